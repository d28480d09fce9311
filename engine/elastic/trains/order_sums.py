"""Sums of harmonics over time: peaks of orders don't add, as they come at different instants."""

import math
from collections.abc import Sequence

import numpy as np

# Samples for each wave of the highest order, from which extremes are then narrowed down.
_PER_WAVE = 16
_NARROWINGS = 4
# Tops that are narrowed down.
_LIKELY = 4
# Most revolutions after which orders repeat themselves.
_REVOLUTIONS = 12
_WHOLE = 1e-9
# Numbers in memory at a time.
_BLOCK = 2**20


def revolutions_of(orders: Sequence[float]) -> int | None:
    """After how many revolutions all orders repeat themselves, up to 12; None where they don't.

    Parameters
    ----------
    orders : sequence of float
        Multiples of the frequency of the rotation.
    """
    for turns in range(1, _REVOLUTIONS + 1):
        if all(abs(turns * order - round(turns * order)) < _WHOLE for order in orders):
            return turns
    return None


def extremes_of_orders(orders: Sequence[float], amplitudes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest value of Re Σ A_h e^(i h φ) over time.

    Parameters
    ----------
    orders : sequence of float
        h, above 0.
    amplitudes : ndarray of complex (orders, ...)

    Returns
    -------
    least, greatest : ndarray (...)
        Where the orders have no common period they come as near as can be to adding up: the sum of their magnitudes.
    """
    turns = revolutions_of(orders)
    if len(orders) == 1 or turns is None:
        total = np.abs(amplitudes).sum(axis=0)
        return -total, total
    flat = amplitudes.reshape(len(orders), -1)
    h = np.array([round(turns * order) for order in orders], float)
    samples = _PER_WAVE * int(h.max())
    waves = np.exp(1j * h[:, None] * (math.tau / samples * np.arange(samples)))
    block = max(1, _BLOCK // samples)
    parts = [_extremes(h, flat[:, k : k + block], waves) for k in range(0, flat.shape[1], block)]
    least, greatest = (np.concatenate(found).reshape(amplitudes.shape[1:]) for found in zip(*parts, strict=True))
    return least, greatest


def _extremes(h: np.ndarray, amplitudes: np.ndarray, waves: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    values = amplitudes.real.T @ waves.real - amplitudes.imag.T @ waves.imag
    step = math.tau / values.shape[1]
    found = []
    for sign in (-1.0, 1.0):
        sampled = sign * values
        # Tops of the parabolas through three samples each: near enough to tell which is the highest.
        before, after = np.roll(sampled, 1, axis=1), np.roll(sampled, -1, axis=1)
        bend, lean = before - 2.0 * sampled + after, 0.5 * (after - before)
        tops = np.where(bend < 0.0, sampled - 0.5 * lean**2 / np.where(bend < 0.0, bend, -1.0), sampled)
        tops = np.where((sampled >= before) & (sampled >= after), tops, -math.inf)
        # The parabolas miss tops by up to a thousandth: whichever may be the highest are all narrowed down.
        likely = np.argpartition(tops, -_LIKELY, axis=1)[:, -_LIKELY:].T
        phi, best = step * likely, np.take_along_axis(sampled, likely.T, axis=1).max(axis=1)
        for _ in range(_NARROWINGS):
            turned = sign * _turned(h, amplitudes, phi)
            slope, curved = -np.tensordot(h, turned.imag, 1), np.tensordot(h**2, turned.real, 1)
            move = np.where(curved > 0.0, slope / np.where(curved > 0.0, curved, 1.0), 0.0)
            phi = phi + np.clip(move, -step, step)
        top = (sign * _turned(h, amplitudes, phi).real.sum(axis=0)).max(axis=0)
        found.append(sign * np.maximum(top, best))
    return found[0], found[1]


def _turned(h: np.ndarray, amplitudes: np.ndarray, phi: np.ndarray) -> np.ndarray:
    """Harmonics A_h e^(i h φ) (orders, places, sums) of amplitudes (orders, sums) at angles (places, sums)."""
    # All powers of one unit vector: much quicker than as many exponentials, and as exact for a few dozen.
    turn = np.exp(1j * phi)
    powers = np.multiply.accumulate(np.broadcast_to(turn, (int(h.max()), *phi.shape)), axis=0)
    return amplitudes[:, None] * powers[h.astype(int) - 1]
