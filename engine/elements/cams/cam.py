"""Cams: the shape of their profile, the motion of their follower, forces, and the least base circle."""

import math
from collections.abc import Callable, Iterator
from enum import IntEnum
from functools import partial
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from numba import types
from pydantic import Field, model_validator

from engine.compiling.running import prepare
from engine.elements.cams.cam_extremes import (
    ACCELERATION_JUMP,
    ANSWERS,
    HALVINGS,
    MEAN_MOMENT,
    SAMPLES,
    VELOCITY_DROP,
    VELOCITY_JUMP,
    TurnExtreme,
    find_extremes,
)
from engine.elements.cams.cam_places import (
    ARM,
    DISTANCE,
    LIMIT_RADIUS,
    MODULUS,
    NEVER,
    POISSON,
    QUANTITIES,
    ROLLER,
    WIDTH,
)
from engine.elements.cams.followers import CamLimits, LineContact, OscillatingFollower, TranslatingFollower
from engine.elements.cams.least_base_circle import least_arm_angles
from engine.elements.cams.pieces import (
    PIECE_NUMBERS,
    PIECES_OF_A_SECTION,
    cut_table,
)
from engine.elements.element import ROUNDING, Answers, Element, ElementResult, Numbers
from engine.laws.cams.motion_laws import DWELL, LAW_KINDS
from engine.laws.cams.profiles import least_arm_angle, pressure_of_lines
from engine.laws.rounding import EPS
from engine.laws.tables import make_table
from engine.parts.motion_programs import CamProgram, DwellSection, Positive, RiseSection
from engine.parts.skeleton import AngularSpeed
from engine.verdicts import Verdict

# An arm that is nearly in line with the line of centres; in line, its cam would have no room.
_LEAST_ANGLE = 1e-9
Found = tuple[np.ndarray, np.ndarray]


class Sought(NamedTuple):
    """What `find_extremes` finds of a set of variants: ndarrays (variants, ANSWERS), verdicts (variants,)."""

    values: np.ndarray
    sizes: np.ndarray
    places: np.ndarray
    spreads: np.ndarray
    verdicts: np.ndarray


