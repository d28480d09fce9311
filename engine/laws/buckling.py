"""Buckling of struts: Euler's curve for slender ones, Tetmajer's line or parabola below, at most the yield strength.

Source: L. v. Tetmajer, Die Gesetze der Knickungs- und der zusammengesetzten Druckfestigkeit (1896), with the
coefficients in MPa as given by handbooks of machine elements.
"""

import math
from typing import NamedTuple

import numpy as np


class StrutMaterial(NamedTuple):
    """Strength of a strut's material.

    Attributes
    ----------
    modulus : float
        Modulus of elasticity [Pa].
    crushing : float
        Strength of a short strut: yield strength, or compressive strength of brittle materials [Pa].
    tetmajer : tuple of 3 floats
        a, b, c of σ = a + b λ + c λ² [Pa].
    slender : float
        Slenderness above which Euler's curve holds.
    """

    modulus: float
    crushing: float
    tetmajer: tuple[float, float, float]
    slender: float


MATERIALS = {
    "S235": StrutMaterial(210e9, 240e6, (310e6, -1.14e6, 0.0), 104.0),
    "E335": StrutMaterial(210e9, 335e6, (335e6, -0.62e6, 0.0), 89.0),
    "grey cast iron": StrutMaterial(100e9, 776e6, (776e6, -12e6, 0.053e6), 80.0),
}


def critical_stress(slenderness: np.ndarray | float, material: StrutMaterial) -> np.ndarray:
    """Critical stress of struts [Pa].

    Parameters
    ----------
    slenderness : array_like
        λ, effective length divided by the radius of gyration of the section.
    material : StrutMaterial
    """
    slenderness = np.asarray(slenderness, float)
    a, b, c = material.tetmajer
    with np.errstate(divide="ignore"):
        euler = math.pi**2 * material.modulus / slenderness**2
    stocky = np.minimum(a + slenderness * (b + c * slenderness), material.crushing)
    return np.where(slenderness >= material.slender, euler, stocky)


def solid(diameter: float, inner: float = 0.0) -> tuple[float, float]:
    """Area [m²] and radius of gyration [m] of a round section; with an inner diameter, of a tube."""
    return math.pi / 4.0 * (diameter**2 - inner**2), np.sqrt(diameter**2 + inner**2) / 4.0


def flat(width: float, thickness: float) -> tuple[float, float]:
    """Area [m²] and minimum radius of gyration [m] of a rectangular section."""
    return width * thickness, np.minimum(width, thickness) / math.sqrt(12.0)
