"""Derived curves, such as angles, work and speeds: their averages over the cycle, and values at spaced positions."""

from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row
from engine.compiling.decorators import routine
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import fill
from engine.cycle.panels.record import Record, known_slot
from engine.cycle.panels.series import Figures, panel_figures, series_value


class Averages(NamedTuple):
    """Averages over the cycle.

    Attributes
    ----------
    mean, mean_error : row
    square, square_error : row
        Mean square.
    length : row
        Length of the range.
    offset : row
        Scratch: error of the curve's values.
    """

    mean: Row
    mean_error: Row
    square: Row
    square_error: Row
    length: Row
    offset: Row


_ROWS = len(Averages._fields)


@routine
def _add(half: Row, figures: Figures, offset: Row, total: Row, error: Row) -> None:
    for lane in range(LANES):
        taken, before, error_before = half[lane] != 0.0, total[lane], error[lane]
        total[lane] = before + half[lane] * figures.sum[lane] if taken else before
        off = abs(half[lane]) * (figures.missing[lane] + 2.0 * offset[lane])
        error[lane] = error_before + off if taken else error_before


@routine
def find_averages(record: Record, curve: int, result: Averages) -> None:
    """Compute the mean and mean square of a curve of the record."""
    whole, shifted, figures, offset = record.whole[curve], record.work.shifted, record.figures, result.offset
    fill(result, _ROWS, 0.0)
    for step in range(record.steps[0]):
        slot, half, bent = step * record.curves + curve, record.panels[step].half, record.panels[step].bent
        values, tail = record.values[slot], record.left[slot].tail
        for lane in range(LANES):
            offset[lane] = whole.offset[lane] + tail[lane] + ROUNDING * whole.scale[lane]
            result.length[lane] += 2.0 * half[lane]
        panel_figures(values, record.degree, bent, figures)
        _add(half, figures, offset, result.mean, result.mean_error)
        for j in range(record.degree + 1):
            for lane in range(LANES):
                shifted[j, lane] = values[j, lane] * values[j, lane]
        for lane in range(LANES):
            offset[lane] *= 2.0 * whole.scale[lane]
        panel_figures(shifted, record.degree, bent, figures)
        _add(half, figures, offset, result.square, result.square_error)
    for lane in range(LANES):
        length = result.length[lane]
        result.mean[lane] /= length
        result.square[lane] /= length
        result.mean_error[lane] /= abs(length)
        result.square_error[lane] /= abs(length)


# A position this fraction of half a panel beyond its end counts as its end.
BEYOND = 1e-9


@routine
def fill_spaced(
    record: Record, curve: int, first: Row, last: Row, intervals: int, begin: int, values: np.ndarray
) -> None:
    """Evaluate a curve of the record at equally spaced positions; at a jump, after the jump.

    Parameters
    ----------
    record : Record
    curve : int
    first, last : row
        Ends of the range.
    intervals : int
        Number of intervals of the range; with as many positions, the last end is excluded.
    begin : int
        Variant of the first lane.
    values : ndarray (variants, positions)
        Output.
    """
    for step in range(record.steps[0]):
        series, panels = record.coefficients[known_slot(record, curve, step)], record.panels[step]
        for lane in range(min(LANES, values.shape[0] - begin)):
            middle, half = panels.middle[lane], panels.half[lane]
            if half == 0.0:
                continue
            gap = (last[lane] - first[lane]) / intervals
            begins = (middle - half * (1.0 + BEYOND) - first[lane]) / gap
            ends = (middle + half * (1.0 + BEYOND) - first[lane]) / gap
            for k in range(max(int(np.ceil(begins)), 0), min(int(np.floor(ends)), values.shape[1] - 1) + 1):
                x = min(max((first[lane] + k * gap - middle) / half, -1.0), 1.0)
                values[begin + lane, k] = series_value(series, lane, x)
