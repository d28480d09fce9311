"""Kinematics of a governor's balls and sleeve.

Each law returns eight numbers at a position x of the governor, r and z for one ball and the sleeve:

- r, r', r'': radius of the balls and its derivatives by x;
- h', h'': derivatives of the balls' height;
- z, z', z'': height of the sleeve above a fixed level, and its derivatives.

For governors with arms x is the radius of the joint between upper and lower arm, for those with bell cranks the radius
of the balls. An arm of length l whose end is `across` from its pivot, perpendicular to the axis, extends √(l² −
across²) along the axis; all rates follow from that. Where an arm is too short, results are NaN.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 18; T. Bevan, The Theory of Machines, chapter 10.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def arm_reach(x: float, pivot: float, length: float) -> tuple[float, float, float]:
    """Extent of an arm along the axis, the tangent of its angle to the axis, and the derivative of that tangent.

    Parameters
    ----------
    x, pivot, length : float
        Radius of the arm's end, radius of its pivot, its length [m].

    Returns
    -------
    tuple of 3 floats
        along = √(l² − across²) [m]; across/along; l²/along³ [1/m].
    """
    across = x - pivot
    along = math.sqrt(length * length - across * across)
    return along, across / along, length * length / (along * along * along)


@scalar
def balls_on_upper_arms(
    x: float, upper: float, lower: float, upper_pivot: float, lower_pivot: float, ball_arm: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Watt's and Porter's governors: balls on the upper arms, at their joints with the lower ones or elsewhere.

    Parameters
    ----------
    x : float
        Radius of the joints [m].
    upper, lower : float
        Lengths of the upper arm, from pivot to joint, and of the lower arm, from joint to sleeve [m].
    upper_pivot, lower_pivot : float
        Radii of the pivots on the spindle and on the sleeve; negative where arms cross the axis [m].
    ball_arm : float
        Distance of the ball from the upper pivot, along the upper arm [m].

    Returns
    -------
    tuple of 8 floats
        See the module docstring.
    """
    along, slope, rate = arm_reach(x, upper_pivot, upper)
    lower_along, lower_slope, lower_rate = arm_reach(x, lower_pivot, lower)
    share = ball_arm / upper
    return (
        upper_pivot + share * (x - upper_pivot),
        share,
        0.0,
        share * slope,
        share * rate,
        -along - lower_along,
        slope + lower_slope,
        rate + lower_rate,
    )


@scalar
def balls_on_lower_arms(
    x: float,
    upper: float,
    lower: float,
    upper_pivot: float,
    lower_pivot: float,
    extension: float,
    parallel_radius: float,
) -> tuple[float, float, float, float, float, float, float, float]:
    """Proell's governor: balls on extensions of the lower arms, fixed to them.

    Parameters
    ----------
    x, upper, lower, upper_pivot, lower_pivot : float
        As in `balls_on_upper_arms`.
    extension : float
        Distance of the ball from the joint [m].
    parallel_radius : float
        Radius of balls and joints where the extensions are parallel to the axis [m].

    Returns
    -------
    tuple of 8 floats
        See the module docstring.
    """
    along, slope, rate = arm_reach(x, upper_pivot, upper)
    lower_along, lower_slope, lower_rate = arm_reach(x, lower_pivot, lower)
    # The extension leans outwards by the lower arm's angle minus that angle at the position of parallel extensions.
    sine = (parallel_radius - lower_pivot) / lower
    cosine = math.sqrt(1.0 - sine * sine)
    share = extension / lower
    return (
        x + share * ((x - lower_pivot) * cosine - lower_along * sine),
        1.0 + share * (cosine + lower_slope * sine),
        share * sine * lower_rate,
        slope + share * (sine - lower_slope * cosine),
        rate - share * cosine * lower_rate,
        -along - lower_along,
        slope + lower_slope,
        rate + lower_rate,
    )


@scalar
def balls_on_bell_cranks(
    x: float, ball_arm: float, sleeve_arm: float, pivot: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Hartnell's governor: balls above the pivots of right-angled bell cranks, whose rollers lift the sleeve.

    The roller bears on a flat collar, so the lift is proportional to the radius.

    Parameters
    ----------
    x : float
        Radius of the balls [m].
    ball_arm, sleeve_arm : float
        Lengths of the bell crank's arms [m].
    pivot : float
        Radius of the bell crank's pivot, at which the ball arms are parallel to the axis [m].

    Returns
    -------
    tuple of 8 floats
        See the module docstring.
    """
    _, slope, rate = arm_reach(x, pivot, ball_arm)
    ratio = sleeve_arm / ball_arm
    return x, 1.0, 0.0, -slope, -rate, (x - pivot) * ratio, ratio, 0.0
