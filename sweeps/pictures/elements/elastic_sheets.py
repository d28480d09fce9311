"""Plots of elastic drives: a machine over its cycle and during a run."""

from collections.abc import Sequence

import numpy as np
from matplotlib.figure import Figure

from engine import Curve, DriveCycle, DriveRun, Mark, Panel, PanelAxis, Scene, drive_cycle, drive_run
from sweeps.pictures.panels import panel_sheet
from sweeps.pictures.picture_error import PictureError


def machine_drive_sheet(scene: Scene, name: str, title: str = "") -> Figure:
    """Torque, end speeds and twist of the elastic shaft over the cycle, compared with a rigid shaft.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of the drive.
    title : str

    Raises
    ------
    PictureError
        There is no steady motion.
    """
    cycle = _found(drive_cycle(scene, name), name)
    moments = Curve("elastic", cycle.moment), Curve("rigid", cycle.rigid_moment, True)
    x, speeds = PanelAxis("crank angle", "rad", "φ"), [Curve("rigid", cycle.rigid_speed, True)]
    return panel_sheet(_panels(x, cycle.angle, cycle, moments, speeds), title)


def machine_run_sheet(scene: Scene, name: str, title: str = "") -> Figure:
    """Torque, end speeds and twist of the elastic shaft during a run.

    Parameters
    ----------
    scene : Scene
    name : str
        Name of the drive, which has a run.
    title : str

    Raises
    ------
    PictureError
        There is no steady motion.
    """
    run, backlash = _found(drive_run(scene, name), name), scene.elements[name].run.backlash
    play = [Mark("", None, 0.0), Mark("backlash", None, -backlash)] if backlash > 0.0 else []
    x, moments = PanelAxis("time", "s", "t"), [Curve("", run.moment)]
    return panel_sheet(_panels(x, run.time, run, moments, marks=play), title)


def _found(motion: DriveCycle | DriveRun | None, name: str) -> DriveCycle | DriveRun:
    if motion is None:
        raise PictureError(f"elements.{name}: no steady motion with this shaft; `sweeps run` shows why")
    return motion


def _panels(
    x: PanelAxis,
    places: np.ndarray,
    motion: DriveCycle | DriveRun,
    moments: Sequence[Curve],
    speeds: Sequence[Curve] = (),
    marks: Sequence[Mark] = (),
) -> list[Panel]:
    """Torque with its peak, end speeds and further ones, and twist of a shaft with marks."""
    peak = np.abs(motion.moment).argmax()
    top = Mark("", places[peak], motion.moment[peak])
    speeds = Curve("motor end", motion.motor_speed), Curve("crank", motion.machine_speed), *speeds
    return [
        Panel(x, PanelAxis("shaft torque", "N m", "M"), places, moments, [top]),
        Panel(x, PanelAxis("crank speed", "rad s-1", "ω"), places, speeds),
        Panel(x, PanelAxis("twist (crank lag)", "rad", "Δφ"), places, [Curve("", motion.twist)], marks),
    ]
