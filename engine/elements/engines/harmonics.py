"""Harmonics of the slider-crank: the piston's acceleration, to any order.

The crank r is at the angle theta from the cylinder's axis; the piston's line of motion is offset by e from the crank
axis (0 in most engines; a désaxé engine has an offset). With λ = r/l and ε = e/l the piston is at

    x = r cos theta + l √(1 − (λ sin theta − ε)²),   −ẍ/(r ω²) = Re Σ c_n exp(i n theta)

Without an offset c_n = A_n is real, A_1 = 1, the other odd orders vanish, and

    A_2 = λ + λ³/4 + 15 λ⁵/128 + …,  A_4 = −λ³/4 − 3 λ⁵/16 − …,  A_6 = 9 λ⁵/128 + …

The series are not summed: x is smooth and periodic, so a discrete Fourier transform over N positions has an aliasing
error of the order of exp(−(N − n) a), with cosh a = (1 − |ε|)/λ at the nearest singularity of the motion in the complex
plane. N is chosen by that bound; the remaining error is rounding, about n² ulp of x/r.

Sources: C. F. Taylor, The Internal-Combustion Engine in Theory and Practice, vol. 2 (engine balance and vibration);
J. P. Den Hartog, Mechanical Vibrations (multicylinder engines).
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike

# −ln(eps), and the fewest and most positions: enough up to λ + |ε| = 1 − 3e-6; beyond, the result is NaN.
_DIGITS = 37.0
FEWEST, MOST = 32, 2**14
# Array elements in memory at a time.
_BLOCK = 2**18


@np.errstate(divide="ignore", invalid="ignore")
def crank_radius(stroke: ArrayLike, rod: ArrayLike, offset: ArrayLike = 0.0) -> np.ndarray:
    """Crank radius for a given stroke: half of it, slightly less with an offset.

    From s = √((l + r)² − e²) − √((l − r)² − e²): r² = ¼ s² (l² − e² − ¼ s²)/(l² − ¼ s²).

    Parameters
    ----------
    stroke, rod, offset : array_like (...)
        s, l and e [m].

    Returns
    -------
    ndarray (...)
        [m]; NaN if the stroke is impossible.
    """
    half, rod, offset = np.divide(stroke, 2.0), np.asarray(rod, float), np.asarray(offset, float)
    left = rod**2 - half**2
    return half * np.sqrt((left - offset**2) / left)


def piston_harmonics(ratio: ArrayLike, orders: Sequence[int], offset: ArrayLike = 0.0) -> np.ndarray:
    """Harmonics c_n of the piston's acceleration, −ẍ/(r ω²) = Re Σ c_n exp(i n theta).

    Parameters
    ----------
    ratio, offset : array_like (...)
        λ = r/l and ε = e/l; the crank can rotate if λ + |ε| < 1.
    orders : sequence of int
        From 1.

    Returns
    -------
    ndarray of complex (..., orders)
        NaN if the crank cannot rotate, or λ + |ε| is too close to 1 (`MOST`).
    """
    ratio, offset = np.broadcast_arrays(np.asarray(ratio, float), np.asarray(offset, float))
    flat_ratio, flat_offset = ratio.ravel(), offset.ravel()
    with np.errstate(invalid="ignore", divide="ignore"):
        decay = np.arccosh((1 - np.abs(flat_offset)) / np.abs(flat_ratio))
        needed = np.maximum(max(orders) + _DIGITS / decay, 2 * max(orders) + 1)
    found = np.full((flat_ratio.size, len(orders)), complex(np.nan, np.nan))
    positions = FEWEST
    left = np.isfinite(needed)
    while positions <= MOST and left.any():
        here = left & (needed <= positions)
        left &= ~here
        theta = math.tau * np.arange(positions) / positions
        blocks = -(-here.sum() * positions // _BLOCK)
        for some in np.array_split(np.flatnonzero(here), blocks) if blocks else ():
            rows = _piston(np.cos(theta), np.sin(theta), flat_ratio[some, None], flat_offset[some, None])
            found[some] = (np.fft.rfft(rows, axis=-1) * (2 / positions))[:, list(orders)]
        positions *= 2
    return found.reshape(*ratio.shape, len(orders)) * np.square(orders)


def _piston(cosine: np.ndarray, sine: np.ndarray, ratio: np.ndarray, offset: np.ndarray) -> np.ndarray:
    """x/r minus a constant; the rod's part is a quotient, which avoids cancellation for long rods."""
    root, middle = np.sqrt(1 - (ratio * sine - offset) ** 2), np.sqrt(1 - offset**2)
    return cosine - sine * (ratio * sine - 2 * offset) / (root + middle)
