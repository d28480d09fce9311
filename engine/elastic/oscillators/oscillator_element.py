"""One mass on a spring with a damper as a machine element of a scene: how it starts, what shakes it."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.scene.actions import Damping, Force, Stiffness, Time
from engine.scene.parts import AngularSpeed, Length, Mass, Number, Part, Speed, quantity

AngularAcceleration = quantity("angular_acceleration")
PositiveLength = Annotated[Length, Field(gt=0)]
Modulus = Annotated[quantity("pressure"), Field(gt=0)]
Ratio = Annotated[Number, Field(ge=0)]
ExcitingSpeed = Annotated[AngularSpeed, Field(ge=0)]
DAMPINGS = ("damping", "damping_ratio", "decrement", "energy_absorption")


class CantileverSpring(Part):
    """A round cantilever that carries the mass at its end; its own mass isn't counted."""

    length: PositiveLength
    diameter: PositiveLength
    bore: Annotated[Length, Field(ge=0)] = 0.0
    elastic_modulus: Modulus

    @model_validator(mode="after")
    def _has_a_wall(self) -> "CantileverSpring":
        if self.bore >= self.diameter:
            raise ValueError(f"bore = {self.bore:g} m: it must be less than the diameter, {self.diameter:g} m")
        return self


class FreeStart(Part):
    """The mass let go: displacement and velocity at the start, and the `time` afterwards at which it is looked at."""

    displacement: Length = 0.0
    velocity: Speed = 0.0
    time: Annotated[Time, Field(ge=0)] = 0.0


class HarmonicForce(Part):
    """A force on the mass that swings about 0 with the angular frequency `speed`."""

    type: Literal["force"]
    amplitude: Annotated[Force, Field(gt=0)]
    speed: ExcitingSpeed


class RotatingUnbalance(Part):
    """A mass off the axis of a rotor on the oscillating mass, which counts it as its own."""

    type: Literal["unbalance"]
    mass: Annotated[Mass, Field(gt=0)]
    radius: PositiveLength
    speed: ExcitingSpeed


class SupportMotion(Part):
    """The support of spring and damper swings with an amplitude."""

    type: Literal["support_motion"]
    amplitude: PositiveLength
    speed: ExcitingSpeed


class RunThrough(Part):
    """A rotor whose speed changes with constant acceleration, from the steady vibration at the speed `start` on."""

    start: Annotated[AngularSpeed, Field(ge=0)]
    acceleration: AngularAcceleration


class OscillatorElement(Part):
    """A mass on a spring, given by its `stiffness` or as a cantilever, with a damper.

    The damper is given by its `damping`, or its `damping_ratio`, the logarithmic `decrement`, or `energy_absorption`,
    the share of the greatest energy dissipated in a cycle at the natural frequency; without any of them there is none.
    """

    type: Literal["oscillator"]
    mass: Annotated[Mass, Field(gt=0)]
    stiffness: Annotated[Stiffness, Field(gt=0)] | None = None
    cantilever: CantileverSpring | None = None
    damping: Annotated[Damping, Field(ge=0)] | None = None
    damping_ratio: Ratio | None = None
    decrement: Ratio | None = None
    energy_absorption: Ratio | None = None
    start: FreeStart | None = None
    excitation: Annotated[HarmonicForce | RotatingUnbalance | SupportMotion, Field(discriminator="type")] | None = None
    run_through: RunThrough | None = None

    @model_validator(mode="after")
    def _one_of_each(self) -> "OscillatorElement":
        if (self.stiffness is None) == (self.cantilever is None):
            raise ValueError("give stiffness or cantilever, one of the two")
        given = [key for key in DAMPINGS if getattr(self, key) is not None]
        if len(given) > 1:
            raise ValueError(f"{' and '.join(given)} are given; the damper has one of {', '.join(DAMPINGS)}")
        if self.run_through is not None and not isinstance(self.excitation, RotatingUnbalance):
            raise ValueError("run_through needs a rotor: give excitation with type = 'unbalance'")
        if self.run_through is not None and self.run_through.acceleration == 0:
            raise ValueError("run_through.acceleration = 0: the speed must change; negative for a run-down")
        return self
