"""The kinematics of an ordered mechanism as nodes, one structural group after another.

Rates are by the input: dr/dq and d²r/dq², the transfer functions of the textbooks, q being the crank's angle or the
displacement of a sliding input. Sources: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on the
kinematics of structural groups by closed forms.
"""

from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Graph, Node
from engine.laws.kinematics.dyads import (
    oblique_components,
    rpr_position,
    rpr_rates,
    rrp_position,
    rrp_rates,
    rrr_position,
    rrr_rates,
)
from engine.laws.kinematics.links import direction_of
from engine.mechanism.vectors import Vector, named
from engine.scene.masses import LinkMass, masses, whole_body
from engine.scene.parts import FRAME, CrankInput
from engine.scene.scene import Scene
from engine.scene.structure import Structure


class Moving(NamedTuple):
    """A point: its position [m], and its first and second derivative by the input."""

    r: Vector
    v: Vector
    a: Vector

    def called(self, name: str) -> "Moving":
        """The same with names that a reader of the printed function will see."""
        return Moving(self.r.called(name), self.v.called(f"{name}_phi"), self.a.called(f"{name}_phiphi"))


class Turning(NamedTuple):
    """A link: its origin, the direction of its x axis, and its angular rates dθ/dq and d²θ/dq²."""

    origin: Moving
    u: Vector
    w: Node
    e: Node

    def at(self, arm: Vector) -> Moving:
        """The motion of the link's point at an arm from its origin, given in the axes of the frame."""
        o, w = self.origin, self.w
        return Moving(o.r + arm, o.v + w * arm.normal, o.a + self.e * arm.normal - (w * w) * arm)

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


