"""The loops of the structural groups: how they transmit forces, whether they close, how they magnify inaccuracies.

An error dr of a link's length, or of a guide's offset, moves the inner joint B of a dyad so that it keeps to the other
link or guide: u₁·dB = dr, u₂·dB = 0, with u₁ and u₂ along the links or across the guides. So B moves across u₂ by
|dB| = dr/|sin γ|, γ the angle between u₁ and u₂: the transmission angle of RRR, that of the rod and the normal of the
guide in RRP, of the two guides in PRP. In RPR the slot's point that lies at the pin moves so by an error of the slot's
offset, in RPP the crossing of slot and guide by an error across the slot. Errors are magnified without bound in dead
centres and change points of the group, where γ is 0.

Source: any course of the theory of mechanisms, chapter on the accuracy of mechanisms.
"""

import numpy as np

from engine.cycle.measured import Measured
from engine.elements.element import Rank
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import Expression, Formula, LeastMagnitude, maximum, unresolved_peak
from engine.quantities.register import Declared, Summary

MAGNIFICATION, RESIDUAL = "error_magnification", "loop_closure_residual"


def declare(mechanics: Mechanics) -> Declared:
    """Transmission angles, error magnifications, and the loops' residual."""
    m, groups = mechanics, tuple(mechanics.scene.groups)
    words = "displacement of the joint or block per unit error of a length or offset, worst position"
    for group in groups:
        yield Summary(
            f"{group}.transmission_angle",
            f"minimum transmission angle of group {group} over the cycle",
            "rad",
            lambda group=group: Formula(_angle_of, (least_sine(m, group),)),
            symbol="γ",
            rank=Rank.ANSWER,
        )
        magnification = f"error magnification of group {group}: {words}"
        yield Summary(f"{group}.{MAGNIFICATION}", magnification, "1", lambda group=group: 1.0 / least_sine(m, group))
    if groups and not m.scene.links:
        yield Summary(
            MAGNIFICATION,
            f"error magnification of the worst group: {words}",
            "1",
            lambda: maximum(*(1.0 / least_sine(m, g) for g in groups)),
        )
    if groups or m.scene.links:
        yield Summary(
            RESIDUAL,
            "loop-closure residual, relative to the links' lengths",
            "1",
            lambda: maximum(*(unresolved_peak(c) for c in m.kinematics.closures.values())),
            rank=Rank.CHECK,
        )


def least_sine(m: Mechanics, group: str) -> Expression:
    """Least quality of force transmission of a group by magnitude; the quality never changes its sign."""
    return LeastMagnitude(m.kinematics.sines[group])


def _angle_of(sine: Measured) -> Measured:
    """Angle from its sine, and how much less it may be."""
    with np.errstate(invalid="ignore"):
        angle = np.arcsin(np.minimum(sine.value, 1.0))
        lower = np.arcsin(np.clip(sine.value - sine.error, 0.0, 1.0))
    return Measured(angle, angle - lower)
