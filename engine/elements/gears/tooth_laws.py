"""Laws of involute teeth in mesh: operating angle, tips, interference, contact ratio, losses, forces.

All functions work elementwise on arrays. In an internal mesh the second wheel is the ring, with `sense` −1. The
addendum is one module; profile shifts are in modules and positive outwards, also for a ring. Lengths are in normal
modules.

Source: DIN 3960; Shigley, Mechanical Engineering Design, on interference; Schlenk's general form of the tooth loss by
Niemann and Winter.
"""

import math
from typing import NamedTuple

import numpy as np

# Newton steps for the angle of an involute; five reach rounding from these starting values.
_NEWTON_STEPS = 8
# Relative overlap below which tips just touch: rounding.
_TOUCH = 1e-12
# Largest number of teeth of the search, as a power of two.
_MOST_HALVINGS = 20


class TeethInMesh(NamedTuple):
    """Numbers of teeth, shifts and angles of a mesh; arrays that broadcast.

    `pressure_angle` is in the normal section, `helix_angle` on the pitch cylinder [rad].
    """

    first: np.ndarray
    second: np.ndarray
    sense: int
    pressure_angle: np.ndarray
    helix_angle: np.ndarray
    first_shift: np.ndarray
    second_shift: np.ndarray


class MeshGeometry(NamedTuple):
    """Geometry of a mesh in the transverse section; lengths in normal modules, NaN if no centre distance is possible.

    Attributes
    ----------
    angle : ndarray
        Operating pressure angle [rad].
    distance : ndarray
        Centre distance.
    rolling : tuple of ndarray
        Operating pitch diameters.
    tips : tuple of ndarray
        Tip diameters; pointed teeth end at their point, those of a ring at its base circle.
    contact : tuple of ndarray
        Parts ε₁, ε₂ of the contact ratio on both sides of the pitch point, on involute flanks only: the path of contact
        ends at the interference points, where it is tangent to the base circles.
    interferes : ndarray of bool
        Whether a tip reaches beyond such a point, or tips of an internal mesh collide off the path of contact.
    """

    angle: np.ndarray
    distance: np.ndarray
    rolling: tuple[np.ndarray, np.ndarray]
    tips: tuple[np.ndarray, np.ndarray]
    contact: tuple[np.ndarray, np.ndarray]
    interferes: np.ndarray


class ToothForces(NamedTuple):
    """Forces between two teeth at the pitch point [N]: tangential, radial, axial, and normal (total)."""

    tangential: np.ndarray
    radial: np.ndarray
    axial: np.ndarray
    normal: np.ndarray


def pitch_diameter(teeth: np.ndarray, module: np.ndarray, helix_angle: np.ndarray) -> np.ndarray:
    """Pitch diameter d = m z / cos β, m the normal module."""
    return module * teeth / np.cos(helix_angle)


def transverse_angle(pressure_angle: np.ndarray, helix_angle: np.ndarray) -> np.ndarray:
    """Pressure angle in the transverse section, tan α_t = tan α_n / cos β."""
    return np.arctan(np.tan(pressure_angle) / np.cos(helix_angle))


def involute(tangent: np.ndarray) -> np.ndarray:
    """Involute function of an angle given by its tangent, inv α = tan α − α."""
    return tangent - np.arctan(tangent)


def tangent_of_involute(value: np.ndarray) -> np.ndarray:
    """Tangent of the angle with a given involute function; NaN for negative values.

    Newton's method on a convex function: after the first step it converges monotonically from above.
    """
    with np.errstate(invalid="ignore", divide="ignore"):
        root = np.cbrt(3.0 * value)
        tangent = np.minimum(root + 0.25 * root**3, value + 0.5 * math.pi)
        for _ in range(_NEWTON_STEPS):
            tangent = tangent - (involute(tangent) - value) * (1.0 + 1.0 / tangent**2)
        return np.where(value > 0.0, tangent, np.where(value == 0.0, 0.0, np.nan))


