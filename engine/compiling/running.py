"""Run drivers: compile them once for their parameter types, and spread their work over all threads."""

from collections.abc import Callable, Hashable
from functools import wraps

import numba
import numpy as np
from numba import types
from numba.core.compiler import CompileResult

from engine.compiling.decorators import driver
from engine.compiling.kept_code import compiling
from engine.compiling.packed import Packed
from engine.compiling.threads import on_all_threads, pieces_of

# Machine code of drivers, by driver and layout of its arguments.
_code: dict[tuple[Callable, Hashable], Callable] = {}
# Addresses of machine code, by function and types of its arguments.
_addresses: dict[tuple, int] = {}
# Flags of an array that don't change its type in Numba: whether it owns its memory.
_OWNS_DATA = 0x4


def _layout(value: object) -> Hashable:
    """What determines Numba's type of an argument. Numba itself takes a millisecond to derive the type of a record."""
    if isinstance(value, np.ndarray):
        return value.dtype, value.ndim, value.flags.num & ~_OWNS_DATA
    if isinstance(value, tuple):
        return type(value), tuple(map(_layout, value))
    if isinstance(value, Packed):
        # Each type is made once.
        return id(value.kind)
    if isinstance(value, types.WrapperAddressProtocol):
        # Each signature is made once; comparing signatures takes long.
        return id(value.signature())
    if callable(value):
        # Each function has its own type in Numba.
        raise TypeError(f"{value} must be passed as a value of its signature")
    return type(value)


def run_piece(compiled: Callable, piece: tuple[int, int], arguments: tuple) -> None:
    """Run a `driver` over a piece of its range; compile it, or load it from the cache, if it is new to the arguments.

    Parameters
    ----------
    compiled : callable
        Returns nothing; its first two parameters are the begin and end of the piece.
    piece : tuple of int
    arguments : tuple
        The remaining ones.
    """
    known = compiled, _layout(arguments)
    if known not in _code:
        with compiling():
            kinds = types.intp, types.intp, *map(numba.typeof, arguments)
            _code[known] = _made(compiled, kinds).entry_point
    _code[known](*piece, *arguments)


def _made(compiled: Callable, kinds: tuple[types.Type, ...]) -> CompileResult:
    """Machine code for some types of arguments, compiled or from the cache."""
    if kinds not in compiled.overloads:
        compiled.disable_compile(False)
        compiled.compile(types.void(*kinds))
        compiled.disable_compile()
    return compiled.overloads[kinds]


def address_of(compiled: Callable, *kinds: types.Type) -> int:
    """Address of the machine code of a `separate` function for some types of arguments.

    Parameters
    ----------
    compiled : callable
        Returns nothing.
    kinds : types
    """
    # Each type is made once; comparing types takes long.
    known = compiled, *map(id, kinds)
    if known not in _addresses:
        with compiling():
            made = _made(compiled, kinds)
            _addresses[known] = made.library.get_pointer_to_function(made.fndesc.llvm_func_name)
    return _addresses[known]


def spread(compiled: Callable, count: int, arguments: Callable) -> None:
    """Run a `driver` over the range 0 … count − 1, in pieces on all threads.

    Parameters
    ----------
    compiled : callable
        Its first two parameters are the begin and end of a piece.
    count : int
    arguments : callable
        Returns the remaining arguments, called once for each piece.
    """
    on_all_threads(lambda piece: run_piece(compiled, piece, arguments()), pieces_of(count))


def of_all(values: np.ndarray, who: np.ndarray, count: int) -> np.ndarray:
    """Scatter results (…, selected) of the variants `who` to (…, count) variants; the others get NaN."""
    whole = np.full((*values.shape[:-1], count), np.nan)
    whole[..., who] = values
    return whole


def over_variants(function: Callable) -> Callable:
    """Compile a function of a range of variants; the result takes their number and runs in pieces on all threads."""
    kernel = driver(function, makes_arrays=True)

    @wraps(function)
    def over_all(count: int, *arguments: object) -> None:
        spread(kernel, count, lambda: arguments)

    return over_all


def sum_of_rows(rows: np.ndarray) -> np.ndarray:
    """Sum over the first axis in row order, for one variant as for many."""
    # NumPy adds the rows of a single column in pairs, those of several columns one after the other.
    if rows[0].size == 1:
        return np.add.accumulate(rows, axis=0)[-1]
    return np.add.reduce(np.ascontiguousarray(rows), axis=0)


def mean_of_rows(rows: np.ndarray) -> np.ndarray:
    """Mean over the first axis, summed in row order."""
    return sum_of_rows(rows) / len(rows)
