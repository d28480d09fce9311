"""Diagrams of a machine's true motion: time history through the regimes, and the cycle in steady running."""

import math
import textwrap
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

import engine
from engine import Scene, Verdict, display_unit
from sweeps.pictures.machine.cycle_rows import input_axis
from sweeps.pictures.panels import draw_panel
from sweeps.pictures.style import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, legend_below, sheet
from sweeps.report.regime_words import failure_text

# Colour and words of rows; all others are black.
_LOOKS = {
    "motors": (BLUE, "motors"),
    "driving": (SKY, "driving"),
    "useful": (VERMILION, "useful resistances"),
    "harmful": (ORANGE, "harmful resistances"),
    "braking": (PURPLE, "brakes"),
    "other": (GREY, "gravity and springs"),
    "coupling": (GREEN, "coupling torque, its heat"),
    "shaft_speed": ("black", "shaft of the coupling, reduced to the crank"),
    "energy": ("black", "kinetic energy E"),
}
_PLAIN = ("black", "")
# Rows that are drawn even where they are zero.
_ALWAYS = ("speed", "shaft_speed", "coupling", "energy", "reaction")
# Points drawn per regime; of more, the minimum and maximum per interval.
MOST_INSTANTS = 20_000
# Minimum width of a regime, relative to equal widths.
LEAST_SHARE = 0.5
# Width of a regime, relative to that of all, in which there is room for the label of its end only.
NARROW = 0.2
# Regimes whose ranges differ by more than this factor get separate scales.
APART = 2.0
# Values below this share of the peak are rounding.
NOTHING = 1e-9
# Height of the sheet, and of each reaction in it [mm]; share of its row.
HEIGHT, OF_REACTION, LOW = 165, 22, 0.6


class _Course(NamedTuple):
    """One regime of a history: its time from 0, its rows by diagram, and the pairs with a diagram; SI units."""

    name: str
    time: np.ndarray
    angle: np.ndarray
    rows: dict[str, dict[str, np.ndarray]]
    pairs: tuple[str, ...]


def courses(seen: "engine.History") -> list[_Course]:
    """A history by regime, with the nonzero torques and their work since the start.

    Parameters
    ----------
    seen : History
    """
    whole = np.isfinite(seen.speed) & np.isfinite(seen.time)
    moments = {"motors": seen.motor_moment} | seen.load_moments
    moments = {name: row for name, row in moments.items() if np.any(row[whole])}
    powers = {key: seen.powers[key] for key in moments}
    rates, along = moments, seen.angle
    if seen.powers["coupling"].any():
        # With a single speed, integrate over the angle, which is exact at speed jumps.
        powers["coupling"] = seen.powers["coupling"]
        rates, along = powers, seen.time
    within = whole[1:] & whole[:-1] & (seen.regime[1:] == seen.regime[:-1])
    steps = {key: np.where(within, 0.5 * np.diff(along) * (row[1:] + row[:-1]), 0.0) for key, row in rates.items()}
    known = {pair: np.abs(row) for pair, row in seen.loads_on_pairs.items() if np.isfinite(row).any()}
    reactions = {pair.removesuffix(".reaction"): {"reaction": row} for pair, row in known.items()}
    rounded = NOTHING * np.square(seen.speed[whole]).max(initial=0.0)
    diagrams = {
        "speed": {"speed": seen.speed, "shaft_speed": seen.shaft_speed},
        "acceleration": {"acceleration": np.where(np.abs(seen.acceleration) <= rounded, 0.0, seen.acceleration)},
        "moments": moments | {"coupling": seen.coupling_moment},
        "powers": powers,
        "works": {"energy": seen.energy} | {key: np.append(0.0, np.cumsum(row)) for key, row in steps.items()},
        **reactions,
    }
    found = []
    for name in dict.fromkeys(seen.regime):
        chosen = whole & (seen.regime == name)
        if chosen.sum() > 1:
            rows = {key: {k: row[chosen] for k, row in own.items()} for key, own in diagrams.items()}
            rows = {key: {k: row for k, row in own.items() if np.isfinite(row).any()} for key, own in rows.items()}
            time = seen.time[chosen]
            found.append(_Course(str(name), time - time[0], seen.angle[chosen], rows, tuple(reactions)))
    return found


