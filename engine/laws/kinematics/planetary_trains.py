"""Wheels on a carrier, by Willis: relative to the carrier they turn like an ordinary train."""

from typing import TypeVar

Value = TypeVar("Value")


def willis(ratio: Value, driver: Value, carrier: Value) -> Value:
    """Speed, acceleration or angle of a wheel, ω = ω_h + r (ω_driver − ω_h); numbers, arrays or nodes.

    Parameters
    ----------
    ratio : float
        Ratio r of the speeds relative to the carrier.
    driver, carrier : float
        Speeds of the driving wheel and of the carrier.
    """
    return carrier + ratio * (driver - carrier)
