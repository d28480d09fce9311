"""A journal in its bearing and a roller on its plane: forces at the body, and what moves it by friction's number."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Arc, Circle

from engine import ElementsAlone, Scene
from sweeps.pictures.style import GREY, PALETTE, sheet
from sweeps.text.engineer_units import engineer_unit

PLACES = 101
# Curves go so many times as far as the number given, and coefficients of friction as far as dry steel on steel.
BEYOND, DRY = 2.0, 0.3
# Radius of the body that is drawn, forces and arms beside it.
RADIUS, FORCE = 1.0, 0.9
# An arm of rolling friction is drawn so long, however small it is.
ARM = 0.2


def journal_sheet(element: Any, target: Path | str | Figure, title: str = "") -> Figure:
    """Draw a journal with its friction circle and the reaction beside its middle; and its moment over the friction.

    Parameters
    ----------
    element : journal of a scene
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    friction = np.linspace(0.0, max(BEYOND * element.friction, DRY), PLACES)
    contacts = ("line", "new", "worn in")
    moments = {
        contact: _varied(element.model_copy(update={"contact": contact}), "friction_moment", "friction", friction)
        for contact in contacts
    }
    circle, moment = (
        _varied(element, name, "friction", np.array([element.friction]))[0]
        for name in ("friction_circle", "friction_moment")
    )
    with sheet(target, 180, 90, title) as figure:
        body, curves = _body_and_curves(figure, (-2.6, 2.1))
        share = RADIUS * circle / (element.diameter / 2)
        body.add_patch(Circle((0, 0), RADIUS, fill=False, color="black", linewidth=1.0))
        body.add_patch(Arc((0, 0), 2.1 * RADIUS, 2.1 * RADIUS, theta1=180, theta2=360, color=GREY, linewidth=3))
        body.add_patch(Circle((0, 0), share, fill=False, color=PALETTE[1], linewidth=0.9, linestyle=(0, (4, 2))))
        _arrow(body, (0, RADIUS + FORCE), (0, 0), PALETTE[0], f"load {_told(element.load, 'N')}", (0.08, RADIUS + 0.7))
        _arrow(body, (share, -RADIUS - FORCE), (share, 0), PALETTE[2], "reaction", (share + 0.08, -RADIUS - 0.7))
        # Turning to the left, it is held to the right, by the reaction on the right of its middle.
        _turn(body, 0.55 * RADIUS, f"turns; friction {_told(moment, 'N m')} against it")
        told = f"friction circle, radius {_told(circle, 'm')}"
        body.text(-0.15, -RADIUS - 0.7, told, color=PALETTE[1], ha="right", va="center")
        _over(curves, friction, moments, "N m", "coefficient of friction", element.friction)
        curves.set_title("moment of friction, by contact", fontsize="medium")
    return figure


def roller_sheet(element: Any, target: Path | str | Figure, title: str = "") -> Figure:
    """Draw a roller with the force that moves it and the reaction ahead of its middle; and that force over the arm k.

    Parameters
    ----------
    element : roller of a scene
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    height = element.diameter / 2 if element.pull_height is None else element.pull_height
    arm = np.linspace(0.0, BEYOND * (element.rolling_arm or element.friction * height), PLACES)
    pulls = {"force that moves it": _varied(element, "pull_force", "rolling_arm", arm)}
    force, rolls = (
        _varied(element, name, "rolling_arm", np.array([element.rolling_arm]))[0] for name in ("pull_force", "rolls")
    )
    with sheet(target, 180, 90, title) as figure:
        body, curves = _body_and_curves(figure, (-1.2, 3.2))
        at = RADIUS * height / (element.diameter / 2)
        body.add_patch(Circle((0, RADIUS), RADIUS, fill=False, color="black", linewidth=1.0))
        body.plot([-2.2, 2.2], [0, 0], color="black", linewidth=1.4)
        _arrow(body, (0, 2 * RADIUS + FORCE), (0, RADIUS), PALETTE[0], f"load {_told(element.load, 'N')}", (0.08, 2.7))
        _arrow(body, (0, at), (2.0, at), PALETTE[1], f"pull {_told(force, 'N')}", (1.1, at + 0.1))
        _arrow(body, (ARM, -FORCE), (ARM, 0), PALETTE[2], "reaction", (ARM + 0.08, -FORCE))
        told = f"arm k = {_told(element.rolling_arm, 'm')}, not to scale"
        body.text(-0.1, -0.45, told, ha="right", color=GREY)
        slides = f"it would slide under {_told(element.friction * element.load, 'N')}"
        body.text(-0.1, -0.9, slides if rolls > 0 else "it slides", ha="right", color=GREY)
        _over(curves, arm, pulls, "N", "arm of rolling friction", element.rolling_arm, "m")
        curves.set_title("pull, by the arm of rolling friction", fontsize="medium")
    return figure


def _varied(element: Any, name: str, key: str, values: np.ndarray) -> np.ndarray:
    """One of an element's results over one of its numbers."""
    path = f"elements.it.{key}"
    alone = ElementsAlone(Scene(elements={"it": element}), [f"it.{name}"], varied=[path])
    return alone.evaluate({path: values}).summaries[f"it.{name}"]


def _body_and_curves(figure: Figure, extent: tuple[float, float]) -> tuple[Axes, Axes]:
    body, curves = figure.subplots(1, 2)
    body.set_aspect("equal")
    body.set_axis_off()
    body.set(xlim=(-2.4, 2.4), ylim=extent)
    return body, curves


def _told(value: float, units: str) -> str:
    factor, unit = engineer_unit(units, np.array([value]))
    return f"{factor * value:.3g} {unit}"


def _arrow(ax: Axes, begin: tuple, end: tuple, colour: str, text: str, at: tuple) -> None:
    ax.annotate("", xy=end, xytext=begin, arrowprops={"arrowstyle": "-|>", "color": colour, "linewidth": 1.3})
    ax.text(*at, text, color=colour, va="center")


def _turn(ax: Axes, radius: float, text: str) -> None:
    """An arrow about the middle, against the clock."""
    angle = np.radians(np.linspace(100.0, 200.0, 40))
    x, y = radius * np.cos(angle), radius * np.sin(angle)
    ax.plot(x, y, color=GREY, linewidth=1.0)
    style = {"arrowstyle": "-|>", "color": GREY, "linewidth": 1.0}
    ax.annotate("", xy=(x[-1], y[-1]), xytext=(x[-3], y[-3]), arrowprops=style)
    ax.text(0.0, -RADIUS - FORCE - 0.45, text, ha="center", color=GREY)


def _over(
    ax: Axes, places: np.ndarray, rows: dict[str, np.ndarray], units: str, name: str, given: float, of: str = "1"
) -> None:
    """Curves over a number, and an upright line where it is as given."""
    factor, unit = engineer_unit(units, np.array([row[-1] for row in rows.values()]))
    along, its_unit = (1.0, "") if of == "1" else engineer_unit(of, places[-1:])
    for (label, row), colour in zip(rows.items(), PALETTE, strict=False):
        ax.plot(along * places, factor * row, color=colour, label=label)
    ax.axvline(along * given, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)), label="as given")
    ax.set(
        xlim=(0, along * places[-1]), ylim=(0, None), xlabel=f"{name}, {its_unit}" if its_unit else name, ylabel=unit
    )
    ax.legend(loc="best")
