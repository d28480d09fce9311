"""The loads on every link before any reaction is known: the scene's forces and moments, gravity and inertia forces.

By d'Alembert, inertia forces are loads like all others.
"""

from collections.abc import Iterable, Iterator
from functools import partial

from engine.graph.nodes import Node
from engine.laws.masses.link_inertia import inertia_force, inertia_moment
from engine.mechanism.inertia import Inert, inert_parts, inertia_forces
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Grip, LinkForce, LinkLoads, Load
from engine.mechanism.vectors import Vector
from engine.scene.masses import body_mass


class AppliedLoads:
    """The loads on the links of a scene, with inertia forces unless the scene excludes them.

    Parameters
    ----------
    kinematics : Kinematics
    loads : iterable of Load
        All loads, including gravity.
    motion : InputMotion

    Attributes
    ----------
    fields : dict of str to Node
        Forces and moments of the scene by the names of their fields.
    forces : list of LinkForce
        The same one by one, and the inertia forces of shafts.
    on_links : dict of str to Wrench
        Resultant on every link.
    """

    def __init__(self, kinematics: Kinematics, loads: Iterable[Load], motion: InputMotion) -> None:
        self.kinematics, self.motion = kinematics, motion
        self.scene, self.graph = kinematics.scene, kinematics.graph
        self.fields: dict[str, Node] = {}
        self.forces: list[LinkForce] = []
        of_links = LinkLoads(kinematics)
        if self.scene.inertia_in_reactions:
            for one in inert_parts(self.kinematics):
                self._inertia(of_links, one)
        by_grip: dict[Grip, list[Load]] = {}
        for load in loads:
            # At the scene's constant speed brakes are released; regimes apply them.
            if self.motion.given or load.role != "braking":
                by_grip.setdefault(load.grip._replace(direction=None), []).append(load)
        for grip, own in by_grip.items():
            self._apply(of_links, grip, own)
        self.on_links = {name: of_links.total(name) for name in kinematics.links}

    def _inertia(self, of_links: LinkLoads, one: Inert) -> None:
        """Apply the inertia force of a mass, or the moment of a moment of inertia."""
        if one.centre is not None:
            acceleration = self.motion.acceleration(one.centre.a, one.centre.v)
            of_links.push(one.link, one.centre, Vector(*self.graph.apply(inertia_force, one.size, *acceleration)))
            return
        link = self.kinematics.links[one.link]
        moment = epsilon = self.motion.acceleration(link.e, link.w)
        if epsilon is not self.graph.zero:
            moment = self.graph.apply(inertia_moment, one.size, epsilon)
        of_links.twist(one.link, moment)
        if one.of in self.scene.shafts:
            self.forces.append(LinkForce("inertia", one.of, one.link, None, moment=moment))

    def _apply(self, of_links: LinkLoads, grip: Grip, loads: list[Load]) -> None:
        """Apply the scene's forces or moments at one grip, and their reactions on the bearer, if any."""
        courses = [(load, self.motion.power(load.order) * load.characteristic) for load in loads]
        for load, course in courses:
            self._register(load, load.coefficient * course)
        bearer, at = grip.bearer or (None, None)
        if grip.at is None:
            moment = self._total([(load.coefficient, course) for load, course in courses])
            of_links.twist(grip.link, moment)
            if bearer is not None:
                of_links.twist(bearer, -moment)
            return
        x = self._total([(load.coefficient, course * load.grip.direction.x) for load, course in courses])
        y = self._total([(load.coefficient, course * load.grip.direction.y) for load, course in courses])
        of_links.push(grip.link, grip.at, Vector(x, y))
        if bearer is not None:
            of_links.push(bearer, at, -Vector(x, y))

    def _total(self, terms: list[tuple[Node, Node]]) -> Node:
        """Sum of coefficient × curve."""
        return terms[0][0] * terms[0][1] if len(terms) == 1 else self.graph.combination(terms)

    def _register(self, load: Load, value: Node) -> None:
        """Register the fields and link forces of a force or moment of the scene; weights are listed by body."""
        grip, name = load.grip, load.action
        if name == "gravity":
            return
        bearer, at = grip.bearer or (None, None)
        if grip.at is None:
            parts = {f"{name}.acting_moment": value}
            found = LinkForce("load", name, grip.link, bearer, moment=value)
        else:
            force = value * grip.direction
            parts = {f"{name}.force_x": force.x, f"{name}.force_y": force.y}
            found = LinkForce("load", name, grip.link, bearer, grip.at.r, force)
        for field, node in parts.items():
            # A spring's damping adds to its pull.
            self.fields[field] = self.fields[field] + node if field in self.fields else node
        self.forces.append(found)
        if bearer is not None:
            self.forces.append(found.opposite._replace(at=None if grip.at is None else at.r))


def forces_on_bodies(kinematics: Kinematics) -> Iterator[LinkForce]:
    """Weights and inertia forces of the bodies, also where point masses replace them."""
    scene, graph = kinematics.scene, kinematics.graph
    for name, body in scene.bodies.items():
        mass = graph.derived(f"mass of body {name}", partial(body_mass, scene, name))
        field = Vector(graph.zero, graph.number("gravity"))
        if scene.base is not None:
            field += Vector(*(graph.number(f"base.acceleration_{axis}") for axis in "xy"))
        at = kinematics.body_centre(name).r
        yield LinkForce("weight", name, body.link, None, at, -(mass * field))
        if scene.inertia_in_reactions:
            inertia = inertia_forces(kinematics, name)
            yield LinkForce("inertia", name, body.link, None, at, inertia.force)
            yield LinkForce("inertia", name, body.link, None, moment=inertia.moment)
