"""Diagrams of one machine over its cycle: reduced inertia and torque, work, energy loop, speed."""

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import engine
from sweeps.pictures.machine import cycle_rows
from sweeps.pictures.panels import axis_label, draw_panel
from sweeps.pictures.style import BLUE, GREEN, GREY, VERMILION, sheet, typeset, wrapped
from sweeps.study.default_summaries import main_slider

# A range of the inertia below this share of it is rounding.
ROUNDED = 1e-12
# Characters of a title above a panel.
WORDS = 31
# Size of the loop's axes, and of a letter in them [points].
LOOP, LETTER = np.array([122.0, 84.0]), np.array([3.6, 6.5])
# Distances of a label from its point [points], its directions from there, and a grid within its box.
GAPS = (2.5, 5.0)
SIDES = np.array([(1, 1), (-1, -1), (1, -1), (-1, 1), (1, 0), (-1, 0), (0, 1), (0, -1)])
WITHIN = np.stack(np.meshgrid(np.linspace(-1, 1, 9), np.linspace(-1, 1, 5)), axis=-1).reshape(-1, 2)
# Points of a straight line.
MANY = 200
TIMED = "a load depends on time"


class _Cycle(NamedTuple):
    """One machine, its fields over the cycle [SI], and marks at the dead centres of its main slider."""

    moving: engine.MovingMachine
    rows: Mapping[str, np.ndarray]
    centres: Sequence[engine.Mark]


def _has_flywheel(scene: engine.Scene) -> bool:
    return scene.flywheel is not None and scene.flywheel.has_size


def _cycle_of(moving: engine.MovingMachine) -> _Cycle:
    names = ["reduced_inertia", "reduced_inertia_phi", "reduced_moment", "input_moment"]
    if moving.scene.has_cycle:
        names += ["work", *(["speed"] if _has_flywheel(moving.scene) else [])]
    known = [name for name in names if name in moving.register.available_fields]
    cycle_rows.need_motion(moving, known)
    rows = cycle_rows.over_cycle(moving, known)
    return _Cycle(moving, rows, cycle_rows.dead_centres(moving, main_slider(moving.scene)))


def diagrams(machine: engine.Scene | engine.MovingMachine) -> Figure:
    """Diagrams of one machine on one sheet, 180 mm wide.

    Over a full cycle: I(φ), dI/dφ, M(φ), W(φ), the loop W(I), with Wittenbauer's tangents if a coefficient of speed
    fluctuation is given, and ω(φ). If the input doesn't turn fully: I, dI/dφ, M and the drive torque.

    Parameters
    ----------
    machine : Scene or MovingMachine

    Returns
    -------
    matplotlib.figure.Figure

    Raises
    ------
    PictureError
        The machine can't be computed.
    """
    moving = machine if isinstance(machine, engine.MovingMachine) else engine.MovingMachine(machine)
    cycle, scene = _cycle_of(moving), moving.scene
    with sheet(180, 115) as figure:
        if scene.has_cycle:
            _sheet_of_cycle(figure, cycle)
        else:
            for ax, name in zip(figure.subplots(2, 2).flat, cycle.rows, strict=True):
                _panel(ax, cycle, name)
        if scene.title:
            figure.suptitle(scene.title, fontweight="bold")
        if cycle.centres:
            words = f"Vertical lines: dead centres of {main_slider(scene)}."
            figure.supxlabel(words, fontsize=7, x=0.01, ha="left")
    return figure


def _sheet_of_cycle(figure: Figure, cycle: _Cycle) -> None:
    axes, moving = figure.subplots(2, 3), cycle.moving
    _panel(axes[0, 0], cycle, "reduced_inertia")
    _panel(axes[0, 1], cycle, "reduced_inertia_phi")
    # Rows skip load jumps, so their mean would be visibly off.
    _panel(axes[0, 2], cycle, "reduced_moment", "reduced_moment.mean")
    _panel(axes[1, 0], cycle, "work")
    _energy_loop(axes[1, 1], cycle)
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


def _panel(ax: Axes, cycle: _Cycle, name: str, mean: str | float | None = None, title: str = "") -> None:
    """One quantity over the input position, optionally with its mean (a summary, or a value in SI)."""
    row = cycle.rows.get(name)
    if row is None:
        _say(ax, f"{name.replace('_', ' ')}: {TIMED}")
        return
    field = cycle.moving.register.fields[name]
    words, units, symbol = field.long_name, field.units, field.symbol
    if np.isfinite(row).sum() < 2 or np.nanmax(np.abs(row)) > cycle_rows.LARGEST:
        _say(ax, f"{typeset(symbol)}: infinite or undefined")
        return
    title, marks = title or words[0].upper() + words[1:], [*cycle.centres]
    middle = cycle.moving.summary(mean) if isinstance(mean, str) else mean
    if middle is not None and math.isfinite(middle):
        middle = middle if abs(middle) > 1e-12 * np.abs(row).max() else 0.0
        marks.append(engine.Mark("", None, middle))
        # These words stay on one line.
        text = f"mean {engine.quantity_text(middle, units)}".replace(" ", "\N{NO-BREAK SPACE}")
        title += f", {text}".replace("-", "\N{MINUS SIGN}")
    title, axis = "\n".join(wrapped(title, WORDS)), engine.PanelAxis("", units, symbol)
    draw_panel(ax, cycle_rows.panel_over_cycle(cycle.moving, axis, [engine.Curve("", row)], marks, title))


