"""Roots within brackets: of switching functions in rows and lanes, and one at a time.

In each row and lane there is a root of its own, and all are evaluated together. A row looks either for places where a
function f takes a level or for places where it turns, that is where f′ is zero. Each root lies between two places where
what is to vanish has opposite signs. Newton's method, or where no derivative is given the secant through the last two
places, is kept within that interval, which is halved where they lead out of it.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, Rows, in_lanes
from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.directions import directions
from engine.cycle.panels.lanes import any_positive, many, new_record, rows

# The level of a row that looks for a turn.
TURN = -1
# Length of the last step, as a share of the interval.
FOUND = 1e-11
MOST_STEPS = 60
# Of a root by itself: most steps, no fewer than bisection alone would take, and when it can't be told any better.
MOST_TURNS, _SETTLED = 80, 4e-16


class GivenNumbers(NamedTuple):
    """What a machine's functions are given besides positions.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
        Numbers of each lane's variant.
    tables : ndarray
        That all lanes share.
    """

    block: np.ndarray
    tables: np.ndarray


class Samples(NamedTuple):
    """Functions and their derivatives at rows of positions.

    Attributes
    ----------
    place : ndarray (3, room, LANES)
        Positions with cosine and sine.
    tile : ndarray (2 functions, room, LANES)
        By turns f and f′.
    """

    place: np.ndarray
    tile: np.ndarray


class Root(NamedTuple):
    """A root in each lane.

    Attributes
    ----------
    low, high, at_low, at_high : row
        Its interval, and f less the level, or f′, at the interval's ends.
    x : row
        Its place.
    before, at_before : row
        The place before, and what was to vanish there.
    length, enough : row
        Length of the last step, and that which is short enough.
    mark : row
    first_low, first_high, f_low, f_high : row
        Of a turn, the interval to begin with and f at its ends.
    """

    low: Row
    high: Row
    at_low: Row
    at_high: Row
    x: Row
    before: Row
    at_before: Row
    length: Row
    enough: Row
    mark: Row
    first_low: Row
    first_high: Row
    f_low: Row
    f_high: Row


_PARTS = len(Root._fields)


class Roots(NamedTuple):
    """Rows of roots.

    Attributes
    ----------
    rows : many Root
    used : ndarray (1,) of int
        How many rows are used.
    function, level : ndarray (rows,) of int
        What each looks for: the number of f, and that of the level or TURN.
    at : Samples
        All functions at the places.
    """

    rows: many(Root)
    used: np.ndarray
    function: np.ndarray
    level: np.ndarray
    at: Samples


def new_samples(functions: int, room: int) -> Samples:
    """Room for so many functions at so many rows of positions."""
    return Samples(rows(3, room), rows(2 * functions, room))


def new_roots(functions: int, room: int) -> Roots:
    """Room for so many rows of roots of so many functions."""
    used, function, level = (np.zeros(size, np.int64) for size in (1, room, room))
    return new_record(Roots, rows=room, used=used, function=function, level=level, at=new_samples(functions, room))


@routine
def open_row(row: int, function: int, level: int, roots: Roots) -> Root:
    """A row of roots; begin it if it is the next one."""
    root = roots.rows[row]
    if row == roots.used[0]:
        for part in range(_PARTS):
            for lane in range(LANES):
                root[part, lane] = math.nan
        roots.function[row], roots.level[row] = function, level
        roots.used[0] = row + 1
    return root


@routine
def sample(functions: Callable, given: GivenNumbers, count: int, samples: Samples) -> None:
    """Evaluate all functions at the first `count` rows of positions."""
    place = samples.place
    q, cos_q, sin_q = place[0, :count], place[1, :count], place[2, :count]
    directions(count, in_lanes(q), in_lanes(cos_q), in_lanes(sin_q))
    functions(given.block, given.tables, q, cos_q, sin_q, samples.tile)


@routine
def begin_roots(roots: Roots) -> None:
    """Begin each root on the straight line between the ends of its interval."""
    for r in range(roots.used[0]):
        root = roots.rows[r]
        for lane in range(LANES):
            low, high = root.low[lane], root.high[lane]
            at_low, at_high = root.at_low[lane], root.at_high[lane]
            share = at_low / (at_low - at_high)
            share = share if (share > 0.0) & (share < 1.0) else 0.5
            nearer = abs(at_low) < abs(at_high)
            root.x[lane] = low + (high - low) * share
            root.before[lane] = low if nearer else high
            root.at_before[lane] = at_low if nearer else at_high
            root.length[lane] = abs(high - low)
            root.enough[lane] = FOUND * abs(high - low)


@routine
def improve_roots(levels: Rows, roots: Roots) -> bool:
    """Move each root by one step.

    Parameters
    ----------
    levels : rows (levels, LANES)
    roots : Roots
        With all functions at their places.

    Returns
    -------
    bool
        Whether any root isn't found yet. One that is stays.
    """
    going = False
    for r in range(roots.used[0]):
        root, f, level = roots.rows[r], roots.function[r], max(roots.level[r], 0)
        values, slopes = in_lanes(roots.at.tile[2 * f, r:]), in_lanes(roots.at.tile[2 * f + 1, r:])
        turns = 1.0 if roots.level[r] == TURN else 0.0
        for lane in range(LANES):
            derivative = slopes[0, lane]
            x, before = root.x[lane], root.before[lane]
            value = derivative if turns > 0.0 else values[0, lane] - levels[level, lane]
            slope = (value - root.at_before[lane]) / (x - before) if turns > 0.0 else derivative
            beside_low = (value > 0.0) == (root.at_low[lane] > 0.0)
            low = x if beside_low else root.low[lane]
            high = root.high[lane] if beside_low else x
            ahead = x - value / slope
            ahead = ahead if (ahead - low) * (ahead - high) <= 0.0 else 0.5 * (low + high)
            ahead = x if value == 0.0 else ahead
            ahead = ahead if abs(value) < math.inf else math.nan
            found = not root.length[lane] > root.enough[lane]
            root.length[lane] = 0.0 if found else abs(ahead - x)
            root.mark[lane] = 1.0 if (not found) & (abs(ahead - x) > root.enough[lane]) else 0.0
            root.before[lane], root.at_before[lane] = x, value
            root.x[lane] = x if found else ahead
            root.low[lane], root.high[lane] = low, high
        going |= any_positive(root.mark)
    return going


@routine
def solve_roots(functions: Callable, given: GivenNumbers, levels: Rows, roots: Roots) -> None:
    """Find the roots of all rows; `roots.at` holds all functions at the places found afterwards.

    Parameters
    ----------
    functions : callable
        Fills in each function and its derivative.
    given : GivenNumbers
        Handed on to it.
    levels : rows (levels, LANES)
    roots : Roots
    """
    q, count = in_lanes(roots.at.place[0]), roots.used[0]
    found = count == 0
    begin_roots(roots)
    for _ in range(MOST_STEPS):
        for r in range(count):
            for lane in range(LANES):
                q[r, lane] = roots.rows[r].x[lane]
        if count > 0:
            sample(functions, given, count, roots.at)
        # Once more where all were found, so that nothing depends on which of them was the last.
        if found:
            break
        found = not improve_roots(levels, roots)


@inlined
def newton_between(
    x: float, over: float, slope: float, rises: bool, low: float, high: float
) -> tuple[float, float, float, bool]:
    """One step towards the zero of a function that has different signs at two bounds.

    Parameters
    ----------
    x : float
        Between the bounds.
    over, slope : float
        The function and its derivative there.
    rises : bool
        Whether the function is above 0 at the upper bound.
    low, high : float

    Returns
    -------
    x : float
        Nearer to the zero: Newton's step, or half-way between the bounds where that leaves them.
    low, high : float
        Nearer to each other.
    settled : bool
        Whether it can't be told any better.
    """
    if (over > 0.0) == rises:
        high = x
    else:
        low = x
    new = x - over / slope if slope != 0.0 else low
    if not low < new < high:
        new = 0.5 * (low + high)
    return new, low, high, abs(new - x) <= _SETTLED * abs(new) or high - low <= _SETTLED * abs(high)
