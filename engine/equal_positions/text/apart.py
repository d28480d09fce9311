"""Rows known to lie apart in memory: loops over positions that fill many of them.

A vectorised loop first makes sure that no row it writes lies across another row. The compiler does so by comparing
every two of them, and gives up where they are many: then each position is computed by itself, several times slower.
Here reads and writes say what the compiler can't know, that rows of a kernel never share memory.
"""

import re
from functools import partial

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic

# Half of what the compiler compares at most (LLVM's vectorize-memory-check-threshold): it counts in its own way.
COMPARISONS = 64

_WRITE = re.compile(r"(\w+)\[k\] = (.*)")
_READ = re.compile(r"(\w+)\[k\]")


def is_long(lines: list[str]) -> bool:
    """Whether a loop over positions k fills more rows than the compiler compares.

    Every write of a row is `row[k] = …` on a line of its own.
    """
    written = _written(lines)
    read = set(_READ.findall("\n".join(lines))) - set(written)
    count = len(written)
    return count * (count - 1) // 2 + count * len(read) > COMPARISONS


def said_apart(lines: list[str]) -> list[str]:
    """Lines of a loop over positions k with reads and writes that say rows lie apart."""
    written = _written(lines)
    count, found = len(written), []
    for line in lines:
        match = _WRITE.fullmatch(line)
        value = _READ.sub(partial(_read, written), match[2] if match else line)
        found.append(f"write_apart({match[1]}, k, {value}, {written.index(match[1])}, {count})" if match else value)
    return found


def _read(written: list[str], match: re.Match[str]) -> str:
    """Reading of a row: one that is written too, or one that only is read."""
    row, count = match[1], len(written)
    return f"read_own({row}, k, {written.index(row)}, {count})" if row in written else f"read_apart({row}, k, {count})"


def _written(lines: list[str]) -> list[str]:
    return [match[1] for line in lines if (match := _WRITE.fullmatch(line))]


def _place(context: object, builder: ir.IRBuilder, kind: object, row: ir.Value, k: ir.Value) -> ir.Value:
    return cgutils.get_item_pointer(context, builder, kind, context.make_array(kind)(context, builder, row), [k])


def _scopes(builder: ir.IRBuilder, count: int) -> list[ir.MDValue]:
    """A scope for each row written: what is marked as outside a scope shares no memory with what is marked as in it."""
    module = builder.module
    domain = module.add_metadata(["rows of a kernel"])
    return [module.add_metadata([f"row {i}", domain]) for i in range(count)]


@intrinsic
def write_apart(typing: object, row: object, k: object, value: object, i: object, count: object) -> tuple | None:
    """row[k] = value, where row is the i-th of a number of rows that a loop writes; both are literal."""
    if not isinstance(i, types.IntegerLiteral) or not isinstance(count, types.IntegerLiteral):
        return None

    def generate(context: object, builder: ir.IRBuilder, signature: object, arguments: list) -> None:
        written = builder.store(arguments[2], _place(context, builder, row, arguments[0], arguments[1]))
        scopes = _scopes(builder, count.literal_value)
        own = scopes.pop(i.literal_value)
        written.set_metadata("alias.scope", builder.module.add_metadata([own]))
        written.set_metadata("noalias", builder.module.add_metadata(scopes))

    return types.void(row, types.intp, row.dtype, i, count), generate


@intrinsic
def read_apart(typing: object, row: object, k: object, count: object) -> tuple | None:
    """row[k] of a row that a loop which writes a number of rows only reads; the number is literal."""
    if not isinstance(count, types.IntegerLiteral):
        return None

    def generate(context: object, builder: ir.IRBuilder, signature: object, arguments: list) -> ir.Value:
        value = builder.load(_place(context, builder, row, arguments[0], arguments[1]))
        value.set_metadata("noalias", builder.module.add_metadata(_scopes(builder, count.literal_value)))
        return value

    return row.dtype(row, types.intp, count), generate


@intrinsic
def read_own(typing: object, row: object, k: object, i: object, count: object) -> tuple | None:
    """row[k] of the i-th of a number of rows that a loop writes; both are literal."""
    if not isinstance(i, types.IntegerLiteral) or not isinstance(count, types.IntegerLiteral):
        return None

    def generate(context: object, builder: ir.IRBuilder, signature: object, arguments: list) -> ir.Value:
        value = builder.load(_place(context, builder, row, arguments[0], arguments[1]))
        scopes = _scopes(builder, count.literal_value)
        own = scopes.pop(i.literal_value)
        value.set_metadata("alias.scope", builder.module.add_metadata([own]))
        value.set_metadata("noalias", builder.module.add_metadata(scopes))
        return value

    return row.dtype(row, types.intp, i, count), generate
