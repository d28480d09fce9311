"""Plots of sweep results: curves, field bands, maps and scatters, chosen by the design."""

from collections.abc import Sequence

import numpy as np
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap
from matplotlib.figure import Figure
from matplotlib.patches import Patch
from matplotlib.ticker import MultipleLocator

from engine import Verdict, display_unit
from sweeps.pictures import style
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, COLOURS, GREY, PALE, PALETTE, VERMILION
from sweeps.pictures.sweep.parallel_coordinates import chosen_columns, parallel
from sweeps.pictures.sweep.sweep_data import SweepData
from sweeps.study.sensitivity import RSS, WORST_CASE

VEIL = "#e9ebed"
# Maximum total variation along a row or column, in ranges, for legible contour lines.
MOST_TRAVEL = 4.0
# Maximum number of entries of a list with a tick each.
MOST_TICKS = 12
# Cells with white edges.
MOST_CELLS = 2500
# Visible band width, as a share of the curve's range.
SEEN = 0.002
# Characters along the side of a panel.
BESIDE_A_PANEL = 34


def curves(figure: Figure, data: SweepData, x: str, ys: Sequence[str], best: int | None = None) -> None:
    """Summaries against one parameter, one panel each, with visible error bands.

    Parameters
    ----------
    figure : Figure
        Empty figure.
    data : SweepData
    x : str
        Parameter along the axis.
    ys : sequence of str
        Summaries.
    best : int, optional
        Variant to mark.
    """
    along, label, _ = data.shown(x)
    order = np.argsort(along, kind="stable")
    axes = figure.subplots(len(ys), 1, sharex=True, squeeze=False)[:, 0]
    for ax, y in zip(axes, ys, strict=True):
        values, y_label, factor = data.shown(y)
        values = np.where(data.ok, values, np.nan)
        few = np.count_nonzero(data.ok) <= 60
        ax.plot(along[order], values[order], color=BLUE, marker="o" if few else None, markersize=2.5)
        error = factor * np.asarray(data.arrays.get(f"{y}_error", np.zeros_like(values)), dtype=float)
        constant = style.scaled_as_constant(ax, values)
        if not constant and data.ok.any() and np.nanmax(np.nan_to_num(error[data.ok])) > SEEN * np.ptp(values[data.ok]):
            low, high = (values - error)[order], (values + error)[order]
            ax.fill_between(along[order], low, high, color=BLUE, alpha=0.2, linewidth=0, label="error estimate")
        _tolerance_bands(ax, data, along[order], y, order)
        if data.out.any():
            shown = np.where(data.out, values, np.nan)[order]
            look = {"color": PALE, "marker": "o" if few else None, "markersize": 3, "linewidth": 1.8}
            ax.plot(along[order], shown, **look, label=data.legend_of("misses:"))
        _mark_failed(ax, along, data.status)
        if best is not None:
            ax.plot(along[best], values[best], "*", color=VERMILION, markersize=10, label="best")
        ax.set_ylabel("\n".join(style.wrapped(y_label.replace("\n", " "), BESIDE_A_PANEL)))
    axes[-1].set_xlabel(label)
    style.legend_below(figure, axes, 3)


def _tolerance_bands(ax: Axes, data: SweepData, along: np.ndarray, y: str, order: np.ndarray) -> None:
    """Bands of a summary within tolerances: worst case and statistical."""
    values, _, factor = data.shown(y)
    for ending, alpha, words in ((WORST_CASE, 0.15, "worst case"), (RSS, 0.25, "root of sum of squares")):
        band = np.where(data.ok, factor * np.asarray(data.arrays.get(f"{y}.{ending}", 0.0), float), np.nan)
        if data.ok.any() and np.nanmax(np.nan_to_num(band)) > SEEN * np.ptp(values[data.ok]):
            ends, look = ((values - band)[order], (values + band)[order]), {"color": VERMILION, "linewidth": 0}
            ax.fill_between(along, *ends, alpha=alpha, label=f"within tolerances, {words}", **look)


