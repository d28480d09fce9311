"""Pictures of the machine elements of a scene: plans of rotors, sheets of engines and governors; tables in words."""

from pathlib import Path

from engine import EngineElement, Governor, RotorElement, Scene, governed_scene
from sweeps.pictures.elements.engine_sheet import engine_sheet, engine_table
from sweeps.pictures.elements.governor_sheet import governor_sheet
from sweeps.pictures.elements.unbalance_plan import unbalance_plan


def element_pictures(scene: Scene, path: Path) -> list[Path]:
    """Draw the rotors, engines and governors of a scene.

    Parameters
    ----------
    scene : Scene
    path : Path
        The names of the pictures are this one's with the element's name and `_plan`, `_orders` or `_governor`
        added.

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
    scene, cycles = governed_scene(scene)
    for name, element in scene.elements.items():
        title = f"{scene.title}: {name}" if scene.title else name
        match element:
            case RotorElement():
                made.append(path.with_name(f"{path.stem}_{name}_plan{path.suffix}"))
                unbalance_plan(element, made[-1], title)
            case EngineElement():
                made.append(path.with_name(f"{path.stem}_{name}_orders{path.suffix}"))
                engine_sheet(element, made[-1], title)
            case Governor():
                made.append(path.with_name(f"{path.stem}_{name}_governor{path.suffix}"))
                governor_sheet(element, made[-1], title, cycles.get(name))
    return made


def element_tables(scene: Scene) -> str:
    """Tables of the orders of a scene's engines, in words; "" without engines."""
    engines = {name: e for name, e in scene.elements.items() if isinstance(e, EngineElement)}
    return "\n".join(f"{name}: orders of the crank\n{engine_table(engine)}" for name, engine in engines.items())
