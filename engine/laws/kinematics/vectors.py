"""Vectors in the plane, given by their components."""

import math

from engine.compiling.decorators import scalar

# Components, in the axes of the frame.
Vector = tuple[float, float]
# A guide or slot: a point on it [m], and its direction.
Line = tuple[float, float, float, float]
# A link's length [m] and direction.
Link = tuple[float, float, float]
# Load on a link: force [N] and moment about the link's origin [N·m].
Load = tuple[float, float, float]


@scalar
def distance(a: Vector, b: Vector) -> float:
    """Distance between two points [m]."""
    x, y = b[0] - a[0], b[1] - a[1]
    return math.sqrt(x * x + y * y)


@scalar
def arm(along: float, across: float, c: float, s: float) -> Vector:
    """Vector, in frame axes [m], from a link's origin to its point (along, across).

    Parameters
    ----------
    along, across : float
        Coordinates in the link's axes, x along the link and y to its left [m].
    c, s : float
        Cosine and sine of the link's angle.
    """
    return along * c - across * s, along * s + across * c


@scalar
def oblique_components(gap: Vector, u1: Vector, u2: Vector) -> tuple[float, float]:
    """Components p, q of a vector along two oblique directions: p u1 + q u2 = gap.

    Parallel directions give infinity, NaN, or, due to rounding, about 1e16; check the sine of the angle between them.
    """
    gapx, gapy = gap
    c1, s1 = u1
    c2, s2 = u2
    sine = c1 * s2 - s1 * c2
    return (gapx * s2 - gapy * c2) / sine, (gapy * c1 - gapx * s1) / sine
