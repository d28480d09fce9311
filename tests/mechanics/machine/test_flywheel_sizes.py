"""The flywheel's methods and the speeds of whole machines against balances of energy, dense fields and each other.

For extreme numbers they are compared with closed forms in test_extremes_matrix.py.
"""

import math

import numpy as np
import pytest
from machines import slider_crank

from engine import Machine, Scene, Verdict

EPS = np.finfo(float).eps
R, ROD, INERTIA, SPEED = 0.05, 0.2, 0.02, 100.0

DRAG = {"type": "linear_drag", "coefficient": 30.0}
# It presses hard over a fifth of the way in, less over another third, and not at all on the way out.
STEPS = {
    "type": "table",
    "slider": "ram",
    "measured_from": "high end",
    "over_stroke": [0, 0.02, 0.02, 0.05],
    "force": [2000, 2000, 500, 500],
    "interpolation": "linear",
    "outside": "zero",
    "acts": "against",
}
LOADS = pytest.mark.parametrize("force", [DRAG, STEPS], ids=["drag", "steps"])
SIZES = ["flywheel_excess_work", "flywheel_merzalov", "flywheel_wittenbauer"]
ASKED = ["excess_work", *SIZES, "speed_fluctuation", "speed_min", "speed_max"]
ASKED += ["required_drive_moment", "required_power"]
VARIED = ["groups.g.first.length", "bodies.ram.mass", "input.speed", "flywheel.speed_fluctuation"]


def press(flywheel, force):
    scene = slider_crank(
        R,
        ROD,
        SPEED,
        bodies={"wheel": {"link": "crank", "mass": 5, "inertia": INERTIA}, "ram": {"link": "ram", "mass": 1.5}},
        forces={"F": {"on": "B", "angle": 0.0} | force},
        flywheel=flywheel,
    )
    return Scene.model_validate(scene)


@pytest.fixture(scope="module")
def machines():
    asked = [*ASKED, "merzalov_difference", "flywheel_used"]
    return {
        force["type"]: Machine(press({"speed_fluctuation": 0.02}, force), asked, varied=VARIED)
        for force in (DRAG, STEPS)
    }


def evaluate(machines, force, varied):
    outcome = machines[force["type"]].evaluate(varied)
    assert (outcome.status == Verdict.OK).all()
    return outcome


# Merzalov and the excess work: approximations


@LOADS
def test_merzalov__tends_to_the_exact_flywheel(machines, force):
    deltas = np.array([1e-2, 1e-3, 1e-4])
    numbers = {"groups.g.first.length": ROD, "bodies.ram.mass": 1.5, "input.speed": 20.0}
    varied = {path: np.full(3, value) for path, value in numbers.items()}
    found = evaluate(machines, force, varied | {"flywheel.speed_fluctuation": deltas}).summaries
    assert found["merzalov_difference"] == pytest.approx(
        found["flywheel_merzalov"] / found["flywheel_wittenbauer"] - 1, abs=1e-12
    )
    # What is neglected is what varies of I, less than that of the ram at its fastest, of what grows as 1/δ.
    assert (np.abs(found["merzalov_difference"]) * found["flywheel_wittenbauer"] <= 1.5 * (1.2 * R) ** 2).all()


@LOADS
def test_flywheel_that_is_not_needed__is_none(machines, force):
    # A rotor's inertia is more than enough at this fluctuation.
    numbers = {"groups.g.first.length": ROD, "bodies.ram.mass": 0.1, "input.speed": 300.0}
    numbers["flywheel.speed_fluctuation"] = 1.5
    outcome = evaluate(machines, force, {path: np.array([value]) for path, value in numbers.items()})
    assert outcome.summaries["flywheel_wittenbauer"][0] < 0.0
    assert outcome.summaries["flywheel_used"][0] == 0.0
    assert 0.0 < outcome.summaries["speed_fluctuation"][0] < 1.5


# Either way round, and small


@LOADS
def test_negative_speed__needs_the_same_flywheel(machines, force):
    # What presses on the way in one way round does so on the way in the other way round: the machine is its own mirror.
    lows, highs = (0.07, 0.1, 10.0, -8.0), (0.4, 3.0, 300.0, -0.3)
    *others, power = np.random.default_rng(2).uniform(lows, highs, (100, 4)).T
    varied = dict(zip(VARIED, (*others, 10.0**power), strict=True))
    forward = evaluate(machines, force, varied)
    backward = evaluate(machines, force, varied | {"input.speed": -varied["input.speed"]})
    for key in ASKED:
        sign = -1 if key == "required_drive_moment" else 1
        off = np.abs(backward.summaries[key] - sign * forward.summaries[key])
        assert (off <= forward.errors[key] + backward.errors[key]).all(), key


def test_tiny_fluctuation__is_reached_and_its_error_is_honest(machines):
    numbers = {"groups.g.first.length": ROD, "bodies.ram.mass": 1.5, "input.speed": SPEED}
    deltas = np.array([1e-2, 1e-4, 1e-6, 1e-8])
    varied = {path: np.full(4, value) for path, value in numbers.items()} | {"flywheel.speed_fluctuation": deltas}
    outcome = evaluate(machines, DRAG, varied)
    np.testing.assert_allclose(outcome.summaries["speed_fluctuation"], deltas, rtol=4 * EPS)
    assert (outcome.errors["speed_fluctuation"] <= 1e-12 * deltas).all()
    wheels = outcome.summaries["flywheel_wittenbauer"]
    assert wheels[3] / wheels[2] == pytest.approx(100, rel=1e-4)


