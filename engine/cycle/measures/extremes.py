"""Minima and maxima over the cycle, also between the positions, with error estimates of values and positions.

The search maximises s (a − c (b − b₀)), s = ±1, for two kept curves a and b and a factor c of each lane; b₀ is the
initial value of b. For a single curve, c = 0.

In each panel, the candidate is the local maximum among the positions next to which the curve may rise highest. Each
lane takes its candidate with the highest bound, finds the polynomial's peak there by Newton's method, confined between
the neighbouring positions, and continues with the next candidate while its bound exceeds the peak found. Panels include
their ends, so a curve that jumps between two panels has an extreme on either side.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import inlined, routine, separate
from engine.compiling.instructions import fused
from engine.compiling.packed import call_at, unpacked
from engine.cycle.panels.chebyshev import COARSE, DEGREE, PLACES
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import any_positive, many, one
from engine.cycle.panels.record import Record, known_slot
from engine.cycle.panels.series import TINY, larger, series_at, series_value, smaller

# Kinds of extremes: minimum, maximum, or minimum magnitude of a curve that keeps its initial sign. EACH_TURN is added
# for a curve that recurs with each turn of the crank.
LEAST, GREATEST, LEAST_MAGNITUDE, EACH_TURN = 1, 2, 4, 8
BOTH = LEAST + GREATEST
# Step or position of no candidate.
NONE = -1.0


class ExtremeRows(NamedTuple):
    """An extreme.

    Attributes
    ----------
    value, value_error : row
    at, at_error : row
        Its position.
    other : row
        b − b₀ there.
    """

    value: Row
    value_error: Row
    at: Row
    at_error: Row
    other: Row


_ROWS = len(ExtremeRows._fields)


class SoughtExtreme(NamedTuple):
    """An extreme to search for: the maximum of s (a − c (b − b₀)).

    Attributes
    ----------
    a, b : int
        Curves of the record; equal for a single curve.
    factor : row
        c; 0 for a single curve.
    sign : row
        s, 1 or −1.
    period : float
        Length after which positions recur; infinite if the range isn't a cycle.
    """

    a: int
    b: int
    factor: Row
    sign: Row
    period: float


class Candidate(NamedTuple):
    """Candidates in the panels of a step.

    Attributes
    ----------
    reach, position : row
        Upper bound of the best candidate, and its index among the positions.
    next_reach : row
        Upper bound of the second best.
    """

    reach: Row
    position: Row
    next_reach: Row


class Climb(NamedTuple):
    """The candidate of each lane and the progress towards its peak.

    Attributes
    ----------
    best : row
        Maximum over all positions.
    taken, step, at_position : row
        Upper bound of the candidate, its step and its index among the positions.
    half, middle : row
        Half length and middle of its panel.
    cut_before, cut_after : row
        Error estimates of the positions of the cuts at the panel's ends.
    beyond_series : row
        Remainder beyond the series in the panel.
    bent : row
        1 if the panel has a kink, else 0.
    low, high : row
        Bracket of Newton's method.
    x, length : row
        Current estimate on [−1, 1], and length of the last step.
    start : row
        Value at the candidate's position.
    top, top_bend : row
        Value and second derivative at the peak.
    here, slope, bend : row
        Value, first and second derivative at `x`.
    mark : row
        Scratch.
    range : row
        Length of the range.
    """

    best: Row
    taken: Row
    step: Row
    at_position: Row
    half: Row
    middle: Row
    cut_before: Row
    cut_after: Row
    beyond_series: Row
    bent: Row
    low: Row
    high: Row
    x: Row
    length: Row
    start: Row
    top: Row
    top_bend: Row
    here: Row
    slope: Row
    bend: Row
    mark: Row
    range: Row


class Search(NamedTuple):
    """Arrays for a search.

    Attributes
    ----------
    candidates : many Candidate
        One for each step.
    series, other_series : rows (POSITIONS, LANES)
        Coefficients of the curve searched and of b, in the panel of each lane's candidate.
    climb : Climb
    zero, up, down : row
        0, 1 and −1 in all lanes.
    finder : int
        Address of `find_in_record`, which several measures call.
    """

    candidates: many(Candidate)
    series: Rows
    other_series: Rows
    climb: one(Climb)
    zero: Row
    up: Row
    down: Row
    finder: int


def _beyond(degree: int) -> tuple[np.ndarray, np.ndarray]:
    """Bound of a curve's rise above a position, as fractions of its fall to the left and right neighbours.

    The bound is twice the rise of the parabola through the three points. With distances g and h to the neighbours, and
    the neighbour at h as high as the position, the parabola rises by h²/(4 g (g + h)) of the fall to the one at g. At
    an end of a panel, the fall from the neighbour to the next position replaces the missing one, with the fraction
    g²/(4 h (g + h)).
    """
    gap = np.diff(PLACES[:: DEGREE // degree])
    g, h = gap[:-1], gap[1:]
    left, right = np.zeros(degree + 1), np.zeros(degree + 1)
    left[1:-1], right[1:-1] = h**2 / (g * (g + h)), g**2 / (h * (g + h))
    left[0] = right[-1] = gap[0] ** 2 / (gap[1] * (gap[0] + gap[1]))
    return 0.5 * left, 0.5 * right


_LEFT, _RIGHT = _beyond(DEGREE)
_COARSE_LEFT, _COARSE_RIGHT = _beyond(COARSE)
# Last Newton step, as a fraction of half the panel; the remaining error is its square.
FOUND = 1e-5
MOST_TOPS, MOST_STEPS = 8, 40
# Rounding of values affects slopes as 1/√(1 − x²), which is limited near the ends of a panel.
STEEPEST = 0.05


@inlined
def combined(of_a: Rows, of_b: Rows, factor: float, sign: float, j: int, lane: int) -> float:
    """Value of s (a − c b) at a position."""
    return sign * of_a[j, lane] - (sign * factor) * of_b[j, lane]


@routine
def scan(record: Record, sought: SoughtExtreme, step: int, candidate: Candidate, search: Climb) -> None:
    """Find the candidates in the panels of a step, and update the maximum over all positions."""
    if record.degree == DEGREE:
        _scan(record, DEGREE, (_LEFT, _RIGHT), sought, step, candidate, search)
    else:
        _scan(record, COARSE, (_COARSE_LEFT, _COARSE_RIGHT), sought, step, candidate, search)


@inlined
def _scan(
    record: Record,
    degree: int,
    rises: tuple[np.ndarray, np.ndarray],
    sought: SoughtExtreme,
    step: int,
    candidate: Candidate,
    search: Climb,
) -> None:
    left, right = rises
    slot, base, half = step * record.curves, record.whole[sought.b].first, record.panels[step].half
    of_a, of_b = record.values[slot + sought.a], record.values[slot + sought.b]
    for lane in range(LANES):
        c, s = sought.factor[lane], sought.sign[lane]
        here, after = combined(of_a, of_b, c, s, 0, lane), combined(of_a, of_b, c, s, 1, lane)
        fall = larger(after - combined(of_a, of_b, c, s, 2, lane), 0.0)
        best, reach, next_reach, position = here, -math.inf, -math.inf, NONE
        # Two loops, each short enough for the compiler to unroll.
        for j in range(degree // 2):
            after = combined(of_a, of_b, c, s, j + 1, lane)
            rise = here - after
            mine = here + (left[j] * fall + right[j] * rise) if (fall >= 0.0) & (rise >= 0.0) else -math.inf
            next_reach = larger(smaller(mine, reach), next_reach)
            position = float(j) if mine > reach else position
            best, reach, here, fall = larger(after, best), larger(mine, reach), after, -rise
        for j in range(degree // 2, degree):
            after = combined(of_a, of_b, c, s, j + 1, lane)
            rise = here - after
            mine = here + (left[j] * fall + right[j] * rise) if (fall >= 0.0) & (rise >= 0.0) else -math.inf
            next_reach = larger(smaller(mine, reach), next_reach)
            position = float(j) if mine > reach else position
            best, reach, here, fall = larger(after, best), larger(mine, reach), after, -rise
        rise = larger(here - fall - combined(of_a, of_b, c, s, degree - 2, lane), 0.0)
        mine = here + right[degree] * rise if fall >= 0.0 else -math.inf
        next_reach = larger(smaller(mine, reach), next_reach)
        position, reach = float(degree) if mine > reach else position, larger(mine, reach)
        taken, shift = half[lane] != 0.0, s * c * base[lane]
        candidate.reach[lane] = reach + shift if taken else -math.inf
        candidate.next_reach[lane] = next_reach + shift if taken else -math.inf
        candidate.position[lane] = position
        search.best[lane] = larger(best + shift, search.best[lane]) if taken else search.best[lane]
        search.range[lane] += 2.0 * abs(half[lane])


@routine
def take_farthest(steps: int, candidates: Rows, search: Climb, found: ExtremeRows) -> bool:
    """Take each lane's candidate with the highest bound; returns whether any bound is high enough to be tried."""
    for lane in range(LANES):
        search.taken[lane], search.step[lane] = -math.inf, NONE
    for step in range(steps):
        reach = candidates[step].reach
        for lane in range(LANES):
            farther = reach[lane] > search.taken[lane]
            search.taken[lane] = reach[lane] if farther else search.taken[lane]
            search.step[lane] = float(step) if farther else search.step[lane]
    for lane in range(LANES):
        # A candidate that may equal the extreme found is its rival.
        reach = search.taken[lane] + found.value_error[lane]
        enough = (reach >= search.best[lane]) & (reach > found.value[lane])
        search.step[lane] = search.step[lane] if enough else NONE
        search.mark[lane] = 1.0 if enough else 0.0
    return any_positive(search.mark)


