"""Where a machine's switching functions turn and cross levels: its landmarks and the cuts of its cycle.

Each function f(q), given with its derivative, is looked at in equally spaced positions over each lane's range. Between
two of them where f′ has opposite signs it turns; between its turns it is monotone and takes a level once at most.
"""

import math

import numpy as np

from engine.cycle.compiling import routine
from engine.cycle.integrals import ROUNDING
from engine.cycle.lanes import LANES, in_lanes
from engine.cycle.panels import DIRECTION, PLACE, PLACE_ERROR, RANGE
from engine.cycle.roots import (
    AT_HIGH,
    AT_LOW,
    ENOUGH,
    F_HIGH,
    F_LOW,
    FIRST_HIGH,
    FIRST_LOW,
    FOUND,
    FUNCTION,
    HIGH,
    LEVEL,
    LOW,
    PARTS,
    TURN,
    X,
)
from engine.cycle.series import larger, smaller

# Rows of a function's landmarks: its least and greatest value and their places, what values and either place may be off
# by; greatest magnitude.
LEAST, LEAST_AT, GREATEST, GREATEST_AT, VALUE_ERROR, LEAST_AT_ERROR, GREATEST_AT_ERROR, SCALE = range(8)
LANDMARKS = 8
# Roots of one function at one level, or turns of one function, at most.
MOST_ROOTS = 12
# A root beside a turn is off by no more than this share of the range.
FLAT = 1e-7


@routine
def scan_positions(first: np.ndarray, last: np.ndarray, q: np.ndarray) -> None:
    """Equally spaced positions over each lane's range, both ends included."""
    q = in_lanes(q)
    count = q.shape[0]
    for k in range(count):
        for lane in range(LANES):
            share = k / (count - 1.0)
            q[k, lane] = first[lane] + share * (last[lane] - first[lane]) if k < count - 1 else last[lane]


@routine
def changes(at: np.ndarray, row: int, k: int, marks: np.ndarray) -> bool:
    """Mark the lanes where a row of a tile changes its sign between positions k and k + 1; whether any does.

    Zero counts as positive; nothing changes where a value isn't finite.
    """
    at = in_lanes(at)
    for lane in range(LANES):
        here, there = at[row, k, lane], at[row, k + 1, lane]
        marks[lane] = 1.0 if ((here >= 0.0) != (there >= 0.0)) & (abs(here) + abs(there) < math.inf) else 0.0
    found = False
    for lane in range(LANES):
        found |= marks[lane] > 0.0
    return found


@routine
def open_row(row: int, used: int, function: int, level: int, sought: np.ndarray, roots: np.ndarray) -> int:
    """Begin a row if it is the next one; returns how many are used."""
    if row < used:
        return used
    for part in range(PARTS):
        for lane in range(LANES):
            roots[part, row, lane] = math.nan
    sought[row, FUNCTION], sought[row, LEVEL] = function, level
    return row + 1


@routine
def find_turns(
    function: int,
    q: np.ndarray,
    tile: np.ndarray,
    used: int,
    sought: np.ndarray,
    roots: np.ndarray,
    marks: np.ndarray,
    counts: np.ndarray,
) -> int:
    """Enter the intervals in which a function turns as new rows of roots.

    Parameters
    ----------
    function : int
    q : ndarray (scan, LANES)
    tile : ndarray (2 functions, scan, LANES)
    used : int
        Rows of roots in use.
    sought : ndarray (rows, 2) of int
    roots : ndarray (PARTS, rows, LANES)
    marks, counts : ndarray (LANES,)
        Used meanwhile.

    Returns
    -------
    int
        Rows of roots in use now.
    """
    q, tile, roots = in_lanes(q), in_lanes(tile), in_lanes(roots)
    before = used
    for lane in range(LANES):
        counts[lane] = 0.0
    for k in range(q.shape[0] - 1):
        if not changes(tile, 2 * function + 1, k, marks):
            continue
        for lane in range(LANES):
            row = before + int(counts[lane])
            if marks[lane] > 0.0 and counts[lane] < MOST_ROOTS:
                used = open_row(row, used, function, TURN, sought, roots)
                counts[lane] += 1.0
                roots[LOW, row, lane], roots[HIGH, row, lane] = q[k, lane], q[k + 1, lane]
                roots[AT_LOW, row, lane] = tile[2 * function + 1, k, lane]
                roots[AT_HIGH, row, lane] = tile[2 * function + 1, k + 1, lane]
                roots[F_LOW, row, lane], roots[F_HIGH, row, lane] = (
                    tile[2 * function, k, lane],
                    tile[2 * function, k + 1, lane],
                )
                roots[FIRST_LOW, row, lane], roots[FIRST_HIGH, row, lane] = q[k, lane], q[k + 1, lane]
    return used


