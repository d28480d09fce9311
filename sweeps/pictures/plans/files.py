"""Files of plans at a position, and of reactions and bearing loads over the cycle."""

from collections.abc import Collection, Iterable, Iterator
from pathlib import Path

from matplotlib.figure import Figure

from engine import Scene, pairs_of
from sweeps.pictures.drawing import DrawnMotion
from sweeps.pictures.plans.bearing_loads import bearing_sheet, loaded_bearings
from sweeps.pictures.plans.forces.loads import loaded_links
from sweeps.pictures.plans.pose import pose_at
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
    motion = DrawnMotion(scene)
    pose = pose_at(motion, at)
    made = save_beside(path, ((which, kinematic_sheet(pose, which)) for which in ("velocity", "acceleration")))
    if peaks := loaded_bearings(motion):
        parts = (scene.input.link, *motion.groups, *loaded_links(pose))
        made += save_beside(path, ((f"forces_{part}", force_sheet(pose, part)) for part in parts))
        made += save_beside(path, _reactions(motion, sorted(peaks, key=lambda name: -peaks[name])[:MOST_BEARINGS]))
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
    return save_beside(path, _bearings(DrawnMotion(scene), dict.fromkeys(bearings))) if bearings else []


def _bearings(motion: DrawnMotion, names: Iterable[str]) -> Iterator[tuple[str, Figure]]:
    for name in names:
        yield f"bearing_{name.replace('.', '_')}", bearing_sheet(motion, name)


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
    return save_beside(path, _reactions(DrawnMotion.of(drawn), asked)) if asked else []


def _reactions(motion: DrawnMotion, asked: Collection[str]) -> Iterator[tuple[str, Figure]]:
    yield "reactions", reaction_sheet(motion)
    yield from _bearings(motion, (name for name in loaded_bearings(motion) if name in asked))
