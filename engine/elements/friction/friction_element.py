"""Elements with one coefficient of friction, over which their results are drawn; and types of their numbers."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from engine.elements.element import PLACES, Element
from engine.elements.panels import Panel, PanelAxis
from engine.parts.actions import Force
from engine.parts.skeleton import Number
from engine.words.verdicts import Verdict

# Range of the diagrams relative to the given coefficient, but at least up to dry steel on steel.
BEYOND, DRY = 2.0, 0.3
Load = Annotated[Force, Field(gt=0)]
Friction = Annotated[Number, Field(ge=0)]

# Axes of results.
FORCE, TORQUE = PanelAxis("force", "N", "F"), PanelAxis("torque", "N m", "M")
EFFICIENCY, RATIO = PanelAxis("efficiency", "1", "η"), PanelAxis("ratio", "1", "i")


class FrictionElement(Element):
    """An element with a coefficient of `friction`.

    Attributes
    ----------
    shown : tuple of (PanelAxis, tuple of str)
        The y axis of each diagram, and names of the results in it.
    """

    infinite: ClassVar = Verdict.JAMS
    picture: ClassVar = "friction"
    shown: ClassVar[tuple[tuple[PanelAxis, tuple[str, ...]], ...]]

    def panels(self) -> tuple[Panel, ...]:
        """Results over the coefficient of friction; curves end where the element jams."""
        # A belt without friction transmits nothing.
        friction = np.linspace(1e-3, max(BEYOND * self.friction, DRY), PLACES)
        return self.panels_over("friction", PanelAxis("coefficient of friction", "1", "μ"), friction, self.shown)
