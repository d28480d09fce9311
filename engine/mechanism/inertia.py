"""The inertia of a machine as nodes: reduced to its input, and as shaking forces on its frame.

Reduced inertia: I(q) = Σ m (v_S/q̇)² + J (ω/q̇)², with derivative dI/dq = 2 Σ m v·a + J w e, where v, a, w, e are the
transfer functions of the mass centres and links. By d'Alembert, inertia forces at constant speed are −m ω² d²r/dq².
Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on reduction and on balancing.
"""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from engine import mechanism
from engine.graph.nodes import Node
from engine.laws.masses.link_inertia import inertia_offset
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics, MovingPoint
from engine.mechanism.vectors import Vector
from engine.parts.skeleton import CrankInput
from engine.scene.attachments import geared_to_input
from engine.scene.masses import body_inertia, body_mass, carried_inertia, carried_on, replacement
from engine.scene.scene import Numbers, Scene

Terms = list[tuple[Node, Node]]


class ReducedInertia(NamedTuple):
    """The reduced moment of inertia.

    Attributes
    ----------
    first_kind : Node
        Constant part, from links at a constant speed ratio to the input [kg·m², or kg for a sliding input].
    inertia : Node
        Total.
    slope : Node
        Derivative of the total with respect to the input.
    slope_terms : tuple of (Node, Node)
        Masses and moments of inertia, each with its factor in half the derivative.
    """

    first_kind: Node
    inertia: Node
    slope: Node
    slope_terms: tuple[tuple[Node, Node], ...]


class Inert(NamedTuple):
    """A mass with its centre, or a moment of inertia.

    Attributes
    ----------
    of : str
        Name of the mass or shaft.
    link : str
    size : Node
        [kg], or [kg·m²].
    centre : MovingPoint or None
        None for a moment of inertia.
    """

    of: str
    link: str
    size: Node
    centre: MovingPoint | None = None


def inert_parts(kinematics: Kinematics) -> Iterator[Inert]:
    """Yield the masses and moments of inertia of all bodies and shafts, and of loads carried by the crank."""
    scene, graph = kinematics.scene, kinematics.graph
    for name, part in kinematics.masses.items():
        yield Inert(name, part.link, graph.derived(f"mass of {name}", part.mass), kinematics.mass_centre(name))
        if part.inertia is not None:
            yield Inert(name, part.link, graph.derived(f"inertia of {name}", part.inertia))
    for name in scene.shafts:
        yield Inert(name, name, mechanism.actions.carried_masses.turning_inertia(kinematics, name))
    crank = scene.input.link
    if carried_on(scene, crank):
        carried = graph.derived(f"inertia carried by {crank}", partial(carried_inertia, scene, crank))
        yield Inert(crank, crank, carried)


class MovedMass(NamedTuple):
    """A mass [kg] or moment of inertia [kg·m²], and the first and second derivatives of its position or angle."""

    mass: Node
    first: Vector
    second: Vector


def moved_masses(kinematics: Kinematics) -> list[MovedMass]:
    """All masses except those at a constant speed ratio to the input."""
    uniform, zero = {kinematics.scene.input.link, *geared_to_input(kinematics.scene)}, kinematics.graph.zero

    def moved(one: Inert) -> MovedMass:
        if one.centre is not None:
            return MovedMass(one.size, one.centre.v, one.centre.a)
        link = kinematics.links[one.link]
        return MovedMass(one.size, Vector(link.w, zero), Vector(link.e, zero))

    return [moved(one) for one in inert_parts(kinematics) if one.link not in uniform]


def reduced_inertia(kinematics: Kinematics) -> ReducedInertia:
    """Reduce the masses of a machine to its input."""
    graph, moved = kinematics.graph, moved_masses(kinematics)
    inertia = [(one.mass, one.first.dot(one.first)) for one in moved]
    slope = [(one.mass, one.first.dot(one.second)) for one in moved]
    first_kind = graph.derived("first kind inertia", lambda n: _first_kind(kinematics, n))
    return ReducedInertia(
        first_kind,
        graph.combination([(first_kind, graph.one), *inertia]),
        2.0 * graph.combination(slope),
        tuple(slope),
    )


