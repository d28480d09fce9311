"""The pictures that a command makes: of a machine its drawing and diagrams, of a result its sweep and best machine."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from engine import Mechanics, Scene, SteadyRegime, Verdict, history, history_fields
from sweeps.optimising.optimum import is_front
from sweeps.pictures.drawing import DrawnMotion, picture
from sweeps.pictures.drawing.figures import default_position
from sweeps.pictures.elements.element_pictures import element_pictures
from sweeps.pictures.machine.diagrams import diagrams
from sweeps.pictures.machine.field_curves import POSITIONS, field_curves
from sweeps.pictures.machine.hodographs import hodographs
from sweeps.pictures.machine.motion_diagrams import courses, cycle_diagrams, history_diagrams
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.plans import reaction_pictures
from sweeps.pictures.sweep.front_picture import front_picture
from sweeps.pictures.sweep.maps import plot_result
from sweeps.pictures.sweep.sweep_data import SweepData, evenly_chosen
from sweeps.report.sweep_result import SweepResult
from sweeps.store import read_columns
from sweeps.study.sensitivity import RSS, WORST_CASE
from sweeps.text.scene_text import with_values

Named = tuple[Scene, Mapping[str, float], str]

# Fields larger than this are not read for a picture.
LARGEST_FIELD = 256e6
# More variants than a picture has dots aren't drawn.
MOST_DRAWN = 1_000_000


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
    of_elements = element_pictures(with_values(scene, values), path)
    if scene.input is None:
        return of_elements
    second = path.with_name(f"{path.stem}_diagrams{path.suffix}")
    motion = DrawnMotion(scene, values, known)
    picture(motion, path, at, paths, shown)
    diagrams(motion.machine, second)
    return [path, second, *(motion_pictures(with_values(scene, values), path) if scene.regimes else []), *of_elements]


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


def motion_pictures(scene: Scene, path: Path) -> list[Path]:
    """History of a machine through its regimes, and the cycle of each of its steady ones.

    Parameters
    ----------
    scene : Scene
    path : Path
        The names of the pictures are this one's with `_history` and `_REGIME` added.

    Returns
    -------
    list of Path
        The files made; without regimes that a failing machine doesn't reach.
    """
    seen = history(scene, fields=[name for name in history_fields(scene) if name.endswith(".reaction")])
    made = [path.with_name(f"{path.stem}_history{path.suffix}")]
    history_diagrams(scene, seen, made[0])
    reached = {part.name for part in courses(seen)}
    for name, regime in scene.regimes.items():
        if isinstance(regime, SteadyRegime) and name in reached:
            made.append(path.with_name(f"{path.stem}_{name}{path.suffix}"))
            cycle_diagrams(scene, seen, name, made[-1])
    return made


def result_pictures(
    result: SweepResult, out: Path | None = None, x: str | None = None, y: str | None = None, colour: str | None = None
) -> list[Path]:
    """Picture of a sweep, chosen by what varies; with nothing asked, also of its best machine and the reactions kept.

    Without a goal, the reactions are those of the first variant that works.

    Parameters
    ----------
    result : SweepResult
    out : Path, optional
        Picture; beside the result unless given.
    x, y, colour : str, optional
        Columns to show.

    Returns
    -------
    list of Path
        The files made.
    """
    result.show_own_units()
    path = result.path
    if result.description.variants == 1:
        values, picture_file = result.variant_values(0), out or path.with_suffix(".png")
        if result.scene.input is None:
            return machine_pictures(result.scene, values, picture_file)
        made = machine_pictures(result.scene, values, picture_file, known=result.mechanics)
        return made + reaction_pictures(result.scene, picture_file, result.fields, values)
    best = result.best()
    made = [out or path.with_suffix(".png")]
    if is_front(result) and x is y is colour is None:
        front_picture(result, sweep_data(result, ())[0], made[0])
        return made
    data, marked = sweep_data(result, (x, y, colour), best)
    plot_result(data, made[0], x, y, colour, marked)
    if out is None and x is y is colour is None:
        made += _pictures_of_one(result, best)
    return made


def _pictures_of_one(result: SweepResult, best: int | None) -> list[Path]:
    """The best machine and the reactions kept; without a goal those of the first variant that works."""
    path = result.path
    if best is None:
        first = result.first_with(Verdict.OK)
        if first is None or result.goal is not None or result.scene.input is None:
            return []
        stem = path.with_name(f"{path.stem}_{first}.png")
        return reaction_pictures(result.scene, stem, result.fields, result.variant_values(first))
    stem, values = path.with_name(f"{path.stem}_best.png"), result.variant_values(best)
    if result.scene.input is None:
        return element_pictures(with_values(result.scene, values), stem)
    made = machine_pictures(result.scene, values, stem, known=result.mechanics)
    return made + reaction_pictures(result.scene, stem, result.fields, values)


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


def sweep_data(
    result: SweepResult, asked: Sequence[str | None], best: int | None = None
) -> tuple[SweepData, int | None]:
    """What is drawn of a result, of more variants than a picture can show fewer; and which of them is the best.

    Parameters
    ----------
    result : SweepResult
    asked : sequence of str or None
        Columns to be shown; of the fields those among them are read, if they fit in memory.
    best : int, optional
        Variant to be marked.
    """
    d, shape, chosen, goal = result.description, result.shape, slice(None), result.goal
    if is_too_many := d.variants > MOST_DRAWN and "search" not in result.record:
        shape, chosen = evenly_chosen(shape, best, MOST_DRAWN)
        best = None if best is None else int(np.searchsorted(chosen, best))
    arrays = result.taken(chosen)
    along = {f: result.along(f) for f in result.fields if f in asked}
    small = [f for f, axis in along.items() if d.variants * axis.values.size * 8 <= LARGEST_FIELD]
    arrays |= {name: rows[chosen] for name, rows in read_columns(result.path, small).items()}
    # Tolerances are shown as bands about their summaries.
    alone = (name for name in result.summaries if not name.endswith((WORST_CASE, RSS)))
    summaries = sorted(alone, key=lambda name: goal is None or name != goal.goal)
    data = SweepData(
        arrays,
        result.units,
        result.long_names,
        result.varied,
        summaries,
        shape,
        arrays["status"],
        along,
        goal.where or "" if goal else "",
        result.candidates(chosen),
        d.variants if is_too_many else None,
    )
    return data, best
