"""Sheet of a governor: what holds its balls, its engine's place in Vyshnegradsky's diagram, and a change of load."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import (
    Governor,
    GovernorCurves,
    LoadChange,
    StabilityPoint,
    Verdict,
    governor_curves,
    load_change,
    stability_point,
)
from sweeps.pictures.style import BLUE, GREEN, GREY, ORANGE, PALE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

RPM = 30 / math.pi
# Margins nearer to 0 than this are drawn as stable: the kernel of the sweep tells them apart, a line can't.
FLAT = 1e-12


def governor_sheet(
    governor: Governor, target: Path | str | Figure, title: str = "", cycle: np.ndarray | None = None
) -> Figure:
    """Controlling force and speed of a governor in equilibrium; with an engine, its stability and a change of load.

    Parameters
    ----------
    governor : governor element
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str
    cycle : ndarray, optional
        Of a governor of a mechanism, from `governed_scene`.

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    curve, point, change = governor_curves(governor), stability_point(governor), load_change(governor, cycle)
    rows = 1 + (point is not None or change is not None)
    with sheet(target, 180, 12 + 80 * rows) as figure:
        if curve.radius.size:
            axes = figure.subplots(rows, 2, squeeze=False, width_ratios=(1.15, 1))
            _characteristic(axes[0, 0], curve)
            _speeds(axes[0, 1], curve, governor.friction)
            figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
            if rows > 1:
                if point is None:
                    # A throttle that is either open or shut has no linear stability: time has all the room.
                    axes[1, 0].set_subplotspec(axes[1, 0].get_gridspec()[1, :])
                _change(axes[1, 0], change, governor)
                _diagram(axes[1, 1], point)
        words = [title] if title else []
        if curve.verdict != Verdict.OK:
            words.append(curve.verdict.sentence)
        figure.suptitle("\n".join(words), fontweight="bold" if len(words) < 2 else None, wrap=True)
    return figure


def _characteristic(ax: Axes, curve: GovernorCurves) -> None:
    """Controlling force of one ball, with lines of constant speed and the stops."""
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
    # Arms with mass bend the lines of constant speed: those go as far as arms reach, the others to the axis.
    mass = curve.force / (curve.radius * curve.speed**2)
    known = np.isfinite(mass)
    straight = np.ptp(mass[known]) <= 1e-9 * np.max(mass[known])
    along = np.array([0, right / to_radius]) if straight else curve.radius[known]
    whirling = np.full(along.size, np.mean(mass[known])) if straight else mass[known]
    speeds = {float(s) for s in (np.nanmin(inside), np.nanmax(inside)) if np.isfinite(s)}
    for speed, side in zip(sorted(speeds), ("top", "bottom"), strict=False):
        at, pull = to_radius * along, to_force * whirling * speed**2 * along
        ax.plot(at, pull, color=GREY, linewidth=0.7, linestyle=(0, (4, 3)))
        ax.annotate(
            f"{RPM * speed:.4g} rpm", (at[-1], pull[-1]), (2, 0), textcoords="offset points", fontsize=7, va=side
        )
    for k, stop in enumerate(curve.stops):
        ax.axvline(to_radius * stop, color="black", linewidth=0.9, label=None if k else "stops")
    ax.plot([], [], color=GREY, linewidth=0.7, linestyle=(0, (4, 3)), label="constant speed")
    if straight:
        ax.set(xlim=(0, 1.22 * right), ylim=(0, None))
    else:
        span = to_radius * np.ptp(along)
        ax.set(xlim=(to_radius * along[0] - 0.1 * span, to_radius * along[-1] + 0.4 * span))
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


def _diagram(ax: Axes, point: StabilityPoint | None) -> None:
    """Vyshnegradsky's diagram: where an engine with its governor hunts, oscillates or comes to rest without, and it."""
    if point is None:
        ax.set_axis_off()
        return
    top = max(6.0, 1.25 * point.x, 1.25 * point.y)
    x = np.linspace(top / 400, top, 400)
    ax.fill_between(x, 0, np.minimum(1 / x, top), color=VERMILION, alpha=0.18, linewidth=0, label="hunts")
    ax.plot(x, 1 / x, color=VERMILION)
    # Double roots −a, −a, −1/a²: X = 2a + 1/a², Y = a² + 2/a; the two branches meet at (3, 3).
    for a in (np.linspace(1, top, 400), np.linspace(1 / top, 1, 400)):
        ax.plot(2 * a + 1 / a**2, a**2 + 2 / a, color=BLUE)
    beyond, rim = np.linspace(3, top, 300), [np.full(300, top), np.full(300, 3.0)]
    for k, a in enumerate((np.geomspace(1, top, 2000), np.geomspace(1, 1 / top, 2000))):
        rim[k] = np.interp(beyond, 2 * a + 1 / a**2, a**2 + 2 / a)
    ax.fill_between(
        beyond, np.minimum(*rim), np.maximum(*rim), color=BLUE, alpha=0.12, linewidth=0, label="no oscillation"
    )
    ax.plot(point.x, point.y, "o", color="black", markersize=5, zorder=5)
    words = f"X Y = {point.x * point.y:.3g}"
    side = {"ha": "right", "xytext": (-6, 5)} if point.x > 0.6 * top else {"ha": "left", "xytext": (6, 5)}
    ax.annotate(words, (point.x, point.y), textcoords="offset points", fontsize=7.5, **side)
    ax.set(xlim=(0, top), ylim=(0, top), xlabel="X, damping", ylabel="Y, stiffness")
    ax.legend(loc="upper left" if point.x > point.y else "upper right")
    ax.set_title("Vyshnegradsky's diagram")


def _change(ax: Axes, change: LoadChange | None, governor: Governor) -> None:
    """Speed of the engine and lift of the sleeve after a change of load."""
    if change is None:
        ax.set_axis_off()
        return
    band, after = governor.engine.settling_band, RPM * change.after
    ax.axhspan(after * (1 - band), after * (1 + band), color=GREEN, alpha=0.15, linewidth=0, label="settled")
    ax.axhline(after, color=GREEN, linewidth=0.8)
    ax.plot(change.time, RPM * change.speed, color=BLUE, label="speed of the engine")
    ax.set(xlim=(0, change.time[-1]), xlabel="time after the change of load, s", ylabel="speed of the engine, rpm")
    lift, (factor, unit) = ax.twinx(), engineer_unit("m", change.lift)
    lift.plot(change.time, factor * change.lift, color=ORANGE, linewidth=1.0)
    ax.plot([], [], color=ORANGE, linewidth=1.0, label="lift of the sleeve")
    lift.set_ylabel(f"lift of the sleeve, {unit}")
    lift.grid(visible=False)
    ax.legend(loc="best")
    factor, unit = engineer_unit("N m", np.array([governor.engine.load, governor.engine.new_load]))
    loads = [f"{factor * load:.4g}" for load in (governor.engine.load, governor.engine.new_load)]
    ax.set_title(f"Load from {loads[0]} to {loads[1]} {unit}")
