"""Runs of machines of constant inertia against quadratures, by the numerical methods (see `motion_scenes.rotor`).

With I constant and M(ω), from one speed to another t = ∫ I dω/M and φ = ∫ I·ω dω/M; with M(φ), ½I·ω² grows by ∫M dφ;
with M(t), I·ω by ∫M dt.
"""

import math
from collections.abc import Callable

import numpy as np
import pytest
from motion_scenes import BY_ANGLE, BY_TIME, INERTIA, MOMENTS, ask, dc_moment, kloss_moment, rotor, run
from mpmath import mp

from engine import Verdict

POSITIONS = 480
STEP = 2 * math.pi / POSITIONS
PUSH, LOAD, BRAKE = MOMENTS["push"]["moment"], MOMENTS["load"]["moment"], -0.8
OIL, FAN = (mp.mpf(MOMENTS[name]["coefficient"]) for name in ("oil", "fan"))

# What acts, M(ω), speeds at begin and end, and the greatest share of ω² or M that changes per radian: M/(½Iω²), or
# M′/(Iω). Within a radian of rest, where steps are in time, a step is a share of what a radian takes: 2.
LAWS: dict[str, tuple[str, Callable, float, float, float]] = {
    "constant, speeding up": ("push", lambda w: PUSH + 0 * w, 5.0, 60.0, 0.6),
    "constant, from rest": ("push", lambda w: PUSH + 0 * w, 0.0, 60.0, 2.0),
    "constant, slowing down": ("load", lambda w: LOAD + 0 * w, 60.0, 5.0, 0.4),
    "oil, slowing down": ("oil", lambda w: -OIL * w, 90.0, 20.0, 0.1),
    "fan, slowing down": ("fan", lambda w: -FAN * w * w, 90.0, 20.0, 0.1),
    "fan, driven": ("push fan", lambda w: PUSH - FAN * w * w, 5.0, 50.0, 0.6),
    "DC motor from rest": ("dc oil", lambda w: dc_moment(w) - OIL * w, 0.0, 70.0, 2.0),
    "DC motor": ("dc oil", lambda w: dc_moment(w) - OIL * w, 5.0, 79.0, 4.0),
    "DC motor, braking": ("dc oil", lambda w: dc_moment(w) - OIL * w, 130.0, 82.0, 0.1),
    "DC motor with fan": ("dc fan", lambda w: dc_moment(w) - FAN * w * w, 5.0, 70.0, 4.0),
    "induction motor from rest": ("induction load", lambda w: kloss_moment(w) + LOAD, 0.0, 19.0, 2.0),
    "induction motor": ("induction load", lambda w: kloss_moment(w) + LOAD, 3.0, 19.7, 3.0),
    "induction motor, generating": ("induction", lambda w: kloss_moment(w), 27.0, 20.1, 1.2),
    "two motors": ("induction dc fan", lambda w: kloss_moment(w) + dc_moment(w) - FAN * w * w, 5.0, 22.0, 6.0),
}


def until(moment: Callable, begin: float, end: float) -> tuple[float, float]:
    """Time and angle from one speed to another, by Gauss's quadrature at 30 digits, in pieces of equal speed."""
    with mp.workdps(30):
        pieces = mp.linspace(begin, end, 17)
        time = mp.quad(lambda w: INERTIA / moment(w), pieces)
        angle = mp.quad(lambda w: INERTIA * w / moment(w), pieces)
    return float(time), float(angle)


def tolerance(rate: float) -> float:
    """Relative error of RK4: (h·rate)⁴/120 for each length 1/rate, of which some 30 count; and rounding."""
    return 30 * (STEP * rate) ** 4 / 120 + 1e-11


@pytest.mark.parametrize("by", ["speed", "time", "cycles"])
@pytest.mark.parametrize("law", LAWS)
def test_moment_by_speed__time_angle_and_speed_as_by_quadrature(law, by):
    only, moment, begin, end, rate = LAWS[law]
    time, angle = until(moment, begin, end)
    goal = {"speed": end, "time": time, "cycles": angle / (2 * math.pi)}
    scene = rotor({"go": run(only, from_speed=begin, **{by: goal[by]})})
    found = ask(scene, "go.time go.angle go.final_speed", POSITIONS)
    for name, value in (("time", time), ("angle", angle), ("final_speed", end)):
        assert found[f"go.{name}"] == pytest.approx(value, rel=tolerance(rate)), name


# The published brake (K. V. Frolov et al., Theory of Mechanisms and Machines, run-down with a block brake)


