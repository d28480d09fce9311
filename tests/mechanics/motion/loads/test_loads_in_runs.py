"""Loads on the pairs in runs: closed forms of a rotor and of a pendulum, Newton and Euler, and error estimates."""

import math

import numpy as np
import pytest
from machines import compare
from motion_scenes import (
    ARM,
    CLUTCH,
    GRAVITY,
    RATIO,
    SWUNG_INERTIA,
    SWUNG_MASS,
    WEIGHT,
    ask,
    behind,
    pendulum,
    rotor,
    run,
    slider_crank,
    steady,
)
from newton_euler import reactions
from oracle import EPS

from engine import AskError, History, Machine, Scene, Verdict, history
from engine.motion.quantities import EXTREMES

PAIRS = ("input.reaction", "drive.first.reaction", "drive.inner.reaction", "drive.second.reaction")
COLUMNS = (
    *(f"{pair}_{axis}" for pair in PAIRS[:3] for axis in "xy"),
    "drive.second.reaction",
    "drive.second.reaction_moment",
    *(f"frame.reaction_{part}" for part in ("x", "y", "moment")),
)
# Always the same is asked, so that all machines share their functions.
ASKED = [f"{pair}.{key}" for pair in (*PAIRS, "shaking_force", "acceleration", "speed") for key in EXTREMES]


def asked(*regimes: str) -> str:
    return " ".join(f"{regime}.{name}" for regime in regimes for name in ASKED)


# Closed forms


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_rotor_under_a_constant_moment__accelerates_evenly_and_loads_its_bearing_by_the_centrifugal_force(speed):
    # M = 3 N·m on a rotor of 0.4 kg·m², whose masses are zero; then a mass of 2 kg on an arm of 30 mm.
    scene = slider_crank(
        {"go": run("push", from_speed=0.0, cycles=3.0)}, speed, push={"moment": math.copysign(3, speed)}
    )
    scene["bodies"]["ram_body"]["mass"] = 0.0
    found = ask(scene, asked("go"), 240)
    mass, arm = 2.0, 0.03
    epsilon = 3.0 / (0.02 + mass * arm**2)
    top = math.sqrt(2.0 * epsilon * 6.0 * math.pi)
    for end in ("min", "max"):
        found.covers(f"go.acceleration.{end}", math.copysign(epsilon, speed))
    found.covers("go.speed.max", top)
    assert found["go.speed.max_time"] == pytest.approx(top / epsilon, rel=1e-9)
    # Centrifugal and tangential inertia of the mass: m e √(ω⁴ + ε²).
    for name in ("input.reaction", "shaking_force"):
        found.covers(f"go.{name}.min", mass * arm * epsilon)
        found.covers(f"go.{name}.max", mass * arm * math.hypot(top**2, epsilon))
        assert found[f"go.{name}.min_time"] == 0.0


@pytest.mark.parametrize("speed", [10.0, -10.0])
@pytest.mark.parametrize("before", [-5.0, 9.0])
def test_extreme_at_a_jump__is_that_of_its_own_side(speed, before):
    """Moments over the angle jump at 1 rad; moments over time leave no form but that over time."""
    table = {"over_angle": [0.0, 1.0, 1.0, 6.0], "moment": [2.0, before, 7.0 - before, 2.0], "outside": "hold"}
    scene = rotor({"go": run("by_angle nothing", from_speed=30.0, cycles=1.0)}, speed, by_angle=table)
    found = ask(scene, "go.load_moment.min go.load_moment.max", 240)
    # The table falls by 12 N·m/rad at most, and is read 1e-10 rad beside the jump.
    for name, value in (("min", min(before, 7.0 - before)), ("max", max(before, 7.0 - before))):
        found.covers(f"go.load_moment.{name}", value)
        assert found.figure(f"go.load_moment.{name}") <= 1e-8


def test_pendulum_let_go__bears_its_weight_and_twice_the_energy_of_its_fall():
    # From the horizontal, until it comes to the same height again on the other side.
    scene = pendulum({"go": run("gravity", from_angle=math.pi, from_speed=0.0, reversal=True)})
    found = ask(scene, asked("go"), 240)
    # At the bottom: ½ I ω² = m g e, and R = m g + m ω² e; at the ends: ε = m g e/I, and R = m (g − ε e).
    omega_squared, epsilon = 2.0 * WEIGHT / SWUNG_INERTIA, WEIGHT / SWUNG_INERTIA
    found.covers("go.input.reaction.max", SWUNG_MASS * GRAVITY + SWUNG_MASS * omega_squared * ARM)
    found.covers("go.input.reaction.max_at", 1.5 * math.pi)
    found.covers("go.input.reaction.min", SWUNG_MASS * (GRAVITY - epsilon * ARM))
    found.covers("go.acceleration.max", epsilon)
    found.covers("go.acceleration.min", -epsilon)
    found.covers("go.acceleration.amplitude", epsilon)


