"""Chebyshev series of a curve on a panel: its integral, its remainder beyond its degree n, its values anywhere.

The coefficients of a smooth curve finally decay by a constant factor. The ratio of the last three to those n/2 degrees
lower gives this factor, and so the coefficients beyond degree n. These also give the error of the integral, which is
far smaller, because the rule for degree n is nearly exact for the next few degrees. Where coefficients don't decay,
because they are rounding or the panel has a kink or a jump inside, a decay by SLOWEST is assumed.
"""

import math
from typing import NamedTuple

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.compiling.instructions import held
from engine.cycle.panels.chebyshev import COARSE, DEGREE, MATRICES, PanelMatrices


class Figures(NamedTuple):
    """Figures of a curve on a panel.

    Attributes
    ----------
    sum : row
        Integral over [−1, 1] by the quadrature weights.
    tail, missing : row
        Estimated remainder of the curve and of that integral beyond its degree.
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
# Fastest assumed decay of coefficients up to degree COARSE: the few there are say less about those that follow.
FASTEST = 0.3
# The last coefficients count as level if they are at least this fraction of those n/2 degrees lower; for a kink they
# are a fifth of them, for a jump two fifths.
LEVEL = 0.5
# Safety factor on the extrapolated remainder; of random curves, one in a thousand exceeds it.
MARGIN = 3.0
# The coefficients of a kink, a fifth of those n/2 degrees lower, decay by a power of the degree, and scarcely at all
# for a kink at the end of a panel. Above this ratio, the integral's remainder is taken to be as large as the curve's.
KINKED = 0.1
TINY = 1e-300
_FINE, _COARSE = MATRICES[DEGREE], MATRICES[COARSE]


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
def panel_figures(curve: Rows, degree: int, bent: Row, figures: Figures) -> None:
    """Compute the figures of a curve on each lane's panel.

    Parameters
    ----------
    curve : rows (degree + 1, LANES)
    degree : int
        DEGREE or COARSE.
    bent : row
        1 if the panel is known to have a kink inside: its coefficients are then taken for a kink's, however small they
        are relative to the curve's own; else 0.
    figures : Figures
        Output.
    """
    # Loops of constant length are unrolled.
    if degree == DEGREE:
        _figures(curve, DEGREE, _FINE, bent, figures)
    else:
        _figures(curve, COARSE, _COARSE, bent, figures)


@inlined
def _figures(curve: Rows, degree: int, matrices: PanelMatrices, bent: Row, figures: Figures) -> None:
    half, even, odd, weights, missed = degree // 2, matrices.even, matrices.odd, matrices.weights, matrices.missed
    early = half // 2
    for lane in range(LANES):
        middle = curve[half, lane]
        low = high = middle
        total = early_even = early_odd = early_last = last_but_3 = last_but_2 = last_but_1 = final = 0.0
        for j in range(half):
            left, right = curve[j, lane], curve[degree - j, lane]
            both, apart = (left - middle) + (right - middle), left - right
            total += weights[j] * both
            early_even, early_odd = early_even + even[early - 1, j] * both, early_odd + odd[early - 1, j] * apart
            early_last, last_but_3 = early_last + even[early, j] * both, last_but_3 + odd[half - 2, j] * apart
            last_but_2, last_but_1 = last_but_2 + even[half - 1, j] * both, last_but_1 + odd[half - 1, j] * apart
            final += even[half, j] * both
            low, high = smaller(smaller(left, right), low), larger(larger(left, right), high)
        before = larger(larger(abs(early_even), abs(early_odd)), abs(early_last))
        last = larger(larger(abs(last_but_2), abs(last_but_1)), abs(final))
        share = larger(last / larger(before, TINY), bent[lane])
        # Over n/2 degrees the coefficients fall by `share`: over one by its root of that order.
        if degree == COARSE:
            square = math.sqrt(smaller(share, SLOWEST**4))
        else:
            square = math.sqrt(math.sqrt(smaller(share, SLOWEST**8)))
        fall = math.sqrt(square)
        level = larger(
            abs(final), fall * larger(abs(last_but_1), fall * larger(abs(last_but_2), fall * abs(last_but_3)))
        )
        missing = 0.0
        for i in range(half):
            missing = square * (missed[half - 1 - i] + missing)
        figures.sum[lane] = middle + middle + total
        fall = larger(fall, FASTEST) if degree == COARSE else fall
        tail = MARGIN * level * fall / (1.0 - fall)
        figures.tail[lane] = tail
        figures.missing[lane] = tail if share > KINKED else MARGIN * level * missing
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
