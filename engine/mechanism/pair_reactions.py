"""The reactions in pairs: their fields, their friction and its losses, and their kinks.

Friction in a pair changes the reactions in its own group, and those in all groups solved after it.
"""

from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

from engine import mechanism
from engine.graph.nodes import Node
from engine.mechanism.applied_loads import AppliedLoads
from engine.mechanism.assembly import MovingPoint, Turning
from engine.mechanism.input_motion import InputMotion
from engine.mechanism.kinematics import Kinematics
from engine.mechanism.link_loads import Components, LinkForce, LinkLoads, Wrench
from engine.mechanism.vectors import Vector, named
from engine.parts.skeleton import FRAME
from engine.scene.pairs import Pair, contact_pairs, pairs

# Friction fields for each kind of pair.
FRICTION_FIELDS = {"revolute": "friction_moment", "prismatic": "friction_force", "contact": "friction_force"}
# Solves for the reactions in a group's pairs, from the loads on its links.
Solve = Callable[[Mapping[str, Wrench]], Sequence[Components]]


class PairReactions:
    """Registers the reactions in pairs, and applies them to the links.

    Parameters
    ----------
    kinematics : Kinematics
    applied : AppliedLoads
    motion : InputMotion

    Attributes
    ----------
    pairs, contacts : dict of str to Pair
        Lower pairs, and those of cams, by name.
    variables : dict of str to Node
        Fields by name.
    forces : list of LinkForce
        Forces and moments on the links, one by one.
    loads : LinkLoads
        Those on every moving link that are known so far; reactions within a group are left out.
    in_axes : dict of (str, str) to Vector
        By revolute pair and link: the force on that link, in the link's axes.
    lost : dict of str to Node
        Work lost in each pair with friction per unit of input motion.
    lost_in_teeth : dict of str to Node
        The same of the mesh of each wheel or rack with an efficiency.
    settlings : dict of str to Settled
        Per group with friction: pressing forces and margin against jamming.
    bending : dict of str to tuple of Node
        Per pair with friction: pressing forces that have a kink where the pair's load has one, its own and, in a group,
        those of the other pairs.
    """

    def __init__(self, kinematics: Kinematics, applied: AppliedLoads, motion: InputMotion) -> None:
        self.kinematics, self.motion = kinematics, motion
        self.scene, self.graph = kinematics.scene, kinematics.graph
        self.variables, self.forces = applied.fields, applied.forces
        self.in_axes: dict[tuple[str, str], Vector] = {}
        self.settlings: dict[str, mechanism.friction.Settled] = {}
        self.bending: dict[str, tuple[Node, ...]] = {}
        self.pairs = {pair.name: pair for pair in pairs(self.scene)}
        self.contacts = {pair.name: pair for pair in contact_pairs(self.scene)}
        self.rubs = mechanism.friction.rubbing_pairs(kinematics, motion) if self.scene.friction else {}
        self.lost = {friction.pair: self.graph.zero for friction in self.scene.friction.values()}
        self.lost_in_teeth: dict[str, Node] = {}
        self.loads = LinkLoads(kinematics)
        for name in kinematics.links:
            if name != FRAME:
                self.loads.add(name, applied.on_links[name])

    def force_in(self, pair: str) -> Vector:
        """Force exerted by a pair on its link, in frame axes."""
        return Vector(*(self.variables[f"{pair}.reaction_{axis}"] for axis in "xy"))

    def react(self, pair: Pair, reaction: Components, within: Collection[str]) -> None:
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
        self.exert(LinkForce("reaction", *ends, at.r, force), at, within)
        for moment in moments:
            self.exert(LinkForce("reaction", *ends, moment=moment), None, within)

    def exert(self, found: LinkForce, at: MovingPoint | None = None, within: Collection[str] = ()) -> None:
        """Register a force or moment between two links, and apply it to those outside a group."""
        self.forces += [found, found.opposite]
        self.loads.apply(found, at, within)

    def in_pivot(self, name: str, load: Wrench) -> Node:
        """Register the reaction of a pivot; return its friction moment."""
        pair = self.pairs[name]
        self.react(pair, -load.force, {pair.link})
        friction = self.apply_friction(pair, self.variables[f"{name}.reaction"], {pair.link})
        self.register_kinks(pair, frozenset())
        return friction

    def with_friction(
        self, name: str, links: Sequence[str], around: Sequence[Pair], solved: Solve, loads: Mapping[str, Wrench]
    ) -> Sequence[Components]:
        """Reactions in a group: those without its own friction, plus the effect of each pair with friction."""
        free = solved(loads)
        frictional = [(i, pair) for i, pair in enumerate(around) if pair.name in self.rubs]
        if not frictional:
            return free
        backs = [solved(self._loads_per_newton(pair, links)) for _, pair in frictional]
        settled = mechanism.friction.pressing_in_group(
            [self.rubs[pair.name] for _, pair in frictional],
            [free[i] for i, _ in frictional],
            [[back[i] for back in backs] for i, _ in frictional],
        )
        self.settlings[name] = settled
        named(settled.margin, f"{name} margin")
        named(settled.residual, f"{name} residual")
        for (_, pair), pressing in zip(frictional, settled.pressing, strict=True):
            self.bending[pair.name] = settled.pressing
            self.apply_friction(pair, named(pressing, f"{pair.name} pressing"), links)
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
        loads.apply(*self._friction_in(pair, self.rubs[pair.name].drag))
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

    def apply_friction(self, pair: Pair, pressing: Node, within: Collection[str]) -> Node:
        """Friction on a pair's link from its pressing force; also applied to the pair's links outside the group."""
        if pair.name not in self.rubs:
            return self.graph.zero
        rub = self.rubs[pair.name]
        self.bending.setdefault(pair.name, (pressing,))
        friction = rub.drag * pressing
        self.variables[f"{pair.name}.{FRICTION_FIELDS[pair.kind]}"] = friction
        self.lost[pair.name] = rub.lost * pressing
        self.exert(*self._friction_in(pair, friction), within)
        return friction

    def register_kinks(self, pair: Pair, unloaded: Iterable[str]) -> None:
        """Register the kinks in a pair's load: a reaction touches zero, or a slider changes the edge it bears on.

        The reaction passes through zero where a link loaded only by its pairs changes from compression to tension.
        Friction tilts the reaction, but its component along a bar, or across a slide, still changes sign there.
        """
        rub, found = self.rubs.get(pair.name), []
        loads = [*self.bending.get(pair.name, ())]
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


def _components(force: Vector, link: Turning) -> Vector:
    """Components of a force along a link and across it, to its left."""
    return Vector(force.dot(link.u), link.u.cross(force))
