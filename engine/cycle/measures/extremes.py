"""Greatest and least values over the cycle, between the positions too, with their places and what both may be off by.

Looked for is the greatest value of s (a − c (b − b₀)), s = ±1, of two kept curves a and b with a factor c of each
lane's own; b₀ is the value of b at the first position. Of a single curve, c = 0.

In each panel, the position that its neighbours don't exceed and beside which the curve may reach farthest is a
candidate. Of its candidates each lane takes the one that may reach farthest, finds the top of the polynomial there by
Newton's method, kept between the neighbours, and goes on with the next for as long as that may reach beyond what it
has found. Panels include their ends, so a curve that jumps from one to the next has its extremes on either side.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, MIDDLE, PLACES, POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import Memory, any_positive, memory
from engine.cycle.panels.record import CLOSED, FIRST, HALF, OFFSET, OPENED, SCALE, TAIL, Record, known_slot
from engine.cycle.panels.record import MIDDLE as PANEL_MIDDLE
from engine.cycle.panels.series import TINY, larger, smaller

# Rows of an extreme: its value, its place, what they may be off by, b − b₀ there.
VALUE, VALUE_ERROR, AT, AT_ERROR, OTHER = range(5)
EXTREME = 5
# What is looked for: both, one of them, or the least magnitude of a curve that keeps the sign of its first value; of
# what follows a link, whose place is meant within a turn of the crank, in addition EACH_TURN.
LEAST, GREATEST, LEAST_MAGNITUDE, EACH_TURN = 1, 2, 4, 8
BOTH = LEAST + GREATEST
# Rows of a step's candidates: how far the best may reach, its position, how far the next best may.
REACH, POSITION, NEXT_REACH = range(3)
CANDIDATE = 3
of_candidates = memory(CANDIDATE, LANES)
# Rows of a search: greatest value at any position; the candidate taken, with its STEP, its position, HALF and MIDDLE of
# its panel, what the cuts at its ends are off by, what lies beyond the series there.
BEST, TAKEN, STEP, AT_POSITION, PANEL_HALF, PANEL_CENTRE, BEYOND_SERIES = range(7)
CUT_BEFORE, CUT_AFTER = range(19, 21)
# The interval in which Newton's method is at X, LENGTH of its last step; value at the position, value and bend at the
# top; value, slope and bend at X; a MARK.
LOW, HIGH, X, LENGTH, START, TOP, TOP_BEND, HERE, SLOPE, BEND, MARK = range(7, 18)
# After which length positions are the same again; infinite where the range is no cycle.
PERIOD = 18
SEARCH = 21
# Of no candidate.
NONE = -1.0


def _beyond() -> tuple[np.ndarray, np.ndarray]:
    """How far a curve may go beyond a position, as shares of how far it falls to its neighbours on either side.

    Twice what a parabola through the three may: with distances g and h to the neighbours, at equal heights of the
    position and the neighbour at h, it rises by h²/(4 g (g + h)) of the fall to that at g. At an end of a panel, where
    the fall from the neighbour to the next but one takes the place of that on the outside, by g²/(4 h (g + h)) of it.
    """
    gap = np.diff(PLACES)
    g, h = gap[:-1], gap[1:]
    left, right = np.zeros(POSITIONS), np.zeros(POSITIONS)
    left[1:-1], right[1:-1] = h**2 / (g * (g + h)), g**2 / (h * (g + h))
    left[0] = right[-1] = gap[0] ** 2 / (gap[1] * (gap[0] + gap[1]))
    return 0.5 * left, 0.5 * right


LEFT, RIGHT = _beyond()
# The last of Newton's steps, as a share of half the panel: it leaves the square of this.
FOUND = 1e-5
MOST_TOPS, MOST_STEPS = 8, 40
# Rounding of values tells on slopes as 1/√(1 − x²), but at the ends of a panel.
STEEPEST = 0.05


class Search(NamedTuple):
    """Memory for a search.

    Attributes
    ----------
    candidates : rows (steps, CANDIDATE, LANES)
    series, other_series : rows (POSITIONS, LANES)
        Coefficients of what is searched and of b, in the panel of each lane's candidate.
    rows : rows (SEARCH, LANES)
    """

    candidates: Memory
    series: Memory
    other_series: Memory
    rows: Memory


@inlined
def combined(values: Memory, a: int, b: int, factor: float, sign: float, j: int, lane: int) -> float:
    """Value of s (a − c b) at a position, from the slots of a and b."""
    return sign * values[a, j, lane] - (sign * factor) * values[b, j, lane]


@routine
def scan(
    values: Memory,
    a: int,
    b: int,
    factor: Memory,
    base: Memory,
    sign: Memory,
    panels: Memory,
    step: int,
    candidates: Memory,
    search: Memory,
) -> None:
    """Candidates in the panels of a step; widen the greatest value by those there."""
    for lane in range(LANES):
        here, after = (
            combined(values, a, b, factor[lane], sign[lane], 0, lane),
            combined(values, a, b, factor[lane], sign[lane], 1, lane),
        )
        fall = larger(after - combined(values, a, b, factor[lane], sign[lane], 2, lane), 0.0)
        best, reach, next_reach, position = here, -math.inf, -math.inf, NONE
        # In two, each short enough to be unrolled.
        for j in range(MIDDLE):
            after = combined(values, a, b, factor[lane], sign[lane], j + 1, lane)
            rise = here - after
            mine = here + (LEFT[j] * fall + RIGHT[j] * rise) if (fall >= 0.0) & (rise >= 0.0) else -math.inf
            next_reach = larger(smaller(mine, reach), next_reach)
            position = float(j) if mine > reach else position
            best, reach, here, fall = larger(after, best), larger(mine, reach), after, -rise
        for j in range(MIDDLE, DEGREE):
            after = combined(values, a, b, factor[lane], sign[lane], j + 1, lane)
            rise = here - after
            mine = here + (LEFT[j] * fall + RIGHT[j] * rise) if (fall >= 0.0) & (rise >= 0.0) else -math.inf
            next_reach = larger(smaller(mine, reach), next_reach)
            position = float(j) if mine > reach else position
            best, reach, here, fall = larger(after, best), larger(mine, reach), after, -rise
        rise = larger(here - fall - combined(values, a, b, factor[lane], sign[lane], DEGREE - 2, lane), 0.0)
        mine = here + RIGHT[DEGREE] * rise if fall >= 0.0 else -math.inf
        next_reach = larger(smaller(mine, reach), next_reach)
        position, reach = float(DEGREE) if mine > reach else position, larger(mine, reach)
        taken, shift = panels[step, HALF, lane] != 0.0, sign[lane] * factor[lane] * base[lane]
        candidates[step, REACH, lane] = reach + shift if taken else -math.inf
        candidates[step, NEXT_REACH, lane] = next_reach + shift if taken else -math.inf
        candidates[step, POSITION, lane] = position
        search[BEST, lane] = larger(best + shift, search[BEST, lane]) if taken else search[BEST, lane]


@routine
def take_farthest(steps: int, candidates: Memory, search: Memory, found: Memory) -> bool:
    """Take each lane's candidate that may reach farthest; whether any lane has one that may reach far enough."""
    for lane in range(LANES):
        search[TAKEN, lane], search[STEP, lane] = -math.inf, NONE
    for step in range(steps):
        for lane in range(LANES):
            farther = candidates[step, REACH, lane] > search[TAKEN, lane]
            search[TAKEN, lane] = candidates[step, REACH, lane] if farther else search[TAKEN, lane]
            search[STEP, lane] = float(step) if farther else search[STEP, lane]
    for lane in range(LANES):
        enough = (search[TAKEN, lane] >= search[BEST, lane]) & (search[TAKEN, lane] > found[VALUE, lane])
        search[STEP, lane] = search[STEP, lane] if enough else NONE
        search[MARK, lane] = 1.0 if enough else 0.0
    return any_positive(search[MARK])


