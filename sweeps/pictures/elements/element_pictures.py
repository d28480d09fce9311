"""Plots and tables of a scene's machine elements.

Elements supply their own diagrams; drawings next to them, and sheets that need the scene, are listed here.
"""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import Element, EngineElement, GearTrain, Scene, TorsionalTrain, governed_scene
from sweeps.pictures.elements.cam_layout import cam_layout
from sweeps.pictures.elements.elastic_sheets import machine_drive_sheet, machine_run_sheet
from sweeps.pictures.elements.engine_sheet import engine_front, engine_table
from sweeps.pictures.elements.gear_sheet import gear_sheet, gear_table
from sweeps.pictures.elements.train_sheet import numbers_of_machine, train_sheet, train_table
from sweeps.pictures.panels import panel_sheet
from sweeps.pictures.picture_error import PictureError

LAYOUTS = {"cam": cam_layout, "engine": engine_front}
SHEETS = {
    "gear_train": lambda scene, name, *paper: gear_sheet(scene.elements[name], *paper),
    "machine_drive": machine_drive_sheet,
    "torsional_train": train_sheet,
}


def element_pictures(scene: Scene, path: Path) -> list[Path]:
    """Draw the elements of a scene.

    Parameters
    ----------
    scene : Scene
    path : Path
        Base name; element and content are appended, such as `_fan_plan`.

    Returns
    -------
    list of Path
        The files written.

    Raises
    ------
    PictureError
        An element has no results to draw; the others are drawn.
    """
    made, failures = [], []
    scene, cycles = governed_scene(scene)
    for name, element in scene.elements.items():
        title = f"{scene.title}: {name}" if scene.title else name
        made.append(path.with_name(f"{path.stem}_{name}_{element.picture}{path.suffix}"))
        try:
            if element.type in SHEETS:
                SHEETS[element.type](scene, name, made[-1], title)
            else:
                element_sheet(element, made[-1], title, {"cycle": cycles.get(name)})
            if getattr(element, "run", None) is not None:
                made.append(path.with_name(f"{path.stem}_{name}_run{path.suffix}"))
                machine_run_sheet(scene, name, made[-1], title)
        except PictureError as error:
            made.pop()
            failures.append(str(error) if str(error).startswith("elements.") else f"elements.{name}: {error}")
    if failures:
        raise PictureError("; ".join(failures))
    return made


def element_sheet(
    element: Element, target: Path | str | Figure, title: str = "", given: Mapping[str, np.ndarray] | None = None
) -> Figure:
    """Draw the diagrams of an element, next to its layout if it has one.

    Parameters
    ----------
    element : Element
    target : path or Figure
        File to write (.svg, .pdf, .png), or an empty figure to draw on.
    title : str
    given : mapping of str to ndarray, optional
        Input from the machine of its scene.
    """
    layout = LAYOUTS.get(element.type)
    return panel_sheet(element.panels(given), target, title, layout and (lambda ax: layout(ax, element)))


def element_tables(scene: Scene) -> str:
    """Tables of engine orders, torsional modes and gear shafts; "" if there are none."""
    told = []
    for name, element in scene.elements.items():
        match element:
            case EngineElement():
                told.append(f"{name}: orders of the crank\n{engine_table(element)}")
            case TorsionalTrain():
                rows = train_table(element, numbers_of_machine(scene, name))
                told.append(f"{name}: Holzer's table, reduced to {element.layout.masses[0]}\n{rows}")
            case GearTrain():
                told.append(f"{name}: {gear_table(element)}")
    return "\n".join(told)
