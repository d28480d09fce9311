"""Bearing load over the cycle: polar diagrams in frame and link axes, load by direction."""

import math
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from matplotlib.projections.polar import PolarAxes
from matplotlib.ticker import MaxNLocator

from engine import FRAME, CrankInput, Pair, did_you_mean, display_unit, full_names, quantity_text
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.machine.cycle_rows import closed
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.plans.lettering import size_text
from sweeps.pictures.plans.reaction_curves import reaction_panel
from sweeps.pictures.style import BLUE, GREY, SKY, VERMILION, sheet, titled

# Directions of the load, every degree; arc about each over which the load is summed [rad].
DIRECTIONS, WIDTH = np.radians(np.arange(360)), math.radians(10)
# Distance of edges from whole degrees [rad].
EDGE = 1e-6
# Arc over which the load is lowest, for the oil hole [rad].
SPAN = math.radians(120)
# Size of letters at marks, as x + iy, and minimum distance of marks, as shares of the peak load.
LETTERS, DOT = 0.34 + 0.11j, 0.03


class BearingLoad(NamedTuple):
    """Load of a revolute pair over the cycle, in the axes of one link.

    Attributes
    ----------
    motion : DrawnMotion
    pair : Pair
    axes : str
        Link that defines the axes.
    on : str
        Link that it acts on.
    force : complex ndarray (positions,)
        x + iy [N].
    """

    motion: DrawnMotion
    pair: Pair
    axes: str
    on: str
    force: np.ndarray

    @property
    def peak(self) -> int:
        """Index of the peak load."""
        return int(np.nanargmax(np.abs(self.force)))


def loaded_bearings(motion: DrawnMotion) -> dict[str, float]:
    """The loaded revolute pairs of a machine, each with the peak of its reaction as drawn [N]."""
    names = [name for name, pair in motion.pairs.items() if pair.kind == "revolute"]
    peaks = {name: float(np.nanmax(np.abs(motion.force(f"{name}.reaction")))) for name in names}
    return {name: peak for name, peak in peaks.items() if peak > 0}


def bearing_load(motion: DrawnMotion, pair: str, axes: str = FRAME) -> BearingLoad:
    """Bearing load in the axes of a link, as the force on that link; in frame axes, as the force on the moving link.

    Parameters
    ----------
    motion : DrawnMotion
    pair : str
        A revolute pair: `input`, `GROUP.first`, `GROUP.inner`, `GROUP.second`, a shaft, or the letter of its joint.
    axes : str
        The frame or one of the two links.

    Raises
    ------
    PictureError
        No such pair, or it isn't revolute or loaded.
    """
    known = {name: p for name, p in motion.pairs.items() if p.kind == "revolute"}
    pair = full_names(motion.scene, f"{pair.removesuffix('.reaction')}.reaction").removesuffix(".reaction")
    if pair not in known:
        raise PictureError(f"bearing load: {pair!r} is not a revolute pair of this scene; {did_you_mean(pair, known)}")
    found = known[pair]
    force = motion.force(f"{pair}.reaction")
    if not np.nanmax(np.abs(force)) > 0:
        raise PictureError(f"bearing load: {pair} is unloaded; give the machine masses, forces or gravity")
    on = found.other if axes == found.other != FRAME else found.link
    sign = 1 if on == found.link else -1
    return BearingLoad(motion, found, axes, on, sign * force * motion.axes[axes][1].conj())


def shares(load: BearingLoad, width: float = WIDTH) -> np.ndarray:
    """Share of the load over the cycle within `width` [rad] about each degree, (360,)."""
    force = load.force[np.isfinite(load.force)]
    force = force[np.argsort(np.angle(force))]
    angle, size = np.angle(force), np.abs(force)
    angles = np.concatenate([angle - math.tau, angle, angle + math.tau])
    sums = np.cumsum([0.0, *size, *size, *size])
    # Loads that lie at a whole degree but for rounding are not at an edge.
    low, high = (sums[np.searchsorted(angles, DIRECTIONS + side * width / 2 - EDGE)] for side in (-1, 1))
    return (high - low) / size.sum()


def least_loaded(load: BearingLoad) -> float:
    """Direction of the lowest load summed over `SPAN` [rad]; the middle one of several."""
    around = shares(load, SPAN)
    least = around <= around.min() + 1e-12
    # Ties: the middle of the longest run around the circle.
    longest, middle = 0, 0.0
    for first in np.flatnonzero(least & ~np.roll(least, 1)) if not least.all() else [0]:
        run = next((n for n in range(least.size) if not least[(first + n) % least.size]), least.size)
        if run > longest:
            longest, middle = run, first + (run - 1) / 2
    return math.radians(middle % least.size)


