"""Runs with second inputs that have drives of their own, against all bodies' equations with constraints by SciPy."""

import math
from typing import NamedTuple

import numpy as np
import pytest
from driving_cams import changed
from each_case import refusals
from five_bars import JOINED
from machines import rrr
from scipy.integrate import solve_ivp

from engine import Machine, Scene, Verdict
from engine.scene.structure.ordering import order

GRAVITY = 9.81
MOTOR = {"type": "dc_motor", "on": "crank", "stall_moment": 2.0, "no_load_speed": 30.0}
FAN = {"type": "quadratic_drag", "on": "crank", "coefficient": 1e-3}
BRAKE = {"type": "against_motion", "on": "crank", "moment": 1.5}
PUSH = {"type": "constant", "on": "B", "force": 7.0, "angle": 0.4}
SWING = {"one": {"order": 1, "cosine": 0.3, "sine": -0.2}, "two": {"order": 2, "sine": 0.1}}
SECOND = {"type": "crank", "pivot": "C", "phase": 0.5, "period": 0.5, "harmonics": SWING}
FIVE_BAR = JOINED | {
    "inputs": {"second": SECOND},
    "bodies": {"crank_body": {"link": "crank", "mass": 1.1, "x": 0.01, "inertia": 0.004}, **JOINED["bodies"]},
    "forces": {"push": PUSH, "oil": {"type": "linear_drag", "on": "B", "coefficient": 5.0, "angle": 0.0}},
    "moments": {"motor": MOTOR, "fan": FAN, "brake": BRAKE},
    "springs": {"coil": {"between": ["O", "B"], "stiffness": 300.0, "free_length": 0.1, "damping": 4.0}},
}
TIMES = [0.05, 0.2, 0.35, 0.6, 0.8]
LOADED = {"type": "run", "from_speed": 0.0, "from_angle": 0.3, "off": ["brake"], "at": {"times": TIMES}}
FIELDS = ("turned", "speed", "acceleration", "kinetic_energy", "driving_power", "arms.inner.reaction_x", "O.reaction_y")
WORKS = ("motor_work", "driving_work", "useful_work", "harmful_work", "other_work", "energy_change")
RESULTS = ("time", "angle", "final_speed", *WORKS)


class Place(NamedTuple):
    """A point of a body, in its axes from the mass centre; of the frame without a body."""

    body: int | None
    x: float
    y: float


class Drive(NamedTuple):
    """A drive `row` · v = rate: it pushes along `way`, and the constraint's derivative is `row` · a = gamma."""

    row: np.ndarray
    way: np.ndarray
    rate: float
    gamma: float


CRANK_BODY, LEFT, RIGHT, OTHER = range(4)
MASS = np.array([1.1, 1.1, 0.004, 0.7, 0.7, 0.002, 0.8, 0.8, 0.003, 1.5, 1.5, 0.002])
N = MASS.size
FRAME_O, FRAME_C = Place(None, 0.0, 0.0), Place(None, 0.2, 0.02)
PIVOT, PIN = Place(CRANK_BODY, -0.01, 0.0), Place(CRANK_BODY, 0.04, 0.0)
FOOT, D = Place(OTHER, -0.04, -0.01), Place(OTHER, 0.0, 0.0)
LEFT_BEGIN, LEFT_END = Place(LEFT, -0.09, 0.0), Place(LEFT, 0.10, 0.0)
RIGHT_BEGIN, RIGHT_END = Place(RIGHT, -0.08, 0.0), Place(RIGHT, 0.09, 0.0)


def angle_row(**at: float) -> np.ndarray:
    """A row of the angles of bodies."""
    row = np.zeros(N)
    for name, value in at.items():
        row[3 * {"crank": CRANK_BODY, "second": OTHER}[name] + 2] = value
    return row


