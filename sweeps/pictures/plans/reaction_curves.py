"""Reactions of all pairs over the cycle."""

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import CrankInput, Pair, pairs_of
from sweeps.pictures.plans.pose import MachineCycle
from sweeps.pictures.style import BLUE, GREEN, ORANGE, PURPLE, house_style, new_figure
from sweeps.text.engineer_units import engineer_unit

COLUMNS = 3
# Smaller shares of the greatest reaction are rounding.
NOTHING = 1e-9


def reaction_panel(cycle: MachineCycle, pair: Pair, ax: Axes) -> None:
    """Draw the reaction of a pair over the cycle: magnitude and components, with the moment in a prismatic one.

    Parameters
    ----------
    cycle : MachineCycle
    pair : Pair
    ax : matplotlib.axes.Axes
    """
    force = cycle.force(f"{pair.name}.reaction")
    factor, unit = engineer_unit("N", np.abs(force))
    q, label = _abscissa(cycle)
    ax.plot(q, factor * _closed(cycle, np.abs(force)), color=BLUE, label="R")
    ax.plot(q, factor * _closed(cycle, force.real), color=ORANGE, linewidth=0.8, label="$R_x$")
    ax.plot(q, factor * _closed(cycle, force.imag), color=GREEN, linewidth=0.8, label="$R_y$")
    peak = int(np.nanargmax(np.abs(force)))
    ax.set(xlabel=label, ylabel=f"R, {unit}", xlim=(q[0], q[-1]))
    what = f"{pair.name}: {pair.other} on {pair.link}"
    ax.set_title(f"{what}\npeak {factor * abs(force[peak]):.4g} {unit}", fontsize=7.5)
    if cycle.is_closed:
        ax.set_xticks(np.linspace(0, q[-1], 5))
    if pair.kind == "prismatic":
        _moment(cycle, pair, ax, q, force)


def _moment(cycle: MachineCycle, pair: Pair, ax: Axes, q: np.ndarray, force: np.ndarray) -> None:
    """The moment of a prismatic pair against an axis of its own, where there is one."""
    moment = cycle.forces[f"{pair.name}.reaction_moment"]
    if not np.nanmax(np.abs(moment)) > NOTHING * np.nanmax(np.abs(force)) * cycle.motion.radius:
        return
    factor, unit = engineer_unit("N m", moment)
    right = ax.twinx()
    right.grid(False)
    right.plot(q, factor * _closed(cycle, moment), color=PURPLE, linewidth=0.8, linestyle=(0, (4, 2)))
    right.set_ylabel(f"moment, {unit} (dashed)", color=PURPLE, fontsize=7)


def _closed(cycle: MachineCycle, row: np.ndarray) -> np.ndarray:
    return np.append(row, row[:1]) if cycle.is_closed else row


def _abscissa(cycle: MachineCycle) -> tuple[np.ndarray, str]:
    q = cycle.motion.q
    if isinstance(cycle.scene.input, CrankInput):
        q = np.degrees(np.append(q, 2 * q[-1] - q[-2]) if cycle.is_closed else q)
        return q, "crank angle φ, °"
    factor, unit = engineer_unit("m", q)
    return factor * q, f"displacement q, {unit}"


def reaction_sheet(cycle: MachineCycle) -> Figure:
    """Sheet of the reactions of all pairs over the cycle and of the input moment, 180 mm wide."""
    shown = pairs_of(cycle.scene)
    rows = math.ceil((len(shown) + 1) / COLUMNS)
    with house_style():
        figure = new_figure(180, 12 + 56 * rows)
        axes = figure.subplots(rows, COLUMNS, squeeze=False).ravel()
        for ax, pair in zip(axes, shown, strict=False):
            reaction_panel(cycle, pair, ax)
        _input_panel(cycle, axes[len(shown)])
        for ax in axes[len(shown) + 1 :]:
            ax.set_axis_off()
        figure.legend(*axes[0].get_legend_handles_labels(), loc="outside lower right", ncols=3)
        if cycle.scene.title:
            figure.suptitle(f"{cycle.scene.title}: reactions at uniform speed", fontweight="bold")
    return figure


def _input_panel(cycle: MachineCycle, ax: Axes) -> None:
    row, crank = cycle.forces["input_moment_by_equilibrium"], isinstance(cycle.scene.input, CrankInput)
    factor, unit = engineer_unit("N m" if crank else "N", row)
    q, label = _abscissa(cycle)
    ax.plot(q, factor * _closed(cycle, row), color=BLUE)
    letter = "M" if crank else "F"
    ax.set(xlabel=label, ylabel=rf"${letter}_\mathrm{{in}}$, {unit}", xlim=(q[0], q[-1]))
    ax.set_title("input moment\nby equilibrium" if crank else "input force\nby equilibrium", fontsize=7.5)
    if cycle.is_closed:
        ax.set_xticks(np.linspace(0, q[-1], 5))
