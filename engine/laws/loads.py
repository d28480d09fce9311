"""Loads on a point or a link: resistances that follow the velocity, springs; moments of fluid couplings.

A load is a force (or a moment) along a direction of its own. It is positive along that direction, and v is
the velocity [m/s, or rad/s for a moment] of the loaded point along the same direction: a resistance is
negative for v > 0. Per-position functions: floats in and out, float32 or float64, NaN for NaN.

Sources: any textbook of machine dynamics; Coulomb's resistance has no value at rest, which is taken as 0
here (the middle of what it may be). VDI 2153, hydrodynamic power transmission: the moment λ ρ ω² D⁵ of a coupling of
the diameter D, by its performance coefficient λ.
"""

import math

import numpy as np

from engine.compiling.decorators import scalar


@scalar
def constant_against_motion(magnitude: float, v: float) -> float:
    """Resistance of constant magnitude against the motion, -F sign(v).

    Parameters
    ----------
    magnitude : float
        F [N or N·m].
    v : float
        Velocity [m/s or rad/s].

    Returns
    -------
    float
        [N or N·m]; 0 at rest.
    """
    if v > 0.0:
        return -magnitude
    if v < 0.0:
        return magnitude
    # 0 at rest, and NaN where the velocity is not known.
    return v * magnitude


@scalar
def direction_of_motion(vx: float, vy: float) -> tuple[float, float]:
    """Unit vector along a velocity.

    Parameters
    ----------
    vx, vy : float
        Velocity [m/s].

    Returns
    -------
    c, s : float
        Zero at rest, NaN where the velocity is not known.
    """
    v = math.sqrt(vx * vx + vy * vy)
    if v == 0.0:
        return vx, vy
    return vx / v, vy / v


@scalar
def spring(stiffness: float, free_length: float, length: float) -> float:
    """Force of a linear spring along its growing length: it pushes its ends apart where it is compressed.

    Parameters
    ----------
    stiffness : float
        [N/m], or [N·m/rad] of a torsion spring.
    free_length, length : float
        [m], or angles [rad].

    Returns
    -------
    float
        [N or N·m], stiffness · (free length - length).
    """
    return stiffness * (free_length - length)


@scalar
def lifting_factor(efficiency: float, direction: float, v: float) -> float:
    """Factor of a weight behind gearing of some efficiency η: 1/η while it is lifted, η while it drives.

    Parameters
    ----------
    efficiency : float
        η.
    direction : float
        +1 where it is lifted while v > 0, -1 where while v < 0.
    v : float
        Velocity [m/s or rad/s].

    Returns
    -------
    float
        1 at rest; NaN where the velocity is not known.
    """
    lifted = direction * v
    if lifted > 0.0:
        return 1.0 / efficiency
    if lifted < 0.0:
        return efficiency
    return 1.0 + v


@scalar
def acts_in_direction(direction: float, v: float) -> float:
    """Factor of a load that acts in one direction of motion only (cutting, not the return stroke).

    Parameters
    ----------
    direction : float
        +1: acts while v > 0; -1: while v < 0; 0: always.
    v : float
        Velocity [m/s or rad/s].

    Returns
    -------
    float
        1.0 or 0.0; NaN where a direction is asked of an unknown velocity.
    """
    forwards = direction * v
    acts = 0.0 if forwards <= 0.0 else v
    return 1.0 if (direction == 0.0) | (forwards > 0.0) else acts


@scalar
def sized(size: float, value: float) -> float:
    """Size times value; nothing where the size is 0, whatever the value."""
    return size * value if size != 0.0 else 0.0


def fluid_coupling_moment(
    coefficient: float | np.ndarray,
    density: float | np.ndarray,
    speed: float | np.ndarray,
    diameter: float | np.ndarray,
) -> float | np.ndarray:
    """Moment of a fluid coupling, λ ρ ω² D⁵ [N·m]; arrays too.

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
    """Slip of a coupling, 1 − ω₂/ω₁; 0 where the driving side stands; arrays too.

    Parameters
    ----------
    driving, driven : float or ndarray
        Speeds ω₁ and ω₂ [rad/s].
    """
    with np.errstate(all="ignore"):
        return np.where(driving == 0.0, 0.0, 1.0 - driven / driving)