def _mark_failed(ax: Axes, along: np.ndarray, status: np.ndarray) -> None:
    """Crosses at the bottom where variants failed, coloured by reason."""
    for colour, code in zip(PALETTE[2:] + PALETTE[1:2], _failures(status), strict=False):
        where = along[status == code]
        look = {"color": colour, "markersize": 4, "label": Verdict(code).short}
        ax.plot(where, np.full(where.shape, 0.03), "x", transform=ax.get_xaxis_transform(), **look)


def _failures(status: np.ndarray) -> list[int]:
    return [int(code) for code in np.unique(status) if code != Verdict.OK]


def field_band(ax: Axes, data: SweepData, name: str, best: int | None = None) -> None:
    """A field over the input position: band of all variants, median, best variant.

    Parameters
    ----------
    ax : Axes
    data : SweepData
    name : str
        A field with its axis.
    best : int, optional
        Variant to highlight.

    Raises
    ------
    PictureError
        No computed variant.
    """
    values, label, _ = data.shown(name)
    axis = data.along[name]
    # Rows of a run stop at its end.
    over_cycle, known = axis.over_positions, np.isfinite(values)
    sound = data.ok & (known.all(axis=1) if over_cycle else known.any(axis=1))
    if not sound.any():
        raise PictureError(f"{name!r}: no variant was computed successfully")
    factor, unit = display_unit(axis.units, axis.values)
    position = factor * axis.values
    step = np.diff(position[:2]).sum()
    if over_cycle and unit == "°" and round((position[-1] + step) % 360, 6) in (0, 360):
        # Close the cycle.
        position, values = np.append(position, position[-1] + step), np.append(values, values[:, :1], axis=1)
    if data.out.any():
        _band(ax, position, values[sound], PALE, 0.5, f"all {np.count_nonzero(sound)} variants")
    chosen = sound & ~data.out
    if chosen.any():
        words = f"{np.count_nonzero(chosen)} variants"
        _band(ax, position, values[chosen], BLUE, 0.18, data.legend_of(f"{words} with") if data.out.any() else words)
        words, reached = "median", np.isfinite(values[chosen]).any(axis=0)
        if not known[chosen].all():
            words = "median of those still running"
        middle = np.nanmedian(values[chosen][:, reached], axis=0)
        ax.plot(position[reached], middle, color=BLUE, linewidth=1, linestyle=(0, (5, 2)), label=words)
    if best is not None:
        ax.plot(position, values[best], color=VERMILION, label="best variant")
    along = f"position q, {unit}"
    if not over_cycle:
        along = f"{axis.long_name}, {unit}"
    elif unit == "°":
        along = f"crank angle φ, {unit}"
    ax.set(xlabel=along, ylabel=label)
    if position.size > 1:
        ax.set_xlim(position[0], position[-1])
    if over_cycle and unit == "°":
        ax.xaxis.set_major_locator(MultipleLocator(90 if np.ptp(position) > 180 else 30))
    ax.legend(loc="best")


def _band(ax: Axes, position: np.ndarray, values: np.ndarray, colour: str, alpha: float, label: str) -> None:
    reached = np.isfinite(values).any(axis=0)
    low, high = np.nanmin(values[:, reached], axis=0), np.nanmax(values[:, reached], axis=0)
    ax.fill_between(position[reached], low, high, color=colour, alpha=alpha, linewidth=0, label=label)


