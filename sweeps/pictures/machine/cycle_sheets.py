"""Sheets of one machine over its cycle: indicator diagrams of cylinders, and the motion of a part up to its jerk."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import CrankInput, Curve, Mark, MovingMachine, Panel, PanelAxis, Quantity, Verdict, has_cycle, quantity_text
from sweeps.pictures.elements.panels import draw_panel, panel_sheet
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, sheet

# Fields of a part, by the first of them.
_DERIVATIVES = {
    "slide": ("velocity", "acceleration"),
    "angle": ("angular_velocity", "angular_acceleration"),
}
# Cylinders that fit on a sheet, and the height of each [mm].
MOST_CYLINDERS, HEIGHT = 4, 75


def indicator_diagrams(moving: MovingMachine, target: Path | str | Figure) -> Figure:
    """Pressure of each cylinder over its volume and over the crank angle, with its work and power.

    Parameters
    ----------
    moving : MovingMachine
        Of a scene with cylinders.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.

    Raises
    ------
    PictureError
        The machine can't be computed, or unknown picture format.
    """
    names = list(moving.scene.cylinders)[:MOST_CYLINDERS]
    with sheet(target, 180, HEIGHT * len(names), moving.scene.title or "") as figure:
        for name, axes in zip(names, figure.subplots(len(names), 2, squeeze=False), strict=True):
            over_volume, over_angle = _of_cylinder(moving, name)
            draw_panel(axes[0], over_volume)
            # The area of the loop is the work.
            axes[0].fill(*axes[0].lines[0].get_data(), color=BLUE, alpha=0.12, linewidth=0)
            draw_panel(axes[1], over_angle)
    return figure


def _of_cylinder(moving: MovingMachine, name: str) -> tuple[Panel, Panel]:
    places, (pressure, volume) = _rows(moving, (f"{name}.pressure", f"{name}.volume"))
    title, dead_centres = name, []
    if has_cycle(moving.scene):
        work, power = (moving.summary(f"{name}.indicated_{what}") for what in ("work", "power"))
        title = f"{name}: {quantity_text(work, 'J')} per cycle, {quantity_text(power, 'W')}"
        piston = moving.scene.cylinders[name].piston
        ends = (moving.summary(f"{piston}.stroke_{end}_at") for end in ("low", "high"))
        turns = np.arange(moving.scene.input.revolutions) * 2.0 * np.pi
        dead_centres = [Mark("", np.mod(end, 2.0 * np.pi) + turn, None) for end in ends for turn in turns]
    pressures = PanelAxis("absolute pressure", "Pa", "p")
    return (
        Panel(PanelAxis("volume", "m3", "V"), pressures, volume, [Curve("", pressure)], title=title),
        Panel(_input_axis(moving), pressures, places, [Curve("", pressure)], dead_centres),
    )


def motion_of_part(moving: MovingMachine, part: str, target: Path | str | Figure) -> Figure:
    """Displacement, velocity, acceleration and jerk of a slider or link over the input's position.

    Parameters
    ----------
    moving : MovingMachine
    part : str
        A slider, or a link that turns.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.

    Raises
    ------
    PictureError
        There is no such part, the machine can't be computed, or unknown picture format.
    """
    known = moving.register.fields
    kind = next((kind for kind in _DERIVATIVES if f"{part}.{kind}" in known), None)
    if kind is None:
        parts = [name.rpartition(".")[0] for name in known if name.rpartition(".")[2] in _DERIVATIVES]
        raise PictureError(f"{part!r} is not a slider or link of this machine; choose from: {', '.join(parts)}")
    names = [f"{part}.{what}" for what in (kind, *_DERIVATIVES[kind])]
    places, rows = _rows(moving, names)
    jerk = moving.rate(names[-1])
    rows.append(np.append(jerk, jerk[:1]) if has_cycle(moving.scene) else jerk)
    quantities = [known[name].quantity for name in names]
    words = quantities[2].long_name.replace("acceleration", "jerk")
    quantities.append(Quantity("", words, quantities[2].units.replace("s-2", "s-3"), "j"))
    panels = [
        Panel(_input_axis(moving), PanelAxis(q.long_name, q.units, q.symbol), places, [Curve("", row)])
        for q, row in zip(quantities, rows, strict=True)
    ]
    return panel_sheet(panels, target, f"{moving.scene.title or ''}\nMotion of {part} at constant input speed".lstrip())


def _rows(moving: MovingMachine, names: Sequence[str]) -> tuple[np.ndarray, list[np.ndarray]]:
    """Positions and fields there, a cycle closed by its first position."""
    verdict = moving.verdict(names)
    if verdict not in (Verdict.OK, Verdict.NOT_FINITE):
        raise PictureError(f"no diagrams of this machine: {verdict.sentence}")
    places, rows = moving.q, list(moving.fields(names).values())
    if has_cycle(moving.scene):
        places = np.append(places, 2.0 * places[-1] - places[-2])
        rows = [np.append(row, row[:1]) for row in rows]
    return places, rows


def _input_axis(moving: MovingMachine) -> PanelAxis:
    if isinstance(moving.scene.input, CrankInput):
        return PanelAxis("crank angle", "rad", "φ")
    return PanelAxis(f"displacement of {moving.scene.input.link}", "m", "q")
