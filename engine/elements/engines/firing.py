"""Firing of a four-stroke engine: crank angles, intervals and orders.

A cylinder fires at its outer dead centre, phi = beta − alpha plus whole turns; the firing order decides in which of the
two turns of its cycle. All rods are assumed to be on the crankpin: link rods reach their dead centres a few degrees
earlier or later.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.engines.engine_layout import EngineLayout, LayoutError

FOUR_STROKE = 2 * math.tau
# Angles closer than this are equal except for rounding.
_SAME = 1e-9


def firing_angles(layout: EngineLayout, order: Sequence[int]) -> np.ndarray:
    """Crank angle at which each cylinder fires, starting from the first in the order.

    Parameters
    ----------
    layout : EngineLayout
        One engine, without variants.
    order : sequence of int
        Cylinder numbers, from 1, each once.

    Returns
    -------
    ndarray (cylinders,)
        Angles by cylinder, within one cycle of the first [rad].

    Raises
    ------
    LayoutError
        A cylinder is missing or repeated, or the throws do not allow this order within one cycle.
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
    """Crank angles at which the cylinders fire in turn, each as early as its throw allows.

    Parameters
    ----------
    layout : EngineLayout
    order : sequence of int
        Cylinder numbers, from 1, each once.

    Returns
    -------
    angles : ndarray (..., cylinders)
        Firing angles by cylinder, starting from that of the first in the order [rad].
    taken : ndarray (...)
        Angle from the first firing to the last [rad]; must be less than the cycle.
    """
    centres = layout.banks - layout.throws
    now = np.zeros(centres.shape[:-1])
    angles = np.repeat(centres[..., order[0] - 1, None], centres.shape[-1], axis=-1)
    for before, cylinder in pairwise(order):
        step = (centres[..., cylinder - 1] - centres[..., before - 1]) % math.tau
        now = now + np.where(step > _SAME, step, math.tau)
        angles[..., cylinder - 1] += now
    return angles, now


def firing_intervals(angles: np.ndarray) -> np.ndarray:
    """Angles from each firing to the next, the last one to the first of the next cycle.

    Parameters
    ----------
    angles : ndarray (cylinders,)
        As from `firing_angles`, in any order.

    Returns
    -------
    ndarray (cylinders,)
        Intervals [rad].
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
        Starts with cylinder 1; None if the throws allow no even order.
    """
    count = layout.banks.shape[-1]
    centres = (layout.banks - layout.throws) - (layout.banks - layout.throws)[0]
    waiting, order = list(range(count)), []
    for k in range(count):
        off = [(centres[c] - k * FOUR_STROKE / count + math.tau / 2) % math.tau - math.tau / 2 for c in waiting]
        fitting = [c for c, angle in zip(waiting, off, strict=True) if abs(angle) < _SAME]
        if not fitting:
            return None
        # The cylinder farthest from the last one to fire, to spare the bearing between them.
        order.append(max(fitting, key=lambda c: abs(c - order[-1])) if order else fitting[0])
        waiting.remove(order[-1])
    return tuple(c + 1 for c in order)


def firing_sums(orders: Sequence[float], angles: ArrayLike) -> np.ndarray:
    """Sums of the unit vectors exp(−i n f_k) of all cylinders, the factor of each order of one cylinder's torque.

    With even intervals all orders vanish except multiples of the number of firings per turn.

    Parameters
    ----------
    orders : sequence of float
    angles : array_like (..., cylinders)
        Firing angles [rad].

    Returns
    -------
    ndarray of complex (..., orders)
        Their magnitude is the number of cylinders for major orders, 0 for balanced ones.
    """
    angles = np.asarray(angles, float)
    return np.exp(-1j * angles[..., None, :] * np.asarray(orders, float)[:, None]).sum(axis=-1)


def _order_text(order: Sequence[int]) -> str:
    return "-".join(str(c) for c in order)


def _suggestion(layout: EngineLayout) -> str:
    even = even_firing_order(layout)
    return "these throws allow no even one" if even is None else f"{_order_text(even)} fires evenly"
