"""The five cases recognised from scenes, and runs with constant inertia against quadrature by mpmath."""

import math
from itertools import pairwise, product

import mpmath
import numpy as np
import pytest
from exact import EPS
from machines import slider_crank
from motion_scenes import crank_alone
from mpmath import mpf
from mpmath.calculus.quadrature import GaussLegendre

from engine import Machine, Scene, Verdict
from engine.mechanism.mechanics import Mechanics
from engine.motion.cases import regime_text
from engine.scene.scene import Numbers, scene_numbers

INERTIA = 0.4
COURSE = ["time", "angle", "final_speed", "speed_min", "speed_max"]
MOTORS = ["motor_moment_peak", "motor_moment_rms", "motor_power", "motor_work"]
LOADS = ["driving_work", "useful_work", "harmful_work", "brake_heat", "other_work", "efficiency"]
QUANTITIES = [*COURSE, *MOTORS, *LOADS, "energy_change", "work_residual"]

DC = {"type": "dc_motor", "on": "crank", "no_load_speed": 100.0, "stall_moment": 20.0}
INDUCTION = {
    "type": "induction_motor",
    "on": "fast",
    "synchronous_speed": 300.0,
    "power": 3000.0,
    "rated_speed": 285.0,
    "breakdown_ratio": 2.6,
    "starting_ratio": 2.0,
}
BRAKE = {"type": "block_brake", "on": "crank", "force": 20.0, "friction": 0.2, "radius": 0.1, "blocks": 2}
PUSH = {"type": "constant", "on": "crank", "moment": 6.0, "role": "driving"}
RUB = {"type": "against_motion", "on": "crank", "moment": 1.0, "role": "useful"}
OIL = {"type": "linear_drag", "on": "crank", "coefficient": 0.02}
FAN = {"type": "quadratic_drag", "on": "crank", "coefficient": 0.0005}
GRAIN = {"type": "power_drag", "on": "crank", "moment": 2.0, "at_speed": 10.0, "exponent": 1.5}
KICK = {
    "type": "table",
    "on": "crank",
    "over_time": [0.0, 1.0, 2.0, 2.0, 5.0],
    "moment": [4.0, 10.0, 6.0, 2.0, 0.5],
    "interpolation": "linear",
    "role": "driving",
}
TURN = {"type": "table", "on": "crank", "over_angle": [0.0, 3.0], "moment": [1.0, -1.0], "interpolation": "spline"}


ACTIONS = {"dc": DC, "induction": INDUCTION, "brake": BRAKE, "push": PUSH, "rub": RUB, "oil": OIL, "fan": FAN}
ACTIONS |= {"grain": GRAIN, "kick": KICK, "again": KICK, "turn": TURN}


def crank(moments, regimes, speed=100.0, **more):
    """A crank alone and a fast shaft, nothing that swings: I = 0.4 kg·m²."""
    shafts = {"fast": {"geared_to": "crank", "ratio": 3.0, "inertia": 0.02}}
    return crank_alone(0.22, moments, regimes, speed, shafts=shafts, **more)


def with_ram(moments, regimes):
    scene = crank(moments, regimes, gravity=9.81) | slider_crank(0.1, 0.4, 100.0)
    scene["bodies"]["ram_body"] = {"link": "ram", "mass": 2.0}
    return scene


def asked(scene, varied=None, positions=240):
    """Every quantity of every regime, its error estimate, and the verdicts."""
    scene, varied = Scene.model_validate(scene), varied or {}
    names = [f"{regime}.{quantity}" for regime in scene.regimes for quantity in QUANTITIES]
    machine = Machine(scene, summaries=names, varied=varied, positions=positions)
    return machine.evaluate(varied)


# Brakes


def test_band_brake_that_nearly_locks_itself__has_errors_of_its_torque():
    """There the tensions' moments about the fulcrum cancel, and their rounding shows in the torque."""
    share = 1.0 - 10.0 ** -np.linspace(0.5, 9.0, 60)
    band = {"type": "band_brake", "on": "crank", "force": 1e-3, "lever_arm": 0.5, "slack_arm": 0.1, "radius": 0.1}
    band |= {"friction": 0.3, "wrap": 4.0}
    scene = crank({"brake": band}, {"stop": {"type": "run", "from_speed": 10.0, "rest": True}})
    arms = -0.1 * math.exp(-0.3 * 4.0) * share
    outcome = asked(scene, {"moments.brake.tight_arm": arms})
    assert (outcome.status == Verdict.OK).all()
    with mpmath.workdps(30):
        growth = mpmath.exp(mpf(0.3) * mpf(4.0))
        for k, arm in enumerate(arms):
            moment = mpf(1e-3) * mpf(0.5) * mpf(0.1) * (growth - 1) / (mpf(0.1) + mpf(float(arm)) * growth)
            for name, true in (("time", INERTIA * 10.0 / moment), ("angle", INERTIA * 50.0 / moment)):
                value, error = (float(rows[f"stop.{name}"][k]) for rows in (outcome.summaries, outcome.errors))
                assert abs(value - float(true)) <= error, (name, share[k])
                assert error <= 1e-14 / (1.0 - share[k]) * float(true) + 1e-8 * float(true)


