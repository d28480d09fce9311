"""Kinetostatics of an ordered mechanism as nodes: the reactions in all pairs, last group first.

By d'Alembert inertia forces join the forces that act on a link; each group is then in equilibrium under its own loads
and what later groups leave on it. The last step is the input link: the reaction of its pivot or guide, and the moment
or force that drives it; second inputs come in their turn. Gears carry moments alone unless the pressure angle of their
teeth is given.

Friction in pairs acts back within its own group, and on what comes after it in this order.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on kinetostatics; N. E. Zhukovsky's lever for
the input moment by virtual power.
"""

from collections.abc import Callable, Collection, Iterable, Iterator, Mapping, Sequence
from functools import partial

import numpy as np

from engine import laws, mechanism
from engine.graph.nodes import Node
from engine.laws.masses.inertia_forces import inertia_force, inertia_moment
from engine.laws.senses import sense
from engine.mechanism.acting import Grip, Load
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.assembly import MovingPoint, Turning
from engine.mechanism.inertia import inertia_forces
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics, dyad_of
from engine.mechanism.link_loads import Components, LinkForce, LinkLoads, Wrench
from engine.mechanism.vectors import Vector, named
from engine.parts.skeleton import FRAME, CrankInput
from engine.scene.inertia import body_mass, carried_inertia, carried_on
from engine.scene.pairs import (
    Pair,
    contact_pairs,
    drive_base,
    driving_field,
    follower_pair,
    has_friction,
    joint_of,
    lossy_meshes,
    pairs,
    pairs_of_group,
)
from engine.scene.structure.ordering import Structure

# What friction causes in each kind of pair, as the names of fields have it.
_FRICTION = {"revolute": "friction_moment", "prismatic": "friction_force", "contact": "friction_force"}
# Reactions in the pairs of a group from what acts on its links.
Solve = Callable[[Mapping[str, Wrench]], Sequence[Components]]


