"""Hoists, vehicles and conveyors on the shafts of a machine, by closed forms of their run-up and coast-down."""

import math

import numpy as np
import pytest
from each_case import refusals
from machines import slider_crank

from engine import Machine, Scene, Verdict

GRAVITY, INERTIA, DRUM, WHEEL = 9.81, 0.4, -0.2, 0.5
SCENE = slider_crank(speed=6.0, group="drive") | {
    "gravity": 0.0,
    "guides": {"way": {"angle": 0.0}},
    "shafts": {
        "drum": {"geared_to": "crank", "ratio": DRUM, "inertia": 3.0},
        "wheel": {"geared_to": "crank", "ratio": WHEEL},
    },
    "bodies": {"disc": {"link": "crank", "mass": 0.0, "inertia": INERTIA}, "ram": {"link": "ram", "mass": 0.0}},
    "moments": {
        "pull": {"type": "constant", "on": "crank", "moment": 0.0, "role": "driving"},
        "rope": {
            "type": "hoist",
            "on": "drum",
            "forwards": "clockwise",
            "mass": 0.0,
            "drum_radius": 0.3,
            "gravity": GRAVITY,
        },
        "car": {"type": "vehicle", "on": "wheel", "mass": 0.0, "wheel_radius": 0.2, "gravity": GRAVITY},
        "belt": {"type": "conveyor", "on": "crank", "load_mass": 0.0, "drum_radius": 0.15, "gravity": GRAVITY},
    },
    "regimes": {
        "go": {"type": "run", "from_speed": 0.0, "time": 0.7},
        "stop": {"type": "run", "off": ["pull"], "from_speed": 5.0, "reversal": True},
        "back": {"type": "run", "off": ["pull"], "from_speed": 0.0, "time": 0.5},
    },
}
OWN = INERTIA + DRUM**2 * 3.0
# Runs miss 1e-10 a step, of a few dozen steps.
TOLERANCE = 1e-8


def evaluate(names, moment, pull=0.0, **numbers):
    """What is asked of the machine with some numbers of one load."""
    numbers = {"moments.pull.moment": pull} | {f"moments.{moment}.{key}": value for key, value in numbers.items()}
    values = dict(zip(numbers, np.array(np.broadcast_arrays(*numbers.values(), [0.0])[:-1]), strict=True))
    outcome = Machine(Scene.model_validate(SCENE), list(names), varied=list(values)).evaluate(values)
    assert (outcome.status == Verdict.OK).all()
    return np.array([outcome.summaries[name] for name in names])


GO = ("go.final_speed", "go.angle", "go.driving_work", "go.useful_work", "go.harmful_work", "go.energy_change")


def test_hoist__is_lifted_at_constant_acceleration():
    mass, efficiency, times = np.random.default_rng(6).uniform([[1.0], [0.3], [1.01]], [[300.0], [1.0], [5.0]], (3, 40))
    # Against its weight of m g r on the drum, through the drum's gearing, by a share more than that.
    weight = mass * GRAVITY * 0.3 * abs(DRUM) / efficiency
    found = evaluate(GO, "rope", times * weight, mass=mass, efficiency=efficiency)
    inertia = OWN + DRUM**2 * mass * 0.3**2
    speed = (times - 1.0) * weight / inertia * 0.7
    angle = 0.35 * speed
    lifted, lost = efficiency * weight * angle, (1.0 - efficiency) * weight * angle
    expected = np.array([speed, angle, times * weight * angle, lifted, lost, 0.5 * inertia * speed**2])
    # Moments that nearly balance carry their rounding, and what a step misses, so many times as much.
    assert (np.abs(found - expected) <= TOLERANCE / (times - 1.0) * (expected + weight * angle)).all()


def test_hoist__drives_less_where_it_is_lowered_than_it_takes_to_lift_it():
    names = ("stop.time", "stop.angle", "back.final_speed", "back.useful_work", "back.harmful_work")
    found = evaluate(names, "rope", mass=50.0, efficiency=0.6)[:, 0]
    weight, inertia = 50.0 * GRAVITY * 0.3 * abs(DRUM), OWN + DRUM**2 * 50.0 * 0.3**2
    slows, falls = weight / 0.6 / inertia, 0.6 * weight / inertia
    way = 0.125 * falls
    expected = [5.0 / slows, 12.5 / slows, -falls * 0.5, -weight * way, 0.4 * weight * way]
    np.testing.assert_allclose(found, expected, rtol=TOLERANCE)


@pytest.mark.parametrize(("own", "of_scene", "taken"), [(3.7, 9.81, 3.7), (None, 9.81, 9.81), (None, 0.0, 9.80665)])
def test_weight__is_by_its_own_gravity_or_the_scenes_or_the_standard(own, of_scene, taken):
    rope = {key: value for key, value in SCENE["moments"]["rope"].items() if key != "gravity"}
    rope |= {"mass": 50.0} | ({} if own is None else {"gravity": own})
    parts = {key: SCENE[key] for key in ("points", "input", "shafts")}
    made = Machine(
        Scene.model_validate(parts | {"gravity": of_scene, "moments": {"rope": rope}}), ["mean_useful_moment"]
    )
    assert made.evaluate({}).summaries["mean_useful_moment"][0] == pytest.approx(
        50.0 * taken * 0.3 * abs(DRUM), rel=1e-14
    )


