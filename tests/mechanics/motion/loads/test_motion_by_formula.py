"""Loads by formula in true motion: as the loads that they restate, and against a general integrator at 1e-12."""

import math
from collections.abc import Callable, Iterable
from itertools import pairwise

import machines
import numpy as np
import pytest
from motion_scenes import crank_alone
from scipy.integrate import solve_ivp

from engine import Machine, Outcome, Scene, Verdict
from engine.mechanism.mechanics import Mechanics
from engine.motion.cases import regime_text

INERTIA = 0.4
RTOL = 1e-12


def moment(formula: str, **more: object) -> dict:
    return {"type": "formula", "on": "crank", "moment": formula, **more}


def crank(moments: dict, regimes: dict) -> dict:
    """A crank alone, I = 0.4 kg·m²; only the moments that a regime names act in it."""
    regimes = {name: only(names, moments) | regime for name, (names, regime) in regimes.items()}
    return crank_alone(INERTIA, moments, regimes, 20.0)


def only(names: list[str], actions: Iterable[str]) -> dict:
    return {"off": [action for action in actions if action not in names]}


def turned_until(
    by_hand: Callable[[float, float, float], float], begin: float, angle: float, speed: float, end: float
) -> tuple[float, float]:
    """Angle and speed of I ε = M(t, φ, ω) from one time to another."""

    def rates(t: float, y: np.ndarray) -> tuple[float, float]:
        return y[1], by_hand(t, *y) / INERTIA

    found = solve_ivp(rates, (begin, end), (angle, speed), method="DOP853", rtol=RTOL, atol=1e-13)
    return found.y[0, -1], found.y[1, -1]


COURSES = {
    "powers": (
        "6 N m - 0.02 N m s * omega - 1e-3 N m s2 * omega * abs(omega) - 1e-3 N m * (abs(omega) / (1 rad/s))^1.5",
        lambda t, q, w: 6 - 0.02 * w - 1e-3 * w * abs(w) - 1e-3 * abs(w) ** 1.5,
    ),
    "angle": (
        "2 N m + 3 N m * sin(2 * phi) - (0.1 N m s * omega if phi > 1 and phi < 4 else 0)",
        lambda t, q, w: 2 + 3 * math.sin(2 * q) - (0.1 * w if 1 < q % (2 * math.pi) < 4 else 0.0),
    ),
    "falling_angle": (
        "k * (phi - 3) - 0.05 N m s * omega + 4 N m",
        lambda t, q, w: 0.7 * (q % (2 * math.pi) - 3) - 0.05 * w + 4,
    ),
    "time": (
        "5 N m * exp(-t / (1 s)) * cos(3 rad/s * t) + (2 N m if t > 0.7 s else 0) - 0.02 N m s * omega",
        lambda t, q, w: 5 * math.exp(-t) * math.cos(3 * t) + (2 if t > 0.7 else 0) - 0.02 * w,
    ),
    "per_speed": ("60 W / omega - 0.1 N m s * omega", lambda t, q, w: 60 / w - 0.1 * w),
    "speed_angle_and_time": (
        "9 N m * sin(phi) / (1 + omega / (10 rad/s)) + 1 N m * cos(omega * t)",
        lambda t, q, w: 9 * math.sin(q) / (1 + w / 10) + math.cos(w * t),
    ),
}