@routine
def leave_next(
    of_a: Rows, of_b: Rows, degree: int, sought: SoughtExtreme, lane: int, candidate: Candidate, search: Climb
) -> None:
    """After a lane's best candidate of a step is taken, promote the second best; no third is known."""
    c, s = sought.factor[lane], sought.sign[lane]
    left, right = (_LEFT, _RIGHT) if degree == DEGREE else (_COARSE_LEFT, _COARSE_RIGHT)
    reach, position, done = -math.inf, NONE, int(search.at_position[lane])
    for j in range(degree + 1):
        # At an end of the panel, use the fall from the neighbour to the next position.
        inner = 1 if j == 0 else j
        fall = combined(of_a, of_b, c, s, inner, lane) - combined(of_a, of_b, c, s, 2 if j == 0 else j - 1, lane)
        inner = degree - 1 if j == degree else j
        rise = combined(of_a, of_b, c, s, inner, lane)
        rise -= combined(of_a, of_b, c, s, degree - 2 if j == degree else j + 1, lane)
        fall, rise = max(fall, 0.0) if j == 0 else fall, max(rise, 0.0) if j == degree else rise
        mine = combined(of_a, of_b, c, s, j, lane) + (left[j] * fall + right[j] * rise)
        if j != done and fall >= 0.0 and rise >= 0.0 and mine > reach:
            reach, position = mine, float(j)
    candidate.reach[lane], candidate.position[lane] = candidate.next_reach[lane], position
    candidate.next_reach[lane] = -math.inf


