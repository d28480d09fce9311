"""What a cam does to its follower over a turn, as a scene says it: sections by laws of motion, or a table.

Second inputs, which have drives of their own, move by the same.
"""

import math
from collections.abc import Mapping
from typing import Annotated, Literal, NamedTuple

import numpy as np
from pydantic import Field, model_validator

from engine import laws
from engine.parts.skeleton import Angle, Length, Name, Part, Positive

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
_ONE_PROGRAM = "give sections, or a table of the motion over a turn, one of the two"
TURN = 2.0 * math.pi
# Shares of a turn, or of a stroke, by which sums of sections may miss their end.
CLOSING = 1e-9


class RiseSection(Part):
    """A part of the turn in which what slides moves away by `lift`, or what turns by `swing`; `law` says how."""

    type: Literal["rise"]
    law: LawName
    angle: Annotated[Angle, Field(gt=0)] | None = None
    lift: Positive | None = None
    swing: Annotated[Angle, Field(gt=0)] | None = None


class ReturnSection(Part):
    """A part of the turn in which what moves comes back, all the way unless `lift` or `swing` is given."""

    type: Literal["return"]
    law: LawName
    angle: Annotated[Angle, Field(gt=0)] | None = None
    lift: Positive | None = None
    swing: Annotated[Angle, Field(gt=0)] | None = None


class DwellSection(Part):
    """A part of the turn in which what moves rests."""

    type: Literal["dwell"]
    angle: Annotated[Angle, Field(gt=0)] | None = None


Section = Annotated[RiseSection | ReturnSection | DwellSection, Field(discriminator="type")]


class MotionTable(Part):
    """A motion over a turn by rows: `lift` of what slides, or `swing` of what turns, over the cam's or crank's angle.

    A spline has a continuous acceleration; "pchip" never goes beyond the rows, but its acceleration jumps.
    """

    over_angle: list[Angle]
    lift: list[Length] | None = None
    swing: list[Angle] | None = None
    interpolation: Literal["spline", "pchip"] = "spline"

    @model_validator(mode="after")
    def _makes_a_table(self) -> "MotionTable":
        if (self.lift is None) == (self.swing is None):
            raise ValueError("give lift for a slider or swing for a rotating link, not both")
        key = "lift" if self.swing is None else "swing"
        names = ("over_angle", key)
        try:
            laws.tables.make_table(self.over_angle, self.rows, self.interpolation, 2 * math.pi, names=names)
        except laws.tables.TableError as error:
            raise ValueError(str(error)) from None
        return self

    @property
    def rows(self) -> list[float]:
        """Displacement of each row."""
        return self.lift if self.swing is None else self.swing


class MotionProgram(Part):
    """A motion over a turn of a cam or the crank: `sections` in the order of the text, or a `table`."""

    sections: dict[Name, Section] = {}
    table: MotionTable | None = None

    @property
    def translating(self) -> bool:
        """Whether what moves slides."""
        raise NotImplementedError

    @property
    def advance(self) -> float:
        """How far what moves gets on in a turn; a follower comes back [m or rad]."""
        return 0.0

    @model_validator(mode="after")
    def _closes(self) -> "MotionProgram":
        if self.sections and self.table is not None:
            raise ValueError(_ONE_PROGRAM)
        self._check_stroke()
        if self.sections:
            self._check_angles()
        return self

    def _check_stroke(self) -> None:
        right, wrong = ("lift", "swing") if self.translating else ("swing", "lift")
        parts = {f"sections.{name}": section for name, section in self.sections.items()}
        for place, part in (parts | ({"table": self.table} if self.table else {})).items():
            if getattr(part, wrong, None) is not None:
                moves = "slides" if self.translating else "turns"
                raise ValueError(f"{place}.{wrong}: what moves here {moves}; give {right} instead")
            if isinstance(part, RiseSection) and getattr(part, right) is None:
                raise ValueError(f"{place}.{right} is missing: say how far it moves away")

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
                raise ValueError(f"sections.{name}: it is back already; a return comes after a rise")
            left = self._after(section, left)
        if abs(left - self.advance) > CLOSING * self._greatest_stroke():
            raise ValueError(f"the motion ends the turn {left:g} away from where it began; add a return")

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

    def stroke_of(self, section: RiseSection | ReturnSection) -> float | None:
        """How far the motion goes in a section; None for all the way back.

        Parameters
        ----------
        section : RiseSection or ReturnSection
        """
        return section.lift if self.translating else section.swing

    def _check_no_jumps(self) -> None:
        """Refuse laws by which masses can't move."""
        for name, section in self.sections.items():
            if getattr(section, "law", None) == "uniform":
                raise ValueError(
                    f"sections.{name}.law: at both ends of a uniform motion velocities jump, and with them all that "
                    "has mass; take another law, such as 'modified sine'"
                )


class CamProgram(MotionProgram):
    """The motion of a follower over a turn of its cam."""

    follower: Part

    @property
    def translating(self) -> bool:
        """Whether the follower slides."""
        return self.follower.type == "translating"

    @model_validator(mode="after")
    def _has_one(self) -> "CamProgram":
        if not self.sections and self.table is None:
            raise ValueError(_ONE_PROGRAM)
        return self


class Sections(NamedTuple):
    """Sections of a turn with the numbers of some variants: lists of float or ndarray (variants,), one for each.

    `whole` says for each variant whether they make a turn that ends where that of the scene does.
    """

    begin: list[float | np.ndarray]
    angle: list[float | np.ndarray]
    before: list[float | np.ndarray]
    stroke: list[float | np.ndarray]
    whole: bool | np.ndarray


def sections_of(program: MotionProgram, at: str, numbers: Mapping[str, float | np.ndarray]) -> Sections:
    """Sections of a program.

    Parameters
    ----------
    program : MotionProgram
    at : str
        What stands before its keys in the paths of numbers, with a dot at its end.
    numbers : mapping of str to float or ndarray (variants,)
    """
    key = "lift" if program.translating else "swing"
    given = {n: numbers[f"{at}sections.{n}.angle"] for n, s in program.sections.items() if s.angle is not None}
    missing = TURN - sum(given.values())
    is_open = len(given) < len(program.sections)
    whole = missing > 0.0 if is_open else np.abs(missing) <= CLOSING * TURN
    found, begin, before, greatest = ([], [], [], []), 0.0, 0.0, 0.0
    for name, section in program.sections.items():
        stroke = 0.0
        if isinstance(section, RiseSection):
            stroke = numbers[f"{at}sections.{name}.{key}"]
        elif not isinstance(section, DwellSection):
            stroke = -before if program.stroke_of(section) is None else -numbers[f"{at}sections.{name}.{key}"]
        angle = given.get(name, missing)
        for row, value in zip(found, (begin, angle, before, stroke), strict=True):
            row.append(value)
        begin, before = begin + angle, before + stroke
        greatest = np.maximum(greatest, before)
        whole = whole & (before >= -CLOSING * greatest)
    return Sections(*found, whole & (np.abs(before - program.advance) <= CLOSING * greatest))


def check_roller(contact: str, radius: float | None) -> None:
    """Refuse a roller without a radius, and the radius of what is none.

    Parameters
    ----------
    contact : str
    radius : float or None

    Raises
    ------
    ValueError
        A roller has none, or what is no roller has one.
    """
    if contact == "roller" and radius is None:
        raise ValueError("roller_radius is missing: contact = 'roller' needs it")
    if contact != "roller" and radius is not None:
        raise ValueError(f"roller_radius goes with contact = 'roller'; the contact is {contact!r}")
