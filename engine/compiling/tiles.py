"""What compiled functions that fill tiles have in common: their width, their signature, their options."""

from numba import types

from engine.compiling.jit import FLOATING_POINT_RULES

# Variants side by side. With 64 the loops over lanes are vectorised whole.
LANES = 64
# Positions of a panel, and of each part of a scan.
PANEL_POSITIONS = 17

_ROWS = types.float64[:, ::1]
# (P, T, q, cos_q, sin_q, tile): numbers × lanes, all tables, three times positions × lanes, curves × positions × lanes.
TILE_SIGNATURE = types.void(_ROWS, types.float64[::1], _ROWS, _ROWS, _ROWS, types.float64[:, :, ::1])

# Sums run within a lane, so their order is nobody's to change.
TILE_OPTIONS = {
    "error_model": "numpy",
    "fastmath": set(FLOATING_POINT_RULES - {"reassoc"}),
    "nogil": True,
    "cache": True,
}
