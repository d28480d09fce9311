"""Roots of switching functions, many at once: in each row and lane one of its own, all evaluated together.

A row looks either for places where a function f takes a level or for places where it turns, that is where f′ is zero.
Each root lies between two places where what is to vanish has opposite signs. Newton's method, or where no derivative is
given the secant through the last two places, is kept within that interval, which is halved where they lead out of it.
"""

import math
from collections.abc import Callable

import numpy as np

from engine.cycle.compiling import routine
from engine.cycle.directions import directions
from engine.cycle.lanes import LANES, in_lanes

# Parts of a root: its interval, and f less the level, or f′, at the interval's ends; f itself there; its place X; the
# place BEFORE and what was to vanish there; LENGTH of the last step, and that which is short
# enough; the interval to begin with.
LOW, HIGH, AT_LOW, AT_HIGH, F_LOW, F_HIGH, X, BEFORE, AT_BEFORE, LENGTH, ENOUGH = range(11)
FIRST_LOW, FIRST_HIGH = 11, 12
PARTS = 13
# What a row looks for: the number of f, and the row of P with the level or TURN.
FUNCTION, LEVEL = range(2)
TURN = -1
# Length of the last step, as a share of the interval.
FOUND = 1e-11
MOST_STEPS = 60


@routine
def begin_roots(count: int, roots: np.ndarray) -> None:
    """Begin each root on the straight line between the ends of its interval."""
    roots = in_lanes(roots)
    for r in range(count):
        for lane in range(LANES):
            low, high = roots[LOW, r, lane], roots[HIGH, r, lane]
            at_low, at_high = roots[AT_LOW, r, lane], roots[AT_HIGH, r, lane]
            share = at_low / (at_low - at_high)
            share = share if (share > 0.0) & (share < 1.0) else 0.5
            nearer = abs(at_low) < abs(at_high)
            roots[X, r, lane] = low + (high - low) * share
            roots[BEFORE, r, lane] = low if nearer else high
            roots[AT_BEFORE, r, lane] = at_low if nearer else at_high
            roots[LENGTH, r, lane] = abs(high - low)
            roots[ENOUGH, r, lane] = FOUND * abs(high - low)


@routine
def improve_roots(count: int, sought: np.ndarray, block: np.ndarray, tile: np.ndarray, roots: np.ndarray) -> bool:
    """Move each root by one step.

    Parameters
    ----------
    count : int
        Number of rows used.
    sought : ndarray (rows, 2) of int
        Rows FUNCTION and LEVEL.
    block : ndarray (numbers, LANES)
        P.
    tile : ndarray (2 functions, rows, LANES)
        All functions and their derivatives at the X of each row.
    roots : ndarray (PARTS, rows, LANES)

    Returns
    -------
    bool
        Whether any root isn't found yet. One that is stays.
    """
    block, tile, roots = in_lanes(block), in_lanes(tile), in_lanes(roots)
    going = False
    for r in range(count):
        function, level = sought[r, FUNCTION], max(sought[r, LEVEL], 0)
        turns = 1.0 if sought[r, LEVEL] == TURN else 0.0
        for lane in range(LANES):
            f, derivative = tile[2 * function, r, lane], tile[2 * function + 1, r, lane]
            x, before = roots[X, r, lane], roots[BEFORE, r, lane]
            value = derivative if turns > 0.0 else f - block[level, lane]
            slope = (value - roots[AT_BEFORE, r, lane]) / (x - before) if turns > 0.0 else derivative
            beside_low = (value > 0.0) == (roots[AT_LOW, r, lane] > 0.0)
            low = x if beside_low else roots[LOW, r, lane]
            high = roots[HIGH, r, lane] if beside_low else x
            ahead = x - value / slope
            ahead = ahead if (ahead - low) * (ahead - high) <= 0.0 else 0.5 * (low + high)
            ahead = x if value == 0.0 else ahead
            ahead = ahead if abs(value) < math.inf else math.nan
            found = not roots[LENGTH, r, lane] > roots[ENOUGH, r, lane]
            roots[LENGTH, r, lane] = 0.0 if found else abs(ahead - x)
            roots[BEFORE, r, lane], roots[AT_BEFORE, r, lane] = x, value
            roots[X, r, lane] = x if found else ahead
            roots[LOW, r, lane], roots[HIGH, r, lane] = low, high
        for lane in range(LANES):
            going |= roots[LENGTH, r, lane] > roots[ENOUGH, r, lane]
    return going


@routine
def solve_roots(
    functions: Callable,
    block: np.ndarray,
    tables: np.ndarray,
    count: int,
    sought: np.ndarray,
    place: np.ndarray,
    tile: np.ndarray,
    roots: np.ndarray,
) -> None:
    """Find the roots of all rows; all functions at the places found are in `tile` afterwards.

    Parameters
    ----------
    functions : callable
        Fills in each function and its derivative.
    block, tables : ndarray
        Handed on to it.
    count : int
        Number of rows used.
    sought : ndarray (rows, 2) of int
    place : ndarray (3, rows, LANES)
        Used for input positions.
    tile : ndarray (2 functions, rows, LANES)
    roots : ndarray (PARTS, rows, LANES)
    """
    if count == 0:
        return
    begin_roots(count, roots)
    q, cos_q, sin_q, x = place[0, :count], place[1, :count], place[2, :count], roots[X]
    found = False
    for _ in range(MOST_STEPS):
        for r in range(count):
            for lane in range(LANES):
                q[r, lane] = x[r, lane]
        directions(q, cos_q, sin_q)
        functions(block, tables, q, cos_q, sin_q, tile)
        # Once more where all were found, so that nothing depends on which of them was the last.
        if found:
            break
        found = not improve_roots(count, sought, block, tile, roots)
