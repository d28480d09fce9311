"""Loads, reduced inertia and moment, and reactions in all pairs, in Taylor series on the motion of `closed_motion`.

Loads that switch (a force over a stroke, one direction of motion only, valves of a compressor) are smooth between the
angles at which their switches change sign; the nodes of panels are within.
"""

from typing import NamedTuple

import numpy as np
from closed_motion import Motion, Place
from scipy.interpolate import CubicSpline, PchipInterpolator
from taylor import LONG, PI, Series

from engine.scene.attachments import bearer_of
from engine.scene.pairs import holder_of

Ends = dict[str, tuple[object, object]]


class Wrench(NamedTuple):
    """A force and its moment about the frame's origin."""

    force: Place
    moment: Series

    def __add__(self, other: "Wrench") -> "Wrench":
        return Wrench(self.force + other.force, self.moment + other.moment)

    def about(self, place: Place) -> Series:
        """Moment about a point."""
        return self.moment - place.across(self.force)


def chosen(condition: np.ndarray, one: Series, other: object) -> Series:
    """One series where a condition holds, else another or a number."""
    if not isinstance(other, Series):
        other = one * LONG(0) + other
    pairs = zip(one.terms, other.terms, strict=False)
    return Series([np.where(condition, a, b) for a, b in pairs])


def angle_pieces(action: object) -> tuple[np.ndarray, np.ndarray]:
    """Breaks and cubics of a periodic table over the crank angle."""
    x, y = np.append(action.over_angle, 2 * np.pi + action.over_angle[0]), np.append(action.moment, action.moment[0])
    if action.interpolation == "linear":
        zero = np.zeros(y.size - 1)
        return x, np.stack([zero, zero, np.diff(y) / np.diff(x), y[:-1]])
    if action.interpolation == "pchip":
        # The cycle repeated three times, for the slopes at its ends.
        turns = np.concatenate([x[:-1] + 2 * np.pi * k for k in (-1, 0, 1)])
        curve, first = PchipInterpolator(turns, np.tile(y[:-1], 3)), x.size - 1
        return x, curve.c[:, first : first + x.size - 1]
    return x, CubicSpline(x, y, bc_type="periodic").c


