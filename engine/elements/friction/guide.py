"""Sliders on their guides, which jam when pushed too far off their middle."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.element import Columns, ElementResult, Numbers
from engine.elements.friction.friction_element import EFFICIENCY, FORCE, Friction, FrictionElement, Load, Positive
from engine.graph.over_arrays import over_arrays
from engine.laws.friction.coefficients import BUSHES
from engine.laws.friction.guides import guide
from engine.parts.actions import Force
from engine.parts.skeleton import Angle, Length


class GuideElement(FrictionElement):
    """A slider on its guide, moved against a `resistance` along its middle by a force at an `overhang`.

    `load` presses it onto the guide: flat, a V with `vee_angle` between its faces, or half-round, new or worn in.
    """

    shown: ClassVar = ((FORCE, ("drive_force", "front_edge_force", "rear_edge_force")), (EFFICIENCY, ("efficiency",)))
    RESULTS: ClassVar = (
        ElementResult(
            "effective_friction", "coefficient of friction in terms of the force that presses the slider", "1"
        ),
        ElementResult("drive_force", "force that moves the slider", "N"),
        ElementResult("friction_force", "friction of the slider", "N"),
        ElementResult("front_edge_force", "force on the front edge of the slider", "N"),
        ElementResult("rear_edge_force", "force on the rear edge of the slider, negative on the opposite face", "N"),
        ElementResult("tilts", "whether the slider bears on opposite faces of the guide (1 or 0)", "1", exact=True),
        ElementResult("jamming_overhang", "overhang at which the slider jams", "m", may_be_undefined=True),
        ElementResult("efficiency", "work on the resistance over that of the force that moves the slider", "1"),
    )

    required_with: ClassVar = {"vee_angle": ("form", ("vee",))}

    type: Literal["guide"]
    form: Literal["flat", "vee", "half-round, new", "half-round, worn in"] = "flat"
    vee_angle: Annotated[Angle, Field(gt=0, le=math.pi)] | None = None
    length: Positive
    friction: Friction
    load: Force = 0.0
    resistance: Load
    overhang: Length = 0.0

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        keys = ("load", "resistance", "overhang", "length", "friction")
        factor = BUSHES.get(self.form, 1.0)
        return self.in_order(over_arrays(guide, *(n[key] for key in keys), n.get("vee_angle", math.pi), factor))
