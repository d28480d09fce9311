"""Motion programs over a turn of a cam or crank: sections by laws of motion, or a table.

Cam followers and second inputs move by them.
"""

import math
from collections.abc import Mapping
from itertools import accumulate
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from engine import laws
from engine.parts.skeleton import Angle, Faults, Length, Name, Part, Positive

LawName = Literal[
    "uniform", "parabolic", "harmonic", "cycloidal", "3-4-5", "4-5-6-7", "modified sine", "modified trapezoid"
]
_ONE_PROGRAM = "give sections, or a table of the motion over a turn, one of the two"
# Relative tolerance for the sums of angles and strokes of sections.
CLOSING = 1e-9


class RiseSection(Part):
    """A part of the turn with an outward motion by `lift` (translating) or `swing` (oscillating), by the `law`."""

    type: Literal["rise"]
    law: LawName
    angle: Annotated[Angle, Field(gt=0)] | None = None
    lift: Positive | None = None
    swing: Annotated[Angle, Field(gt=0)] | None = None


class ReturnSection(Part):
    """A part of the turn with a return motion, by `lift` or `swing`; without them, complete."""

    type: Literal["return"]
    law: LawName
    angle: Annotated[Angle, Field(gt=0)] | None = None
    lift: Positive | None = None
    swing: Annotated[Angle, Field(gt=0)] | None = None


class DwellSection(Part):
    """A part of the turn without motion."""

    type: Literal["dwell"]
    angle: Annotated[Angle, Field(gt=0)] | None = None


Section = Annotated[RiseSection | ReturnSection | DwellSection, Field(discriminator="type")]


class MotionTable(Part):
    """A motion over a turn by rows: `lift` (translating) or `swing` (oscillating) over the angle of the cam or crank.

    The acceleration of a "spline" is continuous; "pchip" never exceeds the rows, but its acceleration jumps.
    """

    one_of: ClassVar = (("lift", "swing"),)

    over_angle: list[Angle]
    lift: list[Length] | None = None
    swing: list[Angle] | None = None
    interpolation: Literal["spline", "pchip"] = "spline"

    def _faults(self) -> Faults:
        key = "lift" if self.swing is None else "swing"
        names = ("over_angle", key)
        laws.tables.make_table(self.over_angle, self.rows, self.interpolation, math.tau, names=names)

    @property
    def rows(self) -> list[float]:
        """Displacements of the rows."""
        return self.lift if self.swing is None else self.swing


class MotionProgram(Part):
    """A motion over a turn of a cam or the crank: `sections` in the order of the text, or a `table`."""

    sections: dict[Name, Section] = {}
    table: MotionTable | None = None

    @property
    def translating(self) -> bool:
        """Whether the moved link translates."""
        raise NotImplementedError

    @property
    def advance(self) -> float:
        """Net motion per turn [m or rad]; 0 for a follower."""
        return 0.0

    def _faults(self) -> Faults:
        if self.sections and self.table is not None:
            yield (_ONE_PROGRAM)
        yield from self._faults_of_strokes()
        if self.sections:
            yield from self._faults_of_angles()

    def _faults_of_strokes(self) -> Faults:
        right, wrong = ("lift", "swing") if self.translating else ("swing", "lift")
        parts = {f"sections.{name}": section for name, section in self.sections.items()}
        for place, part in (parts | ({"table": self.table} if self.table else {})).items():
            if getattr(part, wrong, None) is not None:
                moves = "slides" if self.translating else "turns"
                yield f"{place}.{wrong}: this link {moves}; give {right} instead"
            if isinstance(part, RiseSection) and getattr(part, right) is None:
                yield f"{place}.{right} is missing: give how far the link moves"

    def _faults_of_angles(self) -> Faults:
        angles = [section.angle for section in self.sections.values()]
        whole = sum(angle for angle in angles if angle is not None)
        total = f"the angles of the sections add up to {math.degrees(whole):g} deg"
        if angles.count(None) > 1:
            yield "angle: only one section may omit it; that section takes the rest of the turn"
        if angles.count(None) == 1 and not whole < math.tau:
            yield f"{total}: nothing is left for the section without an angle; make one smaller"
        if None not in angles and abs(whole - math.tau) > CLOSING:
            yield f"{total}, not to 360 deg; leave out one angle, and it follows"
        *starts, left = self.displacements
        for (name, section), before in zip(self.sections.items(), starts, strict=True):
            if isinstance(section, ReturnSection) and not before > 0.0:
                yield f"sections.{name}: the follower is back already; a return comes after a rise"
        if abs(left - self.advance) > CLOSING * max(self.displacements):
            yield f"the motion ends the turn {left:g} away from where it began; add a return"

    @property
    def displacements(self) -> list[float]:
        """Displacement before each section, and after the last [m or rad]."""
        return [*accumulate(self.sections.values(), self._after, initial=0.0)]

    def _after(self, before: float, section: Section) -> float:
        match section:
            case RiseSection():
                return before + self.stroke_of(section)
            case ReturnSection():
                stroke = self.stroke_of(section)
                return 0.0 if stroke is None else before - stroke
        return before

    def stroke_of(self, section: RiseSection | ReturnSection) -> float | None:
        """Stroke of a section; None for a complete return."""
        return section.lift if self.translating else section.swing

    def _faults_of_jumps(self) -> Faults:
        for name, section in self.sections.items():
            if getattr(section, "law", None) == "uniform":
                yield (
                    f"sections.{name}.law: at both ends of a uniform motion the velocity jumps, which needs "
                    "infinite forces; choose another law, such as 'modified sine'"
                )


class TouchesCam(Part):
    """A follower, by its `contact` with the cam: a roller of some radius, a flat face, or a knife edge."""

    required_with: ClassVar = {"roller_radius": ("contact", ("roller",))}


class CamProgram(MotionProgram):
    """The motion of a follower over a turn of its cam."""

    follower: TouchesCam

    @property
    def translating(self) -> bool:
        """Whether the follower translates."""
        return self.follower.type == "translating"

    def _faults(self) -> Faults:
        if not self.sections and self.table is None:
            yield (_ONE_PROGRAM)
        if self.closure == "form" and self.follower.contact != "roller":
            yield "closure = 'form' is a groove, in which a roller runs; give contact = 'roller'"


class Sections(NamedTuple):
    """Sections of a turn for some variants; one entry per section: float or ndarray (variants,).

    `whole` is true for variants in which the sections add up to a turn and to the net motion of the program.
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
        Prefix of the paths of its numbers, with the final dot.
    numbers : mapping of str to float or ndarray (variants,)
    """
    key = "lift" if program.translating else "swing"
    given = {n: numbers[f"{at}sections.{n}.angle"] for n, s in program.sections.items() if s.angle is not None}
    missing = math.tau - sum(given.values())
    is_open = len(given) < len(program.sections)
    whole = missing > 0.0 if is_open else np.abs(missing) <= CLOSING * math.tau
    found, begin, before, largest = ([], [], [], []), 0.0, 0.0, 0.0
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
        largest = np.maximum(largest, before)
        whole = whole & (before >= -CLOSING * largest)
    return Sections(*found, whole & (np.abs(before - program.advance) <= CLOSING * largest))
