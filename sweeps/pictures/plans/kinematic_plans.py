"""Velocity and acceleration plans as drawings, each vector from the pole or from another point's image."""

import numpy as np
from matplotlib.axes import Axes

from engine import FRAME, display_unit
from sweeps.pictures.plans.lettering import image_name, size_text, subscript, symbol
from sweeps.pictures.plans.paper import Paper
from sweeps.pictures.plans.polygons import PlanKind, VectorPlan
from sweeps.pictures.plans.pose import Pose
from sweeps.pictures.style import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION

# Vectors and rotations below this share of the plan's maximum are rounding.
ROUNDED = 1e-12
COLOURS = {"whole": BLUE, "normal": GREEN, "tangential": VERMILION, "coriolis": PURPLE, "relative": ORANGE}


def draw_plan(plan: VectorPlan, ax: Axes) -> None:
    """Draw a velocity or acceleration plan.

    Parameters
    ----------
    plan : VectorPlan
    ax : matplotlib.axes.Axes
        In their final size on paper, which the scale μ refers to.
    """
    factor, label = display_unit(plan.kind.unit, np.abs([*plan.images.values(), 0j]))
    images = {name: factor * image for name, image in plan.images.items()}
    chains = [
        np.cumsum([images.get(leg.start, 0j), *(factor * step.vector for step in leg.steps)]) for leg in plan.legs
    ]
    paper = Paper(ax, [0j, *images.values(), *(corner for chain in chains for corner in chain[1:])])
    for names in plan.links:
        outline = [images.get(n, 0j) for n in names]
        paper.line([*outline, outline[0]], GREY, 0.4, (0, (4, 2)))
    _points(paper, plan, images)
    led = {leg.end for leg in plan.legs if leg.start not in images and len(leg.steps) == 1}
    for name, image in images.items():
        if name not in led and not name.endswith("'"):
            paper.arrow(0j, image, "", "black", 0.6)
    for leg, chain in zip(plan.legs, chains, strict=True):
        for start, step in zip(chain, leg.steps, strict=False):
            paper.arrow(start, factor * step.vector, step.text, COLOURS[step.kind])
    paper.letter()
    paper.scale_of(plan.kind.letter, label)


def _points(paper: Paper, plan: VectorPlan, images: dict[str, complex]) -> None:
    """The pole and the images; coincident ones share a label."""
    at_rest = [image_name(n) for n in plan.pole if n != FRAME]
    places: list[tuple[complex, list[str]]] = [(0j, [f"$p_{plan.kind.letter}$", *at_rest])]
    for name, image in images.items():
        near = next((names for place, names in places if abs(place - image) < 0.3 * paper.per_mm), None)
        if near is None:
            places.append((image, [image_name(name)]))
        else:
            near.append(image_name(name))
    for place, names in places:
        paper.dot(place, ", ".join(dict.fromkeys(names)))


def plan_lines(pose: Pose, plan: VectorPlan) -> list[str]:
    """Values of a plan by line: points, the parts of vectors, then links."""
    images = [(symbol(plan.kind.letter, subscript(name)), image) for name, image in plan.images.items()]
    whole = [step for leg in plan.legs if len(leg.steps) == 1 and leg.start in plan.images for step in leg.steps]
    parts = [step for leg in plan.legs if len(leg.steps) > 1 for step in leg.steps if step.text]
    every = [*plan.images.values(), *(step.vector for leg in plan.legs for step in leg.steps)]
    least = ROUNDED * max(map(abs, every), default=0.0)
    shown = [*images, *((step.text, step.vector) for step in whole)]
    shown = [(text, abs(vector) if abs(vector) > least else 0.0) for text, vector in shown]
    shown += [(step.text, abs(step.vector)) for step in parts if abs(step.vector) > least]
    return [*(f"{text} = {size_text(size, plan.kind.unit)}" for text, size in shown), *_turns(pose, plan.kind)]


def _turns(pose: Pose, kind: PlanKind) -> list[str]:
    turns = {link: getattr(pose.turn(link), kind.turned) for link in pose.motion.structure.links}
    least, found = ROUNDED * max(map(abs, turns.values()), default=0.0), []
    for link, value in turns.items():
        if abs(value) > least:
            shown = f"{value:.4g}".replace("-", "\N{MINUS SIGN}")
            found.append(f"{symbol(kind.turn_letter, str(pose.number(link)))} = {shown} {kind.turn_unit}")
    return found
