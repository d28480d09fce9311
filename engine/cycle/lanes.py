"""Lanes: variants computed side by side, and memory laid out for them.

Every quantity of a block of variants is a row of LANES numbers, one lane each, and the innermost loop of everything runs
over the lanes. A row begins on a cache line: an accumulator a quarter line off makes sums more than twice as slow.
Loads are also held up by stores a multiple of a page away. The rows of a tile come to lie on every eighth of a page; what
is added up while a tile is read lies half a row aside from all of them.
"""

import math
from collections.abc import Callable

import numpy as np
from numba import types
from numba.core import cgutils
from numba.extending import intrinsic

from engine.cycle.chebyshev import POSITIONS

LANES = 64
_PAGE = 4096
# Half a row, in numbers.
ASIDE = LANES // 2


def _with_known_shape(*last: int) -> Callable:
    """Intrinsic that states the last dimensions of an array in C order.

    Rows are then constant distances apart. Without that the compiler must check for every pair of rows whether they
    overlap, and for more than a few it doesn't vectorise.
    """

    @intrinsic
    def known(typing_context: object, array: types.Array) -> tuple:
        def generate(context: object, builder: object, signature: object, arguments: tuple) -> object:
            given = context.make_array(array)(context, builder, arguments[0])
            ndim, itemsize = array.ndim, context.get_abi_sizeof(context.get_data_type(array.dtype))
            shape = cgutils.unpack_tuple(builder, given.shape, ndim)
            strides = cgutils.unpack_tuple(builder, given.strides, ndim)
            step = itemsize
            for axis in range(ndim - 1, ndim - 1 - len(last), -1):
                length = last[axis - ndim]
                shape[axis], strides[axis] = (context.get_constant(types.intp, n) for n in (length, step))
                step *= length
            if len(last) < ndim:
                strides[ndim - 1 - len(last)] = context.get_constant(types.intp, step)
            given.shape, given.strides = (cgutils.pack_array(builder, numbers) for numbers in (shape, strides))
            context.nrt.incref(builder, array, given._getvalue())
            return given._getvalue()

        return array(array), generate

    return known


# Of rows: (…, LANES); of panels: (…, POSITIONS, LANES).
in_lanes = _with_known_shape(LANES)
in_panels = _with_known_shape(POSITIONS, LANES)


def rows(*shape: int, aside: int = 0) -> np.ndarray:
    """Array (…, LANES) of zeros that begins `aside` numbers after the beginning of a page."""
    size = math.prod(shape) * LANES
    memory = np.zeros(size + aside + _PAGE // 8)
    start = -(memory.ctypes.data // 8) % (_PAGE // 8) + aside
    return memory[start : start + size].reshape(*shape, LANES)


def tiles(count: int) -> np.ndarray:
    """Array (count, POSITIONS, LANES) of zeros that begins on a page."""
    return rows(count, POSITIONS)
