"""An engine element by orders of its crank: a sheet of its layout, forces, couples and torque, and a table in words."""

import math
from collections.abc import Iterable
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MultipleLocator

from engine import (
    FOUR_STROKE,
    ROUNDED_ORDERS,
    EngineElement,
    Hodograph,
    crankshaft_counterweights,
    engine_shaking,
    engine_torque,
    firing_angles,
    made_engine,
    remaining_shaking,
)
from sweeps.pictures.style import BLUE, GREY, PALE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit
from sweeps.text.tables import table

ORDERS = (1, 2, 3, 4, 5, 6)
TURN = 2 * math.pi
ROUNDING = float(np.finfo(float).eps)
# A vector whose shorter half axis is less than this share of the longer one swings on a line.
LINE = 1e-9
# Roundings of the whole motion that are left in a harmonic, beside the square of its order.
WHOLE = 32
BEFORE, AFTER = "without counterweights", "with counterweights"


class Shaken(NamedTuple):
    """Forces [N] and couples [N·m] of an engine by orders, without and with its counterweights."""

    forces: tuple[Hodograph, Hodograph]
    couples: tuple[Hodograph, Hodograph]


def shaken(engine: EngineElement) -> Shaken:
    """Forces and couples of an engine at its speed; what balances but for rounding is 0.

    Parameters
    ----------
    engine : EngineElement
    """
    n = engine.own_numbers()
    made = made_engine(engine, n)
    found = engine_shaking(made, ORDERS)
    weights = crankshaft_counterweights(made, n["balanced_rotating"], n["balanced_reciprocating"])
    left = remaining_shaking(found, [weights])
    square = engine.speed**2
    return Shaken(
        (_scaled(found.forces, found.force_terms, square), _scaled(left.forces, left.force_terms, square)),
        (_scaled(found.couples, found.couple_terms, square), _scaled(left.couples, left.couple_terms, square)),
    )


def _scaled(vector: Hodograph, terms: np.ndarray, factor: float) -> Hodograph:
    # Besides the rounding of sums, a transform gives every harmonic the rounding of the whole motion.
    least = ROUNDING * (ROUNDED_ORDERS * terms + WHOLE * np.square(vector.orders) * terms[..., :1])
    parts = (np.where(np.abs(p) <= least, 0.0, p)[0] * factor for p in (vector.forward, vector.backward))
    return Hodograph(vector.orders, *parts)


def engine_table(engine: EngineElement) -> str:
    """The orders of an engine's forces, couples and torque in words, as columns of plain text.

    Parameters
    ----------
    engine : EngineElement
    """
    found = shaken(engine)
    rows = [("order", "force", AFTER, *(("couple", AFTER) if engine.spacing is not None else ()))]
    kinds = [("N", found.forces), *([("N m", found.couples)] if engine.spacing is not None else [])]
    for i, order in enumerate(ORDERS):
        cells = [_ellipse_text(vector, i, unit) for unit, both in kinds for vector in both]
        if any(cell != "0" for cell in cells) or order in (1, 2, 4, 6):
            rows.append((f"{order}", *cells))
    lines = [table(rows), "An ellipse by its half axes; ↺ turns with the crank, ↻ against it."]
    if engine.gas is not None:
        lines.append(_torque_text(engine))
    return "\n".join(lines)


def _ellipse_text(vector: Hodograph, i: int, units: str) -> str:
    major, minor = float(vector.major[i]), float(vector.minor[i])
    if major == 0:
        return "0"
    factor, unit = engineer_unit(units, np.array([major]))
    turns = "↺" if abs(vector.forward[i]) > abs(vector.backward[i]) else "↻"
    if minor <= LINE * major:
        return f"{factor * major:.4g} {unit} line"
    if major - minor <= LINE * major:
        return f"{factor * major:.4g} {unit} {turns}"
    return f"{factor * major:.4g} × {factor * minor:.4g} {unit} {turns}"


def _torque_orders(engine: EngineElement, orders: np.ndarray) -> tuple[float, np.ndarray]:
    """Mean torque and its orders [N·m]; what balances but for rounding is 0."""
    one, found, _ = engine_torque(engine, engine.own_numbers(), orders)
    least = ROUNDED_ORDERS * ROUNDING * engine.cylinders * np.abs(one.orders[0])
    return engine.cylinders * float(one.mean[0]), np.where(np.abs(found[0]) <= least, 0.0, found[0])


