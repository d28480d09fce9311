"""Cams: shape of the profile, motion of the follower, forces, minimum base circle.

Source: K. L. Johnson, Contact Mechanics, chapter 4 (Hertz's pressure between cylinders).
"""

import math
from collections.abc import Iterator
from functools import cached_property
from typing import Annotated, ClassVar, Literal, NamedTuple

import numpy as np
from pydantic import Field

from engine.elements.cams.cam_curves import cam_curves
from engine.elements.cams.followers import CamLimits, LineContact, OscillatingFollower, TranslatingFollower
from engine.elements.cams.oscillating_base_circle import least_arm_angles, point_angle, room_at
from engine.elements.cams.over_turn import Measures, PeakPlaces, Sought, measure
from engine.elements.cams.positions import PEAK_FACTOR, at_positions, cam_variants, limit_radius, with_roundings
from engine.elements.element import ROUNDING, Answers, Columns, Element, Numbers, nudged
from engine.elements.panels import Curve, Mark, Panel, PanelAxis
from engine.laws.rounding import EPS
from engine.parts.motion_programs import CamProgram, sections_of
from engine.parts.skeleton import AngularSpeed, Faults, Positive
from engine.words.quantity import Quantity, Rank, main_result
from engine.words.verdicts import Verdict

# The diagram omits curvatures above this multiple of the base circle's: they are infinite at edges.
_MOST_CURVED = 30.0
# Extremes that limit the arm angle of an oscillating follower.
_DIP, _LOW_ANGLE, _HIGH_ANGLE = Sought("s", -1), Sought("low angle", 1), Sought("high angle", -1)


Extremes = dict[Sought, np.ndarray]


# Faults of a cam that leave some of its results undefined; the velocity jumps at an impact.
_MADE, _SMOOTH, _TOUCHING = ("undercut",), ("undercut", "impact"), ("undercut", "impact", "lifting")


class Result(NamedTuple):
    """A result of a cam, the faults that leave it undefined, and its extremes.

    It is the maximum of these, or follows from it.
    """

    result: Quantity
    lost: tuple[str, ...] = ()
    of: tuple[Sought, ...] = ()


