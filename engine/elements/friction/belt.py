"""Belts on a pulley on the point of slipping."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.element import Columns, ElementResult, Numbers
from engine.elements.friction.friction_element import FORCE, RATIO, FrictionElement, Load, Positive
from engine.graph.over_arrays import over_arrays
from engine.laws.friction.belts import belt
from engine.parts.skeleton import Angle, Moment, Number, Speed, quantity


class BeltElement(FrictionElement):
    """A belt on a pulley on the point of slipping: the torque that its `tension` transmits, or the tension required.

    `tension` is that of the tight strand; `groove_angle` is the angle between the faces of a V groove. A moving belt
    has a `speed` and, with its `linear_density`, a centrifugal tension.
    """

    one_of: ClassVar = (("tension", "moment"),)
    needs: ClassVar = {"linear_density": ("speed",)}
    shown: ClassVar = ((FORCE, ("tight_tension", "slack_tension", "shaft_force")), (RATIO, ("tension_ratio",)))
    RESULTS: ClassVar = (
        ElementResult("tension_ratio", "tension of the tight strand over the slack one's, without centrifugal", "1"),
        ElementResult("tight_tension", "tension of the tight strand", "N"),
        ElementResult("slack_tension", "tension of the slack strand", "N"),
        ElementResult("moment", "maximum torque without slip", "N m"),
        ElementResult("shaft_force", "force of the belt on the shaft", "N"),
        ElementResult("power", "maximum power without slip", "W", "speed"),
        ElementResult("centrifugal_tension", "tension that keeps the belt on its circle", "N", "linear_density"),
        ElementResult("speed_of_most_power", "speed of most power at this tension", "m s-1", "linear_density"),
    )

    type: Literal["belt"]
    diameter: Positive
    wrap: Annotated[Angle, Field(gt=0)]
    friction: Annotated[Number, Field(gt=0)]
    groove_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    tension: Load | None = None
    moment: Annotated[Moment, Field(gt=0)] | None = None
    speed: Annotated[Speed, Field(ge=0)] | None = None
    linear_density: Annotated[quantity("linear_density"), Field(gt=0)] | None = None

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        usual = {"groove_angle": math.pi, "tension": math.nan, "moment": math.nan, "linear_density": 0.0, "speed": 0.0}
        others = (n.get(key, value) for key, value in usual.items())
        return self.in_order(over_arrays(belt, n["diameter"], n["wrap"], n["friction"], *others))
