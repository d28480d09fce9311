"""The Chebyshev series of a curve within a panel: its integral, what is missing beyond degree 16, its values anywhere.

The coefficients of a smooth curve fall by a constant factor in the end. By how much the last three are below those
eight degrees before them tells what the next ones would be. Those also tell how far the integral is off, of which far
less is missed: the rule for degree 16 is nearly exact for the next few. Where coefficients don't fall, as what is left
is rounding or something within the panel bends or jumps, they are taken to fall by SLOWEST.
"""

import math
from typing import NamedTuple

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.compiling.instructions import held
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, EVEN, MIDDLE, MISSED, ODD, WEIGHTS


class Figures(NamedTuple):
    """What is known of a curve in a panel.

    Attributes
    ----------
    sum : row
        Sum over the positions with the weights of the integral over [−1, 1].
    tail, missing : row
        What of the curve and of that integral lies beyond degree 16.
    magnitude : row
        Greatest magnitude.
    flat : row
        Whether the last coefficients are level (1 or 0).
    """

    sum: Row
    tail: Row
    missing: Row
    magnitude: Row
    flat: Row


# Share by which each coefficient is taken to fall at least.
SLOWEST = 0.85
# The last coefficients are level where they are no less than this share of those eight degrees before: those of a kink
# are a fifth of them, those of a jump two fifths.
LEVEL = 0.5
# By how much what is left may exceed what the fall makes of it, of random curves, in one case of a thousand.
MARGIN = 3.0
# The coefficients of a kink, a fifth of those eight degrees before, fall by a power of the degree, not by a factor; at
# the end of a panel they hardly fall. Then the integral may miss as much as the curve.
KINKED = 0.1
TINY = 1e-300


@inlined
def larger(a: float, b: float) -> float:
    """The larger of two numbers in one instruction; b where either is NaN."""
    a, b = held(a), held(b)
    return a if a > b else b


@inlined
def smaller(a: float, b: float) -> float:
    """The smaller of two numbers in one instruction; b where either is NaN."""
    a, b = held(a), held(b)
    return a if a < b else b


@routine
def panel_figures(curve: Rows, bent: Row, figures: Figures) -> None:
    """Figures of a curve in each lane's panel.

    Parameters
    ----------
    curve : rows (POSITIONS, LANES)
    bent : row
        1 where something in the panel is known to bend: its coefficients are taken for those of a kink, however small
        they are beside the curve's own; else 0.
    figures : Figures
        Receives them.
    """
    for lane in range(LANES):
        middle = curve[MIDDLE, lane]
        low = high = middle
        total = six = seven = eight = thirteen = fourteen = fifteen = sixteen = 0.0
        for j in range(MIDDLE):
            left, right = curve[j, lane], curve[DEGREE - j, lane]
            both, apart = (left - middle) + (right - middle), left - right
            total += WEIGHTS[j] * both
            six, seven, eight = six + EVEN[3, j] * both, seven + ODD[3, j] * apart, eight + EVEN[4, j] * both
            thirteen, fourteen = thirteen + ODD[6, j] * apart, fourteen + EVEN[7, j] * both
            fifteen, sixteen = fifteen + ODD[7, j] * apart, sixteen + EVEN[8, j] * both
            low, high = smaller(smaller(left, right), low), larger(larger(left, right), high)
        before = larger(larger(abs(six), abs(seven)), abs(eight))
        last = larger(larger(abs(fourteen), abs(fifteen)), abs(sixteen))
        share = last / larger(before, TINY)
        square = math.sqrt(math.sqrt(smaller(larger(share, bent[lane]), SLOWEST**8)))
        fall = math.sqrt(square)
        level = larger(abs(sixteen), fall * larger(abs(fifteen), fall * larger(abs(fourteen), fall * abs(thirteen))))
        missing = 0.0
        for i in range(MISSED.shape[0]):
            missing = square * (MISSED[MISSED.shape[0] - 1 - i] + missing)
        figures.sum[lane] = middle + middle + total
        tail = MARGIN * level * fall / (1.0 - fall)
        figures.tail[lane] = tail
        figures.missing[lane] = tail if larger(share, bent[lane]) > KINKED else MARGIN * level * missing
        figures.magnitude[lane] = larger(abs(low), abs(high))
        figures.flat[lane] = 1.0 if last >= LEVEL * before else 0.0


@inlined
def series_at(series: Rows, lane: int, x: float) -> tuple[float, float, float]:
    """Value and first two derivatives of a lane's series at x, by Clenshaw's recurrence."""
    twice = x + x
    b = b_before = d = d_before = e = e_before = 0.0
    for i in range(DEGREE):
        e, e_before = 4.0 * d + (twice * e - e_before), e
        d, d_before = 2.0 * b + (twice * d - d_before), d
        b, b_before = series[DEGREE - i, lane] + (twice * b - b_before), b
    return series[0, lane] + (x * b - b_before), b + (x * d - d_before), 2.0 * d + (x * e - e_before)


@inlined
def series_value(series: Rows, lane: int, x: float) -> float:
    """Value of a lane's series at x."""
    b = b_before = 0.0
    for i in range(DEGREE):
        b, b_before = series[DEGREE - i, lane] + ((x + x) * b - b_before), b
    return series[0, lane] + (x * b - b_before)
