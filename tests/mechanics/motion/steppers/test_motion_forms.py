"""The energy form and the form in time: conservation, references at 30 digits, agreement with each other."""

import json
from pathlib import Path

import numpy as np
import pytest
from motion_scenes import ask, reduced, run, slider_crank
from mpmath import mp

from engine import Mechanics, Scene, Verdict
from engine.motion.moments.dynamics import Dynamics, Reduction
from engine.stepping.methods import NINE

REFERENCE = json.loads((Path(__file__).parents[3] / "oracles" / "motion" / "motion_reference.json").read_text())


# Energy


def test_unloaded_machine__keeps_its_energy_over_3000_revolutions():
    def found(cycles: float) -> tuple:
        scene = slider_crank({"go": run("", from_speed=20.0, from_angle=0.3, cycles=cycles, at_most=1e4)})
        return ask(scene, "go.time go.final_speed go.energy_change go.speed_max", 60)

    short, whole, both = found(0.3), found(1.0), found(3e3 + 0.3)
    assert whole["go.energy_change"] == 0.0
    # The angle is known to 2π·3e3·1.1e-16 rad, where ½ω²·dI/dφ is some 2 J/rad.
    assert abs(both["go.energy_change"]) <= 2.1e-12 * 4
    assert both["go.final_speed"] == pytest.approx(short["go.final_speed"], rel=2.1e-12)
    # The first cycle is the same step by step; those after it go with steps of their own, which see the top elsewhere.
    with mp.workdps(30):
        least = min(reduced(phi)[0] for phi in (mp.mpf(0), mp.pi))
        fast = float(20 * mp.sqrt(reduced(mp.mpf(0.3))[0] / least))
    for own in (whole, both):
        own.covers("go.speed_max", fast)
    # Cubics between places of a step.
    assert fast * (1.0 - 1e-6) <= whole["go.speed_max"] <= both["go.speed_max"] <= fast * (1.0 + 1e-6)
    # Steps miss 1e-10 of a cycle's time each, and all cycles the same.
    assert both["go.time"] == pytest.approx(3e3 * whole["go.time"] + short["go.time"], rel=1e-10)


@pytest.mark.parametrize("works", [False, True])
@pytest.mark.parametrize("first", ["by_angle", "by_time"])
def test_both_forms__have_one_function_of_the_position(first, works):
    scene = slider_crank({"go": run("dc fan gravity load", from_speed=20.0, cycles=1.0)})
    dynamics = Dynamics(Reduction(Mechanics(Scene.model_validate(scene))), works=works)
    systems = getattr(dynamics, first), dynamics.by_angle, dynamics.by_time
    assert len({system.functions.codes["places"] for system in systems}) == 1


# Two machines against mpmath at 30 digits

MACHINES = {"dc": ("dc fan gravity", 20.0, 0.0), "induction": ("induction load gravity", 15.0, 0.5)}


def three_turns(name: str, positions: int, more: str = "") -> dict[str, float]:
    only, begin, flywheel = MACHINES[name]
    scene = slider_crank({"go": run(only + more, from_speed=begin, cycles=3.0)}, flywheel=flywheel)
    found = ask(scene, "go.time go.final_speed", positions)
    return {
        "omega": found["go.final_speed"],
        "time": found["go.time"],
        "omega_figure": found.figure("go.final_speed"),
        "time_figure": found.figure("go.time"),
    }


# What steps may miss, for order eight to show: each of a few a turn adds as much.
TOLERANCES = (1e-5, 1e-7, 1e-9, 1e-11)


def steps_and_errors(name: str, more: str, monkeypatch: pytest.MonkeyPatch) -> dict[str, np.ndarray]:
    """Relative errors by tolerance, within their figures."""
    errors = {"omega": [], "time": []}
    for tolerance in TOLERANCES:
        monkeypatch.setattr("engine.motion.asked_regimes.RUN_TOLERANCE", tolerance)
        found = three_turns(name, 120, more)
        for key, seen in errors.items():
            true = float(REFERENCE[name][key])
            error = abs(found[key] - true)
            assert error <= found[f"{key}_figure"] + 1e-13 * true, (key, tolerance)
            seen.append(error / true)
    return {key: np.array(seen) for key, seen in errors.items()}


@pytest.mark.parametrize("more", ["", " nothing"], ids=["energy form", "time form"])
@pytest.mark.parametrize("name", MACHINES)
def test_three_turns__as_mpmath_at_30_digits_within_figures(name, more, monkeypatch):
    for errors in steps_and_errors(name, more, monkeypatch).values():
        # Some tens of steps, none of them amplified.
        assert (errors <= 100 * np.array(TOLERANCES)).all(), errors


@pytest.mark.parametrize("name", MACHINES)
def test_implicit_steps__as_mpmath_at_30_digits_within_figures(name, monkeypatch):
    monkeypatch.setattr("engine.motion.runs.run_in_angle.EIGHT", NINE)
    for errors in steps_and_errors(name, "", monkeypatch).values():
        assert (errors <= 100 * np.array(TOLERANCES)).all(), errors


# One form against the other


@pytest.mark.parametrize(
    ("only", "regime"),
    [
        ("dc fan gravity", {"from_speed": 20.0, "cycles": 2.3}),
        ("induction load gravity cut", {"from_speed": 15.0, "time": 0.9}),
        ("dc fan cut", {"speed": 40.0}),
        ("brake gravity cut", {"from_speed": 20.0, "speed": 10.0}),
        ("rub cut", {"from_speed": 10.0, "rest": True}),
    ],
)
def test_energy_form_and_time_form__agree_within_their_figures(only, regime):
    names = "go.time go.angle go.final_speed go.motor_work go.useful_work go.harmful_work"
    energy, time = (
        ask(slider_crank({"go": run(only + more, **regime)}, flywheel=0.5), names, 240) for more in ("", " nothing")
    )
    for name in names.split():
        sum_of_figures = energy.figure(name) + time.figure(name)
        assert abs(energy[name] - time[name]) <= 3 * sum_of_figures + 1e-12 * abs(energy[name]), name
        # Figures alone could be large.
        assert energy[name] == pytest.approx(time[name], rel=2e-6, abs=1e-9), name


# Extremes of the speed, of which steps of long runs see only those of the first and the last cycle


@pytest.mark.parametrize(
    ("begin", "end"),
    [
        (20.0, {"cycles": 12.3}),
        (90.0, {"cycles": 12.3}),
        (20.0, {"time": 1.9}),
        (90.0, {"time": 1.9}),
        (20.0, {"speed": 60.0}),
        (90.0, {"speed": 82.0}),
    ],
)
def test_extremes_of_the_speed__are_those_that_are_seen_cycle_by_cycle(begin, end):
    scene = slider_crank({"go": run("dc fan gravity cut", from_speed=begin, **end)}, flywheel=0.3)
    found = ask(scene, "go.speed_max go.speed_min go.speed.max go.speed.min", 720)
    assert found.status == [Verdict.OK]
    for name in ("max", "min"):
        found.covers(f"go.speed_{name}", found[f"go.speed.{name}"], found.figure(f"go.speed.{name}"))
