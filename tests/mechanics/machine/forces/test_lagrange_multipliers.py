"""Reactions in all pairs against Lagrange multipliers of constraints between free links.

Every link has three coordinates of its own (x, y, theta of its axes). Pairs, gears and the drive are constraints
phi(u, t) = 0 between them, written from the scene alone; `Jet` differentiates them. Their Jacobian J gives velocities
and accelerations, J u" = -(phi_uu u' u' + phi_tt), and d'Alembert's principle in Lagrange's form the multipliers,

    J^T lambda = sum m a dr/du + sum J_S alpha dtheta/du - Q,

in which nothing is a force or an equilibrium: J^T lambda of a pair's own constraints is the reaction on a link. From
the engine come the positions alone, which must satisfy all constraints.

Tolerance: positions, and from them both solutions, are good to a rounding times the condition of J; ROUNDINGS are
allowed of the greatest term in J^T lambda.
"""

import math

import numpy as np
import pytest
from drawn_machines import geared_five_bar, quick_return, scotch_yoke, sliding_input
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from loaded_machines import asked, loaded
from machines import chain, crank, frame, rrp, rrr
from oracle import EPS, Jet, Pose
from reaction_graphs import ReactionValues
from scipy.linalg import lstsq

from engine import Machine, Scene
from engine.mechanism.input_motion import InputMotion
from engine.parts.skeleton import FRAME, CrankInput, Hinged, Sliding, Yoke
from engine.scene.pairs import pairs

ROUNDINGS = 200


# The engine, its graph evaluated by NumPy


def moved(scene, q, omega, epsilon):
    """Places of all links (x, y, theta), and the reactions, at one position of an accelerated input."""

    def motion(graph):
        return InputMotion(graph.constant(omega**2), graph.constant(epsilon), graph.constant(abs(omega)))

    of, at = ReactionValues(scene, motion), np.array([q])
    turning = {name: link for name, link in of.kinematics.links.items() if name != FRAME}
    nodes = [node for link in turning.values() for node in (*of.kinematics.coordinates(link.origin.r), *link.u)]
    rows = np.reshape(of.values(nodes, at), (-1, 4))
    places = {}
    for name, (x, y, c, s) in zip(turning, rows.tolist(), strict=True):
        loose = name in scene.shafts and scene.shafts[name].pivot is None
        places[name] = (x, y, scene.shafts[name].ratio * q if loose else math.atan2(s, c))
    names = [name for name in asked(scene) if not name.startswith("frame")]
    return places, {name: float(value[0]) for name, value in of(names, at).items()}


# Constraints


