"""Greatest and least values over the cycle, between the positions too, with their places and what both may be off by.

Looked for is the greatest value of s (a − c (b − b₀)), s = ±1, of two kept curves a and b with a factor c of each
lane's own; b₀ is the value of b at the first position. Of a single curve, c = 0.

The greatest value at any position is a lower bound. A panel whose curve may go beyond it is looked at more closely:
beside each position that its neighbours don't exceed, the polynomial's top is found by Newton's method, kept between the
neighbours. Panels include their ends, so a curve that jumps from one to the next has its extremes on either side.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.cycle.chebyshev import DEGREE, MIDDLE, PLACES, POSITIONS
from engine.cycle.compiling import routine, scalar
from engine.cycle.integrals import ROUNDING
from engine.cycle.lanes import LANES, Memory
from engine.cycle.record import FIRST, HALF, OFFSET, SCALE, TAIL, Record, known_slot
from engine.cycle.record import MIDDLE as MIDDLE_ROW
from engine.cycle.series import larger, smaller

# Rows of an extreme: its value, its place, what they may be off by, b − b₀ there.
VALUE, VALUE_ERROR, AT, AT_ERROR, OTHER = range(5)
EXTREME = 5
# Rows of a search: greatest value at any position, NaN if one isn't finite; in a panel the position CHOSEN, with the
# value SAMPLEd there and its PLACE; the interval LOW … HIGH in which Newton's method is at X, LENGTH of its last step; values found at X.
BEST, CHOSEN, SAMPLE, PLACE, LOW, HIGH, X, LENGTH, TOP, SLOPE, BEND = range(11)
SEARCH = 11
# Where no position is chosen.
NONE = 99.0

# How far a curve may go beyond three neighbours, by what they differ. Positions lie up to three times farther apart on
# one side than on the other: a parabola's top may then be 0.55 of the differences above the highest of the three.
BEYOND = 1.0
# How far beyond all positions, as a share of the range of the values in a panel.
REACH = 0.1
# The last of Newton's steps, as a share of half the panel: it leaves the square of this.
FOUND = 1e-6
MOST_TOPS, MOST_STEPS = 4, 30


class Search(NamedTuple):
    """Memory for a search.

    Attributes
    ----------
    combined, series : rows (POSITIONS, LANES)
        Values and coefficients of what is searched, in one panel.
    reaches : rows (steps, LANES)
        How far each panel may reach.
    search : rows (SEARCH, LANES)
    other : row (LANES,)
        Value of b.
    """

    combined: Memory
    series: Memory
    reaches: Memory
    search: Memory
    other: Memory


@routine
def combine(values: Memory, a: int, b: int, factor: Memory, base: Memory, sign: float, combined: Memory) -> None:
    """Values of s (a − c (b − b₀)) at the positions of a panel, from the slots of a and b."""
    for j in range(POSITIONS):
        for lane in range(LANES):
            combined[j, lane] = sign * (values[a, j, lane] - factor[lane] * (values[b, j, lane] - base[lane]))


@routine
def combine_series(
    coefficients: Memory, a: int, b: int, factor: Memory, base: Memory, sign: float, combined: Memory
) -> None:
    """The same for the coefficients of their series."""
    for k in range(POSITIONS):
        for lane in range(LANES):
            combined[k, lane] = sign * (coefficients[a, k, lane] - factor[lane] * coefficients[b, k, lane])
    for lane in range(LANES):
        combined[0, lane] += sign * factor[lane] * base[lane]


@routine
def scan(
    values: Memory,
    a: int,
    b: int,
    factor: Memory,
    base: Memory,
    sign: float,
    panels: Memory,
    step: int,
    reaches: Memory,
    search: Memory,
) -> None:
    """Widen the greatest value by those of a step's panels; how far each of these may reach goes to its row."""
    for lane in range(LANES):
        high, low, total = -math.inf, math.inf, 0.0
        for j in range(POSITIONS):
            value = sign * (values[a, j, lane] - factor[lane] * (values[b, j, lane] - base[lane]))
            high, low, total = larger(value, high), smaller(value, low), total + value
        taken = panels[step, HALF, lane] != 0.0
        reaches[step, lane] = high + REACH * (high - low) if taken else -math.inf
        best = larger(high, search[BEST, lane]) if taken else search[BEST, lane]
        # NaN stays: it is larger than nothing, and nothing is larger than it.
        broken = taken & (not abs(total) < math.inf)
        search[BEST, lane] = math.nan if broken | (search[BEST, lane] != search[BEST, lane]) else best


