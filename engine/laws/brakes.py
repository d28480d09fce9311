"""Braking torques of block, disc and band brakes from their geometry.

Torques are magnitudes, opposed to the rotation of the drum or disc. A force of 0 or less leaves the brake released,
with zero torque. A self-locking brake, which friction applies by itself, has infinite torque. Scalar functions: floats
in and out. Friction is Coulomb's, with coefficient f = `friction`.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 19; Machinery's Handbook, Brakes; R. G. Budynas
and J. K. Nisbett, Shigley's Mechanical Engineering Design, chapter 16. Band and block brake, braking of a vehicle:
Khurmi and Gupta, chapter 19.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def pressed_brake(force: float, friction: float, radius: float, faces: float) -> float:
    """Torque of equal blocks pressed on a drum, or of the faces of a disc: n f P R.

    Parameters
    ----------
    force, friction, radius, faces : float
        P on each block or face [N], f, radius of the drum, or effective radius of the disc by `uniform_wear_radius` or
        `uniform_pressure_radius` [m], number n of blocks or faces.

    Returns
    -------
    float
        [N·m].
    """
    return faces * friction * _pressing(force) * radius


@scalar
def long_block_factor(half_angle: float) -> float:
    """Factor on f for a pivoted block with angle of contact 2 theta: 4 sin theta/(2 theta + sin 2 theta).

    The pressure of an evenly worn block varies as the cosine of the angle from its middle. The factor matters above
    about 2 theta = 60 degrees.

    Parameters
    ----------
    half_angle : float
        theta, 0 to pi/2 [rad].

    Returns
    -------
    float
        1 for a short block, 4/pi for half the drum.
    """
    if half_angle == 0.0:
        return 1.0
    return 4 * math.sin(half_angle) / (2 * half_angle + math.sin(2 * half_angle))


@scalar
def uniform_wear_radius(inner: float, outer: float) -> float:
    """Effective radius of a worn-in ring (uniform wear, p r constant): the mean radius.

    Parameters
    ----------
    inner, outer : float
        Radii of the ring [m].

    Returns
    -------
    float
        [m].
    """
    return (inner + outer) / 2


@scalar
def uniform_pressure_radius(inner: float, outer: float) -> float:
    """Effective radius of a new ring (uniform pressure): (2/3) (R³ - r³)/(R² - r²), with R - r cancelled.

    Parameters
    ----------
    inner, outer : float
        Radii of the ring [m].

    Returns
    -------
    float
        [m].
    """
    return 2 * (inner * inner + inner * outer + outer * outer) / (3 * (inner + outer))


@scalar
def band_brake(
    force: float, lever_arm: float, slack_arm: float, tight_arm: float, friction: float, wrap: float, radius: float
) -> float:
    """Torque of a band brake by Euler's formula: the tight end's tension is e^(f alpha) times that of the slack end.

    Moments about the fulcrum give F l = T_slack a + T_tight b, so M = (T_tight - T_slack) R is
    F l R (e^(f alpha) - 1)/(a + b e^(f alpha)), evaluated here with both divided by e^(f alpha). With b = 0 it is the
    simple band pulled at its slack end, P R (e^(f alpha) - 1), with a = 0 at its tight end,
    P R (1 - e^(-f alpha)), where P = F l/a or F l/b; with arms of opposite sign it is the differential band. Reversed
    rotation exchanges a and b.

    Parameters
    ----------
    force, lever_arm : float
        F [N] and its arm l [m].
    slack_arm, tight_arm : float
        a and b, arms of the slack and the tight end for this rotation [m]: 0 for an end fixed to the frame or the
        fulcrum, negative for an end that the lever slackens where the force pulls the other one.
    friction, wrap, radius : float
        f, angle of contact alpha [rad], radius of the drum R [m].

    Returns
    -------
    float
        [N·m]; infinite where the brake is self-locking, a + b e^(f alpha) <= 0, and NaN for a + b <= 0, where the force
        slackens the band.
    """
    if not slack_arm + tight_arm > 0.0:
        return math.nan
    rubbing = -math.expm1(-friction * wrap) * _pressing(force) * lever_arm * radius
    left = slack_arm * math.exp(-friction * wrap) + tight_arm
    if left <= 0.0:
        return math.inf if rubbing > 0.0 else rubbing
    return rubbing / left


@scalar
def band_and_block_grip(friction: float, block_angle: float, blocks: float) -> float:
    """Equivalent f alpha of a band lined with blocks: e^(f alpha) is the ratio of its end tensions.

    On a block with angle of contact 2 theta the band pulls with T' and T: (T' - T) cos theta = f N and
    (T' + T) sin theta = N, so n blocks give
    T_tight/T_slack = ((1 + f tan theta)/(1 - f tan theta))^n = e^(2 n artanh(f tan theta)).

    Parameters
    ----------
    friction, block_angle, blocks : float
        f, 2 theta below pi [rad], number n of blocks.

    Returns
    -------
    float
        Infinite where a block grabs, f tan theta >= 1.
    """
    held = friction * math.tan(block_angle / 2)
    if held >= 1.0:
        return math.inf
    return 2 * blocks * math.atanh(held)


@scalar
def _pressing(force: float) -> float:
    """The applied force; 0 where it would lift the brake, NaN for NaN."""
    return 0.0 if force < 0.0 else force
