"""Kept curves between their positions: values at given places, and the places where a curve is zero."""

import math

import numpy as np

from engine.cycle.chebyshev import DEGREE, PLACES
from engine.cycle.compiling import routine
from engine.cycle.extremes import HIGH, LOW, SLOPE, TOP, X, evaluate, value_of_series
from engine.cycle.integrals import ROUNDING
from engine.cycle.lanes import LANES, in_lanes, in_panels
from engine.cycle.record import HALF, MIDDLE, OFFSET, SCALE, TAIL, Record, known_slot
from engine.cycle.series import larger, smaller

# Rows of a value at a place, or of a zero: it, and what it may be off by.
FOUND, ERROR = range(2)
# A place beyond the end of a panel by no more than this share of it is at its end.
BEYOND = 1e-9
# Last step towards a zero, as a share of half the panel.
ENOUGH = 1e-9
MOST_STEPS = 60


@routine
def _locate(panels: np.ndarray, step: int, at: np.ndarray, search: np.ndarray) -> bool:
    """Each lane's X in its panel of a step, NaN where it is elsewhere; whether any lane's place is in its panel."""
    panels, search = in_lanes(panels), in_lanes(search)
    inside = False
    for lane in range(LANES):
        x = (at[lane] - panels[step, MIDDLE, lane]) / panels[step, HALF, lane]
        x = x if abs(x) <= 1.0 + BEYOND else math.nan
        search[X, lane] = larger(smaller(x, 1.0), -1.0) if abs(x) < math.inf else math.nan
    for lane in range(LANES):
        inside |= abs(search[X, lane]) < math.inf
    return inside


@routine
def value_at(
    record: Record, matrix: np.ndarray, steps: int, curve: int, at: np.ndarray, search: np.ndarray, result: np.ndarray
) -> None:
    """Value of a kept curve at a place of each lane; where it jumps, that after the jump.

    Parameters
    ----------
    record, matrix, steps
        As of `find_extreme`.
    curve : int
    at : ndarray (LANES,)
        Input positions.
    search : ndarray (SEARCH + 1, LANES)
        Used meanwhile.
    result : ndarray (2, LANES)
        Receives value and error; NaN where the place is outside of the range.
    """
    search, result, values = in_lanes(search), in_lanes(result), search[search.shape[0] - 1]
    errors, whole = in_lanes(record.errors), in_lanes(record.whole)
    for lane in range(LANES):
        result[FOUND, lane] = result[ERROR, lane] = math.nan
    for step in range(steps):
        if not _locate(record.panels, step, at, search):
            continue
        slot = known_slot(record, matrix, curve, step)
        value_of_series(record.coefficients, slot, search, values)
        for lane in range(LANES):
            here = abs(search[X, lane]) <= 1.0
            off = 2.0 * errors[slot, TAIL, lane] + ROUNDING * whole[curve, SCALE, lane] + whole[curve, OFFSET, lane]
            result[FOUND, lane] = values[lane] if here else result[FOUND, lane]
            result[ERROR, lane] = off if here else result[ERROR, lane]


@routine
def _close_in(search: np.ndarray, lengths: np.ndarray) -> bool:
    """Move each lane by a step towards the zero between LOW and HIGH, where the series is below and above it.

    Returns
    -------
    bool
        Whether any lane isn't there yet. A lane that is there stays.
    """
    search = in_lanes(search)
    for lane in range(LANES):
        x, value, slope = search[X, lane], search[TOP, lane], search[SLOPE, lane]
        low, high = search[LOW, lane], search[HIGH, lane]
        low, high = (x if value < 0.0 else low), (x if value > 0.0 else high)
        ahead = x - value / slope
        ahead = ahead if (ahead - low) * (ahead - high) <= 0.0 else 0.5 * (low + high)
        ahead = x if value == 0.0 else ahead
        there = not lengths[lane] > ENOUGH
        lengths[lane] = 0.0 if there else abs(ahead - x)
        search[X, lane] = x if there else ahead
        search[LOW, lane], search[HIGH, lane] = low, high
    going = False
    for lane in range(LANES):
        going |= lengths[lane] > ENOUGH
    return going


@routine
def zeros_of(
    record: Record,
    matrix: np.ndarray,
    steps: int,
    curve: int,
    search: np.ndarray,
    counts: np.ndarray,
    lengths: np.ndarray,
    result: np.ndarray,
) -> None:
    """Places within panels where a kept curve changes its sign, in the order in which the input comes to them.

    Parameters
    ----------
    record, matrix, steps
        As of `find_extreme`.
    curve : int
    search : ndarray (SEARCH, LANES)
        Used meanwhile.
    counts, lengths : ndarray (LANES,)
        Used meanwhile; `counts` receives how many there are, more than `result` has room for or not.
    result : ndarray (most, 2, LANES)
        Receives each place and its error, then NaN.
    """
    search, result, values, coefficients = (
        in_lanes(search),
        in_lanes(result),
        in_panels(record.values),
        in_panels(record.coefficients),
    )
    errors, whole, panels = in_lanes(record.errors), in_lanes(record.whole), in_lanes(record.panels)
    for lane in range(LANES):
        counts[lane] = 0.0
        for i in range(result.shape[0]):
            result[i, FOUND, lane] = result[i, ERROR, lane] = math.nan
    for step in range(steps):
        slot = step * record.curves + curve
        for j in range(DEGREE):
            changing = False
            for lane in range(LANES):
                here, there = values[slot, j, lane], values[slot, j + 1, lane]
                rises = (here < 0.0) & (there >= 0.0)
                falls = (here >= 0.0) & (there < 0.0)
                changes = (rises | falls) & (panels[step, HALF, lane] != 0.0)
                lengths[lane] = 1.0 if changes else 0.0
                share = here / (here - there)
                search[X, lane] = PLACES[j] + (PLACES[j + 1] - PLACES[j]) * (share if changes else 0.0)
                search[LOW, lane] = PLACES[j] if rises else PLACES[j + 1]
                search[HIGH, lane] = PLACES[j + 1] if rises else PLACES[j]
            for lane in range(LANES):
                changing |= lengths[lane] > 0.0
            if not changing:
                continue
            known_slot(record, matrix, curve, step)
            for _ in range(MOST_STEPS):
                evaluate(coefficients[slot], search)
                if not _close_in(search, lengths):
                    break
            evaluate(coefficients[slot], search)
            for lane in range(LANES):
                here, there = values[slot, j, lane], values[slot, j + 1, lane]
                if ((here < 0.0) == (there < 0.0)) or panels[step, HALF, lane] == 0.0 or not abs(there) < math.inf:
                    continue
                i = int(counts[lane])
                counts[lane] += 1.0
                if i < result.shape[0]:
                    half = panels[step, HALF, lane]
                    place = panels[step, MIDDLE, lane] + half * search[X, lane]
                    off = 2.0 * errors[slot, TAIL, lane] + ROUNDING * whole[curve, SCALE, lane]
                    aside = min(off / abs(search[SLOPE, lane]), PLACES[j + 1] - PLACES[j])
                    result[i, FOUND, lane] = place
                    result[i, ERROR, lane] = abs(half) * aside + ROUNDING * abs(place)
