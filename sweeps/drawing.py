"""A mechanism drawn to scale with the symbols of the theory of mechanisms: hinges, guides, sliders, slotted links.

`primitives` gives lines, polygons, circles and names in metres and in painting order: what comes later hides what
it covers. `draw` paints them on axes of matplotlib. Points of the plane are complex numbers here, x + iy.
"""

import cmath
import math
from collections.abc import Iterable, Mapping, Sequence
from functools import cache
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.font_manager import FontProperties
from matplotlib.patches import Circle, PathPatch, Polygon
from matplotlib.path import Path as Outline
from matplotlib.textpath import TextPath

from engine import SENTENCES, Machine, Scene, Verdict
from engine.names import did_you_mean, input_point
from engine.parts import FRAME, CrankInput, Hinged, Sliding
from engine.quantities import has_cycle
from engine.scene import Numbers
from engine.structure import order
from sweeps.diagrams import MM_PER_INCH, VERMILION, PictureError, house_style, new_figure, save
from sweeps.engineer_units import engineer_unit

LAYERS = ("frame", "hatching", "pitch", "paths", "links", "joints", "names")
POSITIONS = 720

# Sizes of the symbols in radii of a hinge.
HALF_LENGTH, HALF_HEIGHT = 3.2, 2.0
PIVOT_WIDTH, PIVOT_HEIGHT = 2.3, 4.0
HATCH_STEP = 1.5
NAME_HEIGHT = 2.6


class Primitive(NamedTuple):
    """A figure of a drawing.

    Attributes
    ----------
    layer : str
        One of `LAYERS`.
    kind : {"line", "polygon", "circle", "text"}
        Polygons are convex.
    points : tuple of complex
        Vertices x + iy [m]; the centre of a circle or a text.
    size : float
        Radius of a circle, height of a text [m].
    fill : {"none", "paper", "tint", "solid"}
        What a polygon or circle is filled with; "none" hides nothing.
    text : str
    """

    layer: str
    kind: Literal["line", "polygon", "circle", "text"]
    points: tuple[complex, ...]
    size: float = 0.0
    fill: Literal["none", "paper", "tint", "solid"] = "none"
    text: str = ""


class Slider(NamedTuple):
    """A link that slides on a guide with its joint at an offset to the guide's left."""

    link: str
    joint: str
    guide: str
    offset: float


class Motion:
    """Where the points and links of a scene are at every node of the cycle.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float, optional
        Numbers (SI) in place of the scene's.

    Attributes
    ----------
    q : ndarray (nodes,)
        Crank angles [rad] or displacements of a sliding input [m].
    points : dict of str to complex ndarray (nodes,)
    slides : dict of str to ndarray (nodes,)
    radius : float
        Radius of a hinge, which scales all symbols [m].

    Raises
    ------
    PictureError
        The mechanism can't be assembled at any position, or a value is outside the limits of its number.
    """

    def __init__(self, scene: Scene, values: Mapping[str, float] | None = None) -> None:
        values = dict(values or {})
        self.scene, structure = scene, order(scene)
        drive = scene.input
        moving = [n for n, p in scene.points.items() if p.link != FRAME]
        moving += [g.inner for g in scene.groups.values() if hasattr(g, "inner")]
        moving.append(input_point(scene))
        fields = [f"{n}.{axis}" for n in moving for axis in "xy"] + [f"{n}.slide" for n in structure.sliders]
        machine = Machine(scene, fields=fields, varied=values, positions=POSITIONS)
        outcome = machine.evaluate({path: np.array([value]) for path, value in values.items()})
        self.numbers = Numbers(scene, values)
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
        if not np.isfinite(sum(self.points.values())).any():
            verdict = SENTENCES[Verdict(int(outcome.status[0]))]
            raise PictureError(f"this mechanism can't be drawn at any position: {verdict}")
        self.links = (*structure.links, FRAME)
        self.axes, self.guide = cache(self._axes), cache(self._guide)
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
            sentence = SENTENCES[Verdict.CANNOT_ASSEMBLE]
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
            ratio, phase = self.numbers[f"shafts.{link}.ratio"], self.numbers[f"shafts.{link}.phase"]
            return self.points[self.scene.shafts[link].pivot], np.exp(1j * (ratio * self.q + phase))
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

    def _radius(self) -> float:
        """Radius of a hinge: a share of the whole, smaller where links are short."""
        cloud = np.concatenate([*self.points.values(), *self._stems()])
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
        elif link != FRAME:
            name, part = self._part(link)
            inner = isinstance(part, (Hinged, Sliding))
            found = [part.joint] if hasattr(part, "joint") else []
            found += [self.scene.groups[name].inner] if inner else []
        return found + [n for n, p in self.scene.points.items() if p.link == link]

    @property
    def hinges(self) -> set[str]:
        """Points that are revolute pairs."""
        drive = self.scene.input
        found = {drive.pivot} if isinstance(drive, CrankInput) else set()
        found |= {s.pivot for s in self.scene.shafts.values() if s.pivot is not None}
        for group in self.scene.groups.values():
            found |= {p.joint for p in (group.first, group.second) if hasattr(p, "joint")}
            found |= {group.inner} if hasattr(group, "inner") else set()
        return found


