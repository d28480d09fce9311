"""The coefficient of speed fluctuation δ of the steady cycle with a given flywheel.

Let W be the work about the mean since the first position, I the machine's inertia and I_F that of the flywheel, both
reduced to the input link. The kinetic energy ½ω² (I + I_F) changes by W. With ω_max,min = ω_m (1 ± δ/2), the energy
both at the greatest and that at the least speed differ from the first one's by extremes of W − ½ω² I at fixed ω:

    h(δ) = max[W − ½ω_max² (I − I_1)] − min[W − ½ω_min² (I − I_1)] − δ ω_m² (I_1 + I_F) = 0,

Wittenbauer's condition, I_1 = I at the first position. No nearly equal numbers are subtracted, however small δ is. At
an extreme the derivative by its place is 0, so h′(δ) needs nothing but I at the places of the extremes, and Newton's
method converges from δ = 0.
"""

import math

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.measures.extremes import AT, AT_ERROR, OTHER, VALUE, VALUE_ERROR, Search, find_extreme
from engine.cycle.panels.chebyshev import POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.record import FIRST, HALF, OFFSET, SCALE, TAIL, Record, keep_derived
from engine.cycle.panels.series import larger, smaller

# Rows of the result: δ and its error; places of the least and the greatest speed with errors; max[W − ½ω_max² (I −
# I_1)] and its error. Then rows used meanwhile: ½ω² at the greatest and the least speed, length of the last step.
DELTA, DELTA_ERROR, SLOWEST_AT, SLOWEST_AT_ERROR, FASTEST_AT, FASTEST_AT_ERROR, TOP, TOP_ERROR, FAST, SLOW, STEP = (
    range(11)
)
FLUCTUATION = 11
RESULTS = 8

# Greatest δ: the machine stops at its slowest.
MOST = 2.0
FOUND = 1e-6
MOST_STEPS = 40


@routine
def _slopes(omega: Memory, result: Memory) -> None:
    for lane in range(LANES):
        fast = omega[lane] * (1.0 + 0.5 * result[DELTA, lane])
        slow = omega[lane] * (1.0 - 0.5 * result[DELTA, lane])
        result[FAST, lane], result[SLOW, lane] = 0.5 * fast * fast, 0.5 * slow * slow


@routine
def _improve(
    omega: Memory,
    flywheel: Memory,
    first: Memory,
    high: Memory,
    low: Memory,
    result: Memory,
) -> bool:
    """One step of Newton's method; whether any lane isn't there yet. A lane that is there stays."""
    for lane in range(LANES):
        delta, square = result[DELTA, lane], omega[lane] * omega[lane]
        inertia = first[lane] + flywheel[lane]
        excess = high[VALUE, lane] - low[VALUE, lane] - delta * square * inertia
        turning = (1.0 + 0.5 * delta) * high[OTHER, lane] + (1.0 - 0.5 * delta) * low[OTHER, lane]
        fall = square * (0.5 * turning + inertia)
        ahead = larger(delta + excess / fall, 0.0)
        # Once it has been tried in vain it stops within the cycle.
        ahead = math.nan if (ahead > MOST) & (delta == MOST) else smaller(ahead, MOST)
        ahead = ahead if abs(excess) < math.inf else math.nan
        there = not result[STEP, lane] > 0.0
        step = abs(ahead - delta)
        result[STEP, lane] = 0.0 if there else (step if step > FOUND * ahead else -1.0)
        # The last step leaves its square.
        off = (high[VALUE_ERROR, lane] + low[VALUE_ERROR, lane]) / fall + step * step
        result[DELTA, lane] = delta if there else ahead
        result[DELTA_ERROR, lane] = result[DELTA_ERROR, lane] if there else off
        result[SLOWEST_AT, lane] = result[SLOWEST_AT, lane] if there else low[AT, lane]
        result[SLOWEST_AT_ERROR, lane] = result[SLOWEST_AT_ERROR, lane] if there else low[AT_ERROR, lane]
        result[FASTEST_AT, lane] = result[FASTEST_AT, lane] if there else high[AT, lane]
        result[FASTEST_AT_ERROR, lane] = result[FASTEST_AT_ERROR, lane] if there else high[AT_ERROR, lane]
        gone = 0.5 * square * (1.0 + 0.5 * delta) * (ahead - delta) * high[OTHER, lane]
        result[TOP, lane] = result[TOP, lane] if there else high[VALUE, lane] - gone
        result[TOP_ERROR, lane] = result[TOP_ERROR, lane] if there else high[VALUE_ERROR, lane]
    going = False
    for lane in range(LANES):
        going |= result[STEP, lane] > 0.0
    return going


