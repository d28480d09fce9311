"""Plot of a Pareto front among all candidates, with chosen mechanisms drawn to one scale."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import quantity_text
from sweeps.optimising.optimum import Choice, choices, front, met, objectives
from sweeps.pictures.drawing import draw
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, COLOURS, PALE, VERMILION, remark, sheet, wrapped
from sweeps.pictures.sweep.sweep_data import SweepData
from sweeps.report.sweep_result import SweepResult

WIDTH, HEIGHT, DRAWING = 180, 105, 72
# Margin beyond the front, in front widths; distant candidates are cut off.
ROUND_ABOUT = 0.6
# Numbers listed per drawn machine.
MOST_TOLD = 4


def front_picture(result: SweepResult, data: SweepData) -> Figure:
    """Draw the front of a multi-objective search.

    The first two objectives are the axes, a third is the colour of the front.

    Parameters
    ----------
    result : SweepResult
    data : SweepData
        Its plot data.

    Raises
    ------
    PictureError
        The front is empty.
    """
    if not front(result).size:
        raise PictureError("no candidate meets all conditions: there is no front to draw")
    chosen = choices(result)
    drawn = [] if result.scene.input is None else chosen
    with sheet(WIDTH, HEIGHT + (DRAWING if drawn else 0)) as figure:
        rows = figure.subfigures(2, 1, height_ratios=[HEIGHT, DRAWING]) if drawn else [figure]
        _scatter(rows[0].subplots(), result, data, chosen)
        if drawn:
            _mechanisms(rows[1].subplots(1, len(drawn), squeeze=False)[0], result, drawn)
    return figure


def _scatter(ax: Axes, result: SweepResult, data: SweepData, chosen: Sequence[Choice]) -> None:
    """Computed candidates, the front, and the chosen points by letter."""
    there, names = front(result), [name for name, _ in objectives(result)]
    (x, x_label, _), (y, y_label, _) = (data.shown(name) for name in names[:2])
    meets = met(result)
    for which, colour, label in ((data.ok & ~meets, PALE, "misses a condition"), (meets, BLUE, "meets all conditions")):
        if which.any():
            ax.scatter(x[which], y[which], s=2, c=colour, linewidths=0, rasterized=True, label=label)
    if len(names) > 2:
        shades, label, _ = data.shown(names[2])
        dots = ax.scatter(x[there], y[there], s=14, c=shades[there], cmap=COLOURS, label="Pareto front", zorder=3)
        ax.figure.colorbar(dots, ax=ax, label=label, pad=0.02)
    else:
        ax.plot(x[there], y[there], "o", color=VERMILION, markersize=2.5, label="Pareto front")
    for letter, choice in zip("ABCDEFGH", chosen, strict=False):
        at = x[choice.variant], y[choice.variant]
        ax.plot(*at, "o", markersize=9, markerfacecolor="none", markeredgecolor="black", zorder=4)
        ax.annotate(letter, at, (7, 7), textcoords="offset points", fontsize=10, fontweight="bold", zorder=4)
    for set_limits, values in ((ax.set_xlim, x[there]), (ax.set_ylim, y[there])):
        room = ROUND_ABOUT * (np.ptp(values) or abs(values[0]) or 1.0)
        set_limits(values.min() - room / 3, values.max() + room)
    ax.set(xlabel=x_label, ylabel=y_label)
    ax.legend(loc="best", markerscale=2)
    hidden = np.count_nonzero(~data.ok)
    words = f"{hidden} of {data.ok.size} candidates failed or were dropped" if hidden else ""
    remark(ax, words)


def _differing(result: SweepResult, chosen: Sequence[Choice]) -> list[list[str]]:
    """Varied numbers that differ between the chosen machines, by machine."""
    rows = []
    for name in result.varied:
        values = (result.columns[name][choice.variant] for choice in chosen)
        texts = [quantity_text(float(value), result.units[name]) for value in values]
        if len(set(texts)) > 1 or len(texts) == 1:
            rows.append([f"{'.'.join(name.split('.')[-2:])} = {text}" for text in texts])
    return [[row[k] for row in rows[:MOST_TOLD]] for k in range(len(chosen))]


def _mechanisms(axes: Sequence[Axes], result: SweepResult, chosen: Sequence[Choice]) -> None:
    """The machines of chosen points, all to the same scale."""
    for letter, ax, choice, numbers in zip("ABCDEFGH", axes, chosen, _differing(result, chosen), strict=False):
        draw(result.scene_of(choice.variant), ax)
        ax.set_title("\n".join([*wrapped(f"{letter}: {choice.why}", 30), *numbers]), fontsize=7)
        ax.tick_params(labelsize=6)
    x, y = ([f(ax) for ax in axes] for f in (Axes.get_xlim, Axes.get_ylim))
    for ax in axes:
        ax.set_xlim(min(low for low, _ in x), max(high for _, high in x))
        ax.set_ylim(min(low for low, _ in y), max(high for _, high in y))