def _unit(vectors: np.ndarray) -> np.ndarray:
    # Where the mechanism can't be assembled, undefined stays undefined.
    with np.errstate(invalid="ignore"):
        return vectors / np.abs(vectors)


# Symbols


def _line(*points: complex, layer: str = "links") -> Primitive:
    return Primitive(layer, "line", tuple(complex(p) for p in points))


def _polygon(*points: complex, fill: str = "tint", layer: str = "links") -> Primitive:
    return Primitive(layer, "polygon", tuple(complex(p) for p in points), fill=fill)


def _box(centre: complex, u: complex, half_length: float, half_height: float, fill: str = "tint") -> Primitive:
    along, across = half_length * u, 1j * half_height * u
    corners = (centre - along - across, centre + along - across, centre + along + across, centre - along + across)
    return _polygon(*corners, fill=fill)


def _hatched(a: complex, b: complex, r: float) -> list[Primitive]:
    """A line of the frame from a to b, the frame on its right."""
    u = (b - a) / abs(b - a)
    count = max(2, round(abs(b - a) / (HATCH_STEP * r)))
    starts = a + (b - a) * (np.arange(count) + 0.7) / count
    strokes = [_line(p, p - HATCH_STEP * r * (0.8 + 0.9j) * u, layer="hatching") for p in starts]
    return [*strokes, _line(a, b, layer="frame")]


def _shape(points: Sequence[complex], r: float) -> list[Primitive]:
    """A link through some points: a line, or a filled polygon where they don't lie on one line."""
    distinct: list[complex] = []
    for p in points:
        if all(abs(p - d) > 0.3 * r for d in distinct):
            distinct.append(p)
    if len(distinct) < 2:
        return []
    a, b = max(((p, q) for p in distinct for q in distinct), key=lambda ends: abs(ends[1] - ends[0]))
    if max(abs(((p - a) / (b - a)).imag) * abs(b - a) for p in distinct) < 1.2 * r:
        return [_line(a, b)]
    return [_polygon(*_hull(distinct))]


def _hull(points: Sequence[complex]) -> list[complex]:
    """Convex hull, counter-clockwise (Andrew's monotone chain)."""

    def chain(ordered: Sequence[complex]) -> list[complex]:
        found: list[complex] = []
        for p in ordered:
            while len(found) > 1 and ((found[-1] - found[-2]).conjugate() * (p - found[-2])).imag <= 0:
                found.pop()
            found.append(p)
        return found[:-1]

    ordered = sorted(points, key=lambda p: (p.real, p.imag))
    return chain(ordered) + chain(ordered[::-1])


def _weld(corner: complex, u: complex, v: complex, r: float) -> list[Primitive]:
    """Marks in the two corners that a line along u makes with a line along ±v: the lines are of one piece."""
    return [_polygon(corner, corner + 1.6 * r * u, corner + s * 1.6 * r * v, fill="solid") for s in (1, -1)]


def _fixed_pivot(c: complex, r: float) -> list[Primitive]:
    foot, half = c - 1j * PIVOT_HEIGHT * r, PIVOT_WIDTH * r
    triangle = _polygon(c, foot - half, foot + half, fill="paper", layer="frame")
    return [*_hatched(foot - 1.6 * half, foot + 1.6 * half, r), triangle]


