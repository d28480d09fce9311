"""Velocity and acceleration plans as numbers: images of points from a pole, and the vectors between them.

Each dyad fixes a point's image by two vector chains: RRR along both bars; RRP along rod and guide; RPR along the
slotted link and its slot; PRP along both guides; RPP along guide and slot. Acceleration chains have two steps: normal
and tangential on a bar, Coriolis and relative along a rotating guide. Points at rest have their image in the pole.
Second inputs give vectors like the first. Wheels and racks share one velocity at their pitch point, where
accelerations differ along the common normal; a follower slides on its cam along the tangent. A group of class III
starts from a special point of Assur; for other groups of free links all bars and slides are drawn.

Source: I. I. Artobolevsky, Theory of Mechanisms and Machines, chapter on velocity and acceleration plans.
"""

from collections.abc import Callable, Iterable
from typing import NamedTuple

from engine import FRAME, RPP, RPR, CrankInput, FreeGroup, Hinged, guide_of
from sweeps.pictures.plans.contacts import Rolling, Touching, lettered, rolling, touching
from sweeps.pictures.plans.lettering import subscript, symbol
from sweeps.pictures.plans.pose import Movement, Pose, Turn
from sweeps.pictures.plans.special_points import SpecialPoint, special_point


class PlanStep(NamedTuple):
    """A vector of a plan: symbol, value (x + iy) and kind.

    `kind` is "whole", "normal", "tangential", "coriolis" or "relative".
    """

    text: str
    vector: complex
    kind: str


class Leg(NamedTuple):
    """A chain of vectors between the images of two points."""

    start: str
    end: str
    steps: tuple[PlanStep, ...]


class PlanKind(NamedTuple):
    """Velocity or acceleration plan: symbols and units of its vectors and of turns, and its rules.

    Attributes
    ----------
    letter, unit : str
    turned, turn_letter, turn_unit : str
        The turns listed: field of `Turn`, symbol and unit.
    image : callable
        A point's vector from its motion.
    turning, slid, rolled : callable
        Symbol, vector and kind of each step on a bar, along a guide or a path of a curvature (normal, as a vector), and
        between rolling curves.
    """

    letter: str
    unit: str
    turned: str
    turn_letter: str
    turn_unit: str
    image: Callable[[Movement], complex]
    turning: Callable[[Turn, complex], list[tuple[str, complex, str]]]
    slid: Callable[[Turn, complex, complex, complex | None], list[tuple[str, complex, str]]]
    rolled: Callable[[float, complex], list[tuple[str, complex, str]]]


_VELOCITY = PlanKind(
    *("v", "m s-1", "omega", r"\omega", "rad/s"),
    lambda moving: moving.v,
    lambda turn, arm: [("", 1j * turn.omega * arm, "whole")],
    lambda _, v, a, bend=None: [("", v, "relative")],
    lambda omega, drift: [],
)
_ACCELERATION = PlanKind(
    *("a", "m s-2", "epsilon", r"\varepsilon", "rad/s²"),
    lambda moving: moving.a,
    lambda turn, arm: [("n", -(turn.omega**2) * arm, "normal"), ("t", 1j * turn.epsilon * arm, "tangential")],
    lambda turn, v, a, bend=None: [
        ("c", 2j * turn.omega * v, "coriolis"),
        *([] if bend is None else [("rn", abs(v) ** 2 * bend, "normal")]),
        ("r" if bend is None else "rt", a, "relative"),
    ],
    lambda omega, drift: [("n", omega**2 * drift, "normal")],
)