def map2d(ax: Axes, data: SweepData, x: str, y: str, colour: str, best: int | None = None) -> None:
    """Colour map with contour lines of a summary over two grid parameters; failed cells grey with the reason.

    Over lists and whole numbers it has cells, without contour lines: no variant lies between them.

    Parameters
    ----------
    ax : Axes
    data : SweepData
        Its grid has exactly two axes with more than one value.
    x, y : str
        The parameters along those axes, in either order.
    colour : str
        The summary.
    best : int, optional
        Variant to mark.
    """
    sizes = [size for size in data.shape if size > 1]
    turn = data.grid_parameters()[0] == x
    (xs, x_label, _), (ys, y_label, _), (values, label, _) = (data.shown(name) for name in (x, y, colour))

    def cells(flat: np.ndarray) -> np.ndarray:
        grid = np.asarray(flat).reshape(sizes)
        return grid.T if turn else grid

    places_x, places_y = cells(xs)[0], cells(ys)[:, 0]
    sound = data.ok & np.isfinite(values)
    grid = cells(np.where(sound, values, np.nan))
    status = np.where(data.ok & ~sound, Verdict.NOT_FINITE, data.status)
    _failed_cells(ax, places_x, places_y, cells(status))
    if sound.any():
        in_steps = data.in_steps(x) or data.in_steps(y)
        edges = {"edgecolors": "white", "linewidth": 0.8} if in_steps and grid.size <= MOST_CELLS else {}
        look = {"cmap": COLOURS, "shading": "nearest", "rasterized": grid.size > 10_000}
        mesh = ax.pcolormesh(places_x, places_y, grid, **look, **edges)
        ax.figure.colorbar(mesh, ax=ax, label=label, pad=0.02)
        if _is_smooth(grid) and not in_steps:
            lines = ax.contour(places_x, places_y, grid, levels=8, colors="white", linewidths=0.7)
            ax.clabel(lines, fontsize=6.5, fmt="%.4g")
    if best is not None:
        ax.plot(xs[best], ys[best], "*", color=VERMILION, markeredgecolor="white", markersize=13, label="best")
    ax.set(xlabel=x_label, ylabel=y_label)
    for name, axis, places in ((x, ax.xaxis, places_x), (y, ax.yaxis, places_y)):
        if data.in_steps(name) and places.size <= MOST_TICKS:
            axis.set_ticks(places, [f"{place:.4g}" for place in places])
    ax.grid(False)
    handles = ax.get_legend_handles_labels()[0]
    if data.out.any():
        _veil(ax, places_x, places_y, cells(data.out))
        handles.append(Patch(label=data.legend_of("misses:"), facecolor=VEIL, linewidth=0))
    for k, code in enumerate(_failures(status)):
        handles.append(Patch(label=Verdict(code).short, linewidth=0, **_failed_look(k)))
    if handles:
        ax.figure.legend(handles=handles, loc="outside lower center", ncols=3)


def _is_smooth(grid: np.ndarray) -> bool:
    """Whether contour lines are legible: values vary slowly across the grid."""
    span = np.nanmax(grid) - np.nanmin(grid)
    if min(grid.shape) < 3 or not span > 0:
        return False
    travelled = [np.nansum(np.abs(np.diff(grid, axis=axis)), axis=axis).mean() for axis in (0, 1)]
    return max(travelled) < MOST_TRAVEL * span


def _veil(ax: Axes, xs: np.ndarray, ys: np.ndarray, out: np.ndarray) -> None:
    """Fade the cells of variants that miss the condition."""
    there = np.ma.masked_where(~out, np.ones(out.shape))
    face = ListedColormap([VEIL])
    ax.pcolormesh(xs, ys, there, cmap=face, shading="nearest", alpha=0.8, linewidth=0, rasterized=out.size > 10_000)


def _failed_look(k: int) -> dict[str, str]:
    return {
        "facecolor": ("#9aa0a6", "#c3c8cc", "#7f858a", "#dcdfe2")[k % 4],
        "hatch": ("////", "\\\\\\\\", "xxxx", "....")[k % 4],
        "edgecolor": "white",
    }


def _failed_cells(ax: Axes, xs: np.ndarray, ys: np.ndarray, status: np.ndarray) -> None:
    """Grey cells, hatched by reason."""
    for k, code in enumerate(_failures(status)):
        there = np.ma.masked_where(status != code, np.ones(status.shape))
        look = _failed_look(k)
        face = ListedColormap([look["facecolor"]])
        cells = ax.pcolor(xs, ys, there, cmap=face, shading="nearest", rasterized=status.size > 10_000)
        cells.set(linewidth=0, hatch=look["hatch"], edgecolor=look["edgecolor"])


