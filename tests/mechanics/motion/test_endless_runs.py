"""Runs that never come to their end: told from what they do first, not by waiting."""

import math

import numpy as np
import pytest
from motion_scenes import (
    CLUTCH,
    FLUID,
    INERTIA,
    RATIO,
    SWUNG_INERTIA,
    WEIGHT,
    ask,
    behind,
    crank_alone,
    pendulum,
    rotor,
    run,
    slider_crank,
    steady,
)
from scipy.integrate import quad

from engine import Machine, Scene, Verdict
from engine.machine.one_machine.history import history
from sweeps.report.regime_words import failure_text

TURN = 2 * math.pi
# About the lowest place, φ = −π/2, for small swings; at 0.6 rad the period is longer by 0.6²/16.
PERIOD = TURN * math.sqrt(SWUNG_INERTIA / WEIGHT)


def told(scene: dict) -> str:
    return failure_text(Scene.model_validate(scene), Verdict.NO_END)


@pytest.mark.parametrize(
    ("only", "end"),
    [("gravity", {"cycles": 3.0}), ("gravity oil", {"speed": 30.0}), ("gravity oil", {"rest": True})],
)
def test_pendulum__is_known_to_swing_for_ever_when_it_turns_round_for_the_second_time(only, end):
    begin = {"from_angle": -math.pi / 2 - 0.6, "from_speed": 0.0}
    scene = pendulum({"go": run(only, **begin, **end)})
    assert ask(scene, "go.time").status == [Verdict.NO_END]
    seen = history(Scene.model_validate(scene))
    assert seen.time[-1] < 1.5 * PERIOD * (1 + 0.6**2 / 16) + 0.1
    assert np.abs(seen.angle + math.pi / 2).max() <= 0.6 + 1e-6
    assert "swings between φ = " in told(scene)


def test_load_above_the_motor__is_known_to_turn_backwards_for_ever_after_a_cycle():
    scene = slider_crank({"go": run("dc load", speed=50.0)}, load={"moment": -50.0})
    assert ask(scene, "go.time").status == [Verdict.NO_END]
    seen = history(Scene.model_validate(scene))
    assert -1.1 * TURN < seen.angle[-1] <= -TURN
    assert "accelerates backwards" in told(scene)


def test_viscous_resistance_alone__is_never_come_to_rest_by():
    # From I ω dω/dφ = −c ω: the speed falls with the angle, and is zero at φ = I ω₀/c, after an infinite time.
    reach = INERTIA * 20.0 / 0.05 / TURN
    within = ask(rotor({"go": run("oil", from_speed=20.0, cycles=0.999 * reach)}), "go.final_speed")
    within.covers("go.final_speed", 0.001 * 20.0)
    assert within.figure("go.final_speed") < 1e-5
    for end in ({"cycles": 1.001 * reach}, {"rest": True}):
        assert ask(rotor({"go": run("oil", from_speed=20.0, **end)}), "go.time").status == [Verdict.NO_END]
    rubbing = ask(rotor({"go": run("oil rub", from_speed=20.0, rest=True)}), "go.time")
    # ω = (ω₀ + M/c) e^(−ct/I) − M/c.
    assert rubbing["go.time"] == pytest.approx(INERTIA / 0.05 * math.log1p(20.0 * 0.05 / 0.4), rel=1e-6)


@pytest.mark.parametrize("only", ["", "oil", "fan", "oil fan"])
def test_what_vanishes_with_the_speed__stops_no_machine(only):
    scene = slider_crank({"go": run(only, from_speed=20.0, rest=True)})
    assert ask(scene, "go.time").status == [Verdict.NO_END]
    assert "all resistance vanishes with the speed" in told(scene)


# Where a motor of 20 N·m at rest and none at 100 rad/s carries a drag of 0.05 N·m·s, but for what the ram makes of it.
SETTLED = 20.0 / (20.0 / 100.0 + 0.05)