def _first_kind(kinematics: Kinematics, numbers: Numbers) -> float | np.ndarray:
    """Constant part of the reduced inertia: bodies on the input, shafts geared to it and the bodies on those."""
    scene, total = kinematics.scene, 0.0
    ratios = {scene.input.link: 1.0} if isinstance(scene.input, CrankInput) else {}
    for name, shaft in scene.shafts.items():
        if shaft.geared_to == scene.input.link and shaft.carrier is None:
            ratios[name] = numbers[f"shafts.{name}.ratio"]
            total = total + numbers[f"shafts.{name}.inertia"] * ratios[name] ** 2
    for name, ratio in ratios.items():
        total = total + carried_inertia(scene, name, numbers) * ratio**2
    for part in kinematics.masses.values():
        mass = part.mass(numbers)
        if part.link in ratios:
            radius2 = part.along(numbers) ** 2 + part.across(numbers) ** 2
            inertia = 0.0 if part.inertia is None else part.inertia(numbers)
            total = total + (mass * radius2 + inertia) * ratios[part.link] ** 2
        elif part.link == scene.input.link:
            total = total + mass
    return total


class BodyInertiaForces(NamedTuple):
    """Inertia forces of one body at constant speed: resultant [N], moment about its mass centre [N·m], offset [m]."""

    force: Vector
    moment: Node
    offset: Node


def inertia_forces(kinematics: Kinematics, name: str) -> BodyInertiaForces:
    """Inertia forces of the body `name`, also where point masses replace the body."""
    scene, graph = kinematics.scene, kinematics.graph
    centre, e = kinematics.body_centre(name), kinematics.links[scene.bodies[name].link].e
    mass = graph.derived(f"mass of body {name}", partial(body_mass, scene, name))
    inertia = graph.derived(f"inertia of body {name}", partial(inertia_of, scene, name))
    push, twist = (_by_square(size) for size in (mass, inertia))
    gyration2 = graph.derived(
        f"square of the radius of gyration of {name}",
        lambda n: inertia_of(scene, name, n) / body_mass(scene, name, n),
    )
    offset = graph.apply(inertia_offset, gyration2, *centre.a, e)
    force = Vector(*(graph.combination([(push, part)]) for part in centre.a))
    return BodyInertiaForces(force, graph.combination([(twist, e)]), offset)


def inertia_of(scene: Scene, name: str, numbers: Numbers) -> float | np.ndarray:
    """Moment of inertia about a body's mass centre as used in the dynamics: its own, or that of its point masses."""
    if scene.bodies[name].replace is None:
        return body_inertia(scene, name, numbers)
    return replacement(scene, name, numbers).inertia()


class FrameShaking(NamedTuple):
    """Shaking force on the frame at constant speed [N], and shaking moment about a point of the frame [N·m]."""

    force: Vector
    moment: Node


def moment_centre(scene: Scene) -> str:
    """Point or guide of the frame about which the shaking moment is taken."""
    if scene.balance is not None:
        return scene.balance.about
    return scene.input.pivot if isinstance(scene.input, CrankInput) else scene.input.guide


def shaking(
    kinematics: Kinematics, rate: Callable[[MovingPoint], Vector], turning: Callable[[object], Node]
) -> FrameShaking:
    """Sum the inertia forces of all masses and shafts; they are proportional to `rate` and `turning`.

    Parameters
    ----------
    kinematics : Kinematics
    rate, turning : callable
        Derivative of a point and of a link with respect to the input: the second for the forces at constant speed, the
        first for the forces per unit input acceleration (at unit speed).
    """
    graph, about = kinematics.graph, moment_centre(kinematics.scene)
    centre = kinematics.points[about].r if about in kinematics.points else kinematics.guides[about].r
    x: Terms = []
    y: Terms = []
    moment: Terms = []
    for one in inert_parts(kinematics):
        factor, at = _by_square(one.size), one.centre
        if at is None:
            moment.append((factor, turning(kinematics.links[one.link])))
        else:
            x.append((factor, rate(at).x))
            y.append((factor, rate(at).y))
            moment.append((factor, (at.r - centre).cross(rate(at))))
    return FrameShaking(Vector(graph.combination(x), graph.combination(y)), graph.combination(moment))


def _by_square(mass: Node) -> Node:
    """−m ω², the factor of a second derivative with respect to the input."""
    return -mass * InputMotion.uniform(mass.graph).square
