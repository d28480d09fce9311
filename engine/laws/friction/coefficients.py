"""Coefficients of friction: of material pairs, and as a function of sliding speed.

Amontons and Coulomb: F = f N against the sliding, f = friction. At rest friction takes any value up to f_s N.

Sources: the ranges of engineering practice as printed in courses of the theory of mechanisms and machines; static and
kinetic values: P. P. Urone and R. Hinrichs, College Physics (OpenStax), table 5.1. Speed: R. Stribeck, 1902, in the
form of B. Armstrong-Hélouvry, Control of Machines with Friction.
"""

import math
from collections.abc import Mapping
from types import MappingProxyType
from typing import NamedTuple

from engine.compiling.decorators import scalar
from engine.laws.elementary import exponential, power

# Ratio of the sum of pressures to the load on a half-round seat: a worn-in lining presses with the cosine of the angle
# from its middle, a new one evenly.
WORN_IN = 4 / math.pi
NEW = math.pi / 2
# The same ratio by the name of the contact; on a line it is 1.
BUSHES = {"line": 1.0, "new": NEW, "worn in": WORN_IN, "half-round, new": NEW, "half-round, worn in": WORN_IN}
# Exponent of Stribeck's curve in its Gaussian form.
GAUSS = 2.0


class CoefficientRange(NamedTuple):
    """Usual minimum and maximum coefficient of sliding friction of two materials."""

    low: float
    high: float


class FrictionCoefficients(NamedTuple):
    """Static and kinetic coefficient of friction of two materials."""

    static: float
    kinetic: float


SLIDING: Mapping[str, CoefficientRange] = MappingProxyType(
    {
        "steel on steel": CoefficientRange(0.18, 0.18),
        "cast iron on steel": CoefficientRange(0.20, 0.20),
        "steel on wood": CoefficientRange(0.40, 0.40),
        "wood on wood": CoefficientRange(0.4, 0.7),
        "brake lining on metal": CoefficientRange(0.3, 0.8),
        "rubber on steel": CoefficientRange(0.6, 0.8),
    }
)

STATIC_AND_KINETIC: Mapping[str, FrictionCoefficients] = MappingProxyType(
    {
        "steel on steel, dry": FrictionCoefficients(0.6, 0.3),
        "steel on steel, oiled": FrictionCoefficients(0.05, 0.03),
        "PTFE on steel": FrictionCoefficients(0.04, 0.04),
        "wood on wood": FrictionCoefficients(0.5, 0.3),
        "metal on wood": FrictionCoefficients(0.5, 0.3),
        "rubber on concrete, dry": FrictionCoefficients(1.0, 0.7),
        "rubber on concrete, wet": FrictionCoefficients(0.7, 0.5),
        "steel on ice": FrictionCoefficients(0.4, 0.02),
    }
)


@scalar
def stribeck(static: float, kinetic: float, speed: float, stribeck_speed: float, exponent: float) -> float:
    """Coefficient of friction at a sliding speed: f_k + (f_s - f_k) e^(-(|v|/v_s)^d).

    Parameters
    ----------
    static, kinetic : float
        f_s at rest, f_k at high speed.
    speed, stribeck_speed : float
        v, of either sign, and the speed v_s at which the difference has fallen to 1/e [m/s].
    exponent : float
        d: 2 (Gauss) and 1 (Tustin) are usual, 0.5 has been measured.
    """
    fall = exponential(-power(abs(speed) / stribeck_speed, exponent))
    return static * fall + kinetic * (1.0 - fall)
