"""Walks along time deliver the accuracy asked, and their figures cover what they miss, whatever limits their steps."""

from pathlib import Path

import numpy as np
import pytest
from motion_scenes import CLUTCH, FLUID, MOMENTS, RATIO, ask, behind, rotor, run, slider_crank, steady

from engine import Machine, Outcome, Scene, Verdict, scene_numbers
from sweeps import read_scene
from sweeps.text.templates import bundled_templates

GRIPPING = CLUTCH | {"engagement": 0.1}
# So stiff that stability limits the steps more than their errors do.
STIFF = FLUID | {"diameter": 0.4, "slip": [0.0, 0.03, 0.1, 1.0], "coefficient": [0.0, 0.002, 0.005, 0.008]}
START = "dc rub by_angle"


def coupled(coupling: dict, regime: dict) -> dict:
    motor = {"stall_moment": 20.0 / RATIO, "no_load_speed": 100.0 * RATIO}
    return behind(slider_crank({"go": regime}, dc=motor), 0.02, coupling=coupling)


COUPLED = run(START, from_speed=1.0, from_shaft_speed=300.0, time=0.3)
# Behind the jump of `by_angle` at 1 rad, one step leads to the lock-up if little is asked.
LOCKING = run(START, from_angle=0.93, from_speed=1.0, from_shaft_speed=100.0, lock_up=True)
CASES = {
    "clutch": (coupled(GRIPPING, COUPLED), ("coupling_heat", "final_speed", "angle")),
    "lock-up": (coupled(GRIPPING | {"capacity": 3.0}, LOCKING), ("coupling_heat", "coupling_slip_angle", "angle")),
    "fluid coupling": (coupled(STIFF, COUPLED), ("coupling_heat", "final_speed", "angle")),
    "steady fluid coupling": (coupled(STIFF, steady(START)), ("mean_speed", "speed_fluctuation")),
    "over time": (
        slider_crank({"go": run(START + " by_time", from_speed=5.0, time=0.6)}),
        ("final_speed", "angle", "speed_max"),
    ),
    "stop": (slider_crank({"go": run("rub nothing", from_speed=5.0, rest=True)}), ("angle", "time")),
}
# Steady running behind a steep coupling takes dozens of cycles of each variant.
VARIANTS = dict.fromkeys(CASES, 4) | {"steady fluid coupling": 2}
ACCURACIES = (1e-11, 1e-8, 1e-5, 1e-2)


@pytest.fixture(scope="module", params=CASES)
def found(request: pytest.FixtureRequest) -> dict[float, tuple[np.ndarray, np.ndarray]]:
    """Numbers of some machines and their figures, (numbers, variants), by the accuracy."""
    data, words = CASES[request.param]
    # The residual, of which nothing is required, makes them share the functions of other machines.
    names, answers = " ".join(f"go.{word}" for word in (*words, "work_residual")), {}
    varied = {"moments.rub.moment": np.linspace(0.2, 0.8, VARIANTS[request.param])}
    for accuracy in ACCURACIES:
        outcome = ask(data, names, varied=varied, accuracy=accuracy)
        assert set(outcome.status) == {Verdict.OK}
        answers[accuracy] = tuple(np.array(list(table.values()))[:-1] for table in (outcome.values, outcome.errors))
    return answers


@pytest.mark.parametrize("accuracy", ACCURACIES[1:])
def test_what_a_walk_misses__is_covered_and_within_the_accuracy(found, accuracy):
    (exact, least), (values, figures) = found[ACCURACIES[0]], found[accuracy]
    off = np.abs(values - exact)
    assert (off <= accuracy * np.abs(exact)).all()
    # The errors of three walks hardly ever agree by chance, as those of two do in a hundredth of the variants.
    beyond = off / (figures + least)
    assert ((beyond > 1.0).sum(axis=1) <= 1).all(), beyond.max(axis=1)
    assert (beyond <= 2.0).all(), beyond.max(axis=1)
    assert (np.median(figures, axis=1) <= 20.0 * accuracy * np.abs(exact).max(axis=1)).all()


def test_accuracy__is_what_steps_are_made_for(found):
    assert (np.median(found[1e-11][1], axis=1) < 0.1 * np.median(found[1e-5][1], axis=1)).all()


