"""How far a structural group is from its dead centres.

The `sine` of a group is a root of what the links' reach leaves over. In a dead centre nothing is left; where what is
left is no more than rounding, whose sign is chance, the position is the dead centre itself.
"""

import numpy as np
from numba.extending import intrinsic

from engine.compiling.decorators import scalar

# Half a unit in the last place of each of four coordinates and two lengths, and of the operations with them.
ROUNDINGS = 8.0


@intrinsic
def _roundings(typing: object, number: object) -> tuple:
    """ROUNDINGS units in the last place of 1, in a number's own precision."""

    def generate(context: object, builder: object, signature: object, arguments: list) -> object:
        return context.get_constant(number, ROUNDINGS * float(np.finfo(str(number)).eps))

    return number(number), generate


@scalar
def left_over(square: float, scale: float) -> float:
    """What the links' reach leaves over, 0 where it is within rounding of it.

    Parameters
    ----------
    square, scale : float
        Product of the reach's two factors, and the size of the terms it comes from [m², or its square].
    """
    doubt = _roundings(scale) * scale
    return doubt - doubt if abs(square) < doubt else square
