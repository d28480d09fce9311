"""The motors of a scene: their moment reduced to the input link."""

import numpy as np

from engine.laws.motor_characteristics import dc_motor, induction_motor
from engine.parts.actions import DCMotor, InductionMotor
from engine.parts.motor_constants import kloss_constants, stall_moment
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
