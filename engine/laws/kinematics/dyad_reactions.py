"""Reactions in the pairs of the five structural (Assur) dyads in closed form: kinetostatics of two links at a time.

A dyad is statically determinate: from everything that acts on its two links, inertia forces included (d'Alembert),
six equations of equilibrium give the six unknowns of its three pairs.

Conventions
-----------
The load on a link is a force (fx, fy) [N] and a moment m [N·m] about the link's origin: the outer joint of a link of
RRR, of the rod of RRP, of the block and of the rocker; the joint of a slider; the crossing of slot and guide for the
sliding link of RPP. It is all that acts on the link but the pairs of its own group.

Reactions of an outer pair act on the group's link, from what carries the pair; those of the inner pair act on the
first link, from the second. A revolute pair has a force. A prismatic pair has a normal force, positive along the left
normal n = k × u of its direction u, on a line through the link's origin, and a moment: together one force N on a
line at the distance moment/N. Pairs are without friction.

Masses and forces enter linearly. In a singular position (`sine` zero, `slide` zero) reactions are infinite or NaN,
as rates are.

Source: any course of the theory of mechanisms, chapter on the kinetostatics of Assur groups of class II,
e.g. I. I. Artobolevsky, Theory of Mechanisms and Machines.
"""

from engine.compiling.jit import scalar


@scalar
def moment_of(px: float, py: float, fx: float, fy: float) -> float:
    """Moment of a force about a point, p × F [N·m].

    Parameters
    ----------
    px, py : float
        Arm from the point to the force's line [m].
    fx, fy : float
        Force [N].
    """
    return px * fy - py * fx


@scalar
def rrr_reactions(
    f1x: float,
    f1y: float,
    m1: float,
    f2x: float,
    f2y: float,
    m2: float,
    r1: float,
    c1: float,
    s1: float,
    r2: float,
    c2: float,
    s2: float,
    sine: float,
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RRR: each link's moments about its outer joint give the force in the inner one.

    Parameters
    ----------
    f1x, f1y, m1, f2x, f2y, m2 : float
        Loads on the links, moments about A and D.
    r1, c1, s1, r2, c2, s2, sine : float
        As for `rrr_rates`.

    Returns
    -------
    ax, ay, bx, by, dx, dy : float
        Forces in A on the first link, in B on the first link, in D on the second [N].
    """
    # The divisor of the rates, written as there, so that the compiler divides once.
    area = r1 * r2 * sine
    bx, by = -(m2 * (r1 * c1) + m1 * (r2 * c2)) / area, -(m2 * (r1 * s1) + m1 * (r2 * s2)) / area
    return -f1x - bx, -f1y - by, bx, by, bx - f2x, by - f2y


@scalar
def rrp_reactions(
    f1x: float,
    f1y: float,
    m1: float,
    f2x: float,
    f2y: float,
    m2: float,
    r1: float,
    c1: float,
    s1: float,
    c: float,
    s: float,
    sine: float,
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RRP: the slider gives the joint's force along the guide, the rod's moments the rest.

    Parameters
    ----------
    f1x, f1y, m1, f2x, f2y, m2 : float
        Loads on rod and slider, moments about A and B.
    r1, c1, s1, c, s, sine : float
        As for `rrp_rates`.

    Returns
    -------
    ax, ay, bx, by : float
        Forces in A and B on the rod [N].
    normal, moment : float
        Of the guide on the slider [N, N·m], the moment about B.
    """
    extent = r1 * sine
    along = f2x * c + f2y * s
    across = -(m1 + along * r1 * (c1 * s - s1 * c)) / extent
    bx, by = along * c - across * s, along * s + across * c
    return -f1x - bx, -f1y - by, bx, by, across + f2x * s - f2y * c, -m2


@scalar
def rpr_reactions(
    f1x: float, f1y: float, m1: float, f2x: float, f2y: float, m2: float, c: float, s: float, slide: float
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RPR: block and rocker turn as one, so their moments about D give the force in the slot.

    Parameters
    ----------
    f1x, f1y, m1, f2x, f2y, m2 : float
        Loads on block and rocker, moments about A and D.
    c, s, slide : float
        Direction of the slot and coordinate of A along it from D [m].

    Returns
    -------
    ax, ay : float
        Force in A on the block [N].
    normal, moment : float
        Of the rocker on the block [N, N·m], the moment about A.
    dx, dy : float
        Force in D on the rocker [N].
    """
    normal = (m1 + m2) / slide
    nx, ny = -normal * s, normal * c
    return -f1x - nx, -f1y - ny, normal, -m1, nx - f2x, ny - f2y


@scalar
def prp_reactions(
    f1x: float,
    f1y: float,
    m1: float,
    f2x: float,
    f2y: float,
    m2: float,
    c1: float,
    s1: float,
    c2: float,
    s2: float,
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad PRP: each slider gives the joint's force along its own guide.

    Parameters
    ----------
    f1x, f1y, m1, f2x, f2y, m2 : float
        Loads on the sliders, moments about B.
    c1, s1, c2, s2 : float
        Directions of the guides.

    Returns
    -------
    normal1, moment1 : float
        Of the first guide on the first slider [N, N·m], the moment about B.
    bx, by : float
        Force in B on the first slider [N].
    normal2, moment2 : float
        Of the second guide on the second slider.
    """
    sine = c1 * s2 - s1 * c2
    along1, along2 = (f1x * c1 + f1y * s1) / sine, (f2x * c2 + f2y * s2) / sine
    bx, by = -along2 * s1 - along1 * s2, along2 * c1 + along1 * c2
    # Of both sliders together along either guide: the force in the joint, which may be large, is not in it.
    fx, fy = f1x + f2x, f1y + f2y
    normal1, normal2 = -(fx * c2 + fy * s2) / sine, (fx * c1 + fy * s1) / sine
    return normal1, -m1, bx, by, normal2, -m2


@scalar
def rpp_reactions(
    f1x: float,
    f1y: float,
    m1: float,
    f2x: float,
    f2y: float,
    m2: float,
    c: float,
    s: float,
    slot_c: float,
    slot_s: float,
    slide: float,
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RPP: the sliding link's forces along its guide give the force in the slot.

    Parameters
    ----------
    f1x, f1y, m1, f2x, f2y, m2 : float
        Loads on block and sliding link, moments about A and about the crossing of slot and guide.
    c, s, slot_c, slot_s : float
        Directions of guide and slot.
    slide : float
        Coordinate of A along the slot from the crossing [m].

    Returns
    -------
    ax, ay : float
        Force in A on the block [N].
    normal, moment : float
        Of the sliding link on the block, across the slot [N, N·m], the moment about A.
    guide_normal, guide_moment : float
        Of the guide on the sliding link [N, N·m], the moment about the crossing.
    """
    sine = c * slot_s - s * slot_c
    normal = -(f2x * c + f2y * s) / sine
    nx, ny = -normal * slot_s, normal * slot_c
    guide_normal = -(f2x * slot_c + f2y * slot_s) / sine
    return -f1x - nx, -f1y - ny, normal, -m1, guide_normal, slide * normal - m1 - m2
