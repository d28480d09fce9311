"""Blocks of variants: numbers of LANES of them side by side, and what is found handed out to each."""

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.memory import Memory, memory
from engine.compiling.widths import LANES

# (LANES,) and (…, LANES).
Row, Rows = Memory(()), Memory((LANES,))
lane_of, in_lanes = memory(Row), memory(Rows)


@routine
def gather(numbers: np.ndarray, begin: int, block: Rows) -> None:
    """Numbers of a block of variants; lanes beyond the last variant repeat it."""
    count = min(LANES, numbers.shape[1] - begin)
    for i in range(numbers.shape[0]):
        if count == LANES:
            for lane in range(LANES):
                block[i, lane] = numbers[i, begin + lane]
        else:
            for lane in range(LANES):
                block[i, lane] = numbers[i, begin + min(lane, count - 1)]


@routine
def hand_out_row(row: Row, begin: int, answers: np.ndarray) -> None:
    """Write a row of a block to its variants."""
    lanes = min(LANES, answers.shape[0] - begin)
    if lanes == LANES:
        for lane in range(LANES):
            answers[begin + lane] = row[lane]
    else:
        for lane in range(lanes):
            answers[begin + lane] = row[lane]


@routine
def hand_out(rows: Rows, begin: int, answers: np.ndarray) -> None:
    """Write the first rows of a block to its variants, as many as there are answers."""
    for i in range(answers.shape[0]):
        hand_out_row(rows[i], begin, answers[i])


@routine
def copy_rows(given: Rows, wanted: np.ndarray, block: Rows) -> None:
    """Copy rows to those rows of the block's numbers that are to receive them, if any."""
    for i in range(wanted.shape[0]):
        if wanted[i] >= 0:
            for lane in range(LANES):
                block[wanted[i], lane] = given[i, lane]
