"""Turning points and level crossings of a machine's switching functions: the landmarks and cuts of its cycle.

Each function f(q), supplied with its derivative, is sampled over each lane's range. It turns between two samples of
opposite sign of f′. Between its turning points it is monotone and crosses a level at most once.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, Rows, in_lanes, scatter_row
from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import any_positive, fill
from engine.cycle.panels.record import OF_ROUNDING
from engine.cycle.panels.series import TINY, larger, smaller
from engine.cycle.panels.walk import Walk
from engine.cycle.roots import FOUND, TURN, Root, Roots, Samples, open_row

# Maximum number of turning points of a function, and of its crossings of one level, per turn of the input.
MOST_ROOTS = 12
# Number of scan positions that are evaluated again, perturbed by their rounding.
LOOKED_BESIDE = 4
# Bound on the error of a root next to a turning point, as a fraction of the range.
FLAT = 1e-7
# Scan positions are unequally spaced: spacings of whole periods would hide fast oscillations.
UNEVEN = 0.1 / math.tau
# The scan is too coarse if a function's slope misses the cubic through its neighbours by more than MISSED of its rms,
# in more than COARSE of the intervals in which the function moves. A sine needs a sample every fifth of its period.
COARSE, MISSED = 0.25, 0.05
# Changes of a function up to this fraction of its scale count as rounding, not motion.
STILL = 64.0 * ROUNDING


class LandmarkRows(NamedTuple):
    """Landmarks of a switching function.

    Attributes
    ----------
    least, greatest : row
        Minimum and maximum.
    least_at, greatest_at : row
        Their positions.
    value_error, least_at_error, greatest_at_error : row
        Error estimates of the values and of either position.
    scale : row
        Maximum magnitude.
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
    """Scratch rows for entering roots.

    Attributes
    ----------
    marks : row
        Lanes that enter a root.
    counts : row
        Number of roots found for a function, or for a function and level.
    steepest, scale : row
        Maxima of |f′| and of |f|; the latter is NaN if a value is NaN or infinite.
    """

    marks: Row
    counts: Row
    steepest: Row
    scale: Row


class Level(NamedTuple):
    """A level of a switching function.

    Attributes
    ----------
    function, number : int
        Indices of the function and of the level.
    height : row
        Value of the level.
    scale : row
        Maximum magnitude of the function.
    """

    function: int
    number: int
    height: Row
    scale: Row


class MonotonePiece(NamedTuple):
    """A monotone piece of a function in each lane.

    Attributes
    ----------
    low, high : row
        Ends of the piece.
    at_low, at_high : row
        Values of the function at the ends.
    """

    low: Row
    high: Row
    at_low: Row
    at_high: Row


@routine
def scan_positions(first: Row, last: Row, count: int, q: Rows) -> None:
    """Fill `count` positions over each lane's range, including both ends."""
    for k in range(count):
        even = k / (count - 1.0)
        share = even + UNEVEN * math.sin(math.tau * even)
        for lane in range(LANES):
            q[k, lane] = first[lane] + share * (last[lane] - first[lane])
    for lane in range(LANES):
        q[count - 1, lane] = last[lane]


@inlined
def _scale(f: float, scale: float) -> float:
    """Maximum magnitude, raised to that of a value; NaN from the first NaN or infinite value on."""
    magnitude = abs(f) if abs(f) < math.inf else math.nan
    return scale if (scale >= magnitude) | (scale != scale) else magnitude


