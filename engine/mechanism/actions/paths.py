"""Along which way a loaded point or link moves, and where it turns back.

A point on a slider of the frame, or on a link that turns about a pivot of the frame, comes to rest where the slider or
link turns back. There its speed |v| has a kink and its direction of motion jumps, so that both are written with the
sense of the motion held: smooth to the very end of its stroke, and beyond.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node, Return, Stage
from engine.laws.loads import direction_of_motion
from engine.laws.senses import sense
from engine.mechanism.assembly import Slide
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.vectors import Vector
from engine.parts.actions import ForceAction
from engine.parts.skeleton import FRAME, SliderInput, Sliding, Yoke
from engine.scene.load_formulas import TIME
from engine.scene.scene import Scene


class Along(NamedTuple):
    """Motion of what is loaded along its load.

    Attributes
    ----------
    velocity, slope : Node
        Transfer velocity along the direction, of a moment that of the link; and its derivative by the input.
    direction : Vector or None
        Unit vector; None for a moment.
    turning : tuple of (Node, Node) or None
        A curve that changes its sign wherever the velocity does, and its derivative by the input; None where the
        velocity is a speed, which never changes it.
    """

    velocity: Node
    slope: Node
    direction: Vector | None
    turning: tuple[Node, Node] | None

    def switch(self, law: Callable, *operands: Node | float) -> Node:
        """A law of some operands and the velocity, whose result changes only where the velocity's sign does."""
        graph = self.velocity.graph
        if self.turning is not None:
            graph.switches(*self.turning)
        return graph.apply(law, *operands, self.velocity)


def input_sense(kinematics: Kinematics) -> Node:
    """Sign of the input's speed: which way the cycle is run through."""
    return kinematics.graph.derived("sense of the input", lambda n: np.sign(n["input.speed"]) + 0.0)


def uniform_time(kinematics: Kinematics) -> Node:
    """Time since the begin of the cycle [s], in the direction in which the input moves, at uniform speed.

    It goes on from cycle to cycle, so that what depends on it doesn't repeat itself.
    """
    full, drive = kinematics.has_cycle, kinematics.scene.input

    def begin(numbers: dict) -> float | np.ndarray:
        first = 0.0 if full else numbers["input.start"]
        last = 2.0 * math.pi * drive.revolutions if full else numbers["input.stop"]
        forward = np.asarray(numbers["input.speed"]) > 0.0
        return np.where(forward, np.minimum(first, last), np.maximum(first, last))

    graph = kinematics.graph
    time = (graph.q - graph.derived("position at the start", begin)) * time_per_input(kinematics)
    if full:
        graph.returns((time,), Return(TIME, graph.constant(math.nan)))
    return time


def time_per_input(kinematics: Kinematics) -> Node:
    """Time that passes for each unit of the input's motion [s/rad or s/m]."""
    return kinematics.graph.derived("time for the input's unit", lambda n: 1.0 / n["input.speed"])


def about_link(kinematics: Kinematics, link: str) -> Along:
    """Motion of a link under a moment."""
    turning = kinematics.links[link]
    return Along(turning.w, turning.e, None, (turning.w, turning.e))


def along(kinematics: Kinematics, name: str, force: ForceAction) -> Along:
    """Motion of a loaded point along its force; of a resistance without a direction, along the point's own motion.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        Of the force.
    force : ForceAction
    """
    if force.angle is None:
        return _along_motion(kinematics, force.on)
    point, link = kinematics.points[force.on], kinematics.links[force.turns_with]
    direction = kinematics.direction(f"forces.{name}.angle").in_axes(link.u)
    straight = _straight(kinematics, force.on)
    if straight is not None and direction.x.stage < Stage.POSITION:
        slide, way = straight
        share = way.dot(direction)
        return Along(slide.v * share, slide.a * share, direction, (slide.v, slide.a))
    velocity = point.v.dot(direction)
    slope = point.a.dot(direction) + link.w * point.v.dot(direction.normal)
    return Along(velocity, slope, direction, (velocity, slope))


def _along_motion(kinematics: Kinematics, name: str) -> Along:
    """Motion of a point along its path: its speed."""
    point, graph = kinematics.points[name], kinematics.graph
    if point.v == kinematics.nowhere:
        return Along(graph.zero, graph.zero, kinematics.nowhere, None)
    track = _track(kinematics, name)
    if track is None:
        speed, unit = point.v.length, Vector(*graph.apply(direction_of_motion, *point.v))
        return Along(speed, point.a.dot(unit), unit, None)
    rate, slope, tangent = track
    graph.switches(rate, slope)
    forward = graph.held(graph.apply(sense, rate))
    unit = Vector(*graph.apply(direction_of_motion, *tangent))
    # On a line or a circle the tangent keeps its length.
    return Along(forward * rate * tangent.length, forward * slope * tangent.length, forward * unit, None)


def _track(kinematics: Kinematics, name: str) -> tuple[Node, Node, Vector] | None:
    """Of a point on a line or a circle of the frame rate · tangent is its velocity: rate, its derivative, tangent."""
    straight = _straight(kinematics, name)
    if straight is not None:
        slide, way = straight
        return slide.v, slide.a, way
    for link in _links_at(kinematics.scene, name):
        turning = kinematics.links[link]
        if turning.origin.v == kinematics.nowhere:
            return turning.w, turning.e, (kinematics.points[name].r - turning.origin.r).normal
    return None


def _straight(kinematics: Kinematics, name: str) -> tuple[Slide, Vector] | None:
    """Of a point on a slider of the frame the slide coordinate and the direction of the guide."""
    for link in _links_at(kinematics.scene, name):
        guide = guide_on_frame(kinematics.scene, link)
        if guide is not None:
            return kinematics.slides[link], kinematics.guides[guide].u
    return None


def guide_on_frame(scene: Scene, link: str) -> str | None:
    """The guide of the frame on which a link slides; None where it slides on none."""
    if isinstance(scene.input, SliderInput) and scene.input.link == link:
        return scene.input.guide
    for group in scene.groups.values():
        for part in (group.first, group.second):
            if part.link == link and isinstance(part, (Sliding, Yoke)) and scene.guides[part.guide].link == FRAME:
                return part.guide
    return None


def _links_at(scene: Scene, point: str) -> tuple[str, ...]:
    """Links to which a point belongs: one, or the two of an inner joint."""
    if point in scene.points:
        return (scene.points[point].link,)
    for group in scene.groups.values():
        if getattr(group, "inner", None) == point:
            return group.first.link, group.second.link
    return (scene.input.link,)
