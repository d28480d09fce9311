"""Motion through rest: swinging, friction that holds, run-down; and regimes that follow one another."""

import math

import numpy as np
import pytest
from closed_forms import slider_motion
from motion_scenes import (
    ECCENTRIC_MASS,
    ECCENTRICITY,
    INERTIA,
    MOMENTS,
    RADIUS,
    ROD,
    SWUNG_INERTIA,
    WEIGHT,
    ask,
    inertia_at,
    pendulum,
    rotor,
    run,
    slider_crank,
    steady,
)
from mpmath import mp
from scipy.optimize import brentq

from engine import Scene, Verdict, history

# Of small swings, rad/s.
RATE = math.sqrt(WEIGHT / SWUNG_INERTIA)
DOWN = -math.pi / 2


def swing(amplitude: float, only: str = "gravity", **regime: object) -> dict:
    """A pendulum let go from rest."""
    return pendulum({"go": run(only, from_speed=0.0, from_angle=DOWN + amplitude, **regime)})


def period(amplitude: float) -> float:
    """Of a pendulum: 4K(sin(amplitude/2))/RATE."""
    return float(4 * mp.ellipk(mp.sin(mp.mpf(amplitude) / 2) ** 2) / mp.mpf(RATE))


@pytest.mark.parametrize("amplitude", [0.3, 1.2, 2.8])
def test_pendulum__comes_back_after_the_period_by_the_elliptic_integral(amplitude):
    names = "go.angle go.final_speed go.speed_min go.speed_max go.other_work"
    turns = 5
    found = ask(swing(amplitude, time=turns * period(amplitude)), names, 240)
    # RK4 with steps of 2π/240 of an angle or of the time of a radian from rest: (0.026)⁴/120 a radian of phase, 2π a
    # swing; the slow turn of a wide swing has a rate of its own.
    allowed = turns * 2 * math.pi * 10 * (2 * math.pi / 240) ** 4 / 120
    assert abs(found["go.angle"]) <= allowed * amplitude
    assert abs(found["go.final_speed"]) <= allowed * 4 * RATE * 10
    # At the bottom ½Iω² is the weight's drop; the speeds are those at steps, h²/8 of the true ones away.
    fastest = 2 * RATE * math.sin(amplitude / 2)
    assert found["go.speed_max"] == pytest.approx(fastest, rel=1e-3)
    assert found["go.speed_min"] == pytest.approx(-fastest, rel=1e-3)
    assert abs(found["go.other_work"]) <= allowed * WEIGHT * amplitude


def next_turning(angle: float, friction: float) -> float:
    """Where a pendulum with friction turns round next, on the other side: E falls by friction × way."""

    def gap(x: float) -> float:
        return WEIGHT * (math.cos(x) - math.cos(angle)) - friction * (angle + x)

    # It is at rest here already; a little farther it has energy left, and on the other side as high up it hasn't.
    return brentq(gap, -angle * (1.0 - 1e-6), angle, xtol=1e-15, rtol=1e-15)


def test_pendulum_with_friction__each_half_swing_loses_friction_times_way():
    friction = 0.4
    turning, way = 1.2, 0.0
    reached = [turning]
    while WEIGHT * math.sin(turning) > friction:
        after = next_turning(turning, friction)
        way += turning + after
        turning = after
        reached.append(turning)
    assert len(reached) > 4
    found = ask(swing(1.2, "gravity rub", time=60.0), "go.angle go.final_speed go.harmful_work go.time", 240)
    side = 1.0 if len(reached) % 2 else -1.0
    # A few turning points, each met to the error of RK4, 1e-8 or so; √ of it where the last swing hardly turns.
    assert found["go.angle"] == pytest.approx(side * turning - 1.2, abs=1e-6)
    assert found["go.harmful_work"] == pytest.approx(friction * way, rel=1e-6)
    assert found["go.final_speed"] == 0.0
    assert found["go.time"] == 60.0
    first = ask(swing(1.2, "gravity rub", reversal=True), "go.angle", 240)
    assert first["go.angle"] == pytest.approx(-1.2 - reached[1], abs=1e-8)
    last = ask(swing(1.2, "gravity rub", rest=True), "go.angle go.time", 240)
    assert last["go.angle"] == pytest.approx(side * turning - 1.2, abs=1e-6)
    # Friction of constant moment shifts the middle of small swings, not their period; wide ones take longer.
    halves = len(reached) - 1
    assert halves * math.pi / RATE < last["go.time"] < halves * period(1.2) / 2


