"""From values in a panel to the coefficients of its Chebyshev series, back, and to running integrals.

All three are products of a matrix with a panel's values. As positions mirror each other, sums of values at a position
and its mirror image have to do with one half of the results only, and differences with the other: the matrix falls into
two of half the size.
"""

import numpy as np

from engine.cycle.chebyshev import DEGREE, MIDDLE
from engine.cycle.compiling import routine
from engine.cycle.lanes import LANES, Memory

_HALF = MIDDLE + 1
# Tiles used meanwhile.
FOLDED, PRODUCT, SHIFTED = range(3)


@routine
def _folded(values: Memory, slot: int, folded: Memory) -> None:
    """Sums of values at a position and its mirror image, the middle one once, then differences."""
    for j in range(MIDDLE):
        for lane in range(LANES):
            folded[j, lane] = values[slot, j, lane] + values[slot, DEGREE - j, lane]
        for lane in range(LANES):
            folded[_HALF + j, lane] = values[slot, j, lane] - values[slot, DEGREE - j, lane]
    for lane in range(LANES):
        folded[MIDDLE, lane] = values[slot, MIDDLE, lane]


@routine
def _product(matrix: np.ndarray, given: Memory, result: Memory) -> None:
    """Both halves of a matrix times the two halves of the given rows."""
    # Lengths read off the matrix: the compiler would write out loops of known length, all of them.
    size = matrix.shape[0]
    for i in range((size + 1) // 2):
        for lane in range(LANES):
            total = matrix[i, MIDDLE] * given[MIDDLE, lane]
            for j in range(MIDDLE):
                total += matrix[i, j] * given[j, lane]
            result[i, lane] = total
    for i in range((size + 1) // 2, size):
        for lane in range(LANES):
            total = 0.0
            for j in range(MIDDLE):
                total += matrix[i, j] * given[_HALF + j, lane]
            result[i, lane] = total


@routine
def to_coefficients(matrix: np.ndarray, values: Memory, slot: int, work: Memory, coefficients: Memory) -> None:
    """Coefficients of the Chebyshev series from the values at the positions.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE + 1)
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
    _product(matrix, work[FOLDED], work[PRODUCT])
    for i in range(_HALF):
        for lane in range(LANES):
            coefficients[slot, 2 * i, lane] = product[i, lane]
    for i in range(MIDDLE):
        for lane in range(LANES):
            coefficients[slot, 2 * i + 1, lane] = product[_HALF + i, lane]


@routine
def to_integrals(matrix: np.ndarray, work: Memory, integrals: Memory, slot: int) -> None:
    """Integrals over [−1, x] to each position x of the values in tile SHIFTED of `work`, into a slot.

    Parameters
    ----------
    matrix : ndarray (POSITIONS, MIDDLE + 1)
        `chebyshev.TO_INTEGRALS`.
    work : panels (3, POSITIONS, LANES)
    integrals : panels (slots, POSITIONS, LANES)
    slot : int
    """
    product = work[PRODUCT]
    _folded(work, SHIFTED, work[FOLDED])
    # Of sums the integral from the middle is odd, of differences it is even.
    _product(matrix, work[FOLDED], work[PRODUCT])
    for lane in range(LANES):
        product[MIDDLE, lane] = product[0, lane] + product[_HALF, lane]
    for j in range(MIDDLE):
        for lane in range(LANES):
            even = product[_HALF + j, lane] - product[MIDDLE, lane]
            integrals[slot, j, lane] = even + product[j, lane]
            integrals[slot, DEGREE - j, lane] = even - product[j, lane]
    for lane in range(LANES):
        integrals[slot, MIDDLE, lane] = -product[MIDDLE, lane]
