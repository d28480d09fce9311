"""Running integrals of kept curves from the first position: work of a moment about its mean, or integral of a rate.

What is constant is taken out before anything is added up, so that a constant moment does no work at all about its mean,
exactly.
"""

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, PLACES, POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.record import FIRST, HALF, MISSING, OFFSET, OPENED, SCALE, TAIL, Record
from engine.cycle.panels.series import larger
from engine.cycle.panels.transforms import SHIFTED, to_integrals

# Rows used meanwhile: integral of the curve less its first value, length of the range, integral reached, mean less the
# first value; value of the curve where the last panel ended; what running integrals miss at most within a panel.
_TOTAL, _LENGTH, _REACHED, _MEAN, _ENDED, _WITHIN = range(6)
WORK_ROWS = 6


@routine
def _less_first(values: Memory, slot: int, first: Memory, shifted: Memory) -> None:
    for j in range(POSITIONS):
        for lane in range(LANES):
            shifted[SHIFTED, j, lane] = values[slot, j, lane] - first[lane]


@routine
def _add_total(integrals: Memory, slot: int, panels: Memory, step: int, sums: Memory) -> None:
    for lane in range(LANES):
        half = panels[step, HALF, lane]
        sums[_TOTAL, lane] += half * integrals[slot, DEGREE, lane] if half != 0.0 else 0.0
        sums[_LENGTH, lane] += 2.0 * half


@routine
def _from_first(integrals: Memory, slot: int, panels: Memory, step: int, sums: Memory) -> None:
    """From integrals over [−1, x] of one panel to those of the curve less its mean from the first position."""
    for j in range(POSITIONS):
        for lane in range(LANES):
            mean, half = sums[_MEAN, lane], panels[step, HALF, lane]
            work = half * (integrals[slot, j, lane] - mean * (1.0 + PLACES[j]))
            integrals[slot, j, lane] = sums[_REACHED, lane] + (work if half != 0.0 else 0.0)
    for lane in range(LANES):
        sums[_REACHED, lane] = integrals[slot, DEGREE, lane]


@routine
def _errors(record: Record, step: int, moment: int, work: int, sums: Memory) -> None:
    """What lies beyond the series of the work in a panel, and what its values may be off by.

    Where the moment jumps at a cut, it does so within what the cut's place may be off by.
    """
    of_moment, of_work = step * record.curves + moment, step * record.curves + work
    values = record.values
    for lane in range(LANES):
        half, ended = abs(record.panels[step, HALF, lane]), sums[_ENDED, lane]
        tail = half * record.errors[of_moment, TAIL, lane] / DEGREE
        record.errors[of_work, TAIL, lane] = tail
        sums[_WITHIN, lane] = larger(tail, sums[_WITHIN, lane]) if half > 0.0 else sums[_WITHIN, lane]
        off = half * (record.errors[of_moment, MISSING, lane] + 2.0 * ROUNDING * record.whole[moment, SCALE, lane])
        off += abs(values[of_moment, 0, lane] - ended) * record.panels[step, OPENED, lane]
        record.whole[work, OFFSET, lane] += off if half > 0.0 else 0.0
        sums[_ENDED, lane] = values[of_moment, DEGREE, lane] if half > 0.0 else ended


@routine
def add_work(
    record: Record, matrix: np.ndarray, steps: int, moment: int, about_mean: int, work: int, sums: Memory
) -> None:
    """Enter the running integral of a kept curve as another kept curve.

    Parameters
    ----------
    record : Record
    matrix : ndarray
        `chebyshev.TO_INTEGRALS`.
    steps : int
        How many steps the record has.
    moment : int
        Curve of the record.
    about_mean : int
        Whether its mean is taken out, 1 or 0.
    work : int
        Curve of the record that receives the integral.
    sums : rows (WORK_ROWS, LANES)
        Used meanwhile.
    """
    values, panels, whole = record.values, record.panels, record.whole
    for lane in range(LANES):
        sums[_TOTAL, lane] = sums[_LENGTH, lane] = sums[_REACHED, lane] = 0.0
        sums[_ENDED, lane] = sums[_WITHIN, lane] = 0.0
    for step in range(steps):
        slot = step * record.curves + work
        _less_first(values, step * record.curves + moment, whole[moment, FIRST], record.work)
        to_integrals(matrix, record.work, values, slot)
        _add_total(values, slot, panels, step, sums)
    for lane in range(LANES):
        mean = sums[_TOTAL, lane] / sums[_LENGTH, lane]
        sums[_MEAN, lane] = mean if about_mean == 1 else -whole[moment, FIRST, lane]
    for step in range(steps):
        _from_first(values, step * record.curves + work, panels, step, sums)
        _errors(record, step, moment, work, sums)
    for lane in range(LANES):
        whole[work, OFFSET, lane] += sums[_WITHIN, lane]
