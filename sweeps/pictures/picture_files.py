"""The pictures of a machine that a command makes: its drawing and diagrams, fields, shaking force."""

from collections.abc import Mapping, Sequence
from pathlib import Path

from engine import Mechanics, Scene
from sweeps.pictures.drawing import DrawnMotion, picture
from sweeps.pictures.drawing.figures import default_position
from sweeps.pictures.machine.diagrams import diagrams
from sweeps.pictures.machine.field_curves import POSITIONS, field_curves
from sweeps.pictures.machine.hodographs import hodographs
from sweeps.pictures.picture_error import PictureError
from sweeps.text.scene_text import with_values

Named = tuple[Scene, Mapping[str, float], str]


def machine_pictures(
    scene: Scene,
    values: Mapping[str, float],
    path: Path,
    at: Sequence[float] = (),
    paths: Sequence[str] = (),
    shown: Sequence[str] = (),
    known: Mechanics | None = None,
) -> list[Path]:
    """Drawing of a machine and its diagrams in two files; its regimes and machine elements in others.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        Numbers of the scene (SI) to be replaced.
    path : Path
        File of the drawing; the diagrams' name has `_diagrams` added.
    at : sequence of float
        Positions of the input to draw; one that shows the machine well if none is given.
    paths : sequence of str
        Points whose paths are drawn.
    shown : sequence of str
        What else the drawing shows: some of `ANNOTATIONS`, and `SCALE`.
    known : Mechanics, optional
        As for `MovingMachine`.

    Returns
    -------
    list of Path
        The files made.

    Raises
    ------
    PictureError
        The mechanism can't be assembled, or an element can't be drawn.
    """
    made, whole = [], with_values(scene, values)
    if scene.input is not None:
        made = [path, path.with_name(f"{path.stem}_diagrams{path.suffix}")]
        motion = DrawnMotion(scene, values, known)
        picture(motion, path, at, paths, shown)
        diagrams(motion.machine, made[1])
    # What few machines have is loaded for these alone.
    if scene.regimes:
        from sweeps.pictures.machine.motion_diagrams import motion_pictures

        made += motion_pictures(whole, path)
    if scene.elements:
        from sweeps.pictures.elements.element_pictures import element_pictures

        made += element_pictures(whole, path)
    return made


def field_picture(
    scene: Scene, path: Path, names: Sequence[str], x: str | None = None, positions: int | None = None
) -> Path:
    """Draw fields of a machine over its cycle, or over another field.

    Parameters
    ----------
    scene : Scene
    path : Path
    names : sequence of str
    x : str, optional
        Field along x.
    positions : int, optional

    Returns
    -------
    Path
        The file made.

    Raises
    ------
    PictureError, AskError
        As for `field_curves`.
    """
    field_curves(scene, path, names, x, positions or POSITIONS)
    return path


def hodograph_picture(machine: Named, beside: Named | None, path: Path) -> Path:
    """Draw the shaking force of a machine over its cycle, with another one's or with the scene's as it was given.

    Parameters
    ----------
    machine : (Scene, mapping of path to float, str)
        With numbers (SI) to be replaced, and its name.
    beside : (Scene, mapping of path to float, str), optional
        Another machine; unless given, and where numbers are replaced, the scene without that.
    path : Path
        The name of the picture is this one's with `_hodograph` added.

    Returns
    -------
    Path
        The file made.

    Raises
    ------
    PictureError
        A machine can't be computed or its crank doesn't turn fully.
    """
    scene, values, name = machine
    shown = {}
    if beside is not None:
        shown[beside[2]] = with_values(*beside[:2])
    elif values:
        shown["scene"] = scene
    # Where both have the same name, the first is marked as the one beside.
    shown = {f"{other} (beside)" if other == name else other: s for other, s in shown.items()}
    target = path.with_name(f"{path.stem}_hodograph{path.suffix}")
    hodographs({**shown, name: with_values(scene, values)}, target)
    return target


def drawing_file(scene: Scene, values: Mapping[str, float], out: Path, position: float | None = None) -> None:
    """Drawing of the mechanism at one position, SVG or DXF by the file's ending; where it shows it well, if not said.

    Raises
    ------
    PictureError
        The scene has machine elements alone, or can't be drawn so.
    """
    if scene.input is None:
        raise PictureError("the scene has machine elements alone: there is no mechanism to draw")
    motion = DrawnMotion(scene, values)
    if out.suffix == ".dxf":
        from sweeps.pictures.drawing.dxf import write_dxf

        write_dxf(out, motion, default_position(motion) if position is None else position)
        return
    picture(motion, out, () if position is None else (position,))
