"""Moments of couplings: how much a friction clutch may transmit, and what a fluid coupling does by its slip.

Arguments are floats or arrays of any shape.

Sources: G. Niemann and H. Winter, Maschinenelemente, volume 3 (friction clutches); VDI 2153 (hydrodynamic power
transmission: the moment λ ρ ω² D⁵ of a coupling of the diameter D, by its performance coefficient λ).
"""

import numpy as np


def fluid_coupling_moment(
    coefficient: float | np.ndarray,
    density: float | np.ndarray,
    speed: float | np.ndarray,
    diameter: float | np.ndarray,
) -> float | np.ndarray:
    """Moment of a fluid coupling, λ ρ ω² D⁵ [N·m].

    Parameters
    ----------
    coefficient : float or ndarray
        Performance coefficient λ at the slip.
    density : float or ndarray
        Of the fluid, ρ [kg/m³].
    speed : float or ndarray
        Of the side that drives, ω [rad/s].
    diameter : float or ndarray
        Profile diameter D [m].
    """
    return coefficient * density * speed**2 * diameter**5


def slip_of(driving: float | np.ndarray, driven: float | np.ndarray) -> float | np.ndarray:
    """Slip of a coupling, 1 − ω₂/ω₁; 0 where the driving side stands.

    Parameters
    ----------
    driving, driven : float or ndarray
        Speeds ω₁ and ω₂ [rad/s].
    """
    with np.errstate(all="ignore"):
        return np.where(driving == 0.0, 0.0, 1.0 - driven / driving)
