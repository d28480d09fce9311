"""Fields of one machine plotted over its cycle, or against another field."""

import math
from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import MovingMachine, Scene, display_unit, has_cycle
from sweeps.pictures.machine.diagrams import input_axis
from sweeps.pictures.picture_error import PictureError, need_mechanism
from sweeps.pictures.style import BLUE, sheet, typeset

POSITIONS = 720
# Panels that fit on a sheet.
MOST = 8


def field_curves(
    scene: Scene, target: Path | str | None, names: Sequence[str], x: str | None = None, positions: int = POSITIONS
) -> Figure:
    """Draw fields of a machine in stacked panels.

    Parameters
    ----------
    scene : Scene
    target : path or None
        File to write (.svg, .pdf, .png), if any.
    names : sequence of str
        1 to `MOST` fields.
    x : str, optional
        Field on the x axis instead of the input position; "B.x" with "B.y" gives a path.
    positions : int

    Raises
    ------
    PictureError
        The scene has no mechanism, too many or no fields are named, or a field has no finite values.
    AskError
        There is no such field, or the number of positions isn't allowed.
    """
    need_mechanism(scene)
    if not 1 <= len(names) <= MOST:
        raise PictureError(f"name from 1 to {MOST} fields with -y, such as -y B.vx; `sweeps quantities` lists them")
    along = [x] if x else []
    machine = MovingMachine(scene, positions=positions)
    rows, known = machine.fields(dict.fromkeys([*names, *along])), machine.register.fields
    for name, row in rows.items():
        if not np.isfinite(row).any():
            raise PictureError(f"{name} is infinite or undefined everywhere; `sweeps run` shows why")
    if x:
        factor, label = display_unit(known[x].units, rows[x])
        places, title = rows[x] * factor, f"{known[x].long_name} {typeset(known[x].symbol) or x}{_comma(label)}"
    else:
        title, factor = input_axis(scene, machine.q)
        places = machine.q * factor
    closed = has_cycle(scene)
    with sheet(target, 180, 25 + 45 * len(names), scene.title or "") as figure:
        axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for ax, name in zip(axes, names, strict=True):
            factor, label = display_unit(known[name].units, rows[name])
            shown, at = rows[name] * factor, places
            if closed:
                begin = shown[0] + (_turned(rows[name]) * factor if known[name].units == "rad" else 0.0)
                end = places[0] if x else places[0] + 360.0 * scene.input.revolutions
                shown, at = np.append(shown, begin), np.append(at, end)
            ax.plot(at, shown, color=BLUE)
            ax.set(title=known[name].long_name, ylabel=f"{typeset(known[name].symbol) or name}{_comma(label)}")
        axes[-1].set_xlabel(title)
    return figure


def _comma(label: str) -> str:
    return f", {label}" if label not in ("", "1") else ""


def _turned(row: np.ndarray) -> float:
    """Increase of an angle over the cycle: a whole number of turns."""
    step = row[1] - row[0]
    return 2 * math.pi * round((row[-1] + step - row[0]) / (2 * math.pi))