@pytest.mark.parametrize(
    ("only", "end", "words"),
    [
        ("dc oil", {"speed": 1.05 * SETTLED}, "is not reached: it runs at"),
        ("dc oil nothing", {"speed": 1.05 * SETTLED}, "is not reached: it runs at"),
        ("dc oil", {"from_speed": 1.5 * SETTLED, "speed": 0.95 * SETTLED}, "is not reached: it runs at"),
        ("dc oil", {"from_speed": 0.5 * SETTLED, "rest": True}, "does not come to rest: it runs at"),
    ],
    ids=["from below", "in time", "from above", "rest"],
)
def test_end_that_a_settled_machine_never_meets__is_known_long_before_it_has_settled(only, end, words):
    scene = slider_crank({"go": run(only, **end)}, flywheel=0.2)
    assert ask(scene, "go.time").status == [Verdict.NO_END]
    # By I/(0.2 N·m·s + 0.05 N·m·s) it forgets within 13 cycles all but a share of 1/e.
    assert history(Scene.model_validate(scene)).angle[-1] < 26.0 * TURN
    assert words in told(scene)
    assert "at_most" not in told(scene)


def test_speed_that_is_come_to_slowly__is_waited_for():
    # From I ω' = M (1 − ω/ω₀) − c ω: ω = s (1 − e^(−t/T)), with T = I/(M/ω₀ + c).
    scene = rotor({"go": run("dc oil", speed=0.9999 * SETTLED)})
    found = ask(scene, "go.time")
    assert found["go.time"] == pytest.approx(INERTIA / 0.25 * math.log(1e4), rel=1e-9)


# Friction of 60 N·m against Kloss' moment 2 · 100 N·m/(s/0.2 + 0.2/s), s the slip below 100 rad/s: they are equal at
# 40 rad/s, where the machine's speed is unstable, and at 93.3 rad/s, where it is stable.
def loaded_motor(**regime: object) -> dict:
    motor = {"type": "induction_motor", "on": "crank", "synchronous_speed": 100.0}
    motor |= {"breakdown_moment": 100.0, "breakdown_slip": 0.2}
    moments = {"motor": motor, "friction": {"type": "against_motion", "on": "crank", "moment": 60.0}}
    return crank_alone(1.0, moments, {"go": {"type": "run", "from_angle": 0.0, **regime}}, 95.0)


def excess(omega: float) -> float:
    slip = 1.0 - omega / 100.0
    return 200.0 / (slip / 0.2 + 0.2 / slip) - 60.0


@pytest.mark.parametrize("end", [{"speed": 90.0}, {"cycles": 200.0}, {"rest": True}], ids=["speed", "angle", "rest"])
@pytest.mark.parametrize("begin", [5.0, 39.9])
def test_machine_that_its_motor_lets_stop__stalls_whatever_was_to_end_its_run(begin, end):
    scene = loaded_motor(from_speed=begin, **end)
    found, seen = ask(scene, "go.time"), history(Scene.model_validate(scene))
    stops, _ = quad(lambda omega: 1.0 / excess(omega), begin, 0.0, epsrel=1e-11)
    assert seen.time[-1] == pytest.approx(stops, rel=1e-6)
    assert found.status == [seen.verdict] == [Verdict.OK if "rest" in end else Verdict.STALLS]


@pytest.mark.parametrize(("begin", "speed"), [(99.0, 90.0), (99.0, 99.5), (60.0, 95.0), (60.0, 50.0)])
def test_machine_that_settles_short_of_its_speed__has_no_end(begin, speed):
    scene = loaded_motor(from_speed=begin, speed=speed)
    seen = history(Scene.model_validate(scene))
    assert ask(scene, "go.time").status == [seen.verdict] == [Verdict.NO_END]
    assert seen.time[-1] < 20.0


def test_machine_that_settles_after_a_table_of_time__never_stands():
    """From rest it comes to the speed of its motor, and falls back to it as the last moment of the table holds."""
    scene = rotor({"go": run("dc by_time brake", from_speed=0.0, reversal=True)})
    assert ask(scene, "go.time").status == [Verdict.NO_END]


def test_run_that_gets_nowhere_in_its_time__is_given_up():
    """Steps of a tenth of a nanosecond, for a torque that swings as fast: 40 000 are a hundredth of no long run."""
    scene = rotor({"go": run("nothing", from_speed=0.0, time=1e6)})
    scene["moments"]["nothing"] = {"type": "formula", "on": "crank", "moment": "1 kN m * sin(1e10 rad/s * t)"}
    assert ask(scene, "go.time").status == [Verdict.NO_END]


