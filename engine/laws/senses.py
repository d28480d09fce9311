"""Senses and sides: signs that tell which of several smooth characteristics holds. Scalar functions, NaN for NaN."""

import math

from engine.compiling.decorators import scalar
from engine.laws.elementary import angle_of


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
