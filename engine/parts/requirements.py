"""Requirements of a machine: wanted motions, pins and struts to check, limits beyond which the program warns."""

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
    Number,
    Part,
    PointRef,
    Positive,
    Refers,
    SliderInput,
    SliderRef,
)

# Each point adds a curve whose minimum is computed.
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
            yield f"x has {len(self.x)} rows; give 1 to {MOST_PLACES} points"


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
        return [(path, "a sliding input has no crank angle; use the wanted path of a point instead")]
    first, last = wanted.over_angle[0], wanted.over_angle[-1]
    low, high = (0.0, math.tau * drive.revolutions) if drive.turns_fully else (drive.start, drive.stop)
    if first < low - 1e-9 or last > high + 1e-9:
        rows, cycle = (f"{math.degrees(a):g} deg to {math.degrees(b):g} deg" for a, b in ((first, last), (low, high)))
        return [(path, f"{rows} isn't within the range of the crank, {cycle}; give angles in it")]
    return []


# The materials of `engine.laws.buckling`.
StrutMaterialName = Literal["S235", "E335", "grey cast iron"]


class Pin(Part):
    """The pin of a revolute pair: its `diameter` and the `width` of its bearing.

    `pair` is GROUP.first, GROUP.inner or GROUP.second, LINK.JOINT of a free link, input, or a shaft with a pivot.
    """

    pair: Annotated[str, Refers("revolute pair")]
    diameter: Positive
    width: Positive


class Strut(Part):
    """A rod between two joints that may buckle: of a `diameter`, a tube, or flat with a `width` and a `thickness`.

    `end_fixity` is the effective length over the distance of its joints, 1 between two pins. `material` is S235 (mild
    structural steel), E335 (harder machine steel) or grey cast iron.
    """

    link: Annotated[LinkRef, Refers("rod")]
    material: StrutMaterialName = "S235"
    diameter: Positive | None = None
    inner_diameter: Positive | None = None
    width: Positive | None = None
    thickness: Positive | None = None
    end_fixity: Annotated[Number, Field(gt=0)] = 1.0

    def _faults(self) -> Faults:
        round_one, flat_one = self.diameter is not None, self.width is not None and self.thickness is not None
        if round_one == flat_one or (round_one and (self.width or self.thickness)):
            yield "give the diameter of a round rod, or width and thickness of a flat one"
        if self.inner_diameter is not None and not (round_one and self.inner_diameter < self.diameter):
            yield "inner_diameter belongs to a tube: give a larger diameter with it"


class WarningLimits(Part):
    """Limits beyond which the program warns; they change no result, and zero or very large limits never warn.

    `transmission_angle` is the minimum: 40° is usual, 30° suffices for slow machines. `clearance` is the maximum
    clearance volume over the swept volume. `slenderness` is the maximum of a rod in compression, its length over the
    radius of gyration of its section. `rim_width` is the minimum width of a flywheel's rim. `flywheel_ratio` is the
    maximum inertia of a flywheel over the mean reduced inertia of the machine. `friction` is the maximum coefficient
    of friction.
    """

    transmission_angle: Annotated[Angle, Field(ge=0, lt=math.pi / 2)] = math.radians(40)
    clearance: Annotated[Number, Field(gt=0)] = 0.5
    slenderness: Annotated[Number, Field(gt=0)] = 200.0
    rim_width: Annotated[Length, Field(ge=0)] = 1e-3
    flywheel_ratio: Annotated[Number, Field(gt=0)] = 100.0
    friction: Annotated[Number, Field(gt=0)] = 1.5
