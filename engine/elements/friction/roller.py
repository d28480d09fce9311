"""Rollers on a plane or on each other."""

import math
from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import PLACES, Columns, Element, ElementResult, Numbers
from engine.elements.friction.friction_element import BEYOND, Friction, Load, Positive
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, circle, path, plan
from engine.graph.over_arrays import over_arrays
from engine.laws.friction.rolling import roller
from engine.parts.skeleton import Length


class RollerElement(Element):
    """A loaded roller on a plane, pulled at its axle or at `pull_height`, or driving a second roller.

    `rolling_arm` is the arm k of rolling friction, `friction` the coefficient of sliding friction.
    """

    picture: ClassVar = "friction"
    RESULTS: ClassVar = (
        ElementResult("rolling_moment", "moment of rolling friction", "N m"),
        ElementResult("rolling_friction", "rolling friction as a coefficient", "1"),
        ElementResult("pull_force", "force that moves the roller", "N"),
        ElementResult("rolls", "whether the pulled roller rolls (1) or slides (0)", "1", exact=True),
        ElementResult("traction_moment", "maximum torque transmitted by sliding friction", "N m"),
        ElementResult("reduced_radius", "radius of the roller on a plane that fits as closely", "m", "mate_diameter"),
        ElementResult(
            "drive_moment", "moment that overcomes the rolling friction of both rollers", "N m", "mate_diameter"
        ),
    )

    type: Literal["roller"]
    load: Load
    diameter: Positive
    rolling_arm: Annotated[Length, Field(ge=0)]
    friction: Friction
    pull_height: Positive | None = None
    mate_diameter: Positive | None = None

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        height, mate = n.get("pull_height", n["diameter"] / 2), n.get("mate_diameter", math.inf)
        keys = ("load", "diameter", "rolling_arm", "friction")
        return self.in_order(over_arrays(roller, *(n[key] for key in keys), height, mate))

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """The roller with its forces, and the force that moves it over the arm of rolling friction."""
        height = self.diameter / 2 if self.pull_height is None else self.pull_height
        arm = np.linspace(0.0, BEYOND * (self.rolling_arm or self.friction * height), PLACES)
        curve = Curve("force that moves it", self.over("rolling_arm", arm)["pull_force"])
        mark = Mark("as given", self.rolling_arm, None)
        x, y = PanelAxis("arm of rolling friction", "m", "e"), PanelAxis("pull", "N", "F")
        over = Panel(x, y, arm, (curve,), (mark,))
        r, k = 0.5 * self.diameter, self.rolling_arm
        lines = (
            circle("", r, 1j * r),
            path("", (-2.0 * r, 2.0 * r), True),
            path("load", (3j * r, 1j * r)),
            path("pull", (1j * height, 2.0 * r + 1j * height)),
            path("reaction, ahead by the arm", (k, k - 1j * r)),
        )
        return plan(lines), over
