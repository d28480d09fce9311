"""Machine elements that work by friction, over the coefficient of friction: forces or moments, and efficiency."""

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engine import ElementsAlone, Scene
from sweeps.pictures.style import GREY, PALETTE, sheet
from sweeps.text.engineer_units import engineer_unit

PLACES = 201
# Coefficients up to so many times the one given, and as far as dry steel on steel at least.
BEYOND, DRY = 2.0, 0.3
# Forces that grow beyond all bounds are drawn up to so many times those at the friction given.
HIGHEST = 4.0
# By type of element: what is drawn in one unit on the left, and ratios on the right.
CURVES = {
    "screw": (("raise_moment", "lower_moment"), ("raise_efficiency", "lower_efficiency")),
    "belt": (("tight_tension", "slack_tension", "shaft_force"), ("tension_ratio",)),
    "wedge": (("drive_force", "withdraw_force"), ("efficiency",)),
    "incline": (("up_force", "down_force"), ("efficiency",)),
    "friction_drive": (("needed_press_force", "tangential_force"), ("efficiency",)),
    "guide": (("drive_force", "front_edge_force", "rear_edge_force"), ("efficiency",)),
}


def friction_sheet(element: Any, target: Path | str | Figure, title: str = "") -> Figure:
    """Draw an element's forces or moments over its coefficient of friction, and its efficiency or ratio of tensions.

    Forces end where the element jams.

    Parameters
    ----------
    element : element of a scene
        Of one of the types in `CURVES`.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    sides = CURVES[element.type]
    # A belt without friction carries nothing.
    friction = np.linspace(1e-3, max(BEYOND * element.friction, DRY), PLACES)
    asked = [f"it.{name}" for names in sides for name in names]
    alone = ElementsAlone(Scene(elements={"it": element}), asked, varied=["elements.it.friction"])
    found = alone.evaluate({"elements.it.friction": friction}).summaries
    given = int(np.abs(friction - element.friction).argmin())
    with sheet(target, 180, 80) as figure:
        for ax, names in zip(figure.subplots(1, 2), sides, strict=True):
            rows = {name: found[f"it.{name}"] for name in names}
            _panel(ax, friction, rows, given, alone.available_summaries[f"it.{names[0]}"].units)
            ax.axvline(element.friction, color=GREY, linewidth=0.8, linestyle=(0, (4, 2)))
        if title:
            figure.suptitle(f"{title}, over its friction (upright line: as given)", fontweight="bold")
    return figure


def _panel(ax: Axes, friction: np.ndarray, rows: dict[str, np.ndarray], given: int, units: str) -> None:
    """Curves in one unit, as high as they are at the place `given`, or in the midst of all places where it jams."""
    drawn = np.array(list(rows.values()))
    usual = drawn[:, given] if np.isfinite(drawn[:, given]).all() else np.nanmedian(drawn, axis=1)
    high = HIGHEST * np.abs(usual).max()
    factor, unit = (1.0, "") if units == "1" else engineer_unit(units, usual)
    for (name, row), colour in zip(rows.items(), PALETTE, strict=False):
        ax.plot(friction, factor * row, color=colour, label=name.replace("_", " "))
    if np.nanmax(np.abs(drawn)) > high > 0:
        low = max(min(np.nanmin(drawn), 0.0) - 0.05 * high, -high)
        ax.set_ylim(factor * low, factor * min(1.05 * np.nanmax(drawn), high))
    ax.set(xlim=(0, friction[-1]), xlabel="coefficient of friction", ylabel=unit or "ratio")
    ax.axhline(0.0, color=GREY, linewidth=0.6)
    ax.legend(loc="best")