class Constraints:
    """Equations between the links of a scene, by the pair that they belong to."""

    def __init__(self, scene):
        self.scene = scene
        self.at = {name: (p.link, p.x, p.y) for name, p in scene.points.items()}
        drive = scene.input
        if isinstance(drive, CrankInput):
            self.at[drive.pin] = (drive.link, drive.length, 0.0)
        else:
            self.at[drive.point] = (drive.link, 0.0, 0.0)
        for g in scene.groups.values():
            if hasattr(g, "inner"):
                self.at[g.inner] = self.end(g.first)

    @staticmethod
    def end(part):
        """Inner joint of a group on one of its links."""
        return (part.link, part.length if isinstance(part, Hinged) else 0.0, 0.0)

    def equations(self, poses, time):
        """All constraints at the poses of the links, the drive at its place at `time`."""
        poses = {FRAME: Pose(0.0, 0.0, 0.0), **poses}
        drive, found = self.scene.input, {}
        if isinstance(drive, CrankInput):
            found["input"] = self.pin(poses, (drive.link, 0.0, 0.0), self.at[drive.pivot])
            found["drive"] = [poses[drive.link].theta - time]
        else:
            found["input"] = self.guided(poses, drive.link, drive.guide, 0.0)
            found["drive"] = [self.along(poses, drive.link, drive.guide) - time]
        for name, shaft in self.scene.shafts.items():
            pivot = (FRAME, 0.0, 0.0) if shaft.pivot is None else self.at[shaft.pivot]
            found[name] = self.pin(poses, (name, 0.0, 0.0), pivot)
            phase = shaft.phase if shaft.pivot is not None else 0.0
            found[f"gear of {name}"] = [poses[name].theta - poses[shaft.geared_to].theta * shaft.ratio - phase]
        for name, g in self.scene.groups.items():
            for side in ("first", "second"):
                found[f"{name}.{side}"] = self.outer(poses, getattr(g, side))
            found[f"{name}.inner"] = self.inner(poses, g)
        return found

    @staticmethod
    def pin(poses, one, other):
        (ax, ay), (bx, by) = (poses[link].point(x, y) for link, x, y in (one, other))
        return [ax - bx, ay - by]

    def way(self, poses, guide):
        g = self.scene.guides[guide]
        return Pose(*poses[g.link].point(g.x, g.y), poses[g.link].theta + g.angle)

    def along(self, poses, link, guide):
        return self.way(poses, guide).seen(poses[link].x, poses[link].y)[0]

    def guided(self, poses, link, guide, offset):
        way = self.way(poses, guide)
        return [way.seen(poses[link].x, poses[link].y)[1] - offset, poses[link].theta - way.theta]

    def outer(self, poses, part):
        if isinstance(part, (Sliding, Yoke)):
            return self.guided(poses, part.link, part.guide, getattr(part, "offset", 0.0))
        return self.pin(poses, (part.link, 0.0, 0.0), self.at[part.joint])

    def inner(self, poses, g):
        if hasattr(g, "inner"):
            return self.pin(poses, self.end(g.first), self.end(g.second))
        block, slotted = poses[g.first.link], poses[g.second.link]
        turned = g.second.slot_angle if g.type == "RPP" else 0.0
        slot = Pose(slotted.x, slotted.y, slotted.theta + turned)
        offset = 0.0 if g.type == "RPP" else g.second.offset
        return [slot.seen(block.x, block.y)[1] - offset, block.theta - slot.theta]


# Multipliers


def turned_by(value, size):
    """Derivatives of a Jet by all coordinates."""
    return np.broadcast_to(value.d, size).astype(float)


