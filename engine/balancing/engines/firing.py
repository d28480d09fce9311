"""Firing of an engine: at which crank angles its cylinders fire, in which intervals, and in which order it may.

A cylinder fires at its outer dead centre, phi = beta − alpha and whole turns; of the turns in its cycle (two in a
four-stroke engine) the firing order says in which. The rods are taken to turn on the crankpin: link rods have their
dead centres some degrees beside.
"""

import math
from collections.abc import Sequence
from itertools import pairwise

import numpy as np

from engine.balancing.engines.engine_layout import TURN, Layout, LayoutError

FOUR_STROKE = 2 * TURN
TWO_STROKE = TURN
# Angles that are equal but for rounding.
_SAME = 1e-9


def firing_angles(layout: Layout, order: Sequence[int], cycle: float = FOUR_STROKE) -> np.ndarray:
    """Crank angle at which each cylinder fires, from that of the first one in the order on.

    Parameters
    ----------
    layout : Layout
        One engine, without variants.
    order : sequence of int
        Numbers of the cylinders from 1 on, each once.
    cycle : float
        4π for four strokes, 2π for two.

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
    if taken > cycle - _SAME:
        raise LayoutError(
            f"firing order {_order_text(order)}: with these throws it takes {math.degrees(taken):.6g}° to the last "
            f"cylinder, the cycle has {math.degrees(cycle):.6g}°; {_suggestion(layout, cycle)}"
        )
    return angles


def firing_sequence(layout: Layout, order: Sequence[int]) -> tuple[np.ndarray, np.ndarray]:
    """Crank angles at which cylinders fire one after another, each as soon as its throw lets it.

    Parameters
    ----------
    layout : Layout
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


def firing_intervals(angles: np.ndarray, cycle: float = FOUR_STROKE) -> np.ndarray:
    """Angles from each firing to the next one, the last one to the first of the next cycle.

    Parameters
    ----------
    angles : ndarray (cylinders,)
        As of `firing_angles`, in any order.
    cycle : float
        [rad].

    Returns
    -------
    ndarray (cylinders,)
        [rad].
    """
    fired = np.sort(angles % cycle)
    return np.diff(fired, append=fired[0] + cycle)


def even_firing_order(layout: Layout, cycle: float = FOUR_STROKE) -> tuple[int, ...] | None:
    """A firing order with even intervals.

    Parameters
    ----------
    layout : Layout
        One engine, without variants.
    cycle : float
        [rad].

    Returns
    -------
    tuple of int or None
        Beginning with cylinder 1; None where the throws allow no even one.
    """
    count = layout.banks.shape[-1]
    centres = (layout.banks - layout.throws) - (layout.banks - layout.throws)[0]
    waiting, order = list(range(count)), []
    for k in range(count):
        off = [(centres[c] - k * cycle / count + TURN / 2) % TURN - TURN / 2 for c in waiting]
        fitting = [c for c, angle in zip(waiting, off, strict=True) if abs(angle) < _SAME]
        if not fitting:
            return None
        order.append(_farthest(fitting, order[-1] if order else fitting[0]))
        waiting.remove(order[-1])
    return tuple(c + 1 for c in order)


def _farthest(fitting: list[int], last: int) -> int:
    """Of the cylinders that may fire now, the one farthest from the last, to spare the bearing between; 1 first."""
    return fitting[0] if last == fitting[0] else max(fitting, key=lambda c: abs(c - last))


def _order_text(order: Sequence[int]) -> str:
    return "-".join(str(c) for c in order)


def _suggestion(layout: Layout, cycle: float) -> str:
    even = even_firing_order(layout, cycle)
    return "these throws allow no even one" if even is None else f"{_order_text(even)} fires evenly"