class CamElement(CamProgram, Element):
    """A cam that turns at a `speed`, and its follower, lifted by sections in the order of the text or by a table.

    `base_radius` is the least of the cam's surface where the displacement is zero. One section may leave out its
    angle: it takes what the others leave of the turn. `closure` is by a spring or load, or by the form: a groove. The
    path of a cutter of `cutter_radius` is drawn and exported; unless given, it is as large as the roller.
    """

    variants_at_once: ClassVar = 256

    type: Literal["cam"]
    base_radius: Positive
    speed: Annotated[AngularSpeed, Field(gt=0)]
    follower: Annotated[TranslatingFollower | OscillatingFollower, Field(discriminator="type")]
    closure: Literal["spring", "form"] = "spring"
    line_contact: LineContact | None = None
    limits: CamLimits | None = None
    cutter_radius: Positive | None = None

    @model_validator(mode="after")
    def _is_whole(self) -> "CamElement":
        self._check_contact()
        return self

    def _check_contact(self) -> None:
        if self.closure == "form" and self.follower.contact != "roller":
            raise ValueError("closure = 'form' is a groove, in which a roller runs; give contact = 'roller'")
        if self.line_contact is not None and (self.follower.contact == "knife edge" or self.follower.moved is None):
            key = "mass" if self.translating else "inertia"
            raise ValueError(f"line_contact: the pressure is that of a roller or flat face of known follower.{key}")
        if self.follower.contact == "flat" and self.limits is not None and self.limits.pressure_angle is not None:
            raise ValueError("limits.pressure_angle: a flat face has none; give limits.convex_radius alone")

    def results(self) -> tuple[ElementResult, ...]:
        """Those of its shape and motion, of forces where the follower's mass is known, and of its limits."""
        return tuple(made.result for made in _results(self))

    def row(self, n: Numbers) -> np.ndarray:
        """Numbers in the order of `engine.elements.cams.cam_places`, (variants, numbers); 0 where there is none.

        Parameters
        ----------
        n : mapping of str to ndarray (variants,)
        """
        place, mass = ("offset", "mass") if self.translating else ("pivot_distance", "inertia")
        follower = ("roller_radius", place, "arm", mass, "preload", "stiffness", "load", "friction")
        found = [n["base_radius"], n["speed"]]
        found += [n.get(f"follower.{key}", 0.0) for key in (*follower, "guide_length", "overhang")]
        found += [np.tan(n.get("limits.pressure_angle", 0.0)), n.get("limits.convex_radius", 0.0)]
        found += [n.get(f"line_contact.{key}", 0.0) for key in ("width", "elastic_modulus", "poisson")]
        stroke = "lift" if self.translating else "swing"
        for name in self.sections:
            found += [n.get(f"sections.{name}.{key}", math.nan) for key in ("angle", stroke)]
        return np.ascontiguousarray(np.array(np.broadcast_arrays(*found), float).T)

    def evaluate(self, n: Numbers) -> Answers:
        """Results with errors made of the sizes of their terms, and verdicts."""
        numbers = self.row(n)
        seen = cam_extremes(self, numbers)
        with np.errstate(all="ignore"):
            made = _results(self)
            found = [result.made(numbers, seen) for result in made]
            verdicts = seen.verdicts.copy()
            verdicts[(verdicts == Verdict.OK) & _is_undercut(self, numbers, seen)] = Verdict.UNDERCUT
            if self.follower.moved is not None and self.closure == "spring":
                lifts = (verdicts == Verdict.OK) & ~(-seen.values[:, TurnExtreme.SLACK] > 0.0)
                verdicts[lifts & (seen.values[:, VELOCITY_JUMP] == 0.0)] = Verdict.LIFTS_OFF
        whole = np.isin(verdicts, (Verdict.OK, Verdict.UNDERCUT, Verdict.LIFTS_OFF))
        values, errors = {}, {}
        for (result, _, after), (value, size) in zip(made, found, strict=True):
            gone = ~whole
            if after >= Lasting.UNLESS_UNDERCUT:
                gone = gone | (verdicts == Verdict.UNDERCUT)
            if after == Lasting.WHILE_TOUCHING:
                gone = gone | (verdicts == Verdict.LIFTS_OFF)
            values[result.name] = np.where(gone, np.nan, value)
            errors[result.name] = ROUNDING * EPS * np.where(np.isfinite(size), size, 0.0)
        return Answers(values, errors, verdicts)


def cam_traits(cam: CamElement) -> np.ndarray:
    """What a cam is, as `engine.elements.cams.cam_places` counts it."""
    follower = cam.follower
    opens = -1 if not cam.translating and follower.opens == "with" else 1
    flat, dynamic = follower.contact == "flat", follower.moved is not None
    return np.array([not cam.translating, flat, opens, dynamic, cam.limits is not None], np.int64)


def cam_sections(cam: CamElement) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Kinds and directions of a cam's sections, and the pieces of its table; what it doesn't have is empty.

    Parameters
    ----------
    cam : CamElement
    """
    kinds, directions = [], []
    for section in cam.sections.values():
        still = isinstance(section, DwellSection)
        kinds.append(DWELL if still else LAW_KINDS[section.law])
        directions.append(0 if still else 1 if isinstance(section, RiseSection) else -1)
    tabled = np.empty((0, PIECE_NUMBERS))
    if cam.table is not None:
        table = cam.table
        tabled = cut_table(make_table(table.over_angle, table.rows, table.interpolation, 2 * math.pi))
    return np.array(kinds, np.int64), np.array(directions, np.int64), tabled


def cam_extremes(cam: CamElement, numbers: np.ndarray) -> Sought:
    """Sought over the turn.

    Parameters
    ----------
    cam : CamElement
        Its kind and its table; its numbers are not used.
    numbers : ndarray (variants, NUMBERS + 2 sections)
    """
    variants = numbers.shape[0]
    kinds, directions, tabled = cam_sections(cam)
    values, sizes, places, spreads = np.full((4, variants, ANSWERS), np.nan)
    verdicts = np.empty(variants, np.uint8)
    pieces = np.empty((max(len(tabled), PIECES_OF_A_SECTION * kinds.size), PIECE_NUMBERS))
    samples, stack = np.empty((SAMPLES + 1, 2 * QUANTITIES)), np.empty((2 * HALVINGS + 4, 2))
    prepare(find_extremes, _TYPES)
    find_extremes(
        kinds, directions, cam_traits(cam), numbers, tabled, values, sizes, places, spreads, verdicts, pieces, samples,
        stack,
    )  # fmt: skip
    return Sought(values, sizes, places, spreads, verdicts)


_INTEGERS, _TABLE = types.int64[::1], types.float64[:, ::1]
_TYPES = (*(_INTEGERS,) * 3, *(_TABLE,) * 6, types.uint8[::1], *(_TABLE,) * 3)


class Result(NamedTuple):
    """A result of a cam, what makes it of numbers and extremes, and what it doesn't survive."""

    result: ElementResult
    made: Callable[[np.ndarray, Sought], Found]
    after: "Lasting"


