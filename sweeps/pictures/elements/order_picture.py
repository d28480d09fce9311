"""Figure of an engine order table: the unbalanced force and couple vectors."""

import math
from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import Hodograph
from sweeps.pictures.style import BLUE, GREY, ORANGE, sheet
from sweeps.report import order_table


def order_picture(rows: Sequence[order_table.EngineRow]) -> Figure:
    """Draw the hodographs of each engine's unbalanced forces and couples.

    Parameters
    ----------
    rows : sequence of EngineRow
    """
    with sheet(180, 12 + 12 * len(rows)) as figure:
        axes = figure.subplots(len(rows), 4, squeeze=False)
        for row, line in zip(rows, axes, strict=True):
            found = order_table.remaining_orders(row)
            vectors = [(v, order) for v in (found.forces, found.couples) for order in (1, 2)]
            for ax, (vector, order) in zip(line, vectors, strict=True):
                _draw(ax, vector, order)
            line[0].set_ylabel(row.name, rotation=0, ha="right", va="center")
        for ax, head in zip(axes[0], order_table.VECTOR_HEADS, strict=True):
            unit = "m r ω² A" if "force" in head else "m r ω² a A"
            ax.set_title(f"{head}\nin {unit}{order_table.subscript_of(1 + ('sec' in head))}")
    return figure


def _draw(ax: Axes, vector: Hodograph, order: int) -> None:
    """Hodograph of one vector, the engine's axis upwards; a dot marks the start."""
    i = vector.orders.index(order)
    one = Hodograph((order,), vector.forward[i : i + 1], vector.backward[i : i + 1])
    way = one.at(np.linspace(0, math.tau / order, 181)) * 1j
    size = one.major[0]
    ax.set(aspect="equal", xticks=[], yticks=[], xlim=(-1.3, 6.5), ylim=(-1.2, 1.2))
    ax.grid(False)
    for side in ax.spines.values():
        side.set_visible(False)
    if size == 0:
        ax.plot(0, 0, ".", color=GREY, markersize=3)
        return
    way = way / size
    shape = BLUE if one.minor[0] <= order_table.BALANCED * size else ORANGE
    ax.plot(way.real, way.imag, color=shape)
    ax.plot([0, way[0].real], [0, way[0].imag], color=GREY, linewidth=0.6)
    ax.plot(way[0].real, way[0].imag, "o", color=shape, markersize=2.5)
    ax.text(1.15, 0, order_table.ellipse_text(vector, order), ha="left", va="center", fontsize=6.5)