MOTOR = {"type": "dc_motor", "on": "crank", "no_load_speed": 30.0, "stall_moment": 40.0}
MOMENTS = {name: moment(formula) for name, (formula, _) in COURSES.items()} | {
    "falling_angle": moment(COURSES["falling_angle"][0], numbers={"k": "0.7 N m/rad"}),
    "push": moment("push", numbers={"push": "9 N m"}),
    # Stribeck's friction, 7 N·m at rest and 2 N·m when fast, and one of 12 N·m at rest.
    "rubs": moment("-sign(omega) * (2 N m + 5 N m * exp(-abs(omega) / (15 rad/s)))"),
    "stops": moment("-sign(omega) * (7 N m + 5 N m * exp(-abs(omega) / (15 rad/s)))"),
    "spring": moment(
        "-3 N m/rad * (phi if phi < pi else phi - 2 * pi) - 0.1 N m s * omega - 0.2 N m * sign(omega)"
        " - 0.02 N m s2 * omega * abs(omega)"
    ),
    "grows": moment("1.25 N m * t / (1 s) - 1 N m * sign(omega)"),
    "swings": moment("3 N m * sin(5 rad/s * t)"),
    "pulse": moment("2 N m * exp(-((t - t0) / (0.1 s))^2)", numbers={"t0": "1 s"}),
    "sets_in": moment("2 N m if t > t0 else 0", numbers={"t0": "0.5 s"}),
    "motor": MOTOR,
    "mill": moment("-200 W / omega"),
}
FROM_REST = {"type": "run", "from_speed": 0.0, "from_angle": 0.0}


def pushed_before(name: str, speed: float, time: float) -> dict:
    """A run under a formula after one to a speed under a constant push; the clock goes on."""
    to_speed = FROM_REST | {"speed": speed}
    return {f"to_{name}": (["push"], to_speed), f"under_{name}": ([name], {"type": "run", "time": time})}


REGIMES = (
    {
        "letting_go": (["rubs", "push"], FROM_REST | {"time": 0.8}),
        "letting_go_or_not": (["rubs", "push"], FROM_REST | {"speed": 2.0}),
        "stopping": (["stops"], FROM_REST | {"from_speed": 20.0, "rest": True}),
        "waiting": (["grows"], FROM_REST | {"time": 2.0}),
        "waiting_for_speed": (["grows"], FROM_REST | {"speed": 1.0}),
        "swinging": (["swings"], FROM_REST | {"time": 3.0}),
        "setting_in": (["sets_in"], FROM_REST | {"time": 1.5}),
        "milling": (["motor", "mill"], {"type": "steady"}),
    }
    | pushed_before("spring", 2.0, 1.5)
    | pushed_before("pulse", 0.01, 10.0)
)
for name in COURSES:
    REGIMES |= pushed_before(name, 12.0, 1.5)
VARIED = {
    "moments.pulse.numbers.t0": np.linspace(1.0, 9.0, 5),
    "moments.sets_in.numbers.t0": np.array([0.0, 0.1234, 0.5, 1.4999, 2.0]),
    "moments.push.numbers.push": np.full(5, 9.0),
}


@pytest.fixture(scope="module")
def drum() -> Machine:
    """The drum with all formulas, which share their compiled functions."""
    runs = [name for name, (_, regime) in REGIMES.items() if regime["type"] == "run"]
    asked = [f"{name}.{quantity}" for name in runs for quantity in ("time", "angle", "final_speed")]
    scene = Scene.model_validate(crank(MOMENTS, REGIMES))
    return Machine(scene, [*asked, "milling.mean_speed"], varied=list(VARIED), positions=720)


@pytest.fixture(scope="module")
def found(drum) -> Outcome:
    outcome = drum.evaluate(VARIED)
    assert (outcome.status == Verdict.OK).all()
    return outcome


def check(found: Outcome, name: str, expected: float | np.ndarray, roughly: float) -> None:
    """A number is what it should be within its error estimate and a share that the reference misses."""
    off = np.abs(found.summaries[name] - expected)
    assert (off <= found.errors[name] + roughly * np.abs(expected)).all(), (name, off)
    assert (found.errors[name] <= 1e-6 * np.abs(expected) + 1e-9).all(), name


