"""The kinematics of an ordered mechanism as nodes, one structural group after the other.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapters on the kinematics of structural groups.
"""

from engine import laws, mechanism
from engine.graph.nodes import Graph, Node, Return
from engine.laws.elementary import direction_of
from engine.mechanism.assembly import Assembly, Course, DyadStatics, MovingPoint, Slide, Turning
from engine.mechanism.vectors import Vector, named
from engine.parts.skeleton import FRAME, CrankInput
from engine.scene import structure
from engine.scene.attachments import turning_evenly
from engine.scene.masses import LinkMass, resultant_masses, whole_body
from engine.scene.scene import Scene
from engine.scene.structure.ordering import Structure


class Kinematics(Assembly):
    """The motion of every point, link and slider of a scene.

    Parameters
    ----------
    scene : Scene
    structure : Structure
    graph : Graph
    varied : frozenset of str
        Paths of the varied numbers.
    course : Course, optional

    Attributes
    ----------
    masses : dict of str to LinkMass
        Bodies, and the point masses that replace bodies, combined per link.
    statics : dict of str to DyadStatics
        Dyads.
    free : dict of str to FreeMotion
        Groups of free links.
    cams : dict of str to CamMotion
    noncircular : dict of str to NoncircularMotion
        Non-circular wheels.
    """

    def __init__(
        self,
        scene: Scene,
        structure: Structure,
        graph: Graph,
        varied: frozenset[str],
        course: Course | None = None,
    ) -> None:
        super().__init__(scene, graph, course)
        self.varied = varied
        self.masses: dict[str, LinkMass] = resultant_masses(scene, varied)
        self.statics: dict[str, DyadStatics] = {}
        self.free: dict[str, mechanism.groups.free.FreeMotion] = {}
        self.cams: dict[str, mechanism.higher_pairs.cam_motion.CamMotion] = {}
        self.noncircular: dict[str, mechanism.higher_pairs.noncircular_motion.NoncircularMotion] = {}
        # The input may precede the frame's points in the order, but needs its pivot or guide on the frame.
        for name, point in scene.points.items():
            if point.link == FRAME:
                self._point(name)
        for name, guide in scene.guides.items():
            if guide.link == FRAME:
                self._guide(name)
        add = {
            "input": self._input,
            "second input": lambda name: mechanism.higher_pairs.second_input_motion.add_second_input(self, name),
            "shaft": self._shaft,
            "noncircular wheel": self._noncircular_wheel,
            "rack": lambda name: mechanism.higher_pairs.rack_motion.add_rack(self, name),
            "pinion": lambda name: mechanism.higher_pairs.rack_motion.add_pinion(self, name),
            "cam": self._cam,
            "group": self._dyad,
            "free group": lambda name: self._free_group(structure.free_groups[name]),
            "point": self._point,
            "guide": self._guide,
        }
        known = {"point": self.points, "guide": self.guides}
        for element in structure.elements:
            # An element of another kind may share its name with a guide or a point.
            if element.name not in known.get(element.kind, ()):
                add[element.kind](element.name)

    def mass_centre(self, name: str) -> MovingPoint:
        """Mass centre of one of the `masses`; an existing point where it coincides with one in every variant."""
        return self._centre(name, self.masses[name])

    def body_centre(self, name: str) -> MovingPoint:
        """Mass centre of a body, also where point masses replace the body."""
        return self._centre(name, whole_body(self.scene, name, self.varied))

    def _centre(self, name: str, mass: LinkMass) -> MovingPoint:
        if mass.point is not None:
            return self.points[mass.point]
        link = self.links[mass.link]
        if mass.at_origin:
            return link.origin
        along = self.graph.derived(f"bodies.{name}.along", mass.along)
        across = self.graph.derived(f"bodies.{name}.across", mass.across)
        return link.at(Vector(along, across).to_frame(link.u)).called(f"centre_of_{name}")

    # Elements of the ordering

    def _point(self, name: str) -> None:
        part, place = self.scene.points[name], self.place("points", name)
        if part.link == FRAME:
            self.points[name] = self.at_rest(place)
            return
        link, varied = self.links[part.link], {f"points.{name}.x", f"points.{name}.y"} & self.varied
        on_axis = part.x == part.y == 0.0 and not varied
        self.points[name] = link.origin if on_axis else link.at(place.to_frame(link.u)).called(name)

    def _guide(self, name: str) -> None:
        self.guides[name] = self.guide_on(name, self.links[self.scene.guides[name].link])

    def _input(self, name: str) -> None:
        drive, g, (first, second, *_) = self.scene.input, self.graph, self.course
        if isinstance(drive, CrankInput):
            crank = Turning(self.points[drive.pivot], Vector(g.cos_q, g.sin_q), first, second)
            self.links[name] = crank
            self.angles[name] = g.q
            if drive.pin is not None:
                self.points[drive.pin] = crank.at(crank.u * self.number("input.length")).called(drive.pin)
            return
        guide = self.guides[drive.guide]
        point = MovingPoint(guide.r + guide.u * g.q, guide.u * first, guide.u * second)
        self.points[drive.point] = point.called(drive.point)
        self.links[name] = Turning(point, guide.u, g.zero, g.zero)
        self.slides[name] = Slide(g.q, first, second)

    def _dyad(self, name: str) -> None:
        kind = getattr(mechanism.groups, self.scene.groups[name].type.lower())
        self.statics[name] = kind.add_dyad(self, name)

    def _free_group(self, group: "structure.free_groups.FreeGroup") -> None:
        self.free[group.name] = mechanism.groups.free.add_free_group(self, group)

    def _noncircular_wheel(self, name: str) -> None:
        self.noncircular[name] = mechanism.higher_pairs.noncircular_motion.add_noncircular_wheel(self, name)

    def _cam(self, name: str) -> None:
        self.cams[name] = mechanism.higher_pairs.cam_motion.add_cam(self, name)

    def _shaft(self, name: str) -> None:
        shaft, driver = self.scene.shafts[name], self.links[self.scene.shafts[name].geared_to]
        ratio = self.number(f"shafts.{name}.ratio")
        w, e = ratio * driver.w, ratio * driver.e
        if shaft.carrier is not None:
            carrier, willis = self.links[shaft.carrier], laws.kinematics.geared_links.willis
            w, e = willis(ratio, driver.w, carrier.w), willis(ratio, driver.e, carrier.e)
        if shaft.pivot is None:
            nowhere = self.links[FRAME]
            self.links[name] = Turning(nowhere.origin, nowhere.u, w, e)
            return
        self.links[name] = Turning(self.points[shaft.pivot], self._shaft_direction(name, w), w, e)
        self.links[name].called(name)

    def _shaft_direction(self, name: str, w: Node) -> Vector:
        """Direction of a shaft's x axis: from its total angle, or from the direction of its driver."""
        shaft, phase = self.scene.shafts[name], self.number(f"shafts.{name}.phase")
        carrier = self.links[shaft.carrier or FRAME]
        if name in turning_evenly(self.scene):
            self.angles[name] = w * self.graph.q + phase
        elif structure.meshes.has_known_angle(self.scene, name):
            angle_of = mechanism.higher_pairs.rack_motion.angle_of_link
            driver, carried = (angle_of(self, link) for link in (shaft.geared_to, shaft.carrier or FRAME))
            ratio = self.number(f"shafts.{name}.ratio")
            self.angles[name] = laws.kinematics.geared_links.willis(ratio, driver, carried) + phase
        else:
            driver = self.links[shaft.geared_to].u
            swing = (carrier.u.dot(driver), carrier.u.cross(driver))
            numbers = (self.number(f"shafts.{name}.{key}") for key in ("ratio", "around"))
            turned, clear = self.graph.apply(laws.kinematics.geared_links.geared_turn, *swing, *numbers)
            # Beyond half a turn of the driver the shaft's angle is ambiguous.
            self.sines[name] = named(clear, f"{name}_clear")
            self.solutions[name] = (clear, turned)
            return Vector(*self.graph.apply(direction_of, turned + phase)).to_frame(carrier.u)
        direction = Vector(*self.graph.apply(direction_of, self.angles[name]))
        self.graph.returns(direction, Return(f"shafts.{name}.ratio", self.turns(name)))
        return direction
