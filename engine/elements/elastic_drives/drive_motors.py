"""Motors that drive two masses on an elastic shaft."""

from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.laws.tables import TableError, make_table
from engine.parts.actions import DCCharacteristic, InductionCharacteristic, Moment
from engine.parts.skeleton import AngularSpeed, Number, Part


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
