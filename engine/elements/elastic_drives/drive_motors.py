"""Motors that drive two masses on an elastic shaft."""

from typing import Annotated, Literal

from pydantic import Field

from engine.parts.actions import DCCharacteristic, InductionCharacteristic, TableCharacteristic


class DriveDCMotor(DCCharacteristic):
    """A DC motor with a straight characteristic; instead of the stall moment, power and rated speed may be given."""

    type: Literal["dc"]


class DriveInductionMotor(InductionCharacteristic):
    """An induction motor, by Kloss' formula or from its nameplate."""

    type: Literal["induction"]


class DriveTableMotor(TableCharacteristic):
    """A motor by a table of its moment over its speed, with straight lines between; the outermost ones go on.

    All moments are multiplied by `scale`.
    """

    type: Literal["table"]


DriveMotor = Annotated[DriveDCMotor | DriveInductionMotor | DriveTableMotor, Field(discriminator="type")]
