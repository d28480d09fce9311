"""Elements with one coefficient of friction, over which they are shown; and the numbers that such elements have."""

from typing import Annotated, ClassVar

import numpy as np
from pydantic import Field

from engine.elements.element import PLACES, Element, Numbers
from engine.elements.panels import Panel, PanelAxis
from engine.parts.actions import Force
from engine.parts.skeleton import Number, Positive

__all__ = ["BEYOND", "DRY", "Friction", "FrictionElement", "Load", "Positive"]

# Coefficients up to so many times the one given, and as far as dry steel on steel at least.
BEYOND, DRY = 2.0, 0.3
Load = Annotated[Force, Field(gt=0)]
Friction = Annotated[Number, Field(ge=0)]


class FrictionElement(Element):
    """An element with a `friction`.

    Attributes
    ----------
    shown : tuple of (str, tuple of str)
        Words of each of its diagrams, and names of the results in it.
    """

    picture: ClassVar = "friction"
    shown: ClassVar[tuple[tuple[str, tuple[str, ...]], ...]]

    def panels(self, given: Numbers | None = None) -> tuple[Panel, ...]:
        """Results over the friction; curves end where the element jams."""
        # A belt without friction carries nothing.
        friction = np.linspace(1e-3, max(BEYOND * self.friction, DRY), PLACES)
        return self.panels_over("friction", PanelAxis("coefficient of friction", "1"), friction, self.shown)
