"""The dyad RPP, a block in the slot of a link that slides: the Scotch yoke.

Position, rates, and equilibrium of the sliding link along its guide, `normal` the force of the slot on the block:

    along u + slide u_slot = A − G
    guide_rate u + slot_rate u_slot = gap
    u · (F_2 − normal n_slot) = 0

`engine.laws.kinematics` has the conventions of all groups.
"""

from engine.compiling.decorators import scalar
from engine.laws.kinematics.closure import direction_gap, greater, guide_gap
from engine.laws.kinematics.links import arm
from engine.laws.kinematics.vectors import Line, Load, Vector, oblique_components


@scalar
def rpp_position(a: Vector, guide: Line, turn: Vector) -> tuple[float, float, float, float, float, float]:
    """Position of the dyad RPP: a block pivoted at A in the slot of a link that slides along a guide.

    Parameters
    ----------
    a : Vector
        Outer joint A of the block [m].
    guide : Line
    turn : Vector
        Cosine and sine of the angle from the guide to the slot, which never changes; its sine is the quality of
        transmission.

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

    For velocities the gap is v_A − v, v the velocity of the guide's carrier at A; for accelerations it is a_A − a, a
    with the Coriolis term of the sliding, of guide and slot together.
    """
    return oblique_components(gap, u, slot)


@scalar
def rpp_reactions(
    load1: Load, load2: Load, u: Vector, slot: Vector, slide: float
) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad RPP: the sliding link's forces along its guide give the force in the slot.

    Parameters
    ----------
    load1, load2 : Load
        On block and sliding link, moments about A and about the crossing of slot and guide.
    u, slot : Vector
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
    """What crossing and block miss of guide and slot, and the slot of its angle to the guide; the greatest.

    Lengths as shares of the magnitudes of the two coordinates.

    Parameters
    ----------
    a, guide, turn
        As for `rpp_position`.
    crossing, slot, along, slide
        As it found them.
    """
    size, line = abs(along) + abs(slide), (crossing[0], crossing[1], slot[0], slot[1])
    lengths = greater(guide_gap(crossing, guide, 0.0, along, size), guide_gap(a, line, 0.0, slide, size))
    return greater(lengths, direction_gap(slot, (guide[2], guide[3]), turn))