def _zigzag(a: complex, b: complex, r: float) -> Primitive:
    steps = np.array([0, 0.2, *(0.2 + 0.6 * (np.arange(14) + 0.5) / 14), 0.8, 1.0])
    sides = np.array([0, 0, *(-1.0) ** np.arange(14), 0, 0])
    u = (b - a) / abs(b - a)
    return _line(*(a + steps * (b - a) + 2.2j * r * sides * u))


def _arrow(points: Sequence[complex], r: float) -> list[Primitive]:
    u = (points[-1] - points[-2]) / abs(points[-1] - points[-2])
    tip = points[-1] + 2.4 * r * u
    head = _polygon(tip, points[-1] + 0.85j * r * u, points[-1] - 0.85j * r * u, fill="solid", layer="names")
    return [_line(*points, layer="names"), head]


# The frame


def _frame(m: Motion) -> list[Primitive]:
    """Fixed pivots, guides of the frame and gears' pitch circles: what is the same at every position."""
    r, scene, found = m.radius, m.scene, []
    for slider in m.sliders:
        if scene.guides[slider.guide].link == FRAME:
            found += _hatched(*_rail(m, slider), r)
    for group in scene.groups.values():
        if group.type == "RPP" and scene.guides[group.second.guide].link == FRAME:
            place, along = (values[0] for values in m.guide(group.second.guide))
            bush = place + _bush_at(m, group) * along
            for side in (1, -1):
                ends = [bush + r * along * (side * 1.2j - side * half) for half in (4, -4)]
                found += _hatched(*ends, r)
    for name, shaft in scene.shafts.items():
        if shaft.pivot is not None:
            found += _gearing(
                *(m.points[p][0] for p in (scene.input.pivot, shaft.pivot)), m.numbers[f"shafts.{name}.ratio"]
            )
    anchors = m.hinges | {end for s in scene.springs.values() for end in s.between}
    for name in sorted(anchors):
        if name in scene.points and scene.points[name].link == FRAME:
            found += _fixed_pivot(m.points[name][0], r)
    return found


def _rail(m: Motion, slider: Slider) -> tuple[complex, complex]:
    """Ends of a fixed guide under a slider, on the side where the mechanism isn't; the frame is on their right."""
    r = m.radius
    place, u = (complex(values[0]) for values in m.guide(slider.guide))
    base = place + 1j * slider.offset * u
    others = np.concatenate(list(m.points.values()))
    side = float(np.nanmean(((others - base) / u).imag))
    if abs(side) < 2 * r:
        side = u.real if abs(u.real) > 1e-9 else u.imag
    margin, (low, high) = (HALF_LENGTH + 2) * r, m.range_of(slider.link)
    ends = [base + s * u - 1j * math.copysign(HALF_HEIGHT * r, side) * u for s in (low - margin, high + margin)]
    return (ends[0], ends[1]) if side > 0 else (ends[1], ends[0])


def _bush_at(m: Motion, group: object) -> float:
    """Where along its guide the stem of a yoke is held: beyond the stroke."""
    return m.range_of(group.second.link)[1] + 12 * m.radius


def _gearing(a: complex, b: complex, ratio: float) -> list[Primitive]:
    """Pitch circles of two wheels in mesh; of a belt or chain where both turn the same way."""
    d = abs(b - a)
    if d == 0:
        return []
    r1, r2 = (d * share / (1 + abs(ratio)) for share in (abs(ratio), 1))
    straps = []
    if ratio > 0:
        r1, r2 = r1 / 2, r2 / 2
        for side in (1, -1):
            n = (b - a) / d * cmath.exp(1j * side * math.acos((r1 - r2) / d))
            straps.append(_line(a + r1 * n, b + r2 * n, layer="pitch"))
    return [Primitive("pitch", "circle", (c,), radius) for c, radius in ((a, r1), (b, r2))] + straps


# Moving links