# Which case


def acting(*names, steady=False, **end):
    """A regime in which only some actions act."""
    off = sorted(set(ACTIONS) - set(names))
    return {"type": "steady", "off": off} if steady else {"type": "run", "off": off, **(end or {"speed": 50.0})}


# Regime, case of a machine with constant I, and of one with I(φ).
CASES = [
    (acting(), "1: I constant, no moment", 3),
    (acting("brake", rest=True), "1: I constant, M constant of brake (block brake)", 3),
    (acting("push", "rub", cycles=2.0), "1: I constant, M constant of push (constant) and rub (against motion)", 3),
    (acting("dc", "rub", "oil", time=2.0), "2: I constant, M(ω) of dc (DC motor) and oil (viscous resistance)", 5),
    (acting("push", "fan"), "2: I constant, M(ω) of fan (resistance by ω²)", 5),
    (acting("oil", "fan"), "2: I constant, M(ω) of oil (viscous resistance) and fan (resistance by ω²)", 5),
    (acting("grain"), "2: I constant, M(ω) of grain (resistance by a power of ω)", 5),
    (acting("induction", "rub"), "2: I constant, M(ω) of induction (induction motor)", 5),
    (acting("induction", "rub", time=1.0), "2: I constant, M(ω) of induction (induction motor)", 5),
    (acting("induction", "oil"), "2: I constant, M(ω) of induction (induction motor) and oil (viscous resistance)", 5),
    (acting("dc", steady=True), "2: I constant, M(ω) of dc (DC motor)", 5),
    (acting("turn"), "2: I constant, M(φ) of turn (table)", 3),
    (acting("kick", "rub", time=3.0), "2: I constant, M(t) of kick (table)", 5),
    (acting("kick"), "2: I constant, M(t) of kick (table)", 5),
    (acting("kick", "again", time=3.0), "2: I constant, M(t) of kick (table) and again (table)", 5),
    (acting("dc", "turn"), "4: I constant, M(φ, ω) of dc (DC motor) and turn (table)", 5),
    (acting("kick", "dc", time=1.0), "4: I constant, M(ω, t) of dc (DC motor) and kick (table)", 5),
    (acting("kick", "dc", "turn"), "4: I constant, M(φ, ω, t) of dc (DC motor), kick (table) and turn (table)", 5),
]


def method_of(regime):
    return "energy form" if "kick" in regime["off"] else "time form"


def test_cases__of_a_machine_with_constant_inertia_and_of_one_whose_inertia_varies():
    regimes = {f"r{i}": regime for i, (regime, *_) in enumerate(CASES)}
    same, varies = (regime_text(Mechanics(Scene.model_validate(of(ACTIONS, regimes)))) for of in (crank, with_ram))
    for one, other, (regime, sentence, number) in zip(same, varies, CASES, strict=True):
        assert one[1:] == (f"case {sentence}", method_of(regime))
        assert other[1].startswith(f"case {number}: I(φ), ")
        assert other[2] == method_of(regime)
    assert [name for name, *_ in same] == list(regimes)


@pytest.mark.parametrize(("x", "number"), [(0.0, 1), (0.01, 2)])
def test_gravity__acts_on_an_eccentric_rotor_only(x, number):
    scene = crank({}, {"go": {"type": "run", "cycles": 1.0}}, gravity=9.81)
    scene["bodies"]["rotor"]["x"] = x
    ((_, sentence, _),) = regime_text(Mechanics(Scene.model_validate(scene)))
    assert sentence == ("case 1: I constant, no moment" if number == 1 else "case 2: I constant, M(φ) of gravity")


def test_shaft_geared_to_a_shaft__leaves_inertia_constant():
    scene = crank({"rub": RUB}, {"go": {"type": "run", "cycles": 1.0}})
    scene["shafts"]["faster"] = {"geared_to": "fast", "ratio": -2.0, "inertia": 0.01}
    ((_, sentence, _),) = regime_text(Mechanics(Scene.model_validate(scene)))
    assert sentence.startswith("case 1: I constant")


# Runs against quadrature

ENDS = {"until": {"speed": 60.0}, "lasting": {"time": 0.7}, "turning": {"cycles": 4.0}}


def runs(begin, *names, **ends):
    return {name: acting(*names, from_speed=begin, **end) for name, end in (ends or ENDS).items()}


