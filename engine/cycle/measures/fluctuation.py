"""Coefficient of speed fluctuation δ of the steady cycle with a given flywheel.

Let W be the work about the mean since the first position, I the machine's inertia and I_F that of the flywheel, both
reduced to the input link. The kinetic energy ½ω² (I + I_F) changes by W. With ω_max,min = ω_m (1 ± δ/2), the energies
at maximum and minimum speed differ from the initial one by extremes of W − ½ω² I at constant ω:

    h(δ) = max[W − ½ω_max² (I − I_1)] − min[W − ½ω_min² (I − I_1)] − δ ω_m² (I_1 + I_F) = 0,

Wittenbauer's condition, with I_1 = I at the first position. No nearly equal numbers are subtracted, however small δ is.
At an extreme the derivative by its position is 0, so h′(δ) needs only I at the positions of the extremes. Newton's
method converges from δ = 0.
"""

import math
from typing import NamedTuple

from engine.compiling.blocks import LANES, Row
from engine.compiling.decorators import routine
from engine.cycle.measures.extremes import ExtremeRows, Search, SoughtExtreme, find_extreme
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import any_positive, fill, one
from engine.cycle.panels.record import Record, keep_derived
from engine.cycle.panels.series import larger, smaller


class Fluctuation(NamedTuple):
    """Speed fluctuation of a steady cycle.

    Attributes
    ----------
    delta, delta_error : row
        δ.
    top, top_error : row
        max[W − ½ω_max² (I − I_1)].
    fast, slow : row
        Scratch: ½ω² at maximum and minimum speed.
    step : row
        Scratch: length of the last step.
    """

    delta: Row
    delta_error: Row
    top: Row
    top_error: Row
    fast: Row
    slow: Row
    step: Row


class SteadyWheel(NamedTuple):
    """A steady cycle with a flywheel.

    Attributes
    ----------
    work, inertia : int
        Curves of the record with W and I.
    omega, flywheel : row
        Mean speed, of either sign, and inertia of the flywheel.
    period : float
        Length of the cycle.
    """

    work: int
    inertia: int
    omega: Row
    flywheel: Row
    period: float


class SpeedEnds(NamedTuple):
    """Scratch: extremes at maximum and minimum speed, and a row.

    Attributes
    ----------
    high, low : ExtremeRows
    slowest : row
        Minimum of ω (I + I_F); an error of the energy divided by it is an error of the speed.
    """

    high: one(ExtremeRows)
    low: one(ExtremeRows)
    slowest: Row


_ROWS = len(Fluctuation._fields)
# Maximum δ, at which the machine just stops.
MOST = 2.0
FOUND = 1e-6
MOST_STEPS = 40


@routine
def _slopes(omega: Row, result: Fluctuation) -> None:
    for lane in range(LANES):
        fast = omega[lane] * (1.0 + 0.5 * result.delta[lane])
        slow = omega[lane] * (1.0 - 0.5 * result.delta[lane])
        result.fast[lane], result.slow[lane] = 0.5 * fast * fast, 0.5 * slow * slow


@routine
def _improve(steady: SteadyWheel, first: Row, ends: SpeedEnds, result: Fluctuation) -> bool:
    """Take one Newton step; returns whether any lane hasn't converged. Converged lanes stay."""
    omega, flywheel, high, low = steady.omega, steady.flywheel, ends.high, ends.low
    for lane in range(LANES):
        delta, square = result.delta[lane], omega[lane] * omega[lane]
        inertia = first[lane] + flywheel[lane]
        excess = high.value[lane] - low.value[lane] - delta * square * inertia
        turning = (1.0 + 0.5 * delta) * high.other[lane] + (1.0 - 0.5 * delta) * low.other[lane]
        fall = square * (0.5 * turning + inertia)
        ahead = larger(delta + excess / fall, 0.0)
        # If the step leads beyond MOST again, the machine stops within the cycle.
        ahead = math.nan if (ahead > MOST) & (delta == MOST) else smaller(ahead, MOST)
        ahead = ahead if abs(excess) < math.inf else math.nan
        converged = not result.step[lane] > 0.0
        step = abs(ahead - delta)
        result.step[lane] = 0.0 if converged else (step if step > FOUND * ahead else -1.0)
        # Newton's method converges quadratically: the remaining error is the square of the last step.
        off = (high.value_error[lane] + low.value_error[lane]) / fall + step * step
        result.delta[lane] = delta if converged else ahead
        result.delta_error[lane] = result.delta_error[lane] if converged else off
        descent = 0.5 * square * (1.0 + 0.5 * delta) * (ahead - delta) * high.other[lane]
        result.top[lane] = result.top[lane] if converged else high.value[lane] - descent
        result.top_error[lane] = result.top_error[lane] if converged else high.value_error[lane]
    return any_positive(result.step)


