"""Loads on an inclined plane."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.element import Columns, ElementResult, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, FORCE, Friction, FrictionElement, Load
from engine.graph.over_arrays import over_arrays
from engine.laws.friction.inclines import incline
from engine.parts.skeleton import Angle


class InclineElement(FrictionElement):
    """A load on an inclined plane, pulled at `pull_angle` above the plane; `static_friction` holds it at rest."""

    shown: ClassVar = ((FORCE, ("up_force", "down_force")), (EFFICIENCY, ("efficiency",)))
    RESULTS: ClassVar = (
        ElementResult("friction_angle", "angle of friction", "rad"),
        ElementResult("up_force", "force that moves the load up", "N"),
        ElementResult("start_force", "force that sets the load going upwards", "N"),
        ElementResult("down_force", "force that moves the load down, negative where it has to be held", "N"),
        ElementResult("efficiency", "efficiency of moving the load up", "1", may_be_undefined=True),
        ElementResult("self_locking", "whether the load stays by itself (1 or 0)", "1", exact=True),
    )

    type: Literal["incline"]
    load: Load
    angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)]
    friction: Friction
    static_friction: Friction | None = None
    pull_angle: Annotated[Angle, Field(gt=-math.pi / 2, lt=math.pi / 2)] = 0.0

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        static = n.get("static_friction", n["friction"])
        return self.in_order(over_arrays(incline, n["load"], n["angle"], n["friction"], static, n["pull_angle"]))
