"""The function of a machine that has nothing of a sort: no curve that switches anything, nothing that a panel holds."""

import numpy as np
from numba import njit

from engine.compiling.kept_code import keep_compiled
from engine.compiling.tiles import TILE_OPTIONS, TILE_SIGNATURE


def _fills_nothing(
    P: np.ndarray, T: np.ndarray, q: np.ndarray, cos_q: np.ndarray, sin_q: np.ndarray, tile: np.ndarray
) -> None:
    """Leave the tile as it is."""


nothing = njit(**{**TILE_OPTIONS, "cache": False})(_fills_nothing)
keep_compiled(nothing)
nothing.compile(TILE_SIGNATURE)
