"""The mechanism at one position, to a drawing scale, with named points and numbered links."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.axes import Axes

from engine import quantity_text
from sweeps.pictures.drawing import bounds, figures
from sweeps.pictures.drawing.racks import rack_shapes
from sweeps.pictures.plans.lettering import subscript
from sweeps.pictures.plans.paper import Paper
from sweeps.pictures.plans.pose import Pose
from sweeps.pictures.plans.special_points import SpecialPoint
from sweeps.pictures.style import BLUE, GREY

# Hinge radius on paper [mm], if links are long enough.
HINGE = 0.85


def mechanism_plan(
    pose: Pose, ax: Axes, special: Sequence[SpecialPoint] = (), places: Mapping[str, complex] | None = None
) -> Paper:
    """Draw the mechanism to scale.

    Parameters
    ----------
    pose : Pose
    ax : matplotlib.axes.Axes
        In their final size on paper.
    special : sequence of SpecialPoint, optional
        Special points to draw; those farther away than the mechanism's width are omitted.
    places : mapping of str to complex, optional
        Further named points of the plan [m], such as pitch points.
    """
    motion = pose.motion
    whole = _figures(pose)
    near = [point for point in special if _is_near(point.place, whole)]
    marked = {name: at for name, at in (places or {}).items() if _is_near(at, whole)}
    cloud = [*(point.place for point in near), *marked.values()]
    paper = _laid_out(ax, whole, cloud)
    usual = motion.radius
    motion.radius = min(max(usual, HINGE * paper.per_mm), 2.2 * usual)
    whole = _figures(pose)
    paper = _laid_out(ax, whole, cloud)
    for point in near:
        for bar in point.bars:
            paper.line([pose.place(bar.outer), point.place], GREY, 0.4, (0, (4, 2)))
        paper.dot(point.place, f"${subscript(point.name)}$")
    paper.figures(whole)
    for joint in whole:
        if joint.layer == "joints" and joint.text:
            paper.name(joint.points[0], f"${subscript(joint.text)}$", clear=joint.size / paper.per_mm)
    for name, at in marked.items():
        paper.dot(at, f"${subscript(name)}$")
    for link in pose.motion.structure.links:
        _number(paper, pose, link)
    motion.radius = usual
    paper.letter()
    scale = 1e3 * paper.per_mm
    ratio = f"1 : {scale:g}" if scale >= 1 else f"{1 / scale:g} : 1"
    paper.scale(quantity_text(20 * paper.per_mm, "m"), ratio)
    return paper


def _figures(pose: Pose) -> list:
    return figures(pose.motion, [pose.motion.q[pose.k]], named=False)[-1]


def _is_near(place: complex, drawn: list) -> bool:
    low, high = bounds(drawn)
    return abs(place - (low + high) / 2) < 1.5 * abs(high - low)


def _laid_out(ax: Axes, drawn: list, further: Sequence[complex]) -> Paper:
    ax.clear()
    return Paper(ax, [*bounds(drawn), *further], margin=5.0)


def _number(paper: Paper, pose: Pose, link: str) -> None:
    """A link's number next to its middle (for a rack, the middle of its bar)."""
    if link in pose.scene.racks:
        corners = np.array(next(p.points for p in rack_shapes(pose.motion, pose.k) if p.link == link))
        # A bar may lie far from its link's axes and points.
        half_height = np.abs(np.diff(corners)).min() / 2
        paper.name(complex(corners.mean()), str(pose.number(link)), BLUE, clear=half_height / paper.per_mm + 0.5)
        return
    places = [pose.place(n) for n in pose.motion.members(link)]
    if len(places) > 1:
        a, b = max(((p, q) for p in places for q in places), key=lambda ends: abs(ends[1] - ends[0]))
        middle = (a + b) / 2
    else:
        middle = complex(pose.motion.axes[link][0][pose.k])
    paper.name(middle, str(pose.number(link)), BLUE, clear=1.2 if len(places) > 1 else 2.6)
