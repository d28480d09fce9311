"""The moment of an elastic shaft with backlash, until when it touches as it does, and by what it grows.

Its twist is counted from where it is just in touch forwards; it touches forwards, 1, backwards, −1, or nowhere, 0. In
touch T = k e + b ė, or behind the backlash T = k (e + Δ) + b ė; damping may not pull.
"""

from engine.compiling.decorators import scalar
from engine.compiling.instructions import chosen

# Stiffness, damping, backlash.
Shaft = tuple[float, float, float]


@scalar
def touching_moment(shaft: Shaft, touch: float, twist: float, slip: float) -> float:
    """Moment by the twist and its rate [N·m]."""
    stiffness, damping, backlash = shaft
    pressed = twist + chosen(touch < 0.0, backlash, 0.0)
    return chosen(touch == 0.0, 0.0, stiffness * pressed + damping * slip)


@scalar
def touch_left(shaft: Shaft, touch: float, twist: float, slip: float) -> float:
    """What is positive until touch is lost or made."""
    stiffness, damping, backlash = shaft
    ahead, behind, pull = stiffness * twist, -stiffness * (twist + backlash), damping * slip
    # Pressed together, and the damper not pulling.
    forwards, backwards = chosen(pull > 0.0, ahead, ahead + pull), chosen(pull < 0.0, behind, behind - pull)
    parted = -chosen(forwards > backwards, forwards, backwards)
    return chosen(touch == 0.0, parted, touch * touching_moment(shaft, touch, twist, slip))


@scalar
def touch_turns(shaft: Shaft, touch: float, slip: float, apart: float) -> float:
    """Rate of the moment, or out of touch that of the twist, by that and its own rate."""
    return chosen(touch == 0.0, slip, shaft[0] * slip + shaft[1] * apart)
