"""Steady motion: against long runs and finite differences, with flat motors, and the flywheel in it."""

import math

import numpy as np
import pytest
from exact import top_between
from motion_scenes import CUT, ask, crank_on_dc_motor, rotor, run, slider_crank, steady
from scipy.integrate import solve_ivp

from engine import Machine, Scene, Verdict

# What acts, and the flywheel.
MACHINES = {
    "DC motor, cutting": ("dc fan gravity cut", 0.2),
    "induction motor, constant load": ("induction load gravity", 2.0),
    "constant drive and fan": ("push fan gravity", 0.1),
    "engine with fan": ("fan", 0.2),
}
GAS = {"type": "two_stroke", "piston": "ram", "bore": 0.06, "clearance": 0.15, "port": 0.8}
GAS |= {"intake": 1.0e5, "exhaust": 1.05e5, "peak": 2.5e6}


def scene_of(name: str, regimes: dict) -> dict:
    only, flywheel = MACHINES[name]
    scene = slider_crank({k: regime | {"only": only} for k, regime in regimes.items()}, flywheel=flywheel)
    return scene | ({"cylinders": {"gas": GAS}} if "engine" in name else {})


@pytest.mark.parametrize("name", MACHINES)
def test_steady_motion__is_the_limit_of_a_long_run(name):
    found = ask(scene_of(name, {"on": steady("")}), "on.multiplier on.mean_speed on.period", 240, "on.speed")
    multiplier, at_zero = found["on.multiplier"], float(found.fields["on.speed"][0, 0])
    assert 0.0 < multiplier < 1.0
    # From a speed that is off by a twentieth; what is left of it after so many cycles is below 1e-10.
    cycles = math.ceil(math.log(1e-10) / math.log(multiplier)) + 1
    long = ask(scene_of(name, {"go": run("", from_speed=0.95 * at_zero, cycles=cycles)}), "go.final_speed", 960)
    # They differ by what is left, and by the error of the run: of order four, about (2 pi/960)^4/180 = 1e-11 of the
    # fluctuation where a moment jumps or bends.
    assert long["go.final_speed"] == pytest.approx(at_zero, rel=1e-9)
    once = ask(scene_of(name, {"go": run("", from_speed=at_zero, cycles=1.0)}), "go.time go.final_speed", 960)
    assert once["go.time"] == pytest.approx(found["on.period"], rel=1e-9)
    assert found["on.mean_speed"] == pytest.approx(2 * math.pi / once["go.time"], rel=1e-9)


@pytest.mark.parametrize("name", MACHINES)
def test_multiplier__is_the_slope_of_the_return_map(name):
    found = ask(scene_of(name, {"on": steady("")}), "on.multiplier", 480, "on.speed")
    at_zero = float(found.fields["on.speed"][0, 0])

    def after(share: float) -> float:
        scene = scene_of(name, {"go": run("", from_speed=at_zero * (1 + share), cycles=1.0)})
        return ask(scene, "go.final_speed", 480)["go.final_speed"] ** 2

    share = 1e-4
    energies = at_zero**2 * ((1 + share) ** 2 - (1 - share) ** 2)
    slope = (after(share) - after(-share)) / energies
    # Central difference: share² of curvature; the multiplier's trapezoids: h²/12 = 1.4e-5 beside breaks.
    assert found["on.multiplier"] == pytest.approx(slope, rel=1e-5, abs=1e-9)


def test_cycle_of_just_as_many_steps_as_are_kept__is_that_of_the_machine_alone():
    """6 s: a ripple that makes a cycle take about 160 steps, at an accuracy near rounding."""
    scene = scene_of("DC motor, cutting", {"on": steady("")})
    scene["moments"]["ripple"] = {"type": "formula", "on": "crank", "moment": "-1 N m * cos(9 * phi)"}
    machine = Machine(Scene.model_validate(scene), ["on.mean_speed"], varied=["flywheel.inertia"], accuracy=1e-11)
    inertias = 0.2 * np.linspace(0.5, 3.0, 128)[:64]
    together = machine.evaluate({"flywheel.inertia": inertias}).summaries["on.mean_speed"]
    for i in (43, 44, 45):
        alone = machine.evaluate({"flywheel.inertia": inertias[i : i + 1]}).summaries["on.mean_speed"]
        assert together[i] == alone[0]


