"""One set of floating-point rules, and one decorator for each kind of compiled function.

`nnan` and `ninf` are omitted because a NaN must survive from a position that can't be assembled to the variant's
status. `reassoc` is for laws only: it lets the compiler move terms that are equal at all positions out of a loop. Sums
over positions are added in the order written, whatever the width of the processor's vectors.

Laws stay Python functions, and Numba is imported with the first function that is compiled: a single machine needs
neither Numba nor compilation.
"""

from collections.abc import Callable
from functools import cached_property, update_wrapper

from engine.compiling.in_python import over_lanes, reading_arrays

RULES = frozenset({"contract", "arcp", "nsz"})
LAW_RULES = RULES | {"reassoc"}
# Functions that allocate no arrays only borrow their callers', so they need no reference counting.
BORROWING = {"_nrt": False}


class Law:
    """A scalar function of mechanics. Division by zero returns infinity or NaN, as in NumPy, and never raises.

    A call from Python is evaluated in Python, element by element. Compiled code always inlines the law, so results are
    the same to the last bit whether its machine code was just made or loaded from the cache on disk.

    Parameters
    ----------
    function : callable
    rules : frozenset of str
        LLVM fast-math flags of the compiled law.

    Attributes
    ----------
    py_func : callable
        The Python function.
    """

    def __init__(self, function: Callable, rules: frozenset[str]) -> None:
        update_wrapper(self, function)
        self.py_func, self._rules = function, rules

    @cached_property
    def in_python(self) -> Callable:
        """The Python function, adapted to take an array of lanes in place of each float."""
        return reading_arrays(self.py_func)

    def __call__(self, *arguments: object) -> object:
        """Evaluate the law at each element of its broadcast arguments."""
        return over_lanes(self.in_python, arguments)

    @cached_property
    def compiled(self) -> Callable:
        """The function compiled by Numba."""
        return _kept(self.py_func, self._rules, forceinline=True, no_cpython_wrapper=True, **_plain())

    @property
    def _numba_type_(self) -> object:
        """Numba's type of the compiled law, by which compiled code may call it."""
        return self.compiled._numba_type_


def scalar(function: Callable) -> Law:
    """Declare a law whose sums the compiler may reorder."""
    return Law(function, LAW_RULES)


def in_order(function: Callable) -> Law:
    """Declare a law whose operations the compiler must keep exactly as written."""
    return Law(function, frozenset())


def driver(function: Callable, makes_arrays: bool = False) -> Callable:
    """Compile a function that runs without Python's lock, and cache its machine code on disk."""
    return _kept(function, RULES, nogil=True, **({} if makes_arrays else _plain()))


def separate(function: Callable) -> Callable:
    """Compile a function that drivers call at its address; its machine code is cached on disk apart from theirs."""
    return _kept(function, RULES, no_cpython_wrapper=True, **_plain())


def _plain() -> dict[str, object]:
    from engine.compiling.compilers import Plain

    return {**BORROWING, "pipeline_class": Plain}


def _kept(function: Callable, rules: frozenset[str], **options: object) -> Callable:
    from numba import njit

    from engine.compiling.kept_code import keep_compiled

    compiled = njit(error_model="numpy", fastmath=set(rules), no_cfunc_wrapper=True, **options)(function)
    keep_compiled(compiled)
    return compiled


def inlined(function: Callable) -> Callable:
    """Compile a small function that only compiled code calls, and inline it into its callers."""
    from engine.compiling.compilers import Within

    return _within(function, forceinline=True, pipeline_class=Within)


def routine(function: Callable) -> Callable:
    """Compile a function that only compiled code calls; an array it writes to must overlap no other argument."""
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