@routine
def leave_next(
    values: Memory, a: int, b: int, factor: float, sign: float, lane: int, step: int, candidates: Memory, search: Memory
) -> None:
    """Where a lane's best candidate of a step was taken, the next best becomes its best; there is none after that."""
    reach, position, done = -math.inf, NONE, int(search[AT_POSITION, lane])
    for j in range(POSITIONS):
        # Of an end of the panel, the fall from the neighbour to the next but one.
        inner = 1 if j == 0 else j
        fall = combined(values, a, b, factor, sign, inner, lane)
        fall -= combined(values, a, b, factor, sign, 2 if j == 0 else j - 1, lane)
        inner = DEGREE - 1 if j == DEGREE else j
        rise = combined(values, a, b, factor, sign, inner, lane)
        rise -= combined(values, a, b, factor, sign, DEGREE - 2 if j == DEGREE else j + 1, lane)
        fall, rise = max(fall, 0.0) if j == 0 else fall, max(rise, 0.0) if j == DEGREE else rise
        here = combined(values, a, b, factor, sign, j, lane)
        mine = here + (LEFT[j] * fall + RIGHT[j] * rise)
        if j != done and fall >= 0.0 and rise >= 0.0 and mine > reach:
            reach, position = mine, float(j)
    candidates[step, REACH, lane] = candidates[step, NEXT_REACH, lane]
    candidates[step, NEXT_REACH, lane] = -math.inf
    candidates[step, POSITION, lane] = position


