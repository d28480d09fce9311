"""Constants of motors: as given, or from a nameplate."""

from collections.abc import Mapping

import numpy as np

from engine.laws.motor_characteristics import dc_motor_from_nameplate, kloss_from_nameplate
from engine.parts.actions import DCCharacteristic, InductionCharacteristic


def stall_moment(motor: DCCharacteristic, at: str, numbers: Mapping[str, float | np.ndarray]) -> float | np.ndarray:
    """Stall moment of a DC motor, as given or from its nameplate."""
    if motor.stall_moment is not None:
        return numbers[f"{at}.stall_moment"]
    return dc_motor_from_nameplate(*(numbers[f"{at}.{key}"] for key in ("power", "rated_speed", "no_load_speed")))


def kloss_constants(motor: InductionCharacteristic, at: str, numbers: Mapping[str, float | np.ndarray]) -> tuple:
    """Breakdown moment and slip, rotor ratio and synchronous speed, as given or from the motor's nameplate."""
    synchronous = numbers[f"{at}.synchronous_speed"]
    if motor.breakdown_moment is not None:
        return numbers[f"{at}.breakdown_moment"], numbers[f"{at}.breakdown_slip"], 0.0, synchronous
    keys = ["power", "rated_speed", "synchronous_speed", "breakdown_ratio"]
    keys += ["starting_ratio"] if motor.starting_ratio is not None else []
    return *kloss_from_nameplate(*(numbers[f"{at}.{key}"] for key in keys)), synchronous
