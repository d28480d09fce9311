"""Where on its circumference a bearing is loaded over the cycle: rows of a force in the axes of a link.

A film of oil is fed where it is never loaded: on the arc that no force points to. In the axes of the link that holds
the bush the force on it points to the place that is pressed; in those of the link with the journal it points away
from it.

Source: any course of machine elements, chapter on plain bearings (polar diagrams of bearing load; position of the oil
hole).
"""

import math

import numpy as np

from engine.compiling.jit import scalar
from engine.equal_positions.rows import is_finite

# Share of the greatest load below which a bearing counts as unloaded.
LEAST_LOAD = 1e-3
TURN = 2.0 * math.pi
# No angle.
NONE = 2.0 * TURN


@scalar
def turn_between(a: float, b: float) -> float:
    """Smaller of the two angles between directions [rad]."""
    return abs(a - b - TURN * math.floor((a - b) / TURN + 0.5))


@scalar
def hidden(x: np.ndarray, y: np.ndarray, before: float, after: float, periodic: bool) -> float:
    """How far the direction of a force may go beyond two extreme ones between positions, both together [rad].

    Of its turns in the two steps before and the two after, the second largest: a jump is one of them, and either
    branch goes no farther than in its last step.
    """
    n, at, nearest = x.shape[0], (0, 0), (NONE, NONE)
    for k in range(n):
        angle = math.atan2(y[k], x[k])
        a, b = turn_between(angle, before), turn_between(angle, after)
        at = (k if a < nearest[0] else at[0], k if b < nearest[1] else at[1])
        nearest = (min(a, nearest[0]), min(b, nearest[1]))
    total = 0.0
    for edge in at:
        largest = second = 0.0
        for k in range(edge - 2, edge + 2):
            if periodic or 0 <= k < n - 1:
                i, j = k % n, (k + 1) % n
                turn = abs(math.atan2(x[i] * y[j] - y[i] * x[j], x[i] * x[j] + y[i] * y[j]))
                largest, second = max(largest, turn), max(second, min(largest, turn))
        total += second
    return total


@scalar
def unloaded_arc(
    x: np.ndarray, y: np.ndarray, low: np.ndarray, high: np.ndarray, periodic: bool
) -> tuple[float, float, float]:
    """Widest arc that a force never points to.

    Parameters
    ----------
    x, y : ndarray (positions,)
        The force in the axes of a link [N]; where it is less than `LEAST_LOAD` of its greatest it has no direction.
    low, high : ndarray (positions,)
        Room for the least and greatest direction in each of as many sectors. The widest arc is no narrower than one
        of them, so that it lies between sectors and nothing has to be sorted.
    periodic : bool
        Whether the last position is followed by the first.

    Returns
    -------
    arc : float
        2π less the smallest arc that holds all directions [rad]; NaN where a force is NaN or infinite.
    middle : float
        Its middle [rad], from −π to π; NaN where there is no force at all.
    doubt : float
        How much of it may be loaded between positions [rad].
    """
    n, most, total = x.shape[0], 0.0, 0.0
    for k in range(n):
        square = x[k] * x[k] + y[k] * y[k]
        total += square
        most = max(most, square)
        low[k], high[k] = NONE, -NONE
    if not is_finite(total):
        return math.nan, math.nan, math.nan
    if most == 0.0:
        return TURN, math.nan, 0.0
    for k in range(n):
        if x[k] * x[k] + y[k] * y[k] >= LEAST_LOAD * LEAST_LOAD * most:
            angle = math.atan2(y[k], x[k])
            i = min(int((angle / TURN + 0.5) * n), n - 1)
            low[i], high[i] = min(low[i], angle), max(high[i], angle)
    arc, before, after, first, last = -1.0, NONE, NONE, NONE, -NONE
    for i in range(n):
        if low[i] < NONE:
            if first == NONE:
                first = low[i]
            elif low[i] - last > arc:
                arc, before, after = low[i] - last, last, low[i]
            last = high[i]
    if first + TURN - last > arc:
        arc, before, after = first + TURN - last, last, first + TURN
    middle = 0.5 * (before + after)
    return arc, math.atan2(math.sin(middle), math.cos(middle)), hidden(x, y, before, after, periodic)


@scalar
def direction_doubt(off: float, x: float, y: float) -> float:
    """How far the direction of a vector may be off that may itself be off by so much [rad]."""
    length = math.sqrt(x * x + y * y)
    return math.pi if off >= length else math.asin(off / length)


@scalar
def middle_doubt(middle: float, coarse: float, arc: float, doubt: float) -> float:
    """How far the middle of an arc may be off [rad]: anything where what may hide between positions fills the arc."""
    return math.pi if doubt >= arc else turn_between(middle, coarse) + 0.5 * doubt
