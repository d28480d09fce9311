"""Journals in their bearings."""

from typing import ClassVar, Literal

import numpy as np

from engine.elements.element import PLACES, Columns, Element, ElementResult, Numbers
from engine.elements.friction.friction_element import BEYOND, DRY, Friction, Load, Positive
from engine.elements.panels import Curve, Mark, Panel, PanelAxis, circle, path, plan
from engine.graph.over_arrays import over_arrays
from engine.laws.friction.coefficients import BUSHES
from engine.laws.friction.journals import journal
from engine.parts.skeleton import AngularSpeed


class JournalElement(Element):
    """A journal in its bearing, with line contact, or in a new or worn-in bush that embraces half of it."""

    picture: ClassVar = "friction"
    RESULTS: ClassVar = (
        ElementResult("friction_circle", "radius of the friction circle", "m"),
        ElementResult("friction_moment", "moment of friction in the journal", "N m"),
        ElementResult("friction_power", "power lost in the journal", "W", "speed"),
    )

    type: Literal["journal"]
    load: Load
    diameter: Positive
    friction: Friction
    contact: Literal["line", "new", "worn in"] = "line"
    speed: AngularSpeed | None = None

    def values(self, n: Numbers) -> Columns:
        """Results of a set of variants by name."""
        factor, speed = BUSHES[self.contact], n.get("speed", 0.0)
        return self.in_order(over_arrays(journal, n["load"], n["diameter"], n["friction"], factor, speed))

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
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
