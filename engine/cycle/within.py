"""Kept curves between their positions: values at given places, and the places where a curve is zero."""

import math

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.tiles import LANES
from engine.cycle.chebyshev import DEGREE, PLACES
from engine.cycle.extremes import HERE, HIGH, LENGTH, LOW, SLOPE, TAKEN, Search, X, evaluate
from engine.cycle.integrals import ROUNDING
from engine.cycle.lanes import Memory, memory
from engine.cycle.record import HALF, MIDDLE, OFFSET, SCALE, TAIL, Record, known_slot
from engine.cycle.series import larger, smaller

# Rows of a value at a place, or of a zero: it, and what it may be off by.
FOUND, ERROR = range(2)
of_zeros = memory(2, LANES)
# A place beyond the end of a panel by no more than this share of it is at its end.
BEYOND = 1e-9
# Last step towards a zero, as a share of half the panel.
ENOUGH = 1e-9
MOST_STEPS = 60


@routine
def value_at(
    record: Record, matrix: np.ndarray, steps: int, curve: int, at: Memory, work: Search, result: Memory
) -> None:
    """Value of a kept curve at a place of each lane; where it jumps, that after the jump.

    Parameters
    ----------
    record, matrix, steps
        As of `find_extreme`.
    curve : int
    at : row (LANES,)
        Input positions.
    work : Search
        Used meanwhile.
    result : rows (2, LANES)
        Receives value and error; NaN where the place is outside of the range.
    """
    search, panels = work.rows, record.panels
    for lane in range(LANES):
        result[FOUND, lane] = result[ERROR, lane] = math.nan
    for step in range(steps):
        inside = False
        for lane in range(LANES):
            x = (at[lane] - panels[step, MIDDLE, lane]) / panels[step, HALF, lane]
            within = abs(x) <= 1.0 + BEYOND
            search[X, lane] = larger(smaller(x, 1.0), -1.0) if within else math.nan
            inside |= within
        if not inside:
            continue
        slot = known_slot(record, matrix, curve, step)
        evaluate(record.coefficients[slot], search)
        for lane in range(LANES):
            here = abs(search[X, lane]) <= 1.0
            # Rounding of values and of the place.
            moved = abs(at[lane] * search[SLOPE, lane] / panels[step, HALF, lane])
            noise = ROUNDING * (record.whole[curve, SCALE, lane] + moved) + record.whole[curve, OFFSET, lane]
            result[FOUND, lane] = search[HERE, lane] if here else result[FOUND, lane]
            off = 2.0 * record.errors[slot, TAIL, lane] + noise
            result[ERROR, lane] = off if here else result[ERROR, lane]


@routine
def close_in(search: Memory) -> bool:
    """Move each lane by a step towards the zero between LOW, where the series is below it, and HIGH.

    Returns
    -------
    bool
        Whether any lane isn't there yet. A lane that is there stays.
    """
    going = False
    for lane in range(LANES):
        x, value, slope = search[X, lane], search[HERE, lane], search[SLOPE, lane]
        low, high = search[LOW, lane], search[HIGH, lane]
        low, high = (x if value < 0.0 else low), (x if value > 0.0 else high)
        ahead = x - value / slope
        ahead = ahead if (ahead - low) * (ahead - high) <= 0.0 else 0.5 * (low + high)
        ahead = x if value == 0.0 else ahead
        there = not search[LENGTH, lane] > ENOUGH
        search[LENGTH, lane] = 0.0 if there else abs(ahead - x)
        search[X, lane] = x if there else ahead
        search[LOW, lane], search[HIGH, lane] = low, high
    for lane in range(LANES):
        going |= search[LENGTH, lane] > ENOUGH
    return going


@routine
def zeros_of(
    record: Record, matrix: np.ndarray, steps: int, curve: int, work: Search, counts: Memory, most: int, result: Memory
) -> None:
    """Places within panels where a kept curve changes its sign, in the order in which the input comes to them.

    Parameters
    ----------
    record, matrix, steps
        As of `find_extreme`.
    curve : int
    work : Search
        Used meanwhile.
    counts : row (LANES,)
        Receives how many there are, whether or not `result` has room for them.
    most : int
        How many it has room for.
    result : rows (most, 2, LANES)
        Receives each place and its error, then NaN.
    """
    search, values, panels = work.rows, record.values, record.panels
    for lane in range(LANES):
        counts[lane] = 0.0
        for i in range(most):
            result[i, FOUND, lane] = result[i, ERROR, lane] = math.nan
    for step in range(steps):
        slot = step * record.curves + curve
        for j in range(DEGREE):
            changing = False
            for lane in range(LANES):
                here, there = values[slot, j, lane], values[slot, j + 1, lane]
                rises, falls = (here < 0.0) & (there >= 0.0), (here >= 0.0) & (there < 0.0)
                changes = (rises | falls) & (panels[step, HALF, lane] != 0.0)
                # Marked for after the search, too.
                search[TAKEN, lane] = 1.0 if changes else 0.0
                search[LENGTH, lane] = search[TAKEN, lane]
                share = here / (here - there) if changes else 0.0
                search[X, lane] = PLACES[j] + (PLACES[j + 1] - PLACES[j]) * share
                search[LOW, lane] = PLACES[j] if rises else PLACES[j + 1]
                search[HIGH, lane] = PLACES[j + 1] if rises else PLACES[j]
                changing |= changes
            if not changing:
                continue
            series = record.coefficients[known_slot(record, matrix, curve, step)]
            for _ in range(MOST_STEPS):
                evaluate(series, search)
                if not close_in(search):
                    break
            evaluate(series, search)
            for lane in range(LANES):
                i = int(counts[lane])
                if search[TAKEN, lane] > 0.0:
                    counts[lane] += 1.0
                if search[TAKEN, lane] > 0.0 and i < most:
                    half = panels[step, HALF, lane]
                    place = panels[step, MIDDLE, lane] + half * search[X, lane]
                    off = 2.0 * record.errors[slot, TAIL, lane] + ROUNDING * record.whole[curve, SCALE, lane]
                    aside = min(off / abs(search[SLOPE, lane]), PLACES[j + 1] - PLACES[j])
                    result[i, FOUND, lane] = place
                    result[i, ERROR, lane] = abs(half) * aside + ROUNDING * abs(place)
