"""Elastic drives to be looked at: a machine over its cycle and on a run, and shares of parts."""

import math
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import ComplianceElement, Curve, Mark, Panel, PanelAxis, Scene, drive_cycle, drive_run
from sweeps.pictures.elements.panels import panel_sheet
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import BLUE, sheet
from sweeps.text.engineer_units import engineer_unit


def machine_drive_sheet(scene: Scene, name: str, target: Path | str | Figure, title: str = "") -> Figure:
    """Moment of the elastic shaft, speeds of its ends and its twist over the machine's cycle, a rigid shaft beside.

    Parameters
    ----------
    scene : Scene
    name : str
        The drive among its elements.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or there is no steady motion to be drawn.
    """
    cycle = drive_cycle(scene, name)
    if cycle is None:
        raise PictureError(f"elements.{name}: the machine has no steady motion on this shaft; sweeps run says why")
    x, peak = PanelAxis("crank angle", "rad"), np.abs(cycle.moment).argmax()
    moments = Curve("elastic", cycle.moment), Curve("rigid", cycle.rigid_moment, True)
    speeds = Curve("motors' end", cycle.motor_speed), Curve("crank", cycle.machine_speed)
    panels = (
        Panel(x, PanelAxis("shaft", "N m"), cycle.angle, moments, (Mark("", cycle.angle[peak], cycle.moment[peak]),)),
        Panel(x, _AT_CRANK, cycle.angle, (*speeds, Curve("rigid", cycle.rigid_speed, True))),
        Panel(x, _BEHIND, cycle.angle, (Curve("", cycle.twist),)),
    )
    return panel_sheet(panels, target, title)


def machine_run_sheet(scene: Scene, name: str, target: Path | str | Figure, title: str = "") -> Figure:
    """Moment of the elastic shaft, speeds of its ends and its twist over the time of a run.

    Parameters
    ----------
    scene : Scene
    name : str
        The drive among its elements; it has a run.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, it can't be written, or the machine has no steady motion.
    """
    run = drive_run(scene, name)
    if run is None:
        raise PictureError(f"elements.{name}: the machine has no steady motion on this shaft; sweeps run says why")
    x, peak, backlash = PanelAxis("time", "s"), np.abs(run.moment).argmax(), scene.elements[name].run.backlash
    speeds = Curve("motors' end", run.motor_speed), Curve("crank", run.machine_speed)
    top = Mark("", run.time[peak], run.moment[peak])
    play = [Mark("", None, 0.0), Mark("backlash", None, -backlash)] if backlash > 0.0 else []
    panels = (
        Panel(x, PanelAxis("shaft", "N m"), run.time, (Curve("", run.moment),), (top,)),
        Panel(x, _AT_CRANK, run.time, speeds),
        Panel(x, _BEHIND, run.time, (Curve("", run.twist),), play),
    )
    return panel_sheet(panels, target, title)


_AT_CRANK, _BEHIND = PanelAxis("speed at the crank", "rad s-1"), PanelAxis("crank behind", "rad")


def compliance_sheet(element: ComplianceElement, target: Path | str | Figure, title: str = "") -> Figure:
    """What share of the twist, or of the energy, each elastic part of a shaft line has, the softest first.

    Parameters
    ----------
    element : ComplianceElement
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    own = element.own_values()
    shares = {name.removesuffix(".share"): value for name, value in own.items() if name.endswith(".share")}
    parts = sorted(shares, key=shares.get)
    told = [f"{100 * shares[part]:.3g} %, {_stiffness(own[f'{part}.stiffness'])}" for part in parts]
    with sheet(target, 140, 25 + 9 * len(parts), title) as figure:
        ax = figure.subplots()
        bars = ax.barh([part.replace(".", " · ") for part in parts], [100 * shares[part] for part in parts], color=BLUE)
        ax.bar_label(bars, told, padding=3, fontsize=7)
        ax.set(xlabel="share of the energy, %", xlim=(0, 1.6 * 100 * max(shares.values())))
        ax.grid(axis="y", visible=False)
        words = f"whole line: {_stiffness(own['stiffness'])}"
        if "twist" in own:
            words += f", {math.degrees(own['twist']):.3g}° under {element.moment:g} N·m"
        ax.set_title(words)
    return figure


def _stiffness(value: float) -> str:
    factor, unit = engineer_unit("N m rad-1", np.array([value]))
    return f"{factor * value:.4g} {unit}"
