"""Non-circular wheels in mesh: how the driven one turns, pitch curves, and the force between the teeth.

Wheels at the distance a roll on each other where they turn at the ratio g = dψ/dθ by magnitude, teeth outside:

    r₁ = a g/(1 + g)    r₂ = a/(1 + g)

Two equal ellipses that turn about foci give g = (1 − e²)/(1 + e² − 2 e cos θ), tan(ψ/2) = (1 + e)/(1 − e) tan(θ/2).

Sources: F. L. Litvin, A. Fuentes-Aznar, I. Gonzalez-Perez, K. Hayasaka, Noncircular Gears: Design and Generation,
Cambridge University Press (2009); I. I. Artobolevsky, Theory of Mechanisms and Machines (forces in higher pairs).
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.elementary import angle_of, direction_of


@scalar
def elliptical_wheels(angle: float, eccentricity: float) -> tuple[float, float, float, float]:
    """How far a wheel driven by an ellipse about its focus leads an even motion [rad], and its rates.

    Parameters
    ----------
    angle : float
        Of the driver from where it drives fastest, times its number of lobes [rad].
    eccentricity : float
        Below 1.

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
    """What a harmonic c cos kθ + s sin kθ of the rate adds to the lead of the driven wheel and to its rates.

    Parameters
    ----------
    angle : float
        Of the driver, times its number of lobes [rad].
    order : float
        Its number k.
    cosine, sine : float
        Its coefficients, as shares of the mean rate.
    """
    c, s = direction_of(order * angle)
    rate, quarter = cosine * c + sine * s, sine * c - cosine * s
    return (cosine * s + sine * (1.0 - c)) / order, rate, order * quarter, -(order * order) * rate


@scalar
def driving_pitch_curve(distance: float, rate: float, slope: float, bend: float) -> tuple[float, float, float]:
    """Pitch curve of the driver: its radius at the pitch point, and two derivatives of that by its angle [m].

    Parameters
    ----------
    distance : float
        Of the axes [m].
    rate, slope, bend : float
        First to third derivative of the driven wheel's angle by the driver's, by magnitude.
    """
    whole = 1.0 + rate
    radius = distance * rate / whole
    first = distance * slope / (whole * whole)
    return radius, first, distance * (bend * whole - 2.0 * slope * slope) / (whole * whole * whole)


@scalar
def driven_pitch_curve(distance: float, rate: float, slope: float, bend: float) -> tuple[float, float, float]:
    """Pitch curve of the driven wheel: its radius, and two derivatives of that by its own angle [m].

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
        The radius and its derivatives by the angle [m].
    """
    square = radius * radius + first * first
    return (square + first * first - radius * second) / (square * math.sqrt(square))


@scalar
def noncircular_tooth_force(moment: float, lever: float, offset: float, slope: float) -> tuple[float, float]:
    """Force between teeth that balances a moment on a wheel: along the common tangent, and what pushes apart [N].

    Off a circle the normal of the pitch curve passes beside the axis, so that both components have moments:
    T lever + |T| slope offset = −M.

    Parameters
    ----------
    moment : float
        M, of all else on the wheel about its axis [N·m].
    lever, offset : float
        Moments about the axis of forces of 1 N along the tangent, and along the normal away from the other wheel [m].
    slope : float
        Tangent of the pressure angle.
    """
    side = 1.0 if moment * lever < 0.0 else -1.0
    tangential = -moment / (lever + side * slope * offset)
    return tangential, slope * abs(tangential)
