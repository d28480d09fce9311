"""Friction in revolute pairs: the friction circle, and the factors of new and worn-in journals.

While the journal turns, the resultant R of pressure and friction passes its middle at the distance rho, the radius of
the friction circle, and resists with M = R rho. For contact on a single line, rho = r sin(phi), tan(phi) = f. A bush
around half of the journal multiplies it by WORN_IN = 4/pi (pressure with the cosine of the angle from its middle, as
after even wear) or NEW = pi/2 (even pressure), both from `engine.laws.friction.coefficients`.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines (friction circle, worn-in and new journals). The value
1.47 sometimes printed for the new journal is a misprint of pi/2 = 1.57.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def friction_circle(radius: float, friction: float, factor: float) -> float:
    """Radius of the friction circle: k r sin(arctan f) = k r f/√(1 + f²), about k f r.

    Parameters
    ----------
    radius, friction : float
        Radius of the journal r [m], f.
    factor : float
        k: 1 for contact on a line, WORN_IN or NEW for a bush around half of the journal.

    Returns
    -------
    float
        rho [m].

    Notes
    -----
    k f r is the friction moment divided by the resultant of the pressures along the middle of the bush. The resultant
    of friction is perpendicular to that and makes R larger by √(1 + f²), for either distribution of pressure.
    """
    return factor * radius * friction / math.sqrt(1 + friction * friction)


@scalar
def journal_moment(reaction: float, radius: float, friction: float, factor: float) -> float:
    """Friction moment in a journal: R rho.

    Parameters
    ----------
    reaction : float
        R, total force between journal and bush [N].
    radius, friction, factor : float
        As in `friction_circle`.

    Returns
    -------
    float
        [N·m], against the rotation.
    """
    return abs(reaction) * friction_circle(radius, friction, factor)


@scalar
def journal(load: float, diameter: float, friction: float, factor: float, speed: float) -> tuple[float, float, float]:
    """Journal: its results in order."""
    moment = journal_moment(load, diameter / 2, friction, factor)
    return friction_circle(diameter / 2, friction, factor), moment, moment * abs(speed)