class Lasting(IntEnum):
    """Which results a cam has that can't move its follower as it should."""

    ALWAYS = 0
    UNLESS_UNDERCUT = 1
    WHILE_TOUCHING = 2


def _results(cam: CamElement) -> list[Result]:
    """Results of a cam."""
    made = [*(_flat_shape(cam) if cam.follower.contact == "flat" else _shape(cam)), *_motion(cam)]
    if cam.follower.moved is not None:
        made += _forces(cam)
    if cam.line_contact is not None:
        result = ElementResult(
            "contact_pressure", "greatest pressure by Hertz between cam and follower", "Pa", None, True
        )
        made.append(Result(result, partial(_pressure, cam.closure == "form"), Lasting.WHILE_TOUCHING))
    if cam.limits is not None:
        words = "least base radius that keeps the limits; none if no base circle does"
        result = ElementResult("least_base_radius", words, "m", None, True)
        make = _least_base if cam.translating else _least_base_of_arm
        made.append(Result(result, partial(make, cam), Lasting.ALWAYS))
    return made


def _shape(cam: CamElement) -> Iterator[Result]:
    """Pressure angles and radii of curvature under a roller or knife edge."""
    for stroke, ways in (
        ("rise", (TurnExtreme.RISE_ANGLE, TurnExtreme.RISE_ANGLE_BACK)),
        ("return", (TurnExtreme.RETURN_ANGLE, TurnExtreme.RETURN_ANGLE_BACK)),
    ):
        name, words = f"{stroke}_pressure_angle", f"greatest pressure angle of the {stroke}"
        yield Result(ElementResult(name, words, "rad", None, True), partial(_greatest, ways), Lasting.ALWAYS)
        at = ElementResult(f"{name}_at", f"cam angle of the {words}", "rad", None, True)
        yield Result(at, partial(_where, ways), Lasting.ALWAYS)
    curved, hollow = (TurnExtreme.CURVED,), (TurnExtreme.HOLLOW,)
    for name, words, make, ways in (
        ("convex_radius", "least radius of curvature of the convex profile", _convex, curved),
        ("hollow_radius", "least radius of curvature of the hollow profile; none if it is convex", _hollow, hollow),
    ):
        yield Result(ElementResult(name, words, "m", None, True), make, Lasting.ALWAYS)
        at = ElementResult(f"{name}_at", f"cam angle of the {words.partition(';')[0]}", "rad", None, True)
        yield Result(at, partial(_where_hollow if make is _hollow else _where, ways), Lasting.ALWAYS)
    limit = ElementResult("undercut_radius", "radius of the roller at which undercutting begins", "m", None, True)
    yield Result(limit, partial(_undercut_radius, cam.closure == "form"), Lasting.ALWAYS)


def _flat_shape(cam: CamElement) -> Iterator[Result]:
    """Curvature under a flat face, and the part of the face that is touched."""
    radius = ElementResult("convex_radius", "least radius of curvature of the profile", "m")
    yield Result(radius, _flat_radius, Lasting.ALWAYS)
    at = ElementResult("convex_radius_at", "cam angle of the least radius of curvature", "rad")
    yield Result(at, partial(_where, (TurnExtreme.HOLLOW,)), Lasting.ALWAYS)
    origin = "beside the axis" if cam.translating else "from the pivot"
    for name, words, make in (
        ("face_from", f"least distance of the contact {origin}", partial(_least, TurnExtreme.FACE_FROM)),
        ("face_to", f"greatest distance of the contact {origin}", partial(_most, TurnExtreme.FACE_TO)),
        ("face_length", "length of the face that is touched", _face_length),
    ):
        yield Result(ElementResult(name, words, "m"), make, Lasting.UNLESS_UNDERCUT)