@routine
def find_landmarks(
    function: int,
    q: np.ndarray,
    tile: np.ndarray,
    count: int,
    sought: np.ndarray,
    turned: np.ndarray,
    roots: np.ndarray,
    landmarks: np.ndarray,
) -> None:
    """Least and greatest value of a function, from the ends of the range and from where it turns.

    Parameters
    ----------
    function : int
    q, tile : ndarray
        The positions scanned, and all functions with their derivatives there.
    count : int
        Number of rows of turns.
    sought : ndarray (rows, 2) of int
    turned : ndarray (2 functions, rows, LANES)
        All functions at each row's root.
    roots : ndarray (PARTS, rows, LANES)
    landmarks : ndarray (functions, LANDMARKS, LANES)
        Receives them.
    """
    q, tile, turned, roots, landmarks = (
        in_lanes(q),
        in_lanes(tile),
        in_lanes(turned),
        in_lanes(roots),
        in_lanes(landmarks),
    )
    row, last = 2 * function, q.shape[0] - 1
    for lane in range(LANES):
        landmarks[function, LEAST, lane], landmarks[function, LEAST_AT, lane] = math.inf, math.nan
        landmarks[function, GREATEST, lane], landmarks[function, GREATEST_AT, lane] = -math.inf, math.nan
        landmarks[function, SCALE, lane] = 0.0
        landmarks[function, LEAST_AT_ERROR, lane] = landmarks[function, GREATEST_AT_ERROR, lane] = 0.0
    for k in range(last + 1):
        for lane in range(LANES):
            f, place = tile[row, k, lane], q[k, lane]
            low, high, scale = (
                landmarks[function, LEAST, lane],
                landmarks[function, GREATEST, lane],
                landmarks[function, SCALE, lane],
            )
            landmarks[function, LEAST_AT, lane] = place if f < low else landmarks[function, LEAST_AT, lane]
            landmarks[function, GREATEST_AT, lane] = place if f > high else landmarks[function, GREATEST_AT, lane]
            landmarks[function, LEAST, lane], landmarks[function, GREATEST, lane] = smaller(f, low), larger(f, high)
            # Not finite once, not finite for good.
            magnitude = abs(f) if abs(f) < math.inf else math.nan
            landmarks[function, SCALE, lane] = scale if (scale >= magnitude) | (scale != scale) else magnitude
    for k in range(last + 1):
        for lane in range(LANES):
            # Of f′, for a moment.
            steepest = landmarks[function, VALUE_ERROR, lane]
            landmarks[function, VALUE_ERROR, lane] = larger(abs(tile[row + 1, k, lane]), steepest)
    for r in range(count):
        if sought[r, FUNCTION] != function:
            continue
        for lane in range(LANES):
            f, place = turned[row, r, lane], roots[X, r, lane]
            low, high = landmarks[function, LEAST, lane], landmarks[function, GREATEST, lane]
            bend = abs(roots[AT_HIGH, r, lane] - roots[AT_LOW, r, lane]) / (roots[ENOUGH, r, lane] / FOUND)
            aside = ROUNDING * (landmarks[function, VALUE_ERROR, lane] / bend)
            lower, higher = f <= low, f >= high
            landmarks[function, LEAST, lane] = f if lower else low
            landmarks[function, LEAST_AT, lane] = place if lower else landmarks[function, LEAST_AT, lane]
            landmarks[function, LEAST_AT_ERROR, lane] = aside if lower else landmarks[function, LEAST_AT_ERROR, lane]
            landmarks[function, GREATEST, lane] = f if higher else high
            landmarks[function, GREATEST_AT, lane] = place if higher else landmarks[function, GREATEST_AT, lane]
            landmarks[function, GREATEST_AT_ERROR, lane] = (
                aside if higher else landmarks[function, GREATEST_AT_ERROR, lane]
            )
    for part in range(LANDMARKS):
        for lane in range(LANES):
            known = landmarks[function, SCALE, lane] < math.inf
            landmarks[function, part, lane] = landmarks[function, part, lane] if known else math.nan
    for lane in range(LANES):
        landmarks[function, VALUE_ERROR, lane] = ROUNDING * landmarks[function, SCALE, lane]
        furthest = ROUNDING * larger(abs(q[0, lane]), abs(q[last, lane]))
        landmarks[function, LEAST_AT_ERROR, lane] += furthest
        landmarks[function, GREATEST_AT_ERROR, lane] += furthest


@routine
def mark_crossings(
    at_low: np.ndarray, at_high: np.ndarray, level: np.ndarray, scale: np.ndarray, marks: np.ndarray
) -> bool:
    """Mark lanes where a monotone piece of f crosses a level (1), or touches it within rounding at its low end (2).

    Where f touches a level it counts as on neither side of it, whatever its rounding.

    Returns
    -------
    bool
        Whether any lane is marked.
    """
    for lane in range(LANES):
        here, there, near = at_low[lane] - level[lane], at_high[lane] - level[lane], ROUNDING * scale[lane]
        apart = ((here > near) & (there < -near)) | ((here < -near) & (there > near))
        marks[lane] = 2.0 if abs(here) <= near else (1.0 if apart else 0.0)
    marked = False
    for lane in range(LANES):
        marked |= marks[lane] > 0.0
    return marked


