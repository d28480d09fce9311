"""Pictures of the assembly modes of a mechanism, each at the first position of the input."""

from pathlib import Path

from engine import AssemblyMode, CrankInput, Near, Scene
from sweeps.pictures.drawing.painting import picture


def in_mode(scene: Scene, mode: AssemblyMode) -> Scene:
    """The scene put together in another of its assembly modes: `near` tells where that one's points lie."""
    told = {name: Near(x=x, y=y) for name, (x, y) in mode.points.items()}
    return scene.model_copy(update={"near": {**scene.near, **told}})


def mode_pictures(scene: Scene, modes: dict[str, tuple[AssemblyMode, ...]], path: Path) -> list[Path]:
    """A picture of each mode of each group, the mechanism at its first position.

    Parameters
    ----------
    scene : Scene
    modes : dict of str to tuple of AssemblyMode
        Of each group of free links.
    path : Path
        The pictures' names are this one with the group and the mode's number added.

    Raises
    ------
    PictureError
        The mechanism can't be drawn.
    """
    drive = scene.input
    first = 0.0 if isinstance(drive, CrankInput) and drive.start is None else drive.start
    made = []
    for group, found in modes.items():
        for number, mode in enumerate(found, 1):
            made.append(path.with_name(f"{path.stem}_{group}_{number}{path.suffix}"))
            picture(in_mode(scene, mode), made[-1], [first])
    return made
