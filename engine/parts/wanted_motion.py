"""Motion wanted of a mechanism: the path of a point, or a motion over the crank angle."""

import math
from typing import Annotated, ClassVar, Literal

from pydantic import Field

from engine import laws
from engine.parts.actions import Interpolation
from engine.parts.skeleton import (
    Angle,
    CrankInput,
    Faults,
    Length,
    LinkRef,
    Part,
    PointRef,
    Refers,
    SliderInput,
    SliderRef,
)

# Each place adds a curve whose minimum is computed.
MOST_PLACES = 100


class WantedPath(Part):
    """Points through which the path of a point should pass, at any positions of the input.

    The deviation at each is its distance from the path.
    """

    type: Literal["path"]
    point: Annotated[PointRef, Refers("moving point")]
    x: list[Length]
    y: list[Length]

    def _faults(self) -> Faults:
        if len(self.x) != len(self.y):
            yield f"x has {len(self.x)} rows, y has {len(self.y)}; give one y for every x"
        if not 1 <= len(self.x) <= MOST_PLACES:
            yield f"x has {len(self.x)} rows; give 1 to {MOST_PLACES} places"


class _OverAngle(Part):
    """A motion wanted over the crank angle, from the first row to the last; elsewhere it is free.

    The deviation is the motion minus `offset` and the curve through the rows.
    """

    rows: ClassVar[str]
    over_angle: list[Angle]
    interpolation: Interpolation = "spline"

    @property
    def wanted(self) -> list[float]:
        """Displacements [m] or angles [rad] of the rows."""
        return getattr(self, self.rows)

    def _faults(self) -> Faults:
        laws.tables.make_table(self.over_angle, self.wanted, self.interpolation, names=("over_angle", self.rows))


class WantedSlide(_OverAngle):
    """Displacement of a slider."""

    rows: ClassVar[str] = "slide"
    type: Literal["slider"]
    of: SliderRef
    slide: list[Length]
    offset: Length = 0.0


class WantedAngle(_OverAngle):
    """Angle of a link; the deviation is at most half a turn in either direction."""

    rows: ClassVar[str] = "angle"
    type: Literal["link"]
    of: Annotated[LinkRef, Refers("moving link")]
    angle: list[Angle]
    offset: Angle = 0.0


WantedMotion = Annotated[WantedPath | WantedSlide | WantedAngle, Field(discriminator="type")]


def wrong_angles(name: str, wanted: WantedMotion, drive: CrankInput | SliderInput) -> list[tuple[str, str]]:
    """Problems with the crank angles of a wanted motion, as (path, message)."""
    if isinstance(wanted, WantedPath):
        return []
    path = f"wanted.{name}.over_angle"
    if not isinstance(drive, CrankInput):
        return [(path, "a sliding input has no crank angle; a path can be wanted of a point")]
    first, last = wanted.over_angle[0], wanted.over_angle[-1]
    low, high = (0.0, 2.0 * math.pi * drive.revolutions) if drive.turns_fully else (drive.start, drive.stop)
    if first < low - 1e-9 or last > high + 1e-9:
        rows, cycle = (f"{math.degrees(a):g} deg to {math.degrees(b):g} deg" for a, b in ((first, last), (low, high)))
        return [(path, f"{rows} isn't within the range of the crank, {cycle}; give angles in it")]
    return []
