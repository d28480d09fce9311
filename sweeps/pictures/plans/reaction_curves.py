"""Reactions of all pairs over the cycle."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import InputUnits, Pair, display_unit, drive_words, pairs_of
from sweeps.pictures.machine.diagrams import input_axis
from sweeps.pictures.plans.pose import MachineCycle
from sweeps.pictures.plans.sheets import blank_sheet, heading, place
from sweeps.pictures.style import BLUE, GREEN, ORANGE, PURPLE, house_style, typeset

COLUMNS = 3
# Sizes on paper [mm]: a panel with its labels, and its left, right, lower and upper margins.
PANEL_WIDTH, PANEL_HEIGHT = 59.0, 56.0
LEFT, RIGHT, BELOW, ABOVE = 15.0, 4.0, 11.0, 10.0
# Right margin of a panel with moments.
OF_MOMENTS = 14.0
# Reactions below this share of the maximum are rounding.
NOTHING = 1e-9


def reaction_panel(cycle: MachineCycle, pair: Pair, ax: Axes) -> None:
    """Draw the reaction of a pair over the cycle: magnitude, components, and the moment of a prismatic pair.

    Parameters
    ----------
    cycle : MachineCycle
    pair : Pair
    ax : matplotlib.axes.Axes
    """
    force = cycle.force(f"{pair.name}.reaction")
    factor, unit = display_unit("N", np.abs(force))
    q, label = _abscissa(cycle)
    ax.plot(q, factor * _closed(cycle, np.abs(force)), color=BLUE, label="R")
    ax.plot(q, factor * _closed(cycle, force.real), color=ORANGE, linewidth=0.8, label="$R_x$")
    ax.plot(q, factor * _closed(cycle, force.imag), color=GREEN, linewidth=0.8, label="$R_y$")
    ax.set(xlabel=label, ylabel=f"R, {unit}", xlim=(q[0], q[-1]))
    what = f"{pair.name}: {pair.other} on {pair.link}"
    ax.set_title(f"{what}\npeak {factor * cycle.peak_force(pair.name):.4g} {unit}", fontsize=7.5)
    if cycle.is_closed:
        ax.set_xticks(np.linspace(0, q[-1], 5))
    if _bears_moment(cycle, pair):
        _moment(cycle, pair, ax, q)


def _bears_moment(cycle: MachineCycle, pair: Pair) -> bool:
    if pair.kind != "prismatic":
        return False
    moment, force = cycle.forces[f"{pair.name}.reaction_moment"], cycle.force(f"{pair.name}.reaction")
    return bool(np.nanmax(np.abs(moment)) > NOTHING * np.nanmax(np.abs(force)) * cycle.motion.radius)


def _moment(cycle: MachineCycle, pair: Pair, ax: Axes, q: np.ndarray) -> None:
    """Draw the moment of a prismatic pair on a second axis."""
    moment = cycle.forces[f"{pair.name}.reaction_moment"]
    factor, unit = display_unit("N m", moment)
    right = ax.twinx()
    right.grid(False)
    right.plot(q, factor * _closed(cycle, moment), color=PURPLE, linewidth=0.8, linestyle=(0, (4, 2)))
    right.set_ylabel(f"moment, {unit} (dashed)", color=PURPLE, fontsize=7)


def _closed(cycle: MachineCycle, row: np.ndarray) -> np.ndarray:
    return np.append(row, row[:1]) if cycle.is_closed else row


def _abscissa(cycle: MachineCycle) -> tuple[np.ndarray, str]:
    q = cycle.motion.q
    label, factor = input_axis(cycle.scene, q)
    return factor * (np.append(q, 2 * q[-1] - q[-2]) if cycle.is_closed else q), label


def reaction_sheet(cycle: MachineCycle) -> Figure:
    """Sheet of all pair reactions and the drive torque over the cycle, 180 mm wide."""
    shown = pairs_of(cycle.scene)
    rows = math.ceil((len(shown) + 1) / COLUMNS)
    right = OF_MOMENTS if any(_bears_moment(cycle, pair) for pair in shown) else RIGHT
    with house_style():
        figure = blank_sheet(180, 16 + PANEL_HEIGHT * rows)
        heading(figure, cycle.scene, "reactions at constant speed")
        axes = []
        for i in range(len(shown) + 1):
            row, column = divmod(i, COLUMNS)
            left, bottom = 2 + PANEL_WIDTH * column + LEFT, 6 + PANEL_HEIGHT * (rows - 1 - row) + BELOW
            axes.append(place(figure, left, bottom, PANEL_WIDTH - LEFT - right, PANEL_HEIGHT - BELOW - ABOVE))
        for ax, pair in zip(axes, shown, strict=False):
            reaction_panel(cycle, pair, ax)
        _input_panel(cycle, axes[-1])
        figure.legend(*axes[0].get_legend_handles_labels(), loc="lower right", ncols=3)
    return figure


def _input_panel(cycle: MachineCycle, ax: Axes) -> None:
    row, units = cycle.forces["input_moment_by_equilibrium"], InputUnits.of(cycle.scene)
    factor, unit = display_unit(units.moment, row)
    q, label = _abscissa(cycle)
    ax.plot(q, factor * _closed(cycle, row), color=BLUE)
    ax.set(xlabel=label, ylabel=f"{typeset(f'{units.symbols[2]}_in')}, {unit}", xlim=(q[0], q[-1]))
    ax.set_title(drive_words(cycle.scene).replace(" for", "\nfor"), fontsize=7.5)
    if cycle.is_closed:
        ax.set_xticks(np.linspace(0, q[-1], 5))