class CamElement(CamProgram, Element):
    """A cam that turns at `speed`, with a follower moved by lift sections (in the order of the text) or by a table.

    `base_radius` is the minimum radius of the cam surface, at zero displacement. One section may omit its angle: it
    spans the rest of the turn. `closure` is by a spring or load, or by form (a groove). The path of a cutter of
    `cutter_radius` (default: the roller's radius) is drawn and exported.
    """

    picture: ClassVar = "cam"
    variants_at_once: ClassVar = 512

    type: Literal["cam"]
    base_radius: Positive
    speed: Annotated[AngularSpeed, Field(gt=0)]
    follower: Annotated[TranslatingFollower | OscillatingFollower, Field(discriminator="type")]
    closure: Literal["spring", "form"] = "spring"
    line_contact: LineContact | None = None
    limits: CamLimits | None = None
    cutter_radius: Positive | None = None

    def _faults(self) -> Faults:
        if self.line_contact is not None and (self.follower.contact == "knife edge" or self.follower.moved is None):
            key = "mass" if self.translating else "inertia"
            yield f"line_contact: it needs a roller or a flat face, and follower.{key}; give these, or leave it out"
        if self.follower.contact == "flat" and self.limits is not None and self.limits.pressure_angle is not None:
            yield "limits.pressure_angle: a flat face has none; give limits.convex_radius only"

    @cached_property
    def results(self) -> tuple[Quantity, ...]:
        """Results for shape and motion, for forces if the follower's mass is known, and for the limits."""
        return tuple(made.result for made in _results(self))

    @np.errstate(all="ignore")
    def evaluate(self, n: Numbers) -> Answers:
        """Results with their error estimates, and verdicts.

        The extremes are located once; nudged numbers are evaluated at the same positions. This is exact to first order,
        as the slope vanishes there. The estimate of a position is the range in which rounding hides the extreme.
        """
        n, made = with_roundings({**n}), tuple(_results(self))
        cams = cam_variants(self, n)
        found = measure(cams, self._sought)
        limited = self.limits is not None and not self.translating
        angles = None if not limited else self._least_angles(n, found)
        values, errors = nudged(lambda m: self._values(m, found.places, angles), n)
        if self.follower.moved is not None:
            ends = "greatest_moment", "least_moment"
            most, off = (np.abs([part[end] for end in ends]).max(axis=0) for part in (values, errors))
            size = np.where(most > 0.0, found.moment_size * (ROUNDING * EPS + off / most), 0.0)
            values["mean_moment"], errors["mean_moment"] = found.moment, size + found.moment_missed
        if "face_length" in values:
            # Both ends are rounded separately; changing a number moves them together.
            errors["face_length"] = errors["face_from"] + errors["face_to"]
        for result, _, of in made:
            at = f"{result.name}_at"
            if at in values:
                k = np.argmax([values[sought] for sought in of], axis=0)
                blurs = found.places.blurs[[self._sought.index(sought) for sought in of]]
                off = np.where(blurs > 0.0, np.sqrt([errors[sought] for sought in of]) * blurs, 0.0)
                errors[at] = errors[at] + ROUNDING * EPS * math.tau + np.choose(k, off)
        return self._answers(n, (values, errors), found.verdicts)

    def panels(self) -> tuple[Panel, ...]:
        """Motion, pressure angle, curvature and forces over the turn, with the boundaries of the sections."""
        c, unit, rate = cam_curves(self), *(("m", "m") if self.translating else ("rad", "1"))
        curvature = np.where(np.abs(c.curvature) * self.base_radius < _MOST_CURVED, c.curvature, np.nan)
        rows = [(PanelAxis("follower motion", unit, "s"), c.displacement)]
        derivatives = zip(("first", "second", "third"), "′″‴", (c.first, c.second, c.third), strict=True)
        rows += [(PanelAxis(f"{nth} derivative by the angle", rate, f"s{dash}"), row) for nth, dash, row in derivatives]
        rows += [] if self.follower.contact == "flat" else [(PanelAxis("pressure angle", "rad", "α"), c.pressure_angle)]
        rows += [(PanelAxis("curvature", "m-1", "κ"), curvature)]
        if self.follower.moved is not None:
            rows += [(PanelAxis("contact force", "N", "F"), c.force), (PanelAxis("torque", "N m", "M"), c.moment)]
        ends = sections_of(self, "", self.own_numbers()).begin
        marks = (Mark("", None, 0.0), *(Mark("", float(np.squeeze(end)), None) for end in ends))
        x = PanelAxis("angle of the cam", "rad", "φ")
        return tuple(Panel(x, y, c.angle, (Curve("", row),), marks) for y, row in rows)

    @property
    def _sought(self) -> tuple[Sought, ...]:
        """Extremes of this cam."""
        return tuple(dict.fromkeys(sought for made in _results(self) for sought in made.of))

    def _least_angles(self, n: Numbers, found: Measures) -> tuple[np.ndarray, PeakPlaces]:
        """Minimum arm angles that satisfy the limits, and the positions that determine them."""
        x = self._extremes(n, found.places)[0]
        angle, greatest, cams = point_angle(n, x[_DIP]), np.pi, cam_variants(self, n)
        if _LOW_ANGLE in x:
            angle, greatest = np.fmax(angle, x[_LOW_ANGLE]), -x[_HIGH_ANGLE]
        angle = np.where(angle < np.minimum(greatest, np.pi), angle, np.nan)
        angle, at = least_arm_angles(cams, angle)
        return np.where(angle <= greatest, angle, np.nan), at

    def _extremes(self, n: Numbers, places: PeakPlaces) -> tuple[Extremes, Extremes]:
        """Extremes, signed, at the given positions, and the cam angles there."""
        cams = cam_variants(self, n)
        variants = cams.lowest.size
        p, u, _, missed = (np.tile(part, variants // part.shape[1]) for part in places)
        v = np.broadcast_to(np.arange(variants), p.shape)
        found, angle = at_positions(cams, p, v, u), cams.turn.cam_angle(p, v, u)
        higher = missed * ((n[PEAK_FACTOR] - 1.0) / EPS)
        rows = {sought: sought.sign * found[sought.quantity][k] + higher[k] for k, sought in enumerate(self._sought)}
        return rows, dict(zip(self._sought, angle, strict=True))

    def _values(
        self, n: Numbers, places: PeakPlaces, angles: tuple[np.ndarray, PeakPlaces] | None
    ) -> Columns | Extremes:
        """Extremes and results by name, regardless of the verdict."""
        x, at = self._extremes(n, places)
        found, roller = {**x}, n.get("follower.roller_radius", 0.0)
        for result, _, of in _results(self):
            if of:
                rows = [x[sought] for sought in of]
                found[result.name] = np.max(rows, axis=0)
                found[f"{result.name}_at"] = np.choose(np.argmax(rows, axis=0), [at[sought] for sought in of])
        jump, drop, jump2 = cam_variants(self, n).turn.jumps(n)
        found |= {"velocity_jump": n["speed"] * jump, "acceleration_jump": n["speed"] ** 2 * jump2, "drop": drop}
        if self.follower.contact == "flat":
            found["face_length"] = found["face_to"] + found["face_from"]
            found |= {name: -found[name] for name in ("convex_radius", "face_from")}
        else:
            convex, hollow = found["convex_radius"], found["hollow_radius"]
            radius = np.where(drop > 0.0, 0.0, np.where(convex > 0.0, 1.0 / convex, np.nan))
            found |= {"convex_radius": radius - roller, "hollow_radius": np.where(hollow > 0.0, 1.0 / hollow, np.nan)}
            found["hollow_radius"] = found["hollow_radius"] + roller
            found["hollow_radius_at"] = np.where(hollow > 0.0, found["hollow_radius_at"], np.nan)
            groove = self.closure == "form"
            curved = np.maximum(convex, hollow) if groove else convex
            corner = (jump if groove else drop) > 0.0
            found["undercut_radius"] = np.where(corner, 0.0, np.where(curved > 0.0, 1.0 / curved, np.nan))
        if self.follower.moved is not None:
            found["least_moment"] = -found["least_moment"]
            if self.closure == "spring":
                growth = found["lift_off_speed"]
                found |= {"needed_preload": np.maximum(found["needed_preload"], 0.0)}
                found |= {"least_contact_force": -found["least_contact_force"]}
                found["lift_off_speed"] = np.where(growth > 0.0, growth**-0.5, np.nan)
        if self.line_contact is not None:
            modulus = n["line_contact.elastic_modulus"] / (2.0 * (1.0 - n["line_contact.poisson"] ** 2))
            # Hertz's pressure of cylinders of one material, from the normal force times the sum of the curvatures.
            width = math.pi * n["line_contact.width"]
            found["contact_pressure"] = np.sqrt(found["contact_pressure"] * modulus / width)
        if self.limits is not None:
            if angles is None:
                height = np.maximum(found["least_base_radius"], 0.0)
                offset = 0.0 if self.follower.contact == "flat" else n["follower.offset"]
                base = np.hypot(height, offset) - n.get("follower.roller_radius", 0.0)
            else:
                base = self._least_base_of_arm(n, x, angles)
            # The curvature at a corner of the profile violates the limit for every base circle.
            sharp = (limit_radius(n) > 0.0) & (drop > 0.0)
            found["least_base_radius"] = np.where(sharp, np.nan, np.maximum(base, 0.0))
        return found

    def _least_base_of_arm(self, n: Numbers, x: Extremes, angles: tuple[np.ndarray, PeakPlaces]) -> np.ndarray:
        """Minimum base radius for an oscillating follower: a Newton step from the known minimum arm angles."""
        known, at = angles
        d, variants = n["follower.pivot_distance"], n["speed"].size
        copies = variants // known.size
        angle, p, u = (np.tile(part, copies) for part in (known, at.pieces, at.u))
        room, slope, bound = room_at(cam_variants(self, n), angle, p, np.arange(variants), u)
        curved = angle - room / np.maximum(slope, np.sqrt(np.abs(bound * room)))
        least = np.fmax(point_angle(n, x[_DIP]), x.get(_LOW_ANGLE, 0.0))
        angle = np.where(np.isnan(u), least, curved) + 0.0 * angle
        if self.follower.contact == "flat":
            return np.where(angle <= np.pi / 2, d * np.sin(angle), np.nan)
        arm = n["follower.arm"]
        prime = np.sqrt((d - arm) ** 2 + 4.0 * arm * d * np.sin(angle / 2) ** 2)
        return prime - n.get("follower.roller_radius", 0.0)

    def _answers(self, n: Numbers, found: tuple[Columns | Extremes, ...], verdicts: np.ndarray) -> Answers:
        """Results valid under the final verdicts, and these verdicts."""
        values, errors = found
        impact = values["velocity_jump"] > 0.0
        verdicts = verdicts.copy()
        verdicts[(verdicts == Verdict.OK) & self._is_undercut(n, values)] = Verdict.UNDERCUT
        if self.follower.moved is not None and self.closure == "spring":
            lifts = ~(values["least_contact_force"] > 0.0) & ~impact
            verdicts[(verdicts == Verdict.OK) & lifts] = Verdict.LIFTS_OFF
        whole = np.isin(verdicts, (Verdict.OK, Verdict.UNDERCUT, Verdict.LIFTS_OFF))
        faults = {"undercut": verdicts == Verdict.UNDERCUT, "lifting": verdicts == Verdict.LIFTS_OFF}
        faults |= {"impact": impact, "acceleration jump": values["acceleration_jump"] > 0.0}
        kept, off = {}, {}
        for result, lost, _ in _results(self):
            name, gone = result.name, np.any([~whole, *(faults[fault] for fault in lost)], axis=0)
            kept[name] = np.where(gone, np.nan, values[name])
            off[name] = np.where(np.isfinite(kept[name]), errors[name], 0.0)
        return Answers(kept, off, verdicts)

    def _is_undercut(self, n: Numbers, values: Columns) -> np.ndarray:
        """Whether the profile cannot be made: only a knife edge can follow its corners, except hollow ones."""
        contact = self.follower.contact
        if contact == "knife edge":
            return np.zeros(values["drop"].size, bool)
        if contact == "flat":
            return (values["drop"] > 0.0) | ~(values["convex_radius"] > 0.0)
        return values["undercut_radius"] <= n["follower.roller_radius"]


# Results that are seldom needed.
_FURTHER = ("velocity_jump", "acceleration_jump", "least_moment", "needed_preload", "face_from", "face_to")


def _results(cam: CamElement) -> Iterator[Result]:
    """Results of a cam."""
    yield from (_flat_shape(cam) if cam.follower.contact == "flat" else _shape())
    yield from _motion(cam)
    if cam.follower.moved is not None:
        yield from _forces(cam)
    if cam.line_contact is not None:
        words = "peak Hertzian pressure between cam and follower"
        sides = ("inner", "outer") if cam.closure == "form" else ("inner",)
        yield _result("contact_pressure", words, "Pa", _TOUCHING, tuple(Sought(side, 1) for side in sides))
    if cam.limits is not None:
        words = "minimum base radius that meets the limits; none if no base circle does"
        yield _result("least_base_radius", words, "m", of=_limiting(cam))


def _limiting(cam: CamElement) -> tuple[Sought, ...]:
    """Extremes of the heights or arm angles that the limits require."""
    steep = cam.limits.pressure_angle is not None
    if cam.translating:
        heights = (Sought(f"height {sign:+d}", 1) for sign in (1, -1) if steep)
        return (*heights, Sought("curved height", 1), _DIP)
    return (_LOW_ANGLE, _HIGH_ANGLE, _DIP) if steep else (_DIP,)


def _both_ways(quantity: str, direction: int = 0) -> tuple[Sought, Sought]:
    """Maximum and minimum of a quantity over the turn."""
    return Sought(quantity, 1, direction), Sought(quantity, -1, direction)


def _result(name: str, words: str, unit: str, lost: tuple[str, ...] = (), of: tuple[Sought, ...] = ()) -> Result:
    rank = Rank.FURTHER if name in _FURTHER or name.endswith("_at") else Rank.ANSWER
    return Result(main_result(name, words, unit, True, rank=rank), lost, of)


def _with_angle(
    name: str, words: str, unit: str, of: tuple[Sought, ...], lost: tuple[str, ...] = ()
) -> Iterator[Result]:
    """A result and the cam angle at which it occurs."""
    yield _result(name, words, unit, lost, of)
    yield _result(f"{name}_at", f"cam angle of the {words.partition(';')[0]}", "rad", lost)


def _shape() -> Iterator[Result]:
    """Pressure angles and radii of curvature under a roller or knife edge."""
    for stroke, direction in (("rise", 1), ("return", -1)):
        words, of = f"maximum pressure angle of the {stroke}", _both_ways("angle", direction)
        yield from _with_angle(f"{stroke}_pressure_angle", words, "rad", of)
    (convex, hollow), words = _both_ways("curvature"), "minimum radius of curvature of the convex profile"
    yield from _with_angle("convex_radius", words, "m", (convex,))
    words = "minimum radius of curvature of the hollow profile; none if it is convex"
    yield from _with_angle("hollow_radius", words, "m", (hollow,))
    yield _result("undercut_radius", "radius of the roller at which undercutting begins", "m")


def _flat_shape(cam: CamElement) -> Iterator[Result]:
    """Curvature under a flat face, and the part of the face in contact."""
    origin = "from the follower's axis" if cam.translating else "from the pivot"
    least, (end, start) = Sought("radius", -1), _both_ways("face")
    found = (
        _result("convex_radius", "minimum radius of curvature of the profile", "m", of=(least,)),
        _result("convex_radius_at", "cam angle of the minimum radius of curvature", "rad"),
        _result("face_from", f"minimum distance of the contact {origin}", "m", _MADE, (start,)),
        _result("face_to", f"maximum distance of the contact {origin}", "m", _MADE, (end,)),
        _result("face_length", "length of the face in contact over a turn", "m", _MADE),
    )
    for made in found:
        yield made._replace(result=made.result._replace(may_be_undefined=False))


def _motion(cam: CamElement) -> Iterator[Result]:
    """The follower's motion."""
    unit, (faster, slower) = "m" if cam.translating else "rad", _both_ways("acceleration")
    jerk, of_jerk = (*_SMOOTH, "acceleration jump"), "peak jerk of the follower; none where the acceleration jumps"
    for name, words, power, lost, of in (
        ("greatest_velocity", "peak velocity of the follower", 1, _MADE, _both_ways("velocity")),
        ("greatest_acceleration", "peak acceleration of the follower, away from the cam", 2, _SMOOTH, (faster,)),
        ("greatest_deceleration", "peak acceleration of the follower, towards the cam", 2, _SMOOTH, (slower,)),
        ("greatest_jerk", of_jerk, 3, jerk, _both_ways("jerk")),
        ("velocity_jump", "maximum jump of the follower's velocity", 1, _MADE, ()),
        ("acceleration_jump", "maximum jump of the follower's acceleration", 2, _MADE, ()),
    ):
        yield _result(name, words, f"{unit} s-{power}", lost, of)


def _forces(cam: CamElement) -> Iterator[Result]:
    """Contact force, spring, drive torque."""
    spring = cam.closure == "spring"
    (pressed, slack), (driven, driving) = _both_ways("force"), _both_ways("moment")
    of = (pressed,) if spring else (pressed, slack)
    yield from _with_angle("greatest_contact_force", "peak force between cam and follower", "N", of, _TOUCHING)
    if spring:
        words = "minimum force between cam and follower"
        yield from _with_angle("least_contact_force", words, "N", (slack,), _TOUCHING)
    for name, words, of in (
        ("greatest_moment", "peak torque that turns the cam", (driven,)),
        ("least_moment", "minimum torque that turns the cam; negative where it is driven", (driving,)),
        ("mean_moment", "mean torque that turns the cam", ()),
    ):
        yield _result(name, words, "N m", _TOUCHING, of)
    if spring:
        unit = "N" if cam.translating else "N m"
        words = "preload at which the follower just doesn't lift off"
        yield _result("needed_preload", words, unit, _SMOOTH, (Sought("shortfall", 1),))
        words = "speed of the cam at which the follower lifts off; none if it never does"
        yield _result("lift_off_speed", words, "rad s-1", _SMOOTH, (Sought("growth", 1),))
