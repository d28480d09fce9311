"""From values in a panel to the coefficients of its Chebyshev series, back, and to running integrals.

All three are products of a matrix with a panel's values. As positions mirror each other, sums of values at a position
and its mirror image have to do with one half of the results only, and differences with the other: the matrix falls into
two of half the size.
"""

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, MIDDLE, PLACES
from engine.cycle.panels.lanes import Memory

# Tiles used meanwhile.
FOLDED, PRODUCT, SHIFTED = range(3)


@routine
def _folded(values: Memory, slot: int, folded: Memory) -> None:
    """Sums of values at a position and its mirror image, less twice the value in the middle; then differences."""
    for j in range(MIDDLE):
        for lane in range(LANES):
            left, right, middle = values[slot, j, lane], values[slot, DEGREE - j, lane], values[slot, MIDDLE, lane]
            folded[j, lane] = (left - middle) + (right - middle)
            folded[MIDDLE + j, lane] = left - right


@routine
def _product(matrix: np.ndarray, folded: Memory, result: Memory) -> None:
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
def to_coefficients(matrix: np.ndarray, values: Memory, slot: int, work: Memory, coefficients: Memory) -> None:
    """Coefficients of the Chebyshev series from the values at the positions.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE)
        `chebyshev.TO_COEFFICIENTS`.
    values : panels (slots, POSITIONS, LANES)
    slot : int
    work : panels (3, POSITIONS, LANES)
        Used meanwhile.
    coefficients : panels (slots, POSITIONS, LANES)
        Receives them.
    """
    product = work[PRODUCT]
    _folded(values, slot, work[FOLDED])
    _product(matrix, work[FOLDED], product)
    for i in range(MIDDLE):
        for lane in range(LANES):
            coefficients[slot, 2 * i, lane] = product[i, lane]
        for lane in range(LANES):
            coefficients[slot, 2 * i + 1, lane] = product[MIDDLE + 1 + i, lane]
    for lane in range(LANES):
        coefficients[slot, 0, lane] += values[slot, MIDDLE, lane]
        coefficients[slot, DEGREE, lane] = product[MIDDLE, lane]


@routine
def to_integrals(matrix: np.ndarray, work: Memory, integrals: Memory, slot: int) -> None:
    """Integrals over [−1, x] to each position x of the values in tile SHIFTED of `work`, into a slot.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE)
        `chebyshev.TO_INTEGRALS`.
    work : panels (3, POSITIONS, LANES)
    integrals : panels (slots, POSITIONS, LANES)
    slot : int
    """
    product = work[PRODUCT]
    _folded(work, SHIFTED, work[FOLDED])
    _product(matrix, work[FOLDED], product)
    # The integral from the middle is odd of the sums and of the constant, even of the differences.
    for lane in range(LANES):
        first = product[0, lane] + PLACES[0] * work[SHIFTED, MIDDLE, lane] + product[MIDDLE + 1, lane]
        integrals[slot, MIDDLE, lane] = -first
    for j in range(MIDDLE):
        for lane in range(LANES):
            odd = product[j, lane] + PLACES[j] * work[SHIFTED, MIDDLE, lane]
            even = product[MIDDLE + 1 + j, lane] + integrals[slot, MIDDLE, lane]
            integrals[slot, j, lane], integrals[slot, DEGREE - j, lane] = even + odd, even - odd
