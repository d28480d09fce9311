"""Firing of a four-stroke engine: at which crank angles its cylinders fire, in which intervals and orders.

A cylinder fires at its outer dead centre, phi = beta − alpha and whole turns; the firing order says in which of the
two turns of its cycle. The rods are taken to turn on the crankpin: link rods reach their dead centres a few degrees
earlier or later.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.engines.engine_layout import TURN, EngineLayout, LayoutError

FOUR_STROKE = 2 * TURN
# Angles that are equal but for rounding.
_SAME = 1e-9


def firing_angles(layout: EngineLayout, order: Sequence[int]) -> np.ndarray:
    """Crank angle at which each cylinder fires, from that of the first one in the order on.

    Parameters
    ----------
    layout : EngineLayout
        One engine, without variants.
    order : sequence of int
        Numbers of the cylinders from 1 on, each once.

    Returns
    -------
    ndarray (cylinders,)
        Within one cycle of the first [rad], by cylinder.

    Raises
    ------
    LayoutError
        Not every cylinder once, or the throws don't let the cylinders fire in this order within one cycle.
    """
    count = layout.banks.shape[-1]
    if sorted(order) != list(range(1, count + 1)):
        raise LayoutError(f"firing order {_order_text(order)}: it must name each of the cylinders 1 to {count} once")
    angles, taken = firing_sequence(layout, order)
    if taken > FOUR_STROKE - _SAME:
        raise LayoutError(
            f"firing order {_order_text(order)}: with these throws it takes {math.degrees(taken):.6g}° to the last "
            f"cylinder, the cycle has {math.degrees(FOUR_STROKE):.6g}°; {_suggestion(layout)}"
        )
    return angles


def firing_sequence(layout: EngineLayout, order: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    """Crank angles at which cylinders fire one after another, each as soon as its throw lets it.

    Parameters
    ----------
    layout : EngineLayout
    order : sequence of int
        Numbers of the cylinders from 1 on, each once.

    Returns
    -------
    angles : ndarray (..., cylinders)
        From that of the first one in the order on [rad], by cylinder.
    taken : ndarray (...)
        From the first to the last [rad]; to be less than the cycle.
    """
    centres = layout.banks - layout.throws
    now = np.zeros(centres.shape[:-1])
    angles = np.repeat(centres[..., order[0] - 1, None], centres.shape[-1], axis=-1)
    for before, cylinder in pairwise(order):
        step = (centres[..., cylinder - 1] - centres[..., before - 1]) % TURN
        now = now + np.where(step > _SAME, step, TURN)
        angles[..., cylinder - 1] += now
    return angles, now


def firing_intervals(angles: np.ndarray) -> np.ndarray:
    """Angles from each firing to the next one, the last one to the first of the next cycle.

    Parameters
    ----------
    angles : ndarray (cylinders,)
        As for `firing_angles`, in any order.

    Returns
    -------
    ndarray (cylinders,)
        [rad].
    """
    fired = np.sort(angles % FOUR_STROKE)
    return np.diff(fired, append=fired[0] + FOUR_STROKE)


def even_firing_order(layout: EngineLayout) -> tuple[int, ...] | None:
    """A firing order with even intervals.

    Parameters
    ----------
    layout : EngineLayout
        One engine, without variants.

    Returns
    -------
    tuple of int or None
        Beginning with cylinder 1; None where the throws allow no even one.
    """
    count = layout.banks.shape[-1]
    centres = (layout.banks - layout.throws) - (layout.banks - layout.throws)[0]
    waiting, order = list(range(count)), []
    for k in range(count):
        off = [(centres[c] - k * FOUR_STROKE / count + TURN / 2) % TURN - TURN / 2 for c in waiting]
        fitting = [c for c, angle in zip(waiting, off, strict=True) if abs(angle) < _SAME]
        if not fitting:
            return None
        order.append(_farthest(fitting, order[-1] if order else fitting[0]))
        waiting.remove(order[-1])
    return tuple(c + 1 for c in order)


def firing_sums(orders: Sequence[float], angles: ArrayLike) -> np.ndarray:
    """Sums of the unit vectors exp(−i n f_k) of all cylinders: what each order of one's torque is multiplied by.

    With even intervals all orders vanish but multiples of the firings per turn.

    Parameters
    ----------
    orders : sequence of float
    angles : array_like (..., cylinders)
        [rad].

    Returns
    -------
    ndarray of complex (..., orders)
        Their size is the number of cylinders in the major orders, 0 in those that balance.
    """
    angles = np.asarray(angles, float)
    return np.exp(-1j * angles[..., None, :] * np.asarray(orders, float)[:, None]).sum(axis=-1)


def _farthest(fitting: list[int], last: int) -> int:
    """Of the cylinders that may fire now, the one farthest from the last, to spare the bearing between; 1 first."""
    return fitting[0] if last == fitting[0] else max(fitting, key=lambda c: abs(c - last))


def _order_text(order: Sequence[int]) -> str:
    return "-".join(str(c) for c in order)


def _suggestion(layout: EngineLayout) -> str:
    even = even_firing_order(layout)
    return "these throws allow no even one" if even is None else f"{_order_text(even)} fires evenly"
