"""Single bodies to be looked at: tilted, sliding out on a turning lever, on an elastic tie."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from engine import RotatingGuide, TetheredBody, TiltedBody, body_ellipsoid, slides_out
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

PLACES = 721
# Stretches of the lever, in time alike, at which it is drawn.
LEVERS = 8
CENTRE_LINE = (0, (12, 3, 2, 3))


def lever_layout(ax: Axes, element: RotatingGuide) -> None:
    """The body's path, the lever on the way, and the velocity with which the body leaves it."""
    time = np.linspace(0.0, element.own_values()["time"], PLACES)
    motion = element.speed, element.start_radius, element.start_velocity, element.friction
    radius, rate = slides_out(*(np.full(time.shape, value) for value in motion), time)
    factor, unit = engineer_unit("m", np.array([element.length]))
    angle = element.speed * time
    for k in np.linspace(0, PLACES - 1, LEVERS).astype(int):
        tip = factor * element.length * np.exp(1j * angle[k])
        ax.plot([0.0, tip.real], [0.0, tip.imag], color=GREY, linewidth=0.6)
        here = factor * radius[k] * np.exp(1j * angle[k])
        ax.plot(here.real, here.imag, "o", color=BLUE, markersize=3)
    path = factor * radius * np.exp(1j * angle)
    ax.plot(path.real, path.imag, color=BLUE)
    leaves = (rate[-1] + 1j * element.speed * radius[-1]) * np.exp(1j * angle[-1])
    beyond = path[-1] + 0.5 * factor * element.length * leaves / abs(leaves)
    ax.annotate(
        "", (beyond.real, beyond.imag), (path[-1].real, path[-1].imag),
        arrowprops={"arrowstyle": "-|>", "color": VERMILION, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip
    # An arrow alone doesn't widen the axes.
    ax.plot(beyond.real, beyond.imag, alpha=0.0)
    ax.plot(0.0, 0.0, "o", color="black", markersize=4)
    ax.set(aspect="equal", adjustable="datalim", xlabel=f"x, {unit}", ylabel=f"y, {unit}", title="From above")


def tie_layout(ax: Axes, element: TetheredBody) -> None:
    """The way after the impulse, about a turn of it, and where the tie is longest."""
    length, moment = element.length, element.speed * element.length

    def motion(_: float, state: np.ndarray) -> tuple[float, float, float]:
        radius, rate, _ = state
        pulled = element.stiffness / element.mass * (radius - length)
        return rate, moment**2 / radius**3 - pulled, moment / radius**2

    last = math.tau * length / element.speed
    way = solve_ivp(motion, (0.0, last), (length, 0.0, 0.0), rtol=1e-8, max_step=last / PLACES)
    factor, unit = engineer_unit("m", np.array([length]))
    turn = np.exp(1j * np.linspace(0.0, math.tau, PLACES))
    circles = (
        (length, GREY, "tie without force", "-"),
        (length + element.own_values()["spin_up_stretch"], ORANGE, "spun up slowly", (0, (4, 2))),
    )
    for radius, colour, label, dashes in circles:
        ax.plot(factor * radius * turn.real, factor * radius * turn.imag, color=colour, linewidth=0.8, linestyle=dashes,
                label=label)  # fmt: skip
    path = factor * way.y[0] * np.exp(1j * way.y[2])
    ax.plot(path.real, path.imag, color=BLUE, label="after the impulse")
    # It comes again and again: the first time of them.
    longest = path[np.argmax(way.y[0] - length > (1.0 - 1e-4) * (way.y[0].max() - length))]
    ax.plot([0.0, longest.real], [0.0, longest.imag], color=VERMILION, linewidth=0.8)
    ax.plot(longest.real, longest.imag, "o", color=VERMILION, markersize=4, label="greatest pull")
    ax.annotate(
        "", (factor * length, 0.35 * factor * length), (factor * length, 0.0),
        arrowprops={"arrowstyle": "-|>", "color": BLUE, "shrinkA": 0, "shrinkB": 0},
    )  # fmt: skip
    ax.plot(0.0, 0.0, "o", color="black", markersize=4)
    ax.set(aspect="equal", adjustable="datalim", xlabel=f"x, {unit}", ylabel=f"y, {unit}", title="Along the axis")
    ax.legend(loc="lower center", bbox_to_anchor=(0.5, 0.2))


def tilted_body_sheet(element: TiltedBody, target: Path | str | Figure, title: str = "") -> Figure:
    """A tilted body from the front, the side and above: outlines of the uniform ellipsoid that is inert as it is.

    Its principal axes and the fixed z axis are drawn as centre lines; its results stand beside the views.

    Parameters
    ----------
    element : TiltedBody
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or no body has such moments of inertia.
    """
    semi_axes, axes = body_ellipsoid(element)
    if np.isnan(semi_axes).any():
        raise PictureError("no body has a moment of inertia greater than the sum of the two others")
    centre = np.array([element.x, element.y, element.z])
    factor, unit = engineer_unit("m", np.append(semi_axes, centre))
    # Which of x, y and z lie across and upwards on the paper.
    views = (("the front", 0, 2), ("the side", 1, 2), ("above", 0, 1))
    with sheet(target, 180, 130, title) as figure:
        drawn = figure.subplot_mosaic([["the front", "the side"], ["above", "told"]])
        for name, across, up in views:
            ax = drawn[name]
            _outline(ax, factor * centre, factor * semi_axes, axes, (across, up))
            ax.plot(0.0, 0.0, "+", color="black", markersize=9)
            if up == 2:
                ax.axvline(0.0, color="black", linewidth=0.8, linestyle=CENTRE_LINE)
            ax.set(aspect="equal", adjustable="datalim", title=f"From {name}")
            ax.set(xlabel=f"{'xyz'[across]}, {unit}", ylabel=f"{'xyz'[up]}, {unit}")
        _tell(drawn["told"], element)
    return figure


def _outline(ax: Axes, centre: np.ndarray, semi_axes: np.ndarray, axes: np.ndarray, view: tuple[int, int]) -> None:
    """Outline of an ellipsoid on the paper, with its axes."""
    seen = axes[list(view)] * semi_axes
    # Of points c + A u on the ellipsoid the outermost to each side are those with u along Aᵀ of that direction.
    angle = np.linspace(0.0, math.tau, PLACES)
    outwards = np.stack([np.cos(angle), np.sin(angle)])
    reach = seen.T @ outwards
    size = np.linalg.norm(reach, axis=0)
    outline = seen @ np.divide(reach, size, out=np.zeros_like(reach), where=size > 0.0)
    middle = centre[list(view)]
    ax.fill(middle[0] + outline[0], middle[1] + outline[1], facecolor=SKY, alpha=0.35, edgecolor="none")
    ax.plot(middle[0] + outline[0], middle[1] + outline[1], color=BLUE, label="outline")
    for k, colour in zip(range(3), (GREEN, ORANGE, PURPLE), strict=True):
        end = 1.25 * seen[:, k]
        ends = np.stack([middle - end, middle + end])
        ax.plot(*ends.T, color=colour, linewidth=0.8, linestyle=CENTRE_LINE)
    ax.plot(*middle, "o", color=VERMILION, markersize=4)


def _tell(ax: Axes, element: TiltedBody) -> None:
    """The body's results in words, in place of a fourth view."""
    ax.axis("off")
    found, lines = element.own_values(), []
    for result in element.results():
        factor, unit = engineer_unit(result.units, np.array([found[result.name]]))
        lines.append(f"{result.name.replace('_', ' ')}: {factor * found[result.name]:.4g} {unit}")
    ax.text(0.0, 1.0, "\n".join(lines), transform=ax.transAxes, verticalalignment="top", linespacing=1.5)