def test_motor_of_any_steepness__is_followed_over_time():
    """A stall moment of 10⁹ N·m pulls to the no-load speed in 4·10⁻⁸ s, and moments over time leave no other form."""
    scene = rotor({"go": run("dc nothing", from_speed=0.0, time=100.0)}, dc={"stall_moment": 1e9})
    assert ask(scene, "go.final_speed")["go.final_speed"] == pytest.approx(100.0, rel=1e-9)


WEAK = {"oil": {"coefficient": 0.03}, "flywheel": 50.0}


@pytest.mark.parametrize(
    ("begin", "shaft", "capacity", "verdict"),
    [
        # The clutch carries the oil at 0.85 rad/s, the motor runs at 100/7.5 rad/s; the flywheel needs 1700 s for it.
        ({"from_speed": 0.0, "from_shaft_speed": 50.0, "lock_up": True}, 0.018, 0.0034, Verdict.SLIPS),
        ({"from_speed": 5.0, "from_shaft_speed": 50.0, "rest": True}, 0.018, 0.0034, Verdict.SLIPS),
        # The shaft faster than the motor, its clutch held: both slow down to where the motor drives the oil.
        ({"from_speed": 20.0, "from_shaft_speed": 150.0, "rest": True}, 54.0, 90.0, Verdict.NO_END),
    ],
    ids=["speeds up", "slows down", "held"],
)
def test_slow_approach_to_a_speed_at_which_a_clutch_goes_on__is_known_within_cycles(begin, shaft, capacity, verdict):
    scene = behind(slider_crank({"go": run("dc oil", **begin)}, **WEAK), shaft, clutch=CLUTCH | {"capacity": capacity})
    assert ask(scene, "go.time").status == [verdict]
    assert history(Scene.model_validate(scene)).angle[-1] < 5.0 * TURN


def test_crank_that_comes_to_rest_while_its_clutch_slips__stops_when_it_should():
    scene = rotor({"go": run("dc rub", from_speed=5.0, from_shaft_speed=99.0, rest=True)}, rub={"moment": 0.1})
    scene, begin = behind(scene, 0.008, clutch=CLUTCH | {"capacity": 0.002}), np.array([5.0, 50.0])
    found = ask(scene, "go.time", varied={"regimes.go.from_speed": begin})
    # The shaft, at up to 100/7.5 rad/s, drives the crank below this speed and brakes it above.
    pull, fast = 0.002 * RATIO, np.maximum(begin - 100.0 / RATIO, 0.0)
    assert found.status == [Verdict.OK] * 2
    exact = INERTIA * ((begin - fast) / (0.1 - pull) + fast / (0.1 + pull))
    off = np.abs(found.values["go.time"] - exact)
    assert (off <= np.where(fast > 0.0, 1e-2, 1e-9) * exact).all()


def test_machine_whose_clutch_locks_after_some_cycles__comes_to_rest():
    """Both sides at 5 and 20 rad/s, the shaft reduced to the crank; then a load brakes the locked machine to rest."""
    shaft, capacity, load = np.array([[0.02, 0.2, 0.1], [0.05, 0.1, 0.3], [0.1, 0.2, 0.4]]).T
    scene = behind(rotor({"go": run("rub", from_speed=5.0, from_shaft_speed=150.0, rest=True)}), clutch=CLUTCH)
    paths = "shafts.motor_shaft.inertia", "couplings.clutch.capacity", "moments.rub.moment"
    found = ask(scene, "go.time", varied=dict(zip(paths, (shaft, capacity, load), strict=True)))
    own, pull, fast = shaft * RATIO**2, capacity * RATIO, 150.0 / RATIO
    lock = (fast - 5.0) / (pull / own + (pull - load) / INERTIA)
    together = fast - pull / own * lock
    assert found.status == [Verdict.OK] * 3
    assert found.values["go.time"] == pytest.approx(lock + together * (INERTIA + own) / load, rel=1e-8)


@pytest.mark.parametrize(("crank", "shaft"), [(38.0, 43.0), (50.0, 23.0)])
def test_clutch_whose_sides_come_to_rest_one_after_the_other__stalls_for_ever(crank, shaft):
    """The slip, the speed of the last side and its sign end at the same instant."""
    begin = {"from_speed": crank, "from_shaft_speed": RATIO * shaft, "lock_up": True}
    scene = behind(rotor({"go": run("rub oil", **begin)}), 1e-4, clutch=CLUTCH | {"capacity": 0.002})
    load = np.random.default_rng(7).uniform(2.0, 4.0, 24)
    machine = Machine(Scene.model_validate(scene), ["go.time"], (), ["moments.rub.moment"])
    assert (machine.evaluate({"moments.rub.moment": load}).status == Verdict.STALLS).all()