@routine
def fetch(record: Record, sought: SoughtExtreme, work: Search) -> None:
    """Copy the panel and series of each lane's candidate to the search, and remove the candidate."""
    search, series, other, base = work.climb, work.series, work.other_series, record.whole[sought.b].first
    for lane in range(LANES):
        if search.step[lane] < 0.0:
            continue
        step, c, s = int(search.step[lane]), sought.factor[lane], sought.sign[lane]
        slot_a, slot_b = known_slot(record, sought.a, step), known_slot(record, sought.b, step)
        of_a, of_b = record.coefficients[slot_a], record.coefficients[slot_b]
        if sought.a == sought.b:
            for k in range(record.degree + 1):
                series[k, lane] = s * of_a[k, lane]
        else:
            for k in range(record.degree + 1):
                other[k, lane] = of_b[k, lane]
                series[k, lane] = s * (of_a[k, lane] - c * of_b[k, lane])
        # Rounded in the same way in any surrounding code.
        series[0, lane] = fused(s, s * series[0, lane], s * c * base[lane])
        panels, candidate = record.panels[step], work.candidates[step]
        search.beyond_series[lane] = record.left[slot_a].tail[lane] + abs(c) * record.left[slot_b].tail[lane]
        search.half[lane], search.middle[lane] = panels.half[lane], panels.middle[lane]
        search.bent[lane] = panels.bent[lane]
        search.cut_before[lane], search.cut_after[lane] = panels.opened[lane], panels.closed[lane]
        search.at_position[lane] = candidate.position[lane]
        candidate.reach[lane] = -math.inf
        if candidate.next_reach[lane] > search.best[lane]:
            values_a, values_b = record.values[slot_a], record.values[slot_b]
            leave_next(values_a, values_b, record.degree, sought, lane, candidate, search)


