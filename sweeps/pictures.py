"""The pictures that a command makes: of a machine its drawing and diagrams, of a result its sweep and best machine."""

from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from engine import Scene
from engine.motion.history import history
from engine.regimes import SteadyRegime
from sweeps.diagrams import diagrams
from sweeps.drawing import picture
from sweeps.errors import PictureError
from sweeps.maps import plot_result
from sweeps.motion_diagrams import courses, cycle_diagrams, history_diagrams
from sweeps.optimising.front_picture import front_picture
from sweeps.optimising.optimum import is_front
from sweeps.plans import reaction_pictures
from sweeps.results import Result
from sweeps.scenefile import with_values
from sweeps.store import columns
from sweeps.sweep_data import SweepData

# Fields larger than this are not read for a picture.
LARGEST_FIELD = 256e6


def machine_pictures(
    scene: Scene, values: Mapping[str, float], path: Path, at: Sequence[float] = (), paths: Sequence[str] = ()
) -> list[Path]:
    """Drawing of a machine and its diagrams, side by side in two files; with regimes its motion in further ones.

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

    Returns
    -------
    list of Path
        The files made.

    Raises
    ------
    PictureError
        The scene has machine elements alone, or its mechanism can't be assembled.
    """
    if scene.input is None:
        raise PictureError("the scene has machine elements alone: there is no mechanism to draw")
    second = path.with_name(f"{path.stem}_diagrams{path.suffix}")
    picture(scene, path, at, paths, values)
    diagrams(scene, second, values)
    return [path, second, *(motion_pictures(with_values(scene, values), path) if scene.regimes else [])]


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
        The files made; none of what a machine that fails doesn't come to.
    """
    seen = history(scene)
    made = [path.with_name(f"{path.stem}_history{path.suffix}")]
    history_diagrams(scene, seen, made[0])
    reached = {part.name for part in courses(seen)}
    for name, regime in scene.regimes.items():
        if isinstance(regime, SteadyRegime) and name in reached:
            made.append(path.with_name(f"{path.stem}_{name}{path.suffix}"))
            cycle_diagrams(scene, seen, name, made[-1])
    return made


def result_pictures(
    path: Path, out: Path | None = None, x: str | None = None, y: str | None = None, colour: str | None = None
) -> list[Path]:
    """Picture of a sweep, chosen by what varies; with nothing asked, also of its best machine and the reactions kept.

    Parameters
    ----------
    path : Path
        Result file.
    out : Path, optional
        Picture; beside the result unless given.
    x, y, colour : str, optional
        Columns to show.

    Returns
    -------
    list of Path
        The files made.
    """
    result = Result(path)
    if result.description.variants == 1:
        values, picture_file = result.variant_values(0), out or path.with_suffix(".png")
        made = machine_pictures(result.scene, values, picture_file)
        return made + reaction_pictures(result.scene, picture_file, result.fields, values)
    best = result.best()
    made = [out or path.with_suffix(".png")]
    if is_front(result) and x is y is colour is None:
        front_picture(result, sweep_data(result, ()), made[0])
        return made
    plot_result(sweep_data(result, (x, y, colour)), made[0], x, y, colour, best)
    if best is not None and out is None and x is y is colour is None and result.scene.input is not None:
        stem = path.with_name(f"{path.stem}_best.png")
        made += machine_pictures(result.scene, result.variant_values(best), stem)
        made += reaction_pictures(result.scene, stem, result.fields, result.variant_values(best))
    return made


def sweep_data(result: Result, asked: Sequence[str | None]) -> SweepData:
    """What is drawn of a result; of its fields those asked for, if they fit in memory."""
    d = result.description
    arrays = dict(result.columns)
    small = d.variants * d.positions * 8 <= LARGEST_FIELD
    arrays |= columns(result.path, [f for f in result.fields if f in asked and small])
    goal = result.goal
    summaries = sorted(result.summaries, key=lambda name: goal is None or name != goal.goal)
    position = columns(result.path, [result.position_name])[result.position_name] if result.fields else None
    return SweepData(
        arrays,
        result.units,
        result.long_names,
        result.varied,
        summaries,
        result.shape,
        np.asarray(result.columns["status"]),
        position,
        result.units.get(result.position_name, "rad"),
        goal.where or "" if goal else "",
        result.candidates(),
    )
