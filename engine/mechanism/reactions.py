"""Kinetostatics of an ordered mechanism as nodes: the reactions in all pairs, last group first.

By d'Alembert, inertia forces are added to the loads on each link. Each group is then in equilibrium under its own loads
and the reactions of the groups that follow it. The last step is the input link: the reaction of its pivot or guide, and
the drive torque or force; second inputs are solved in their order. Gears transmit pure moments unless the pressure
angle of their teeth is given.

Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on kinetostatics; N. E. Zhukovsky's lever for
the drive torque by virtual power.
"""

from collections.abc import Iterable, Mapping, Sequence

from engine import laws, mechanism
from engine.graph.nodes import Node
from engine.mechanism.actions.paths import input_sense
from engine.mechanism.applied_loads import AppliedLoads, forces_on_bodies
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Components, LinkForce, LinkLoads, Load, Wrench
from engine.mechanism.pair_reactions import FRICTION_FIELDS, PairReactions, Solve
from engine.mechanism.vectors import named
from engine.parts.skeleton import FRAME
from engine.scene.pairs import (
    Pair,
    drive_base,
    driving_field,
    has_friction,
    outer_pair,
    pairs_of_group,
)
from engine.scene.structure.ordering import Structure


class Reactions(PairReactions):
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
    checks : dict of str to Node
        Equilibrium of the whole machine: residual "force" and "moment"; for scale, the sums of magnitudes of all pair
        reactions ("forces") and of all moments on the frame ("moments").
    moment_of_drives : Node
        Torque of the input and of the second inputs, reduced to the input.
    """

    def __init__(
        self, kinematics: Kinematics, structure: Structure, loads: Iterable[Load], motion: InputMotion
    ) -> None:
        applied = AppliedLoads(kinematics, loads, motion)
        super().__init__(kinematics, applied, motion)
        self._own = applied.on_links
        balance = {
            "group": self._group,
            "free group": self._free_group,
            "cam": self._cam,
            "second input": self._second_input,
        }
        if any((self.scene.shafts, self.scene.noncircular_wheels, self.scene.racks, self.scene.pinions)):
            balance |= mechanism.higher_pairs.tooth_reactions.ToothReactions(self).kinds
        for element in reversed(structure.elements):
            if element.kind in balance:
                balance[element.kind](element.name)
        self._input()
        self.moment_of_drives = self._moment_of_drives()
        if has_friction(self.scene):
            self._losses()
        self._power()
        self.checks = self._frame()

    @property
    def _moving(self) -> list[str]:
        return [name for name in self.kinematics.links if name != FRAME]

    def link_forces(self) -> list[LinkForce]:
        """All loads on each link, one by one; every link except the frame is in equilibrium under them."""
        found: dict[tuple, LinkForce] = {}
        for one in (*forces_on_bodies(self.kinematics), *self.forces):
            # A load may have several parts, such as the pull and the damping of a spring.
            key = (one.kind, one.name, one.link, one.source, one.at)
            found[key] = one + found[key] if key in found else one
        return list(found.values())

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
        loads = {link: self.loads.total(link) for link in links}
        for pair, reaction in zip(around, self.with_friction(name, links, around, solved, loads), strict=True):
            self.react(pair, reaction, links)
        unloaded = {link for link, load in loads.items() if load.is_nothing}
        for pair in around:
            self.register_kinks(pair, unloaded)

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
        links, load = (cam.follower.link,), self.loads.total(cam.follower.link)
        touching, holding = self.contacts[f"{name}.contact"], outer_pair(self.scene, cam.follower.link)

        def solved(loads: Mapping[str, Wrench]) -> list[Components]:
            found = cam_forces(self.kinematics, name, loads[cam.follower.link])
            return [(found.contact, self.graph.zero), found.held]

        (contact, _), held = self.with_friction(name, links, (touching, holding), solved, {links[0]: load})
        closing = cam_forces(self.kinematics, name, load).closing
        self.variables |= {f"{name}.contact_force": contact, f"{name}.closing_force": closing}
        for node in self.bending.get(touching.name, ()):
            self.graph.bends(node, contact)
        at = self.kinematics.at_rest(motion.contact)
        self.exert(LinkForce("reaction", touching.name, *links, cam.on, at.r, contact * motion.normal), at, links)
        self.react(holding, held, links)
        self.register_kinks(holding, frozenset())

    def _input(self) -> None:
        needed = -self._load_on_drive(self.scene.input.link, FRAME, "input")
        self.variables["input_moment_by_equilibrium"] = named(needed, "input_moment_by_equilibrium")

    def _load_on_drive(self, name: str, base: str, pair: str) -> Node:
        """Balance an input by its drive, which reacts on the base; return the load on the drive."""
        load, link, ends = self.loads.total(name), self.kinematics.links[name], (name, name, base)
        if self.pairs[pair].kind == "prismatic":
            total = load.force.dot(link.u) + self._in_guide(pair, load)
            self.exert(LinkForce("drive", *ends, link.origin.r, -total * link.u), link.origin, {name})
        else:
            total = load.moment + self.in_pivot(pair, load)
            self.exert(LinkForce("drive", *ends, moment=-total), None, {name})
        return total

    def _in_guide(self, name: str, load: Wrench) -> Node:
        """Register the reaction of an input's guide; return its friction force."""
        pair = self.pairs[name]
        normal, turning = load.force.cross(self.kinematics.links[pair.link].u), -load.moment
        self.react(pair, (normal, turning), {pair.link})
        if name not in self.rubs:
            return self.graph.zero
        edge = self.rubs[name].edge
        pressing = self.graph.apply(laws.friction.feedback.guide_pressing, normal, turning, edge)
        friction = self.apply_friction(pair, pressing, {pair.link})
        self.register_kinks(pair, frozenset())
        return friction

    def _second_input(self, name: str) -> None:
        """Balance a second input by its drive, which reacts on the carrier, and on the crank if that drives it."""
        total = self._load_on_drive(name, drive_base(self.scene, name), name)
        if self.scene.inputs[name].drive == "crank":
            passed = total * mechanism.higher_pairs.second_input_motion.rate_of_drive(self.kinematics, name)
            self.loads.twist(self.scene.input.link, passed)
            self.loads.twist(FRAME, -passed)
            self.forces.append(LinkForce("gears", name, self.scene.input.link, name, moment=passed))
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

    def _losses(self) -> None:
        """Register friction power, and the equivalent moment on the input."""
        for pair, lost in self.lost.items():
            kind = (self.pairs | self.contacts)[pair].kind
            self.variables.setdefault(f"{pair}.{FRICTION_FIELDS[kind]}", self.graph.zero)
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
        left = self.loads.total(FRAME)
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
            "forces": sum((abs(self.variables[f"{name}.reaction"]) for name in self.pairs), zero),
            "moment": total.moment - left.moment,
            "moments": sum((abs(moment) for moment in self.loads.moments(FRAME)), zero),
        }
