"""Integrals over the cycle, summed panel by panel, with error estimates."""

from typing import NamedTuple

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.compiling.instructions import chosen
from engine.cycle.panels.series import Figures, larger
from engine.cycle.panels.walk import Walk
from engine.laws.rounding import EPS


class IntegralRows(NamedTuple):
    """An integral over the panels so far.

    Attributes
    ----------
    value, error : row
    end, length : row
        The curve's value at the end of the last panel, and half of that panel's length.
    """

    value: Row
    error: Row
    end: Row
    length: Row


# Rounding of a curve's values and of weighted sums of them, relative to the maximum magnitude.
ROUNDING = 12.0 * EPS


@inlined
def jump_error(jump: float, opened: float, half: float) -> float:
    """Error of an integral from a jump between two panels: of the edge's position, `opened`, if an edge is there.

    Without an edge a jump is rounding, or that of a switch that was missed in one of the panels, of at most half
    length `half`.
    """
    return abs(jump) * (opened if opened > 0.0 else half)


@routine
def add_panels(curve: Rows, degree: int, figures: Figures, walk: Walk, integral: IntegralRows) -> None:
    """Add the accepted panels to the integral of a curve.

    Parameters
    ----------
    curve : rows (degree + 1, LANES)
    degree : int
    figures : Figures
    walk : Walk
    integral : IntegralRows
    """
    for lane in range(LANES):
        half, accepted = walk.half[lane], walk.accepted[lane] > 0.0
        share = half * figures.sum[lane]
        # Rounding of the values and of the positions of the panel's ends.
        noise = figures.magnitude[lane] * (2.0 * ROUNDING * abs(half) + 0.5 * walk.close[lane])
        off = abs(half) * figures.missing[lane] + noise
        meets, longer = accepted & (walk.taken[lane] > 1.0), larger(abs(half), integral.length[lane])
        off += jump_error(curve[0, lane] - integral.end[lane], walk.opened[lane], longer) if meets else 0.0
        # Selected before the addition, so that the sum is rounded in the same way in any surrounding code.
        integral.value[lane] += chosen(accepted, share, 0.0)
        integral.error[lane] += chosen(accepted, off, 0.0)
        integral.end[lane] = curve[degree, lane] if accepted else integral.end[lane]
        integral.length[lane] = abs(half) if accepted else integral.length[lane]
