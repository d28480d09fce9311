"""Drawings of a mechanism's assembly modes at the first input position."""

from pathlib import Path

from engine import AssemblyMode, Near, Scene, assembly_modes
from sweeps.pictures.drawing.painting import picture
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import save


def in_mode(scene: Scene, mode: AssemblyMode) -> Scene:
    """The scene in another assembly mode, selected by `near`."""
    told = {name: Near(x=x, y=y) for name, (x, y) in mode.points.items()}
    return scene.model_copy(update={"near": {**scene.near, **told}})


def _with_first_modes(scene: Scene) -> Scene:
    """The scene with the first mode for every group whose mode it leaves open."""
    for _ in scene.links:
        untold = [found[0] for found in assembly_modes(scene).values() if found and not any(m.chosen for m in found)]
        if not untold:
            break
        scene = in_mode(scene, untold[0])
    return scene


def mode_pictures(
    scene: Scene, modes: dict[str, tuple[AssemblyMode, ...] | None], path: Path
) -> dict[Path, PictureError | None]:
    """Draw each mode of each group, the mechanism at its first position.

    Other groups whose mode the scene leaves open are drawn in their first mode.

    Parameters
    ----------
    scene : Scene
    modes : dict of str to tuple of AssemblyMode
        By group of free links; None for one that depends on a group whose mode is open.
    path : Path
        Base name; group and mode number are appended.

    Returns
    -------
    dict of Path to PictureError
        Why a mode can't be drawn, such as links that don't reach; None if it is drawn.
    """
    drive = scene.input
    first = 0.0 if drive.turns_fully else drive.start
    made: dict[Path, PictureError | None] = {}
    for group, found in modes.items():
        for number, mode in enumerate(found or (), 1):
            file = path.with_name(f"{path.stem}_{group}_{number}{path.suffix}")
            shown = in_mode(scene, mode)
            made[file] = None
            try:
                save(picture(_with_first_modes(shown) if len(modes) > 1 else shown, [first]), file)
            except PictureError as refusal:
                made[file] = refusal
    return made
