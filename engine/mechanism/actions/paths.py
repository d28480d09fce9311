"""Direction in which a loaded point or link moves, and where the motion reverses.

A point on a slider of the frame, or on a link pivoted to the frame, comes to rest where the slider or link reverses.
Its speed |v| has a kink there and its direction of motion jumps. Both are therefore written with the sense of motion
held: they are smooth up to the end of the stroke and beyond.
"""

import math
from collections.abc import Callable, Iterable
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node, Return, Stage
from engine.laws.loads import direction_of_motion
from engine.laws.senses import sense
from engine.mechanism.assembly import Slide
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.vectors import Vector
from engine.parts.actions import ForceAction
from engine.parts.skeleton import FRAME
from engine.scene.attachments import carriers, guide_of
from engine.scene.load_formulas import TIME
from engine.scene.pairs import pairs
from engine.scene.scene import Scene


class Along(NamedTuple):
    """Motion of a loaded point or link along its load.

    Attributes
    ----------
    velocity, slope : Node
        Transfer velocity along the direction (of a moment: of the link), and its derivative with respect to the input.
    direction : Vector or None
        Unit vector; None for a moment.
    turning : tuple of (Node, Node) or None
        A curve that changes sign wherever the velocity does, and its derivative with respect to the input; None if the
        velocity is a speed, which never changes sign.
    """

    velocity: Node
    slope: Node
    direction: Vector | None
    turning: tuple[Node, Node] | None

    def switch(self, law: Callable, *operands: Node | float) -> Node:
        """Apply a law to operands and the velocity; its result may change only where the velocity changes sign."""
        graph = self.velocity.graph
        if self.turning is not None:
            graph.switches(*self.turning)
        return graph.apply(law, *operands, self.velocity)


def input_sense(kinematics: Kinematics) -> Node:
    """Sign of the input speed, the direction in which the cycle runs."""
    return kinematics.graph.derived("sense of the input", lambda n: np.sign(n["input.speed"]) + 0.0)


def uniform_time(kinematics: Kinematics) -> Node:
    """Time after the start of the cycle [s], in the input's direction of motion, at constant speed.

    It continues from cycle to cycle, so quantities that depend on it are not periodic in general.
    """
    full, drive = kinematics.scene.has_cycle, kinematics.scene.input

    def begin(numbers: dict) -> float | np.ndarray:
        first = 0.0 if full else numbers["input.start"]
        last = math.tau * drive.revolutions if full else numbers["input.stop"]
        forward = np.asarray(numbers["input.speed"]) > 0.0
        return np.where(forward, np.minimum(first, last), np.maximum(first, last))

    graph = kinematics.graph
    time = (graph.q - graph.derived("position at the start", begin)) * time_per_input(kinematics)
    if full:
        graph.returns((time,), Return(TIME, graph.constant(math.nan)))
    return time


def time_per_input(kinematics: Kinematics) -> Node:
    """Time per unit of input motion [s/rad or s/m]."""
    return kinematics.graph.derived("time for the input's unit", lambda n: 1.0 / n["input.speed"])


def about_link(kinematics: Kinematics, link: str) -> Along:
    """Motion of a link under a moment."""
    turning = kinematics.links[link]
    return Along(turning.w, turning.e, None, (turning.w, turning.e))


def along(kinematics: Kinematics, name: str, force: ForceAction) -> Along:
    """Motion of a loaded point along its force; for a resistance without a direction, along the point's path."""
    if force.angle is None:
        return _along_motion(kinematics, force.on)
    point, link = kinematics.points[force.on], kinematics.links[force.turns_with]
    direction = kinematics.direction(f"forces.{name}.angle").to_frame(link.u)
    straight = _straight(kinematics, force.on)
    if straight is not None and direction.x.stage < Stage.POSITION:
        slide, axis = straight
        share = axis.dot(direction)
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
    # On a line or a circle the length of the tangent is constant.
    return Along(forward * rate * tangent.length, forward * slope * tangent.length, forward * unit, None)


def _track(kinematics: Kinematics, name: str) -> tuple[Node, Node, Vector] | None:
    """Rate, its derivative and tangent of a point on a line or circle of the frame; its velocity is rate · tangent."""
    straight = _straight(kinematics, name)
    if straight is not None:
        slide, axis = straight
        return slide.v, slide.a, axis
    for link in _links_at(kinematics.scene, name):
        turning = kinematics.links[link]
        if turning.origin.v == kinematics.nowhere:
            return turning.w, turning.e, (kinematics.points[name].r - turning.origin.r).normal
    return None


def _straight(kinematics: Kinematics, name: str) -> tuple[Slide, Vector] | None:
    """Slide coordinate and guide direction of a point on a slider of the frame."""
    scene = kinematics.scene
    for link in _links_at(scene, name):
        guide = guide_of(scene, link)
        if guide is not None and scene.guides[guide].link == FRAME:
            return kinematics.slides[link], kinematics.guides[guide].u
    return None


def _links_at(scene: Scene, point: str) -> Iterable[str]:
    """Links to which a point belongs: one, or those that meet in a joint that belongs to none."""
    if point in scene.points:
        return [scene.points[point].link]
    met = [pair for pair in pairs(scene) if pair.joint == point]
    return dict.fromkeys([carriers(scene)[point], *(link for pair in met for link in (pair.link, pair.other))])
