"""Controlling force of a governor and its equilibrium speed, by virtual work at a position x.

With two balls of mass m at radius r on a spindle with speed ω, the centrifugal forces do the work 2 m ω² r dr against
the potential V of weights and spring: ω² 2 m r r' = V'. Primes are derivatives by x; see
`engine.laws.governors.linkages`. The controlling force is that of one ball, F_c = m ω² r.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 18; T. Bevan, The Theory of Machines, chapter 10
(controlling force, stability, effort); I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on governors.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def holding(
    ball_weight: float,
    sleeve_load: float,
    stiffness: float,
    ball_rise: float,
    ball_rise_rate: float,
    lift_rate: float,
    lift_rate_rate: float,
) -> tuple[float, float]:
    """V' and V'' of two balls, and of a sleeve under its weight and a spring.

    Parameters
    ----------
    ball_weight : float
        Weight of one ball [N].
    sleeve_load : float
        Weight of the sleeve with its load, plus the spring force [N].
    stiffness : float
        Stiffness of the spring [N/m].
    ball_rise, ball_rise_rate, lift_rate, lift_rate_rate : float
        h', h'', z', z''.

    Returns
    -------
    tuple of 2 floats
        For x in metres [N], [N/m].
    """
    slope = 2.0 * ball_weight * ball_rise + sleeve_load * lift_rate
    return slope, 2.0 * ball_weight * ball_rise_rate + sleeve_load * lift_rate_rate + stiffness * lift_rate * lift_rate


@scalar
def controlling_force(potential_slope: float, radius_rate: float) -> float:
    """Controlling force of one ball: V'/(2 r') [N]."""
    return potential_slope / (2.0 * radius_rate)


@scalar
def equilibrium_speed(force: float, mass: float, radius: float) -> float:
    """Spindle speed at which balls of a mass stay at their radius: √(F_c/(m r)) [rad/s]."""
    return math.sqrt(force / (mass * radius))


@scalar
def sleeve_equivalent(potential_slope: float, lift_rate: float) -> float:
    """Equivalent at the sleeve of the controlling force: E = V'/z' [N]."""
    return potential_slope / lift_rate


@scalar
def stability_margin(
    radius: float,
    radius_rate: float,
    radius_rate_rate: float,
    potential_slope: float,
    potential_curvature: float,
) -> float:
    """Stability margin: relative slope of the squared equilibrium speed over the radius, (dω²/dr)/(ω²/r).

    Above 0 the governor is stable, at 0 isochronous: the speed is equal at neighbouring radii. It is the slope of the
    controlling force relative to that of a ray from the origin, minus 1: (dF_c/dr)/(F_c/r) − 1.

    Parameters
    ----------
    radius, radius_rate, radius_rate_rate : float
        r, r', r''.
    potential_slope, potential_curvature : float
        V', V''.

    Returns
    -------
    float
    """
    return radius * (potential_curvature / potential_slope - radius_rate_rate / radius_rate) / radius_rate - 1.0


@scalar
def speed_with_friction(speed: float, friction: float, force: float) -> float:
    """Speed at which the sleeve starts to move against friction: ω √(1 + F/E).

    Parameters
    ----------
    speed, friction, force : float
        ω without friction [rad/s]; F at the sleeve, negative for a falling sleeve; E [N].

    Returns
    -------
    float
        [rad/s]; NaN where friction holds the sleeve at any speed.
    """
    return speed * math.sqrt(1.0 + friction / force)


@scalar
def insensitivity_by_friction(friction: float, force: float) -> float:
    """Insensitivity: relative range of speeds in which friction holds the sleeve, √(1 + F/E) − √(1 − F/E) ≈ F/E."""
    return math.sqrt(1.0 + friction / force) - math.sqrt(1.0 - friction / force)


@scalar
def sleeve_stiffness(force: float, margin: float, radius: float, radius_rate: float, lift_rate: float) -> float:
    """Stiffness at the sleeve, force per metre of lift at constant speed: c = E μ r'/(r z') [N/m].

    It is (V'' − ½ ω² J'')/z'² with J = 2 m r² + J_a and ω the equilibrium speed.

    Parameters
    ----------
    force, margin : float
        E [N] and `stability_margin` μ.
    radius, radius_rate, lift_rate : float
        r, r', z'.

    Returns
    -------
    float
    """
    return force * margin * radius_rate / (radius * lift_rate)


@scalar
def moving_inertia(
    ball_mass: float, sleeve_mass: float, radius_rate: float, ball_rise: float, lift_rate: float
) -> float:
    """Inertia A of the governor's motion, with kinetic energy ½ A ẋ²: 2 m (r'² + h'²) + M z'² [kg]."""
    balls = radius_rate * radius_rate + ball_rise * ball_rise
    return 2.0 * ball_mass * balls + sleeve_mass * lift_rate * lift_rate


def non_uniformity(slowest: float, fastest: float, mean: float) -> float:
    """Degree of non-uniformity δ = (ω_max − ω_min)/ω_m of the speeds at which a governor is in equilibrium."""
    return (fastest - slowest) / mean


@scalar
def under_friction(
    friction: float, least: float, least_force: float, greatest: float, greatest_force: float, weakest: float
) -> tuple[float, float, float]:
    """Speeds at which the sleeve reaches its lowest and highest position; the maximum insensitivity."""
    return (
        speed_with_friction(least, -friction, least_force),
        speed_with_friction(greatest, friction, greatest_force),
        insensitivity_by_friction(friction, weakest),
    )
