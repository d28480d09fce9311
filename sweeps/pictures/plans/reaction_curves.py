"""Reactions of all pairs over the cycle."""

import math

import numpy as np
from matplotlib.artist import setp
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import Curve, InputUnits, Pair, PanelAxis, display_unit, drive_words
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.machine.cycle_rows import closed, panel_over_cycle
from sweeps.pictures.panels import draw_panel
from sweeps.pictures.plans.lettering import size_text
from sweeps.pictures.style import PURPLE, legend_below, sheet, titled

# Panels side by side, and the height of each [mm].
COLUMNS, HEIGHT = 3, 56
# Reactions below this share of the maximum are rounding.
NOTHING = 1e-9


def reaction_panel(motion: DrawnMotion, pair: Pair, ax: Axes, with_legend: bool = True) -> None:
    """Draw the reaction of a pair over the cycle: magnitude, components, and the moment of a prismatic pair.

    Parameters
    ----------
    motion : DrawnMotion
    pair : Pair
    ax : matplotlib.axes.Axes
    with_legend : bool
    """
    force = closed(motion.scene, motion.force(f"{pair.name}.reaction"))
    curves = [Curve("R", np.abs(force)), Curve("$R_x$", force.real), Curve("$R_y$", force.imag)]
    title = f"{pair.name}: {pair.other} on {pair.link}\npeak {size_text(motion.peak_force(pair.name), 'N')}"
    _draw(motion, ax, PanelAxis("", "N", "R"), curves, title, with_legend)
    # Where a component is the whole reaction, both are seen.
    setp(ax.lines[1:], linewidth=0.8)
    if _bears_moment(motion, pair):
        _moment(motion, pair, ax)


def _draw(
    motion: DrawnMotion, ax: Axes, axis: PanelAxis, curves: list[Curve], title: str, with_legend: bool = False
) -> None:
    draw_panel(ax, panel_over_cycle(motion.machine, axis, curves, title=title), with_legend=with_legend)
    ax.title.set_fontsize(7.5)
    if motion.scene.has_cycle:
        ax.set_xticks(np.linspace(*ax.get_xlim(), 5))


def _bears_moment(motion: DrawnMotion, pair: Pair) -> bool:
    if pair.kind != "prismatic":
        return False
    moment, force = motion.forces[f"{pair.name}.reaction_moment"], motion.force(f"{pair.name}.reaction")
    return bool(np.nanmax(np.abs(moment)) > NOTHING * np.nanmax(np.abs(force)) * motion.radius)


def _moment(motion: DrawnMotion, pair: Pair, ax: Axes) -> None:
    """Draw the moment of a prismatic pair on a second axis."""
    moment = closed(motion.scene, motion.forces[f"{pair.name}.reaction_moment"])
    factor, unit = display_unit("N m", moment)
    right = ax.twinx()
    right.grid(False)
    look = {"color": PURPLE, "linewidth": 0.8, "linestyle": (0, (4, 2))}
    right.plot(ax.lines[0].get_xdata(), factor * moment, **look)
    right.set_ylabel(f"moment, {unit} (dashed)", color=PURPLE, fontsize=7)


def reaction_sheet(motion: DrawnMotion) -> Figure:
    """Sheet of all pair reactions and the drive torque over the cycle, 180 mm wide."""
    scene, shown = motion.scene, motion.pairs.values()
    rows = math.ceil((len(shown) + 1) / COLUMNS)
    with sheet(180, 16 + HEIGHT * rows, titled(scene.title, "reactions at constant speed")) as figure:
        axes = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
        for ax in axes[len(shown) + 1 :]:
            ax.remove()
        for ax, pair in zip(axes, shown, strict=False):
            reaction_panel(motion, pair, ax, with_legend=False)
        units, moment = InputUnits.of(scene), closed(scene, motion.forces["input_moment_by_equilibrium"])
        axis = PanelAxis("", units.moment, f"{units.symbols[2]}_in")
        _draw(motion, axes[len(shown)], axis, [Curve("", moment)], drive_words(scene).replace(" for", "\nfor"))
        legend_below(figure, axes[:1], 3)
    return figure
