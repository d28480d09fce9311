"""Motion of a governor and its engine, by Lagrange's equations for the governor's position x and the engine's angle.

The kinetic energy is ½ A(x) ẋ² + ½ (I + i² J(x)) ω², where J = 2 m r² is the inertia of the balls about the spindle,
which turns i times as fast as the engine with speed ω. Primes are derivatives by x; see
`engine.laws.governors.linkages`:

    A ẍ + ½ A' ẋ² = ½ i² ω² J' − V' − z' (b z' ẋ + F sgn ẋ),   (I + i² J) ω̇ + i² J' ẋ ω = M_d − M_c
"""

import math

from engine.compiling.decorators import scalar


@scalar
def moving_inertia_rate(
    ball_mass: float,
    sleeve_mass: float,
    radius_rate: float,
    radius_rate_rate: float,
    ball_rise: float,
    ball_rise_rate: float,
    lift_rate: float,
    lift_rate_rate: float,
) -> float:
    """A', derivative of `moving_inertia`: 4 m (r' r'' + h' h'') + 2 M z' z'' [kg/m].

    Parameters
    ----------
    ball_mass, sleeve_mass : float
        m, M [kg].
    radius_rate, radius_rate_rate, ball_rise, ball_rise_rate, lift_rate, lift_rate_rate : float
        r', r'', h', h'', z', z''.

    Returns
    -------
    float
    """
    balls = radius_rate * radius_rate_rate + ball_rise * ball_rise_rate
    return 4.0 * ball_mass * balls + 2.0 * sleeve_mass * lift_rate * lift_rate_rate


@scalar
def governor_acceleration(driving: float, inertia: float, inertia_rate: float, velocity: float) -> float:
    """ẍ of a governor: (Q − ½ A' ẋ²)/A, with Q the sum of the generalised forces on x [m/s²]."""
    return (driving - 0.5 * inertia_rate * velocity * velocity) / inertia


@scalar
def engine_acceleration(moment: float, inertia: float, whirl_rate: float, velocity: float, speed: float) -> float:
    """ω̇ of an engine: (M_d − M_c − i² J' ẋ ω)/(I + i² J) [rad/s²].

    Parameters
    ----------
    moment, inertia, whirl_rate : float
        M_d − M_c [N·m], I + i² J [kg·m²], i² J' [kg·m].
    velocity, speed : float
        ẋ [m/s], ω [rad/s].

    Returns
    -------
    float
    """
    return (moment - whirl_rate * velocity * speed) / inertia


@scalar
def time_to_speed(speed: float, target: float, moment: float, self_regulation: float, inertia: float) -> float:
    """Time in which an engine changes from one speed to another while its sleeve is held.

    The torque changes by −s (ω̃ − ω) with the speed.

    Parameters
    ----------
    speed, target : float
        [rad/s]
    moment : float
        M_d − M_c at the initial speed [N·m].
    self_regulation, inertia : float
        s [N·m·s/rad], I + i² J [kg·m²].

    Returns
    -------
    float
        [s]; infinite if the target is never reached.
    """
    change = target - speed
    if change == 0.0:
        return 0.0
    if moment * change <= 0.0:
        return math.inf
    if self_regulation == 0.0:
        return inertia * change / moment
    share = self_regulation * change / moment
    return -inertia / self_regulation * math.log1p(-share) if share < 1.0 else math.inf


@scalar
def speed_after(speed: float, time: float, moment: float, self_regulation: float, inertia: float) -> float:
    """Speed of an engine after some time with its sleeve held [rad/s].

    Parameters
    ----------
    speed, time : float
        [rad/s], [s]
    moment, self_regulation, inertia : float
        As in `time_to_speed`.

    Returns
    -------
    float
    """
    if self_regulation == 0.0:
        return speed + moment * time / inertia
    return speed - moment / self_regulation * math.expm1(-self_regulation * time / inertia)