def kloss(speed, constants):
    most, slip_b, rotor, synchronous, ratio = constants
    s = 1 - ratio * speed / synchronous
    return ratio * most * (2 + rotor * slip_b) / (s / slip_b + slip_b / s + rotor * slip_b)


def references(begin, end, motor, loads):
    """Quantities of a run between two speeds: integrals over ω of the equation of motion, dt = I dω/M."""
    with mpmath.workdps(30):
        ends = [mpf(begin) + (mpf(end) - begin) * k / 4 for k in range(5)]
        # With 24 nodes in each quarter Gauss–Legendre quadrature agrees with an adaptive one to the digits of a float.
        rule = GaussLegendre(mpmath.mp)
        nodes = [node for piece in pairwise(ends) for node in rule.get_nodes(*piece, 4, mpmath.mp.prec)]
        of_motor = [motor(w) for w, _ in nodes]
        of_loads = {role: [load(w) for w, _ in nodes] for role, load in loads.items()}
        totals = map(sum, zip(of_motor, *of_loads.values(), strict=True))
        times = [weight * mpf(INERTIA) / total for (_, weight), total in zip(nodes, totals, strict=True)]
        turns = [time * w for time, (w, _) in zip(times, nodes, strict=True)]
        found = {"time": sum(times), "angle": sum(turns), "motor_work": mpmath.fdot(turns, of_motor)}
        found["motor_moment_rms"] = mpmath.sqrt(mpmath.fdot(times, (m**2 for m in of_motor)) / found["time"])
        found["motor_power"] = found["motor_work"] / found["time"]
        signs = {"driving": 1, "other": 1, "useful": -1, "harmful": -1, "braking": -1}
        for role, load in of_loads.items():
            name = "brake_heat" if role == "braking" else f"{role}_work"
            found[name] = signs[role] * mpmath.fdot(turns, load)
        supplied = found["motor_work"] + found.get("driving_work", 0)
        if supplied > 0 and "useful_work" in found:
            found["efficiency"] = found["useful_work"] / supplied
        found["energy_change"] = mpf(INERTIA) * (mpf(end) ** 2 - mpf(begin) ** 2) / 2
        found["speed_min"], found["speed_max"] = sorted([mpf(begin), mpf(end)])
        found["motor_moment_peak"] = np.max(np.abs(motor(np.linspace(begin, end, 4001))))
        return {name: float(value) for name, value in found.items()}


def constant(value):
    return lambda w: mpf(value)


def none(w):
    return mpf(0)


PUSHED = {"driving": constant(6), "useful": constant(-1)}
# Which actions, the motor's moment, and the loads by role; two blocks with 20 N, f = 0.2, R = 0.1 m brake by 0.8 N·m.
LAWS = {
    "constant": (("push", "rub", "brake"), none, {**PUSHED, "braking": constant("-0.8")}),
    "linear": (
        ("dc", "rub", "oil"),
        lambda w: 20 * (1 - w / 100),
        {"useful": constant(-1), "harmful": lambda w: -mpf(0.02) * w},
    ),
    "motor_and_fan": (("dc", "fan"), lambda w: 20 * (1 - w / 100), {"harmful": lambda w: -mpf(0.0005) * w * w}),
    "fan": (("push", "rub", "fan"), none, {**PUSHED, "harmful": lambda w: -mpf(0.0005) * w * w}),
}


@pytest.mark.parametrize(("begin", "way"), [(20.0, 1.0), (20.0, -1.0), (0.0, 1.0)])
def test_runs_with_constant_inertia__are_the_quadrature(begin, way):
    moments = {**ACTIONS, "push": {**PUSH, "moment": math.copysign(6.0, way)}}
    regimes = {f"{law}_{end}": regime for law, (n, *_) in LAWS.items() for end, regime in runs(begin, *n).items()}
    outcome = asked(crank(moments, regimes, speed=way * 100.0))
    assert outcome.status == [Verdict.OK]
    for law, end in product(LAWS, ENDS):
        _, motor, loads = LAWS[law]
        regime = f"{law}_{end}"
        last, unsure = (part[f"{regime}.final_speed"][0] for part in (outcome.summaries, outcome.errors))
        found, beside = (references(begin, speed, motor, loads) for speed in (last, last - unsure))
        for name, value in found.items():
            got, figure = (part[f"{regime}.{name}"][0] for part in (outcome.summaries, outcome.errors))
            # The reference is taken to the speed that was found, right to its own error estimate.
            figure += abs(value - beside[name]) + 40 * EPS * abs(value)
            assert abs(got - value) <= figure, (regime, name, got, value, figure)
        key, goal = next(iter(ENDS[end].items()))
        name = {"speed": "final_speed", "time": "time", "cycles": "angle"}[key]
        expected = 2 * math.pi * goal if key == "cycles" else goal
        assert outcome.summaries[f"{regime}.{name}"][0] == pytest.approx(expected, rel=2 * EPS)


