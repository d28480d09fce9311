"""Hartnell's governor."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.governors.governor import LoadedGovernor
from engine.elements.governors.places import Holding
from engine.parts.skeleton import Length, quantity


class HartnellGovernor(LoadedGovernor):
    """Hartnell's governor: balls on the upright arms of bell cranks, which lift the sleeve against a spring.

    `pivot_radius` is that of the cranks' pivots; there the ball arms are parallel to the axis.
    """

    holding: ClassVar = Holding.BELL_CRANKS
    geometry: ClassVar = ("ball_arm", "sleeve_arm", "pivot_radius")

    type: Literal["hartnell_governor"]
    ball_arm: Annotated[Length, Field(gt=0)]
    sleeve_arm: Annotated[Length, Field(gt=0)]
    pivot_radius: Annotated[Length, Field(gt=0)]
    stiffness: Annotated[quantity("stiffness"), Field(gt=0)]
