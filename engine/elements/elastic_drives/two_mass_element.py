"""A drive of two masses on an elastic shaft with backlash as a machine element of a scene."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elements.elastic_drives.elastic_shaft import ElasticShaft
from engine.laws.tables import TableError, make_table
from engine.parts.actions import DCCharacteristic, InductionCharacteristic, Moment, Time
from engine.parts.skeleton import Angle, AngularSpeed, Inertia, Number, Part


class DriveDCMotor(DCCharacteristic):
    """A DC motor with a straight characteristic; instead of the stall moment, power and rated speed may be given."""

    type: Literal["dc"]


class DriveInductionMotor(InductionCharacteristic):
    """An induction motor, by Kloss' formula or from its nameplate."""

    type: Literal["induction"]


class DriveTableMotor(Part):
    """A motor by a table of its moment over its speed, with straight lines between; the outermost ones go on.

    All moments are multiplied by `scale`.
    """

    type: Literal["table"]
    speed: list[AngularSpeed]
    moment: list[Moment]
    scale: Annotated[Number, Field(gt=0)] = 1.0

    @model_validator(mode="after")
    def _table_is_sound(self) -> "DriveTableMotor":
        try:
            make_table(self.speed, self.moment, "linear", outside="hold", names=("speed", "moment"))
        except TableError as error:
            raise ValueError(str(error)) from None
        if any(after <= before for before, after in pairwise(self.speed)):
            raise ValueError("speed: every row must lie above the one before; a moment that jumps is not followed")
        return self


DriveMotor = Annotated[DriveDCMotor | DriveInductionMotor | DriveTableMotor, Field(discriminator="type")]


class TwoMassDrive(ElasticShaft):
    """A motor drives a load through a shaft with backlash; all is reduced to one shaft.

    `backlash` is the whole angle through which one end turns freely against the other. The load resists with
    `load_moment`, as dry friction does: at rest it holds up to that moment. The motor drives with the constant
    `motor_moment`, or as a `motor` whose moment depends on its speed. `begin` "at rest", it closes the whole backlash
    first; "running", the drive runs with `load_before` at `speed` until at time 0 the load jumps to `load_moment`. What
    happens is computed up to `time`.
    """

    type: Literal["two_mass_drive"]
    begin: Literal["at rest", "running"] = "at rest"
    motor_inertia: Annotated[Inertia, Field(gt=0)]
    load_inertia: Annotated[Inertia, Field(gt=0)]
    backlash: Annotated[Angle, Field(ge=0)] = 0.0
    motor_moment: Annotated[Moment, Field(gt=0)] | None = None
    motor: DriveMotor | None = None
    load_moment: Annotated[Moment, Field(ge=0)] = 0.0
    load_before: Annotated[Moment, Field(ge=0)] | None = None
    speed: Annotated[AngularSpeed, Field(gt=0)] | None = None
    time: Annotated[Time, Field(gt=0)]

    @model_validator(mode="after")
    def _begins_in_one_way(self) -> "TwoMassDrive":
        if (self.begin == "running") != (self.speed is not None) or (self.speed is None) != (self.load_before is None):
            raise ValueError("speed and load_before go with begin = 'running': give both, or neither")
        return self

    @model_validator(mode="after")
    def _driven_in_one_way(self) -> "TwoMassDrive":
        if (self.motor_moment is None) == (self.motor is None):
            raise ValueError("give motor_moment (constant) or motor (its moment by its speed), one of the two")
        return self
