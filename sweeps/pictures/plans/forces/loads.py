"""Everything that acts on each link of a mechanism at a position, inertia forces included: what balances.

A link is in equilibrium under its loads: the reactions of its pairs, weights, inertia forces (d'Alembert), the forces
and moments of the scene, what gears pass on, and at the input what drives it.

The reaction of a journal with friction touches its friction circle. A guide with friction presses where the moment on
its slider puts it, or with both edges where that lies outside the slider; friction acts along it.
"""

from typing import NamedTuple

from engine import (
    FRAME,
    Brake,
    CrankInput,
    DCMotor,
    InductionMotor,
    Pair,
    TorsionSpring,
    bearer_of,
    body_mass,
    carried_inertia,
    contact_pairs,
    drive_base,
    driving_field,
    friction_in_pairs,
    guide_edge_forces,
    holder_of,
    joint_of,
    pairs_of,
    slider_tilts,
)
from sweeps.pictures.plans.forces.contact_forces import ContactForce, contact_forces, share_lost_between_teeth
from sweeps.pictures.plans.lettering import numbered, subscript, symbol
from sweeps.pictures.plans.pose import Pose


class DrawnLoad(NamedTuple):
    """A force with its point, or a moment.

    Attributes
    ----------
    text : str
        Its symbol.
    force : complex
        x + iy [N]; 0 for a moment.
    at : complex
        Point of the force [m].
    moment : float
        [N·m], counter-clockwise.
    pair : str
        Name of the pair whose reaction or friction it is; "" for what is neither.
    middle : complex, optional
        Middle of the joint [m], of a reaction that touches a friction circle.
    """

    text: str
    force: complex
    at: complex
    moment: float = 0.0
    pair: str = ""
    middle: complex | None = None

    @property
    def is_friction(self) -> bool:
        """Whether it is the friction in a guide."""
        return bool(self.pair) and self.text[1] == "F"

    @property
    def rho(self) -> float:
        """Radius of the friction circle that it touches [m]; 0 for what touches none."""
        return 0.0 if self.middle is None else abs(self.at - self.middle)

    @property
    def is_moment(self) -> bool:
        """Whether it is a moment."""
        return self.force == 0

    def moment_about(self, place: complex) -> float:
        """Moment about a place [N·m]."""
        return self.moment + ((self.at - place).conjugate() * self.force).imag


def loads_on_links(pose: Pose) -> dict[str, list[DrawnLoad]]:
    """What acts on each moving link, by its name; nothing that is zero.

    Parameters
    ----------
    pose : Pose
    """
    return _Collector(pose).found()


def loaded_links(pose: Pose) -> list[str]:
    """Links beside the input and those of groups that forces act on: second inputs, followers, wheels and racks.

    Parameters
    ----------
    pose : Pose
    """
    known = {pose.scene.input.link, *(link for links in pose.cycle.groups.values() for link in links)}
    loads = loads_on_links(pose)
    return [link for link in loads if link not in known and any(not load.is_moment for load in loads[link])]


def group_loads(pose: Pose, name: str) -> list[DrawnLoad]:
    """What acts on the links of a group together: all but its inner pairs, what its first pair does last.

    Parameters
    ----------
    pose : Pose
    name : str
        A group.
    """
    links, loads = pose.cycle.groups[name], loads_on_links(pose)
    forces = [load for link in links for load in loads[link] if not load.is_moment]
    if name in pose.scene.groups:
        own, outer = {f"{name}.{side}" for side in ("first", "inner", "second")}, [f"{name}.second", f"{name}.first"]
    else:
        around = pose.cycle.structure.free_groups[name].pairs
        own, outer = {p.name for p in around}, [p.name for p in around if not {p.link, p.other} <= set(links)]
    rest = [load for load in forces if load.pair not in own]
    return rest + [load for pair in outer for load in forces if load.pair == pair]