@pytest.mark.parametrize(("begin", "end"), [(0.0, 60.0), (20.0, 94.0), (99.9, 99.89), (120.0, 101.0)])
def test_run_of_an_induction_motor__is_the_quadrature(begin, end):
    data = crank(ACTIONS, runs(begin, "induction", "rub", go={"speed": end}))
    outcome, scene = asked(data), Scene.model_validate(data)
    assert outcome.status == [Verdict.OK]
    numbers = Numbers(scene_numbers(scene), {})
    constants = [mpf(float(c)) for c in scene.moments["induction"].curve("moments.induction", numbers).constants[0]]
    found = references(begin, end, lambda w: kloss(w, (*constants, mpf(3))), {"useful": constant(-1)})
    for name, value in found.items():
        got, figure = (part[f"go.{name}"][0] for part in (outcome.summaries, outcome.errors))
        allowed = figure + 100 * EPS * abs(value)
        if name == "motor_moment_peak":
            # Of 4001 speeds one is nearer to the breakdown than a thousandth: its moment is less by a millionth or so.
            allowed = 1e-6 * value
        elif name == "energy_change":
            # A difference of two energies.
            allowed += 4 * EPS * INERTIA * max(begin, end) ** 2
        assert abs(got - value) <= allowed, (name, got, value, figure)


def test_error_figures__hold_near_the_final_speed():
    # The nearer to the final speed, the less certain is the time to it: the moment cancels.
    shares = 1.0 - np.geomspace(1e-1, 1e-12, 40)
    scene = crank(ACTIONS, runs(0.0, "dc", "oil", go={"speed": 1.0}))
    with mpmath.workdps(40):
        final = mpf(20) / (mpf(20) / 100 + mpf(0.02))
        speeds = np.array([float(final * share) for share in shares])
        exact = [float(mpf(INERTIA) / (mpf(20) / 100 + mpf(0.02)) * -mpmath.log(1 - mpf(w) / final)) for w in speeds]
    outcome = asked(scene, {"regimes.go.speed": speeds})
    error = np.abs(outcome.summaries["go.time"] - exact)
    assert (error <= outcome.errors["go.time"]).all()
    # And they say no more than a hundred times what the moment's last digit does, and what the steps may miss.
    most = 100 * EPS * (np.array(exact) + INERTIA / 0.22 / (1.0 - shares)) + 1e-10 * np.array(exact)
    assert (outcome.errors["go.time"] <= most).all()


@pytest.mark.parametrize(
    ("names", "end", "verdict"),
    [
        (("dc", "rub"), {"speed": 10.0}, Verdict.STALLS),
        (("dc", "oil"), {"speed": 95.0, "at_most": 50.0}, Verdict.NO_END),
        (("push",), {"cycles": 60.0, "at_most": 50.0}, Verdict.NO_END),
        (("fan",), {"speed": 10.0, "at_most": 50.0, "from_speed": 5.0}, Verdict.NO_END),
    ],
)
def test_run_that_does_not_end__says_so(names, end, verdict):
    # Friction holds more than the 20 N·m of the motor at rest.
    scene = crank(ACTIONS | {"rub": RUB | {"moment": 21.0}}, {"go": acting(*names, **end)})
    assert asked(scene).status == [verdict]


# Moment over time


def test_moment_over_time__is_its_impulse():
    """It jumps at its first row and at 2 s, and ends at 5 s; the clock goes on from one regime to the next."""
    kick = KICK | {"over_time": [0.5, 1.0, 2.0, 2.0, 5.0], "outside": "zero"}
    regimes = {"first": {"type": "run", "from_speed": 8.0, "time": 2.7}, "second": {"type": "run", "time": 3.5}}
    outcome, speed = asked(crank({"kick": kick}, regimes)), 8.0
    # Of straight lines between 4, 10 and 6, and between 2 and 0.5 N·m, which is 1.65 N·m at 2.7 s.
    for name, impulse in (("first", 0.5 * 7.0 + 8.0 + 0.7 * 1.825), ("second", 2.3 * 1.075)):
        before, speed = speed, speed + impulse / INERTIA
        for key, value in (("final_speed", speed), ("driving_work", INERTIA * (speed**2 - before**2) / 2)):
            got, figure = (part[f"{name}.{key}"][0] for part in (outcome.summaries, outcome.errors))
            assert abs(got - value) <= figure + 200 * EPS * abs(value), (name, key, got, value)
            assert figure <= 2e-12 * max(abs(value), 100.0)
