"""Scan positions added where a function may turn more often than its slopes at neighbouring scan positions show.

Between two scan positions a slope is approximated by that of the Hermite cubic through both. A function may turn twice
between slopes of one sign if the approximation has an extreme close to 0, and three times between slopes of opposite
signs if the slope is flat at its zero, compared with the approximation's chord or its neighbours. Such an interval is
divided at that extreme or zero, and its parts are judged likewise.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, Rows, in_lanes
from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import any_positive, many, new_record, one
from engine.cycle.panels.series import larger, smaller
from engine.cycle.roots import GivenNumbers, Samples, new_samples, sample

# A slope's extreme is close to 0 if it is below this fraction of the larger slope at the ends.
CLOSE = 0.1
# A slope is flat at its zero if its derivative there, times the interval, is below this fraction of its change over the
# interval, or if that change is below this fraction of the change over an adjacent interval of the same length.
FLAT = 0.75
# Let c be the change of the slope over an adjacent interval of the same length. Between slopes of one sign the
# approximation may miss an extreme if the slope changes by less than EVEN · c over the interval, and is below SMALL · c
# at an end.
EVEN, SMALL = 0.3, 0.1
# How far outside its interval the extreme of an approximation may lie, as a fraction of the interval.
OUTSIDE = 0.1
# Positions divide an interval no closer to its ends than this fraction.
EDGE = 0.1
# Intervals shorter than this fraction of the range aren't divided: what turns twice there changes by rounding only.
SHORTEST = 2e-5
# Slopes up to this fraction of the steepest are rounding.
STILL = 64.0 * ROUNDING
# Room for added positions, as a multiple of the scan positions.
ADDED = 2
# Most suspected intervals of a function at once, and most divisions one after another.
MOST_SUSPECTS, MOST_DIVISIONS = 16, 60


class Suspect(NamedTuple):
    """An interval in which a function may turn more often than its slopes at the ends show.

    Attributes
    ----------
    low, high : row
        Its ends; NaN if a lane has none.
    f_low, f_high, slope_low, slope_high : row
        The function and its slope at the ends.
    before, after : row
        Change of the slope per length on either side of the interval.
    at : row
        Position that divides it.
    """

    low: Row
    high: Row
    f_low: Row
    f_high: Row
    slope_low: Row
    slope_high: Row
    before: Row
    after: Row
    at: Row


_PARTS = len(Suspect._fields)


class End(NamedTuple):
    """An end of an interval.

    Attributes
    ----------
    q, f, slope : float
        Its position, and a function and its slope there.
    beside : float
        Change of the slope per length beyond it.
    """

    q: float
    f: float
    slope: float
    beside: float


class SlopeInside(NamedTuple):
    """The approximation of the slope inside an interval, first + linear x + …, 0 ≤ x ≤ 1.

    Attributes
    ----------
    first, last : float
        The slope at both ends.
    linear : float
    square_at_zero : float
        Square of its derivative where it is 0; 0 if it isn't 0 anywhere.
    inside : float
        The x at which it is extreme, or the nearest end.
    dips : bool
        Whether that extreme is close to 0.
    opposite : bool
        Whether the slopes at the ends have opposite signs.
    """

    first: float
    last: float
    linear: float
    square_at_zero: float
    inside: float
    dips: bool
    opposite: bool


class IntervalMarks(NamedTuple):
    """Scratch rows of the search.

    Attributes
    ----------
    suspected : row
        1 if an interval is suspected, else 0.
    left, here, right : row
        Change of the slope per length before it, in it and after it.
    found : row
        Number of suspected intervals.
    steepest : row
        Maximum of |f′|.
    used, used_before : row
        Number of scan positions, with and without those added for one function.
    """

    suspected: Row
    left: Row
    here: Row
    right: Row
    found: Row
    steepest: Row
    used: Row
    used_before: Row


class CloseTurns(NamedTuple):
    """Scratch arrays of the search.

    Attributes
    ----------
    suspects, parts : many Suspect
        Suspected intervals, and suspected parts of these.
    marks : one IntervalMarks
    at : Samples
        All functions where the intervals are divided.
    order, sorted : ndarray (positions,)
        Order of a lane's positions, and a row of its samples in that order.
    """

    suspects: many(Suspect)
    parts: many(Suspect)
    marks: one(IntervalMarks)
    at: Samples
    order: np.ndarray
    sorted: np.ndarray


def new_close_turns(outputs: int, positions: int) -> CloseTurns:
    """Allocate the scratch arrays for an `events` function with `outputs` rows and `positions` scan positions."""
    at, order = new_samples(outputs, MOST_SUSPECTS), np.zeros(positions, np.int64)
    found = {"suspects": MOST_SUSPECTS, "parts": MOST_SUSPECTS, "at": at, "order": order}
    return new_record(CloseTurns, **found, sorted=np.zeros(positions))


@inlined
def _approximated(low: End, high: End) -> SlopeInside:
    """The slope's approximation, with the sign that makes the slope at the low end positive."""
    sign = 1.0 if low.slope >= 0.0 else -1.0
    first, last, chord = sign * low.slope, sign * high.slope, sign * (high.f - low.f) / (high.q - low.q)
    linear, square = 6.0 * chord - 4.0 * first - 2.0 * last, 3.0 * (first + last) - 6.0 * chord
    extreme = -0.5 * linear / square
    inside = smaller(larger(extreme, 0.0), 1.0)
    close = first + inside * (linear + square * inside) < CLOSE * larger(first, last)
    dips = (square > 0.0) & (extreme > -OUTSIDE) & (extreme < 1.0 + OUTSIDE) & close
    opposite = (low.slope >= 0.0) != (high.slope >= 0.0)
    return SlopeInside(first, last, linear, larger(linear * linear - 4.0 * first * square, 0.0), inside, dips, opposite)


