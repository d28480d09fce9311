"""Files of plans at a position, and of reactions and bearing loads over the cycle."""

from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from engine import Scene, pairs_of
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.plans.bearing_loads import bearing_sheet, revolute_pairs
from sweeps.pictures.plans.forces.loads import loaded_links
from sweeps.pictures.plans.pose import MachineCycle
from sweeps.pictures.plans.reaction_curves import reaction_sheet
from sweeps.pictures.plans.sheets import force_sheet, kinematic_sheet
from sweeps.pictures.style import save_beside

# Default number of bearing sheets: a machine of ten dyads has 31 bearings, few of them critical.
MOST_BEARINGS = 8


def plan_pictures(scene: Scene, path: Path, at: float | None = None) -> list[Path]:
    """Draw all plans of a machine at one position, and its reactions over the cycle.

    Velocity and acceleration plans; for a loaded machine also force sheets for each group, the input link and other
    loaded links, the reactions of all pairs, and the loads of the (eight most heavily loaded) bearings.

    Parameters
    ----------
    scene : Scene
    path : Path
        Base name; `_velocity`, `_acceleration`, `_forces_GROUP`, `_reactions` and `_bearing_PAIR` are appended.
    at : float, optional
        Crank angle [rad] or displacement of a sliding input [m] (default: a suitable position).

    Returns
    -------
    list of Path
        Files written.

    Raises
    ------
    PictureError
        The position can't be drawn, or unknown picture format.
    """
    cycle = MachineCycle(scene)
    pose = cycle.at(at)
    made = save_beside(path, ((which, kinematic_sheet(pose, which)) for which in ("velocity", "acceleration")))
    if revolute_pairs(cycle):
        parts = (scene.input.link, *cycle.groups, *loaded_links(pose))
        made += save_beside(path, ((f"forces_{part}", force_sheet(pose, part)) for part in parts))
        made += save_beside(path, _reactions(cycle, _most_loaded(cycle)))
    return made


def bearing_pictures(scene: Scene, path: Path, bearings: Collection[str]) -> list[Path]:
    """Draw some bearing loads over the cycle; arguments as for `plan_pictures`.

    Parameters
    ----------
    scene : Scene
    path : Path
    bearings : collection of str
        Names of revolute pairs.

    Returns
    -------
    list of Path
        Files written.

    Raises
    ------
    PictureError
        No such pair, or it isn't revolute or loaded.
    """
    return save_beside(path, _bearings(MachineCycle(scene), dict.fromkeys(bearings))) if bearings else []


def _most_loaded(cycle: MachineCycle) -> list[str]:
    peaks = {pair.name: np.nanmax(np.abs(cycle.force(f"{pair.name}.reaction"))) for pair in revolute_pairs(cycle)}
    return sorted(peaks, key=peaks.__getitem__, reverse=True)[:MOST_BEARINGS]


def _bearings(cycle: MachineCycle, names: Iterable[str]) -> Iterator[tuple[str, Figure]]:
    for name in names:
        yield f"bearing_{name.replace('.', '_')}", bearing_sheet(cycle, name)


def reaction_pictures(drawn: Scene | DrawnMotion, path: Path, fields: Collection[str]) -> list[Path]:
    """Draw the reactions over the cycle, and the load of each bearing among the fields.

    Parameters
    ----------
    drawn : Scene or DrawnMotion
    path : Path
        As for `plan_pictures`.
    fields : collection of str
        Names of fields; without pair reactions nothing is drawn.

    Returns
    -------
    list of Path
        Files written.
    """
    scene = drawn.scene if isinstance(drawn, DrawnMotion) else drawn
    asked = {name.rpartition(".reaction")[0] for name in fields} & {pair.name for pair in pairs_of(scene)}
    return save_beside(path, _reactions(MachineCycle(drawn), asked)) if asked else []


def _reactions(cycle: MachineCycle, asked: Collection[str]) -> Iterator[tuple[str, Figure]]:
    yield "reactions", reaction_sheet(cycle)
    yield from _bearings(cycle, (pair.name for pair in revolute_pairs(cycle) if pair.name in asked))
