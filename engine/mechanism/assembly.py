"""What is known of a mechanism as it is put together: points, links, guides and slides, each with its motion.

Rates are by the input: dr/dq and d²r/dq², the transfer functions of the textbooks, q being the crank's angle or the
displacement of a sliding input.

Positions are counted from the input's pivot, or from the point of its guide. So they are as small as the machine, and
a machine far from the origin of the scene's coordinates is computed with as many digits as one at the origin.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine import mechanism
from engine.graph.nodes import Graph, Node
from engine.mechanism.vectors import Vector, named
from engine.parts.skeleton import FRAME, CrankInput
from engine.scene import structure
from engine.scene.scene import Scene

# The law of the reactions in a dyad, and the geometry that it takes after the loads on its two links.
DyadStatics = tuple[Callable, tuple]


class MovingPoint(NamedTuple):
    """A point: its position [m], and its first and second derivative by the input."""

    r: Vector
    v: Vector
    a: Vector

    def called(self, name: str) -> "MovingPoint":
        """The same with names that a reader of the printed function will see."""
        return MovingPoint(self.r.called(name), self.v.called(f"{name}_phi"), self.a.called(f"{name}_phiphi"))


class Turning(NamedTuple):
    """A link: its origin, the direction of its x axis, and its angular rates dθ/dq and d²θ/dq²."""

    origin: MovingPoint
    u: Vector
    w: Node
    e: Node

    def at(self, arm: Vector) -> MovingPoint:
        """The motion of the link's point at an arm from its origin, given in the axes of the frame."""
        o, w = self.origin, self.w
        return MovingPoint(o.r + arm, o.v + w * arm.normal, o.a + self.e * arm.normal - (w * w) * arm)

    def called(self, name: str) -> "Turning":
        """The same with names that a reader of the printed function will see."""
        self.u.called(f"{name}_direction")
        named(self.w, f"{name}_angle_phi")
        named(self.e, f"{name}_angle_phiphi")
        return self


class GuideLine(NamedTuple):
    """A guide: the link that carries it, a point on it and its direction."""

    carrier: Turning
    r: Vector
    u: Vector

    def under(self, r: Vector) -> MovingPoint:
        """Motion of the carrier's point that lies in a place at the moment."""
        return self.carrier.at(r - self.carrier.origin.r)._replace(r=r)

    def along(self, slide: "Slide") -> MovingPoint:
        """Motion of what slides on the guide itself."""
        sliding = slide.v * self.u
        under = self.under(self.r + slide.d * self.u)
        return MovingPoint(under.r, under.v + sliding, under.a + self.coriolis(sliding) + slide.a * self.u)

    def coriolis(self, sliding: Vector) -> Vector:
        """Coriolis acceleration 2 w k × v of what slides with a velocity relative to the guide."""
        return (self.carrier.w + self.carrier.w) * sliding.normal


class Slide(NamedTuple):
    """A slide coordinate [m] and its first two derivatives by the input."""

    d: Node
    v: Node
    a: Node

    def called(self, name: str) -> "Slide":
        """The same with names that a reader of the printed function will see."""
        for node, suffix in zip(self, ("", "_phi", "_phiphi"), strict=True):
            named(node, f"{name}_slide{suffix}")
        return self


