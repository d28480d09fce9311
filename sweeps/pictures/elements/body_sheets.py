"""Single bodies to be looked at: tilted, sliding out on a turning lever, on an elastic tie, and wound flywheels."""

import math
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from scipy.integrate import solve_ivp

from engine import (
    ElementsAlone,
    RotatingGuide,
    Scene,
    TetheredBody,
    TiltedBody,
    WoundFlywheel,
    body_ellipsoid,
    slides_out,
    wound_stresses,
)
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, sheet
from sweeps.text.engineer_units import engineer_unit

PLACES = 721
# Stretches of the lever, in time alike, at which it is drawn.
LEVERS = 8
CENTRE_LINE = (0, (12, 3, 2, 3))


def rotating_guide_sheet(element: RotatingGuide, target: Path | str | Figure, title: str = "") -> Figure:
    """Way of a body that slides out on a turning lever, from above, with its distance from the axis and the reaction.

    Parameters
    ----------
    element : RotatingGuide
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or the body doesn't leave the lever.
    """
    alone = ElementsAlone(Scene(elements={"it": element}), ["it.time"])
    end = float(alone.evaluate({}).summaries["it.time"][0])
    if not math.isfinite(end):
        raise PictureError("no time in which the body leaves the lever could be found; sweeps run says why")
    time = np.linspace(0.0, end, PLACES)
    motion = element.speed, element.start_radius, element.start_velocity, element.friction
    radius, rate = slides_out(*(np.full(time.shape, value) for value in motion), time)
    with sheet(target, 180, 90, title) as figure:
        drawn = figure.subplot_mosaic([["plan", "distance"], ["plan", "reaction"]])
        _plan(drawn["plan"], element, time, radius, rate)
        curves = (
            ("distance", radius, "m", "distance"),
            ("reaction", 2.0 * element.mass * element.speed * rate, "N", "reaction"),
        )
        for name, values, si, label in curves:
            factor, unit = engineer_unit(si, values)
            drawn[name].plot(time, factor * values, color=BLUE)
            drawn[name].plot(end, factor * values[-1], "o", color=VERMILION, markersize=4)
            drawn[name].set(ylabel=f"{label}, {unit}", xlim=(0, 1.03 * end), ylim=(0, None))
        drawn["reaction"].set_xlabel("time, s")
    return figure


def _plan(ax: Axes, element: RotatingGuide, time: np.ndarray, radius: np.ndarray, rate: np.ndarray) -> None:
    """The body's path, the lever on the way, and the velocity with which the body leaves it."""
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


def tethered_body_sheet(element: TetheredBody, target: Path | str | Figure, title: str = "") -> Figure:
    """Way of a body on an elastic tie after an impulse, beside its circle when spun up, and the pull over the speed.

    Parameters
    ----------
    element : TetheredBody
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    kinds = (("impulse", BLUE, "by an impulse"), ("spin_up", ORANGE, "spun up slowly"))
    asked = [f"it.{kind}_{what}" for kind, _, _ in kinds for what in ("force", "burst_speed", "stretch")]
    alone = ElementsAlone(Scene(elements={"it": element}), asked, varied=["elements.it.speed"])
    given = alone.evaluate({"elements.it.speed": np.array([element.speed])}).summaries
    own = {name: float(values[0]) for name, values in given.items()}
    fastest = 1.15 * max(element.speed, own["it.spin_up_burst_speed"], own["it.impulse_burst_speed"])
    speeds = np.linspace(fastest / PLACES, fastest, PLACES)
    pulls = alone.evaluate({"elements.it.speed": speeds}).summaries
    factor, unit = engineer_unit("N", np.array([element.strength]))
    with sheet(target, 180, 85, title) as figure:
        plan, pull = figure.subplots(1, 2)
        _tethered_plan(plan, element, own)
        for kind, colour, label in kinds:
            burst = own[f"it.{kind}_burst_speed"]
            pull.plot(speeds, factor * pulls[f"it.{kind}_force"], color=colour, label=label)
            pull.plot(burst, factor * element.strength, "o", color=colour, markersize=4)
        pull.axhline(factor * element.strength, color=VERMILION, linewidth=0.8, label="strength of the tie")
        pull.axvline(element.speed, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="its speed")
        pull.set(xlabel="speed, m/s", ylabel=f"greatest pull, {unit}", xlim=(0, fastest))
        pull.set_ylim(0, 2.2 * factor * element.strength)
        pull.legend(loc="upper left")
    return figure


def _tethered_plan(ax: Axes, element: TetheredBody, own: dict[str, float]) -> None:
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
        (length + own["it.spin_up_stretch"], ORANGE, "spun up slowly", (0, (4, 2))),
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


def wound_flywheel_sheet(element: WoundFlywheel, target: Path | str | Figure, title: str = "") -> Figure:
    """Hoop and radial stresses over the radius of a wound flywheel, at rest, at its speed, and where layers part.

    Parameters
    ----------
    element : WoundFlywheel
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    numbers = {key: value for key, value in element if isinstance(value, float)}
    inner, edge, outer = (0.5 * numbers[key] for key in ("bore", "winding_diameter", "diameter"))
    stretches = np.linspace(inner, edge, PLACES), np.linspace(edge, outer, PLACES)
    # The last place of the ring still is ring.
    radius = np.concatenate([np.minimum(stretches[0], np.nextafter(edge, 0.0)), stretches[1]])
    alone = ElementsAlone(Scene(elements={"it": element}), ["it.parting_speed"])
    parting = float(alone.evaluate({}).summaries["it.parting_speed"][0])
    # Beyond the speed at which layers part the stresses are others.
    own = ((element.speed, BLUE, "at its speed"),) if element.speed <= parting else ()
    speeds = ((0.0, GREY, "at rest"), *own, (parting, ORANGE, "where layers part"))
    found = [(wound_stresses(numbers, radius, speed), colour, label) for speed, colour, label in speeds]
    factor, unit = engineer_unit("Pa", np.concatenate([np.ravel(stresses) for stresses, _, _ in found]))
    wide, length_unit = engineer_unit("m", radius)
    with sheet(target, 180, 80, title) as figure:
        axes = figure.subplots(1, 2)
        for ax, which, words in zip(axes, (1, 0), ("hoop", "radial"), strict=True):
            for stresses, colour, label in found:
                ax.plot(wide * radius, factor * stresses[which], color=colour, label=label)
            ax.axhline(0.0, color="black", linewidth=0.6)
            ax.axvline(wide * edge, color=GREY, linewidth=0.8, linestyle=(0, (6, 2)))
            ax.set(xlabel=f"radius, {length_unit}", ylabel=f"{words} stress, {unit}", xlim=(wide * inner, wide * outer))
        if element.strength is not None:
            axes[0].axhline(factor * element.strength, color=VERMILION, linewidth=0.8, label="strength")
        axes[0].legend(loc="best")
        axes[1].set_title("Broken line: where the winding begins")
    return figure


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
    scene = Scene(elements={"it": element})
    known = ElementsAlone(scene).available_summaries
    found = ElementsAlone(scene, list(known)).evaluate({}).summaries
    lines = []
    for name, quantity in known.items():
        value = float(found[name][0])
        factor, unit = engineer_unit(quantity.units, np.array([value]))
        lines.append(f"{name.partition('.')[2].replace('_', ' ')}: {factor * value:.4g} {unit}")
    ax.text(0.0, 1.0, "\n".join(lines), transform=ax.transAxes, verticalalignment="top", linespacing=1.5)
