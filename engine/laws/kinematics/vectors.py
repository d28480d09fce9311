"""Vectors in the plane, given by their components."""

import math

from engine.compiling.decorators import scalar


@scalar
def distance(ax: float, ay: float, bx: float, by: float) -> float:
    """Distance of two points [m]."""
    x, y = bx - ax, by - ay
    return math.sqrt(x * x + y * y)


@scalar
def oblique_components(gapx: float, gapy: float, c1: float, s1: float, c2: float, s2: float) -> tuple[float, float]:
    """Components p, q of a vector in two oblique directions: p u1 + q u2 = gap.

    Parallel directions give infinity, NaN, or what rounding makes of them, about 1e16; the sine of the angle between
    them tells.
    """
    sine = c1 * s2 - s1 * c2
    return (gapx * s2 - gapy * c2) / sine, (gapy * c1 - gapx * s1) / sine
