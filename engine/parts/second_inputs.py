"""Second inputs as a scene describes them: links that move by laws of the first input or of time."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.parts.motion_programs import MotionProgram
from engine.parts.skeleton import Angle, AngularSpeed, GuideRef, Length, Name, Number, Part, PointRef, Time

# Beyond this a harmonic of a drive's law is vibration.
_MOST_ORDER = 24


class AngleHarmonic(Part):
    """A harmonic of the angle of a second input over a turn of its law: `cosine` · cos kτ + `sine` · sin kτ."""

    order: Annotated[int, Field(ge=1, le=_MOST_ORDER)]
    cosine: Angle = 0.0
    sine: Angle = 0.0


class SlideHarmonic(Part):
    """A harmonic of the place of a second input that slides: `cosine` · cos kτ + `sine` · sin kτ."""

    order: Annotated[int, Field(ge=1, le=_MOST_ORDER)]
    cosine: Length = 0.0
    sine: Length = 0.0


Drive = Literal["own", "crank"]


class MovedByLaw(MotionProgram):
    """A motion by a law that is periodic in its argument τ, with period 2π.

    The crank's angle φ is the argument of a law without `period` and `travel`. With a `period` it is 2π t/period, the
    time t being zero with the first input's coordinate; under a first input that slides by s, 2π s/`travel`.
    """

    drive: Drive = "own"
    begin: Angle = 0.0
    period: Annotated[Time, Field(gt=0)] | None = None
    travel: Annotated[Length, Field(gt=0)] | None = None

    @property
    def repeats(self) -> bool:
        """Whether its motion has parts that come again with each turn of τ."""
        return bool(self.harmonics or self.sections or self.table)

    @model_validator(mode="after")
    def _has_one_argument(self) -> "MovedByLaw":
        if self.period is not None and self.travel is not None:
            raise ValueError("give period, of a law of time, or travel, of one of the first input, one of the two")
        lost = self.gives("period", "travel")
        if lost and not self.repeats and getattr(self, "ratio", 0.0) == 0.0:
            raise ValueError(f"{lost[0]} is what a ratio, harmonics, sections or a table go by, and there are none")
        if self.gives("begin") and not self.sections and self.table is None:
            raise ValueError("begin is where sections or a table begin, and there are none; leave it out")
        if self.drive == "crank" and (self.period is not None or getattr(self, "speed", 0.0) != 0.0):
            key = "speed" if self.period is None else "period"
            raise ValueError(
                f"{key}: what the crank drives follows the crank's angle, not the time; leave {key} out, or set "
                "drive = 'own'"
            )
        return self


class SecondCrank(MovedByLaw):
    """A link that is turned about a `pivot` by a law of the first input or of time.

    Its angle against the link that the pivot is a point of is `phase` + `ratio`·τ + `speed`·t, the sum of `harmonics`,
    and the swing of `sections` or of a `table`, which begin at τ = `begin`. τ is the crank's angle φ, or goes through
    a turn in each `period` or `travel`. After sections that don't come back the next turn of τ goes on from where they
    end. It can carry points, guides and bodies. Its `drive` is its own, or the crank's: gears or cams, not described,
    that stand on the frame and that it drives.
    """

    type: Literal["crank"]
    pivot: PointRef
    ratio: Number = 0.0
    speed: AngularSpeed = 0.0
    phase: Angle = 0.0
    harmonics: dict[Name, AngleHarmonic] = {}

    @property
    def translating(self) -> bool:
        """Whether it slides."""
        return False

    @property
    def advance(self) -> float:
        """How far its sections turn it on in a turn of the crank [rad]."""
        before = 0.0
        for section in self.sections.values():
            before = self._after(section, before)
        return before

    @model_validator(mode="after")
    def _moves(self) -> "SecondCrank":
        if self.ratio == 0.0 and self.speed == 0.0 and not self.repeats:
            raise ValueError("this link never moves: give a ratio, a speed, harmonics, sections or a table")
        if self.advance < 0.0:
            raise ValueError(
                f"sections: they go {math.degrees(-self.advance):g} deg further back than out; make a return shorter, "
                "or leave its swing out, and it returns fully"
            )
        self._check_no_jumps()
        return self


class SecondSlider(MovedByLaw):
    """A link that is moved along a `guide` by a law of the first input or of time.

    Its origin lies on the guide, beyond the guide's point by `start`, the sum of `harmonics`, and the lift of
    `sections` or of a `table`, which begin at τ = `begin`. τ is the crank's angle φ, or goes through a turn in each
    `period` or `travel`. It can carry points, guides and bodies. Its `drive` is its own, or the crank's: gears or cams,
    not described, that stand on the frame and that it drives.
    """

    type: Literal["slider"]
    guide: GuideRef
    start: Length = 0.0
    harmonics: dict[Name, SlideHarmonic] = {}

    @property
    def translating(self) -> bool:
        """Whether it slides."""
        return True

    @model_validator(mode="after")
    def _moves(self) -> "SecondSlider":
        if not self.repeats:
            raise ValueError("this link never moves: give harmonics, sections or a table")
        self._check_no_jumps()
        return self


SecondInput = Annotated[SecondCrank | SecondSlider, Field(discriminator="type")]
