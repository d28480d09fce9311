"""Sheet of a chain drive: the chain on its sprockets to scale, and its speed while a link comes on."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import ChainDrive
from sweeps.pictures.style import BLUE, GREY, ORANGE, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

PLACES = 241
# Links that come on while the speed is drawn.
LINKS = 3


def chain_sheet(drive: ChainDrive, target: Path | str | Figure, title: str = "") -> Figure:
    """Draw both pitch circles with the chain round them, and the speed of the chain over the driving sprocket's angle.

    Without a distance of the axes they are drawn as far apart as the diameters of both.

    Parameters
    ----------
    drive : ChainDrive
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    with sheet(target, 180, 75, title) as figure:
        layout, speed = figure.subplots(1, 2, width_ratios=(1.4, 1.0))
        _layout(layout, drive)
        _speed(speed, drive)
    return figure


def _radius(drive: ChainDrive, teeth: float) -> float:
    return 0.5 * drive.pitch / math.sin(math.pi / teeth)


def _layout(ax: Axes, drive: ChainDrive) -> None:
    radii = [_radius(drive, teeth) for teeth in (drive.driving_teeth, drive.driven_teeth)]
    distance = 2.0 * sum(radii) if drive.distance is None else drive.distance
    factor, unit = engineer_unit("m", np.array([distance]))
    centres = (0.0, distance)
    # Both strands touch the circles where a radius stands square to them.
    lean = math.acos(max(-1.0, min(1.0, (radii[0] - radii[1]) / distance)))
    arcs = (np.linspace(lean, math.tau - lean, PLACES), np.linspace(-lean, lean, PLACES))
    chain = np.concatenate([c + r * np.exp(1j * arc) for c, r, arc in zip(centres, radii, arcs, strict=True)])
    chain = factor * np.append(chain, chain[0])
    ax.plot(chain.real, chain.imag, color=BLUE)
    colours = (ORANGE, GREY)
    for centre, radius, teeth, colour in zip(
        centres, radii, (drive.driving_teeth, drive.driven_teeth), colours, strict=True
    ):
        joints = centre + radius * np.exp(1j * math.tau * np.arange(round(teeth) + 1) / teeth)
        ax.plot(factor * joints.real, factor * joints.imag, color=colour, linewidth=0.9)
        ax.plot(factor * centre, 0.0, "o", color="black", markersize=4)
        turning = "↺" if drive.speed > 0 else "↻"
        words = f"z = {teeth:g} {turning}", (factor * centre, -factor * radius), (0, -4)
        ax.annotate(*words, textcoords="offset points", ha="center", va="top")
    way = 1.0 if drive.speed > 0 else -1.0
    # The driving sprocket draws the strand in on the side that moves towards it.
    tight = np.exp(1j * way * lean)
    ends = [factor * (c + r * tight) for c, r in zip(centres, radii, strict=True)]
    ax.plot([e.real for e in ends], [e.imag for e in ends], color=VERMILION, linewidth=1.8, label="tight strand")
    ax.set(aspect="equal", adjustable="datalim", xlabel=f"x, {unit}", ylabel=f"y, {unit}")
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0))


def _speed(ax: Axes, drive: ChainDrive) -> None:
    """Speed ω R cos β of the joint that carries the strand, within half a pitch angle of the tangent point."""
    pitch_angle = math.tau / drive.driving_teeth
    angle = np.linspace(0.0, LINKS * pitch_angle, LINKS * PLACES)
    from_tangent = np.mod(angle, pitch_angle) - 0.5 * pitch_angle
    greatest = abs(drive.speed) * _radius(drive, drive.driving_teeth)
    mean = abs(drive.speed) * drive.driving_teeth * drive.pitch / math.tau
    ax.plot(np.degrees(angle), greatest * np.cos(from_tangent), color=BLUE)
    ax.axhline(mean, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="mean")
    ax.set(
        xlabel="angle of the driving sprocket, °", ylabel="speed of the chain, m/s", xlim=(0, math.degrees(angle[-1]))
    )
    ax.legend(loc="best")
