"""Elastic drives to be looked at: a machine over its cycle and on a run, and shares of parts."""

from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import Curve, Mark, Panel, PanelAxis, Scene, drive_cycle, drive_run
from sweeps.pictures.elements.panels import panel_sheet
from sweeps.pictures.picture_error import PictureError


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
