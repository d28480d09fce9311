"""What computed positions of a structural group miss of its lengths, guides and directions.

Found from the positions alone, not by the formulas that solve the groups. Every function gives shares of a length, so
that what is left is some roundings of the machine's extent over the length of the link.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.kinematics.vectors import Line, Link, Vector


@scalar
def greater(a: float, b: float) -> float:
    """The greater of two numbers; NaN if either is."""
    return a if a >= b or a != a else b


@scalar
def share_of(part: float, whole: float) -> float:
    """A magnitude as a share of another; 0 where there is nothing of it."""
    return part / whole if part != 0.0 else part


@scalar
def link_gap(a: Vector, b: Vector, link: Link) -> float:
    """What a link A → B misses of its length, and of B from A along its direction; the greater, as a share of r.

    Parameters
    ----------
    a, b : Vector
        Its joints [m].
    link : Link
    """
    r, c, s = link
    x, y = b[0] - a[0], b[1] - a[1]
    aside, ahead = y - r * s, x - r * c
    return greater(abs(math.sqrt(x * x + y * y) - r), math.sqrt(ahead * ahead + aside * aside)) / r


@scalar
def guide_gap(joint: Vector, line: Line, offset: float, slide: float, size: float) -> float:
    """What a slider misses of its line and of its place on it; the greater, as a share of a length.

    Parameters
    ----------
    joint : Vector
        The slider's joint [m].
    line : Line
        The guide or slot.
    offset, slide : float
        Where the joint is to be: to the left of the line, and along it [m].
    size : float
        The length [m]; of 0 nothing is missed if nothing is.
    """
    gx, gy, c, s = line
    lx, ly = joint[0] - gx, joint[1] - gy
    return share_of(greater(abs(ly * c - lx * s - offset), abs(lx * c + ly * s - slide)), size)


@scalar
def direction_gap(u: Vector, other: Vector, turn: Vector) -> float:
    """What a direction misses of its angle to another one, and of unit length; both about as angles.

    Parameters
    ----------
    u, other : Vector
        The direction, and the other one.
    turn : Vector
        Cosine and sine of the angle from the other one to it.
    """
    c, s = u
    along, across = other
    cosine, sine = turn
    ahead = c * along + s * across - cosine
    aside = s * along - c * across - sine
    return math.sqrt(ahead * ahead + aside * aside)


@scalar
def unit_gap(u: Vector) -> float:
    """What a direction misses of unit length."""
    c, s = u
    return abs(math.sqrt(c * c + s * s) - 1.0)