def test_heat_of_a_coupling__has_the_same_figure_by_any_name():
    scene = coupled(STIFF, COUPLED)
    renamed = scene | {"couplings": {"hub": scene["couplings"]["coupling"]}}
    found = ask(scene, "go.coupling_heat", accuracy=1e-4), ask(renamed, "go.hub_heat", accuracy=1e-4)
    assert found[0].errors["go.coupling_heat"] == found[1].errors["go.hub_heat"]


@pytest.mark.parametrize("accuracy", [1e-4, 1e-5, 1e-6])
def test_stop_after_steady_running__is_covered_though_most_of_it_is_walked_over_the_angle(accuracy):
    scene, random = read_scene(bundled_templates()["press_with_motor"]), np.random.default_rng(5)
    varied = {"input.length": 0.04, "shafts.motor_shaft.inertia": 0.006, "moments.brake.inner_radius": 0.08}
    varied = {path: value * 10.0 ** random.uniform(-0.3, 0.3, 128) for path, value in varied.items()}
    names = ["stop.angle", "stop.time", "stop.brake_heat"]
    found, exact = (Machine(scene, names, (), varied, accuracy=given).evaluate(varied) for given in (accuracy, 1e-12))
    assert (found.status == Verdict.OK).sum() > 100
    for name, value in found.summaries.items():
        off, figures = np.abs(value - exact.summaries[name]), found.errors[name] + exact.errors[name]
        assert not (off > figures).any(), (name, np.nanmax(off / figures))


@pytest.mark.parametrize("accuracy", [1e-2, 1e-3, 1e-4])
def test_top_of_the_speed_at_the_end__is_as_uncertain_as_the_final_speed(accuracy):
    inertia, moment, time = np.geomspace(0.01, 2.0, 24), np.geomspace(60.0, 10.0, 24), 0.16
    scene, names = rotor({"go": run("dc", time=time)}), "go.speed_max go.final_speed"
    varied = {"bodies.eccentric.inertia": inertia, "moments.dc.stall_moment": moment}
    found, light = ask(scene, names, varied=varied, accuracy=accuracy), MOMENTS["dc"]["no_load_speed"]
    speed = -light * np.expm1(-time * moment / (light * inertia))
    for name, value in found.values.items():
        assert (np.abs(value - speed) <= found.errors[name]).all(), name


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5])
def test_speed_reached_within_a_step_and_left_again__ends_the_run_behind_a_coupling(accuracy):
    """A clutch that always holds: both sides move as one machine without it."""
    motor = {"stall_moment": 8.0 / RATIO, "no_load_speed": 100.0 * RATIO}
    scene = slider_crank({"go": run("dc fan cut", from_speed=28.0, speed=40.0)}, flywheel=0.2, dc=motor)
    whole, split = scene | {"shafts": {"motor_shaft": scene["shafts"]["motor_shaft"] | {"inertia": 0.02}}}, dict(scene)
    whole["moments"] = scene["moments"] | {"dc": scene["moments"]["dc"] | {"on": "motor_shaft"}}
    split = behind(split, 0.02, coupling=CLUTCH | {"capacity": 40.0})
    # Targets that are reached near a top of the speed, or only in the next cycle.
    varied = {"regimes.go.speed": np.linspace(29.0, 36.0, 192)}
    exact, found = ask(whole, "go.angle", varied=varied), ask(split, "go.angle", varied=varied, accuracy=accuracy)
    off = np.abs(found.values["go.angle"] - exact.values["go.angle"])
    assert not (off > found.errors["go.angle"] + exact.errors["go.angle"]).any(), off.max()


