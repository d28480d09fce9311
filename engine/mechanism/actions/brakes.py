"""The brakes of a scene: braking torque of each, for every variant."""

import numpy as np

from engine.laws.brakes import (
    band_and_block_grip,
    band_brake,
    long_block_factor,
    pressed_brake,
    uniform_pressure_radius,
    uniform_wear_radius,
)
from engine.parts.actions import BandBrake, BlockBrake, Brake
from engine.scene.scene import Numbers

_ARMS = "slack_arm", "tight_arm"
_LEVER = "force", "lever_arm", *_ARMS


def braking_moment(brake: Brake, at: str, numbers: Numbers) -> float | np.ndarray:
    """Braking torque on a drum or disc [N·m], for every variant.

    Parameters
    ----------
    brake : Brake
    at : str
        Path of the brake in the scene.
    numbers : Numbers
    """
    if isinstance(brake, BandBrake):
        lever = (numbers[f"{at}.{key}"] for key in _LEVER)
        return band_brake(*lever, 1.0, _grip(brake, at, numbers), numbers[f"{at}.radius"])
    force, friction = numbers[f"{at}.force"], numbers[f"{at}.friction"]
    if isinstance(brake, BlockBrake):
        factor = long_block_factor(0.5 * numbers[f"{at}.embrace"])
        return pressed_brake(force, friction * factor, numbers[f"{at}.radius"], float(brake.blocks))
    mean_radius = uniform_wear_radius if brake.linings == "worn in" else uniform_pressure_radius
    radius = mean_radius(numbers[f"{at}.inner_radius"], numbers[f"{at}.outer_radius"])
    return pressed_brake(force, friction, radius, float(brake.faces))


def rounding_of_braking(brake: Brake, at: str, numbers: Numbers) -> float | np.ndarray:
    """Factor from the rounding of a brake's numbers to that of its torque: large for a band that nearly locks itself.

    Parameters
    ----------
    brake, at, numbers
        As for `braking_moment`.
    """
    if not isinstance(brake, BandBrake):
        return 1.0
    slack, tight = (numbers[f"{at}.{key}"] for key in _ARMS)
    slack = slack * np.exp(-_grip(brake, at, numbers))
    return (np.abs(slack) + np.abs(tight)) / np.abs(slack + tight)


def _grip(brake: BandBrake, at: str, numbers: Numbers) -> float | np.ndarray:
    """Logarithm of the ratio of the tensions at a band's ends."""
    if brake.blocks is None:
        return numbers[f"{at}.friction"] * numbers[f"{at}.wrap"]
    return band_and_block_grip(numbers[f"{at}.friction"], numbers[f"{at}.block_angle"], float(brake.blocks))
