"""Senses and sides: signs that select one of several smooth characteristics. Scalar functions, NaN for NaN."""

import math

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen
from engine.laws.elementary import angle_of

# Distance from a zero of b within which a position counts as the zero, and within which a zero of a coincides with it
# [rad or m].
_AT_ZERO, _COMMON_ZERO = 1e-12, 1e-9


@scalar
def sense(v: float) -> float:
    """Sense of a motion: +1, −1, or 0 at rest.

    Parameters
    ----------
    v : float
        Velocity [m/s or rad/s].
    """
    if v > 0.0:
        return 1.0
    if v < 0.0:
        return -1.0
    return v


@scalar
def past(guard: float, before: float, behind: float) -> float:
    """One of two numbers: that before a guard's zero, where the guard is positive, or that after it."""
    return chosen(guard > 0.0, before, behind)


@scalar
def side(s: float) -> float:
    """Side of the x axis to which a direction points: +1 above or along it, −1 below.

    Parameters
    ----------
    s : float
        Sine of the direction's angle.
    """
    if s >= 0.0:
        return 1.0
    if s < 0.0:
        return -1.0
    return s


@scalar
def angle_on_side(above: float, c: float, s: float) -> float:
    """Angle of a direction, measured from the y axis so that it is smooth across the x axis.

    The angle in (−π, π] jumps where a direction crosses the negative x axis. With `above` held constant it continues
    beyond either end of its half turn.

    Parameters
    ----------
    above : float
        From `side`.
    c, s : float
        Cosine and sine of the angle.

    Returns
    -------
    float
        θ [rad], above · π/2 + atan2(−above · c, above · s).
    """
    return above * (0.5 * math.pi) + angle_of(above * s, -above * c)


@scalar
def exceeds(a: float, b: float) -> float:
    """1 if a > b, else 0; NaN if either is NaN.

    Parameters
    ----------
    a, b : float
    """
    above = 1.0 if a > b else 0.0
    return above if (a == a) & (b == b) else a - b


@scalar
def kept_positive(forward: float, x: float) -> float:
    """A number of known sign as the argument of a power or root: a value that rounding puts below 0 becomes 0.

    Parameters
    ----------
    forward : float
        Sense of the number, from `sense`.
    x : float

    Returns
    -------
    float
        NaN for a negative sense.
    """
    found = 0.0 if x < 0.0 else x
    return found if forward >= 0.0 else math.nan


@scalar
def either(condition: float, a: float, b: float) -> float:
    """Select a where a condition is 1, b where it is 0; NaN for a NaN condition.

    Parameters
    ----------
    condition : float
    a, b : float
        The number that isn't selected may be NaN or infinite.
    """
    found = chosen(condition > 0.5, a, b)
    return found if condition == condition else condition


@scalar
def quotient(on: float, a: float, a_rate: float, b: float, b_rate: float) -> float:
    """a/b along a motion; NaN at a pole, where b vanishes and a doesn't.

    At a zero of b, rounding of the position leaves b uncertain by its derivative times that rounding. Where a vanishes
    too, as in v/|v|, the quotient is that of the derivatives.

    Parameters
    ----------
    on : float
        Sign of b next to the position.
    a, b : float
    a_rate, b_rate : float
        Their derivatives by the position [1/rad or 1/m].
    """
    of_rates = chosen(abs(a) <= _COMMON_ZERO * abs(a_rate), a_rate / b_rate, math.nan)
    return chosen(on * b <= _AT_ZERO * abs(b_rate), of_rates, a / b)
