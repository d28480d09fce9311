"""Bracketed roots of switching functions, in rows and lanes.

Each row and lane has a separate root, and all are evaluated together. A row seeks either a level of a function f or a
turning point, where f′ = 0. Each root lies in a bracket with opposite signs at its ends. Newton's method, or the secant
through the last two points where there is no second derivative, stays inside the bracket and bisects it otherwise.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, Rows, in_lanes
from engine.compiling.decorators import routine
from engine.cycle.panels.directions import directions
from engine.cycle.panels.lanes import any_positive, many, new_record, rows

# Level of a row that seeks a turning point.
TURN = -1
# Length of the last step, as a fraction of the bracket.
FOUND = 1e-11
MOST_STEPS = 60


class GivenNumbers(NamedTuple):
    """Arguments of a machine's functions apart from positions.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
        Numbers of each lane's variant.
    tables : ndarray
        Shared by all lanes.
    """

    block: np.ndarray
    tables: np.ndarray


class Samples(NamedTuple):
    """Functions and their derivatives at rows of positions.

    Attributes
    ----------
    place : ndarray (3, room, LANES)
        Positions with cosine and sine.
    tile : ndarray (outputs, room, LANES)
        f and f′ alternately, then the held nodes.
    used : ndarray (1,) of int
        Number of rows in use, if not all are.
    """

    place: np.ndarray
    tile: np.ndarray
    used: np.ndarray


class Root(NamedTuple):
    """A root in each lane.

    Attributes
    ----------
    low, high, at_low, at_high : row
        Its bracket, and f minus the level, or f′, at the bracket's ends.
    x : row
        Current estimate.
    before, at_before : row
        Previous estimate, and the residual there.
    length, enough : row
        Length of the last step, and the length at which it has converged.
    mark : row
        Scratch: 1 if the root hasn't converged, else 0.
    first_low, first_high, f_low, f_high : row
        For a turning point, the initial bracket and f at its ends.
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
        Number of rows in use.
    function, level : ndarray (rows,) of int
        Index of f and of the level of each row, or TURN.
    at : Samples
        All functions at the roots.
    """

    rows: many(Root)
    used: np.ndarray
    function: np.ndarray
    level: np.ndarray
    at: Samples


def new_samples(outputs: int, room: int) -> Samples:
    """Allocate samples of `outputs` rows at `room` rows of positions."""
    return Samples(rows(3, room), rows(outputs, room), np.array([room]))


def new_roots(outputs: int, room: int) -> Roots:
    """Allocate `room` rows of roots, with samples of `outputs` rows."""
    used, function, level = (np.zeros(size, np.int64) for size in (1, room, room))
    return new_record(Roots, rows=room, used=used, function=function, level=level, at=new_samples(outputs, room))


@routine
def open_row(row: int, function: int, level: int, roots: Roots) -> Root:
    """Return a row of roots; initialise it if it is the next unused one."""
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
    """Start each root at the zero of the chord over its bracket."""
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
    """Move each root by one step; converged roots stay.

    Parameters
    ----------
    levels : rows (levels, LANES)
    roots : Roots
        With all functions evaluated at the current estimates.

    Returns
    -------
    bool
        Whether any root hasn't converged.
    """
    moving = False
    for r in range(roots.used[0]):
        root, f, level = roots.rows[r], roots.function[r], max(roots.level[r], 0)
        values, slopes = in_lanes(roots.at.tile[2 * f, r:]), in_lanes(roots.at.tile[2 * f + 1, r:])
        turns = 1.0 if roots.level[r] == TURN else 0.0
        for lane in range(LANES):
            derivative = slopes[0, lane]
            x, before = root.x[lane], root.before[lane]
            value = derivative if turns > 0.0 else values[0, lane] - levels[level, lane]
            slope = (value - root.at_before[lane]) / (x - before) if turns > 0.0 else derivative
            like_low = (value > 0.0) == (root.at_low[lane] > 0.0)
            low = x if like_low else root.low[lane]
            high = root.high[lane] if like_low else x
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
        moving |= any_positive(root.mark)
    return moving


@routine
def solve_roots(functions: Callable, given: GivenNumbers, levels: Rows, roots: Roots) -> None:
    """Find the roots of all rows; `roots.at` then holds all functions at the roots.

    Parameters
    ----------
    functions : callable
        Fills each function and its derivative.
    given : GivenNumbers
        Arguments of `functions`.
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
        # Sampled again after the last step, so that no result depends on which root converged last.
        if found:
            break
        found = not improve_roots(levels, roots)
