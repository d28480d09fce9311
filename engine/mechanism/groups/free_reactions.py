"""Reactions in the pairs of a group of free links, from the transposed Jacobian of its loops.

A cut link passes its loads to its ends, except for the force along the link; the force in a cut joint is entirely
unknown. These forces λ keep the remaining open chain in equilibrium. By virtual work, Jᵀλ = Q, with J the Jacobian of
the loops and Q the work of all loads per unknown. The chain is then dismantled from its ends.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on the kinetostatics of groups of class III.
"""

from collections.abc import Mapping

from engine.graph.nodes import Node
from engine.mechanism.assembly import Assembly, MovingPoint, Turning
from engine.mechanism.groups.closure_of_free import ClosureOfFree, CutLink
from engine.mechanism.groups.free import FreeMotion
from engine.mechanism.link_loads import Components, LinkLoads, Wrench
from engine.mechanism.vectors import Vector
from engine.scene.pairs import Pair


def free_reactions(assembly: Assembly, motion: FreeMotion, loads: Mapping[str, Wrench]) -> dict[str, Components]:
    """Reactions in the pairs, by pair name; each acts on the link of that name.

    Parameters
    ----------
    assembly : Assembly
    motion : FreeMotion
    loads : mapping of str to Wrench
        Resultant load on each link of the group.
    """
    on_links = LinkLoads(assembly)
    for link, load in loads.items():
        on_links.add(link, load)
    return _Balance(assembly, motion, on_links).reactions


class _Balance:
    """The equilibrium of a group, link by link."""

    def __init__(self, assembly: Assembly, motion: FreeMotion, loads: LinkLoads) -> None:
        self._links, self._motion, self._loads = assembly.links, motion, loads
        self._closure: ClosureOfFree = motion.closure
        self.reactions: dict[str, Components] = {}
        closure = self._closure
        own = {cut.name: self._pass_to_ends(cut) for cut in closure.cut_links}
        unknown = motion.linearised.inverse.transposed_times([self._work(unit) for unit in motion.linearised.units])
        for cut, force in zip(closure.cut_links, unknown, strict=False):
            self._along(cut, own[cut.name], force)
        rest = unknown[len(closure.cut_links) :]
        for i, pair in enumerate(closure.cutting.cut_pairs):
            self._cut_pair(pair, *rest[2 * i : 2 * i + 2])
        for name, pair in reversed(closure.cutting.placed):
            self._remove_link(name, pair)

    def _work(self, unit: dict[str, Turning]) -> Node:
        """Work of all loads on the open chain per unit of an unknown."""
        total = self._closure.graph.zero
        for name, _ in self._closure.cutting.placed:
            load, link = self._loads.total(name), unit[name]
            total = total + (load.force.dot(link.origin.v) + load.moment * link.w)
        return total

    def _joint(self, name: str, pair: Pair) -> MovingPoint:
        """The joint of a pair as a point of the link beyond it."""
        return self._closure.joint_on(self._motion.links, pair.beyond(name), pair.joint)

    def _register(self, pair: Pair, name: str, force: Vector) -> None:
        """Register the force in a joint, given as it acts on the link `name`."""
        self.reactions[pair.name] = tuple(force if pair.link == name else -force)

    # Cut links

    def _pass_to_ends(self, cut: CutLink) -> Wrench:
        """Pass a cut link's loads to its ends, without the unknown force; return its load about the first joint."""
        total, joint = self._loads.total(cut.name), self._joint(cut.name, cut.one)
        moment = total.moment - (joint.r - self._links[cut.name].origin.r).cross(total.force)
        load = Wrench(total.force, moment)
        if cut.other.kind == "prismatic":
            self._loads.push(cut.one.beyond(cut.name), joint, total.force)
            self._loads.twist(cut.other.beyond(cut.name), moment)
            return load
        across = self._across(cut, load)
        self._loads.push(cut.one.beyond(cut.name), joint, total.force + across)
        self._loads.push(cut.other.beyond(cut.name), self._joint(cut.name, cut.other), -across)
        return load

    def _direction(self, cut: CutLink) -> Vector:
        one, other = self._closure.ends(self._motion.links, cut)
        return (other.r - one.r) * (self._closure.graph.one / self._closure.bar(cut).length)

    def _across(self, cut: CutLink, load: Wrench) -> Vector:
        """Force across a cut link in its second joint, which balances the moments about the first."""
        return -(load.moment / self._closure.bar(cut).length) * self._direction(cut).normal

    def _along(self, cut: CutLink, load: Wrench, unknown: Node) -> None:
        """Apply the solved force of a cut link, and register the link's reactions."""
        joint, one, other = self._joint(cut.name, cut.one), *(p.beyond(cut.name) for p in (cut.one, cut.other))
        if cut.other.kind == "revolute":
            one_end, other_end = self._closure.ends(self._motion.links, cut)
            force = unknown * (other_end.r - one_end.r)
            self._loads.push(one, joint, force)
            self._loads.push(other, self._joint(cut.name, cut.other), -force)
            at_end = force + self._across(cut, load)
            self._register(cut.other, cut.name, at_end)
            self._register(cut.one, cut.name, -(load.force + at_end))
            return
        line, _ = self._closure.line(self._motion.links, cut)
        normal = -unknown
        force = normal * line.u.normal
        self._loads.push(one, joint, force)
        self._loads.push(other, joint, -force)
        self._register(cut.one, cut.name, -(load.force + force))
        if cut.other.link == cut.name:
            arm = self._links[cut.name].origin.r - joint.r
            self.reactions[cut.other.name] = normal, -load.moment - arm.cross(force)
            return
        # The slider is the link beyond: it takes the opposite reaction, about its own origin.
        arm = joint.r - self._links[other].origin.r
        self.reactions[cut.other.name] = -normal, load.moment - arm.cross(force)

    # Cut pairs

    def _cut_pair(self, pair: Pair, one: Node, other: Node) -> None:
        if pair.kind == "revolute":
            force, joint = Vector(one, other), self._joint(pair.link, pair)
            self._loads.push(pair.link, joint, -force)
            self._loads.push(pair.other, joint, force)
            self.reactions[pair.name] = tuple(-force)
            return
        slider, carrier = self._links[pair.link], self._links[pair.other]
        line = self._closure.assembly.guide_on(self._closure.slider_guide(pair), carrier)
        moment, force = -(one * self._closure.size * line.u.dot(slider.u)), -other * line.u.normal
        self._loads.push(pair.link, slider.origin, force)
        self._loads.push(pair.other, slider.origin, -force)
        self._loads.twist(pair.link, moment)
        self._loads.twist(pair.other, -moment)
        self.reactions[pair.name] = force.dot(slider.u.normal), moment

    # The open chain

    def _remove_link(self, name: str, pair: Pair) -> None:
        """Remove the last link of the chain: its pair takes all its loads."""
        load, link, other = self._loads.total(name), self._links[name], pair.beyond(name)
        if pair.kind == "revolute":
            self._register(pair, name, -load.force)
            self._loads.push(other, self._joint(name, pair), load.force)
            return
        slider = self._links[pair.link]
        normal = load.force.dot(slider.u.normal)
        moment = load.moment - (slider.origin.r - link.origin.r).cross(load.force)
        self._loads.push(other, slider.origin, normal * slider.u.normal)
        self._loads.twist(other, moment)
        self.reactions[pair.name] = (-normal, -moment) if name == pair.link else (normal, moment)
