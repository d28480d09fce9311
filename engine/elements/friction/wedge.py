"""Wedges driven in under a load, and withdrawn.

Source: R. S. Khurmi and J. K. Gupta, Theory of Machines, chapter 10.
"""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import NamedRows, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, FORCE, Friction, FrictionElement, Load
from engine.laws.friction.inclines import push_down, push_up
from engine.parts.skeleton import Angle
from engine.words.quantity import main_result


class WedgeElement(FrictionElement):
    """A wedge under a load that is guided at right angles to the wedge's base.

    `friction` is the coefficient of the inclined face, and of the base unless `base_friction` is given.
    """

    shown: ClassVar = ((FORCE, ("drive_force", "withdraw_force")), (EFFICIENCY, ("efficiency",)))

    type: Literal["wedge"]
    load: Load
    angle: Annotated[Angle, Field(gt=0, lt=math.pi / 2)]
    friction: Friction
    base_friction: Friction | None = None
    guide_friction: Friction = 0.0

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        load, slope, friction, guide = n["load"], np.tan(n["angle"]), n["friction"], n["guide_friction"]
        base = n.get("base_friction", friction)
        inwards, outwards = push_up(slope, friction), push_down(slope, friction)
        # The thrust across the load's guide causes friction there, which the wedge lifts too.
        left = 1 - guide * inwards
        drive = np.where(left > 0.0, load * (inwards + base) / left, np.inf)
        withdraw = load * (outwards + base) / (1 + guide * np.abs(outwards))
        yield main_result("drive_force", "force that drives the wedge in", "N"), drive
        words = "force that withdraws the wedge, negative where the load presses it out"
        yield main_result("withdraw_force", words, "N"), withdraw
        yield main_result("efficiency", "efficiency of driving the wedge in", "1"), load * slope / drive
        words = "whether the wedge holds by itself (1 or 0)"
        yield main_result("self_locking", words, "1", exact=True), np.where(withdraw < 0.0, 0.0, 1.0)
