"""Curves sampled at the positions of panels, as arrays: convergence of their polynomials, integrals, peaks.

For NumPy evaluations; a machine's cycle has the same in lanes.
"""

from typing import NamedTuple

import numpy as np

from engine.cycle.panels.chebyshev import COARSE, DEGREE, PLACES, POSITIONS, SHARES, shares_of
from engine.cycle.regula_falsi import regula_falsi
from engine.laws.rounding import EPS

# Number of last coefficients by which convergence is judged.
_LAST = 3
_SHARES_OF = {degree: shares_of(degree) for degree in (COARSE // 2, COARSE, DEGREE)}
_FINER = np.polynomial.chebyshev.chebvander(PLACES, COARSE) @ _SHARES_OF[COARSE]
_K = np.arange(POSITIONS)
_OF_T = np.where(_K % 2 == 0, 2.0 / (1.0 - np.where(_K % 2 == 0, _K, 0) ** 2.0), 0.0)
_WEIGHTS = (_OF_T @ SHARES)[None]
_NEWTON_STEPS = 6
# Second derivatives below this multiple of the noise are rounding.
_BENT = 1024
# Last coefficients of a curve resolved to rounding, relative to its magnitude.
_ROUNDING = 64 * EPS


class Tops(NamedTuple):
    """Maxima of polynomials (panels,), their positions on [−1, 1], and the magnitudes of the second derivatives.

    A second derivative is infinite at an end where the curve is steep or constant: the position is sharp.
    """

    values: np.ndarray
    places: np.ndarray
    bends: np.ndarray


def weighted_sums(weights: np.ndarray, values: np.ndarray) -> np.ndarray:
    """Weighted sums over the positions (weights, …), in their order for any number of panels."""
    return sum(np.multiply.outer(weights[:, j], values[..., j]) for j in range(weights.shape[1]))


def tails(values: np.ndarray, degree: int = DEGREE) -> np.ndarray:
    """Largest of the last coefficients of polynomials (…): an estimate of their truncation error.

    Parameters
    ----------
    values : ndarray (…, degree + 1)
    degree : int
        DEGREE, COARSE, or half of this.
    """
    return last_coefficients(values, degree).max(axis=0)


def last_coefficients(values: np.ndarray, degree: int = DEGREE) -> np.ndarray:
    """Magnitudes of the last three coefficients of polynomials, (3, …); parameters as for `tails`."""
    return np.abs(weighted_sums(_SHARES_OF[degree][-_LAST:], values))


def finer(values: np.ndarray) -> np.ndarray:
    """Polynomials of degree COARSE (…, COARSE + 1) at all POSITIONS, those known and constants exactly."""
    first = values[..., :1]
    found = first + np.moveaxis(weighted_sums(_FINER, values - first), 0, -1)
    found[..., ::2] = values
    return found


def panel_integrals(values: np.ndarray) -> np.ndarray:
    """Integrals of polynomials over [−1, 1] (…).

    Parameters
    ----------
    values : ndarray (…, POSITIONS)
    """
    return weighted_sums(_WEIGHTS, values)[0]


def root_inside(values: np.ndarray) -> np.ndarray:
    """Positions (panels,) on [−1, 1] where curves change sign between their inner positions; 0 for none.

    A curve that its polynomial doesn't resolve to rounding gets 0, too.

    Parameters
    ----------
    values : ndarray (panels, POSITIONS)
    """
    inner = values[:, 1:-1]
    k = 1 + np.argmax(inner[:, :-1] * inner[:, 1:] < 0.0, axis=1)
    here, after = (np.take_along_axis(values, i[:, None], axis=1)[:, 0] for i in (k, k + 1))
    series = weighted_sums(SHARES, values)
    x = regula_falsi(lambda x: _at(x, series), PLACES[k], PLACES[k + 1])
    follows = tails(values) <= _ROUNDING * np.abs(values).max(axis=1)
    return np.where(follows & (here * after < 0.0), x, 0.0)


def _at(place: np.ndarray, series: np.ndarray) -> np.ndarray:
    return np.polynomial.chebyshev.chebval(place, series, tensor=False)


def tops(values: np.ndarray, noise: np.ndarray) -> Tops:
    """Maxima of polynomials, also between the positions; the first of equal ones.

    Parameters
    ----------
    values : ndarray (panels, POSITIONS)
        Sampled densely enough that each maximum is next to the largest value.
    noise : ndarray (panels,)
        Values that differ by less are equal.
    """
    series = weighted_sums(SHARES, values)
    k = np.argmax(values >= (values.max(axis=1) - noise)[:, None], axis=1)
    x, low, high = PLACES[k], PLACES[np.maximum(k - 1, 0)], PLACES[np.minimum(k + 1, DEGREE)]
    slope, bend = (np.polynomial.chebyshev.chebder(series, m) for m in (1, 2))
    for _ in range(_NEWTON_STEPS):
        rate, turn = _at(x, slope), _at(x, bend)
        x = np.where(turn < 0.0, np.clip(x - rate / turn, low, high), x)
    found, sampled = _at(x, series), np.take_along_axis(values, k[:, None], axis=1)[:, 0]
    better = found > sampled + noise
    x = np.where(better, x, PLACES[k])
    rate, turn = np.abs(_at(x, slope)), np.abs(_at(x, bend))
    sharp = (np.abs(x) == 1.0) & ((rate * rate > 2.0 * turn * noise) | (turn < _BENT * noise))
    return Tops(np.where(better, found, sampled), x, np.where(sharp, np.inf, turn))
