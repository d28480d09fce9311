"""Hartnell's governor."""

from typing import Annotated, Literal

from pydantic import Field

from engine.elements.governors.governor import LoadedGovernor
from engine.elements.governors.governor_forces import Linkage, along_axis, numbers
from engine.graph.nodes import Graph, Node
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
        """Right-angled bell cranks, whose rollers bear on a flat collar: the lift is proportional to the radius."""
        ball_arm, sleeve_arm, pivot = numbers(graph, "ball_arm", "sleeve_arm", "pivot_radius")
        return Linkage(x, along_axis(x, pivot, ball_arm), (x - pivot) * (sleeve_arm / ball_arm))
