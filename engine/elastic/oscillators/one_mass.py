"""Vibration of one mass, q″ + 2 β q′ + ω₀² q = f(t): free, and forced by a harmonic force, an unbalance or its support.

All functions take arrays that broadcast. ζ = β/ω₀ is the damping ratio and η = Ω/ω₀ the frequency ratio; what has no
value, such as the decrement of an aperiodic motion, is NaN, and an amplitude without a bound infinite.

Source: J. P. Den Hartog, Mechanical Vibrations, chapter 2.
"""

import math

import numpy as np


def ratio_from_decrement(decrement: np.ndarray) -> np.ndarray:
    """Damping ratio of a logarithmic decrement, ζ = Λ/√(4π² + Λ²)."""
    return decrement / np.hypot(math.tau, decrement)


def decrement_of_ratio(ratio: np.ndarray) -> np.ndarray:
    """Logarithmic decrement Λ = ln(A₁/A₂) = 2πζ/√(1 − ζ²) of a damping ratio; NaN for an aperiodic motion."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return math.tau * ratio / np.sqrt((1.0 - ratio) * (1.0 + ratio)) * np.where(ratio < 1.0, 1.0, math.nan)


def ratio_from_absorption(absorption: np.ndarray) -> np.ndarray:
    """Damping ratio that dissipates the share ψ of the greatest energy in a cycle at the natural frequency, ψ/(4π)."""
    return absorption / (2.0 * math.tau)


def dynamic_factor(eta: np.ndarray, ratio: np.ndarray) -> np.ndarray:
    """Amplitude under a harmonic force over the deflection by that force at rest, 1/√((1 − η²)² + (2ζη)²)."""
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
    return phase_lag(eta, ratio) - np.arctan(2.0 * ratio * eta)


def resonance_factor(ratio: np.ndarray) -> np.ndarray:
    """Greatest dynamic factor, 1/(2ζ√(1 − ζ²)), of a force of one size or of an unbalance; NaN from ζ = √½ on."""
    with np.errstate(invalid="ignore", divide="ignore"):
        found = 0.5 / (ratio * np.sqrt((1.0 - ratio) * (1.0 + ratio)))
    return np.where(2.0 * ratio**2 < 1.0, found, math.nan)


def resonance_ratio(ratio: np.ndarray) -> np.ndarray:
    """Frequency ratio at which a force of one size has its greatest effect, √(1 − 2ζ²); of an unbalance 1 over it."""
    with np.errstate(invalid="ignore"):
        return np.sqrt(1.0 - 2.0 * ratio**2)


def support_resonance_ratio(ratio: np.ndarray) -> np.ndarray:
    """Frequency ratio at which the motion of a support has its greatest effect, η² = 2/(1 + √(1 + 8ζ²))."""
    return np.sqrt(2.0 / (1.0 + np.sqrt(1.0 + 8.0 * ratio**2)))


def _decaying(frequency: np.ndarray, ratio: np.ndarray, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Solutions of the free motion that begin with (1, −β) and (0, 1): e^(−βt) cos ω_d t, e^(−βt) sin(ω_d t)/ω_d.

    Beyond ζ = 1 with hyperbolic functions, written with exponents that don't overflow; between them 1 − ω_d² t²/2 ….
    """
    beta = ratio * frequency
    square = frequency**2 * (1.0 - ratio) * (1.0 + ratio)
    root = np.sqrt(np.abs(square))
    x = root * time
    decay = np.exp(-beta * time)
    # The slower exponent, −β + w = −ω₀²/(β + w), without cancellation.
    with np.errstate(invalid="ignore", divide="ignore"):
        slow = np.exp(-(frequency**2) / (beta + root) * time)
        fast = np.exp(-(beta + root) * time)
        cosine = np.where(square > 0.0, decay * np.cos(x), 0.5 * (slow + fast))
        sine = np.where(square > 0.0, decay * np.sin(x), 0.5 * (slow - fast)) / root
    # Near ζ = 1 what both differ by is all that counts.
    near = np.minimum(x, 0.1) ** 2 * np.where(square > 0.0, -1.0, 1.0)
    series = decay * time * (1.0 + near / 6.0 * (1.0 + near / 20.0 * (1.0 + near / 42.0 * (1.0 + near / 72.0))))
    return cosine, np.where(x < 0.1, series, sine)


def free_motion(
    frequency: np.ndarray, ratio: np.ndarray, displacement: np.ndarray, velocity: np.ndarray, time: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Free motion from given start values, of whatever damping.

    Parameters
    ----------
    frequency, ratio : ndarray
        Natural frequency ω₀ [rad/s] and damping ratio ζ.
    displacement, velocity : ndarray
        At the start [m], [m/s].
    time : ndarray
        Since then [s].

    Returns
    -------
    displacement, velocity : ndarray
        At that time [m], [m/s].
    """
    beta = ratio * frequency
    cosine, sine = _decaying(frequency, ratio, time)
    pushed = velocity + beta * displacement
    moved = displacement * cosine + pushed * sine
    return moved, velocity * cosine - (beta * velocity + frequency**2 * displacement) * sine


def first_turning_point(
    frequency: np.ndarray, ratio: np.ndarray, displacement: np.ndarray, velocity: np.ndarray
) -> np.ndarray:
    """Time after the start at which a free motion first turns back [s]; NaN where it never does.

    The velocity vanishes where tan(ω_d t)/ω_d = v/(β v + ω₀² q).
    """
    beta = ratio * frequency
    square = frequency**2 * (1.0 - ratio) * (1.0 + ratio)
    root = np.sqrt(np.abs(square))
    below = beta * velocity + frequency**2 * displacement
    with np.errstate(invalid="ignore", divide="ignore"):
        angle = np.arctan2(root * velocity, below) % math.pi
        # At rest it begins with a turning point.
        swings = np.where(angle > 0.0, angle, math.pi) / root
        creeps = np.arctanh(root * velocity / below) / root
        critical = velocity / below
    turns = np.where(square > 0.0, swings, np.where(square < 0.0, creeps, critical))
    return np.where((turns > 0.0) & np.isfinite(turns), turns, math.nan)


def greatest_displacement(
    frequency: np.ndarray, ratio: np.ndarray, displacement: np.ndarray, velocity: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Greatest magnitude of a free motion, at its start or where it first turns back, and when.

    Parameters
    ----------
    frequency, ratio, displacement, velocity : ndarray
        As for `free_motion`.

    Returns
    -------
    greatest, time : ndarray
        [m], [s].
    """
    turns = first_turning_point(frequency, ratio, displacement, velocity)
    there = np.where(np.isnan(turns), 0.0, turns)
    reached = np.abs(free_motion(frequency, ratio, displacement, velocity, there)[0])
    later = reached > np.abs(displacement)
    return np.maximum(reached, np.abs(displacement)), np.where(later, there, 0.0)
