"""Inertia forces of a link in plane motion, and their resultant.

They reduce to the force U = −m a_S at the link's centre of mass S and the moment M_U = −J_S ε, or to the single force U
along a line at the distance h = M_U/U from S.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on kinetostatics.
"""

import math

from engine.compiling.decorators import scalar


@scalar
def inertia_force(mass: float, ax: float, ay: float) -> tuple[float, float]:
    """Resultant force of a link's inertia forces, U = −m a_S [N].

    Parameters
    ----------
    mass : float
        [kg].
    ax, ay : float
        Acceleration of the centre of mass [m/s²].
    """
    return -mass * ax, -mass * ay


@scalar
def inertia_moment(inertia: float, epsilon: float) -> float:
    """Resultant moment of a link's inertia forces about its centre of mass, M_U = −J_S ε [N·m].

    Parameters
    ----------
    inertia : float
        J_S [kg·m²].
    epsilon : float
        Angular acceleration [rad/s²].
    """
    return -inertia * epsilon


@scalar
def inertia_offset(gyration2: float, ax: float, ay: float, epsilon: float) -> float:
    """Distance h = M_U/U of the resultant's line from the centre of mass [m].

    Positive where the line passes to the right of S, seen along U. Accelerations may be transfer functions at constant
    input speed: the speed cancels. Infinite for a pure moment, NaN without inertia forces.

    Parameters
    ----------
    gyration2 : float
        Square of the radius of gyration, J_S/m [m²].
    ax, ay : float
        Acceleration of the centre of mass [m/s²].
    epsilon : float
        Angular acceleration [rad/s²].
    """
    return -gyration2 * epsilon / math.sqrt(ax * ax + ay * ay)
