"""The inertia of a machine as nodes: reduced to its input, and as forces that shake its frame.

Reduced inertia: I(q) = Σ m (v_S/q̇)² + J (ω/q̇)², and its derivative dI/dq = 2 Σ m v·a + J w e, with the transfer
functions of the centres and links. By d'Alembert the inertia forces at uniform speed are −m ω² d²r/dq².
Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on reduction and on balancing.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from engine import mechanism
from engine.graph.nodes import Node
from engine.laws.masses.inertia_forces import inertia_offset
from engine.mechanism.kinematics import Kinematics, MovingPoint
from engine.mechanism.vectors import Vector
from engine.parts.skeleton import CrankInput
from engine.scene.inertia import body_inertia, body_mass, carried_inertia, carried_on
from engine.scene.masses import replacement
from engine.scene.scene import Numbers, Scene

Terms = list[tuple[Node, Node]]


class ReducedInertia(NamedTuple):
    """The reduced moment of inertia.

    Attributes
    ----------
    first_kind : Node
        Its constant part, of links that turn uniformly with the input [kg·m², or kg of a sliding input].
    inertia : Node
        All of it.
    slope : Node
        Its derivative by the input.
    slope_terms : tuple of (Node, Node)
        Masses and moments of inertia, with what half the derivative takes of each.
    """

    first_kind: Node
    inertia: Node
    slope: Node
    slope_terms: tuple[tuple[Node, Node], ...]


def reduced_inertia(kinematics: Kinematics) -> ReducedInertia:
    """Reduce the masses of a machine to its input."""
    scene, graph = kinematics.scene, kinematics.graph
    inertia: Terms = []
    slope: Terms = []

    def rotation(own: Node, name: str) -> None:
        link = kinematics.links[name]
        inertia.append((own, link.w * link.w))
        slope.append((own, link.w * link.e))

    about_frame = {n for n, s in scene.shafts.items() if s.geared_to == scene.input.link and s.carrier is None}
    uniform = {scene.input.link} | about_frame
    for name, part in kinematics.masses.items():
        if part.link in uniform:
            continue
        centre = kinematics.mass_centre(name)
        mass = graph.derived(f"mass of {name}", part.mass)
        inertia.append((mass, centre.v.dot(centre.v)))
        slope.append((mass, centre.v.dot(centre.a)))
        if part.inertia is not None:
            rotation(graph.derived(f"inertia of {name}", part.inertia), part.link)
    for name in scene.shafts:
        if name not in about_frame:
            rotation(mechanism.actions.carried_masses.turning_inertia(kinematics, name), name)
    first_kind = graph.derived("first kind inertia", lambda n: _first_kind(kinematics, n))
    return ReducedInertia(
        first_kind,
        graph.combination([(first_kind, graph.one), *inertia]),
        2.0 * graph.combination(slope),
        tuple(slope),
    )


def _first_kind(kinematics: Kinematics, numbers: Numbers) -> float | np.ndarray:
    """Inertia that reduces to a constant: bodies on the input, shafts geared to it and bodies on those."""
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
    """The inertia forces of one body at uniform speed: resultant [N], moment about its centre [N·m], offset [m]."""

    force: Vector
    moment: Node
    offset: Node


def inertia_forces(kinematics: Kinematics, name: str) -> BodyInertiaForces:
    """Inertia forces of a body, even where point masses replace it.

    Parameters
    ----------
    kinematics : Kinematics
    name : str
        Of the body.
    """
    scene, graph = kinematics.scene, kinematics.graph
    centre, e = kinematics.body_centre(name), kinematics.links[scene.bodies[name].link].e
    push = graph.derived(f"inertia force of {name}", _by_square(lambda n: body_mass(scene, name, n)))
    twist = graph.derived(f"inertia moment of {name}", _by_square(lambda n: inertia_of(scene, name, n)))
    gyration2 = graph.derived(
        f"square of the radius of gyration of {name}",
        lambda n: inertia_of(scene, name, n) / body_mass(scene, name, n),
    )
    offset = graph.apply(inertia_offset, gyration2, *centre.a, e)
    force = Vector(*(graph.combination([(push, part)]) for part in centre.a))
    return BodyInertiaForces(force, graph.combination([(twist, e)]), offset)


def inertia_of(scene: Scene, name: str, numbers: Numbers) -> float | np.ndarray:
    """Moment of inertia about a body's centre of mass that the dynamics uses: its own, or that of its point masses.

    Parameters
    ----------
    scene : Scene
    name : str
        Of the body.
    numbers : Numbers
    """
    if scene.bodies[name].replace is None:
        return body_inertia(scene, name, numbers)
    return replacement(scene, name, numbers).inertia()


class FrameShaking(NamedTuple):
    """What shakes the frame at uniform speed: force [N], and moment about a point of the frame [N·m]."""

    force: Vector
    moment: Node


def moment_centre(scene: Scene) -> str:
    """The point or guide of the frame about which the shaking moment is taken."""
    if scene.balance is not None:
        return scene.balance.about
    return scene.input.pivot if isinstance(scene.input, CrankInput) else scene.input.guide


def shaking(
    kinematics: Kinematics, rate: Callable[[MovingPoint], Vector], turning: Callable[[object], Node]
) -> FrameShaking:
    """Inertia forces of all masses and shafts together, by a rate that they are proportional to.

    Parameters
    ----------
    kinematics : Kinematics
    rate, turning : callable
        Of a point and of a link: their second derivatives by the input for uniform speed; their first, which the
        input's acceleration multiplies, at unit speed.
    """
    scene, graph, about = kinematics.scene, kinematics.graph, moment_centre(kinematics.scene)
    centre = kinematics.points[about].r if about in kinematics.points else kinematics.guides[about].r
    x: Terms = []
    y: Terms = []
    moment: Terms = []
    for name, part in kinematics.masses.items():
        at, link = kinematics.mass_centre(name), kinematics.links[part.link]
        push = graph.derived(f"inertia force of mass {name}", _by_square(part.mass))
        x.append((push, rate(at).x))
        y.append((push, rate(at).y))
        moment.append((push, (at.r - centre).cross(rate(at))))
        if part.inertia is not None:
            twist = graph.derived(f"inertia moment of mass {name}", _by_square(part.inertia))
            moment.append((twist, turning(link)))
    own = {name: mechanism.actions.carried_masses.turning_inertia(kinematics, name).compute for name in scene.shafts}
    if carried_on(scene, scene.input.link):
        own[scene.input.link] = partial(carried_inertia, scene, scene.input.link)
    for name, inertia in own.items():
        twist = graph.derived(f"inertia moment of shaft {name}", _by_square(inertia))
        moment.append((twist, turning(kinematics.links[name])))
    return FrameShaking(Vector(graph.combination(x), graph.combination(y)), graph.combination(moment))


def _by_square(mass: Callable[[Numbers], float | np.ndarray]) -> Callable[[Numbers], float | np.ndarray]:
    """−m ω², what a second derivative by the input is multiplied by."""
    return lambda n: -mass(n) * n["input.speed"] ** 2
