"""The drive of the scene's own machine through an elastic shaft, as a machine element of a scene."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.elements.elastic_drives.elastic_shaft import ElasticShaft
from engine.parts.actions import Time
from engine.parts.skeleton import Angle, Inertia, Name, Part


class MachineRun(Part):
    """A run over `time`, at rest on an untwisted shaft at a crank angle or out of the steady motion at φ = 0.

    From then on everything acts but what is `off`: with the motors a stop is followed, without what was off in steady
    motion a sudden load. `backlash` is the whole angle through which one end turns freely against the other: at rest
    it is open, and the motors have to close it; steady motion doesn't know of it.
    """

    begin: Literal["at rest", "steady"] = "at rest"
    angle: Angle = 0.0
    time: Annotated[Time, Field(gt=0)]
    off: tuple[Name, ...] = ()
    backlash: Annotated[Angle, Field(ge=0)] = 0.0

    @model_validator(mode="after")
    def _steady_at_zero(self) -> "MachineRun":
        if self.begin == "steady" and self.angle != 0.0:
            raise ValueError("angle goes with begin = 'at rest': out of steady motion it begins at 0")
        return self


class MachineDrive(ElasticShaft):
    """The scene's motors drive its crank through an elastic shaft.

    At the motors' end turns the `driver`, a shaft of the scene, or a `motor_inertia` that the scene doesn't have;
    everything else of the scene turns with the crank. Stiffness, damping and `motor_inertia` are reduced to the crank.
    What is named as `off` doesn't act in steady motion. A `run` is followed over time.
    """

    type: Literal["machine_drive"]
    driver: Name | None = None
    motor_inertia: Annotated[Inertia, Field(gt=0)] | None = None
    off: tuple[Name, ...] = ()
    run: MachineRun | None = None

    @model_validator(mode="after")
    def _one_driver(self) -> "MachineDrive":
        if (self.driver is None) == (self.motor_inertia is None):
            raise ValueError("give driver (a shaft of the scene) or motor_inertia, one of the two")
        return self
