"""Loads on a point or a link: resistances that depend on velocity, springs, fluid couplings.

A load is a force (or moment) along its own direction, positive along it. v is the velocity [m/s, or rad/s for a moment]
of the loaded point along the same direction, so a resistance is negative for v > 0. Functions of a position: floats in
and out, float32 or float64, NaN for NaN.

Sources: any textbook of machine dynamics. Coulomb's resistance is undetermined at rest; it is taken as 0 here, the
middle of its range. VDI 2153, hydrodynamic power transmission: torque λ ρ ω² D⁵ of a coupling with diameter D and
performance coefficient λ.
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
    # 0 at rest, NaN for an unknown velocity.
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
        Zero at rest, NaN for an unknown velocity.
    """
    v = math.sqrt(vx * vx + vy * vy)
    if v == 0.0:
        return vx, vy
    return vx / v, vy / v


@scalar
def spring(stiffness: float, free_length: float, length: float) -> float:
    """Force of a linear spring in the direction of increasing length; positive in compression.

    Parameters
    ----------
    stiffness : float
        [N/m], or [N·m/rad] for a torsion spring.
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
    """Factor on a weight behind gearing with efficiency η: 1/η while it is lifted, η while it drives.

    Parameters
    ----------
    efficiency : float
        η.
    direction : float
        +1 if the weight is lifted for v > 0, -1 if for v < 0.
    v : float
        Velocity [m/s or rad/s].

    Returns
    -------
    float
        1 at rest; NaN for an unknown velocity.
    """
    lifted = direction * v
    if lifted > 0.0:
        return 1.0 / efficiency
    if lifted < 0.0:
        return efficiency
    return 1.0 + v


@scalar
def acts_in_direction(direction: float, v: float) -> float:
    """Factor on a load that acts in one direction of motion only (cutting, not the return stroke).

    Parameters
    ----------
    direction : float
        +1: acts while v > 0; -1: while v < 0; 0: always.
    v : float
        Velocity [m/s or rad/s].

    Returns
    -------
    float
        1.0 or 0.0; NaN if the direction matters and the velocity is unknown.
    """
    forwards = direction * v
    acts = 0.0 if forwards <= 0.0 else v
    return 1.0 if (direction == 0.0) | (forwards > 0.0) else acts


@scalar
def sized(size: float, value: float) -> float:
    """Size times value; 0 for size 0, even if the value is infinite or NaN."""
    return size * value if size != 0.0 else 0.0


def fluid_coupling_moment(
    coefficient: float | np.ndarray,
    density: float | np.ndarray,
    speed: float | np.ndarray,
    diameter: float | np.ndarray,
) -> float | np.ndarray:
    """Torque of a fluid coupling, λ ρ ω² D⁵ [N·m].

    Parameters
    ----------
    coefficient : float or ndarray
        Performance coefficient λ at the slip.
    density : float or ndarray
        Density of the fluid, ρ [kg/m³].
    speed : float or ndarray
        Speed of the driving side, ω [rad/s].
    diameter : float or ndarray
        Profile diameter D [m].
    """
    return coefficient * density * speed**2 * diameter**5


def slip_of(driving: float | np.ndarray, driven: float | np.ndarray) -> float | np.ndarray:
    """Slip of a coupling, 1 − ω₂/ω₁; 0 where the driving side is at rest.

    Parameters
    ----------
    driving, driven : float or ndarray
        Speeds ω₁ and ω₂ [rad/s].
    """
    with np.errstate(all="ignore"):
        return np.where(driving == 0.0, 0.0, 1.0 - driven / driving)
