"""A mechanism's drawing over its whole motion: each figure once, in the axes of the link that carries it."""

from collections import Counter
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine import FRAME
from sweeps.pictures.drawing.figures import figures
from sweeps.pictures.drawing.motion import POSITIONS, DrawnMotion
from sweeps.pictures.drawing.names import names_of_points
from sweeps.pictures.drawing.painting import ABOVE
from sweeps.pictures.drawing.symbols import Primitive

# A figure is rigid if its points stay in a link's axes within this share of a hinge radius.
RIGID = 1e-3


class MovingFigure(NamedTuple):
    """A figure of a drawing at all positions.

    Attributes
    ----------
    look : Primitive
        Its points are in the axes that carry it; there are none if its shape changes.
    carrier : int or None
        Which axes of the drawing carry it; None if its shape changes.
    places : complex ndarray (positions, points) or None
        Points of a changing shape [m], NaN where it is absent.
    """

    look: Primitive
    carrier: int | None
    places: np.ndarray | None


class MovingDrawing(NamedTuple):
    """A drawing at evenly spaced positions from the start of the motion to its end.

    Attributes
    ----------
    nodes : ndarray (positions,) of int
        Nodes of the motion; the last one of a cycle is the first again.
    axes : list of (complex ndarray, complex ndarray)
        Origin and direction of axes that carry figures: the frame's and those of links.
    figures : list of MovingFigure
        In painting order.
    """

    nodes: np.ndarray
    axes: list[tuple[np.ndarray, np.ndarray]]
    figures: list[MovingFigure]

    def points_of(self, figure: MovingFigure) -> np.ndarray:
        """Points of a figure at each position [m], complex (positions, points)."""
        if figure.carrier is None:
            return figure.places
        origin, along = self.axes[figure.carrier]
        return origin[:, None] + along[:, None] * np.array(figure.look.points)


def moving_drawing(motion: DrawnMotion, intervals: int = 120) -> MovingDrawing:
    """Record the drawing of a mechanism over its motion.

    Parameters
    ----------
    motion : DrawnMotion
    intervals : int

    Raises
    ------
    PictureError
        A position can't be drawn.
    """
    nodes = spread_nodes(motion, intervals)
    poses = [figures(motion, [at], named=False)[-1] for at in motion.q[nodes]]
    recorded = _aligned(poses, motion.radius)
    recorded.sort(key=lambda pair: (pair[0].layer in ABOVE, pair[0].layer == "paths"))
    axes = [tuple(values[nodes] for values in motion.axes[link]) for link in (FRAME, *motion.links[:-1])]
    found = [_carried(look, places, axes, motion.radius) for look, places in recorded]
    named = names_of_points(motion, nodes, poses)
    for name in zip(*named, strict=True):
        places = np.array([at.points for at in name])
        # Axes of a link would turn the letters.
        found.append(_carried(name[0]._replace(points=()), places, axes[:1], motion.radius))
    return MovingDrawing(nodes, axes, found)


def spread_nodes(motion: DrawnMotion, intervals: int) -> np.ndarray:
    """Evenly spread nodes from the start of the motion to its end; the last one of a cycle is the first again."""
    nodes = np.rint(np.linspace(0, POSITIONS, intervals + 1)).astype(int)
    return nodes % POSITIONS if motion.scene.has_cycle else nodes


def _aligned(poses: Sequence[Sequence[Primitive]], radius: float) -> list[tuple[Primitive, np.ndarray]]:
    """Figures with their points at every position, NaN where one is absent, in painting order."""
    order, found = [], {}
    for k, pose in enumerate(poses):
        seen, after = Counter(), 0
        for p in pose:
            look = p.layer, p.kind, p.fill, p.text, round(p.size / radius, 3), len(p.points)
            key = look, seen[look]
            seen[look] += 1
            if key not in found:
                places = np.full((len(poses), len(p.points)), complex(np.nan, np.nan))
                found[key] = p._replace(points=()), places
                order.insert(after, key)
            after = after + 1 if order[after : after + 1] == [key] else order.index(key) + 1
            found[key][1][k] = p.points
    return [found[key] for key in order]


def _carried(
    look: Primitive, places: np.ndarray, axes: Sequence[tuple[np.ndarray, np.ndarray]], radius: float
) -> MovingFigure:
    """A figure in the first axes in which it is rigid, if any."""
    for carrier, (origin, along) in enumerate(axes):
        own = (places - origin[:, None]) / along[:, None]
        if np.abs(own - own[0]).max() <= RIGID * radius:
            return MovingFigure(look._replace(points=tuple(map(complex, own[0]))), carrier, None)
    return MovingFigure(look, None, places)
