"""Directions followed over the cycle: the angle of a vector of two kept curves, continuous from its first position on.

From one position to the next the vector turns by less than half a turn, within a panel and from panel to panel.
"""

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.record import HALF, OFFSET, SCALE, TAIL, Record, keep_derived
from engine.cycle.panels.series import TINY, larger, smaller
from engine.laws.elementary import angle_of

# Rows used meanwhile: the angle reached and the vector there; the shortest vector of a panel.
_REACHED, _X, _Y, _SHORTEST = range(4)
ANGLE_ROWS = 4


@routine
def _begin(state: Memory) -> None:
    """Before the first position: angles are counted from the direction of the first axis."""
    for lane in range(LANES):
        state[_REACHED, lane] = state[_Y, lane] = 0.0
        state[_X, lane] = 1.0


@routine
def _follow(values: Memory, of_x: int, of_y: int, panels: Memory, step: int, angle: int, state: Memory) -> None:
    """Angles at the positions of a step; lanes without a panel there stay where they are."""
    for lane in range(LANES):
        state[_SHORTEST, lane] = np.inf
    for j in range(POSITIONS):
        for lane in range(LANES):
            x, y, x_before, y_before = values[of_x, j, lane], values[of_y, j, lane], state[_X, lane], state[_Y, lane]
            reached, shortest, size = state[_REACHED, lane], state[_SHORTEST, lane], np.sqrt(x * x + y * y)
            turned = angle_of(x_before * x + y_before * y, x_before * y - y_before * x)
            # A vector without length doesn't turn.
            turned = 0.0 if size == 0.0 else turned
            taken = (panels[step, HALF, lane] != 0.0) & (size != 0.0)
            values[angle, j, lane] = reached + turned
            state[_REACHED, lane] = reached + turned if taken else reached
            state[_X, lane], state[_Y, lane] = x if taken else x_before, y if taken else y_before
            state[_SHORTEST, lane] = smaller(size, shortest) if panels[step, HALF, lane] != 0.0 else shortest


@routine
def add_angle(record: Record, steps: int, x: int, y: int, angle: int, figures: Memory, state: Memory) -> None:
    """Enter the angle of a vector of two kept curves as another kept curve [rad].

    Parameters
    ----------
    record : Record
    steps : int
        How many steps the record has.
    x, y : int
        Curves of the record.
    angle : int
        Curve of the record that receives the angle.
    figures : rows (1, FIGURES, LANES)
        Used meanwhile.
    state : rows (ANGLE_ROWS, LANES)
        Used meanwhile.
    """
    values, errors, whole, panels = record.values, record.errors, record.whole, record.panels
    _begin(state)
    for step in range(steps):
        slot = step * record.curves
        of_x, of_y, of_angle = slot + x, slot + y, slot + angle
        _follow(values, of_x, of_y, panels, step, of_angle, state)
        keep_derived(record, step, angle, figures)
        for lane in range(LANES):
            rounding = ROUNDING * larger(whole[x, SCALE, lane], whole[y, SCALE, lane])
            rounding += whole[x, OFFSET, lane] + whole[y, OFFSET, lane]
            tail, shortest = errors[of_x, TAIL, lane] + errors[of_y, TAIL, lane], larger(state[_SHORTEST, lane], TINY)
            errors[of_angle, TAIL, lane] += smaller(tail / shortest, np.pi)
            whole[angle, OFFSET, lane] = larger(smaller(rounding / shortest, np.pi), whole[angle, OFFSET, lane])