class _Collector:
    """Gathers the loads of all links."""

    def __init__(self, pose: Pose) -> None:
        self.pose, self.k, self.forces = pose, pose.k, pose.cycle.forces
        self.loads: dict[str, list[DrawnLoad]] = {link: [] for link in pose.cycle.link_numbers}
        self.frictions = friction_in_pairs(pose.scene)
        self.contacts = {pair.name for pair in contact_pairs(pose.scene)}

    def found(self) -> dict[str, list[DrawnLoad]]:
        for name in self.pose.scene.bodies:
            self._body(name)
        self._actions()
        for pair in pairs_of(self.pose.scene):
            self._pair(pair)
        for contact in contact_forces(self.pose):
            self._touches(contact)
        self._second_inputs()
        self._gears()
        self._drive()
        return {link: loads for link, loads in self.loads.items() if link != FRAME}

    def _add(self, link: str, text: str, force: complex, at: complex) -> None:
        if force != 0:
            self.loads[link].append(DrawnLoad(text, force, at))

    def _twist(self, link: str, text: str, moment: float, pair: str = "") -> None:
        if moment != 0:
            self.loads[link].append(DrawnLoad(text, 0j, 0j, moment, pair))

    def _force(self, name: str) -> complex:
        return complex(self.pose.cycle.force(name)[self.k])

    def _body(self, name: str) -> None:
        pose, link = self.pose, self.pose.scene.bodies[name].link
        alone = sum(body.link == link for body in pose.scene.bodies.values()) == 1
        index = str(pose.number(link)) if alone else subscript(name)
        numbers = pose.cycle.numbers
        mass, field = float(body_mass(pose.scene, name, numbers)), 1j * float(numbers["gravity"])
        if pose.scene.base is not None:
            field += complex(float(numbers["base.acceleration_x"]), float(numbers["base.acceleration_y"]))
        centre = pose.centre(name).place
        self._add(link, symbol("G", index), -mass * field, centre)
        if not pose.scene.inertia_in_reactions:
            return
        self._add(link, symbol("U", index), self._force(f"{name}.inertia_force"), centre)
        self._twist(link, symbol("M", f"U{index}"), float(self.forces[f"{name}.inertia_moment"][self.k]))

    def _actions(self) -> None:
        scene, points = self.pose.scene, self.pose.motion.points
        for name, force in scene.forces.items():
            at = complex(points[force.on][self.k])
            self._add(holder_of(scene, force.on), symbol("F", subscript(name)), self._force(f"{name}.force"), at)
        for name, spring in scene.springs.items():
            pull = self._force(f"{name}.force")
            for end, sign in zip(spring.between, (-1, 1), strict=True):
                at = complex(points[end][self.k])
                self._add(holder_of(scene, end), symbol("F", subscript(name)), sign * pull, at)
        for name, cylinder in scene.cylinders.items():
            push, at = self._force(f"{name}.force"), self.pose.origin(cylinder.piston).place
            self._add(cylinder.piston, symbol("F", subscript(name)), push, at)
            self._add(bearer_of(scene, cylinder.piston), symbol("F", subscript(name)), -push, at)
        for name, moment in scene.moments.items():
            if not isinstance(moment, (Brake, DCMotor, InductionMotor)):
                value = float(self.forces[f"{name}.acting_moment"][self.k])
                self._twist(moment.on, symbol("M", subscript(name)), value)
                if isinstance(moment, TorsionSpring):
                    self._twist(FRAME, symbol("M", subscript(name)), -value)

    def _pair(self, pair: Pair) -> None:
        """The reaction of a pair on its link, and the opposite on the other, with its friction."""
        friction = float(self.forces[self.frictions[pair.name]][self.k]) if pair.name in self.frictions else 0.0
        force, at = self._force(f"{pair.name}.reaction"), self.pose.origin(pair.link).place
        if pair.kind == "prismatic":
            self._in_guide(pair, force, at)
            self._both(pair, "F", friction * self.pose.direction(pair.link), at, before=r"\mathrm{f}")
            return
        if pair.name.endswith(".inner") and pair.link not in self.pose.scene.links:
            group = self.pose.scene.groups[pair.name.removesuffix(".inner")]
            at = complex(self.pose.motion.points[group.inner][self.k])
        elif pair.link in self.pose.scene.links:
            at = complex(self.pose.motion.points[joint_of(pair)][self.k])
        if friction and force:
            self._both(pair, "R", force, at - 1j * force * friction / abs(force) ** 2, at)
        else:
            self._both(pair, "R", force, at)

    def _both(
        self, pair: Pair, letter: str, force: complex, at: complex, middle: complex | None = None, **index: str
    ) -> None:
        """A force of a pair on its link and the opposite on the other."""
        one, two = self.pose.number(pair.other), self.pose.number(pair.link)
        if force != 0:
            text, opposite = numbered(letter, one, two, **index), numbered(letter, two, one, **index)
            self.loads[pair.link].append(DrawnLoad(text, force, at, 0.0, pair.name, middle))
            self.loads[pair.other].append(DrawnLoad(opposite, -force, at, 0.0, pair.name, middle))

    def _in_guide(self, pair: Pair, force: complex, at: complex) -> None:
        """What presses in a guide: a force with a moment, or where the slider's length is known, where that bears."""
        moment = float(self.forces[f"{pair.name}.reaction_moment"][self.k])
        length = self._length(pair)
        if length is None:
            self._both(pair, "R", force, at)
            one, two = self.pose.number(pair.other), self.pose.number(pair.link)
            self._twist(pair.link, numbered("M", one, two), moment, pair.name)
            self._twist(pair.other, numbered("M", two, one), -moment, pair.name)
            return
        u = self.pose.direction(pair.link)
        normal = (force / (1j * u)).real
        if not slider_tilts(normal, moment, length / 2):
            self._both(pair, "R", force, at + (moment / normal * u if normal else 0))
            return
        edges = guide_edge_forces(normal, moment, length / 2)
        for prime, edge, side in zip(("\\prime", "\\prime\\prime"), edges, (1, -1), strict=True):
            self._both(pair, "R", edge * 1j * u, at + side * length / 2 * u, power=prime)

    def _length(self, pair: Pair) -> float | None:
        """Length of the slider in a guide with friction [m]; None where it isn't given."""
        name = next((n for n, friction in self.pose.scene.friction.items() if friction.pair == pair.name), None)
        return None if name is None else self.pose.cycle.numbers.get(f"friction.{name}.length")

    def _touches(self, contact: ContactForce) -> None:
        """A force in a higher pair on its link, and the opposite on the other."""
        name = contact.pair if contact.pair in self.contacts else f"{contact.pair}.teeth"
        pair = Pair(name, "contact", contact.link, contact.other, "")
        if contact.rubs:
            self._both(pair, "F", contact.force, contact.at, before=r"\mathrm{f}")
        else:
            self._both(pair, "R", contact.force, contact.at)

    def _second_inputs(self) -> None:
        """What drives second inputs, from the links that their drives stand on, by the crank where that drives."""
        pose = self.pose
        for name, second in pose.scene.inputs.items():
            value = float(self.forces[driving_field(pose.scene, name)][self.k])
            index, base = rf"\mathrm{{in}}{pose.number(name)}", drive_base(pose.scene, name)
            if second.translating:
                rate, at, u = pose.slide(name)[0], pose.origin(name).place, pose.direction(name)
                self._add(name, symbol("F", index), value * u, at)
                self._add(base, symbol("F", index), -value * u, at)
            else:
                rate = pose.turn(name).omega - pose.turn(base).omega
                self._twist(name, symbol("M", index), value)
                self._twist(base, symbol("M", index), -value)
            if second.drive == "crank":
                one, crank = pose.number(name), pose.scene.input.link
                self._twist(crank, numbered("M", one, pose.number(crank)), -value * rate / pose.cycle.omega)

    def _gears(self) -> None:
        """Moments of gears: they balance each wheel, load what drives it by the ratio, what carries both by the rest.

        Teeth with a place have done so by their forces.
        """
        pose, numbers = self.pose, self.pose.cycle.numbers
        for element in reversed(pose.cycle.structure.elements):
            name = element.name
            if element.kind == "shaft":
                shaft = pose.scene.shafts[name]
                if pose.scene.inertia_in_reactions:
                    inertia = numbers[f"shafts.{name}.inertia"] + carried_inertia(pose.scene, name, numbers)
                    self._twist(name, symbol("M", f"U{pose.number(name)}"), -inertia * pose.turn(name).epsilon)
                if shaft.pressure_angle is None:
                    left = self._left(name)
                    passed = numbers[f"shafts.{name}.ratio"] * left * share_lost_between_teeth(pose, name, -left)
                    self._geared(name, shaft.geared_to, shaft.carrier or FRAME, left, passed)
            elif element.kind == "noncircular wheel":
                wheel = pose.scene.noncircular_wheels[name]
                if wheel.pressure_angle is None:
                    left, ratio = self._left(name), pose.turn(name).omega / pose.turn(wheel.geared_to).omega
                    passed = ratio * left * share_lost_between_teeth(pose, name, -left)
                    self._geared(name, wheel.geared_to, FRAME, left, passed)

    def _left(self, link: str) -> float:
        """Moment of all loads of a link about its origin."""
        origin = self.pose.origin(link).place
        return sum(load.moment_about(origin) for load in self.loads[link])

    def _geared(self, name: str, driver: str, carrier: str, left: float, passed: float) -> None:
        """Balance a wheel, and load its driver and its carrier."""
        one, two, carrying = (self.pose.number(link) for link in (driver, name, carrier))
        self._twist(name, numbered("M", one, two), -left)
        self._twist(driver, numbered("M", two, one), passed)
        self._twist(carrier, numbered("M", two, carrying), left - passed)

    def _drive(self) -> None:
        drive = self.pose.scene.input
        value = float(self.forces["input_moment_by_equilibrium"][self.k])
        if isinstance(drive, CrankInput):
            self._twist(drive.link, symbol("M", r"\mathrm{in}"), value)
        else:
            at = self.pose.origin(drive.link).place
            self._add(drive.link, symbol("F", r"\mathrm{in}"), value * self.pose.guide(drive.guide), at)
