"""Lanes: variants computed side by side, and memory laid out for them.

Every quantity of a block of variants is a row of LANES numbers, one lane each, and the innermost loop of everything
runs over the lanes. A row begins on a cache line: an accumulator a quarter line off makes sums more than twice as slow.
Loads are also held up by stores a multiple of a page away. The rows of a tile come to lie on every eighth of a page;
what is added up while a tile is read lies half a row off from all of them.

In compiled code rows are `Memory`, a pointer with known distances between rows. A NamedTuple with a field for each row
names them. The annotations of a record of arrays say which of them are `Memory` in compiled code, and of which record.
"""

import math
from functools import cache
from typing import get_type_hints

import numpy as np

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import routine
from engine.compiling.memory import Memory, memory
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import POSITIONS

_PAGE = 4096
# Half a row, in numbers.
ASIDE = LANES // 2

# (…, POSITIONS, LANES).
Panels = Memory((POSITIONS, LANES))
in_panels = memory(Panels)


def one(record: type) -> Memory:
    """The rows of a record."""
    return Memory((LANES,), record)


def many(record: type) -> Memory:
    """The rows of many records of one kind."""
    return Memory((len(record._fields), LANES), record, 1)


@routine
def any_positive(row: Row) -> bool:
    """Whether a row is positive in any lane."""
    found = False
    for lane in range(LANES):
        found |= row[lane] > 0.0
    return found


@routine
def fill(rows: Rows, count: int, value: float) -> None:
    """Set the first `count` rows to a value."""
    for i in range(count):
        for lane in range(LANES):
            rows[i, lane] = value


def rows(*shape: int, aside: int = 0) -> np.ndarray:
    """Array (…, LANES) of zeros that begins `aside` numbers after the beginning of a page."""
    size = math.prod(shape) * LANES
    memory = np.zeros(size + aside + _PAGE // 8)
    start = -(memory.ctypes.data // 8) % (_PAGE // 8) + aside
    return memory[start : start + size].reshape(*shape, LANES)


def tiles(count: int) -> np.ndarray:
    """Array (count, POSITIONS, LANES) of zeros that begins on a page."""
    return rows(count, POSITIONS)


# Looked up once: every evaluation makes some tens of records.
_kinds_of = cache(get_type_hints)


def new_record(record: type, /, **given: object) -> tuple:
    """A record of arrays with memory for what its annotations name.

    Parameters
    ----------
    record : type of NamedTuple
    given : int or object
        How many rows, tiles or records there are of a field; of a field that is no memory what it holds.
    """
    made = {}
    for name, kind in _kinds_of(record).items():
        if not isinstance(kind, Memory):
            made[name] = given[name]
        elif not kind.inner:
            made[name] = rows(aside=ASIDE)
        else:
            count = given[name] if kind.before or kind.record is None else len(kind.record._fields)
            inside = kind.inner[:-1]
            made[name] = rows(count, *inside, aside=0 if POSITIONS in inside else ASIDE)
    return record(**made)
