"""Cosine and sine of angles by polynomials: unlike those of the C library they are computed for many lanes at once."""

import math

import numpy as np

from engine.cycle.chebyshev import DEGREE, MIDDLE, PLACES
from engine.cycle.compiling import routine, scalar
from engine.cycle.lanes import LANES, Memory


@scalar
def near_zero(r: float) -> tuple[float, float]:
    """Cosine and sine of an angle of at most π/4, to the last bit or two; the polynomials are those of Cephes."""
    z = r * r
    p = -2.50507477628578072866e-8 + z * 1.58962301576546568060e-10
    p = -1.98412698295895385996e-4 + z * (2.75573136213857245213e-6 + z * p)
    sine = r + r * z * (-1.66666666666666307295e-1 + z * (8.33333333332211858878e-3 + z * p))
    p = 2.08757008419747316778e-9 - z * 1.13585365213876817300e-11
    p = 2.48015872888517045348e-5 + z * (-2.75573141792967388112e-7 + z * p)
    cosine = 1.0 - 0.5 * z + z * z * (4.16666666666665929218e-2 + z * (-1.38888888888730564116e-3 + z * p))
    return cosine, sine


@scalar
def direction_of(angle: float) -> tuple[float, float]:
    """Cosine and sine of any angle [rad], to about 2e-16 for a few turns."""
    quarter = np.floor(angle * (2.0 / math.pi) + 0.5)
    # π/2 in two parts: the first has few enough digits for its multiples to be exact.
    cosine, sine = near_zero((angle - quarter * 1.57079632673412561417) - quarter * 6.07710050650619224932e-11)
    # Turned by 0 to 3 right angles.
    turns = quarter - 4.0 * np.floor(0.25 * quarter)
    odd = (turns == 1.0) | (turns == 3.0)
    c, s = (sine if odd else cosine), (cosine if odd else sine)
    return (-c if (turns == 1.0) | (turns == 2.0) else c), (-s if turns >= 2.0 else s)


@routine
def directions(count: int, q: Memory, cos_q: Memory, sin_q: Memory) -> None:
    """Cosine and sine of `count` rows of positions.

    Parameters
    ----------
    count : int
    q, cos_q, sin_q : rows (count, LANES)
    """
    for k in range(count):
        for lane in range(LANES):
            cos_q[k, lane], sin_q[k, lane] = direction_of(q[k, lane])


@scalar
def _mirrored(first: int, last: int, half: Memory, q: Memory, cos_q: Memory, sin_q: Memory) -> None:
    """Some positions of each panel and their mirror images, by sums and differences with the middle's direction."""
    for lane in range(LANES):
        middle, c, s = q[MIDDLE, lane], cos_q[MIDDLE, lane], sin_q[MIDDLE, lane]
        for j in range(first, last):
            aside = half[lane] * PLACES[DEGREE - j]
            cosine, sine = near_zero(aside)
            cc, ss, sc, cs = c * cosine, s * sine, s * cosine, c * sine
            q[j, lane], cos_q[j, lane], sin_q[j, lane] = middle - aside, cc + ss, sc - cs
            q[DEGREE - j, lane], cos_q[DEGREE - j, lane], sin_q[DEGREE - j, lane] = middle + aside, cc - ss, sc + cs


@routine
def panel_positions(middle: Memory, half: Memory, q: Memory, cos_q: Memory, sin_q: Memory) -> None:
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
