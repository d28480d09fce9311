"""All ways to put a mechanism of free links together at the first position of its input."""

from engine.mechanism.groups.seed_tables import AssemblyMode
from engine.mechanism.mechanics import Mechanics
from engine.scene.scene import Scene


def assembly_modes(scene: Scene) -> dict[str, tuple[AssemblyMode, ...]]:
    """The real assembly modes of every group of free links, of groups that hang on others after these.

    Parameters
    ----------
    scene : Scene

    Raises
    ------
    SceneError
        The scene can't be ordered, or a group hangs on one whose mode it doesn't tell.
    """
    return {name: tables.modes for name, tables in Mechanics(scene).kinematics.seed_tables.items()}
