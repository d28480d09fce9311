"""Loads by formula in true motion: as the loads that they restate, and against a general integrator at 1e-12."""

import math
from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from engine import Machine, Scene, Verdict
from engine.mechanism.mechanics import Mechanics
from engine.motion.cases import regime_text

INERTIA, CRANK, ROD, MASS = 0.4, 0.05, 0.2, 3.0
RTOL = 1e-12


def moment(formula: str, **more: object) -> dict:
    return {"type": "formula", "on": "crank", "moment": formula, **more}


def crank(moments: dict, regimes: dict, speed: float = 20.0, **more: object) -> Scene:
    """A crank with a drum, I = 0.4 kg·m²."""
    return Scene.model_validate(
        {
            "points": {"O": {"x": 0, "y": 0}},
            "input": {"type": "crank", "pivot": "O", "pin": "A", "length": CRANK, "speed": speed},
            "bodies": {"drum": {"link": "crank", "mass": 1.0, "inertia": INERTIA}},
            "moments": moments,
            "regimes": regimes,
            **more,
        }
    )


def slider_crank(moments: dict, regimes: dict, forces: dict, speed: float = 20.0) -> Scene:
    """The crank with a rod and a heavy ram that slides along x."""
    first, second = {"link": "rod", "joint": "A", "length": ROD}, {"link": "ram", "guide": "way"}
    scene = crank(moments, regimes, speed).model_dump(exclude_none=True)
    scene["guides"] = {"way": {}}
    scene["groups"] = {"drive": {"type": "RRP", "inner": "B", "first": first, "second": second}}
    scene["bodies"]["ram_body"] = {"link": "ram", "mass": MASS}
    scene["forces"] = forces
    return Scene.model_validate(scene)


def answers(scene: Scene, *names: str, positions: int = 720) -> tuple[dict, dict]:
    outcome = Machine(scene, summaries=list(names), positions=positions).evaluate({})
    assert outcome.status[0] == Verdict.OK
    return {name: outcome.summaries[name][0] for name in names}, {name: outcome.errors[name][0] for name in names}


def turned_until(
    by_hand: Callable[[float, float, float], float], begin: float, angle: float, speed: float, end: float
) -> tuple[float, float]:
    """Angle and speed of I ε = M(t, φ, ω) from one time to another."""

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], by_hand(t, *y) / INERTIA

    found = solve_ivp(rates, (begin, end), (angle, speed), method="DOP853", rtol=RTOL, atol=1e-13)
    return found.y[0, -1], found.y[1, -1]


RUN = {"type": "run", "off": [], "time": 1.5}
COURSES = {
    "powers": (
        "6 N m - 0.02 N m s * omega - 1e-3 N m s2 * omega * abs(omega) - 1e-3 N m * (abs(omega) / (1 rad/s))^1.5",
        lambda t, q, w: 6 - 0.02 * w - 1e-3 * w * abs(w) - 1e-3 * abs(w) ** 1.5,
    ),
    "angle": (
        "2 N m + 3 N m * sin(2 * phi) - (0.1 N m s * omega if phi > 1 and phi < 4 else 0)",
        lambda t, q, w: 2 + 3 * math.sin(2 * q) - (0.1 * w if 1 < q % (2 * math.pi) < 4 else 0.0),
    ),
    "falling angle": (
        "k * (phi - 3) - 0.05 N m s * omega + 4 N m",
        lambda t, q, w: 0.7 * (q % (2 * math.pi) - 3) - 0.05 * w + 4,
    ),
    "time": (
        "5 N m * exp(-t / (1 s)) * cos(3 rad/s * t) + (2 N m if t > 0.7 s else 0) - 0.02 N m s * omega",
        lambda t, q, w: 5 * math.exp(-t) * math.cos(3 * t) + (2 if t > 0.7 else 0) - 0.02 * w,
    ),
    "per speed": ("60 W / omega - 0.1 N m s * omega", lambda t, q, w: 60 / w - 0.1 * w),
    "of speed, angle and time": (
        "9 N m * sin(phi) / (1 + omega / (10 rad/s)) + 1 N m * cos(omega * t)",
        lambda t, q, w: 9 * math.sin(q) / (1 + w / 10) + math.cos(w * t),
    ),
}