@routine
def evaluate(series: Rows, search: Climb) -> None:
    """Evaluate a series and its first two derivatives at each lane's x."""
    for lane in range(LANES):
        search.here[lane], search.slope[lane], search.bend[lane] = series_at(series, lane, search.x[lane])


@routine
def improve(search: Climb) -> bool:
    """Move each lane by a Newton step towards the peak, or bisect where that leaves the bracket; converged lanes stay.

    Returns
    -------
    bool
        Whether any lane hasn't converged.
    """
    for lane in range(LANES):
        x, slope, bend = search.x[lane], search.slope[lane], search.bend[lane]
        low = x if slope > 0.0 else search.low[lane]
        high = search.high[lane] if slope > 0.0 else x
        ahead = x - slope / bend
        ahead = ahead if (bend < 0.0) & (ahead >= low) & (ahead <= high) else 0.5 * (low + high)
        converged, step, length = not search.length[lane] > FOUND, ahead - x, search.length[lane]
        top, top_ahead = search.top[lane], search.here[lane] + step * (slope + 0.5 * bend * step)
        bend_before = search.top_bend[lane]
        search.top[lane], search.top_bend[lane] = top if converged else top_ahead, bend_before if converged else bend
        search.length[lane] = length if converged else abs(step)
        search.x[lane] = x if converged else ahead
        search.low[lane], search.high[lane] = low, high
        search.mark[lane] = 1.0 if search.length[lane] > FOUND else 0.0
    return any_positive(search.mark)


@routine
def climb(series: Rows, degree: int, search: Climb) -> None:
    """Climb from the candidates' positions to the peaks next to them."""
    stride = DEGREE // degree
    for lane in range(LANES):
        taken = search.step[lane] >= 0.0
        j = int(search.at_position[lane]) if taken else 0
        search.x[lane], search.length[lane] = PLACES[stride * j], 2.0 if taken else 0.0
        search.low[lane], search.high[lane] = PLACES[stride * max(j - 1, 0)], PLACES[stride * min(j + 1, degree)]
    evaluate(series, search)
    for lane in range(LANES):
        search.start[lane] = search.top[lane] = search.here[lane]
        search.top_bend[lane] = search.bend[lane]
    for _ in range(MOST_STEPS):
        if not improve(search):
            break
        evaluate(series, search)


