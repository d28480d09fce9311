"""Senses and sides: signs that tell which of several smooth characteristics holds. Scalar functions, NaN for NaN."""

import math

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen
from engine.laws.elementary import angle_of

# Places nearer to a zero than this [rad or m] can't be told from it; so much beyond, what vanishes with it is small.
_NEAR_ZERO, _NEAR_TOO = 1e-12, 1e-9


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
def side(s: float) -> float:
    """Side of the x axis on which a direction points: +1 above it or on it, −1 below.

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
    """Angle of a direction, smooth across the x axis too: measured from the y axis and back.

    The angle in (−π, π] jumps where a direction passes the negative x axis. With the side held it goes on beyond
    either end of its half turn.

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
    """1 where one number is above another, else 0; NaN where either is not known.

    Parameters
    ----------
    a, b : float
    """
    above = 1.0 if a > b else 0.0
    return above if (a == a) & (b == b) else a - b


@scalar
def kept_positive(forward: float, x: float) -> float:
    """A number whose sign is known, as a power or a root takes it: what rounding puts below 0 is 0.

    Parameters
    ----------
    forward : float
        The number's sense, from `sense`.
    x : float

    Returns
    -------
    float
        NaN for numbers that are negative by their sense.
    """
    found = 0.0 if x < 0.0 else x
    return found if forward >= 0.0 else math.nan


@scalar
def either(condition: float, a: float, b: float) -> float:
    """One of two numbers: the first where a condition is 1, the second where it is 0.

    Parameters
    ----------
    condition : float
    a, b : float
        Each may be anything where the other holds, infinite as well.
    """
    found = chosen(condition > 0.5, a, b)
    return found if condition == condition else condition


@scalar
def quotient(on: float, a: float, a_rate: float, b: float, b_rate: float) -> float:
    """a/b along a motion; NaN at a pole, where b vanishes and a doesn't.

    At a zero of b a place is known to so many digits that b may be any value up to its derivative times their
    rounding. Where a vanishes with b, as in v/|v|, the quotient is that of the derivatives.

    Parameters
    ----------
    on : float
        Sign of b beside the place.
    a, b : float
    a_rate, b_rate : float
        Their derivatives by the place [1/rad or 1/m].
    """
    beside = chosen(abs(a) <= _NEAR_TOO * abs(a_rate), a_rate / b_rate, math.nan)
    return chosen(on * b <= _NEAR_ZERO * abs(b_rate), beside, a / b)
