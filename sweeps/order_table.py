"""Order tables of engines: which forces, couples and torques remain, as a textbook lists them, and pictures of them."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import Scene
from engine.balancing.engines.engine_element import EngineElement
from engine.balancing.engines.engine_layout import (
    Engine,
    Layout,
    MasterRod,
    boxer,
    in_line,
    radial,
    usual_throws,
    v,
    w,
)
from engine.balancing.engines.firing import FOUR_STROKE, even_firing_order, firing_angles, firing_intervals
from engine.balancing.engines.harmonics import crank_radius, piston_harmonics
from engine.balancing.engines.hodograph import Hodograph
from engine.balancing.engines.shaking import ORDERS, shaking
from engine.balancing.engines.torque_orders import firing_sums
from sweeps.report import table
from sweeps.style import BLUE, GREY, ORANGE, house_style, new_figure, save

# Ratio of the rows; without master rods the multiples are the same for any other.
RATIO = 0.3
# Amplitudes are multiples of those of one cylinder: no greater than this they are rounding.
BALANCED = 1e-12
HIGHEST_TORQUE_ORDER = 6
_HEADS = (
    "engine",
    "firing",
    "primary force",
    "secondary force",
    "primary couple",
    "secondary couple",
    "higher orders",
    "torque orders",
)


class EngineRow(NamedTuple):
    """An engine of an order table.

    Attributes
    ----------
    name : str
    layout : Layout
        With a spacing of 1.
    firing_order : tuple of int, optional
        An even one is looked for where it is not given.
    master : MasterRod, optional
        Its lengths as multiples of the crank's, the rod being 1/λ of it.
    ratio : float
        λ, crank over rod.
    offset : float
        Of the gudgeon pins' ways, as a multiple of the crank's length.
    """

    name: str
    layout: Layout
    firing_order: tuple[int, ...] | None = None
    master: MasterRod | None = None
    ratio: float = RATIO
    offset: float = 0.0


class Remaining(NamedTuple):
    """What remains of an engine, as multiples of m r ω² A_n and of m r ω² A_n a.

    Attributes
    ----------
    forces, couples : Hodograph
    torque_orders : tuple of float
        Those to which all cylinders' firing adds up; None where no firing order is known.
    intervals : ndarray or None
        Between firings [rad].
    """

    forces: Hodograph
    couples: Hodograph
    torque_orders: tuple[float, ...] | None
    intervals: np.ndarray | None


def well_known_engines() -> list[EngineRow]:
    """Engines that textbooks list."""
    right, narrow = math.pi / 2, math.pi / 3
    rows = [
        EngineRow("single cylinder", in_line(1).layout(), (1,)),
        EngineRow("in-line 2, 360°", in_line(2, (0, 0)).layout(), (1, 2)),
        EngineRow("in-line 2, 180°", in_line(2).layout(), (1, 2)),
        EngineRow("V2 90°", v(2).layout(right), (1, 2)),
        EngineRow("V2 52°, pins 76°", v(2).layout(math.radians(52), math.radians(76)), (1, 2)),
    ]
    rows += [EngineRow(f"in-line {n}", in_line(n).layout()) for n in (3, 4, 5, 6, 8)]
    rows += [EngineRow(f"boxer {n}", boxer(n).layout()) for n in (2, 4, 6)]
    rows += [
        EngineRow("V6 90°, 3 throws", v(6).layout(right), (1, 5, 2, 6, 3, 4)),
        EngineRow("V6 60°, pins 60°", v(6).layout(narrow, narrow)),
        EngineRow("V8 90° cross-plane", v(8).layout(right)),
        EngineRow("V8 90° flat-plane", v(8, usual_throws(4)).layout(right)),
        EngineRow("V10 72°", v(10).layout(math.radians(72))),
        EngineRow("V12 60°", v(12).layout(narrow)),
        EngineRow("W12 60°", w(12).layout(narrow)),
    ]
    rows += [EngineRow(f"radial {n}", radial(n).layout()) for n in (3, 5, 7, 9)]
    return [*rows, EngineRow("radial 9, master rod", radial(9).layout(), master=MasterRod(0, 0.9, 1 / RATIO - 0.9))]


def engine_rows(scene: Scene) -> list[EngineRow]:
    """The engines of a scene; couples are multiples of their spacing, or of the rods' distance on one throw.

    Parameters
    ----------
    scene : Scene
    """
    return [_row(name, e) for name, e in scene.elements.items() if isinstance(e, EngineElement)]


def _row(name: str, engine: EngineElement) -> EngineRow:
    unit = engine.spacing or abs(engine.rod_distance) or 1.0
    bank, pins = engine.bank_angle or 0.0, engine.pin_offset or 0.0
    # Without a spacing couples aren't asked for; with one of 1 they are those of the layout.
    spacing = 1.0 if engine.spacing is None else engine.spacing / unit
    layout = engine.pattern().layout(bank, pins, spacing, engine.rod_distance / unit)
    radius = float(crank_radius(engine.stroke, engine.rod, engine.gudgeon_offset or 0.0))
    index, master = engine.master_index, None
    if index is not None:
        master = MasterRod(index, engine.knuckle_radius / radius, engine.link_rod / radius)
    ratio, offset = radius / engine.rod, (engine.gudgeon_offset or 0.0) / radius
    return EngineRow(name, layout, engine.firing_order, master, ratio, offset)


def remaining_orders(row: EngineRow) -> Remaining:
    """Forces, couples and torque orders of an engine with balanced rotating masses.

    Parameters
    ----------
    row : EngineRow
    """
    found = shaking(Engine(row.layout, 1.0, 1.0 / row.ratio, offset=row.offset, master=row.master))
    units = np.abs(piston_harmonics(row.ratio, ORDERS, row.offset * row.ratio))
    forces, couples = (
        Hodograph(ORDERS, _clean(vector.forward / units), _clean(vector.backward / units))
        for vector in (found.forces, found.couples)
    )
    order = row.firing_order or even_firing_order(row.layout)
    if order is None:
        return Remaining(forces, couples, None, None)
    angles = firing_angles(row.layout, order)
    orders = np.arange(1, 2 * HIGHEST_TORQUE_ORDER + 1) / 2
    left = orders[np.abs(firing_sums(orders, angles)) > BALANCED * len(order)]
    return Remaining(forces, couples, tuple(left.tolist()), firing_intervals(angles, FOUR_STROKE))


def order_table(rows: Sequence[EngineRow] | None = None, markdown: bool = True) -> str:
    """Table of the orders that remain, with a line below it that says what its numbers are.

    Parameters
    ----------
    rows : sequence of EngineRow, optional
        `well_known_engines` where not given.
    markdown : bool
        Or columns of plain text.
    """
    rows = well_known_engines() if rows is None else rows
    cells = [_cells(row) for row in rows]
    if markdown:
        lines = [_HEADS, ("---",) * len(_HEADS), *cells]
        shown = "\n".join("| " + " | ".join(line) + " |" for line in lines)
    else:
        shown = table([_HEADS, *cells])
    kinds = dict.fromkeys((row.ratio, row.offset) for row in rows)
    return f"{shown}\n\n{_LEGEND} {' '.join(_harmonics_text(*kind) for kind in kinds)}\n"


def _harmonics_text(ratio: float, offset: float) -> str:
    harmonics = piston_harmonics(ratio, ORDERS, offset * ratio)
    sizes = np.abs(harmonics) if offset else harmonics.real
    values = ", ".join(f"A{_small(n)} = {value:.4g}" for n, value in zip(ORDERS, sizes, strict=True))
    aside = f" and an offset of {offset:.3g} r" if offset else ""
    return f"At λ = {ratio:.4g}{aside}: {values}."


_LEGEND = (
    "Forces as multiples of m r ω² Aₙ, couples of m r ω² Aₙ a (a: spacing of the throws), rotating masses balanced; "
    "an ellipse by its half axes. ↺ turns with the crank, ↻ against it; counterweights balance a primary ↺ circle. "
    "Four strokes; torque orders per turn of the crank, link rods' dead centres taken as even. "
    "Only with a master rod do the multiples depend on λ."
)


def _small(n: int) -> str:
    return "₀₁₂₃₄₅₆₇₈₉"[n]


def _clean(part: np.ndarray) -> np.ndarray:
    return np.where(np.abs(part) > BALANCED, part, 0.0)


def _cells(row: EngineRow) -> tuple[str, ...]:
    found = remaining_orders(row)
    vectors = (found.forces, found.couples)
    amplitudes = [_ellipse_text(vector, order) for vector in vectors for order in (1, 2)]
    higher = [
        f"{kind} {order}: {_ellipse_text(vector, order)}"
        for vector, kind in zip(vectors, ("force", "couple"), strict=True)
        for order in ORDERS[2:]
        if any(abs(part) for part in vector.of(order))
    ]
    return row.name, _firing_text(found.intervals), *amplitudes, "; ".join(higher) or "0", _torque_text(found)


def _ellipse_text(vector: Hodograph, order: int) -> str:
    """The vector of one order: 0, a line's or circle's size, or an ellipse's half axes."""
    i = vector.orders.index(order)
    major, minor = vector.major[i], vector.minor[i]
    if major == 0:
        return "0"
    turns = "↺" if abs(vector.forward[i]) > abs(vector.backward[i]) else "↻"
    if minor <= BALANCED * major:
        return f"{major:.4g} line"
    return f"{major:.4g} {turns}" if major - minor <= BALANCED * major else f"{major:.4g} × {minor:.4g} {turns}"


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


