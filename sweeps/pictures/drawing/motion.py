"""Where the points, links and sliders of a mechanism are over its cycle, as complex numbers x + iy [m]."""

import cmath
import math
from collections.abc import Iterable, Mapping
from functools import cache
from typing import NamedTuple

import numpy as np

from engine import (
    FRAME,
    CrankInput,
    DrivingCam,
    Hinged,
    Machine,
    NoncircularWheel,
    Pinion,
    Rack,
    Scene,
    SceneNumbers,
    SecondCrank,
    SecondSlider,
    Sliding,
    Verdict,
    has_cycle,
    input_point,
    joint_owners,
    order_groups,
    scene_numbers,
)
from sweeps.pictures.picture_error import PictureError

POSITIONS = 720


class Slider(NamedTuple):
    """A link that slides on a guide with its joint, if it has one, at an offset to the guide's left."""

    link: str
    joint: str | None
    guide: str
    offset: float


class DrawnMotion:
    """Where the points and links of a scene are at every node of the cycle.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) in place of the scene's.

    Attributes
    ----------
    values : dict of str to float
    q : ndarray (nodes,)
        Crank angles [rad] or displacements of a sliding input [m].
    points : dict of str to complex ndarray (nodes,)
    slides : dict of str to ndarray (nodes,)
    contacts : dict of str to complex ndarray (nodes,)
        Where cams touch their followers.
    profiles : dict of str to complex ndarray (points,)
        Of cams, in the axes of the links that they sit on: closed where the cam makes a turn.
    pitch_curves : dict of str to (complex ndarray, complex ndarray)
        Of non-circular wheels, each in the axes of its own link: its own, and that of its driver.
    radius : float
        Radius of a hinge, which scales all symbols [m].

    Raises
    ------
    PictureError
        The mechanism can't be assembled at any position, or a value is outside the limits of its number.
    """

    def __init__(self, scene: Scene, values: Mapping[str, float] | None = None) -> None:
        self.values = values = dict(values or {})
        self.scene, structure = scene, order_groups(scene)
        drive = scene.input
        moving = [n for n, p in scene.points.items() if p.link != FRAME]
        moving += [g.inner for g in scene.groups.values() if hasattr(g, "inner")]
        moving += [joint for joint, link in joint_owners(scene).items() if link in scene.links and joint not in moving]
        moving.append(input_point(scene))
        fields = [f"{n}.{axis}" for n in moving for axis in "xy"] + [f"{n}.slide" for n in structure.sliders]
        free = [name for name, link in scene.links.items() if link.guide is None]
        free += [cam.follower.link for cam in scene.cams.values() if not cam.translating]
        free += [name for name, shaft in scene.shafts.items() if shaft.pivot is not None]
        free += self._wheels
        fields += [f"{n}.angle" for n in free]
        fields += [f"{n}.contact_{axis}" for n in scene.cams for axis in "xy"]
        fields += [f"{n}.pitch_{axis}" for n in scene.noncircular_wheels for axis in "xy"]
        machine = Machine(scene, fields=fields, varied=values, positions=POSITIONS)
        outcome = machine.evaluate({path: np.array([value]) for path, value in values.items()})
        self.numbers = SceneNumbers(scene_numbers(scene), values)
        self.q = machine.nodes
        if not isinstance(drive, CrankInput):
            start, stop = self.numbers["input.start"], self.numbers["input.stop"]
            self.q = start + (stop - start) * self.q
        at_rest = np.ones_like(self.q)
        self.points = {
            n: (self.numbers[f"points.{n}.x"] + 1j * self.numbers[f"points.{n}.y"]) * at_rest
            for n, p in scene.points.items()
            if p.link == FRAME
        }
        rows = {name: row[0].astype(float) for name, row in outcome.fields.items()}
        self.points |= {n: rows[f"{n}.x"] + 1j * rows[f"{n}.y"] for n in moving}
        self.slides = {n: rows[f"{n}.slide"] for n in structure.sliders}
        self._turned = {n: np.exp(1j * rows[f"{n}.angle"]) for n in free}
        if not np.isfinite(sum(self.points.values())).any():
            verdict = Verdict(int(outcome.status[0])).sentence
            raise PictureError(f"this mechanism can't be drawn at any position: {verdict}")
        self.contacts = {n: rows[f"{n}.contact_x"] + 1j * rows[f"{n}.contact_y"] for n in scene.cams}
        pitch_points = {n: rows[f"{n}.pitch_x"] + 1j * rows[f"{n}.pitch_y"] for n in scene.noncircular_wheels}
        self.links = (*structure.links, FRAME)
        self.axes, self.guide = cache(self._axes), cache(self._guide)
        self.profiles = {name: self._profile(name) for name in scene.cams}
        self.pitch_curves = {
            name: tuple((point - self.axes(link)[0]) / self.axes(link)[1] for link in (name, wheel.geared_to))
            for (name, wheel), point in zip(scene.noncircular_wheels.items(), pitch_points.values(), strict=True)
        }
        self.sliders = tuple(self._sliders())
        self.radius = self._radius()

    def node(self, at: float) -> int:
        """Number of the node nearest to a crank angle [rad] or displacement [m].

        Raises
        ------
        PictureError
            The place is outside the range of the input, or the mechanism can't be assembled there.
        """
        step = self.q[1] - self.q[0]
        k = round((at - self.q[0]) / step)
        if has_cycle(self.scene):
            k %= self.q.size
        elif not 0 <= k < self.q.size:
            raise PictureError(f"position {at:g} is outside the input's range {self.q[0]:g} to {self.q[-1]:g}")
        if not all(np.isfinite(p[k]) for p in self.points.values()):
            sentence = Verdict.CANNOT_ASSEMBLE.sentence
            raise PictureError(f"position {at:g} can't be drawn: {sentence}; or ask for another position")
        return k

    def _part(self, link: str) -> tuple[str, object]:
        """The group and the part of it that a link is."""
        for name, group in self.scene.groups.items():
            for part in (group.first, group.second):
                if part.link == link:
                    return name, part
        raise KeyError(link)

    def _axes(self, link: str) -> tuple[np.ndarray, np.ndarray]:
        """Origin and direction of a link's axes at every node."""
        drive, one = self.scene.input, np.ones_like(self.q) + 0j
        if link == FRAME:
            return 0 * one, one
        if link == drive.link and isinstance(drive, CrankInput):
            return self.points[drive.pivot], np.exp(1j * self.q)
        if link == drive.link:
            return self.points[drive.point], self.guide(drive.guide)[1]
        if link in self.scene.shafts:
            return self.points[self.scene.shafts[link].pivot], self._turned[link]
        if link in self._wheels:
            return self.points[self._wheels[link].pivot], self._turned[link]
        if link in self._driven_sliders:
            place, along = self.guide(self._driven_sliders[link].guide)
            return place + self.slides[link] * along, along
        if link in self.scene.links:
            return self._free_axes(link)
        if link in self._followers:
            follower = self._followers[link].follower
            if follower.type == "oscillating":
                return self.points[follower.pivot], self._turned[link]
            place, along = self.guide(follower.guide)
            return place + self.slides[link] * along, along
        name, part = self._part(link)
        group = self.scene.groups[name]
        if isinstance(part, Hinged):
            return self.points[part.joint], _unit(self.points[group.inner] - self.points[part.joint])
        if isinstance(part, Sliding):
            return self.points[group.inner], self.guide(part.guide)[1]
        if part is group.first:
            turned = cmath.exp(1j * self.numbers[f"groups.{name}.second.slot_angle"]) if group.type == "RPP" else 1
            return self.points[part.joint], self.axes(group.second.link)[1] * turned
        if group.type == "RPP":
            place, along = self.guide(part.guide)
            return place + self.slides[link] * along, along
        arm = self.points[group.first.joint] - self.points[part.joint]
        slide = self.slides[group.first.link]
        return self.points[part.joint], _unit(arm / (slide + 1j * self.numbers[f"groups.{name}.second.offset"]))

    def _profile(self, name: str) -> np.ndarray:
        """Profile of a cam over a turn of it, or as far as it turns."""
        place, along = self.axes(self.scene.cams[name].on)
        profile = (self.contacts[name] - place) / along
        turns = abs(np.unwrap(np.angle(along))[-1] - np.angle(along[0])) / math.tau
        if not has_cycle(self.scene) and turns < 1.0:
            return profile
        count = round(profile.size / max(1.0, round(turns)))
        return np.append(profile[:count], profile[:1])

    def _free_axes(self, link: str) -> tuple[np.ndarray, np.ndarray]:
        """Axes of a free link: from one of its points, or from the guide that it slides on."""
        part = self.scene.links[link]
        if part.guide is not None:
            place, along = self.guide(part.guide)
            return place + (self.slides[link] + 1j * self.numbers[f"links.{link}.offset"]) * along, along
        along, at = self._turned[link], 0j
        point = part.joints[0] if part.joints else next(n for n, p in self.scene.points.items() if p.link == link)
        if not part.joints:
            at = self.numbers[f"points.{point}.x"] + 1j * self.numbers[f"points.{point}.y"]
        return self.points[point] - at * along, along

    def _guide(self, name: str) -> tuple[np.ndarray, np.ndarray]:
        """A point and the direction of a guide at every node."""
        x, y, angle = (self.numbers[f"guides.{name}.{key}"] for key in ("x", "y", "angle"))
        origin, direction = self.axes(self.scene.guides[name].link)
        return origin + (x + 1j * y) * direction, direction * cmath.exp(1j * angle)

    def _sliders(self) -> Iterable[Slider]:
        drive = self.scene.input
        if not isinstance(drive, CrankInput):
            yield Slider(drive.link, drive.point, drive.guide, 0.0)
        for name, group in self.scene.groups.items():
            for side in ("first", "second"):
                part = getattr(group, side)
                if isinstance(part, Sliding):
                    offset = self.numbers[f"groups.{name}.{side}.offset"]
                    yield Slider(part.link, group.inner, part.guide, offset)
        for name, link in self.scene.links.items():
            if link.guide is not None:
                yield Slider(name, next(iter(link.joints), None), link.guide, self.numbers[f"links.{name}.offset"])
        for name, second in self.scene.inputs.items():
            if isinstance(second, SecondSlider):
                yield Slider(name, None, second.guide, 0.0)

    def _radius(self) -> float:
        """Radius of a hinge: a share of the whole, smaller where links are short."""
        cloud = np.concatenate([*self.points.values(), *self._stems(), *self.contacts.values()])
        cloud = cloud[np.isfinite(cloud)]
        whole = abs(np.ptp(cloud.real) + 1j * np.ptp(cloud.imag))
        lengths = [v for path, v in self.numbers.items() if path.endswith(".length") and path[:6] != "bodies"]
        return min(whole / 85, max(0.14 * min(lengths, default=math.inf), whole / 170))

    def _stems(self) -> Iterable[np.ndarray]:
        """How far the stems of yokes reach."""
        for group in self.scene.groups.values():
            if group.type == "RPP":
                place, along = self.guide(group.second.guide)
                low, high = self.range_of(group.second.link)
                yield place + (2 * high - low) * along

    def range_of(self, link: str) -> tuple[float, float]:
        """Least and greatest slide coordinate of a slider over the cycle [m]."""
        return float(np.nanmin(self.slides[link])), float(np.nanmax(self.slides[link]))

    def members(self, link: str) -> list[str]:
        """Names of the points of a link, the origin of its axes first where that is a point."""
        drive, found = self.scene.input, []
        if link == drive.link:
            found = [drive.pivot, drive.pin] if isinstance(drive, CrankInput) else [drive.point]
        elif link in self.scene.shafts:
            found = [self.scene.shafts[link].pivot]
        elif link in self._wheels:
            found = [self._wheels[link].pivot]
        elif link in self._driven_sliders:
            found = []
        elif link in self.scene.links:
            found = list(self.scene.links[link].joints)
        elif link in self._followers:
            found = [] if self._followers[link].translating else [self._followers[link].follower.pivot]
        elif link != FRAME:
            name, part = self._part(link)
            inner = isinstance(part, (Hinged, Sliding))
            found = [part.joint] if hasattr(part, "joint") else []
            found += [self.scene.groups[name].inner] if inner else []
        return found + [n for n, p in self.scene.points.items() if p.link == link]

    @property
    def _followers(self) -> dict[str, DrivingCam]:
        """Cams by the links that they drive."""
        return {cam.follower.link: cam for cam in self.scene.cams.values()}

    @property
    def _wheels(self) -> dict[str, SecondCrank | Pinion | NoncircularWheel]:
        """Second inputs that turn, pinions that racks drive, and non-circular wheels."""
        turning = {n: second for n, second in self.scene.inputs.items() if isinstance(second, SecondCrank)}
        return {**turning, **self.scene.pinions, **self.scene.noncircular_wheels}

    @property
    def _driven_sliders(self) -> dict[str, Rack | SecondSlider]:
        """Racks, and second inputs that slide."""
        sliding = {n: second for n, second in self.scene.inputs.items() if isinstance(second, SecondSlider)}
        return {**sliding, **self.scene.racks}

    @property
    def hinges(self) -> set[str]:
        """Points that are revolute pairs."""
        drive = self.scene.input
        found = {drive.pivot} if isinstance(drive, CrankInput) else set()
        found |= {s.pivot for s in self.scene.shafts.values() if s.pivot is not None}
        found |= {wheel.pivot for wheel in self._wheels.values()}
        found |= {cam.follower.pivot for cam in self.scene.cams.values() if not cam.translating}
        for group in self.scene.groups.values():
            found |= {p.joint for p in (group.first, group.second) if hasattr(p, "joint")}
            found |= {group.inner} if hasattr(group, "inner") else set()
        return found.union(*(link.joints for link in self.scene.links.values()))


def _unit(vectors: np.ndarray) -> np.ndarray:
    # Where the mechanism can't be assembled, undefined stays undefined.
    with np.errstate(invalid="ignore"):
        return vectors / np.abs(vectors)
