"""Force polygon: the closed polygon of all forces on a group or link, with inertia forces."""

from collections.abc import Sequence
from itertools import accumulate

import numpy as np
from matplotlib.axes import Axes

from engine import display_unit
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.plans.forces.loads import DrawnLoad, group_loads, loads_on_links
from sweeps.pictures.plans.lettering import size_text
from sweeps.pictures.plans.paper import Paper
from sweeps.pictures.plans.pose import Pose
from sweeps.pictures.style import BLUE, GREEN, ORANGE, PURPLE, VERMILION

# By the letter of the force: reaction, weight, inertia force, force of the scene.
COLOURS = {"R": BLUE, "G": GREEN, "U": ORANGE, "F": VERMILION, "M": VERMILION}


def colour_of(load: DrawnLoad) -> str:
    """Colour of a force or moment, by kind."""
    return PURPLE if load.is_friction else COLOURS[load.text[1]]


def force_polygon(pose: Pose, of: str) -> list[DrawnLoad]:
    """Forces on a group (without its inner pair) or on a link, in polygon order.

    Parameters
    ----------
    pose : Pose
    of : str
        A group or a moving link.

    Returns
    -------
    list of DrawnLoad
        Known forces first, reactions last; they sum to zero within rounding.

    Raises
    ------
    PictureError
        Forces are undefined at this position.
    """
    if of in pose.motion.groups:
        loads = group_loads(pose, of)
    else:
        forces = [load for load in loads_on_links(pose)[of] if not load.is_moment]
        loads = sorted(forces, key=lambda load: load.pair != "")
    if not np.isfinite([load.force for load in loads]).all():
        raise PictureError(f"force plan of {of}: forces are undefined at {pose.title}; choose another position")
    return loads


def force_plan(pose: Pose, of: str, ax: Axes) -> list[DrawnLoad]:
    """Draw the force plan of a group or a link.

    Parameters
    ----------
    pose : Pose
    of : str
        A group or a moving link.
    ax : matplotlib.axes.Axes
        In their final size on paper, which the scale μ refers to.

    Returns
    -------
    list of DrawnLoad
        The sides of the polygon.
    """
    loads = force_polygon(pose, of)
    if not loads:
        ax.set_axis_off()
        ax.text(0.5, 0.5, "no forces", ha="center", va="center", transform=ax.transAxes)
        return loads
    factor, unit = display_unit("N", np.array([abs(load.force) for load in loads]))
    sides = [factor * load.force for load in loads]
    corners = list(accumulate(sides, initial=0j))
    paper = Paper(ax, corners)
    for start, side, load in zip(corners, sides, loads, strict=False):
        paper.arrow(start, side, load.text, colour_of(load))
    paper.letter()
    paper.scale_of("F", unit)
    return loads


def force_lines(loads: Sequence[DrawnLoad]) -> list[str]:
    """Values of forces and moments by line: magnitude, direction, friction circle."""
    found = []
    for load in loads:
        size = size_text(load.moment, "N m") if load.is_moment else size_text(abs(load.force), "N")
        text = f"{load.text} = {size}".replace("-", "\N{MINUS SIGN}")
        turned = "" if load.is_moment else f" ∠ {round(np.degrees(np.angle(load.force)), 1) % 360:.1f}°"
        found.append(text + turned)
        if load.rho:
            circle = load.text.replace("$R", r"$\rho")
            found.append(f"{circle} = {size_text(load.rho, 'm')}")
    return found
