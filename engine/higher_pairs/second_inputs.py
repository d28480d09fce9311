"""Second inputs as a scene describes them: links that their own drives, or the crank, move by laws of its angle."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.higher_pairs.cams.motion_programs import MotionProgram
from engine.scene.parts import Angle, Length, Name, Number, Part

# Beyond this a harmonic of a drive's law is vibration.
_MOST_ORDER = 24


class AngleHarmonic(Part):
    """A harmonic of the angle of a second input over a turn of the crank: `cosine` · cos kφ + `sine` · sin kφ."""

    order: Annotated[int, Field(ge=1, le=_MOST_ORDER)]
    cosine: Angle = 0.0
    sine: Angle = 0.0


class SlideHarmonic(Part):
    """A harmonic of the place of a second input that slides: `cosine` · cos kφ + `sine` · sin kφ."""

    order: Annotated[int, Field(ge=1, le=_MOST_ORDER)]
    cosine: Length = 0.0
    sine: Length = 0.0


Drive = Literal["own", "crank"]


class SecondCrank(MotionProgram):
    """A link that is turned about a `pivot` by a law of the crank's angle φ.

    Its angle against the link that the pivot is a point of is `phase` + `ratio`·φ, the sum of `harmonics`, and the
    swing of `sections` or of a `table`, which begin at the crank angle `begin`. After sections that don't come back the
    next turn of the crank goes on from where they end. It can carry points, guides and bodies. Its `drive` is its own,
    or the crank's: gears or cams, not described, that stand on the frame and that it drives.
    """

    type: Literal["crank"]
    pivot: Name
    drive: Drive = "own"
    ratio: Number = 0.0
    phase: Angle = 0.0
    harmonics: dict[Name, AngleHarmonic] = {}
    begin: Angle = 0.0

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
        if self.ratio == 0.0 and not (self.harmonics or self.sections or self.table):
            raise ValueError("this link never moves: give a ratio, harmonics, sections or a table")
        if self.advance < 0.0:
            raise ValueError(
                f"sections: they go {math.degrees(-self.advance):g} deg further back than out; make a return shorter, "
                "or leave its swing out, and it goes all the way"
            )
        self._check_no_jumps()
        return self


class SecondSlider(MotionProgram):
    """A link that is moved along a `guide` by a law of the crank's angle φ.

    Its origin lies on the guide, beyond the guide's point by `start`, the sum of `harmonics`, and the lift of
    `sections` or of a `table`, which begin at the crank angle `begin`. It can carry points, guides and bodies. Its
    `drive` is its own, or the crank's: gears or cams, not described, that stand on the frame and that it drives.
    """

    type: Literal["slider"]
    guide: Name
    drive: Drive = "own"
    start: Length = 0.0
    harmonics: dict[Name, SlideHarmonic] = {}
    begin: Angle = 0.0

    @property
    def translating(self) -> bool:
        """Whether it slides."""
        return True

    @model_validator(mode="after")
    def _moves(self) -> "SecondSlider":
        if not (self.harmonics or self.sections or self.table):
            raise ValueError("this link never moves: give harmonics, sections or a table")
        self._check_no_jumps()
        return self


SecondInput = Annotated[SecondCrank | SecondSlider, Field(discriminator="type")]
