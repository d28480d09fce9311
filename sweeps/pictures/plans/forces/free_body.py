"""Free-body diagram of a link with all forces, moments and friction circles."""

import cmath
import math
from collections.abc import Iterator

import numpy as np
from matplotlib.axes import Axes

from sweeps.pictures.drawing import Primitive, bounds
from sweeps.pictures.drawing.frame import frame_parts
from sweeps.pictures.drawing.links import plates_and_bars
from sweeps.pictures.plans.forces.force_plan import colour_of
from sweeps.pictures.plans.forces.loads import DrawnLoad, loads_on_links
from sweeps.pictures.plans.lettering import subscript
from sweeps.pictures.plans.paper import Paper, size_of
from sweeps.pictures.plans.pose import Pose

# On paper [mm]: longest and shortest arrow, gap between collinear ones, radius of a moment's arc.
LONGEST, SHORTEST, APART, ARC = 15.0, 6.0, 1.8, 4.5
# Margin for letters [mm].
MARGIN = 7.0
# Number of iterations to fit a drawing to its paper.
FITTED = 5
# Minimum half-width of the drawing, in hinge radii.
LEAST = 12.0
# Minimum radius of a friction circle [mm].
SEEN = 0.2
# Smaller shares of the maximum are rounding.
NOTHING = 1e-10


def free_body(pose: Pose, link: str, ax: Axes) -> list[DrawnLoad]:
    """Draw a single link with its loads as arrows at their points, not to scale.

    Parameters
    ----------
    pose : Pose
    link : str
    ax : matplotlib.axes.Axes
        In their final size on paper.

    Returns
    -------
    list of DrawnLoad
        Loads on the link.
    """
    loads, figure = _above_rounding(loads_on_links(pose)[link], pose.motion.radius), _link_figure(pose, link)
    middle, cloud = _spread(pose, figure, loads, size_of(ax))
    paper = Paper(ax, cloud, margin=MARGIN, to_scale=False)
    paper.figures(figure)
    for name in pose.motion.members(link):
        paper.name(pose.place(name), f"${subscript(name)}$", clear=1.3)
    for load in loads:
        if load.rho > SEEN * paper.per_mm:
            paper.line(load.middle + load.rho * np.exp(2j * np.pi * np.arange(49) / 48), colour_of(load))
    for load, start, vector in _arrows(loads, middle, paper.per_mm):
        paper.arrow(start, vector, load.text, colour_of(load))
    for i, load in enumerate(load for load in loads if load.is_moment):
        _moment(paper, middle, load, ARC + 2 * i)
    paper.letter()
    return loads


def _link_figure(pose: Pose, link: str) -> list[Primitive]:
    """A link as drawn in the mechanism, with its joints and its cam or wheel."""
    plates, bars = plates_and_bars(pose.motion, pose.k)
    joints = pose.motion.members(link)
    whole = (*frame_parts(pose.motion), *plates, *bars)
    return [p for p in whole if p.link == link or (p.layer == "joints" and p.text in joints)]


def height_of_body(pose: Pose, link: str, width: float, most: float) -> float:
    """Height on paper of a free body of a width, at most `most` [mm].

    Parameters
    ----------
    pose : Pose
    link : str
    width, most : float
    """
    loads, room = _above_rounding(loads_on_links(pose)[link], pose.motion.radius), complex(width, most)
    _, cloud = _spread(pose, _link_figure(pose, link), loads, room)
    return float(np.ptp(cloud.imag)) / _per_mm(cloud, room) + 2 * MARGIN


def _per_mm(cloud: np.ndarray, size: complex) -> float:
    """Metres per millimetre of paper of a size [mm]."""
    return max(np.ptp(cloud.real) / (size.real - 2 * MARGIN), np.ptp(cloud.imag) / (size.imag - 2 * MARGIN))


def _spread(pose: Pose, figure: list[Primitive], loads: list[DrawnLoad], size: complex) -> tuple[complex, np.ndarray]:
    """Middle of a link, and the points, including arrows, that must fit on paper of a size [mm]."""
    corners = bounds(figure)
    middle = sum(corners) / 2
    # A single slider is drawn at symbol size.
    least = middle + LEAST * pose.motion.radius * np.array([-1, 1, -0.5j, 0.5j])
    body = cloud = np.array([*corners, *least, *(load.at for load in loads if not load.is_moment)])
    # Arrows have a fixed length on paper, so their length in metres depends on the scale.
    for _ in range(FITTED):
        arrows = [(start, start + vector) for _, start, vector in _arrows(loads, middle, _per_mm(cloud, size))]
        cloud = np.concatenate([body, *np.reshape(arrows, (-1, 2))])
    return middle, cloud


def _above_rounding(loads: list[DrawnLoad], length: float) -> list[DrawnLoad]:
    """Loads above rounding."""
    force = max((abs(load.force) for load in loads), default=0.0)
    moment = max([force * length, *(abs(load.moment) for load in loads)])
    return [load for load in loads if abs(load.force) > NOTHING * force or abs(load.moment) > NOTHING * moment]


def _arrows(loads: list[DrawnLoad], middle: complex, per_mm: float) -> Iterator[tuple[DrawnLoad, complex, complex]]:
    """Forces with the starts and vectors of their arrows; collinear ones side by side."""
    forces = [load for load in loads if not load.is_moment]
    greatest = max((abs(load.force) for load in forces), default=1.0)
    drawn: list[tuple[complex, complex]] = []
    for load in sorted(forces, key=lambda load: -abs(load.force)):
        u = load.force / abs(load.force)
        length = SHORTEST + (LONGEST - SHORTEST) * math.sqrt(abs(load.force) / greatest)
        inward = middle - load.at
        # A force into the link ends at its point, others start there.
        presses = abs(inward) > 3 * per_mm and (u.conjugate() * inward).real > 0.5 * abs(inward)
        beside = sum(abs(at - load.at) < 2 * per_mm and abs((u.conjugate() * v).imag) < 0.15 for at, v in drawn)
        shift = APART * per_mm * 1j * (u if u.imag > 0 or (u.imag == 0 and u.real > 0) else -u) * beside
        yield load, load.at + shift - (length * per_mm * u if presses else 0), length * per_mm * u
        drawn.append((load.at, u))


def _moment(paper: Paper, centre: complex, load: DrawnLoad, radius: float) -> None:
    """An arc with arrowhead about the link's middle, in the sense of the moment."""
    sense = math.copysign(1.0, load.moment)
    angles = math.pi / 2 + sense * np.linspace(-1.9, 1.5, 40)
    arc = centre + radius * paper.per_mm * np.exp(1j * angles)
    paper.line(arc, colour_of(load), 1.0)
    tangent = sense * 1j * cmath.exp(1j * float(angles[-1]))
    paper.arrow(complex(arc[-1]), 3.0 * paper.per_mm * tangent, "", colour_of(load))
    paper.name(complex(arc[20]), load.text, colour_of(load))
