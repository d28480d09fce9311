"""The dyad RRR, two links and three revolute pairs: coupler and rocker of the four-bar linkage.

Position, rates, and equilibrium of moments about the outer joints, F_B the force in the inner one on the first link:

    |AB| = r1 and |DB| = r2
    w1 k × AB − w2 k × DB = gap
    m1 + AB × F_B = 0 and m2 − DB × F_B = 0

`engine.laws.kinematics` has the conventions of all groups.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.kinematics.closure import greater, link_gap
from engine.laws.kinematics.dead_centres import left_over
from engine.laws.kinematics.vectors import Link, Load, Vector


@scalar
def rrr_position(
    a: Vector, d: Vector, r1: float, r2: float, mode: float
) -> tuple[float, float, float, float, float, float, float]:
    """Position of the dyad RRR: B at r1 from A and at r2 from D, on the left of A → D for mode +1.

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
    With u = d² − (r1 − r2)² the area of the triangle ABD is √(u (4 r1 r2 − u))/4. Whatever rounding does to u it does
    to both factors, and to the shares of AD before and behind the foot of B, as another distance of A and D would:
    links of very different length stay of their length, and lose no more digits than the data deserve.
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
    # One divisor for both, so that the compiler divides once: twice the area of the triangle ABD.
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
        On the links, moments about A and D.
    first, second, sine
        As for `rrr_rates`.

    Returns
    -------
    ax, ay, bx, by, dx, dy : float
        Forces in A on the first link, in B on the first link, in D on the second [N].
    """
    f1x, f1y, m1 = load1
    f2x, f2y, m2 = load2
    r1, c1, s1 = first
    r2, c2, s2 = second
    # The divisor of the rates, written as there, so that the compiler divides once.
    area = r1 * r2 * sine
    bx, by = -(m2 * (r1 * c1) + m1 * (r2 * c2)) / area, -(m2 * (r1 * s1) + m1 * (r2 * s2)) / area
    return -f1x - bx, -f1y - by, bx, by, bx - f2x, by - f2y


@scalar
def rrr_closure(a: Vector, d: Vector, b: Vector, first: Link, second: Link) -> float:
    """What the two links miss of their lengths and directions; the greater, as a share of the link's length.

    Parameters
    ----------
    a, d : Vector
        As for `rrr_position`.
    b, first, second
        As it found them.
    """
    return greater(link_gap(a, b, first), link_gap(d, b, second))
