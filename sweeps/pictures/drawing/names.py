"""Lettering of a drawing: names of points, and arrows of the inputs' motion."""

import math
from collections.abc import Iterable, Sequence

import numpy as np

from engine import CrankInput, SecondCrank, holder_of
from sweeps.pictures.drawing.links import joints
from sweeps.pictures.drawing.motion import DrawnMotion
from sweeps.pictures.drawing.symbols import HALF_LENGTH, Primitive, arrow

# Height of a name in hinge radii.
NAME_HEIGHT = 2.6
# Cost of a text that moves by its height between two drawings; covering an outline over that length costs ten.
MOVING = 0.5
# A second input at rest moves less than this between neighbouring nodes, in radians or hinge radii.
LEAST_STEP = 1e-6


def input_arrows(m: DrawnMotion, k: int) -> list[Primitive]:
    """Arrows of the input's motion, and of second inputs that move at this node."""
    r, drive = m.radius, m.scene.input
    sense = math.copysign(1, m.numbers["input.speed"])
    if isinstance(drive, CrankInput):
        arm = m.numbers.get("input.length", r) * np.exp(1j * m.q[k])
        shown = _turning_arrow(m.points[drive.pivot][k], arm, sense, r)
    else:
        shown = _sliding_arrow(m.points[drive.point][k], sense * m.guides[drive.guide][1][k], r)
    before, after = k - 1, (k + 1) % m.q.size
    for name, second in m.scene.inputs.items():
        (origin, along), seconds_sense = m.axes[name], sense
        if isinstance(second, SecondCrank):
            against = along / m.axes[holder_of(m.scene, second.pivot)][1]
            seconds_sense *= _sign_of_step(np.angle(against[after] / against[before]))
            arms = [m.points[point][k] - origin[k] for point in m.members(name)]
            arm = max(arms, key=abs)
            if seconds_sense:
                shown += _turning_arrow(origin[k], arm if abs(arm) > r else r * along[k], seconds_sense, r)
        else:
            seconds_sense *= _sign_of_step((m.slides[name][after] - m.slides[name][before]) / r)
            if seconds_sense:
                shown += _sliding_arrow(origin[k], seconds_sense * along[k], r)
    return shown


def _sign_of_step(step: float) -> int:
    """Sense of a step between nodes; 0 if only rounding, or undefined."""
    return int(step > LEAST_STEP) - int(step < -LEAST_STEP)


def _turning_arrow(pivot: complex, arm: complex, sense: float, r: float) -> list[Primitive]:
    """Arc ahead of a link's arm about its pivot: across a long arm, else beyond its end."""
    length = abs(arm)
    radius = 0.55 * length if length > 9 * r else length + 3.5 * r
    turn = max(0.6, min(1.2, 9 * r / radius))
    angles = np.angle(arm) + sense * np.linspace(0.25, 0.25 + turn, 24)
    return arrow(pivot + radius * np.exp(1j * angles), r)


def _sliding_arrow(centre: complex, way: complex, r: float) -> list[Primitive]:
    """Arrow ahead of a slider along its motion."""
    face = centre + (HALF_LENGTH + 1) * r * way
    return arrow([face, face + 4 * r * way], r)


def outline_points(drawn: Iterable[Primitive], step: float) -> np.ndarray:
    """Points along all outlines, at most a step apart."""
    outlines = [p.outline() for p in drawn]
    starts, ends = (np.concatenate([line[part] for line in outlines]) for part in (slice(-1), slice(1, None)))
    whole = np.isfinite(starts) & np.isfinite(ends)
    starts, along = starts[whole], (ends - starts)[whole]
    counts = np.minimum(np.ceil(np.abs(along) / step).astype(int) + 1, 400)
    number = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    return np.repeat(starts, counts) + number * np.repeat(along / np.maximum(counts - 1, 1), counts)


