"""The dyad RRP, a rod and a slider: connecting rod and piston of the slider-crank mechanism.

Position, rates, and equilibrium of the slider along its guide and of the rod about A, with F_B the force in the inner
joint on the rod:

    |AB| = r1 and n · (B − G) = offset
    w1 k × AB − slide_rate u = gap
    u · (F_2 − F_B) = 0 and m1 + AB × F_B = 0

The conventions are those of `engine.laws.kinematics`.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.kinematics.closure import greater, guide_gap, link_gap
from engine.laws.kinematics.vectors import Line, Link, Load, Vector
from engine.laws.rounding import left_over


@scalar
def rrp_position(
    a: Vector, guide: Line, r1: float, offset: float, mode: float
) -> tuple[float, float, float, float, float, float]:
    """Position of the dyad RRP: B at r1 from A, on the line parallel to a guide at `offset` to its left.

    Parameters
    ----------
    a : Vector
        Outer joint A [m].
    guide : Line
    r1, offset : float
        Length AB and offset of B from the guide [m].
    mode : float
        +1: the intersection farther along the guide's direction; −1: the other.

    Returns
    -------
    bx, by : float
        Inner joint B [m].
    c1, s1 : float
        Direction of the rod A → B.
    slide : float
        Coordinate of B along the guide from its point [m].
    sine : float
        Sine of the transmission angle, which lies between the rod and the normal of the guide.
    """
    ax, ay = a
    gx, gy, c, s = guide
    lx, ly = ax - gx, ay - gy
    along = lx * c + ly * s
    across = ly * c - lx * s - offset
    root = mode * math.sqrt(left_over((r1 - across) * (r1 + across), r1 * (r1 + abs(offset))))
    p1x, p1y = root * c + across * s, root * s - across * c
    return ax + p1x, ay + p1y, p1x / r1, p1y / r1, along + root, root / r1


@scalar
def rrp_rates(gap: Vector, rod: Link, u: Vector, sine: float) -> tuple[float, float]:
    """Rod's angular rate w1 and slider's rate along the guide from w1 k × AB − slide_rate u = gap.

    For velocities the gap is v − v_A, with v the velocity of the guide's point under B; for accelerations it is
    a − a_A + w1² AB, where a includes the Coriolis term of sliding.
    """
    gapx, gapy = gap
    r1, c1, s1 = rod
    c, s = u
    # A common divisor, the rod's extent along the guide, so that the compiler divides once.
    extent = r1 * sine
    return (gapy * c - gapx * s) / extent, -(gapx * c1 + gapy * s1) * r1 / extent


@scalar
def rrp_reactions(
    load1: Load, load2: Load, rod: Link, u: Vector, sine: float
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RRP: the slider gives the joint's force along the guide, the rod's moments the rest.

    Parameters
    ----------
    load1, load2 : Load
        Loads on rod and slider, moments about A and B.
    rod, u, sine
        As in `rrp_rates`.

    Returns
    -------
    ax, ay, bx, by : float
        Forces in A and B on the rod [N].
    normal, moment : float
        Reaction of the guide on the slider [N, N·m], the moment about B.
    """
    f1x, f1y, m1 = load1
    f2x, f2y, m2 = load2
    r1, c1, s1 = rod
    c, s = u
    extent = r1 * sine
    along = f2x * c + f2y * s
    across = -(m1 + along * r1 * (c1 * s - s1 * c)) / extent
    bx, by = along * c - across * s, along * s + across * c
    return -f1x - bx, -f1y - by, bx, by, across + f2x * s - f2y * c, -m2


@scalar
def rrp_closure(a: Vector, guide: Line, offset: float, b: Vector, rod: Link, slide: float) -> float:
    """Residuals of the rod in length and direction, and of the slider in its guide; the largest, relative to r1.

    Parameters
    ----------
    a, guide, offset
        As in `rrp_position`.
    b, rod, slide
        Its results.
    """
    return greater(link_gap(a, b, rod), guide_gap(b, guide, offset, slide, rod[0]))