@routine
def fetch(
    record: Record, matrix: np.ndarray, a: int, b: int, factor: Memory, base: Memory, sign: Memory, work: Search
) -> None:
    """Copy what is known of the panel of each lane's candidate, and cross this off.

    Parameters
    ----------
    record, matrix, a, b, factor, sign
        As of `find_extreme`.
    base : row (LANES,)
        b₀.
    work : Search
    """
    search, series, other, coefficients = work.rows, work.series, work.other_series, record.coefficients
    candidates = work.candidates
    for lane in range(LANES):
        if search[STEP, lane] < 0.0:
            continue
        step, c, way = int(search[STEP, lane]), factor[lane], sign[lane]
        slot_a, slot_b = known_slot(record, matrix, a, step), known_slot(record, matrix, b, step)
        for k in range(POSITIONS):
            of_b = coefficients[slot_b, k, lane]
            other[k, lane] = of_b
            series[k, lane] = way * (coefficients[slot_a, k, lane] - c * of_b)
        series[0, lane] += way * c * base[lane]
        search[BEYOND_SERIES, lane] = record.errors[slot_a, TAIL, lane] + abs(c) * record.errors[slot_b, TAIL, lane]
        search[PANEL_HALF, lane] = record.panels[step, HALF, lane]
        search[PANEL_CENTRE, lane] = record.panels[step, PANEL_MIDDLE, lane]
        search[CUT_BEFORE, lane], search[CUT_AFTER, lane] = (
            record.panels[step, OPENED, lane],
            record.panels[step, CLOSED, lane],
        )
        search[AT_POSITION, lane] = candidates[step, POSITION, lane]
        candidates[step, REACH, lane] = -math.inf
        if candidates[step, NEXT_REACH, lane] > search[BEST, lane]:
            leave_next(record.values, slot_a, slot_b, c, way, lane, step, candidates, search)


@routine
def evaluate(series: Memory, search: Memory) -> None:
    """Value and first two derivatives of a series at each lane's X, by Clenshaw's recurrence."""
    for lane in range(LANES):
        x = search[X, lane]
        twice = x + x
        b = b_before = d = d_before = e = e_before = 0.0
        for i in range(DEGREE):
            e, e_before = 4.0 * d + (twice * e - e_before), e
            d, d_before = 2.0 * b + (twice * d - d_before), d
            b, b_before = series[DEGREE - i, lane] + (twice * b - b_before), b
        search[HERE, lane] = series[0, lane] + (x * b - b_before)
        search[SLOPE, lane] = b + (x * d - d_before)
        search[BEND, lane] = 2.0 * d + (x * e - e_before)


