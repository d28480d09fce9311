"""Braking moments of block, disc and band brakes by their geometry.

Moments are magnitudes, acting against the rotation of the drum or disc. A force of 0 or below leaves the brake
released: no moment. A brake that locks by itself (friction alone presses it on) has an infinite one. Scalar
functions: floats in and out. Friction is Coulomb's, f = friction.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 19; Machinery's Handbook, Brakes; R. G. Budynas
and J. K. Nisbett, Shigley's Mechanical Engineering Design, chapter 16. Band and blocks, braking of a vehicle: Khurmi
and Gupta, chapter 19.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.friction.belts import gripped_share, slack_share


@scalar
def block_brake(normal_force: float, friction: float, radius: float, blocks: float) -> float:
    """Moment of equal blocks pressed on a drum: n f N R.

    Parameters
    ----------
    normal_force, friction, radius, blocks : float
        N on each block [N], f, radius of the drum R [m], number of blocks n.

    Returns
    -------
    float
        [N·m].
    """
    return blocks * friction * _pressing(normal_force) * radius


@scalar
def long_block_factor(half_angle: float) -> float:
    """Factor on f for a pivoted block that embraces an angle 2 theta: 4 sin theta/(2 theta + sin 2 theta).

    The pressure of a block that wears evenly goes with the cosine of the angle from its middle. It matters from
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
def disc_brake(force: float, friction: float, mean_radius: float, faces: float) -> float:
    """Moment of a disc brake: n f P r_m.

    Parameters
    ----------
    force, friction, mean_radius, faces : float
        P, axial force on each face [N], f, radius by `uniform_wear_radius` or `uniform_pressure_radius` [m],
        number n of rubbing faces.

    Returns
    -------
    float
        [N·m].
    """
    return faces * friction * _pressing(force) * mean_radius


@scalar
def uniform_wear_radius(inner: float, outer: float) -> float:
    """Radius at which the friction of a worn-in ring acts (p r constant): the middle one.

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
    """Radius at which the friction of a new ring acts (p constant): (2/3) (R³ - r³)/(R² - r²), reduced by R - r.

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
    """Moment of a band brake by Euler: the tight end of the band pulls e^(f alpha) times as much as the slack end.

    About the fulcrum F l = T_slack a + T_tight b, so that M = (T_tight - T_slack) R is
    F l R (e^(f alpha) - 1)/(a + b e^(f alpha)), here with both divided by e^(f alpha). With b = 0 it is the
    simple band pulled at its slack end, P R (e^(f alpha) - 1), with a = 0 at its tight end,
    P R (1 - e^(-f alpha)), where P = F l/a or F l/b; with arms of unlike sign the differential band. The other
    rotation exchanges a and b.

    Parameters
    ----------
    force, lever_arm : float
        F [N] and its arm l [m].
    slack_arm, tight_arm : float
        a and b, arms of the ends that are slack and tight in this rotation [m]: 0 for an end fixed to the frame
        or the fulcrum, negative for an end that the lever lets go where the force draws the other one.
    friction, wrap, radius : float
        f, angle of contact alpha [rad], radius of the drum R [m].

    Returns
    -------
    float
        [N·m]; infinite where the brake locks by itself, a + b e^(f alpha) <= 0, and NaN for a + b <= 0, where the
        force slackens the band.
    """
    if not slack_arm + tight_arm > 0.0:
        return math.nan
    rubbing = gripped_share(friction, wrap) * _pressing(force) * lever_arm * radius
    left = slack_arm * slack_share(friction, wrap) + tight_arm
    if left <= 0.0:
        return math.inf if rubbing > 0.0 else rubbing
    return rubbing / left


@scalar
def band_and_block_grip(friction: float, block_angle: float, blocks: float) -> float:
    """What f alpha of a plain band is for one lined with blocks: its e^(f alpha) is the ratio of the end tensions.

    On a block that embraces 2 theta the band pulls with T' and T: (T' - T) cos theta = f N, (T' + T) sin theta = N, so
    that n blocks give T_tight/T_slack = ((1 + f tan theta)/(1 - f tan theta))^n = e^(2 n artanh(f tan theta)).

    Parameters
    ----------
    friction, block_angle, blocks : float
        f, 2 theta below pi [rad], number n of blocks.

    Returns
    -------
    float
        Infinite where a block sticks, f tan theta >= 1.
    """
    held = friction * math.tan(block_angle / 2)
    if held >= 1.0:
        return math.inf
    return 2 * blocks * math.atanh(held)


@scalar
def axle_shares(
    wheelbase: float, rear_distance: float, height: float, front: float, rear: float
) -> tuple[float, float]:
    """Shares of a braked vehicle's weight normal to the road that its front and rear axle bear.

    About the centre of mass (f_1 N_1 + f_2 N_2) h = N_1 (L - x) - N_2 x.

    Parameters
    ----------
    wheelbase, rear_distance, height : float
        L, distance x of the centre of mass from the rear axle, and its height h [m].
    front, rear : float
        f_1 and f_2 between tyres and road, 0 of an axle without brakes.

    Returns
    -------
    front_share, rear_share : float
        NaN where the rear axle would lift.
    """
    kept = wheelbase - rear_distance - front * height
    if kept < 0.0:
        return math.nan, math.nan
    whole = wheelbase + (rear - front) * height
    return (rear_distance + rear * height) / whole, kept / whole


@scalar
def _pressing(force: float) -> float:
    """The force, or 0 where it would lift the brake; NaN stays."""
    return 0.0 if force < 0.0 else force