def _energy_loop(ax: Axes, cycle: _Cycle) -> None:
    """The loop W(I); if δ is given, with Wittenbauer's tangents and the flywheel from them."""
    if "work" not in cycle.rows:
        _say(ax, f"Energy loop: {TIMED}")
        return
    inertia, work = cycle.rows["reduced_inertia"], cycle.rows["work"]
    with np.errstate(over="ignore", invalid="ignore"):
        varies = np.ptp(inertia) > ROUNDED * inertia.max()
        span_i, span_w = np.ptp(inertia) if varies else 0.1 * inertia.max() or 1.0, np.ptp(work) or 1.0
        ends = np.array([inertia.min() - span_i, inertia.max() + span_i])
        tangents = _tangents(cycle.moving, inertia, work)
        heights = [[height + slope * end for end in ends] for slope, height, _ in tangents]
    if not np.max(np.abs([span_i, span_w, *np.ravel(heights)])) < cycle_rows.LARGEST:
        _say(ax, "Energy loop: infinite or undefined")
        return
    known = cycle.moving.register.fields
    axes = [engine.PanelAxis("", known[name].units, known[name].symbol) for name in ("reduced_inertia", "work")]
    (fi, unit_i), (fw, unit_w) = (
        engine.display_unit(axis.unit, row) for axis, row in zip(axes, (inertia, work), strict=True)
    )
    ax.plot(fi * inertia, fw * work, color=BLUE)
    for k in np.array([1, 3, 5, 7]) * inertia.size // 8:
        tip, tail = ((fi * inertia[i], fw * work[i]) for i in (k + max(1, inertia.size // 90), k))
        ax.annotate("", tip, tail, arrowprops={"arrowstyle": "-|>", "color": BLUE, "linewidth": 1.0})
    ax.xaxis.set_major_locator(MaxNLocator(4))
    ax.set(title="Energy loop", xlabel=axis_label(axes[0], unit_i), ylabel=axis_label(axes[1], unit_w))
    ax.set_xlim(fi * (inertia.min() - 0.4 * span_i), fi * (inertia.max() + 0.4 * span_i))
    ax.set_ylim(fw * (work.min() - 0.35 * span_w), fw * (work.max() + 0.45 * span_w))
    lines = [np.column_stack([fi * ends, fw * np.array(row)]) for row in heights]
    shown = [np.linspace(*line, MANY) for line in lines]
    _mark_quarters(ax, cycle, fi * inertia, fw * work, shown)
    if not tangents:
        return
    for (_, _, k), at_ends, colour, word in zip(tangents, heights, (VERMILION, GREEN), ("max", "min"), strict=True):
        label = rf"tangent of slope ½ω$_\mathrm{{{word}}}$²"
        ax.plot(fi * ends, fw * np.array(at_ends), color=colour, linewidth=0.9, label=label)
        ax.plot(fi * inertia[k], fw * work[k], "o", color=colour, markersize=3.5)
    wheel = engine.quantity_text(cycle.moving.summary("flywheel_wittenbauer"), "kg m2")
    ax.set_title(f"Energy loop: required flywheel {wheel}".replace("-", "\N{MINUS SIGN}"))
    # Inside the axes it would cover a tangent.
    ax.figure.legend(loc="outside lower right", ncols=2)


def _mark_quarters(ax: Axes, cycle: _Cycle, x: np.ndarray, y: np.ndarray, others: Sequence[np.ndarray]) -> None:
    """Mark the start and quarters of the cycle on a loop with the input position, clear of the loop and other lines."""
    quarters = np.arange(4) * x.size // 4
    ax.plot(x[quarters], y[quarters], "o", color=BLUE, markersize=3)
    low, high = np.transpose([ax.get_xlim(), ax.get_ylim()])
    points, *lines = ((row - low) / (high - low) * LOOP for row in (np.column_stack([x, y]), *others))
    drawn, at = np.concatenate([points, *lines]), {}
    for k in quarters:
        at.setdefault(tuple(np.rint(points[k])), []).append(k)
    for same in at.values():
        text = f"φ {', '.join(f'{math.degrees(cycle.moving.q[i]):.0f}°' for i in same)}"
        half = 0.5 * LETTER * (len(text), 1)
        centres = np.concatenate([points[same[0]] + SIDES * (half + gap) for gap in GAPS])
        within = (np.abs(drawn - centres[:, None]) < half + 1.0).all(axis=2).sum(axis=1)
        beyond = (np.abs(centres - 0.5 * LOOP) > 0.5 * LOOP - half - 2.0).any(axis=1)
        best = np.argmin(within + drawn.size * beyond)
        look = {"textcoords": "offset points", "fontsize": 6, "ha": "center", "va": "center"}
        ax.annotate(text, (x[same[0]], y[same[0]]), centres[best] - points[same[0]], **look)
        drawn = np.concatenate([drawn, centres[best] + half * WITHIN])


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
