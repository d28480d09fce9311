"""The drive of the scene's own machine through an elastic shaft, as a machine element of a scene."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elastic.drives.elastic_shaft import ElasticShaft
from engine.scene.parts import Inertia, Name


class MachineDrive(ElasticShaft):
    """The scene's motors drive its crank through an elastic shaft.

    At the motors' end turns the `driver`, a shaft of the scene, or a `motor_inertia` that the scene doesn't have;
    everything else of the scene turns with the crank. Stiffness, damping and `motor_inertia` are reduced to the crank.
    What is named as `off` doesn't act.
    """

    type: Literal["machine_drive"]
    driver: Name | None = None
    motor_inertia: Annotated[Inertia, Field(gt=0)] | None = None
    off: tuple[Name, ...] = ()

    @model_validator(mode="after")
    def _one_driver(self) -> "MachineDrive":
        if (self.driver is None) == (self.motor_inertia is None):
            raise ValueError("give driver (a shaft of the scene) or motor_inertia, one of the two")
        return self
