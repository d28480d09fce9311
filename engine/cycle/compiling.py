"""How this room is compiled: in lanes, once for all machines.

Loops over lanes need no freedom to reorder sums: what is added up over positions is added in the order written,
whatever the lane, and results don't depend on the width of the processor's vectors.
"""

from collections.abc import Callable, Sequence
from itertools import pairwise

from numba import njit, types
from numba.core.compiler import Compiler

from engine.compiling.jit import (
    COMPILING,
    FLOATING_POINT_RULES,
    keep_compiled,
    on_all_threads,
    pieces_of,
)

RULES = set(FLOATING_POINT_RULES) - {"reassoc"}

_rows = types.float64[:, ::1]
# What a machine gives: curves(P, T, q, cos_q, sin_q, tile), see `engine.cycle.machine`.
CURVES_SIGNATURE = types.void(_rows, types.float64[::1], _rows, _rows, _rows, types.float64[:, :, ::1])
CURVES = types.FunctionType(CURVES_SIGNATURE)


class _Apart(Compiler):
    """Compiler that takes it for granted that arrays handed over don't overlap, where one of them is written to.

    It then needs neither checks before every loop nor another, slow loop for when they do.
    """

    def define_pipelines(self) -> list:
        self.state.flags.noalias = True
        return super().define_pipelines()


def scalar(function: Callable) -> Callable:
    """Compile a small function; it becomes part of whatever calls it."""
    return njit(error_model="numpy", fastmath=RULES, forceinline=True, no_cfunc_wrapper=True, no_cpython_wrapper=True)(
        function
    )


def routine(function: Callable) -> Callable:
    """Compile a function that is called, not inlined; arrays that it writes to overlap with no other argument."""
    return njit(
        error_model="numpy",
        fastmath=RULES,
        forceinline=False,
        no_cfunc_wrapper=True,
        no_cpython_wrapper=True,
        pipeline_class=_Apart,
    )(function)


def curves_function(function: Callable) -> Callable:
    """Compile one of a machine's functions, of the signature that `engine.cycle` takes."""
    return njit(CURVES_SIGNATURE, error_model="numpy", fastmath=RULES, nogil=True, pipeline_class=_Apart)(function)


def driver(function: Callable) -> Callable:
    """Compile a function that runs without Python's lock; its machine code is kept on disk."""
    compiled = njit(error_model="numpy", fastmath=RULES, nogil=True, no_cfunc_wrapper=True)(function)
    keep_compiled(compiled)
    return compiled


def prepare(compiled: Callable, signature: Sequence[types.Type]) -> None:
    """Compile a `driver` for the types of its parameters, or load it, once.

    Types are stated because a function is otherwise a type of its own: the driver would be compiled for every machine.
    """
    with COMPILING:
        if tuple(signature) not in compiled.overloads:
            compiled.disable_compile(False)
            compiled.compile(types.void(*signature))
            compiled.disable_compile()


def spread(compiled: Callable, count: int, arguments: Callable) -> None:
    """Run a `driver` over a range 0 … count − 1 in pieces on all threads; its first two parameters are the range.

    Parameters
    ----------
    compiled : callable
    count : int
    arguments : callable
        Returns what follows the range, for one piece.
    """
    pieces = pieces_of(count)
    ends = [i * count // pieces for i in range(pieces + 1)] if pieces else []
    on_all_threads(lambda piece: compiled(*piece, *arguments()), list(pairwise(ends)))
