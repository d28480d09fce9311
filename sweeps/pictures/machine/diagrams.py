"""Diagrams of one machine over its cycle: reduced inertia and torque, work, energy loop, speed."""

import math
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import engine
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, GREEN, GREY, VERMILION, degree_ticks, sheet, typeset, wrapped

# Larger values overflow the axis.
LARGEST = 1e300
# Relative to the inertia, a range or a slope that is rounding [-, 1/rad or 1/m].
ROUNDED = 1e-12
# Characters of a title above a panel.
WORDS = 31
TIMED = "a load depends on time"


class CycleCurves(NamedTuple):
    """Fields of one machine, ready to plot.

    Attributes
    ----------
    q : ndarray (positions,)
        Crank angle [deg], or displacement of a sliding input in the unit of `q_label`.
    q_label : str
    rows : dict of str to ndarray (positions,)
        Periodic fields by name, SI.
    known : dict of str to Quantity
        Their descriptions.
    closed : bool
        Whether the first position follows the last.
    main : str or None
        Slider whose dead centres are marked.
    dead_centres : tuple of float
        Their positions q.
    mean_moment : float
        Mean reduced torque over the cycle, SI; nan without a cycle.
    """

    q: np.ndarray
    q_label: str
    rows: dict[str, np.ndarray]
    known: dict[str, engine.Quantity]
    closed: bool
    main: str | None
    dead_centres: tuple[float, ...]
    mean_moment: float


def main_slider(scene: engine.Scene) -> str | None:
    """The main slider: a cylinder's piston, else the last one on a guide of the frame."""
    for cylinder in scene.cylinders.values():
        return cylinder.piston
    parts = (part for group in scene.groups.values() for part in (group.first, group.second))
    on_frame = {p.link for p in parts if hasattr(p, "guide") and scene.guides[p.guide].link == engine.FRAME}
    return next((name for name in reversed(engine.sliders_of(scene)) if name in on_frame), None)


def _has_flywheel(scene: engine.Scene) -> bool:
    wheel = scene.flywheel
    return wheel is not None and (wheel.inertia is not None or wheel.speed_fluctuation is not None)


def need_motion(moving: engine.MovingMachine, names: Sequence[str]) -> None:
    """Raise a `PictureError` if fields of a machine can't be computed."""
    verdict = moving.verdict(names)
    if verdict not in (engine.Verdict.OK, engine.Verdict.NOT_FINITE):
        raise PictureError(f"no diagrams of this machine: {verdict.sentence}")


def cycle_curves(moving: engine.MovingMachine) -> CycleCurves:
    """Compute the fields of one machine.

    Parameters
    ----------
    moving : MovingMachine

    Raises
    ------
    PictureError
        The machine can't be computed.
    """
    scene = moving.scene
    names = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment", "input_moment"]
    names += ["work", *(["speed"] if _has_flywheel(scene) else [])] if engine.has_cycle(scene) else []
    main = main_slider(scene)
    ends = [f"{main}.stroke_{end}_at" for end in ("low", "high")] if main and engine.has_cycle(scene) else []
    known = [name for name in names if name in moving.register.available_fields]
    need_motion(moving, known)
    rows, quantities = moving.fields(known), {name: moving.register.fields[name].quantity for name in known}
    inertia, slope = rows["reduced_inertia"], rows["reduced_inertia_phi"]
    # Of an inertia that is constant, rounding leaves a slope.
    rows["reduced_inertia_phi"] = np.where(np.abs(slope).max() <= ROUNDED * np.abs(inertia).max(), 0.0, slope)
    label, factor = input_axis(scene, moving.q)
    centres = tuple(c for end in ends if math.isfinite(c := math.degrees(moving.summary(end))))
    # Rows skip load jumps, so their mean would be visibly off.
    mean = moving.summary("reduced_moment.mean") if engine.has_cycle(scene) and "reduced_moment" in known else math.nan
    return CycleCurves(
        moving.q * factor, label, rows, quantities, engine.has_cycle(scene), main if centres else None, centres, mean
    )


def input_axis(scene: engine.Scene, q: np.ndarray) -> tuple[str, float]:
    """Label and factor of the input axis for crank angles [rad] or displacements [m]."""
    symbol = engine.InputUnits.of(scene).symbols[0]
    if isinstance(scene.input, engine.CrankInput):
        return f"crank angle {symbol}, °", 180 / math.pi
    factor, label = engine.display_unit("m", q)
    return f"displacement of {scene.input.link} {symbol}, {label}", factor


