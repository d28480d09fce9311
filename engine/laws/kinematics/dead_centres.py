"""Distance of a structural group from its dead centres.

The `sine` of a group is the square root of the links' surplus reach. At a dead centre the surplus is zero; within
rounding, where its sign is random, the position counts as the dead centre itself.
"""

from engine.compiling.decorators import scalar
from engine.laws.rounding import EPS

# Half a unit in the last place of each of four coordinates and two lengths, and of the operations with them.
_ROUNDINGS = 8.0 * EPS


@scalar
def left_over(square: float, scale: float) -> float:
    """Surplus of the links' reach, 0 where it is within rounding of zero.

    Parameters
    ----------
    square, scale : float
        Product of the reach's two factors, and the magnitude of its terms [m², or its square].
    """
    rounding = _ROUNDINGS * scale
    return rounding - rounding if abs(square) < rounding else square
