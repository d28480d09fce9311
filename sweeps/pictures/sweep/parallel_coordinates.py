"""Parallel coordinates of a sweep: each variant is a line across vertical axes."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import LineCollection
from matplotlib.patheffects import withStroke

from engine import display_unit
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import COLOURS, PALE, VERMILION, remark, wrapped
from sweeps.pictures.sweep.sweep_data import SweepData
from sweeps.text.conditions import parts_of

MOST_LINES = 1000
# Up to this number, lines stay lines in an SVG file, which is smaller than their pixels.
MOST_VECTORS = 300
MOST_COLUMNS = 10
# Characters that fit below the axes of a 180 mm figure with a colour bar.
LETTERS_ACROSS = 78


def chosen_columns(data: SweepData, colour: str) -> list[str]:
    """Columns to plot: variables, then summaries.

    Summaries in order: the colouring one, those of the condition, the others.

    Parameters
    ----------
    data : SweepData
    colour : str
        Array that colours the lines.

    Returns
    -------
    list of str
        At most 10, with at least one summary if there is any; constant columns are omitted, and summaries that the
        condition makes equal.
    """
    parts = parts_of(data.condition)
    asked = {name for part in parts for name in part.names}
    # The same for all variants that meet the condition.
    equal = {name for part in parts if part.is_equality for name in part.names} - {colour}
    summaries = sorted(data.summaries, key=lambda name: (name != colour, name not in asked))
    summaries = [name for name in summaries if name not in equal]
    varied, summaries = ([n for n in names if _differs(data, n)] for names in (data.varied, summaries))
    kept = 1 + sum(name in asked for name in summaries[1:]) if summaries else 0
    return [*varied[: max(MOST_COLUMNS - kept, 1)], *summaries][:MOST_COLUMNS]


def _differs(data: SweepData, name: str) -> bool:
    values = np.asarray(data.arrays[name])[data.ok]
    return values.size > 0 and bool((values != values[0]).any())


def parallel(ax: Axes, data: SweepData, names: Sequence[str], colour: str, best: int | None = None) -> None:
    """Parallel coordinates: a line per variant across vertical axes, coloured by one array.

    Parameters
    ----------
    ax : Axes
    data : SweepData
    names : sequence of str
        Parameters and summaries, one axis each; constant ones are omitted.
    colour : str
        Array that colours the lines.
    best : int, optional
        Variant to be marked.

    Raises
    ------
    PictureError
        Nothing varies, or no such array.
    """
    columns = [(data.shown(name)[0], _short(data, name), name) for name in names]
    shades, label, _ = data.shown(colour)
    sound = data.ok & np.isfinite(shades)
    for values, _, _ in columns:
        sound &= np.isfinite(values)
    columns = [c for c in columns if sound.any() and np.ptp(c[0][sound]) > 0]
    if not columns:
        raise PictureError(f"no column varies among the {np.count_nonzero(sound)} computed variants: nothing to show")
    rows = np.flatnonzero(sound)
    if rows.size > MOST_LINES:
        remark(ax, f"{MOST_LINES} of {rows.size} variants (evenly sampled)")
        rows = rows[np.linspace(0, rows.size - 1, MOST_LINES).astype(int)]
    lows, highs = (np.array([reach(values[sound]) for values, _, _ in columns]) for reach in (np.min, np.max))

    def paths(variants: np.ndarray) -> np.ndarray:
        heights = (np.column_stack([values[variants] for values, _, _ in columns]) - lows) / (highs - lows)
        return np.stack(np.broadcast_arrays(np.arange(len(columns)), heights), axis=-1)

    alpha = float(np.clip(200 / rows.size, 0.08, 0.7))
    look = {"linewidths": 0.7, "alpha": alpha, "rasterized": rows.size > MOST_VECTORS}
    out, rows = rows[data.out[rows]], rows[~data.out[rows]]
    if out.size:
        ax.add_collection(LineCollection(paths(out), color=PALE, **look))
        ax.plot([], color=PALE, label=data.legend_of("misses:"))
    if rows.size:
        lines = LineCollection(paths(rows), array=shades[rows], cmap=COLOURS, **look)
        ax.add_collection(lines)
        ax.figure.colorbar(lines, ax=ax, label=label, pad=0.02).solids.set_alpha(1)
    if best is not None:
        halo = [withStroke(linewidth=5, foreground="white")]
        look = {"color": VERMILION, "linewidth": 2.4, "marker": "o", "markersize": 5, "zorder": 5}
        ax.plot(*paths([best])[0].T, label="best", path_effects=halo, **look)
    if ax.get_legend_handles_labels()[0]:
        ax.figure.legend(loc="outside upper left", ncols=2)
    _uprights(ax, [text for _, text, _ in columns], lows, highs)


def _uprights(ax: Axes, labels: Sequence[str], lows: np.ndarray, highs: np.ndarray) -> None:
    """The axes of parallel coordinates, with the range of each."""
    numbers = [(f"{low:.4g}", f"{high:.4g}") for low, high in zip(lows, highs, strict=True)]
    # Wide numbers alternate between two levels.
    widest = max(len(number) for pair in numbers for number in pair)
    step = 0.09 if (widest + 1) * len(labels) > LETTERS_ACROSS else 0.0
    for place, (low, high) in enumerate(numbers):
        away = 0.02 + step * (place % 2)
        ax.plot([place, place], [0, 1], color="black", linewidth=0.8)
        ax.text(place, 1 + away, high, ha="center", va="bottom", fontsize=7)
        ax.text(place, -away, low, ha="center", va="top", fontsize=7)
    ax.set(xlim=(-0.4, len(labels) - 0.6), ylim=(-0.09 - step, 1.09 + step), yticks=[])
    _label(ax, labels)
    ax.tick_params(axis="x", length=0)
    ax.grid(False)
    ax.spines[:].set_visible(False)


def _label(ax: Axes, labels: Sequence[str]) -> None:
    """Label the axes horizontally; many or long labels are smaller."""
    across = LETTERS_ACROSS // len(labels)
    lines = [wrapped(label, min(18, across)) for label in labels]
    tight = any(len(line) > across for found in lines for line in found)
    ax.set_xticks(range(len(labels)), ["\n".join(found) for found in lines], fontsize=5.5 if tight else 7)


def _short(data: SweepData, name: str) -> str:
    """Name of a column with its unit."""
    _, unit = display_unit(data.units.get(name, "1"), np.asarray(data.arrays[name], float))
    return name + (f", {unit}" if unit not in ("", "1") else "")