def order_picture(target: Path | str | Figure, rows: Sequence[EngineRow] | None = None) -> Figure:
    """Vectors that remain of each engine, drawn as they swing and circle: an order table to be looked at.

    Parameters
    ----------
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    rows : sequence of EngineRow, optional
        `well_known_engines` where not given.

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    rows = well_known_engines() if rows is None else rows
    with house_style():
        figure = target if isinstance(target, Figure) else new_figure(180, 12 + 12 * len(rows))
        axes = figure.subplots(len(rows), 4, squeeze=False)
        for row, line in zip(rows, axes, strict=True):
            found = remaining_orders(row)
            vectors = [(v, order) for v in (found.forces, found.couples) for order in (1, 2)]
            for ax, (vector, order) in zip(line, vectors, strict=True):
                _draw(ax, vector, order)
            line[0].set_ylabel(row.name, rotation=0, ha="right", va="center")
        for ax, head in zip(axes[0], _HEADS[2:6], strict=True):
            ax.set_title(f"{head}\nin {'m r ω² A' if 'force' in head else 'm r ω² a A'}{_small(1 + ('sec' in head))}")
    if not isinstance(target, Figure):
        save(figure, target)
    return figure


def _draw(ax: Axes, vector: Hodograph, order: int) -> None:
    """One vector's hodograph over the turn, the engine's own axis upwards; a dot where it starts."""
    i = vector.orders.index(order)
    one = Hodograph((order,), vector.forward[i : i + 1], vector.backward[i : i + 1])
    way = one.at(np.linspace(0, 2 * math.pi / order, 181)) * 1j
    size = one.major[0]
    ax.set(aspect="equal", xticks=[], yticks=[], xlim=(-1.3, 6.5), ylim=(-1.2, 1.2))
    ax.grid(False)
    for side in ax.spines.values():
        side.set_visible(False)
    if size == 0:
        ax.plot(0, 0, ".", color=GREY, markersize=3)
        return
    way = way / size
    shape = BLUE if one.minor[0] <= BALANCED * size else ORANGE
    ax.plot(way.real, way.imag, color=shape)
    ax.plot([0, way[0].real], [0, way[0].imag], color=GREY, linewidth=0.6)
    ax.plot(way[0].real, way[0].imag, "o", color=shape, markersize=2.5)
    ax.text(1.15, 0, _ellipse_text(vector, order), ha="left", va="center", fontsize=6.5)