def test_no_steady_motion__stalls_and_runs_away():
    weak = ask(
        slider_crank({"on": steady("dc load")}, flywheel=1.0),
        "on.mean_speed",
        varied={"moments.dc.stall_moment": [1.0, 1.9, 2.1, 20.0]},
    )
    assert weak.status == [Verdict.STALLS, Verdict.STALLS, Verdict.OK, Verdict.OK]
    assert np.isfinite(weak.values["on.mean_speed"]).tolist() == [False, False, True, True]
    for only, verdict in (
        ("load", Verdict.STALLS),
        ("rub fan", Verdict.STALLS),
        ("push", Verdict.RUNS_AWAY),
        ("push rub", Verdict.RUNS_AWAY),
        ("push fan", Verdict.OK),
        # Without moments, or with those that give back what they take, every speed stays.
        ("", Verdict.ANY_SPEED),
        ("gravity", Verdict.ANY_SPEED),
        ("gravity oil", Verdict.STALLS),
        ("gravity push oil", Verdict.OK),
    ):
        assert ask(slider_crank({"on": steady(only)}, flywheel=0.2), "on.mean_speed").status == [verdict], only
    # Beyond the breakdown moment of 18.75 N·m.
    heavy = slider_crank({"on": steady("induction load")}, flywheel=5.0, load={"moment": -19.0})
    assert ask(heavy, "on.mean_speed").status == [Verdict.STALLS]


@pytest.mark.parametrize("no_load", [1e2, 1e5, 1e7])
def test_motor_however_flat__settles_where_its_moment_meets_the_loads(no_load):
    loads = {"load": {"moment": -25.0}, "fan": {"coefficient": 0.01}}
    scene = rotor({"on": steady("dc load fan")}, dc={"stall_moment": 40.0, "no_load_speed": no_load}, **loads)
    found = ask(scene, "on.mean_speed")
    # 40 (1 - w/w0) - 25 - 0.01 w² = 0; what is constant settles to rounding, as far as its slope tells it.
    slope = 40.0 / no_load
    speed = (math.sqrt(slope**2 + 4 * 0.01 * 15.0) - slope) / 0.02
    assert found["on.mean_speed"] == pytest.approx(speed, rel=1e-9)


def test_work_that_cancels_over_the_cycle__rounds_as_the_energy_does():
    scene = slider_crank({"on": steady("push rub gravity induction")})
    varied = {"flywheel.inertia": np.geomspace(0.02, 2.0, 48), "moments.rub.moment": np.linspace(0.1, 0.8, 48)}
    found = ask(scene, "on.other_work", varied=varied)
    # Gravity returns its work.
    assert (np.abs(found.values["on.other_work"]) <= found.errors["on.other_work"]).all()


def test_efficiency__is_undefined_where_nothing_is_supplied_but_for_rounding():
    scene = slider_crank({"on": steady("induction")})
    found = ask(scene, "on.efficiency", varied={"flywheel.inertia": np.geomspace(0.02, 2.0, 48)})
    assert np.isnan(found.values["on.efficiency"]).all()


# The flywheel in true motion


@pytest.mark.parametrize(("only", "asked"), [("dc cut fan", 0.02), ("dc cut fan", 1e-3), ("induction cut rub", 0.1)])
def test_flywheel_in_motion__gives_the_asked_fluctuation(only, asked):
    scene = slider_crank({"on": steady(only)})
    scene["flywheel"]["speed_fluctuation"] = asked
    found = ask(scene, "on.flywheel on.speed_fluctuation", 240)
    assert found["on.flywheel"] > 0.0
    fitted = ask(slider_crank({"on": steady(only)}, flywheel=found["on.flywheel"]), "on.speed_fluctuation", 240)
    # The root is found to 1e-10 of ln(I + I_F).
    assert fitted["on.speed_fluctuation"] == pytest.approx(asked, rel=1e-8)
    assert found["on.speed_fluctuation"] == pytest.approx(asked, rel=1e-8)


@pytest.mark.parametrize("times", [2.0, 16.0])
def test_flywheel_of_a_machine_that_stalls_without__is_the_lightest_that_will_do(times):
    scene = slider_crank({"on": steady("induction cut")})
    scene["flywheel"]["speed_fluctuation"] = 1.99
    scene["forces"] = {"cut": CUT | {"force": [times * force for force in CUT["force"]]}}
    found = ask(scene, "on.flywheel on.speed_fluctuation")
    wheel, figure = found["on.flywheel"], found.errors["on.flywheel"][0]
    assert 0.0 < figure < 1e-5 * wheel
    lighter = ask(scene, "on.speed_fluctuation", varied={"flywheel.inertia": [wheel, wheel - 2.0 * figure]})
    if times == 2.0:
        assert found["on.speed_fluctuation"] == pytest.approx(1.99, rel=1e-9)
        # Of a machine that nearly stops in each turn, δ changes by no more than its inertia does.
        assert 1.99 <= lighter.values["on.speed_fluctuation"][1] <= 2.0
    else:
        assert lighter.status == [Verdict.OK, Verdict.STALLS]


