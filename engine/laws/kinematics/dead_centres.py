"""How far a structural group is from its dead centres.

The `sine` of a group is a root of what the links' reach leaves over. In a dead centre nothing is left; where what is
left is no more than rounding, whose sign is chance, the position is the dead centre itself.
"""

from engine.compiling.decorators import scalar
from engine.laws.rounding import EPS

# Half a unit in the last place of each of four coordinates and two lengths, and of the operations with them.
_ROUNDINGS = 8.0 * EPS


@scalar
def left_over(square: float, scale: float) -> float:
    """What the links' reach leaves over, 0 where it is within rounding of it.

    Parameters
    ----------
    square, scale : float
        Product of the reach's two factors, and the size of the terms it comes from [m², or its square].
    """
    doubt = _ROUNDINGS * scale
    return doubt - doubt if abs(square) < doubt else square