def diagrams(machine: engine.Scene | engine.MovingMachine, target: Path | str | Figure | None) -> Figure:
    """Diagrams of one machine on one sheet, 180 mm wide.

    Over a full cycle: I(φ), dI/dφ, M(φ), W(φ), the loop W(I), with Wittenbauer's tangents if a coefficient of speed
    fluctuation is given, and ω(φ). If the input doesn't turn fully: I, dI/dφ, M and the drive torque.

    Parameters
    ----------
    machine : Scene or MovingMachine
    target : path, Figure or None
        File to write (.svg, .pdf, .png), or an empty figure to draw on; None for a new one.

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    PictureError
        The machine can't be computed, or unknown picture format.
    """
    moving = machine if isinstance(machine, engine.MovingMachine) else engine.MovingMachine(machine)
    cycle, scene = cycle_curves(moving), moving.scene
    with sheet(target, 180, 115) as figure:
        if engine.has_cycle(scene):
            _sheet_of_cycle(figure, moving, cycle)
        else:
            _sheet_of_range(figure, cycle)
        if scene.title:
            figure.suptitle(scene.title, fontweight="bold")
        if cycle.dead_centres:
            figure.supxlabel(f"Dotted lines: dead centres of {cycle.main}.", fontsize=7, x=0.01, ha="left")
    return figure


def _sheet_of_cycle(figure: Figure, moving: engine.MovingMachine, cycle: CycleCurves) -> None:
    axes = figure.subplots(2, 3)
    _panel(axes[0, 0], cycle, "reduced_inertia")
    _panel(axes[0, 1], cycle, "reduced_inertia_phi")
    _panel(axes[0, 2], cycle, "reduced_moment", cycle.mean_moment)
    _panel(axes[1, 0], cycle, "work")
    _energy_loop(axes[1, 1], moving, cycle)
    speed = cycle.rows.get("speed", np.array([np.nan]))
    if np.isfinite(speed).all():
        delta = engine.quantity_text(moving.summary("speed_fluctuation"), "1")
        # δ refers to the mean of the extremes, which is the input's speed.
        middle = abs(moving.numbers["input.speed"])
        _panel(axes[1, 2], cycle, "speed", middle, f"δ = {delta}")
    else:
        why = "the machine stalls within the cycle" if "speed" in cycle.rows else TIMED
        _say(axes[1, 2], f"ω(φ): {why if _has_flywheel(moving.scene) else 'no flywheel in the scene'}")


def _say(ax: Axes, why: str) -> None:
    """A sentence in place of a missing diagram."""
    ax.text(0.5, 0.5, why, ha="center", va="center", color=GREY, transform=ax.transAxes)
    ax.set_axis_off()


def _sheet_of_range(figure: Figure, cycle: CycleCurves) -> None:
    for ax, name in zip(figure.subplots(2, 2).flat, cycle.rows, strict=True):
        _panel(ax, cycle, name)


def _panel(ax: Axes, cycle: CycleCurves, name: str, mean: float = math.nan, title: str = "") -> None:
    """One quantity over the input position, optionally with its mean (SI)."""
    row = cycle.rows.get(name)
    if row is None:
        _say(ax, f"{name.replace('_', ' ')}: {TIMED}")
        return
    _, words, units, symbol, _ = cycle.known[name]
    symbol, title = typeset(symbol), title or words[0].upper() + words[1:]
    if np.isfinite(row).sum() < 2 or np.nanmax(np.abs(row)) > LARGEST:
        _say(ax, f"{symbol}: infinite or undefined")
        return
    factor, label = engine.display_unit(units, row)
    q, shown = cycle.q, factor * row
    if cycle.closed:
        # Close the cycle.
        q, shown = np.append(q, 2 * q[-1] - q[-2]), np.append(shown, shown[:1])
    ax.plot(q, shown, color=BLUE)
    if math.isfinite(mean):
        middle = factor * mean if abs(mean) > 1e-12 * np.abs(row).max() else 0.0
        ax.axhline(middle, color=VERMILION, linewidth=0.9, linestyle=(0, (6, 2)))
        # These words stay on one line.
        text = f"mean {engine.quantity_text(middle / factor, units)}".replace(" ", "\N{NO-BREAK SPACE}")
        title += f", {text}".replace("-", "\N{MINUS SIGN}")
    for centre in cycle.dead_centres:
        ax.axvline(centre, color="black", linewidth=0.7, linestyle=":")
    _show_range(ax, shown)
    title = "\n".join(wrapped(title, WORDS))
    ax.set(title=title, xlabel=cycle.q_label, ylabel=f"{symbol}, {label}", xlim=(q[0], q[-1]))
    if "°" in cycle.q_label:
        degree_ticks(ax.xaxis, q[-1] - q[0])


