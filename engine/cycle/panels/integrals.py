"""Integrals over the cycle, added up panel by panel, with what they may be off by."""

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE
from engine.cycle.panels.lanes import Memory, memory
from engine.cycle.panels.series import MAGNITUDE, MISSING, SUM
from engine.cycle.panels.walk import ACCEPTED, CLOSE, HALF, OPENED

# Rows of an integral; the last one is the curve's value at the end of the last panel.
VALUE, ERROR, END = range(3)
INTEGRAL = 3
of_integrals = memory(INTEGRAL, LANES)
# What values of a curve and weighted sums of them are off by, as a share of the greatest magnitude.
ROUNDING = 12.0 * np.finfo(np.float64).eps


@routine
def add_panels(tile: Memory, figures: Memory, curve: int, walk: Memory, integrals: Memory, k: int) -> None:
    """Add the accepted panels' share to the integral of a curve.

    Where a curve jumps at an edge, it does so within what the edge's place may be off by.

    Parameters
    ----------
    tile : panels (curves, POSITIONS, LANES)
    figures : rows (curves, FIGURES, LANES)
    curve : int
    walk : rows (WALK, LANES)
    integrals : rows (integrals, INTEGRAL, LANES)
    k : int
        Which of them.
    """
    for lane in range(LANES):
        half, accepted = walk[HALF, lane], walk[ACCEPTED, lane] > 0.0
        share = half * figures[curve, SUM, lane]
        # Rounding of values, and of the places of the panel's ends.
        noise = figures[curve, MAGNITUDE, lane] * (2.0 * ROUNDING * abs(half) + 0.5 * walk[CLOSE, lane])
        off = abs(half) * figures[curve, MISSING, lane] + noise
        off += abs(tile[curve, 0, lane] - integrals[k, END, lane]) * walk[OPENED, lane]
        integrals[k, VALUE, lane] += share if accepted else 0.0
        integrals[k, ERROR, lane] += off if accepted else 0.0
        integrals[k, END, lane] = tile[curve, DEGREE, lane] if accepted else integrals[k, END, lane]
