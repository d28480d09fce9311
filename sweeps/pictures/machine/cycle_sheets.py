"""Sheets of one machine over its cycle: indicator diagrams, the motion of a part up to its jerk, any fields."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

import engine
from sweeps.pictures.machine.cycle_rows import closed, dead_centres, need_motion, over_cycle, panel_over_cycle
from sweeps.pictures.panels import draw_panel, panel_sheet
from sweeps.pictures.picture_error import PictureError, need_mechanism
from sweeps.pictures.style import BLUE, sheet

# Fields of a part, by the first of them.
_DERIVATIVES = {"slide": ("velocity", "acceleration"), "angle": ("angular_velocity", "angular_acceleration")}
# Cylinders that fit on a sheet, and the height of each [mm].
MOST_CYLINDERS, HEIGHT = 4, 75
# Fields that fit on a sheet, and positions of each.
MOST_FIELDS, POSITIONS = 8, 720


def indicator_diagrams(moving: engine.MovingMachine) -> Figure:
    """Pressure of each cylinder over its volume and over the crank angle, with its work and power.

    Parameters
    ----------
    moving : MovingMachine
        Of a scene with cylinders.

    Raises
    ------
    PictureError
        The machine can't be computed.
    """
    names = list(moving.scene.cylinders)[:MOST_CYLINDERS]
    with sheet(180, HEIGHT * len(names), moving.scene.title or "") as figure:
        for name, axes in zip(names, figure.subplots(len(names), 2, squeeze=False), strict=True):
            over_volume, over_angle = _of_cylinder(moving, name)
            draw_panel(axes[0], over_volume)
            # The area of the loop is the work.
            axes[0].fill(*axes[0].lines[0].get_data(), color=BLUE, alpha=0.12, linewidth=0)
            draw_panel(axes[1], over_angle)
    return figure


def _of_cylinder(moving: engine.MovingMachine, name: str) -> tuple[engine.Panel, engine.Panel]:
    asked = f"{name}.pressure", f"{name}.volume"
    need_motion(moving, asked)
    pressure, volume = over_cycle(moving, asked).values()
    title = name
    if moving.scene.has_cycle:
        work, power = (moving.summary(f"{name}.indicated_{what}") for what in ("work", "power"))
        title = f"{name}: {engine.quantity_text(work, 'J')} per cycle, {engine.quantity_text(power, 'W')}"
    axis, curves = engine.PanelAxis("absolute pressure", "Pa", "p"), [engine.Curve("", pressure)]
    centres = dead_centres(moving, moving.scene.cylinders[name].piston)
    over_volume = engine.Panel(engine.PanelAxis("volume", "m3", "V"), axis, volume, curves, title=title)
    return over_volume, panel_over_cycle(moving, axis, curves, centres)


def motion_of_part(moving: engine.MovingMachine, part: str) -> Figure:
    """Displacement, velocity, acceleration and jerk of a slider or link over the input's position.

    Parameters
    ----------
    moving : MovingMachine
    part : str
        A slider, or a link that turns.

    Raises
    ------
    PictureError
        There is no such part, the machine can't be computed.
    """
    known = moving.register.fields
    kind = next((kind for kind in _DERIVATIVES if f"{part}.{kind}" in known), None)
    if kind is None:
        parts = dict.fromkeys(name.rpartition(".")[0] for name in known if name.rpartition(".")[2] in _DERIVATIVES)
        raise PictureError(f"{part!r} is not a slider or link of this machine; choose from: {', '.join(parts)}")
    names = [f"{part}.{what}" for what in (kind, *_DERIVATIVES[kind])]
    need_motion(moving, names)
    rows = [*over_cycle(moving, names).values(), closed(moving.scene, moving.rate(names[-1]))]
    quantities = [known[name].quantity for name in names]
    words = quantities[2].long_name.replace("acceleration", "jerk")
    quantities.append(
        engine.Quantity("", words, quantities[2].units.replace("s-2", "s-3"), symbol=f"j{quantities[2].symbol[1:]}")
    )
    panels = [
        panel_over_cycle(moving, engine.PanelAxis(q.long_name, q.units, q.symbol), [engine.Curve("", row)])
        for q, row in zip(quantities, rows, strict=True)
    ]
    return panel_sheet(panels, f"{moving.scene.title or ''}\nMotion of {part} at constant input speed".lstrip())


def field_curves(scene: engine.Scene, names: Sequence[str], x: str | None = None, positions: int = POSITIONS) -> Figure:
    """Draw fields of a machine in stacked panels.

    Parameters
    ----------
    scene : Scene
    names : sequence of str
        1 to `MOST_FIELDS` fields.
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
    if not 1 <= len(names) <= MOST_FIELDS:
        words = "fields with -y, such as -y B.vx; `sweeps quantities` lists them"
        raise PictureError(f"name from 1 to {MOST_FIELDS} {words}")
    moving = engine.MovingMachine(scene, positions=positions)
    rows, known = over_cycle(moving, [*names, *([x] if x else [])]), moving.register.fields
    for name, row in rows.items():
        if not np.isfinite(row).any():
            raise PictureError(f"{name} is infinite or undefined everywhere; `sweeps run` shows why")
    with sheet(180, 25 + 45 * len(names), scene.title or "") as figure:
        axes = figure.subplots(len(names), 1, sharex=True, squeeze=False)[:, 0]
        for ax, name in zip(axes, names, strict=True):
            up = engine.PanelAxis("" if known[name].symbol else name, known[name].units, known[name].symbol)
            panel = panel_over_cycle(moving, up, [engine.Curve("", rows[name])], title=known[name].long_name)
            if x:
                words = known[x].long_name if known[x].symbol else f"{known[x].long_name} {x}"
                panel = panel._replace(x=engine.PanelAxis(words, known[x].units, known[x].symbol), places=rows[x])
            draw_panel(ax, panel, ax is axes[-1])
    return figure