@inlined
def is_suspected(low: End, high: End) -> bool:
    """Whether a function may turn more often in an interval than the slopes at its ends show."""
    slope, beside = _approximated(low, high), abs(high.q - low.q) * larger(low.beside, high.beside)
    change = slope.first - slope.last
    even = (abs(change) < EVEN * beside) & (smaller(slope.first, slope.last) < SMALL * beside)
    flat = (slope.square_at_zero < (FLAT * change) ** 2) | (change < FLAT * beside)
    return flat if slope.opposite else slope.dips | even


@routine
def _enter(low: End, high: End, lane: int, turns: CloseTurns) -> None:
    """Enter a suspected interval of a lane as one of `parts`."""
    row = int(turns.marks.found[lane])
    if row < MOST_SUSPECTS:
        slope, part = _approximated(low, high), turns.parts[row]
        at_zero = 2.0 * slope.first / (math.sqrt(slope.square_at_zero) - slope.linear)
        share = at_zero if slope.opposite else (slope.inside if slope.dips else 0.5)
        share = smaller(larger(share, EDGE), 1.0 - EDGE)
        part.low[lane], part.f_low[lane], part.slope_low[lane] = low.q, low.f, low.slope
        part.high[lane], part.f_high[lane], part.slope_high[lane] = high.q, high.f, high.slope
        part.before[lane], part.after[lane] = low.beside, high.beside
        part.at[lane] = low.q + share * (high.q - low.q)
        turns.marks.found[lane] += 1.0


@routine
def _change_of_slope(k: int, last: int, q: Rows, slopes: Rows, change: Row) -> None:
    """Compute the change of the slope per length after scan position k; 0 if the next one coincides, or k is last."""
    after = min(k + 1, last)
    for lane in range(LANES):
        width = q[after, lane] - q[k, lane]
        change[lane] = abs((slopes[after, lane] - slopes[k, lane]) / width) if width != 0.0 else 0.0


@routine
def begin_suspects(function: int, samples: Samples, turns: CloseTurns) -> None:
    """Enter the suspected intervals between scan positions as `parts`."""
    q, marks, last = in_lanes(samples.place[0]), turns.marks, samples.used[0] - 1
    values, slopes = in_lanes(samples.tile[2 * function]), in_lanes(samples.tile[2 * function + 1])
    for lane in range(LANES):
        marks.found[lane] = marks.steepest[lane] = marks.here[lane] = 0.0
    for k in range(last + 1):
        for lane in range(LANES):
            marks.steepest[lane] = larger(abs(slopes[k, lane]), marks.steepest[lane])
    _change_of_slope(0, last, q, slopes, marks.right)
    for k in range(last):
        for lane in range(LANES):
            marks.left[lane], marks.here[lane] = marks.here[lane], marks.right[lane]
        _change_of_slope(k + 1, last, q, slopes, marks.right)
        for lane in range(LANES):
            low = End(q[k, lane], values[k, lane], slopes[k, lane], marks.left[lane])
            high = End(q[k + 1, lane], values[k + 1, lane], slopes[k + 1, lane], marks.right[lane])
            moves = larger(abs(low.slope), abs(high.slope)) > STILL * marks.steepest[lane]
            marks.suspected[lane] = 1.0 if moves & is_suspected(low, high) else 0.0
        if any_positive(marks.suspected):
            for lane in range(LANES):
                if marks.suspected[lane] > 0.0:
                    low = End(q[k, lane], values[k, lane], slopes[k, lane], marks.left[lane])
                    high = End(q[k + 1, lane], values[k + 1, lane], slopes[k + 1, lane], marks.right[lane])
                    _enter(low, high, lane, turns)


@inlined
def _append(at: float, row: int, lane: int, samples: Samples, turns: CloseTurns) -> None:
    """Append a position of `turns.at` to a lane's scan positions."""
    k = int(turns.marks.used[lane])
    samples.place[0, k, lane] = at
    for f in range(samples.tile.shape[0]):
        samples.tile[f, k, lane] = turns.at.tile[f, row, lane]
    turns.marks.used[lane] += 1.0


