"""The loops of a group of free links as nodes: positions of its links for given unknowns, and loop residuals.

Unknowns are the directions of links placed by a revolute pair, and the slides of links placed by a prismatic one.
Equations state that cut links keep their length, or their distance from a guide, and that cut joints coincide. Each is
computed with its first and second derivative, so the same functions give residuals, the Jacobian (all other unknowns
and links at rest), and the right-hand sides for velocities and accelerations.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on groups of class III and IV; J. Wittenburg,
Dynamics of Multibody Systems, chapter on the closure conditions of cut joints.
"""

from collections.abc import Sequence
from typing import NamedTuple

from engine.graph.nodes import Node
from engine.mechanism.assembly import Assembly, GuideLine, MovingPoint, Slide, Turning
from engine.mechanism.vectors import Vector
from engine.scene.pairs import Pair
from engine.scene.structure.free_groups import Cutting, FreeGroup, cutting_of


class Direction(NamedTuple):
    """A direction with its first and second rate; one kind of unknown."""

    u: Vector
    w: Node
    e: Node


Unknown = Direction | Slide


class LoopResidual(NamedTuple):
    """Residual of an equation, with its first and second derivative."""

    r: Node
    v: Node
    a: Node


class Reach(NamedTuple):
    """Bounds of a position's derivatives by the unknowns: each first derivative, and the sum of all second ones."""

    first: tuple[Node, ...]
    second: Node


class CutLink(NamedTuple):
    """A link cut out of its loops, between a joint and another joint or a guide.

    Attributes
    ----------
    name : str
    one, other : Pair
        A revolute pair; the other pair.
    """

    name: str
    one: Pair
    other: Pair


