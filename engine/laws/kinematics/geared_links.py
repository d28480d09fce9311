"""Wheels on a carrier, in mesh with wheels on other links."""

import math
from typing import TypeVar

from engine.compiling.decorators import scalar
from engine.laws.elementary import angle_of, direction_of

Value = TypeVar("Value")

# 1 − cos of the widest swing to either side: 5 deg less than half a turn.
_WIDEST = 1.0 + math.cos(math.radians(5.0))


def willis(ratio: Value, driver: Value, carrier: Value) -> Value:
    """Speed, acceleration or angle of a wheel, ω = ω_h + r (ω_driver − ω_h); numbers, arrays or nodes.

    Relative to its carrier it turns like a wheel of an ordinary train.

    Parameters
    ----------
    ratio : float
        Ratio r of the speeds relative to the carrier.
    driver, carrier : float
        Speeds of the driving wheel and of the carrier.
    """
    return carrier + ratio * (driver - carrier)


@scalar
def geared_turn(cosine: float, sine: float, ratio: float, around: float) -> tuple[float, float]:
    """Angle of a wheel relative to its carrier, r α, from the direction of its driver, and a margin for its uniqueness.

    The driving link's angle is known only as a direction, between -180 deg and 180 deg. With an integer ratio r any
    angle of a direction gives the same position of the wheel. With any other ratio the driving link must swing by less
    than half a turn to either side of a given angle.

    Parameters
    ----------
    cosine, sine : float
        Cosine and sine of the driving link's angle α relative to the carrier.
    ratio : float
        Ratio r of the speeds relative to the carrier.
    around : float
        Angle about which the driving link swings [rad].

    Returns
    -------
    angle : float
        [rad]
    clear : float
        1 for an integer ratio; otherwise near 1 up to a swing of a quarter turn, and zero 5 deg before half a turn.
    """
    c, s = direction_of(around)
    along, across = cosine * c + sine * s, sine * c - cosine * s
    clear = 1.0 if ratio == math.floor(ratio) else 1.0 - ((1.0 - along) / _WIDEST) ** 8
    return ratio * (around + angle_of(along, across)), clear
