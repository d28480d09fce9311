"""Optional items of a drawing: centres of mass, forces and moments at the position, names of links."""

import math
from collections.abc import Sequence

import numpy as np

from engine import FRAME, did_you_mean, quantity_text
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.names import outline_points
from sweeps.pictures.drawing.symbols import TIP, Primitive, arrow, polygon
from sweeps.pictures.picture_error import PictureError

ANNOTATIONS = ("masses", "forces", "links")
# Longest and shortest arrow, in hinge radii.
LONGEST, SHORTEST = 16.0, 4.0
# Radius of a moment's arc, and its angle [rad].
ARC, SPAN = 5.0, 4.0
# Forces and moments below this share of the maximum are rounding.
NOTHING = 1e-9


def annotations(
    m: DrawnMotion, k: int, kinds: Sequence[str], drawn: Sequence[Primitive]
) -> tuple[list[Primitive], list[Primitive]]:
    """Optional items at a node: figures, and marks to be lettered.

    Parameters
    ----------
    m : DrawnMotion
    k : int
    kinds : sequence of str
        Some of `ANNOTATIONS`.
    drawn : sequence of Primitive
        The mechanism, which arrows avoid.

    Raises
    ------
    PictureError
        One of the kinds is unknown, or the forces can't be computed.
    """
    for kind in kinds:
        if kind not in ANNOTATIONS:
            raise PictureError(f"{kind!r} can't be shown; {did_you_mean(kind, (*ANNOTATIONS, 'scale'))}")
    figures, marks, outlines = [], [], outline_points(drawn, 0.3 * m.radius)
    for kind, found in (("masses", _masses), ("forces", _forces), ("links", _links)):
        if kind in kinds:
            shown, marked = found(m, k, outlines)
            figures += shown
            marks += marked
    return figures, marks


def _masses(m: DrawnMotion, k: int, outlines: np.ndarray) -> tuple[list[Primitive], list[Primitive]]:
    """Centres of mass by body, each a disc with two quarters filled."""
    figures = []
    for name, body in m.scene.bodies.items():
        if body.link in m.scene.shafts and m.scene.shafts[body.link].pivot is None:
            continue
        at, r = complex(m.centres[name][k]), 0.7 * m.radius
        figures.append(Primitive("masses", "circle", (at,), r, "paper"))
        for turn in (0.0, math.pi):
            rim = at + r * np.exp(1j * (turn + np.linspace(0, math.pi / 2, 12)))
            figures.append(polygon(at, *rim, fill="solid", layer="masses"))
    return figures, []


def _forces(m: DrawnMotion, k: int, outlines: np.ndarray) -> tuple[list[Primitive], list[Primitive]]:
    """Nonzero forces and moments of the scene with their magnitudes."""
    acting = {force.name: force for force in reversed(m.link_forces) if force.kind == "load"}
    values = {name: complex((load.moment if load.at is None else load.force)[k]) for name, load in acting.items()}
    if not np.isfinite(list(values.values())).all():
        raise PictureError("the forces are undefined at this position; choose another position")
    forces = {name: values[name] for name, load in acting.items() if load.at is not None}
    greatest = max((abs(force) for force in forces.values()), default=0.0)
    figures, marks = [], []
    for name, force in forces.items():
        if abs(force) <= NOTHING * greatest:
            continue
        u, at = force / abs(force), complex(acting[name].at[k])
        length = m.radius * max(LONGEST * abs(force) / greatest, SHORTEST)
        # Draw as a pull from the point or a push to it, whichever covers less.
        pull, push = (_crossed(outlines, at, way * length * u, m.radius) for way in (1, -1))
        tail, free = (at, at + length * u) if pull <= push else (at - length * u, at - length * u)
        figures += arrow([tail, tail + (length - TIP * m.radius) * u], m.radius, "forces")
        marks.append(_mark("forces", free, 0.3 * m.radius, f"{name} = {quantity_text(abs(force), 'N')}"))
    for name in (name for name in acting if name not in forces):
        link, value = acting[name].link, values[name].real
        if value == 0.0 or link == FRAME or (link in m.scene.shafts and m.scene.shafts[link].pivot is None):
            continue
        at, r = complex(m.axes[link][0][k]), ARC * m.radius
        sense = math.copysign(1.0, value)
        figures += arrow(at + r * np.exp(1j * sense * np.linspace(0.4, SPAN, 32)), m.radius, "forces")
        words = f"{name} = {quantity_text(abs(value), 'N m')}"
        marks.append(_mark("forces", at + 1j * sense * r, 0.3 * m.radius, words))
    return figures, marks


def _links(m: DrawnMotion, k: int, outlines: np.ndarray) -> tuple[list[Primitive], list[Primitive]]:
    """Names of the moving links, between their joints."""
    marks = []
    for link in m.links[:-1]:
        joints = [complex(m.points[name][k]) for name in m.members(link)]
        joints = joints or [complex(m.axes[link][0][k])]
        marks.append(_mark("links", sum(joints) / len(joints), 0.5 * m.radius, link))
    return [], marks


def _mark(layer: str, at: complex, size: float, text: str) -> Primitive:
    """A point to be lettered."""
    return Primitive(layer, "circle", (complex(at),), size, "none", text)


def _crossed(outlines: np.ndarray, at: complex, along: complex, near: float) -> int:
    """Number of outline points near an arrow, except at its point of application."""
    gap = (outlines - at) / along
    return int(((gap.real > 0.2) & (gap.real < 1.1) & (np.abs(gap.imag * along) < near)).sum())
