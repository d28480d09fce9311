"""Proell's governor."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field

from engine.cycle.regula_falsi import regula_falsi
from engine.elements.governors.equilibria import GovernorVariants
from engine.elements.governors.governor import ARMS, ArmGovernor
from engine.elements.governors.governor_forces import Linkage, along_axis, numbers
from engine.graph.nodes import Graph, Node
from engine.parts.skeleton import Length

# Samples for bracketing the position at a radius.
_SAMPLES = 64


class ProellGovernor(ArmGovernor):
    """Proell's governor: balls on extensions of the lower arms.

    The extensions are parallel to the axis when the balls are at `parallel_radius`.
    """

    type: Literal["proell_governor"]
    extension: Annotated[Length, Field(gt=0)]
    parallel_radius: Length

    def linkage(self, graph: Graph, x: Node) -> Linkage:
        """Linkage of the arms, with the balls on extensions of the lower ones."""
        lower, pivot, extension, parallel = numbers(graph, "lower_arm", "lower_pivot", "extension", "parallel_radius")
        arms, along = super().linkage(graph, x), along_axis(x, pivot, lower)
        # The extension leans outwards by the lower arm's angle minus that angle at the position of parallel extensions.
        sine, share = (parallel - pivot) / lower, extension / lower
        cosine = graph.function("sqrt", 1.0 - sine * sine)
        radius = x + share * ((x - pivot) * cosine - along * sine)
        return Linkage(radius, arms.balls + share * ((x - pivot) * sine + along * cosine), arms.sleeve)

    def position_of(self, g: GovernorVariants, radius: np.ndarray) -> np.ndarray:
        """Radii of the joints; of two solutions the first at which the sleeve rises."""
        upper, lower, upper_pivot, lower_pivot = (g.n[key] for key in ARMS)
        low = np.maximum(upper_pivot - upper, lower_pivot - lower)
        high = np.minimum(upper_pivot + upper, lower_pivot + lower)
        # Without both ends: there an arm is at right angles to the axis.
        places = low + (np.arange(_SAMPLES)[:, None] + 0.5) * ((high - low) / _SAMPLES)
        found = g.at(places)
        below = found.radius - radius < 0.0
        crossed = below[:-1] & (found.lift_rate[:-1] > 0.0) & (found.radius[1:] - radius >= 0.0)
        k = crossed.argmax(axis=0)
        a, b = (np.take_along_axis(places, k[None] + i, axis=0)[0] for i in (0, 1))
        x = regula_falsi(lambda x: g.at(x).radius - radius, a, b)
        return np.where(crossed.any(axis=0), g.moved(x, "radius", radius), np.nan)
