"""Friction wheels: creep, contact force required, sliding."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import Answers, NamedRows, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, FORCE, FrictionElement
from engine.laws.friction.inclines import in_groove
from engine.parts.actions import Force
from engine.parts.skeleton import Angle, AngularSpeed, Length, Moment, Number
from engine.words.quantity import main_result
from engine.words.verdicts import Verdict

# Results that remain valid for sliding wheels.
_VALID_WHEN_SLIDING = ("tangential_force", "needed_press_force", "traction_share")


class FrictionDrive(FrictionElement):
    """Two wheels pressed together, the second a ring if `internal`; a `groove_angle` lies between V-shaped faces.

    `moment` is the load torque on the driven wheel. `creep` is the relative loss of rim speed. `safety` is the ratio of
    the required contact force to the minimum one; `press_force` is the actual contact force.
    """

    shown: ClassVar = ((FORCE, ("needed_press_force", "tangential_force")), (EFFICIENCY, ("efficiency",)))

    type: Literal["friction_drive"]
    driving_diameter: Annotated[Length, Field(gt=0)]
    driven_diameter: Annotated[Length, Field(gt=0)]
    internal: bool = False
    groove_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    friction: Annotated[Number, Field(gt=0)]
    creep: Annotated[Number, Field(ge=0, lt=1)] = 0.0
    safety: Annotated[Number, Field(ge=1)] = 1.5
    speed: AngularSpeed
    moment: Annotated[Moment, Field(ge=0)]
    press_force: Annotated[Force, Field(gt=0)] | None = None

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants, whether or not the wheels slide."""
        mu = in_groove(n["friction"], n.get("groove_angle", math.pi))
        ratio = (1.0 if self.internal else -1.0) * n["driven_diameter"] / (n["driving_diameter"] * (1.0 - n["creep"]))
        pull = 2.0 * n["moment"] / n["driven_diameter"]
        driving = 0.5 * pull * n["driving_diameter"]
        yield main_result("ratio", "speed of the driving wheel over that of the driven one", "1"), ratio
        yield main_result("driven_speed", "angular speed of the driven wheel", "rad s-1"), n["speed"] / ratio
        yield main_result("tangential_force", "tangential force at the rims", "N"), pull
        words = "required contact force between the wheels"
        yield main_result("needed_press_force", words, "N"), n["safety"] * pull / mu
        if "press_force" in n:
            words = "tangential force over the friction limit"
            yield main_result("traction_share", words, "1"), pull / (mu * n["press_force"])
        yield main_result("driving_moment", "drive torque", "N m"), driving
        yield main_result("input_power", "input power", "W"), driving * np.abs(n["speed"])
        words = "output power over input power, with creep as the only loss"
        yield main_result("efficiency", words, "1"), 1.0 - n["creep"]

    def evaluate(self, n: Numbers) -> Answers:
        """Results, and verdicts on insufficient contact force and on rings that are too small."""
        found, errors, _ = super().evaluate(n)
        slides = found.get("traction_share", np.zeros_like(n["speed"])) >= 1.0
        fits = n["driven_diameter"] > n["driving_diameter"] if self.internal else np.ones(slides.shape, bool)
        for name in found:
            found[name] = np.where(fits & (~slides | (name in _VALID_WHEN_SLIDING)), found[name], np.nan)
        verdicts = np.where(fits, np.where(slides, Verdict.SLIDES, Verdict.OK), Verdict.DOES_NOT_FIT)
        return Answers(found, errors, verdicts.astype(np.uint8))
