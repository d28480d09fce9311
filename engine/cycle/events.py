"""Where a machine's switching functions turn and cross levels: its landmarks and the cuts of its cycle.

Each function f(q), given with its derivative, is looked at in positions over each lane's range. Between
two of them where f′ has opposite signs it turns; between its turns it is monotone and takes a level once at most.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, Rows, in_lanes
from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import any_positive
from engine.cycle.panels.record import OF_ROUNDING
from engine.cycle.panels.series import larger, smaller
from engine.cycle.panels.walk import Walk
from engine.cycle.roots import FOUND, TURN, Roots, Samples, open_row

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


class LandmarkRows(NamedTuple):
    """Landmarks of a switching function.

    Attributes
    ----------
    least, greatest : row
        Its least and greatest value.
    least_at, greatest_at : row
        Their places.
    value_error, least_at_error, greatest_at_error : row
        What values and either place may be off by.
    scale : row
        Greatest magnitude.
    """

    least: Row
    greatest: Row
    least_at: Row
    greatest_at: Row
    value_error: Row
    least_at_error: Row
    greatest_at_error: Row
    scale: Row


_LANDMARKS = len(LandmarkRows._fields)


class Noted(NamedTuple):
    """Rows used while roots are entered.

    Attributes
    ----------
    marks : row
        Which lanes enter one.
    counts : row
        How many of a function, or of a function and level, were found.
    steepest : row
        Greatest magnitude of f′.
    """

    marks: Row
    counts: Row
    steepest: Row


class Level(NamedTuple):
    """A level of a switching function.

    Attributes
    ----------
    function, number : int
        Numbers of the function and of the level.
    height : row
        The level.
    scale : row
        Greatest magnitude of the function.
    """

    function: int
    number: int
    height: Row
    scale: Row


class MonotonePiece(NamedTuple):
    """Each lane's piece of a function.

    Attributes
    ----------
    low, high : row
        Ends of the piece.
    at_low, at_high : row
        The function there.
    """

    low: Row
    high: Row
    at_low: Row
    at_high: Row


@routine
def scan_positions(first: Row, last: Row, count: int, q: Rows) -> None:
    """Positions over each lane's range, both ends included."""
    for k in range(count):
        even = k / (count - 1.0)
        share = even + UNEVEN * math.sin(2.0 * math.pi * even)
        for lane in range(LANES):
            q[k, lane] = first[lane] + share * (last[lane] - first[lane])
    for lane in range(LANES):
        q[count - 1, lane] = last[lane]