def test_flywheel_light_enough__is_zero():
    scene = slider_crank({"on": steady("dc fan")}, dc={"stall_moment": 1.0})
    scene["flywheel"]["speed_fluctuation"] = 1.5
    assert ask(scene, "on.flywheel")["on.flywheel"] == 0.0


# The other way round


def test_clockwise_machine__is_the_mirror_image():
    regimes = {
        "start": run("dc fan rub gravity push", speed=30.0),
        "on": steady("dc fan rub gravity push cut"),
        "stop": run("brake rub gravity load", reversal=True),
    }
    names = "start.time start.angle on.period on.speed_fluctuation on.motor_work stop.time stop.angle stop.brake_heat"
    fields = "on.speed on.acceleration on.motor_moment on.load_moment reduced_inertia"
    scene = slider_crank(regimes, flywheel=0.2)
    # About the x axis: the sense of rotation and what acts across it change their signs.
    mirrored = slider_crank(regimes, -10.0, 0.2, push={"moment": -3.0}, load={"moment": 2.0}) | {"gravity": -9.81}
    found, other = ask(scene, names, fields=fields), ask(mirrored, names, fields=fields)
    for name in names.split():
        # A jump is a piece of 2e-10 rad that has the moment of one side in its middle.
        assert other[name] == pytest.approx(found[name], rel=1e-9), name
    for name in fields.split():
        one, two = found.fields[name][0], other.fields[name][0]
        # Fields are over the crank angle: φ is −φ now.
        two = np.roll(two[::-1], 1)
        sign = 1.0 if name in ("on.speed", "reduced_inertia") else -1.0
        assert sign * two == pytest.approx(one, rel=1e-8, abs=1e-8 * np.abs(one).max()), name


def test_extremes_close_together__are_found_with_long_steps_too():
    inertia, stall, light = 0.5, 100.0, 20.0
    # Of 4000, those whose slopes at both ends of a step of a quarter turn hide a turn of the speed between.
    random, chosen = np.random.default_rng(11), [72, 97, 119, 791, 1104, 1470, 1592, 1745]
    sizes = random.uniform(1.0, 20.0, (4, 4000))[:, chosen]
    places = random.uniform(0.0, 2.0 * math.pi, (4, 4000))[:, chosen]
    waves = " + ".join(f"a{k} * cos({k} * phi + b{k})" for k in range(1, 5))
    numbers = {f"a{k}": "1 N m" for k in range(1, 5)} | {f"b{k}": "0 rad" for k in range(1, 5)}
    load = {"type": "formula", "moment": waves, "numbers": numbers}
    scene = crank_on_dc_motor(inertia, stall, light, load)
    varied = {f"moments.load.numbers.a{k}": sizes[k - 1] for k in range(1, 5)}
    varied |= {f"moments.load.numbers.b{k}": places[k - 1] for k in range(1, 5)}
    orders = np.arange(1, 5)[:, None]

    def rates(phi: float, omega: np.ndarray) -> np.ndarray:
        load = (sizes * np.cos(orders * phi + places)).sum(axis=0)
        return (stall * (1.0 - omega / light) + load) / (inertia * omega)

    # After twelve turns the begin is forgotten.
    turn, speeds, how = 2.0 * math.pi, np.full(len(chosen), light), {"rtol": 1e-12, "atol": 1e-12, "max_step": 0.05}
    speeds = solve_ivp(rates, (0.0, 12 * turn), speeds, "DOP853", **how).y[:, -1]
    along = solve_ivp(rates, (0.0, turn), speeds, "DOP853", np.linspace(0.0, turn, 20_001)[:-1], **how).y
    extremes = [(-top_between(-row), top_between(row)) for row in along]
    for accuracy in (None, 1e-4, 1e-3):
        found = ask(scene, "on.speed_min on.speed_max", varied=varied, accuracy=accuracy)
        for name, true in zip(("on.speed_min", "on.speed_max"), np.transpose(extremes), strict=True):
            assert (abs(found.values[name] - true) <= found.errors[name] + 1e-10).all(), (name, accuracy)