@routine
def value_of_series(series: Memory, search: Memory, values: Memory) -> None:
    """Value of a series at each lane's X."""
    for lane in range(LANES):
        twice = 2.0 * search[X, lane]
        b = b_before = 0.0
        for i in range(DEGREE):
            b, b_before = series[DEGREE - i, lane] + (twice * b - b_before), b
        values[lane] = series[0, lane] + (search[X, lane] * b - b_before)


@routine
def improve(search: Memory) -> bool:
    """Move each lane by a step of Newton's method towards the top, or by half the interval where that leads out of it.

    Returns
    -------
    bool
        Whether any lane isn't there yet. A lane that is there stays.
    """
    for lane in range(LANES):
        x, slope, bend = search[X, lane], search[SLOPE, lane], search[BEND, lane]
        low = x if slope > 0.0 else search[LOW, lane]
        high = search[HIGH, lane] if slope > 0.0 else x
        ahead = x - slope / bend
        ahead = ahead if (bend < 0.0) & (ahead >= low) & (ahead <= high) else 0.5 * (low + high)
        there, step, length = not search[LENGTH, lane] > FOUND, ahead - x, search[LENGTH, lane]
        top, top_ahead = search[TOP, lane], search[HERE, lane] + step * (slope + 0.5 * bend * step)
        bend_before = search[TOP_BEND, lane]
        search[TOP, lane], search[TOP_BEND, lane] = top if there else top_ahead, bend_before if there else bend
        search[LENGTH, lane] = length if there else abs(step)
        search[X, lane] = x if there else ahead
        search[LOW, lane], search[HIGH, lane] = low, high
        search[MARK, lane] = 1.0 if search[LENGTH, lane] > FOUND else 0.0
    return any_positive(search[MARK])


@routine
def climb(series: Memory, search: Memory) -> None:
    """From the positions of the candidates taken to the tops beside them."""
    for lane in range(LANES):
        taken = search[STEP, lane] >= 0.0
        j = int(search[AT_POSITION, lane]) if taken else 0
        search[X, lane], search[LENGTH, lane] = PLACES[j], 2.0 if taken else 0.0
        search[LOW, lane], search[HIGH, lane] = PLACES[max(j - 1, 0)], PLACES[min(j + 1, DEGREE)]
    evaluate(series, search)
    for lane in range(LANES):
        search[START, lane] = search[TOP, lane] = search[HERE, lane]
        search[TOP_BEND, lane] = search[BEND, lane]
    for _ in range(MOST_STEPS):
        if not improve(search):
            break
        evaluate(series, search)


