"""Plot files of a machine: drawing, diagrams, fields, shaking force."""

from collections.abc import Iterator, Sequence
from pathlib import Path

from matplotlib.figure import Figure

from engine import Scene
from sweeps.pictures.drawing import DrawnMotion, picture
from sweeps.pictures.drawing.figures import default_position
from sweeps.pictures.machine.cycle_sheets import indicator_diagrams, motion_of_part
from sweeps.pictures.machine.diagrams import diagrams
from sweeps.pictures.style import format_of, save, save_beside


def machine_pictures(
    drawn: Scene | DrawnMotion,
    path: Path,
    at: Sequence[float] = (),
    paths: Sequence[str] = (),
    shown: Sequence[str] = (),
    parts: Sequence[str] = (),
) -> list[Path]:
    """Draw a machine and its diagrams, regimes and elements to separate files.

    A machine that can be assembled only at some positions has no diagrams over its cycle.

    Parameters
    ----------
    drawn : Scene or DrawnMotion
    path : Path
        File of the drawing; diagrams get `_diagrams` appended.
    at : sequence of float
        Input positions to draw; default: a suitable one.
    paths : sequence of str
        Points whose paths are drawn.
    shown : sequence of str
        Optional items: from `ANNOTATIONS`, and `SCALE`.
    parts : sequence of str
        Sliders and links whose motion is drawn, up to their jerk.

    Returns
    -------
    list of Path
        Files written.

    Raises
    ------
    PictureError
        Unknown extension; the mechanism can't be assembled, or an element can't be drawn.
    """
    format_of(path)
    if isinstance(drawn, Scene) and drawn.input is None:
        return save_beside(path, _sheets(drawn, None, parts))
    motion = DrawnMotion.of(drawn)
    made = save_beside(path, _sheets(motion.scene, motion, parts))
    # Written last: if it exists, so do the others.
    save(picture(motion, at, paths, shown), path)
    return [path, *made]


def _sheets(scene: Scene, motion: DrawnMotion | None, parts: Sequence[str]) -> Iterator[tuple[str, Figure]]:
    """Sheets of a machine, by name."""
    if motion is not None:
        if motion.assembled.all():
            yield "diagrams", diagrams(motion.machine)
        if scene.cylinders and motion.assembled.all():
            yield "cylinders", indicator_diagrams(motion.machine)
        for part in parts:
            yield f"motion_of_{part}", motion_of_part(motion.machine, part)
    # Rarely needed modules are imported on demand.
    if scene.regimes:
        from sweeps.pictures.machine.motion_diagrams import motion_sheets

        yield from motion_sheets(scene)
    if scene.elements:
        from sweeps.pictures.elements.element_pictures import element_sheets

        yield from element_sheets(scene)


def drawing_file(scene: Scene, out: Path, position: float | None = None) -> None:
    """Draw the mechanism at one position (default: a suitable one) as SVG or DXF, by file extension.

    Raises
    ------
    PictureError
        The scene has only machine elements, or can't be drawn.
    """
    motion = DrawnMotion(scene)
    if out.suffix == ".dxf":
        from sweeps.pictures.drawing.dxf import write_dxf

        write_dxf(out, motion, default_position(motion) if position is None else position)
        return
    save(picture(motion, () if position is None else (position,)), out)