@pytest.mark.parametrize("load", [-0.5, -1.5])
def test_brake_that_stops_a_load__brings_it_to_rest_where_it_holds_it(load):
    # 0.8 N·m of the brake.
    ends = {"rests": {"rest": True}, "turns": {"reversal": True}}
    regimes = {name: run("brake load", from_speed=10.0, from_angle=0.0, **end) for name, end in ends.items()}
    scene = rotor(regimes, load={"moment": load})
    found = ask(scene, "turns.time turns.angle")
    assert found["turns.time"] == pytest.approx(INERTIA * 10.0 / (0.8 - load), rel=1e-9)
    assert found["turns.angle"] == pytest.approx(0.5 * 10.0 * found["turns.time"], rel=1e-9)
    rests = ask(scene, "rests.time")
    if load > -0.8:
        assert rests["rests.time"] == pytest.approx(found["turns.time"], rel=1e-9)
    else:
        assert rests.status == [Verdict.NO_END]


def test_pendulum_held_by_friction__stays():
    found = ask(swing(0.08, "gravity rub", time=3.0), "go.angle go.final_speed go.time")
    # 4.905·sin 0.08 = 0.39 N·m against 0.4 N·m.
    assert (found["go.angle"], found["go.final_speed"], found["go.time"]) == (0.0, 0.0, 3.0)
    assert ask(swing(0.083, "gravity rub", time=3.0), "go.angle")["go.angle"] < 0.0
    assert ask(swing(0.08, "gravity rub", cycles=1.0), "go.angle").status == [Verdict.STALLS]


def test_pendulum_let_go_at_the_bottom__stays_there():
    # cos(−π/2) is 6e-17, not 0: what pulls it away is rounding, and what it may swing through then as well.
    found = ask(swing(0.0, time=3.0), "go.angle go.final_speed go.time")
    assert abs(found["go.angle"]) < 1e-14
    assert abs(found["go.final_speed"]) < 1e-13
    assert found["go.time"] == 3.0


# One regime after another

REGIMES = {
    "start": run("dc fan gravity", speed=45.0),
    "working": run("dc fan gravity cut", cycles=6.25),
    "idle": run("dc fan gravity", time=0.7),
    "on": steady("dc fan gravity cut"),
    "stop": run("brake gravity rub", rest=True),
}


def test_schedule__each_regime_begins_where_the_one_before_ended():
    names = [f"{r}.{q}" for r in REGIMES for q in ("work_residual", "energy_change", "speed_min", "speed_max")]
    names += [f"{r}.{q}" for r in ("start", "working", "idle", "stop") for q in ("angle", "time", "final_speed")]
    found = ask(slider_crank(REGIMES, flywheel=0.2), " ".join(names), 240, "on.speed")
    assert found["start.final_speed"] == pytest.approx(45.0, rel=1e-14)
    assert found["working.angle"] == pytest.approx(12.5 * math.pi, rel=1e-14)
    assert found["idle.time"] == pytest.approx(0.7, rel=1e-14)
    assert found["stop.final_speed"] == 0.0

    # The same by one regime at a time, each told where it begins; with the speeds between, steps are the same.
    angle, omega = 0.0, 0.0
    for name in ("start", "working", "idle"):
        alone = REGIMES[name] | {"from_speed": omega, "from_angle": angle}
        one = ask(slider_crank({"go": alone}, flywheel=0.2), "go.angle go.final_speed go.time go.speed_max", 240)
        for key in ("angle", "final_speed", "time"):
            assert found[f"{name}.{key}"] == pytest.approx(one[f"go.{key}"], rel=1e-13), (name, key)
        angle, omega = angle + one["go.angle"], one["go.final_speed"]
    # After the steady regime: at φ = 0 with its speed there.
    begin = float(found.fields["on.speed"][0, 0])
    last = REGIMES["stop"] | {"from_speed": begin, "from_angle": 0.0}
    one = ask(slider_crank({"go": last}, flywheel=0.2), "go.angle go.time go.speed_max", 240)
    assert found["stop.angle"] == pytest.approx(one["go.angle"], rel=1e-13)
    assert found["stop.time"] == pytest.approx(one["go.time"], rel=1e-12)

    inertia = 0.2 + 0.02 + ECCENTRIC_MASS * ECCENTRICITY**2
    # At φ = 0 the ram stands still.
    assert found["stop.energy_change"] == pytest.approx(-0.5 * inertia * begin**2 + 0.5 * 0.0, rel=1e-12)
    for name in REGIMES:
        # Works and energy are the same integrals in the energy form: rounding. Near rest both have the error of time.
        assert abs(found[f"{name}.work_residual"]) <= (1e-12 if name in ("working", "idle", "on") else 1e-8), name


