"""Run drivers: compile them once for their parameter types, and spread their work over all threads."""

from collections.abc import Callable, Sequence
from functools import wraps

import numpy as np
from numba import types

from engine.compiling.decorators import driver
from engine.compiling.kept_code import compiling
from engine.compiling.threads import on_all_threads, pieces_of


def prepare(compiled: Callable, parameters: Sequence[types.Type]) -> None:
    """Compile a `driver` for its parameter types, or load it from the cache, once.

    The types are explicit because Numba otherwise gives each function its own type, and would compile the driver again
    for every machine.

    Parameters
    ----------
    compiled : callable
        Returns nothing.
    parameters : sequence of Type
    """
    with compiling():
        if tuple(parameters) in compiled.overloads:
            return
        compiled.disable_compile(False)
        compiled.compile(types.void(*parameters))
        compiled.disable_compile()


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
    on_all_threads(lambda piece: compiled(*piece, *arguments()), pieces_of(count))


def of_all(values: np.ndarray, who: np.ndarray, count: int) -> np.ndarray:
    """Scatter results (…, selected) of the variants `who` to (…, count) variants; the others get NaN."""
    whole = np.full((*values.shape[:-1], count), np.nan)
    whole[..., who] = values
    return whole


def over_variants(function: Callable) -> Callable:
    """Compile a function of a range of variants; the result takes their number and runs in pieces on all threads."""
    kernel = driver(function, makes_arrays=True)

    @wraps(function)
    def run(count: int, *arguments: object) -> None:
        with compiling():
            kernel(0, 0, *arguments)
        on_all_threads(lambda piece: kernel(*piece, *arguments), pieces_of(count))

    return run


def sum_of_rows(rows: np.ndarray) -> np.ndarray:
    """Sum over the first axis in row order. NumPy's own sum adds in a different order for one variant than for many."""
    return np.add.accumulate(rows, axis=0)[-1]


def mean_of_rows(rows: np.ndarray) -> np.ndarray:
    """Mean over the first axis, summed in row order."""
    return sum_of_rows(rows) / len(rows)
