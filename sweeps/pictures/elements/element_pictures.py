"""Plots and tables of a scene's machine elements.

Elements supply their own diagrams; drawings next to them, and sheets that need the scene, are listed here.
"""

from collections.abc import Iterator

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
    "gear_train": lambda scene, name, title: gear_sheet(scene.elements[name], title),
    "machine_drive": machine_drive_sheet,
    "torsional_train": train_sheet,
}


def element_sheets(scene: Scene) -> Iterator[tuple[str, Figure]]:
    """Sheets of the elements of a scene, by element and content, such as `fan_plan`.

    Parameters
    ----------
    scene : Scene

    Raises
    ------
    PictureError
        An element has no results to draw; the others are drawn before.
    """
    failures = []
    scene, cycles = governed_scene(scene)
    for name, element in scene.elements.items():
        title = f"{scene.title}: {name}" if scene.title else name
        try:
            if element.type in SHEETS:
                drawn = SHEETS[element.type](scene, name, title)
            else:
                given = {"cycle": cycles[name]} if name in cycles else {}
                drawn = element_sheet(element, title, **given)
            yield f"{name}_{element.picture}", drawn
            if getattr(element, "run", None) is not None:
                yield f"{name}_run", machine_run_sheet(scene, name, title)
        except PictureError as error:
            failures.append(str(error) if str(error).startswith("elements.") else f"elements.{name}: {error}")
    if failures:
        raise PictureError("; ".join(failures))


def element_sheet(element: Element, title: str = "", **given: np.ndarray) -> Figure:
    """Draw the diagrams of an element, next to its layout if it has one.

    Parameters
    ----------
    element : Element
    title : str
    **given : ndarray
        Input from the machine of its scene, as for `panels` of its kind.
    """
    layout = LAYOUTS.get(element.type)
    return panel_sheet(element.panels(**given), title, layout and (lambda ax: layout(ax, element)))


def element_tables(scene: Scene) -> str:
    """Tables of engine orders, torsional modes and gear shafts; "" if there are none."""
    tables = []
    for name, element in scene.elements.items():
        match element:
            case EngineElement():
                tables.append(f"{name}: orders of the crank\n{engine_table(element)}")
            case TorsionalTrain():
                rows = train_table(element, numbers_of_machine(scene, name))
                tables.append(f"{name}: Holzer's table, reduced to {element.layout.masses[0]}\n{rows}")
            case GearTrain():
                tables.append(f"{name}: {gear_table(element)}")
    return "\n".join(tables)
