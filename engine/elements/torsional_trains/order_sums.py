"""Sums of harmonics over time: the peaks of orders do not add, as they occur at different instants."""

import math
from collections.abc import Sequence

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.running import over_variants
from engine.laws.rounding import EPS

# Samples per wave of the highest order, from which the extremes are refined.
_PER_WAVE = 16
# Newton's method converges linearly at a flat top, where the curvature vanishes too.
_NARROWINGS = 40
# Loss of the sample nearest to a peak, at most (π/16)²/2 = 0.0193 of the sum of all magnitudes times (order/highest)².
_MISSED = 0.02
# Longest common period of orders that are summed together: in revolutions, and in waves of the lowest of them.
_REVOLUTIONS, _WAVES = 12, 24
_WHOLE = 1e-9


def waves_together(orders: Sequence[float]) -> np.ndarray | None:
    """Waves of each order in the shortest common period; None if there is none, or only a long one.

    Parameters
    ----------
    orders : sequence of float
        Multiples of the rotational frequency, positive.
    """
    all_orders = np.array(orders)
    turns = np.arange(1, _REVOLUTIONS + 1)
    for period in (*turns, *np.arange(1, _WAVES + 1) / all_orders.min()):
        waves = np.rint(period * all_orders)
        if np.all(waves > 0) and np.all(np.abs(period * all_orders - waves) < _WHOLE * np.maximum(1.0, waves)):
            return waves.astype(np.int64)
    return None


def _groups(orders: Sequence[float]) -> list[list[int]]:
    """Indices of the orders, those with a common period together, ascending."""
    groups: list[list[int]] = []
    for i in np.argsort(orders):
        joined = (group for group in groups if waves_together([orders[k] for k in (*group, i)]) is not None)
        group = next(joined, None)
        if group is None:
            groups.append([i])
        else:
            group.append(i)
    return groups


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
        Sums over orders without a common period take any phases in the course of time, so that their extremes add.
    """
    found = np.zeros((2, *amplitudes.shape[1:]))
    for group in _groups(orders):
        found += _extremes_together([orders[i] for i in group], amplitudes[group])
    least, greatest = found
    return least, greatest


def _extremes_together(orders: Sequence[float], amplitudes: np.ndarray) -> np.ndarray:
    """Minimum and maximum of a sum of ascending orders with a common period."""
    if len(orders) == 1:
        total = np.abs(amplitudes[0])
        return np.array([-total, total])
    h = waves_together(orders)
    samples = _PER_WAVE * int(h.max())
    waves = np.exp(1j * h[:, None] * (math.tau / samples * np.arange(samples)))
    sums = np.ascontiguousarray(amplitudes.reshape(len(orders), -1).T)
    found = np.empty((2, sums.shape[0]))
    _extremes(len(sums), h, waves.real.copy(), waves.imag.copy(), sums, found)
    return found.reshape(2, *amplitudes.shape[1:])


@routine
def _narrowed(h: np.ndarray, own: np.ndarray, sign: float, phi: float, step: float) -> float:
    """Height of the peak near an angle, by Newton's method on the slope; uphill where the curve is hollow."""
    angle, height = phi, -math.inf
    for _ in range(_NARROWINGS):
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
        if sign * curved < 0.0:
            move = min(max(-slope / curved, -step), step)
            if abs(curved) * move * move < EPS * height:
                break
        else:
            move = math.copysign(step / 4.0, sign * slope)
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
        bend = 0.0
        for k in range(samples):
            values[k] = 0.0
        for j in range(h.size):
            a, b = amplitudes[i, j].real, amplitudes[i, j].imag
            bend += (h[j] / h[-1]) ** 2 * math.hypot(a, b)
            for k in range(samples):
                values[k] += a * cosines[j, k] - b * sines[j, k]
        for side in range(2):
            sign = 2.0 * side - 1.0
            sampled = -math.inf
            for k in range(samples):
                sampled = max(sampled, sign * values[k])
            # A peak may lie next to any sample that is high enough, even where the samples rise throughout.
            highest, enough = sampled, sampled - _MISSED * bend
            for k in range(samples):
                if max(sign * values[k], sign * values[(k + 1) % samples]) >= enough:
                    highest = max(highest, _narrowed(h, amplitudes[i], sign, step * (k + 0.5), step))
            # An infinite or NaN amplitude gives NaN.
            found[side, i] = sign * highest if bend < math.inf else math.nan
