"""Kinetostatics of an ordered mechanism as nodes: the reactions in all pairs, last group first.

By d'Alembert, inertia forces are added to the loads on each link. Each group is then in equilibrium under its own loads
and the reactions of the groups that follow it. The last step is the input link: the reaction of its pivot or guide, and
the drive torque or force; second inputs are solved in their order. Gears transmit pure moments unless the pressure
angle of their teeth is given.

Friction in a pair changes the reactions in its own group, and those in all groups solved after it.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on kinetostatics; N. E. Zhukovsky's lever for
the drive torque by virtual power.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from engine import laws, mechanism
from engine.graph.nodes import Node
from engine.laws.masses.link_inertia import inertia_force, inertia_moment
from engine.laws.senses import sense
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.assembly import MovingPoint, Turning
from engine.mechanism.inertia import Inert, inert_parts, inertia_forces
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Components, Grip, LinkForce, LinkLoads, Load, Wrench
from engine.mechanism.vectors import Vector, named
from engine.parts.skeleton import FRAME
from engine.scene.masses import body_mass
from engine.scene.pairs import (
    Pair,
    contact_pairs,
    drive_base,
    driving_field,
    has_friction,
    lossy_meshes,
    mesh_driver,
    outer_pair,
    pairs,
    pairs_of_group,
)
from engine.scene.structure.ordering import Structure

# Friction fields for each kind of pair.
_FRICTION = {"revolute": "friction_moment", "prismatic": "friction_force", "contact": "friction_force"}
# Solves for the reactions in a group's pairs, from the loads on its links.
Solve = Callable[[Mapping[str, Wrench]], Sequence[Components]]


class Reactions:
    """The reactions in the pairs of a scene.

    Parameters
    ----------
    kinematics : Kinematics
    structure : Structure
    loads : sequence of Load
        All loads, including gravity.
    motion : InputMotion

    Attributes
    ----------
    variables : dict of str to Node
        Fields by name.
    checks : dict of str to Node
        Equilibrium of the whole machine: residual "force" and "moment"; for scale, the sums of magnitudes of all pair
        reactions ("forces") and of all moments on the frame ("moments").
    in_axes : dict of (str, str) to Vector
        By revolute pair and link: the force on that link, in the link's axes.
    lost : dict of str to Node
        Work lost in each pair with friction per unit of input motion.
    lost_in_teeth : dict of str to Node
        Work lost in the mesh of each wheel or rack with an efficiency, per unit of input motion.
    moment_of_drives : Node
        Torque of the input and of the second inputs, reduced to the input.
    settlings : dict of str to Settled
        Per group with friction: pressing forces and margin against jamming.
    """

    def __init__(
        self, kinematics: Kinematics, structure: Structure, loads: Iterable[Load], motion: InputMotion
    ) -> None:
        self.kinematics, self.motion = kinematics, motion
        self.scene, self.graph = kinematics.scene, kinematics.graph
        self.variables: dict[str, Node] = {}
        self.in_axes: dict[tuple[str, str], Vector] = {}
        self.settlings: dict[str, mechanism.friction.Settled] = {}
        self._pressing: dict[str, Node] = {}
        self._pairs = {pair.name: pair for pair in pairs(self.scene)}
        self._contacts = {pair.name: pair for pair in contact_pairs(self.scene)}
        self._rubs = mechanism.friction.rubbing_pairs(kinematics, motion) if self.scene.friction else {}
        tables = ("shafts", "noncircular_wheels", "racks", "pinions")
        self._paths = {name: f"{table}.{name}" for table in tables for name in getattr(self.scene, table)}
        self.lost_in_teeth: dict[str, Node] = {}
        self.lost = {friction.pair: self.graph.zero for friction in self.scene.friction.values()}
        self._forces: list[LinkForce] = []
        self._own = self._loads_on_links(loads)
        self._loads = LinkLoads(kinematics)
        for name in self._moving:
            self._loads.add(name, self._own[name])
        solve = {
            "group": self._group,
            "free group": self._free_group,
            "cam": self._cam,
            "second input": self._second_input,
            "noncircular wheel": self._noncircular_wheel,
            "rack": self._rack,
            "pinion": self._pinion,
            "shaft": self._shaft,
        }
        for element in reversed(structure.elements):
            if element.kind in solve:
                solve[element.kind](element.name)
        self._input()
        self.moment_of_drives = self._moment_of_drives()
        if has_friction(self.scene):
            self._losses()
        self._power()
        self.checks = self._frame()

    @property
    def _moving(self) -> list[str]:
        return [name for name in self.kinematics.links if name != FRAME]

    def force_in(self, pair: str) -> Vector:
        """Force exerted by a pair on its link, in frame axes."""
        return Vector(*(self.variables[f"{pair}.reaction_{axis}"] for axis in "xy"))

    def link_forces(self) -> list[LinkForce]:
        """All loads on each link, one by one; every link except the frame is in equilibrium under them."""
        found: dict[tuple, LinkForce] = {}
        for one in (*self._on_bodies(), *self._forces):
            # A load may have several parts, such as the pull and the damping of a spring.
            key = (one.kind, one.name, one.link, one.source, one.at)
            found[key] = one + found[key] if key in found else one
        return list(found.values())

    def _on_bodies(self) -> Iterator[LinkForce]:
        """Weights and inertia forces of the bodies, also where point masses replace them."""
        scene, graph = self.scene, self.graph
        for name, body in scene.bodies.items():
            mass = graph.derived(f"mass of body {name}", partial(body_mass, scene, name))
            field = Vector(graph.zero, graph.number("gravity"))
            if scene.base is not None:
                field += Vector(*(graph.number(f"base.acceleration_{axis}") for axis in "xy"))
            at = self.kinematics.body_centre(name).r
            yield LinkForce("weight", name, body.link, None, at, -(mass * field))
            if scene.inertia_in_reactions:
                inertia = inertia_forces(self.kinematics, name)
                yield LinkForce("inertia", name, body.link, None, at, inertia.force)
                yield LinkForce("inertia", name, body.link, None, moment=inertia.moment)

    # Loads

    def _loads_on_links(self, loads: Iterable[Load]) -> dict[str, Wrench]:
        """Loads on every link, with inertia forces unless the scene excludes them."""
        of_links = LinkLoads(self.kinematics)
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
        return {name: of_links.total(name) for name in self.kinematics.links}

    def _inertia(self, of_links: LinkLoads, one: Inert) -> None:
        """Apply the inertia force of a mass, or the moment of a moment of inertia."""
        if one.centre is not None:
            acceleration = self.motion.acceleration_of(one.centre.a, one.centre.v)
            of_links.push(one.link, one.centre, Vector(*self.graph.apply(inertia_force, one.size, *acceleration)))
            return
        link = self.kinematics.links[one.link]
        moment = epsilon = self.motion.acceleration(link.e, link.w)
        if epsilon is not self.graph.zero:
            moment = self.graph.apply(inertia_moment, one.size, epsilon)
        of_links.twist(one.link, moment)
        if one.of in self.scene.shafts:
            self._forces.append(LinkForce("inertia", one.of, one.link, None, moment=moment))

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
        """Register the fields and link forces of a force or moment of the scene."""
        grip = load.grip
        bearer, at = grip.bearer or (None, None)
        if grip.at is None:
            self._register_fields(load.action, acting_moment=value)
            found = LinkForce("load", load.action, grip.link, bearer, moment=value)
        else:
            force = value * grip.direction
            self._register_fields(load.action, force_x=force.x, force_y=force.y)
            found = LinkForce("load", load.action, grip.link, bearer, grip.at.r, force)
        if load.action != "gravity":
            self._forces.append(found)
            if bearer is not None:
                self._forces.append(found.opposite._replace(at=None if grip.at is None else at.r))

    def _register_fields(self, action: str, **parts: Node) -> None:
        """Register fields of a force or moment of the scene; a spring's damping adds to its pull."""
        if action == "gravity":
            return
        for key, node in parts.items():
            name = f"{action}.{key}"
            self.variables[name] = self.variables[name] + node if name in self.variables else node

    # Pairs

    def _react(self, pair: Pair, reaction: Components, within: Collection[str]) -> None:
        """Register the reaction of a pair, and apply it to the pair's links outside the group."""
        link, ends = self.kinematics.links[pair.link], (pair.name, pair.link, pair.other)
        if pair.kind == "revolute":
            at, force = self.kinematics.points[pair.joint], Vector(*reaction).called(f"{pair.name} reaction")
            own = self.in_axes[pair.name, pair.link] = _components(force, link)
            self.in_axes[pair.name, pair.other] = _components(-force, self.kinematics.links[pair.other])
            parts = {"_x": force.x, "_y": force.y, "_along": own.x, "_across": own.y, "": force.length}
            moments = ()
        else:
            normal, *moments = reaction
            at, force = link.origin, normal * link.u.normal
            parts = {"": normal, "_x": force.x, "_y": force.y, "_moment": moments[0]}
        self.variables |= {f"{pair.name}.reaction{part}": node for part, node in parts.items()}
        self._exert(LinkForce("reaction", *ends, at.r, force), at, within)
        for moment in moments:
            self._exert(LinkForce("reaction", *ends, moment=moment), None, within)

    def _exert(self, found: LinkForce, at: MovingPoint | None = None, within: Collection[str] = ()) -> None:
        """Register a force or moment between two links, and apply it to those outside a group."""
        self._forces += [found, found.opposite]
        _apply_between(self._loads, found, at, within)

    # Groups, last first, then the links that turn on the frame

    def _group(self, name: str) -> None:
        group = self.scene.groups[name]
        links = (group.first.link, group.second.link)
        self._balance(name, links, pairs_of_group(self.scene, name), lambda loads: self._solved(name, loads))

    def _free_group(self, name: str) -> None:
        motion = self.kinematics.free[name]
        group = motion.closure.group

        def solved(loads: Mapping[str, Wrench]) -> list[Components]:
            found = mechanism.groups.free_reactions.free_reactions(self.kinematics, motion, loads)
            return [found[pair.name] for pair in group.pairs]

        self._balance(group.name, group.links, group.pairs, solved)

    def _balance(self, name: str, links: Sequence[str], around: Sequence[Pair], solved: Solve) -> None:
        """Register the reactions in a group's pairs and apply them to the links that carry the group."""
        loads = {link: self._loads.total(link) for link in links}
        for pair, reaction in zip(around, self._with_friction(name, links, around, solved, loads), strict=True):
            self._react(pair, reaction, links)
        unloaded = {link for link, load in loads.items() if load.is_nothing}
        for pair in around:
            self._register_kinks(pair, unloaded)

    def _solved(self, name: str, loads: Mapping[str, Wrench]) -> list[Components]:
        """Reactions in the three pairs of a dyad, two components each."""
        law, geometry = self.kinematics.statics[name]
        given = [(*load.force, load.moment) for load in loads.values()]
        found = self.graph.apply(law, *given, *geometry)
        return [found[0:2], found[2:4], found[4:6]]

    def _cam(self, name: str) -> None:
        """Balance a follower by the contact force of its cam; its guide or pivot takes the rest."""
        cam, motion = self.scene.cams[name], self.kinematics.cams[name]
        cam_forces = mechanism.higher_pairs.cam_forces.cam_forces
        links, load = (cam.follower.link,), self._loads.total(cam.follower.link)
        touching, holding = self._contacts[f"{name}.contact"], outer_pair(self.scene, cam.follower.link)

        def solved(loads: Mapping[str, Wrench]) -> list[Components]:
            found = cam_forces(self.kinematics, name, loads[cam.follower.link])
            return [(found.contact, self.graph.zero), found.held]

        (contact, _), held = self._with_friction(name, links, (touching, holding), solved, {links[0]: load})
        closing = cam_forces(self.kinematics, name, load).closing
        self.variables |= {f"{name}.contact_force": contact, f"{name}.closing_force": closing}
        if touching.name in self._pressing:
            self.graph.bends(self._pressing[touching.name], contact)
        at = self.kinematics.at_rest(motion.contact)
        self._exert(LinkForce("reaction", touching.name, *links, cam.on, at.r, contact * motion.normal), at, links)
        self._react(holding, held, links)
        self._register_kinks(holding, frozenset())

    def _shaft(self, name: str) -> None:
        """Balance the moments on a shaft by gear moments on its driver (by the ratio) and on their common carrier."""
        shaft, load = self.scene.shafts[name], self._loads.total(name)
        if shaft.pressure_angle is not None:
            self._in_mesh(name, load)
            return
        moment = load.moment
        if shaft.pivot is not None:
            moment = moment + self._in_pivot(name, load)
        passed = self.graph.number(f"shafts.{name}.ratio") * moment * self._lost_share(name, -moment)
        self._transmit(name, shaft.geared_to, shaft.carrier or FRAME, moment, passed)

    def _transmit(self, name: str, driver: str, carrier: str, moment: Node, passed: Node) -> None:
        """Balance a wheel by moments on its driver and on their common carrier."""
        on = ((name, driver, -moment), (driver, name, passed), (carrier, name, moment - passed))
        self._forces += [LinkForce("gears", name, link, source, moment=twist) for link, source, twist in on]
        for link, _, twist in on[1:]:
            self._loads.twist(link, twist)

    def _apply_tooth_force(self, name: str, driver: str, place: Vector, force: Vector) -> None:
        """Apply the tooth force to a wheel or rack, and its reaction to the driver."""
        found = LinkForce("reaction", f"{name}.teeth", name, driver, place, force)
        self._exert(found, self.kinematics.at_rest(place))

    def _in_mesh(self, name: str, load: Wrench) -> None:
        """Balance the moments on a shaft by the tooth force at the pitch point, which also separates the wheels."""
        shaft, found = self.scene.shafts[name], mechanism.higher_pairs.mesh.mesh_of(self.kinematics, name)
        arm = found.radius
        if shaft.efficiency is not None:
            ratio, k = self.graph.number(f"shafts.{name}.ratio"), self._lost_share(name, -load.moment)
            arm = self.graph.apply(laws.friction.teeth.shifted_contact, found.radius, ratio, k)
        tangential = load.moment / arm
        apart = self._separating_force(name, tangential)
        force = -(tangential * found.along) + apart * found.away
        self._between_teeth(found, arm, force, name, shaft.geared_to)
        self._in_pivot(name, self._loads.total(name))

    def _lost_share(self, name: str, taken: Node) -> Node:
        """Factor by which mesh losses change the load on the driver.

        Parameters
        ----------
        name : str
            Driven wheel or rack.
        taken : Node
            Moment (for a rack, force) exerted by the driver; its sign gives the direction of power flow.
        """
        if name not in lossy_meshes(self.scene):
            return self.graph.one
        rate, slope = mechanism.friction.rolling_rate(self.kinematics, name)
        self.graph.switches(rate, slope)
        sense_of_input = input_sense(self.kinematics)
        direction = self.graph.held(self.graph.apply(sense, rate)) * sense_of_input
        efficiency = self.graph.number(f"{self._paths[name]}.efficiency")
        k = self.graph.apply(laws.friction.teeth.lost_share, direction * taken, efficiency)
        self.graph.bends(k, taken)
        self.lost_in_teeth[name] = sense_of_input * ((k - 1.0) * (taken * rate))
        return k

    def _noncircular_wheel(self, name: str) -> None:
        """Balance the moments on a wheel: by a moment on the driver (by the ratio), or by tooth forces."""
        wheel, found = self.scene.noncircular_wheels[name], self.kinematics.noncircular[name]
        load = self._loads.total(name)
        if wheel.pressure_angle is None:
            passed = -(found.rate * load.moment * self._lost_share(name, -load.moment))
            self._transmit(name, wheel.geared_to, FRAME, load.moment, passed)
            self._in_pivot(name, load)
            return
        place = found.pitch_point
        if wheel.efficiency is not None:
            k, along = self._lost_share(name, -load.moment), self._line_of_centres(name)
            shifted = self.graph.apply(laws.friction.teeth.shifted_contact, -found.radius, -found.rate, k)
            place = place + (shifted + found.radius) * along
        arm = place - self.kinematics.links[name].origin.r
        slope = self._tooth_slope(name)
        levers = arm.cross(found.tangent), arm.cross(found.away)
        law = laws.kinematics.noncircular_wheels.noncircular_tooth_force
        tangential, apart = self.graph.apply(law, load.moment, *levers, slope)
        self.graph.bends(tangential, load.moment)
        self.graph.bends(apart, load.moment)
        self._in_teeth(name, tangential, apart)
        self._apply_tooth_force(name, wheel.geared_to, place, tangential * found.tangent + apart * found.away)
        self._in_pivot(name, self._loads.total(name))

    def _line_of_centres(self, name: str) -> Vector:
        """Unit vector from the axis of a non-circular wheel's driver to the wheel's axis."""
        links, wheel = self.kinematics.links, self.scene.noncircular_wheels[name]
        line = links[name].origin.r - links[wheel.geared_to].origin.r
        return line * (self.graph.one / line.length)

    def _rack(self, name: str) -> None:
        """Balance the force along a rack's guide by tooth forces; the guide takes the rest."""
        load = self._loads.total(name)
        found = mechanism.higher_pairs.rack_motion.toothing(self.kinematics, name)
        tangential = -load.force.dot(found.along)
        apart = self._separating_force(name, tangential)
        force = tangential * found.along - apart * found.away
        arm = found.radius * self._lost_share(name, tangential)
        self._between_teeth(found, arm, force, name, self.scene.racks[name].pinion)
        left = self._loads.total(name)
        normal = -left.force.dot(self.kinematics.links[name].u.normal)
        self._react(self._pairs[name], (normal, -left.moment), {name})

    def _pinion(self, name: str) -> None:
        """Balance the moments on a pinion by tooth forces on its rack; the pivot takes the rest."""
        load = self._loads.total(name)
        found = mechanism.higher_pairs.rack_motion.toothing(self.kinematics, name)
        arm = found.radius / self._lost_share(name, -load.moment)
        tangential = -load.moment / arm
        force = tangential * found.along + self._separating_force(name, tangential) * found.away
        self._between_teeth(found, arm, force, name, mesh_driver(self.scene, name))
        self._in_pivot(name, self._loads.total(name))

    def _tooth_slope(self, name: str) -> Node:
        """Tangent of the pressure angle."""
        angle = f"{self._paths[name]}.pressure_angle"
        return self.graph.derived(f"slope of the teeth of {name}", lambda n: np.tan(n[angle]))

    def _separating_force(self, name: str, tangential: Node) -> Node:
        """Separating force of a mesh; it has a kink where the tangential force changes sign."""
        apart = abs(tangential) * self._tooth_slope(name)
        self.graph.bends(apart, tangential)
        self._in_teeth(name, tangential, apart)
        return apart

    def _in_teeth(self, name: str, tangential: Node, apart: Node) -> None:
        """Register the components of a tooth force, which acts along the normal to the flanks."""
        normal = Vector(tangential, apart).length
        self.graph.bends(normal, tangential)
        parts = {"tangential": tangential, "radial": apart, "normal": normal}
        self.variables |= {f"{name}.{part}_force": force for part, force in parts.items()}

    def _between_teeth(
        self, found: "mechanism.higher_pairs.mesh.Toothing", arm: Node, force: Vector, on: str, bearer: str
    ) -> None:
        """Apply a tooth force, with the arm about the wheel's axis that losses shift."""
        place = found.pitch_point
        if arm is not found.radius:
            place = place + (found.radius - arm) * found.along.normal
        self._apply_tooth_force(on, bearer, place, force)

    def _in_pivot(self, name: str, load: Wrench) -> Node:
        """Register the reaction of a pivot; return its friction moment."""
        pair = self._pairs[name]
        self._react(pair, -load.force, {pair.link})
        friction = self._apply_friction(pair, self.variables[f"{name}.reaction"], {pair.link})
        self._register_kinks(pair, frozenset())
        return friction

    def _input(self) -> None:
        needed = -self._load_on_drive(self.scene.input.link, FRAME, "input")
        self.variables["input_moment_by_equilibrium"] = named(needed, "input_moment_by_equilibrium")

    def _load_on_drive(self, name: str, base: str, pair: str) -> Node:
        """Balance an input by its drive, which reacts on the base; return the load on the drive."""
        load, link, ends = self._loads.total(name), self.kinematics.links[name], (name, name, base)
        if self._pairs[pair].kind == "prismatic":
            total = load.force.dot(link.u) + self._in_guide(pair, load)
            self._exert(LinkForce("drive", *ends, link.origin.r, -total * link.u), link.origin, {name})
        else:
            total = load.moment + self._in_pivot(pair, load)
            self._exert(LinkForce("drive", *ends, moment=-total), None, {name})
        return total

    def _in_guide(self, name: str, load: Wrench) -> Node:
        """Register the reaction of an input's guide; return its friction force."""
        pair = self._pairs[name]
        normal, turning = load.force.cross(self.kinematics.links[pair.link].u), -load.moment
        self._react(pair, (normal, turning), {pair.link})
        if name not in self._rubs:
            return self.graph.zero
        edge = self._rubs[name].edge
        pressing = self.graph.apply(laws.friction.feedback.guide_pressing, normal, turning, edge)
        friction = self._apply_friction(pair, pressing, {pair.link})
        self._register_kinks(pair, frozenset())
        return friction

    def _second_input(self, name: str) -> None:
        """Balance a second input by its drive, which reacts on the carrier, and on the crank if that drives it."""
        total = self._load_on_drive(name, drive_base(self.scene, name), name)
        if self.scene.inputs[name].drive == "crank":
            passed = total * mechanism.higher_pairs.second_input_motion.rate_of_drive(self.kinematics, name)
            self._loads.twist(self.scene.input.link, passed)
            self._loads.twist(FRAME, -passed)
            self._forces.append(LinkForce("gears", name, self.scene.input.link, name, moment=passed))
        field = driving_field(self.scene, name)
        self.variables[field] = named(-total, field.replace(".", "_"))

    def _moment_of_drives(self) -> Node:
        """Torque of all drives reduced to the input: M + Σ M_k dψ_k/dφ, or Σ F_k ds_k/dφ for sliding ones.

        The crank's own torque already includes second inputs that the crank drives.
        """
        total = self.variables["input_moment_by_equilibrium"]
        for name, second in self.scene.inputs.items():
            if second.drive == "own":
                rate = mechanism.higher_pairs.second_input_motion.rate_of_drive(self.kinematics, name)
                total = total + self.variables[driving_field(self.scene, name)] * rate
        return total

    # Friction

    def _with_friction(
        self, name: str, links: Sequence[str], around: Sequence[Pair], solved: Solve, loads: Mapping[str, Wrench]
    ) -> Sequence[Components]:
        """Reactions in a group: those without its own friction, plus the effect of each pair with friction."""
        free = solved(loads)
        frictional = [(i, pair) for i, pair in enumerate(around) if pair.name in self._rubs]
        if not frictional:
            return free
        backs = [solved(self._loads_per_newton(pair, links)) for _, pair in frictional]
        settled = mechanism.friction.pressing_in_group(
            [self._rubs[pair.name] for _, pair in frictional],
            [free[i] for i, _ in frictional],
            [[back[i] for back in backs] for i, _ in frictional],
        )
        self.settlings[name] = settled
        named(settled.margin, f"{name} margin")
        named(settled.residual, f"{name} residual")
        for (_, pair), pressing in zip(frictional, settled.pressing, strict=True):
            self._apply_friction(pair, named(pressing, f"{pair.name} pressing"), links)
        return [
            tuple(
                sum((back[i][axis] * n for back, n in zip(backs, settled.pressing, strict=True)), free[i][axis])
                for axis in (0, 1)
            )
            for i in range(len(around))
        ]

    def _loads_per_newton(self, pair: Pair, links: Sequence[str]) -> dict[str, Wrench]:
        """Loads on a group's links from friction in one of its pairs, per newton of pressing force."""
        loads = LinkLoads(self.kinematics)
        _apply_between(loads, *self._friction_in(pair, self._rubs[pair.name].drag))
        return {link: loads.total(link) for link in links}

    def _friction_in(self, pair: Pair, friction: Node) -> tuple[LinkForce, MovingPoint | None]:
        """Friction on a pair's link, a moment in a joint or a force in a guide or on a cam, and where it acts."""
        ends = (pair.name, pair.link, pair.other)
        if pair.kind == "revolute":
            return LinkForce("friction", *ends, moment=friction), None
        if pair.kind == "prismatic":
            link = self.kinematics.links[pair.link]
            at, along = link.origin, link.u
        else:
            motion = self.kinematics.cams[pair.name.partition(".")[0]]
            at, along = self.kinematics.at_rest(motion.contact), motion.normal.normal
        return LinkForce("friction", *ends, at.r, friction * along), at

    def _apply_friction(self, pair: Pair, pressing: Node, within: Collection[str]) -> Node:
        """Friction on a pair's link from its pressing force; also applied to the pair's links outside the group."""
        if pair.name not in self._rubs:
            return self.graph.zero
        rub = self._rubs[pair.name]
        self._pressing[pair.name] = pressing
        friction = rub.drag * pressing
        self.variables[f"{pair.name}.{_FRICTION[pair.kind]}"] = friction
        self.lost[pair.name] = rub.lost * pressing
        self._exert(*self._friction_in(pair, friction), within)
        return friction

    def _register_kinks(self, pair: Pair, unloaded: Iterable[str]) -> None:
        """Register the kinks in a pair's load: a reaction touches zero, or a slider changes the edge it bears on.

        The reaction passes through zero where a link loaded only by its pairs changes from compression to tension.
        Friction tilts the reaction, but its component along a bar, or across a slide, still changes sign there.
        """
        rub, found = self._rubs.get(pair.name), []
        loads = [self._pressing[pair.name]] if rub is not None else []
        if pair.kind == "revolute":
            loads.append(self.variables[f"{pair.name}.reaction"])
            ends = [name for name in (pair.link, pair.other) if name in unloaded]
            found = [
                force.y if name in self.kinematics.slides else force.x
                for name, force in ((name, self.in_axes[pair.name, name]) for name in ends)
            ]
        elif rub is not None:
            normal = self.variables[f"{pair.name}.reaction"]
            tilting = rub.edge * self.variables[f"{pair.name}.reaction_moment"]
            found = [normal - tilting, normal + tilting]
        for load in loads:
            for curve in found:
                self.graph.bends(load, curve)

    def _losses(self) -> None:
        """Register friction power, and the equivalent moment on the input."""
        for pair, lost in self.lost.items():
            kind = (self._pairs | self._contacts)[pair].kind
            self.variables.setdefault(f"{pair}.{_FRICTION[kind]}", self.graph.zero)
            self.variables[f"{pair}.friction_power"] = self.motion.speed * lost
        for name, lost in self.lost_in_teeth.items():
            self.variables[f"{name}.mesh_loss"] = self.motion.speed * lost
        total = sum((*self.lost.values(), *self.lost_in_teeth.values()), self.graph.zero)
        self.variables["friction_moment"] = named(-(input_sense(self.kinematics) * total), "friction_moment")
        self.variables["input_moment_with_friction"] = self.moment_of_drives

    # The whole machine

    def _power(self) -> None:
        """Drive torque by virtual power: the power of all forces on all links, inertia forces included, is zero."""
        power = self.variables.get("friction_moment", self.graph.zero)
        for name in self._moving:
            link, load = self.kinematics.links[name], self._own[name]
            power = power + (load.force.dot(link.origin.v) + load.moment * link.w)
        self.variables["input_moment_by_power"] = -power

    def _frame(self) -> dict[str, Node]:
        """Register the forces of the machine on its frame; return the equilibrium check of the moving links."""
        left = self._loads.total(FRAME)
        on_frame = self._own[FRAME] + left
        # About the origin of the scene's coordinates, not about the datum of positions.
        about_origin = on_frame.moment + self.kinematics.coordinates(self.kinematics.nowhere).cross(on_frame.force)
        for key, node in zip(("x", "y", "moment"), (*on_frame.force, about_origin), strict=True):
            self.variables[f"frame.reaction_{key}"] = named(node, f"frame reaction_{key}")
        whole = LinkLoads(self.kinematics)
        for name in self._moving:
            load = self._own[name]
            whole.push(FRAME, self.kinematics.links[name].origin, load.force)
            whole.twist(FRAME, load.moment)
        total = whole.total(FRAME)
        zero = self.graph.zero
        return {
            "force": (total.force - left.force).length,
            "forces": sum((abs(self.variables[f"{name}.reaction"]) for name in self._pairs), zero),
            "moment": total.moment - left.moment,
            "moments": sum((abs(moment) for moment in self._loads.moments(FRAME)), zero),
        }


def _components(force: Vector, link: Turning) -> Vector:
    """Components of a force along a link and across it, to its left."""
    return Vector(force.dot(link.u), link.u.cross(force))


def _apply_between(
    loads: LinkLoads, found: LinkForce, at: MovingPoint | None = None, within: Collection[str] = ()
) -> None:
    """Apply a force or moment and its reaction to their links, except those within a group."""
    for one in (found, found.opposite):
        if one.link not in within:
            if at is None:
                loads.twist(one.link, one.moment)
            else:
                loads.push(one.link, at, one.force)
