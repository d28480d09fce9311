"""Reduction of a machine to its input link: the terms of I(φ), dI/dφ and M(φ).

I = Σ m (v_S/ω)² + J (ω_i/ω)², dI/dφ = 2 Σ m (v_S/ω)·(dv_S/dφ/ω) + J (ω_i/ω)(dω_i/dφ/ω) and
M = Σ F·(v/ω) + M_i (ω_i/ω), from equality of kinetic energy and of power (Artobolevsky; Levitsky).
With a sliding input the same sums are the reduced mass [kg] and the reduced force [N].
"""

from engine.compiling.decorators import scalar


@scalar
def translation_inertia(vx: float, vy: float) -> float:
    """(v_S/ω)²: reduced inertia per unit of mass [m²]."""
    return vx * vx + vy * vy


@scalar
def translation_inertia_phi(vx: float, vy: float, ax: float, ay: float) -> float:
    """d/dφ (v_S/ω)² = 2 v·a, with the transfer functions v and a of the centre of mass [m²/rad]."""
    half = vx * ax + vy * ay
    return half + half


@scalar
def rotation_inertia(w: float) -> float:
    """(ω_i/ω)²: reduced inertia per unit of moment of inertia about the centre of mass [1]."""
    return w * w


@scalar
def rotation_inertia_phi(w: float, e: float) -> float:
    """d/dφ (ω_i/ω)² = 2 w e, with the angular transfer functions w and e of the link [1/rad]."""
    half = w * e
    return half + half


@scalar
def power_of_force(fx: float, fy: float, vx: float, vy: float) -> float:
    """Reduced moment of a force, F·(v/ω) [N·m]."""
    return fx * vx + fy * vy
