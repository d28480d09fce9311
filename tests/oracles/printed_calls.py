"""Printed functions called from Python, and functions compiled by Numba in their place."""

import numpy as np
from numba import njit, types

from engine.compiling.printed_functions import PrintedFunction, _library, signature_of


@njit
def _call(function, given):
    function(*given)


def call_printed(code, *given):
    """Call a printed function, which only compiled code can call."""
    _call(PrintedFunction(code), given)


def filled(functions, code, numbers, q, rows):
    """What a printed function of a graph makes of a tile."""
    tile = np.empty((rows, *q.shape))
    call_printed(functions.codes[code], numbers, functions.memory, q, np.cos(q), np.sin(q), tile)
    return tile


def assembly_of(code):
    """Assembly of a printed function, which must not be in the cache."""
    return _library(code).get_asm_str()


class FillsTile(types.WrapperAddressProtocol):
    """A function written by hand that fills a tile, as a value."""

    def __init__(self, function):
        made = function.overloads[signature_of("tile").args]
        self._address = made.library.get_pointer_to_function(made.fndesc.llvm_cfunc_wrapper_name)

    def __wrapper_address__(self):
        return self._address

    def signature(self):
        return signature_of("tile")