@routine
def reached(reaches: Memory, step: int, search: Memory, found: Memory) -> bool:
    """Whether the panel of any lane may hold its extreme; readies the search in this panel."""
    wanted = False
    for lane in range(LANES):
        hopeful = reaches[step, lane] >= larger(search[BEST, lane], found[VALUE, lane])
        search[CHOSEN, lane] = -1.0 if hopeful else NONE
        wanted |= hopeful
    return wanted


@scalar
def _choose_among(begin: int, end: int, combined: Memory, search: Memory, found: Memory) -> None:
    """The first of some positions that `choose` may choose; PLACE holds the one chosen before."""
    for lane in range(LANES):
        chosen, previous = search[CHOSEN, lane], search[PLACE, lane]
        enough = larger(search[BEST, lane], found[VALUE, lane])
        for i in range(end - begin):
            j = end - 1 - i
            here = combined[j, lane]
            fall, rise = here - combined[max(j - 1, 0), lane], here - combined[min(j + 1, DEGREE), lane]
            # At an end of the panel the next step on tells how the curve bends.
            on = abs(combined[1, lane] - combined[2, lane]) if j == 0 else 0.0
            on = abs(combined[DEGREE - 1, lane] - combined[DEGREE - 2, lane]) if j == DEGREE else on
            is_top = (fall >= 0.0) & (rise >= 0.0) & (here + BEYOND * (fall + rise + on) >= enough)
            chosen = float(j) if is_top & (j > previous) else chosen
        search[CHOSEN, lane] = chosen


@routine
def choose(combined: Memory, search: Memory, found: Memory) -> bool:
    """Choose each lane's next position that its neighbours don't exceed and that may have the extreme beside it."""
    # In two, each short enough to be unrolled.
    for lane in range(LANES):
        search[PLACE, lane], search[CHOSEN, lane] = search[CHOSEN, lane], NONE
    _choose_among(MIDDLE, POSITIONS, combined, search, found)
    _choose_among(0, MIDDLE, combined, search, found)
    any_chosen = False
    for lane in range(LANES):
        any_chosen |= search[CHOSEN, lane] < NONE
    for lane in range(LANES):
        # Unused where none is chosen, but read.
        j = int(smaller(search[CHOSEN, lane], float(DEGREE)))
        search[SAMPLE, lane] = combined[j, lane]
        search[PLACE, lane] = search[X, lane] = PLACES[j]
        search[LOW, lane], search[HIGH, lane] = PLACES[max(j - 1, 0)], PLACES[min(j + 1, DEGREE)]
    return any_chosen


@routine
def evaluate(series: Memory, search: Memory) -> None:
    """Value and first two derivatives of a series at each lane's X, by Clenshaw's recurrence."""
    for lane in range(LANES):
        x = search[X, lane]
        twice = x + x
        b = b_before = d = d_before = e = e_before = 0.0
        for i in range(DEGREE):
            e, e_before = 4.0 * d + twice * e - e_before, e
            d, d_before = 2.0 * b + twice * d - d_before, d
            b, b_before = series[DEGREE - i, lane] + twice * b - b_before, b
        search[TOP, lane] = series[0, lane] + x * b - b_before
        search[SLOPE, lane] = b + x * d - d_before
        search[BEND, lane] = 2.0 * d + x * e - e_before


@routine
def improve(search: Memory) -> bool:
    """Move each lane by a step of Newton's method towards the top, or by half the interval where that leads out of it.

    Returns
    -------
    bool
        Whether any lane isn't there yet. A lane that is there stays.
    """
    going = False
    for lane in range(LANES):
        x, slope, bend = search[X, lane], search[SLOPE, lane], search[BEND, lane]
        low = x if slope > 0.0 else search[LOW, lane]
        high = search[HIGH, lane] if slope > 0.0 else x
        ahead = x - slope / bend
        ahead = ahead if (bend < 0.0) & (ahead > low) & (ahead < high) else 0.5 * (low + high)
        there = not search[LENGTH, lane] > FOUND
        search[LENGTH, lane] = 0.0 if there else abs(ahead - x)
        search[X, lane] = x if there else ahead
        search[LOW, lane], search[HIGH, lane] = low, high
        going |= search[LENGTH, lane] > FOUND
    return going


@routine
def climb(series: Memory, search: Memory) -> None:
    """From the chosen positions to the tops beside them."""
    for lane in range(LANES):
        search[LENGTH, lane] = NONE if search[CHOSEN, lane] < NONE else 0.0
    for _ in range(MOST_STEPS):
        evaluate(series, search)
        if not improve(search):
            break
    evaluate(series, search)


@routine
def value_of_series(coefficients: Memory, slot: int, search: Memory, values: Memory) -> None:
    """Value of a curve's series at each lane's X."""
    for lane in range(LANES):
        twice = 2.0 * search[X, lane]
        b = b_before = 0.0
        for i in range(DEGREE):
            b, b_before = coefficients[slot, DEGREE - i, lane] + twice * b - b_before, b
        values[lane] = coefficients[slot, 0, lane] + search[X, lane] * b - b_before


