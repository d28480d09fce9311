"""A machine in motion as data for the page's script: its drawing, curves, paths and arrows."""

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from engine import NowhereDefinedError, display_unit, order_groups, quantity_text
from sweeps.pictures.drawing import FILLS, DrawnMotion, MovingDrawing, MovingFigure, bounds, moving_drawing
from sweeps.pictures.drawing.annotations import LONGEST, NOTHING
from sweeps.pictures.drawing.figures import default_position
from sweeps.pictures.drawing.moving_drawing import spread_nodes
from sweeps.pictures.drawing.painting import DASHES, INKS, WIDTHS
from sweeps.pictures.drawing.symbols import TIP
from sweeps.pictures.machine.cycle_rows import LARGEST, input_axis
from sweeps.pictures.panels import axis_label
from sweeps.study.default_summaries import main_slider
from sweeps.text.visible import visible

# Whole units of the page across the longer side of a drawing.
UNITS_ACROSS = 10_000
PIXELS_PER_POINT = 4 / 3
# Intervals of the drawing over the motion, and of a brief one; curves have three times as many, so that peaks show.
INTERVALS, BRIEF, OF_CURVES = 120, 60, 3
RATES = {"velocity": ("vx", "vy"), "acceleration": ("ax", "ay")}
FORCES = {"loads": "load", "joint forces": "reaction"}


def looks() -> dict[str, Any]:
    """Strokes of the layers and fills of figures, as other drawings have them."""
    layers = {}
    for layer, width in WIDTHS.items():
        pixels = width * PIXELS_PER_POINT
        dashes = " ".join(f"{dash * pixels:.1f}" for dash in DASHES[layer][1]) if layer in DASHES else "none"
        layers[layer] = {"stroke-width": round(pixels, 2), "stroke-dasharray": dashes, "ink": INKS.get(layer, "black")}
    return {"layers": layers, "fills": FILLS}


def motion_data(motion: DrawnMotion, intervals: int = INTERVALS, arrows: bool = True) -> dict[str, Any]:
    """A machine's drawing over its motion, with its curves, and the paths and arrows of its points.

    Parameters
    ----------
    motion : DrawnMotion
    intervals : int
        Of the drawing over the motion, such as INTERVALS or BRIEF.
    arrows : bool

    Returns
    -------
    dict
        Whole numbers are in units of the page (`unit` in metres), y down, points flat as x0, y0, x1, y1. Rows go from
        the start of the motion to its end, which for a cycle is its start again.

    Raises
    ------
    PictureError
        A position can't be drawn.
    """
    drawing = moving_drawing(motion, intervals)
    paper, closed = _Paper(drawing, motion.radius), motion.scene.has_cycle
    axis = input_axis(motion.scene)
    factor, unit = display_unit(axis.unit, motion.q)
    last = motion.q[-1] + (motion.q[1] - motion.q[0] if closed else 0.0)
    moving = {n: r[drawing.nodes] for n, r in motion.points.items() if np.abs(r - r[0]).max() > NOTHING}
    return {
        "box": paper.box,
        "unit": paper.unit,
        "tip": round(TIP * motion.radius / paper.unit),
        "closed": closed,
        "backwards": bool(motion.numbers["input.speed"] < 0),
        "axis": {
            "label": visible(axis_label(axis, unit)),
            "first": float(factor * motion.q[0]),
            "last": float(factor * last),
        },
        "start": float(factor * default_position(motion)),
        "axes": [paper.axes(*pair) for pair in drawing.axes],
        "figures": [paper.figure(figure) for figure in drawing.figures],
        "points": {visible(name): paper.flat(places) for name, places in moving.items()},
        "arrows": list(_arrows(motion, drawing.nodes, moving, paper)) if arrows else [],
        "curves": list(_curves(motion, OF_CURVES * intervals)),
    }


class _Paper:
    """The page below a drawing: metres become whole units, y down."""

    def __init__(self, drawing: MovingDrawing, radius: float) -> None:
        covered = [f.look._replace(points=tuple(drawing.points_of(f).ravel())) for f in drawing.figures]
        low, high = bounds(covered)
        size = high - low
        self.radius, self.unit = radius, max(size.real, size.imag) / UNITS_ACROSS
        corner = complex(low.real, -high.imag)
        margin = 2.5 * radius * (1 + 1j)
        self.box = self.flat(np.conj([corner - margin, size + 2 * margin]))

    def flat(self, places: np.ndarray) -> list[int | None]:
        """Points x + iy [m] one after another; None where undefined."""
        pairs = np.column_stack([places.real, -places.imag]).ravel() / self.unit
        return [round(value) if np.isfinite(value) else None for value in pairs.tolist()]

    def axes(self, origin: np.ndarray, along: np.ndarray) -> dict[str, list]:
        """Axes: their origin and their angle in degrees, clockwise; a single value if it is constant."""
        turn = -np.degrees(np.unwrap(np.angle(along)))
        still = [bool(np.ptp(row) < NOTHING) for row in (np.abs(origin - origin[0]), turn)]
        origin, turn = (row[:1] if stands else row for row, stands in zip((origin, turn), still, strict=True))
        return {"at": self.flat(origin), "turn": [round(angle, 2) for angle in turn.tolist()]}

    def figure(self, figure: MovingFigure) -> dict[str, Any]:
        """A figure, in the axes that carry it if its shape doesn't change."""
        look = figure.look
        found = {"layer": look.layer, "kind": look.kind, "fill": look.fill}
        if look.kind in ("circle", "text"):
            found["size"] = round(look.size / self.unit)
        if look.kind == "text":
            found["text"] = visible(look.text)
        if figure.carrier is None:
            return found | {"places": [self.flat(row) if np.isfinite(row).all() else None for row in figure.places]}
        return found | {"on": figure.carrier, "at": self.flat(np.array(look.points))}


