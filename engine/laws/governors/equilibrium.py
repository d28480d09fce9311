"""What holds the balls of a governor, and the speed at which it does, by virtual work at a position x.

With two balls of mass m at radius r on a spindle that turns at ω, the centrifugal forces do the work 2 m ω² r dr, and
whatever holds the balls takes up the potential V: ω² 2 m r r' = V'. Dashes are derivatives by x; see
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
        Weight of the sleeve with its load, and force of the spring [N].
    stiffness : float
        That of the spring [N/m].
    ball_rise, ball_rise_rate, lift_rate, lift_rate_rate : float
        h', h'', z', z''.

    Returns
    -------
    tuple of 2 floats
        Of a coordinate in metres [N], [N/m].
    """
    slope = 2.0 * ball_weight * ball_rise + sleeve_load * lift_rate
    return slope, 2.0 * ball_weight * ball_rise_rate + sleeve_load * lift_rate_rate + stiffness * lift_rate * lift_rate


@scalar
def controlling_force(potential_slope: float, radius_rate: float) -> float:
    """Controlling force of one ball: V'/(2 r') [N]."""
    return potential_slope / (2.0 * radius_rate)


@scalar
def equilibrium_speed(force: float, mass: float, radius: float) -> float:
    """Speed of the spindle at which balls of a mass keep their radius: √(F_c/(m r)) [rad/s]."""
    return math.sqrt(force / (mass * radius))


@scalar
def sleeve_equivalent(potential_slope: float, lift_rate: float) -> float:
    """Force at the sleeve that does what holds the balls: E = V'/z' [N]."""
    return potential_slope / lift_rate


@scalar
def stability_margin(
    radius: float,
    radius_rate: float,
    radius_rate_rate: float,
    potential_slope: float,
    potential_curvature: float,
) -> float:
    """How steeply the square of the speed in equilibrium rises with the radius: (dω²/dr)/(ω²/r).

    Above 0 the governor is stable, at 0 isochronous: the speed is the same at neighbouring radii. It is how steep the
    controlling force is against a ray from the origin, (dF_c/dr)/(F_c/r) − 1.

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
    """Speed at which the sleeve begins to move against friction: ω √(1 + F/E).

    Parameters
    ----------
    speed, friction, force : float
        ω without friction [rad/s]; F at the sleeve, negative where it holds a falling sleeve up; E [N].

    Returns
    -------
    float
        [rad/s]; NaN where friction holds the sleeve at any speed.
    """
    return speed * math.sqrt(1.0 + friction / force)


@scalar
def insensitivity_by_friction(friction: float, force: float) -> float:
    """Range of speeds within which friction holds the sleeve, as a share: √(1 + F/E) − √(1 − F/E), about F/E."""
    return math.sqrt(1.0 + friction / force) - math.sqrt(1.0 - friction / force)


@scalar
def sleeve_stiffness(force: float, margin: float, radius: float, radius_rate: float, lift_rate: float) -> float:
    """Force at the sleeve for each metre of lift at constant speed: c = E μ r'/(r z') [N/m].

    It is (V'' − ½ ω² J'')/z'² with J = 2 m r² + J_a and the ω of equilibrium.

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
    """Inertia A of the governor's own motion, of kinetic energy ½ A ẋ²: 2 m (r'² + h'²) + M z'² [kg]."""
    balls = radius_rate * radius_rate + ball_rise * ball_rise
    return 2.0 * ball_mass * balls + sleeve_mass * lift_rate * lift_rate
