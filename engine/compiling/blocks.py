"""Blocks of LANES variants: gather their numbers side by side, and scatter a block's results to the variants."""

import math

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.memory import Memory, memory

# Variants in a block. With 64 the loops over lanes are fully vectorised.
LANES = 64
# Positions of a panel, and of each part of a scan.
PANEL_POSITIONS = 17
_PAGE = 4096
# Shapes (LANES,) and (…, LANES).
Row, Rows = Memory(()), Memory((LANES,))
in_lanes = memory(Rows)


def rows(*shape: int, offset: int = 0) -> np.ndarray:
    """Allocate zeros (…, LANES) that begin `offset` numbers after the start of a page."""
    size = math.prod(shape) * LANES
    memory = np.zeros(size + offset + _PAGE // 8)
    start = -(memory.ctypes.data // 8) % (_PAGE // 8) + offset
    return memory[start : start + size].reshape(*shape, LANES)


@routine
def gather(numbers: np.ndarray, begin: int, block: Rows) -> None:
    """Copy LANES variants, from `begin` on, of `numbers` (numbers, variants) to `block` (numbers, LANES).

    A block with fewer variants left repeats the last one in its remaining lanes.
    """
    count = min(LANES, numbers.shape[1] - begin)
    for i in range(numbers.shape[0]):
        if count == LANES:
            for lane in range(LANES):
                block[i, lane] = numbers[i, begin + lane]
        else:
            for lane in range(LANES):
                block[i, lane] = numbers[i, begin + min(lane, count - 1)]


@routine
def scatter_row(row: Row, begin: int, answers: np.ndarray) -> None:
    """Copy a row (LANES,) of a block to the results (variants,) of its variants, the first of which is `begin`."""
    lanes = min(LANES, answers.shape[0] - begin)
    if lanes == LANES:
        for lane in range(LANES):
            answers[begin + lane] = row[lane]
    else:
        for lane in range(lanes):
            answers[begin + lane] = row[lane]


@routine
def scatter_rows(rows: Rows, begin: int, answers: np.ndarray) -> None:
    """Copy the first rows (rows, LANES) of a block to the results (results, variants) of its variants."""
    for i in range(answers.shape[0]):
        scatter_row(rows[i], begin, answers[i])


@routine
def copy_rows(given: Rows, wanted: np.ndarray, block: Rows) -> None:
    """Copy row i of `given` to row `wanted[i]` of the block; skip negative entries of `wanted`."""
    for i in range(wanted.shape[0]):
        if wanted[i] >= 0:
            for lane in range(LANES):
                block[wanted[i], lane] = given[i, lane]
