"""A chain on its sprockets, to scale."""

import math

import numpy as np
from matplotlib.axes import Axes

from engine import ChainDrive
from sweeps.pictures.style import BLUE, GREY, ORANGE, VERMILION
from sweeps.text.engineer_units import engineer_unit

PLACES = 241


def chain_layout(ax: Axes, drive: ChainDrive) -> None:
    """Both pitch circles with the chain round them; without a distance of the axes as far apart as both diameters."""
    own = drive.own_values()
    radii = [0.5 * own["driving_diameter"], 0.5 * own["driven_diameter"]]
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