@pytest.mark.parametrize("name", COURSES)
def test_run_under_a_formula__goes_as_a_general_integrator_does(name):
    formula, by_hand = COURSES[name]
    start = {"type": "run", "off": ["load"], "speed": 12.0}
    regimes = {"start": start, "work": RUN}
    moments = {"load": moment(formula, numbers={"k": "0.7 N m/rad"}), "push": moment("9 N m")}
    regimes["work"] = {**RUN, "off": ["push"]}
    scene = crank(moments, regimes)
    found, errors = answers(scene, "work.angle", "work.final_speed", "start.angle", "start.time")
    # A constant moment from rest: ω²/2 = M φ / I. The clock goes on from one regime to the next.
    begin, clock = 12.0**2 / 2 * INERTIA / 9.0, 12.0 * INERTIA / 9.0
    assert found["start.angle"] == pytest.approx(begin, rel=1e-12)
    angle, speed = begin, 12.0
    # In pieces between instants at which the moment jumps, and so short that an angle at which it does is met closely.
    ends = [0.0, 0.7 - clock, 0.7 - clock + 1e-12, 1.5] if name == "time" else np.linspace(0.0, 1.5, 301)
    for first, last in pairwise(ends):
        angle, speed = turned_until(by_hand, clock + first, angle, speed, clock + last)
    # Jumps over the angle cost the reference what its step control makes of them.
    rough = 1e-7 if "angle" in name else 1e-10
    for quantity, expected in (("work.angle", angle - begin), ("work.final_speed", speed)):
        assert errors[quantity] <= 1e-6 * abs(expected)
        assert abs(found[quantity] - expected) <= rough * abs(expected) + errors[quantity]


def test_friction_by_formula__holds_what_is_at_rest_and_lets_go():
    """From rest under Stribeck's friction of 7 N·m, 2 N·m when fast: 9 N·m set a drum going, 6 N·m don't."""
    friction = moment("-sign(omega) * (2 N m + 5 N m * exp(-abs(omega) / (15 rad/s)))")
    machine = Machine(
        crank({"rubs": friction, "push": moment("9 N m")}, {"go": {"type": "run", "from_speed": 0.0, "time": 0.8}}),
        ["go.final_speed", "go.angle"],
    )
    found = machine.evaluate({})
    rates = lambda t, y: [y[1], (7.0 - 5.0 * math.exp(-y[1] / 15.0)) / INERTIA]  # noqa: E731
    turned, speed = solve_ivp(rates, (0.0, 0.8), [0.0, 0.0], method="DOP853", rtol=RTOL, atol=1e-14).y[:, -1]
    assert found.status[0] == Verdict.OK
    for name, value in (("go.angle", turned), ("go.final_speed", speed)):
        assert abs(found.summaries[name][0] - value) <= found.errors[name][0] + 1e-10 * value
    held = crank({"rubs": friction, "push": moment("6 N m")}, {"go": {"type": "run", "from_speed": 0.0, "speed": 2.0}})
    assert Machine(held, ["go.angle"]).evaluate({}).status[0] == Verdict.STALLS
    # From 20 rad/s it comes to rest under 6 N·m within finite time, and stays.
    stops = {"go": {"type": "run", "from_speed": 20.0, "rest": True}}
    rest = crank({"rubs": moment("-sign(omega) * (7 N m + 5 N m * exp(-abs(omega) / (15 rad/s)))")}, stops)
    stopped = Machine(rest, ["go.time"]).evaluate({})
    ended = lambda t, y: y[0]  # noqa: E731
    ended.terminal = True
    by_hand = lambda t, y: [-(7.0 + 5.0 * math.exp(-y[0] / 15.0)) / INERTIA]  # noqa: E731
    gone = solve_ivp(by_hand, (0.0, 5.0), [20.0], events=ended, method="DOP853", rtol=RTOL, atol=1e-14)
    assert stopped.summaries["go.time"][0] == pytest.approx(gone.t[-1], rel=1e-9)


