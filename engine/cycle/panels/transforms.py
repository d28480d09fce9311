"""Transforms of a panel's values to Chebyshev coefficients and to running integrals.

Each is the product of a matrix with the panel's values. Positions lie symmetrically, so sums of values at mirrored
positions contribute to one half of the results only, and differences to the other: the matrix splits into two of half
the size.
"""

from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Rows
from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, MIDDLE, PLACES


class Tiles(NamedTuple):
    """Scratch tiles of one curve.

    Attributes
    ----------
    folded, product, shifted : rows (POSITIONS, LANES)
    """

    folded: Rows
    product: Rows
    shifted: Rows


@routine
def _folded(values: Rows, folded: Rows) -> None:
    """Sums of mirrored values minus twice the middle one, then differences of mirrored values."""
    for j in range(MIDDLE):
        for lane in range(LANES):
            left, right, middle = values[j, lane], values[DEGREE - j, lane], values[MIDDLE, lane]
            folded[j, lane] = (left - middle) + (right - middle)
            folded[MIDDLE + j, lane] = left - right


@routine
def _product(matrix: np.ndarray, folded: Rows, result: Rows) -> None:
    """Multiply the sums by the first half of the matrix's rows, and the differences by the rest."""
    # Loop lengths come from the matrix: the compiler would fully unroll loops of constant length.
    size = matrix.shape[0]
    for i in range(size):
        first = 0 if i < (size + 1) // 2 else MIDDLE
        for lane in range(LANES):
            total = 0.0
            for j in range(MIDDLE):
                total += matrix[i, j] * folded[first + j, lane]
            result[i, lane] = total


@routine
def to_coefficients(matrix: np.ndarray, values: Rows, work: Tiles, coefficients: Rows) -> None:
    """Compute Chebyshev coefficients from the values at the positions.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE)
        `chebyshev.TO_COEFFICIENTS`.
    values : rows (POSITIONS, LANES)
    work : Tiles
        Scratch.
    coefficients : rows (POSITIONS, LANES)
        Output.
    """
    product = work.product
    _folded(values, work.folded)
    _product(matrix, work.folded, product)
    for i in range(MIDDLE):
        for lane in range(LANES):
            coefficients[2 * i, lane] = product[i, lane]
        for lane in range(LANES):
            coefficients[2 * i + 1, lane] = product[MIDDLE + 1 + i, lane]
    for lane in range(LANES):
        coefficients[0, lane] += values[MIDDLE, lane]
        coefficients[DEGREE, lane] = product[MIDDLE, lane]


@routine
def to_integrals(matrix: np.ndarray, work: Tiles, integrals: Rows) -> None:
    """Integrate the values in `work.shifted` over [−1, x] for each position x.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE)
        `chebyshev.TO_INTEGRALS`.
    work : Tiles
    integrals : rows (POSITIONS, LANES)
        Output.
    """
    product = work.product
    _folded(work.shifted, work.folded)
    _product(matrix, work.folded, product)
    # Integrals from the middle of the sums' part and of the constant are odd; that of the differences' part is even.
    for lane in range(LANES):
        first = product[0, lane] + PLACES[0] * work.shifted[MIDDLE, lane] + product[MIDDLE + 1, lane]
        integrals[MIDDLE, lane] = -first
    for j in range(MIDDLE):
        for lane in range(LANES):
            odd = product[j, lane] + PLACES[j] * work.shifted[MIDDLE, lane]
            even = product[MIDDLE + 1 + j, lane] + integrals[MIDDLE, lane]
            integrals[j, lane], integrals[DEGREE - j, lane] = even + odd, even - odd
