"""Motion of a mechanism by closed formulas in Taylor series: positions of points and links, with all derivatives.

Joints are found as intersections of circles and straight lines; nothing is shared with the engine but the scene and
its conventions.
"""

from typing import NamedTuple

import numpy as np
from taylor import LONG, Series, crank

from engine import Scene
from engine.scene.scene import scene_numbers

Numbers = dict[str, object]


def numbers_of(scene: Scene, varied: dict[str, float]) -> Numbers:
    """All numbers of a scene, with the given values of varied ones."""
    absent = {f"bodies.{body}.{key}": 0.0 for body in scene.bodies for key in ("x", "y", "inertia")}
    known = {path: limit.value for path, limit in scene_numbers(scene).items()}
    return {path: LONG(value) for path, value in (absent | known | varied).items()}


class Place(NamedTuple):
    """A point of the plane."""

    x: Series
    y: Series

    def __add__(self, other: "Place") -> "Place":
        return Place(self.x + other.x, self.y + other.y)

    def __sub__(self, other: "Place") -> "Place":
        return Place(self.x - other.x, self.y - other.y)

    def times(self, factor: object) -> "Place":
        """A multiple."""
        return Place(self.x * factor, self.y * factor)

    def along(self, other: "Place") -> Series:
        """Scalar product."""
        return self.x * other.x + self.y * other.y

    def across(self, other: "Place") -> Series:
        """Cross product self × other."""
        return self.x * other.y - self.y * other.x

    @property
    def left(self) -> "Place":
        """Turned by a right angle, counter-clockwise."""
        return Place(-self.y, self.x)

    @property
    def squared(self) -> Series:
        """Square of the magnitude."""
        return self.along(self)

    def by_angle(self) -> "Place":
        """Derivative by the crank angle."""
        return Place(self.x.by_angle(), self.y.by_angle())


class Pose(NamedTuple):
    """Origin and direction of a link."""

    origin: Place
    way: Place

    def point(self, x: object, y: object) -> Place:
        """A point in the link's axes."""
        return self.origin + self.way.times(x) + self.way.left.times(y)

    def turned(self, c: object, s: object) -> Place:
        """A direction at a fixed angle to the link."""
        return self.way.times(c) + self.way.left.times(s)

    @property
    def rate(self) -> Series:
        """Angular velocity by the crank angle."""
        return self.way.across(self.way.by_angle())


class Motion:
    """Poses of links, positions of points and slides of sliders at many crank angles, as Taylor series.

    Parameters
    ----------
    scene : Scene
        With a rotating crank that turns fully; groups RRR, RRP, RPR, RPP.
    numbers : dict of str to number
        All numbers of the scene by path.
    angles : ndarray
        Crank angles.
    order : int
        Of the highest derivative of positions.
    """

    def __init__(self, scene: Scene, numbers: Numbers, angles: np.ndarray, order: int) -> None:
        self.scene, self.numbers, self.angles = scene, numbers, angles
        c, s = crank(angles, order)
        self.zero = c * LONG(0)
        self.links = {"frame": Pose(Place(self.zero, self.zero), Place(self.zero + 1, self.zero))}
        self.points: dict[str, Place] = {}
        self.slides: dict[str, Series] = {}
        self.sines: dict[str, Series] = {}
        drive = scene.input
        self._fixed("frame")
        self.links[drive.link] = Pose(self.points[drive.pivot], Place(c, s))
        self.points[drive.pin] = self.links[drive.link].point(numbers["input.length"], LONG(0))
        self._fixed(drive.link)
        for name, group in scene.groups.items():
            {"RRR": self._rrr, "RRP": self._rrp, "RPR": self._rpr, "RPP": self._rpp}[group.type](name, group)
            self._fixed(group.first.link)
            self._fixed(group.second.link)

    def _fixed(self, link: str) -> None:
        """Points that are given on a link."""
        for name, point in self.scene.points.items():
            if point.link == link:
                at = (self.numbers[f"points.{name}.{axis}"] for axis in "xy")
                self.points[name] = self.links[link].point(*at)

    def guide(self, name: str) -> tuple[Place, Place]:
        """A point of a guide, and its direction."""
        link = self.links[self.scene.guides[name].link]
        n = self.numbers
        angle = n[f"guides.{name}.angle"]
        origin = link.point(n[f"guides.{name}.x"], n[f"guides.{name}.y"])
        return origin, link.turned(np.cos(angle), np.sin(angle))

    def _rrr(self, name: str, group: object) -> None:
        a, d = self.points[group.first.joint], self.points[group.second.joint]
        r, q = (self.numbers[f"groups.{name}.{side}.length"] for side in ("first", "second"))
        base = d - a
        square = base.squared
        foot = (square + (r * r - q * q)) / (square + square)
        height = (r * r / square - foot * foot).sqrt() * group.mode
        b = a + base.times(foot) + base.left.times(height)
        self.points[group.inner] = b
        self.links[group.first.link] = Pose(a, (b - a).times(1 / r))
        self.links[group.second.link] = Pose(d, (b - d).times(1 / q))
        self.sines[name] = (b - a).across(b - d) / (r * q)

    def _rrp(self, name: str, group: object) -> None:
        a, r = self.points[group.first.joint], self.numbers[f"groups.{name}.first.length"]
        g, way = self.guide(group.second.guide)
        height = way.across(a - g) - self.numbers[f"groups.{name}.second.offset"]
        reach = (r * r - height * height).sqrt() * group.mode
        b = a + way.times(reach) - way.left.times(height)
        self.points[group.inner] = b
        self.links[group.first.link] = Pose(a, (b - a).times(1 / r))
        self.links[group.second.link] = Pose(b, way)
        self.slides[group.second.link] = (b - g).along(way)
        self.sines[name] = reach / r

    def _rpr(self, name: str, group: object) -> None:
        a, d = self.points[group.first.joint], self.points[group.second.joint]
        offset, arm = self.numbers[f"groups.{name}.second.offset"], a - d
        slide = (arm.squared - offset * offset).sqrt() * group.mode
        # slide·u + offset·n = arm
        way = (arm.times(slide) - arm.left.times(offset)).times(1 / arm.squared)
        self.links[group.first.link], self.links[group.second.link] = Pose(a, way), Pose(d, way)
        self.sines[name] = slide / arm.squared.sqrt()

    def _rpp(self, name: str, group: object) -> None:
        a, n = self.points[group.first.joint], self.numbers
        g, way = self.guide(group.second.guide)
        angle = n[f"groups.{name}.second.slot_angle"]
        slot = Pose(g, way).turned(np.cos(angle), np.sin(angle))
        sine = way.across(slot)
        slide = (a - g).across(slot) / sine
        self.links[group.first.link] = Pose(a, slot)
        self.links[group.second.link] = Pose(g + way.times(slide), way)
        self.slides[group.second.link] = slide
        self.sines[name] = sine
