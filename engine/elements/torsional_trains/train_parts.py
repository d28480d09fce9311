"""How a torsional train is made: its masses, shafts and gears, and the moments that excite it."""

from typing import Annotated

from pydantic import Field, model_validator

from engine.elements.compliances.elastic_parts import ElasticPart
from engine.parts.actions import Moment, TorsionalDamping, TorsionalStiffness
from engine.parts.skeleton import Angle, Inertia, Name, Number, Part


class TrainMass(Part):
    """A rigid disc, wheel, rotor or throw; `damping` against the frame."""

    inertia: Annotated[Inertia, Field(gt=0)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] = 0.0


class TrainShaft(Part):
    """A shaft between two masses, or a mass and the `frame`; its stiffness given, or that of its parts in series.

    Stiffness and damping are about the axis of the first end. `ratio` is the speed of the second end over that of the
    first, where teeth or belts that give way are among the parts. `energy_absorption` is the share of the greatest
    energy dissipated in a cycle.
    """

    between: tuple[Name, Name]
    stiffness: Annotated[TorsionalStiffness, Field(gt=0)] | None = None
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    energy_absorption: Annotated[Number, Field(ge=0)] | None = None
    ratio: Number = 1.0

    @model_validator(mode="after")
    def _stiffness_in_one_way(self) -> "TrainShaft":
        if (self.stiffness is None) == (self.parts is None):
            raise ValueError("give stiffness or parts, one of the two")
        if self.parts is not None and (self.damping is not None or self.energy_absorption is not None):
            raise ValueError("the parts have their own dampers: give damping or energy_absorption to them")
        if self.ratio == 0:
            raise ValueError("ratio = 0: the ends would not turn together; give speed of the second over the first")
        return self


class TrainGear(Part):
    """Gears that don't give way; `ratio` is the speed of the second mass over that of the first, negative outside."""

    between: tuple[Name, Name]
    ratio: Number

    @model_validator(mode="after")
    def _turns(self) -> "TrainGear":
        if self.ratio == 0:
            raise ValueError("ratio = 0: give the speed of the second mass over that of the first")
        return self


class HarmonicMoment(Part):
    """A moment on a mass, amplitude · cos(order · Ω t + phase), with Ω the `speed`; of order 0 a mean one."""

    on: Name
    order: Annotated[float, Field(ge=0, le=1000)]
    amplitude: Moment
    phase: Angle = 0.0
