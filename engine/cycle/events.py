"""Where a machine's switching functions turn and cross levels: its landmarks and the cuts of its cycle.

Each function f(q), given with its derivative, is looked at in positions over each lane's range. Between
two of them where f′ has opposite signs it turns; between its turns it is monotone and takes a level once at most.
"""

import math

import numpy as np

from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import Memory, any_positive, memory
from engine.cycle.panels.record import OF_ROUNDING
from engine.cycle.panels.series import larger, smaller
from engine.cycle.panels.walk import DIRECTION, PLACE, PLACE_ERROR, RANGE
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
    SampledFunctions,
    X,
)

# Rows of a function's landmarks: its least and greatest value, their places, what values and either place may be off
# by; its greatest magnitude.
LEAST, GREATEST, LEAST_AT, GREATEST_AT, VALUE_ERROR, LEAST_AT_ERROR, GREATEST_AT_ERROR, SCALE = range(8)
LANDMARKS = 8
of_landmarks = memory(LANDMARKS, LANES)
# Turns of one function, or places where it takes one level, at most: so many in each turn of the input.
MOST_ROOTS = 12
# How many of the positions scanned are looked at once more, changed by their rounding.
LOOKED_BESIDE = 4
# A root beside a turn is off by no more than this share of the range.
FLAT = 1e-7
# Positions scanned aren't equally spaced: whole numbers of periods between all of them would hide what moves so fast.
UNEVEN = 0.1 / (2.0 * math.pi)
# Positions are too far apart where in more than this share of the intervals in which a function moves its slope isn't
# what a cubic tells, by this share of its root mean square: of a sine where they are more than a fifth of its period.
COARSE, MISSED = 0.25, 0.05
# What is no more than so many roundings of a function isn't motion.
STILL = 64.0 * ROUNDING


@routine
def scan_positions(first: Memory, last: Memory, count: int, q: Memory) -> None:
    """Positions over each lane's range, both ends included."""
    for k in range(count):
        even = k / (count - 1.0)
        share = even + UNEVEN * math.sin(2.0 * math.pi * even)
        for lane in range(LANES):
            q[k, lane] = first[lane] + share * (last[lane] - first[lane])
    for lane in range(LANES):
        q[count - 1, lane] = last[lane]


