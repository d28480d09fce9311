"""Members of a torsional train: masses, shafts and gears, and the torques that excite it."""

from typing import Annotated, ClassVar

from pydantic import Field

from engine.elements.compliances.elastic_parts import ElasticPart
from engine.parts.actions import Moment, TorsionalDamping, TorsionalStiffness
from engine.parts.skeleton import Angle, Faults, Inertia, Name, Number, Part


class TrainMass(Part):
    """A rigid disc, wheel, rotor or throw; `damping` relative to the frame."""

    inertia: Annotated[Inertia, Field(gt=0)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] = 0.0


class TrainShaft(Part):
    """A shaft between two masses, or a mass and the `frame`; its stiffness is given, or that of its parts in series.

    Stiffness and damping are about the axis of the first end. `ratio` is the speed of the second end over that of the
    first, if the parts include elastic teeth or belts. `energy_absorption` is the fraction of the maximum energy
    dissipated in a cycle.
    """

    one_of: ClassVar = (("stiffness", "parts"),)

    between: tuple[Name, Name]
    stiffness: Annotated[TorsionalStiffness, Field(gt=0)] | None = None
    parts: Annotated[dict[Name, ElasticPart], Field(min_length=1)] | None = None
    damping: Annotated[TorsionalDamping, Field(ge=0)] | None = None
    energy_absorption: Annotated[Number, Field(ge=0)] | None = None
    ratio: Number = 1.0

    def _faults(self) -> Faults:
        if self.parts is not None and (self.damping is not None or self.energy_absorption is not None):
            yield "the parts have their own dampers: give damping or energy_absorption to them"
        if self.ratio == 0:
            yield "ratio = 0: the ends would not turn together; give speed of the second over the first"


class TrainGear(Part):
    """Rigid gears; `ratio` is the speed of the second mass over that of the first, negative for external gears."""

    between: tuple[Name, Name]
    ratio: Number

    def _faults(self) -> Faults:
        if self.ratio == 0:
            yield "ratio = 0: give the speed of the second mass over that of the first"


class HarmonicMoment(Part):
    """A torque on a mass, amplitude · cos(order · Ω t + phase), with Ω the `speed`; order 0 is a mean torque."""

    on: Name
    order: Annotated[float, Field(ge=0, le=1000)]
    amplitude: Moment
    phase: Angle = 0.0
