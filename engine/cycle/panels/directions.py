"""Cosine and sine of positions, lanes side by side."""

import numpy as np

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, MIDDLE, PLACES
from engine.laws.elementary import direction_near_zero, direction_of

# By what share of itself the direction of a position is changed by its rounding.
ROUNDED = 2.0 * np.finfo(np.float64).eps


@routine
def directions(count: int, q: Rows, cos_q: Rows, sin_q: Rows) -> None:
    """Cosine and sine of `count` rows of positions.

    Parameters
    ----------
    count : int
    q, cos_q, sin_q : rows (count, LANES)
    """
    for k in range(count):
        for lane in range(LANES):
            cos_q[k, lane], sin_q[k, lane] = direction_of(q[k, lane])


@inlined
def _mirrored(first: int, last: int, half: Row, q: Rows, cos_q: Rows, sin_q: Rows) -> None:
    """Some positions of each panel and their mirror images, by sums and differences with the middle's direction."""
    for lane in range(LANES):
        middle, c, s = q[MIDDLE, lane], cos_q[MIDDLE, lane], sin_q[MIDDLE, lane]
        for j in range(first, last):
            aside = half[lane] * PLACES[DEGREE - j]
            cosine, sine = direction_near_zero(aside)
            cc, ss, sc, cs = c * cosine, s * sine, s * cosine, c * sine
            q[j, lane], cos_q[j, lane], sin_q[j, lane] = middle - aside, cc + ss, sc - cs
            q[DEGREE - j, lane], cos_q[DEGREE - j, lane], sin_q[DEGREE - j, lane] = middle + aside, cc - ss, sc + cs


@routine
def panel_positions(middle: Row, half: Row, q: Rows, cos_q: Rows, sin_q: Rows) -> None:
    """Positions of each lane's panel with cosine and sine; where the input is an angle, of panels no longer than π/2.

    Parameters
    ----------
    middle, half : row (LANES,)
        Middle of the panel and half its length, negative where the input runs backwards.
    q, cos_q, sin_q : rows (POSITIONS, LANES)
        Receive them.
    """
    for lane in range(LANES):
        q[MIDDLE, lane] = middle[lane]
        cos_q[MIDDLE, lane], sin_q[MIDDLE, lane] = direction_of(middle[lane])
    # In two: no more of an inner loop would be unrolled, and only what is unrolled runs over all lanes at once.
    _mirrored(0, 4, half, q, cos_q, sin_q)
    _mirrored(4, 8, half, q, cos_q, sin_q)


@routine
def change_by_rounding(
    row: int, q: Rows, cos_q: Rows, sin_q: Rows, k: int, q_beside: Rows, cos_beside: Rows, sin_beside: Rows
) -> None:
    """Enter a row of positions as row k of others, changed by its rounding, with cosine and sine.

    Parameters
    ----------
    row : int
    q, cos_q, sin_q : rows (positions, LANES)
    k : int
    q_beside, cos_beside, sin_beside : rows (positions, LANES)
        Receive it.
    """
    for lane in range(LANES):
        q_beside[k, lane] = q[row, lane] * (1.0 + ROUNDED)
        cos_beside[k, lane] = cos_q[row, lane] * (1.0 + ROUNDED)
        sin_beside[k, lane] = sin_q[row, lane] * (1.0 - ROUNDED)
