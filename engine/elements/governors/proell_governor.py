"""Proell's governor."""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.elements.governors.governor import ArmGovernor
from engine.elements.governors.places import Holding
from engine.parts.skeleton import Length


class ProellGovernor(ArmGovernor):
    """Proell's governor: balls on extensions of the lower arms.

    The extensions are parallel to the axis when the balls are at `parallel_radius`.
    """

    holding: ClassVar = Holding.LOWER_ARMS
    geometry: ClassVar = (*ArmGovernor.geometry[:-1], "extension", "parallel_radius")

    type: Literal["proell_governor"]
    extension: Annotated[Length, Field(gt=0)]
    parallel_radius: Length
