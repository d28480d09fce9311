"""Hartnell's governor."""

from typing import Annotated, Literal

from pydantic import Field

from engine.elements.governors.governor import LoadedGovernor
from engine.elements.governors.governor_nodes import Linkage, numbers
from engine.graph.nodes import Graph, Node
from engine.laws.governors.linkages import balls_on_bell_cranks
from engine.parts.skeleton import Length, quantity


class HartnellGovernor(LoadedGovernor):
    """Hartnell's governor: balls on the upright arms of bell cranks, which lift the sleeve against a spring.

    `pivot_radius` is the radius of the cranks' pivots; with the balls at this radius the ball arms are parallel to the
    axis.
    """

    type: Literal["hartnell_governor"]
    ball_arm: Annotated[Length, Field(gt=0)]
    sleeve_arm: Annotated[Length, Field(gt=0)]
    pivot_radius: Annotated[Length, Field(gt=0)]
    stiffness: Annotated[quantity("stiffness"), Field(gt=0)]

    def linkage(self, graph: Graph, x: Node) -> Linkage:
        """Linkage of the bell cranks."""
        keys = ("ball_arm", "sleeve_arm", "pivot_radius")
        return Linkage(*graph.apply(balls_on_bell_cranks, x, *numbers(graph, *keys)))
