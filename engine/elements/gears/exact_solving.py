"""Small systems of equations for many variants at once, solved to the last digits.

Meshes of a train whose basic ratio is nearly 1 have equations that nearly repeat each other: what elimination leaves of
1e-9 has lost nine digits. Residuals in twice the digits bring these back, as numbers of teeth are exact.
"""

from typing import NamedTuple

import numpy as np

# 2**27 + 1 splits a double into halves whose products are exact (Dekker).
_SPLITTER = 134217729.0
# With pivots smaller than this beside their rows, corrections would no longer bring all digits back.
_VANISHING = 2.0**-40
_CORRECTIONS = 3
_ENOUGH = 2.0**-53
# A change that is smaller leaves less than a rounding of what is found, as it shrinks by as much in each correction.
_SMALL = 2.0**-26
_HIDDEN = 2.0**-95


class Solution(NamedTuple):
    """Solutions of equations; NaN where they have none or many.

    Attributes
    ----------
    values, errors : ndarray (unknowns, right sides, variants)
        What is left of rounding within the solution, that of its last digit apart.
    inverse : ndarray (unknowns, equations, variants)
        Magnitudes of the inverse.
    """

    values: np.ndarray
    errors: np.ndarray
    inverse: np.ndarray


def solve_exactly(matrix: np.ndarray, right: np.ndarray) -> Solution:
    """Solve systems whose entries count as exact.

    Parameters
    ----------
    matrix : ndarray (unknowns, unknowns, variants)
    right : ndarray (unknowns, right sides, variants)
    """
    inverse = _inverse(matrix)
    with np.errstate(invalid="ignore", over="ignore"):
        found = _product(inverse, right)
        # What rounding of the others leaves of the equations, times the inverse's own error: no correction finds that.
        floor = _HIDDEN * np.abs(found).max(axis=0, keepdims=True)
        for _ in range(_CORRECTIONS):
            change = _product(inverse, _residual(matrix, found, right))
            # What is right already stays as it is, however many corrections others beside it need.
            wanting = np.abs(change) > _ENOUGH * np.abs(found)
            found = np.where(wanting, found + change, found)
            # No more than the last change, as each is smaller than the one before.
            left = np.where(wanting & (np.abs(change) > _SMALL * np.abs(found)), np.abs(change), 0.0) + floor
            if not wanting.any():
                break
    return Solution(found, left, np.abs(inverse))


def _product(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Matrix products with variants along the last axis."""
    return np.einsum("ijv,jkv->ikv", a, b)


def _inverse(matrix: np.ndarray) -> np.ndarray:
    """Inverses by elimination with pivots chosen in each variant."""
    size, _, variants = matrix.shape
    work = np.concatenate([matrix, np.broadcast_to(np.eye(size)[:, :, None], matrix.shape)], axis=1)
    scale = np.abs(matrix).max(axis=1)
    v = np.arange(variants)
    with np.errstate(invalid="ignore", divide="ignore", over="ignore"):
        for k in range(size):
            if k < size - 1:
                pivot = k + np.argmax(np.abs(work[k:, k]) / scale[k:], axis=0)
                work[k], work[pivot, :, v] = work[pivot, :, v].T, work[k].T.copy()
                scale[k], scale[pivot, v] = scale[pivot, v], scale[k].copy()
            own = work[k, k]
            work[k] = work[k] / np.where(np.abs(own) <= _VANISHING * scale[k], np.nan, own)
            for i in range(size):
                if i != k and work[i, k].any():
                    work[i] = work[i] - work[i, k] * work[k]
    return work[:, size:]


def _residual(matrix: np.ndarray, found: np.ndarray, right: np.ndarray) -> np.ndarray:
    """What `found` leaves of the right sides, summed with twice the digits."""
    high, low = right.copy(), np.zeros_like(right)
    for i in range(matrix.shape[0]):
        for j in range(matrix.shape[1]):
            if matrix[i, j].any():
                product, rest = _exact_product(matrix[i, j], found[j])
                high[i], lost = _exact_sum(high[i], -product)
                low[i] += lost - rest
    return high + low


def _exact_product(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A product and what rounding takes from it."""
    product = a * b
    a_high, a_low = _halves(a)
    b_high, b_low = _halves(b)
    return product, ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low


def _halves(a: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    shifted = _SPLITTER * a
    high = shifted - (shifted - a)
    return high, a - high


def _exact_sum(a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A sum and what rounding takes from it."""
    total = a + b
    other = total - a
    return total, (a - (total - other)) + (b - other)