class ClosureOfFree:
    """The loops of a group of free links.

    Parameters
    ----------
    assembly : Assembly
        The mechanism without the group.
    group : FreeGroup

    Attributes
    ----------
    cutting : Cutting
    size : Node
        Largest length in the group [m].
    units : list of Node
        Unit of each unknown: 1 rad, or the size for a slide.
    """

    def __init__(self, assembly: Assembly, group: FreeGroup) -> None:
        self.assembly, self.graph, self.group = assembly, assembly.graph, group
        self.cutting: Cutting = cutting_of(group)
        self.cut_links = tuple(self._cut(name) for name in self.cutting.cut_links)
        self.size = self._size()
        self.units = [self.size if pair.kind == "prismatic" else self.graph.one for _, pair in self.cutting.placed]

    def _cut(self, name: str) -> CutLink:
        one, other = sorted(self.group.pairs_of(name), key=lambda pair: pair.kind != "revolute")
        return CutLink(name, one, other)

    def _size(self) -> Node:
        scene, paths = self.assembly.scene, []
        for link in self.group.links:
            paths += [f"links.{link}.length"] if scene.links[link].length is not None else []
            paths += [f"points.{p}.{axis}" for p, part in scene.points.items() if part.link == link for axis in "xy"]
        if not paths:
            return self.graph.one

        def largest(numbers: dict) -> float:
            found = abs(numbers[paths[0]])
            for path in paths[1:]:
                other = abs(numbers[path])
                found = found + 0.5 * (other - found + abs(other - found))
            return found

        return self.graph.derived(f"size of {self.group.name}", largest)

    # Positions on links

    def local(self, link: str, joint: str) -> Vector:
        """Position of a joint in the axes of a free link."""
        joints = self.assembly.scene.links[link].joints
        if joint in joints:
            along = (
                self.assembly.number(f"links.{link}.length") if joint == joints[-1] != joints[0] else self.graph.zero
            )
            return Vector(along, self.graph.zero)
        return self.assembly.place("points", joint)

    def offset(self, link: str) -> Node:
        """Distance of a slider's origin from its guide, positive to the left."""
        return self.assembly.number(f"links.{link}.offset")

    def slider_guide(self, pair: Pair) -> str:
        """Name of the guide of a prismatic pair."""
        return self.assembly.scene.links[pair.link].guide

    def _known(self, name: str, still: bool) -> Turning:
        link = self.assembly.links[name]
        if not still:
            return link
        return Turning(self.assembly.at_rest(link.origin.r), link.u, self.graph.zero, self.graph.zero)

    # Placing links

    def placed(self, unknowns: Sequence[Unknown], still: bool = False) -> dict[str, Turning]:
        """Motion of the placed links and of the known links that carry them; cut links are absent.

        Parameters
        ----------
        unknowns : sequence of Direction or Slide
        still : bool
            Whether known links are treated as at rest.
        """
        around = {name for pair in self.group.pairs for name in (pair.link, pair.other)} - set(self.group.links)
        links = {name: self._known(name, still) for name in sorted(around)}
        for (name, pair), unknown in zip(self.cutting.placed, unknowns, strict=True):
            if isinstance(unknown, Direction):
                at = self.joint_on(links, pair.beyond(name), pair.joint)
                links[name] = hinged(Turning(at, *unknown), self.local(name, pair.joint))
            elif name == pair.link:
                links[name] = self._sliding(links, pair, unknown)
            else:
                links[name] = self._carrying(links, pair, unknown)
        return links

    def joint_on(self, links: dict[str, Turning], link: str, joint: str) -> MovingPoint:
        """Motion of a joint as a point of one of the links that meet there."""
        if link in self.group.links or joint not in self.assembly.points:
            return point_on(links[link], self.local(link, joint))
        point, moves = self.assembly.points[joint], links[link] == self.assembly.links[link]
        return point if moves else self.assembly.at_rest(point.r)

    def _sliding(self, links: dict[str, Turning], pair: Pair, unknown: Slide) -> Turning:
        """A slider on a guide of a link placed before it."""
        line = self.assembly.guide_on(self.slider_guide(pair), links[pair.other])
        origin = line._replace(r=line.r + self.offset(pair.link) * line.u.normal).along(unknown)
        return Turning(origin, line.u, line.carrier.w, line.carrier.e)

    def _carrying(self, links: dict[str, Turning], pair: Pair, unknown: Slide) -> Turning:
        """A link whose guide carries a slider placed before it."""
        slider, name = links[pair.link], self.slider_guide(pair)
        angle = self.assembly.direction(f"guides.{name}.angle")
        u = Vector(angle.x, -angle.y).to_frame(slider.u)
        r = self.assembly.place("guides", name)
        axis, sliding = slider.u, unknown.v * slider.u
        carrier = Turning(slider.origin, u, slider.w, slider.e)
        # The carrier's point under the slider moves with the slider, less the relative sliding.
        back = (carrier.w + carrier.w) * sliding.normal
        under = MovingPoint(slider.origin.r, slider.origin.v - sliding, slider.origin.a - back - unknown.a * axis)
        arm = -(r.to_frame(u) + unknown.d * axis + self.offset(pair.link) * axis.normal)
        return carrier._replace(origin=_at_arm(carrier._replace(origin=under), arm))

    # Equations

    def misses(self, links: dict[str, Turning]) -> list[LoopResidual]:
        """Residuals of the loops: of cut links, then of cut pairs."""
        found = [self._of_link(links, cut) for cut in self.cut_links]
        return found + [miss for pair in self.cutting.cut_pairs for miss in self._of_pair(links, pair)]

    def ends(self, links: dict[str, Turning], cut: CutLink) -> list[MovingPoint]:
        """Joints at both ends of a cut link with two joints."""
        return [self.joint_on(links, pair.beyond(cut.name), pair.joint) for pair in (cut.one, cut.other)]

    def measures(self) -> list[Node]:
        """Factor of each equation that makes its residual a length: the residual of a cut link is a square."""
        found = [self.bar(cut).length if cut.other.kind == "revolute" else self.graph.one for cut in self.cut_links]
        return found + [self.graph.one] * (2 * len(self.cutting.cut_pairs))

    def bar(self, cut: CutLink) -> Vector:
        """Vector from the first to the second joint of a cut link, in the link's axes."""
        return self.local(cut.name, cut.other.joint) - self.local(cut.name, cut.one.joint)

    def line(self, links: dict[str, Turning], cut: CutLink) -> tuple[GuideLine, Node]:
        """Guide line of a cut link's joint, on the link beyond the guide, and the joint's distance to its left."""
        joint, guide = self.local(cut.name, cut.one.joint), self.slider_guide(cut.other)
        if cut.other.link == cut.name:
            return self.assembly.guide_on(guide, links[cut.other.other]), self.offset(cut.name) + joint.y
        slider = links[cut.other.link]
        r = self.assembly.place("guides", guide)
        angle = self.assembly.direction(f"guides.{guide}.angle")
        return GuideLine(slider, slider.origin.r, slider.u), angle.cross(joint - r) - self.offset(cut.other.link)

    def _of_link(self, links: dict[str, Turning], cut: CutLink) -> LoopResidual:
        if cut.other.kind == "prismatic":
            point = self.joint_on(links, cut.one.beyond(cut.name), cut.one.joint)
            return _line_residual(*self.line(links, cut), point)
        bar = self.bar(cut)
        r, v, a = (two - first for first, two in zip(*self.ends(links, cut), strict=True))
        return LoopResidual((r.dot(r) - bar.dot(bar)) * 0.5, r.dot(v), r.dot(a) + v.dot(v))

    def _of_pair(self, links: dict[str, Turning], pair: Pair) -> list[LoopResidual]:
        if pair.kind == "revolute":
            joints = (self.joint_on(links, link, pair.joint) for link in (pair.link, pair.other))
            r, v, a = (first - two for first, two in zip(*joints, strict=True))
            return [LoopResidual(r.x, v.x, a.x), LoopResidual(r.y, v.y, a.y)]
        line, slider = self.assembly.guide_on(self.slider_guide(pair), links[pair.other]), links[pair.link]
        sine, cosine = line.u.cross(slider.u), line.u.dot(slider.u)
        w, e = slider.w - line.carrier.w, slider.e - line.carrier.e
        turning = LoopResidual(sine * self.size, cosine * w * self.size, (cosine * e - sine * w * w) * self.size)
        return [turning, _line_residual(line, self.offset(pair.link), slider.origin)]

    # Bounds for the proof

    def bounds(
        self, unknowns: Sequence[Unknown], misses: Sequence[LoopResidual], within: Node
    ) -> tuple[list[list[Node]], list[Node]]:
        """Bounds of each equation's first derivatives at these unknowns, and of the sum of its second derivatives.

        Parameters
        ----------
        unknowns : sequence of Direction or Slide
        misses : sequence of LoopResidual
            Residuals at the unknowns.
        within : Node
            Radius in which the bounds of second derivatives hold [rad, or units of the group's size].
        """
        graph, count = self.graph, len(unknowns)
        links = self.placed(unknowns)
        nothing = Reach((graph.zero,) * count, graph.zero)
        turns: dict[str, int | None] = {}
        origins: dict[str, tuple[Reach, Vector]] = {}

        def reach(name: str, pair: Pair) -> Reach:
            """Bounds for the joint of a pair, as a point of the link beyond it."""
            link = pair.beyond(name)
            if link not in origins:
                return nothing
            base, place = origins[link]
            return _turned_by(base, turns[link], (self.local(link, pair.joint) - place).length)

        def from_line(point: Reach, carrier: str, r: Vector) -> tuple[list[Node], Node]:
            """Bounds of the distance of a point at r from a line on its carrier, which may turn with an unknown."""
            base, place = origins.get(carrier, (nothing, self.assembly.nowhere))
            first = [a + b for a, b in zip(point.first, base.first, strict=True)]
            second, turning = point.second + base.second, turns.get(carrier)
            if turning is None:
                return first, second
            arm = (r - point_on(links[carrier], place).r).length
            second = second + 2.0 * sum(first) + (arm + sum(first) * within)
            return [f + arm if k == turning else f for k, f in enumerate(first)], second

        for i, ((name, pair), unknown) in enumerate(zip(self.cutting.placed, unknowns, strict=True)):
            other = pair.beyond(name)
            if isinstance(unknown, Direction):
                turns[name] = i
                origins[name] = reach(name, pair), self.local(name, pair.joint)
                continue
            turns[name] = turns.get(other)
            r = self.assembly.place("guides", self.slider_guide(pair))
            arm = abs(unknown.d) + self.size * within + abs(self.offset(pair.link)) + r.length
            base, place = origins.get(other, (nothing, self.assembly.nowhere))
            moved = _turned_by(base, turns[name], arm + place.length)
            first = tuple(f + self.size if k == i else f for k, f in enumerate(moved.first))
            twice = self.size + self.size if turns[name] is not None else graph.zero
            origins[name] = Reach(first, moved.second + twice), self.assembly.nowhere
        found = []
        for cut, miss in zip(self.cut_links, misses, strict=False):
            one = reach(cut.name, cut.one)
            if cut.other.kind == "prismatic":
                point = self.joint_on(links, cut.one.beyond(cut.name), cut.one.joint)
                found.append(from_line(one, cut.other.beyond(cut.name), point.r))
                continue
            two = reach(cut.name, cut.other)
            first = [a + b for a, b in zip(one.first, two.first, strict=True)]
            total, length = sum(first), self.bar(cut).length
            # Upper bound: the residual is half the difference of the squares of distance and length.
            distance = length + abs(miss.r) * (graph.one / length) + total * within
            first = [bound * length for bound in first]
            found.append((first, total * total + (one.second + two.second) * distance))
        for pair in self.cutting.cut_pairs:
            if pair.kind == "revolute":
                one, two = (reach(name, pair) for name in (pair.other, pair.link))
                first = [a + b for a, b in zip(one.first, two.first, strict=True)]
                found += [(first, one.second + two.second)] * 2
                continue
            both = turns.get(pair.link), turns.get(pair.other)
            found.append(([self.size if k in both else graph.zero for k in range(count)], 4.0 * self.size))
            one = origins.get(pair.link, (nothing, None))[0]
            found.append(from_line(one, pair.other, links[pair.link].origin.r))
        return [first for first, _ in found], [second for _, second in found]


def hinged(link: Turning, place: Vector) -> Turning:
    """A link whose motion is given at one of its points instead of its origin."""
    return link._replace(origin=point_on(link, -place))


def point_on(link: Turning, place: Vector) -> MovingPoint:
    """Motion of a point given in a link's axes."""
    return _at_arm(link, place.to_frame(link.u))


def _at_arm(link: Turning, arm: Vector) -> MovingPoint:
    nothing = link.w.graph.zero
    return link.origin if arm == (nothing, nothing) else link.at(arm)


def _line_residual(line: GuideLine, offset: Node, point: MovingPoint) -> LoopResidual:
    """Residual of a point's distance to the left of a line."""
    under, n = line.under(point.r), line.u.normal
    relative = point.v - under.v
    return LoopResidual(
        n.dot(point.r - line.r) - offset, n.dot(relative), n.dot(point.a - under.a - line.coriolis(relative))
    )


def _turned_by(base: Reach, turns: int | None, arm: Node) -> Reach:
    """Bounds of a point at `arm` from a base point, on a link that turns with an unknown."""
    if turns is None:
        return base
    return Reach(tuple(f + arm if k == turns else f for k, f in enumerate(base.first)), base.second + arm)
