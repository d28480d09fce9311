"""Directions followed over the cycle: the angle of a vector of two kept curves, continuous from its first position on.

From one position to the next the vector turns by less than half a turn, within a panel and from panel to panel.
"""

from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.record import Record, keep_derived
from engine.cycle.panels.series import TINY, larger, smaller
from engine.laws.elementary import angle_of


class FollowedAngle(NamedTuple):
    """Used meanwhile.

    Attributes
    ----------
    reached : row
        The angle reached.
    x, y : row
        The vector there.
    shortest : row
        The shortest vector of a panel.
    """

    reached: Row
    x: Row
    y: Row
    shortest: Row


@routine
def _follow(of_x: Rows, of_y: Rows, half: Row, angle: Rows, state: FollowedAngle) -> None:
    """Angles at the positions of a step; lanes without a panel there stay where they are."""
    for lane in range(LANES):
        state.shortest[lane] = np.inf
    for j in range(POSITIONS):
        for lane in range(LANES):
            x, y, x_before, y_before = of_x[j, lane], of_y[j, lane], state.x[lane], state.y[lane]
            reached, shortest, size = state.reached[lane], state.shortest[lane], np.sqrt(x * x + y * y)
            turned = angle_of(x_before * x + y_before * y, x_before * y - y_before * x)
            # A vector without length doesn't turn.
            turned = 0.0 if size == 0.0 else turned
            taken = (half[lane] != 0.0) & (size != 0.0)
            angle[j, lane] = reached + turned
            state.reached[lane] = reached + turned if taken else reached
            state.x[lane], state.y[lane] = x if taken else x_before, y if taken else y_before
            state.shortest[lane] = smaller(size, shortest) if half[lane] != 0.0 else shortest


@routine
def add_angle(record: Record, x: int, y: int, angle: int, state: FollowedAngle) -> None:
    """Enter the angle of a vector of two kept curves as another kept curve [rad].

    Parameters
    ----------
    record : Record
    x, y : int
        Curves of the record.
    angle : int
        Curve of the record that receives the angle.
    state : FollowedAngle
        Used meanwhile.
    """
    values, of_x, of_y, offset = record.values, record.whole[x], record.whole[y], record.whole[angle].offset
    # Angles are counted from the direction of the first axis.
    for lane in range(LANES):
        state.reached[lane] = state.y[lane] = 0.0
        state.x[lane] = 1.0
    for step in range(record.steps[0]):
        slot = step * record.curves
        _follow(values[slot + x], values[slot + y], record.panels[step].half, values[slot + angle], state)
        keep_derived(record, step, angle)
        tail_x, tail_y, tail = record.left[slot + x].tail, record.left[slot + y].tail, record.left[slot + angle].tail
        for lane in range(LANES):
            rounding = ROUNDING * larger(of_x.scale[lane], of_y.scale[lane])
            rounding += of_x.offset[lane] + of_y.offset[lane]
            both, shortest = tail_x[lane] + tail_y[lane], larger(state.shortest[lane], TINY)
            tail[lane] += smaller(both / shortest, np.pi)
            offset[lane] = larger(smaller(rounding / shortest, np.pi), offset[lane])