@routine
def compare(
    record: Record,
    step: int,
    a: int,
    b: int,
    factor: Memory,
    other: Memory,
    search: Memory,
    found: Memory,
) -> None:
    """Take each lane's top for its extreme if it is higher than what was found so far."""
    panels, errors, whole = record.panels, record.errors, record.whole
    slot_a, slot_b = step * record.curves + a, step * record.curves + b
    for lane in range(LANES):
        weight = abs(factor[lane])
        tail = errors[slot_a, TAIL, lane] + weight * errors[slot_b, TAIL, lane]
        noise = ROUNDING * (whole[a, SCALE, lane] + weight * whole[b, SCALE, lane])
        offset = whole[a, OFFSET, lane] + weight * whole[b, OFFSET, lane]
        sample, top, x = search[SAMPLE, lane], search[TOP, lane], search[X, lane]
        half, middle = panels[step, HALF, lane], panels[step, MIDDLE_ROW, lane]
        between = top > sample
        value = top if between else sample
        x = x if between else search[PLACE, lane]
        place = middle + half * x
        # Between the positions the series is off by 2 |sin 16θ sin mθ| times coefficient 16 + m, where x = cos θ.
        cosine = 2.0 * x * x - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        cosine = 2.0 * cosine * cosine - 1.0
        sine = math.sqrt(larger(1.0 - cosine * cosine, 0.0))
        value_error = noise + offset + 2.0 * tail * sine
        inside = abs(x) < 1.0
        aside = (2.0 * DEGREE * tail + 2.0 * noise) / larger(-search[BEND, lane], 1e-300)
        place_error = ROUNDING * abs(place) + (abs(half) * smaller(aside, 1.0) if inside else 0.0)
        # Of two that may be the same, either may be the extreme.
        before, at_before = found[VALUE, lane], found[AT, lane]
        chosen = search[CHOSEN, lane] < NONE
        higher = chosen & (value > before)
        rivals = chosen & (abs(value - before) <= value_error + found[VALUE_ERROR, lane])
        apart = abs(place - at_before)
        kept_error = place_error if higher else found[AT_ERROR, lane]
        found[VALUE, lane] = value if higher else before
        found[VALUE_ERROR, lane] = value_error if higher else found[VALUE_ERROR, lane]
        found[AT, lane] = place if higher else at_before
        found[AT_ERROR, lane] = larger(kept_error, apart) if rivals else kept_error
        found[OTHER, lane] = other[lane] - whole[b, FIRST, lane] if higher else found[OTHER, lane]


@routine
def find_extreme(
    record: Record,
    matrix: np.ndarray,
    steps: int,
    a: int,
    b: int,
    factor: Memory,
    sign: float,
    work: Search,
    found: Memory,
) -> None:
    """Greatest (sign 1) or least (−1) value of a − c (b − b₀) over the cycle.

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
    sign : float
    work : Search
        Used meanwhile.
    found : rows (EXTREME, LANES)
        Receives the extreme; NaN where any value isn't finite.
    """
    base, (combined, series, reaches, search, other) = record.whole[b, FIRST], work
    for lane in range(LANES):
        search[BEST, lane] = found[VALUE, lane] = -math.inf
        found[VALUE_ERROR, lane] = found[AT, lane] = found[AT_ERROR, lane] = found[OTHER, lane] = 0.0
        other[lane] = 0.0
    for step in range(steps):
        slot_a, slot_b = step * record.curves + a, step * record.curves + b
        scan(record.values, slot_a, slot_b, factor, base, sign, record.panels, step, reaches, search)
    for step in range(steps):
        if not reached(reaches, step, search, found):
            continue
        slot_a, slot_b = known_slot(record, matrix, a, step), known_slot(record, matrix, b, step)
        combine(record.values, slot_a, slot_b, factor, base, sign, combined)
        combine_series(record.coefficients, slot_a, slot_b, factor, base, sign, series)
        for _ in range(MOST_TOPS):
            if not choose(combined, search, found):
                break
            climb(series, search)
            if a != b:
                value_of_series(record.coefficients, slot_b, search, other)
            compare(record, step, a, b, factor, other, search, found)
    for lane in range(LANES):
        unknown = not abs(found[VALUE, lane] + search[BEST, lane]) < math.inf
        found[VALUE, lane] = math.nan if unknown else sign * found[VALUE, lane]
        for part in range(VALUE_ERROR, EXTREME):
            found[part, lane] = math.nan if unknown else found[part, lane]