@routine
def note_coarse(
    function: int,
    samples: SampledFunctions,
    scale: Memory,
    square: Memory,
    moving: Memory,
    missed: Memory,
    coarse: Memory,
) -> None:
    """Note the lanes in which positions are too far apart to tell where a function turns.

    Every second position is compared with the cubic through those beside it.

    Parameters
    ----------
    function : int
    samples : SampledFunctions
        All functions at the positions scanned.
    scale : row (LANES,)
        Greatest magnitude of the function.
    square, moving, missed : row (LANES,)
        Used meanwhile: mean square of the slope, in how many intervals it moves, in how many of them it is missed.
    coarse : row (LANES,)
        1 where they are noted.
    """
    q, values, f_row = samples.q, samples.values, 2 * function * samples.room
    slope_row = f_row + samples.room
    for lane in range(LANES):
        square[lane] = moving[lane] = missed[lane] = 0.0
    for k in range(samples.room):
        for lane in range(LANES):
            square[lane] += values[slope_row + k, lane] ** 2 / samples.room
    for i in range((samples.room - 1) // 2):
        k = 2 * i + 1
        for lane in range(LANES):
            before, here = values[slope_row + k - 1, lane], values[slope_row + k, lane]
            after = values[slope_row + k + 1, lane]
            width = q[k + 1, lane] - q[k - 1, lane]
            t = (q[k, lane] - q[k - 1, lane]) / width
            chord = (values[f_row + k + 1, lane] - values[f_row + k - 1, lane]) / width
            told = 6.0 * t * (1.0 - t) * chord + (1.0 - t) * (1.0 - 3.0 * t) * before + t * (3.0 * t - 2.0) * after
            least = larger(MISSED * math.sqrt(square[lane]), STILL * scale[lane] / abs(width))
            moving[lane] += 1.0 if larger(larger(abs(before), abs(here)), abs(after)) > least else 0.0
            missed[lane] += 1.0 if abs(here - told) > least else 0.0
    for lane in range(LANES):
        coarse[lane] = 1.0 if missed[lane] > COARSE * moving[lane] else coarse[lane]


@routine
def open_row(row: int, used: int, function: int, level: int, sought: np.ndarray, roots: Memory) -> int:
    """Begin a row of roots if it is the next one; returns how many are used."""
    if row < used:
        return used
    for part in range(PARTS):
        for lane in range(LANES):
            roots[row, part, lane] = math.nan
    sought[row, FUNCTION], sought[row, LEVEL] = function, level
    return row + 1


@routine
def find_turns(
    function: int,
    samples: SampledFunctions,
    used: int,
    sought: np.ndarray,
    roots: Memory,
    marks: Memory,
    counts: Memory,
    most: int,
) -> int:
    """Enter the intervals in which a function turns as new rows of roots.

    Zero counts as positive; nothing turns where a value isn't finite.

    Parameters
    ----------
    function : int
    samples : SampledFunctions
        All functions at the positions scanned.
    used : int
        Rows of roots in use.
    sought : ndarray (rows, 2) of int
    roots : rows (rows, PARTS, LANES)
    marks : row (LANES,)
        Used meanwhile.
    counts : row (LANES,)
        Receives how many are entered.
    most : int
        Of what turns more often, by rounding as a rule, the first so many are entered.

    Returns
    -------
    int
        Rows of roots in use now.
    """
    before, q, values, f_row = used, samples.q, samples.values, 2 * function * samples.room
    slope_row = f_row + samples.room
    for lane in range(LANES):
        counts[lane] = 0.0
    for k in range(samples.room - 1):
        for lane in range(LANES):
            here, there = values[slope_row + k, lane], values[slope_row + k + 1, lane]
            turns = ((here >= 0.0) != (there >= 0.0)) & (abs(here) + abs(there) < math.inf)
            marks[lane] = 1.0 if turns else 0.0
        if not any_positive(marks):
            continue
        for lane in range(LANES):
            row = before + int(counts[lane])
            if marks[lane] > 0.0 and counts[lane] < most:
                counts[lane] += 1.0
                used = open_row(row, used, function, TURN, sought, roots)
                roots[row, LOW, lane] = roots[row, FIRST_LOW, lane] = q[k, lane]
                roots[row, HIGH, lane] = roots[row, FIRST_HIGH, lane] = q[k + 1, lane]
                roots[row, AT_LOW, lane] = values[slope_row + k, lane]
                roots[row, AT_HIGH, lane] = values[slope_row + k + 1, lane]
                roots[row, F_LOW, lane] = values[f_row + k, lane]
                roots[row, F_HIGH, lane] = values[f_row + k + 1, lane]
    return used


@routine
def find_landmarks(
    function: int,
    samples: SampledFunctions,
    count: int,
    sought: np.ndarray,
    turned: SampledFunctions,
    roots: Memory,
    beside: SampledFunctions,
    steepest: Memory,
    landmarks: Memory,
) -> None:
    """Least and greatest value of a function, of the positions scanned and of those where it turns.

    Parameters
    ----------
    function : int
    samples : SampledFunctions
        All functions at the positions scanned.
    count : int
        Number of rows of turns.
    sought : ndarray (rows, 2) of int
    turned : SampledFunctions
        All functions where they turn.
    roots : rows (rows, PARTS, LANES)
    beside : SampledFunctions
        All functions at some of the positions scanned, evenly spaced, changed by their rounding.
    steepest : row (LANES,)
        Used meanwhile: greatest magnitude of f′.
    landmarks : rows (functions, LANDMARKS, LANES)
        Receives them.
    """
    f_row, last = 2 * function * samples.room, samples.room - 1
    slope_row = f_row + samples.room
    for lane in range(LANES):
        for part in range(LANDMARKS):
            landmarks[function, part, lane] = 0.0
        landmarks[function, LEAST, lane], landmarks[function, GREATEST, lane] = math.inf, -math.inf
        steepest[lane] = 0.0
    for k in range(last + 1):
        for lane in range(LANES):
            f, place, scale = samples.values[f_row + k, lane], samples.q[k, lane], landmarks[function, SCALE, lane]
            low, high = landmarks[function, LEAST, lane], landmarks[function, GREATEST, lane]
            low_at, high_at = landmarks[function, LEAST_AT, lane], landmarks[function, GREATEST_AT, lane]
            landmarks[function, LEAST, lane], landmarks[function, GREATEST, lane] = smaller(f, low), larger(f, high)
            landmarks[function, LEAST_AT, lane] = place if f < low else low_at
            landmarks[function, GREATEST_AT, lane] = place if f > high else high_at
            # Not finite once, not finite for good.
            magnitude = abs(f) if abs(f) < math.inf else math.nan
            landmarks[function, SCALE, lane] = scale if (scale >= magnitude) | (scale != scale) else magnitude
            steepest[lane] = larger(abs(samples.values[slope_row + k, lane]), steepest[lane])
    stride = samples.room // LOOKED_BESIDE
    for k in range(LOOKED_BESIDE):
        for lane in range(LANES):
            here, there = samples.values[f_row + k * stride, lane], beside.values[2 * function * beside.room + k, lane]
            off = OF_ROUNDING * abs(here - there)
            landmarks[function, VALUE_ERROR, lane] = larger(off, landmarks[function, VALUE_ERROR, lane])
    for r in range(count):
        if sought[r, FUNCTION] != function:
            continue
        for lane in range(LANES):
            f, place = turned.values[2 * function * turned.room + r, lane], roots[r, X, lane]
            width = roots[r, ENOUGH, lane] / FOUND
            bend = abs(roots[r, AT_HIGH, lane] - roots[r, AT_LOW, lane]) / width
            aside = ROUNDING * (steepest[lane] / bend)
            lower, higher = f <= landmarks[function, LEAST, lane], f >= landmarks[function, GREATEST, lane]
            landmarks[function, LEAST, lane] = f if lower else landmarks[function, LEAST, lane]
            landmarks[function, LEAST_AT, lane] = place if lower else landmarks[function, LEAST_AT, lane]
            landmarks[function, LEAST_AT_ERROR, lane] = aside if lower else landmarks[function, LEAST_AT_ERROR, lane]
            landmarks[function, GREATEST, lane] = f if higher else landmarks[function, GREATEST, lane]
            landmarks[function, GREATEST_AT, lane] = place if higher else landmarks[function, GREATEST_AT, lane]
            at_error = landmarks[function, GREATEST_AT_ERROR, lane]
            landmarks[function, GREATEST_AT_ERROR, lane] = aside if higher else at_error
    # Where a function stands still at its end, the end is anywhere there.
    for k in range(last):
        for lane in range(LANES):
            here, there = samples.values[f_row + k, lane], samples.values[f_row + k + 1, lane]
            near, width = ROUNDING * landmarks[function, SCALE, lane], samples.q[k + 1, lane] - samples.q[k, lane]
            low = larger(here, there) <= landmarks[function, LEAST, lane] + near
            high = smaller(here, there) >= landmarks[function, GREATEST, lane] - near
            landmarks[function, LEAST_AT_ERROR, lane] += 2.0 * width if low else 0.0
            landmarks[function, GREATEST_AT_ERROR, lane] += 2.0 * width if high else 0.0
    for lane in range(LANES):
        aside = ROUNDING * larger(abs(samples.q[0, lane]), abs(samples.q[last, lane]))
        landmarks[function, VALUE_ERROR, lane] += ROUNDING * landmarks[function, SCALE, lane]
        landmarks[function, LEAST_AT_ERROR, lane] += aside
        landmarks[function, GREATEST_AT_ERROR, lane] += aside
    for part in range(LANDMARKS):
        for lane in range(LANES):
            known = landmarks[function, SCALE, lane] < math.inf
            landmarks[function, part, lane] = landmarks[function, part, lane] if known else math.nan


@inlined
def crosses(at_low: float, at_high: float, level: float, near: float) -> float:
    """2 where f touches a level within rounding at the low end of a piece, 1 where it crosses it in between, else 0.

    Where f touches a level it counts as on neither side of it, whatever its rounding.
    """
    here, there = at_low - level, at_high - level
    apart = ((here > near) & (there < -near)) | ((here < -near) & (there > near))
    return 2.0 if abs(here) <= near else (1.0 if apart else 0.0)


@routine
def enter_crossings(
    low: Memory,
    high: Memory,
    at_low: Memory,
    at_high: Memory,
    function: int,
    number: int,
    level: Memory,
    before: int,
    used: int,
    sought: np.ndarray,
    roots: Memory,
    marks: Memory,
    counts: Memory,
    most: int,
) -> int:
    """Enter the pieces of f marked as of `crosses` as new rows of roots.

    Parameters
    ----------
    low, high, at_low, at_high : row (LANES,)
        Ends of the pieces and f there.
    function, number, level, before, used, sought, roots, marks, counts, most
        As of `find_crossings`; `before` is the first row for this function and level.

    Returns
    -------
    int
        Rows of roots in use now.
    """
    for lane in range(LANES):
        row, room = before + int(counts[lane]), counts[lane] < most
        # What lies on its level all along touches it at every position: of such, any may be left out.
        counts[lane] += 1.0 if (marks[lane] == 1.0) | (marks[lane] > 0.0) & room else 0.0
        if marks[lane] > 0.0 and room:
            used = open_row(row, used, function, number, sought, roots)
            roots[row, LOW, lane], roots[row, HIGH, lane] = low[lane], low[lane] if marks[lane] == 2.0 else high[lane]
            roots[row, AT_LOW, lane] = at_low[lane] - level[lane]
            roots[row, AT_HIGH, lane] = at_high[lane] - level[lane]
    return used


@routine
def find_crossings(
    function: int,
    number: int,
    level: Memory,
    scale: Memory,
    samples: SampledFunctions,
    turns: int,
    turn_sought: np.ndarray,
    turned: SampledFunctions,
    turn_roots: Memory,
    used: int,
    sought: np.ndarray,
    roots: Memory,
    marks: Memory,
    counts: Memory,
    most: int,
) -> int:
    """Enter the intervals in which a function takes a level as new rows of roots.

    Parameters
    ----------
    function, number : int
        Numbers of the function and of the level.
    level, scale : row (LANES,)
        The level; greatest magnitude of the function.
    samples : SampledFunctions
        All functions at the positions scanned.
    turns : int
        Rows of turns.
    turn_sought, turned, turn_roots
        What they are, all functions there, their roots.
    used : int
        Rows of roots in use.
    sought : ndarray (rows, 2) of int
    roots : rows (rows, PARTS, LANES)
    marks : row (LANES,)
        Used meanwhile.
    counts : row (LANES,)
        Receives how many there are.
    most : int
        How many of them are entered.

    Returns
    -------
    int
        Rows of roots in use now.
    """
    before, q, values, f_row = used, samples.q, samples.values, 2 * function * samples.room
    slope_row = f_row + samples.room
    for lane in range(LANES):
        counts[lane] = 0.0
    for k in range(samples.room - 1):
        for lane in range(LANES):
            mark = crosses(values[f_row + k, lane], values[f_row + k + 1, lane], level[lane], ROUNDING * scale[lane])
            # Where it turns within, it isn't monotone.
            turns_here = (values[slope_row + k, lane] >= 0.0) != (values[slope_row + k + 1, lane] >= 0.0)
            marks[lane] = 0.0 if turns_here & (mark == 1.0) else mark
        if any_positive(marks):
            low, high, at_low, at_high = q[k], q[k + 1], values[f_row + k], values[f_row + k + 1]
            used = enter_crossings(
                low, high, at_low, at_high, function, number, level, before, used, sought, roots, marks, counts, most
            )
    for r in range(turns):
        if turn_sought[r, FUNCTION] != function:
            continue
        place, at_place = turn_roots[r, X], turned.values[2 * function * turned.room + r]
        for side in range(2):
            end, at_end = turn_roots[r, FIRST_LOW + side], turn_roots[r, F_LOW + side]
            for lane in range(LANES):
                mark = crosses(at_place[lane], at_end[lane], level[lane], ROUNDING * scale[lane])
                # A turn that touches the level is entered once.
                marks[lane] = 0.0 if (side == 1) & (mark == 2.0) else mark
            used = enter_crossings(
                place, end, at_place, at_end, function, number, level, before, used, sought, roots, marks, counts, most
            )
    return used


@routine
def lay_edges(
    count: int,
    sought: np.ndarray,
    samples: SampledFunctions,
    roots: Memory,
    landmarks: Memory,
    cut_rows: np.ndarray,
    block: Memory,
    walk: Memory,
    edges: Memory,
) -> int:
    """Turn roots and positions given in rows of P into edges of a walk, with what their places may be off by.

    Returns
    -------
    int
        How many edges there are.
    """
    for r in range(count):
        function = sought[r, FUNCTION]
        slope_row = (2 * function + 1) * samples.room + r
        for lane in range(LANES):
            place = roots[r, X, lane]
            # Levels may follow from other landmarks, and are off as much.
            off = 2.0 * landmarks[function, VALUE_ERROR, lane] / abs(samples.values[slope_row, lane])
            edges[r, PLACE, lane] = walk[DIRECTION, lane] * place
            # Where f turns it is flat.
            edges[r, PLACE_ERROR, lane] = smaller(off, FLAT * walk[RANGE, lane]) + ROUNDING * abs(place)
    for i in range(cut_rows.shape[0]):
        for lane in range(LANES):
            edges[count + i, PLACE, lane] = walk[DIRECTION, lane] * block[cut_rows[i], lane]
            edges[count + i, PLACE_ERROR, lane] = ROUNDING * abs(block[cut_rows[i], lane])
    sort_edges(count + cut_rows.shape[0], edges)
    return count + cut_rows.shape[0]


@routine
def sort_edges(count: int, edges: Memory) -> None:
    """Put each lane's edges in order, those at one place by what they may be off by, NaN last, as infinity.

    Source: D. L. Shell, A high-speed sorting procedure, Communications of the ACM 2 (1959).
    """
    for e in range(count):
        for lane in range(LANES):
            edges[e, PLACE, lane] = edges[e, PLACE, lane] if edges[e, PLACE, lane] < math.inf else math.inf
    gap = count
    while gap > 1:
        gap = max(1, 5 * gap // 11)
        for lane in range(LANES):
            for e in range(gap, count):
                place, off, k = edges[e, PLACE, lane], edges[e, PLACE_ERROR, lane], e
                while k >= gap and (
                    edges[k - gap, PLACE, lane] > place
                    or (edges[k - gap, PLACE, lane] == place and edges[k - gap, PLACE_ERROR, lane] < off)
                ):
                    edges[k, PLACE, lane] = edges[k - gap, PLACE, lane]
                    edges[k, PLACE_ERROR, lane] = edges[k - gap, PLACE_ERROR, lane]
                    k -= gap
                edges[k, PLACE, lane], edges[k, PLACE_ERROR, lane] = place, off
