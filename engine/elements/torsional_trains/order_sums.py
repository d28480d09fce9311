"""Sums of harmonics over time: the peaks of orders do not add, as they occur at different instants."""

import math
from collections.abc import Sequence

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.running import over_variants
from engine.laws.rounding import EPS

# Samples per wave of the highest order, from which the extremes are refined.
_PER_WAVE = 16
_NARROWINGS = 4
# Loss of the sample nearest to a peak, relative to the sum of all magnitudes, at most (π/16)²/2 = 0.0193.
_MISSED = 0.02
# Longest common period of the orders, in revolutions.
_REVOLUTIONS = 12
_WHOLE = 1e-9


def revolutions_of(orders: Sequence[float]) -> int | None:
    """Common period of all orders in revolutions, up to 12; None if there is none.

    Parameters
    ----------
    orders : sequence of float
        Multiples of the rotational frequency.
    """
    for turns in range(1, _REVOLUTIONS + 1):
        if all(abs(turns * order - round(turns * order)) < _WHOLE for order in orders):
            return turns
    return None


def extremes_of_orders(orders: Sequence[float], amplitudes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Minimum and maximum of Re Σ A_h e^(i h φ) over time.

    Parameters
    ----------
    orders : sequence of float
        h, positive.
    amplitudes : ndarray of complex (orders, ...)

    Returns
    -------
    least, greatest : ndarray (...)
        Without a common period of the orders: ∓ the sum of their magnitudes, which is approached arbitrarily closely.
    """
    turns = revolutions_of(orders)
    if len(orders) == 1 or turns is None:
        total = np.abs(amplitudes).sum(axis=0)
        return -total, total
    whole = np.array([round(turns * order) for order in orders])
    rising = np.argsort(whole)
    h = whole[rising]
    samples = _PER_WAVE * int(h.max())
    waves = np.exp(1j * h[:, None] * (math.tau / samples * np.arange(samples)))
    sums = np.ascontiguousarray(amplitudes.reshape(len(orders), -1)[rising].T)
    found = np.empty((2, sums.shape[0]))
    _extremes(len(sums), h, waves.real.copy(), waves.imag.copy(), sums, found)
    least, greatest = found.reshape(2, *amplitudes.shape[1:])
    return least, greatest


@routine
def _narrowed(h: np.ndarray, own: np.ndarray, sign: float, phi: float, step: float) -> float:
    """Height of the peak near an angle, by Newton's method on the slope."""
    angle, height = phi, -math.inf
    for _ in range(_NARROWINGS + 1):
        # Powers of one unit vector: much faster than separate sines, and as accurate for a few dozen orders.
        c, s = math.cos(angle), math.sin(angle)
        x, y, power = 1.0, 0.0, 0
        value, slope, curved = 0.0, 0.0, 0.0
        for j in range(h.size):
            while power < h[j]:
                x, y = x * c - y * s, x * s + y * c
                power += 1
            real = own[j].real * x - own[j].imag * y
            value += real
            slope -= h[j] * (own[j].real * y + own[j].imag * x)
            curved -= h[j] * h[j] * real
        height = max(height, sign * value)
        if not sign * curved < 0.0:
            break
        move = min(max(-slope / curved, -step), step)
        if abs(curved) * move * move < EPS * height:
            break
        angle += move
    return height


@over_variants
def _extremes(
    begin: int,
    end: int,
    h: np.ndarray,
    cosines: np.ndarray,
    sines: np.ndarray,
    amplitudes: np.ndarray,
    found: np.ndarray,
) -> None:
    """Minimum and maximum of sums `begin` … `end` − 1.

    Parameters
    ----------
    begin, end : int
    h : ndarray of int (orders,)
        Ascending.
    cosines, sines : ndarray (orders, samples)
    amplitudes : ndarray of complex (sums, orders)
    found : ndarray (2, sums)
    """
    samples = cosines.shape[1]
    values, step = np.empty(samples), math.tau / samples
    for i in range(begin, end):
        size = 0.0
        for k in range(samples):
            values[k] = 0.0
        for j in range(h.size):
            a, b = amplitudes[i, j].real, amplitudes[i, j].imag
            size += math.hypot(a, b)
            for k in range(samples):
                values[k] += a * cosines[j, k] - b * sines[j, k]
        for side in range(2):
            sign = 2.0 * side - 1.0
            sampled = -math.inf
            for k in range(samples):
                sampled = max(sampled, sign * values[k])
            # Refine all peaks that may be the highest.
            highest = sampled
            for k in range(samples):
                here = sign * values[k]
                if here >= sampled - _MISSED * size:
                    before = sign * values[k - 1 if k > 0 else samples - 1]
                    after = sign * values[k + 1 if k + 1 < samples else 0]
                    if here >= before and here >= after:
                        highest = max(highest, _narrowed(h, amplitudes[i], sign, step * k, step))
            # An infinite or NaN amplitude gives NaN.
            found[side, i] = sign * highest if size < math.inf else math.nan