def _motion(cam: CamElement) -> Iterator[Result]:
    """The follower's motion."""
    unit = "m" if cam.translating else "rad"
    whole, speeds = Lasting.UNLESS_UNDERCUT, (TurnExtreme.OUTWARDS, TurnExtreme.INWARDS)
    for name, words, power, make in (
        ("greatest_velocity", "greatest velocity of the follower", 1, partial(_greatest, speeds)),
        ("greatest_acceleration", "greatest acceleration of the follower, away from the cam", 2, _accelerated),
        ("greatest_deceleration", "greatest acceleration of the follower, towards the cam", 2, _decelerated),
        ("greatest_jerk", "greatest jerk of the follower; none where the acceleration jumps", 3, _jerked),
        ("velocity_jump", "greatest jump of the follower's velocity", 1, partial(_most, VELOCITY_JUMP)),
        ("acceleration_jump", "greatest jump of the follower's acceleration", 2, partial(_most, ACCELERATION_JUMP)),
    ):
        unit_of = f"{unit} s-{power}"
        yield Result(ElementResult(name, words, unit_of, None, True), make, whole)


def _forces(cam: CamElement) -> Iterator[Result]:
    """Contact force, spring, driving moment."""
    touching, spring = Lasting.WHILE_TOUCHING, cam.closure == "spring"
    ways = (TurnExtreme.PRESSED,) if spring else (TurnExtreme.PRESSED, TurnExtreme.SLACK)
    named = [
        ("greatest_contact_force", "greatest force between cam and follower", "N", partial(_greatest, ways)),
        ("greatest_contact_force_at", "cam angle of the greatest contact force", "rad", partial(_where, ways)),
    ]
    if spring:
        named += [
            ("least_contact_force", "least force between cam and follower", "N", partial(_least, TurnExtreme.SLACK)),
            (
                "least_contact_force_at",
                "cam angle of the least contact force",
                "rad",
                partial(_where, (TurnExtreme.SLACK,)),
            ),
        ]
    named += [
        ("greatest_moment", "greatest moment that turns the cam", "N m", partial(_most, TurnExtreme.DRIVEN)),
        ("least_moment", "least moment that turns the cam; negative where it is driven", "N m", _driving),
        ("mean_moment", "mean of the moment that turns the cam", "N m", partial(_most, MEAN_MOMENT)),
    ]
    for name, words, unit, make in named:
        yield Result(ElementResult(name, words, unit, None, True), partial(_without_impact, make), touching)
    if spring:
        unit = "N" if cam.translating else "N m"
        preload = ElementResult(
            "needed_preload", "preload at which the follower just doesn't lift off", unit, None, True
        )
        yield Result(preload, partial(_without_impact, _needed_preload), Lasting.UNLESS_UNDERCUT)
        words = "speed of the cam at which the follower lifts off; none if it never does"
        speed = ElementResult("lift_off_speed", words, "rad s-1", None, True)
        yield Result(speed, partial(_without_impact, _lift_off_speed), Lasting.UNLESS_UNDERCUT)


def _is_undercut(cam: CamElement, numbers: np.ndarray, seen: Sought) -> np.ndarray:
    """Whether the profile can't be made; it has no corners but hollow ones under anything but a knife edge."""
    if cam.follower.contact == "knife edge":
        return np.zeros(numbers.shape[0], bool)
    corner = seen.values[:, VELOCITY_DROP] > 0.0
    if cam.follower.contact == "flat":
        return corner | ~(-seen.values[:, TurnExtreme.HOLLOW] > 0.0)
    radius = numbers[:, ROLLER]
    limit = seen.values[:, TurnExtreme.CURVED]
    if cam.closure == "form":
        limit = np.maximum(limit, seen.values[:, TurnExtreme.HOLLOW])
        corner = seen.values[:, VELOCITY_JUMP] > 0.0
    return corner | ~(limit * radius < 1.0)


def _better(ways: tuple[int, ...], seen: Sought) -> np.ndarray:
    """Column of the greatest of several extremes, of each variant (1, variants)."""
    return np.array(ways)[np.argmax(seen.values[:, ways], axis=1)][:, None]