class Kinematics:
    """The motion of every point, link and slider of a scene.

    Parameters
    ----------
    scene : Scene
    structure : Structure
    graph : Graph
    varied : frozenset of str
        Paths of numbers that will vary.

    Attributes
    ----------
    points, links, guides, slides : dict
        By their names in the scene.
    sines : dict of str to Node
        Quality of force transmission of each group.
    masses : dict of str to LinkMass
        Bodies and the point masses that stand for bodies.
    """

    def __init__(self, scene: Scene, structure: Structure, graph: Graph, varied: frozenset[str]) -> None:
        self.scene, self.graph, self.varied = scene, graph, varied
        self.nowhere = Vector(graph.zero, graph.zero)
        still = self.at_rest(self.nowhere)
        self.points: dict[str, Moving] = {}
        self.links: dict[str, Turning] = {FRAME: Turning(still, Vector(graph.one, graph.zero), graph.zero, graph.zero)}
        self.guides: dict[str, GuideLine] = {}
        self.slides: dict[str, Slide] = {}
        self.sines: dict[str, Node] = {}
        self.masses: dict[str, LinkMass] = masses(scene, varied)
        # The input may stand before the frame's points in the order; its pivot or guide is on the frame.
        for name, point in scene.points.items():
            if point.link == FRAME:
                self._point(name)
        for name, guide in scene.guides.items():
            if guide.link == FRAME:
                self._guide(name)
        add = {
            "input": self._input,
            "shaft": self._shaft,
            "group": self._group,
            "point": self._point,
            "guide": self._guide,
        }
        for element in structure.elements:
            if element.name not in self.points and element.name not in self.guides:
                add[element.kind](element.name)

    def at_rest(self, r: Vector) -> Moving:
        """A point that doesn't move."""
        return Moving(r, self.nowhere, self.nowhere)

    def mass_centre(self, name: str) -> Moving:
        """Centre of one of the `masses`: a point known before where it lies in one for every variant."""
        return self._centre(name, self.masses[name])

    def body_centre(self, name: str) -> Moving:
        """Centre of mass of a body, whatever stands for it."""
        return self._centre(name, whole_body(self.scene, name, self.varied))

    def _centre(self, name: str, mass: LinkMass) -> Moving:
        if mass.point is not None:
            return self.points[mass.point]
        link = self.links[mass.link]
        if mass.at_origin:
            return link.origin
        along = self.graph.derived(f"bodies.{name}.along", mass.along)
        across = self.graph.derived(f"bodies.{name}.across", mass.across)
        return link.at(Vector(along, across).in_axes(link.u)).called(f"centre_of_{name}")

    def _number(self, path: str) -> Node:
        return self.graph.number(path)

    def _direction(self, path: str) -> Vector:
        """Direction at an angle of the scene."""
        return Vector(
            self.graph.derived(f"cos {path}", lambda n: np.cos(n[path])),
            self.graph.derived(f"sin {path}", lambda n: np.sin(n[path])),
        )

    # Elements of the ordering

    def _point(self, name: str) -> None:
        part = self.scene.points[name]
        place = Vector(self._number(f"points.{name}.x"), self._number(f"points.{name}.y"))
        if part.link == FRAME:
            self.points[name] = self.at_rest(place)
        else:
            link = self.links[part.link]
            self.points[name] = link.at(place.in_axes(link.u)).called(name)

    def _guide(self, name: str) -> None:
        carrier = self.links[self.scene.guides[name].link]
        r = Vector(self._number(f"guides.{name}.x"), self._number(f"guides.{name}.y"))
        u = self._direction(f"guides.{name}.angle")
        self.guides[name] = GuideLine(carrier, carrier.origin.r + r.in_axes(carrier.u), u.in_axes(carrier.u))

    def _input(self, name: str) -> None:
        drive, g = self.scene.input, self.graph
        if isinstance(drive, CrankInput):
            crank = Turning(self.points[drive.pivot], Vector(g.cos_q, g.sin_q), g.one, g.zero)
            self.links[name] = crank
            self.points[drive.pin] = crank.at(crank.u * self._number("input.length")).called(drive.pin)
            return
        guide = self.guides[drive.guide]
        point = Moving(guide.r + guide.u * g.q, guide.u, self.nowhere)
        self.points[drive.point] = point.called(drive.point)
        self.links[name] = Turning(point, guide.u, g.zero, g.zero)
        self.slides[name] = Slide(g.q, g.one, g.zero)

    def _shaft(self, name: str) -> None:
        shaft, driver = self.scene.shafts[name], self.links[self.scene.shafts[name].geared_to]
        ratio = self._number(f"shafts.{name}.ratio")
        w, e = ratio * driver.w, ratio * driver.e
        if shaft.pivot is None:
            nowhere = self.links[FRAME]
            self.links[name] = Turning(nowhere.origin, nowhere.u, w, e)
            return
        angle = ratio * self.graph.q + self._number(f"shafts.{name}.phase")
        self.links[name] = Turning(self.points[shaft.pivot], Vector(*self.graph.apply(direction_of, angle)), w, e)
        self.links[name].called(name)

    # Structural groups

    def _group(self, name: str) -> None:
        getattr(self, f"_{self.scene.groups[name].type.lower()}")(name)

    def _rrr(self, name: str) -> None:
        group, apply = self.scene.groups[name], self.graph.apply
        a, d = self.points[group.first.joint], self.points[group.second.joint]
        r1, r2 = self._number(f"groups.{name}.first.length"), self._number(f"groups.{name}.second.length")
        bx, by, c1, s1, c2, s2, sine = apply(rrr_position, *a.r, *d.r, r1, r2, self._number(f"groups.{name}.mode"))
        u1, u2 = Vector(c1, s1), Vector(c2, s2)
        ab, db = r1 * u1, r2 * u2
        known = (r1, *u1, r2, *u2, sine)
        w1, w2 = apply(rrr_rates, *(d.v - a.v), *known)
        e1, e2 = apply(rrr_rates, *(d.a - a.a + (w1 * w1) * ab - (w2 * w2) * db), *known)
        first, second = Turning(a, u1, w1, e1), Turning(d, u2, w2, e2)
        self.links[group.first.link] = first.called(group.first.link)
        self.links[group.second.link] = second.called(group.second.link)
        self.sines[name] = named(sine, f"{name}_sine")
        # From the side whose outer joint is at rest the joint's motion takes fewer operations.
        b = second.at(db) if d.v == self.nowhere else first.at(ab)
        self.points[group.inner] = Moving(Vector(bx, by), b.v, b.a).called(group.inner)

    def _under(self, guide: GuideLine, r: Vector) -> Moving:
        """Motion of the point of a guide's carrier that lies in a place at the moment."""
        return guide.carrier.at(r - guide.carrier.origin.r)._replace(r=r)

    def _coriolis(self, guide: GuideLine, sliding: Vector) -> Vector:
        """Coriolis acceleration 2 w k × v of what slides with a velocity relative to a guide."""
        return (guide.carrier.w + guide.carrier.w) * sliding.normal

    def _slider(self, link: str, origin: Moving, guide: GuideLine, slide: Slide) -> None:
        self.links[link] = Turning(origin, guide.u, guide.carrier.w, guide.carrier.e)
        self.slides[link] = slide.called(link)

    def _rrp(self, name: str) -> None:
        group, apply = self.scene.groups[name], self.graph.apply
        a, guide = self.points[group.first.joint], self.guides[group.second.guide]
        r, offset = self._number(f"groups.{name}.first.length"), self._number(f"groups.{name}.second.offset")
        mode = self._number(f"groups.{name}.mode")
        bx, by, c, s, d, sine = apply(rrp_position, *a.r, *guide.r, *guide.u, r, offset, mode)
        b, u = Vector(bx, by), Vector(c, s)
        ab, known = r * u, (r, *u, *guide.u, sine)
        under = self._under(guide, b)
        w, dv = apply(rrp_rates, *(under.v - a.v), *known)
        sliding = dv * guide.u
        carried = under.a + self._coriolis(guide, sliding)
        e, da = apply(rrp_rates, *(carried - a.a + (w * w) * ab), *known)
        joint = Moving(b, under.v + sliding, carried + da * guide.u).called(group.inner)
        self.points[group.inner] = joint
        self.links[group.first.link] = Turning(a, u, w, e).called(group.first.link)
        self._slider(group.second.link, joint, guide, Slide(d, dv, da))
        self.sines[name] = named(sine, f"{name}_sine")

    def _rpr(self, name: str) -> None:
        group, apply = self.scene.groups[name], self.graph.apply
        a, d = self.points[group.first.joint], self.points[group.second.joint]
        offset = self._number(f"groups.{name}.second.offset")
        c, s, slide, sine = apply(rpr_position, *a.r, *d.r, offset, self._number(f"groups.{name}.mode"))
        u, known = Vector(c, s), (c, s, offset, slide)
        w, dv = apply(rpr_rates, *(a.v - d.v), *known)
        coriolis = (w + w) * (dv * u).normal
        e, da = apply(rpr_rates, *(a.a - d.a + (w * w) * (a.r - d.r) - coriolis), *known)
        rocker = Turning(d, u, w, e).called(group.second.link)
        self.links[group.second.link] = rocker
        self.links[group.first.link] = rocker._replace(origin=a)
        self.slides[group.first.link] = Slide(slide, dv, da).called(group.first.link)
        self.sines[name] = named(sine, f"{name}_sine")

    def _prp(self, name: str) -> None:
        group = self.scene.groups[name]
        one, two = self.guides[group.first.guide], self.guides[group.second.guide]
        e1, e2 = (self._number(f"groups.{name}.{side}.offset") for side in ("first", "second"))

        def along_both(gap: Vector) -> tuple[Node, Node]:
            m1, m2 = self.graph.apply(oblique_components, *gap, *one.u, *two.u)
            return m1, -m2

        q1, q2 = one.r + e1 * one.u.normal, two.r + e2 * two.u.normal
        d1, d2 = along_both(q2 - q1)
        b = q1 + d1 * one.u
        under1, under2 = self._under(one, b), self._under(two, b)
        v1, v2 = along_both(under2.v - under1.v)
        carried1 = under1.a + self._coriolis(one, v1 * one.u)
        carried2 = under2.a + self._coriolis(two, v2 * two.u)
        a1, a2 = along_both(carried2 - carried1)
        joint = Moving(b, under1.v + v1 * one.u, carried1 + a1 * one.u).called(group.inner)
        self.points[group.inner] = joint
        self._slider(group.first.link, joint, one, Slide(d1, v1, a1))
        self._slider(group.second.link, joint, two, Slide(d2, v2, a2))
        self.sines[name] = named(one.u.cross(two.u), f"{name}_sine")

    def _rpp(self, name: str) -> None:
        group = self.scene.groups[name]
        a, guide = self.points[group.first.joint], self.guides[group.second.guide]
        beta = self._direction(f"groups.{name}.second.slot_angle")
        slot = beta.in_axes(guide.u)

        def along_both(gap: Vector) -> tuple[Node, Node]:
            return self.graph.apply(oblique_components, *gap, *guide.u, *slot)

        d, block = along_both(a.r - guide.r)
        crossing = guide.r + d * guide.u
        under_pin, under = self._under(guide, a.r), self._under(guide, crossing)
        dv, block_v = along_both(a.v - under_pin.v)
        coriolis = self._coriolis(guide, dv * guide.u)
        da, block_a = along_both(a.a - under_pin.a - self._coriolis(guide, a.v - under_pin.v))
        origin = Moving(crossing, under.v + dv * guide.u, under.a + coriolis + da * guide.u)
        self._slider(group.second.link, origin, guide, Slide(d, dv, da))
        self.links[group.first.link] = Turning(a, slot, guide.carrier.w, guide.carrier.e)
        self.slides[group.first.link] = Slide(block, block_v, block_a).called(group.first.link)
        # The slot's angle to the guide never changes: neither does the quality of transmission.
        self.sines[name] = named(beta.y, f"{name}_sine")
