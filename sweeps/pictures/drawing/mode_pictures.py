"""Pictures of the assembly modes of a mechanism, each at the first position of the input."""

from pathlib import Path

from engine import AssemblyMode, CrankInput, Near, Scene, assembly_modes
from sweeps.pictures.drawing.painting import picture
from sweeps.pictures.picture_error import PictureError


def in_mode(scene: Scene, mode: AssemblyMode) -> Scene:
    """The scene put together in another of its assembly modes: `near` tells where that one's points lie."""
    told = {name: Near(x=x, y=y) for name, (x, y) in mode.points.items()}
    return scene.model_copy(update={"near": {**scene.near, **told}})


def _all_told(scene: Scene) -> Scene:
    """The scene with every group whose mode it doesn't tell in the first one of its modes."""
    for _ in scene.links:
        untold = [found[0] for found in assembly_modes(scene).values() if found and not any(m.chosen for m in found)]
        if not untold:
            break
        scene = in_mode(scene, untold[0])
    return scene


def mode_pictures(
    scene: Scene, modes: dict[str, tuple[AssemblyMode, ...] | None], path: Path
) -> dict[Path, PictureError | None]:
    """A picture of each mode of each group, the mechanism at its first position.

    Groups whose mode the scene doesn't tell are drawn in the first of theirs, where the picture is of another's.

    Parameters
    ----------
    scene : Scene
    modes : dict of str to tuple of AssemblyMode
        Of each group of free links; None of one that hangs on a group whose mode isn't told.
    path : Path
        The pictures' names are this one with the group and the mode's number added.

    Returns
    -------
    dict of Path to PictureError
        Why a mode can't be drawn, as where what hangs on the group doesn't reach; None where it is.
    """
    drive = scene.input
    first = 0.0 if isinstance(drive, CrankInput) and drive.start is None else drive.start
    made: dict[Path, PictureError | None] = {}
    for group, found in modes.items():
        for number, mode in enumerate(found or (), 1):
            file = path.with_name(f"{path.stem}_{group}_{number}{path.suffix}")
            shown = in_mode(scene, mode)
            made[file] = None
            try:
                picture(_all_told(shown) if len(modes) > 1 else shown, file, [first])
            except PictureError as refusal:
                made[file] = refusal
    return made
