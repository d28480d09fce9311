"""Interpolation in Chebyshev points: the matrices from a panel's values to coefficients and integrals.

A panel of degree n has its positions at x_j = −cos(πj/n) on [−1, 1], j = 0 … n, ends included. The polynomial through
the values there is Σ a_k T_k(x); the a_k are a cosine sum over the positions. Mirrored positions have equal weights in
even coefficients and opposite ones in odd coefficients, so sums run over half the positions.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice (2013), ch. 3, 4, 8, 19.
"""

import numpy as np

from engine.compiling.widths import PANEL_POSITIONS

POSITIONS = PANEL_POSITIONS
DEGREE = POSITIONS - 1
MIDDLE = DEGREE // 2


def _tables() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Positions x_j; values T_k(x_j) as (k, j); weight of the value at x_j in coefficient k as (k, j)."""
    j = np.arange(POSITIONS)
    # Sines of small angles are exactly antisymmetric, and 0 in the middle.
    places = np.sin(0.5 * np.pi * (2 * j - DEGREE) / DEGREE)
    # Integers reduce the argument to less than a turn exactly.
    values = np.cos(np.pi * (np.outer(j, DEGREE - j) % (2 * DEGREE)) / DEGREE)
    shares = 2.0 / DEGREE * values
    shares[:, [0, -1]] *= 0.5
    shares[[0, -1]] *= 0.5
    return places, values, shares


PLACES, _values, SHARES = _tables()

# The middle value is subtracted as a constant. Coefficient 2i is then the sum over j of EVEN[i, j] (f_j + f_{n−j}),
# and coefficient 2i + 1 that of ODD[i, j] (f_j − f_{n−j}), j = 0 … n/2 − 1.
EVEN = np.ascontiguousarray(SHARES[0::2, :MIDDLE])
ODD = np.ascontiguousarray(SHARES[1::2, :MIDDLE])


def _integrals_from_middle() -> np.ndarray:
    """Integrals of T_k from 0 to x_j as (k, j)."""
    of_one = [np.polynomial.chebyshev.chebint(row, lbnd=0.0) for row in np.eye(POSITIONS)]
    return np.array([np.polynomial.chebyshev.chebval(PLACES, row) for row in of_one])


_integrals = _integrals_from_middle()
# Rows for sums, then rows for differences.
TO_COEFFICIENTS = np.vstack([EVEN, ODD])
TO_INTEGRALS = np.vstack([_integrals[0::2, : MIDDLE + 1].T @ EVEN, _integrals[1::2, :MIDDLE].T @ ODD])
_of_even = 2.0 / (1.0 - np.arange(0, POSITIONS, 2) ** 2.0)
# Weights of the Clenshaw–Curtis rule for f_j + f_{n−j}, with the middle value subtracted.
WEIGHTS = _of_even @ EVEN


def _missed() -> np.ndarray:
    """Error of the rule for T_k, k = n + 2, n + 4, … 2n, whose values at the positions are those of T_{2n−k}."""
    k = np.arange(DEGREE + 2, 2 * DEGREE + 1, 2)
    return np.abs(2.0 / (1.0 - k**2.0) - 2.0 / (1.0 - (2 * DEGREE - k) ** 2.0))


MISSED = _missed()
