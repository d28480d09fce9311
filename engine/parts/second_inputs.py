"""Second inputs of a scene: links that move by laws of the first input or of time."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine.parts.motion_programs import MotionProgram
from engine.parts.skeleton import (
    Angle,
    AngularSpeed,
    Faults,
    GuideRef,
    Length,
    Name,
    Number,
    Part,
    PointRef,
    Refers,
    Time,
)

# Harmonics above this order would be vibration.
_MOST_ORDER = 24


class AngleHarmonic(Part):
    """A harmonic of a second input's angle over a turn of its law: `cosine` · cos kτ + `sine` · sin kτ."""

    order: Annotated[int, Field(ge=1, le=_MOST_ORDER)]
    cosine: Angle = 0.0
    sine: Angle = 0.0


class SlideHarmonic(Part):
    """A harmonic of a sliding second input's displacement: `cosine` · cos kτ + `sine` · sin kτ."""

    order: Annotated[int, Field(ge=1, le=_MOST_ORDER)]
    cosine: Length = 0.0
    sine: Length = 0.0


Drive = Literal["own", "crank"]


class MovedByLaw(MotionProgram):
    """A motion by a law that repeats with each turn of its argument τ.

    Without `period` and `travel` the argument is the crank angle φ. With a `period` it is 2π t/`period`, the time t
    being zero where the first input's coordinate is; in regimes it is their time. With a `travel`, under a first input
    that slides by s, it is 2π s/`travel`.
    """

    at_most_one_of: ClassVar = (("period", "travel"),)

    drive: Drive = "own"
    begin: Angle = 0.0
    period: Annotated[Time, Field(gt=0)] | None = None
    travel: Annotated[Length, Field(gt=0)] | None = None

    @property
    def repeats(self) -> bool:
        """Whether parts of its motion repeat with each turn of τ."""
        return bool(self.harmonics or self.sections or self.table)

    def _faults(self) -> Faults:
        lost = self.gives("period", "travel")
        if lost and not self.repeats and getattr(self, "ratio", 0.0) == 0.0:
            yield f"{lost[0]} has no meaning without a ratio, harmonics, sections or a table; give one, or leave it out"
        if self.gives("begin") and not self.sections and self.table is None:
            yield "begin has no meaning without sections or a table; leave it out"
        if self.drive == "crank" and (self.period is not None or getattr(self, "speed", 0.0) != 0.0):
            key = "speed" if self.period is None else "period"
            yield (
                f"{key}: with drive = 'crank' the input follows the crank angle, not time; leave {key} out, or set "
                "drive = 'own'"
            )


class SecondCrank(MovedByLaw):
    """A link that is turned about a `pivot` by a law of the first input or of time; it can carry other parts.

    Its angle relative to the link that carries the pivot is `phase` + `ratio`·τ + `speed`·t, plus the sum of
    `harmonics` and the swing of `sections` or of a `table`, which start at τ = `begin`. τ is the crank angle φ, or
    makes a turn in each `period` or `travel`. If the sections don't return fully, the next turn of τ continues from
    their end. `drive` is "own", a separate drive, or "crank": gears or cams on the frame, not modelled, driven by
    the crank.
    """

    type: Literal["crank"]
    pivot: Annotated[PointRef, Refers("point of one link")]
    ratio: Number = 0.0
    speed: AngularSpeed = 0.0
    phase: Angle = 0.0
    harmonics: dict[Name, AngleHarmonic] = {}

    @property
    def translating(self) -> bool:
        """Whether it translates."""
        return False

    @property
    def advance(self) -> float:
        """Net rotation by its sections per turn of τ [rad]."""
        return self.displacements[-1]

    def _faults(self) -> Faults:
        if self.ratio == 0.0 and self.speed == 0.0 and not self.repeats:
            yield "this link never moves: give a ratio, a speed, harmonics, sections or a table"
        if self.advance < 0.0:
            yield (
                f"sections: the returns exceed the rises by {math.degrees(-self.advance):g} deg; shorten a return, or "
                "omit its swing for a full return"
            )
        yield from self._faults_of_jumps()


class SecondSlider(MovedByLaw):
    """A link that is moved along a `guide` by a law of the first input or of time; it can carry other parts.

    The distance of its origin from the guide's point is `start`, plus the sum of `harmonics` and the lift of `sections`
    or of a `table`, which start at τ = `begin`. τ is the crank angle φ, or makes a turn in each `period` or `travel`.
    `drive` is "own", a separate drive, or "crank": gears or cams on the frame, not modelled, driven by the crank.
    """

    type: Literal["slider"]
    guide: GuideRef
    start: Length = 0.0
    harmonics: dict[Name, SlideHarmonic] = {}

    @property
    def translating(self) -> bool:
        """Whether it translates."""
        return True

    def _faults(self) -> Faults:
        if not self.repeats:
            yield "this link never moves: give harmonics, sections or a table"
        yield from self._faults_of_jumps()


SecondInput = Annotated[SecondCrank | SecondSlider, Field(discriminator="type")]
