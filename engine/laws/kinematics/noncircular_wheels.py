"""Non-circular wheels in mesh: rotation of the driven one, pitch curves, and the force between the teeth.

Wheels at the centre distance a roll on each other with the ratio g = dψ/dθ by magnitude, external teeth:

    r₁ = a g/(1 + g)    r₂ = a/(1 + g)

Two equal ellipses that turn about foci have g = (1 − e²)/(1 + e² − 2 e cos θ), tan(ψ/2) = (1 + e)/(1 − e) tan(θ/2).

Sources: F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez, K. Hayasaka, Noncircular Gears: Design and Generation,
Cambridge University Press (2009); I. I. Artobolevsky, Theory of Mechanisms and Machines (forces in higher pairs).
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.elementary import angle_of, direction_of


@scalar
def elliptical_wheels(angle: float, eccentricity: float) -> tuple[float, float, float, float]:
    """Lead of a wheel driven by an ellipse about its focus over uniform rotation [rad], and its rates.

    Parameters
    ----------
    angle : float
        Angle of the driver from its fastest drive, times its number of lobes [rad].
    eccentricity : float
        e, below 1.

    Returns
    -------
    lead : float
        ψ − θ, periodic in a turn.
    rate, slope, bend : float
        First, second and third derivative of ψ by θ.
    """
    c, s = direction_of(angle)
    e = eccentricity
    within = 1.0 + e * e - 2.0 * e * c
    rate = (1.0 - e * e) / within
    slope = -2.0 * e * s * rate / within
    bend = -2.0 * e * (c - 4.0 * e * s * s / within) * rate / within
    return 2.0 * angle_of(1.0 - e * c, e * s), rate, slope, bend


@scalar
def wheel_harmonic(angle: float, order: float, cosine: float, sine: float) -> tuple[float, float, float, float]:
    """Contribution of a harmonic c cos kθ + s sin kθ of the rate to the driven wheel's lead and its rates.

    Parameters
    ----------
    angle : float
        Angle of the driver, times its number of lobes [rad].
    order : float
        Order k.
    cosine, sine : float
        Coefficients c and s, relative to the mean rate.
    """
    c, s = direction_of(order * angle)
    rate, quarter = cosine * c + sine * s, sine * c - cosine * s
    return (cosine * s + sine * (1.0 - c)) / order, rate, order * quarter, -(order * order) * rate


@scalar
def driving_pitch_curve(distance: float, rate: float, slope: float, bend: float) -> tuple[float, float, float]:
    """Pitch curve of the driver: radius at the pitch point, and its first two derivatives by the driver's angle [m].

    Parameters
    ----------
    distance : float
        Centre distance [m].
    rate, slope, bend : float
        First to third derivative of the driven wheel's angle by the driver's, by magnitude.
    """
    whole = 1.0 + rate
    radius = distance * rate / whole
    first = distance * slope / (whole * whole)
    return radius, first, distance * (bend * whole - 2.0 * slope * slope) / (whole * whole * whole)


@scalar
def driven_pitch_curve(distance: float, rate: float, slope: float, bend: float) -> tuple[float, float, float]:
    """Pitch curve of the driven wheel: radius at the pitch point, and its first two derivatives by its own angle [m].

    Parameters are those of `driving_pitch_curve`.
    """
    radius, first, second = driving_pitch_curve(distance, rate, slope, bend)
    return distance - radius, -first / rate, -(second * rate - first * slope) / (rate * rate * rate)


@scalar
def polar_curvature(radius: float, first: float, second: float) -> float:
    """Curvature of a curve r(θ), positive where it is convex as seen from outside [1/m].

    Parameters
    ----------
    radius, first, second : float
        Radius and its derivatives by the angle [m].
    """
    square = radius * radius + first * first
    return (square + first * first - radius * second) / (square * math.sqrt(square))


@scalar
def noncircular_tooth_force(moment: float, lever: float, offset: float, slope: float) -> tuple[float, float]:
    """Force between teeth that balances a moment on a wheel: tangential and separating component [N].

    The normal of a non-circular pitch curve misses the axis, so both components have moments:
    T lever + |T| slope offset = −M.

    Parameters
    ----------
    moment : float
        M, moment of all other loads on the wheel about its axis [N·m].
    lever, offset : float
        Moments about the axis of forces of 1 N along the tangent, and along the normal away from the other wheel [m].
    slope : float
        Tangent of the pressure angle.
    """
    side = 1.0 if moment * lever < 0.0 else -1.0
    tangential = -moment / (lever + side * slope * offset)
    return tangential, slope * abs(tangential)
