"""Walks along time deliver the accuracy asked, and their figures cover what they miss, whatever limits their steps."""

import numpy as np
import pytest
from motion_scenes import RATIO, ask, rotor, run, slider_crank, steady

from engine import Verdict

CLUTCH = {"type": "friction_clutch", "shaft": "motor_shaft", "capacity": 4.0, "engagement": 0.1}
# So stiff that stability limits the steps more than their errors do.
FLUID = {
    "type": "fluid_coupling",
    "shaft": "motor_shaft",
    "diameter": 0.4,
    "density": 860.0,
    "slip": [0.0, 0.03, 0.1, 1.0],
    "coefficient": [0.0, 0.002, 0.005, 0.008],
    "interpolation": "linear",
}
START = "dc rub by_angle"


def coupled(coupling: dict, regime: dict, scene: dict | None = None) -> dict:
    scene = slider_crank({"go": regime}) if scene is None else scene
    scene["shafts"]["motor_shaft"]["inertia"] = 0.02
    scene["couplings"] = {"coupling": coupling}
    scene["moments"]["dc"] |= {"on": "motor_shaft", "stall_moment": 20.0 / RATIO, "no_load_speed": 100.0 * RATIO}
    return scene


COUPLED = run(START, from_speed=1.0, from_shaft_speed=300.0, time=0.3)
CASES = {
    "clutch": (coupled(CLUTCH, COUPLED), ("coupling_heat", "final_speed", "angle")),
    "fluid coupling": (coupled(FLUID, COUPLED), ("coupling_heat", "final_speed", "angle")),
    "steady fluid coupling": (coupled(FLUID, steady(START)), ("mean_speed", "speed_fluctuation")),
    "over time": (
        slider_crank({"go": run(START + " by_time", from_speed=5.0, time=0.6)}),
        ("final_speed", "angle", "speed_max"),
    ),
    "stop": (slider_crank({"go": run("rub nothing", from_speed=5.0, rest=True)}), ("angle", "time")),
}
# Steady running behind a steep coupling takes dozens of cycles of each variant.
VARIANTS = dict.fromkeys(CASES, 24) | {"steady fluid coupling": 6}
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


@pytest.mark.parametrize("accuracy", [1e-12, 1e-15])
def test_accuracy_beyond_rounding__is_as_good_as_rounding_allows(accuracy):
    # A heavy flywheel behind a stiff crank: what acts is in balance but for its last digits.
    scene = rotor({"go": run("push rub by_time", from_speed=0.0, time=3.0)}, flywheel=1e4)
    assert ask(scene, "go.final_speed", accuracy=accuracy).status == [Verdict.OK]
