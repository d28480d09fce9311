"""Wedges driven in under a load, and withdrawn."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.element import Columns, ElementResult, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, FORCE, Friction, FrictionElement, Load
from engine.graph.over_arrays import over_arrays
from engine.laws.friction.inclines import wedge
from engine.parts.skeleton import Angle


class WedgeElement(FrictionElement):
    """A wedge under a load that is guided at right angles to the wedge's base.

    `friction` is the coefficient of the inclined face, and of the base unless `base_friction` is given.
    """

    shown: ClassVar = ((FORCE, ("drive_force", "withdraw_force")), (EFFICIENCY, ("efficiency",)))
    RESULTS: ClassVar = (
        ElementResult("drive_force", "force that drives the wedge in", "N"),
        ElementResult("withdraw_force", "force that withdraws the wedge, negative where the load presses it out", "N"),
        ElementResult("efficiency", "efficiency of driving the wedge in", "1"),
        ElementResult("self_locking", "whether the wedge stays by itself (1 or 0)", "1", exact=True),
    )

    type: Literal["wedge"]
    load: Load
    angle: Annotated[Angle, Field(gt=0, lt=math.pi / 2)]
    friction: Friction
    base_friction: Friction | None = None
    guide_friction: Friction = 0.0

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        faces = n["friction"], n.get("base_friction", n["friction"]), n["guide_friction"]
        return self.in_order(over_arrays(wedge, n["load"], n["angle"], *faces))
