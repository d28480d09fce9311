"""A journal in its bearing and a roller on its plane, with the forces at the body."""

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Arc, Circle

from engine import Element
from sweeps.pictures.style import GREY, PALETTE
from sweeps.text.engineer_units import engineer_unit

# Radius of the body that is drawn, forces and arms beside it.
RADIUS, FORCE = 1.0, 0.9
# An arm of rolling friction is drawn so long, however small it is.
ARM = 0.2


def journal_layout(body: Axes, element: Element) -> None:
    """A journal with its friction circle and the reaction beside its middle."""
    own = element.own_values()
    circle, moment = own["friction_circle"], own["friction_moment"]
    _bare(body, (-2.6, 2.1))
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


def roller_layout(body: Axes, element: Element) -> None:
    """A roller with the force that moves it and the reaction ahead of its middle."""
    own, height = element.own_values(), element.diameter / 2 if element.pull_height is None else element.pull_height
    force, rolls = own["pull_force"], own["rolls"]
    _bare(body, (-1.2, 3.2))
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


def _bare(body: Axes, extent: tuple[float, float]) -> None:
    body.set_aspect("equal")
    body.set_axis_off()
    body.set(xlim=(-2.4, 2.4), ylim=extent)


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
