"""Friction in revolute pairs: the friction circle, and the factors of new and worn-in journals.

While it turns, the resultant R of pressure and friction passes the journal's middle at rho, the radius of its
friction circle, and resists with M = R rho. Where the contact is a single line, rho = r sin(phi), tan(phi) = f.
A bush that embraces half of the journal multiplies it by WORN_IN = 4/pi (pressure with the cosine of the angle from
its middle, as after even wear) or NEW = pi/2 (even pressure), both from `engine.laws.friction.coefficients`.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines (friction circle, worn-in and new journals); the 1.47
that is printed here and there for the new journal is a misprint of pi/2 = 1.57.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def friction_circle(radius: float, friction: float, factor: float) -> float:
    """Radius of the friction circle: k r sin(arctan f) = k r f/√(1 + f²), about k f r.

    Parameters
    ----------
    radius, friction : float
        Of the journal r [m], f.
    factor : float
        k: 1 for contact on a line, WORN_IN or NEW for a bush that embraces half of the journal.

    Returns
    -------
    float
        rho [m].

    Notes
    -----
    k f r alone is its moment over the sum of the pressures' components along the middle of the bush; the friction
    there adds at a right angle and makes R larger by √(1 + f²), whichever of the two laws the pressure has.
    """
    return factor * radius * friction / math.sqrt(1 + friction * friction)


@scalar
def journal_moment(reaction: float, radius: float, friction: float, factor: float) -> float:
    """Moment of friction in a journal: R rho.

    Parameters
    ----------
    reaction : float
        R, all of the force between journal and bush [N].
    radius, friction, factor : float
        As for `friction_circle`.

    Returns
    -------
    float
        [N·m], against the rotation.
    """
    return abs(reaction) * friction_circle(radius, friction, factor)
