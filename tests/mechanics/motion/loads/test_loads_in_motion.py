"""Loads on the pairs in steady motion: balances, limits and closed forms at a machine's own speed."""

import math

import numpy as np
import pytest
from closed_forms import slider_motion
from motion_scenes import ECCENTRIC_MASS, MOMENTS, RADIUS, RAM_MASS, ROD, Found, ask, crank_alone, slider_crank, steady
from oracle import EPS
from test_loads_in_runs import COLUMNS, PAIRS

from engine import Machine, Scene, Verdict
from engine.words.quantity import STATISTICS
from sweeps.report.readings import readings_at
from sweeps.study.bundled import STUDIES
from sweeps.text.scene_text import read_scene

SHAKING = ("shaking_force", "shaking_force_x", "shaking_force_y", "shaking_moment")
# Always the same is asked: all machines then share their kernels.
LOADS = (*COLUMNS, *PAIRS[:3], *SHAKING, "input_moment_by_equilibrium")
FIELDS = (*LOADS, "input_moment", "speed", "acceleration", "motor_moment")


def settled(only: str, changes: dict | None = None, accuracy: float | None = None, **scene: object) -> Found:
    """Loads on the slider-crank in steady motion, with the statistics of the loads on its pairs."""
    regime = steady(only)
    machine = slider_crank({"on": regime}, **scene) | (changes or {})
    rows = (*PAIRS, "shaking_force", "input_moment", "speed")
    names = [f"on.{row}.{statistic}" for row in rows for statistic in STATISTICS]
    return ask(machine, " ".join(names), 240, " ".join(f"on.{field}" for field in FIELDS), accuracy=accuracy)


def rows_of(found: Found) -> dict[str, np.ndarray]:
    """Fields of the only variant, without the regime's name."""
    assert found.status == [Verdict.OK], found.status
    return {name.partition(".")[2]: row[0] for name, row in found.fields.items()}


@pytest.mark.parametrize("speed", [10.0, -10.0])
def test_slider_crank__shaking_force_is_what_all_masses_take(speed):
    rows = rows_of(settled("dc cut fan", flywheel=0.05, speed=speed))
    phi = np.arange(240) * math.pi / 120
    omega, epsilon = rows["speed"], rows["acceleration"]
    assert np.ptp(omega) > 1.0
    s, c = np.sin(phi), np.cos(phi)
    _, first, second = slider_motion(phi, RADIUS, ROD, by=np)
    ram = RAM_MASS * (omega**2 * second + epsilon * first)
    arm = ECCENTRIC_MASS * 0.03
    x = -ram + arm * (omega**2 * c + epsilon * s)
    y = arm * (omega**2 * s - epsilon * c)
    # Ram on the line through the pivot, crank of 0.02 kg·m² with its eccentric mass, flywheel of 0.05 kg·m².
    moment = -(0.02 + arm * 0.03 + 0.05) * epsilon
    for name, row in (("force_x", x), ("force_y", y), ("force", np.hypot(x, y)), ("moment", moment)):
        np.testing.assert_allclose(rows[f"shaking_{name}"], row, rtol=0, atol=100 * EPS * np.abs(row).max())


# The other way round, other places for the same inertia


def test_flywheel_on_a_faster_shaft__loads_the_frame_as_that_shaft_does():
    wheel = {"inertia": 0.2, "wheel": {"type": "disc", "ratio": 7.5}}
    one = rows_of(settled("dc cut fan", changes={"flywheel": wheel}))
    shafts = {"motor_shaft": {"geared_to": "crank", "ratio": 7.5, "inertia": 0.2 / 7.5**2}}
    two = rows_of(settled("dc cut fan", changes={"shafts": shafts, "flywheel": {"inertia": 0.0}}))
    for name in LOADS:
        if name != "input_moment_by_equilibrium":
            np.testing.assert_allclose(one[name], two[name], rtol=0, atol=1e-9 * np.abs(two[name]).max() + 1e-12)