# What is restated: as it is built in, and by formula.
ON_RAM = {"on": "B", "angle": 0.0}
LOADS = {
    "fan": (
        {"type": "quadratic_drag", "on": "crank", "coefficient": 2e-3},
        moment("-2e-3 N m s2 * omega * abs(omega)"),
    ),
    "draught": (
        {"type": "quadratic_drag", "on": "crank", "coefficient": 3e-3},
        # No sum of powers as it is written.
        moment("-3e-3 N m * sign(omega) * exp(2 * log(abs(omega) / (1 rad/s)))"),
    ),
    "oil": ({"type": "linear_drag", "on": "crank", "coefficient": 0.02}, moment("-0.02 N m s * omega")),
    "rub": ({"type": "against_motion", "on": "crank", "moment": 0.3}, moment("-0.3 N m * sign(omega)")),
    "slide": ({"type": "against_motion", "force": 20.0, **ON_RAM}, "-20 N * sign(v)"),
    "air": ({"type": "quadratic_drag", "coefficient": 9.0, **ON_RAM}, "-9 N s2/m2 * v * abs(v)"),
    "grain": (
        {"type": "power_drag", "force": 50.0, "at_speed": 0.7, "exponent": 1.5, **ON_RAM},
        "-50 N * (abs(v) / (0.7 m/s))^1.5 * sign(v)",
    ),
    "cut": (
        {
            "type": "table",
            "slider": "ram",
            "measured_from": "high end",
            "over_stroke": [0.01, 0.02],
            "force": [-900.0, -500.0],
            "interpolation": "linear",
            "outside": "zero",
            "acts": "along",
            **ON_RAM,
        },
        "-900 N + 40 kN/m * (ram.from_high - 10 mm) if 10 mm < ram.from_high < 20 mm and v > 0 else 0",
    ),
}
MOTOR = {"type": "dc_motor", "on": "crank", "no_load_speed": 30.0, "stall_moment": 40.0}
REGIMES = {
    "start": {"type": "run", "off": [], "speed": 15.0},
    "work": {"type": "steady", "off": []},
    "stop": {"type": "run", "off": ["motor"], "rest": True},
}
ASKED = ["start.time", "start.angle", "work.mean_speed", "work.speed_fluctuation", "stop.time", "stop.angle"]
ASKED += ["stop.harmful_work", "work.drive.second.reaction.max", "work.input.reaction.rms"]


def told(which: int, speed: float) -> tuple[dict, dict]:
    """What a machine under all loads answers, as they are built in (0) or by formula (1)."""
    moments, forces = {"motor": MOTOR}, {}
    for name, pair in LOADS.items():
        load = {"type": "formula", "force": pair[1], **ON_RAM} if isinstance(pair[which], str) else pair[which]
        (moments if load["on"] == "crank" else forces)[name] = {**load, "role": "harmful"}
    return answers(slider_crank(moments, REGIMES, forces, speed), *ASKED)


def test_regimes_under_formulas__are_those_under_the_loads_they_restate():
    # Turning backwards, where a sign mistaken would show.
    (own, own_errors), (said, said_errors) = (told(which, -20.0) for which in (0, 1))
    for name in ASKED:
        # Cut in the same places they differ by rounding, and by the steps that follow slopes that rounding moves.
        assert abs(said[name] - own[name]) <= 1e-9 * abs(own[name]), name
        assert said_errors[name] <= 2 * own_errors[name] + 1e-9 * abs(own[name]), name


def test_machine_that_swings_back__is_resisted_on_its_way_back_too():
    """A push against a spring: the crank turns round, and viscous, dry and fan resistance turn with it."""
    formula = "-3 N m/rad * (phi if phi < pi else phi - 2 * pi) - 0.1 N m s * omega - 0.2 N m * sign(omega)"
    formula += " - 0.02 N m s2 * omega * abs(omega)"
    start = {"type": "run", "off": ["load"], "speed": 2.0}
    scene = crank(
        {"load": moment(formula), "push": moment("9 N m")}, {"start": start, "swing": {**RUN, "off": ["push"]}}
    )
    found, errors = answers(scene, "swing.angle", "swing.final_speed", "swing.speed_min", "start.angle")
    angle, speed, time = found["start.angle"], 2.0, 0.0

    def by_hand(t: float, q: float, w: float, way: float) -> float:
        return -3 * q - 0.1 * w - 0.2 * way - 0.02 * w * w * way

    # From one rest to the next, each way with the dry friction of its own.
    for way in (1.0, -1.0, 1.0, -1.0):
        rest = lambda t, y: way * y[1] if t > time + 1e-6 else 1.0  # noqa: B023, E731
        rest.terminal = True
        swing = solve_ivp(
            lambda t, y: (y[1], by_hand(t, *y, way) / INERTIA),  # noqa: B023
            (time, 1.5), (angle, speed), method="DOP853", rtol=RTOL, atol=1e-13, events=rest,
        )  # fmt: skip
        angle, speed, time = swing.y[0, -1], swing.y[1, -1], swing.t[-1]
        if time >= 1.5:
            break
        speed = 0.0
    assert found["swing.angle"] == pytest.approx(angle - found["start.angle"], abs=1e-9 + errors["swing.angle"])
    assert found["swing.final_speed"] == pytest.approx(speed, abs=1e-9 + errors["swing.final_speed"])


