"""Elements over their coefficient of friction."""

from collections.abc import Sequence

import numpy as np

from engine.elements.element import PLACES, Element
from engine.elements.panels import Panel, PanelAxis

# Coefficients up to so many times the one given, and as far as dry steel on steel at least.
BEYOND, DRY = 2.0, 0.3


def over_friction(element: Element, *groups: tuple[str, Sequence[str]]) -> tuple[Panel, ...]:
    """Results of an element over its friction, in one diagram for each group; curves end where it jams.

    Parameters
    ----------
    element : Element
        With a `friction`.
    *groups : (str, sequence of str)
        Words, and names of results.
    """
    # A belt without friction carries nothing.
    friction = np.linspace(1e-3, max(BEYOND * element.friction, DRY), PLACES)
    return element.panels_over("friction", PanelAxis("coefficient of friction", "1"), friction, groups)
