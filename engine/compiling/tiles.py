"""What compiled functions that fill tiles, or rows over positions, have in common: signature, options, width."""

from collections.abc import Callable

import numba
import numpy as np
from numba import types
from numba.core.typing import Signature

from engine.compiling.compilers import Apart
from engine.compiling.decorators import RULES
from engine.compiling.kept_code import keep_compiled

_ROWS = types.float64[:, ::1]
# (P, T, q, cos_q, sin_q, tile): numbers × lanes, all tables, three times positions × lanes, curves × positions × lanes.
TILE_SIGNATURE = types.void(_ROWS, types.float64[::1], _ROWS, _ROWS, _ROWS, types.float64[:, :, ::1])
# A function of that signature as a parameter of a driver.
FILLS_TILE = types.FunctionType(TILE_SIGNATURE)
TILE_OPTIONS = {"error_model": "numpy", "fastmath": set(RULES), "nogil": True, "pipeline_class": Apart}


def filling(signature: Signature) -> Callable:
    """Decorator of functions that fill tiles or rows: compiled for one signature, their machine code kept on disk.

    Parameters
    ----------
    signature : Signature
    """

    def compiled(function: Callable) -> Callable:
        made = numba.njit(**TILE_OPTIONS)(function)
        keep_compiled(made)
        made.compile(signature)
        made.disable_compile()
        return made

    return compiled


def field_signature(dtype: np.dtype) -> Signature:
    """Signature of functions that fill rows over the positions of one variant.

    Their arguments are (p, T, q, cos_q, sin_q, v, rows): the variant's numbers, all tables, positions with cosines and
    sines, the variant's place, and rows (curves, variants, positions). They compute in double precision.

    Parameters
    ----------
    dtype : float64 or float32
        In which the rows are kept.
    """
    line = types.float64[::1]
    return types.void(line, line, line, line, line, types.intp, numba.from_dtype(np.dtype(dtype))[:, :, ::1])


class TypedFunction(types.WrapperAddressProtocol):
    """A compiled function of one signature as a value: handed over as it is, it would be looked up at every call.

    Parameters
    ----------
    function : callable
        Compiled for this signature.
    of : Signature
    """

    def __init__(self, function: Callable, of: Signature) -> None:
        self._function, self._signature = function, of
        compiled = function.overloads[of.args]
        self._address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)

    def __wrapper_address__(self) -> int:
        """Where its machine code begins."""
        return self._address

    def signature(self) -> Signature:
        """The signature."""
        return self._signature


class TileFunction(TypedFunction):
    """A function that fills tiles as a value.

    Parameters
    ----------
    function : callable
        Compiled for `TILE_SIGNATURE`.
    """

    def __init__(self, function: Callable) -> None:
        super().__init__(function, TILE_SIGNATURE)