class Loads:
    """Loads on the links of a machine at constant crank speed."""

    def __init__(self, motion: Motion, ends: Ends) -> None:
        self.motion, self.scene, self.numbers, self.ends = motion, motion.scene, motion.numbers, ends
        scene, numbers = self.scene, self.numbers
        self.speed = numbers["input.speed"]
        # The reduced moment of each load, and its forces on the links.
        self.moments: list[Series] = []
        self.wrenches: dict[str, list[Wrench]] = {name: [] for name in self.motion.links}
        self.switches: list[Series] = []
        for name, body in scene.bodies.items():
            centre = self.motion.links[body.link].point(numbers[f"bodies.{name}.x"], numbers[f"bodies.{name}.y"])
            weight = -numbers[f"bodies.{name}.mass"] * numbers["gravity"]
            self._push(body.link, centre, Place(self.motion.zero, self.motion.zero + weight))
        for name, force in scene.forces.items():
            self._force(name, force)
        for name, moment in scene.moments.items():
            self._twist(moment.on, self._value(f"moments.{name}", moment, self.motion.links[moment.on].rate))
        for name in scene.springs:
            self._spring(name)
        for name in scene.cylinders:
            self._cylinder(name)

    def _push(self, link: str, place: Place, force: Place) -> None:
        self.wrenches[link].append(Wrench(force, place.across(force)))
        self.moments.append(force.along(place.by_angle()))

    def _twist(self, link: str, moment: Series) -> None:
        zero = self.motion.zero
        self.wrenches[link].append(Wrench(Place(zero, zero), moment))
        self.moments.append(moment * self.motion.links[link].rate)

    def _force(self, name: str, force: object) -> None:
        at = f"forces.{name}"
        place, link = self.motion.points[force.on], holder_of(self.scene, force.on)
        if force.angle is None:
            # Linear drag acts against the velocity.
            factor = -self.numbers[f"{at}.coefficient"] * self.speed
            self._push(link, place, place.by_angle().times(factor))
            return
        angle = self.numbers[f"{at}.angle"]
        c, s = np.cos(angle), np.sin(angle)
        way = Place(self.motion.zero + c, self.motion.zero + s)
        self._push(link, place, way.times(self._value(at, force, place.by_angle().along(way))))

    def _value(self, at: str, action: object, rate: Series) -> Series:
        """Value of a characteristic; `rate` is the velocity along it by the crank angle."""
        n, zero, velocity = self.numbers, self.motion.zero, rate[0] * self.speed
        match action.type:
            case "constant":
                value = zero + n[f"{at}.{'force' if hasattr(action, 'force') else 'moment'}"]
            case "against_motion":
                size = n[f"{at}.{'force' if hasattr(action, 'force') else 'moment'}"]
                value = chosen(velocity > 0, zero - size, size)
                self.switches.append(rate)
            case "linear_drag":
                value = rate * (-n[f"{at}.coefficient"] * self.speed)
            case "quadratic_drag":
                square = rate * rate * (n[f"{at}.coefficient"] * self.speed * self.speed)
                value = chosen(velocity > 0, -square, square)
                self.switches.append(rate)
            case "table":
                over = self._over_angle if action.over_angle is not None else self._over_stroke
                value = over(action) * n[f"{at}.scale"]
        if getattr(action, "acts", "always") != "always":
            direction = 1 if action.acts == "along" else -1
            value = chosen(direction * velocity > 0, value, 0)
            self.switches.append(rate)
        return value

    def _over_angle(self, action: object) -> Series:
        breaks, cubics = angle_pieces(action)
        turn = 2 * PI
        shift = np.floor(np.asarray((self.motion.angles - LONG(float(breaks[0]))) / turn, float)).astype(int)
        inside = np.asarray(self.motion.angles, float) - 2 * np.pi * shift
        piece = np.clip(np.searchsorted(breaks, inside, "right") - 1, 0, breaks.size - 2)
        t = self.motion.angles - shift * turn - LONG(breaks[piece])
        terms = [LONG(c[piece]) for c in cubics]
        variable = Series([t, 0 * t + 1, *(0 * t for _ in self.motion.zero.terms[2:])])
        value = variable * 0
        for term in terms:
            value = value * variable + Series([term, *(0 * t for _ in self.motion.zero.terms[1:])])
        return value

    def _over_stroke(self, action: object) -> Series:
        low, high = self.ends.get(action.slider, (0, 0))
        origin, sense = {"guide": (0, 1), "low end": (-low, 1), "high end": (high, -1)}[action.measured_from]
        place = self.motion.slides[action.slider] * sense + origin
        assert action.interpolation == "linear", "tables over a stroke: linear"
        x, y = action.over_stroke, action.force
        hold = action.outside == "hold"
        value = place * 0 + (LONG(y[0]) if hold else 0)
        for x0, x1, y0, y1 in zip(x, x[1:], y, y[1:], strict=False):
            slope = (LONG(y1) - LONG(y0)) / (LONG(x1) - LONG(x0))
            value = chosen(place[0] >= LONG(x0), (place - LONG(x0)) * slope + LONG(y0), value)
        value = chosen(place[0] > LONG(x[-1]), place * 0 + (LONG(y[-1]) if hold else 0), value)
        self.switches += [place - LONG(at) for at in x]
        return value

    def _spring(self, name: str) -> None:
        n, spring = self.numbers, self.scene.springs[name]
        a, b = (self.motion.points[end] for end in spring.between)
        length = (b - a).squared.sqrt()
        pull = (length - n[f"springs.{name}.free_length"]) * n[f"springs.{name}.stiffness"]
        pull = pull + length.by_angle() * (n[f"springs.{name}.damping"] * self.speed)
        force = (b - a).times(pull / length)
        for end, place, sign in zip(spring.between, (a, b), (1, -1), strict=True):
            link = holder_of(self.scene, end)
            self._push(link, place, force.times(sign))

    def _cylinder(self, name: str) -> None:
        cylinder, at, n = self.scene.cylinders[name], f"cylinders.{name}", self.numbers
        piston = self.motion.links[cylinder.piston]
        slide = self.motion.slides[cylinder.piston]
        sign = 1 if cylinder.head == "high" else -1
        toward = slide[1] * self.speed * sign > 0
        low, high = self.ends[cylinder.piston]
        travel = slide * -sign + (high if sign > 0 else -low)
        self.switches.append(slide.by_angle())
        if cylinder.type == "pump":
            pressure = chosen(toward, travel * 0 + n[f"{at}.discharge"], n[f"{at}.suction"])
        else:
            pressure = self._compressor(at, travel, toward, high - low)
        area = PI * n[f"{at}.bore"] ** 2 / 4
        force = (pressure - n[f"{at}.ambient"]) * (-sign * area)
        assert bearer_of(self.scene, cylinder.piston) == "frame"
        self._push(cylinder.piston, piston.origin, piston.way.times(force))

    def _compressor(self, at: str, travel: Series, toward: np.ndarray, stroke: object) -> Series:
        n = self.numbers
        suction, discharge = n[f"{at}.suction"], n[f"{at}.discharge"]
        least = n[f"{at}.clearance"] * stroke
        most, length = stroke + least, travel + least
        squeeze, widen = n[f"{at}.n_compression"], n[f"{at}.n_expansion"]
        opens = most * np.power(suction / discharge, 1 / squeeze)
        reached = discharge if least < opens else suction * np.power(most / least, squeeze)
        refills = least * np.power(reached / suction, 1 / widen)
        rising = chosen(length[0] > opens, (most / length).power(squeeze) * suction, discharge)
        falling = chosen(length[0] < refills, (least / length).power(widen) * reached, suction)
        self.switches += [length - opens, length - refills]
        return chosen(toward, rising, falling)


