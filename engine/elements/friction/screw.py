"""Screws that raise and lower a load, with their thrust collar."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.element import Columns, ElementResult, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, TORQUE, Friction, FrictionElement, Load, Positive
from engine.graph.over_arrays import over_arrays
from engine.laws.friction.screws import screw
from engine.parts.skeleton import Angle, Faults, Length

THREAD_ANGLES = {"square": 0.0, "trapezoidal": math.radians(30.0), "metric": math.radians(60.0)}


class ScrewElement(FrictionElement):
    """A screw that raises and lowers a load, with a named thread or any `thread_angle` between the flanks.

    `collar_diameter` is the mean diameter of the thrust collar.
    """

    shown: ClassVar = (
        (TORQUE, ("raise_moment", "lower_moment")),
        (EFFICIENCY, ("raise_efficiency", "lower_efficiency")),
    )
    RESULTS: ClassVar = (
        ElementResult("lead_angle", "lead angle of the thread", "rad"),
        ElementResult("friction_angle", "angle of friction of the thread, with the inclination of its flanks", "rad"),
        ElementResult("raise_moment", "moment that raises the load", "N m"),
        ElementResult("lower_moment", "moment that lowers the load, negative where the load drives", "N m"),
        ElementResult("collar_moment", "moment of friction at the thrust collar", "N m"),
        ElementResult("raise_efficiency", "efficiency of raising the load", "1"),
        ElementResult("lower_efficiency", "share of the sinking load's work that the screw passes on", "1"),
        ElementResult("self_locking", "whether the load stays by itself (1 or 0)", "1", exact=True),
        ElementResult("locking_friction", "minimum coefficient of friction with which the load stays by itself", "1"),
    )

    type: Literal["screw"]
    load: Load
    mean_diameter: Positive
    pitch: Positive
    starts: Annotated[int, Field(ge=1)] = 1
    thread: Literal["square", "trapezoidal", "metric"] | None = None
    thread_angle: Annotated[Angle, Field(ge=0, lt=math.pi)] | None = None
    friction: Friction
    collar_diameter: Annotated[Length, Field(ge=0)] = 0.0
    collar_friction: Friction = 0.0

    def _faults(self) -> Faults:
        if (self.thread is None) == (self.thread_angle is None):
            yield "give thread ('square', 'trapezoidal' or 'metric') or thread_angle, one of the two"

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        angle = n["thread_angle"] if self.thread is None else THREAD_ANGLES[self.thread]
        lead, collar = n["pitch"] * self.starts, (n["collar_diameter"], n["collar_friction"])
        return self.in_order(over_arrays(screw, n["load"], n["mean_diameter"], lead, angle, n["friction"], *collar))
