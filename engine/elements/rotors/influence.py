"""Field balancing with influence coefficients: the effect of trial weights on the vibration gives the correction.

Readings are the once-per-turn components of vibrations as complex numbers V: amplitude and phase relative to a mark on
the rotor. The response of a linear machine to unbalances W added in its planes is V = V_0 + A W. From a first run V_0
and a run with a trial weight W_k in each plane, A_sk = (V_sk - V_s0)/W_k, and the correction is C = -A⁺ V_0: the
vibration vanishes with as many readings as planes; with more readings the sum of their squares is a minimum.

Noise: if the real and imaginary parts of every reading have independent errors of standard deviation sigma, the
residual unbalance R = C + U is, to first order in sigma, a circular complex normal vector with mean 0 and covariance
E[R R*] = 2 sigma² g A⁺A⁺*, g = |1 - Σ C_k/W_k|² + Σ |C_k/W_k|². For large trial weights g approaches 1; for small ones
it grows with the square of C/W; if W is the exact correction, g = 1 for one plane. With more readings than planes this
assumes a linear machine, so that a balanced rotor does not vibrate.

Arrays of several rotors have them along the leading axes, which are free and are broadcast.

Sources: T. P. Goodman, A least-squares method for computing balance corrections, J. Eng. Ind. 86, 1964; S. S. Rao,
Mechanical Vibrations, 9.4; noise: propagation of the readings' errors through the formulas above.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

# Minimum ratio of the smallest to the largest singular value: below it only rounding distinguishes the planes.
LEAST_CONDITION = 1e-13


class Confidence(NamedTuple):
    """Residual unbalance due to noise.

    Attributes
    ----------
    covariance : ndarray of complex (..., planes, planes)
        E[R R*] of the residual unbalance [kg²·m²].
    radii : ndarray (..., planes)
        Residual of each plane that is not exceeded with the given probability [kg·m].
    """

    covariance: np.ndarray
    radii: np.ndarray


def influence_coefficients(initial: ArrayLike, trials: ArrayLike, weights: ArrayLike) -> np.ndarray:
    """Influence coefficients from trial runs, each with one weight in one plane.

    Parameters
    ----------
    initial : array_like of complex (..., readings)
        Vibration of the first run.
    trials : array_like of complex (..., planes, readings)
        Vibration with the trial weight in each plane in turn.
    weights : array_like of complex (..., planes)
        Trial weights, as unbalances [kg·m] or masses [kg].

    Returns
    -------
    ndarray of complex (..., readings, planes)
        Vibration per unbalance.
    """
    weights = np.asarray(weights)
    with np.errstate(divide="ignore", invalid="ignore"):
        rises = (np.asarray(trials) - np.asarray(initial)[..., None, :]) / weights[..., None]
    return np.swapaxes(rises, -1, -2)


def influence_correction(coefficients: ArrayLike, initial: ArrayLike) -> np.ndarray:
    """Unbalances to add, C = -A⁺ V_0.

    Parameters
    ----------
    coefficients : array_like of complex (..., readings, planes)
    initial : array_like of complex (..., readings)

    Returns
    -------
    ndarray of complex (..., planes)
        In the unit of the trial weights; NaN if a coefficient is infinite or NaN.
    """
    inverse = _pseudo_inverse(np.asarray(coefficients))
    return -(inverse @ np.asarray(initial)[..., None])[..., 0]


def residual_confidence(
    coefficients: ArrayLike, corrections: ArrayLike, weights: ArrayLike, noise: ArrayLike, probability: float
) -> Confidence:
    """Residual unbalance due to noise in the readings.

    Parameters
    ----------
    coefficients : array_like of complex (..., readings, planes)
    corrections, weights : array_like of complex (..., planes)
        Corrections found, and the trial weights.
    noise : array_like (...)
        Standard deviation sigma of the real and of the imaginary part of a reading.
    probability : float
        Probability that the residual is within the radii, 0 … 1.
    """
    inverse = _pseudo_inverse(np.asarray(coefficients))
    with np.errstate(divide="ignore", invalid="ignore"):
        parts = np.asarray(corrections) / np.asarray(weights)
    gain = np.abs(1.0 - parts.sum(axis=-1)) ** 2 + (np.abs(parts) ** 2).sum(axis=-1)
    scale = 2.0 * np.square(noise) * gain
    covariance = scale[..., None, None] * (inverse @ np.conj(np.swapaxes(inverse, -1, -2)))
    variances = np.diagonal(covariance, axis1=-2, axis2=-1).real
    # |R_k|² has an exponential distribution with the mean E|R_k|².
    return Confidence(covariance, np.sqrt(-np.log1p(-probability) * variances))


class FourRuns(NamedTuple):
    """Result of four runs without phase measurement.

    Attributes
    ----------
    unbalance : ndarray of complex (...)
        In the unit of the trial weight.
    sensitivity : ndarray (...)
        Amplitude per unbalance.
    """

    unbalance: np.ndarray
    sensitivity: np.ndarray


def four_runs(initial: ArrayLike, amplitudes: ArrayLike, weight: ArrayLike) -> FourRuns:
    """Unbalance of one plane from amplitudes only: a first run, then a trial weight at 0, 120 and 240 degrees.

    A_k² = a² |U + W exp(i theta_k)|² has the mean a² (|U|² + |W|²) and the first harmonic a² W U.

    Parameters
    ----------
    initial : array_like (...)
        Amplitude A_0 = a |U|.
    amplitudes : array_like (..., 3)
        A_k with the trial weight.
    weight : array_like (...)
        Magnitude W of the trial weight.

    Returns
    -------
    FourRuns
        NaN if no linear machine has these amplitudes.
    """
    squares = np.square(amplitudes)
    directions = np.exp(2j * np.pi / 3 * np.arange(3))
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = squares.mean(axis=-1) - np.square(initial)
        rise = np.where(rise > 0.0, rise, np.nan)
        unbalance = (squares * directions).mean(axis=-1) * weight / rise
        return FourRuns(unbalance, np.sqrt(rise) / np.abs(weight))


def _pseudo_inverse(coefficients: np.ndarray) -> np.ndarray:
    """A⁺; NaN if an entry is infinite or NaN, or the readings do not distinguish the planes."""
    sound = np.isfinite(coefficients).all(axis=(-1, -2), keepdims=True)
    matrix = np.where(sound, coefficients, np.zeros_like(coefficients))
    inverse = np.linalg.pinv(matrix, rcond=LEAST_CONDITION)
    # A⁺A is the identity on the subspace of the planes that are distinguished.
    apart = np.trace(inverse @ matrix, axis1=-2, axis2=-1).real > matrix.shape[-1] - 0.5
    return np.where(sound & apart[..., None, None], inverse, np.nan)
