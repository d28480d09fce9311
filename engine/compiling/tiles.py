"""Signatures and options shared by compiled functions that fill tiles or rows over positions."""

from collections.abc import Callable
from functools import cache

import numba
import numpy as np
from numba import types
from numba.core.typing import Signature

from engine.compiling.blocks import Row
from engine.compiling.compilers import Apart
from engine.compiling.decorators import BORROWING, RULES
from engine.compiling.kept_code import compiling, keep_compiled
from engine.compiling.memory import memory

_ROWS = types.float64[:, ::1]
# (P, T, q, cos_q, sin_q, tile): numbers (numbers, lanes), all tables, three arrays (positions, lanes), and the tile
# (curves, positions, lanes).
TILE_SIGNATURE = types.void(_ROWS, types.float64[::1], _ROWS, _ROWS, _ROWS, types.float64[:, :, ::1])
# An array as its numbers, one after the other. Compiling `ravel` takes as long as all else in a short function.
flat = memory(Row)
TILE_OPTIONS = {"error_model": "numpy", "fastmath": set(RULES), "nogil": True, "pipeline_class": Apart}


def filling(signature: Signature) -> Callable:
    """Decorator that compiles a function for one signature and caches its machine code on disk.

    Only compiled code calls it, at its address.

    Parameters
    ----------
    signature : Signature
    """

    def compiled(function: Callable) -> Callable:
        borrows = {} if "empty" in function.__code__.co_names else BORROWING
        made = numba.njit(**TILE_OPTIONS, **borrows, no_cpython_wrapper=True)(function)
        keep_compiled(made)
        made.compile(signature)
        made.disable_compile()
        return made

    return compiled


@cache
def field_signature(dtype: np.dtype) -> Signature:
    """Signature of functions that fill rows over the positions of one variant, in double precision.

    Their arguments are (p, T, q, cos_q, sin_q, v, rows): the variant's numbers, all tables, the positions with their
    cosines and sines, the variant's index, and rows (curves, variants, positions).

    Parameters
    ----------
    dtype : float64 or float32
        Type in which the rows are stored.
    """
    line = types.float64[::1]
    return types.void(line, line, line, line, line, types.intp, numba.from_dtype(np.dtype(dtype))[:, :, ::1])


class TypedFunction(types.WrapperAddressProtocol):
    """A compiled function of one signature as a value; Numba would look up a plain function at every call.

    Parameters
    ----------
    function : callable
        Compiled for this signature alone.
    of : Signature
    """

    def __init__(self, function: Callable, of: Signature) -> None:
        self._function, self._signature = function, of
        (compiled,) = function.overloads.values()
        self._address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)

    def __wrapper_address__(self) -> int:
        """Address of its machine code."""
        return self._address

    def signature(self) -> Signature:
        """Its signature."""
        return self._signature


class TileFunction(TypedFunction):
    """A tile function as a value.

    Parameters
    ----------
    function : callable or None
        Compiled for `TILE_SIGNATURE`; None where there is nothing to fill.
    """

    def __init__(self, function: Callable | None) -> None:
        super().__init__(_nothing() if function is None else function, TILE_SIGNATURE)


@cache
def _nothing() -> Callable:
    def nothing(
        P: np.ndarray, T: np.ndarray, q: np.ndarray, cos_q: np.ndarray, sin_q: np.ndarray, tile: np.ndarray
    ) -> None:
        """Leave the tile unchanged."""

    with compiling():
        return filling(TILE_SIGNATURE)(nothing)