def _moving(m: Motion, k: int) -> list[Primitive]:
    """Links, sliders and hinges at a node, without names."""
    r, scene = m.radius, m.scene
    under, plates, over = [], [], []
    carriers = {scene.guides[s.guide].link for s in m.sliders}
    carriers |= {g.second.link for g in scene.groups.values() if g.type in ("RPR", "RPP")}
    for link in m.links[:-1]:
        shape = _shape([m.axes(link)[0][k], *(m.points[n][k] for n in m.members(link))], r)
        is_plate = bool(shape) and shape[0].kind == "polygon"
        (under if link in carriers else plates if is_plate else over).extend(shape)
    for name, group in scene.groups.items():
        if group.type in ("RPR", "RPP"):
            under += _slotted(m, name, k)
    for slider in m.sliders:
        if scene.guides[slider.guide].link != FRAME:
            under += _moving_guide(m, slider, k)
    boxes = [_box(m.points[s.joint][k], m.guide(s.guide)[1][k], HALF_LENGTH * r, HALF_HEIGHT * r) for s in m.sliders]
    spans = [tuple(m.points[end][k] for end in s.between) for s in scene.springs.values()]
    springs = [_zigzag(a, b, r) for a, b in spans if abs(b - a) > r]
    return [*under, *boxes, *plates, *over, *springs, *_joints(m, k)]


def _slotted(m: Motion, name: str, k: int) -> list[Primitive]:
    """Slotted link and block of RPR or RPP."""
    r, group = m.radius, m.scene.groups[name]
    origin, u = m.axes(group.second.link)[0][k], m.axes(group.first.link)[1][k]
    pin = m.points[group.first.joint][k]
    low, high = m.range_of(group.first.link)
    foot = origin + m.slides[group.first.link][k] * u
    block = _box(foot, u, HALF_LENGTH * r, HALF_HEIGHT * r)
    margin = (HALF_LENGTH + 1.5) * r
    if group.type == "RPR":
        return [_line(*_rod(m, name, k)), _line(foot, pin), block]
    slot = _box(origin + (low + high) / 2 * u, u, (high - low) / 2 + margin, HALF_HEIGHT * r, "paper")
    along = m.axes(group.second.link)[1][k]
    start = origin + HALF_HEIGHT * r / abs((u / along).imag) * along
    held = m.guide(group.second.guide)[0][k] + (_bush_at(m, group) + 4 * r) * along
    tip = held + (m.slides[group.second.link][k] - m.range_of(group.second.link)[0] + 1.5 * r) * along
    below = [_line(start, tip), *_weld(start, along, u, r), slot, block]
    if m.scene.guides[group.second.guide].link != FRAME:
        below.append(_box(held - 4 * r * along, along, 4 * r, 1.2 * r))
    return below


def _rod(m: Motion, name: str, k: int) -> tuple[complex, complex]:
    """Ends of the rod that serves the rocker of RPR as its slot."""
    group = m.scene.groups[name]
    origin, u = (values[k] for values in m.axes(group.second.link))
    low, high = m.range_of(group.first.link)
    margin = (HALF_LENGTH + 1.5) * m.radius
    return origin + min(low - margin, 0) * u, origin + max(high + margin, 0) * u


def _moving_guide(m: Motion, slider: Slider, k: int) -> list[Primitive]:
    """The rod that guides a slider on a moving link, joined to the link's origin."""
    r = m.radius
    place, u = (values[k] for values in m.guide(slider.guide))
    place = place + 1j * slider.offset * u
    origin = m.axes(m.scene.guides[slider.guide].link)[0][k]
    low, high = (s + side * (HALF_LENGTH + 2) * r for s, side in zip(m.range_of(slider.link), (-1, 1), strict=True))
    apart = (origin - place) / u
    if abs(apart.imag) < 0.5 * r:
        return [_line(place + min(low, apart.real) * u, place + max(high, apart.real) * u)]
    foot = place + min(max(low, apart.real), high) * u
    arm = (origin - foot) / abs(origin - foot)
    return [_line(place + low * u, place + high * u), _line(origin, foot), *_weld(foot, arm, u, r)]