def _above_rounding(rows: dict[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Rows of a diagram without torques, powers or works that are rounding in a regime."""
    sizes = {key: np.abs(row).max(initial=0.0) for key, row in rows.items()}
    return {key: row for key, row in rows.items() if key in _ALWAYS or sizes[key] > NOTHING * max(sizes.values())}


def history_diagrams(scene: Scene, seen: "engine.History") -> Figure:
    """Speed, torques, power, energy, work and kept reactions against time.

    One column per regime.

    Parameters
    ----------
    scene : Scene
    seen : History
        From `engine.machine.one_machine.history.history`.
    """
    for coupling in scene.couplings.values():
        # Both sides meet where the coupling locks.
        seen = seen._replace(shaft_speed=seen.shaft_speed / scene.shafts[coupling.shaft].ratio)
    parts, title = courses(seen), f"{scene.title or 'Machine'}: history"
    height = HEIGHT + OF_REACTION * len(parts[0].pairs) if parts else 30
    with sheet(180, height) as figure:
        if parts:
            _history_sheet(figure, scene, parts)
        if seen.verdict == Verdict.OK:
            figure.suptitle(title, fontweight="bold")
        else:
            figure.suptitle(f"{title}\n{textwrap.fill(failure_text(scene, seen.verdict, seen), 110)}", fontsize=8)
    return figure


def _history_sheet(figure: Figure, scene: Scene, parts: Sequence[_Course]) -> None:
    times = np.array([max(part.time[-1], 1e-9) for part in parts])
    widths = np.maximum(times / times.sum(), LEAST_SHARE / len(parts))
    # Reactions hide each other: each has a row.
    pairs = parts[0].pairs
    heights = [1.0] * 4 + [LOW] * len(pairs)
    grid = {"width_ratios": widths, "height_ratios": heights}
    axes = figure.subplots(len(heights), len(parts), sharex="col", squeeze=False, gridspec_kw=grid)
    units = engine.InputUnits.of(scene)
    _, speed, load = units.symbols
    shown = (
        *((speed, units.speed, "speed"), (load, units.moment, "moments"), ("P", "W", "powers"), ("E, W", "J", "works")),
        *(("R", "N", pair) for pair in pairs),
    )
    for row, (symbol, unit, of) in zip(axes, shown, strict=True):
        columns = [_above_rounding(part.rows[of]) for part in parts]
        factor, label = display_unit(unit, np.concatenate([v for column in columns for v in column.values()] or [[0]]))
        for ax, part, column in zip(row, parts, columns, strict=True):
            _lines(ax, part.time, {key: factor * values for key, values in column.items()})
        row[0].set_ylabel(f"{symbol}, {label}")
        _share_scale(row, columns)
    places = {pair.name: pair.place for pair in engine.pairs_of(scene)}
    for ax, pair in zip(axes[4:, 0], pairs, strict=True):
        ax.set_title(f"{pair}: {places[pair]}" if pair in places else pair, loc="left", fontsize=7, pad=2)
    for ax, part in zip(axes[0], parts, strict=True):
        kind = " (one cycle)" if isinstance(scene.regimes[part.name], engine.SteadyRegime) else ""
        ax.set_title(f"{part.name}{kind}", fontweight="bold")
    for ax, part, width in zip(axes[-1], parts, widths / widths.sum(), strict=True):
        ax.set_xlabel("t, s")
        ax.set_xlim(0, part.time[-1] if part.time[-1] > 0 else 1)
        if width > NARROW:
            ax.xaxis.set_major_locator(MaxNLocator(int(10 * width)))
        else:
            ax.set_xticks([part.time[-1]], [f"{part.time[-1]:.3g}"])
    legend_below(figure, axes.flat, 4)


def _share_scale(row: Sequence[Axes], columns: Sequence[dict[str, np.ndarray]]) -> None:
    """Use one scale for all regimes, or separate scales if one regime would be invisible."""
    spans = [float(np.ptp(list(column.values()))) for column in columns if column]
    if len(spans) == len(row) and min(spans) * APART < max(spans):
        return
    low, high = zip(*(ax.get_ylim() for ax in row), strict=True)
    for ax in row:
        ax.set_ylim(min(low), max(high))
    for ax in row[1:]:
        ax.tick_params(labelleft=False)


def _lines(ax: Axes, x: np.ndarray, rows: dict[str, np.ndarray]) -> None:
    for key, row in rows.items():
        colour, words = _LOOKS.get(key, _PLAIN)
        dashes = (0, (4, 2)) if key == "shaft_speed" else "solid"
        ax.plot(*_thinned(x, row), color=colour, label=words or None, linewidth=1.0, linestyle=dashes)


def _thinned(x: np.ndarray, row: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """A long row reduced to minimum and maximum per interval."""
    every = -(-row.size // MOST_INSTANTS)
    if every == 1:
        return x, row
    count = row.size // every
    pieces = row[: count * every].reshape(count, every)
    return np.repeat(x[: count * every : every], 2), np.stack((pieces.min(axis=1), pieces.max(axis=1)), axis=1).ravel()


def cycle_diagrams(scene: Scene, part: _Course) -> Figure:
    """Steady running over the crank angle: speed with its mean and δ, acceleration, torques and power.

    Parameters
    ----------
    scene : Scene
    part : _Course
        A steady regime of its history.
    """
    with sheet(180, 125) as figure:
        axes = figure.subplots(2, 2, sharex=True)
        title, marks = _speed_words(scene, part)
        panels = (
            (title, engine.PanelAxis("", "rad s-1", "ω"), {"speed": part.rows["speed"]["speed"]}, marks),
            ("Torques on the crank", engine.PanelAxis("", "N m", "M"), _above_rounding(part.rows["moments"]), ()),
            ("Angular acceleration", engine.PanelAxis("", "rad s-2", "ε"), part.rows["acceleration"], ()),
            ("Power", engine.PanelAxis("", "W", "P"), _above_rounding(part.rows["powers"]), ()),
        )
        for ax, (title, axis, rows, marks) in zip(axes.flat, panels, strict=True):
            colours, words = zip(*(_LOOKS.get(key, _PLAIN) for key in rows), strict=True)
            curves = list(map(engine.Curve, words, rows.values()))
            panel = engine.Panel(input_axis(scene), axis, part.angle, curves, marks, title)
            draw_panel(ax, panel, ax in axes[1], False, colours)
        # A clockwise crank turns to the right, too.
        axes[0, 0].xaxis.set_inverted(bool(part.angle[-1] < part.angle[0]))
        legend_below(figure, axes.flat, 4)
        figure.suptitle(f"{scene.title or 'Machine'}: {part.name}", fontweight="bold")
    return figure


def _speed_words(scene: Scene, part: _Course) -> tuple[str, list[engine.Mark]]:
    """Fluctuation and mean of the speed, and marks at its mean and extremes."""
    names = [f"{part.name}.{key}" for key in ("mean_speed", "speed_min", "speed_max", "speed_fluctuation")]
    sized = [f"{name}.flywheel" for name in engine.sized_regimes(scene)]
    found = engine.Machine(scene, [*names, *sized]).evaluate({})
    *marked, delta = (float(found.summaries[name][0]) for name in names)
    delta = delta if delta > found.errors[names[-1]][0] else 0.0
    title = f"δ = {engine.quantity_text(delta, '1')}, mean speed {engine.quantity_text(marked[0], 'rad s-1')}"
    return title, [engine.Mark("", None, math.copysign(height, part.rows["speed"]["speed"][0])) for height in marked]


def motion_sheets(scene: Scene) -> Iterator[tuple[str, Figure]]:
    """The history of a machine, and the cycle of each steady regime that it reaches, by name."""
    seen = engine.history(scene, fields=[name for name in engine.history_fields(scene) if name.endswith(".reaction")])
    yield "history", history_diagrams(scene, seen)
    for part in courses(seen):
        if isinstance(scene.regimes[part.name], engine.SteadyRegime):
            yield part.name, cycle_diagrams(scene, part)
