"""Stiffness of machine parts.

Sources: S. P. Timoshenko, Strength of Materials, part I (torsion of round shafts, tension, bending of a cantilever);
for gear teeth ISO 6336-1, which gives the mesh stiffness c_γ per face width.
"""

import math

import numpy as np


def shaft_stiffness(diameter: np.ndarray, bore: np.ndarray, length: np.ndarray, modulus: np.ndarray) -> np.ndarray:
    """Torsional stiffness of a round shaft, G π (D⁴ − d⁴)/(32 L) [N·m/rad]; infinite for L = 0."""
    # D⁴ − d⁴ in factors, to avoid cancellation.
    polar = math.pi / 32.0 * (diameter - bore) * (diameter + bore) * (diameter**2 + bore**2)
    with np.errstate(divide="ignore"):
        return modulus * polar / length


def cantilever_stiffness(diameter: np.ndarray, bore: np.ndarray, length: np.ndarray, modulus: np.ndarray) -> np.ndarray:
    """Stiffness of a round cantilever for a transverse force at its end, 3 E I/L³ [N/m]."""
    second_moment = math.pi / 64.0 * (diameter - bore) * (diameter + bore) * (diameter**2 + bore**2)
    return 3.0 * modulus * second_moment / length**3


def at_radius(stiffness: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Torsional stiffness k r² of a part elastic along a circle: teeth, strands of a belt or chain [N·m/rad]."""
    return stiffness * radius**2


def rods_at_radius(
    area: np.ndarray, length: np.ndarray, modulus: np.ndarray, radius: np.ndarray, count: np.ndarray
) -> np.ndarray:
    """Torsional stiffness of parallel rods in tension, of E A/L each, along a circle [N·m/rad]."""
    return at_radius(count * (modulus * area / length), radius)


def teeth_at_radius(per_width: np.ndarray, width: np.ndarray, radius: np.ndarray) -> np.ndarray:
    """Torsional stiffness of teeth in mesh, c_γ b along the base circle [N·m/rad]."""
    return at_radius(per_width * width, radius)


def damping_of_absorption(absorption: np.ndarray, stiffness: np.ndarray, frequency: np.ndarray) -> np.ndarray:
    """Damping that dissipates the fraction ψ of the maximum energy in a cycle, ψ k/(2 π ω), at ω [rad/s]."""
    return absorption * stiffness / (math.tau * frequency)
