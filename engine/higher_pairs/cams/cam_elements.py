"""A cam as a machine element of a scene: what its follower does over a turn, the follower, and what closes the pair."""

import math
from typing import Annotated, Literal

from pydantic import Field, model_validator

from engine.laws.tables import TableError, make_table
from engine.scene.parts import Angle, AngularSpeed, Inertia, Length, Mass, Name, Number, Part, quantity

Positive = Annotated[Length, Field(gt=0)]
NotNegative = Annotated[Length, Field(ge=0)]
Force = quantity("force")
Moment = quantity("moment")
Stiffness = Annotated[quantity("stiffness"), Field(ge=0)]
TorsionalStiffness = Annotated[quantity("torsional_stiffness"), Field(ge=0)]
LawName = Literal[
    "uniform",
    "parabolic",
    "harmonic",
    "cycloidal",
    "3-4-5",
    "4-5-6-7",
    "modified sine",
    "modified trapezoid",
]
# Angles and strokes as texts have them close to this.
CLOSING = 1e-9


class RiseSection(Part):
    """A part of the turn in which the follower moves away, by `lift`, or an arm by `swing`; `law` says how."""

    type: Literal["rise"]
    law: LawName
    angle: Annotated[Angle, Field(gt=0)] | None = None
    lift: Positive | None = None
    swing: Annotated[Angle, Field(gt=0)] | None = None


class ReturnSection(Part):
    """A part of the turn in which the follower comes back, all the way unless `lift` or `swing` is given."""

    type: Literal["return"]
    law: LawName
    angle: Annotated[Angle, Field(gt=0)] | None = None
    lift: Positive | None = None
    swing: Annotated[Angle, Field(gt=0)] | None = None


class DwellSection(Part):
    """A part of the turn in which the follower rests."""

    type: Literal["dwell"]
    angle: Annotated[Angle, Field(gt=0)] | None = None


Section = Annotated[RiseSection | ReturnSection | DwellSection, Field(discriminator="type")]


class MotionTable(Part):
    """The follower's motion over a turn by rows: `lift`, or `swing` of an arm, over the cam's angle.

    A spline has a continuous acceleration; "pchip" never goes beyond the rows, but its acceleration jumps.
    """

    over_angle: list[Angle]
    lift: list[Length] | None = None
    swing: list[Angle] | None = None
    interpolation: Literal["spline", "pchip"] = "spline"

    @model_validator(mode="after")
    def _makes_a_table(self) -> "MotionTable":
        if (self.lift is None) == (self.swing is None):
            raise ValueError("give lift, or swing of an oscillating follower, one of the two")
        key = "lift" if self.swing is None else "swing"
        try:
            make_table(self.over_angle, self.rows, self.interpolation, 2 * math.pi, names=("over_angle", key))
        except TableError as error:
            raise ValueError(str(error)) from None
        return self

    @property
    def rows(self) -> list[float]:
        """Displacement of each row."""
        return self.lift if self.swing is None else self.swing


class TranslatingFollower(Part):
    """A follower that slides; `offset` of its line of motion from the cam's axis, positive lowers α on the rise.

    `load` presses it on the cam at all times, its weight included. Friction in its guide needs `guide_length` and
    `overhang`, by which it stands out of the guide when it is lowest.
    """

    type: Literal["translating"]
    contact: Literal["roller", "flat", "knife edge"]
    roller_radius: Positive | None = None
    offset: Length = 0.0
    mass: Annotated[Mass, Field(ge=0)] | None = None
    preload: Force = 0.0
    stiffness: Stiffness = 0.0
    load: Force = 0.0
    friction: Annotated[Number, Field(ge=0)] | None = None
    guide_length: Positive | None = None
    overhang: NotNegative | None = None

    @model_validator(mode="after")
    def _contact_fits(self) -> "TranslatingFollower":
        _one_roller(self.contact, self.roller_radius)
        given = [self.friction is None, self.guide_length is None, self.overhang is None]
        if any(given) and not all(given):
            raise ValueError("friction, guide_length and overhang belong together: give all three, or none")
        if self.friction is not None and (self.contact == "flat" or self.mass is None):
            raise ValueError("friction in the guide is that of a roller or knife edge with a mass: leave it out")
        if self.offset and self.contact == "flat":
            raise ValueError("offset = 0 for a flat face: an offset moves the contact along the face, and nothing else")
        return self

    @property
    def moved(self) -> float | None:
        """What inertia the follower has; None without dynamics."""
        return self.mass


class OscillatingFollower(Part):
    """A follower that swings about a pivot at `pivot_distance` from the cam's axis, with a roller or edge on its `arm`.

    A flat face goes through the pivot. As it moves away from the cam it turns against the cam's rotation unless
    `opens` says "with" it. `load` and `preload` are moments about the pivot that press it on the cam.
    """

    type: Literal["oscillating"]
    contact: Literal["roller", "flat", "knife edge"]
    roller_radius: Positive | None = None
    pivot_distance: Positive
    arm: Positive | None = None
    opens: Literal["against", "with"] = "against"
    inertia: Annotated[Inertia, Field(ge=0)] | None = None
    preload: Moment = 0.0
    stiffness: TorsionalStiffness = 0.0
    load: Moment = 0.0

    @model_validator(mode="after")
    def _contact_fits(self) -> "OscillatingFollower":
        _one_roller(self.contact, self.roller_radius)
        if (self.arm is None) != (self.contact == "flat"):
            raise ValueError("arm is the distance of a roller or knife edge from the pivot; a flat face has none")
        return self

    @property
    def moved(self) -> float | None:
        """What inertia the follower has; None without dynamics."""
        return self.inertia