class Lagrange:
    """A scene at given places of its links, its input at a speed and an acceleration.

    Attributes
    ----------
    jacobian, terms : ndarray (coordinates, coordinates), (coordinates,)
    rows : dict of str to slice
        Those of the constraints of each pair, of gears and of the drive.
    """

    def __init__(self, scene, places, q, omega, epsilon):
        self.scene, self.links, self.q = scene, list(places), q
        self.u = np.array([value for place in places.values() for value in place])
        self.constraints, size = Constraints(scene), self.u.size
        found = self.constraints.equations(self.poses(np.eye(size)), Jet(q))
        ends = np.cumsum([0, *(len(rows) for rows in found.values())])
        self.rows = {name: slice(*ends[i : i + 2]) for i, name in enumerate(found)}
        equations = [equation for rows in found.values() for equation in rows]
        # Angles are of the engine's directions: of whole turns nothing is known.
        self.gap = max(abs(math.remainder(float(equation.v), 2 * math.pi)) for equation in equations)
        self.jacobian = np.array([turned_by(equation, size) for equation in equations])
        rate = np.linalg.solve(self.jacobian, -self.rates(np.zeros(size), np.zeros(size), omega, 0.0, "d"))
        second = np.linalg.solve(self.jacobian, -self.rates(rate, np.zeros(size), omega, epsilon, "dd"))
        self.terms = self.inertia(rate, second) - self.given()

    def poses(self, d, dd=0.0):
        """Links with the derivatives of their coordinates, (coordinates, ...)."""
        dd = np.broadcast_to(dd, np.shape(d))
        jets = [Jet(v, d[i], dd[i]) for i, v in enumerate(self.u)]
        return {name: Pose(*jets[3 * i : 3 * i + 3]) for i, name in enumerate(self.links)}

    def rates(self, d, dd, omega, epsilon, order):
        found = self.constraints.equations(self.poses(d, dd), Jet(self.q, omega, epsilon))
        return np.array([float(getattr(equation, order)) for rows in found.values() for equation in rows])

    def inertia(self, rate, second):
        unit, moved = self.poses(np.eye(self.u.size)), self.poses(rate, second)
        total = np.zeros(self.u.size)

        def add(mass, one, other):
            nonlocal total
            total = total + mass * float(other.dd) * turned_by(one, self.u.size)

        for body in self.scene.bodies.values():
            for one, other in zip(*(p[body.link].point(body.x or 0.0, body.y) for p in (unit, moved)), strict=True):
                add(body.mass, one, other)
            add(body.inertia or 0.0, unit[body.link].theta, moved[body.link].theta)
        for name, shaft in self.scene.shafts.items():
            add(shaft.inertia, unit[name].theta, moved[name].theta)
        return total

    def given(self):
        """Generalised forces: weights, forces and moments, springs by their potentials."""
        scene, size = self.scene, self.u.size
        poses = {FRAME: Pose(0.0, 0.0, 0.0), **self.poses(np.eye(size))}
        total = np.zeros(size)
        for body in scene.bodies.values():
            height = poses[body.link].point(body.x or 0.0, body.y)[1]
            total -= body.mass * scene.gravity * turned_by(height, size)
        for force in scene.forces.values():
            link, a, b = self.constraints.at[force.on]
            x, y = (turned_by(part, size) for part in poses[link].point(a, b))
            total += force.force * (math.cos(force.angle) * x + math.sin(force.angle) * y)
        for moment in scene.moments.values():
            total += moment.moment * turned_by(poses[moment.on].theta, size)
        for spring in scene.springs.values():
            (ax, ay), (bx, by) = (
                poses[link].point(a, b) for link, a, b in map(self.constraints.at.get, spring.between)
            )
            ex, ey = bx - ax, by - ay
            length = math.hypot(float(np.max(ex.v)), float(np.max(ey.v)))
            stretched = turned_by((ex * ex + ey * ey) * (0.5 / length), size)
            total -= spring.stiffness * (length - spring.free_length) * stretched
        return total

    def reactions(self):
        """Reactions by the engine's names."""
        multipliers, _, rank, _ = lstsq(self.jacobian.T, self.terms)
        assert rank == self.u.size
        found = {"input_moment_by_equilibrium": multipliers[self.rows["drive"]][0]}
        for pair in pairs(self.scene):
            own, i = self.rows[pair.name], 3 * self.links.index(pair.link)
            x, y, moment = self.jacobian[own, i : i + 3].T @ multipliers[own]
            if pair.kind == "revolute":
                found |= {f"{pair.name}.reaction_x": x, f"{pair.name}.reaction_y": y}
            else:
                theta = self.u[i + 2]
                normal = y * math.cos(theta) - x * math.sin(theta)
                found |= {f"{pair.name}.reaction": normal, f"{pair.name}.reaction_moment": moment}
        return found

    def tolerance(self):
        return ROUNDINGS * EPS * np.linalg.cond(self.jacobian) * np.abs(self.terms).max()


def check(scene, q, omega, epsilon):
    scene = Scene.model_validate(scene)
    places, found = moved(scene, q, omega, epsilon)
    lagrange = Lagrange(scene, places, q, omega, epsilon)
    # Of lengths and angles of order one.
    assert lagrange.gap < ROUNDINGS * EPS * np.linalg.cond(lagrange.jacobian)
    expected = lagrange.reactions()
    assert set(expected) == set(found)
    for name, value in found.items():
        assert value == pytest.approx(expected[name], rel=0, abs=lagrange.tolerance()), name


def sprung(scene, between):
    return {**scene, "springs": {"spring": {"between": between, "stiffness": 400.0, "free_length": 0.2}}}


# Random machines

