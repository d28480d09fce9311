"""Stability of an engine with its governor: the linearised equation of third order.

A sleeve with mass m, stiffness c and damping b, on which a speed deviation ω̃ acts with f ω̃, governs an engine of
inertia I whose torque falls by K per metre of lift and by s per rad/s:

    m z̈ + b ż + c z = f ω̃,   I ω̃' = −K z − s ω̃ − f ż

The term f ż is the angular momentum taken up by balls that move outwards. Textbooks omit it: f² below is small compared
with I c unless the governor is as heavy as the engine's flywheel. The characteristic polynomial is

    I m λ³ + (I b + s m) λ² + (I c + s b + f²) λ + (s c + K f)

Sources: I. A. Vyshnegradsky, Sur la théorie générale des régulateurs, C. R. Acad. Sci. 83 (1876); A. Hurwitz (1895);
T. Bevan, The Theory of Machines, chapter 10.
"""

import math

from engine.compiling.decorators import scalar
from engine.laws.rounding import MOST_TURNS, newton_between


@scalar
def governed_polynomial(
    inertia: float, mass: float, damping: float, stiffness: float, self_regulation: float, lift_gain: float, pull: float
) -> tuple[float, float, float, float]:
    """Coefficients of the characteristic polynomial, highest power first.

    Parameters
    ----------
    inertia, mass, damping, stiffness, self_regulation, lift_gain, pull : float
        I, m, b, c, s, K and f of the module's equations.

    Returns
    -------
    tuple of 4 floats
    """
    return (
        inertia * mass,
        inertia * damping + self_regulation * mass,
        inertia * stiffness + self_regulation * damping + pull * pull,
        self_regulation * stiffness + lift_gain * pull,
    )


@scalar
def vyshnegradsky(a3: float, a2: float, a1: float, a0: float) -> tuple[float, float, float]:
    """Vyshnegradsky's parameters X and Y, and their unit of time τ.

    In units of τ = (a3/a0)^⅓ the polynomial is λ³ + X λ² + Y λ + 1. It is stable for X Y > 1, X > 0.

    Parameters
    ----------
    a3, a2, a1, a0 : float
        Coefficients; a0 must be positive.

    Returns
    -------
    tuple of 3 floats
        X, Y, τ [s].
    """
    time = (a3 / a0) ** (1.0 / 3.0)
    return a2 / a3 * time, a1 / a3 * time * time, time


@scalar
def oscillates(x: float, y: float) -> bool:
    """Whether λ³ + X λ² + Y λ + 1 has a pair of complex roots: X²Y² − 4 (X³ + Y³) + 18 X Y − 27 < 0."""
    return x * x * y * y - 4.0 * (x * x * x + y * y * y) + 18.0 * x * y - 27.0 < 0.0


@scalar
def normal_roots(x: float, y: float) -> tuple[float, float, float]:
    """Roots of λ³ + X λ² + Y λ + 1 for X, Y ≥ 0.

    Parameters
    ----------
    x, y : float

    Returns
    -------
    real : float
        The root that is always real, below 0.
    middle, square : float
        The other roots are middle ± √square.
    """
    # The reversed polynomial has the reciprocal roots; one of the two has its real root between −1 and 0.
    backwards = x > y
    p, q = (y, x) if backwards else (x, y)
    low, high = -1.0, 0.0
    root = -1.0 / (1.0 + q)
    for _ in range(MOST_TURNS):
        value, slope = ((root + p) * root + q) * root + 1.0, (3.0 * root + 2.0 * p) * root + q
        root, low, high, settled = newton_between(root, value, slope, True, low, high)
        if settled:
            break
    real = 1.0 / root if backwards else root
    # The remaining factor is λ² + t λ − 1/real with t = X + real; where X and −real are large and nearly equal, t comes
    # from Y.
    total = (-1.0 / real - y) / real if backwards else x + real
    middle = -0.5 * total
    return real, middle, middle * middle + 1.0 / real


