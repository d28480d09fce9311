"""Pressure of pins and buckling of struts: a slider-crank pressed at its slider, by hand."""

import math

import machines
import numpy as np
import pytest
from each_case import refusals
from hypothesis import given
from hypothesis import strategies as st

from engine import Machine, Scene
from engine.laws.buckling import MATERIALS, critical_stress

CRANK, ROD, FORCE = 0.05, 0.4, 12e3
ROUND = {"link": "rod", "diameter": 0.016}


def pressed(strut: dict = ROUND, force: float = FORCE, **parts: dict) -> dict:
    """A massless slider-crank whose ram is pushed back by a constant force."""
    scene = machines.slider_crank(CRANK, ROD, 3.0, "drive")
    scene["forces"] = {"load": {"type": "constant", "on": "B", "angle": math.pi, "force": force}}
    scene["pins"] = {"wrist": {"pair": "drive.inner", "diameter": 0.02, "width": 0.03}}
    return scene | {"struts": {"con_rod": strut}} | parts


def ask(scene: dict, names: str) -> dict[str, float]:
    outcome = Machine(Scene.model_validate(scene), names.split()).evaluate({})
    return {name: float(outcome.summaries[name][0]) for name in names.split()}


def test_rod_of_a_press__buckles_by_euler_and_its_pin_bears_what_the_rod_does():
    """The rod leans by asin(r/l) at most, where it bears F/cos."""
    names = "wrist.pressure.peak con_rod.slenderness con_rod.compression con_rod.critical_force con_rod.buckling_safety"
    found = ask(pressed(), names)
    most = FORCE / math.sqrt(1.0 - (CRANK / ROD) ** 2)
    assert found["con_rod.compression"] == pytest.approx(most, rel=1e-9)
    assert found["wrist.pressure.peak"] == pytest.approx(most / (0.02 * 0.03), rel=1e-9)
    # λ = 4 l/d = 100 is Tetmajer's; a rod of 14 mm with 114 is Euler's, F_K = π² E I/l².
    assert found["con_rod.slenderness"] == pytest.approx(100.0, rel=1e-12)
    tetmajer = (310e6 - 1.14e6 * 100.0) * math.pi / 4 * 0.016**2
    assert found["con_rod.critical_force"] == pytest.approx(tetmajer, rel=1e-12)
    assert found["con_rod.buckling_safety"] == pytest.approx(tetmajer / most, rel=1e-9)
    thin = ask(pressed({"link": "rod", "diameter": 0.014}), names)
    euler = math.pi**2 * 210e9 * math.pi / 64 * 0.014**4 / ROD**2
    assert thin["con_rod.critical_force"] == pytest.approx(euler, rel=1e-12)


def test_free_rod__bears_what_the_rod_of_a_dyad_does():
    scene = pressed(force=-FORCE) | {"friction": {}}
    dyad = scene.pop("groups")["drive"]
    free = {"rod": {"joints": ["A", "B"], "length": ROD}, "ram": {"joints": ["B"], "guide": dyad["second"]["guide"]}}
    loose = scene | {"links": free, "near": {"B": {"x": ROD, "y": 0.0}}, "pins": {}}
    names = "con_rod.slenderness con_rod.compression con_rod.critical_force"
    for force in (-FORCE, FORCE):
        one, other = (
            ask(s | {"forces": pressed(force=force)["forces"]}, names)
            for s in (scene | {"groups": {"drive": dyad}}, loose)
        )
        assert one == pytest.approx(other, rel=1e-9, abs=1e-6)
    assert one["con_rod.compression"] > FORCE


def test_amplitude_of_a_shaft_torque__is_that_of_its_sine():
    """A force of fixed direction at the crankpin has the torque −F r sin φ; a steady torque shifts it."""
    scene = pressed() | {"moments": {"rub": {"type": "against_motion", "on": "crank", "moment": 50.0}}}
    scene["forces"] = {"pull": {"type": "constant", "on": "A", "angle": 0.0, "force": FORCE}}
    found = ask(scene, "input_moment.amplitude input_moment.mean")
    assert found["input_moment.amplitude"] == pytest.approx(FORCE * CRANK, rel=1e-9)
    assert found["input_moment.mean"] == pytest.approx(50.0, rel=1e-9)


def test_sections__have_the_least_radius_of_gyration():
    tube = {"link": "rod", "diameter": 0.03, "inner_diameter": 0.026, "end_fixity": 0.7}
    found = ask(pressed(tube), "con_rod.slenderness")["con_rod.slenderness"]
    inertia, area = math.pi / 64 * (0.03**4 - 0.026**4), math.pi / 4 * (0.03**2 - 0.026**2)
    assert found == pytest.approx(0.7 * ROD / math.sqrt(inertia / area), rel=1e-12)
    plate = {"link": "rod", "width": 0.04, "thickness": 0.01}
    found = ask(pressed(plate), "con_rod.slenderness")["con_rod.slenderness"]
    assert found == pytest.approx(ROD / math.sqrt(0.01**2 / 12), rel=1e-12)


def test_rod_that_is_only_pulled__has_no_safety_against_buckling():
    outcome = Machine(
        Scene.model_validate(pressed(force=-FORCE)), ["con_rod.compression", "con_rod.buckling_safety"]
    ).evaluate({})
    assert outcome.status[0] == 0
    assert outcome.summaries["con_rod.compression"][0] == 0.0
    assert np.isnan(outcome.summaries["con_rod.buckling_safety"][0])


def test_heavy_rod__is_compressed_most_at_the_end_that_speeds_it_up():
    """Without a load the ends differ by what accelerates the rod; the outer one bears the slider and the rod."""
    body = {
        "rod_body": {"link": "rod", "mass": 4.0, "x": 0.2, "inertia": 0.0},
        "ram_body": {"link": "ram", "mass": 2.0},
    }
    scene = pressed(force=0.0, bodies=body)
    names = "con_rod.compression drive.first.reaction_along.max"
    found = ask(scene, names)
    assert found["con_rod.compression"] == pytest.approx(found["drive.first.reaction_along.max"], rel=1e-12)


@given(st.sampled_from(sorted(MATERIALS)), st.floats(1.0, 400.0), st.floats(1e-6, 0.1))
def test_critical_stress__falls_with_slenderness(name, slenderness, more):
    """But for a jump where Tetmajer's curve meets Euler's: no more than 10 % in these tables."""
    material = MATERIALS[name]
    low, high = critical_stress(np.array([slenderness * (1.0 + more), slenderness]), material)
    assert low <= high * (
        1.0 if (slenderness < material.slender) == (slenderness * (1.0 + more) < material.slender) else 1.1
    )
    assert high <= material.crushing


test_what_has_no_meaning__is_refused = refusals(
    lambda change: Machine(Scene.model_validate(pressed() | change), ["reduced_inertia.mean"]),
    ({"struts": {"s": {"link": "ram", "diameter": 0.01}}}, "struts.s.link: 'ram' is not a rod between … rod"),
    ({"struts": {"s": {"link": "rod"}}}, "struts.s … give the diameter of a round rod, or width and thickness"),
    ({"struts": {"s": ROUND | {"inner_diameter": 0.02}}}, "struts.s … inner_diameter belongs to a tube"),
    ({"pins": {"p": {"pair": "drive.second", "diameter": 0.02, "width": 0.03}}}, "pins.p.pair: 'drive.second' is"),
)
