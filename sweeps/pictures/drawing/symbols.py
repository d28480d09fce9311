"""Figures of a drawing, and the mechanism symbols built from them.

Points are complex numbers x + iy, lengths are in metres; the hinge radius `r` scales all symbols.
"""

from collections.abc import Sequence
from typing import Literal, NamedTuple

import numpy as np

LAYERS = ("frame", "hatching", "pitch", "paths", "links", "joints", "names", "masses", "forces", "notes")

# Symbol sizes in hinge radii.
HALF_LENGTH, HALF_HEIGHT = 3.2, 2.0
# Half the length of sliders with a special shape, by the word in their name that selects it.
HALF_LENGTHS = {"ram": 5.0, "table": 9.0, "trough": 9.0}
PIVOT_WIDTH, PIVOT_HEIGHT = 2.3, 4.0
HATCH_STEP = 1.5
TIP = 2.4


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
        Fill of a polygon or circle; "none" hides nothing.
    text : str
    link : str
        Link that it is part of; "" for the frame, and for joints of several links.
    """

    layer: str
    kind: Literal["line", "polygon", "circle", "text"]
    points: tuple[complex, ...]
    size: float = 0.0
    fill: Literal["none", "paper", "tint", "solid"] = "none"
    text: str = ""
    link: str = ""

    def outline(self, corners: int = 8) -> np.ndarray:
        """Its points along its outline, closed unless it is a line: a circle as a polygon, a text as its box."""
        points = np.array(self.points)
        if self.kind == "circle":
            points = points + self.size * np.exp(2j * np.pi * np.arange(corners) / corners)
        elif self.kind == "text":
            half = complex(0.36 * len(self.text), 0.5) * self.size
            points = points + np.array([half, half.conjugate(), -half, -half.conjugate()])
        return points if self.kind == "line" else np.append(points, points[0])


def of_link(link: str, *figures: Primitive) -> list[Primitive]:
    """Figures as parts of a link."""
    return [figure._replace(link=link) for figure in figures]


def line(*points: complex, layer: str = "links") -> Primitive:
    """Polyline through some points."""
    return Primitive(layer, "line", tuple(complex(p) for p in points))


def polygon(*points: complex, fill: str = "tint", layer: str = "links") -> Primitive:
    """Convex polygon."""
    return Primitive(layer, "polygon", tuple(complex(p) for p in points), fill=fill)


def box(centre: complex, u: complex, half_length: float, half_height: float, fill: str = "tint") -> Primitive:
    """Rectangle about a centre with its length along the unit vector u: a slider, block or slot."""
    along, across = half_length * u, 1j * half_height * u
    corners = (centre - along - across, centre + along - across, centre + along + across, centre - along + across)
    return polygon(*corners, fill=fill)


def shape_of(slider: str) -> str:
    """The word in a slider's name that selects a special shape, "" for a block."""
    return next((word for word in slider.lower().split("_") if word in HALF_LENGTHS), "")


def half_length(slider: str) -> float:
    """Half the length of a slider, in hinge radii."""
    return HALF_LENGTHS.get(shape_of(slider), HALF_LENGTH)


def slider_shape(slider: str, centre: complex, front: complex, up: complex, half: float, r: float) -> list[Primitive]:
    """A slider: a ram with its tool, a table with its slots, a trough with its walls, or a block.

    Parameters
    ----------
    slider : str
        Its name.
    centre : complex
    front, up : complex
        Unit vectors: along the guide to the tool, and across it.
    half : float
        Half its height [m].
    r : float
        Hinge radius [m].
    """
    long, shape = half_length(slider) * r, shape_of(slider)
    if shape == "ram":
        face, neck, edge = centre + long * front, 0.6 * half * up, 0.35 * half * up
        tool = polygon(face + neck, face - neck, face + 3.0 * r * front - edge, face + 3.0 * r * front + edge)
        return [tool, box(centre, front, long, half)]
    if shape == "table":
        plate, foot = box(centre + 0.65 * half * up, front, long, 0.35 * half), box(centre, front, 0.5 * long, half)
        slots = [centre + half * up + side * 0.7 * long * front for side in (-1, 0, 1)]
        return [foot, plate, *(line(slot, slot - 0.35 * half * up) for slot in slots)]
    if shape == "trough":
        wall, bottom = 0.3 * r, centre - (half - 0.3 * r) * up
        lug = box((centre + bottom) / 2, front, r, half / 2)
        walls = [centre + side * (long - wall) * front for side in (-1, 1)]
        return [lug, box(bottom, front, long, wall), *(box(at, front, wall, half) for at in walls)]
    return [box(centre, front, long, half)]


