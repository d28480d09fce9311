"""The elastic shaft of a drive, as elements have it."""

from typing import Annotated

from pydantic import Field, model_validator

from engine.elements.compliances.elastic_parts import ElasticPart
from engine.parts.actions import TorsionalDamping, TorsionalStiffness
from engine.parts.skeleton import Name, Number, Part


class ElasticShaft(Part):
    """Something with an elastic shaft: its stiffness is given, or that of its parts in series."""

    stiffness: Annotated[TorsionalStiffness, Field(gt=0)] | None = None
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    damping_ratio: Annotated[Number, Field(ge=0)] | None = None

    @model_validator(mode="after")
    def _stiff_in_one_way(self) -> "ElasticShaft":
        if (self.stiffness is None) == (self.parts is None):
            raise ValueError("give stiffness or parts, one of the two")
        if self.damping is not None and self.damping_ratio is not None:
            raise ValueError("damping and damping_ratio are given; the shaft has one of the two, or none")
        return self