def _arrows(
    motion: DrawnMotion, nodes: np.ndarray, moving: Mapping[str, np.ndarray], paper: _Paper
) -> Iterator[dict[str, Any]]:
    """Kinds of arrows: velocities and accelerations of points, loads, forces in joints."""
    known = motion.machine.register.available_fields
    for kind, ends in RATES.items():
        names = {point: [f"{point}.{end}" for end in ends] for point in moving}
        names = {point: pair for point, pair in names.items() if set(pair) <= set(known)}
        rows = motion.machine.fields([name for pair in names.values() for name in pair])
        vectors = {point: (moving[point], rows[x][nodes] + 1j * rows[y][nodes]) for point, (x, y) in names.items()}
        units = next((motion.machine.register.fields[x].units for x, _ in names.values()), "")
        yield from _scaled(kind, vectors, units, paper)
    try:
        acting = motion.machine.forces
    except NowhereDefinedError:
        return
    for words, kind in FORCES.items():
        # Of a force between two links, the first one listed; the other is its opposite.
        forces = {force.name: force for force in reversed(acting) if force.kind == kind and force.at is not None}
        vectors = {name: (force.at[nodes], force.force[nodes]) for name, force in forces.items()}
        yield from _scaled(words, vectors, "N", paper)


def _scaled(
    kind: str, vectors: Mapping[str, tuple[np.ndarray, np.ndarray]], units: str, paper: _Paper
) -> Iterator[dict[str, Any]]:
    """Arrows of one kind to one scale, the longest as long as in other drawings."""
    lengths = np.abs([vector for _, vector in vectors.values()])
    greatest = float(np.max(lengths, initial=0.0, where=np.isfinite(lengths)))
    if greatest == 0.0:
        return
    scale = LONGEST * paper.radius / greatest
    yield {
        "kind": kind,
        "longest": quantity_text(greatest, units),
        "items": [
            {"name": visible(name), "at": paper.flat(at), "by": paper.flat(scale * vector)}
            for name, (at, vector) in vectors.items()
        ],
    }


def _curves(motion: DrawnMotion, intervals: int) -> Iterator[dict[str, Any]]:
    """Curves of the machine: drive torque, motion of its output, force on the input, pressure over volume."""
    scene, fields = motion.scene, motion.machine.register.fields
    known = set(motion.machine.register.available_fields)
    output = main_slider(scene) or order_groups(scene).links[-1]
    moves = ("velocity", "acceleration") if f"{output}.velocity" in known else ("angular_velocity",)
    torque = "input_moment" if "input_moment" in known else "reduced_moment"
    pairs = [(None, name) for name in (torque, *(f"{output}.{how}" for how in moves), "input.reaction")]
    pairs += [(f"{cylinder}.volume", f"{cylinder}.pressure") for cylinder in scene.cylinders]
    pairs = [(x, y) for x, y in pairs if {x or y, y} <= known]
    rows = motion.machine.fields({name for pair in pairs for name in pair if name})
    nodes = spread_nodes(motion, intervals)
    for x, y in pairs:
        if all(_varies(rows[name]) for name in (x, y) if name):
            yield {key: _axis(fields[name], rows[name][nodes]) for key, name in (("x", x), ("y", y)) if name}


def _varies(row: np.ndarray) -> bool:
    """Whether a row shows more than rounding."""
    some = row[np.abs(row) < LARGEST]
    return some.size > 1 and bool(np.ptp(some) > NOTHING * np.abs(some).max())


def _axis(field: Any, row: np.ndarray) -> dict[str, Any]:
    """Values in a practical unit, to five digits; None where undefined."""
    row = np.where(np.abs(row) < LARGEST, row, np.nan)
    factor, unit = display_unit(field.units, row)
    values = [float(f"{value:.5g}") if np.isfinite(value) else None for value in (factor * row).tolist()]
    words = visible(field.long_name)
    return {"label": words, "unit": "" if unit == "1" else unit, "values": values}