def _torque_text(engine: EngineElement) -> str:
    steps = np.arange(1, 13) / 2
    mean, parts = _torque_orders(engine, steps)
    factor, unit = engineer_unit("N m", np.array([mean]))
    left = ", ".join(f"{n:g}: {factor * abs(part):.4g}" for n, part in zip(steps, parts, strict=True) if part)
    order = "-".join(map(str, engine.order_of_firing))
    return f"firing order {order}; torque, mean {factor * mean:.4g} {unit}, by orders [{unit}] {left or 'none'}"


def engine_sheet(engine: EngineElement, target: Path | str | Figure, title: str = "") -> Figure:
    """Layout, hodographs and orders of an engine's forces and couples, and its torque, 180 mm wide.

    Parameters
    ----------
    engine : EngineElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's.
    """
    found = shaken(engine)
    rows = 1 + (engine.spacing is not None) + (engine.gas is not None)
    with sheet(target, 180, 10 + 62 * rows, title) as figure:
        axes = iter(figure.subplots(rows, 3, squeeze=False, width_ratios=(0.9, 1, 1.1)))
        front, loop, bars = next(axes)
        _front(front, engine)
        _hodograph(loop, found.forces, "N", "force")
        _order_bars(bars, [np.asarray(v.major) for v in found.forces], ORDERS, "N", "greatest force")
        if engine.spacing is not None:
            side, loop, bars = next(axes)
            _side(side, engine)
            _hodograph(loop, found.couples, "N m", "couple")
            _order_bars(bars, [np.asarray(v.major) for v in found.couples], ORDERS, "N m", "greatest couple")
        figure.legend(*front.figure.axes[2].get_legend_handles_labels(), loc="outside lower right", ncols=2)
        if engine.gas is not None:
            _torque(next(axes), engine)
    return figure


def _together(angles: Iterable[float]) -> dict[float, str]:
    """Numbers of the cylinders whose angles [rad] are the same."""
    found: dict[float, list[str]] = {}
    for k, angle in enumerate(angles, 1):
        turned = float(angle) % TURN
        same = next((a for a in found if abs((a - turned + math.pi) % TURN - math.pi) < LINE), turned)
        found.setdefault(same, []).append(str(k))
    return {
        angle: ", ".join(numbers) if len(numbers) < 7 else f"{numbers[0]} … {numbers[-1]}"
        for angle, numbers in found.items()
    }


def _front(ax: Axes, engine: EngineElement) -> None:
    """Banks and throws as seen along the crank, the engine's own axis upwards, the crank at 0."""
    layout = engine.nominal_layout
    for angles, length, look, label in (
        (layout.banks, 1.1, {"color": GREY, "linewidth": 5, "alpha": 0.5, "solid_capstyle": "butt"}, "cylinders"),
        (layout.throws, 0.45, {"color": VERMILION, "linewidth": 1.6}, "throws"),
    ):
        for i, (angle, numbers) in enumerate(_together(angles).items()):
            way = 1j * np.exp(1j * angle)
            begin, tip = way * (0.78 if length > 1 else 0.0), way * length
            ax.plot([begin.real, tip.real], [begin.imag, tip.imag], label=None if i else label, **look)
            place = way * (length + 0.17)
            ax.text(place.real, place.imag, numbers, ha="center", va="center", fontsize=7, color=look["color"])
    ax.plot(0, 0, "o", color="black", markersize=3)
    ax.set(aspect="equal", xlim=(-1.4, 1.4), ylim=(-1.4, 1.4), xticks=[], yticks=[])
    for side in ax.spines.values():
        side.set_visible(False)
    ax.set_title("Cylinders, throws (red), crank at 0")


def _side(ax: Axes, engine: EngineElement) -> None:
    """Throws along the crank, as high as they stand at 0."""
    layout, radius = engine.nominal_layout, engine.stroke / 2
    factor, unit = engineer_unit("m", layout.positions)
    heights = 1e3 * radius * np.cos(layout.throws)
    ax.plot(factor * layout.positions, 0 * heights, color="black", linewidth=1)
    ax.stem(factor * layout.positions, heights, linefmt=VERMILION, markerfmt="o", basefmt=" ")
    for k, (x, y) in enumerate(zip(factor * layout.positions, heights, strict=True), 1):
        ax.annotate(str(k), (x, y), (0, 4 if y >= 0 else -10), textcoords="offset points", ha="center", fontsize=7)
    ax.set(xlabel=f"along the crank, {unit}", ylabel="crankpins, mm", ylim=(-1.9e3 * radius, 1.9e3 * radius))
    ax.margins(x=0.12)
    ax.set_title("Throws from the side")