def mesh_geometry(teeth: TeethInMesh) -> MeshGeometry:
    """Operating pressure angle, centre distance, tips, contact ratio and interference of a mesh.

    inv α_w = inv α_t + 2 tan α_n (x₁ ± x₂)/(z₁ ± z₂), + external; the tips of an external mesh are shortened to keep
    the clearance of wheels without shift.
    """
    z, x, sense = (teeth.first, teeth.second), (teeth.first_shift, teeth.second_shift), teeth.sense
    sides = (1, sense)
    t = np.tan(transverse_angle(teeth.pressure_angle, teeth.helix_angle))
    total = teeth.first + sense * teeth.second
    shift = x[0] + sense * x[1]
    with np.errstate(invalid="ignore", divide="ignore"):
        wanted = involute(t) + 2.0 * np.tan(teeth.pressure_angle) * shift / total
        operating = np.where(shift == 0.0, t, tangent_of_involute(np.where(wanted > 0.0, wanted, np.nan)))
        stretch = np.sqrt((1.0 + operating**2) / (1.0 + t**2)) / np.cos(teeth.helix_angle)
        rolling = z[0] * stretch, z[1] * stretch
        distance = 0.5 * (sense * rolling[0] + rolling[1])
        # Tip shortening: the sum of the shifts minus the increase of the centre distance.
        short = 0.5 * total / np.cos(teeth.helix_angle) + shift - distance if sense > 0 else 0.0
        tangents = tuple(
            _tip_tangent(number, side, own - side * short, teeth, own)
            for number, side, own in zip(z, sides, x, strict=True)
        )
        bases = tuple(number / np.cos(teeth.helix_angle) / np.sqrt(1.0 + t**2) for number in z)
        tips = tuple(base * np.sqrt(1.0 + tangent**2) for base, tangent in zip(bases, tangents, strict=True))
        wheels = zip(z, sides, tangents, strict=True)
        reach = tuple(side * number * (tangent - operating) for number, side, tangent in wheels)
        # Limit of the path of contact: where the line of action is tangent to the other base circle; towards the teeth
        # of a ring there is no such point.
        room = np.inf if sense < 0 else z[1] * operating, z[0] * operating
        interferes = np.any([r > most * (1.0 + _TOUCH) for r, most in zip(reach, room, strict=True)], axis=0)
        if sense < 0:
            interferes |= _tips_meet(z, tangents, bases, operating)
        contact = tuple(np.minimum(r, most) / math.tau for r, most in zip(reach, room, strict=True))
    return MeshGeometry(np.arctan(operating), distance, rolling, tips, contact, interferes)


def _tip_tangent(
    number: np.ndarray, side: int, addition: np.ndarray, teeth: TeethInMesh, shift: np.ndarray
) -> np.ndarray:
    """Tangent of the transverse pressure angle at the tips of a wheel, side 1, or ring, side −1.

    Half the tooth angle at the tip, (π/2 ± 2 x tan α_n)/z ± (inv α_t − inv α_a), vanishes for a pointed tooth.
    """
    helix = np.cos(teeth.helix_angle)
    t = np.tan(transverse_angle(teeth.pressure_angle, teeth.helix_angle))
    tip = number + 2.0 * helix * (side + addition)
    # Tips of a ring inside its base circle end there.
    tangent = np.sqrt(np.maximum((1.0 + t**2) * (np.maximum(tip, 0.0) / number) ** 2 - 1.0, 0.0))
    half = (0.5 * math.pi + side * 2.0 * shift * np.tan(teeth.pressure_angle)) / number
    point = tangent_of_involute(np.maximum(involute(t) + side * half, 0.0))
    return np.minimum(tangent, point) if side > 0 else np.maximum(tangent, point)


def _tips_meet(
    z: tuple[np.ndarray, np.ndarray],
    tangents: tuple[np.ndarray, np.ndarray],
    bases: tuple[np.ndarray, np.ndarray],
    operating: np.ndarray,
) -> np.ndarray:
    """Whether tips of a wheel and a ring of nearly equal numbers of teeth collide where the wheel leaves the ring.

    Where the tip circles intersect, the wheel's tooth must be behind the ring's (DIN 3993).
    """
    r_1, r_2 = (0.5 * base * np.sqrt(1.0 + tangent**2) for base, tangent in zip(bases, tangents, strict=True))
    a = 0.5 * (bases[1] - bases[0]) * np.sqrt(1.0 + operating**2)
    inv_w, inv_1, inv_2 = (involute(value) for value in (operating, *tangents))
    cosines = (r_2**2 - r_1**2 - a**2) / (2.0 * a * r_1), (r_2**2 - r_1**2 + a**2) / (2.0 * a * r_2)
    at_1, at_2 = (np.arccos(np.clip(value, -1.0, 1.0)) for value in cosines)
    ahead = (at_1 + inv_1 - inv_w) * z[0] / z[1] + inv_w - inv_2 - at_2
    return (np.abs(cosines[0]) <= 1.0) & (ahead < -_TOUCH)


