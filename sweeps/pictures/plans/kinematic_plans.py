"""Velocity and acceleration plans as drawings, each vector from the pole or from another point's image."""

import numpy as np
from matplotlib.axes import Axes

from engine import FRAME, display_unit
from sweeps.pictures.plans.lettering import image_name, subscript, symbol
from sweeps.pictures.plans.paper import Paper
from sweeps.pictures.plans.polygons import VectorPlan, accelerations, velocities
from sweeps.pictures.plans.pose import Pose
from sweeps.pictures.style import BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION

# Vectors and rotations below this share of the plan's maximum are rounding.
ROUNDED = 1e-12
COLOURS = {"whole": BLUE, "normal": GREEN, "tangential": VERMILION, "coriolis": PURPLE, "relative": ORANGE}


def velocity_plan(pose: Pose, ax: Axes) -> VectorPlan:
    """Draw the velocity plan.

    Parameters
    ----------
    pose : Pose
    ax : matplotlib.axes.Axes
        In their final size on paper, which the scale μ refers to.

    Returns
    -------
    VectorPlan
        The plan as numbers.
    """
    plan = velocities(pose)
    _draw(plan, ax, "v", "m s-1")
    return plan


def acceleration_plan(pose: Pose, ax: Axes) -> VectorPlan:
    """Draw the acceleration plan at constant input speed; arguments as for `velocity_plan`."""
    plan = accelerations(pose)
    _draw(plan, ax, "a", "m s-2")
    return plan


def _draw(plan: VectorPlan, ax: Axes, letter: str, unit: str) -> None:
    factor, label = display_unit(unit, np.abs([*plan.images.values(), 0j]))
    plan = _scaled(plan, factor)
    paper = Paper(ax, [0j, *plan.images.values(), *_corners(plan)])
    for names in plan.links:
        outline = [plan.images.get(n, 0j) for n in names]
        paper.line([*outline, outline[0]], GREY, 0.4, (0, (4, 2)))
    _points(paper, plan, letter)
    led = {leg.end for leg in plan.legs if leg.start not in plan.images and len(leg.steps) == 1}
    for name, image in plan.images.items():
        if name not in led and not name.endswith("'"):
            paper.arrow(0j, image, "", "black", 0.6)
    for leg in plan.legs:
        at = plan.images.get(leg.start, 0j)
        for step in leg.steps:
            paper.arrow(at, step.vector, step.text, COLOURS[step.kind])
            at += step.vector
    paper.letter()
    paper.scale_of(letter, label)


def _scaled(plan: VectorPlan, factor: float) -> VectorPlan:
    """The plan with its vectors in the unit shown."""
    legs = [
        leg._replace(steps=type(leg.steps)(step._replace(vector=factor * step.vector) for step in leg.steps))
        for leg in plan.legs
    ]
    return plan._replace(images={name: factor * image for name, image in plan.images.items()}, legs=legs)


def _corners(plan: VectorPlan) -> list[complex]:
    """Intermediate points of legs."""
    found = []
    for leg in plan.legs:
        found += list(plan.images.get(leg.start, 0j) + np.cumsum([step.vector for step in leg.steps]))
    return found


def _points(paper: Paper, plan: VectorPlan, letter: str) -> None:
    """The pole and the images; coincident ones share a label."""
    at_rest = [image_name(n) for n in plan.pole if n != FRAME]
    places: list[tuple[complex, list[str]]] = [(0j, [f"$p_{letter}$", *at_rest])]
    for name, image in plan.images.items():
        near = next((names for place, names in places if abs(place - image) < 0.3 * paper.per_mm), None)
        if near is None:
            places.append((image, [image_name(name)]))
        else:
            near.append(image_name(name))
    for place, names in places:
        paper.dot(place, ", ".join(dict.fromkeys(names)))


def velocity_lines(pose: Pose, plan: VectorPlan) -> list[str]:
    """Values of a velocity plan by line: points, then links."""
    return [*_values(plan, "v", "m s-1"), *_turns(pose, r"\omega", 0, "rad/s")]


def acceleration_lines(pose: Pose, plan: VectorPlan) -> list[str]:
    """Values of an acceleration plan by line."""
    steps = [step for leg in plan.legs if len(leg.steps) > 1 for step in leg.steps]
    sizes = [(step.text, _size(plan, step.vector)) for step in steps if step.text]
    parts = [f"{text} = {_shown(size, 'm s-2')}" for text, size in sizes if size]
    return [*_values(plan, "a", "m s-2"), *parts, *_turns(pose, r"\varepsilon", 1, "rad/s²")]


def _values(plan: VectorPlan, letter: str, unit: str) -> list[str]:
    images = [(symbol(letter, subscript(name)), image) for name, image in plan.images.items()]
    whole = [step for leg in plan.legs if len(leg.steps) == 1 and leg.start in plan.images for step in leg.steps]
    told = [*images, *((step.text, step.vector) for step in whole)]
    return [f"{text} = {_shown(_size(plan, vector), unit)}" for text, vector in told]


def _shown(size: float, unit: str) -> str:
    factor, label = display_unit(unit, np.array([size]))
    return f"{factor * size:.4g} {label}"


def _size(plan: VectorPlan, vector: complex) -> float:
    """Magnitude of a plan's vector; 0 if only rounding."""
    every = [*plan.images.values(), *(step.vector for leg in plan.legs for step in leg.steps)]
    return abs(vector) if abs(vector) > ROUNDED * max(map(abs, every)) else 0.0


def _turns(pose: Pose, letter: str, which: int, unit: str) -> list[str]:
    turns = {link: pose.turn(link)[which] for link in pose.cycle.structure.links}
    least, found = ROUNDED * max(map(abs, turns.values()), default=0.0), []
    for link, value in turns.items():
        if abs(value) > least:
            shown = f"{value:.4g}".replace("-", "\N{MINUS SIGN}")
            found.append(f"{symbol(letter, str(pose.number(link)))} = {shown} {unit}")
    return found
