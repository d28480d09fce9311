"""Runs by the classical method of order four: its order, its error estimate, where it is refused, what it is called."""

import numpy as np
import pytest
from each_case import refusals
from motion_scenes import Found, ask, rotor, run, slider_crank
from numpy.polynomial import Polynomial

from engine import Machine, Scene, Verdict
from engine.mechanism.mechanics import Mechanics
from engine.motion.cases import regime_text

ASKED = "go.time go.final_speed"


def gone(steps: int | None, **changes: dict):
    named = {} if steps is None else {"method": "rk4", "steps_per_turn": steps}
    at = {"times": "0 s to 0.25 s, 6"}
    scene = slider_crank({"go": run("dc gravity", from_speed=20.0, cycles=3.0, at=at, **named)}, **changes)
    return ask(scene, ASKED, 120, "go.speed")


def test_error__falls_with_the_fourth_power_and_stays_within_its_figure():
    exact, sure = gone(None), {}
    for steps in (16, 32, 64, 128):
        found = gone(steps)
        found.agrees(exact)
        for name in ASKED.split():
            error = abs(found[name] - exact[name])
            # It is what steps of twice the length change: sixteen times the error, were these as short as that.
            assert found.figure(name) <= 200.0 * error + exact.figure(name), (steps, name)
            sure.setdefault(name, []).append(error / exact[name])
        rows, right = found.fields["go.speed"][0], exact.fields["go.speed"][0]
        assert np.abs(rows - right).max() <= found.figure("go.speed") + exact.figure("go.speed")
    for name, errors in sure.items():
        order = Polynomial.fit(np.log2([16, 32, 64, 128]), np.log2(errors), 1).convert().coef[1]
        assert -5.0 < order < -3.8, (name, errors)


def test_jumps_closer_than_a_step__are_in_the_figure():
    # The cut takes a twentieth of a turn, a single step of 22.5°; on a heavy wheel little else is missed.
    def found(**named: object) -> Found:
        return ask(slider_crank({"go": run("cut", from_speed=20.0, cycles=1.0, **named)}, flywheel=20.0), ASKED)

    exact = found()
    for steps in (16, 24, 32, 48, 64):
        made = found(method="rk4", steps_per_turn=steps)
        made.agrees(exact)


def test_method_that_is_named__is_used_and_told():
    # ω = ω₀(1 − e^(−t/T)) after 1 s, with T = I ω₀/M₀ = 2 s.
    named = {"method": "rk4", "steps_per_turn": 32}
    scene = rotor({"go": run("dc", from_speed=20.0, time=1.0, **named)})
    found = ask(scene, ASKED)
    true = 100.0 - 80.0 * np.exp(-0.5)
    assert 0.0 < abs(found["go.final_speed"] - true) <= found.figure("go.final_speed")
    assert regime_text(Mechanics(Scene.model_validate(scene)))[0][2] == "energy form, by rk4 in 32 steps a turn"


def test_start__near_rest_steps_go_in_time():
    def start(**named):
        return ask(slider_crank({"go": run("dc gravity", from_speed=0.0, cycles=1.0, **named)}), ASKED)

    found, exact = start(method="rk4", steps_per_turn=128), start()
    found.agrees(exact)
    for name in ASKED.split():
        assert found[name] == pytest.approx(exact[name], rel=1e-6)


def test_steep_motor__gets_a_verdict_and_as_short_steps_as_it_needs():
    # λ = M₀/(ω₀² I) per radian, I some 0.022 kg·m²: 90 for 2e4 N·m; steps of more than 2.785/λ blow up.
    assert gone(64, dc={"stall_moment": 2e4}).status == [Verdict.TOO_COARSE]
    short, exact = gone(2048, dc={"stall_moment": 2e4}), gone(None, dc={"stall_moment": 2e4})
    short.agrees(exact)
    for name in ASKED.split():
        assert short[name] == pytest.approx(exact[name], rel=1e-4)


test_nonsense__is_refused_in_words = refusals(
    lambda only, regime: Machine(
        Scene.model_validate(rotor({"go": run(only, from_speed=1.0, cycles=1.0, **regime)})), ["go.time"]
    ),
    ("dc", {"method": "rk4"}, "belong together"),
    ("dc", {"steps_per_turn": 64}, "belong together"),
    ("dc", {"method": "rk5", "steps_per_turn": 64}, "'rk4'"),
    ("dc", {"method": "rk4", "steps_per_turn": 4}, "must be at least 8"),
    ("by_time", {"method": "rk4", "steps_per_turn": 64}, "moments that depend on time"),
)
