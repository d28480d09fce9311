"""Sliders on their guides, which jam when pushed too far off their middle."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import NamedRows, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, FORCE, Friction, FrictionElement, Load
from engine.laws.friction.coefficients import BUSHES
from engine.laws.friction.guides import edge_forces
from engine.laws.friction.inclines import in_groove
from engine.parts.actions import Force
from engine.parts.skeleton import Angle, Length, Positive
from engine.words.quantity import main_result


class GuideElement(FrictionElement):
    """A slider on its guide, moved against a `resistance` along its middle by a force at an `overhang`.

    `load` presses it onto the guide: flat, a V with `vee_angle` between its faces, or half-round, new or worn in.
    """

    shown: ClassVar = ((FORCE, ("drive_force", "front_edge_force", "rear_edge_force")), (EFFICIENCY, ("efficiency",)))

    required_with: ClassVar = {"vee_angle": ("form", ("vee",))}

    type: Literal["guide"]
    form: Literal["flat", "vee", "half-round, new", "half-round, worn in"] = "flat"
    vee_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    length: Positive
    friction: Friction
    load: Force = 0.0
    resistance: Load
    overhang: Length = 0.0

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        load, resistance, overhang, half = n["load"], n["resistance"], n["overhang"], n["length"] / 2
        mu = BUSHES.get(self.form, 1.0) * in_groove(n["friction"], n.get("vee_angle", math.pi))
        # Equilibrium along the guide: P = Q + f max(|N|, P |e|/a), with the edges a from the middle.
        left = 1 - mu * np.abs(overhang) / half
        drive = np.where(left <= 0.0, np.inf, np.maximum(resistance + mu * np.abs(load), resistance / left))
        front, rear = edge_forces(load, drive * overhang, half)
        words = "coefficient of friction relative to the force that presses the slider"
        yield main_result("effective_friction", words, "1"), mu
        yield main_result("drive_force", "force that moves the slider", "N"), drive
        yield main_result("friction_force", "friction of the slider", "N"), mu * (np.abs(front) + np.abs(rear))
        yield main_result("front_edge_force", "force on the front edge of the slider", "N"), front
        words = "force on the rear edge of the slider, negative on the opposite face"
        yield main_result("rear_edge_force", words, "N"), rear
        tilts = np.abs(drive * overhang) > np.abs(load) * half
        words = "whether the slider bears on opposite faces of the guide (1 or 0)"
        yield main_result("tilts", words, "1", exact=True), tilts.astype(float)
        words = "overhang at which the slider jams"
        yield main_result("jamming_overhang", words, "m", may_be_undefined=True), half / mu
        words = "work on the resistance over that of the force that moves the slider"
        yield main_result("efficiency", words, "1"), resistance / drive
