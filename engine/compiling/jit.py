"""What modules that still write their kernels as text are compiled with; it goes with them."""

from collections.abc import Callable
from functools import wraps

from numba import njit

from engine.compiling.decorators import LAW_RULES, scalar
from engine.compiling.kept_code import BROKEN, COMPILING, cache_folder, empty_cache, keep_compiled
from engine.compiling.printed import _load as load_kernel
from engine.compiling.printed import load_printed as load_compiled
from engine.compiling.sources import sources_digest
from engine.compiling.threads import on_all_threads, pieces_of, set_threads, threads

__all__ = ["cache_folder", "load_compiled", "on_all_threads", "scalar", "set_threads", "sources_digest", "threads"]

KERNEL_OPTIONS = {"error_model": "numpy", "fastmath": set(LAW_RULES), "nogil": True, "cache": True}


def routine(function: Callable) -> Callable:
    """Compile a function too large to be inlined wherever it is called; otherwise as of `scalar`."""
    compiled = njit(error_model="numpy", fastmath=set(LAW_RULES), forceinline=False, no_cfunc_wrapper=True)(function)
    keep_compiled(compiled)
    return compiled


def run_kernel(text: str, function: str, count: int, *arguments: object) -> None:
    """Run a function of a generated source over a range 0 … count − 1, in pieces on all threads."""
    with COMPILING:
        try:
            getattr(load_kernel(text), function)(0, 0, *arguments)
        except BROKEN:
            load_kernel.cache_clear()
            empty_cache()
            getattr(load_kernel(text), function)(0, 0, *arguments)
        kernel = getattr(load_kernel(text), function)
    on_all_threads(lambda piece: kernel(*piece, *arguments), pieces_of(count))


def over_variants(function: Callable) -> Callable:
    """Compile a function over a range of variants; called with their number, it runs in pieces on all threads."""
    kernel = njit(**{**KERNEL_OPTIONS, "cache": False})(function)
    keep_compiled(kernel)

    @wraps(function)
    def run(count: int, *arguments: object) -> None:
        with COMPILING:
            kernel(0, 0, *arguments)
        on_all_threads(lambda piece: kernel(*piece, *arguments), pieces_of(count))

    return run
