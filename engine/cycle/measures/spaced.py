"""Curves of the record at equally spaced positions, as fields are kept."""

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.record import HALF, MIDDLE, Record, known_slot

# A position beyond the end of a panel by no more than this share of it is at its end.
BEYOND = 1e-9


@routine
def fill_spaced(
    record: Record,
    matrix: np.ndarray,
    steps: int,
    curve: int,
    first: Memory,
    last: Memory,
    intervals: int,
    begin: int,
    values: np.ndarray,
) -> None:
    """Values of a curve of the record at equally spaced positions; where it jumps, those after the jump.

    Parameters
    ----------
    record : Record
    matrix : ndarray
        `chebyshev.TO_COEFFICIENTS`.
    steps : int
        How many steps the record has.
    curve : int
    first, last : row (LANES,)
        The range.
    intervals : int
        Into how many parts positions divide it; where there are as many positions, its last end is left out.
    begin : int
        Variant of the first lane.
    values : ndarray (variants, positions)
        Receives them.
    """
    panels = record.panels
    for step in range(steps):
        series = record.coefficients[known_slot(record, matrix, curve, step)]
        for lane in range(min(LANES, values.shape[0] - begin)):
            middle, half = panels[step, MIDDLE, lane], panels[step, HALF, lane]
            if half == 0.0:
                continue
            gap = (last[lane] - first[lane]) / intervals
            begins = (middle - half * (1.0 + BEYOND) - first[lane]) / gap
            ends = (middle + half * (1.0 + BEYOND) - first[lane]) / gap
            for k in range(max(int(np.ceil(begins)), 0), min(int(np.floor(ends)), values.shape[1] - 1) + 1):
                x = min(max((first[lane] + k * gap - middle) / half, -1.0), 1.0)
                b = before = 0.0
                for i in range(DEGREE):
                    b, before = series[DEGREE - i, lane] + (2.0 * x * b - before), b
                values[begin + lane, k] = series[0, lane] + (x * b - before)
