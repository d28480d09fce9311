"""The dyad RPR, a block on a slotted link: block and rocker of the quick-return mechanism, an oscillating cylinder.

Position, rates, and equilibrium of moments about the rocker's pivot D; block and rocker turn together:

    n · DA = offset
    w k × DA + slide_rate u = gap
    m1 + m2 = slide · normal

The conventions are those of `engine.laws.kinematics`.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.kinematics.closure import greater, guide_gap, unit_gap
from engine.laws.kinematics.vectors import Load, Vector, distance
from engine.laws.rounding import left_over


@scalar
def rpr_position(a: Vector, d: Vector, offset: float, mode: float) -> tuple[float, float, float, float]:
    """Position of the dyad RPR: a block pivoted at A slides on a slotted link (rocker) pivoted at D.

    Parameters
    ----------
    a, d : Vector
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
    lx, ly = a[0] - d[0], a[1] - d[1]
    d2 = lx * lx + ly * ly
    d = math.sqrt(d2)
    slide = mode * math.sqrt(left_over((d - offset) * (d + offset), d2))
    return (slide * lx + offset * ly) / d2, (slide * ly - offset * lx) / d2, slide, slide / d


@scalar
def rpr_rates(gap: Vector, u: Vector, offset: float, slide: float) -> tuple[float, float]:
    """Angular rate w of both links and sliding rate from w k × DA + slide_rate u = gap.

    For velocities the gap is v_A − v_D; for accelerations it is a_A − a_D + w² DA − 2 w slide_rate n.
    """
    gapx, gapy = gap
    c, s = u
    w = (gapy * c - gapx * s) / slide
    return w, gapx * c + gapy * s + w * offset


@scalar
def rpr_reactions(load1: Load, load2: Load, u: Vector, slide: float) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RPR: block and rocker turn together, so their moments about D give the force in the slot.

    Parameters
    ----------
    load1, load2 : Load
        Loads on block and rocker, moments about A and D.
    u : Vector
        Direction of the slot.
    slide : float
        Coordinate of A along it from D [m].

    Returns
    -------
    ax, ay : float
        Force in A on the block [N].
    normal, moment : float
        Reaction of the rocker on the block [N, N·m], the moment about A.
    dx, dy : float
        Force in D on the rocker [N].
    """
    f1x, f1y, m1 = load1
    f2x, f2y, m2 = load2
    c, s = u
    normal = (m1 + m2) / slide
    nx, ny = -normal * s, normal * c
    return -f1x - nx, -f1y - ny, normal, -m1, nx - f2x, ny - f2y


@scalar
def rpr_closure(a: Vector, d: Vector, offset: float, u: Vector, slide: float) -> float:
    """Residual of the block in its slot, relative to DA, and of the slot's direction in its unit length; the larger.

    Parameters
    ----------
    a, d, offset
        As in `rpr_position`.
    u, slide
        Its results.
    """
    return greater(guide_gap(a, (d[0], d[1], u[0], u[1]), offset, slide, distance(a, d)), unit_gap(u))
