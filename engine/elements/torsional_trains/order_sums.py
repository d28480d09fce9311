"""Sums of harmonics over time: the peaks of orders do not add, as they occur at different instants."""

import math
from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import chain, pairwise
from typing import NamedTuple

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.laws.rounding import EPS

# Samples per wave of the highest order, from which the peaks are refined.
_PER_WAVE = 32
# Loss of the sample nearest to a peak, at most (π/32)²/2 = 0.0048 of the sum of all magnitudes times (order/highest)².
_MISSED = 0.005
# Most waves of the highest order in a common period of orders that are summed together, and relative tolerance of it.
_MOST_WAVES, _WHOLE = 1000, 1e-9
# Largest denominator of a ratio of two sums' periods.
_DENOMINATOR = 10**6
# Waves of all variants in memory at a time.
_AT_ONCE = 2**16


class ExtremesOfOrders(NamedTuple):
    """Minimum and maximum of a sum of orders over time, and the error estimate of both."""

    least: np.ndarray
    greatest: np.ndarray
    error: np.ndarray


def _waves_together(orders: Sequence[float]) -> np.ndarray | None:
    """Waves of each order in the shortest common period; None if there is none, or only a long one."""
    shares = [Fraction(order / min(orders)).limit_denominator(_MOST_WAVES) for order in orders]
    waves = [share * math.lcm(*(share.denominator for share in shares)) for share in shares]
    equal = np.allclose([float(share) * min(orders) for share in shares], orders, rtol=_WHOLE, atol=0.0)
    return np.array(waves, dtype=np.int64) if equal and max(waves) <= _MOST_WAVES else None


@lru_cache(maxsize=64)
def _groups(orders: tuple[float, ...]) -> list[tuple[list[int], np.ndarray]]:
    """Indices of the orders, those with a common period together, ascending, with their waves in it."""
    groups: list[tuple[list[int], np.ndarray]] = []
    for i in np.argsort(orders):
        for k, (group, _) in enumerate(groups):
            joined = [*group, i]
            waves = _waves_together([orders[own] for own in joined])
            if waves is not None:
                groups[k] = joined, waves
                break
        else:
            groups.append(([i], np.ones(1, np.int64)))
    return groups


def extremes_of_orders(orders: Sequence[float], amplitudes: np.ndarray) -> ExtremesOfOrders:
    """Minimum and maximum of Re Σ A_h e^(i h φ) over time.

    Sums without a short common period take nearly any phases in the course of time, so that their extremes add. If the
    ratio of their base frequencies is p/q, they shift against each other by steps of 1/p of the first one's period:
    their peaks miss each other by half of a step at most.

    Parameters
    ----------
    orders : sequence of float
        h, positive.
    amplitudes : ndarray of complex (orders, ...)
    """
    found, error, common, bends = np.zeros((2, *amplitudes.shape[1:])), np.zeros(amplitudes.shape[1:]), 0.0, 0.0
    for group, waves in _groups(tuple(orders)):
        base = orders[group[0]] / waves[0]
        bend = np.tensordot((base * waves) ** 2, np.abs(amplitudes[group]), 1)
        found += _extremes_together(waves, amplitudes[group])
        # Each power of a unit vector is a product more.
        error += 2.0 * EPS * np.tensordot(waves, np.abs(amplitudes[group]), 1)
        ratio = Fraction(base / (common or base)).limit_denominator(_DENOMINATOR)
        if common:
            error += 0.5 * (math.pi / (common * ratio.numerator)) ** 2 * np.minimum(bend, bends)
        common, bends = (common or base) / ratio.denominator, bends + bend
    return ExtremesOfOrders(*found, error)


def _extremes_together(waves: np.ndarray, amplitudes: np.ndarray) -> np.ndarray:
    """Minimum and maximum of a sum of orders with ascending numbers of waves in their common period."""
    if len(waves) == 1:
        total = np.abs(amplitudes[0])
        return np.array([-total, total])
    sums = amplitudes.reshape(len(waves), -1)
    pieces = np.array_split(sums, max(-(-sums.shape[1] * int(waves.max()) // _AT_ONCE), 1), axis=1)
    found = np.concatenate([[-_peaks(waves, -piece), _peaks(waves, piece)] for piece in pieces], axis=1)
    return found.reshape(2, *amplitudes.shape[1:])


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