class Dynamics:
    """Reduced inertia and moment, and reactions, of a machine at constant speed, as Taylor series by field."""

    def __init__(self, motion: Motion, ends: Ends) -> None:
        scene, numbers = motion.scene, motion.numbers
        self.scene, self.numbers, self.motion, loads = scene, numbers, motion, Loads(motion, ends)
        self.switches = loads.switches
        self.moment = sum(loads.moments[1:], loads.moments[0])
        zero, square = self.motion.zero, numbers["input.speed"] ** 2
        self.inertia, self.shaking = zero, Place(zero, zero)
        self.totals = dict(loads.wrenches)
        for name, body in scene.bodies.items():
            link = self.motion.links[body.link]
            centre = link.point(numbers[f"bodies.{name}.x"], numbers[f"bodies.{name}.y"])
            mass, own = numbers[f"bodies.{name}.mass"], numbers[f"bodies.{name}.inertia"]
            velocity, rate = centre.by_angle(), link.rate
            self.inertia = self.inertia + velocity.squared * mass + rate * rate * own
            force = velocity.by_angle().times(-mass * square)
            self.shaking = self.shaking + force
            moment = centre.across(force) - rate.by_angle() * (own * square)
            self.totals[body.link].append(Wrench(force, moment))
        self.slope = self.inertia.by_angle()
        self.input_moment = self.slope * (square / 2) - self.moment
        self.reactions: dict[str, Place] = {}
        self._reactions()

    def _total(self, link: str) -> Wrench:
        zero = self.motion.zero
        return sum(self.totals[link], Wrench(Place(zero, zero), zero))

    def _outer(self, name: str, point: str, link: str, load: Wrench, inner: Place) -> None:
        """Reaction of an outer joint on a link, and the opposite force on the link that carries the joint."""
        reaction = Place(-load.force.x - inner.x, -load.force.y - inner.y)
        self.reactions[name] = reaction
        place, back = self.motion.points[point], reaction.times(-1)
        self.totals[holder_of(self.scene, point)].append(Wrench(back, place.across(back)))

    def _reactions(self) -> None:
        for name, group in reversed(self.scene.groups.items()):
            one, two = self._total(group.first.link), self._total(group.second.link)
            inner = {"RRR": self._rrr, "RRP": self._rrp, "RPR": self._rpr, "RPP": self._rpp}[group.type](
                group, one, two
            )
            self.reactions[f"{name}.inner"] = inner
            self._outer(f"{name}.first", group.first.joint, group.first.link, one, inner)
            if group.type in ("RRR", "RPR"):
                self._outer(f"{name}.second", group.second.joint, group.second.link, two, inner.times(-1))
            else:
                way = self.motion.links[group.second.link].way
                rest = inner - two.force
                self.reactions[f"{name}.second"] = way.left.times(way.left.along(rest))
        load = self._total(self.scene.input.link)
        self.reactions["input"] = load.force.times(-1)

    def _rrr(self, group: object, one: Wrench, two: Wrench) -> Place:
        a, d = (self.motion.points[side.joint] for side in (group.first, group.second))
        b = self.motion.points[group.inner]
        p, q = b - a, b - d
        return (p.times(two.about(d)) + q.times(one.about(a))).times(-1 / p.across(q))

    def _rrp(self, group: object, one: Wrench, two: Wrench) -> Place:
        a, b = self.motion.points[group.first.joint], self.motion.points[group.inner]
        way, p = self.motion.links[group.second.link].way, b - a
        along = two.force.along(way)
        across = -(one.about(a) + along * p.across(way)) / p.along(way)
        return way.times(along) + way.left.times(across)

    def _rpr(self, group: object, one: Wrench, two: Wrench) -> Place:
        a, d = (self.motion.points[side.joint] for side in (group.first, group.second))
        way = self.motion.links[group.second.link].way
        return way.left.times((one.about(a) + two.about(d)) / (a - d).along(way))

    def _rpp(self, group: object, one: Wrench, two: Wrench) -> Place:
        way, normal = self.motion.links[group.second.link].way, self.motion.links[group.first.link].way.left
        return normal.times(two.force.along(way) / normal.along(way))