def turned(point: Place, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Position, Jacobian and centripetal acceleration of a point."""
    jacobian = np.zeros((2, N))
    if point.body is None:
        return np.array([point.x, point.y]), jacobian, np.zeros(2)
    i = 3 * point.body
    c, s = math.cos(z[i + 2]), math.sin(z[i + 2])
    arm = np.array([c * point.x - s * point.y, s * point.x + c * point.y])
    jacobian[:, i : i + 3] = [[1, 0, -arm[1]], [0, 1, arm[0]]]
    return z[i : i + 2] + arm, jacobian, -arm * z[N + i + 2] ** 2


class Bodies:
    """Rigid bodies in Cartesian coordinates (x, y, θ): M a = Q + Dᵀ λ with J a = γ.

    D is not J where a drive follows another body, as its reaction does not act on that body.
    `way` is the sense in which the motor drives; a `brake` stops the crank without it.
    """

    def __init__(self, joints: list, drives, way: float = 1.0, brake: float = 0.0) -> None:
        self.joints, self.drives, self.way, self.brake = joints, drives, way, brake

    def constraints(self, t: float, z: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """J, D, γ and J v."""
        rows, gammas = [], []
        for a, b in self.joints:
            (_, ja, ca), (_, jb, cb) = turned(a, z), turned(b, z)
            rows, gammas = [*rows, *(ja - jb)], [*gammas, *(cb - ca)]
        drives = self.drives(t, z)
        ways, rates = [*rows, *(drive.way for drive in drives)], [0.0] * len(rows) + [drive.rate for drive in drives]
        rows, gammas = [*rows, *(drive.row for drive in drives)], [*gammas, *(drive.gamma for drive in drives)]
        return tuple(map(np.array, (rows, ways, gammas, rates)))

    def begin(self, places: np.ndarray, omega: float) -> np.ndarray:
        """State at t = 0 with a speed of the crank, and no work yet."""
        rows, _, _, rates = self.constraints(0.0, np.concatenate([places, np.zeros(N)]))
        v = np.linalg.solve(np.vstack([rows, angle_row(crank=1.0)]), [*rates, omega])
        return np.concatenate([places, v, np.zeros(2)])

    def motor(self, z: np.ndarray) -> float:
        """Torque of the motor."""
        return 0.0 if self.brake else 2.0 * (self.way - z[N + 2] / 30.0)

    def loads(self, z: np.ndarray) -> np.ndarray:
        """Generalised forces of weights, motor, brake, push, oil, fan and coil."""
        v, (at, jacobian, _) = z[N : 2 * N], turned(LEFT_END, z)
        load = np.zeros(N)
        load[1::3] = -GRAVITY * MASS[1::3]
        load[2] += self.motor(z) - 1e-3 * v[2] * abs(v[2]) - self.brake
        speed, length = jacobian @ v, math.hypot(*at)
        pull = -at / length * (300.0 * (length - 0.1) + 4.0 * (at @ speed) / length)
        push = np.array([7.0 * math.cos(0.4) - 5.0 * speed[0], 7.0 * math.sin(0.4)])
        return load + jacobian.T @ (pull + push)

    def solved(self, t: float, z: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Accelerations, and reactions λ: of joints first, then of drives."""
        rows, ways, gammas, _ = self.constraints(t, z)
        whole = np.block([[np.diag(MASS), -ways.T], [rows, np.zeros((len(rows), len(rows)))]])
        found = np.linalg.solve(whole, np.concatenate([self.loads(z), gammas]))
        return found[:N], found[N:]

    def rates(self, t: float, z: np.ndarray) -> np.ndarray:
        """Derivatives of the state, and powers of the drives and of the motor."""
        acceleration, reactions = self.solved(t, z)
        return np.concatenate([z[N : 2 * N], acceleration, [self.power(t, z, reactions), self.motor(z) * z[N + 2]]])

    @staticmethod
    def energy(z: np.ndarray) -> float:
        """Kinetic energy."""
        return 0.5 * (MASS * z[N : 2 * N] ** 2).sum()

    def power(self, t: float, z: np.ndarray, reactions: np.ndarray) -> float:
        """Power of the drives."""
        own = reactions[2 * len(self.joints) :]
        return sum(r * (drive.way @ z[N : 2 * N]) for r, drive in zip(own, self.drives(t, z), strict=True))


RATE = 2.0 * math.pi / 0.5


def swing(tau: float) -> np.ndarray:
    """The law's value and two derivatives by its argument."""
    c, s, c2, s2 = math.cos(tau), math.sin(tau), math.cos(2 * tau), math.sin(2 * tau)
    return np.array([0.3 * c - 0.2 * s + 0.1 * s2, -0.3 * s - 0.2 * c + 0.2 * c2, -0.3 * c + 0.2 * s - 0.4 * s2])


def placed(phi: float, psi: float, carried: bool = False) -> np.ndarray:
    """Coordinates of the bodies by two circles; the second crank is at C, or on the crank's pin."""
    crank = np.exp(1j * phi)
    tip = (0.05 * crank if carried else 0.2 + 0.02j) + (0.04 + 0.01j) * np.exp(1j * psi)
    one, other = (tip, 0.2 + 0.02j) if carried else (0.05 * crank, tip)
    line = other - one
    along = (abs(line) ** 2 + 0.19**2 - 0.17**2) / (2 * abs(line))
    inner = one + line / abs(line) * complex(along, math.sqrt(0.19**2 - along**2))
    left, right = (inner - one) / 0.19, (inner - other) / 0.17
    centres = [(0.01 * crank, phi), (one + 0.09 * left, np.angle(left)), (other + 0.08 * right, np.angle(right))]
    return np.array([part for at, angle in [*centres, (tip, psi)] for part in (at.real, at.imag, angle)])


ARMS = [(PIN, LEFT_BEGIN), (LEFT_END, RIGHT_END), (RIGHT_BEGIN, D)]
TURNING = [(PIVOT, FRAME_O), (FOOT, FRAME_C), *ARMS]
RELATIVE = [(PIVOT, FRAME_O), (FOOT, PIN), (D, LEFT_BEGIN), (LEFT_END, RIGHT_END), (RIGHT_BEGIN, FRAME_C)]
ALONG = np.array([math.cos(0.3), math.sin(0.3)])


def by_time(t: float, z: np.ndarray) -> list[Drive]:
    (_, slope, bend), row = swing(RATE * t), angle_row(second=1.0)
    return [Drive(row, row, RATE * slope, RATE**2 * bend)]


def on_the_pin(t: float, z: np.ndarray) -> list[Drive]:
    (_, slope, bend), row = swing(RATE * t), angle_row(second=1.0, crank=-1.0)
    return [Drive(row, row, RATE * slope - 4.0 * math.pi, RATE**2 * bend)]


def by_the_crank(t: float, z: np.ndarray) -> list[Drive]:
    _, slope, bend = swing(z[2])
    row = angle_row(second=1.0, crank=-slope)
    return [Drive(row, angle_row(second=1.0), 0.0, bend * z[N + 2] ** 2)]


def sliding(t: float, z: np.ndarray) -> list[Drive]:
    rows = np.zeros((2, N))
    rows[0, -3:-1], rows[1, -3:-1] = ALONG, [-ALONG[1], ALONG[0]]
    rate, bend = 0.02 * RATE * math.cos(RATE * t), -0.02 * RATE**2 * math.sin(RATE * t)
    still = angle_row(second=1.0)
    return [Drive(rows[0], rows[0], rate, bend), Drive(rows[1], rows[1], 0.0, 0.0), Drive(still, still, 0.0, 0.0)]


RAIL = {"type": "slider", "guide": "rail", "period": 0.5, "harmonics": {"one": {"order": 1, "sine": 0.02}}}
ON_RAIL = {"guides": {"rail": {"x": 0.2, "y": 0.02, "angle": 0.3}}, "inputs__second": RAIL}
CARRIED = {
    "inputs__second": SECOND | {"pivot": "A", "speed": -4.0 * math.pi},
    "groups__arms": rrr("B", ("left", "D", 0.19), ("right", "C", 0.17)),
}
START, AT_ONCE = 0.3, 0.5 + swing(0.0)[0]
CASES = {
    "law of time": ({}, Bodies(TURNING, by_time), placed(START, AT_ONCE)),
    "crank turns back": ({"input__speed": "-120 rpm"}, Bodies(TURNING, by_time, -1.0), placed(START, AT_ONCE)),
    "on the crank": (CARRIED, Bodies(RELATIVE, on_the_pin), placed(START, START + AT_ONCE, carried=True)),
    "law of the crank": (
        {"inputs__second__period": None}, Bodies(TURNING, by_the_crank), placed(START, 0.5 + swing(START)[0])
    ),
    "slider up to a stop": (
        ON_RAIL | {"input__start": 0.0, "input__stop": 8.0},
        Bodies([(PIVOT, FRAME_O), *ARMS], sliding),
        placed(START, 0.3),
    ),
}  # fmt: skip


def answers(scene: dict, fields: tuple[str, ...] = ()) -> tuple[dict, dict]:
    """Results and fields of the run "go", and their error estimates."""
    names = [f"go.{name}" for name in RESULTS]
    machine = Machine(Scene.model_validate(scene), names, [f"go.{name}" for name in fields], positions=48)
    found = machine.evaluate({})
    assert Verdict(found.status[0]) == Verdict.OK
    values = {name: found.summaries[f"go.{name}"][0] for name in RESULTS}
    return values | {name: found.fields[f"go.{name}"][0] for name in fields}, found.errors


def close(found: dict, errors: dict, wanted: dict, k: int | None = None) -> None:
    """Results are as near as their estimates say, plus the reference's own error, and to ten digits."""
    for name, value in wanted.items():
        error = abs((found[name] if k is None else found[name][k]) - value)
        assert error <= np.max(errors[f"go.{name}"]) + 1e-10 * abs(value) + 1e-11, (name, k, error)
        assert error <= 1e-9 * max(abs(value), 10.0), (name, k, error)


@pytest.mark.parametrize("name", CASES)
def test_run__is_that_of_all_bodies(name):
    changes, bodies, places = CASES[name]
    stops = "input__stop" in changes
    drive = "second.driving_force" if stops else "second.driving_moment"
    run = LOADED | ({"end_of_range": True} if stops else {"time": 0.8})
    found, errors = answers(changed(FIVE_BAR, regimes={"go": run}, **changes), (*FIELDS, drive))

    def at_stop(t: float, z: np.ndarray) -> float:
        return z[2] - 8.0 if stops else 1.0

    at_stop.terminal = True
    start = bodies.begin(places, 0.0)
    true = solve_ivp(bodies.rates, (0.0, 0.8), start, "DOP853", TIMES, events=at_stop, rtol=1e-12, atol=1e-13)
    for k, (t, z) in enumerate(zip(true.t, true.y.T, strict=True)):
        acceleration, reactions = bodies.solved(t, z)
        inner = 2 * bodies.joints.index((LEFT_END, RIGHT_END))
        power, energy = bodies.power(t, z, reactions), bodies.energy(z)
        motion = bodies.way * (z[2] - 0.3), bodies.way * z[N + 2], acceleration[2]
        own = reactions[2 * len(bodies.joints)]
        wanted = (*motion, energy, power, reactions[inner], reactions[1], own)
        close(found, errors, dict(zip((*FIELDS, drive), wanted, strict=True)), k)
    end, last = (true.y_events[0][0], true.t_events[0][0]) if stops else (true.y[:, -1], 0.8)
    assert stops or true.t.size == len(TIMES)
    motion = {"time": last, "angle": bodies.way * (end[2] - 0.3), "final_speed": bodies.way * end[N + 2]}
    change = bodies.energy(end) - bodies.energy(start)
    close(found, errors, motion | {"driving_work": end[-2], "motor_work": end[-1], "energy_change": change})
    # The drive's work is not a remainder of the others.
    total = found["motor_work"] + found["driving_work"] + found["other_work"]
    total -= found["useful_work"] + found["harmful_work"]
    assert abs(total - change) <= sum(np.max(errors[f"go.{name}"]) for name in WORKS)


def test_brake__stops_the_crank_while_the_servo_moves():
    run = LOADED | {"from_speed": 20.0, "off": ["motor"], "rest": True}
    found, errors = answers(changed(FIVE_BAR, regimes={"go": run}), FIELDS)
    bodies = Bodies(TURNING, by_time, brake=1.5)

    def at_rest(t: float, z: np.ndarray) -> float:
        return z[N + 2]

    at_rest.terminal = True
    start = bodies.begin(placed(START, AT_ONCE), 20.0)
    true = solve_ivp(bodies.rates, (0.0, 5.0), start, "DOP853", events=at_rest, rtol=1e-12, atol=1e-13)
    end, change = true.y[:, -1], bodies.energy(true.y[:, -1]) - bodies.energy(start)
    close(found, errors, {"time": true.t[-1], "angle": end[2] - 0.3, "driving_work": end[-2], "energy_change": change})


def test_crank_that_a_brake_holds__stalls_as_the_drive_would_do_work_meanwhile():
    run = LOADED | {"off": ["motor"], "time": 0.8}
    scene = changed(FIVE_BAR, regimes={"go": run}, moments__brake__moment=100.0)
    names = [f"go.{name}" for name in RESULTS]
    found = Machine(Scene.model_validate(scene), names, [f"go.{name}" for name in FIELDS], positions=48).evaluate({})
    assert Verdict(found.status[0]) == Verdict.STALLS


def test_gear_law_that_would_make_the_inertia_negative__has_no_motion():
    light = {f"bodies__{link}_body__{key}": 1e-5 for link in ("crank", "left") for key in ("mass", "inertia")}
    geared = {"inputs__second__period": None, "inputs__second__harmonics": None, "inputs__second__ratio": 2.0}
    scene = changed(FIVE_BAR, regimes={"go": LOADED | {"time": 1e-3}}, **light, **geared)
    found = Machine(Scene.model_validate(scene), ["go.time"], positions=48).evaluate({})
    assert Verdict(found.status[0]) == Verdict.NOT_FINITE


REGIMES = {"go": LOADED | {"time": 0.8}}


test_uncounted_parts__are_refused_in_words = refusals(
    lambda changes: order(Scene.model_validate(changed(FIVE_BAR, regimes=REGIMES, **changes))),
    ({"regimes__go": {"type": "steady"}}, "regimes.go: needs a single drive, but 'second' has its own"),
    ({"flywheel": {"inertia": 0.05}}, "flywheel: needs a single drive"),
    ({"friction": {"f": {"pair": "arms.inner", "coefficient": 0.1, "diameter": 0.02}}}, "friction.f: a run with"),
    (
        {"inputs__second__period": None, "inputs__second__drive": "crank", "inputs__other": SECOND},
        "second.drive: a run",
    ),
    ({"shafts": {"s": {"geared_to": "crank", "ratio": 2, "pivot": "C"}}}, "shafts.s.pivot: a run with 'second'"),
    (
        {"inputs__second__sections": {"a": {"type": "dwell"}}},
        "inputs.second.sections: a run with 'second', which has its own drive, ignores this",
    ),
)


JUMPS = "can't jump, act"
test_what_a_second_input_does_not_allow__is_refused = refusals(
    lambda changes: Machine(Scene.model_validate(changed(FIVE_BAR, regimes=REGIMES, **changes)), ["go.time"]),
    ({"forces__rub": {"type": "against_motion", "on": "B", "force": 1.0}}, JUMPS),
    ({"forces__rub": {"type": "linear_drag", "on": "B", "coefficient": 1.0}}, "give an angle and a load linear"),
    ({"forces__oil__acts": "along"}, JUMPS),
    ({"moments__air": {"type": "quadratic_drag", "on": "left", "coefficient": 1e-3}}, JUMPS),
    ({"moments__air": {"type": "torsion_spring", "on": "left", "stiffness": 1.0}}, JUMPS),
    ({"forces__rub": {"type": "formula", "on": "B", "force": "9 N/m * B.x", "angle": 0.0}}, JUMPS),
    (
        {"regimes__go__method": "rk4", "regimes__go__steps_per_turn": 64, "inputs__second__period": None},
        "can't follow a second input with its own drive",
    ),
)
