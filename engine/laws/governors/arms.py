"""Mass of a governor's arms: uniform rods in the plane of axis and balls, integrated from end to end.

A point at the share t of a rod lies at the radius a + t (b − a), with a and b those of the ends, and likewise for its
height. The integrals over t are then exact: ∫ r² dm = m (a² + a b + b²)/3, and so for squares of rates. Dashes are
derivatives by the governor's position x, as in `engine.laws.governors.linkages`.

What arms add to two balls of mass m at the radius r counts like a mass at the balls: at constant speed the centrifugal
forces of all do the work ½ ω² J' dx, those of the balls 2 m ω² r r' dx.

Source: L. D. Landau and E. M. Lifshitz, Mechanics, § 32 (kinetic energy and moments of inertia as integrals).
"""

from engine.compiling.decorators import scalar


@scalar
def arm_inertia(
    mass: float,
    near: float,
    near_rate: float,
    near_rate_rate: float,
    far: float,
    far_rate: float,
    far_rate_rate: float,
) -> tuple[float, float, float]:
    """Moment of inertia of a rod about the axis, I = m (a² + a b + b²)/3, and its derivatives.

    Parameters
    ----------
    mass : float
        m [kg].
    near, near_rate, near_rate_rate, far, far_rate, far_rate_rate : float
        Radii of the ends a, b [m], and a', a'', b', b''.

    Returns
    -------
    tuple of 3 floats
        I [kg·m²], I' [kg·m], I'' [kg].
    """
    third = mass / 3.0
    rate = near_rate * (2.0 * near + far) + far_rate * (near + 2.0 * far)
    rate_rate = near_rate_rate * (2.0 * near + far) + far_rate_rate * (near + 2.0 * far)
    squares = near_rate * near_rate + near_rate * far_rate + far_rate * far_rate
    return third * (near * near + near * far + far * far), third * rate, third * (rate_rate + 2.0 * squares)


@scalar
def arm_moving_inertia(
    mass: float, near_rate: float, near_rate_rate: float, far_rate: float, far_rate_rate: float
) -> tuple[float, float]:
    """What a rod's motion along one direction adds to A: m (a'² + a' b' + b'²)/3, and the derivative of that.

    Parameters
    ----------
    mass : float
        m [kg].
    near_rate, near_rate_rate, far_rate, far_rate_rate : float
        a', a'', b', b'' of the ends' radii, or of their heights.

    Returns
    -------
    tuple of 2 floats
        [kg], [kg/m]
    """
    rate = near_rate_rate * (2.0 * near_rate + far_rate) + far_rate_rate * (near_rate + 2.0 * far_rate)
    squares = near_rate * near_rate + near_rate * far_rate + far_rate * far_rate
    return mass / 3.0 * squares, mass / 3.0 * rate
