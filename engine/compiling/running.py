"""Running of drivers: compiled once for the types of their parameters, spread over all threads."""

from collections.abc import Callable, Sequence

from numba import types

from engine.compiling.kept_code import BROKEN, COMPILING, empty_cache
from engine.compiling.threads import on_all_threads, pieces_of


def prepare(driver: Callable, parameters: Sequence[types.Type]) -> None:
    """Compile a `driver` for the types of its parameters, or load it, once.

    Types are stated because a function is otherwise a type of its own: the driver would be compiled for every machine.

    Parameters
    ----------
    driver : callable
        Returns nothing.
    parameters : sequence of Type
    """
    with COMPILING:
        if tuple(parameters) in driver.overloads:
            return
        driver.disable_compile(False)
        try:
            driver.compile(types.void(*parameters))
        except BROKEN:
            empty_cache()
            driver.compile(types.void(*parameters))
        driver.disable_compile()


def spread(driver: Callable, count: int, arguments: Callable) -> None:
    """Run a `driver` over a range 0 … count − 1 in pieces on all threads; its first two parameters are the range.

    Parameters
    ----------
    driver : callable
    count : int
    arguments : callable
        Returns what follows the range, for one piece.
    """
    on_all_threads(lambda piece: driver(*piece, *arguments()), pieces_of(count))
