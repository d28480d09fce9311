"""Vibration of one mass, q″ + 2 β q′ + ω₀² q = f(t): free, and forced by a harmonic force, an unbalance or its support.

All functions take arrays that broadcast. ζ = β/ω₀ is the damping ratio and η = Ω/ω₀ the frequency ratio; what has no
value, such as the decrement of an aperiodic motion, is NaN, and an amplitude without a bound infinite.

Source: J. P. Den Hartog, Mechanical Vibrations, chapter 2.
"""

import math

import numpy as np

# Square of the angle ω_d t below which series take over from cosine and sine.
_NEAR = 0.01


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


def _swinging(frequency: np.ndarray, ratio: np.ndarray, time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """e^(−βt) cos ω_d t and e^(−βt) sin(ω_d t)/ω_d, with series near critical damping, and a little beyond it."""
    square = frequency**2 * (1.0 - ratio) * (1.0 + ratio)
    x_square, decay = square * time**2, np.exp(-ratio * frequency * time)
    near = np.clip(x_square, -_NEAR, _NEAR)
    cosine = 1.0 - near / 2.0 * (1.0 - near / 12.0 * (1.0 - near / 30.0 * (1.0 - near / 56.0)))
    sine = time * (1.0 - near / 6.0 * (1.0 - near / 20.0 * (1.0 - near / 42.0 * (1.0 - near / 72.0))))
    root = np.sqrt(np.where(x_square > _NEAR, square, 1.0))
    cosine = np.where(x_square > _NEAR, np.cos(root * time), cosine)
    sine = np.where(x_square > _NEAR, np.sin(root * time) / root, sine)
    return decay * cosine, decay * sine


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
    cosine, sine = _swinging(frequency, ratio, time)
    moved = displacement * cosine + (velocity + beta * displacement) * sine
    rate = velocity * cosine - (beta * velocity + frequency**2 * displacement) * sine
    # Far beyond critical damping the two exponentials apart, −β + w = −ω₀²/(β + w) without cancellation.
    square = frequency**2 * (ratio - 1.0) * (ratio + 1.0)
    creeps = square * time**2 > _NEAR
    root = np.sqrt(np.where(creeps, square, 1.0))
    slow, fast = -(frequency**2) / (beta + root), -(beta + root)
    first = (velocity - fast * displacement) / (2.0 * root) * np.exp(slow * time)
    second = (slow * displacement - velocity) / (2.0 * root) * np.exp(fast * time)
    return np.where(creeps, first + second, moved), np.where(creeps, slow * first + fast * second, rate)


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
