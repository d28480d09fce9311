"""Mean and mean square over the cycle of curves that follow from others, such as angles, works and speeds."""

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.record import HALF, OFFSET, SCALE, TAIL, Record
from engine.cycle.panels.series import MISSING, SUM, panel_figures
from engine.cycle.panels.transforms import SHIFTED

# Rows of the result: mean, what it may be off by, the same of the square; the length of the range.
MEAN, MEAN_ERROR, SQUARE, SQUARE_ERROR, LENGTH = range(5)
AVERAGES = 5


@routine
def _add(record: Record, step: int, figures: Memory, offset: Memory, row: int, result: Memory) -> None:
    for lane in range(LANES):
        half, total, error = record.panels[step, HALF, lane], result[row, lane], result[row + 1, lane]
        taken = half != 0.0
        result[row, lane] = total + half * figures[0, SUM, lane] if taken else total
        off = abs(half) * (figures[0, MISSING, lane] + 2.0 * offset[lane])
        result[row + 1, lane] = error + off if taken else error


@routine
def find_averages(record: Record, steps: int, curve: int, figures: Memory, offset: Memory, result: Memory) -> None:
    """Mean and mean square of a curve of the record.

    Parameters
    ----------
    record : Record
    steps : int
        How many steps the record has.
    curve : int
    figures : rows (1, FIGURES, LANES)
        Used meanwhile.
    offset : row (LANES,)
        Used meanwhile.
    result : rows (AVERAGES, LANES)
        Receives them.
    """
    values, work = record.values, record.work
    for part in range(AVERAGES):
        for lane in range(LANES):
            result[part, lane] = 0.0
    for step in range(steps):
        slot = step * record.curves + curve
        for lane in range(LANES):
            scale = record.whole[curve, SCALE, lane]
            offset[lane] = record.whole[curve, OFFSET, lane] + record.errors[slot, TAIL, lane] + ROUNDING * scale
            result[LENGTH, lane] += 2.0 * record.panels[step, HALF, lane]
        panel_figures(values, slot, figures, 0)
        _add(record, step, figures, offset, MEAN, result)
        for j in range(POSITIONS):
            for lane in range(LANES):
                work[SHIFTED, j, lane] = values[slot, j, lane] * values[slot, j, lane]
        for lane in range(LANES):
            offset[lane] *= 2.0 * record.whole[curve, SCALE, lane]
        panel_figures(work, SHIFTED, figures, 0)
        _add(record, step, figures, offset, SQUARE, result)
    for lane in range(LANES):
        length = result[LENGTH, lane]
        for part in range(LENGTH):
            result[part, lane] /= abs(length) if (part == MEAN_ERROR) | (part == SQUARE_ERROR) else length