def _show_range(ax: Axes, shown: np.ndarray) -> None:
    """Avoid magnifying rounding noise of a constant."""
    low, high = float(np.nanmin(shown)), float(np.nanmax(shown))
    size = max(abs(low), abs(high))
    if high - low <= 1e-9 * size or size == 0:
        ax.set_ylim(low - 0.1 * size - (size == 0), high + 0.1 * size + (size == 0))


def _energy_loop(ax: Axes, moving: engine.MovingMachine, cycle: CycleCurves) -> None:
    """The loop W(I); if δ is given, with Wittenbauer's tangents and the flywheel from them."""
    if "work" not in cycle.rows:
        _say(ax, f"Energy loop: {TIMED}")
        return
    inertia, work = cycle.rows["reduced_inertia"], cycle.rows["work"]
    with np.errstate(over="ignore", invalid="ignore"):
        varies = np.ptp(inertia) > ROUNDED * inertia.max()
        span_i, span_w = np.ptp(inertia) if varies else 0.1 * inertia.max() or 1.0, np.ptp(work) or 1.0
        ends = np.array([inertia.min() - span_i, inertia.max() + span_i])
        tangents = _tangents(moving, inertia, work)
        heights = [[height + slope * end for end in ends] for slope, height, _ in tangents]
    if not np.max(np.abs([span_i, span_w, *np.ravel(heights)])) < LARGEST:
        _say(ax, "Energy loop: infinite or undefined")
        return
    quantities = cycle.known["reduced_inertia"], cycle.known["work"]
    (fi, unit_i), (fw, unit_w) = (
        engine.display_unit(q.units, row) for q, row in zip(quantities, (inertia, work), strict=True)
    )
    ax.plot(fi * np.append(inertia, inertia[0]), fw * np.append(work, work[0]), color=BLUE)
    _mark_quarters(ax, cycle, fi * inertia, fw * work)
    for k in np.array([1, 3, 5, 7]) * inertia.size // 8:
        tip, tail = ((fi * inertia[i], fw * work[i]) for i in (k + max(1, inertia.size // 90), k))
        ax.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", "color": BLUE, "linewidth": 1.0})
    ax.xaxis.set_major_locator(MaxNLocator(4))
    of_inertia, of_work = (typeset(quantity.symbol) for quantity in quantities)
    ax.set(title="Energy loop", xlabel=f"{of_inertia}, {unit_i}", ylabel=f"{of_work}, {unit_w}")
    ax.set_xlim(fi * (inertia.min() - 0.25 * span_i), fi * (inertia.max() + 0.25 * span_i))
    ax.set_ylim(fw * (work.min() - 0.35 * span_w), fw * (work.max() + 0.45 * span_w))
    if not tangents:
        return
    for (_, _, k), at_ends, colour, word in zip(tangents, heights, (VERMILION, GREEN), ("max", "min"), strict=True):
        label = rf"tangent of slope ½ω$_\mathrm{{{word}}}$²"
        ax.plot(fi * ends, fw * np.array(at_ends), color=colour, linewidth=0.9, label=label)
        ax.plot(fi * inertia[k], fw * work[k], "o", color=colour, markersize=3.5)
    wheel = engine.quantity_text(moving.summary("flywheel_wittenbauer"), "kg m2")
    ax.set_title(f"Energy loop: flywheel {wheel}".replace("-", "\N{MINUS SIGN}"))
    # Inside the axes it would cover a tangent.
    ax.figure.legend(loc="outside lower right", ncols=2)


def _mark_quarters(ax: Axes, cycle: CycleCurves, x: np.ndarray, y: np.ndarray) -> None:
    """Mark the start and quarters of the cycle on a loop with the input position."""
    quarters = np.arange(4) * x.size // 4
    ax.plot(x[quarters], y[quarters], "o", color=BLUE, markersize=3)
    for k in quarters:
        text = f"φ {cycle.q[k]:.0f}°" if "°" in cycle.q_label else f"{cycle.q[k]:.3g}"
        ax.annotate(text, (x[k], y[k]), (3, 3), textcoords="offset points", fontsize=6)


def _tangents(moving: engine.MovingMachine, inertia: np.ndarray, work: np.ndarray) -> list[tuple[float, float, int]]:
    """Wittenbauer's tangents of maximum and minimum speed: slope, intercept at I = 0, node touched."""
    wheel = moving.scene.flywheel
    if wheel is None or wheel.speed_fluctuation is None:
        return []
    delta, omega = moving.numbers["flywheel.speed_fluctuation"], np.float64(moving.numbers["input.speed"])
    found = []
    for sign, best in ((1, np.argmax), (-1, np.argmin)):
        slope = 0.5 * (omega * (1 + sign * delta / 2)) ** 2
        k = best(work - slope * inertia)
        found.append((slope, work[k] - slope * inertia[k], k))
    return found