@pytest.mark.parametrize(("end", "verdict"), [("lock_up", Verdict.STALLS), ("rest", Verdict.OK)])
def test_crank_that_slips_to_rest_beside_a_standing_shaft__rests(end, verdict):
    """The shaft is held by its own friction; the slip and the crank's speed end at the same instant."""
    begin = {"from_speed": 30.0, "from_shaft_speed": 0.0, end: True}
    scene = behind(rotor({"go": run("rub oil", **begin)}), 1e-3, clutch=CLUTCH | {"capacity": 0.05})
    scene["moments"]["hold"] = {"type": "against_motion", "on": "motor_shaft", "moment": 2.0}
    load = np.random.default_rng(3).uniform(0.01, 0.3, 24)
    machine = Machine(Scene.model_validate(scene), ["go.time"], (), ["moments.rub.moment"])
    assert (machine.evaluate({"moments.rub.moment": load}).status == verdict).all()


@pytest.mark.parametrize("coupling", [FLUID, CLUTCH | {"capacity": 40.0}], ids=["fluid coupling", "clutch"])
def test_run_to_a_speed_behind_a_coupling__ends_below_the_top_of_steady_running_only(coupling):
    motor, acts = {"stall_moment": 20.0 / RATIO, "no_load_speed": 100.0 * RATIO}, "dc by_angle gravity fan"
    regimes = {"on": steady(acts), "go": run(acts, from_speed=5.0, from_angle=0.0, speed=10.0)}
    scene = behind(slider_crank(regimes, flywheel=0.2, dc=motor), 0.02, coupling=coupling)
    top = ask(scene, "on.speed_max")["on.speed_max"]
    found = ask(scene, "go.time", varied={"regimes.go.speed": top * np.array([0.5, 0.97, 1.03, 2.0])})
    assert found.status == [Verdict.OK] * 2 + [Verdict.NO_END] * 2


@pytest.mark.parametrize(
    ("only", "begin", "verdict"),
    [
        ("dc oil", {"from_speed": 5.0, "rest": True}, Verdict.NO_END),
        ("dc oil", {"from_speed": 300.0, "from_shaft_speed": 300.0 * RATIO, "rest": True}, Verdict.NO_END),
        ("load rub", {"from_speed": 0.0, "rest": True}, Verdict.NO_END),
        ("oil", {"from_speed": 5.0, "rest": True}, Verdict.NO_END),
        ("brake rub", {"from_speed": 5.0, "cycles": 50.0}, Verdict.STALLS),
    ],
    ids=["speeds up", "slows down", "runs backwards", "fades", "stands"],
)
def test_slow_approach_behind_a_fluid_coupling__is_known_within_cycles(only, begin, verdict):
    """Its torque vanishes with the slip: a flywheel on the motor's shaft approaches the crank's speed ever more slowly.

    Followed until nothing changes any more, these runs took up to a minute, or didn't end.
    """
    motor = {"stall_moment": 20.0 / RATIO, "no_load_speed": 100.0 * RATIO}
    scene = slider_crank({"go": run(only, **begin)}, flywheel=0.1, dc=motor, load={"moment": -5.0})
    scene = behind(scene, 1.0, fluid=FLUID)
    assert ask(scene, "go.time").status == [verdict]
    assert abs(history(Scene.model_validate(scene)).angle[-1]) < 30.0 * TURN


@pytest.mark.parametrize(("load", "verdict"), [(-1.0, Verdict.STALLS), (-2.0, Verdict.NO_END)])
def test_crank_held_against_its_load_by_a_shaft_that_slows_down__is_driven_back_by_it_later(load, verdict):
    """The friction alone, 1.5 N·m, holds the smaller load. The shaft's torque, at first 2.5 N·m, falls."""
    begin = {"from_speed": 0.0, "from_shaft_speed": 35.0, "cycles": 3.0}
    scene = rotor({"go": run("load rub", **begin)}, load={"moment": load}, rub={"moment": 1.5})
    assert ask(behind(scene, 0.05, fluid=FLUID), "go.time").status == [verdict]
