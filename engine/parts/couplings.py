"""Couplings of a scene, between a shaft and everything that turns with the crank.

Conventions
-----------
The shaft is geared to the crank. While its coupling slips, the shaft turns at a separate speed, with its inertia,
motors and moments. Slip is the shaft's speed minus the speed at which the crank would drive it. The coupling is open in
regimes that list it as `off`.
"""

from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.parts.actions import Interpolation
from engine.parts.skeleton import Density, Faults, GearedRef, Length, Moment, Number, Part, Time

Share = Annotated[Number, Field(ge=0)]


class FrictionClutch(Part):
    """A friction clutch: it transmits up to `capacity` (torque on its shaft), and slips beyond.

    After its engagement the capacity rises linearly within the time `engagement`, or by a table of its `share`
    `over_time`, interpolated linearly and held after the last row; without either it is complete at once.
    """

    together: ClassVar = (("over_time", "share"),)
    at_most_one_of: ClassVar = (("engagement", "over_time"),)

    type: Literal["friction_clutch"]
    shaft: GearedRef
    capacity: Annotated[Moment, Field(gt=0)]
    engagement: Annotated[Time, Field(gt=0)] | None = None
    over_time: Annotated[list[Time], Field(min_length=2)] | None = None
    share: list[Share] | None = None

    def _faults(self) -> Faults:
        if self.over_time is None:
            return
        if len(self.over_time) != len(self.share):
            yield f"over_time has {len(self.over_time)} rows, share {len(self.share)}: give as many of both"
        steps = zip(self.over_time, self.over_time[1:], strict=False)
        if self.over_time[0] < 0.0 or not all(before < after for before, after in steps):
            yield "over_time starts when the clutch is engaged: its rows must rise from 0 s or later"


class FluidCoupling(Part):
    """A fluid coupling: the faster side drives the slower one with the torque λ(s) ρ ω² D⁵, ω being the faster speed.

    `coefficient` is λ, a table over the `slip` s = 1 − ω₂/ω₁, held after its last row; it starts at 0 for no slip.
    """

    type: Literal["fluid_coupling"]
    shaft: GearedRef
    diameter: Annotated[Length, Field(gt=0)]
    density: Annotated[Density, Field(gt=0)]
    slip: Annotated[list[Number], Field(min_length=2)]
    coefficient: list[Share]
    interpolation: Interpolation

    def _faults(self) -> Faults:
        if len(self.slip) != len(self.coefficient):
            yield f"slip has {len(self.slip)} rows, coefficient {len(self.coefficient)}: give as many"
        if self.slip[0] != 0.0 or self.coefficient[0] != 0.0:
            yield "the table must begin with slip 0 and coefficient 0: without slip nothing is transmitted"
        if not all(before < after for before, after in zip(self.slip, self.slip[1:], strict=False)):
            yield "the rows of slip must rise"


Coupling = Annotated[FrictionClutch | FluidCoupling, Field(discriminator="type")]
