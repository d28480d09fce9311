"""Moments that jump, also where the cycle begins or breaks lie close: their work in a run and in steady motion."""

import math
from fractions import Fraction
from itertools import pairwise

import numpy as np
import pytest
from motion_scenes import INERTIA, ask, rotor, run, slider_crank, steady

TURN = 2 * math.pi


# A sawtooth: it jumps where the cycle begins. All tables have as many rows, so that machines share their functions.
SAWTOOTH = {"over_angle": [0.0, 1.5, 2.4, 3.0, TURN, TURN], "moment": [1.0, 1.5, 1.8, 2.0, 6.0, 1.0]}


def test_steady_motion_with_a_jump_where_the_cycle_begins__balances_its_works():
    scene = rotor({"go": steady("by_angle dc")}, by_angle=SAWTOOTH)
    found = ask(scene, "go.motor_work", 60)
    # What the table gives in a turn, the motor takes; rounding of works of some 40 J on the way.
    assert found["go.motor_work"] == pytest.approx(-(3.0 * 1.5 + (TURN - 3.0) * 4.0), abs=1e-9)


def area(angles: list[float], moments: list[float]) -> float:
    """Of the straight lines between rows; differences of close angles are exact in fractions."""
    rows = list(zip(map(Fraction, angles), map(Fraction, moments), strict=True))
    return float(sum((m + n) / 2 * (b - a) for (a, m), (b, n) in pairwise(rows)))


# Rows with a break by a distance from another one, or from where the cycle or the run begins.
CLOSE = {
    "after the begin of the cycle": lambda d: ([0, d, d, 3, TURN, TURN], [50, 50, -2, -2, -2, 50], 0.0),
    "before the end of the cycle": lambda d: ([0, 3, TURN - d, TURN - d, TURN, TURN], [50, 50, 50, -2, -2, 50], 0.0),
    "after another": lambda d: ([0, 1, 1, 1 + d, 1 + d, TURN], [5, 5, 1e3, 1e3, 5, 5], 0.0),
    "with nothing but what is between them": lambda d: ([0, 1, 1, 1 + d, 1 + d, TURN], [0, 0, 1e3, 1e3, 0, 0], 0.0),
    "after the begin of the run": lambda d: ([0, 1, 1, 3, TURN, TURN], [50, 50, -2, -2, -2, 50], 1 - d),
    "before the begin of the run": lambda d: ([0, 1, 1, 3, TURN, TURN], [50, 50, -2, -2, -2, 50], 1 + d),
}


@pytest.mark.parametrize("place", CLOSE)
def test_breaks_however_close__give_their_work(place):
    distances = 10.0 ** np.random.default_rng(7).uniform(-13.0, -5.0, 3)
    for d in distances:
        angles, moments, begin = CLOSE[place](float(d))
        # The second one goes in time, as something may depend on it.
        regimes = {"angle": run("by_angle", from_speed=20.0, from_angle=begin, cycles=1.0)}
        regimes["time"] = regimes["angle"] | {"only": "by_angle nothing"}
        found = ask(
            rotor(regimes, by_angle={"over_angle": angles, "moment": moments}), "angle.final_speed time.final_speed"
        )
        true = math.sqrt(20.0**2 + 2.0 * area(angles, moments) / INERTIA)
        for name in ("angle.final_speed", "time.final_speed"):
            found.covers(name, true)


def test_cycle_of_many_turns__cuts_as_often_as_one_of_one():
    names = "required_power input_moment.max on.motor_work go.final_speed"
    found = {}
    for turns in (1, 7):
        regimes = {"on": steady("dc cut gravity"), "go": run("cut gravity", from_speed=30.0, cycles=2.0 / turns)}
        scene = slider_crank(regimes, flywheel=0.4)
        scene["input"]["revolutions"], scene["moments"] = turns, {"dc": scene["moments"]["dc"]}
        scene["regimes"]["on"]["off"], scene["regimes"]["go"]["off"] = [], ["dc"]
        found[turns] = ask(scene, names)
    for name in names.split():
        share = 7 if name == "on.motor_work" else 1
        assert found[7][name] == pytest.approx(share * found[1][name], rel=1e-8), name