# Against Newton and Euler, at the instants of a history


def test_start_and_stop__newton_euler_at_every_instant():
    # Clockwise; the clutch below turns either way.
    # No load is at work but weight: resistances change their sign with the motion, which the oracle isn't told.
    regimes = {"go": run("dc gravity", speed=40.0), "on": steady("dc gravity"), "stop": run("brake gravity", rest=True)}
    loads_are_in_equilibrium(slider_crank(regimes, -10.0, flywheel=0.2), COLUMNS)


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_clutch_that_slips_and_opens__newton_euler_at_every_instant(speed):
    spin = run("dc gravity", time=0.3)
    regimes = {"spin": spin, "go": run("dc gravity", time=0.4), "stop": run("brake gravity", rest=True)}
    scene = behind(slider_crank(regimes, speed, flywheel=0.2), open_in="spin stop", clutch=CLUTCH)
    # Besides, the shaft's inertia turns the frame.
    seen = loads_are_in_equilibrium(scene, COLUMNS[:-1])
    slips = (seen.regime == "go") & (np.abs(seen.shaft_speed) > RATIO * np.abs(seen.speed) * (1 + 1e-9))
    assert 0.1 < slips.sum() / (seen.regime == "go").sum() < 0.9


def loads_are_in_equilibrium(machine: dict, columns: tuple[str, ...]) -> History:
    """The history of a slider-crank, its loads on pairs compared with those at its speeds and accelerations."""
    scene, speed = Scene.model_validate(machine), machine["input"]["speed"]
    seen = history(scene, 120, columns)
    assert seen.verdict == Verdict.OK
    bare = slider_crank({}, speed)
    bare |= {"moments": {}, "forces": {}, "flywheel": None}
    bare = Scene.model_validate({key: value for key, value in bare.items() if value is not None})
    for name in dict.fromkeys(seen.regime):
        some = np.flatnonzero(seen.regime == name)[::59]
        q, omega, epsilon = seen.angle[some], seen.speed[some], seen.acceleration[some]
        found = {key: seen.loads_on_pairs[key][some] for key in columns}
        if "frame.reaction_moment" in found:
            # The flywheel, on the crank, turns the frame; what a brake does to crank and frame adds up to zero.
            found["frame.reaction_moment"] = found["frame.reaction_moment"] + 0.2 * epsilon
        # Angles go on beyond a turn, and round as what they have grown to.
        rounding = EPS * (1.0 + np.abs(q).max())
        compare(found, bare, lambda of, at=(q, omega, epsilon): reactions(of, *at), rounding)
    return seen


def test_history__comes_near_the_extremes_and_never_beyond():
    regimes = {"go": run("dc cut gravity fan rub", speed=50.0), "stop": run("brake gravity rub", rest=True)}
    scene = slider_crank(regimes, flywheel=0.05)
    found, seen = ask(scene, asked(*regimes), 240), history(Scene.model_validate(scene), 240, PAIRS)
    for name in regimes:
        own = seen.regime == name
        for pair in PAIRS:
            row = np.abs(seen.loads_on_pairs[pair][own]) if pair == PAIRS[3] else seen.loads_on_pairs[pair][own]
            key = "peak" if pair == PAIRS[3] else "max"
            peak = found[f"{name}.{pair}.{key}"]
            # Between instants 0.026 rad apart: h²/8 of what changes within 0.3 rad.
            assert -found.figure(f"{name}.{pair}.{key}") <= peak - row.max() <= 1e-3 * peak, pair
        energy = seen.energy[own]
        works = np.array([seen.motor_moment[own], *(row[own] for row in seen.load_moments.values())]).sum(axis=0)
        # Power balance between instants by the trapezoid rule: h²/12·M″, h = 0.026 rad, M changes within 0.3 rad.
        done = np.sum(0.5 * (works[1:] + works[:-1]) * np.diff(seen.angle[own]))
        assert done == pytest.approx(energy[-1] - energy[0], rel=2e-3)


# Error figures


@pytest.mark.parametrize("only", ["dc cut gravity fan rub", "dc by_time gravity", "induction cut gravity"])
def test_error_figures__cover_what_little_accuracy_misses(only):
    scene = slider_crank({"go": run(only, time=0.6)}, flywheel=0.5 if "induction" in only else 0.05)
    rough, fine = (ask(scene, asked("go"), accuracy=accuracy) for accuracy in (1e-3, 1e-10))
    rough.agrees(fine, *(name for name in rough.values if not name.endswith(("_at", "_time"))))


# What can't be


def test_means_of_runs__are_not_offered():
    scene = slider_crank({"go": run("dc cut", time=1.0)}, flywheel=0.2)
    with pytest.raises(AskError, match="not a summary"):
        Machine(Scene.model_validate(scene), ["go.input.reaction.mean"])
