"""Journals in their bearings.

While the journal turns, the resultant R of pressure and friction passes its middle at the distance ρ, the radius of the
friction circle, and resists with M = R ρ. For contact on a single line, ρ = r sin φ, tan φ = f. A bush around half of
the journal multiplies it by 4/π (pressure with the cosine of the angle from its middle, as after even wear) or π/2
(even pressure).

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines (friction circle, worn-in and new journals). The value
1.47 sometimes printed for the new journal is a misprint of π/2 = 1.57.
"""

from typing import ClassVar, Literal

import numpy as np

from engine.elements.element import PLACES, Element, NamedRows, Numbers
from engine.elements.friction.friction_element import BEYOND, DRY, Friction, Load
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, circle, path, plan
from engine.laws.friction.coefficients import BUSHES
from engine.parts.skeleton import AngularSpeed, Positive
from engine.words.quantity import main_result


class JournalElement(Element):
    """A journal in its bearing, with line contact, or in a new or worn-in bush that embraces half of it."""

    picture: ClassVar = "friction"

    type: Literal["journal"]
    load: Load
    diameter: Positive
    friction: Friction
    contact: Literal["line", "new", "worn in"] = "line"
    speed: AngularSpeed | None = None

    def named(self, n: Numbers) -> NamedRows:
        """Results of a set of variants."""
        circle = BUSHES[self.contact] * n["diameter"] / 2 * n["friction"] / np.sqrt(1 + n["friction"] ** 2)
        moment = n["load"] * circle
        yield main_result("friction_circle", "radius of the friction circle", "m"), circle
        yield main_result("friction_moment", "friction torque in the journal", "N m"), moment
        if "speed" in n:
            yield main_result("friction_power", "power lost in the journal", "W"), moment * np.abs(n["speed"])

    def panels(self) -> tuple[Panel, ...]:
        """The journal with its friction circle and forces, and the friction torque over the coefficient, by contact."""
        friction = np.linspace(0.0, max(BEYOND * self.friction, DRY), PLACES)
        contacts = {contact: self.model_copy(update={"contact": contact}) for contact in ("line", "new", "worn in")}
        curves = [Curve(contact, it.over("friction", friction)["friction_moment"]) for contact, it in contacts.items()]
        x, y = PanelAxis("coefficient of friction", "1", "μ"), PanelAxis("friction torque", "N m", "M")
        over = Panel(x, y, friction, curves, (Mark("as given", self.friction, None),), "by contact")
        # The journal turns to the left; the reaction on the right of its centre opposes it.
        radius, rho = 0.5 * self.diameter, self.own_values()["friction_circle"]
        lines = circle("", radius), circle("friction circle", rho), path("load", (2j * radius, 0.0))
        return plan((*lines, path("reaction", (rho, rho - 2j * radius))), "Turning to the left"), over
