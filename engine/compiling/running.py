"""Running of drivers: compiled once for the types of their parameters, spread over all threads."""

from collections.abc import Callable, Sequence
from functools import wraps

import numpy as np
from numba import types

from engine.compiling.decorators import driver
from engine.compiling.kept_code import compiling
from engine.compiling.threads import on_all_threads, pieces_of


def prepare(compiled: Callable, parameters: Sequence[types.Type]) -> None:
    """Compile a `driver` for the types of its parameters, or load it, once.

    Types are stated because a function is otherwise a type of its own: the driver would be compiled for every machine.

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
    """Run a `driver` over a range 0 … count − 1 in pieces on all threads; its first two parameters are the range.

    Parameters
    ----------
    compiled : callable
    count : int
    arguments : callable
        Returns what follows the range, for one piece.
    """
    on_all_threads(lambda piece: compiled(*piece, *arguments()), pieces_of(count))


def of_all(values: np.ndarray, who: np.ndarray, count: int) -> np.ndarray:
    """Numbers of some variants, (…, variants), as those of so many, NaN for the others."""
    whole = np.full((*values.shape[:-1], count), np.nan)
    whole[..., who] = values
    return whole


def over_variants(function: Callable) -> Callable:
    """Compile a function over a range of variants; called with their number, it runs in pieces on all threads."""
    kernel = driver(function, makes_arrays=True)

    @wraps(function)
    def run(count: int, *arguments: object) -> None:
        with compiling():
            kernel(0, 0, *arguments)
        on_all_threads(lambda piece: kernel(*piece, *arguments), pieces_of(count))

    return run


def sum_of_rows(rows: np.ndarray) -> np.ndarray:
    """Sum over the first axis, row after row: NumPy adds the numbers of one variant in another order than of many."""
    return np.add.accumulate(rows, axis=0)[-1]


def mean_of_rows(rows: np.ndarray) -> np.ndarray:
    """Mean over the first axis, row after row."""
    return sum_of_rows(rows) / len(rows)
