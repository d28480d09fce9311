"""Racks, pinions and their like that drive a mechanism, as a scene describes them."""

import math
from typing import Annotated

from pydantic import Field, field_validator, model_validator

from engine.scene.parts import Angle, Length, Name, Part


class ToothedBar(Part):
    """What a rack that is driven and a pinion that is driven have in common.

    `pivot` is the pinion's axis: a point of what carries the rack's guide, or of a slider on that guide. With a
    positive `radius` of the pinion's pitch circle the rack moves along the guide's direction as the pinion turns
    counter-clockwise, and lies to the right of the axis; with a negative one it is the other way round.
    """

    pivot: Name
    radius: Length
    pressure_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] = 0.0

    @field_validator("radius")
    @classmethod
    def _has_a_size(cls, radius: float) -> float:
        if radius == 0.0:
            raise ValueError("a pinion with the radius 0 moves no rack: give the radius of its pitch circle")
        return radius


class Rack(ToothedBar):
    """A link that slides on a `guide`, driven by a `pinion`: the crank, a shaft with a pivot, or another pinion.

    Its origin lies on the guide, `start` beyond the pinion's axis where the pinion's angle against what carries the
    guide is zero; its x axis lies along the guide.
    """

    pinion: Name
    guide: Name
    start: Length = 0.0


class Pinion(ToothedBar):
    """A link that turns about its `pivot`, driven by a `rack`, which is any slider on a guide.

    Without a rack that moves, it rolls on one that lies along the `guide` on which its axis slides. Its angle against
    what carries the guide is `phase` where the rack's origin, or the guide's point, is beside the axis.
    """

    rack: Name | None = None
    guide: Name | None = None
    phase: Angle = 0.0

    @model_validator(mode="after")
    def _has_one_rack(self) -> "Pinion":
        if (self.rack is None) == (self.guide is None):
            raise ValueError("give either rack, the slider that drives it, or guide, along which a fixed rack lies")
        return self
