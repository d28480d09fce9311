"""How functions are compiled: one set of floating-point rules, and a decorator for each use.

Rules: `nnan` and `ninf` are left out because a NaN must survive from the position that can't be assembled to the status
of the variant. `reassoc` is for laws alone: the compiler may take what is the same at all positions out of a loop. Sums
over positions are added in the order written, and results don't depend on the width of the processor's vectors.
"""

from collections.abc import Callable

from numba import njit
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import Compiler

from engine.compiling.kept_code import keep_compiled

RULES = frozenset({"contract", "arcp", "nsz"})
LAW_RULES = RULES | {"reassoc"}
# Arrays are borrowed from the caller: where none is made in compiled code, none needs to be counted there.
BORROWING = {"_nrt": False}


class PartOfCallers(JITCodeLibrary):
    """Code that becomes part of its callers' alone: with theirs it is optimised and made into machine code, once.

    A library of Numba's own would be both by itself too, at every level of calls again.
    """

    def _optimize_final_module(self) -> None:
        """Leave it to the callers."""

    def _finalize_final_module(self) -> None:
        self._finalize_dynamic_globals()
        self._verify_declare_only_symbols()
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Nowhere: there is no machine code."""
        return 0

    @property
    def codegen(self) -> "PartOfCallers":
        """What takes the environment for Python's objects, of which compiled code alone has none."""
        return self

    def set_env(self, name: str, environment: object) -> None:
        """Nothing reads it."""


class Within(Compiler):
    """Compiler of functions that are called by compiled code alone."""

    def define_pipelines(self) -> list:
        """Passes as usual, into a library that waits for its callers'."""
        self.state.library = PartOfCallers(self.state.targetctx.codegen(), self.state.func_id.func_qualname)
        return super().define_pipelines()


class Apart(Compiler):
    """Compiler that takes it for granted that arrays handed over don't overlap, where one of them is written to.

    It then needs neither checks before every loop nor another, slow loop for when they do.
    """

    def define_pipelines(self) -> list:
        """Passes as usual, with the promise among the flags."""
        self.state.flags.noalias = True
        return super().define_pipelines()


class ApartWithin(Apart, Within):
    """Both."""


def scalar(function: Callable) -> Callable:
    """Compile a scalar function of the mechanics; it is compiled into whatever calls it, and kept on disk.

    Division by zero gives infinity or NaN, as in NumPy, and never raises. It is inlined always: whether a first run
    or one from the cache, results are the same to the last bit.
    """
    return _kept(function, LAW_RULES, forceinline=True)


def in_order(function: Callable) -> Callable:
    """Compile a scalar function as `scalar` does, its operations exactly as they are written."""
    return _kept(function, frozenset(), forceinline=True)


def driver(function: Callable, makes_arrays: bool = False) -> Callable:
    """Compile a function that runs without Python's lock; its machine code is kept on disk."""
    return _kept(function, RULES, nogil=True, **({} if makes_arrays else BORROWING))


def _kept(function: Callable, rules: frozenset[str], **options: bool) -> Callable:
    compiled = njit(error_model="numpy", fastmath=set(rules), no_cfunc_wrapper=True, **options)(function)
    keep_compiled(compiled)
    return compiled


def inlined(function: Callable) -> Callable:
    """Compile a small function of compiled code alone; it becomes part of whatever calls it."""
    return _within(function, forceinline=True, pipeline_class=Within)


def routine(function: Callable) -> Callable:
    """Compile a function of compiled code alone that is called; what it writes to overlaps with no other argument."""
    return _within(function, forceinline=False, pipeline_class=ApartWithin)


def _within(function: Callable, **options: object) -> Callable:
    return njit(
        error_model="numpy",
        fastmath=set(RULES),
        no_cfunc_wrapper=True,
        no_cpython_wrapper=True,
        **BORROWING,
        **options,
    )(function)