@pytest.mark.parametrize(
    ("formula", "words", "method"),
    [
        ("12 N m", "case 1: I constant, M constant of load (by formula)", "energy form"),
        ("3 N m s * omega", "case 2: I constant, M(ω) of load (by formula)", "energy form"),
        ("3 N m * cos(2 * phi)", "case 2: I constant, M(φ) of load (by formula)", "energy form"),
        ("3 N m * cos(2 rad/s * t)", "case 2: I constant, M(t) of load (by formula)", "time form"),
    ],
)
def test_case_of_a_formula__follows_from_what_it_depends_on(formula, words, method):
    scene = crank({"load": moment(formula)}, {"work": RUN})
    assert regime_text(Mechanics(scene)) == [("work", words, method)]


def test_steady_regime_of_a_load_of_constant_power__has_its_speed_in_closed_form():
    """A DC motor M₀ (1 − ω/ω₀) against P/ω: ω of the stable equilibrium."""
    scene = crank({"motor": MOTOR, "mill": moment("-200 W / omega")}, {"work": {"type": "steady", "off": []}})
    found, errors = answers(scene, "work.mean_speed")
    expected = 15 * (1 + math.sqrt(1 - 4 * 200 / (40 * 30)))
    assert found["work.mean_speed"] == pytest.approx(expected, abs=1e-9 + errors["work.mean_speed"])


@pytest.mark.parametrize("end", [{"time": 2.0}, {"speed": 1.0}])
def test_machine_at_rest__waits_for_a_push_that_grows(end):
    """Against dry friction of 1 N·m a push of 1.25 N·m s⁻¹ t sets off at 0.8 s."""
    scene = crank({"load": moment("1.25 N m * t / (1 s) - 1 N m * sign(omega)")}, {"work": {**RUN, "time": None} | end})
    found, _ = answers(scene, "work.final_speed", "work.time")
    if "time" in end:
        assert found["work.final_speed"] == pytest.approx(0.625 * 1.2**2 / INERTIA, rel=1e-10)
    else:
        assert found["work.time"] == pytest.approx(0.8 + math.sqrt(INERTIA / 0.625), rel=1e-10)


def test_push_that_swings__moves_a_machine_from_rest_as_its_integral_says():
    """∫ 3 sin 5t dt over 3 s: a push that is nothing at first."""
    found, errors = answers(
        crank({"load": moment("3 N m * sin(5 rad/s * t)")}, {"work": {**RUN, "time": 3.0}}), "work.final_speed"
    )
    expected = 3 / 5 / INERTIA * (1 - math.cos(15))
    assert abs(found["work.final_speed"] - expected) <= errors["work.final_speed"] + 1e-9 * expected
    assert errors["work.final_speed"] <= 1e-6 * expected


def test_short_push__is_not_stepped_over():
    """A crank creeps on by itself, and is pushed within a fiftieth of its time: ∫ M e^(−(t−t₀)²/s²) dt = √π M s."""
    start = {"type": "run", "off": ["load"], "speed": 0.01}
    pulse = moment("2 N m * exp(-((t - t0) / (0.1 s))^2)", numbers={"t0": "1 s"})
    regimes = {"start": start, "work": {**RUN, "off": ["push"], "time": 10.0}}
    scene = crank({"load": pulse, "push": moment("9 N m")}, regimes)
    machine = Machine(scene, summaries=["work.final_speed"], varied=["moments.load.numbers.t0"])
    outcome = machine.evaluate({"moments.load.numbers.t0": np.linspace(1.0, 9.0, 40)})
    expected = 0.01 + math.sqrt(math.pi) * 2.0 * 0.1 / INERTIA
    off = np.abs(outcome.summaries["work.final_speed"] - expected)
    assert (off <= outcome.errors["work.final_speed"] + 1e-9).all()


def test_instant_that_varies__is_met_by_each_variant():
    """A push that sets in at a time of each variant's own, on a machine that it finds at rest."""
    scene = crank({"load": moment("2 N m if t > t0 else 0", numbers={"t0": "0.5 s"})}, {"work": RUN})
    begins = np.array([0.0, 0.1234, 0.5, 1.4999, 2.0])
    machine = Machine(scene, summaries=["work.final_speed", "work.angle"], varied=["moments.load.numbers.t0"])
    outcome = machine.evaluate({"moments.load.numbers.t0": begins})
    assert (outcome.status == Verdict.OK).all()
    pushed = np.maximum(1.5 - begins, 0.0)
    np.testing.assert_allclose(outcome.summaries["work.final_speed"], 2 * pushed / INERTIA, rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(outcome.summaries["work.angle"], pushed**2 / INERTIA, rtol=1e-9, atol=1e-11)
