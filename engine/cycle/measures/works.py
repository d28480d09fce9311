"""Running integrals of kept curves from the first position: work of a moment about its mean, or integral of a rate.

The initial value is subtracted before summation, so a constant moment does exactly zero work about its mean.
"""

import math
from typing import NamedTuple

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import routine
from engine.cycle.panels.chebyshev import DEGREE, PLACES
from engine.cycle.panels.integrals import ROUNDING, jump_error
from engine.cycle.panels.record import Record
from engine.cycle.panels.series import larger
from engine.cycle.panels.transforms import to_integrals


class WorkSums(NamedTuple):
    """Scratch rows for a running integral.

    Attributes
    ----------
    total : row
        Integral of the curve minus its initial value.
    length : row
        Length of the range.
    reached : row
        Running integral so far.
    mean : row
        Mean minus initial value.
    ended, before : row
        Value of the curve at the end of the last panel, NaN before the first, and half of that panel's length.
    within : row
        Maximum error of running integrals within a panel.
    """

    total: Row
    length: Row
    reached: Row
    mean: Row
    ended: Row
    before: Row
    within: Row


@routine
def _less_first(values: Rows, degree: int, first: Row, shifted: Rows) -> None:
    for j in range(degree + 1):
        for lane in range(LANES):
            shifted[j, lane] = values[j, lane] - first[lane]


@routine
def _add_total(whole: Row, half: Row, sums: WorkSums) -> None:
    for lane in range(LANES):
        sums.total[lane] += half[lane] * whole[lane] if half[lane] != 0.0 else 0.0
        sums.length[lane] += 2.0 * half[lane]


@routine
def _from_first(integrals: Rows, degree: int, half: Row, scale: Row, sums: WorkSums) -> None:
    """Turn integrals over [−1, x] of a panel into running integrals of the curve minus its mean."""
    for j in range(degree + 1):
        share = 1.0 + PLACES[DEGREE // degree * j]
        for lane in range(LANES):
            work = half[lane] * (integrals[j, lane] - sums.mean[lane] * share)
            integrals[j, lane] = sums.reached[lane] + (work if half[lane] != 0.0 else 0.0)
            scale[lane] = larger(abs(integrals[j, lane]), scale[lane])
    for lane in range(LANES):
        sums.reached[lane] = integrals[degree, lane]


@routine
def _errors(record: Record, step: int, moment: int, work: int, sums: WorkSums) -> None:
    """Estimate the remainder of the work's series in a panel, and the error of its values."""
    slot, panels = step * record.curves, record.panels[step]
    values, left, of_work = record.values[slot + moment], record.left[slot + moment], record.left[slot + work]
    scale, offset = record.whole[moment].scale, record.whole[work].offset
    for lane in range(LANES):
        half, ended = abs(panels.half[lane]), sums.ended[lane]
        tail = half * left.tail[lane] / record.degree
        of_work.tail[lane] = tail
        sums.within[lane] = larger(tail, sums.within[lane]) if half > 0.0 else sums.within[lane]
        off = half * (left.missing[lane] + 2.0 * ROUNDING * scale[lane])
        longer = larger(half, sums.before[lane])
        off += jump_error(values[0, lane] - ended, panels.opened[lane], longer) if ended == ended else 0.0
        offset[lane] += off if half > 0.0 else 0.0
        sums.ended[lane] = values[record.degree, lane] if half > 0.0 else ended
        sums.before[lane] = half if half > 0.0 else sums.before[lane]


@routine
def add_work(record: Record, moment: int, about_mean: int, work: int, sums: WorkSums) -> None:
    """Compute the running integral of a kept curve as another kept curve.

    Parameters
    ----------
    record : Record
    moment : int
        Curve of the record.
    about_mean : int
        1 to subtract the mean, else 0.
    work : int
        Curve of the record that receives the integral.
    sums : WorkSums
        Scratch.
    """
    first, offset, tiles = record.whole[moment].first, record.whole[work].offset, record.work
    for lane in range(LANES):
        sums.total[lane] = sums.length[lane] = sums.reached[lane] = 0.0
        sums.ended[lane], sums.before[lane], sums.within[lane] = math.nan, 0.0, 0.0
    for step in range(record.steps[0]):
        slot = step * record.curves
        _less_first(record.values[slot + moment], record.degree, first, tiles.shifted)
        to_integrals(record.to_integrals, tiles, record.values[slot + work])
        _add_total(record.values[slot + work, record.degree], record.panels[step].half, sums)
    for lane in range(LANES):
        mean = sums.total[lane] / sums.length[lane]
        sums.mean[lane] = mean if about_mean == 1 else -first[lane]
    for step in range(record.steps[0]):
        integrals, half = record.values[step * record.curves + work], record.panels[step].half
        _from_first(integrals, record.degree, half, record.whole[work].scale, sums)
        _errors(record, step, moment, work, sums)
    for lane in range(LANES):
        offset[lane] += sums.within[lane]
