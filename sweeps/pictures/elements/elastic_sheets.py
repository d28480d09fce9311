"""Plots of elastic drives: a machine over its cycle and during a run."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import Curve, Mark, Panel, PanelAxis, Scene, drive_cycle, drive_run
from sweeps.pictures.elements.panels import panel_sheet
from sweeps.pictures.picture_error import PictureError


def machine_drive_sheet(scene: Scene, name: str, target: Path | str | Figure, title: str = "") -> Figure:
    """Torque, end speeds and twist of the elastic shaft over the cycle, compared with a rigid shaft.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of the drive.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        Unknown picture format, the file can't be written, or there is no steady motion.
    """
    cycle = drive_cycle(scene, name)
    if cycle is None:
        raise PictureError(f"elements.{name}: no steady motion with this shaft; `sweeps run` shows why")
    x, peak = PanelAxis("crank angle", "rad", "φ"), np.abs(cycle.moment).argmax()
    moments = Curve("elastic", cycle.moment), Curve("rigid", cycle.rigid_moment, True)
    speeds = Curve("motor end", cycle.motor_speed), Curve("crank", cycle.machine_speed)
    panels = (
        Panel(
            x,
            PanelAxis("shaft torque", "N m", "M"),
            cycle.angle,
            moments,
            (Mark("", cycle.angle[peak], cycle.moment[peak]),),
        ),
        Panel(x, _AT_CRANK, cycle.angle, (*speeds, Curve("rigid", cycle.rigid_speed, True))),
        Panel(x, _BEHIND, cycle.angle, (Curve("", cycle.twist),)),
    )
    return panel_sheet(panels, target, title)


def machine_run_sheet(scene: Scene, name: str, target: Path | str | Figure, title: str = "") -> Figure:
    """Torque, end speeds and twist of the elastic shaft during a run.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of the drive, which has a run.
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str

    Raises
    ------
    PictureError
        Unknown picture format, the file can't be written, or there is no steady motion.
    """
    run = drive_run(scene, name)
    if run is None:
        raise PictureError(f"elements.{name}: no steady motion with this shaft; `sweeps run` shows why")
    x, peak, backlash = PanelAxis("time", "s", "t"), np.abs(run.moment).argmax(), scene.elements[name].run.backlash
    speeds = Curve("motor end", run.motor_speed), Curve("crank", run.machine_speed)
    top = Mark("", run.time[peak], run.moment[peak])
    play = [Mark("", None, 0.0), Mark("backlash", None, -backlash)] if backlash > 0.0 else []
    panels = (
        Panel(x, PanelAxis("shaft torque", "N m", "M"), run.time, (Curve("", run.moment),), (top,)),
        Panel(x, _AT_CRANK, run.time, speeds),
        Panel(x, _BEHIND, run.time, (Curve("", run.twist),), play),
    )
    return panel_sheet(panels, target, title)


_AT_CRANK, _BEHIND = PanelAxis("crank speed", "rad s-1", "ω"), PanelAxis("twist (crank lag)", "rad", "Δφ")