def load_polar(load: BearingLoad, ax: PolarAxes) -> None:
    """Draw a polar load diagram, marked every 30° of the crank and at the peak.

    Parameters
    ----------
    load : BearingLoad
    ax : PolarAxes
        Made with projection="polar".
    """
    factor, unit = display_unit("N", np.abs(load.force))
    z = factor * closed(load.motion.scene, load.force)
    q, turns = load.motion.q, isinstance(load.motion.scene.input, CrankInput)
    ax.plot(np.angle(z), np.abs(z), color=BLUE, linewidth=1.1)
    every = max(1, round(math.pi / 6 / (q[1] - q[0])) if turns else q.size // 12)
    top = factor * np.nanmax(np.abs(load.force))
    marked = lettered = np.empty(0, complex)
    for k in range(0, load.force.size, every):
        end = factor * load.force[k]
        if not np.isfinite(end) or (np.abs(marked - end) < DOT * top).any():
            continue
        marked = np.append(marked, end)
        ax.plot(np.angle(end), abs(end), "o", color=BLUE, markersize=2.5)
        # Towards the middle, where no angle is written.
        ha, side = ("left", 1) if end.real <= 0 else ("right", -1)
        middle = end + side * LETTERS.real / 2 * top
        apart = lettered - middle
        if not ((np.abs(apart.real) < LETTERS.real * top) & (np.abs(apart.imag) < LETTERS.imag * top)).any():
            lettered = np.append(lettered, middle)
            text = f"φ {np.degrees(q[k]):.0f}°" if turns else quantity_text(float(q[k]), "m")
            at = (np.angle(end), abs(end))
            ax.annotate(text, at, (4 * side, 2), textcoords="offset points", fontsize=6, ha=ha)
    star = factor * load.force[load.peak]
    ax.plot(np.angle(star), abs(star), "*", color=VERMILION, markersize=7)
    _axes(ax, unit, z)
    whose = "frame axes" if load.axes == FRAME else f"axes of {load.axes}"
    peak = size_text(load.motion.peak_force(load.pair.name), "N")
    ax.set_title(f"on {load.on}, {whose}\npeak {peak}", fontsize=7.5, pad=8)


def load_rose(load: BearingLoad, ax: PolarAxes) -> None:
    """Draw the load by direction and the least loaded direction; arguments as for `load_polar`."""
    # Averaged over neighbours: the nodes of the cycle would show as teeth.
    share = 100 * np.mean([np.roll(shares(load), shift) for shift in range(-4, 5)], axis=0)
    ax.fill(DIRECTIONS, share, color=SKY, linewidth=0)
    free = least_loaded(load)
    ax.plot([free, free], [0, share.max()], color=VERMILION, linewidth=1.2, linestyle=(0, (4, 2)))
    _axes(ax, "%", np.append(share * np.exp(1j * DIRECTIONS), share.max() * np.exp(1j * free)))
    words = f"load on {load.on} within {math.degrees(WIDTH):.0f}° by direction"
    ax.set_title(f"{words}\nminimum at {np.degrees(free):.0f}°", fontsize=7.5, pad=8)


def _axes(ax: PolarAxes, unit: str, drawn: np.ndarray) -> None:
    """Place the angle labels, and the radius labels in the clearest gap."""
    ax.set_thetagrids(np.arange(0, 360, 30))
    ax.yaxis.set_major_locator(MaxNLocator(4))
    ax.tick_params(labelsize=6, pad=1, labelcolor=GREY)
    ax.tick_params(axis="y", labelcolor="black")
    between = np.radians(np.arange(15, 360, 30))
    reach = [np.nanmax((drawn * np.exp(-1j * way)).real, where=np.isfinite(drawn), initial=0.0) for way in between]
    ax.set_rlabel_position(float(np.degrees(between[np.argmin(reach)])))
    ax.set_ylim(0, None)
    ax.text(1.0, 0.0, unit, transform=ax.transAxes, fontsize=7)


def bearing_sheet(motion: DrawnMotion, pair: str) -> Figure:
    """Sheet of a bearing load, 180 mm wide: polar diagrams in all axes, load by direction.

    Parameters
    ----------
    motion : DrawnMotion
    pair : str
        A revolute pair.
    """
    frame, scene = bearing_load(motion, pair), motion.scene
    own, other = bearing_load(motion, pair, frame.pair.link), frame.pair.other
    words = f"load of {pair} ({frame.pair.place})"
    with sheet(180, 185, titled(scene.title, words)) as figure:
        for number, draw, load in ((1, load_polar, frame), (2, load_polar, own), (4, load_rose, own)):
            draw(load, figure.add_subplot(2, 2, number, projection="polar"))
        if other == FRAME:
            reaction_panel(motion, frame.pair, figure.add_subplot(2, 2, 3))
        else:
            load_polar(bearing_load(motion, pair, other), figure.add_subplot(2, 2, 3, projection="polar"))
        note = (
            "Marks: input position. Link axes: 0° along the link's x axis. A journal bears on the side opposite "
            "to its load,\na bush on the side that its load points to."
        )
        figure.supxlabel(note, fontsize=6.5, x=0.01, ha="left")
    return figure