@routine
def find_fluctuation(record: Record, steady: SteadyWheel, search: Search, ends: SpeedEnds, result: Fluctuation) -> None:
    """Find the coefficient of speed fluctuation of each lane.

    Parameters
    ----------
    record : Record
        Packed.
    steady : SteadyWheel
    search : Search
        Scratch.
    ends : SpeedEnds
        Scratch.
    result : Fluctuation
        Output; NaN if the machine would stop within the cycle.
    """
    fill(result, _ROWS, 0.0)
    for lane in range(LANES):
        result.step[lane] = 1.0
    for _ in range(MOST_STEPS):
        _slopes(steady.omega, result)
        fast = SoughtExtreme(steady.work, steady.inertia, result.fast, search.up, steady.period)
        slow = SoughtExtreme(steady.work, steady.inertia, result.slow, search.down, steady.period)
        find_extreme(record, fast, search, ends.high)
        find_extreme(record, slow, search, ends.low)
        if not _improve(steady, record.whole[steady.inertia].first, ends, result):
            break
    for part in range(_ROWS):
        for lane in range(LANES):
            known = abs(result.delta[lane]) < math.inf
            result[part, lane] = result[part, lane] if known else math.nan


@routine
def add_speed(record: Record, steady: SteadyWheel, ends: SpeedEnds, result: Fluctuation, speed: int) -> None:
    """Compute the speed over the steady cycle, ω = √(2 E/(I + I_F)), as another kept curve.

    Parameters
    ----------
    record : Record
    steady : SteadyWheel
    ends : SpeedEnds
        Scratch.
    result : Fluctuation
        Output of `find_fluctuation`.
    speed : int
        Curve of the record that receives the magnitude of the speed.
    """
    omega, flywheel, slowest = steady.omega, steady.flywheel, ends.slowest
    work, inertia = record.whole[steady.work], record.whole[steady.inertia]
    for step in range(record.steps[0]):
        slot, half = step * record.curves, record.panels[step].half
        of_work, of_inertia = record.values[slot + steady.work], record.values[slot + steady.inertia]
        of_speed, tail = record.values[slot + speed], record.left[slot + speed].tail
        work_tail, inertia_tail = record.left[slot + steady.work].tail, record.left[slot + steady.inertia].tail
        for lane in range(LANES):
            slowest[lane] = math.inf
        for j in range(record.degree + 1):
            for lane in range(LANES):
                fastest = omega[lane] * (1.0 + 0.5 * result.delta[lane])
                first = 0.5 * fastest * fastest * (inertia.first[lane] + flywheel[lane]) - result.top[lane]
                inert = of_inertia[j, lane] + flywheel[lane]
                here = math.sqrt(2.0 * (first + of_work[j, lane]) / inert)
                of_speed[j, lane] = here
                slowest[lane] = smaller(here * inert, slowest[lane])
        keep_derived(record, step, speed)
        for lane in range(LANES):
            square = omega[lane] * omega[lane]
            inert = inertia.scale[lane] + abs(flywheel[lane])
            of_energy = result.top_error[lane] + 2.0 * square * inert * result.delta_error[lane]
            of_energy += work.offset[lane] + work_tail[lane]
            of_energy += square * inertia_tail[lane] + ROUNDING * (work.scale[lane] + square * inert)
            tail[lane] += of_energy / slowest[lane] if half[lane] != 0.0 else 0.0