class Reactions:
    """The reactions in the pairs of a scene.

    Parameters
    ----------
    kinematics : Kinematics
    structure : Structure
    loads : sequence of Load
        All that acts, gravity included.
    motion : InputMotion

    Attributes
    ----------
    variables : dict of str to Node
        Fields by their names.
    checks : dict of str to Node
        The equilibrium of the whole: "force" and "moment" left, sums of the magnitudes of all "forces" in pairs and of
        all "moments" on the frame.
    in_axes : dict of (str, str) to Vector
        Of each revolute pair and either of its links, the force on that link in its own axes.
    lost : dict of str to Node
        Work lost in each pair with friction, for each unit of the input's motion.
    lost_in_teeth : dict of str to Node
        Work lost between the teeth of each wheel or rack with an efficiency, for each unit of the input's motion.
    moment_of_drives : Node
        Moment of the input and of second inputs, reduced to the input.
    settlings : dict of str to Settled
        Of each group with friction what presses in it, and how near it is to jamming.
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
        paths = {name: f"{table}.{name}" for table in tables for name in getattr(self.scene, table)}
        self._lossy = {name: paths[name] for name in lossy_meshes(self.scene)}
        self.lost_in_teeth: dict[str, Node] = {}
        self.lost = {friction.pair: self.graph.zero for friction in self.scene.friction.values()}
        self._forces: list[LinkForce] = []
        self._own = self._loads_on_links(loads)
        self._loads = LinkLoads(kinematics)
        for name in self._moving:
            self._loads.add(name, self._own[name])
        for element in reversed(structure.elements):
            if element.kind == "group":
                self._group(element.name)
            elif element.kind == "free group":
                self._free_group(kinematics.free[element.name])
            elif element.kind == "cam":
                self._cam(element.name)
            elif element.kind == "second input":
                self._second_input(element.name)
            elif element.kind == "noncircular wheel":
                self._noncircular_wheel(element.name)
            elif element.kind == "rack":
                self._rack(element.name)
            elif element.kind == "pinion":
                self._pinion(element.name)
            elif element.kind == "shaft":
                self._shaft(element.name)
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
        """Force of a pair on its link, in the axes of the frame."""
        return Vector(*(self.variables[f"{pair}.reaction_{axis}"] for axis in "xy"))

    def link_forces(self) -> list[LinkForce]:
        """Everything that acts on each link, one by one: each link is in equilibrium, but for the frame."""
        found: dict[tuple, LinkForce] = {}
        for one in (*self._on_bodies(), *self._forces):
            # A load may have several parts, as the pull and the damping of a spring.
            key = (one.kind, one.name, one.link, one.source, one.at)
            found[key] = one + found[key] if key in found else one
        return list(found.values())

    def _on_bodies(self) -> Iterator[LinkForce]:
        """Weights and inertia forces of the bodies, even where point masses replace them."""
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
        """Forces on every link, inertia forces included unless the scene leaves them out."""
        of_links = LinkLoads(self.kinematics)
        if self.scene.inertia_in_reactions:
            for name in self.kinematics.masses:
                self._inertia(of_links, name)
            for name in self.scene.shafts:
                inertia = mechanism.actions.carried_masses.turning_inertia(self.kinematics, name)
                moment = self._rotary_inertia(of_links, name, inertia)
                self._forces.append(LinkForce("inertia", name, name, None, moment=moment))
            crank = self.scene.input.link
            if carried_on(self.scene, crank):
                own = partial(carried_inertia, self.scene, crank)
                inertia = self.graph.derived(f"inertia of what {crank} carries", own)
                self._rotary_inertia(of_links, crank, inertia)
        at_places: dict[Grip, list[Load]] = {}
        for load in loads:
            # At its speed a machine runs with its brakes released; regimes apply them.
            if self.motion.given or load.role != "braking":
                at_places.setdefault(load.grip._replace(direction=None), []).append(load)
        for grip, own in at_places.items():
            self._apply(of_links, grip, own)
        return {name: of_links.total(name) for name in self.kinematics.links}

    def _inertia(self, of_links: LinkLoads, name: str) -> None:
        """Inertia force and moment of one of the mechanism's masses."""
        part, centre = self.kinematics.masses[name], self.kinematics.mass_centre(name)
        mass = self.graph.derived(f"mass of {name}", part.mass)
        acceleration = self.motion.acceleration_of(centre.a, centre.v)
        of_links.push(part.link, centre, Vector(*self.graph.apply(inertia_force, mass, *acceleration)))
        if part.inertia is not None:
            self._rotary_inertia(of_links, part.link, self.graph.derived(f"inertia of {name}", part.inertia))

    def _rotary_inertia(self, of_links: LinkLoads, name: str, inertia: Node) -> Node:
        link = self.kinematics.links[name]
        epsilon = self.motion.acceleration(link.e, link.w)
        if epsilon is self.graph.zero:
            return epsilon
        moment = self.graph.apply(inertia_moment, inertia, epsilon)
        of_links.twist(name, moment)
        return moment

    def _apply(self, of_links: LinkLoads, grip: Grip, loads: list[Load]) -> None:
        """Forces or moments of the scene at one place, and their counterparts where something bears them."""
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
        """Sum of coefficients times curves."""
        return terms[0][0] * terms[0][1] if len(terms) == 1 else self.graph.combination(terms)

    def _register(self, load: Load, value: Node) -> None:
        """Fields of a force or moment of the scene, and what it does to the links it acts on."""
        grip = load.grip
        bearer, at = grip.bearer or (None, None)
        if grip.at is None:
            self._acts(load.action, acting_moment=value)
            found = LinkForce("load", load.action, grip.link, bearer, moment=value)
        else:
            force = value * grip.direction
            self._acts(load.action, force_x=force.x, force_y=force.y)
            found = LinkForce("load", load.action, grip.link, bearer, grip.at.r, force)
        if load.action != "gravity":
            self._forces.append(found)
            if bearer is not None:
                self._forces.append(found.opposite._replace(at=None if grip.at is None else at.r))

    def _acts(self, action: str, **parts: Node) -> None:
        """Fields of a force or moment of the scene; the damping of a spring adds to its pull."""
        if action == "gravity":
            return
        for key, node in parts.items():
            name = f"{action}.{key}"
            self.variables[name] = self.variables[name] + node if name in self.variables else node

    # Pairs

    def _revolute(self, pair: Pair, force: Vector, within: Collection[str]) -> None:
        """Register the reaction of a revolute pair; a link beyond the group bears its part."""
        self._in_joint(pair, force)
        at = self._place(pair)
        self._between(LinkForce("reaction", pair.name, pair.link, pair.other, at.r, force))
        for link, sign in self._beyond(pair, within):
            self._loads.push(link, at, sign * force)

    def _between(self, found: LinkForce) -> None:
        """Register what acts between two links."""
        self._forces += [found, found.opposite]

    def _beyond(self, pair: Pair, within: Collection[str]) -> list[tuple[str, float]]:
        """Links of a pair beyond a group, each with the sign by which it bears what acts on the pair's own link."""
        sides = ((pair.link, 1.0), (pair.other, -1.0))
        return [(link, sign) for link, sign in sides if link not in within]

    def _place(self, pair: Pair) -> MovingPoint:
        """Where a pair's reaction acts: in its joint, or in the origin of what slides."""
        if pair.kind == "revolute":
            return self.kinematics.points[joint_of(pair)]
        return self.kinematics.links[pair.link].origin

    def _in_joint(self, pair: Pair, force: Vector) -> None:
        link, other = (self.kinematics.links[name] for name in (pair.link, pair.other))
        force.called(f"{pair.name} reaction")
        own = self.in_axes[pair.name, pair.link] = _components(force, link)
        self.in_axes[pair.name, pair.other] = _components(-force, other)
        found = {"_x": force.x, "_y": force.y, "_along": own.x, "_across": own.y, "": force.length}
        self.variables |= {f"{pair.name}.reaction{part}": node for part, node in found.items()}

    def _prismatic(self, pair: Pair, normal: Node, moment: Node, within: Collection[str]) -> None:
        """Register the reaction of a prismatic pair; a link beyond the group bears its part."""
        link = self.kinematics.links[pair.link]
        force = normal * link.u.normal
        found = {"": normal, "_x": force.x, "_y": force.y, "_moment": moment}
        self.variables |= {f"{pair.name}.reaction{part}": node for part, node in found.items()}
        self._between(LinkForce("reaction", pair.name, pair.link, pair.other, link.origin.r, force))
        self._between(LinkForce("reaction", pair.name, pair.link, pair.other, moment=moment))
        for name, sign in self._beyond(pair, within):
            self._loads.push(name, link.origin, sign * force)
            self._loads.twist(name, sign * moment)

    # Groups, last first, then what turns on the frame

    def _group(self, name: str) -> None:
        group = self.scene.groups[name]
        links = (group.first.link, group.second.link)
        self._balanced(name, links, pairs_of_group(self.scene, name), lambda loads: self._solved(name, loads))

    def _free_group(self, motion: "mechanism.groups.free.FreeMotion") -> None:
        group = motion.closure.group

        def solved(loads: Mapping[str, Wrench]) -> list[Components]:
            found = mechanism.groups.free_reactions.free_reactions(self.kinematics, motion, loads)
            return [found[pair.name] for pair in group.pairs]

        self._balanced(group.name, group.links, group.pairs, solved)

    def _balanced(self, name: str, links: Sequence[str], around: Sequence[Pair], solved: Solve) -> None:
        """Register the reactions in a group's pairs; what it hangs on bears its part."""
        loads = {link: self._loads.total(link) for link in links}
        for pair, reaction in zip(around, self._with_friction(name, links, around, solved, loads), strict=True):
            if pair.kind == "revolute":
                self._revolute(pair, Vector(*reaction), links)
            else:
                self._prismatic(pair, *reaction, links)
        unloaded = {link for link, load in loads.items() if load.is_nothing}
        for pair in around:
            self._kinks(pair, unloaded)

    def _solved(self, name: str, loads: Mapping[str, Wrench]) -> list[Components]:
        """Reactions in the three pairs of a dyad, two components of each."""
        law, geometry = dyad_of(self.scene, name).dyad_statics(self.kinematics, name)
        given = [(*load.force, load.moment) for load in loads.values()]
        found = self.graph.apply(law, *given, *geometry)
        return [found[0:2], found[2:4], found[4:6]]

    def _cam(self, name: str) -> None:
        """The contact of a cam holds up its follower against all that acts on it, and what guides it takes the rest."""
        cam, motion = self.scene.cams[name], self.kinematics.cams[name]
        cam_forces = mechanism.higher_pairs.cam_forces.cam_forces
        links, load = (cam.follower.link,), self._loads.total(cam.follower.link)
        touching, holding = self._contacts[f"{name}.contact"], follower_pair(self.scene, name)

        def solved(loads: Mapping[str, Wrench]) -> list[Components]:
            found = cam_forces(self.kinematics, name, loads[cam.follower.link])
            return [(found.contact, self.graph.zero), found.held]

        (contact, _), held = self._with_friction(name, links, (touching, holding), solved, {links[0]: load})
        closing = cam_forces(self.kinematics, name, load).closing
        self.variables |= {f"{name}.contact_force": contact, f"{name}.closing_force": closing}
        if touching.name in self._pressing:
            self.graph.bends(self._pressing[touching.name], contact)
        force = contact * motion.normal
        self._loads.push(cam.on, self.kinematics.at_rest(motion.contact), -force)
        self._between(LinkForce("reaction", touching.name, links[0], cam.on, motion.contact, force))
        if holding.kind == "revolute":
            self._revolute(holding, Vector(*held), links)
        else:
            self._prismatic(holding, *held, links)
        self._kinks(holding, frozenset())

    def _shaft(self, name: str) -> None:
        """Gears balance the moments on a shaft, load its driver by the ratio, and what carries both by the rest."""
        shaft, load = self.scene.shafts[name], self._loads.total(name)
        if shaft.pressure_angle is not None:
            self._in_mesh(name, load)
            return
        moment = load.moment
        if shaft.pivot is not None:
            moment = moment + self._in_pivot(name, load)
        passed = self.graph.number(f"shafts.{name}.ratio") * moment * self._lost_share(name, -moment)
        self._pass_on(name, shaft.geared_to, shaft.carrier or FRAME, moment, passed)

    def _pass_on(self, name: str, driver: str, carrier: str, moment: Node, passed: Node) -> None:
        """Balance a wheel, and load its driver and what carries both."""
        self.graph.bends(passed, moment)
        on = ((name, driver, -moment), (driver, name, passed), (carrier, name, moment - passed))
        self._forces += [LinkForce("gears", name, link, source, moment=twist) for link, source, twist in on]
        for link, _, twist in on[1:]:
            self._loads.twist(link, twist)

    def _push_apart(self, name: str, driver: str, place: Vector, force: Vector) -> None:
        """Load a wheel or rack and its driver by the force between their teeth."""
        at = self.kinematics.at_rest(place)
        self._loads.push(name, at, force)
        self._loads.push(driver, at, -force)
        self._between(LinkForce("reaction", f"{name}.teeth", name, driver, place, force))

    def _in_mesh(self, name: str, load: Wrench) -> None:
        """Teeth balance the moments on a shaft by a force at the pitch point, and push both wheels apart."""
        shaft, found = self.scene.shafts[name], mechanism.higher_pairs.mesh.mesh_of(self.kinematics, name)
        at, radius = found.pitch_point, found.radius
        if shaft.efficiency is not None:
            ratio, k = self.graph.number(f"shafts.{name}.ratio"), self._lost_share(name, -load.moment)
            radius = self.graph.apply(laws.friction.teeth.shifted_contact, found.radius, ratio, k)
            at = at + (radius - found.radius) * found.along
        tangential = load.moment / radius
        self.graph.bends(tangential, load.moment)
        # What pushes apart has the magnitude of what turns, and bends where that changes its sign.
        apart = abs(tangential) * found.slope
        self.graph.bends(apart, tangential)
        force = -(tangential * found.across) + apart * found.away
        self._push_apart(name, shaft.geared_to, at, force)
        self._in_teeth(name, tangential, apart)
        self._in_pivot(name, self._loads.total(name))

    def _lost_share(self, name: str, taken: Node) -> Node:
        """By how much losses between teeth change what loads their driver.

        Parameters
        ----------
        name : str
            Of what is driven.
        taken : Node
            Moment on it from its driver, of a rack the force: with the motion it takes power, which is accounted for.
        """
        if name not in self._lossy:
            return self.graph.one
        rate, slope = mechanism.friction.rolling_rate(self.kinematics, name)
        self.graph.switches(rate, slope)
        sense_of_input = input_sense(self.kinematics)
        way = self.graph.held(self.graph.apply(sense, rate)) * sense_of_input
        efficiency = self.graph.number(f"{self._lossy[name]}.efficiency")
        k = self.graph.apply(laws.friction.teeth.lost_share, way * taken, efficiency)
        self.graph.bends(k, taken)
        self.lost_in_teeth[name] = sense_of_input * ((k - 1.0) * (taken * rate))
        return k

    def _noncircular_wheel(self, name: str) -> None:
        """Teeth balance the moments on a wheel: as a moment passed on by the ratio, or by forces at the pitch point."""
        wheel, found, load = (
            self.scene.noncircular_wheels[name],
            self.kinematics.noncircular[name],
            self._loads.total(name),
        )
        if wheel.pressure_angle is None:
            passed = -(found.rate * load.moment * self._lost_share(name, -load.moment))
            self._pass_on(name, wheel.geared_to, FRAME, load.moment, passed)
            self._in_pivot(name, load)
            return
        place = found.pitch_point
        if wheel.efficiency is not None:
            k, along = self._lost_share(name, -load.moment), self._line_of_centres(name)
            shifted = self.graph.apply(laws.friction.teeth.shifted_contact, -found.radius, -found.rate, k)
            place = place + (shifted + found.radius) * along
        arm = place - self.kinematics.links[name].origin.r
        path = f"noncircular_wheels.{name}.pressure_angle"
        slope = self.graph.derived(f"slope of the teeth of {name}", lambda n: np.tan(n[path]))
        levers = arm.cross(found.tangent), arm.cross(found.away)
        law = laws.kinematics.noncircular_wheels.noncircular_tooth_force
        tangential, apart = self.graph.apply(law, load.moment, *levers, slope)
        self.graph.bends(tangential, load.moment)
        self.graph.bends(apart, load.moment)
        self._in_teeth(name, tangential, apart)
        self._push_apart(name, wheel.geared_to, place, tangential * found.tangent + apart * found.away)
        self._in_pivot(name, self._loads.total(name))

    def _line_of_centres(self, name: str) -> Vector:
        """Direction from the axis of a non-circular wheel's driver to its own."""
        links, wheel = self.kinematics.links, self.scene.noncircular_wheels[name]
        line = links[name].origin.r - links[wheel.geared_to].origin.r
        return line * (self.graph.one / line.length)

    def _rack(self, name: str) -> None:
        """Teeth balance all that acts on a rack along its guide, which takes the rest."""
        rack, load = self.scene.racks[name], self._loads.total(name)
        found = mechanism.higher_pairs.rack_motion.toothing(self.kinematics, name)
        tangential = -load.force.dot(found.along)
        apart = self._apart(name, f"racks.{name}", tangential)
        force = tangential * found.along - apart * found.away
        arm = found.radius if rack.efficiency is None else found.radius * self._lost_share(name, tangential)
        self._between_teeth(found, arm, force, name, rack.pinion)
        left = self._loads.total(name)
        normal = -left.force.dot(self.kinematics.links[name].u.normal)
        self._prismatic(self._pairs[name], normal, -left.moment, {name})

    def _pinion(self, name: str) -> None:
        """Teeth balance the moments on a pinion; its pivot takes the rest, its rack bears the force."""
        pinion, load = self.scene.pinions[name], self._loads.total(name)
        found = mechanism.higher_pairs.rack_motion.toothing(self.kinematics, name)
        arm = found.radius if pinion.efficiency is None else found.radius / self._lost_share(name, -load.moment)
        tangential = -load.moment / arm
        apart = self._apart(name, f"pinions.{name}", tangential)
        bearer = pinion.rack or self.scene.guides[pinion.guide].link
        self._between_teeth(found, arm, tangential * found.along + apart * found.away, name, bearer)
        self._in_pivot(name, self._loads.total(name))

    def _apart(self, name: str, at: str, tangential: Node) -> Node:
        """Force by which teeth push apart: by its magnitude, so it bends where what drives changes its sign."""
        slope = self.graph.derived(f"slope of the teeth of {name}", lambda n: np.tan(n[f"{at}.pressure_angle"]))
        apart = abs(tangential) * slope
        self.graph.bends(apart, tangential)
        self._in_teeth(name, tangential, apart)
        return apart

    def _in_teeth(self, name: str, tangential: Node, apart: Node) -> None:
        """Register the force between teeth, which has one unknown: along the normal to their flanks."""
        normal = Vector(tangential, apart).length
        self.graph.bends(normal, tangential)
        parts = {"tangential": tangential, "radial": apart, "normal": normal}
        self.variables |= {f"{name}.{part}_force": force for part, force in parts.items()}

    def _between_teeth(
        self, found: "mechanism.higher_pairs.rack_motion.Toothing", arm: Node, force: Vector, on: str, bearer: str
    ) -> None:
        """Load a rack and its pinion by a force that has an arm about the pinion's axis, by losses not its radius."""
        place = found.pitch_point
        if arm is not found.radius:
            place = place + (found.radius - arm) * found.along.normal
        self._push_apart(on, bearer, place, force)

    def _in_pivot(self, name: str, load: Wrench) -> Node:
        """Register the reaction of a pivot on the frame; the moment of its friction."""
        pair = self._pairs[name]
        self._revolute(pair, -load.force, {pair.link})
        friction = self._rubbed(pair, self.variables[f"{name}.reaction"], {pair.link})
        self._kinks(pair, frozenset())
        return friction

    def _input(self) -> None:
        drive, pair = self.scene.input, self._pairs["input"]
        link, load = self.kinematics.links[drive.link], self._loads.total(drive.link)
        if isinstance(drive, CrankInput):
            total = load.moment + self._in_pivot("input", load)
            needed = -total
            self._loads.twist(FRAME, total)
            self._between(LinkForce("drive", drive.link, drive.link, FRAME, moment=needed))
        else:
            total = load.force.dot(link.u) + self._in_guide(pair, load)
            needed = -total
            self._loads.push(FRAME, link.origin, total * link.u)
            self._between(LinkForce("drive", drive.link, drive.link, FRAME, link.origin.r, needed * link.u))
        self.variables["input_moment_by_equilibrium"] = named(needed, "input_moment_by_equilibrium")

    def _in_guide(self, pair: Pair, load: Wrench) -> Node:
        """Register the reaction of the guide of an input; the force of its friction along it."""
        normal, turning = load.force.cross(self.kinematics.links[pair.link].u), -load.moment
        self._prismatic(pair, normal, turning, {pair.link})
        if pair.name not in self._rubs:
            return self.graph.zero
        edge = self._rubs[pair.name].edge
        pressing = self.graph.apply(laws.friction.feedback.guide_pressing, normal, turning, edge)
        friction = self._rubbed(pair, pressing, {pair.link})
        self._kinks(pair, frozenset())
        return friction

    def _second_input(self, name: str) -> None:
        """A drive balances a second input; what carries the pivot or guide bears it, and the crank where it drives."""
        load, link, base = self._loads.total(name), self.kinematics.links[name], drive_base(self.scene, name)
        if name in self.kinematics.slides:
            total = load.force.dot(link.u) + self._in_guide(self._pairs[name], load)
            self._loads.push(base, link.origin, total * link.u)
            self._between(LinkForce("drive", name, name, base, link.origin.r, -(total * link.u)))
        else:
            total = load.moment + self._in_pivot(name, load)
            self._loads.twist(base, total)
            self._between(LinkForce("drive", name, name, base, moment=-total))
        if self.scene.inputs[name].drive == "crank":
            passed = total * mechanism.higher_pairs.second_input_motion.rate_of_drive(self.kinematics, name)
            self._loads.twist(self.scene.input.link, passed)
            self._loads.twist(FRAME, -passed)
            self._forces.append(LinkForce("gears", name, self.scene.input.link, name, moment=passed))
        field = driving_field(self.scene, name)
        self.variables[field] = named(-total, field.replace(".", "_"))

    def _moment_of_drives(self) -> Node:
        """Moment of all drives, reduced to the input: M + Σ M_k dψ_k/dφ, of sliding ones Σ F_k ds_k/dφ.

        What the crank drives has its share in the crank's own moment.
        """
        total = self.variables["input_moment_by_equilibrium"]
        for name, second in self.scene.inputs.items():
            if second.drive == "own":
                rate = mechanism.higher_pairs.second_input_motion.rate_of_drive(self.kinematics, name)
                total = total + self.variables[driving_field(self.scene, name)] * rate
        return total

    # Friction

    def _with_friction(
        self,
        name: str,
        links: Sequence[str],
        around: Sequence[Pair],
        solved: Solve,
        loads: Mapping[str, Wrench],
    ) -> Sequence[Components]:
        """Reactions in a group: those without its friction, and what each of its rubbing pairs adds."""
        free = solved(loads)
        rubbing = [(i, pair) for i, pair in enumerate(around) if pair.name in self._rubs]
        if not rubbing:
            return free
        backs = [solved(self._for_a_newton(pair, links)) for _, pair in rubbing]
        settled = mechanism.friction.pressing_in_group(
            [self._rubs[pair.name] for _, pair in rubbing],
            [free[i] for i, _ in rubbing],
            [[back[i] for back in backs] for i, _ in rubbing],
        )
        self.settlings[name] = settled
        named(settled.margin, f"{name} margin")
        named(settled.residual, f"{name} residual")
        for (_, pair), pressing in zip(rubbing, settled.pressing, strict=True):
            self._rubbed(pair, named(pressing, f"{pair.name} pressing"), links)
        return [
            tuple(
                sum((back[i][axis] * n for back, n in zip(backs, settled.pressing, strict=True)), free[i][axis])
                for axis in (0, 1)
            )
            for i in range(len(around))
        ]

    def _for_a_newton(self, pair: Pair, links: Sequence[str]) -> dict[str, Wrench]:
        """Loads on the links of a group by friction in one of its pairs, for each newton that presses."""
        loads = LinkLoads(self.kinematics)
        self._rub_on(loads, pair, ((pair.link, 1.0), (pair.other, -1.0)), self._rubs[pair.name].drag)
        return {link: loads.total(link) for link in links}

    def _rub_on(self, loads: LinkLoads, pair: Pair, sides: Iterable[tuple[str, float]], friction: Node) -> None:
        """Load sides of a pair, each with its sign, by friction on the pair's link."""
        for name, sign in sides:
            if pair.kind == "revolute":
                loads.twist(name, sign * friction)
            else:
                at, along = self._rubs_along(pair)
                loads.push(name, at, (sign * friction) * along)

    def _rubs_along(self, pair: Pair) -> tuple[MovingPoint, Vector]:
        """Where friction in a guide or on a cam acts, and its direction."""
        if pair.kind == "prismatic":
            link = self.kinematics.links[pair.link]
            return link.origin, link.u
        motion = self.kinematics.cams[pair.name.partition(".")[0]]
        return self.kinematics.at_rest(motion.contact), motion.normal.normal

    def _rubbed(self, pair: Pair, pressing: Node, within: Collection[str]) -> Node:
        """Friction on a pair's link by its pressing force; a link beyond the group bears its part."""
        if pair.name not in self._rubs:
            return self.graph.zero
        rub = self._rubs[pair.name]
        self._pressing[pair.name] = pressing
        friction = rub.drag * pressing
        self.variables[f"{pair.name}.{_FRICTION[pair.kind]}"] = friction
        self.lost[pair.name] = rub.lost * pressing
        self._rub_on(self._loads, pair, self._beyond(pair, within), friction)
        if pair.kind == "revolute":
            self._between(LinkForce("friction", pair.name, pair.link, pair.other, moment=friction))
        else:
            at, along = self._rubs_along(pair)
            self._between(LinkForce("friction", pair.name, pair.link, pair.other, at.r, friction * along))
        return friction

    def _kinks(self, pair: Pair, unloaded: Iterable[str]) -> None:
        """Say where the load of a pair has kinks, because it touches zero or a slider changes the edge it bears on.

        A reaction passes through zero where a link that bears nothing but pairs changes from push to pull: friction
        leans it to one side or the other, but its component along a bar, or across a slide, changes its sign.
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
        """Powers lost to friction, and the moment on the input that stands for them."""
        for pair, lost in self.lost.items():
            kind = (self._pairs | self._contacts)[pair].kind
            self.variables.setdefault(f"{pair}.{_FRICTION[kind]}", self.graph.zero)
            self.variables[f"{pair}.friction_power"] = self.motion.speed * lost
        for name, lost in self.lost_in_teeth.items():
            self.variables[f"{name}.mesh_loss"] = self.motion.speed * lost
        total = sum((*self.lost.values(), *self.lost_in_teeth.values()), self.graph.zero)
        self.variables["friction_moment"] = named(-(input_sense(self.kinematics) * total), "friction_moment")
        self.variables["input_moment_with_friction"] = self.moment_of_drives

    # The whole

    def _power(self) -> None:
        """Input moment by virtual power: that of all forces on all links, inertia forces among them, is zero."""
        power = self.variables.get("friction_moment", self.graph.zero)
        for name in self._moving:
            link, load = self.kinematics.links[name], self._own[name]
            power = power + (load.force.dot(link.origin.v) + load.moment * link.w)
        self.variables["input_moment_by_power"] = -power

    def _frame(self) -> dict[str, Node]:
        """What the machine does to its frame, and the equilibrium of the machine without it."""
        left = self._loads.total(FRAME)
        on_frame = self._own[FRAME] + left
        # The origin of the scene's coordinates, not that of the frame's as positions are counted.
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
    """A force in the axes of a link: along it, and to its left across it."""
    return Vector(force.dot(link.u), link.u.cross(force))