@routine
def sort_added(first: int, lane: int, samples: Samples, turns: CloseTurns) -> None:
    """Sort a lane's scan positions, of which those from `first` on were added."""
    q, order, count = in_lanes(samples.place[0]), turns.order, int(turns.marks.used[lane])
    run = 1.0 if q[0, lane] < q[1, lane] else -1.0
    for k in range(count):
        i = k
        while k >= first and i > 0 and run * q[order[i - 1], lane] > run * q[k, lane]:
            order[i] = order[i - 1]
            i -= 1
        order[i] = k
    permute(count, lane, q, turns)
    for f in range(samples.tile.shape[0]):
        permute(count, lane, in_lanes(samples.tile[f]), turns)


@routine
def permute(count: int, lane: int, column: Rows, turns: CloseTurns) -> None:
    """Put a lane's first `count` numbers into the order found."""
    for k in range(count):
        turns.sorted[k] = column[turns.order[k], lane]
    for k in range(count):
        column[k, lane] = turns.sorted[k]


@routine
def divide(function: int, rows: int, range_of: Row, samples: Samples, turns: CloseTurns) -> None:
    """Judge both parts of each suspected interval; add the position between them to the scan if need be."""
    values, slopes = in_lanes(turns.at.tile[2 * function]), in_lanes(turns.at.tile[2 * function + 1])
    room, marks = samples.tile.shape[1], turns.marks
    for row in range(rows):
        suspect = turns.suspects[row]
        for lane in range(LANES):
            at, f, slope = suspect.at[lane], values[row, lane], slopes[row, lane]
            if not abs(at) + abs(f) + abs(slope) < math.inf or marks.used[lane] >= room:
                continue
            low = End(suspect.low[lane], suspect.f_low[lane], suspect.slope_low[lane], suspect.before[lane])
            high = End(suspect.high[lane], suspect.f_high[lane], suspect.slope_high[lane], suspect.after[lane])
            at_low = End(at, f, slope, abs((high.slope - slope) / (high.q - at)))
            at_high = End(at, f, slope, abs((slope - low.slope) / (at - low.q)))
            suspected_low, suspected_high = is_suspected(low, at_low), is_suspected(at_high, high)
            turned = ((low.slope >= 0.0) == (high.slope >= 0.0)) & ((slope >= 0.0) != (low.slope >= 0.0))
            if turned | suspected_low | suspected_high:
                _append(at, row, lane, samples, turns)
                if abs(high.q - low.q) > SHORTEST * abs(range_of[lane]):
                    if suspected_low:
                        _enter(low, at_low, lane, turns)
                    if suspected_high:
                        _enter(at_high, high, lane, turns)


@routine
def add_close_turns(
    function: int, events: Callable, given: GivenNumbers, range_of: Row, samples: Samples, turns: CloseTurns
) -> None:
    """Add scan positions near close turns of a function.

    Parameters
    ----------
    function : int
    events : callable
        Fills each function and its derivative.
    given : GivenNumbers
        Arguments of `events`.
    range_of : row
        Length of the range.
    samples : Samples
        All functions at the scan positions. Lanes with fewer positions than others repeat their last one.
    turns : CloseTurns
    """
    marks = turns.marks
    for lane in range(LANES):
        marks.used_before[lane] = marks.used[lane]
    begin_suspects(function, samples, turns)
    for _ in range(MOST_DIVISIONS):
        if not any_positive(marks.found):
            break
        rows = 0
        for lane in range(LANES):
            rows = max(rows, int(marks.found[lane]))
        for row in range(rows):
            for part in range(_PARTS):
                for lane in range(LANES):
                    known = marks.found[lane] > row
                    turns.suspects[row, part, lane] = turns.parts[row, part, lane] if known else math.nan
        q, suspects = in_lanes(turns.at.place[0]), turns.suspects
        for row in range(rows):
            for lane in range(LANES):
                q[row, lane] = suspects[row].at[lane]
        for lane in range(LANES):
            marks.found[lane] = 0.0
        sample(events, given, rows, turns.at)
        divide(function, rows, range_of, samples, turns)
    for lane in range(LANES):
        first = int(marks.used_before[lane])
        if marks.used[lane] > first:
            sort_added(first, lane, samples, turns)
    repeat_last(samples, marks.used)


@routine
def repeat_last(samples: Samples, used: Row) -> None:
    """Repeat each lane's last scan position up to the number of positions of the lane that has most."""
    q, most = in_lanes(samples.place[0]), 0
    for lane in range(LANES):
        most = max(most, int(used[lane]))
    for k in range(samples.used[0], most):
        for lane in range(LANES):
            if k >= used[lane]:
                q[k, lane] = q[k - 1, lane]
                for f in range(samples.tile.shape[0]):
                    samples.tile[f, k, lane] = samples.tile[f, k - 1, lane]
    samples.used[0] = most


@routine
def begin_close_turns(count: int, samples: Samples, turns: CloseTurns) -> None:
    """Begin with `count` scan positions in all lanes."""
    samples.used[0] = count
    for lane in range(LANES):
        turns.marks.used[lane] = count
