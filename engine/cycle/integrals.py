"""Integrals over the cycle, added up panel by panel, with what they may be off by."""

import numpy as np

from engine.cycle.compiling import routine
from engine.cycle.lanes import LANES, in_lanes
from engine.cycle.panels import ACCEPTED, HALF
from engine.cycle.series import MAGNITUDE, MISSING, SUM

# Rows of an integral.
VALUE, ERROR = range(2)
INTEGRAL = 2
# What values of a curve and weighted sums of them are off by, as a share of the greatest magnitude.
ROUNDING = 4.0 * np.finfo(np.float64).eps


@routine
def add_panels(figures: np.ndarray, curve: int, walk: np.ndarray, integrals: np.ndarray, k: int) -> None:
    """Add the accepted panels' share to the integral of a curve.

    Parameters
    ----------
    figures : ndarray (curves, FIGURES, LANES)
    curve : int
    walk : ndarray (WALK, LANES)
    integrals : ndarray (integrals, INTEGRAL, LANES)
    k : int
        Which of them.
    """
    figures, walk, integrals = in_lanes(figures), in_lanes(walk), in_lanes(integrals)
    for lane in range(LANES):
        half, accepted = walk[HALF, lane], walk[ACCEPTED, lane] > 0.0
        share = half * figures[curve, SUM, lane]
        off = abs(half) * (figures[curve, MISSING, lane] + 2.0 * ROUNDING * figures[curve, MAGNITUDE, lane])
        integrals[k, VALUE, lane] += share if accepted else 0.0
        integrals[k, ERROR, lane] += off if accepted else 0.0