def scatter(ax: Axes, data: SweepData, x: str, y: str, colour: str | None = None, best: int | None = None) -> None:
    """Scatter of two arrays, coloured by a third.

    Parameters
    ----------
    ax : Axes
    data : SweepData
    x, y : str
    colour : str, optional
    best : int, optional
        Variant to mark.
    """
    (xs, x_label, _), (ys, y_label, _) = data.shown(x), data.shown(y)
    finite = data.ok & np.isfinite(xs) & np.isfinite(ys)
    sound = finite & ~data.out
    size = float(np.clip(6000 / max(1, np.count_nonzero(finite)), 1.5, 14))
    out = finite & data.out
    if out.any():
        ax.scatter(xs[out], ys[out], c=PALE, s=size, linewidths=0, rasterized=True, label=data.legend_of("misses:"))
    shades, label = (BLUE, "") if colour is None else (data.shown(colour)[0][sound], data.shown(colour)[1])
    dots = ax.scatter(
        xs[sound], ys[sound], c=shades, s=size, cmap=None if colour is None else COLOURS, linewidths=0, rasterized=True
    )
    if colour is not None:
        ax.figure.colorbar(dots, ax=ax, label=label, pad=0.02)
    if best is not None:
        ax.plot(xs[best], ys[best], "*", color=VERMILION, markeredgecolor="black", markersize=12, label="best")
    failed = np.count_nonzero(~data.ok)
    ax.set(xlabel=x_label, ylabel=y_label)
    if failed:
        style.remark(ax, f"{failed} of {data.ok.size} variants failed or were dropped and aren't shown")
    style.legend_below(ax.figure, [ax], 3)


def plot_result(
    data: SweepData, x: str | None = None, y: str | None = None, colour: str | None = None, best: int | None = None
) -> Figure:
    """Draw a sweep in the form that suits its design.

    A field as `y` gives a band, a grid of one axis curves, of two axes a map; otherwise a scatter if `x` or `y` is
    given, else parallel coordinates.

    Parameters
    ----------
    data : SweepData
    x, y, colour : str, optional
        Arrays to show instead of the defaults.
    best : int, optional
        Variant to mark.

    Raises
    ------
    PictureError
        No such array, or nothing to show.
    """
    for name in (x, y, colour):
        if name is not None and data.shown(name)[0].ndim == 2 and name != y:
            raise PictureError(f"{name!r} is a field, which can only be y; give it by -y")
    with style.sheet(180, 110) as figure:
        _choose(figure, data, x, y, colour, best)
        if data.chosen_of:
            words = f"{data.status.size} of {data.chosen_of} variants (evenly sampled, with the best)"
            figure.suptitle(words, fontsize=7, color=GREY)
    return figure


def _choose(
    figure: Figure, data: SweepData, x: str | None, y: str | None, colour: str | None, best: int | None
) -> None:
    along, summaries = data.grid_parameters(), data.summaries
    if y is not None and np.ndim(data.arrays[y]) == 2:
        if x or colour:
            raise PictureError(f"{y!r} is a field, drawn over its own positions: omit -x and --colour")
        return field_band(figure.add_subplot(), data, y, best)
    if not summaries:
        raise PictureError("this result has no summaries; choose a field, or add summaries to the study")
    on_axes = {name for name in (x, y) if name is not None} <= set(along)
    if len(along) == 1 and x in (None, *along) and colour is None:
        shown = [y] if y else summaries[:4]
        figure.set_figheight(figure.get_figwidth() * (0.28 + 0.27 * len(shown)))
        return curves(figure, data, along[0], shown, best)
    if len(along) == 2 and on_axes:
        first = x or next(name for name in along if name != y)
        second = next(name for name in along if name != first)
        return map2d(figure.add_subplot(), data, first, second, colour or summaries[0], best)
    if x is None and y is None:
        colour = colour or summaries[0]
        names = chosen_columns(data, colour)
        # Room for slanted labels.
        figure.set_figheight(figure.get_figwidth() * (0.75 if len(names) > 6 else 0.61))
        return parallel(figure.add_subplot(), data, names, colour, best)
    others = [name for name in (*summaries, *data.varied) if name not in (x, y)]
    x, y = x or others[0], y or others[0]
    return scatter(figure.add_subplot(), data, x, y, colour, best)