def test_regime_after_one_that_ends_only_with_some_steps__is_that_of_the_variant_alone():
    # Near the stall torque a speed is reached by some step lengths and not by others, which leaves other variants.
    regimes = {"creep": run("dc rub", speed=5e-11), "go": run("dc rub", time=1.0)}
    scene, path = rotor(regimes, dc={"no_load_speed": 10.0}), "moments.rub.moment"
    frictions = 20.0 - 20.0 * np.array([3.5e-11, 1e-8, 1e-3])
    every = ask(scene, "go.angle", varied={path: frictions})
    assert every.status == [Verdict.NO_END, Verdict.OK, Verdict.OK]
    for k in (1, 2):
        alone = ask(scene, "go.angle", varied={path: frictions[k : k + 1]})
        assert alone.status == [Verdict.OK]
        assert alone["go.angle"] == every.values["go.angle"][k]
        assert alone.figure("go.angle") == every.errors["go.angle"][k]


@pytest.mark.parametrize("load", [-25.0, -200.0])
def test_load_above_the_motor__turns_it_back_by_the_closed_form(load):
    """I ω' = M₀ (1 − ω/ω₀) + L keeps to one exponential, forward and backwards alike."""
    begin, stall, idle, time = 10.0, 20.0, 100.0, 3.0
    names = ["go.final_speed", "go.angle", "go.motor_work", "go.speed_min"]
    scene = rotor({"go": run("dc load", from_speed=begin, time=time)}, load={"moment": load})
    found = ask(scene, " ".join([*names, "go.efficiency"]))
    rate, end = stall / idle / INERTIA, idle * (1.0 + load / stall)
    fades = math.exp(-rate * time)
    speed = end + (begin - end) * fades
    angle = end * time + (begin - end) * (1.0 - fades) / rate
    work = 0.5 * INERTIA * (speed**2 - begin**2) - load * angle
    # A step misses 1e-10 of the angle it turns and of the speed.
    for name, exact in zip(names, (speed, angle, work, speed), strict=True):
        assert found[name] == pytest.approx(exact, rel=1e-8), name
        found.covers(name, exact)
    # What drives has no efficiency as a load.
    useful = -load * angle
    efficiency = useful / work if useful >= 0.0 and work > 0.0 else math.nan
    assert found["go.efficiency"] == pytest.approx(efficiency, rel=1e-8, nan_ok=True)


def test_push_that_turns_about__pulls_a_machine_back_against_its_friction():
    """M = 3 − 750 t: forward until ∫(M − R) dt is zero, then backwards against R."""
    friction, end = 0.4, 0.01
    table = {"over_time": [0.0, end], "moment": [3.0, -4.5]}
    found = ask(rotor({"go": run("by_time rub", from_speed=0.0, time=end)}, by_time=table), "go.final_speed", 240)
    turns = (3.0 - friction) / 375.0
    impulse = (3.0 + friction) * (end - turns) - 375.0 * (end**2 - turns**2)
    assert found["go.final_speed"] == pytest.approx(impulse / INERTIA, rel=1e-9)


def test_resistance_over_a_hundredth_of_a_radian__stops_a_pendulum_there_in_the_end():
    # Passing takes 0.2 J of 2.25 J, so the eleventh time the pendulum, moving forwards, stops within.
    friction, begin, end = 20.0, 0.3, 0.31
    places = [0.0, begin, begin, end, end]
    table = {"type": "table", "over_angle": [0.0, *((DOWN + x) % (2 * math.pi) for x in places[1:]), 2 * math.pi]}
    table |= {"interpolation": "linear"}
    loads = {
        "by_angle": table | {"moment": [0.0, 0.0, -friction, -friction, 0.0, 0.0], "acts": "along"},
        "load": table | {"moment": [0.0, 0.0, friction, friction, 0.0, 0.0], "acts": "against"},
    }
    regime = run("gravity by_angle load", from_speed=0.0, from_angle=DOWN - 1.0, rest=True)
    scene = pendulum({"go": regime})
    scene["moments"] = {name: moment | loads.get(name, {}) for name, moment in scene["moments"].items()}
    found = ask(scene, "go.angle")
    left = WEIGHT * (math.cos(begin) - math.cos(1.0)) - 10 * friction * (end - begin)
    exact = brentq(lambda x: WEIGHT * (math.cos(begin) - math.cos(x)) + friction * (x - begin) - left, begin, end)
    assert found["go.angle"] == pytest.approx(1.0 + exact, rel=1e-6)
    found.covers("go.angle", 1.0 + exact)


