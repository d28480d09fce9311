"""Loop-closure residuals of structural groups: errors of computed positions in lengths, guides and directions.

They follow from the positions only, not from the formulas that solve the groups. Every residual is relative to a
length, so it is a few roundings of the machine's extent divided by the length of the link.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.kinematics.vectors import Line, Link, Vector


@scalar
def greater(a: float, b: float) -> float:
    """The larger of two numbers; NaN if either is NaN."""
    return a if a >= b or a != a else b


@scalar
def share_of(part: float, whole: float) -> float:
    """Part relative to a whole; 0 if the part is 0."""
    return part / whole if part != 0.0 else part


@scalar
def link_gap(a: Vector, b: Vector, link: Link) -> float:
    """Residual of a link A → B in its length, and of B along its direction from A; the larger, relative to r.

    Parameters
    ----------
    a, b : Vector
        Its joints [m].
    link : Link
    """
    r, c, s = link
    x, y = b[0] - a[0], b[1] - a[1]
    y_error, x_error = y - r * s, x - r * c
    return greater(abs(math.sqrt(x * x + y * y) - r), math.sqrt(x_error * x_error + y_error * y_error)) / r


@scalar
def guide_gap(joint: Vector, line: Line, offset: float, slide: float, size: float) -> float:
    """Residual of a slider across its line and along it; the larger, relative to a length.

    Parameters
    ----------
    joint : Vector
        The slider's joint [m].
    line : Line
        The guide or slot.
    offset, slide : float
        Nominal position of the joint: to the left of the line, and along it [m].
    size : float
        The length [m]; a zero residual stays 0 for length 0.
    """
    gx, gy, c, s = line
    lx, ly = joint[0] - gx, joint[1] - gy
    return share_of(greater(abs(ly * c - lx * s - offset), abs(lx * c + ly * s - slide)), size)


@scalar
def direction_gap(u: Vector, other: Vector, turn: Vector) -> float:
    """Residual of a direction in its angle to another one and in its unit length, both about in radians.

    Parameters
    ----------
    u, other : Vector
        The direction, and the other one.
    turn : Vector
        Cosine and sine of the angle from `other` to `u`.
    """
    c, s = u
    along, across = other
    cosine, sine = turn
    cosine_error = c * along + s * across - cosine
    sine_error = s * along - c * across - sine
    return math.sqrt(cosine_error * cosine_error + sine_error * sine_error)


@scalar
def unit_gap(u: Vector) -> float:
    """Residual of a direction in its unit length."""
    c, s = u
    return abs(math.sqrt(c * c + s * s) - 1.0)
