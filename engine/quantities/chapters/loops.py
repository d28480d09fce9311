"""The loops of the structural groups: transmission angle, loop-closure residual, error magnification.

An error dr of a link's length, or of a guide's offset, displaces the inner joint B of a dyad along the direction that
the other link or guide allows: u₁·dB = dr, u₂·dB = 0, with u₁ and u₂ along the links or across the guides. Thus B moves
perpendicular to u₂ by |dB| = dr/|sin γ|, with γ the angle between u₁ and u₂: the transmission angle of RRR, the angle
between the rod and the normal of the guide in RRP, between the two guides in PRP. In RPR, an error of the slot's offset
displaces the slot's point at the pin in the same way; in RPP, an error across the slot the intersection of slot and
guide. The magnification is unbounded at dead centres and change points of the group, where γ = 0.

Source: any course of the theory of mechanisms, chapter on the accuracy of mechanisms.
"""

from functools import partial

import numpy as np

from engine.cycle.measured import Measured
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import Expression, Formula, LeastMagnitude, maximum, unresolved_peak
from engine.quantities.register import Declared, Summary, answer_summary, check_summary

MAGNIFICATION, RESIDUAL = "error_magnification", "loop_closure_residual"


def declare(mechanics: Mechanics) -> Declared:
    """Transmission angles, error magnifications, and the loop-closure residual."""
    m, groups = mechanics, tuple(mechanics.scene.groups)
    words = "displacement of the joint or block per unit error of a length or offset, worst position"
    for group in groups:
        least = f"minimum transmission angle of group {group} over the cycle"
        angle = partial(Formula, _angle_of, (least_sine(m, group),))
        yield answer_summary(f"{group}.transmission_angle", least, "rad", angle, "γ")
        magnification = f"error magnification of group {group}: {words}"
        yield Summary(f"{group}.{MAGNIFICATION}", magnification, "1", lambda group=group: 1.0 / least_sine(m, group))
    if groups and not m.scene.links:
        words = f"error magnification of the worst group: {words}"
        yield Summary(MAGNIFICATION, words, "1", lambda: maximum(*(1.0 / least_sine(m, g) for g in groups)))
    if groups or m.scene.links:
        words, closures = "loop-closure residual, relative to the links' lengths", m.kinematics.closures
        yield check_summary(RESIDUAL, words, "1", lambda: maximum(*(unresolved_peak(c) for c in closures.values())))


def least_sine(m: Mechanics, group: str) -> Expression:
    """Minimum magnitude of a group's transmission index, which never changes sign."""
    return LeastMagnitude(m.kinematics.sines[group])


def _angle_of(sine: Measured) -> Measured:
    """Angle from its sine; the error estimate is towards smaller angles."""
    with np.errstate(invalid="ignore"):
        angle = np.arcsin(np.minimum(sine.value, 1.0))
        lower = np.arcsin(np.clip(sine.value - sine.error, 0.0, 1.0))
    return Measured(angle, angle - lower)