def test_vehicle__runs_up_by_tanh_and_coasts_down_by_tan():
    low, high = [[10.0], [0.0], [-0.02], [0.1]], [[2000.0], [0.05], [0.1], [20.0]]
    mass, rolling, slope, area = np.random.default_rng(8).uniform(low, high, (4, 40))
    numbers = {"mass": mass, "rolling": rolling, "slope": slope, "drag_area": area}
    force = mass * GRAVITY * (rolling * np.cos(slope) + np.sin(slope))
    hold, inertia = force * 0.2 * WHEEL, OWN + WHEEL**2 * mass * 0.2**2
    drag, pull = 0.5 * 1.204 * area * (0.2 * WHEEL) ** 3, np.abs(hold) + 20.0
    found = evaluate(GO[:2], "car", pull, **numbers)
    most, pace = np.sqrt((pull - hold) / drag), np.sqrt((pull - hold) * drag) / inertia
    # The logarithm of the hyperbolic cosine near 1 rounds by as much as it is smaller than 1.
    spread = np.log(np.cosh(pace * 0.7))
    expected = np.array([most * np.tanh(pace * 0.7), inertia / drag * spread])
    assert (np.abs(found - expected) <= (TOLERANCE + 1e-15 / spread) * expected).all()
    slowed = hold > 0.1
    hold, inertia, drag = hold[slowed], inertia[slowed], drag[slowed]
    found = evaluate(("stop.time", "stop.angle"), "car", **{key: row[slowed] for key, row in numbers.items()})
    late = inertia / np.sqrt(hold * drag) * np.arctan(5.0 * np.sqrt(drag / hold))
    way = 0.5 * inertia / drag * np.log1p(25.0 * drag / hold)
    np.testing.assert_allclose(found, [late, way], rtol=TOLERANCE)


def test_conveyor__takes_friction_and_lift():
    numbers = {"load_mass": 80.0, "belt_mass": 30.0, "friction": 0.03, "incline": 0.2}
    found = evaluate(("stop.time", "stop.useful_work", "stop.energy_change"), "belt", **numbers)[:, 0]
    moment = 0.15 * GRAVITY * (0.03 * 110.0 * math.cos(0.2) + 80.0 * math.sin(0.2))
    inertia = OWN + 110.0 * 0.15**2
    np.testing.assert_allclose(found, [5.0 * inertia / moment, 12.5 * inertia, -12.5 * inertia], rtol=TOLERANCE)


def test_carried_masses__are_in_the_reduced_inertia_and_in_equilibrium():
    scene = Scene.model_validate(SCENE | {"regimes": {}})
    names = ["required_drive_moment", "input_moment_disagreement"]
    varied = ["moments.rope.mass", "moments.car.mass", "moments.belt.load_mass", "bodies.ram.mass"]
    machine = Machine(scene, names, ["reduced_inertia"], varied)
    outcome = machine.evaluate(dict(zip(varied, np.array([[50.0], [40.0], [30.0], [2.0]]), strict=True)))
    least = OWN + DRUM**2 * 50.0 * 0.3**2 + WHEEL**2 * 40.0 * 0.2**2 + 30.0 * 0.15**2
    # At its dead centres the ram has no share in it.
    assert outcome.fields["reduced_inertia"][0].min() == pytest.approx(least, rel=1e-12)
    assert outcome.summaries["required_drive_moment"][0] == pytest.approx(50.0 * GRAVITY * 0.3 * abs(DRUM), rel=1e-12)
    # A share of the greatest moment.
    assert outcome.summaries["input_moment_disagreement"][0] < 1e-12


def loaded(moment, off):
    moments = SCENE["moments"] | {"rope": SCENE["moments"]["rope"] | moment}
    regimes = {"go": SCENE["regimes"]["go"] | {"off": off}}
    Machine(Scene.model_validate(SCENE | {"moments": moments, "regimes": regimes}))


test_what_has_no_meaning__is_refused_in_words = refusals(
    loaded,
    ({"on": "rod"}, [], "moments.rope.on … allowed: crank, drum, wheel"),
    ({}, ["rope"], "regimes.go.off … always moves with the machine"),
)


def test_drum_without_a_crankpin__lifts_as_with_one():
    drum = {"type": "crank", "link": "drum", "pivot": "O", "speed": 6.0}
    scene = {
        "points": {"O": {"x": 0.0, "y": 0.0}},
        "input": drum,
        "bodies": {"disc": {"link": "drum", "mass": 0.0, "inertia": INERTIA}},
        "moments": {"rope": SCENE["moments"]["rope"] | {"on": "drum", "forwards": "counter-clockwise", "mass": 5.0}},
        "regimes": {"fall": {"type": "run", "from_speed": 2.0, "time": 0.7}},
    }
    with_pin = scene | {"input": drum | {"pin": "A", "length": 0.1}}
    names = ["fall.final_speed", "fall.angle"]
    found = [Machine(Scene.model_validate(one), names).evaluate({}).summaries for one in (scene, with_pin)]
    slows = 5.0 * GRAVITY * 0.3 / (INERTIA + 5.0 * 0.3**2)
    assert found[0]["fall.final_speed"][0] == pytest.approx(2.0 - 0.7 * slows, rel=TOLERANCE)
    assert {name: values.tolist() for name, values in found[0].items()} == {n: v.tolist() for n, v in found[1].items()}
