"""Printed functions called from Python."""

from numba import njit

from engine.compiling.tiles import TILE_SIGNATURE, TypedFunction


@njit
def _call(function, given):
    function(*given)


def call_printed(function, *given, of=TILE_SIGNATURE):
    """Call a function of a printed module, which only compiled code can call."""
    _call(TypedFunction(function, of), given)
