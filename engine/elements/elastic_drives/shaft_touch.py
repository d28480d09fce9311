"""Torque of an elastic shaft with backlash, the range of each contact, and the rate of the torque.

The twist is zero at first forward contact. Contact is forward, 1, backward, −1, or none, 0. In forward contact
T = k e + b ė, in backward contact T = k (e + Δ) + b ė; damping can't pull.
"""

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen

# Stiffness, damping, backlash.
Shaft = tuple[float, float, float]


@scalar
def touching_moment(shaft: Shaft, touch: float, twist: float, slip: float) -> float:
    """Torque from the twist and its rate [N·m]."""
    stiffness, damping, backlash = shaft
    pressed = twist + chosen(touch < 0.0, backlash, 0.0)
    return chosen(touch == 0.0, 0.0, stiffness * pressed + damping * slip)


@scalar
def touch_left(shaft: Shaft, touch: float, twist: float, slip: float) -> float:
    """A guard: positive until contact is lost or made."""
    stiffness, damping, backlash = shaft
    ahead, behind, pull = stiffness * twist, -stiffness * (twist + backlash), damping * slip
    # Contact needs compression, and a damper force that doesn't pull.
    forwards, backwards = chosen(pull > 0.0, ahead, ahead + pull), chosen(pull < 0.0, behind, behind - pull)
    parted = -chosen(forwards > backwards, forwards, backwards)
    return chosen(touch == 0.0, parted, touch * touching_moment(shaft, touch, twist, slip))


@scalar
def touch_turns(shaft: Shaft, touch: float, slip: float, apart: float) -> float:
    """Rate of the torque (of the twist, if out of contact), from the twist's rate `slip` and its derivative `apart`."""
    return chosen(touch == 0.0, slip, shaft[0] * slip + shaft[1] * apart)