class VectorPlan:
    """A velocity or acceleration plan, built group by group.

    Parameters
    ----------
    pose : Pose
    kind : PlanKind

    Attributes
    ----------
    kind : PlanKind
    images : dict of str to complex
        Vector from the pole to the image of each point [m/s or m/s²].
    legs : list of Leg
    pole : iterable of str
        Points at rest.
    links : tuple of tuple of str
        Images of each link's points, similar to the link's shape.
    under : dict of str to str
        Coincident points on another link, by name (with primes), and their link.
    special : list of SpecialPoint
        Special points of Assur used by the plan.
    places : dict of str to complex
        Unnamed points of the scene [m]: pitch points, points of cams and sliding inputs.
    """

    def __init__(self, pose: Pose, kind: PlanKind) -> None:
        self.pose, self.kind = pose, kind
        self.images: dict[str, complex] = {}
        self.legs: list[Leg] = []
        self.pole: dict[str, None] = {}
        self.under: dict[str, str] = {}
        self.special: list[SpecialPoint] = []
        self.places: dict[str, complex] = {}
        self._compose()
        self.links = tuple(filter(None, map(self._others_on, pose.motion.structure.links)))

    def _compose(self) -> None:
        scene, drive = self.pose.scene, self.pose.scene.input
        if isinstance(drive, CrankInput) and drive.pin is None:
            self._carried_by(drive.link)
        elif isinstance(drive, CrankInput):
            self._bar(drive.link, drive.pivot, drive.pin)
        else:
            self._along_guide(drive.link, drive.guide, drive.point)
        for element in self.pose.motion.structure.elements:
            if element.kind == "group":
                self._group(scene.groups[element.name])
            elif element.kind == "free group":
                self._free_group(self.pose.motion.structure.free_groups[element.name])
            elif element.kind == "cam":
                contact = touching(self.pose, element.name)
                self._touching(contact)
                self._carried_by(contact.follower)
            elif element.kind in ("second input", "shaft", "noncircular wheel", "rack", "pinion"):
                self._driven(element.name, element.kind == "second input")

    # Images

    def _image(self, name: str, moving: Movement, at_rest: bool = False) -> str:
        if at_rest:
            self.pole[name] = None
        else:
            self.images[name] = self.kind.image(moving)
        return name

    def _point(self, name: str) -> str:
        points = self.pose.scene.points
        at_rest = name in points and points[name].link == FRAME
        return self._image(name, self.pose.point(name), at_rest)

    def _under(self, link: str, point: str, primes: str) -> str:
        """Image of a link's point coincident with a point of another link, named with primes."""
        if link == FRAME:
            return FRAME
        self.under[point + primes] = link
        return self._image(point + primes, self.pose.rigid(link, self._place(point)))

    def _others_on(self, link: str) -> tuple[str, ...]:
        """Images of a link's points and centres of mass; none if a leg shows them all."""
        pose = self.pose
        names = [self._point(n) for n in pose.motion.members(link)]
        places = [pose.motion.points[n][pose.k] for n in names]
        bodies = [name for name, body in pose.scene.bodies.items() if body.link == link]
        for i, name in enumerate(bodies):
            centre = pose.centre(name)
            if all(abs(centre.place - p) > 0.5 * pose.motion.radius for p in places):
                label = f"S{pose.number(link)}" + (f"_{i + 1}" if len(bodies) > 1 else "")
                names.append(self._image(label, centre))
        return tuple(names) if len(names) > 2 else ()

    # Legs

    def _leg(self, start: str, end: str, steps: Iterable[tuple[str, complex, str]], start_at_rest: bool) -> None:
        sub = subscript(end) if start_at_rest else subscript(end, start)
        made = [PlanStep(symbol(self.kind.letter, sub, sup), vector, kind) for sup, vector, kind in steps]
        if not start_at_rest:
            made = [step._replace(kind="relative") if step.kind == "whole" else step for step in made]
        self.legs.append(Leg(start, end, tuple(made)))

    def _bar(self, link: str, start: str, end: str) -> None:
        """From one point of a link to another."""
        self._point(start)
        if end not in self.images:
            self._point(end)
        arm = self._place(end) - self._place(start)
        self._leg(start, end, self.kind.turning(self.pose.turn(link), arm), start in self.pole)

    def _place(self, name: str) -> complex:
        point = name.rstrip("'")
        return self.places[point] if point in self.places else self.pose.place(point)

    def _along_guide(self, slider: str, guide: str, point: str, primes: str = "'") -> None:
        """From the point under a slider's joint to the joint."""
        carrier, u = self.pose.scene.guides[guide].link, self.pose.guide(guide)
        self._slid(self._under(carrier, point, primes), self._point(point), slider, carrier, u)

    def _slid(self, start: str, end: str, slider: str, carrier: str, u: complex) -> None:
        v, a = (rate * u for rate in self.pose.slide(slider))
        steps = self.kind.slid(self.pose.turn(carrier), v, a)
        if carrier == FRAME:
            # The relative motion is the whole motion.
            steps = [("", steps[-1][1], "whole")]
        self._leg(start, end, steps, start == FRAME)

    def _group(self, group: object) -> None:
        if isinstance(group, RPR):
            pin, rocker = group.first.joint, group.second
            under = self._under(rocker.link, pin, "'")
            self._bar(rocker.link, rocker.joint, under)
            self._slid(under, self._point(pin), group.first.link, rocker.link, self.pose.direction(rocker.link))
        elif isinstance(group, RPP):
            pin, yoke = group.first.joint, group.second
            carrier, u = self.pose.scene.guides[yoke.guide].link, self.pose.guide(yoke.guide)
            under = self._under(yoke.link, pin, "'")
            self._slid(self._under(carrier, pin, "''"), under, yoke.link, carrier, u)
            # The yoke turns with the link that carries its guide.
            slot = self.pose.direction(group.first.link)
            v, a = (rate * slot for rate in self.pose.slide(group.first.link))
            self._leg(under, pin, self.kind.slid(self.pose.turn(carrier), v, a), False)
        else:
            primes = "'"
            for part in (group.first, group.second):
                if isinstance(part, Hinged):
                    self._bar(part.link, part.joint, group.inner)
                else:
                    self._along_guide(part.link, part.guide, group.inner, primes)
                    primes = "''"

    # Second inputs, wheels, racks and cams

    def _driven(self, name: str, by_law: bool) -> None:
        """Pitch point and first point of a link driven by a law or a mesh."""
        contact = None if by_law else rolling(self.pose, name)
        if contact is not None:
            self._rolling(contact)
        if not self._carried_by(name) and by_law and guide_of(self.pose.scene, name) is not None:
            self._origin_of(name)

    def _origin_of(self, slider: str) -> None:
        """Leg to the origin of a slider without points."""
        name = lettered(self.pose, "A", slider)
        self.places[name] = self.pose.origin(slider).place
        self._to(slider, name)

    def _carried_by(self, link: str) -> bool:
        """Leg to the first of a link's own points; returns whether it has one."""
        own = [n for n, point in self.pose.scene.points.items() if point.link == link]
        for name in own[:1]:
            self._to(link, name)
        return bool(own)

    def _to(self, link: str, name: str) -> str:
        """Leg to a point of a link: along its guide, or from its pivot."""
        place, pose = self._place(name), self.pose
        if link == FRAME:
            return self._image(name, pose.rigid(link, place), at_rest=True)
        guide = guide_of(pose.scene, link)
        if guide is not None:
            carrier = pose.scene.guides[guide].link
            self._image(name, pose.rigid(link, place))
            start = self._under(carrier, name.rstrip("'"), name[len(name.rstrip("'")) :] + "''")
            self._slid(start, name, link, carrier, pose.guide(guide))
            return name
        start = self._point(pose.motion.members(link)[0])
        self._image(name, pose.rigid(link, place))
        # One vector from the pole to the pitch point of wheels in mesh.
        if not any(leg.end == name and leg.start in self.pole for leg in self.legs) or start not in self.pole:
            arm = place - self._place(start)
            self._leg(start, name, self.kind.turning(pose.turn(link), arm), start in self.pole)
        return name

    def _rolling(self, contact: Rolling) -> None:
        """Legs to the pitch point on both bodies, and between them if they differ."""
        name, turn = contact.name, self.pose.turn
        self.places[name] = contact.place
        apart = self.kind.rolled(turn(contact.link).omega - turn(contact.driver).omega, contact.drift)
        start = self._to(contact.driver, name + "'" * bool(apart))
        self._to(contact.link, name)
        if apart:
            self.under[start] = contact.driver
            self._leg(start, name, apart, start in self.pole)

    def _touching(self, contact: Touching) -> None:
        """Legs to a point on the cam and on its follower, and between them along the tangent."""
        pose, name = self.pose, contact.name
        self.places[name] = contact.place
        flat = contact.curvature is None
        on_cam, on_follower = (name, f"{name}'") if flat else (f"{name}'", name)
        self._to(contact.cam, on_cam)
        self._to(contact.follower, on_follower)
        cam, follower = (pose.rigid(link, contact.place) for link in (contact.cam, contact.follower))
        start, end, under = (follower, cam, contact.follower) if flat else (cam, follower, contact.cam)
        self.under[f"{name}'"] = under
        # The tangential part closes the plan; the normal parts agree.
        tangent, turn = 1j * contact.normal, pose.turn(under)
        v = ((end.v - start.v) / tangent).real * tangent
        a = ((end.a - start.a - 2j * turn.omega * v) / tangent).real * tangent
        bend = None if flat else -contact.curvature * contact.normal
        self._leg(f"{name}'", name, self.kind.slid(turn, v, a, bend), False)

    # Groups of free links

    def _free_group(self, group: FreeGroup) -> None:
        special, drawn = special_point(self.pose, group), set()
        if special is not None:
            self._from_special_point(special)
            drawn = {special.link, *(bar.link for bar in special.bars)}
        for link in group.links:
            turning = [pair for pair in group.pairs_of(link) if pair.kind == "revolute"]
            # From points known before the group.
            turning.sort(key=lambda pair: {pair.link, pair.other} <= set(group.links))
            for pair in turning[1:] if link not in drawn else ():
                self._bar(link, turning[0].joint, pair.joint)
        for pair in group.pairs:
            if pair.kind != "prismatic":
                continue
            if points := self.pose.motion.members(pair.link):
                self._along_guide(pair.link, self.pose.scene.links[pair.link].guide, points[0])
            else:
                self._origin_of(pair.link)

    def _from_special_point(self, special: SpecialPoint) -> None:
        """Two legs to the special point, the leg to the third joint, and the bars used."""
        pose, name = self.pose, special.name
        self.special.append(special)
        self._image(name, pose.rigid(special.link, special.place))
        turn = pose.turn(special.link)
        for bar in special.bars:
            self._point(bar.outer)
            a, b = self._place(bar.outer), self._place(bar.inner)
            along = self.kind.turning(pose.turn(bar.link), b - a)
            beyond = self.kind.turning(turn, special.place - b)
            # Normal parts in sequence; parts across the bar combined.
            sub, (sup, vector, kind) = subscript(name, bar.outer), along[-1]
            made = [PlanStep(symbol(self.kind.letter, sub, sup), vector + beyond[-1][1], kind)]
            if len(along) > 1:
                text = symbol(self.kind.letter, subscript(name, bar.inner), beyond[0][0])
                # The bar's own leg names the first step.
                made = [PlanStep("", *along[0][1:]), PlanStep(text, *beyond[0][1:]), *made]
            if bar.outer not in self.pole:
                made = [step._replace(kind="relative") if step.kind == "whole" else step for step in made]
            self.legs.append(Leg(bar.outer, name, tuple(made)))
            self._bar(bar.link, bar.outer, bar.inner)
        if special.joint is not None:
            self._point(special.joint)
            self._leg(name, special.joint, self.kind.turning(turn, self._place(special.joint) - special.place), False)


def velocities(pose: Pose) -> VectorPlan:
    """Velocity plan of all points of a mechanism [m/s]."""
    return VectorPlan(pose, _VELOCITY)


def accelerations(pose: Pose) -> VectorPlan:
    """Acceleration plan of all points of a mechanism at constant input speed [m/s²]."""
    return VectorPlan(pose, _ACCELERATION)
