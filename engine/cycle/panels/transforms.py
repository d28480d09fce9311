"""From values in a panel to the coefficients of its Chebyshev series, back, and to running integrals.

All three are products of a matrix with a panel's values. As positions mirror each other, sums of values at a position
and its mirror image have to do with one half of the results only, and differences with the other: the matrix falls into
two of half the size.
"""

from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Rows
from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, MIDDLE, PLACES


class Tiles(NamedTuple):
    """Tiles of one curve that are used meanwhile.

    Attributes
    ----------
    folded, product, shifted : rows (POSITIONS, LANES)
    """

    folded: Rows
    product: Rows
    shifted: Rows


@routine
def _folded(values: Rows, folded: Rows) -> None:
    """Sums of values at a position and its mirror image, less twice the value in the middle; then differences."""
    for j in range(MIDDLE):
        for lane in range(LANES):
            left, right, middle = values[j, lane], values[DEGREE - j, lane], values[MIDDLE, lane]
            folded[j, lane] = (left - middle) + (right - middle)
            folded[MIDDLE + j, lane] = left - right


@routine
def _product(matrix: np.ndarray, folded: Rows, result: Rows) -> None:
    """The rows for sums times the sums, then the rows for differences times the differences."""
    # Lengths are read off the matrix: the compiler would write out loops of known length, all of them.
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
    """Coefficients of the Chebyshev series from the values at the positions.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE)
        `chebyshev.TO_COEFFICIENTS`.
    values : rows (POSITIONS, LANES)
    work : Tiles
        Used meanwhile.
    coefficients : rows (POSITIONS, LANES)
        Receives them.
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
    """Integrals over [−1, x] to each position x of the values in `work.shifted`.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE)
        `chebyshev.TO_INTEGRALS`.
    work : Tiles
    integrals : rows (POSITIONS, LANES)
    """
    product = work.product
    _folded(work.shifted, work.folded)
    _product(matrix, work.folded, product)
    # The integral from the middle is odd of the sums and of the constant, even of the differences.
    for lane in range(LANES):
        first = product[0, lane] + PLACES[0] * work.shifted[MIDDLE, lane] + product[MIDDLE + 1, lane]
        integrals[MIDDLE, lane] = -first
    for j in range(MIDDLE):
        for lane in range(LANES):
            odd = product[j, lane] + PLACES[j] * work.shifted[MIDDLE, lane]
            even = product[MIDDLE + 1 + j, lane] + integrals[MIDDLE, lane]
            integrals[j, lane], integrals[DEGREE - j, lane] = even + odd, even - odd