def _chosen(column: np.ndarray, array: np.ndarray) -> np.ndarray:
    return np.take_along_axis(array, column, axis=1)[:, 0]


def _greatest(ways: tuple[int, ...], numbers: np.ndarray, seen: Sought) -> Found:
    column = _better(ways, seen)
    return _chosen(column, seen.values), _chosen(column, seen.sizes)


def _where(ways: tuple[int, ...], numbers: np.ndarray, seen: Sought) -> Found:
    column = _better(ways, seen)
    known = np.where(np.isfinite(_chosen(column, seen.values)), _chosen(column, seen.places), np.nan)
    return known, _chosen(column, seen.spreads) / (ROUNDING * EPS)


def _where_hollow(ways: tuple[int, ...], numbers: np.ndarray, seen: Sought) -> Found:
    at, size = _where(ways, numbers, seen)
    return np.where(seen.values[:, TurnExtreme.HOLLOW] > 0.0, at, np.nan), size


def _most(which: int, numbers: np.ndarray, seen: Sought) -> Found:
    return seen.values[:, which], seen.sizes[:, which]


def _least(which: int, numbers: np.ndarray, seen: Sought) -> Found:
    return -seen.values[:, which], seen.sizes[:, which]


def _convex(numbers: np.ndarray, seen: Sought) -> Found:
    curved, size = _most(TurnExtreme.CURVED, numbers, seen)
    radius = np.where(curved > 0.0, 1.0 / curved, np.nan)
    radius = np.where(seen.values[:, VELOCITY_DROP] > 0.0, 0.0, radius)
    return radius - numbers[:, ROLLER], size * radius**2 + radius + numbers[:, ROLLER]


def _hollow(numbers: np.ndarray, seen: Sought) -> Found:
    hollow, size = _most(TurnExtreme.HOLLOW, numbers, seen)
    radius = np.where(hollow > 0.0, 1.0 / hollow, np.nan)
    return radius + numbers[:, ROLLER], size * radius**2 + radius + numbers[:, ROLLER]


def _undercut_radius(groove: bool, numbers: np.ndarray, seen: Sought) -> Found:
    curved, size = _greatest((TurnExtreme.CURVED, *((TurnExtreme.HOLLOW,) if groove else ())), numbers, seen)
    corner = seen.values[:, VELOCITY_JUMP if groove else VELOCITY_DROP] > 0.0
    radius = np.where(corner, 0.0, np.where(curved > 0.0, 1.0 / curved, np.nan))
    return radius, size * radius**2 + radius


def _flat_radius(numbers: np.ndarray, seen: Sought) -> Found:
    return _least(TurnExtreme.HOLLOW, numbers, seen)


def _face_length(numbers: np.ndarray, seen: Sought) -> Found:
    values, sizes = seen.values, seen.sizes
    both = (TurnExtreme.FACE_TO, TurnExtreme.FACE_FROM)
    return values[:, both].sum(axis=1), sizes[:, both].sum(axis=1)


def _without_impact(make: Callable[..., Found], numbers: np.ndarray, seen: Sought) -> Found:
    """What has no value where the velocity jumps."""
    value, size = make(numbers, seen)
    return np.where(seen.values[:, VELOCITY_JUMP] > 0.0, np.nan, value), size


def _accelerated(numbers: np.ndarray, seen: Sought) -> Found:
    return _without_impact(partial(_most, TurnExtreme.ACCELERATED), numbers, seen)


def _decelerated(numbers: np.ndarray, seen: Sought) -> Found:
    return _without_impact(partial(_most, TurnExtreme.DECELERATED), numbers, seen)


def _jerked(numbers: np.ndarray, seen: Sought) -> Found:
    value, size = _without_impact(partial(_greatest, (TurnExtreme.JERKED, TurnExtreme.JERKED_BACK)), numbers, seen)
    return np.where(seen.values[:, ACCELERATION_JUMP] > 0.0, np.nan, value), size


def _driving(numbers: np.ndarray, seen: Sought) -> Found:
    return _least(TurnExtreme.DRIVING, numbers, seen)


