"""Interpolation in Chebyshev points: the matrices from a panel's values to coefficients and integrals.

A panel of degree n has its positions at x_j = −cos(πj/n) on [−1, 1], j = 0 … n, ends included. The polynomial through
the values there is Σ a_k T_k(x); the a_k are a cosine sum over the positions. Mirrored positions have equal weights in
even coefficients and opposite ones in odd coefficients, so sums run over half the positions.

A panel has degree DEGREE, or COARSE where little accuracy is requested: its positions are then every second of PLACES.

Source: L. N. Trefethen, Approximation Theory and Approximation Practice (2013), ch. 3, 4, 8, 19.
"""

from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import PANEL_POSITIONS

POSITIONS = PANEL_POSITIONS
DEGREE = POSITIONS - 1
COARSE = DEGREE // 2


def shares_of(degree: int) -> np.ndarray:
    """Weight of the value at x_j in coefficient k, as (k, j)."""
    j = np.arange(degree + 1)
    # Integers reduce the argument to less than a turn exactly.
    shares = 2.0 / degree * np.cos(np.pi * (np.outer(j, degree - j) % (2 * degree)) / degree)
    shares[:, [0, -1]] *= 0.5
    shares[[0, -1]] *= 0.5
    return shares


# Sines of small angles are exactly antisymmetric, and 0 in the middle.
PLACES = np.sin(0.5 * np.pi * (2 * np.arange(POSITIONS) - DEGREE) / DEGREE)
SHARES = shares_of(DEGREE)


class PanelMatrices(NamedTuple):
    """Matrices for panels of degree n; the middle value is subtracted as a constant.

    Attributes
    ----------
    even, odd : ndarray (n/2 + 1, n/2), (n/2, n/2)
        Coefficient 2i is the sum over j of even[i, j] (f_j + f_{n−j}), and coefficient 2i + 1 that of
        odd[i, j] (f_j − f_{n−j}), j = 0 … n/2 − 1.
    to_coefficients, to_integrals : ndarray (n + 1, n/2)
        Rows for sums, then rows for differences.
    weights : ndarray (n/2,)
        Weights of the Clenshaw–Curtis rule for f_j + f_{n−j}.
    missed : ndarray (n/2,)
        Error of the rule for T_k, k = n + 2, n + 4, … 2n, whose values at the positions are those of T_{2n−k}.
    """

    even: np.ndarray
    odd: np.ndarray
    to_coefficients: np.ndarray
    to_integrals: np.ndarray
    weights: np.ndarray
    missed: np.ndarray


def matrices_of(degree: int) -> PanelMatrices:
    """Compute the matrices of a degree."""
    half, shares = degree // 2, shares_of(degree)
    even, odd = (np.ascontiguousarray(shares[first::2, :half]) for first in (0, 1))
    # Integrals of T_k from 0 to x_j as (k, j).
    of_one = [np.polynomial.chebyshev.chebint(row, lbnd=0.0) for row in np.eye(degree + 1)]
    integrals = np.array([np.polynomial.chebyshev.chebval(PLACES[:: DEGREE // degree], row) for row in of_one])
    k = np.arange(degree + 2, 2 * degree + 1, 2)
    return PanelMatrices(
        even,
        odd,
        to_coefficients=np.vstack([even, odd]),
        to_integrals=np.vstack([integrals[0::2, : half + 1].T @ even, integrals[1::2, :half].T @ odd]),
        weights=2.0 / (1.0 - np.arange(0, degree + 1, 2) ** 2.0) @ even,
        missed=np.abs(2.0 / (1.0 - k**2.0) - 2.0 / (1.0 - (2 * degree - k) ** 2.0)),
    )


MATRICES = {degree: matrices_of(degree) for degree in (COARSE, DEGREE)}
