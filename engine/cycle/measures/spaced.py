"""Curves of the record at equally spaced positions, as kept fields need them."""

import numpy as np

from engine.compiling.blocks import LANES, Row
from engine.compiling.decorators import routine
from engine.cycle.panels.record import Record, known_slot
from engine.cycle.panels.series import series_value

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
