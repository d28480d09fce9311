"""The five structural (Assur) dyads in closed form: two links, three lower pairs, no freedom of their own.

Each dyad has a `position` function, evaluated from the known points and guides it hangs on, and a linear part
that serves velocities and accelerations alike: differentiating the closure of the loop once or twice by the
generalised coordinate q leaves the same two equations with another right-hand side, the `gap`.

Conventions
-----------
A, D are known outer joints and B is the inner joint; u is the unit vector of a guide and n = k × u its left
normal; `mode` is the assembly mode, +1 or −1. Lengths in m, rates per unit of q. Where a group can't be
assembled its position is NaN; where it is singular (dead centre, change point) the position stays finite and
the rates are infinite or NaN.
`sine` is the quality of force transmission, 1 at best and 0 in a singular position; its sign is that of `mode`.
It comes from a root of what the links' reach leaves over: where that is no more than rounding, whose sign is chance,
the position is the singular one.

Source: any course of the theory of mechanisms, chapter on the kinematics of Assur groups of class II,
e.g. I. I. Artobolevsky, Theory of Mechanisms and Machines.
"""

import math

import numpy as np
from numba.extending import intrinsic

from engine.compiling.jit import scalar

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


@scalar
def rrr_position(
    ax: float, ay: float, dx: float, dy: float, r1: float, r2: float, mode: float
) -> tuple[float, float, float, float, float, float, float]:
    """Position of the dyad RRR: B at r1 from A and at r2 from D, on the left of A → D for mode +1.

    Parameters
    ----------
    ax, ay, dx, dy : float
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
    lx, ly = dx - ax, dy - ay
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
def rrr_rates(
    gapx: float,
    gapy: float,
    r1: float,
    c1: float,
    s1: float,
    r2: float,
    c2: float,
    s2: float,
    sine: float,
) -> tuple[float, float]:
    """Angular rates w1, w2 of the dyad RRR from w1 k × AB − w2 k × DB = gap.

    For velocities the gap is v_D − v_A; for accelerations it is a_D − a_A + w1² AB − w2² DB.
    """
    # One divisor for both, so that the compiler divides once: twice the area of the triangle ABD.
    area = r1 * r2 * sine
    return (gapx * c2 + gapy * s2) * r2 / area, (gapx * c1 + gapy * s1) * r1 / area


@scalar
def rrp_position(
    ax: float, ay: float, gx: float, gy: float, c: float, s: float, r1: float, offset: float, mode: float
) -> tuple[float, float, float, float, float, float]:
    """Position of the dyad RRP: B at r1 from A, on the line parallel to a guide at `offset` to its left.

    Parameters
    ----------
    ax, ay : float
        Outer joint A [m].
    gx, gy, c, s : float
        A point of the guide [m] and the guide's direction.
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
        Cosine of the angle between rod and guide.
    """
    lx, ly = ax - gx, ay - gy
    along = lx * c + ly * s
    across = ly * c - lx * s - offset
    root = mode * math.sqrt(left_over((r1 - across) * (r1 + across), r1 * (r1 + abs(offset))))
    p1x, p1y = root * c + across * s, root * s - across * c
    return ax + p1x, ay + p1y, p1x / r1, p1y / r1, along + root, root / r1


@scalar
def rrp_rates(
    gapx: float, gapy: float, r1: float, c1: float, s1: float, c: float, s: float, sine: float
) -> tuple[float, float]:
    """Rod's angular rate w1 and slider's rate along the guide from w1 k × AB − slide_rate u = gap.

    For velocities the gap is v − v_A, v the velocity of the guide's point that lies under B; for accelerations
    it is a − a_A + w1² AB, a with the Coriolis term of the sliding.
    """
    # One divisor for both, so that the compiler divides once: the rod's extent along the guide.
    extent = r1 * sine
    return (gapy * c - gapx * s) / extent, -(gapx * c1 + gapy * s1) * r1 / extent


@scalar
def rpr_position(
    ax: float, ay: float, dx: float, dy: float, offset: float, mode: float
) -> tuple[float, float, float, float]:
    """Position of the dyad RPR: a block pivoted at A slides on a slotted link (rocker) pivoted at D.

    Parameters
    ----------
    ax, ay, dx, dy : float
        Outer joints: A of the block, D of the rocker [m].
    offset : float
        Distance of A to the left of the slot's line through D [m].
    mode : float
        +1: the rocker's direction points from D to the block; −1: away from it.

    Returns
    -------
    c, s : float
        Direction of the slot, that of both links.
    slide : float
        Coordinate of A along the slot from D [m].
    sine : float
        Cosine of the angle between DA and the slot.
    """
    lx, ly = ax - dx, ay - dy
    d2 = lx * lx + ly * ly
    d = math.sqrt(d2)
    slide = mode * math.sqrt(left_over((d - offset) * (d + offset), d2))
    return (slide * lx + offset * ly) / d2, (slide * ly - offset * lx) / d2, slide, slide / d


@scalar
def rpr_rates(gapx: float, gapy: float, c: float, s: float, offset: float, slide: float) -> tuple[float, float]:
    """Angular rate w of both links and sliding rate from w k × DA + slide_rate u = gap.

    For velocities the gap is v_A − v_D; for accelerations it is a_A − a_D + w² DA − 2 w slide_rate n.
    """
    w = (gapy * c - gapx * s) / slide
    return w, gapx * c + gapy * s + w * offset


@scalar
def transmission_angle(sine: float) -> float:
    """Transmission angle of a group from its `sine`, at most a right angle [rad]; NaN where it can't be assembled.

    Parameters
    ----------
    sine : float
        Magnitude of the quality of transmission; rounding may put it just above 1.
    """
    if sine > 1.0:
        return math.asin(1.0)
    return math.asin(sine)


@scalar
def oblique_components(gapx: float, gapy: float, c1: float, s1: float, c2: float, s2: float) -> tuple[float, float]:
    """Components p, q of a vector in two oblique directions: p u1 + q u2 = gap.

    The whole of the dyads PRP and RPP, for positions, velocities and accelerations. PRP, a joint B on the two
    lines Q1 + p u1 and Q2 − q u2: the gap is Q2 − Q1. RPP, a block pivoted at A on the slot u2 of a link that
    slides along the guide u1: the gap is A − G. Parallel directions give infinity, NaN, or what rounding makes of
    them, about 1e16; their `sine` tells.
    """
    sine = c1 * s2 - s1 * c2
    return (gapx * s2 - gapy * c2) / sine, (gapy * c1 - gapx * s1) / sine
