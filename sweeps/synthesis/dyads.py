"""Dyads through three and four positions of a plane: centre points, circle points, Burmester's curves.

A point of the plane is a circle point if its positions lie on a circle, whose centre is the centre point; a link
between them guides the plane through its positions. For three positions, any centre point has a circle point and vice
versa. For four, they form curves; here a dyad is selected by the rotation of its link from the first position to the
second.

References
----------
A. G. Erdman, G. N. Sandor, S. Kota: Mechanism Design, Analysis and Synthesis, vol. 1, ch. 8 (standard form of the dyad
and compatibility linkage).
"""

import cmath
import math
from collections.abc import Sequence
from typing import NamedTuple

from sweeps.synthesis.synthesis_error import SynthesisError

# Points with a circumcentre beyond this multiple of their extent count as collinear.
_FARTHEST = 1e9
# Relative tolerance of equal lengths.
_AGREED = 1e-9


class PlanePosition(NamedTuple):
    """A position of a moving plane: its point P, x + iy [m], and its angle [rad]."""

    point: complex
    angle: float


class PlaneDyad(NamedTuple):
    """A link that guides a plane: frame joint, and joint on the plane from P in its axes, x + iy [m]."""

    centre: complex
    circle: complex

    def joint(self, position: PlanePosition) -> complex:
        """Position of the joint on the plane, x + iy [m]."""
        return position.point + self.circle * cmath.exp(1j * position.angle)


def dyad_of_centre(positions: Sequence[PlanePosition], centre: complex) -> PlaneDyad:
    """Dyad through three positions with a given frame joint.

    Seen from the plane, the frame joint has three positions equidistant from the circle point, which is the centre of
    their circle.

    Parameters
    ----------
    positions : sequence of PlanePosition
        Three.
    centre : complex
        x + iy [m].

    Raises
    ------
    SynthesisError
        Not three positions, or the circle point is at infinity.
    """
    _three(positions)
    seen = [(centre - place.point) * cmath.exp(-1j * place.angle) for place in positions]
    return PlaneDyad(centre, _circumcentre(seen, f"the centre point {_spelt(centre)}"))


def dyad_of_circle(positions: Sequence[PlanePosition], circle: complex) -> PlaneDyad:
    """Dyad through three positions with a given joint on the plane.

    Parameters
    ----------
    positions : sequence of PlanePosition
        Three.
    circle : complex
        x + iy from P in the plane's axes [m].

    Raises
    ------
    SynthesisError
        Not three positions, or the point's positions are collinear.
    """
    _three(positions)
    places = [PlaneDyad(0j, circle).joint(place) for place in positions]
    return PlaneDyad(_circumcentre(places, f"the circle point {_spelt(circle)}"), circle)


def dyads_of_turn(positions: Sequence[PlanePosition], turn: float) -> list[PlaneDyad]:
    """Dyads through four positions with a given rotation of the link from the first to the second.

    With displacements δ_j of P, turns α_j of the plane and β_j of the link, from the first position,

        W (exp(iβ_j) − 1) + Z (exp(iα_j) − 1) = δ_j,  j = 2, 3, 4,

    has a solution where its augmented determinant vanishes, Δ₁ + Δ₂ exp(iβ₂) + Δ₃ exp(iβ₃) + Δ₄ exp(iβ₄) = 0, Δ_j its
    cofactors: a four-bar whose link Δ₂ is turned by β₂ and whose others close in two ways.

    Parameters
    ----------
    positions : sequence of PlanePosition
        Four.
    turn : float
        β₂ [rad].

    Returns
    -------
    list of PlaneDyad
        Two; fewer if the compatibility linkage doesn't close at this angle, or two positions coincide.

    Raises
    ------
    SynthesisError
        Not four positions.
    """
    if len(positions) != 4:
        raise SynthesisError(f"four positions are needed for a Burmester curve, not {len(positions)}")
    first = positions[0]
    shifts = [place.point - first.point for place in positions[1:]]
    turns = [cmath.exp(1j * (place.angle - first.angle)) - 1.0 for place in positions[1:]]
    d2 = turns[1] * shifts[2] - turns[2] * shifts[1]
    d3 = turns[2] * shifts[0] - turns[0] * shifts[2]
    d4 = turns[0] * shifts[1] - turns[1] * shifts[0]
    rest = d2 + d3 + d4 - d2 * cmath.exp(1j * turn)
    found = []
    for side in (1.0, -1.0):
        third = _turned_to_close(rest, d3, d4, side)
        if third is None:
            continue
        w, z = _pair((cmath.exp(1j * turn) - 1.0, turns[0], shifts[0]), (third - 1.0, turns[1], shifts[1]))
        if w is None:
            continue
        dyad = PlaneDyad(first.point - z - w, -z * cmath.exp(-1j * first.angle))
        lengths = [abs(dyad.joint(place) - dyad.centre) for place in positions]
        # For nearly coincident positions rounding dominates.
        if max(lengths) - min(lengths) <= _AGREED * (abs(dyad.centre) + abs(dyad.circle) + max(lengths)):
            found.append(dyad)
    return found


def _turned_to_close(rest: complex, d3: complex, d4: complex, side: float) -> complex | None:
    """exp(iβ₃) with Δ₃ exp(iβ₃) + Δ₄ exp(iβ₄) = rest, for one of the two triangles."""
    a, b, c = abs(d3), abs(d4), abs(rest)
    if not a * c > 0.0:
        return None
    cosine = (a * a + c * c - b * b) / (2.0 * a * c)
    if abs(cosine) > 1.0:
        return None
    return rest / c * cmath.exp(1j * side * math.acos(cosine)) * a / d3


def _pair(
    one: tuple[complex, complex, complex], other: tuple[complex, complex, complex]
) -> tuple[complex, complex] | tuple[None, None]:
    """Solution w, z of two equations p w + q z = r; None if singular."""
    (p, q, r), (s, t, u) = one, other
    determinant = p * t - q * s
    if abs(determinant) <= 1e-12 * max(abs(p * t), abs(q * s)):
        return None, None
    return (r * t - q * u) / determinant, (p * u - r * s) / determinant


def _three(positions: Sequence[PlanePosition]) -> None:
    if len(positions) != 3:
        raise SynthesisError(f"a chosen joint needs three positions, not {len(positions)}")


def _circumcentre(points: Sequence[complex], of: str) -> complex:
    """Centre of the circle through three points."""
    b, c = points[1] - points[0], points[2] - points[0]
    size, area = max(abs(b), abs(c)), b.real * c.imag - b.imag * c.real
    centre = points[0]
    if area != 0.0:
        centre += 0.5j * (b * abs(c) ** 2 - c * abs(b) ** 2) / area
    if area == 0.0 or not abs(centre - points[0]) < _FARTHEST * size:
        raise SynthesisError(f"{of} has no partner: its three positions are collinear; choose another joint")
    return centre


def _spelt(point: complex) -> str:
    return f"({point.real:g} m, {point.imag:g} m)"
