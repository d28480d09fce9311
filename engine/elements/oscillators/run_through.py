"""Passage of a rotor through its resonance with constant angular acceleration: peak amplitude.

The rotor's unbalance m e excites one mass M,

    q″ + 2 β q′ + ω₀² q = −(m e/M) (e^(iφ))″,   φ′ = ω₁ + α t,

with q complex. For a rotor on isotropic supports q is its transverse deflection; for a mass that moves in one direction
its real part is, with |q| as the envelope. With y = q + (m e/M) e^(iφ) the equation has the roots λ = −β ± i ω_d, each
of which yields a part of y with an error function of complex argument. The initial motion is the steady vibration at
the speed ω₁.

Sources: F. M. Lewis, Vibration during acceleration through a critical speed, Trans. ASME 54 (1932); W. Gautschi,
Efficient computation of the complex error function, SIAM J. Numer. Anal. 7 (1970), for w(z) = e^(−z²) erfc(−iz).
"""

import math
from functools import partial

import numpy as np
from scipy.special import wofz

from engine.elements.sampled_peak import sampled_peak

# Instants at which the amplitude is sampled before the peak is refined.
INSTANTS = 64
# Time sampled before and after the crossing, in units of 1/√|α|. The beats after it decay; the peak is the first one.
_BEFORE, _AFTER = 4.0, 8.0
_TURNED = np.exp(-0.25j * math.pi)


def _driven_part(root: np.ndarray, start: np.ndarray, acceleration: np.ndarray, time: np.ndarray) -> np.ndarray:
    """Integral of e^(λ (t − τ)) e^(i (ω₁ τ + α τ²/2)) over τ from 0 to t, for α > 0.

    With u = τ + (ω₁ + iλ)/α the exponent is iα u²/2 plus a constant, and the integral one of e^(−z²) along
    z = e^(−iπ/4) √(α/2) u: differences of e^(−z²) w(iz) for Re z ≥ 0, and of −e^(−z²) w(−iz) for Re z < 0.
    """
    centre = (start + 1j * root) / acceleration
    scale = np.sqrt(acceleration / 2.0)
    z_end, z_begin = _TURNED * scale * (time + centre), _TURNED * scale * centre
    driven = np.exp(1j * (start + acceleration * time / 2.0) * time)
    free = np.exp(root * time)
    end = np.where(z_end.real < 0.0, -driven * _scaled(-z_end), driven * _scaled(z_end))
    begin = np.where(z_begin.real < 0.0, -free * _scaled(-z_begin), free * _scaled(z_begin))
    # If Re z changes its sign: the free vibration that the resonance left behind.
    between = (z_begin.real < 0.0) & (z_end.real >= 0.0)
    left = np.where(between, np.exp(np.where(between, root * time + z_begin**2, 0.0)), 0.0)
    return math.sqrt(math.pi) / (2.0 * scale * _TURNED) * (begin - end + 2.0 * left)


def _scaled(z: np.ndarray) -> np.ndarray:
    """e^(z²) erfc z for Re z ≥ 0."""
    return wofz(1j * np.where(z.real < 0.0, 0.0, z))


def run_through_motion(
    frequency: np.ndarray, ratio: np.ndarray, start: np.ndarray, acceleration: np.ndarray, time: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Deflection and velocity of a rotor during a speed change, over the eccentricity m e/M of the vibrating mass.

    Parameters
    ----------
    frequency, ratio : ndarray
        Natural frequency ω₀ [rad/s], damping ratio 0 ≤ ζ < 1.
    start : ndarray
        Initial speed [rad/s], at least 0.
    acceleration : ndarray
        Angular acceleration [rad/s²], not 0; negative for a run-down.
    time : ndarray
        After the start [s].

    Returns
    -------
    deflection, rate : ndarray of complex
        The rate in 1/s.
    """
    # A run-down is a run-up of the mirrored rotor, −i instead of i, from a negative speed.
    down = acceleration < 0.0
    speed, rate = np.where(down, -start, start), np.abs(acceleration)
    beta, damped = ratio * frequency, frequency * np.sqrt((1.0 - ratio) * (1.0 + ratio))
    first, second = -beta + 1j * damped, -beta - 1j * damped
    phase = np.exp(1j * (speed + rate * time / 2.0) * time)
    steady = speed**2 / (frequency**2 - speed**2 + 2j * beta * speed)
    # y and its rate at the start, in the steady vibration.
    y, y_rate = steady + 1.0, 1j * speed * (steady + 1.0)
    found, change = np.zeros((2, *np.shape(phase)), complex)
    for root, other in ((first, second), (second, first)):
        driven = -(root**2) * _driven_part(root, speed, rate, time)
        free = (y_rate - other * y - 2.0 * beta) * np.exp(root * time)
        part = (driven + free) / (root - other)
        found, change = found + part, change + root * part
    # The derivative of each driven part contains e^(iφ); −λ² sums to 2β e^(iφ) over both parts.
    found, change = found - phase, change + (2.0 * beta - 1j * (speed + rate * time)) * phase
    return np.where(down, found.conj(), found), np.where(down, change.conj(), change)


def run_through_peak(
    frequency: np.ndarray, ratio: np.ndarray, start: np.ndarray, acceleration: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Peak deflection of a rotor that passes through its resonance, and its time.

    Parameters
    ----------
    frequency, ratio, start, acceleration : ndarray (variants,)
        As for `run_through_motion`.

    Returns
    -------
    peak : ndarray (variants,)
        Over the eccentricity m e/M. NaN for ζ ≥ √½, where there is no resonance, and if the speed moves away from it.
    time : ndarray (variants,)
        After the start [s].
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        crossed = (frequency - start) / acceleration
        unit = 1.0 / np.sqrt(np.abs(acceleration))
    valid = (2.0 * ratio**2 < 1.0) & (crossed >= 0.0) & np.isfinite(crossed)
    given, usual = (frequency, ratio, start, acceleration, crossed, unit), (1.0, 0.1, 0.0, 0.1, 10.0, 1.0)
    frequency, ratio, start, acceleration, crossed, unit = map(partial(np.where, valid), given, usual)
    # If damping is strong relative to the acceleration, the resonance lasts longer than the beats: 2 β/α.
    lasts = np.maximum(1.0, 2.0 * ratio * frequency * unit)
    begin = np.maximum(crossed - _BEFORE * lasts * unit, 0.0)
    # A rotor that runs down comes to rest before it could turn back through the resonance.
    stops = np.where(acceleration < 0.0, -start / acceleration, math.inf)
    step = (np.minimum(crossed + _AFTER * lasts * unit, stops) - begin) / (INSTANTS - 1)
    times = begin + step * np.arange(INSTANTS)[:, None]

    def size(time: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Amplitude, and the product of amplitude and slope."""
        moved, change = run_through_motion(frequency, ratio, start, acceleration, time)
        return np.abs(moved), (moved.conj() * change).real

    peak, time = sampled_peak(lambda t: size(t)[0], times, lambda t: size(t)[1])
    return np.where(valid, peak, math.nan), np.where(valid, time, math.nan)
