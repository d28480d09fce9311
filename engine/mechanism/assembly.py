"""The mechanism while it is built: points, links, guides and slides, each with its motion.

Derivatives are taken with respect to the input q (crank angle, or displacement of a sliding input): dr/dq and d²r/dq²
are the transfer functions of the textbooks.

Positions are measured from the input's pivot, or from the point of its guide. They are then no larger than the machine,
so a machine far from the origin of the scene's coordinates loses no digits.
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

# Law of a dyad's reactions, and its geometric arguments, which follow the loads on the dyad's two links.
DyadStatics = tuple[Callable, tuple]


class MovingPoint(NamedTuple):
    """A point: position [m], first and second derivative with respect to the input."""

    r: Vector
    v: Vector
    a: Vector

    def called(self, name: str) -> "MovingPoint":
        """Label the nodes for the printed function."""
        return MovingPoint(self.r.called(name), self.v.called(f"{name}_phi"), self.a.called(f"{name}_phiphi"))


class Turning(NamedTuple):
    """A link: origin, direction of its x axis, and angular rates dθ/dq and d²θ/dq²."""

    origin: MovingPoint
    u: Vector
    w: Node
    e: Node

    def at(self, arm: Vector) -> MovingPoint:
        """Motion of the point at `arm` from the link's origin; `arm` is in frame axes."""
        o, w = self.origin, self.w
        return MovingPoint(o.r + arm, o.v + w * arm.normal, o.a + self.e * arm.normal - (w * w) * arm)

    def called(self, name: str) -> "Turning":
        """Label the nodes for the printed function."""
        self.u.called(f"{name}_direction")
        named(self.w, f"{name}_angle_phi")
        named(self.e, f"{name}_angle_phiphi")
        return self


class GuideLine(NamedTuple):
    """A guide: its carrier, a point on the guide and its direction."""

    carrier: Turning
    r: Vector
    u: Vector

    def under(self, r: Vector) -> MovingPoint:
        """Motion of the carrier's point that coincides with `r`."""
        return self.carrier.at(r - self.carrier.origin.r)._replace(r=r)

    def along(self, slide: "Slide") -> MovingPoint:
        """Motion of a point that slides on the guide."""
        sliding = slide.v * self.u
        under = self.under(self.r + slide.d * self.u)
        return MovingPoint(under.r, under.v + sliding, under.a + self.coriolis(sliding) + slide.a * self.u)

    def coriolis(self, sliding: Vector) -> Vector:
        """Coriolis acceleration 2 w k × v for the sliding velocity v relative to the guide."""
        return (self.carrier.w + self.carrier.w) * sliding.normal


class Slide(NamedTuple):
    """A slide coordinate [m] and its first two derivatives with respect to the input."""

    d: Node
    v: Node
    a: Node

    def called(self, name: str) -> "Slide":
        """Label the nodes for the printed function."""
        for node, suffix in zip(self, ("", "_phi", "_phiphi"), strict=True):
            named(node, f"{name}_slide{suffix}")
        return self


class Vanishing(NamedTuple):
    """A curve that vanishes where a group is singular, relative to 1, or to its peak and the size of `beyond`."""

    curve: Node
    beyond: Node | None = None


class Course(NamedTuple):
    """The parameter with respect to which a mechanism's derivatives are taken, by the rates of its inputs.

    Attributes
    ----------
    first, second : Node
        First and second derivative of the input's coordinate.
    clock : Node or None
        Time, for laws of time [s]; None for that of constant input speed.
    pace : Node
        Derivative of the time.
    follows : bool
        Whether second inputs follow the input's coordinate by their laws.
    """

    first: Node
    second: Node
    clock: Node | None
    pace: Node
    follows: bool


