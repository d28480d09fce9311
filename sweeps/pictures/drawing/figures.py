"""A mechanism at some positions as figures in metres, in painting order: later ones cover earlier ones."""

import math
from collections.abc import Sequence

import numpy as np

from engine import Scene, did_you_mean
from sweeps.pictures.drawing.annotations import annotations
from sweeps.pictures.drawing.frame import frame_parts, stands
from sweeps.pictures.drawing.links import plates_and_bars
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.names import input_arrows, names_of_points, texts_beside
from sweeps.pictures.drawing.symbols import Primitive, line
from sweeps.pictures.picture_error import PictureError

USUAL_CRANK_ANGLE = math.pi / 3
# Height of optional lettering, in hinge radii.
TEXT_HEIGHT = 1.9
# Radius of a target point of a path, in hinge radii.
DOT = 0.45


def primitives(drawn: Scene | DrawnMotion, phi: float, paths: Sequence[str] = ()) -> list[Primitive]:
    """Figures of a mechanism at a position, in painting order.

    Parameters
    ----------
    drawn : Scene or DrawnMotion
    phi : float
        Crank angle [rad], or displacement of a sliding input [m]; the nearest of 720 nodes is drawn.
    paths : sequence of str
        Points whose paths over the cycle are drawn.

    Returns
    -------
    list of Primitive
        In metres.

    Raises
    ------
    PictureError
        The position can't be drawn, or a point of `paths` doesn't exist.
    """
    return figures(DrawnMotion.of(drawn), [phi], paths)[-1]


def figures(
    motion: DrawnMotion, at: Sequence[float], paths: Sequence[str] = (), shown: Sequence[str] = (), named: bool = True
) -> list[list[Primitive]]:
    """Figures of a mechanism at several positions; the first is complete and painted last.

    Parameters
    ----------
    motion : DrawnMotion
    at : sequence of float
        Crank angles [rad] or displacements [m].
    paths : sequence of str
        As for `primitives`.
    shown : sequence of str
        Optional items for the first position, from `ANNOTATIONS`.
    named : bool
        Letter the points.

    Returns
    -------
    list of list of Primitive
        The moving links at the other positions, then everything at the first.
    """
    for name in paths:
        if name not in motion.points:
            raise PictureError(f"paths: {name!r} is not a point of this scene; {did_you_mean(name, motion.points)}")
    first, *rest = (motion.node(place) for place in at)
    wanted = [wish for wish in motion.scene.wanted.values() if wish.type == "path"]
    trails = [motion.points[n] for n in dict.fromkeys([*paths, *(wish.point for wish in wanted)])]
    if motion.scene.has_cycle:
        trails = [_once(trail, 0.5 * motion.radius) for trail in trails]
    trails = [line(*trail, layer="paths") for trail in trails]
    places = [complex(*place) for wish in wanted for place in zip(wish.x, wish.y, strict=True)]
    trails += [Primitive("paths", "circle", (place,), DOT * motion.radius, "solid") for place in places]
    others = [[p for part in plates_and_bars(motion, k) for p in part] for k in rest]
    plates, bars = plates_and_bars(motion, first)
    whole = [*frame_parts(motion), *trails, *plates, *stands(motion), *bars, *input_arrows(motion, first)]
    obstacles = [*whole, *(p for other in others for p in other)]
    names = names_of_points(motion, [first], [obstacles])[0] if named else []
    if not shown:
        return [*others, [*whole, *names]]
    more, marked = annotations(motion, first, shown, whole)
    texts = texts_beside([marked], TEXT_HEIGHT * motion.radius, [[*obstacles, *more, *names]], "notes")[0]
    return [*others, [*whole, *more, *names, *texts]]


def _once(path: np.ndarray, near: float) -> np.ndarray:
    """A closed path; half of it if the point returns on the same line, since dashes would fill up."""
    steps = np.diff(path, append=path[:1])
    ends = np.flatnonzero((steps * np.roll(steps, 1).conj()).real < 0)
    if ends.size == 2:
        there, back = path[ends[0] : ends[1] + 1], np.roll(path, -ends[1])[: path.size - np.diff(ends)[0] + 1]
        if max(np.abs(back - p).min() for p in there[::10]) < near:
            return there
    return np.append(path, path[0])


def default_position(motion: DrawnMotion) -> float:
    """Default position: the crank at 60°, or the middle of the input's range; the nearest at which it assembles."""
    usual = USUAL_CRANK_ANGLE if motion.scene.has_cycle else float(motion.q[motion.q.size // 2])
    near = motion.q[motion.assembled]
    return float(near[np.abs(near - usual).argmin()]) if near.size else usual
