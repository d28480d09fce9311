"""Vibration of one mass, q″ + 2 β q′ + ω₀² q = f(t): free, or excited by a harmonic force, an unbalance or its support.

All functions take arrays that broadcast. ζ = β/ω₀ is the damping ratio and η = Ω/ω₀ the frequency ratio. Undefined
values, such as the decrement of an aperiodic motion, are NaN; unbounded amplitudes are infinite.

Source: J. P. Den Hartog, Mechanical Vibrations, chapter 2.
"""

import math

import numpy as np

from engine.elements.oscillators.damped_vibration import damped_vibration, next_turn
from engine.graph.over_arrays import over_arrays


def ratio_from_decrement(decrement: np.ndarray) -> np.ndarray:
    """Damping ratio of a logarithmic decrement, ζ = Λ/√(4π² + Λ²)."""
    return decrement / np.hypot(math.tau, decrement)


def decrement_of_ratio(ratio: np.ndarray) -> np.ndarray:
    """Logarithmic decrement Λ = ln(A₁/A₂) = 2πζ/√(1 − ζ²) of a damping ratio; NaN for an aperiodic motion."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return math.tau * ratio / np.sqrt((1.0 - ratio) * (1.0 + ratio)) * np.where(ratio < 1.0, 1.0, math.nan)


def ratio_from_absorption(absorption: np.ndarray) -> np.ndarray:
    """Damping ratio ψ/(4π) that dissipates the fraction ψ of the peak energy per cycle at the natural frequency."""
    return absorption / (2.0 * math.tau)


def dynamic_factor(eta: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Amplitude under a harmonic force over the static deflection, 1/√((1 − η²)² + (2ζη)²)."""
    with np.errstate(divide="ignore"):
        return 1.0 / np.hypot((1.0 - eta) * (1.0 + eta), 2.0 * ratio * eta)


def transmissibility(eta: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Amplitude of the mass over that of its support, or of the force on the support over that on the mass."""
    return np.hypot(1.0, 2.0 * ratio * eta) * dynamic_factor(eta, ratio)


def phase_lag(eta: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Angle by which the motion lags behind a harmonic force, 0 … π [rad]."""
    return np.arctan2(2.0 * ratio * eta, (1.0 - eta) * (1.0 + eta))


def transmission_lag(eta: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Angle by which the motion lags behind that of the support [rad]."""
    # The difference of the motion's lag and the support's lead, which may nearly cancel, as one angle.
    return np.arctan2(2.0 * ratio * eta**3, (1.0 - eta) * (1.0 + eta) + (2.0 * ratio * eta) ** 2)


def resonance_factor(ratio: np.ndarray) -> np.ndarray:
    """Maximum dynamic factor, 1/(2ζ√(1 − ζ²)), of a constant-amplitude force or an unbalance; NaN for ζ ≥ √½."""
    with np.errstate(invalid="ignore", divide="ignore"):
        found = 0.5 / (ratio * np.sqrt((1.0 - ratio) * (1.0 + ratio)))
    return np.where(2.0 * ratio**2 < 1.0, found, math.nan)


def resonance_ratio(ratio: np.ndarray) -> np.ndarray:
    """Frequency ratio of the peak under a constant-amplitude force, √(1 − 2ζ²); the inverse holds for an unbalance."""
    with np.errstate(invalid="ignore"):
        return np.sqrt(1.0 - 2.0 * ratio**2)


def support_resonance_ratio(ratio: np.ndarray) -> np.ndarray:
    """Frequency ratio of the peak under a motion of the support, η² = 2/(1 + √(1 + 8ζ²))."""
    return np.sqrt(2.0 / (1.0 + np.sqrt(1.0 + 8.0 * ratio**2)))


def free_motion(
    frequency: np.ndarray, ratio: np.ndarray, displacement: np.ndarray, velocity: np.ndarray, time: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Free motion from given initial values, for any damping.

    Parameters
    ----------
    frequency, ratio : ndarray
        Natural frequency ω₀ [rad/s] and damping ratio ζ.
    displacement, velocity : ndarray
        At the start [m], [m/s].
    time : ndarray
        After the start [s].

    Returns
    -------
    displacement, velocity : ndarray
        At that time [m], [m/s].
    """
    return tuple(over_arrays(damped_vibration, frequency, ratio * frequency, displacement, velocity, time))


def greatest_displacement(
    frequency: np.ndarray, ratio: np.ndarray, displacement: np.ndarray, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Peak magnitude of a free motion, at its start or at its first reversal, and its time.

    Parameters
    ----------
    frequency, ratio, displacement, velocity : ndarray
        As for `free_motion`.

    Returns
    -------
    greatest, time : ndarray
        [m], [s].
    """
    (turns,) = over_arrays(next_turn, frequency, ratio * frequency, displacement, velocity)
    there = np.where(np.isfinite(turns), turns, 0.0)
    reached = np.abs(free_motion(frequency, ratio, displacement, velocity, there)[0])
    later = reached > np.abs(displacement)
    return np.maximum(reached, np.abs(displacement)), np.where(later, there, 0.0)
