"""Friction in pairs in true motion: closed forms of a rotor in its journal, balances and limits of a slider-crank."""

import math

import numpy as np
import pytest
from motion_scenes import Found, ask, run, slider_crank, steady

from engine import Machine, Scene, Verdict

MASS, INERTIA, COEFFICIENT, DIAMETER, GRAVITY = 2.0, 0.05, 0.2, 0.04, 9.81
# Radius of the friction circle: f r over the root of 1 + f².
ARM = COEFFICIENT * DIAMETER / 2 / math.sqrt(1.0 + COEFFICIENT**2)


def journal(regimes: dict, eccentricity: float, speed: float = 10.0, **numbers: float) -> Found:
    """What a rotor in a rough journal does."""
    scene = {
        "gravity": numbers.get("gravity", 0.0),
        "points": {"O": {"x": 0, "y": 0}},
        "input": {"type": "crank", "pivot": "O", "pin": "A", "length": 0.1, "speed": speed},
        "bodies": {"rotor": {"link": "crank", "mass": MASS, "x": eccentricity, "inertia": INERTIA}},
        "moments": {"push": {"type": "constant", "on": "crank", "moment": numbers.get("push", 0.0)}},
        "friction": {"main": {"pair": "input", "coefficient": COEFFICIENT, "diameter": DIAMETER}},
        "regimes": {"go": {"type": "run", **regimes}},
    }
    asked = "go.time go.angle go.final_speed go.harmful_work go.work_residual go.input.reaction.max"
    return ask(scene, asked, 120)


def covered(found: Found, name: str, value: float) -> None:
    """A number is what it should be, to its own error estimate."""
    assert found[name] == pytest.approx(value, rel=0, abs=found.figure(name)), name
    assert found.figure(name) <= 1e-5 * abs(value) + 1e-9, name


# Closed forms


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_rotor_under_its_weight__comes_to_rest_evenly(speed):
    found = journal({"from_speed": 20.0, "rest": True}, 0.0, speed, gravity=GRAVITY)
    rise = MASS * GRAVITY * ARM / INERTIA
    covered(found, "go.time", 20.0 / rise)
    covered(found, "go.angle", 20.0**2 / (2.0 * rise))
    covered(found, "go.harmful_work", 0.5 * INERTIA * 20.0**2)
    covered(found, "go.input.reaction.max", MASS * GRAVITY)


def test_unbalanced_rotor_without_weight__rubs_by_what_its_own_slowing_down_adds():
    found = journal({"from_speed": 50.0, "time": 2.0}, 0.1)
    # I ε = −ρ m e √(ω⁴ + ε²), so ε = −κ ω² with κ = k/√(1 − k²), k = ρ m e/I; then 1/ω = 1/ω₀ + κ t.
    k = ARM * MASS * 0.1 / (INERTIA + MASS * 0.1**2)
    kappa = k / math.sqrt(1.0 - k * k)
    covered(found, "go.final_speed", 1.0 / (1.0 / 50.0 + kappa * 2.0))
    covered(found, "go.angle", math.log1p(kappa * 50.0 * 2.0) / kappa)
    covered(found, "go.input.reaction.max", MASS * 0.1 * 50.0**2 * math.hypot(1.0, kappa))


def test_push_on_a_rotor__is_held_at_rest_up_to_the_moment_of_friction():
    held = MASS * GRAVITY * ARM
    for push, verdict in ((0.999 * held, Verdict.STALLS), (1.001 * held, Verdict.OK)):
        found = journal({"from_speed": 0.0, "cycles": 1.0}, 0.0, gravity=GRAVITY, push=push)
        assert found.status == [verdict], push
        if verdict == Verdict.OK:
            covered(found, "go.time", math.sqrt(2.0 * 2.0 * math.pi * INERTIA / (push - held)))


# A slider-crank that rubs in all of its pairs

PAIRS = {
    "pin": {"pair": "drive.inner", "coefficient": 0.1, "diameter": 0.03},
    "crank_pin": {"pair": "drive.first", "coefficient": 0.1, "diameter": 0.04},
    "main": {"pair": "input", "coefficient": 0.08, "diameter": 0.05},
    "skirt": {"pair": "drive.second", "coefficient": 0.12, "length": 0.08},
}


def rubbing(regimes: dict, share: float = 1.0, flywheel: float = 0.2, speed: float = 10.0, **changes: dict) -> dict:
    scene = slider_crank(regimes, speed, flywheel, **changes)
    scene["friction"] = {name: pair | {"coefficient": share * pair["coefficient"]} for name, pair in PAIRS.items()}
    return scene