def _joints(m: Motion, k: int) -> list[Primitive]:
    """Hinges, dots at other points, and a stroke through a hinge where a link goes on beyond it."""
    r, hinges = m.radius, m.hinges
    rest = {n for n, p in m.scene.points.items() if p.link == FRAME}
    found = [
        Primitive(
            "joints", "circle", (complex(p[k]),), r if n in hinges else 0.55 * r, "paper" if n in hinges else "solid", n
        )
        for n, p in m.points.items()
        if n in hinges or n not in rest
    ]
    rods = {g.second.link: _rod(m, name, k) for name, g in m.scene.groups.items() if g.type == "RPR"}
    for link in m.links[:-1]:
        names = m.members(link)
        shape = _shape([*rods.get(link, ()), *(m.points[n][k] for n in names)], r)
        if shape and shape[0].kind == "line":
            a, b = shape[0].points
            u = r * (b - a) / abs(b - a)
            inside = [m.points[n][k] for n in names if n in hinges]
            found += [_line(p - u, p + u, layer="joints") for p in inside if min(abs(p - a), abs(p - b)) > r]
    return found


# Names and the sense of motion


def _sense(m: Motion, k: int) -> list[Primitive]:
    """Arrow of the input's motion."""
    r, drive = m.radius, m.scene.input
    sense = math.copysign(1, m.numbers["input.speed"])
    if isinstance(drive, CrankInput):
        length = m.numbers["input.length"]
        radius = 0.55 * length if length > 9 * r else length + 3.5 * r
        turn = max(0.6, min(1.2, 9 * r / radius))
        angles = m.q[k] + sense * np.linspace(0.25, 0.25 + turn, 24)
        return _arrow(m.points[drive.pivot][k] + radius * np.exp(1j * angles), r)
    u = m.guide(drive.guide)[1][k]
    face = m.points[drive.point][k] + sense * (HALF_LENGTH + 1) * r * u
    return _arrow([face, face + 4 * r * sense * u], r)


def _segments(drawn: Iterable[Primitive]) -> np.ndarray:
    """All outlines as segments, complex (segments, 2)."""
    found = []
    for p in drawn:
        corners = np.array(p.points)
        if p.kind == "circle":
            corners = p.points[0] + p.size * np.exp(2j * np.pi * np.arange(8) / 8)
        if p.kind in ("circle", "polygon"):
            corners = np.append(corners, corners[0])
        found.append(np.stack([corners[:-1], corners[1:]], axis=1))
    return np.concatenate(found)


def _marks(drawn: Iterable[Primitive], step: float) -> np.ndarray:
    """Points along all outlines, no farther apart than a step."""
    pieces = _segments(drawn)
    pieces = pieces[np.isfinite(pieces).all(axis=1)]
    counts = np.minimum(np.ceil(np.abs(pieces[:, 1] - pieces[:, 0]) / step).astype(int) + 1, 400)
    return np.concatenate([np.linspace(a, b, n) for (a, b), n in zip(pieces, counts, strict=True)])


def _names(m: Motion, k: int, drawn: Iterable[Primitive]) -> list[Primitive]:
    """Names beside their points, where they cover least of what is drawn."""
    height, found = NAME_HEIGHT * m.radius, []
    marks = _marks(drawn, 0.3 * height)
    around = np.exp(1j * np.radians([45, 135, 0, 180, 90, 270, 315, 225, 20, 70, 110, 160, 200, 250, 290, 340]))
    u, reach = np.tile(around, 4), np.repeat([0.25, 0.5, 1.0, 1.7], around.size)
    square = np.add.outer(np.linspace(-1, 1, 5), 1j * np.linspace(-1, 1, 5)).ravel()
    for joint in _joints(m, k):
        if joint.text:
            half = complex(0.36 * len(joint.text), 0.5) * height
            beside = half.real * np.clip(1.5 * u.real, -1, 1) + 1j * half.imag * u.imag
            places = joint.points[0] + (joint.size + height * reach) * u + beside
            gap = marks - places[:, None]
            covered = (np.abs(gap.real) < 1.35 * half.real) & (np.abs(gap.imag) < 1.2 * half.imag)
            at = places[np.argmin(3 * covered.sum(axis=1) + reach)]
            found.append(Primitive("names", "text", (complex(at),), height, "none", joint.text))
            marks = np.append(marks, at + square.real * half.real + 1j * square.imag * half.imag)
    return found


# Pictures


