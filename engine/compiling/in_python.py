"""Evaluate scalar functions in Python over arrays of lanes, without a compiler; a debugger can step through them.

A condition that differs between lanes splits them, and each part is evaluated separately.
"""

import builtins
import math
from collections.abc import Callable, Sequence
from types import FunctionType, ModuleType, SimpleNamespace

import numpy as np


class Parted(Exception):
    """Raised where a condition holds in some lanes only; `here` (lanes,) marks those lanes."""

    def __init__(self, here: np.ndarray) -> None:
        super().__init__()
        self.here = here


class Lanes(np.ndarray):
    """An array (lanes,) that, as a condition, has the truth value common to all lanes, and else raises `Parted`."""

    def __bool__(self) -> bool:
        here = np.asarray(self, bool)
        if here.all() or not here.any():
            return bool(here.all())
        raise Parted(here)


def over_lanes(function: Callable, arguments: Sequence[object]) -> object:
    """Evaluate a function from `reading_arrays` over broadcast arguments.

    Parameters
    ----------
    function : callable
    arguments : sequence of float, ndarray, or tuple of these
        Broadcast against each other, except those that the function annotates as arrays: they are shared by all lanes.

    Returns
    -------
    float, ndarray or tuple of these
        The function's results, in the broadcast shape.
    """
    hints, code = function.__annotations__, function.__code__
    taken = {i for i, name in enumerate(code.co_varnames[: code.co_argcount]) if hints.get(name) is np.ndarray}
    each = [(part, i in taken) for i, a in enumerate(arguments) for part in (a if isinstance(a, tuple) else (a,))]
    sizes = [len(a) if isinstance(a, tuple) else 0 for a in arguments]
    numbers, shared = [np.asarray(part) for part, _ in each], [fixed for _, fixed in each]

    def on_flat_arguments(*parts: object) -> object:
        own = iter(parts)
        return function(*(tuple(next(own) for _ in range(size)) if size else next(own) for size in sizes))

    shape = np.broadcast_shapes(*(a.shape for a, fixed in zip(numbers, shared, strict=True) if not fixed))
    given = [
        a.view(Lanes) if fixed else np.broadcast_to(a, shape).ravel().view(Lanes) if a.ndim else a[()]
        for a, fixed in zip(numbers, shared, strict=True)
    ]
    # Intermediate results may divide by zero or take the logarithm of zero.
    with np.errstate(all="ignore"):
        found = _computed(on_flat_arguments, given, shared)
    if isinstance(found, tuple):
        return tuple(_shaped(part, shape) for part in found)
    return _shaped(found, shape)


def _computed(function: Callable, given: Sequence, shared: Sequence[bool]) -> object:
    try:
        return function(*given)
    except Parted as parted:
        here = parted.here
    parts = []
    for some in (here, ~here):
        own = [a if fixed or not np.ndim(a) else a[some] for a, fixed in zip(given, shared, strict=True)]
        parts.append(_computed(function, own, shared))
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
    """Copy a scalar function such that it, and every law it calls, takes arrays in place of floats.

    Parameters
    ----------
    function : function
        Uses only numbers, mathematical functions and laws from its module.
    """
    code, around = function.__code__, function.__globals__
    names = {name: _reading(around[name]) for name in code.co_names if name in around}
    own = {**_BUILTINS, **names, "__builtins__": builtins}
    made = FunctionType(code, own, function.__name__, function.__defaults__, function.__closure__)
    made.__annotations__ = function.__annotations__
    return made


def _reading(value: object) -> object:
    """Counterpart over arrays of a global name of a module of laws."""
    if value is math:
        return _MATHEMATICS
    if isinstance(value, ModuleType):
        return _NUMPY
    return getattr(value, "in_python", value)


def _to_int(x: object) -> object:
    return x.astype(int) if isinstance(x, np.ndarray) else int(x)


def _to_float64(x: object) -> object:
    return x if isinstance(x, np.ndarray) else np.float64(x)


_BUILTINS = {"int": _to_int, "float": lambda x: x * 1.0}
# Before NumPy 2, inverse functions are named arcsin, arctan2 etc.
_NAMES = {name: "arc" + name[1:] if name[:1] == "a" else name for name in dir(math)}
_MATHEMATICS = SimpleNamespace(**{m: getattr(np, n) for m, n in _NAMES.items() if hasattr(np, n)}, tau=math.tau)
_NUMPY = SimpleNamespace(float64=_to_float64)
