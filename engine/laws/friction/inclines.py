"""The inclined plane, the friction cone and the wedge.

Two surfaces with slope t = tan(alpha) not above f = tan(phi) are self-locking: a force inside the friction cone, within
phi of the normal, cannot slide one on the other, however large it is. Tangents of sums of angles are computed from t
and f, tan(alpha + phi) = (t + f)/(1 - t f), so that without friction, and at the limit of self-locking, only rounding
is left.

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
        [N]; negative where the load would slide down and must be held.
    """
    return load * (friction - slope) / (1 + slope * friction)


@scalar
def self_locking(slope: float, friction: float) -> float:
    """1 if a slope is self-locking, tan(alpha) <= f, otherwise 0.

    Parameters
    ----------
    slope, friction : float
        tan(alpha), f (the static one).
    """
    return 1.0 if slope <= friction else 0.0


@scalar
def incline_up(load: float, angle: float, friction: float, pull_angle: float) -> float:
    """Force that moves a load up an inclined plane: P = Q sin(alpha + phi)/cos(beta - phi), minimum at beta = phi.

    Parameters
    ----------
    load, angle, friction : float
        Q [N], alpha [rad], f.
    pull_angle : float
        beta, angle of the pull above the plane [rad], between -pi/2 and pi/2; -alpha for a horizontal pull.

    Returns
    -------
    float
        P [N]; infinite where the push jams, beta <= phi - 90 degrees, NaN where the pull lifts the load off the plane,
        alpha + beta >= 90 degrees.
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
        beta [rad]: P acts along the line of `incline_up`, in the opposite direction.

    Returns
    -------
    float
        P [N]; negative where the load must be held, by a pull of -P. Infinite where the push jams, NaN where the pull
        lifts the load off the plane or is too steep to hold it.
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
    """Whether a uniformly sliding load is pressed on the plane."""
    return math.cos(angle + pull_angle) > 0.0


@scalar
def wedge_drive(load: float, slope: float, friction: float, base_friction: float, guide_friction: float) -> float:
    """Force that drives a wedge under a load that is guided perpendicular to the wedge's base.

    Without friction in the guide it is Q (tan(alpha + phi) + f2), otherwise
    Q cos(phi3) sin(alpha + phi + phi2)/(cos(phi2) cos(alpha + phi + phi3)).

    Parameters
    ----------
    load, slope : float
        Q [N], tangent of the wedge angle alpha.
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

    Without friction in the guide it is Q (tan(phi - alpha) + f2).

    Parameters
    ----------
    load, slope, friction, base_friction, guide_friction : float
        As in `wedge_drive`.

    Returns
    -------
    float
        [N]; negative where the load would press the wedge out, so that it must be held.

    Notes
    -----
    The side thrust reverses at alpha = phi; the guide's friction carries part of the load in either case.
    """
    thrust = push_down(1.0, slope, friction)
    return load * (thrust + base_friction) / (1 + guide_friction * abs(thrust))


@scalar
def wedge(load: float, angle: float, friction: float, base: float, guide: float) -> tuple[float, float, float, float]:
    """Wedge: its results in order."""
    slope = math.tan(angle)
    drive, withdraw = (
        wedge_drive(load, slope, friction, base, guide),
        wedge_withdraw(load, slope, friction, base, guide),
    )
    return drive, withdraw, load * slope / drive, 0.0 if withdraw < 0.0 else 1.0


@scalar
def incline(
    load: float, angle: float, friction: float, static: float, pull_angle: float
) -> tuple[float, float, float, float, float, float]:
    """Incline: its results in order."""
    up = incline_up(load, angle, friction, pull_angle)
    return (
        math.atan(friction),
        up,
        incline_up(load, angle, static, pull_angle),
        incline_down(load, angle, friction, pull_angle),
        load * math.sin(angle) / (up * math.cos(pull_angle)),
        self_locking(math.tan(angle), static),
    )