@routine
def enter_marked(
    low: np.ndarray,
    high: np.ndarray,
    at_low: np.ndarray,
    at_high: np.ndarray,
    function: int,
    level_row: int,
    level: np.ndarray,
    before: int,
    used: int,
    sought: np.ndarray,
    roots: np.ndarray,
    marks: np.ndarray,
    counts: np.ndarray,
) -> int:
    """Enter the pieces marked as new rows of roots; returns how many rows are used."""
    roots = in_lanes(roots)
    for lane in range(LANES):
        row = before + int(counts[lane])
        if marks[lane] > 0.0 and counts[lane] < MOST_ROOTS:
            used = open_row(row, used, function, level_row, sought, roots)
            counts[lane] += 1.0
            touches = marks[lane] == 2.0
            roots[LOW, row, lane], roots[HIGH, row, lane] = low[lane], low[lane] if touches else high[lane]
            roots[AT_LOW, row, lane] = at_low[lane] - level[lane]
            roots[AT_HIGH, row, lane] = at_high[lane] - level[lane]
    return used


@routine
def find_crossings(
    function: int,
    level_row: int,
    level: np.ndarray,
    scale: np.ndarray,
    q: np.ndarray,
    tile: np.ndarray,
    turns: int,
    turn_sought: np.ndarray,
    turned: np.ndarray,
    turn_roots: np.ndarray,
    used: int,
    sought: np.ndarray,
    roots: np.ndarray,
    marks: np.ndarray,
    counts: np.ndarray,
) -> int:
    """Enter the intervals in which a function takes a level as new rows of roots.

    Parameters
    ----------
    function, level_row : int
        Number of the function, row of P with the level.
    level, scale : ndarray (LANES,)
        The level; greatest magnitude of the function.
    q, tile : ndarray
        Positions scanned, and all functions with their derivatives there.
    turns : int
        Rows of turns.
    turn_sought, turned, turn_roots : ndarray
        What they are, all functions there, their roots.
    used : int
        Rows of roots in use.
    sought, roots : ndarray
    marks, counts : ndarray (LANES,)
        Used meanwhile.

    Returns
    -------
    int
        Rows of roots in use now.
    """
    before, f, slope = used, tile[2 * function], tile[2 * function + 1]
    for lane in range(LANES):
        counts[lane] = 0.0
    for k in range(q.shape[0] - 1):
        if not mark_crossings(f[k], f[k + 1], level, scale, marks):
            continue
        # Where it turns within, it isn't monotone.
        for lane in range(LANES):
            turns_here = (slope[k, lane] >= 0.0) != (slope[k + 1, lane] >= 0.0)
            marks[lane] = 0.0 if turns_here & (marks[lane] == 1.0) else marks[lane]
        used = enter_marked(
            q[k], q[k + 1], f[k], f[k + 1], function, level_row, level, before, used, sought, roots, marks, counts
        )
    for r in range(turns):
        if turn_sought[r, FUNCTION] != function:
            continue
        top, place = turned[2 * function, r], turn_roots[X, r]
        if mark_crossings(top, turn_roots[F_LOW, r], level, scale, marks):
            used = enter_marked(
                place,
                turn_roots[FIRST_LOW, r],
                top,
                turn_roots[F_LOW, r],
                function,
                level_row,
                level,
                before,
                used,
                sought,
                roots,
                marks,
                counts,
            )
        if mark_crossings(top, turn_roots[F_HIGH, r], level, scale, marks):
            for lane in range(LANES):
                # Entered with the other side of the turn.
                marks[lane] = 1.0 if marks[lane] == 1.0 else 0.0
            used = enter_marked(
                place,
                turn_roots[FIRST_HIGH, r],
                top,
                turn_roots[F_HIGH, r],
                function,
                level_row,
                level,
                before,
                used,
                sought,
                roots,
                marks,
                counts,
            )
    return used


@routine
def lay_edges(
    count: int,
    sought: np.ndarray,
    tile: np.ndarray,
    roots: np.ndarray,
    landmarks: np.ndarray,
    cut_rows: np.ndarray,
    block: np.ndarray,
    walk: np.ndarray,
    edges: np.ndarray,
) -> int:
    """Turn roots and positions given in rows of P into edges of a walk, with what their places may be off by.

    Returns
    -------
    int
        How many edges there are.
    """
    tile, roots, landmarks = in_lanes(tile), in_lanes(roots), in_lanes(landmarks)
    block, walk, edges = in_lanes(block), in_lanes(walk), in_lanes(edges)
    for r in range(count):
        function = sought[r, FUNCTION]
        for lane in range(LANES):
            place = roots[X, r, lane]
            off = ROUNDING * landmarks[function, SCALE, lane] / abs(tile[2 * function + 1, r, lane])
            # Where f turns, it is flat: a parabola takes it from there.
            off = smaller(off, FLAT * walk[RANGE, lane])
            edges[PLACE, r, lane] = walk[DIRECTION, lane] * place
            edges[PLACE_ERROR, r, lane] = off + ROUNDING * abs(place)
    for i in range(cut_rows.shape[0]):
        for lane in range(LANES):
            edges[PLACE, count + i, lane] = walk[DIRECTION, lane] * block[cut_rows[i], lane]
            edges[PLACE_ERROR, count + i, lane] = 0.0
    return count + cut_rows.shape[0]
