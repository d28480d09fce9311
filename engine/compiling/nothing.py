"""The function of a machine that has nothing of a sort: no curve that switches anything, nothing that a panel holds."""

import numpy as np

from engine.compiling.tiles import TILE_SIGNATURE, filling


@filling(TILE_SIGNATURE)
def nothing(
    P: np.ndarray, T: np.ndarray, q: np.ndarray, cos_q: np.ndarray, sin_q: np.ndarray, tile: np.ndarray
) -> None:
    """Leave the tile as it is."""