@pytest.mark.parametrize("structure", ["rotor", "slider-crank"])
def test_block_brake__stops_in_50_s_and_398_revolutions(structure):
    scene = rotor({"stop": run("brake", from_speed=100.0, rest=True)})
    if structure == "rotor":
        # Nothing but the crank: its inertia is constant by the structure, and the run may be solved in closed form.
        scene["groups"], scene["bodies"]["ram_body"] = {}, {"link": "crank", "mass": 0.0}
        scene["forces"], scene["guides"] = {}, {}
        scene["regimes"]["stop"]["off"].remove("cut")
    found = ask(scene, "stop.time stop.angle stop.final_speed stop.brake_heat", POSITIONS)
    # The time goes with √ of the angle that is left, of which a step near rest takes a share of STEP or so.
    allowed = tolerance(2.0) if structure == "slider-crank" else 1e-12
    assert found["stop.time"] == pytest.approx(50.0, rel=allowed)
    assert found["stop.angle"] == pytest.approx(2500.0, rel=allowed)
    assert round(found["stop.angle"] / (2 * math.pi)) == 398
    assert found["stop.final_speed"] == 0.0
    # ½·0.4·100² J.
    assert found["stop.brake_heat"] == pytest.approx(2000.0, rel=1e-11)


# M(φ) and M(t)


def test_moment_over_angle__speed_by_its_work():
    turn = np.trapezoid(BY_ANGLE[1], BY_ANGLE[0])
    # Up to π: 3.5 J to the jump, then from −1 by 4/3 N·m/rad.
    rest = math.pi - 1.0
    half = 3.5 + rest * (-1.0 + 2 / 3 * rest)
    for cycles, work in ((1.0, turn), (7.0, 7 * turn), (7.5, 7 * turn + half)):
        found = ask(rotor({"go": run("by_angle", from_speed=20.0, cycles=cycles)}), "go.final_speed", POSITIONS)
        # A jump of 3 N·m is a piece of 2e-10 rad whose moment is that of one side or the other, out of 80 J.
        allowed = 2e-10 * 3 / 80 * (cycles + 1)
        assert found["go.final_speed"] == pytest.approx(math.sqrt(400.0 + 2 * work / INERTIA), rel=allowed)


@pytest.mark.parametrize("begin", [0.0, 5.0])
def test_moment_over_time__speed_and_angle_by_its_impulse(begin):
    impulse = twice = 0.0
    # ∫M dt and ∫(6 − t)·M dt by Simpson's rule, exact for them between the table's rows.
    for a, b in [(0.0, 1.0), (1.0, 3.0), (3.0, 6.0)]:
        t = np.array([a, 0.5 * (a + b), b])
        m = np.interp(t, *BY_TIME)
        impulse += (b - a) / 6 * (m @ [1.0, 4.0, 1.0])
        twice += (b - a) / 6 * (((6.0 - t) * m) @ [1.0, 4.0, 1.0])
    expected = {"go.final_speed": begin + impulse / INERTIA, "go.angle": 6.0 * begin + twice / INERTIA}
    found = ask(rotor({"go": run("by_time", from_speed=begin, time=6.0)}), " ".join(expected), 120)
    for name, value in expected.items():
        # RK4 integrates a moment linear in time exactly; across a bend by 4 N·m/s a step of 5 ms errs by up to
        # 4·0.005²/12 N·m·s of 20.
        assert found[name] == pytest.approx(value, rel=1e-6), name
        assert abs(found[name] - value) <= found.figure(name) + 1e-13 * value, name


# Ends


@pytest.mark.parametrize("regime", [{"cycles": 3.0}, {"time": 5.0}, {"speed": 30.0}])
@pytest.mark.parametrize("more", ["", " nothing"], ids=["energy form", "time form"])
def test_ends__are_met_exactly(regime, more):
    found = ask(
        rotor({"go": run("dc oil by_angle" + more, from_speed=5.0, **regime)}), "go.time go.angle go.final_speed", 40
    )
    goal = {"cycles": ("go.angle", 6 * math.pi), "time": ("go.time", 5.0), "speed": ("go.final_speed", 30.0)}
    name, value = goal[next(iter(regime))]
    # Found to a few bits.
    assert found[name] == pytest.approx(value, rel=1e-14)


def test_speed_never_reached__no_end():
    found = ask(rotor({"go": run("dc oil", from_speed=5.0, speed=95.0, at_most=300.0)}), "go.time")
    # The steady speed is 20/(0.2 + 0.05) = 80 rad/s.
    assert found.status == [Verdict.NO_END]
    assert np.isnan(found.values["go.time"]).all()