def test_start__motors_pay_for_energy_loads_and_friction():
    names = "go.motor_work go.useful_work go.harmful_work go.other_work go.energy_change go.work_residual go.angle"
    found = ask(rubbing({"go": run("dc cut gravity", speed=30.0)}), names, 120)
    work = {name.rpartition(".")[2]: found[name] for name in found.values}
    assert work["harmful_work"] > 1.0
    # What the cut takes counts among what is neither useful nor harmful.
    paid = work["motor_work"] + work["other_work"] - work["useful_work"] - work["harmful_work"]
    assert paid == pytest.approx(work["energy_change"], rel=1e-6)
    assert abs(work["work_residual"]) <= found.figure("go.work_residual") + 1e-9


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_steady_motion__is_in_balance_at_every_instant_and_without_friction_what_it_was(speed):
    fields = ("input_moment", "input_moment_by_equilibrium", "friction_moment", "speed", "acceleration")
    asked = " ".join(f"on.{name}" for name in fields)
    cut = {"on": steady("dc cut gravity")}
    smooth = ask(slider_crank(cut, speed, 0.2), "on.mean_speed on.multiplier", 120, "on.speed on.input_moment")
    found = {share: ask(rubbing(cut, share, 0.2, speed), "on.mean_speed", 120, asked) for share in (1.0, 1e-12)}
    for each in found.values():
        given, needed = (each.fields[f"on.{name}"][0] for name in fields[:2])
        # What motor and flywheel give, and what the crank's equilibrium needs, friction in all pairs included.
        np.testing.assert_allclose(given, needed, rtol=0, atol=1e-10 * np.abs(given).max())
    assert found[1.0]["on.mean_speed"] < found[1e-12]["on.mean_speed"] - 1.0
    way = math.copysign(1.0, speed)
    assert (way * found[1.0].fields["on.friction_moment"] < 0.0).all()
    room = found[1e-12].figure("on.mean_speed") + smooth.figure("on.mean_speed")
    assert found[1e-12]["on.mean_speed"] == pytest.approx(smooth["on.mean_speed"], rel=0, abs=room)
    # With friction the cycle is a run in time. Within a step of H ≤ 0.1 rad the angle is a polynomial of degree five
    # that is right at both ends up to the second derivative: its slope misses ω·H⁵/720·max|d/ds s³(1 − s)³|·ω⁽⁵⁾/ω⁶,
    # where the greatest of |d/ds s³(1 − s)³| is 0.0537 and ω⁽⁵⁾ at most 1.1 ω⁶.
    within = 0.1**5 / 720.0 * 0.0537 * 1.1 * smooth["on.mean_speed"]
    np.testing.assert_allclose(found[1e-12].fields["on.speed"], smooth.fields["on.speed"], rtol=0, atol=room + within)


def test_heavy_flywheel__needs_the_moment_of_uniform_speed():
    found = ask(rubbing({"on": steady("dc cut gravity")}, flywheel=100.0), "on.mean_speed", 120)
    scene = rubbing({}, flywheel=100.0, speed=found["on.mean_speed"])
    acting = {"cut": scene["forces"]["cut"]}
    scene |= {"moments": {}, "forces": acting, "regimes": {}}
    outcome = Machine(Scene.model_validate(scene), ["input_moment_with_friction.mean"]).evaluate({})
    # The motor's line: 20 N·m at rest, nothing at 100 rad/s.
    given = 20.0 * (1.0 - found["on.mean_speed"] / 100.0)
    # The flywheel leaves 11 J of excess work over I ω² of the speed, about 2e-5; and the speed's own figure.
    room = 1e-3 + 0.2 * found.figure("on.mean_speed")
    assert given == pytest.approx(outcome.summaries["input_moment_with_friction.mean"][0], rel=0, abs=room)


def test_run_that_begins_where_friction_jumps__is_looked_at_behind_the_jump():
    """At the dead centre itself the slider stands, and its guide doesn't rub."""
    near, found, names = 1e-7, [], "go.acceleration.max go.drive.inner.reaction.max"
    for begin in (0.0, near):
        scene = rubbing({"go": run("dc gravity", from_angle=begin, from_speed=5.0, cycles=0.1)})
        found.append(ask(scene, names))
    for name in names.split():
        # Curves change by a few times themselves, some hundred rad/s² and N, within a radian.
        assert found[0][name] == pytest.approx(found[1][name], abs=1e4 * near), name
