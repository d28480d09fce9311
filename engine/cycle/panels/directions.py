"""Cosine and sine of positions, side by side in lanes."""

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.chebyshev import COARSE, DEGREE, PLACES
from engine.laws.elementary import direction_near_zero, direction_of
from engine.laws.rounding import EPS

# Relative perturbation by which the effect of a position's rounding is measured.
ROUNDED = 2.0 * EPS


@routine
def directions(count: int, q: Rows, cos_q: Rows, sin_q: Rows) -> None:
    """Compute cosine and sine of `count` rows of positions.

    Parameters
    ----------
    count : int
    q, cos_q, sin_q : rows (count, LANES)
        Positions [rad]; outputs.
    """
    for k in range(count):
        for lane in range(LANES):
            cos_q[k, lane], sin_q[k, lane] = direction_of(q[k, lane])


@inlined
def _mirrored(first: int, last: int, degree: int, half: Row, q: Rows, cos_q: Rows, sin_q: Rows) -> None:
    """Compute positions `first` … `last` − 1 of each panel and their mirror images by the addition theorems."""
    for lane in range(LANES):
        middle, c, s = q[degree // 2, lane], cos_q[degree // 2, lane], sin_q[degree // 2, lane]
        for j in range(first, last):
            distance = half[lane] * PLACES[DEGREE - DEGREE // degree * j]
            cosine, sine = direction_near_zero(distance)
            cc, ss, sc, cs = c * cosine, s * sine, s * cosine, c * sine
            q[j, lane], cos_q[j, lane], sin_q[j, lane] = middle - distance, cc + ss, sc - cs
            q[degree - j, lane], cos_q[degree - j, lane], sin_q[degree - j, lane] = middle + distance, cc - ss, sc + cs


@routine
def panel_positions(middle: Row, half: Row, degree: int, q: Rows, cos_q: Rows, sin_q: Rows) -> None:
    """Compute the positions of each lane's panel with cosine and sine; a panel over an angle is at most π/2 long.

    Parameters
    ----------
    middle, half : row (LANES,)
        Middle and half length of the panel, negative if the input runs backwards.
    degree : int
        DEGREE or COARSE.
    q, cos_q, sin_q : rows (degree + 1, LANES)
        Outputs.
    """
    for lane in range(LANES):
        q[degree // 2, lane] = middle[lane]
        cos_q[degree // 2, lane], sin_q[degree // 2, lane] = direction_of(middle[lane])
    # Two calls, because the compiler unrolls no longer inner loop, and vectorises over the lanes only unrolled loops.
    if degree == DEGREE:
        _mirrored(0, 4, DEGREE, half, q, cos_q, sin_q)
        _mirrored(4, 8, DEGREE, half, q, cos_q, sin_q)
    else:
        _mirrored(0, 4, COARSE, half, q, cos_q, sin_q)


@routine
def change_by_rounding(
    row: int, q: Rows, cos_q: Rows, sin_q: Rows, k: int, q_beside: Rows, cos_beside: Rows, sin_beside: Rows
) -> None:
    """Copy a row of positions with cosine and sine to row k of the outputs, perturbed by their rounding.

    Parameters
    ----------
    row : int
    q, cos_q, sin_q : rows (positions, LANES)
    k : int
    q_beside, cos_beside, sin_beside : rows (positions, LANES)
        Outputs.
    """
    for lane in range(LANES):
        q_beside[k, lane] = q[row, lane] * (1.0 + ROUNDED)
        cos_beside[k, lane] = cos_q[row, lane] * (1.0 + ROUNDED)
        sin_beside[k, lane] = sin_q[row, lane] * (1.0 - ROUNDED)
