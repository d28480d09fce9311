"""Memory in compiled code: numbers at a pointer, with constant strides and named rows.

The strides of arrays aren't known to the compiler. It would check every pair of rows for overlap before each loop, give
up vectorising where there are too many pairs, and take several times as long to compile.

A record of rows, `class Walk(NamedTuple)` with a field for each row, gives rows names: `walk.half[lane]`. All rows of a
record lie at known distances from one pointer. A tuple of rows would be one pointer each, and every function would take
dozens of arguments.
"""

import math
import operator
from collections.abc import Callable

from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, AttributeTemplate, infer_global, signature
from numba.extending import infer_getattr, intrinsic, lower_builtin, lower_getattr_generic, models, register_model


class Memory(types.Type):
    """Numba type of a C-ordered block of float64 at a pointer; all extents but the first are constants.

    It doesn't keep the array it points into alive.

    Parameters
    ----------
    inner : tuple of int
        All extents but the first.
    record : type of NamedTuple, optional
        Names the rows along one dimension by its fields.
    before : int
        Number of dimensions before the one with named rows.
    """

    def __init__(self, inner: tuple[int, ...], record: type | None = None, before: int = 0) -> None:
        self.inner, self.record, self.before = inner, record, before
        super().__init__(f"Memory{inner}" if record is None else f"{record.__name__}{inner}{before}")

    @property
    def distances(self) -> list[int]:
        """Stride of each dimension, in numbers."""
        return [math.prod(self.inner[i:]) for i in range(len(self.inner) + 1)]

    def within(self, indices: int) -> types.Type:
        """Type of the element or sub-block at a number of leading indices."""
        if indices > len(self.inner):
            return types.float64
        named = self.record is not None and indices <= self.before
        return Memory(self.inner[indices:], *((self.record, self.before - indices) if named else ()))


@register_model(Memory)
class _MemoryModel(models.PrimitiveModel):
    def __init__(self, manager: object, kind: Memory) -> None:
        super().__init__(manager, kind, manager.lookup(types.float64).get_data_type().as_pointer())


def _indices(index: types.Type) -> int:
    """Number of indices."""
    return 1 if isinstance(index, types.Integer) else len(index)


@infer_global(operator.getitem)
class _Get(AbstractTemplate):
    def generic(self, args: tuple, kws: dict) -> object:
        memory, index = args
        return signature(memory.within(_indices(index)), memory, index) if isinstance(memory, Memory) else None


@infer_global(operator.setitem)
class _Set(AbstractTemplate):
    def generic(self, args: tuple, kws: dict) -> object:
        memory, index, _ = args
        if isinstance(memory, Memory):
            return signature(types.none, memory, index, types.float64)
        return None


@infer_getattr
class _GetRow(AttributeTemplate):
    key = Memory

    def generic_resolve(self, memory: Memory, name: str) -> types.Type | None:
        if memory.record is None or memory.before or name not in memory.record._fields:
            return None
        return memory.within(1)


def _pointer(context: object, builder: object, memory: Memory, index: types.Type, values: list) -> object:
    kinds = [index] if isinstance(index, types.Integer) else list(index.types)
    numbers = [values[1]] if isinstance(index, types.Integer) else cgutils.unpack_tuple(builder, values[1])
    offset = context.get_constant(types.intp, 0)
    for kind, number, distance in zip(kinds, numbers, memory.distances, strict=False):
        number = context.cast(builder, number, kind, types.intp)
        step = builder.mul(number, context.get_constant(types.intp, distance), flags=("nsw",))
        offset = builder.add(offset, step, flags=("nsw",))
    return builder.gep(values[0], [offset], inbounds=True)


@lower_builtin(operator.getitem, Memory, types.Any)
def _get(context: object, builder: object, sig: object, args: list) -> object:
    pointer = _pointer(context, builder, sig.args[0], sig.args[1], args)
    return builder.load(pointer) if sig.return_type == types.float64 else pointer


@lower_builtin(operator.setitem, Memory, types.Any, types.Any)
def _set(context: object, builder: object, sig: object, args: list) -> None:
    builder.store(args[2], _pointer(context, builder, sig.args[0], sig.args[1], args))


@lower_getattr_generic(Memory)
def _get_row(context: object, builder: object, memory: Memory, value: object, name: str) -> object:
    offset = memory.record._fields.index(name) * memory.distances[0]
    return builder.gep(value, [context.get_constant(types.intp, offset)], inbounds=True)


def memory(kind: Memory) -> Callable:
    """Make an intrinsic that views a C-ordered array as a kind of `Memory`."""

    @intrinsic
    def taken(typing_context: object, array: types.Array) -> tuple:
        def generate(context: object, builder: object, sig: object, args: list) -> object:
            return context.make_array(sig.args[0])(context, builder, args[0]).data

        return kind(array), generate

    return taken
