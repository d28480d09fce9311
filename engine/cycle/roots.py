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

from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.directions import directions
from engine.cycle.panels.lanes import Memory, any_positive, in_lanes, memory, rows

# Parts of a root: its interval, and f less the level, or f′, at the interval's ends; its place X; the place BEFORE and
# what was to vanish there; LENGTH of the last step, and that which is short enough; a MARK.
LOW, HIGH, AT_LOW, AT_HIGH, X, BEFORE, AT_BEFORE, LENGTH, ENOUGH, MARK = range(10)
# Of a turn, the interval to begin with and f at its ends.
FIRST_LOW, FIRST_HIGH, F_LOW, F_HIGH = range(10, 14)
PARTS = 14
of_roots = memory(PARTS, LANES)
# What a row looks for: the number of f, and that of the level or TURN.
FUNCTION, LEVEL = range(2)
TURN = -1
# Length of the last step, as a share of the interval.
FOUND = 1e-11
MOST_STEPS = 60
# Of a root by itself: most steps, no fewer than bisection alone would take, and when it can't be told any better.
MOST_TURNS, _SETTLED = 80, 4e-16


class SampledFunctions(NamedTuple):
    """Functions and their derivatives at rows of positions.

    Attributes
    ----------
    room : int
        How many rows of positions there may be.
    q : rows (room, LANES)
    values : rows (2 functions × room, LANES)
        f_i at row k of positions is 2 i · room + k, its derivative (2 i + 1) · room + k.
    place : ndarray (3, room, LANES)
        Positions with cosine and sine.
    tile : ndarray (2 functions, room, LANES)
        The values as the machine's function sees them.
    """

    room: int
    q: Memory
    values: Memory
    place: np.ndarray
    tile: np.ndarray


class SampleRoom(NamedTuple):
    """Arrays for `SampledFunctions`."""

    place: np.ndarray
    tile: np.ndarray


def new_samples(functions: int, room: int) -> SampleRoom:
    """Room for so many functions at so many rows of positions."""
    return SampleRoom(rows(3, room), rows(2 * functions, room))


@routine
def samples_in(given: SampleRoom) -> SampledFunctions:
    """The samples in their memory."""
    return SampledFunctions(
        given.place.shape[1], in_lanes(given.place[0]), in_lanes(given.tile), given.place, given.tile
    )


@routine
def sample(functions: Callable, block: np.ndarray, tables: np.ndarray, count: int, samples: SampledFunctions) -> None:
    """Evaluate all functions at the first `count` rows of positions."""
    place = samples.place
    q, cos_q, sin_q = place[0, :count], place[1, :count], place[2, :count]
    directions(count, in_lanes(q), in_lanes(cos_q), in_lanes(sin_q))
    functions(block, tables, q, cos_q, sin_q, samples.tile)


@routine
def begin_roots(count: int, roots: Memory) -> None:
    """Begin each root on the straight line between the ends of its interval."""
    for r in range(count):
        for lane in range(LANES):
            low, high = roots[r, LOW, lane], roots[r, HIGH, lane]
            at_low, at_high = roots[r, AT_LOW, lane], roots[r, AT_HIGH, lane]
            share = at_low / (at_low - at_high)
            share = share if (share > 0.0) & (share < 1.0) else 0.5
            nearer = abs(at_low) < abs(at_high)
            roots[r, X, lane] = low + (high - low) * share
            roots[r, BEFORE, lane] = low if nearer else high
            roots[r, AT_BEFORE, lane] = at_low if nearer else at_high
            roots[r, LENGTH, lane] = abs(high - low)
            roots[r, ENOUGH, lane] = FOUND * abs(high - low)


@routine
def improve_roots(count: int, sought: np.ndarray, levels: Memory, room: int, values: Memory, roots: Memory) -> bool:
    """Move each root by one step.

    Parameters
    ----------
    count : int
        Number of rows used.
    sought : ndarray (rows, 2) of int
        FUNCTION and LEVEL of each row.
    levels : rows (levels, LANES)
    room : int
    values : rows (2 functions × room, LANES)
        As of `SampledFunctions`, at the X of each row.
    roots : rows (rows, PARTS, LANES)

    Returns
    -------
    bool
        Whether any root isn't found yet. One that is stays.
    """
    going = False
    for r in range(count):
        f_row, level = 2 * sought[r, FUNCTION] * room + r, max(sought[r, LEVEL], 0)
        turns = 1.0 if sought[r, LEVEL] == TURN else 0.0
        for lane in range(LANES):
            derivative = values[f_row + room, lane]
            x, before = roots[r, X, lane], roots[r, BEFORE, lane]
            value = derivative if turns > 0.0 else values[f_row, lane] - levels[level, lane]
            slope = (value - roots[r, AT_BEFORE, lane]) / (x - before) if turns > 0.0 else derivative
            beside_low = (value > 0.0) == (roots[r, AT_LOW, lane] > 0.0)
            low = x if beside_low else roots[r, LOW, lane]
            high = roots[r, HIGH, lane] if beside_low else x
            ahead = x - value / slope
            ahead = ahead if (ahead - low) * (ahead - high) <= 0.0 else 0.5 * (low + high)
            ahead = x if value == 0.0 else ahead
            ahead = ahead if abs(value) < math.inf else math.nan
            found = not roots[r, LENGTH, lane] > roots[r, ENOUGH, lane]
            roots[r, LENGTH, lane] = 0.0 if found else abs(ahead - x)
            roots[r, MARK, lane] = 1.0 if (not found) & (abs(ahead - x) > roots[r, ENOUGH, lane]) else 0.0
            roots[r, BEFORE, lane], roots[r, AT_BEFORE, lane] = x, value
            roots[r, X, lane] = x if found else ahead
            roots[r, LOW, lane], roots[r, HIGH, lane] = low, high
        going |= any_positive(roots[r, MARK])
    return going


@routine
def solve_roots(
    functions: Callable,
    block: np.ndarray,
    tables: np.ndarray,
    count: int,
    sought: np.ndarray,
    levels: Memory,
    samples: SampledFunctions,
    roots: Memory,
) -> None:
    """Find the roots of all rows; `samples` holds all functions at the places found afterwards.

    Parameters
    ----------
    functions : callable
        Fills in each function and its derivative.
    block, tables : ndarray
        Handed on to it.
    count : int
        Number of rows used.
    sought : ndarray (rows, 2) of int
    levels : rows (levels, LANES)
    samples : SampledFunctions
    roots : rows (rows, PARTS, LANES)
    """
    q, found = samples.q, count == 0
    begin_roots(count, roots)
    for _ in range(MOST_STEPS):
        for r in range(count):
            for lane in range(LANES):
                q[r, lane] = roots[r, X, lane]
        if count > 0:
            sample(functions, block, tables, count, samples)
        # Once more where all were found, so that nothing depends on which of them was the last.
        if found:
            break
        found = not improve_roots(count, sought, levels, samples.room, samples.values, roots)


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
