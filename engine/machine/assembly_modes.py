"""All ways to put a mechanism of free links together at the first position of its input, and the one of a variant."""

from collections.abc import Mapping

import numpy as np

from engine.mechanism.groups.seed_tables import AssemblyMode, ModeNotTold
from engine.mechanism.mechanics import Mechanics
from engine.scene.scene import Numbers, Scene, scene_numbers


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


def near_of_variant(scene: Scene, values: Mapping[str, float]) -> dict[str, float] | None:
    """Numbers under `near` that tell a variant's assembly modes, in a scene of its own, as they are carried there.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        Numbers of the scene (SI) that the variant has anew.

    Returns
    -------
    dict of path to float, or None
        None where a mode of the scene isn't reached in the variant, or the scene doesn't tell it.
    """
    if not scene.links or not values:
        return {}
    numbers = Numbers(scene_numbers(scene), {path: np.array([value], float) for path, value in values.items()})
    found: dict[str, float] = {}
    for tables in Mechanics(scene, frozenset(values)).kinematics.seed_tables.values():
        try:
            places = tables.told_places(numbers)
        except ModeNotTold:
            return None
        if places is None:
            return None
        for name, place in places.items():
            found |= {f"near.{name}.{axis}": value for axis, value in zip("xy", place, strict=True)}
    return found