# Angle, speed and acceleration of the input.
MOTIONS = st.tuples(st.floats(0.0, 2 * math.pi), st.floats(-20.0, 20.0), st.floats(-100.0, 100.0))
LENGTHS, SEEDS = st.floats(0.4, 1.2), st.integers(0, 10_000)


@given(LENGTHS, LENGTHS, LENGTHS, st.sampled_from([1, -1]), MOTIONS, SEEDS)
@settings(deadline=None, max_examples=40)
def test_random_four_bars__have_the_multipliers_of_their_pins(base, coupler, rocker, mode, motion, seed):
    # Crank and rocker all around, its transmission angle 10 degrees and more.
    ends = [(coupler**2 + rocker**2 - (base + way * 0.15) ** 2) / (2 * coupler * rocker) for way in (1, -1)]
    assume(all(abs(cosine) < math.cos(math.radians(10)) for cosine in ends))
    plain = {
        "points": {"O": frame(0.1, -0.2), "D": frame(0.1 + base, -0.2)},
        "input": crank(length=0.15),
        "groups": {"bars": rrr("B", ("coupler", "A", coupler), ("rocker", "D", rocker), mode)},
    }
    check(sprung(loaded(plain, seed), ["D", "on_coupler"]), *motion)


@given(st.floats(0.35, 1.5), st.floats(-0.15, 0.15), st.floats(-3.0, 3.0), MOTIONS, SEEDS)
@settings(deadline=None, max_examples=40)
def test_random_slider_cranks__have_the_multipliers_of_their_pins_and_guide(rod, offset, angle, motion, seed):
    plain = {
        "points": {"O": frame(0.0, 0.0)},
        "guides": {"way": {"x": 0.02, "y": -0.01, "angle": angle}},
        "input": crank(length=0.15),
        "groups": {"g": rrp("B", ("rod", "A", rod), "ram", "way", offset)},
    }
    check(loaded(plain, seed), *motion)


# Two dyads make six links with the frame.
@pytest.mark.parametrize("in_series", [True, False])
@pytest.mark.parametrize("seed", range(5))
def test_random_six_links__have_the_multipliers_of_all_their_pairs(seed, in_series):
    scene, rng = loaded(chain(seed, 2, in_series), seed), np.random.default_rng(seed)
    for _ in range(5):
        check(scene, rng.uniform(0, 2 * math.pi), rng.uniform(-10, 10), rng.uniform(-50, 50))


def test_long_chain_of_all_dyads__has_the_multipliers_of_all_its_pairs():
    scene, rng = loaded(chain(4, 7, True), 4), np.random.default_rng(4)
    for _ in range(5):
        check(scene, rng.uniform(0, 2 * math.pi), rng.uniform(-10, 10), rng.uniform(-50, 50))


@pytest.mark.parametrize("machine", [geared_five_bar(), sliding_input(), quick_return(0.01), scotch_yoke()])
def test_machines_of_all_kinds__have_the_multipliers_of_pairs_gears_and_drive(machine):
    scene, drive = loaded(machine.model_dump(exclude_none=True), 7), machine.input
    low, high = (0.0, 2 * math.pi) if isinstance(drive, CrankInput) else (drive.start, drive.stop)
    rng = np.random.default_rng(7)
    for _ in range(5):
        q = rng.uniform(low, high)
        check(scene, q, rng.uniform(-10, 10), rng.uniform(-50, 50))


def test_compiled_machine__has_the_multipliers_of_its_pairs():
    scene = Scene.model_validate(sprung(loaded(chain(2, 2, True), 2), ["O", "on_u0"]))
    fields = [name for name in asked(scene) if not name.startswith("frame")]
    machine = Machine(scene, fields=fields, positions=8)
    rows = machine.evaluate({}).fields
    for k, q in enumerate(machine.nodes):
        lagrange = Lagrange(scene, moved(scene, q, scene.input.speed, 0.0)[0], q, scene.input.speed, 0.0)
        for name, expected in lagrange.reactions().items():
            assert rows[name][0, k] == pytest.approx(expected, rel=0, abs=lagrange.tolerance()), name
