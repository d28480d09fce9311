"""A drive of two masses on an elastic shaft with backlash as a machine element of a scene."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elastic.compliances.elastic_parts import ElasticPart
from engine.scene.actions import Moment, Time, TorsionalDamping, TorsionalStiffness
from engine.scene.parts import Angle, AngularSpeed, Inertia, Name, Number, Part


class TwoMassDrive(Part):
    """A motor drives a load through a shaft with backlash; all is reduced to one shaft.

    `backlash` is the whole angle through which one end turns freely against the other. The load resists with
    `load_moment`, as dry friction does: at rest it holds up to that moment. `begin` "at rest", the constant
    `motor_moment` closes the whole backlash first; "running", the drive runs with `load_before` at `speed` until at
    time 0 the load jumps to `load_moment`. What happens is computed up to `time`.
    """

    type: Literal["two_mass_drive"]
    begin: Literal["at rest", "running"] = "at rest"
    motor_inertia: Annotated[Inertia, Field(gt=0)]
    load_inertia: Annotated[Inertia, Field(gt=0)]
    stiffness: Annotated[TorsionalStiffness, Field(gt=0)] | None = None
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    damping_ratio: Annotated[Number, Field(ge=0)] | None = None
    backlash: Annotated[Angle, Field(ge=0)] = 0.0
    motor_moment: Annotated[Moment, Field(gt=0)]
    load_moment: Annotated[Moment, Field(ge=0)] = 0.0
    load_before: Annotated[Moment, Field(ge=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    time: Annotated[Time, Field(gt=0)]

    @model_validator(mode="after")
    def _keys_fit(self) -> "TwoMassDrive":
        if (self.stiffness is None) == (self.parts is None):
            raise ValueError("give stiffness or parts, one of the two")
        if self.damping is not None and self.damping_ratio is not None:
            raise ValueError("damping and damping_ratio are given; the shaft has one of the two, or none")
        if (self.begin == "running") != (self.speed is not None) or (self.speed is None) != (self.load_before is None):
            raise ValueError("speed and load_before go with begin = 'running': give both, or neither")
        return self
