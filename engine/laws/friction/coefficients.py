"""Coefficients of friction: of material pairs, and as a function of sliding speed.

Amontons and Coulomb: F = f N against the sliding, f = friction. At rest friction takes any value up to f_s N.

Sources: the ranges of engineering practice as printed in courses of the theory of mechanisms and machines; other
values: P. P. Urone and R. Hinrichs, College Physics (OpenStax), table 5.1 (kinetic). Speed: R. Stribeck, 1902, in the
form of B. Armstrong-Hélouvry, Control of Machines with Friction.
"""

import math

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
# Coefficients of sliding friction; of a usual range, the middle.
MATERIALS = {
    "steel on steel": 0.18,
    "cast iron on steel": 0.2,
    "steel on wood": 0.4,
    "wood on wood": 0.3,
    "brake lining on metal": 0.55,  # 0.3 … 0.8
    "rubber on steel": 0.7,  # 0.6 … 0.8
    "steel on steel, dry": 0.3,
    "steel on steel, oiled": 0.03,
    "PTFE on steel": 0.04,
    "metal on wood": 0.3,
    "rubber on concrete, dry": 0.7,
    "rubber on concrete, wet": 0.5,
    "steel on ice": 0.02,
}


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
