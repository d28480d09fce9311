"""A drive of two masses on an elastic shaft with backlash as a machine element of a scene."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elastic.drives.elastic_shaft import ElasticShaft
from engine.scene.actions import Moment, Time
from engine.scene.parts import Angle, AngularSpeed, Inertia


class TwoMassDrive(ElasticShaft):
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
    backlash: Annotated[Angle, Field(ge=0)] = 0.0
    motor_moment: Annotated[Moment, Field(gt=0)]
    load_moment: Annotated[Moment, Field(ge=0)] = 0.0
    load_before: Annotated[Moment, Field(ge=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    time: Annotated[Time, Field(gt=0)]

    @model_validator(mode="after")
    def _begins_in_one_way(self) -> "TwoMassDrive":
        if (self.begin == "running") != (self.speed is not None) or (self.speed is None) != (self.load_before is None):
            raise ValueError("speed and load_before go with begin = 'running': give both, or neither")
        return self
