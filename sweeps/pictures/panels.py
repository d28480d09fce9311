"""Diagrams from the curves and marks of panels."""

from collections.abc import Callable, Sequence
from itertools import cycle

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import MaxNLocator

from engine import Panel, PanelAxis, display_unit
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import GREY, PALETTE, VERMILION, degree_ticks, scaled_as_constant, sheet, typeset

# Height with one, two, three stacked diagrams [mm]; maximum number of columns.
HEIGHTS, MOST_COLUMNS = (80, 100, 150), 3
# Entries of a plan's legend that fit in one column.
FEW = 4
# Letters of tick names that fit along an axis; longer names are slanted.
_LETTERS = 25


def panel_sheet(panels: Sequence[Panel], title: str = "", layout: Callable[[Axes], None] | None = None) -> Figure:
    """Draw the diagrams that have data: those with a common x axis stacked, two single ones side by side.

    Parameters
    ----------
    panels : sequence of Panel
    title : str
    layout : callable, optional
        Draws the layout on the left.

    Raises
    ------
    PictureError
        No diagram has data.
    """
    panels = [panel for panel in panels if _has_numbers(panel)]
    if not panels:
        raise PictureError("the element has no results to draw; `sweeps run` shows why")
    columns: dict[object, list[Panel]] = {}
    for panel in panels:
        columns.setdefault((panel.kind, panel.x.words, panel.kind == "plan" and panel.title), []).append(panel)
    stacks = list(columns.values())
    if len(panels) == 2 and layout is None:
        stacks = [[panel] for panel in panels]
    drawn = ([None] if layout else []) + stacks
    lines = [drawn[k : k + MOST_COLUMNS] for k in range(0, len(drawn), MOST_COLUMNS)]
    rows = [max(len(stack or ()) for stack in line) or 1 for line in lines]
    width = 90 if len(drawn) == 1 and rows[0] == 1 else 180
    heights = [HEIGHTS[min(count, 3) - 1] for count in rows]
    with sheet(width, sum(heights), title) as figure:
        for line, part in zip(
            lines, figure.subfigures(len(lines), 1, squeeze=False, height_ratios=heights)[:, 0], strict=True
        ):
            for stack, column in zip(line, part.subfigures(1, len(line), squeeze=False)[0], strict=True):
                if stack is None:
                    layout(column.subplots())
                    continue
                axes = column.subplots(len(stack), 1, squeeze=False, sharex=len(stack) > 1)[:, 0]
                for ax, panel in zip(axes, stack, strict=True):
                    draw_panel(ax, panel, ax is axes[-1])
                column.align_ylabels(axes)
    return figure


def draw_panel(
    ax: Axes, panel: Panel, with_x: bool = True, with_legend: bool = True, palette: Sequence[str] = PALETTE
) -> None:
    """Draw the curves and marks of a diagram in practical units.

    Parameters
    ----------
    ax : Axes
    panel : Panel
    with_x, with_legend : bool
        Whether the x axis has a label, and the diagram a legend.
    palette : sequence of str
        Colours of the curves that aren't faint.
    """
    values = np.concatenate([np.ravel(c.values) for c in panel.curves] or [np.zeros(1)])
    usual = values if panel.limits is None else np.array([max(np.abs(panel.limits))])
    along, along_unit = display_unit(panel.x.unit, panel.places)
    factor, unit = (along, along_unit) if panel.kind == "plan" else display_unit(panel.y.unit, usual)
    colours = cycle(palette)
    for k, (words, row, faint, own) in enumerate(panel.curves):
        colour = GREY if faint else next(colours)
        places = panel.places if own is None else own
        if panel.kind == "bars":
            width = 0.8 * np.diff(np.unique(places)).min(initial=1.0) / len(panel.curves)
            shift = width * (k - 0.5 * (len(panel.curves) - 1))
            ax.bar(along * (places + shift), factor * row, along * width, color=colour, label=words or "_")
            # Room for the legend above the bars.
            ax.margins(y=0.35 if words else 0.05)
            continue
        look = {"linewidth": 0.8, "zorder": 1.5} if faint else {}
        (line,) = ax.plot(along * places, factor * row, color=colour, label=words or "_", **look)
        if faint and own is not None and panel.kind == "curves":
            line.set_label("_")
            ax.annotate(words, line.get_xydata()[-1], (2, 1), textcoords="offset points", fontsize=6.5, color=GREY)
    for words, place, height in panel.marks:
        style = {"color": GREY, "linewidth": 0.8, "linestyle": (0, (4, 2)), "label": words or "_"}
        if height is None:
            ax.axvline(along * place, **style)
        elif place is None:
            ax.axhline(factor * height, **style)
        else:
            ax.plot(along * place, factor * height, "o", color=VERMILION, markersize=4, label=words or "_")
    legend = {"loc": "best"}
    if panel.kind == "plan":
        # Few entries are stacked: long ones side by side would reach beyond the plan.
        few = len(ax.get_legend_handles_labels()[1]) <= FEW
        legend = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.16), "ncols": 1 if few else 2}
        ax.set(aspect="equal", adjustable="datalim")
    elif panel.kind == "curves" and not panel.names:
        every = np.concatenate([panel.places, *(curve.places for curve in panel.curves if curve.places is not None)])
        ax.set_xlim(along * every.min(), along * every.max())
        if along_unit == "°":
            degree_ticks(ax.xaxis, abs(along) * np.ptp(every))
    if panel.limits is not None:
        # Curves that exceed the limits leave no free corner for a legend.
        wide = with_x and MOST_COLUMNS * ax.figure.bbox.width > 1.1 * ax.get_figure(root=True).bbox.width
        legend = {"loc": "upper center", "bbox_to_anchor": (0.5, -0.25), "ncols": 3} if wide else legend
        ax.set(ylim=[factor * x for x in panel.limits], yscale="log" if panel.limits[0] > 0.0 else "linear")
    elif panel.kind == "curves":
        scaled_as_constant(ax, factor * values)
    if panel.kind == "bars" and panel.x.unit == "1":
        ax.xaxis.set_major_locator(MaxNLocator(10, integer=True))
    if panel.names:
        ax.set_xticks(along * panel.places, panel.names, **({"rotation": 30, "ha": "right"} if _crowded(panel) else {}))
    words = panel.y.words
    if panel.y.symbol and not panel.title:
        ax.set(title=words[0].upper() + words[1:], ylabel=axis_label(PanelAxis("", *panel.y[1:]), unit))
    else:
        ax.set(title=panel.title, ylabel=axis_label(panel.y, unit))
    if with_x:
        ax.set_xlabel(axis_label(panel.x, along_unit))
    if with_legend and any(not label.startswith("_") for label in ax.get_legend_handles_labels()[1]):
        ax.legend(**legend)


def _crowded(panel: Panel) -> bool:
    """Whether neighbouring tick names would overlap."""
    order = np.argsort(panel.places)
    lengths = np.array([max(map(len, name.split("\n"))) for name in panel.names])[order]
    gaps = np.diff(panel.places[order]) / (np.ptp(panel.places) or 1.0)
    return bool((0.5 * (lengths[1:] + lengths[:-1]) > _LETTERS * gaps).any())


def _has_numbers(panel: Panel) -> bool:
    return bool(np.isfinite(panel.places).all() and any(np.isfinite(curve.values).any() for curve in panel.curves))


def axis_label(axis: PanelAxis, unit: str) -> str:
    """Words and symbol of an axis, with the unit of its numbers."""
    text = f"{axis.words} {typeset(axis.symbol)}".strip()
    return text if unit == "1" else f"{text}, {unit}"