def hatched(a: complex, b: complex, r: float) -> list[Primitive]:
    """Hatched line from a to b, the frame on its right."""
    u = (b - a) / abs(b - a)
    count = max(2, round(abs(b - a) / (HATCH_STEP * r)))
    starts = a + (b - a) * (np.arange(count) + 0.7) / count
    strokes = [line(p, p - HATCH_STEP * r * (0.8 + 0.9j) * u, layer="hatching") for p in starts]
    return [*strokes, line(a, b, layer="frame")]


def bush(centre: complex, u: complex, r: float) -> list[Primitive]:
    """Two hatched walls of the frame that guide a rod along the unit vector u."""
    return [p for side in (1, -1) for p in hatched(*(centre + r * u * side * (1.2j + end) for end in (4, -4)), r)]


def link_shape(points: Sequence[complex], r: float) -> list[Primitive]:
    """Link through some points: a line if they are collinear, else a filled polygon; nothing for one point."""
    distinct: list[complex] = []
    for p in points:
        if all(abs(p - d) > 0.3 * r for d in distinct):
            distinct.append(p)
    if len(distinct) < 2:
        return []
    a, b = max(((p, q) for p in distinct for q in distinct), key=lambda ends: abs(ends[1] - ends[0]))
    if max(abs(((p - a) / (b - a)).imag) * abs(b - a) for p in distinct) < 1.2 * r:
        return [line(a, b)]
    return [polygon(*_hull(distinct))]


def _hull(points: Sequence[complex]) -> list[complex]:
    """Convex hull, counter-clockwise (Andrew's monotone chain), from the same point at every position."""

    def chain(ordered: Sequence[complex]) -> list[complex]:
        found: list[complex] = []
        for p in ordered:
            while len(found) > 1 and ((found[-1] - found[-2]).conjugate() * (p - found[-2])).imag <= 0:
                found.pop()
            found.append(p)
        return found[:-1]

    ordered = sorted(points, key=lambda p: (p.real, p.imag))
    found = chain(ordered) + chain(ordered[::-1])
    first = found.index(next(p for p in points if p in found))
    return found[first:] + found[:first]


def weld(corner: complex, u: complex, v: complex, r: float) -> list[Primitive]:
    """Rigid-corner marks between lines along u and ±v."""
    return [polygon(corner, corner + 1.6 * r * u, corner + s * 1.6 * r * v, fill="solid") for s in (1, -1)]


def fixed_pivot(c: complex, r: float, down: complex = -1j) -> list[Primitive]:
    """Fixed support of a hinge at c, its foot along the unit vector `down`."""
    foot, half = c + PIVOT_HEIGHT * r * down, 1j * PIVOT_WIDTH * r * down
    triangle = polygon(c, foot - half, foot + half, fill="paper", layer="frame")
    return [*hatched(foot - 1.6 * half, foot + 1.6 * half, r), triangle]


def zigzag(a: complex, b: complex, r: float) -> Primitive:
    """Spring from a to b."""
    steps = np.array([0, 0.2, *(0.2 + 0.6 * (np.arange(14) + 0.5) / 14), 0.8, 1.0])
    sides = np.array([0, 0, *(-1.0) ** np.arange(14), 0, 0])
    u = (b - a) / abs(b - a)
    return line(*(a + steps * (b - a) + 2.2j * r * sides * u))


def arrow(points: Sequence[complex], r: float, layer: str = "names") -> list[Primitive]:
    """Arrow along some points with its tip beyond the last."""
    u = (points[-1] - points[-2]) / abs(points[-1] - points[-2])
    tip = points[-1] + TIP * r * u
    head = polygon(tip, points[-1] + 0.85j * r * u, points[-1] - 0.85j * r * u, fill="solid", layer=layer)
    return [line(*points, layer=layer), head]
