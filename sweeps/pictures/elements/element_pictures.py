"""Pictures of the machine elements of a scene: plans of rotors, sheets of engines and cams; tables in words."""

from pathlib import Path

from engine import CamElement, EngineElement, RotorElement, Scene
from sweeps.pictures.elements.cam_sheet import cam_sheet
from sweeps.pictures.elements.engine_sheet import engine_sheet, engine_table
from sweeps.pictures.elements.unbalance_plan import unbalance_plan


def element_pictures(scene: Scene, path: Path) -> list[Path]:
    """Draw the rotors, engines and cams of a scene.

    Parameters
    ----------
    scene : Scene
    path : Path
        The names of the pictures are this one's with the element's name and `_plan`, `_orders` or `_cam` added.

    Returns
    -------
    list of Path
        The files made; other elements have no pictures.

    Raises
    ------
    PictureError
        The file's ending isn't a picture's, a cam's follower doesn't reach it, or the file can't be written.
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
            case CamElement():
                made.append(path.with_name(f"{path.stem}_{name}_cam{path.suffix}"))
                cam_sheet(element, made[-1], title)
    return made


def element_tables(scene: Scene) -> str:
    """Tables of the orders of a scene's engines, in words; "" without engines."""
    engines = {name: e for name, e in scene.elements.items() if isinstance(e, EngineElement)}
    return "\n".join(f"{name}: orders of the crank\n{engine_table(engine)}" for name, engine in engines.items())