@routine
def note_coarse(function: int, samples: Samples, scale: Row, noted: Noted, coarse: Row) -> None:
    """Note the lanes in which positions are too far apart to tell where a function turns.

    Every second position is compared with the cubic through those beside it.

    Parameters
    ----------
    function : int
    samples : Samples
        All functions at the positions scanned.
    scale : row
        Greatest magnitude of the function.
    noted : Noted
        Used meanwhile: mean square of the slope, in how many intervals it moves, in how many of them it is missed.
    coarse : row
        1 where they are noted.
    """
    room, q = samples.tile.shape[1], in_lanes(samples.place[0])
    square, moving, missed = noted.steepest, noted.marks, noted.counts
    values, slopes = in_lanes(samples.tile[2 * function]), in_lanes(samples.tile[2 * function + 1])
    for lane in range(LANES):
        square[lane] = moving[lane] = missed[lane] = 0.0
    for k in range(room):
        for lane in range(LANES):
            square[lane] += slopes[k, lane] ** 2 / room
    for i in range((room - 1) // 2):
        k = 2 * i + 1
        for lane in range(LANES):
            before, here, after = slopes[k - 1, lane], slopes[k, lane], slopes[k + 1, lane]
            width = q[k + 1, lane] - q[k - 1, lane]
            t = (q[k, lane] - q[k - 1, lane]) / width
            chord = (values[k + 1, lane] - values[k - 1, lane]) / width
            told = 6.0 * t * (1.0 - t) * chord + (1.0 - t) * (1.0 - 3.0 * t) * before + t * (3.0 * t - 2.0) * after
            least = larger(MISSED * math.sqrt(square[lane]), STILL * scale[lane] / abs(width))
            moving[lane] += 1.0 if larger(larger(abs(before), abs(here)), abs(after)) > least else 0.0
            missed[lane] += 1.0 if abs(here - told) > least else 0.0
    for lane in range(LANES):
        coarse[lane] = 1.0 if missed[lane] > COARSE * moving[lane] else coarse[lane]


@routine
def find_turns(function: int, samples: Samples, most: int, noted: Noted, turns: Roots) -> None:
    """Enter the intervals in which a function turns as new rows of roots.

    Zero counts as positive; nothing turns where a value isn't finite.

    Parameters
    ----------
    function : int
    samples : Samples
        All functions at the positions scanned.
    most : int
        Of what turns more often, by rounding as a rule, the first so many are entered.
    noted : Noted
    turns : Roots
    """
    before, q, marks, counts = turns.used[0], in_lanes(samples.place[0]), noted.marks, noted.counts
    values, slopes = in_lanes(samples.tile[2 * function]), in_lanes(samples.tile[2 * function + 1])
    for lane in range(LANES):
        counts[lane] = 0.0
    for k in range(samples.tile.shape[1] - 1):
        for lane in range(LANES):
            here, there = slopes[k, lane], slopes[k + 1, lane]
            turned = ((here >= 0.0) != (there >= 0.0)) & (abs(here) + abs(there) < math.inf)
            marks[lane] = 1.0 if turned else 0.0
        if not any_positive(marks):
            continue
        for lane in range(LANES):
            row = before + int(counts[lane])
            if marks[lane] > 0.0 and counts[lane] < most:
                counts[lane] += 1.0
                root = open_row(row, function, TURN, turns)
                root.low[lane] = root.first_low[lane] = q[k, lane]
                root.high[lane] = root.first_high[lane] = q[k + 1, lane]
                root.at_low[lane], root.at_high[lane] = slopes[k, lane], slopes[k + 1, lane]
                root.f_low[lane], root.f_high[lane] = values[k, lane], values[k + 1, lane]


@routine
def find_landmarks(
    function: int, samples: Samples, beside: Samples, turns: Roots, steepest: Row, found: LandmarkRows
) -> None:
    """Least and greatest value of a function, of the positions scanned and of those where it turns.

    Parameters
    ----------
    function : int
    samples : Samples
        All functions at the positions scanned.
    beside : Samples
        All functions at some of these, evenly spaced, changed by their rounding.
    turns : Roots
    steepest : row
        Used meanwhile: greatest magnitude of f′.
    found : LandmarkRows
        Receives them.
    """
    last, q = samples.tile.shape[1] - 1, in_lanes(samples.place[0])
    values, slopes = in_lanes(samples.tile[2 * function]), in_lanes(samples.tile[2 * function + 1])
    for part in range(_LANDMARKS):
        for lane in range(LANES):
            found[part, lane] = 0.0
    for lane in range(LANES):
        found.least[lane], found.greatest[lane], steepest[lane] = math.inf, -math.inf, 0.0
    for k in range(last + 1):
        for lane in range(LANES):
            f, place, scale = values[k, lane], q[k, lane], found.scale[lane]
            low, high = found.least[lane], found.greatest[lane]
            low_at, high_at = found.least_at[lane], found.greatest_at[lane]
            found.least[lane], found.greatest[lane] = smaller(f, low), larger(f, high)
            found.least_at[lane] = place if f < low else low_at
            found.greatest_at[lane] = place if f > high else high_at
            # Not finite once, not finite for good.
            magnitude = abs(f) if abs(f) < math.inf else math.nan
            found.scale[lane] = scale if (scale >= magnitude) | (scale != scale) else magnitude
            steepest[lane] = larger(abs(slopes[k, lane]), steepest[lane])
    stride, changed = samples.tile.shape[1] // LOOKED_BESIDE, in_lanes(beside.tile[2 * function])
    for k in range(LOOKED_BESIDE):
        for lane in range(LANES):
            off = OF_ROUNDING * abs(values[k * stride, lane] - changed[k, lane])
            found.value_error[lane] = larger(off, found.value_error[lane])
    at_turns = in_lanes(turns.at.tile[2 * function])
    for r in range(turns.used[0]):
        if turns.function[r] != function:
            continue
        root = turns.rows[r]
        for lane in range(LANES):
            f, place = at_turns[r, lane], root.x[lane]
            width = root.enough[lane] / FOUND
            bend = abs(root.at_high[lane] - root.at_low[lane]) / width
            off = ROUNDING * (steepest[lane] / bend)
            lower, higher = f <= found.least[lane], f >= found.greatest[lane]
            found.least[lane] = f if lower else found.least[lane]
            found.least_at[lane] = place if lower else found.least_at[lane]
            found.least_at_error[lane] = off if lower else found.least_at_error[lane]
            found.greatest[lane] = f if higher else found.greatest[lane]
            found.greatest_at[lane] = place if higher else found.greatest_at[lane]
            found.greatest_at_error[lane] = off if higher else found.greatest_at_error[lane]
    # Where a function stands still at its end, the end is anywhere there.
    for k in range(last):
        for lane in range(LANES):
            here, there = values[k, lane], values[k + 1, lane]
            near, width = ROUNDING * found.scale[lane], q[k + 1, lane] - q[k, lane]
            low = larger(here, there) <= found.least[lane] + near
            high = smaller(here, there) >= found.greatest[lane] - near
            found.least_at_error[lane] += 2.0 * width if low else 0.0
            found.greatest_at_error[lane] += 2.0 * width if high else 0.0
    for lane in range(LANES):
        off = ROUNDING * larger(abs(q[0, lane]), abs(q[last, lane]))
        found.value_error[lane] += ROUNDING * found.scale[lane]
        found.least_at_error[lane] += off
        found.greatest_at_error[lane] += off
    for part in range(_LANDMARKS):
        for lane in range(LANES):
            known = found.scale[lane] < math.inf
            found[part, lane] = found[part, lane] if known else math.nan


@inlined
def crosses(at_low: float, at_high: float, level: float, near: float) -> float:
    """2 where f touches a level within rounding at the low end of a piece, 1 where it crosses it in between, else 0.

    Where f touches a level it counts as on neither side of it, whatever its rounding.
    """
    here, there = at_low - level, at_high - level
    apart = ((here > near) & (there < -near)) | ((here < -near) & (there > near))
    return 2.0 if abs(here) <= near else (1.0 if apart else 0.0)


@routine
def enter_crossings(piece: MonotonePiece, level: Level, before: int, most: int, noted: Noted, crossings: Roots) -> None:
    """Enter the pieces of f marked as by `crosses` as new rows of roots; parameters as for `find_crossings`.

    `before` is the first row for this level.
    """
    marks, counts, height = noted.marks, noted.counts, level.height
    for lane in range(LANES):
        row, room = before + int(counts[lane]), counts[lane] < most
        # What lies on its level all along touches it at every position: of such, any may be left out.
        counts[lane] += 1.0 if (marks[lane] == 1.0) | (marks[lane] > 0.0) & room else 0.0
        if marks[lane] > 0.0 and room:
            root = open_row(row, level.function, level.number, crossings)
            root.low[lane] = piece.low[lane]
            root.high[lane] = piece.low[lane] if marks[lane] == 2.0 else piece.high[lane]
            root.at_low[lane] = piece.at_low[lane] - height[lane]
            root.at_high[lane] = piece.at_high[lane] - height[lane]


@routine
def find_crossings(level: Level, samples: Samples, turns: Roots, most: int, noted: Noted, crossings: Roots) -> None:
    """Enter the intervals in which a function takes a level as new rows of roots.

    Parameters
    ----------
    level : Level
    samples : Samples
        All functions at the positions scanned.
    turns : Roots
    most : int
        How many places are entered.
    noted : Noted
        Receives how many there are.
    crossings : Roots
    """
    before, q, marks, height = crossings.used[0], in_lanes(samples.place[0]), noted.marks, level.height
    values, slopes = in_lanes(samples.tile[2 * level.function]), in_lanes(samples.tile[2 * level.function + 1])
    for lane in range(LANES):
        noted.counts[lane] = 0.0
    for k in range(samples.tile.shape[1] - 1):
        for lane in range(LANES):
            mark = crosses(values[k, lane], values[k + 1, lane], height[lane], ROUNDING * level.scale[lane])
            # Where it turns within, it isn't monotone.
            turns_here = (slopes[k, lane] >= 0.0) != (slopes[k + 1, lane] >= 0.0)
            marks[lane] = 0.0 if turns_here & (mark == 1.0) else mark
        if any_positive(marks):
            piece = MonotonePiece(q[k], q[k + 1], values[k], values[k + 1])
            enter_crossings(piece, level, before, most, noted, crossings)
    at_turns = in_lanes(turns.at.tile[2 * level.function])
    for r in range(turns.used[0]):
        if turns.function[r] != level.function:
            continue
        root, at_place = turns.rows[r], at_turns[r]
        for side in range(2):
            end, at_end = root.first_high if side else root.first_low, root.f_high if side else root.f_low
            for lane in range(LANES):
                mark = crosses(at_place[lane], at_end[lane], height[lane], ROUNDING * level.scale[lane])
                # A turn that touches the level is entered once.
                marks[lane] = 0.0 if (side == 1) & (mark == 2.0) else mark
            enter_crossings(MonotonePiece(root.x, end, at_place, at_end), level, before, most, noted, crossings)


@routine
def lay_edges(crossings: Roots, landmarks: Rows, cut_rows: np.ndarray, block: Rows, walk: Walk, edges: Rows) -> int:
    """Turn roots and positions given in rows of P into edges of a walk, with what their places may be off by.

    Returns
    -------
    int
        How many edges there are.
    """
    count = crossings.used[0]
    for r in range(count):
        f, root, edge = crossings.function[r], crossings.rows[r], edges[r]
        slopes, value_error = in_lanes(crossings.at.tile[2 * f + 1]), landmarks[f].value_error
        for lane in range(LANES):
            # Levels may follow from other landmarks, and are off as much.
            off = 2.0 * value_error[lane] / abs(slopes[r, lane])
            edge.place[lane] = walk.direction[lane] * root.x[lane]
            # Where f turns it is flat.
            edge.error[lane] = smaller(off, FLAT * walk.range[lane]) + ROUNDING * abs(root.x[lane])
    for i in range(cut_rows.shape[0]):
        edge, places = edges[count + i], block[cut_rows[i]]
        for lane in range(LANES):
            edge.place[lane], edge.error[lane] = walk.direction[lane] * places[lane], ROUNDING * abs(places[lane])
    sort_edges(count + cut_rows.shape[0], edges)
    return count + cut_rows.shape[0]


@routine
def sort_edges(count: int, edges: Rows) -> None:
    """Put each lane's edges in order, those at one place by what they may be off by, NaN last, as infinity.

    Source: D. L. Shell, A high-speed sorting procedure, Communications of the ACM 2 (1959).
    """
    for e in range(count):
        for lane in range(LANES):
            edges[e].place[lane] = edges[e].place[lane] if edges[e].place[lane] < math.inf else math.inf
    gap = count
    while gap > 1:
        gap = max(1, 5 * gap // 11)
        for lane in range(LANES):
            for e in range(gap, count):
                place, off, k = edges[e].place[lane], edges[e].error[lane], e
                while k >= gap and (
                    edges[k - gap].place[lane] > place
                    or (edges[k - gap].place[lane] == place and edges[k - gap].error[lane] < off)
                ):
                    edges[k].place[lane] = edges[k - gap].place[lane]
                    edges[k].error[lane] = edges[k - gap].error[lane]
                    k -= gap
                edges[k].place[lane], edges[k].error[lane] = place, off
