"""Laws of teeth in mesh: contact ratios, losses, forces; wheels without profile shift, addendum of one module.

Arrays in, arrays out, element by element. Of an internal mesh the second wheel is the ring, `sense` −1.
"""

import math
from typing import NamedTuple

import numpy as np


class ToothForces(NamedTuple):
    """Forces between two teeth at the pitch point [N]: along the pitch circle, apart, along the axis, and whole."""

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


def addendum_contact_ratios(
    first: np.ndarray, second: np.ndarray, sense: int, pressure_angle: np.ndarray, helix_angle: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Shares ε₁, ε₂ of the contact ratio that lie on the two sides of the pitch point.

    ε = z (tan α_a − tan α_t)/(2π) with the pressure angle α_a at the tip, cos α_a = d cos α_t / d_a. Teeth of a ring
    that would end within its base circle end there.

    Parameters
    ----------
    first, second : ndarray
        Numbers of teeth.
    sense : {1, -1}
        Whether the mesh is external or internal.
    pressure_angle, helix_angle : ndarray
        Of the normal section, and on the pitch cylinder [rad].
    """
    alpha = transverse_angle(pressure_angle, helix_angle)
    shares = []
    for teeth, side in ((first, 1), (second, sense)):
        tip = teeth + side * 2.0 * np.cos(helix_angle)
        cosine = teeth * np.cos(alpha) / tip
        tan_tip = np.sqrt(np.maximum(1.0 / cosine**2 - 1.0, 0.0))
        tan_tip = np.where(cosine < 1.0, tan_tip, 0.0)
        shares.append(side * teeth * (tan_tip - np.tan(alpha)) / math.tau)
    return shares[0], shares[1]


def mesh_efficiency(
    first: np.ndarray,
    second: np.ndarray,
    sense: int,
    friction: np.ndarray,
    pressure_angle: np.ndarray,
    helix_angle: np.ndarray,
) -> np.ndarray:
    """Efficiency of a mesh whose axes stand still, η = 1 − μ H_v, with Niemann and Winter's H_v; 0 where all is lost.

    H_v = π (1/z₁ ± 1/z₂)/cos β · (1 − ε_α + ε₁² + ε₂²), + external.

    Parameters
    ----------
    first, second : ndarray
        Numbers of teeth.
    sense : {1, -1}
        Whether the mesh is external or internal.
    friction : ndarray
        Mean coefficient of friction of the teeth.
    pressure_angle, helix_angle : ndarray
        As for `addendum_contact_ratios`.
    """
    e_1, e_2 = addendum_contact_ratios(first, second, sense, pressure_angle, helix_angle)
    curvature = 1.0 / first + sense / second
    loss = math.pi * curvature / np.cos(helix_angle) * (1.0 - e_1 - e_2 + e_1**2 + e_2**2)
    return np.maximum(1.0 - friction * loss, 0.0)


def tooth_forces(tangential: np.ndarray, pressure_angle: np.ndarray, helix_angle: np.ndarray) -> ToothForces:
    """Forces between teeth from the tangential one: F_r = F_t tan α_t, F_a = F_t tan β, F_n = F_t/(cos α_n cos β)."""
    return ToothForces(
        tangential,
        tangential * np.tan(transverse_angle(pressure_angle, helix_angle)),
        tangential * np.tan(helix_angle),
        tangential / (np.cos(pressure_angle) * np.cos(helix_angle)),
    )