@routine
def compare(record: Record, sought: SoughtExtreme, work: Search, found: ExtremeRows) -> None:
    """Update each lane's extreme if the new peak is higher, and its error estimates if the two may be equal."""
    a, b, search = record.whole[sought.a], record.whole[sought.b], work.climb
    for lane in range(LANES):
        weight, tail = abs(sought.factor[lane]), search.beyond_series[lane]
        noise = ROUNDING * (a.scale[lane] + weight * b.scale[lane])
        offset = a.offset[lane] + weight * b.offset[lane]
        start, top, x = search.start[lane], search.top[lane], search.x[lane]
        half, middle = search.half[lane], search.middle[lane]
        # A rise above the position within rounding isn't significant.
        value, place = top if top > start + noise else start, middle + half * x
        # Between the positions, coefficient n + m leaves an error of 2 |sin nθ sin mθ| times it, where x = cos θ.
        cosine = 2.0 * x * x - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        cosine = 2.0 * cosine * cosine - 1.0 if record.degree == DEGREE else cosine
        # Near a kink the curve leaves the series at the positions, too.
        beyond = larger(math.sqrt(larger(1.0 - cosine * cosine, 0.0)), search.bent[lane])
        value_error = noise + offset + 2.0 * tail * beyond
        # An extreme at a cut shares the error of the cut's position.
        cut = search.cut_before[lane] if x <= -1.0 else (search.cut_after[lane] if x >= 1.0 else 0.0)
        value_error += cut * abs(search.slope[lane] / half)
        across = larger(math.sqrt(larger(1.0 - x * x, 0.0)), STEEPEST)
        bend, of_slope = larger(-search.top_bend[lane], TINY), 2.0 * record.degree * tail / across
        # At a position, too, the curve is flat only as far as its slope is known, and may rise next to it.
        flat = (abs(x) < 1.0) | (abs(search.slope[lane]) <= of_slope)
        value_error += smaller(0.5 * of_slope * of_slope / bend, 2.0 * tail) if flat else 0.0
        x_error = (2.0 * record.degree * tail + 8.0 * (noise + offset) / across) / bend
        x_error += search.length[lane] * search.length[lane]
        place_error = ROUNDING * abs(place) + (abs(half) * smaller(x_error, 1.0) if abs(x) < 1.0 else cut)
        # Of two equal peaks, either may be the extreme; where the cycle closes, they may be neighbours.
        before, at_before = found.value[lane], found.at[lane]
        taken = search.step[lane] >= 0.0
        higher = taken & (value > before)
        distance_apart = abs(value - before)
        rivals = taken & (distance_apart <= value_error + found.value_error[lane])
        # Report the position of the first; the second may still be the higher one.
        first = (higher & (not rivals)) | (rivals & ((place - at_before) * half < 0.0))
        kept_error = place_error if first else found.at_error[lane]
        other_error = found.at_error[lane] if first else place_error
        own_error = value_error if higher else found.value_error[lane]
        rival_error = (found.value_error[lane] if higher else value_error) - distance_apart
        distance = abs(place - at_before)
        periods = math.floor(distance / sought.period + 0.5)
        apart = other_error + (abs(distance - periods * sought.period) if periods > 0.0 else distance)
        found.value[lane] = value if higher else before
        found.value_error[lane] = larger(rival_error, own_error) if rivals else own_error
        found.at[lane] = place if first else at_before
        found.at_error[lane] = larger(kept_error, apart) if rivals else kept_error
        found.other[lane] = search.here[lane] - b.first[lane] if higher else found.other[lane]


@inlined
def find_extreme(record: Record, sought: SoughtExtreme, work: Search, found: ExtremeRows) -> None:
    """Find the maximum (sign 1) or minimum (−1) of a − c (b − b₀) over each lane's cycle.

    Parameters
    ----------
    record : Record
        Packed.
    sought : SoughtExtreme
    work : Search
        Scratch.
    found : ExtremeRows
        Output; NaN if any value is NaN or infinite.
    """
    call_at(work.finder, (record, sought, work, found))


@separate
def find_in_record(packed: Record, sought: SoughtExtreme, work: Search, found: ExtremeRows) -> None:
    """Do what `find_extreme` states."""
    record = unpacked(packed)
    search, candidates, steps = work.climb, work.candidates, record.steps[0]
    scale_a, scale_b = record.whole[sought.a].scale, record.whole[sought.b].scale
    for lane in range(LANES):
        search.best[lane] = found.value[lane] = -math.inf
        search.range[lane] = 0.0
        found.value_error[lane] = found.at[lane] = found.at_error[lane] = found.other[lane] = 0.0
    for step in range(steps):
        scan(record, sought, step, candidates[step], search)
    for _ in range(MOST_TOPS):
        if not take_farthest(steps, candidates, search, found):
            break
        fetch(record, sought, work)
        climb(work.series, record.degree, search)
        for lane in range(LANES):
            alone = sought.a == sought.b
            search.here[lane] = 0.0 if alone else series_value(work.other_series, lane, search.x[lane])
        compare(record, sought, work, found)
    left = take_farthest(steps, candidates, search, found)
    for lane in range(LANES):
        missed = left & (search.step[lane] >= 0.0)
        beyond = search.taken[lane] - found.value[lane] if missed else 0.0
        found.value_error[lane] = larger(found.value_error[lane], beyond)
        # With this many rivals left, the extreme may be anywhere.
        found.at_error[lane] += search.range[lane] if missed else 0.0
        # A NaN or infinite value shows in the curves' scales.
        unknown = not abs(found.value[lane]) + scale_a[lane] + scale_b[lane] < math.inf
        found.value[lane] = sought.sign[lane] * found.value[lane]
        for part in range(_ROWS):
            found[part, lane] = math.nan if unknown else found[part, lane]