# Speed and work over the cycle

# A load that pushes unevenly, once and hard, in a machine out of balance.
UNEVEN = {
    "bodies": {
        "disc": {"link": "crank", "mass": 4.0, "x": 0.03, "y": -0.02, "inertia": 0.05},
        "ram": {"link": "ram", "mass": 6.0},
        "rod": {"link": "rod", "mass": 1.2, "x": 0.07, "y": 0.01, "inertia": 0.004},
    },
    "gravity": 9.81,
    "forces": {"F": {"on": "B", "angle": 0.0} | STEPS | {"acts": "always", "force": [-3000, -500, 200, 200]}},
    "moments": {"brake": {"type": "constant", "on": "crank", "moment": -7.0}},
}


@pytest.fixture(scope="module", params=[{"inertia": 0.3}, {"speed_fluctuation": 0.1}, {"inertia": 40.0}], ids=str)
def uneven(request):
    scene = Scene.model_validate(slider_crank(R, 0.13, 60.0, flywheel=request.param, **UNEVEN))
    statistics = [f"{field}.{s}" for field in ("speed", "work") for s in ("min", "max", "mean", "rms", "range")]
    names = ["speed_min", "speed_max", "speed_fluctuation", "excess_work", "flywheel_used", *statistics]
    outcome = Machine(scene, names, ["speed", "work", "reduced_inertia"], positions=14_400).evaluate({})
    assert outcome.status[0] == Verdict.OK
    return outcome


def test_least_and_greatest_speed__are_those_of_the_speed(uneven):
    found, figures = uneven.summaries, uneven.errors
    for name in ("min", "max"):
        own, of_field = f"speed_{name}", f"speed.{name}"
        assert abs(found[own][0] - found[of_field][0]) <= figures[own][0] + figures[of_field][0]
        assert figures[own][0] + figures[of_field][0] <= 1e-9 * found[own][0]
    assert found["speed.range"][0] == pytest.approx(60.0 * found["speed_fluctuation"][0], rel=1e-9)
    # The wheel is given, or made for a fluctuation of 0.1.
    assert found["flywheel_used"][0] in (0.3, 40.0) or found["speed_fluctuation"][0] == pytest.approx(0.1, rel=1e-12)
    assert found["excess_work"][0] == pytest.approx(found["work.range"][0], rel=1e-12)


def test_speed_over_the_cycle__is_that_of_works_and_inertias(uneven):
    work, inertia, speed = (uneven.fields[name][0] for name in ("work", "reduced_inertia", "speed"))
    energy = 0.5 * (inertia + uneven.summaries["flywheel_used"][0]) * speed**2
    # The work is the change of the kinetic energy.
    np.testing.assert_allclose(energy - energy[0], work - work[0], rtol=0, atol=1e-9 * np.abs(energy).max())
    low, high = (uneven.summaries[name][0] for name in ("speed_min", "speed_max"))
    assert 0.5 * (low + high) == pytest.approx(60.0, rel=1e-13)


@pytest.mark.parametrize("field", ["speed", "work"])
def test_statistics_of_what_is_followed__are_those_of_dense_rows(uneven, field):
    row = uneven.fields[field][0]
    found = {s: uneven.summaries[f"{field}.{s}"][0] for s in ("min", "max", "mean", "rms")}
    h, swing = 2 * math.pi / row.size, np.ptp(row)
    # Means of rows that bend by at most B have an error of B h²/12 at each bend, of which there are six; the swing is
    # run through in no less than some 0.1 rad.
    of_mean = 6 * 10 * swing * h**2
    assert abs(row.mean() - found["mean"]) <= of_mean
    assert abs(math.sqrt(np.mean(row**2)) - found["rms"]) <= 4 * of_mean
    # An extreme at a bend lies half a step from the next position at most.
    assert 0.0 <= found["max"] - row.max() + 1e-12 * swing <= 5 * swing * h
    assert 0.0 <= row.min() - found["min"] + 1e-12 * swing <= 5 * swing * h


# The wheel it is made as


def test_wheel_that_bursts__has_taken_the_work_of_the_moment_that_drove_it_there():
    ratio, strength, inertia = 3.0, 2e8, 40.0
    given = {"type": "disc", "diameter": 0.5, "strength": strength, "density": 7200.0, "ratio": ratio}
    names = [f"wheel_{key}" for key in ("burst_speed", "burst_energy", "burst_impulse", "energy", "mass")]
    machine = Machine(press({"inertia": inertia, "wheel": given}, DRAG), ["speed_max", *names])
    fastest, burst, energy, impulse, before, mass = (float(v[0]) for v in machine.evaluate({}).summaries.values())
    # A disc bursts at ρω²R²/3 = strength; on the input its inertia is i² times mR²/2.
    assert burst == pytest.approx(math.sqrt(3 * strength / 7200) / 0.25 / ratio, rel=1e-13)
    assert mass * 0.25**2 / 2 * ratio**2 == pytest.approx(inertia, rel=1e-13)
    # Under a constant moment of 50 N m on the input: its work is what the energy grows by.
    time = impulse / 50.0
    work = 50.0 * (fastest * time + 0.5 * 50.0 / inertia * time**2)
    assert work == pytest.approx(energy - before, rel=1e-12)
    assert fastest + 50.0 / inertia * time == pytest.approx(burst, rel=1e-12)
