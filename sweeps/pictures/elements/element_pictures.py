"""Pictures of the machine elements of a scene: rotors, engines, gear trains; and their tables in words."""

from pathlib import Path

from engine import EngineElement, GearTrain, RotorElement, Scene
from sweeps.pictures.elements.engine_sheet import engine_sheet, engine_table
from sweeps.pictures.elements.gear_sheet import gear_sheet, gear_table
from sweeps.pictures.elements.unbalance_plan import unbalance_plan


def element_pictures(scene: Scene, path: Path) -> list[Path]:
    """Draw the rotors, engines and gear trains of a scene.

    Parameters
    ----------
    scene : Scene
    path : Path
        The names of the pictures are this one's with the element's name and `_plan`, `_orders` or `_velocities` added.

    Returns
    -------
    list of Path
        The files made; other elements have no pictures.

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, or it can't be written.
    """
    made = []
    for name, element in scene.elements.items():
        title = f"{scene.title}: {name}" if scene.title else name
        match element:
            case RotorElement():
                made.append(path.with_name(f"{path.stem}_{name}_plan{path.suffix}"))
                unbalance_plan(element, made[-1], title)
            case EngineElement():
                made.append(path.with_name(f"{path.stem}_{name}_orders{path.suffix}"))
                engine_sheet(element, made[-1], title)
            case GearTrain():
                made.append(path.with_name(f"{path.stem}_{name}_velocities{path.suffix}"))
                gear_sheet(element, made[-1], title)
    return made


def element_tables(scene: Scene) -> str:
    """Tables of the orders of a scene's engines and of the shafts of its gear trains, in words; "" without any."""
    told = []
    for name, element in scene.elements.items():
        match element:
            case EngineElement():
                told.append(f"{name}: orders of the crank\n{engine_table(element)}")
            case GearTrain():
                told.append(f"{name}: {gear_table(element)}")
    return "\n".join(told)
