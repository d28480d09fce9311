"""Diagrams of any machine element, drawn from the curves and marks that the engine gives of it."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import Element, Panel
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import GREY, PALETTE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

# Draws an element to scale beside its diagrams.
Layout = Callable[[Axes, Element], None]
# Height of a picture with one, two, three diagrams one above the other [mm].
HEIGHTS = (80, 100, 130)


def panel_sheet(
    panels: Sequence[Panel], target: Path | str | Figure, title: str = "", layout: Callable[[Axes], None] | None = None
) -> Figure:
    """Draw diagrams that have numbers: those of one x axis one above the other, two of them alone side by side.

    Parameters
    ----------
    panels : sequence of Panel
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str
    layout : callable, optional
        Draws on axes to the left of all.

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or there are no numbers to draw.
    """
    panels = [panel for panel in panels if _has_numbers(panel)]
    if not panels:
        raise PictureError("the element has no results that could be drawn; sweeps run says why")
    columns: dict[object, list[int]] = {}
    for i, panel in enumerate(panels):
        columns.setdefault(panel.x, []).append(i)
    side_by_side = len(columns) == 1 and len(panels) == 2 and layout is None
    stacks = [[0], [1]] if side_by_side else list(columns.values())
    rows = max(map(len, stacks))
    width = 90 if len(stacks) == 1 and rows == 1 and layout is None else 180
    with sheet(target, width, HEIGHTS[min(rows, 3) - 1], title) as figure:
        parts = figure.subfigures(1, len(stacks) + (layout is not None), squeeze=False)[0]
        if layout is not None:
            layout(parts[0].subplots())
        for part, stack in zip(parts[layout is not None :], stacks, strict=True):
            axes = part.subplots(len(stack), 1, squeeze=False, sharex=len(stack) > 1)[:, 0]
            for ax, i in zip(axes, stack, strict=True):
                draw_panel(ax, panels[i], ax is axes[-1])
            part.align_ylabels(axes)
    return figure


def draw_panel(ax: Axes, panel: Panel, with_x: bool = True) -> None:
    """Draw the curves and marks of a diagram in an engineer's units.

    Parameters
    ----------
    ax : Axes
    panel : Panel
    with_x : bool
        Whether to say what runs along.
    """
    drawn = np.concatenate([np.ravel(c.values) for c in panel.curves])
    usual = drawn if panel.limits is None else np.array([max(np.abs(panel.limits))])
    along, along_unit = engineer_unit(panel.x.unit, panel.places)
    factor, unit = engineer_unit(panel.y.unit, usual[np.isfinite(usual)])
    colours = iter(PALETTE * len(panel.curves))
    for words, values, beside in panel.curves:
        style = {"color": GREY, "linewidth": 0.8} if beside else {"color": next(colours)}
        ax.plot(along * panel.places, factor * values, label=words or "_", **style)
    for words, place, height in panel.marks:
        style = {"color": GREY, "linewidth": 0.8, "linestyle": (0, (4, 2)), "label": words or "_"}
        if height is None:
            ax.axvline(along * place, **style)
        elif place is None:
            ax.axhline(factor * height, **style)
        else:
            ax.plot(along * place, factor * height, "o", color=VERMILION, markersize=4, label=words or "_")
    ax.set_xlim(along * panel.places[0], along * panel.places[-1])
    if panel.limits is not None:
        ax.set_ylim(*(factor * limit for limit in panel.limits))
    ax.set(ylabel=_named(panel.y.words, unit), title=panel.title)
    if with_x:
        ax.set_xlabel(_named(panel.x.words, along_unit))
    if any(not label.startswith("_") for label in ax.get_legend_handles_labels()[1]):
        ax.legend(loc="best")


def _has_numbers(panel: Panel) -> bool:
    return bool(np.isfinite(panel.places).all() and any(np.isfinite(curve.values).any() for curve in panel.curves))


def _named(words: str, unit: str) -> str:
    return words if unit == "1" else f"{words}, {unit}"
