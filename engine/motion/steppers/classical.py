"""The classical method of Runge and Kutta of order four, as data: for steps of one length, without an estimated error.

Within a step the cubic follows the motion that has the values and the slopes of its ends.

Source: W. Kutta, Beitrag zur näherungsweisen Integration totaler Differentialgleichungen, Z. Math. Phys. 46 (1901).
"""

import numpy as np

from engine.laws.runge_kutta import DENSE_PARTS, Method

_WEIGHTS = np.array([1.0, 2.0, 2.0, 1.0]) / 6.0
_MATRIX = np.zeros((5, 5))
_MATRIX[1, 0] = _MATRIX[2, 1] = 0.5
_MATRIX[3, 2] = 1.0
# The slope at the end.
_MATRIX[4, :4] = _WEIGHTS


def _parts() -> np.ndarray:
    """Weights of the parts of the cubic: from values and slopes at both ends."""
    parts, whole = np.zeros((DENSE_PARTS, 5)), np.append(_WEIGHTS, 0.0)
    first, last = np.eye(5)[0], np.eye(5)[4]
    parts[:3] = whole, first - whole, 2.0 * whole - first - last
    return parts


ORDER_FOUR = Method(
    implicit=False,
    stages=4,
    dense_stages=5,
    matrix=_MATRIX,
    inverse=np.zeros((0, 0)),
    weights=_WEIGHTS,
    shares=np.array([0.0, 0.5, 0.5, 1.0]),
    place_of=np.array([0, 1, 2, 3, 3]),
    # It has no other to be compared with: what it misses is told by steps of twice the length.
    fine=np.zeros((1, 4)),
    coarse=np.zeros((1, 4)),
    parts=_parts(),
    looked_at=np.array([0, 1, 3]),
)
