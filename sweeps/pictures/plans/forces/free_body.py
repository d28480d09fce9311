"""Free-body diagram of a link with all forces, moments and friction circles."""

import cmath
import math

import numpy as np
from matplotlib.axes import Axes

from sweeps.pictures.plans.forces.force_plan import colour_of
from sweeps.pictures.plans.forces.link_figure import link_figure
from sweeps.pictures.plans.forces.loads import DrawnLoad, loads_on_links
from sweeps.pictures.plans.lettering import subscript
from sweeps.pictures.plans.paper import Paper
from sweeps.pictures.plans.pose import Pose

# On paper [mm]: longest and shortest arrow, gap between collinear ones, radius of a moment's arc.
LONGEST, SHORTEST, APART, ARC = 15.0, 6.0, 1.8, 4.5
# Minimum half-width of the drawing, in hinge radii.
LEAST = 9.0
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
    loads = _felt(loads_on_links(pose)[link], pose.motion.radius)
    figure = link_figure(pose, link)
    outline = np.array([p for primitive in figure for p in primitive.points])
    middle = complex(outline.real.min() + outline.real.max(), outline.imag.min() + outline.imag.max()) / 2
    # A single slider is drawn at symbol size.
    least = middle + LEAST * pose.motion.radius * np.array([-1 - 1j, 1 + 1j])
    places = [load.at for load in loads if not load.is_moment]
    paper = Paper(ax, [*outline, *least, *places], margin=LONGEST + 4)
    paper.figures(figure)
    for name in pose.motion.members(link):
        paper.name(complex(pose.motion.points[name][pose.k]), f"${subscript(name)}$", clear=1.3)
    for load in loads:
        if load.rho > SEEN * paper.per_mm:
            paper.line(load.middle + load.rho * np.exp(2j * np.pi * np.arange(49) / 48), colour_of(load))
    _forces(paper, [load for load in loads if not load.is_moment], middle)
    for i, load in enumerate(load for load in loads if load.is_moment):
        _moment(paper, middle, load, ARC + 2 * i)
    paper.letter()
    return loads


def _felt(loads: list[DrawnLoad], length: float) -> list[DrawnLoad]:
    """Loads above rounding."""
    force = max((abs(load.force) for load in loads), default=0.0)
    moment = max([force * length, *(abs(load.moment) for load in loads)])
    return [load for load in loads if abs(load.force) > NOTHING * force or abs(load.moment) > NOTHING * moment]


def _forces(paper: Paper, loads: list[DrawnLoad], middle: complex) -> None:
    """Arrows at their points; collinear ones side by side."""
    greatest = max((abs(load.force) for load in loads), default=1.0)
    drawn: list[tuple[complex, complex]] = []
    for load in sorted(loads, key=lambda load: -abs(load.force)):
        u = load.force / abs(load.force)
        length = SHORTEST + (LONGEST - SHORTEST) * math.sqrt(abs(load.force) / greatest)
        inward = middle - load.at
        # A force into the link ends at its point, others start there.
        presses = abs(inward) > 3 * paper.per_mm and (u.conjugate() * inward).real > 0.5 * abs(inward)
        beside = sum(abs(at - load.at) < 2 * paper.per_mm and abs((u.conjugate() * v).imag) < 0.15 for at, v in drawn)
        shift = APART * paper.per_mm * 1j * (u if u.imag > 0 or (u.imag == 0 and u.real > 0) else -u) * beside
        start = load.at + shift - (length * paper.per_mm * u if presses else 0)
        paper.arrow(start, length * paper.per_mm * u, load.text, colour_of(load))
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
