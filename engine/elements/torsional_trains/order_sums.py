"""Sums of harmonics over time: the peaks of orders do not add, as they occur at different instants."""

import math
from collections.abc import Sequence
from itertools import chain, pairwise

import numpy as np

from engine.cycle.regula_falsi import regula_falsi

# Samples per wave of the highest order, from which the peaks are refined.
_PER_WAVE = 32
# Loss of the sample nearest to a peak, at most (π/32)²/2 = 0.0048 of the sum of all magnitudes times (order/highest)².
_MISSED = 0.005
# Longest common period of orders that are summed together: in revolutions, and in waves of the lowest of them.
_REVOLUTIONS, _WAVES = 12, 24
_WHOLE = 1e-9


def _waves_together(orders: Sequence[float]) -> np.ndarray | None:
    """Waves of each order in the shortest common period; None if there is none, or only a long one."""
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
        joined = (group for group in groups if _waves_together([orders[k] for k in (*group, i)]) is not None)
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
    h, sums = _waves_together(orders), amplitudes.reshape(len(orders), -1)
    return np.array([-_peaks(h, -sums), _peaks(h, sums)]).reshape(2, *amplitudes.shape[1:])


def _peaks(h: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
    """Maxima over φ of Re Σ A_h e^(i h φ), by the roots of the slope next to the highest samples."""
    samples, waves = _PER_WAVE * int(h.max()), h[:, None]
    spectrum = np.zeros((samples // 2 + 1, amplitudes.shape[1]), complex)
    spectrum[h] = 0.5 * samples * amplitudes
    values = np.fft.irfft(spectrum, samples, axis=0)
    bends = ((waves / h.max()) ** 2 * np.abs(amplitudes)).sum(axis=0)
    found, higher = values.max(axis=0), np.maximum(values, np.roll(values, -1, axis=0))
    # The peak may lie next to any sample that is high enough.
    k, who = np.nonzero(higher > found - _MISSED * bends)
    low, high = (math.tau / samples * end for end in (k, k + 1.0))

    def sums(phi: np.ndarray, parts: np.ndarray) -> np.ndarray:
        """Re Σ A_h e^(i h φ); powers of one unit vector are much faster than exponentials, and as accurate."""
        turned = np.cumprod(np.broadcast_to(np.exp(1j * phi), (h.max(), phi.size)), axis=0)[h - 1]
        return (parts * turned).real.sum(axis=0)

    chosen = amplitudes[:, who]

    derivatives = [(1j * waves) ** order * chosen for order in range(4)]
    # The curvature changes within an interval by less than this from the nearer end.
    change = 0.5 * (high - low) * np.abs(derivatives[3]).sum(axis=0)
    several = np.maximum(*(sums(end, derivatives[2]) for end in (low, high))) > -change

    def root_between(order: int, begin: np.ndarray, end: np.ndarray) -> np.ndarray:
        """Where a derivative changes its sign, else `end`; higher ones are needed where there may be several peaks."""
        parts, root = derivatives[order], end.copy()
        there = np.flatnonzero((begin < end) & (several | (order == 1)))
        before, after = (sums(at[there], parts[:, there]) > 0.0 for at in (begin, end))
        changes = there[before != after]
        root[changes] = regula_falsi(lambda phi: sums(phi, parts[:, changes]), begin[changes], end[changes])
        return root

    ends = [low, high]
    for order in (3, 2, 1):
        roots = [root_between(order, *piece) for piece in pairwise(ends)]
        ends = [low, *chain.from_iterable(zip(roots, ends[1:], strict=True))]
    for at in roots:
        np.maximum.at(found, who, sums(at, chosen))
    return np.where(np.isfinite(bends), found, math.nan)