@scalar
def most_gain(
    inertia: float, mass: float, damping: float, stiffness: float, self_regulation: float, pull: float
) -> float:
    """Gain K at which the engine with its governor starts to hunt, by Hurwitz; 0 if it hunts at any gain.

    Parameters
    ----------
    inertia, mass, damping, stiffness, self_regulation, pull : float
        I, m, b, c, s and f of the module's equations.

    Returns
    -------
    float
        [N]
    """
    a2 = inertia * damping + self_regulation * mass
    a1 = inertia * stiffness + self_regulation * damping + pull * pull
    return max((a2 * a1 / (inertia * mass) - self_regulation * stiffness) / pull, 0.0)


@scalar
def critical_damping_of_sleeve(
    inertia: float, mass: float, stiffness: float, self_regulation: float, lift_gain: float, pull: float
) -> float:
    """Minimum damping b at the sleeve for which the engine doesn't hunt; m K f/(I c) without s and f².

    Hurwitz' condition as an equation for b: I s b² + (I (I c + f²) + s² m) b + m (s f² − I K f) = 0.

    Parameters
    ----------
    inertia, mass, stiffness, self_regulation, lift_gain, pull : float
        I, m, c, s, K and f of the module's equations.

    Returns
    -------
    float
        [N s/m]; 0 if none is needed, infinite if none suffices.
    """
    constant = mass * (inertia * lift_gain * pull - self_regulation * pull * pull)
    if constant <= 0.0:
        return 0.0
    square = inertia * self_regulation
    linear = inertia * (inertia * stiffness + pull * pull) + self_regulation * self_regulation * mass
    return 2.0 * constant / (linear + math.sqrt(linear * linear + 4.0 * square * constant))


@scalar
def critical_inertia_of_engine(
    mass: float, damping: float, stiffness: float, self_regulation: float, lift_gain: float, pull: float
) -> float:
    """Minimum inertia I for which the engine doesn't hunt; m K f/(b c) without s and f².

    Hurwitz' condition as an equation for I: b c I² + (s b² + b f² − m K f) I + s m (s b + f²) = 0.

    Parameters
    ----------
    mass, damping, stiffness, self_regulation, lift_gain, pull : float
        m, b, c, s, K and f of the module's equations.

    Returns
    -------
    float
        [kg·m²]; 0 if any inertia suffices, infinite if none does.
    """
    square = damping * stiffness
    needed = mass * lift_gain * pull - self_regulation * damping * damping - damping * pull * pull
    constant = self_regulation * mass * (self_regulation * damping + pull * pull)
    if needed <= 0.0:
        return 0.0
    discriminant = needed * needed - 4.0 * square * constant
    if discriminant < 0.0:
        return 0.0
    return (needed + math.sqrt(discriminant)) / (2.0 * square)


@scalar
def stability_with_engine(
    engine: float, mass: float, b: float, stiffness: float, s: float, gain: float, pull: float, balls: float
) -> tuple[float, float, float, float, float, float, float, float, float]:
    """Results of the linearized equation of an engine and its governor.

    Vyshnegradsky's X and Y; 1 if stable; gain margin; critical damping and inertia; rate of decay; angular frequency; 1
    if disturbances oscillate.
    """
    inertia = engine + balls
    a3, a2, a1, a0 = governed_polynomial(inertia, mass, b, stiffness, s, gain, pull)
    x, y, time = vyshnegradsky(a3, a2, a1, a0)
    real, middle, square = normal_roots(x, y)
    slowest = max(real, middle + max(square, 0.0) ** 0.5)
    return (
        x,
        y,
        1.0 if x * y > 1.0 else 0.0,
        most_gain(inertia, mass, b, stiffness, s, pull) / gain,
        critical_damping_of_sleeve(inertia, mass, stiffness, s, gain, pull),
        max(critical_inertia_of_engine(mass, b, stiffness, s, gain, pull) - balls, 0.0),
        -slowest / time,
        max(-square, 0.0) ** 0.5 / time,
        1.0 if oscillates(x, y) else 0.0,
    )