def minimum_teeth(teeth: TeethInMesh) -> np.ndarray:
    """Minimum teeth of the smaller wheel (internal: of the pinion) without interference from the larger wheel's tips.

    Shifts and the larger wheel stay unchanged. NaN if even the largest number of teeth is too small: 2^20, or in an
    internal mesh one below that of the ring.
    """
    is_first = (teeth.first <= teeth.second) | (teeth.sense < 0)
    large = np.where(is_first, teeth.second, teeth.first)
    small_shift = np.where(is_first, teeth.first_shift, teeth.second_shift)
    large_shift = np.where(is_first, teeth.second_shift, teeth.first_shift)

    def clear(count: np.ndarray) -> np.ndarray:
        """Whether the tips of the larger wheel clear the roots of a wheel with this number of teeth."""
        pair = teeth._replace(first=count, second=large, first_shift=small_shift, second_shift=large_shift)
        found = mesh_geometry(pair)
        room = count * np.tan(found.angle) / math.tau
        # `contact` is cut off at the interference point; at the cut-off, tips interfere.
        return found.contact[1] < room * (1.0 - _TOUCH)

    low, high = np.zeros(np.shape(large)), np.full(np.shape(large), 2.0**_MOST_HALVINGS)
    if teeth.sense < 0:
        high = np.maximum(large - 1.0, 0.0)
    possible = clear(high)
    for _ in range(_MOST_HALVINGS):
        middle = np.floor(0.5 * (low + high))
        passes = clear(np.maximum(middle, 1.0))
        low, high = np.where(passes, low, middle), np.where(passes, middle, high)
    return np.where(possible, high, np.nan)


def mesh_efficiency(teeth: TeethInMesh, contact: tuple[np.ndarray, np.ndarray], friction: np.ndarray) -> np.ndarray:
    """Efficiency of a mesh with its axes at rest, η = 1 − μ H_v, at least 0.

    H_v = 2π (1/z₁ ± 1/z₂)/cos β_b · ∫|s|/n ds, + external, where s is the distance of the contact from the pitch point
    in base pitches, from −ε₂ to ε₁, and n the number of teeth that share the load equally. For 1 ≤ ε_α ≤ 2 and ε₁, ε₂
    between 0 and 1 the integral is Niemann and Winter's (1 − ε_α + ε₁² + ε₂²)/2.

    Parameters
    ----------
    teeth : TeethInMesh
    contact : tuple of ndarray
        Parts ε₁, ε₂ of the contact ratio.
    friction : ndarray
        Mean coefficient of friction of the teeth.
    """
    e_1, e_2 = contact
    ratio = e_1 + e_2
    pairs = np.floor(ratio)
    extra = ratio - pairs
    lost = np.zeros(np.broadcast(e_1, e_2).shape)
    for j in range(int(np.nanmax(pairs, initial=0.0)) + 1):
        start = j - e_2
        with_extra = _sliding(start, start + extra) / (pairs + 1.0)
        without = _sliding(start + extra, start + 1.0) / np.maximum(pairs, 1.0)
        lost = lost + np.where(j <= pairs, with_extra, 0.0) + np.where(j < pairs, without, 0.0)
    curvature = 1.0 / teeth.first + teeth.sense / teeth.second
    loss = math.tau * curvature / np.sqrt(1.0 - _base_sine(teeth) ** 2) * lost
    return np.maximum(1.0 - friction * loss, 0.0)


def _sliding(start: np.ndarray, end: np.ndarray) -> np.ndarray:
    """Integral of |s| from start to end."""
    return 0.5 * (end * np.abs(end) - start * np.abs(start))


def tooth_forces(tangential: np.ndarray, angle: np.ndarray, teeth: TeethInMesh) -> ToothForces:
    """Tooth forces for a tangential force at the operating pitch point.

    F_n = F_t/(cos α_w cos β_b), F_a = F_n sin β_b, F_r = F_t tan α_w.

    Parameters
    ----------
    tangential : ndarray
        [N]
    angle : ndarray
        Operating pressure angle [rad].
    teeth : TeethInMesh
    """
    base_sine = _base_sine(teeth)
    normal = tangential / (np.cos(angle) * np.sqrt(1.0 - base_sine**2))
    return ToothForces(tangential, tangential * np.tan(angle), normal * base_sine, normal)


def _base_sine(teeth: TeethInMesh) -> np.ndarray:
    """Sine of the helix angle on the base cylinder, sin β_b = sin β cos α_n."""
    return np.sin(teeth.helix_angle) * np.cos(teeth.pressure_angle)