def test_brake_left_on__is_borne_by_the_frame():
    braked = rows_of(settled("dc cut brake", flywheel=0.2))
    # Two blocks of 20 N with 0.2 on 0.1 m: 0.8 N·m, as a resistance from outside.
    rubbed = rows_of(settled("dc cut rub", flywheel=0.2, rub={"moment": 0.8}))
    for name in LOADS:
        shift = 0.8 if name == "frame.reaction_moment" else 0.0
        size = np.abs(rubbed[name]).max()
        np.testing.assert_allclose(braked[name], rubbed[name] + shift, rtol=0, atol=1e-9 * size + 1e-12, err_msg=name)


# Statistics and their error estimates


@pytest.mark.parametrize(
    ("only", "flywheel", "steeper"),
    [("dc cut gravity fan", 0.02, 1.0), ("dc cut gravity fan", 0.02, 1e4), ("induction rub gravity cut", 2.0, 1.0)],
)
def test_error_figures__cover_what_little_accuracy_misses(only, flywheel, steeper):
    motor = {"stall_moment": MOMENTS["dc"]["stall_moment"] * steeper}
    rough, fine = (settled(only, accuracy=each, flywheel=flywheel, dc=motor) for each in (1e-3, 1e-10))
    # Of two extremes that are nearly as great, either may be the place of the greatest.
    rough.agrees(fine, *(name for name in rough.values if not name.endswith("_at")))


# An engine


def test_idling_engine__gas_of_the_ignition_on_its_pin():
    scene = read_scene(STUDIES / "motion" / "scenes" / "idling_engine.toml")
    names = ["idle.drive.inner.reaction.max", "idle.drive.inner.reaction.max_at"]
    fields = ["idle.speed", "idle.input_moment", "idle.input_moment_by_equilibrium"]
    # The piston is at the top between two positions, at some of these its stroke has begun there, at others not yet.
    top = np.radians(90 + np.linspace(-0.9, 0.9, 9))
    largest, place = names
    machine = Machine(scene, names, fields, ["guides.bore_axis.angle"], positions=360)
    outcome = machine.evaluate({"guides.bore_axis.angle": top})
    assert (outcome.status == Verdict.OK).all()
    # 13.5 bar against 1 bar on 88 mm; a piston of 0.42 kg hangs on, with its weight. r″ = −r − r²/l at the top.
    at = outcome.summaries[place]
    # It rises by a change of the speed before the pressure falls.
    np.testing.assert_allclose(at % (2 * math.pi), top, rtol=0, atol=1e-4)
    rows = outcome.fields["idle.speed"]
    omega = np.array([np.interp(q, machine.nodes, row) for q, row in zip(at, rows, strict=True)])
    gas, second = (13.5e5 - 1e5) * math.pi / 4 * 0.088**2, -0.032 - 0.032**2 / 0.11
    pin = gas + 0.42 * (9.81 + omega**2 * second)
    # The speed between positions, and what the rod takes across: some 1e-6 of the gas.
    np.testing.assert_allclose(outcome.summaries[largest], pin, rtol=1e-5)
    given, needed = (outcome.fields[name] for name in fields[1:])
    np.testing.assert_allclose(given, needed, rtol=0, atol=1e-9 * np.abs(given).max())


# What can't be


def test_table_of_positions__without_regimes():
    scene = crank_alone(0.1, {name: MOMENTS[name] for name in ("dc", "fan")}, {"on": {"type": "steady"}}, 10.0)
    names = readings_at(Scene.model_validate(scene), 8).values
    assert "input.reaction" in names
    assert not [name for name in names if name.startswith("on.")]


def test_machine_that_stalls__has_its_verdict_and_no_loads():
    found = settled("load cut", flywheel=0.2)
    assert found.status == [Verdict.STALLS]
    assert all(np.isnan(value).all() for value in found.values.values())
    assert all(np.isnan(row).all() for row in found.fields.values())


def test_group_without_mass__is_asked_to_assemble_where_its_loads_are():
    scene = slider_crank({"on": steady("dc fan")}, flywheel=0.2)
    scene["points"]["P"] = {"x": 0.5, "y": 0.0}
    arms = {"first": {"link": "a", "joint": "A", "length": 0.3}, "second": {"link": "b", "joint": "P", "length": 0.1}}
    scene["groups"]["extra"] = {"type": "RRR", "inner": "C", **arms}
    assert ask(scene, "on.mean_speed").status == [Verdict.OK]
    found = ask(scene, "on.extra.inner.reaction.max")
    assert found.status == [Verdict.CANNOT_ASSEMBLE]
