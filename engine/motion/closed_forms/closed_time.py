"""Motion with constant inertia under a moment given by a table over time, in closed form.

The table is a cubic in every piece; so I·dω/dt = M(t) makes the speed a polynomial of degree four there, the angle one
of degree five, and the power of each moment one of degree seven at most. Piece by piece they are integrated exactly,
each from where it begins, so that nothing cancels however late it is.
"""

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from engine.laws.tables import Table, table_value
from engine.motion.closed_forms.closed_laws import Motion, MotionEquation
from engine.motion.regula_falsi import regula_falsi


class Push(NamedTuple):
    """A moment over time: its table, the factor it acts with (variants,), and the channel of its work."""

    table: Table
    factor: np.ndarray
    channel: int


def strongest(table: Table) -> tuple[float, float]:
    """An instant [s] at which a table isn't zero, and its value there; (0, 1) for a table that is zero throughout.

    Parameters
    ----------
    table : Table
    """
    instants = np.concatenate((table.breaks, 0.5 * (table.breaks[1:] + table.breaks[:-1])))
    values = np.array([table_value(*table, t) for t in instants])
    best = np.abs(values).argmax()
    return (float(instants[best]), float(values[best])) if values[best] else (0.0, 1.0)


def timed_motion(balance: MotionEquation, push: Push, omega: np.ndarray, clock: np.ndarray, time: np.ndarray) -> Motion:
    """Motion until a time, of machines that go on in their direction.

    Parameters
    ----------
    balance : MotionEquation
        All other moments, which are constant.
    push : Push
    omega, clock, time : ndarray (variants,)
        Speed [rad/s] and time [s] at the begin, and the duration [s].
    """
    steady = balance.loads[:, 0].sum(axis=0)
    angle, works, speed = np.zeros_like(omega), np.zeros((len(balance.loads) + 1, omega.size)), omega.copy()
    slowest, fastest = omega.copy(), omega.copy()
    edges = np.concatenate(([-np.inf], push.table.breaks[1:-1], [np.inf]))
    for piece, cubic in enumerate(push.table.coefficients):
        begin = np.clip(clock, edges[piece], edges[piece + 1])
        h = np.clip(clock + time, edges[piece], edges[piece + 1]) - begin
        if not (h > 0.0).any():
            continue
        pushing = push.factor * _shifted(cubic, begin - push.table.breaks[piece])
        moment = pushing.copy()
        moment[0] += steady
        course = np.concatenate((speed[None], _integral(moment) / balance.inertia))
        for instant in (*_turns(moment, h), h):
            there = _value(course, instant)
            slowest, fastest = np.minimum(slowest, there), np.maximum(fastest, there)
        way = _value(_integral(course), h) * h
        angle += way
        works[1:] += balance.loads[:, 0] * way
        works[1 + push.channel] += _value(_integral(_product(pushing, course)), h) * h
        speed = _value(course, h)
    zero = np.zeros_like(omega)
    return Motion(time.copy(), angle, speed, works, zero, slowest, fastest, zero.copy())


# Polynomials: coefficients (degree + 1, variants), lowest power first


def _shifted(cubic: np.ndarray, by: np.ndarray) -> np.ndarray:
    """A cubic, highest power first, as a polynomial in the distance from `by`."""
    a, b, c, d = cubic
    return np.array(
        [d + by * (c + by * (b + by * a)), c + by * (2.0 * b + 3.0 * by * a), b + 3.0 * by * a, a + 0.0 * by]
    )


def _value(polynomial: np.ndarray, x: np.ndarray) -> np.ndarray:
    value = np.zeros_like(x)
    for coefficient in polynomial[::-1]:
        value = value * x + coefficient
    return value


def _integral(polynomial: np.ndarray) -> np.ndarray:
    """The integral from 0 over x, so without its zero first coefficient."""
    return polynomial / np.arange(1.0, len(polynomial) + 1.0)[:, None]


def _product(one: np.ndarray, other: np.ndarray) -> np.ndarray:
    product = np.zeros((len(one) + len(other) - 1, one.shape[1]))
    for i, row in enumerate(one):
        product[i : i + len(other)] += row * other
    return product


def _turns(cubic: np.ndarray, h: np.ndarray) -> list[np.ndarray]:
    """Where a cubic passes zero between 0 and h, (variants,) each; h where it doesn't."""
    _, b, c, d = cubic
    # Extremes of the cubic part the range into three, each with a root at most.
    root = np.sqrt(c * c - 3.0 * b * d)
    q = -(c + np.where(c < 0.0, -root, root))
    extremes = np.sort(np.clip(np.nan_to_num([q / (3.0 * d), b / q], nan=0.0), 0.0, h), axis=0)
    cuts, found = (np.zeros_like(h), *extremes, h), []
    for low, high in pairwise(cuts):
        passes = (_value(cubic, low) > 0.0) != (_value(cubic, high) > 0.0)
        ends = np.where(passes, low, h), np.where(passes, high, h)
        found.append(regula_falsi(lambda t: _value(cubic, t), *ends))
    return found
