"""The motors of a scene: their constants, as given or from a nameplate, and their moment reduced to the input link."""

from collections.abc import Mapping

import numpy as np

from engine.laws.motor_characteristics import dc_motor, dc_motor_from_nameplate, induction_motor, kloss_from_nameplate
from engine.scene.actions import DCCharacteristic, DCMotor, InductionCharacteristic, InductionMotor
from engine.scene.scene import Numbers, Scene


def motor_moment(scene: Scene, motors: tuple[str, ...], numbers: Numbers) -> float | np.ndarray:
    """Moment of the motors at the input's speed, reduced to the input link [N·m], for every variant."""
    total: float | np.ndarray = 0.0
    for name in motors:
        motor, at = scene.moments[name], f"moments.{name}"
        ratio = motor_ratio(scene, motor, numbers)
        # A motor drives its shaft the way it is meant to turn.
        speed = np.abs(numbers["input.speed"] * ratio)
        if isinstance(motor, DCMotor):
            law = np.vectorize(dc_motor, otypes=[float])
            moment = law(stall_moment(motor, at, numbers), numbers[f"{at}.no_load_speed"], speed)
        else:
            law = np.vectorize(induction_motor, otypes=[float])
            moment = law(*kloss_constants(motor, at, numbers), speed)
        total = total + moment * np.abs(ratio) * np.sign(numbers["input.speed"])
    return total


def motor_ratio(scene: Scene, motor: DCMotor | InductionMotor, numbers: Numbers) -> float | np.ndarray:
    """Speed of a motor over that of the input link, with its sign."""
    return 1.0 if motor.on == scene.input.link else numbers[f"shafts.{motor.on}.ratio"]


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
