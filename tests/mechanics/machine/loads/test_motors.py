"""Motors of a scene: their moment at the input's speed, through the gears."""

import math

import pytest
from machines import slider_crank

from engine import Machine, Scene, SceneError

DC = {"type": "dc_motor", "no_load_speed": "1500 rpm"}
INDUCTION = {"type": "induction_motor", "synchronous_speed": "1500 rpm", "power": "2 kW", "rated_speed": "1440 rpm"}


def scene(motor, speed="60 rpm"):
    return Scene.model_validate(
        slider_crank(
            speed=speed,
            shafts={"rotor": {"geared_to": "crank", "ratio": 24}},
            moments={"motor": {"on": "rotor", **motor}},
        )
    )


def moment(motor, speed="60 rpm"):
    return float(Machine(scene(motor, speed), ["motor_moment"]).evaluate({}).summaries["motor_moment"][0])


@pytest.mark.parametrize(
    "motor",
    [
        DC | {"power": "2 kW", "rated_speed": "1440 rpm"},
        # On the same straight line: 2 kW at 1440 rpm is 1/25 of the stall moment.
        DC | {"stall_moment": 25 * 2000 / (1440 * math.pi / 30)},
        INDUCTION | {"breakdown_ratio": 2.5},
        INDUCTION | {"breakdown_ratio": 2.5, "starting_ratio": 2.0},
    ],
)
def test_rated_speed__gives_the_rated_power_through_the_gear(motor):
    # 60 rpm of the crank are 1440 rpm of the rotor; P = M ω. Fifty roundings remain of the nameplate's algebra.
    expected = 2000 / (60 * math.pi / 30)
    assert moment(motor) == pytest.approx(expected, rel=50 * 2.2e-16)
    assert moment(motor, "-60 rpm") == pytest.approx(-expected, rel=50 * 2.2e-16)


@pytest.mark.parametrize(
    ("motor", "words"),
    [
        (DC, "stall_moment, or power and rated_speed"),
        (DC | {"stall_moment": 5.0, "power": 3.0, "rated_speed": 4.0}, "stall_moment, or power and rated_speed"),
        (DC | {"power": "2 kW", "rated_speed": "1600 rpm"}, "below no_load_speed"),
        (INDUCTION, "breakdown_moment and breakdown_slip"),
        (INDUCTION | {"breakdown_ratio": 2.5, "starting_ratio": 3.0}, "starting torque is below the breakdown torque"),
    ],
)
def test_contradictory_motor__is_refused(motor, words):
    with pytest.raises(SceneError, match=words):
        scene(motor)
