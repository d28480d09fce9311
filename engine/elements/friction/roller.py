"""Rollers on a plane or on each other.

Under a load N the pressure on a roller acts ahead of its middle by k, the arm of rolling friction: M = k N. It rolls
where that needs less force than sliding, otherwise it slides.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines (rolling friction); R. S. Khurmi and J. K. Gupta,
Theory of Machines, chapter 10.
"""

from typing import Annotated, ClassVar, Literal

import numpy as np
from pydantic import Field

from engine.elements.element import PLACES, Element, NamedRows, Numbers
from engine.elements.friction.friction_element import BEYOND, Friction, Load
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, circle, path, plan
from engine.parts.skeleton import Length, Positive
from engine.words.quantity import main_result


class RollerElement(Element):
    """A loaded roller on a plane, pulled at its axle or at `pull_height`, or driving a second roller.

    `rolling_arm` is the arm k of rolling friction, `friction` the coefficient of sliding friction.
    """

    picture: ClassVar = "friction"

    type: Literal["roller"]
    load: Load
    diameter: Positive
    rolling_arm: Annotated[Length, Field(ge=0)]
    friction: Friction
    pull_height: Positive | None = None
    mate_diameter: Positive | None = None

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        load, radius, arm, friction = n["load"], n["diameter"] / 2, n["rolling_arm"], n["friction"]
        rolling, resisting = arm * load, arm / n.get("pull_height", radius)
        yield main_result("rolling_moment", "moment of rolling friction", "N m"), rolling
        yield main_result("rolling_friction", "rolling friction as a coefficient", "1"), resisting
        yield main_result("pull_force", "force that moves the roller", "N"), load * np.minimum(resisting, friction)
        words = "whether the pulled roller rolls (1) or slides (0)"
        yield main_result("rolls", words, "1", exact=True), (resisting < friction).astype(float)
        words = "maximum torque transmitted by sliding friction"
        yield main_result("traction_moment", words, "N m"), friction * load * radius
        if "mate_diameter" in n:
            both = 1 + radius / (n["mate_diameter"] / 2)
            words = "radius of a roller on a plane with the same relative curvature"
            yield main_result("reduced_radius", words, "m"), radius / both
            words = "moment that overcomes the rolling friction of both rollers"
            yield main_result("drive_moment", words, "N m"), rolling * both

    def panels(self) -> tuple[Panel, ...]:
        """The roller with its forces, and the force that moves it over the arm of rolling friction."""
        height = self.diameter / 2 if self.pull_height is None else self.pull_height
        arm = np.linspace(0.0, BEYOND * (self.rolling_arm or self.friction * height), PLACES)
        curve = Curve("force that moves it", self.over("rolling_arm", arm)["pull_force"])
        mark = Mark("as given", self.rolling_arm, None)
        x, y = PanelAxis("arm of rolling friction", "m", "k"), PanelAxis("pull", "N", "F")
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