def primitives(
    scene: Scene, phi: float, values: Mapping[str, float] | None = None, paths: Sequence[str] = ()
) -> list[Primitive]:
    """Figures of a mechanism at a position, in painting order.

    Parameters
    ----------
    scene : Scene
    phi : float
        Crank angle [rad], or displacement of a sliding input [m]; the nearest of 720 nodes is drawn.
    values : mapping of path to float, optional
        Numbers (SI) in place of the scene's.
    paths : sequence of str
        Points whose paths over the cycle are wanted.

    Returns
    -------
    list of Primitive
        In metres.

    Raises
    ------
    PictureError
        The position can't be drawn, or a point of `paths` doesn't exist.
    """
    return figures(Motion(scene, values), [phi], paths)[-1]


def figures(motion: Motion, at: Sequence[float], paths: Sequence[str] = ()) -> list[list[Primitive]]:
    """Figures of a mechanism at several positions, the first of them whole and last in painting order.

    Parameters
    ----------
    motion : Motion
    at : sequence of float
        Crank angles [rad] or displacements [m].
    paths : sequence of str
        As of `primitives`.

    Returns
    -------
    list of list of Primitive
        The moving links at the other positions, then everything at the first.
    """
    for name in paths:
        if name not in motion.points:
            raise PictureError(f"paths: {name!r} is not a point of this scene; {did_you_mean(name, motion.points)}")
    first, *rest = (motion.node(place) for place in at)
    trails = [motion.points[n] for n in paths]
    if has_cycle(motion.scene):
        trails = [_once(trail, 0.5 * motion.radius) for trail in trails]
    trails = [_line(*trail, layer="paths") for trail in trails]
    others = [_moving(motion, k) for k in rest]
    whole = [*_frame(motion), *trails, *_moving(motion, first), *_sense(motion, first)]
    obstacles = [*whole, *(p for other in others for p in other)]
    return [*others, [*whole, *_names(motion, first, obstacles)]]


def _once(path: np.ndarray, near: float) -> np.ndarray:
    """A closed path; the half of it where the point comes back the way it went, since dashes would fill up."""
    steps = np.diff(path, append=path[:1])
    ends = np.flatnonzero((steps * np.roll(steps, 1).conj()).real < 0)
    if ends.size == 2:
        there, back = path[ends[0] : ends[1] + 1], np.roll(path, -ends[1])[: path.size - np.diff(ends)[0] + 1]
        if max(np.abs(back - p).min() for p in there[::10]) < near:
            return there
    return np.append(path, path[0])


