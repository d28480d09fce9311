"""Running integrals of kept curves from the first position: work of a moment about its mean, or integral of a rate.

What is constant is taken out before anything is added up, so that a constant moment does no work at all about its mean,
exactly.
"""

from typing import NamedTuple

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, PLACES, POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.record import Record
from engine.cycle.panels.series import larger
from engine.cycle.panels.transforms import to_integrals


class WorkSums(NamedTuple):
    """Used meanwhile.

    Attributes
    ----------
    total : row
        Integral of the curve less its first value.
    length : row
        Length of the range.
    reached : row
        Integral reached.
    mean : row
        Mean less the first value.
    ended : row
        Value of the curve where the last panel ended.
    within : row
        What running integrals miss at most within a panel.
    """

    total: Row
    length: Row
    reached: Row
    mean: Row
    ended: Row
    within: Row


@routine
def _less_first(values: Rows, first: Row, shifted: Rows) -> None:
    for j in range(POSITIONS):
        for lane in range(LANES):
            shifted[j, lane] = values[j, lane] - first[lane]


@routine
def _add_total(integrals: Rows, half: Row, sums: WorkSums) -> None:
    for lane in range(LANES):
        sums.total[lane] += half[lane] * integrals[DEGREE, lane] if half[lane] != 0.0 else 0.0
        sums.length[lane] += 2.0 * half[lane]


@routine
def _from_first(integrals: Rows, half: Row, sums: WorkSums) -> None:
    """From integrals over [−1, x] of one panel to those of the curve less its mean from the first position."""
    for j in range(POSITIONS):
        for lane in range(LANES):
            work = half[lane] * (integrals[j, lane] - sums.mean[lane] * (1.0 + PLACES[j]))
            integrals[j, lane] = sums.reached[lane] + (work if half[lane] != 0.0 else 0.0)
    for lane in range(LANES):
        sums.reached[lane] = integrals[DEGREE, lane]


@routine
def _errors(record: Record, step: int, moment: int, work: int, sums: WorkSums) -> None:
    """What lies beyond the series of the work in a panel, and what its values may be off by.

    Where the moment jumps at a cut, it does so within what the cut's place may be off by.
    """
    slot, panels = step * record.curves, record.panels[step]
    values, left, of_work = record.values[slot + moment], record.left[slot + moment], record.left[slot + work]
    scale, offset = record.whole[moment].scale, record.whole[work].offset
    for lane in range(LANES):
        half, ended = abs(panels.half[lane]), sums.ended[lane]
        tail = half * left.tail[lane] / DEGREE
        of_work.tail[lane] = tail
        sums.within[lane] = larger(tail, sums.within[lane]) if half > 0.0 else sums.within[lane]
        off = half * (left.missing[lane] + 2.0 * ROUNDING * scale[lane])
        off += abs(values[0, lane] - ended) * panels.opened[lane]
        offset[lane] += off if half > 0.0 else 0.0
        sums.ended[lane] = values[DEGREE, lane] if half > 0.0 else ended


@routine
def add_work(record: Record, moment: int, about_mean: int, work: int, sums: WorkSums) -> None:
    """Enter the running integral of a kept curve as another kept curve.

    Parameters
    ----------
    record : Record
    moment : int
        Curve of the record.
    about_mean : int
        Whether its mean is taken out, 1 or 0.
    work : int
        Curve of the record that receives the integral.
    sums : WorkSums
        Used meanwhile.
    """
    first, offset, tiles = record.whole[moment].first, record.whole[work].offset, record.work
    for lane in range(LANES):
        sums.total[lane] = sums.length[lane] = sums.reached[lane] = 0.0
        sums.ended[lane] = sums.within[lane] = 0.0
    for step in range(record.steps[0]):
        slot = step * record.curves
        _less_first(record.values[slot + moment], first, tiles.shifted)
        to_integrals(record.to_integrals, tiles, record.values[slot + work])
        _add_total(record.values[slot + work], record.panels[step].half, sums)
    for lane in range(LANES):
        mean = sums.total[lane] / sums.length[lane]
        sums.mean[lane] = mean if about_mean == 1 else -first[lane]
    for step in range(record.steps[0]):
        _from_first(record.values[step * record.curves + work], record.panels[step].half, sums)
        _errors(record, step, moment, work, sums)
    for lane in range(LANES):
        offset[lane] += sums.within[lane]
