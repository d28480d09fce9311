"""Friction in pairs beside a clutch or a fluid coupling: closed forms of a rotor in its journal, and a slider-crank."""

import math

import pytest
from motion_scenes import GRAVITY, INERTIA, MOMENTS, RATIO, ask, rotor, run, slider_crank, steady

from engine import Verdict

COEFFICIENT, DIAMETER, MASS = 0.2, 0.04, 6.0
# Torque of friction in the journal, by its friction circle.
HELD = MASS * GRAVITY * COEFFICIENT * DIAMETER / 2 / math.sqrt(1.0 + COEFFICIENT**2)
SHAFT_INERTIA = 0.004
CLUTCH = {"type": "friction_clutch", "shaft": "motor_shaft", "capacity": 0.2}
FLUID = {
    "type": "fluid_coupling",
    "shaft": "motor_shaft",
    "density": 860.0,
    "diameter": 0.2,
    "slip": [0.0, 1.0],
    "coefficient": [0.0, 1e-3],
    "interpolation": "linear",
}
JOURNAL = {"pair": "input", "coefficient": COEFFICIENT, "diameter": DIAMETER}
PAIRS = {
    "pin": {"pair": "drive.inner", "coefficient": 0.1, "diameter": 0.03},
    "crank_pin": {"pair": "drive.first", "coefficient": 0.1, "diameter": 0.04},
    "main": {"pair": "input", "coefficient": 0.08, "diameter": 0.05},
    "skirt": {"pair": "drive.second", "coefficient": 0.12, "length": 0.08},
}


def behind(coupling: dict, scene: dict, friction: dict) -> dict:
    """A machine that rubs, with its motor behind a coupling."""
    scene["shafts"]["motor_shaft"]["inertia"] = SHAFT_INERTIA
    scene["moments"]["dc"] = scene["moments"]["dc"] | {"on": "motor_shaft"}
    return scene | {"friction": friction, "couplings": {"joint": coupling}}


def heavy_rotor(regimes: dict) -> dict:
    scene = rotor(regimes)
    scene["bodies"]["eccentric"] |= {"mass": MASS, "x": 0.0}
    return scene


def of(regime: str, names: str) -> str:
    return " ".join(f"{regime}.{name}" for name in names.split())


def test_rotor_in_its_journal__stands_until_the_clutch_overcomes_friction():
    """r C t/τ = M_f when it sets off; then I ω = r C/τ (t² − t₀²)/2 − M_f (t − t₀)."""
    full, until = 0.3, 0.25
    go = run("gravity", from_speed=0.0, from_shaft_speed=400.0, time=until)
    scene = behind(CLUTCH | {"engagement": full}, heavy_rotor({"go": go}), {"main": JOURNAL})
    found = ask(scene, of("go", "angle final_speed harmful_work work_residual"))
    rise = RATIO * CLUTCH["capacity"] / full
    off = HELD / rise
    assert 0.04 < off < 0.5 * until
    since = until - off
    assert found["go.final_speed"] == pytest.approx(0.5 * rise * since**2 / INERTIA, rel=1e-9)
    angle = rise * since**3 / 6.0 / INERTIA
    assert found["go.angle"] == pytest.approx(angle, rel=1e-9)
    assert found["go.harmful_work"] == pytest.approx(HELD * angle, rel=1e-9)
    assert abs(found["go.work_residual"]) <= found.figure("go.work_residual") + 1e-11


def test_clutch_weaker_than_friction__slips_and_the_crank_stands():
    weak = CLUTCH | {"capacity": 0.999 * HELD / RATIO}
    go = run("dc gravity", from_speed=0.0, from_shaft_speed=50.0, time=0.2)
    found = ask(behind(weak, heavy_rotor({"go": go}), {"main": JOURNAL}), of("go", "angle joint_slip_time"))
    assert found["go.angle"] == 0.0
    assert found["go.joint_slip_time"] == pytest.approx(0.2, rel=1e-12)
    for_ever = run("dc gravity", from_speed=0.0, from_shaft_speed=50.0, lock_up=True)
    scene = behind(weak, heavy_rotor({"go": for_ever}), {"main": JOURNAL})
    assert ask(scene, "go.time").status == [Verdict.SLIPS]


def test_steady_motion_through_a_fluid__carries_load_and_friction():
    """A constant load and constant friction: the motor's speed by its line, the crank's by the slip."""
    found = ask(
        behind(FLUID, heavy_rotor({"on": steady("dc load gravity")}), {"main": JOURNAL}),
        "on.mean_speed on.motor_shaft_mean_speed on.harmful_work on.joint_moment_peak",
    )
    factor, load = 1e-3 * 860.0 * 0.2**5 * RATIO**3, 2.0 + HELD
    motor = 100.0 / RATIO * (1.0 - load / (RATIO * MOMENTS["dc"]["stall_moment"]))
    assert found["on.motor_shaft_mean_speed"] == pytest.approx(RATIO * motor, rel=1e-9)
    assert found["on.mean_speed"] == pytest.approx(motor - load / (factor * motor), rel=1e-9)
    assert found["on.harmful_work"] == pytest.approx(2.0 * math.pi * HELD, rel=1e-9)
    assert found["on.joint_moment_peak"] == pytest.approx(load / RATIO, rel=1e-9)


def test_clutch_that_holds__moves_a_rubbing_slider_crank_as_a_gear_does():
    """As a machine whose motor shaft is geared to the crank without a clutch, which goes by the system of one speed."""
    go = run("dc gravity cut", from_speed=5.0, time=1.5)
    names = "angle final_speed motor_work harmful_work useful_work other_work"
    regimes = {"go": go, "on": steady("dc gravity cut")}
    geared = slider_crank(regimes) | {"friction": PAIRS}
    geared["shafts"]["motor_shaft"]["inertia"] = SHAFT_INERTIA
    geared["moments"]["dc"] = geared["moments"]["dc"] | {"on": "motor_shaft"}
    held = behind(CLUTCH | {"capacity": 1e5}, slider_crank(regimes), PAIRS)
    held["regimes"]["go"]["from_shaft_speed"] = 5.0 * RATIO
    loads = "drive.inner.reaction.max acceleration.min kinetic_energy.max frame.reaction_moment.min"
    asked = f"{of('go', names)} {of('go', loads)} on.mean_speed on.harmful_work"
    one, two = ask(geared, asked), ask(held, asked)
    for name in asked.split():
        assert abs(one[name] - two[name]) <= one.figure(name) + two.figure(name), name
    assert two["go.harmful_work"] > 1.0


def test_slipping_start__works_pay_for_heat_friction_and_energy():
    regimes = {"spin": run("dc", time=0.6), "go": run("dc gravity cut", time=1.5)}
    scene = behind(CLUTCH | {"capacity": 4.0}, slider_crank(regimes), PAIRS)
    scene["regimes"]["spin"]["off"].append("joint")
    names = "motor_work useful_work harmful_work other_work energy_change joint_heat joint_slip_time"
    found = ask(scene, of("go", names))
    motor, useful, harmful, other, change, heat, slips = (found[f"go.{name}"] for name in names.split())
    assert 0.0 < slips < 1.5
    assert heat > 1.0
    assert harmful > 1.0
    figures = sum(found.figure(f"go.{name}") for name in names.split())
    assert abs(motor + other - useful - harmful - heat - change) <= figures
