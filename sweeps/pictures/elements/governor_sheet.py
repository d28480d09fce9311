"""Sheet of a governor: what holds its balls, its engine's place in Vyshnegradsky's diagram, and a change of load."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import SENTENCES, AnyGovernor, GovernorCurves, Verdict, governor_curves
from sweeps.pictures.style import BLUE, GREEN, GREY, PALE, VERMILION, house_style, new_figure, save
from sweeps.text.engineer_units import engineer_unit

RPM = 30 / math.pi
# Margins nearer to 0 than this are drawn as stable: the kernel of the sweep tells them apart, a line can't.
FLAT = 1e-12


def governor_sheet(governor: AnyGovernor, target: Path | str | Figure, title: str = "") -> Figure:
    """Controlling force over the radius and speed over the lift of a governor, stretches and stops marked.

    Parameters
    ----------
    governor : governor element
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    curve = governor_curves(governor)
    with house_style():
        figure = target if isinstance(target, Figure) else new_figure(180, 92)
        if curve.radius.size:
            force, speed = figure.subplots(1, 2, width_ratios=(1.15, 1))
            _characteristic(force, curve)
            _speeds(speed, curve, governor.friction)
            figure.legend(*force.get_legend_handles_labels(), loc="outside lower center", ncols=4)
        words = [title] if title else []
        if curve.verdict != Verdict.OK:
            words.append(SENTENCES[curve.verdict])
        figure.suptitle("\n".join(words), fontweight="bold" if len(words) < 2 else None, wrap=True)
    if not isinstance(target, Figure):
        save(figure, target)
    return figure


def _characteristic(ax: Axes, curve: GovernorCurves) -> None:
    """Controlling force of one ball, with rays of constant speed and the stops."""
    to_radius, radius_unit = engineer_unit("m", curve.radius)
    to_force, force_unit = engineer_unit("N", curve.force[curve.between])
    r, f = to_radius * curve.radius, to_force * curve.force
    stable = curve.margin >= -FLAT
    ax.plot(r, f, color=PALE, linewidth=1.0)
    for chosen, colour, label in ((stable, BLUE, "stable"), (~stable, VERMILION, "unstable")):
        if (chosen & curve.between).any():
            ax.plot(r, np.where(chosen & curve.between, f, np.nan), color=colour, linewidth=1.8, label=label)
    inside = curve.speed[curve.between]
    right = to_radius * (curve.stops[1] + 0.3 * (curve.stops[1] - curve.stops[0]))
    speeds = {float(s) for s in (np.nanmin(inside), np.nanmax(inside)) if np.isfinite(s)}
    at_stops = curve.force[curve.between][[0, -1]] / curve.radius[curve.between][[0, -1]]
    mass = float(at_stops[0] / inside[0] ** 2)
    for speed, side in zip(sorted(speeds), ("top", "bottom"), strict=False):
        top = to_force * mass * speed**2 * right / to_radius
        ax.plot([0, right], [0, top], color=GREY, linewidth=0.7, linestyle=(0, (4, 3)))
        ax.annotate(f"{RPM * speed:.4g} rpm", (right, top), (2, 0), textcoords="offset points", fontsize=7, va=side)
    for k, stop in enumerate(curve.stops):
        ax.axvline(to_radius * stop, color="black", linewidth=0.9, label=None if k else "stops")
    ax.plot([], [], color=GREY, linewidth=0.7, linestyle=(0, (4, 3)), label="constant speed")
    ax.set(xlim=(0, 1.22 * right), ylim=(0, None))
    ax.set(xlabel=f"radius of the balls, {radius_unit}", ylabel=f"controlling force of one ball, {force_unit}")
    ax.set_title("Controlling force")


def _speeds(ax: Axes, curve: GovernorCurves, friction: float) -> None:
    """Speed of the spindle over the lift, with the band in which friction holds the sleeve."""
    chosen = curve.between
    factor, unit = engineer_unit("m", curve.lift[chosen])
    z, speed = factor * curve.lift[chosen], RPM * curve.speed[chosen]
    if friction > 0:
        share = np.minimum(friction / curve.sleeve[chosen], 1.0)
        ax.fill_between(
            z, speed * np.sqrt(1 - share), speed * np.sqrt(1 + share), color=GREEN, alpha=0.25, linewidth=0,
            label="held by friction",
        )  # fmt: skip
        ax.legend(loc="best")
    stable = curve.margin[chosen] >= -FLAT
    for part, colour in ((stable, BLUE), (~stable, VERMILION)):
        ax.plot(z, np.where(part, speed, np.nan), color=colour, linewidth=1.8)
    ax.set(xlabel=f"lift of the sleeve, {unit}", ylabel="speed of the spindle, rpm")
    ax.set_title("Speed in equilibrium")
