"""Transforms of a panel's values to Chebyshev coefficients and to running integrals.

Each is the product of a matrix with the panel's values. Positions lie symmetrically, so sums of values at mirrored
positions contribute to one half of the results only, and differences to the other: the matrix splits into two of half
the size.
"""

from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Rows
from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.chebyshev import COARSE, DEGREE, PLACES


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
def _folded(half: int, values: Rows, folded: Rows) -> None:
    """Sums of mirrored values minus twice the middle one, then differences of mirrored values."""
    for j in range(half):
        for lane in range(LANES):
            left, right, middle = values[j, lane], values[2 * half - j, lane], values[half, lane]
            folded[j, lane] = (left - middle) + (right - middle)
            folded[half + j, lane] = left - right


@routine
def _product(matrix: np.ndarray, folded: Rows, result: Rows) -> None:
    """Multiply the sums by the first half of the matrix's rows, and the differences by the rest."""
    # The compiler vectorises over the lanes only unrolled loops.
    if matrix.shape[1] == DEGREE // 2:
        _sums(matrix, DEGREE // 2, folded, result)
    else:
        _sums(matrix, COARSE // 2, folded, result)


@inlined
def _sums(matrix: np.ndarray, half: int, folded: Rows, result: Rows) -> None:
    # The number of rows comes from the matrix: the compiler would unroll this loop, too.
    for i in range(matrix.shape[0]):
        first = 0 if i <= half else half
        for lane in range(LANES):
            total = 0.0
            for j in range(half):
                total += matrix[i, j] * folded[first + j, lane]
            result[i, lane] = total


@routine
def to_coefficients(matrix: np.ndarray, values: Rows, work: Tiles, coefficients: Rows) -> None:
    """Compute Chebyshev coefficients from the values at the positions.

    Parameters
    ----------
    matrix : ndarray (degree + 1, degree / 2)
        `chebyshev.PanelMatrices.to_coefficients`.
    values : rows (degree + 1, LANES)
    work : Tiles
        Scratch.
    coefficients : rows (degree + 1, LANES)
        Output.
    """
    product, half = work.product, matrix.shape[1]
    _folded(half, values, work.folded)
    _product(matrix, work.folded, product)
    for i in range(half):
        for lane in range(LANES):
            coefficients[2 * i, lane] = product[i, lane]
        for lane in range(LANES):
            coefficients[2 * i + 1, lane] = product[half + 1 + i, lane]
    for lane in range(LANES):
        coefficients[0, lane] += values[half, lane]
        coefficients[2 * half, lane] = product[half, lane]


@routine
def to_integrals(matrix: np.ndarray, work: Tiles, integrals: Rows) -> None:
    """Integrate the values in `work.shifted` over [−1, x] for each position x.

    Parameters
    ----------
    matrix : ndarray (degree + 1, degree / 2)
        `chebyshev.PanelMatrices.to_integrals`.
    work : Tiles
    integrals : rows (degree + 1, LANES)
        Output.
    """
    product, half = work.product, matrix.shape[1]
    stride = DEGREE // (2 * half)
    _folded(half, work.shifted, work.folded)
    _product(matrix, work.folded, product)
    # Integrals from the middle of the sums' part and of the constant are odd; that of the differences' part is even.
    for lane in range(LANES):
        first = product[0, lane] + PLACES[0] * work.shifted[half, lane] + product[half + 1, lane]
        integrals[half, lane] = -first
    for j in range(half):
        for lane in range(LANES):
            odd = product[j, lane] + PLACES[stride * j] * work.shifted[half, lane]
            even = product[half + 1 + j, lane] + integrals[half, lane]
            integrals[j, lane], integrals[2 * half - j, lane] = even + odd, even - odd
