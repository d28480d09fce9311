"""Motor characteristics, torque over speed, in the common form: a line, changes of its slope, Kloss' formula."""

from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from engine.laws.motor_characteristics import dc_motor_from_nameplate, induction_motor, kloss_from_nameplate
from engine.parts.actions import DCCharacteristic, InductionCharacteristic, TableCharacteristic, TableMotor

Value = float | np.ndarray


class MotorCurve(NamedTuple):
    """Torque over speed: level + slope ω + Σ bend (ω − speed) for all speeds exceeded, + Kloss' formula.

    Attributes
    ----------
    level, slope : float or ndarray
        [N·m], [N·m·s].
    bends : tuple of (float or ndarray, float or ndarray)
        Changes of slope [N·m·s], each with its speed [rad/s].
    kloss : tuple or None
        Breakdown torque and slip, rotor ratio and synchronous speed, as in `induction_motor`.
    no_load_speed : float or ndarray
        Speed above which the motor does not drive; infinite for a motor by any table [rad/s].
    """

    level: Value
    slope: Value
    bends: tuple[tuple[Value, Value], ...]
    kloss: tuple | None
    no_load_speed: Value

    def moment(self, speed: Value) -> Value:
        """Torque at a speed [N·m]."""
        bent = (bend * np.maximum(speed - at, 0.0) for bend, at in self.bends)
        moment = sum(bent, self.level + self.slope * speed)
        return moment if self.kloss is None else moment + induction_motor(*self.kloss, speed)


def bends_of(motor: DCCharacteristic | InductionCharacteristic | TableCharacteristic) -> int:
    """Number of changes of slope in a motor's characteristic."""
    return len(motor.speed) - 2 if isinstance(motor, TableCharacteristic) else 0


def stall_moment(motor: DCCharacteristic, at: str, numbers: Mapping[str, Value]) -> Value:
    """Stall torque of a DC motor, given or from its nameplate."""
    if motor.stall_moment is not None:
        return numbers[f"{at}.stall_moment"]
    return dc_motor_from_nameplate(*(numbers[f"{at}.{key}"] for key in ("power", "rated_speed", "no_load_speed")))


def kloss_constants(motor: InductionCharacteristic, at: str, numbers: Mapping[str, Value]) -> tuple:
    """Breakdown torque and slip, rotor ratio and synchronous speed, given or from the nameplate."""
    synchronous = numbers[f"{at}.synchronous_speed"]
    if motor.breakdown_moment is not None:
        return numbers[f"{at}.breakdown_moment"], numbers[f"{at}.breakdown_slip"], 0.0, synchronous
    keys = ["power", "rated_speed", "synchronous_speed", "breakdown_ratio"]
    keys += ["starting_ratio"] if motor.starting_ratio is not None else []
    return *kloss_from_nameplate(*(numbers[f"{at}.{key}"] for key in keys)), synchronous


def motor_curve(
    motor: DCCharacteristic | InductionCharacteristic | TableCharacteristic, at: str, numbers: Mapping[str, Value]
) -> MotorCurve:
    """Characteristic of a motor over the motor's speed.

    Parameters
    ----------
    motor : DCCharacteristic, InductionCharacteristic or TableCharacteristic
    at : str
        Path of the motor in the scene.
    numbers : mapping of str to float or ndarray
        By path.
    """
    if isinstance(motor, DCCharacteristic):
        stall, no_load = stall_moment(motor, at, numbers), numbers[f"{at}.no_load_speed"]
        return MotorCurve(stall, -stall / no_load, (), None, no_load)
    if isinstance(motor, InductionCharacteristic):
        kloss = kloss_constants(motor, at, numbers)
        return MotorCurve(0.0, 0.0, (), kloss, kloss[-1])
    scale, speed, moment = numbers[f"{at}.scale"], np.array(motor.speed), np.array(motor.moment)
    slopes = np.diff(moment) / np.diff(speed)
    bends = tuple((scale * change, knot) for change, knot in zip(np.diff(slopes), speed[1:-1], strict=True))
    level = moment[0] - slopes[0] * speed[0]
    no_load = motor.no_load_speed if isinstance(motor, TableMotor) else np.inf
    return MotorCurve(scale * level, scale * slopes[0], bends, None, no_load)
