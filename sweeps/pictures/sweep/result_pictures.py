"""Plots of a result: the sweep, the best machine, the kept reactions."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import Verdict
from sweeps.optimising.optimum import is_front
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.picture_files import machine_pictures
from sweeps.pictures.plans.files import reaction_pictures
from sweeps.pictures.style import save
from sweeps.pictures.sweep.front_picture import front_picture
from sweeps.pictures.sweep.maps import plot_result
from sweeps.pictures.sweep.sweep_data import SweepData, evenly_chosen
from sweeps.report.sweep_result import SweepResult
from sweeps.study.sensitivity import RSS, WORST_CASE
from sweeps.study.study_text import Best

# Larger fields are not read for a plot.
LARGEST_FIELD = 256e6
# Maximum number of variants in a plot.
MOST_DRAWN = 1_000_000


def result_pictures(
    result: SweepResult, out: Path | None = None, x: str | None = None, y: str | None = None, colour: str | None = None
) -> list[Path]:
    """Plot a sweep; without named columns also its best machine and the kept reactions.

    Without a goal, the reactions are those of the first variant that works.

    Parameters
    ----------
    result : SweepResult
    out : Path, optional
        Picture file (default: next to the result, with the names of the columns).
    x, y, colour : str, optional
        Columns to show.

    Returns
    -------
    list of Path
        Files written.
    """
    result.show_own_units()
    is_named, named = out is not None, [name.replace(".", "_") for name in (x, y, colour) if name]
    out = out or result.path.with_name("_".join([result.path.stem, *named]) + ".png")
    if result.file.variants == 1 and not named and not result.where:
        return _pictures_of(result, 0, out)
    best, made = result.best(), [out]
    if not is_named and not named and not is_front(result):
        made += _pictures_of_one(result, best)
    # Written last: if it exists, so do the others.
    save(sweep_figure(result, x, y, colour, best), made[0])
    return made


def sweep_figure(result: SweepResult, x: str | None, y: str | None, colour: str | None, best: int | None) -> Figure:
    """The front of a search with several objectives, unless columns are named, or a sweep as by `plot_result`.

    Parameters
    ----------
    result : SweepResult
    x, y, colour : str or None
        Columns to show.
    best : int or None
        Variant to mark.
    """
    if is_front(result) and x is y is colour is None:
        return front_picture(result, sweep_data(result, ())[0])
    data, marked = sweep_data(result, (x, y, colour), best)
    return plot_result(data, x, y, colour, marked)


def _pictures_of_one(result: SweepResult, best: int | None) -> list[Path]:
    """Plot the best machine and the kept reactions; without a goal those of the first variant that works."""
    path = result.path
    if best is None:
        first = result.first_with(Verdict.OK)
        if first is None or result.goal is not None or result.scene.input is None:
            return []
        stem = path.with_name(f"{path.stem}_{first}.png")
        return reaction_pictures(result.scene_of(first), stem, result.fields)
    return _pictures_of(result, best, path.with_name(f"{path.stem}_best.png"))


def _pictures_of(result: SweepResult, variant: int, stem: Path) -> list[Path]:
    """Plot the machine of a variant and the kept reactions."""
    scene = result.scene_of(variant)
    if scene.input is None:
        return machine_pictures(scene, stem)
    motion = DrawnMotion(scene, result.mechanics)
    return [*machine_pictures(motion, stem), *reaction_pictures(motion, stem, result.fields)]


def sweep_data(
    result: SweepResult, asked: Sequence[str | None], best: int | None = None
) -> tuple[SweepData, int | None]:
    """Plot data of a result, thinned if too large, and the index of the best variant in it.

    Parameters
    ----------
    result : SweepResult
    asked : sequence of str or None
        Columns to show; fields among them are read if they fit in memory.
    best : int, optional
        Variant to mark.
    """
    result.need(filter(None, asked), "plot", (*result.columns, *result.fields))
    variants, shape, chosen = result.file.variants, result.shape, slice(None)
    if is_too_many := variants > MOST_DRAWN and "search" not in result.record:
        shape, chosen = evenly_chosen(shape, best, MOST_DRAWN)
        best = None if best is None else int(np.searchsorted(chosen, best))
    arrays = result.taken(chosen)
    along = {f: result.along(f) for f in result.fields if f in asked}
    small = [f for f, axis in along.items() if variants * axis.values.size * 8 <= LARGEST_FIELD]
    arrays |= {name: result.field_rows(name, chosen) for name in small}
    data = plot_data(result, arrays, shape, result.goal, result.candidates(chosen))
    chosen_of = variants if is_too_many else None
    return data._replace(along=along, condition=result.condition, chosen_of=chosen_of), best


def plot_data(
    result: SweepResult, arrays: dict[str, np.ndarray], shape: Sequence[int], aim: Best | None, candidates: np.ndarray
) -> SweepData:
    """Plot data of some variants of a result, with the objective as the first of its summaries.

    Parameters
    ----------
    result : SweepResult
    arrays : dict of str to ndarray (variants,)
        Columns of these variants.
    shape : sequence of int
        Sizes of their grid.
    aim : Best or None
    candidates : ndarray (variants,) of bool
        Which of them meet its condition.
    """
    # Tolerances appear as bands on their summaries.
    alone = (name for name in result.summaries if not name.endswith((WORST_CASE, RSS)))
    return SweepData(
        arrays,
        result.units,
        result.long_names,
        result.varied,
        sorted(alone, key=lambda name: aim is None or name != aim.goal),
        shape,
        arrays["status"],
        condition=aim.condition if aim else "",
        candidates=candidates,
        listed=result.lists,
        symbols=result.symbols,
    )
