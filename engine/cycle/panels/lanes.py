"""Lanes: variants computed side by side, and arrays laid out for them.

Every quantity of a block of variants is a row of LANES numbers, and every innermost loop runs over the lanes. Rows
begin on cache lines: an accumulator off by a quarter line makes sums more than twice as slow. Loads also stall behind
stores that are a multiple of a page away. The rows of a tile lie at every eighth of a page; accumulators used while a
tile is read lie half a row off all of them.

In compiled code rows are `Memory`, a pointer with constant strides, and a NamedTuple with a field for each row names
them. The annotations of a record of arrays state which of them are `Memory` in compiled code, and of which record.
"""

from functools import cache
from typing import get_type_hints

from engine.compiling.blocks import LANES, Row, Rows, rows
from engine.compiling.decorators import routine
from engine.compiling.memory import Memory, memory
from engine.cycle.panels.chebyshev import POSITIONS

# Half a row, in numbers.
OFFSET = LANES // 2

# Shape (…, POSITIONS, LANES).
Panels = Memory((POSITIONS, LANES))
in_panels = memory(Panels)


def one(record: type) -> Memory:
    """Kind of memory with the rows of one record."""
    return Memory((LANES,), record)


def many(record: type) -> Memory:
    """Kind of memory with the rows of many records of one type."""
    return Memory((len(record._fields), LANES), record, 1)


@routine
def any_positive(row: Row) -> bool:
    """Whether a row is positive in any lane."""
    # The compiler vectorises a union of bits, but not one of truth values.
    found = 0
    for lane in range(LANES):
        found |= int(row[lane] > 0.0)
    return found != 0


@routine
def fill(rows: Rows, count: int, value: float) -> None:
    """Set the first `count` rows to a value."""
    for i in range(count):
        for lane in range(LANES):
            rows[i, lane] = value


# Cached, because every evaluation allocates tens of records.
_kinds_of = cache(get_type_hints)


def new_record(record: type, /, **given: object) -> tuple:
    """Allocate a record of arrays according to its annotations.

    Parameters
    ----------
    record : type of NamedTuple
    given : int or object
        For a field of memory, its number of rows, tiles or records; for any other field, its value.
    """
    made = {}
    for name, kind in _kinds_of(record).items():
        if not isinstance(kind, Memory):
            made[name] = given[name]
        elif not kind.inner:
            made[name] = rows(offset=OFFSET)
        else:
            count = given[name] if kind.before or kind.record is None else len(kind.record._fields)
            inside = kind.inner[:-1]
            made[name] = rows(count, *inside, offset=0 if POSITIONS in inside else OFFSET)
    return record(**made)