def _hodograph(ax: Axes, both: tuple[Hodograph, Hodograph], units: str, what: str) -> None:
    phi = np.linspace(0, TURN, 721)
    # The engine's own axis is drawn upwards.
    ways = [1j * vector.at(phi) for vector in both]
    factor, unit = engineer_unit(units, np.abs(np.concatenate(ways)))
    for way, colour, label in zip(ways, (GREY, BLUE), (BEFORE, AFTER), strict=True):
        ax.plot(factor * way.real, factor * way.imag, color=colour, label=label)
        ax.plot(factor * way[0].real, factor * way[0].imag, "o", color=colour, markersize=3.5)
    ax.plot(0, 0, "+", color="black", markersize=7)
    if any(np.abs(way).any() for way in ways):
        ax.set_aspect("equal", adjustable="datalim")
    else:
        ax.set(xlim=(-1, 1), ylim=(-1, 1), aspect="equal")
    ax.set(xlabel=f"across, {unit}", ylabel=f"along the engine's axis, {unit}")
    ax.set_title(f"{what[:1].upper()}{what[1:]} (dot: crank at 0)")


def _order_bars(ax: Axes, sizes: list[np.ndarray], orders: Iterable[float], units: str, what: str) -> None:
    factor, unit = engineer_unit(units, np.concatenate(sizes))
    places, width = np.asarray(list(orders), float), 0.4 if len(sizes) > 1 else 0.35
    shifts = (-0.2, 0.2) if len(sizes) > 1 else (0.0,)
    for size, shift, colour, label in zip(sizes, shifts, (PALE, BLUE)[-len(sizes) :], (BEFORE, AFTER), strict=False):
        ax.bar(places + shift, factor * size, width, color=colour, label=label if len(sizes) > 1 else None)
    if not np.concatenate(sizes).any():
        ax.set_ylim(0, 1)
        ax.text(0.5, 0.5, "balanced", ha="center", va="center", transform=ax.transAxes, color=GREY)
    ax.xaxis.set_major_locator(MultipleLocator(1))
    ax.grid(visible=False, axis="x")
    ax.set(xlim=(places[0] - 0.6, places[-1] + 0.6), xlabel="order of the crank's speed", ylabel=f"{what}, {unit}")
    ax.set_title("Orders")


def _torque(axes: Iterable[Axes], engine: EngineElement) -> None:
    """Firing, torque over the cycle, and its orders."""
    firing, curve, bars = axes
    angles = firing_angles(engine.nominal_layout, engine.order_of_firing) % FOUR_STROKE
    degrees = np.degrees(angles)
    firing.stem(degrees, np.ones_like(degrees), linefmt=VERMILION, markerfmt="o", basefmt=" ")
    for angle, numbers in _together(angles / 2).items():
        firing.annotate(numbers, (2 * math.degrees(angle), 1), (0, 4), textcoords="offset points", ha="center")
    firing.set(ylim=(0, 1.35), yticks=[], xlim=(-20, 740), xlabel="crank angle φ, °")
    firing.set_title(f"Firing order {'-'.join(map(str, engine.order_of_firing))}")
    phi = np.linspace(0, FOUR_STROKE, 721)
    steps = np.arange(1, 33) / 2
    mean, parts = _torque_orders(engine, steps)
    torque = mean + (parts @ np.exp(1j * np.multiply.outer(steps, phi))).real
    factor, unit = engineer_unit("N m", torque)
    curve.plot(np.degrees(phi), factor * torque, color=BLUE)
    curve.axhline(factor * mean, color=VERMILION, linewidth=0.9, linestyle=(0, (6, 2)))
    curve.set(xlabel="crank angle φ, °", ylabel=f"torque, {unit}", xlim=(0, 720))
    curve.set_title(f"Gas and inertia, mean {factor * mean:.4g} {unit}".replace("-", "\N{MINUS SIGN}"))
    shown = steps[:12]
    _order_bars(bars, [np.abs(parts[:12])], shown, "N m", "torque")
    for ax in (firing, curve):
        ax.xaxis.set_major_locator(MultipleLocator(180))