@routine
def note_coarse(function: int, samples: Samples, noted: Noted, coarse: Row) -> None:
    """Mark lanes whose scan is too coarse to find all turning points of a function.

    At every second position the slope is compared with that of the Hermite cubic through both neighbours.

    Parameters
    ----------
    function : int
    samples : Samples
        All functions at the scan positions.
    noted : Noted
        Scratch: rms of the slope, number of intervals in which the function moves, and number of those missed.
    coarse : row
        Set to 1 in those lanes.
    """
    room, q, scale = samples.used[0], in_lanes(samples.place[0]), noted.scale
    rms, moving, missed = noted.steepest, noted.marks, noted.counts
    values, slopes = in_lanes(samples.tile[2 * function]), in_lanes(samples.tile[2 * function + 1])
    for lane in range(LANES):
        rms[lane] = moving[lane] = missed[lane] = scale[lane] = 0.0
    for k in range(room):
        for lane in range(LANES):
            scale[lane] = _scale(values[k, lane], scale[lane])
            rms[lane] += slopes[k, lane] ** 2 / room
    for lane in range(LANES):
        rms[lane] = math.sqrt(rms[lane])
    for i in range((room - 1) // 2):
        k = 2 * i + 1
        for lane in range(LANES):
            before, here, after = slopes[k - 1, lane], slopes[k, lane], slopes[k + 1, lane]
            width = q[k + 1, lane] - q[k - 1, lane]
            t = (q[k, lane] - q[k - 1, lane]) / width
            chord = (values[k + 1, lane] - values[k - 1, lane]) / width
            predicted = 6.0 * t * (1.0 - t) * chord + (1.0 - t) * (1.0 - 3.0 * t) * before + t * (3.0 * t - 2.0) * after
            least = larger(MISSED * rms[lane], STILL * scale[lane] / abs(width))
            moving[lane] += 1.0 if larger(larger(abs(before), abs(here)), abs(after)) > least else 0.0
            missed[lane] += 1.0 if abs(here - predicted) > least else 0.0
    for lane in range(LANES):
        coarse[lane] = 1.0 if missed[lane] > COARSE * moving[lane] else coarse[lane]


@routine
def find_turns(function: int, samples: Samples, most: int, noted: Noted, turns: Roots) -> None:
    """Enter the intervals in which a function turns as new rows of roots.

    Zero counts as positive. NaN and infinite slopes are skipped.

    Parameters
    ----------
    function : int
    samples : Samples
        All functions at the scan positions.
    most : int
        Only the first `most` turning points are entered; more are usually due to rounding.
    noted : Noted
    turns : Roots
    """
    before, q, marks, counts = turns.used[0], in_lanes(samples.place[0]), noted.marks, noted.counts
    values, slopes = in_lanes(samples.tile[2 * function]), in_lanes(samples.tile[2 * function + 1])
    for lane in range(LANES):
        counts[lane] = 0.0
    for k in range(samples.used[0] - 1):
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


@inlined
def _turn_error(root: Root, lane: int, steepest: float) -> float:
    """Error of a turning point's position, from the function's largest slope."""
    bend = abs(root.at_high[lane] - root.at_low[lane]) * FOUND / root.enough[lane]
    return ROUNDING * (steepest / bend)


@inlined
def _distance_if(equal: bool, place: float, at: float, turn: float) -> float:
    """Distance between the positions of equal extremes, less whole turns; 0 if they aren't equal."""
    distance = abs(place - at)
    turns = math.floor(distance / turn + 0.5)
    return (abs(distance - turns * turn) if turns > 0.0 else distance) if equal else 0.0


@inlined
def _note_rival(f: float, place: float, off: float, turn: float, lane: int, found: LandmarkRows) -> None:
    """Extend the error of an extreme's position to another one, with its own error, where the function may be equal."""
    near = 2.0 * (found.value_error[lane] + ROUNDING * found.scale[lane])
    low = _distance_if(f <= found.least[lane] + near, place, found.least_at[lane], turn)
    high = _distance_if(f >= found.greatest[lane] - near, place, found.greatest_at[lane], turn)
    found.least_at_error[lane] = larger(low + off if low > 0.0 else 0.0, found.least_at_error[lane])
    found.greatest_at_error[lane] = larger(high + off if high > 0.0 else 0.0, found.greatest_at_error[lane])


@routine
def find_landmarks(
    function: int, samples: Samples, beside: Samples, turns: Roots, turn: float, steepest: Row, found: LandmarkRows
) -> None:
    """Find the minimum and maximum of a function over the scan positions and its turning points.

    Of turning points that tie, the first is reported, with an error that reaches the others.

    Parameters
    ----------
    function : int
    samples : Samples
        All functions at the scan positions.
    beside : Samples
        Changes of all functions when some of these positions are perturbed by their rounding.
    turns : Roots
    turn : float
        Length after which the crank's position recurs; infinite if the range isn't a cycle.
    steepest : row
        Scratch: maximum of |f′|.
    found : LandmarkRows
        Output.
    """
    last, q = samples.used[0] - 1, in_lanes(samples.place[0])
    values, slopes = in_lanes(samples.tile[2 * function]), in_lanes(samples.tile[2 * function + 1])
    fill(found, _LANDMARKS, 0.0)
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
            found.scale[lane] = _scale(f, scale)
            steepest[lane] = larger(abs(slopes[k, lane]), steepest[lane])
    changes = in_lanes(beside.tile[2 * function])
    for k in range(LOOKED_BESIDE):
        for lane in range(LANES):
            off = OF_ROUNDING * abs(changes[k, lane])
            found.value_error[lane] = larger(off, found.value_error[lane])
    at_turns = in_lanes(turns.at.tile[2 * function])
    for r in range(turns.used[0]):
        if turns.function[r] != function:
            continue
        root = turns.rows[r]
        for lane in range(LANES):
            f, place, off = at_turns[r, lane], root.x[lane], _turn_error(root, lane, steepest[lane])
            near = found.value_error[lane] + ROUNDING * found.scale[lane]
            # A turning point takes precedence over the positions, of which only it has an error estimate.
            lower = f <= found.least[lane] - (near if found.least_at_error[lane] > 0.0 else 0.0)
            higher = f >= found.greatest[lane] + (near if found.greatest_at_error[lane] > 0.0 else 0.0)
            found.least[lane], found.greatest[lane] = smaller(f, found.least[lane]), larger(f, found.greatest[lane])
            found.least_at[lane] = place if lower else found.least_at[lane]
            found.least_at_error[lane] = off if lower else found.least_at_error[lane]
            found.greatest_at[lane] = place if higher else found.greatest_at[lane]
            found.greatest_at_error[lane] = off if higher else found.greatest_at_error[lane]
    for r in range(turns.used[0]):
        if turns.function[r] != function:
            continue
        root = turns.rows[r]
        for lane in range(LANES):
            off = _turn_error(root, lane, steepest[lane])
            _note_rival(at_turns[r, lane], root.x[lane], off, turn, lane, found)
    if turn == math.inf:
        for k in range(0, last + 1, last):
            for lane in range(LANES):
                _note_rival(values[k, lane], q[k, lane], 0.0, turn, lane, found)
    # During a dwell at the extreme, its position may be anywhere in the dwell.
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
    """Classify how f meets a level on a piece: 2 if within rounding at the low end, 1 if it crosses inside, else 0.

    An end within rounding of the level lies on neither side of it.
    """
    here, there = at_low - level, at_high - level
    apart = ((here > near) & (there < -near)) | ((here < -near) & (there > near))
    return 2.0 if abs(here) <= near else (1.0 if apart else 0.0)


@routine
def enter_crossings(piece: MonotonePiece, level: Level, before: int, most: int, noted: Noted, crossings: Roots) -> None:
    """Enter the pieces of f marked by `crosses` as new rows of roots.

    Parameters are those of `find_crossings`, and `before`, the first row of this level.
    """
    marks, counts, height = noted.marks, noted.counts, level.height
    for lane in range(LANES):
        # A function that rests on its level touches it at every position; any surplus of these may be dropped, and they
        # leave half of the rows to crossings.
        row, room = before + int(counts[lane]), counts[lane] < (most if marks[lane] == 1.0 else 0.5 * most)
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
        All functions at the scan positions.
    turns : Roots
    most : int
        Maximum number of roots entered.
    noted : Noted
        Receives the number of roots found.
    crossings : Roots
    """
    before, q, marks, height = crossings.used[0], in_lanes(samples.place[0]), noted.marks, level.height
    values, slopes = in_lanes(samples.tile[2 * level.function]), in_lanes(samples.tile[2 * level.function + 1])
    for lane in range(LANES):
        noted.counts[lane] = 0.0
    for k in range(samples.used[0] - 1):
        for lane in range(LANES):
            mark = crosses(values[k, lane], values[k + 1, lane], height[lane], ROUNDING * level.scale[lane])
            # The function isn't monotone where it turns inside.
            turns_here = (slopes[k, lane] >= 0.0) != (slopes[k + 1, lane] >= 0.0)
            repeated = q[k, lane] == q[k + 1, lane]
            marks[lane] = 0.0 if (turns_here & (mark == 1.0)) | repeated else mark
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
                # A turning point on the level is entered once.
                marks[lane] = 0.0 if (side == 1) & (mark == 2.0) else mark
            enter_crossings(MonotonePiece(root.x, end, at_place, at_end), level, before, most, noted, crossings)


@routine
def lay_edges(crossings: Roots, landmarks: Rows, cut_rows: np.ndarray, block: Rows, walk: Walk, edges: Rows) -> int:
    """Turn roots, and positions in rows of P, into the edges of a walk with error estimates of their positions.

    Returns
    -------
    int
        Number of edges.
    """
    count = crossings.used[0]
    for r in range(count):
        f, root, edge = crossings.function[r], crossings.rows[r], edges[r]
        slopes, value_error = in_lanes(crossings.at.tile[2 * f + 1]), landmarks[f].value_error
        for lane in range(LANES):
            # A level may follow from other landmarks and be as inaccurate as they are.
            off = 2.0 * value_error[lane] / abs(slopes[r, lane])
            edge.place[lane] = walk.direction[lane] * root.x[lane]
            # At a turning point f is flat, which would make the quotient unbounded.
            edge.error[lane] = smaller(off, FLAT * walk.range[lane]) + larger(ROUNDING * abs(root.x[lane]), TINY)
    for i in range(cut_rows.shape[0]):
        edge, places = edges[count + i], block[cut_rows[i]]
        for lane in range(LANES):
            edge.place[lane] = walk.direction[lane] * places[lane]
            edge.error[lane] = larger(ROUNDING * abs(places[lane]), TINY)
    sort_edges(count + cut_rows.shape[0], edges)
    return count + cut_rows.shape[0]


@routine
def store_crossings(crossings: Roots, first: int, found: np.ndarray) -> None:
    """Store the positions of a block's crossings, (crossings, roots, variants)."""
    level, slot = -1, 0
    for r in range(crossings.used[0]):
        # Roots of one level are consecutive.
        slot = slot + 1 if crossings.level[r] == level else 0
        level = crossings.level[r]
        scatter_row(crossings.rows[r].x, first, found[level, slot])


@routine
def sort_edges(count: int, edges: Rows) -> None:
    """Sort each lane's edges by position, then by decreasing error estimate; NaN becomes infinity and goes last.

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