def _needed_preload(numbers: np.ndarray, seen: Sought) -> Found:
    value, size = _most(TurnExtreme.PRELOAD, numbers, seen)
    return np.maximum(value, 0.0), size


def _lift_off_speed(numbers: np.ndarray, seen: Sought) -> Found:
    growth, size = _most(TurnExtreme.LIFT_OFF, numbers, seen)
    at = np.where(growth >= NEVER, 0.0, np.where(growth > 0.0, growth**-0.5, np.nan))
    return at, np.where(growth >= NEVER, 0.0, at * (1.0 + 0.5 * size / growth))


def _pressure(groove: bool, numbers: np.ndarray, seen: Sought) -> Found:
    ways = (TurnExtreme.INNER_FLANK, TurnExtreme.OUTER_FLANK) if groove else (TurnExtreme.INNER_FLANK,)
    line, size = _without_impact(partial(_greatest, ways), numbers, seen)
    modulus = numbers[:, MODULUS] / (2.0 * (1.0 - numbers[:, POISSON] ** 2))
    pressure = pressure_of_lines(line, modulus, numbers[:, WIDTH])
    return pressure, pressure * (4.0 + 0.5 * size / line)


def _least_base(cam: CamElement, numbers: np.ndarray, seen: Sought) -> Found:
    """Least base circle under a follower that slides: from the greatest of the heights that the positions need."""
    height, size = _greatest((TurnExtreme.HEIGHT_FOR_ANGLE, TurnExtreme.HEIGHT_FOR_CURVATURE), numbers, seen)
    offset = 0.0 if cam.follower.contact == "flat" else np.abs(numbers[:, DISTANCE])
    base = np.hypot(np.maximum(height, 0.0), offset) - numbers[:, ROLLER]
    return _without_corners(cam, numbers, seen, base), size + np.abs(height) + offset + numbers[:, ROLLER]


def _least_base_of_arm(cam: CamElement, numbers: np.ndarray, seen: Sought) -> Found:
    """Least base circle under a follower that swings."""
    arm, d, roller = (numbers[:, k] for k in (ARM, DISTANCE, ROLLER))
    flat = cam.follower.contact == "flat"
    angle, size = np.full(numbers.shape[0], _LEAST_ANGLE), np.full(numbers.shape[0], _LEAST_ANGLE)
    if not flat:
        # The angle at which the base circle is a point, if the arm reaches so far.
        point = np.vectorize(least_arm_angle, otypes=[float])(roller, arm, d)
        angle = np.where(roller > np.abs(d - arm), np.maximum(angle, point), angle)
    greatest = np.pi
    if cam.limits.pressure_angle is not None:
        needed, off = _most(TurnExtreme.HEIGHT_FOR_ANGLE, numbers, seen)
        angle, size = np.where(needed > angle, needed, angle), np.where(needed > angle, off, size)
        greatest = -seen.values[:, TurnExtreme.ARM_ANGLE_ABOVE]
    angle[~(angle < np.minimum(greatest, np.pi))] = np.nan
    if flat or _curved_limit(numbers).any():
        angle, size = least_arm_angles(cam_sections(cam), cam_traits(cam), numbers, angle, size)
    angle[~(angle <= greatest)] = np.nan
    if flat:
        base = np.where(angle <= np.pi / 2, d * np.sin(angle), np.nan)
        return _without_corners(cam, numbers, seen, base), size * d * np.cos(angle) + d
    prime = np.sqrt((d - arm) ** 2 + 4.0 * arm * d * np.sin(angle / 2) ** 2)
    size = size * arm * d * np.sin(angle) / prime + 2.0 * prime + roller
    return _without_corners(cam, numbers, seen, prime - roller), size


def _curved_limit(numbers: np.ndarray) -> np.ndarray:
    """Least radius of curvature of the pitch curve."""
    return numbers[:, LIMIT_RADIUS] + numbers[:, ROLLER]


def _without_corners(cam: CamElement, numbers: np.ndarray, seen: Sought, base: np.ndarray) -> np.ndarray:
    """Radii of base circles, none where corners of the profile stay below the limit whatever the base circle."""
    sharp = (_curved_limit(numbers) > 0.0) & (seen.values[:, VELOCITY_DROP] > 0.0)
    return np.where(sharp, np.nan, np.maximum(base, 0.0))