def test_walks_that_divide_a_time_into_as_many_steps__make_different_ones():
    motor = {"stall_moment": 1.75, "no_load_speed": 100.0 * RATIO}
    scene = slider_crank({"go": run("dc fan", speed=7.084)}, flywheel=0.8, dc=motor)
    scene = behind(scene, 0.00123, coupling=CLUTCH | {"capacity": 13.06, "engagement": 0.4386})
    random = np.random.default_rng(3)
    varied = {"flywheel.inertia": 0.8 * 10 ** random.uniform(-0.5, 0.5, 256)}
    varied |= {"moments.dc.stall_moment": 1.75 * 10 ** random.uniform(-0.3, 0.5, 256)}
    exact, found = (ask(scene, "go.angle", varied=varied, accuracy=accuracy) for accuracy in (1e-11, 1e-3))
    off = np.abs(found.values["go.angle"] - exact.values["go.angle"])
    beyond = off / (found.errors["go.angle"] + exact.errors["go.angle"])
    # The range of three walks of few steps may be a few times smaller than the error by chance; of equal ones, it is 0.
    assert (beyond < 4.0).all(), beyond.max()


def shaper(asked: dict[str, list[str]], regime: dict) -> list[Outcome]:
    """Answers of 64 shapers in a regime, at an accuracy near rounding first."""
    scene = read_scene(Path(__file__).parents[3] / "results" / "motion" / "shaper.toml")
    numbers, rng = scene_numbers(scene), np.random.default_rng(4)
    spread = {"input.length": 0.1, "points.O.y": 0.05, "forces.cutting.scale": 0.3}
    spread |= dict.fromkeys(("moments.motor.breakdown_moment", "moments.motor.breakdown_slip"), 0.25)
    varied = {path: numbers[path].value * (1.0 + share * rng.uniform(-1.0, 1.0, 64)) for path, share in spread.items()}
    data = scene.model_dump(exclude_unset=True, exclude_none=True) | {"regimes": {"go": regime}}
    scene = Scene.model_validate(data)
    machines = [Machine(scene, **asked, varied=list(varied), accuracy=a) for a in (1e-11, 1e-6, 1e-4, 1e-2)]
    return [machine.evaluate(varied) for machine in machines]


def test_top_of_the_speed__is_where_the_speed_is_flat_at_any_accuracy():
    """A step ends at a top only where the speed hardly rises any more."""
    regime = {"type": "run", "from_angle": 0.0, "from_speed": 1.6, "cycles": 3.0}
    exact, *found = shaper({"summaries": ["go.speed_max"]}, regime)
    for own in found:
        off = np.abs(own.summaries["go.speed_max"] - exact.summaries["go.speed_max"])
        assert (off <= 0.3 * own.errors["go.speed_max"] + exact.errors["go.speed_max"]).all()


@pytest.mark.parametrize("accuracy", [1e-3, 1e-5])
def test_top_of_the_speed__is_that_of_the_last_cycle_if_the_run_ends_by_time_in_the_first_step_after_it(accuracy):
    """Repeated steps pass over tops; those of the last cycle are made again and end there."""
    cycles, names = 6.0 + np.geomspace(1e-5, 0.1, 16), "go.time go.speed_max"
    by_cycles, by_time = (
        slider_crank({"go": run("push oil", from_speed=55.0, **{end: 1.0})}) for end in ("cycles", "time")
    )
    found = ask(by_cycles, names, varied={"regimes.go.cycles": cycles}, accuracy=accuracy)
    other = ask(by_time, names, varied={"regimes.go.time": found.values["go.time"]}, accuracy=accuracy)
    off = np.abs(other.values["go.speed_max"] - found.values["go.speed_max"])
    assert (off <= 0.3 * (found.errors["go.speed_max"] + other.errors["go.speed_max"])).all()


def test_speed_within_the_steps_of_a_cycle__is_covered_at_any_accuracy():
    """Between its ends a step is a polynomial, which may miss more than the ends do."""
    exact, *found = shaper({"fields": ["go.speed"]}, {"type": "steady"})
    for own in found:
        off = np.abs(own.fields["go.speed"] - exact.fields["go.speed"]).max(axis=1)
        assert (off <= 0.3 * own.errors["go.speed"] + exact.errors["go.speed"]).all()


@pytest.mark.parametrize("accuracy", [1e-12, 1e-15])
def test_accuracy_beyond_rounding__is_as_good_as_rounding_allows(accuracy):
    # A heavy flywheel behind a stiff crank: what acts is in balance but for its last digits.
    scene = rotor({"go": run("push rub by_time", from_speed=0.0, time=3.0)}, flywheel=1e4)
    assert ask(scene, "go.final_speed", accuracy=accuracy).status == [Verdict.OK]