def _one_roller(contact: str, radius: float | None) -> None:
    if (contact == "roller") != (radius is not None):
        raise ValueError(f"roller_radius goes with contact = 'roller'; the contact is {contact!r}")


class LineContact(Part):
    """Contact along a line of a `width`, for its pressure by Hertz; cam and follower have the same material."""

    width: Positive
    elastic_modulus: Annotated[quantity("pressure"), Field(gt=0)] = 206e9
    poisson: Annotated[Number, Field(ge=0, le=0.5)] = 0.3


class CamLimits(Part):
    """What the least base circle must keep: the greatest pressure angle, the least convex radius of the profile."""

    pressure_angle: Annotated[Angle, Field(gt=0, lt=math.pi / 2)] | None = None
    convex_radius: NotNegative | None = None

    @model_validator(mode="after")
    def _limits_something(self) -> "CamLimits":
        if self.pressure_angle is None and self.convex_radius is None:
            raise ValueError("give pressure_angle or convex_radius, or both")
        return self


class CamElement(Part):
    """A cam that turns at a `speed`, and its follower, lifted by sections in the order of the text or by a table.

    `base_radius` is the least of the cam's surface where the displacement is zero. One section may leave out its
    angle: it takes what the others leave of the turn. `closure` is by a spring or load, or by the form: a groove. The
    path of a cutter of `cutter_radius` is drawn and exported; unless given, it is as large as the roller.
    """

    type: Literal["cam"]
    base_radius: Positive
    speed: Annotated[AngularSpeed, Field(gt=0)]
    sections: dict[Name, Section] = {}
    table: MotionTable | None = None
    follower: Annotated[TranslatingFollower | OscillatingFollower, Field(discriminator="type")]
    closure: Literal["spring", "form"] = "spring"
    line_contact: LineContact | None = None
    limits: CamLimits | None = None
    cutter_radius: Positive | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> "CamElement":
        if bool(self.sections) == (self.table is not None):
            raise ValueError("give sections, or a table of the motion over a turn, one of the two")
        self._check_stroke()
        if self.sections:
            self._check_angles()
        self._check_contact()
        return self

    def _check_stroke(self) -> None:
        right, wrong = ("lift", "swing") if self.translating else ("swing", "lift")
        parts = {f"sections.{name}": section for name, section in self.sections.items()}
        for place, part in (parts | ({"table": self.table} if self.table else {})).items():
            if getattr(part, wrong, None) is not None:
                raise ValueError(f"{place}.{wrong}: this follower is {self.follower.type}; give {right} instead")
            if isinstance(part, RiseSection) and getattr(part, right) is None:
                raise ValueError(f"{place}.{right} is missing: say how far the follower moves away")

    def _check_angles(self) -> None:
        angles = [section.angle for section in self.sections.values()]
        whole = sum(angle for angle in angles if angle is not None)
        told = f"the angles of the sections add up to {math.degrees(whole):g} deg"
        if angles.count(None) > 1:
            raise ValueError("angle: only one section may leave it out, and take what is left of the turn")
        if angles.count(None) == 1 and not whole < 2 * math.pi:
            raise ValueError(f"{told}: nothing is left for the section without an angle; make one smaller")
        if None not in angles and abs(whole - 2 * math.pi) > CLOSING:
            raise ValueError(f"{told}, not to 360 deg; leave out one angle, and it follows")
        left = 0.0
        for name, section in self.sections.items():
            if isinstance(section, ReturnSection) and not left > 0.0:
                raise ValueError(f"sections.{name}: the follower is down already; a return comes after a rise")
            left = self._after(section, left)
        if abs(left) > CLOSING * self._greatest_stroke():
            raise ValueError(f"the follower ends the turn {left:g} away from where it began; add a return")

    def _after(self, section: Section, before: float) -> float:
        match section:
            case RiseSection():
                return before + self.stroke_of(section)
            case ReturnSection():
                stroke = self.stroke_of(section)
                return 0.0 if stroke is None else before - stroke
        return before

    def _greatest_stroke(self) -> float:
        return sum(self.stroke_of(s) for s in self.sections.values() if isinstance(s, RiseSection))

    def _check_contact(self) -> None:
        if self.closure == "form" and self.follower.contact != "roller":
            raise ValueError("closure = 'form' is a groove, in which a roller runs; give contact = 'roller'")
        if self.line_contact is not None and (self.follower.contact == "knife edge" or self.follower.moved is None):
            key = "mass" if self.translating else "inertia"
            raise ValueError(f"line_contact: the pressure is that of a roller or flat face of known follower.{key}")
        if self.limits is not None:
            if not self.translating:
                raise ValueError("limits: the least base circle is that of a translating follower; leave limits out")
            if self.follower.contact == "flat" and self.limits.pressure_angle is not None:
                raise ValueError("limits.pressure_angle: a flat face has none; give limits.convex_radius alone")

    @property
    def translating(self) -> bool:
        """Whether the follower slides."""
        return isinstance(self.follower, TranslatingFollower)

    def stroke_of(self, section: RiseSection | ReturnSection) -> float | None:
        """How far the follower moves in a section; None for all the way back.

        Parameters
        ----------
        section : RiseSection or ReturnSection
        """
        return section.lift if self.translating else section.swing
