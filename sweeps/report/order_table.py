"""Order tables of engines: unbalanced forces, couples and torques."""

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

import engine
from sweeps.text.tables import table

# Crank-rod ratio of the table; without master rods the multiples don't depend on it.
RATIO = 0.3
# Amplitudes below this, relative to one cylinder's, are rounding.
BALANCED = 1e-12
# An ellipse whose half axes are below this ratio is a line.
LINE = 1e-9
HIGHEST_TORQUE_ORDER = 6
VECTOR_HEADS = ("primary force", "secondary force", "primary couple", "secondary couple")


class EngineRow(NamedTuple):
    """An engine of an order table.

    Attributes
    ----------
    name : str
    layout : EngineLayout
        With a spacing of 1.
    firing_order : tuple of int, optional
        Default: an evenly spaced one, if possible.
    master : MasterRod, optional
        Lengths as multiples of the crank length; the rod is 1/λ.
    ratio : float
        λ, crank over rod.
    offset : float
        Offset of the wrist pins' lines, as a multiple of the crank length.
    """

    name: str
    layout: engine.EngineLayout
    firing_order: tuple[int, ...] | None = None
    master: engine.MasterRod | None = None
    ratio: float = RATIO
    offset: float = 0.0


class Remaining(NamedTuple):
    """Unbalance of an engine, as multiples of m r ω² A_n and of m r ω² A_n a.

    Attributes
    ----------
    forces, couples : Hodograph
    torque_orders : tuple of float
        Orders in which the torques of all cylinders add up; None without a firing order.
    intervals : ndarray or None
        Between firings [rad].
    """

    forces: engine.Hodograph
    couples: engine.Hodograph
    torque_orders: tuple[float, ...] | None
    intervals: np.ndarray | None


def well_known_engines() -> list[EngineRow]:
    """Common engines."""
    right, narrow = math.pi / 2, math.pi / 3
    rows = [
        EngineRow("single cylinder", engine.in_line_engine(1).layout(), (1,)),
        EngineRow("in-line 2, 360°", engine.in_line_engine(2, (0, 0)).layout(), (1, 2)),
        EngineRow("in-line 2, 180°", engine.in_line_engine(2).layout(), (1, 2)),
        EngineRow("V2 90°", engine.v_engine(2).layout(right), (1, 2)),
        EngineRow("V2 52°, pins 76°", engine.v_engine(2).layout(math.radians(52), math.radians(76)), (1, 2)),
    ]
    rows += [EngineRow(f"in-line {n}", engine.in_line_engine(n).layout()) for n in (3, 4, 5, 6, 8)]
    rows += [EngineRow(f"boxer {n}", engine.boxer_engine(n).layout()) for n in (2, 4, 6)]
    rows += [
        EngineRow("V6 90°, 3 throws", engine.v_engine(6).layout(right), (1, 5, 2, 6, 3, 4)),
        EngineRow("V6 60°, pins 60°", engine.v_engine(6).layout(narrow, narrow)),
        EngineRow("V8 90° cross-plane", engine.v_engine(8).layout(right)),
        EngineRow("V8 90° flat-plane", engine.v_engine(8, engine.usual_throws(4)).layout(right)),
        EngineRow("V10 72°", engine.v_engine(10).layout(math.radians(72))),
        EngineRow("V12 60°", engine.v_engine(12).layout(narrow)),
        EngineRow("W12 60°", engine.w_engine(12).layout(narrow)),
    ]
    rows += [EngineRow(f"radial {n}", engine.radial_engine(n).layout()) for n in (3, 5, 7, 9)]
    master = engine.MasterRod(0, 0.9, 1 / RATIO - 0.9)
    return [*rows, EngineRow("radial 9, master rod", engine.radial_engine(9).layout(), master=master)]


def engine_rows(scene: engine.Scene) -> list[EngineRow]:
    """The engines of a scene; couples are multiples of the cylinder spacing, or of the rod distance on one throw.

    Parameters
    ----------
    scene : Scene
    """
    return [_row(name, e) for name, e in scene.elements.items() if isinstance(e, engine.EngineElement)]


def _row(name: str, element: engine.EngineElement) -> EngineRow:
    unit = element.spacing or abs(element.rod_distance) or 1.0
    bank, pins = element.bank_angle or 0.0, element.pin_offset or 0.0
    # Without a spacing couples are omitted; a spacing of 1 gives the layout's multiples.
    spacing = 1.0 if element.spacing is None else element.spacing / unit
    layout = element.pattern().layout(bank, pins, spacing, element.rod_distance / unit)
    radius = float(engine.crank_radius(element.stroke, element.rod, element.gudgeon_offset or 0.0))
    index, master = element.master_index, None
    if index is not None:
        master = engine.MasterRod(index, element.knuckle_radius / radius, element.link_rod / radius)
    ratio, offset = radius / element.rod, (element.gudgeon_offset or 0.0) / radius
    return EngineRow(name, layout, element.firing_order, master, ratio, offset)


