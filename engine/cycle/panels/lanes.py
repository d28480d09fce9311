"""Lanes: variants computed side by side, and memory laid out for them.

Every quantity of a block of variants is a row of LANES numbers, one lane each, and the innermost loop of everything
runs over the lanes. A row begins on a cache line: an accumulator a quarter line off makes sums more than twice as slow.
Loads are also held up by stores a multiple of a page away. The rows of a tile come to lie on every eighth of a page;
what is added up while a tile is read lies half a row aside from all of them.

In compiled code rows are `Memory`, a pointer with known distances between rows.
"""

import math

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.memory import Memory, memory
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import POSITIONS

_PAGE = 4096
# Half a row, in numbers.
ASIDE = LANES // 2


# (LANES,), (…, LANES) and (…, POSITIONS, LANES).
lane_of = memory()
in_lanes = memory(LANES)
in_panels = memory(POSITIONS, LANES)


@routine
def any_positive(row: Memory) -> bool:
    """Whether a row is positive in any lane."""
    found = False
    for lane in range(LANES):
        found |= row[lane] > 0.0
    return found


def rows(*shape: int, aside: int = 0) -> np.ndarray:
    """Array (…, LANES) of zeros that begins `aside` numbers after the beginning of a page."""
    size = math.prod(shape) * LANES
    memory = np.zeros(size + aside + _PAGE // 8)
    start = -(memory.ctypes.data // 8) % (_PAGE // 8) + aside
    return memory[start : start + size].reshape(*shape, LANES)


def tiles(count: int) -> np.ndarray:
    """Array (count, POSITIONS, LANES) of zeros that begins on a page."""
    return rows(count, POSITIONS)
