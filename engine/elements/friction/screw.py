"""Screws that raise and lower a load, with their thrust collar.

A thread of mean radius r is an incline of slope tan β = lead/(2 π r) wound on a cylinder. Flanks inclined by γ to the
plane normal to the axis, half of the thread angle, act like a groove: the friction of the square thread becomes
f/cos γ. Lowering reverses the rotation: a negative torque means that the load drives the screw and must be held.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines (friction in the screw pair); R. G. Budynas and
J. K. Nisbett, Shigley's Mechanical Engineering Design, chapter 8.
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import NamedRows, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, TORQUE, Friction, FrictionElement, Load
from engine.laws.friction.inclines import push_down, push_up
from engine.parts.skeleton import Angle, Faults, Length, Positive
from engine.words.quantity import main_result

THREAD_ANGLES = {"square": 0.0, "trapezoidal": math.radians(30.0), "metric": math.radians(60.0)}


class ScrewElement(FrictionElement):
    """A screw that raises and lowers a load, with a named thread or any `thread_angle` between the flanks.

    `collar_diameter` is the mean diameter of the thrust collar.
    """

    shown: ClassVar = (
        (TORQUE, ("raise_moment", "lower_moment")),
        (EFFICIENCY, ("raise_efficiency", "lower_efficiency")),
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

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        load, radius, collar = n["load"], n["mean_diameter"] / 2, n["collar_friction"] * n["collar_diameter"] / 2
        slope = n["pitch"] * self.starts / (2 * math.pi * radius)
        half = (n["thread_angle"] if self.thread is None else THREAD_ANGLES[self.thread]) / 2
        reduced, held = n["friction"] / np.cos(half), collar * load
        up, down = (load * radius * push(slope, reduced) + held for push in (push_up, push_down))
        work, enough = load * radius * slope, collar / radius
        locking = np.where(slope > enough, np.cos(half) * push_down(enough, slope), 0.0)
        yield main_result("lead_angle", "lead angle of the thread", "rad"), np.arctan(slope)
        words = "friction angle of the thread, including the inclination of its flanks"
        yield main_result("friction_angle", words, "rad"), np.arctan(reduced)
        yield main_result("raise_moment", "torque that raises the load", "N m"), up
        words = "torque that lowers the load, negative where the load drives"
        yield main_result("lower_moment", words, "N m"), down
        yield main_result("collar_moment", "friction torque at the thrust collar", "N m"), held
        yield main_result("raise_efficiency", "efficiency of raising the load", "1"), work / up
        words = "efficiency of lowering: output work over the work of the sinking load"
        yield main_result("lower_efficiency", words, "1"), np.where(down < 0.0, -down / work, 0.0)
        words = "whether the load stays without being held (1 or 0)"
        yield main_result("self_locking", words, "1", exact=True), np.where(down < 0.0, 0.0, 1.0)
        words = "minimum coefficient of friction at which the load stays without being held"
        yield main_result("locking_friction", words, "1"), locking
