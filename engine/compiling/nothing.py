"""The tile function for a machine with nothing to fill in: no switching functions, no held nodes."""

import numpy as np

from engine.compiling.tiles import TILE_SIGNATURE, filling


@filling(TILE_SIGNATURE)
def nothing(
    P: np.ndarray, T: np.ndarray, q: np.ndarray, cos_q: np.ndarray, sin_q: np.ndarray, tile: np.ndarray
) -> None:
    """Leave the tile unchanged."""