@pytest.mark.parametrize("name", COURSES)
def test_run_under_a_formula__goes_as_a_general_integrator_does(found, name):
    _, by_hand = COURSES[name]
    # A constant moment from rest: ω²/2 = M φ / I. The clock goes on from one regime to the next.
    begin, clock = 12.0**2 / 2 * INERTIA / 9.0, 12.0 * INERTIA / 9.0
    check(found, f"to_{name}.angle", begin, 1e-12)
    angle, speed = begin, 12.0
    # In pieces between instants at which the moment jumps, and so short that an angle at which it does is met closely.
    smooth = [0.0, 0.7 - clock, 0.7 - clock + 1e-12, 1.5] if name == "time" else [0.0, 1.5]
    ends = np.linspace(0.0, 1.5, 301) if "angle" in name else smooth
    for first, last in pairwise(ends):
        angle, speed = turned_until(by_hand, clock + first, angle, speed, clock + last)
    # Jumps over the angle cost the reference what its step control makes of them.
    rough = 1e-7 if "angle" in name else 1e-10
    check(found, f"under_{name}.angle", angle - begin, rough)
    check(found, f"under_{name}.final_speed", speed, rough)


def test_friction_by_formula__holds_what_is_at_rest_and_lets_go(drum, found):
    """From rest under friction of 7 N·m, 2 N·m when fast: 9 N·m set a drum going, 6 N·m don't."""
    rates = lambda t, y: [y[1], (7.0 - 5.0 * math.exp(-y[1] / 15.0)) / INERTIA]  # noqa: E731
    turned, speed = solve_ivp(rates, (0.0, 0.8), [0.0, 0.0], method="DOP853", rtol=RTOL, atol=1e-14).y[:, -1]
    check(found, "letting_go.angle", turned, 1e-10)
    check(found, "letting_go.final_speed", speed, 1e-10)
    held = drum.evaluate({path: values[:1] for path, values in VARIED.items()} | {"moments.push.numbers.push": [6.0]})
    assert held.status[0] == Verdict.STALLS
    # From 20 rad/s it comes to rest within finite time, and stays.
    ended = lambda t, y: y[0]  # noqa: E731
    ended.terminal = True
    by_hand = lambda t, y: [-(7.0 + 5.0 * math.exp(-y[0] / 15.0)) / INERTIA]  # noqa: E731
    gone = solve_ivp(by_hand, (0.0, 5.0), [20.0], events=ended, method="DOP853", rtol=RTOL, atol=1e-14)
    check(found, "stopping.time", gone.t[-1], 1e-9)


def test_machine_that_swings_back__is_resisted_on_its_way_back_too(found):
    """A push against a spring: the crank turns round, and viscous, dry and fan resistance turn with it."""
    begin = 2.0**2 / 2 * INERTIA / 9.0
    angle, speed, time = begin, 2.0, 0.0

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
    check(found, "under_spring.angle", angle - begin, 1e-8)
    check(found, "under_spring.final_speed", speed, 1e-8)


def test_steady_regime_of_a_load_of_constant_power__has_its_speed_in_closed_form(found):
    """A DC motor M₀ (1 − ω/ω₀) against P/ω: ω of the stable equilibrium."""
    check(found, "milling.mean_speed", 15 * (1 + math.sqrt(1 - 4 * 200 / (40 * 30))), 1e-10)


def test_machine_at_rest__waits_for_a_push_that_grows(found):
    """Against dry friction of 1 N·m a push of 1.25 N·m s⁻¹ t sets off at 0.8 s."""
    check(found, "waiting.final_speed", 0.625 * 1.2**2 / INERTIA, 1e-10)
    check(found, "waiting_for_speed.time", 0.8 + math.sqrt(INERTIA / 0.625), 1e-10)


def test_push_that_swings__moves_a_machine_from_rest_as_its_integral_says(found):
    """∫ 3 sin 5t dt over 3 s: a push that is nothing at first."""
    check(found, "swinging.final_speed", 3 / 5 / INERTIA * (1 - math.cos(15)), 1e-9)


def test_short_push__is_not_stepped_over(found):
    """A crank creeps on by itself, and is pushed within a fiftieth of its time: ∫ M e^(−(t−t₀)²/s²) dt = √π M s."""
    check(found, "under_pulse.final_speed", 0.01 + math.sqrt(math.pi) * 2.0 * 0.1 / INERTIA, 1e-9)