def names_of_points(
    m: DrawnMotion, nodes: Sequence[int], drawn: Sequence[Iterable[Primitive]]
) -> list[list[Primitive]]:
    """Names of points, placed where they cover least; they move little from node to node.

    Parameters
    ----------
    m : DrawnMotion
    nodes : sequence of int
        Consecutive; a motion that ends where it starts repeats its first node.
    drawn : sequence of iterable of Primitive
        The drawing at each node.

    Returns
    -------
    list of list of Primitive
        The names at each node.
    """
    named = [[joint for joint in joints(m, k) if joint.text] for k in nodes]
    return texts_beside(named, NAME_HEIGHT * m.radius, drawn)


def texts_beside(
    marked: Sequence[Sequence[Primitive]], height: float, drawn: Sequence[Iterable[Primitive]], layer: str = "names"
) -> list[list[Primitive]]:
    """Texts near their marks, placed where they cover least; they move little from drawing to drawing.

    Parameters
    ----------
    marked : sequence of sequence of Primitive
        The lettered marks, the same in each drawing; the last ones may repeat the first.
    height : float
        Text height [m].
    drawn : sequence of iterable of Primitive
        The figures in each drawing.
    layer : str

    Returns
    -------
    list of list of Primitive
        The texts in each drawing.
    """
    found = [[] for _ in marked]
    marks = [outline_points(figures, 0.3 * height) for figures in drawn]
    around = np.exp(1j * np.radians([45, 135, 0, 180, 90, 270, 315, 225, 20, 70, 110, 160, 200, 250, 290, 340]))
    u, reach = np.tile(around, 5), np.repeat([0.25, 0.5, 1.0, 1.7, 2.6], around.size)
    for same in zip(*marked, strict=True):
        joint = same[0]
        # Dense enough that no other text fits between.
        across = np.linspace(-1, 1, max(5, 2 * len(joint.text)))
        square = np.add.outer(across, 1j * np.linspace(-1, 1, 5)).ravel()
        half = complex(0.36 * len(joint.text), 0.5) * height
        beside = half.real * np.clip(1.5 * u.real, -1, 1) + 1j * half.imag * u.imag
        away = (joint.size + height * reach) * u + beside
        covered = [_covered(there, j.points[0] + away, half) for there, j in zip(marks, same, strict=True)]
        moving = MOVING * np.abs(np.subtract.outer(away, away) / height) ** 2
        sides = _cheapest(3 * np.array(covered) + reach, moving, len(marked) > 1 and marked[0] == marked[-1])
        for i, (j, side) in enumerate(zip(same, sides, strict=True)):
            at = complex(j.points[0] + away[side])
            found[i].append(Primitive(layer, "text", (at,), height, "none", joint.text))
            marks[i] = np.append(marks[i], at + square.real * half.real + 1j * square.imag * half.imag)
    return found


def _cheapest(costs: np.ndarray, moving: np.ndarray, closed: bool) -> list[int]:
    """Choice in each row that minimises the sum of all costs, including those of moves between neighbouring rows.

    Parameters
    ----------
    costs : ndarray (rows, choices)
    moving : ndarray (choices, choices)
    closed : bool
        The last choice is the first one: the cheapest of that row.
    """
    if closed:
        start = costs[0].argmin()
        costs = costs.copy()
        costs[[0, -1]] = np.inf
        costs[[0, -1], start] = 0.0
    total, origins = costs[0], []
    for row in costs[1:]:
        sums = total[:, None] + moving
        origins.append(sums.argmin(axis=0))
        total = sums.min(axis=0) + row
    found = [int(total.argmin())]
    for origin in reversed(origins):
        found.append(int(origin[found[-1]]))
    return found[::-1]


def _covered(marks: np.ndarray, places: np.ndarray, half: complex) -> np.ndarray:
    """Number of obstacles that a name of this half size would cover at each position."""
    near = np.abs(marks - places.mean()) < np.abs(places - places.mean()).max() + 2 * abs(half)
    gap = marks[near] - places[:, None]
    # The imaginary part is half the height; a quarter of it stays clear on either side.
    return ((np.abs(gap.real) < half.real + 0.25 * half.imag) & (np.abs(gap.imag) < 1.2 * half.imag)).sum(axis=1)