def default_position(motion: Motion) -> float:
    """Where to draw a mechanism when nobody says: the crank at 60°, or the middle of the input's range."""
    return math.pi / 3 if has_cycle(motion.scene) else float(motion.q[motion.q.size // 2])


# Line widths [pt] of the layers, and how dark they are.
WIDTHS = {"frame": 1.0, "hatching": 0.5, "pitch": 0.6, "paths": 0.9, "links": 1.5, "joints": 1.1, "names": 0.8}
FILLS = {"none": "none", "paper": "white", "tint": "#e4e8ec", "solid": "black"}
DASHES = {"pitch": (0, (9, 2.5, 1.5, 2.5)), "paths": (0, (5, 2.5))}
GHOST = "#a8adb3"


def draw(
    scene: Scene,
    ax: Axes,
    at: Sequence[float] = (),
    paths: Sequence[str] = (),
    values: Mapping[str, float] | None = None,
) -> None:
    """Draw a mechanism to scale on axes of matplotlib.

    Parameters
    ----------
    scene : Scene
    ax : matplotlib.axes.Axes
    at : sequence of float
        Crank angles [rad] or displacements of a sliding input [m]: the first is drawn in black, the others lightly.
        Without any, the crank stands at 60°, a sliding input in mid-range.
    paths : sequence of str
        Points whose paths over the cycle are drawn dashed.
    values : mapping of path to float, optional
        Numbers (SI) in place of the scene's.

    Raises
    ------
    PictureError
        A position can't be drawn, or a point of `paths` doesn't exist.
    """
    motion = Motion(scene, values)
    poses = figures(motion, list(at) or [default_position(motion)], paths)
    extent = bounds(q for pose in poses for q in pose)
    factor = prepare(ax, extent, motion.radius)
    for pose in poses:
        paint(ax, pose, factor, ghost=pose is not poses[-1])


def bounds(drawn: Iterable[Primitive]) -> tuple[float, float, float, float]:
    """Least x, least y, greatest x, greatest y of figures [m]."""
    reach = [
        (p.points, complex(0.37 * len(p.text), 0.5) * p.size if p.kind == "text" else complex(p.size, p.size))
        for p in drawn
    ]
    x = [c.real + s * half.real for points, half in reach for c in points for s in (-1, 1)]
    y = [c.imag + s * half.imag for points, half in reach for c in points for s in (-1, 1)]
    return np.nanmin(x), np.nanmin(y), np.nanmax(x), np.nanmax(y)


def prepare(ax: Axes, extent: tuple[float, float, float, float], radius: float) -> float:
    """Set equal scales, limits and labels of axes; return the factor from metres to the unit shown."""
    factor, label = engineer_unit("m", np.array(extent))
    low_x, low_y, high_x, high_y = (factor * value for value in extent)
    margin = 2.5 * factor * radius
    ax.set(xlim=(low_x - margin, high_x + margin), ylim=(low_y - margin, high_y + margin))
    ax.set_aspect("equal")
    ax.grid(False)
    ax.set(xlabel=f"x, {label}", ylabel=f"y, {label}")
    ax.spines[["top", "right"]].set_visible(False)
    return factor


def paint(ax: Axes, drawn: Iterable[Primitive], factor: float, ghost: bool = False) -> None:
    """Paint figures on axes; lightly where they are of a position that only accompanies another."""
    ink = GHOST if ghost else "black"
    for z, p in enumerate(drawn, 2):
        vertices = factor * np.column_stack([np.real(p.points), np.imag(p.points)])
        style = {
            "edgecolor": VERMILION if p.layer == "paths" else ink,
            "facecolor": {"solid": ink, "tint": "none"}.get(p.fill, FILLS[p.fill]) if ghost else FILLS[p.fill],
            "linewidth": WIDTHS[p.layer] * (0.6 if ghost else 1.0),
            "linestyle": DASHES.get(p.layer, "solid"),
            "zorder": z / 1000 if ghost else 3 + (p.layer == "paths") + 2 * (p.layer in ("joints", "names")) + z / 1000,
        }
        if p.kind == "text":
            ax.add_patch(_lettering(p, factor, style["zorder"]))
        elif p.kind == "circle":
            ax.add_patch(Circle(vertices[0], factor * p.size, **style))
        elif p.kind == "polygon":
            ax.add_patch(Polygon(vertices, joinstyle="round", **style))
        else:
            ax.add_patch(PathPatch(Outline(vertices), **{**style, "facecolor": "none"}, capstyle="round"))


def _lettering(p: Primitive, factor: float, zorder: float) -> PathPatch:
    """A name as outlines of its letters, so that it keeps its size in the drawing whatever the figure's."""
    path = TextPath((0, 0), p.text, size=factor * p.size, prop=FontProperties(family="DejaVu Serif", style="italic"))
    box = path.get_extents()
    at = p.points[0] * factor - complex(box.x0 + box.x1, box.y0 + box.y1) / 2
    moved = Outline(path.vertices + np.array([at.real, at.imag]), path.codes)
    return PathPatch(moved, facecolor="black", edgecolor="none", zorder=zorder)


def picture(
    scene: Scene,
    path: Path | str,
    at: Sequence[float] = (),
    paths: Sequence[str] = (),
    values: Mapping[str, float] | None = None,
) -> None:
    """Draw a mechanism to a file by itself (.svg, .pdf, .png), 160 mm wide at most; arguments as of `draw`."""
    with house_style():
        fig = new_figure(160, 160)
        ax = fig.add_subplot()
        draw(scene, ax, at, paths, values)
        width, height = np.ptp(ax.get_xlim()), np.ptp(ax.get_ylim())
        scale = min(145 / width, 200 / height)
        fig.set_size_inches((scale * width + 18) / MM_PER_INCH, (scale * height + 15) / MM_PER_INCH)
    save(fig, path)