class Assembly:
    """The parts of a mechanism whose motion is known so far.

    Parameters
    ----------
    scene : Scene
    graph : Graph

    Attributes
    ----------
    datum : str
        Path of the point of the frame that positions are counted from.
    points, links, guides, slides : dict
        By their names in the scene.
    angles : dict of str to Node
        Of links that turn evenly or in mesh with such, over all their turns [rad].
    turned : dict of str to Node
        Of pinions and second inputs, their angles against what carries them, over all turns [rad].
    sines, closures : dict of str to Node
        Of each group the quality of force transmission, and what its loop misses of being closed.
    certificates : dict of str to Node
        Of each group of free links what proves its assembly mode.
    seed_tables : dict of str to SeedTables
        Of each group of free links.
    solutions : dict of str to tuple of Node
        Nodes that are needed wherever the position of a group of free links is.
    """

    def __init__(self, scene: Scene, graph: Graph) -> None:
        self.scene, self.graph = scene, graph
        crank = isinstance(scene.input, CrankInput)
        self.datum = f"points.{scene.input.pivot}" if crank else f"guides.{scene.input.guide}"
        self.nowhere = Vector(graph.zero, graph.zero)
        self.points: dict[str, MovingPoint] = {}
        frame = Turning(self.at_rest(self.nowhere), Vector(graph.one, graph.zero), graph.zero, graph.zero)
        self.links: dict[str, Turning] = {FRAME: frame}
        self.guides: dict[str, GuideLine] = {}
        self.slides: dict[str, Slide] = {}
        self.angles: dict[str, Node] = {FRAME: graph.zero}
        self.turned: dict[str, Node] = {}
        self.sines: dict[str, Node] = {}
        self.closures: dict[str, Node] = {}
        self.certificates: dict[str, Node] = {}
        self.seed_tables: dict[str, mechanism.groups.seed_tables.SeedTables] = {}
        self.solutions: dict[str, tuple[Node, ...]] = {}

    @property
    def has_cycle(self) -> bool:
        """Whether the input turns fully, so that there is a cycle to close."""
        return isinstance(self.scene.input, CrankInput) and self.scene.input.start is None

    def turns(self, link: str) -> Node:
        """Turns of a link over the cycle, against that which its angle is known against; 0 where there is no cycle."""
        if not self.has_cycle:
            return self.graph.zero
        scene, revolutions, net_turns = self.scene, self.scene.input.revolutions, structure.meshes.net_turns
        return self.graph.derived(f"turns of {link}", lambda n: revolutions * net_turns(scene, link, n))

    def at_rest(self, r: Vector) -> MovingPoint:
        """A point that doesn't move."""
        return MovingPoint(r, self.nowhere, self.nowhere)

    def number(self, path: str) -> Node:
        """A number of the scene."""
        return self.graph.number(path)

    def place(self, kind: str, name: str) -> Vector:
        """A point of a link, or the point of a guide, in the axes of its link; on the frame from the datum on.

        Parameters
        ----------
        kind : {"points", "guides"}
        name : str
        """
        path, part = f"{kind}.{name}", getattr(self.scene, kind)[name]
        if path == self.datum:
            return self.nowhere
        on_frame = part.link == FRAME
        return Vector(*(self._from_datum(path, axis) if on_frame else self.number(f"{path}.{axis}") for axis in "xy"))

    def _from_datum(self, path: str, axis: str) -> Node:
        own, datum = f"{path}.{axis}", f"{self.datum}.{axis}"
        return self.graph.derived(f"{own} from {datum}", lambda n: n[own] - n[datum])

    def coordinates(self, r: Vector) -> Vector:
        """The scene's coordinates of a position."""
        return r + Vector(self.number(f"{self.datum}.x"), self.number(f"{self.datum}.y"))

    def direction(self, path: str) -> Vector:
        """Direction at an angle of the scene."""
        return Vector(
            self.graph.derived(f"cos {path}", lambda n: np.cos(n[path])),
            self.graph.derived(f"sin {path}", lambda n: np.sin(n[path])),
        )

    def link(self, name: str, link: Turning) -> None:
        """Add a link of a group."""
        self.links[name] = link.called(name)

    def slider(self, name: str, origin: MovingPoint, guide: GuideLine, slide: Slide) -> None:
        """Add a link that slides along a guide."""
        self.links[name] = Turning(origin, guide.u, guide.carrier.w, guide.carrier.e)
        self.slides[name] = slide.called(name)

    def transmits(self, group: str, sine: Node, closure: Node) -> None:
        """Say how well a group transmits forces, and what its loop misses of being closed."""
        self.sines[group], self.closures[group] = named(sine, f"{group}_sine"), named(closure, f"{group}_closure")

    def solution(self, group: str) -> tuple[Node, ...]:
        """Nodes that are needed wherever a group's position is: the quality of transmission and the law behind it.

        Where the angle between two guides never changes, the quality follows from numbers alone, the position doesn't.
        """
        if group in self.solutions:
            return self.solutions[group]
        sine, slide = self.sines[group], self.slides.get(self.scene.groups[group].second.link)
        return (sine, *sine.operands, *(slide.d.operands if slide else ()))