def remaining_orders(row: EngineRow) -> Remaining:
    """Forces, couples and torque orders of an engine with balanced rotating masses.

    Parameters
    ----------
    row : EngineRow
    """
    found = engine.engine_shaking(engine.Engine(row.layout, 1.0, 1.0 / row.ratio, offset=row.offset, master=row.master))
    units = np.abs(engine.piston_harmonics(row.ratio, engine.SHAKING_ORDERS, row.offset * row.ratio))
    forces, couples = (
        engine.Hodograph(engine.SHAKING_ORDERS, _clean(vector.forward / units), _clean(vector.backward / units))
        for vector in (found.forces, found.couples)
    )
    order = row.firing_order or engine.even_firing_order(row.layout)
    if order is None:
        return Remaining(forces, couples, None, None)
    angles = engine.firing_angles(row.layout, order)
    orders = np.arange(1, 2 * HIGHEST_TORQUE_ORDER + 1) / 2
    left = orders[np.abs(engine.firing_sums(orders, angles)) > BALANCED * len(order)]
    return Remaining(forces, couples, tuple(left.tolist()), engine.firing_intervals(angles))


def order_table(rows: Sequence[EngineRow]) -> str:
    """Table of the unbalanced orders, with a legend."""
    shown = table([("engine", "firing", *VECTOR_HEADS, "higher orders", "torque orders"), *map(_cells, rows)])
    kinds = dict.fromkeys((row.ratio, row.offset) for row in rows)
    return f"{shown}\n\n{_LEGEND} {' '.join(_harmonics_text(*kind) for kind in kinds)}"


def _harmonics_text(ratio: float, offset: float) -> str:
    harmonics = engine.piston_harmonics(ratio, engine.SHAKING_ORDERS, offset * ratio)
    sizes = np.abs(harmonics) if offset else harmonics.real
    pairs = zip(engine.SHAKING_ORDERS, sizes, strict=True)
    values = ", ".join(f"A{subscript_of(n)} = {value:.4g}" for n, value in pairs)
    displaced = f" and an offset of {offset:.3g} r" if offset else ""
    return f"At λ = {ratio:.4g}{displaced}: {values}."


_LEGEND = (
    "Forces in m r ω² Aₙ, couples in m r ω² Aₙ a (a: spacing of the throws), rotating masses balanced; "
    "ellipses by their half axes. ↺ turns with the crank, ↻ against it; counterweights balance a primary ↺ circle. "
    "Four-stroke; torque orders per crank turn, assuming evenly spaced dead centres of link rods. "
    "The multiples depend on λ only with a master rod."
)


def subscript_of(n: int) -> str:
    """A digit as a subscript."""
    return "₀₁₂₃₄₅₆₇₈₉"[n]


def _clean(part: np.ndarray) -> np.ndarray:
    return np.where(np.abs(part) > BALANCED, part, 0.0)


def _cells(row: EngineRow) -> tuple[str, ...]:
    found = remaining_orders(row)
    vectors = (found.forces, found.couples)
    amplitudes = [ellipse_text(vector, order) for vector in vectors for order in (1, 2)]
    higher = [
        f"{kind} {order}: {ellipse_text(vector, order)}"
        for vector, kind in zip(vectors, ("force", "couple"), strict=True)
        for order in engine.SHAKING_ORDERS[2:]
        if any(abs(part) for part in vector.of(order))
    ]
    return row.name, _firing_text(found.intervals), *amplitudes, "; ".join(higher) or "0", _torque_text(found)


def ellipse_text(vector: engine.Hodograph, order: int, units: str = "1") -> str:
    """The vector of one order: 0, size of a line or circle, or half axes of an ellipse."""
    i = vector.orders.index(order)
    major, minor = float(vector.major[i]), float(vector.minor[i])
    if major == 0:
        return "0"
    factor, unit = engine.display_unit(units, np.array([major]))
    turns = "↺" if abs(vector.forward[i]) > abs(vector.backward[i]) else "↻"
    sizes = [f"{factor * size:.4g}" for size in (major, minor)]
    if minor <= LINE * major:
        sizes, turns = sizes[:1], "line"
    elif major - minor <= LINE * major:
        sizes = sizes[:1]
    return " ".join([" × ".join(sizes), *([] if units == "1" else [unit]), turns])


def _firing_text(intervals: np.ndarray | None) -> str:
    if intervals is None:
        return "–"
    degrees = list(dict.fromkeys(f"{math.degrees(x):.4g}" for x in intervals))
    return "/".join(degrees) + "°"


def _torque_text(found: Remaining) -> str:
    if found.torque_orders is None:
        return "–"
    shown = [f"{n:g}" for n in found.torque_orders[:4]]
    return ", ".join(shown) + (" …" if len(found.torque_orders) > len(shown) else "")
