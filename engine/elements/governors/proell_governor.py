"""Proell's governor."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.governors.governor import ArmGovernor
from engine.elements.governors.places import Holding
from engine.parts.skeleton import Length, Mass


class ProellGovernor(ArmGovernor):
    """Proell's governor: balls on extensions of the lower arms.

    The extensions are parallel to the axis when the balls are at `parallel_radius`. `extension_mass` is that of one,
    a uniform rod from the joint to the ball.
    """

    holding: ClassVar = Holding.LOWER_ARMS
    geometry: ClassVar = (*ArmGovernor.geometry[:-1], "extension", "parallel_radius")
    arms: ClassVar = (*ArmGovernor.arms, "extension_mass")

    type: Literal["proell_governor"]
    extension: Annotated[Length, Field(gt=0)]
    extension_mass: Annotated[Mass, Field(ge=0)] = 0.0
    parallel_radius: Length
