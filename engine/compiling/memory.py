"""Memory of compiled code: numbers at a pointer, with known distances between rows.

Of arrays the compiler doesn't know them: it would check every pair of rows for overlap before each loop, not vectorise
where there are too many, and take several times as long.
"""

import math
import operator
from collections.abc import Callable

from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model


class Memory(types.Type):
    """Numbers at a pointer, of which all extents but the first are known; only for as long as their array lives.

    Parameters
    ----------
    inner : tuple of int
        The extents but the first.
    """

    def __init__(self, inner: tuple[int, ...]) -> None:
        self.inner = inner
        super().__init__(f"Memory{inner}")

    @property
    def distances(self) -> list[int]:
        """How many numbers lie between neighbours in each dimension."""
        return [math.prod(self.inner[i:]) for i in range(len(self.inner) + 1)]


@register_model(Memory)
class _MemoryModel(models.PrimitiveModel):
    def __init__(self, manager: object, kind: Memory) -> None:
        super().__init__(manager, kind, manager.lookup(types.float64).get_data_type().as_pointer())


def _indices(index: types.Type) -> int:
    """How many indices there are."""
    return 1 if isinstance(index, types.Integer) else len(index)


@infer_global(operator.getitem)
class _Get(AbstractTemplate):
    def generic(self, args: tuple, kws: dict) -> object:
        memory, index = args
        if not isinstance(memory, Memory):
            return None
        # With fewer indices than dimensions: what lies there.
        given = _indices(index)
        found = Memory(memory.inner[given:]) if given <= len(memory.inner) else types.float64
        return signature(found, memory, index)


@infer_global(operator.setitem)
class _Set(AbstractTemplate):
    def generic(self, args: tuple, kws: dict) -> object:
        memory, index, _ = args
        if isinstance(memory, Memory):
            return signature(types.none, memory, index, types.float64)
        return None


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


def memory(*inner: int) -> Callable:
    """Intrinsic that takes an array in C order with these inner extents for `Memory`."""
    kind = Memory(inner)

    @intrinsic
    def taken(typing_context: object, array: types.Array) -> tuple:
        def generate(context: object, builder: object, sig: object, args: list) -> object:
            return context.make_array(sig.args[0])(context, builder, args[0]).data

        return kind(array), generate

    return taken
