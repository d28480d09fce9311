"""Lanes: variants computed side by side, and memory laid out for them.

Every quantity of a block of variants is a row of LANES numbers, one lane each, and the innermost loop of everything
runs over the lanes. A row begins on a cache line: an accumulator a quarter line off makes sums more than twice as slow.
Loads are also held up by stores a multiple of a page away. The rows of a tile come to lie on every eighth of a page;
what is added up while a tile is read lies half a row aside from all of them.

In compiled code rows are `Memory`, a pointer with known distances between rows. Of arrays the compiler doesn't know
them: it would check every pair of rows for overlap before each loop, not vectorise where there are too many, and take
several times as long.
"""

import math
import operator
from collections.abc import Callable

import numpy as np
from numba import types
from numba.core import cgutils
from numba.core.typing.templates import AbstractTemplate, infer_global, signature
from numba.extending import intrinsic, lower_builtin, models, register_model

from engine.compiling.decorators import routine
from engine.compiling.tiles import LANES
from engine.cycle.panels.chebyshev import POSITIONS

_PAGE = 4096
# Half a row, in numbers.
ASIDE = LANES // 2


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
