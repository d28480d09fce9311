"""Moments of inertia of simple shapes about their centres, and of bodies from the period of a swing.

Source of the inertias from swings: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 4 (compound pendulum,
bifilar and trifilar suspension).
"""

import math

import numpy as np

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
