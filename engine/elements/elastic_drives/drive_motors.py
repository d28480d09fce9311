"""Motors that drive two masses on an elastic shaft."""

from typing import Annotated, Literal

from pydantic import Field

from engine.parts.actions import DCCharacteristic, InductionCharacteristic, TableCharacteristic


class DriveDCMotor(DCCharacteristic):
    """A DC motor with a linear characteristic; power and rated speed may replace the stall torque."""

    type: Literal["dc"]


class DriveInductionMotor(InductionCharacteristic):
    """An induction motor, by Kloss' formula or from its nameplate."""

    type: Literal["induction"]


class DriveTableMotor(TableCharacteristic):
    """A motor defined by a table of its torque over its speed, with linear interpolation and extrapolation.

    All torques are multiplied by `scale`.
    """

    type: Literal["table"]


DriveMotor = Annotated[DriveDCMotor | DriveInductionMotor | DriveTableMotor, Field(discriminator="type")]
