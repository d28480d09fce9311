"""The dyad PRP, two sliders with a common joint: the trammel.

Position, rates, and equilibrium of the sliders along their guides, with F_B the force in the joint on the first slider:

    n1 · (B − G1) = offset1 and n2 · (B − G2) = offset2
    slide_rate1 u1 − slide_rate2 u2 = gap
    u1 · (F_1 + F_B) = 0 and u2 · (F_2 − F_B) = 0

The conventions are those of `engine.laws.kinematics`.
"""

from engine.compiling.decorators import scalar
from engine.laws.kinematics.closure import greater, guide_gap
from engine.laws.kinematics.vectors import Line, Load, Vector, oblique_components


@scalar
def prp_position(guide1: Line, offset1: float, guide2: Line, offset2: float) -> tuple[float, float, float, float]:
    """Position of the dyad PRP: B at the crossing of two lines, parallel to two guides at offsets to their left.

    Parameters
    ----------
    guide1, guide2 : Line
    offset1, offset2 : float
        Offsets of B from the guides [m].

    Returns
    -------
    bx, by : float
        Inner joint B [m].
    slide1, slide2 : float
        Coordinates of B along the guides from their points [m].
    """
    g1x, g1y, c1, s1 = guide1
    g2x, g2y, c2, s2 = guide2
    q1x, q1y = g1x - offset1 * s1, g1y + offset1 * c1
    q2x, q2y = g2x - offset2 * s2, g2y + offset2 * c2
    slide1, slide2 = prp_rates((q2x - q1x, q2y - q1y), (c1, s1), (c2, s2))
    return q1x + slide1 * c1, q1y + slide1 * s1, slide1, slide2


@scalar
def prp_rates(gap: Vector, u1: Vector, u2: Vector) -> tuple[float, float]:
    """Rates of the sliders along their guides from slide_rate1 u1 − slide_rate2 u2 = gap.

    For velocities the gap is v_2 − v_1, of the guides' points under B; for accelerations it is a_2 − a_1, with the
    Coriolis terms of sliding.
    """
    along1, along2 = oblique_components(gap, u1, u2)
    return along1, -along2


@scalar
def prp_reactions(load1: Load, load2: Load, u1: Vector, u2: Vector) -> tuple[float, float, float, float, float, float]:
    """Reactions of the dyad PRP: each slider gives the joint's force along its own guide.

    Parameters
    ----------
    load1, load2 : Load
        Loads on the sliders, moments about B.
    u1, u2 : Vector
        Directions of the guides.

    Returns
    -------
    normal1, moment1 : float
        Reaction of the first guide on the first slider [N, N·m], the moment about B.
    bx, by : float
        Force in B on the first slider [N].
    normal2, moment2 : float
        Reaction of the second guide on the second slider.
    """
    f1x, f1y, m1 = load1
    f2x, f2y, m2 = load2
    c1, s1 = u1
    c2, s2 = u2
    sine = c1 * s2 - s1 * c2
    along1, along2 = (f1x * c1 + f1y * s1) / sine, (f2x * c2 + f2y * s2) / sine
    bx, by = -along2 * s1 - along1 * s2, along2 * c1 + along1 * c2
    # Equilibrium of both sliders together avoids the force in the joint, which may be large.
    fx, fy = f1x + f2x, f1y + f2y
    normal1, normal2 = -(fx * c2 + fy * s2) / sine, (fx * c1 + fy * s1) / sine
    return normal1, -m1, bx, by, normal2, -m2


@scalar
def prp_closure(
    guide1: Line, offset1: float, guide2: Line, offset2: float, b: Vector, slide1: float, slide2: float
) -> float:
    """Residuals of the sliders in their guides; the larger, relative to the sum of |coordinates| and |offsets|.

    Parameters
    ----------
    guide1, offset1, guide2, offset2
        As in `prp_position`.
    b, slide1, slide2
        Its results.
    """
    size = abs(slide1) + abs(slide2) + abs(offset1) + abs(offset2)
    return greater(guide_gap(b, guide1, offset1, slide1, size), guide_gap(b, guide2, offset2, slide2, size))
