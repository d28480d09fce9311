"""The dyad RPP, a block in the slot of a link that slides: the Scotch yoke.

Position, rates, and equilibrium of the sliding link along its guide, with `normal` the force of the slot on the block:

    along u + slide u_slot = A − G
    guide_rate u + slot_rate u_slot = gap
    u · (F_2 − normal n_slot) = 0

The conventions are those of `engine.laws.kinematics`.
"""

from engine.compiling.decorators import scalar
from engine.laws.kinematics.closure import direction_gap, greater, guide_gap
from engine.laws.kinematics.vectors import Line, Load, Vector, arm, oblique_components


@scalar
def rpp_position(a: Vector, guide: Line, turn: Vector) -> tuple[float, float, float, float, float, float]:
    """Position of the dyad RPP: a block pivoted at A in the slot of a link that slides along a guide.

    Parameters
    ----------
    a : Vector
        Outer joint A of the block [m].
    guide : Line
    turn : Vector
        Cosine and sine of the constant angle from the guide to the slot; its sine is the transmission angle's sine.

    Returns
    -------
    kx, ky : float
        Crossing of slot and guide [m].
    slot_c, slot_s : float
        Direction of the slot.
    along, slide : float
        Coordinates of the crossing along the guide from its point, and of A along the slot from the crossing [m].
    """
    gx, gy, c, s = guide
    slot_c, slot_s = arm(turn[0], turn[1], c, s)
    along, slide = rpp_rates((a[0] - gx, a[1] - gy), (c, s), (slot_c, slot_s))
    return gx + along * c, gy + along * s, slot_c, slot_s, along, slide


@scalar
def rpp_rates(gap: Vector, u: Vector, slot: Vector) -> tuple[float, float]:
    """Rates along the guide and along the slot from guide_rate u + slot_rate u_slot = gap.

    For velocities the gap is v_A − v, with v the velocity of the guide's carrier at A; for accelerations it is a_A − a,
    where a includes the Coriolis term of sliding along both guide and slot.
    """
    return oblique_components(gap, u, slot)


@scalar
def rpp_reactions(
    load1: Load, load2: Load, u: Vector, slot: Vector, slide: float
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RPP: the forces on the sliding link along its guide give the force in the slot.

    Parameters
    ----------
    load1, load2 : Load
        Loads on block and sliding link, moments about A and about the crossing of slot and guide.
    u, slot : Vector
        Directions of guide and slot.
    slide : float
        Coordinate of A along the slot from the crossing [m].

    Returns
    -------
    ax, ay : float
        Force in A on the block [N].
    normal, moment : float
        Reaction of the sliding link on the block, perpendicular to the slot [N, N·m], the moment about A.
    guide_normal, guide_moment : float
        Reaction of the guide on the sliding link [N, N·m], the moment about the crossing.
    """
    f1x, f1y, m1 = load1
    f2x, f2y, m2 = load2
    c, s = u
    slot_c, slot_s = slot
    sine = c * slot_s - s * slot_c
    normal = -(f2x * c + f2y * s) / sine
    nx, ny = -normal * slot_s, normal * slot_c
    guide_normal = -(f2x * slot_c + f2y * slot_s) / sine
    return -f1x - nx, -f1y - ny, normal, -m1, guide_normal, slide * normal - m1 - m2


@scalar
def rpp_closure(
    a: Vector, guide: Line, turn: Vector, crossing: Vector, slot: Vector, along: float, slide: float
) -> float:
    """Residuals of crossing and block in guide and slot, and of the slot's angle to the guide; the largest.

    Lengths are relative to the sum of the magnitudes of both coordinates.

    Parameters
    ----------
    a, guide, turn
        As in `rpp_position`.
    crossing, slot, along, slide
        Its results.
    """
    size, line = abs(along) + abs(slide), (crossing[0], crossing[1], slot[0], slot[1])
    lengths = greater(guide_gap(crossing, guide, 0.0, along, size), guide_gap(a, line, 0.0, slide, size))
    return greater(lengths, direction_gap(slot, (guide[2], guide[3]), turn))