@routine
def compare(record: Record, a: int, b: int, factor: Memory, others: Memory, search: Memory, found: Memory) -> None:
    """Take each lane's top for its extreme if it is higher than what was found so far."""
    whole = record.whole
    for lane in range(LANES):
        weight, tail = abs(factor[lane]), search[BEYOND_SERIES, lane]
        noise = ROUNDING * (whole[a, SCALE, lane] + weight * whole[b, SCALE, lane])
        offset = whole[a, OFFSET, lane] + weight * whole[b, OFFSET, lane]
        start, top, x = search[START, lane], search[TOP, lane], search[X, lane]
        half, middle = search[PANEL_HALF, lane], search[PANEL_CENTRE, lane]
        # What rises above the position by no more than rounding isn't known to be higher.
        value, place = top if top > start + noise else start, middle + half * x
        # Between the positions the series is off by 2 |sin 16θ sin mθ| times coefficient 16 + m, where x = cos θ.
        cosine = 2.0 * x * x - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        value_error = noise + offset + 2.0 * tail * math.sqrt(larger(1.0 - cosine * cosine, 0.0))
        # An extreme at a cut lies where the cut does.
        cut = search[CUT_BEFORE, lane] if x <= -1.0 else (search[CUT_AFTER, lane] if x >= 1.0 else 0.0)
        value_error += cut * abs(search[SLOPE, lane] / half)
        across = larger(math.sqrt(larger(1.0 - x * x, 0.0)), STEEPEST)
        bend = larger(-search[TOP_BEND, lane], TINY)
        aside = (2.0 * DEGREE * tail + 8.0 * (noise + offset) / across) / bend + search[LENGTH, lane] * search[
            LENGTH, lane
        ]
        place_error = ROUNDING * abs(place) + (abs(half) * smaller(aside, 1.0) if abs(x) < 1.0 else cut)
        # Of two that may be the same, either may be the extreme; where the cycle closes, they may be neighbours.
        before, at_before = found[VALUE, lane], found[AT, lane]
        taken = search[STEP, lane] >= 0.0
        higher = taken & (value > before)
        rivals = taken & (abs(value - before) <= value_error + found[VALUE_ERROR, lane])
        kept_error = place_error if higher else found[AT_ERROR, lane]
        other_error = found[AT_ERROR, lane] if higher else place_error
        distance, period = abs(place - at_before), search[PERIOD, lane]
        periods = math.floor(distance / period + 0.5)
        apart = other_error + (abs(distance - periods * period) if periods > 0.0 else distance)
        found[VALUE, lane] = value if higher else before
        found[VALUE_ERROR, lane] = value_error if higher else found[VALUE_ERROR, lane]
        found[AT, lane] = place if higher else at_before
        found[AT_ERROR, lane] = larger(kept_error, apart) if rivals else kept_error
        found[OTHER, lane] = others[lane] - whole[b, FIRST, lane] if higher else found[OTHER, lane]


@routine
def find_extreme(
    record: Record,
    matrix: np.ndarray,
    steps: int,
    a: int,
    b: int,
    factor: Memory,
    sign: Memory,
    work: Search,
    found: Memory,
) -> None:
    """Greatest (sign 1) or least (−1) value of a − c (b − b₀) over each lane's cycle.

    Parameters
    ----------
    record : Record
    matrix : ndarray
        `chebyshev.TO_COEFFICIENTS`.
    steps : int
        How many steps the record has.
    a, b : int
        Curves of the record; the same where only one is meant.
    factor : row (LANES,)
        c, 0 where only one curve is meant.
    sign : row (LANES,)
    work : Search
        Used meanwhile.
    found : rows (EXTREME, LANES)
        Receives the extreme; NaN where any value isn't finite.
    """
    base, search, candidates = record.whole[b, FIRST], work.rows, work.candidates
    for lane in range(LANES):
        search[BEST, lane] = found[VALUE, lane] = -math.inf
        found[VALUE_ERROR, lane] = found[AT, lane] = found[AT_ERROR, lane] = found[OTHER, lane] = 0.0
    for step in range(steps):
        slot_a, slot_b = step * record.curves + a, step * record.curves + b
        scan(record.values, slot_a, slot_b, factor, base, sign, record.panels, step, candidates, search)
    for _ in range(MOST_TOPS):
        if not take_farthest(steps, candidates, search, found):
            break
        fetch(record, matrix, a, b, factor, base, sign, work)
        climb(work.series, search)
        value_of_series(work.other_series, search, search[HERE])
        compare(record, a, b, factor, search[HERE], search, found)
    left = take_farthest(steps, candidates, search, found)
    for lane in range(LANES):
        beyond = search[TAKEN, lane] - found[VALUE, lane] if left & (search[STEP, lane] >= 0.0) else 0.0
        found[VALUE_ERROR, lane] = larger(found[VALUE_ERROR, lane], beyond)
        # Where a value isn't finite, the greatest magnitude isn't.
        unknown = not abs(found[VALUE, lane]) + record.whole[a, SCALE, lane] + record.whole[b, SCALE, lane] < math.inf
        found[VALUE, lane] = math.nan if unknown else sign[lane] * found[VALUE, lane]
        for part in range(VALUE_ERROR, EXTREME):
            found[part, lane] = math.nan if unknown else found[part, lane]
