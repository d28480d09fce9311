"""The inclined plane, the friction cone and the wedge.

Two surfaces whose slope t = tan(alpha) doesn't exceed f = tan(phi) lock by themselves: no force within the friction
cone, at phi or less from the normal, moves one on the other, however great it is. Tangents of sums of angles are
taken from t and f, tan(alpha + phi) = (t + f)/(1 - t f), so that without friction, and at the limit of
self-locking, nothing is left but rounding.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, friction in kinematic pairs; R. S. Khurmi and
J. K. Gupta, Theory of Machines, chapter 10.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def push_up(load: float, slope: float, friction: float) -> float:
    """Horizontal force that moves a load up a slope: Q tan(alpha + phi).

    Parameters
    ----------
    load, slope, friction : float
        Q [N], tan(alpha), f.

    Returns
    -------
    float
        [N]; infinite where it jams, alpha + phi >= 90 degrees.
    """
    left = 1 - slope * friction
    return load * (slope + friction) / left if left > 0.0 else math.inf


@scalar
def push_down(load: float, slope: float, friction: float) -> float:
    """Horizontal force that moves a load down a slope: Q tan(phi - alpha).

    Parameters
    ----------
    load, slope, friction : float
        Q [N], tan(alpha), f.

    Returns
    -------
    float
        [N]; negative where the load would slide by itself and has to be held.
    """
    return load * (friction - slope) / (1 + slope * friction)


@scalar
def self_locking(slope: float, friction: float) -> float:
    """1 where a load stays on a slope by itself, tan(alpha) <= f, otherwise 0.

    Parameters
    ----------
    slope, friction : float
        tan(alpha), f (the static one).
    """
    return 1.0 if slope <= friction else 0.0


@scalar
def incline_up(load: float, angle: float, friction: float, pull_angle: float) -> float:
    """Force that moves a load up an inclined plane: P = Q sin(alpha + phi)/cos(beta - phi), least at beta = phi.

    Parameters
    ----------
    load, angle, friction : float
        Q [N], alpha [rad], f.
    pull_angle : float
        beta, of the pull above the plane [rad], between -pi/2 and pi/2; -alpha for a horizontal one.

    Returns
    -------
    float
        P [N]; infinite where the push jams, beta <= phi - 90 degrees, NaN where the pull lifts the load off the
        plane, alpha + beta >= 90 degrees.
    """
    if not _stays_on(angle, pull_angle):
        return math.nan
    left = math.cos(pull_angle) + friction * math.sin(pull_angle)
    return load * (math.sin(angle) + friction * math.cos(angle)) / left if left > 0.0 else math.inf


@scalar
def incline_down(load: float, angle: float, friction: float, pull_angle: float) -> float:
    """Force that moves a load down an inclined plane: P = Q sin(phi - alpha)/cos(beta + phi).

    Parameters
    ----------
    load, angle, friction : float
        Q [N], alpha [rad], f.
    pull_angle : float
        beta [rad]: P acts on the line of `incline_up`, the other way round.

    Returns
    -------
    float
        P [N]; negative where the load has to be held, by a pull of -P. Infinite where the push jams, NaN where the
        pull lifts the load off the plane or, too steep, can't hold it.
    """
    if not _stays_on(angle, pull_angle):
        return math.nan
    needed = load * (friction * math.cos(angle) - math.sin(angle))
    left = math.cos(pull_angle) - friction * math.sin(pull_angle)
    if left <= 0.0:
        return math.inf if needed > 0.0 else math.nan
    return needed / left


@scalar
def _stays_on(angle: float, pull_angle: float) -> bool:
    """Whether a load that slides evenly is pressed on the plane."""
    return math.cos(angle + pull_angle) > 0.0


@scalar
def wedge_drive(load: float, slope: float, friction: float, base_friction: float, guide_friction: float) -> float:
    """Force that drives a wedge under a load that is guided at a right angle to the wedge's base.

    Without a guide's friction it is Q (tan(alpha + phi) + f2); with it
    Q cos(phi3) sin(alpha + phi + phi2)/(cos(phi2) cos(alpha + phi + phi3)).

    Parameters
    ----------
    load, slope : float
        Q [N], tan of the wedge's angle alpha.
    friction, base_friction, guide_friction : float
        f of the inclined face, of the base, and of the guide that takes the side thrust.

    Returns
    -------
    float
        [N]; infinite where it jams.
    """
    thrust = push_up(1.0, slope, friction)
    left = 1 - guide_friction * thrust
    return load * (thrust + base_friction) / left if left > 0.0 else math.inf


@scalar
def wedge_withdraw(load: float, slope: float, friction: float, base_friction: float, guide_friction: float) -> float:
    """Force that withdraws a wedge from under its load.

    Without a guide's friction it is Q (tan(phi - alpha) + f2).

    Parameters
    ----------
    load, slope, friction, base_friction, guide_friction : float
        As for `wedge_drive`.

    Returns
    -------
    float
        [N]; negative where the wedge would be pressed out by itself and has to be held.

    Notes
    -----
    The side thrust changes its side at alpha = phi; the guide's friction carries part of the load either way.
    """
    thrust = push_down(1.0, slope, friction)
    return load * (thrust + base_friction) / (1 + guide_friction * abs(thrust))