@routine
def find_fluctuation(
    record: Record,
    matrix: np.ndarray,
    steps: int,
    work: int,
    inertia: int,
    omega: Memory,
    flywheel: Memory,
    search: Search,
    up: Memory,
    down: Memory,
    high: Memory,
    low: Memory,
    result: Memory,
) -> None:
    """Coefficient of speed fluctuation of each lane.

    Parameters
    ----------
    record, matrix, steps, search
        As of `find_extreme`.
    work, inertia : int
        Curves of the record with W and I.
    omega, flywheel : row (LANES,)
        Mean speed, by its magnitude or not, and the flywheel's inertia.
    up, down : row (LANES,)
        1 and −1 in all lanes.
    high, low : rows (EXTREME, LANES)
        Used meanwhile.
    result : rows (FLUCTUATION, LANES)
        Receives it; NaN where the machine would stop within the cycle.
    """
    for part in range(FLUCTUATION):
        for lane in range(LANES):
            result[part, lane] = 1.0 if part == STEP else 0.0
    for _ in range(MOST_STEPS):
        _slopes(omega, result)
        find_extreme(record, matrix, steps, work, inertia, result[FAST], up, search, high)
        find_extreme(record, matrix, steps, work, inertia, result[SLOW], down, search, low)
        if not _improve(omega, flywheel, record.whole[inertia, FIRST], high, low, result):
            break
    for part in range(RESULTS):
        for lane in range(LANES):
            known = abs(result[DELTA, lane]) < math.inf
            result[part, lane] = result[part, lane] if known else math.nan


@routine
def add_speed(
    record: Record,
    steps: int,
    work: int,
    inertia: int,
    omega: Memory,
    flywheel: Memory,
    result: Memory,
    speed: int,
    figures: Memory,
    slowest: Memory,
) -> None:
    """Enter the speed over the steady cycle as another kept curve: ω = √(2 E/(I + I_F)).

    Parameters
    ----------
    record, steps, work, inertia, omega, flywheel
        As of `find_fluctuation`.
    result : rows (FLUCTUATION, LANES)
        What that found.
    speed : int
        Curve of the record that receives the speed, by magnitude.
    figures : rows (1, FIGURES, LANES)
        Used meanwhile.
    slowest : row (LANES,)
        Used meanwhile: the least of ω (I + I_F), of which an error of the energy is a share.
    """
    values, errors, whole = record.values, record.errors, record.whole
    for step in range(steps):
        slot = step * record.curves
        of_work, of_inertia, of_speed = slot + work, slot + inertia, slot + speed
        for lane in range(LANES):
            slowest[lane] = math.inf
        for j in range(POSITIONS):
            for lane in range(LANES):
                fastest = omega[lane] * (1.0 + 0.5 * result[DELTA, lane])
                first = 0.5 * fastest * fastest * (whole[inertia, FIRST, lane] + flywheel[lane]) - result[TOP, lane]
                inert = values[of_inertia, j, lane] + flywheel[lane]
                here = math.sqrt(2.0 * (first + values[of_work, j, lane]) / inert)
                values[of_speed, j, lane] = here
                slowest[lane] = smaller(here * inert, slowest[lane])
        keep_derived(record, step, speed, figures)
        for lane in range(LANES):
            square = omega[lane] * omega[lane]
            inert = whole[inertia, SCALE, lane] + abs(flywheel[lane])
            of_energy = result[TOP_ERROR, lane] + 2.0 * square * inert * result[DELTA_ERROR, lane]
            of_energy += whole[work, OFFSET, lane] + errors[of_work, TAIL, lane]
            of_energy += square * errors[of_inertia, TAIL, lane] + ROUNDING * (
                whole[work, SCALE, lane] + square * inert
            )
            errors[of_speed, TAIL, lane] += of_energy / slowest[lane] if record.panels[step, HALF, lane] != 0.0 else 0.0
