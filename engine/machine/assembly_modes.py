"""All ways to put a mechanism of free links together at the first position of its input."""

from engine.mechanism.groups.seed_tables import AssemblyMode, ModeNotTold
from engine.mechanism.mechanics import Mechanics
from engine.scene.scene import Scene


def assembly_modes(scene: Scene) -> dict[str, tuple[AssemblyMode, ...] | None]:
    """The real assembly modes of every group of free links, of groups that hang on others after these.

    None stands for those of a group that hangs on one whose mode the scene doesn't tell.

    Parameters
    ----------
    scene : Scene

    Raises
    ------
    SceneError
        The scene can't be ordered.
    """
    found: dict[str, tuple[AssemblyMode, ...] | None] = {}
    for name, tables in Mechanics(scene).kinematics.seed_tables.items():
        try:
            found[name] = tables.modes
        except ModeNotTold:
            found[name] = None
    return found
