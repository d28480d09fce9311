"""What compiled functions that fill tiles have in common: their width, their signature, their options."""

from collections.abc import Callable

from numba import types
from numba.core.typing import Signature

from engine.compiling.jit import FLOATING_POINT_RULES

# Variants side by side. With 64 the loops over lanes are vectorised whole.
LANES = 64
# Positions of a panel, and of each part of a scan.
PANEL_POSITIONS = 17

_ROWS = types.float64[:, ::1]
# (P, T, q, cos_q, sin_q, tile): numbers × lanes, all tables, three times positions × lanes, curves × positions × lanes.
TILE_SIGNATURE = types.void(_ROWS, types.float64[::1], _ROWS, _ROWS, _ROWS, types.float64[:, :, ::1])


class TileFunction(types.WrapperAddressProtocol):
    """A compiled function of this signature as a value: handed over as it is, it would be looked up at every call.

    Parameters
    ----------
    function : callable
    """

    def __init__(self, function: Callable) -> None:
        self._function = function
        compiled = function.overloads[TILE_SIGNATURE.args]
        self._address = compiled.library.get_pointer_to_function(compiled.fndesc.llvm_cfunc_wrapper_name)

    def __wrapper_address__(self) -> int:
        """Where its machine code begins."""
        return self._address

    def signature(self) -> Signature:
        """The signature."""
        return TILE_SIGNATURE


# Sums run within a lane, so their order is nobody's to change.
TILE_OPTIONS = {
    "error_model": "numpy",
    "fastmath": set(FLOATING_POINT_RULES - {"reassoc"}),
    "nogil": True,
    "cache": True,
}
