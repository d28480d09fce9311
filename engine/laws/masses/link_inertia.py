"""Inertia of links: moments of inertia of shapes and from swings, inertia forces and their resultant.

Inertia forces reduce to the force U = −m a_S at the link's centre of mass S and the moment M_U = −J_S ε, or to the
single force U along a line at the distance h = M_U/U from S.

Sources: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 4 (compound pendulum, bifilar and trifilar
suspension); I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on kinetostatics.
"""

import math

import numpy as np

from engine.compiling.decorators import scalar

Value = float | np.ndarray


def rod_inertia(mass: Value, length: Value) -> Value:
    """Uniform thin rod about its middle, mL²/12 [kg·m²]."""
    return mass * length**2 / 12


def disc_inertia(mass: Value, diameter: Value) -> Value:
    """Uniform disc about its axis, mR²/2 [kg·m²]."""
    return mass * (diameter / 2) ** 2 / 2


def ring_inertia(mass: Value, diameter: Value, inner_diameter: Value) -> Value:
    """Uniform ring about its axis, m(R² + r²)/2 [kg·m²]."""
    return mass * ((diameter / 2) ** 2 + (inner_diameter / 2) ** 2) / 2


def plate_inertia(mass: Value, length: Value, width: Value) -> Value:
    """Uniform rectangular plate about its centre, m(a² + b²)/12 [kg·m²]."""
    return mass * (length**2 + width**2) / 12


def compound_inertia(mass: Value, weight: Value, distance: Value, period: Value) -> Value:
    """Body swinging about an axis at the distance h from its centre, about the centre: mgh T²/4π² − mh² [kg·m²]."""
    return weight * distance * (period / math.tau) ** 2 - mass * distance**2


def bifilar_inertia(weight: Value, spacing: Value, length: Value, period: Value) -> Value:
    """Body turning on two wires of length L at the spacing d, about their middle: mg d² T²/(16π² L) [kg·m²]."""
    return weight * (spacing / 2) ** 2 * (period / math.tau) ** 2 / length


def trifilar_inertia(weight: Value, radius: Value, length: Value, period: Value) -> Value:
    """Body turning on three wires of length L on a circle of radius r: mg r² T²/(4π² L) [kg·m²]."""
    return weight * radius**2 * (period / math.tau) ** 2 / length


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
    input speed: the speed cancels. Infinite for a pure moment, 0 without a moment: a slider that doesn't accelerate for
    an instant has no resultant, but its line passes through S before and after.

    Parameters
    ----------
    gyration2 : float
        Square of the radius of gyration, J_S/m [m²].
    ax, ay : float
        Acceleration of the centre of mass [m/s²].
    epsilon : float
        Angular acceleration [rad/s²].
    """
    return -gyration2 * epsilon / math.sqrt(ax * ax + ay * ay) if epsilon != 0.0 else 0.0
