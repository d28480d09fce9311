"""Unbalance of a rigid rotor: the resultant of its masses off the axis, and its kind.

A mass m at radius e and angle alpha of the rotor is the unbalance U = m e exp(i alpha) [kg·m]: a complex number with
the real part along the rotor's x axis and the imaginary part along its y axis, across the axis z. At the speed omega it
exerts the radial force omega² U. Any number of them, at positions z_k along the axis, is equivalent to

- the resultant unbalance U = Σ U_k, the force, and
- the moment unbalance P = Σ (z_k - z_0) U_k about a plane z_0 [kg·m²], drawn in the direction of the unbalances, as
  usual in balancing; the axis of the couple is a quarter turn ahead.

Arrays have the unbalances along their last axis; all other axes are free and are broadcast.

Sources: ISO 21940-2 (kinds of unbalance); K. V. Frolov et al., Theory of Mechanisms and Machines (balancing of
rotors).
"""

from collections.abc import Sequence
from enum import IntEnum
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from engine.elements.panels import Mark, Panel, path, plan


class Resultant(NamedTuple):
    """Resultant of a rotor's unbalances.

    Attributes
    ----------
    unbalance : ndarray of complex (...)
        U [kg·m].
    moment : ndarray of complex (...)
        P about the plane [kg·m²].
    plane : ndarray (...)
        z_0 [m].
    """

    unbalance: np.ndarray
    moment: np.ndarray
    plane: np.ndarray


class Kind(IntEnum):
    """Kinds of unbalance, by the position of the central principal axis of inertia relative to the axis of rotation.

    BALANCED: coincident; STATIC: parallel; COUPLE: intersecting at the centre of mass; QUASI_STATIC: intersecting
    elsewhere; DYNAMIC: skew.
    """

    BALANCED = 0
    STATIC = 1
    COUPLE = 2
    QUASI_STATIC = 3
    DYNAMIC = 4


def unbalance(mass: ArrayLike, radius: ArrayLike, angle: ArrayLike) -> np.ndarray:
    """Unbalance of a mass off the axis, m e exp(i alpha).

    Parameters
    ----------
    mass, radius, angle : array_like (...)
        m [kg], e [m], alpha [rad].

    Returns
    -------
    ndarray of complex (...)
        [kg·m].
    """
    angle = np.asarray(angle, dtype=float)
    return np.multiply(mass, radius) * (np.cos(angle) + 1j * np.sin(angle))


def resultant_unbalance(unbalances: ArrayLike, positions: ArrayLike, plane: ArrayLike = 0.0) -> Resultant:
    """Resultant and moment unbalance about a plane.

    Parameters
    ----------
    unbalances : array_like of complex (..., unbalances)
        [kg·m].
    positions : array_like (..., unbalances)
        Positions along the axis [m].
    plane : array_like (...)
        Reference plane of the moment [m].
    """
    unbalances, plane = np.asarray(unbalances), np.asarray(plane, dtype=float)
    arms = np.asarray(positions, dtype=float) - plane[..., None]
    return Resultant(unbalances.sum(axis=-1), (unbalances * arms).sum(axis=-1), plane)


def about(rotor: Resultant, plane: ArrayLike) -> Resultant:
    """The same unbalance with its moment about another plane [m]: P + (z_0 - z) U."""
    plane = np.asarray(plane, dtype=float)
    return Resultant(rotor.unbalance, rotor.moment + (rotor.plane - plane) * rotor.unbalance, plane)


def unbalance_in_two_planes(rotor: Resultant, first: ArrayLike, second: ArrayLike) -> tuple[np.ndarray, np.ndarray]:
    """The equivalent unbalances in two planes: U_1 + U_2 = U with the same moment.

    Parameters
    ----------
    rotor : Resultant
    first, second : array_like (...)
        Positions of the planes [m].

    Returns
    -------
    ndarray of complex (...), ndarray of complex (...)
        [kg·m]; infinite or NaN if both planes are at the same position.
    """
    first, second = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    with np.errstate(divide="ignore", invalid="ignore"):
        span = second - first
        return -about(rotor, second).moment / span, about(rotor, first).moment / span


def kind(rotor: Resultant, centre: ArrayLike, unbalance_tolerance: float, moment_tolerance: float) -> np.ndarray:
    """Kind of unbalance.

    Parameters
    ----------
    rotor : Resultant
    centre : array_like (...)
        Position of the centre of mass [m].
    unbalance_tolerance, moment_tolerance : float
        Resultant unbalance [kg·m] and moment unbalance [kg·m²] that count as zero.

    Returns
    -------
    ndarray of int (...)
        Members of `Kind`.
    """
    static, couple = rotor.unbalance, about(rotor, centre).moment
    has_static, has_couple = np.abs(static) > unbalance_tolerance, np.abs(couple) > moment_tolerance
    # Resultant and couple are in one plane through the axis if the couple has no component across the resultant.
    across = np.abs((np.conj(static) * couple).imag) > moment_tolerance * np.abs(static)
    both, without = np.where(across, Kind.DYNAMIC, Kind.QUASI_STATIC), np.where(has_couple, Kind.COUPLE, Kind.BALANCED)
    return np.where(has_static, np.where(has_couple, both, Kind.STATIC), without)


def single_plane(rotor: Resultant) -> np.ndarray:
    """Position at which a single correction leaves the minimum couple: z_0 + Re(U* P)/|U|², [m] (...).

    A quasi-static unbalance is equivalent to one unbalance there; NaN without a resultant unbalance.
    """
    with np.errstate(divide="ignore", invalid="ignore"):
        return rotor.plane + (rotor.moment / rotor.unbalance).real


def vector_polygon(names: Sequence[str], vectors: np.ndarray, corrections: int, title: str, unit: str) -> Panel:
    """Polygon of vectors: unbalances, then the corrections that close it.

    Parameters
    ----------
    names : sequence of str
    vectors : ndarray of complex (vectors,)
    corrections : int
        Number of corrections at the end.
    title, unit : str
    """
    ends = np.concatenate([[0.0], np.cumsum(vectors)])
    own = len(vectors) - corrections
    lines = [path(name, ends[k : k + 2]) for k, name in enumerate(names[:own])]
    lines += [path(f"{name}, added", ends[k : k + 2]) for k, name in enumerate(names[own:], own)]
    resultant = path("resultant before", ends[[0, own]], True)
    left = Mark("what remains", ends[-1].real, ends[-1].imag)
    return plan((*lines, resultant), title, unit)._replace(marks=(Mark("", 0.0, 0.0), left))