class Assembly:
    """The parts of a mechanism whose motion is already known.

    Parameters
    ----------
    scene : Scene
    graph : Graph
    course : Course, optional
        By default, derivatives are with respect to the input.

    Attributes
    ----------
    datum : str
        Path of the frame point from which positions are measured.
    points, links, guides, slides : dict
        By name in the scene.
    angles : dict of str to Node
        Total angle over all turns of links that turn at a constant ratio to the crank or mesh with such a link [rad].
    turned : dict of str to Node
        Total angle over all turns of pinions and second inputs, relative to their carrier [rad].
    sines, closures : dict of str to Node
        Per group: transmission index (the sine of the transmission angle) and loop-closure residual.
    arms : dict of str to Vanishing
        Of groups whose rates and forces grow with the reciprocal of an arm, not of the transmission index: the arm.
    certificates : dict of str to Node
        Per group of free links: the quantity that proves its assembly mode.
    seed_tables : dict of str to SeedTables
        Per group of free links.
    solutions : dict of str to tuple of Node
        Nodes required wherever the position of a group is.
    """

    def __init__(self, scene: Scene, graph: Graph, course: Course | None = None) -> None:
        self.scene, self.graph = scene, graph
        self.course = course or Course(graph.one, graph.zero, None, graph.zero, follows=True)
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
        self.arms: dict[str, Vanishing] = {}
        self.closures: dict[str, Node] = {}
        self.certificates: dict[str, Node] = {}
        self.seed_tables: dict[str, mechanism.groups.seed_tables.SeedTables] = {}
        self.solutions: dict[str, tuple[Node, ...]] = {}

    def turns(self, link: str) -> Node:
        """Turns of a link over the cycle, relative to the reference of its angle; 0 without a cycle."""
        if not self.scene.has_cycle:
            return self.graph.zero
        scene, revolutions, net_turns = self.scene, self.scene.input.revolutions, structure.meshes.net_turns
        return self.graph.derived(f"turns of {link}", lambda n: revolutions * net_turns(scene, link, n))

    def at_rest(self, r: Vector) -> MovingPoint:
        """A fixed point."""
        return MovingPoint(r, self.nowhere, self.nowhere)

    def number(self, path: str) -> Node:
        """A number of the scene."""
        return self.graph.number(path)

    def place(self, kind: str, name: str) -> Vector:
        """Coordinates of a point or guide: in the axes of its link, or, on the frame, relative to the datum.

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
        """Convert a position to the scene's coordinates."""
        return r + Vector(self.number(f"{self.datum}.x"), self.number(f"{self.datum}.y"))

    def direction(self, path: str) -> Vector:
        """Unit vector at an angle of the scene."""
        return Vector(
            self.graph.derived(f"cos {path}", lambda n: np.cos(n[path])),
            self.graph.derived(f"sin {path}", lambda n: np.sin(n[path])),
        )

    def guide_on(self, name: str, carrier: Turning) -> GuideLine:
        """A guide on its carrier."""
        r, u = self.place("guides", name), self.direction(f"guides.{name}.angle")
        return GuideLine(carrier, carrier.origin.r + r.to_frame(carrier.u), u.to_frame(carrier.u))

    def link(self, name: str, link: Turning) -> None:
        """Register a link of a group."""
        self.links[name] = link.called(name)

    def slider(self, name: str, origin: MovingPoint, guide: GuideLine, slide: Slide) -> None:
        """Register a link that slides along a guide."""
        self.links[name] = Turning(origin, guide.u, guide.carrier.w, guide.carrier.e)
        self.slides[name] = slide.called(name)

    def transmits(self, group: str, sine: Node, closure: Node) -> None:
        """Register a group's transmission index and its loop-closure residual."""
        self.sines[group], self.closures[group] = named(sine, f"{group}_sine"), named(closure, f"{group}_closure")

    def vanishing(self, group: str) -> Vanishing:
        """What vanishes where a group is singular: its transmission index, or its arm if it has one."""
        return self.arms.get(group, Vanishing(self.sines[group]))

    def solution(self, group: str) -> tuple[Node, ...]:
        """Nodes required wherever a group's position is: the transmission index and the operands of its law.

        The operands are included because the index of two guides at a fixed angle follows from per-variant numbers
        only, while the position does not.
        """
        if group in self.solutions:
            return self.solutions[group]
        sine, slide = self.sines[group], self.slides.get(self.scene.groups[group].second.link)
        return (sine, *sine.operands, *(slide.d.operands if slide else ()))
