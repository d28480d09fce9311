"""Scalar functions in Python, over arrays of lanes: no compiler is needed, and a debugger steps through them.

A condition that holds in some lanes alone parts them, and each part is computed by itself.
"""

import builtins
import math
from collections.abc import Callable, Sequence
from types import FunctionType, ModuleType, SimpleNamespace

import numpy as np


class Parted(Exception):
    """A condition doesn't hold in all lanes; `here` says in which it does."""

    def __init__(self, here: np.ndarray) -> None:
        super().__init__()
        self.here = here


class Lanes(np.ndarray):
    """A number in each lane; as a condition it is the same in all of them, or parts them."""

    def __bool__(self) -> bool:
        here = np.asarray(self, bool)
        if here.all() or not here.any():
            return bool(here.all())
        raise Parted(here)


def over_lanes(function: Callable, arguments: Sequence[object]) -> object:
    """Results of a function from `reading_arrays`: one, or a tuple of them.

    Parameters
    ----------
    function : callable
    arguments : sequence of float, ndarray, or tuple of these
        Broadcast against each other; what the function takes as an array is the same for all lanes.
    """
    hints, code = function.__annotations__, function.__code__
    taken = {i for i, name in enumerate(code.co_varnames[: code.co_argcount]) if hints.get(name) is np.ndarray}
    each = [(part, i in taken) for i, a in enumerate(arguments) for part in (a if isinstance(a, tuple) else (a,))]
    sizes = [len(a) if isinstance(a, tuple) else 0 for a in arguments]
    numbers, whole = [np.asarray(part) for part, _ in each], [fixed for _, fixed in each]

    def of_parts(*parts: object) -> object:
        own = iter(parts)
        return function(*(tuple(next(own) for _ in range(size)) if size else next(own) for size in sizes))

    shape = np.broadcast_shapes(*(a.shape for a, fixed in zip(numbers, whole, strict=True) if not fixed))
    given = [
        a.view(Lanes) if fixed else np.broadcast_to(a, shape).ravel().view(Lanes) if a.ndim else a[()]
        for a, fixed in zip(numbers, whole, strict=True)
    ]
    # Functions may divide by zero, and take the logarithm of zero, on the way to what they give.
    with np.errstate(all="ignore"):
        found = _computed(of_parts, given, whole)
    if isinstance(found, tuple):
        return tuple(_shaped(part, shape) for part in found)
    return _shaped(found, shape)


def _computed(function: Callable, given: Sequence, whole: Sequence[bool]) -> object:
    try:
        return function(*given)
    except Parted as parted:
        here = parted.here
    parts = []
    for some in (here, ~here):
        own = [a if fixed or not np.ndim(a) else a[some] for a, fixed in zip(given, whole, strict=True)]
        parts.append(_computed(function, own, whole))
    if isinstance(parts[0], tuple):
        return tuple(_joined(here, *both) for both in zip(*parts, strict=True))
    return _joined(here, *parts)


def _joined(here: np.ndarray, holds: object, fails: object) -> np.ndarray:
    found = np.empty(here.size)
    found[here], found[~here] = holds, fails
    return found.view(Lanes)


def _shaped(part: object, shape: tuple[int, ...]) -> object:
    if not shape:
        return part
    return np.asarray(part).reshape(shape) if np.ndim(part) else np.full(shape, part)


def reading_arrays(function: FunctionType) -> FunctionType:
    """A scalar function that computes with arrays: all that it calls reads them too.

    Parameters
    ----------
    function : function
        What it takes from its module is numbers, mathematics and laws.
    """
    code, around = function.__code__, function.__globals__
    names = {name: _reading(around[name]) for name in code.co_names if name in around}
    own = {**_BUILTINS, **names, "__builtins__": builtins}
    made = FunctionType(code, own, function.__name__, function.__defaults__, function.__closure__)
    made.__annotations__ = function.__annotations__
    return made


def _reading(value: object) -> object:
    """What stands for something in a module of laws."""
    if value is math:
        return _MATHEMATICS
    if isinstance(value, ModuleType):
        return _OF_NUMPY
    return getattr(value, "in_python", value)


def _whole(x: object) -> object:
    return x.astype(int) if isinstance(x, np.ndarray) else int(x)


def _double(x: object) -> object:
    return x if isinstance(x, np.ndarray) else np.float64(x)


_BUILTINS = {"int": _whole, "float": lambda x: x * 1.0}
# Before NumPy 2, inverse functions have other names there.
_NAMES = {name: "arc" + name[1:] if name[:1] == "a" else name for name in dir(math)}
_MATHEMATICS = SimpleNamespace(**{m: getattr(np, n) for m, n in _NAMES.items() if hasattr(np, n)}, tau=math.tau)
_OF_NUMPY = SimpleNamespace(float64=_double)
