"""How functions are compiled: one set of floating-point rules, and a decorator for each use.

Rules: `nnan` and `ninf` are left out because a NaN must survive from the position that can't be assembled to the status
of the variant. `reassoc` is for laws alone: the compiler may take what is the same at all positions out of a loop. Sums
over positions are added in the order written, and results don't depend on the width of the processor's vectors.

Laws stay functions of Python, and Numba is loaded with the first function that is compiled: one machine needs neither.
"""

from collections.abc import Callable
from functools import cached_property, update_wrapper

from engine.compiling.in_python import over_lanes, reading_arrays

RULES = frozenset({"contract", "arcp", "nsz"})
LAW_RULES = RULES | {"reassoc"}
# Arrays are borrowed from the caller: where none is made in compiled code, none needs to be counted there.
BORROWING = {"_nrt": False}


class Law:
    """A scalar function of the mechanics; division by zero gives infinity or NaN, as in NumPy, and never raises.

    Called from Python it is computed there, element by element of its arguments. Compiled code that calls it has it
    compiled into itself, and machine code is kept on disk. It is inlined always: whether a first run or one from the
    cache, results are the same to the last bit.

    Parameters
    ----------
    function : callable
    rules : frozenset of str
        Floating-point rules of compiled code.

    Attributes
    ----------
    py_func : callable
        The function.
    """

    def __init__(self, function: Callable, rules: frozenset[str]) -> None:
        update_wrapper(self, function)
        self.py_func, self._rules = function, rules

    @cached_property
    def in_python(self) -> Callable:
        """The function with arrays of lanes in place of floats."""
        return reading_arrays(self.py_func)

    def __call__(self, *arguments: object) -> object:
        """Results at each element of the arguments."""
        return over_lanes(self.in_python, arguments)

    @cached_property
    def _compiled(self) -> Callable:
        return _kept(self.py_func, self._rules, forceinline=True)

    @property
    def _numba_type_(self) -> object:
        """What Numba takes it for: a function that it compiles."""
        return self._compiled._numba_type_


def scalar(function: Callable) -> Law:
    """A law whose sums compiled code may reorder."""
    return Law(function, LAW_RULES)


def in_order(function: Callable) -> Law:
    """A law whose operations compiled code takes exactly as they are written."""
    return Law(function, frozenset())


def driver(function: Callable, makes_arrays: bool = False) -> Callable:
    """Compile a function that runs without Python's lock; its machine code is kept on disk."""
    return _kept(function, RULES, nogil=True, **({} if makes_arrays else BORROWING))


def _kept(function: Callable, rules: frozenset[str], **options: bool) -> Callable:
    from numba import njit

    from engine.compiling.kept_code import keep_compiled

    compiled = njit(error_model="numpy", fastmath=set(rules), no_cfunc_wrapper=True, **options)(function)
    keep_compiled(compiled)
    return compiled


def inlined(function: Callable) -> Callable:
    """Compile a small function of compiled code alone; it becomes part of whatever calls it."""
    from engine.compiling.compilers import Within

    return _within(function, forceinline=True, pipeline_class=Within)


def routine(function: Callable) -> Callable:
    """Compile a function of compiled code alone that is called; what it writes to overlaps with no other argument."""
    from engine.compiling.compilers import ApartWithin

    return _within(function, forceinline=False, pipeline_class=ApartWithin)


def _within(function: Callable, **options: object) -> Callable:
    from numba import njit

    return njit(
        error_model="numpy",
        fastmath=set(RULES),
        no_cfunc_wrapper=True,
        no_cpython_wrapper=True,
        **BORROWING,
        **options,
    )(function)
