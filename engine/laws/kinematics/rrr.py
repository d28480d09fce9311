"""The dyad RRR, two links and three revolute pairs: coupler and rocker of the four-bar linkage.

Position, rates, and equilibrium of moments about the outer joints, with F_B the force in the inner one on the first
link:

    |AB| = r1 and |DB| = r2
    w1 k × AB − w2 k × DB = gap
    m1 + AB × F_B = 0 and m2 − DB × F_B = 0

The conventions are those of `engine.laws.kinematics`.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.kinematics.closure import greater, link_gap
from engine.laws.kinematics.vectors import Link, Load, Vector
from engine.laws.rounding import left_over


@scalar
def rrr_position(
    a: Vector, d: Vector, r1: float, r2: float, mode: float
) -> tuple[float, float, float, float, float, float, float]:
    """Position of the dyad RRR: B at r1 from A and at r2 from D, to the left of A → D for mode +1.

    Parameters
    ----------
    a, d : Vector
        Outer joints A and D [m].
    r1, r2 : float
        Lengths AB and DB [m].
    mode : float
        Assembly mode.

    Returns
    -------
    bx, by : float
        Inner joint B [m].
    c1, s1, c2, s2 : float
        Directions of the links A → B and D → B.
    sine : float
        Sine of the angle between the links (of the transmission angle).

    Notes
    -----
    With u = d² − (r1 − r2)² the area of the triangle ABD is √(u (4 r1 r2 − u))/4. A rounding error of u affects both
    factors, and the parts of AD before and behind the foot of B, just as a different distance AD would. Links of very
    different length therefore keep their lengths, and no more digits are lost than the data justify.
    """
    ax, ay = a
    lx, ly = d[0] - ax, d[1] - ay
    d2 = lx * lx + ly * ly
    difference = r1 - r2
    u = d2 - difference * difference
    twice = r1 * r2 + r1 * r2
    root = mode * math.sqrt(left_over(u * (twice + twice - u), (twice + twice) * d2))
    before = (r1 * difference + r1 * difference + u) / (d2 + d2)
    behind = (u - (r2 * difference + r2 * difference)) / (d2 + d2)
    h = root / (d2 + d2)
    p1x, p1y = before * lx - h * ly, before * ly + h * lx
    p2x, p2y = -behind * lx - h * ly, h * lx - behind * ly
    return ax + p1x, ay + p1y, p1x / r1, p1y / r1, p2x / r2, p2y / r2, root / twice


@scalar
def rrr_rates(gap: Vector, first: Link, second: Link, sine: float) -> tuple[float, float]:
    """Angular rates w1, w2 of the dyad RRR from w1 k × AB − w2 k × DB = gap.

    For velocities the gap is v_D − v_A; for accelerations it is a_D − a_A + w1² AB − w2² DB.
    """
    gapx, gapy = gap
    r1, c1, s1 = first
    r2, c2, s2 = second
    # A common divisor, twice the area of the triangle ABD, so that the compiler divides once.
    area = r1 * r2 * sine
    return (gapx * c2 + gapy * s2) * r2 / area, (gapx * c1 + gapy * s1) * r1 / area


@scalar
def rrr_reactions(
    load1: Load, load2: Load, first: Link, second: Link, sine: float
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RRR: each link's moments about its outer joint give the force in the inner one.

    Parameters
    ----------
    load1, load2 : Load
        Loads on the links, moments about A and D.
    first, second, sine
        As in `rrr_rates`.

    Returns
    -------
    ax, ay, bx, by, dx, dy : float
        Forces in A on the first link, in B on the first link, in D on the second [N].
    """
    f1x, f1y, m1 = load1
    f2x, f2y, m2 = load2
    r1, c1, s1 = first
    r2, c2, s2 = second
    # The divisor of the rates, in the same form, so that the compiler divides once.
    area = r1 * r2 * sine
    bx, by = -(m2 * (r1 * c1) + m1 * (r2 * c2)) / area, -(m2 * (r1 * s1) + m1 * (r2 * s2)) / area
    return -f1x - bx, -f1y - by, bx, by, bx - f2x, by - f2y


@scalar
def rrr_closure(a: Vector, d: Vector, b: Vector, first: Link, second: Link) -> float:
    """Residuals of the two links in length and direction; the largest, relative to the link's length.

    Parameters
    ----------
    a, d : Vector
        As in `rrr_position`.
    b, first, second
        Its results.
    """
    return greater(link_gap(a, b, first), link_gap(d, b, second))
