"""A wheel in mesh with one on a link whose angle is known as a direction alone, between -180 deg and 180 deg."""

import math

from engine.compiling.decorators import scalar

# 1 − cos of the widest swing to either side: 5 deg less than half a turn.
_WIDEST = 1.0 + math.cos(math.radians(5.0))


@scalar
def geared_turn(cosine: float, sine: float, ratio: float, around: float) -> tuple[float, float]:
    """Angle of a wheel against its carrier, r α, by the direction of what drives it, and whether α is known for it.

    With a whole ratio r any of the angles of a direction gives the same place of the wheel. With another one the
    link that drives it must swing by less than half a turn to either side of an angle that is told.

    Parameters
    ----------
    cosine, sine : float
        Of the driving link's angle α against the carrier.
    ratio : float
        Of the speeds relative to the carrier, r.
    around : float
        About which the driving link swings [rad].

    Returns
    -------
    angle : float
        [rad]
    clear : float
        1 with a whole ratio; otherwise near 1 up to a swing of a quarter turn, and zero 5 deg before half a turn.
    """
    c, s = math.cos(around), math.sin(around)
    along, across = cosine * c + sine * s, sine * c - cosine * s
    clear = 1.0 if ratio == math.floor(ratio) else 1.0 - ((1.0 - along) / _WIDEST) ** 8
    return ratio * (around + math.atan2(across, along)), clear