def test_instant_that_varies__is_met_by_each_variant(found):
    """A push that sets in at a time of each variant's own, on a machine that it finds at rest."""
    pushed = np.maximum(1.5 - VARIED["moments.sets_in.numbers.t0"], 0.0)
    check(found, "setting_in.final_speed", 2 * pushed / INERTIA, 1e-9)
    check(found, "setting_in.angle", pushed**2 / INERTIA, 1e-9)


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
ASKED = ["start.time", "start.angle", "work.mean_speed", "work.speed_fluctuation", "stop.time", "stop.angle"]
ASKED += ["stop.harmful_work", "work.drive.second.reaction.max", "work.input.reaction.rms"]


def test_regimes_under_formulas__are_those_under_the_loads_they_restate():
    """One machine with all loads as they are built in and by formula, and regimes for either kind."""
    moments, forces, regimes = {"motor": MOTOR}, {}, {}
    for name, (own, formula) in LOADS.items():
        said = {"type": "formula", "force": formula, **ON_RAM} if isinstance(formula, str) else formula
        table = moments if own["on"] == "crank" else forces
        table |= {f"own_{name}": own | {"role": "harmful"}, f"said_{name}": said | {"role": "harmful"}}
    for kind in ("own", "said"):
        acting = [name for name in (*moments, *forces) if name.startswith(kind)]
        regimes |= {
            f"{kind}_start": (["motor", *acting], FROM_REST | {"speed": 15.0}),
            f"{kind}_work": (["motor", *acting], {"type": "steady"}),
            f"{kind}_stop": (acting, {"type": "run", "rest": True}),
        }
    # Turning backwards, where a sign mistaken would show.
    scene = crank(moments, {}) | machines.slider_crank(speed=-20.0, group="drive", forces=forces)
    scene["regimes"] = {name: only(names, [*moments, *forces]) | regime for name, (names, regime) in regimes.items()}
    scene["bodies"]["ram_body"] = {"link": "ram", "mass": 3.0}
    asked = [f"{kind}_{name}" for kind in ("own", "said") for name in ASKED]
    outcome = Machine(Scene.model_validate(scene), asked, positions=720).evaluate({})
    assert outcome.status[0] == Verdict.OK
    for name in ASKED:
        (own, own_error), (said, said_error) = (
            (outcome.summaries[f"{kind}_{name}"][0], outcome.errors[f"{kind}_{name}"][0]) for kind in ("own", "said")
        )
        # Cut in the same places they differ by rounding, and by the steps that follow slopes that rounding moves.
        assert abs(said - own) <= 1e-9 * abs(own), name
        assert said_error <= 2 * own_error + 1e-9 * abs(own), name


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
    scene = crank({"load": moment(formula)}, {"work": (["load"], {"type": "run", "time": 1.5})})
    assert regime_text(Mechanics(Scene.model_validate(scene))) == [("work", words, method)]


@pytest.mark.parametrize("friction", [{}, {"pivot": {"pair": "input", "coefficient": 0.1, "diameter": 0.02}}])
def test_loads_that_jump_almost_together__are_one_jump_on_later_turns(friction):
    # The angles differ by several roundings on the first turn, and by less than one on the next.
    jump = moment("-3 N m if phi > at else 0 N m", numbers={"at": 0.04})
    motor = {"type": "dc_motor", "on": "crank", "no_load_speed": 20.0, "stall_moment": 40.0}
    regimes = {"go": ("motor one two", {"type": "run", "cycles": 3})}
    scene = crank({"motor": motor, "one": jump, "two": jump}, regimes) | {"friction": friction}
    asked = ["go.final_speed", "go.work_residual"]
    machine = Machine(Scene.model_validate(scene), asked, varied="moments.two.numbers.at")
    found = machine.evaluate({"moments.two.numbers.at": np.array([0.04, 0.04 + 1e-16])})
    assert list(found.status) == [Verdict.OK] * 2
    (same, almost), off = found.summaries["go.final_speed"], found.errors["go.final_speed"]
    assert abs(almost - same) <= off.sum()
    assert off.max() < 1e-6
    assert (np.abs(found.summaries["go.work_residual"]) <= found.errors["go.work_residual"]).all()