def test_jump_that_turns_a_machine_back_from_both_sides__holds_it_after_endlessly_many_swings():
    """4 N·m as far as the jump at 1 rad, −7 N·m beyond: the swings and their durations form geometric series."""
    push, wall, jump, friction = 4.0, 7.0, 1.0, np.array([1.5, 0.8])
    places, moments = [0.0, jump, jump, 5.0, 5.0, 2 * math.pi], [push, push, -wall, -wall, push, push]
    table = {"over_angle": places, "moment": moments}
    regimes = {"go": run("by_angle rub", rest=True), "waits": run("by_angle rub", from_angle=0.0, time=100.0)}
    scene = rotor(regimes, by_angle=table)
    names = "go.time go.angle go.harmful_work go.speed_max waits.angle waits.harmful_work"
    found = ask(scene, names, varied={"moments.rub.moment": friction})
    assert found.status == [Verdict.OK] * 2
    on, off = (push - friction) / INERTIA, (push + friction) / INERTIA
    out, home = (wall + friction) / INERTIA, (wall - friction) / INERTIA
    fastest = np.sqrt(2.0 * on * jump)
    back = fastest * np.sqrt(home / out)
    again = back * np.sqrt(on / off)
    first_swing = fastest / out + back / home + back / off + again / on
    exact = {
        "go.time": fastest / on + first_swing / (1.0 - again / fastest),
        "go.angle": jump,
        "go.harmful_work": push * jump,
        "go.speed_max": fastest,
        "waits.angle": jump,
        "waits.harmful_work": push * jump,
    }
    for name, value in exact.items():
        off = np.abs(found.values[name] - value)
        assert (off <= np.minimum(1e-6 * value, found.errors[name])).all(), name


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_braked_machine__rests_where_the_brake_has_taken_its_energy(direction):
    begin, speed, brake = 0.7, 30.0, MOMENTS["brake"]
    braking = brake["blocks"] * brake["force"] * brake["friction"] * brake["radius"]
    place = (begin + direction * 0.5 * INERTIA * speed**2 / braking) % (2 * math.pi)
    scene = rotor({"go": run("brake", from_speed=speed, from_angle=begin, rest=True)}, direction)
    found = ask(scene, "go.final_position go.ram.final_position")
    exact = {"go.final_position": place, "go.ram.final_position": slider_motion(place, RADIUS, ROD)[0]}
    for name, value in exact.items():
        # A step misses 1e-10 of the 36 turns to rest.
        assert found[name] == pytest.approx(value, abs=36 * 2 * math.pi * 1e-10), name
        found.covers(name, value)


@pytest.mark.parametrize("direction", [1.0, -1.0])
def test_run_from_an_angle_after_steady_running__begins_with_the_speed_there(direction):
    regimes = {"on": steady("dc gravity"), "stop": run("brake", from_angle=2.0, rest=True)}
    scene, positions = slider_crank(regimes, 10.0 * direction, flywheel=0.2), np.array([0, 17, 80, 119])
    angles = positions * 2 * math.pi / 120
    # Whole turns more or less are the same position.
    varied = {"regimes.stop.from_angle": [*angles, angles[1] - 2 * math.pi, angles[2] + 4 * math.pi]}
    found = ask(scene, "stop.energy_change on.speed_fluctuation", fields="on.speed", varied=varied)
    assert found.status == [Verdict.OK] * 6
    which = [*positions, 17, 80]
    speeds = found.fields["on.speed"][np.arange(6), which]
    assert np.ptp(speeds) > 0.01 * speeds.mean()
    energy = 0.5 * (0.2 + np.array([inertia_at(phi)[0] for phi in angles[[0, 1, 2, 3, 1, 2]]])) * speeds**2
    # The brake's run to rest misses 1e-10 a step, its field 1e-8 of the speed, so 2e-8 of the energy.
    assert found.values["stop.energy_change"] == pytest.approx(-energy, rel=2e-8)

    seen = history(Scene.model_validate(scene))
    assert list(dict.fromkeys(seen.regime)) == ["on", "stop"]
    first = np.flatnonzero(seen.regime == "stop")[0]
    before = (np.arange(seen.regime.size) < first) & (direction * seen.angle <= (direction * 2.0) % (2 * math.pi))
    assert seen.angle[first] == 2.0
    assert seen.speed[first] == pytest.approx(seen.speed[before][-1], rel=1e-3)
