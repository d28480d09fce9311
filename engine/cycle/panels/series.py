"""Chebyshev series of a curve on a panel: its integral, its remainder beyond degree 16, its values anywhere.

The coefficients of a smooth curve finally decay by a constant factor. The ratio of the last three to those eight
degrees lower gives this factor, and so the coefficients beyond degree 16. These also give the error of the integral,
which is far smaller, because the rule for degree 16 is nearly exact for the next few degrees. Where coefficients don't
decay, because they are rounding or the panel has a kink or a jump inside, a decay by SLOWEST is assumed.
"""

import math
from typing import NamedTuple

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.compiling.instructions import held
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, EVEN, MIDDLE, MISSED, ODD, WEIGHTS


class Figures(NamedTuple):
    """Figures of a curve on a panel.

    Attributes
    ----------
    sum : row
        Integral over [−1, 1] by the quadrature weights.
    tail, missing : row
        Estimated remainder of the curve and of that integral beyond degree 16.
    magnitude : row
        Maximum magnitude.
    flat : row
        1 if the last coefficients don't decay, else 0.
    """

    sum: Row
    tail: Row
    missing: Row
    magnitude: Row
    flat: Row


# Slowest assumed decay from one coefficient to the next.
SLOWEST = 0.85
# The last coefficients count as level if they are at least this fraction of those eight degrees lower; for a kink they
# are a fifth of them, for a jump two fifths.
LEVEL = 0.5
# Safety factor on the extrapolated remainder; of random curves, one in a thousand exceeds it.
MARGIN = 3.0
# The coefficients of a kink, a fifth of those eight degrees lower, decay by a power of the degree, and hardly at all
# for a kink at the end of a panel. Above this ratio, the integral's remainder is taken to be as large as the curve's.
KINKED = 0.1
TINY = 1e-300


@inlined
def larger(a: float, b: float) -> float:
    """The larger of two numbers in one instruction; b if either is NaN."""
    a, b = held(a), held(b)
    return a if a > b else b


@inlined
def smaller(a: float, b: float) -> float:
    """The smaller of two numbers in one instruction; b if either is NaN."""
    a, b = held(a), held(b)
    return a if a < b else b


@routine
def panel_figures(curve: Rows, bent: Row, figures: Figures) -> None:
    """Compute the figures of a curve on each lane's panel.

    Parameters
    ----------
    curve : rows (POSITIONS, LANES)
    bent : row
        1 if the panel is known to have a kink inside: its coefficients are then taken for a kink's, however small they
        are relative to the curve's own; else 0.
    figures : Figures
        Output.
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
    """Value of a lane's series at x, by Clenshaw's recurrence."""
    b = b_before = 0.0
    for i in range(DEGREE):
        b, b_before = series[DEGREE - i, lane] + ((x + x) * b - b_before), b
    return series[0, lane] + (x * b - b_before)
