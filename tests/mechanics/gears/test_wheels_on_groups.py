"""Wheels on links that turn unevenly, differentials of two drives, planetary trains with a sun: by Willis and power."""

import math

import numpy as np
import pytest
from driving_cams import asked, changed
from each_case import refusals
from geared_links import CRANK
from hypothesis import given, settings
from hypothesis import strategies as st
from machines import rrr

from engine import MovingMachine, Scene, Verdict
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
# J. Watt's sun and planet, and a wheel that the beam turns.
WATT = {
    "gravity": 9.81,
    "points": {
        "O": {"x": 0, "y": 0},
        "D": {"x": 0.4, "y": 0},
        "F": {"x": 0.52, "y": 0.03},
        "G": {"link": "sun", "x": 0.03, "y": 0},
        "H": {"link": "counter", "x": 0.06, "y": 0.01},
    },
    "input": CRANK | {"length": 0.1},
    "groups": {"beam": rrr("B", ("rod", "A", 0.4), ("rocker", "D", 0.2))},
    "shafts": {
        "sun": {"geared_to": "rod", "carrier": "crank", "pivot": "O", "ratio": -1, "inertia": 0.05, "phase": 0.4}
        | {"pressure_angle": "20 deg"},
        "counter": {"geared_to": "rocker", "pivot": "F", "ratio": -2.5, "around": "110 deg", "inertia": 0.02},
        "idler": {"geared_to": "rod", "carrier": "rocker", "pivot": "D", "ratio": -0.7, "around": "-90 deg"},
    },
    "bodies": {
        "rod_body": {"link": "rod", "mass": 3.0, "x": 0.2, "inertia": 0.04},
        "counter_body": {"link": "counter", "mass": 0.8, "x": 0.01, "inertia": 0.001},
        "idler_body": {"link": "idler", "mass": 1.0, "inertia": 0.01},
    },
}
LINKS = ("rod", "rocker", "sun", "counter", "idler")
FIELDS = [f"{link}.angle{rate}" for link in LINKS for rate in ("", "_phi", "_phiphi")]


FIELDS += ["sun.tangential_force", "H.x", "H.y", "H.x_phi", "H.y_phi"]


def watt(phase: float, ratio: float, around: float) -> dict:
    counter = {"shafts__counter__ratio": ratio, "shafts__counter__around": around}
    return changed(WATT, shafts__sun__phase=phase, **counter)


@settings(max_examples=10)
@given(st.floats(-3.0, 3.0), st.floats(-4.0, -0.3), st.floats(1.0, 2.8))
def test_wheels_on_links_of_a_group__go_by_willis(phase, ratio, around):
    q, rows = asked(watt(phase, ratio, around), FIELDS, 48)
    rod, rocker, sun, counter, idler = (
        np.array([rows[f"{n}.angle{r}"] for r in ("", "_phi", "_phiphi")]) for n in LINKS
    )
    crank = np.array([q, np.ones(48), np.zeros(48)])
    # Transfer functions of the group are below 10; the ratios multiply them.
    np.testing.assert_allclose(sun[1:], (2 * crank - rod)[1:], atol=400 * EPS)
    np.testing.assert_allclose(counter[1:], ratio * rocker[1:], atol=400 * EPS)
    np.testing.assert_allclose(idler[1:], (rocker - 0.7 * (rod - rocker))[1:], atol=400 * EPS)
    np.testing.assert_allclose(np.exp(1j * sun[0]), np.exp(1j * (2 * crank - rod + phase)[0]), atol=100 * EPS)
    swung = around + np.angle(np.exp(1j * (rocker[0] - around)))
    np.testing.assert_allclose(np.exp(1j * counter[0]), np.exp(1j * ratio * swung), atol=100 * EPS)
    between = -math.pi / 2 + np.angle(np.exp(1j * (rod[0] - rocker[0] + math.pi / 2)))
    np.testing.assert_allclose(np.exp(1j * idler[0]), np.exp(1j * (rocker[0] - 0.7 * between)), atol=100 * EPS)
    point = 0.52 + 0.03j + (0.06 + 0.01j) * np.exp(1j * counter[0])
    np.testing.assert_allclose(rows["H.x"] + 1j * rows["H.y"], point, atol=20 * EPS)
    rate = 1j * counter[1] * (point - 0.52 - 0.03j)
    np.testing.assert_allclose(rows["H.x_phi"] + 1j * rows["H.y_phi"], rate, atol=100 * EPS)
    # Nothing but its inertia loads the sun, whose radius is half of the crank's length.
    force = 0.05 * (4 * math.pi) ** 2 * sun[2] / 0.05
    np.testing.assert_allclose(np.abs(rows["sun.tangential_force"]), np.abs(force), atol=1e4 * EPS)


def test_wheel_whose_driver_swings_half_a_turn_away__is_singular_unless_the_ratio_is_whole():
    machines = [MovingMachine(Scene.model_validate(watt(0.0, ratio, -1.3))) for ratio in (-2.5, -2.0)]
    assert [machine.verdict(FIELDS) for machine in machines] == [Verdict.SINGULAR, Verdict.OK]


# Two drives on a differential

DIFFERENTIAL = {
    "points": {
        **{axis: {"x": 0, "y": 0} for axis in ("O", "C", "E")},
        "P": {"link": "out", "x": 0.1, "y": 0},
    },
    "input": CRANK,
    "inputs": {
        "cage": {"type": "crank", "pivot": "C", "phase": 0.2, "harmonics": {"one": {"order": 1, "sine": 0.4}}}
    },
    "shafts": {"out": {"geared_to": "crank", "carrier": "cage", "pivot": "E", "ratio": -1, "phase": 0.3}},
    "moments": {"load": {"type": "constant", "on": "out", "moment": -10.0}},
    "bodies": {"tip": {"link": "out", "mass": 0.0, "x": 0.1}},
}  # fmt: skip


@pytest.mark.parametrize("pivot", [True, False])
def test_differential__adds_motions_and_divides_moments(pivot):
    bare = {"shafts__out__pivot": None, "shafts__out__phase": None, "points__P": None, "bodies": {}}
    scene = DIFFERENTIAL if pivot else changed(DIFFERENTIAL, **bare)
    rates = ["out.angle", "out.angle_phi", "out.angle_phiphi", "P.x"] if pivot else []
    drives = ["input_moment_by_equilibrium", "cage.driving_moment", "input_moment_by_power"]
    phi, rows = asked(scene, [*drives, *rates])
    # Both side wheels of a differential with equal wheels turn against its cage by the same angle, oppositely.
    np.testing.assert_allclose(rows["input_moment_by_equilibrium"], -10.0, atol=100 * EPS)
    np.testing.assert_allclose(rows["cage.driving_moment"], 20.0, atol=100 * EPS)
    np.testing.assert_allclose(rows["input_moment_by_power"], -10.0 + 20.0 * 0.4 * np.cos(phi), atol=400 * EPS)
    if pivot:
        angle = 0.3 + 2 * (0.2 + 0.4 * np.sin(phi)) - phi
        np.testing.assert_allclose(np.exp(1j * rows["out.angle"]), np.exp(1j * angle), atol=32 * EPS)
        np.testing.assert_allclose(rows["out.angle_phi"], 0.8 * np.cos(phi) - 1.0, atol=16 * EPS)
        np.testing.assert_allclose(rows["out.angle_phiphi"], -0.8 * np.sin(phi), atol=16 * EPS)
        np.testing.assert_allclose(rows["P.x"], 0.1 * np.cos(angle), atol=8 * EPS)


test_wheels_that_cannot_mesh__are_refused_in_words = refusals(
    lambda changes: order(Scene.model_validate(changed(WATT, **changes))),
    ({"shafts__counter__geared_to": "rod"}, "no joint holds 'rod' on 'frame'"),
    ({"shafts__sun__pivot": "D"}, "'D' is not a point of the carrier 'crank'"),
    ({"shafts__idler__carrier": "rod"}, "'rod' carries this wheel"),
    ({"shafts__idler__pressure_angle": 0.3, "shafts__idler__pivot": "B"}, "coaxial with 'rod'"),
    ({"shafts__loose": {"geared_to": "crank", "ratio": 2}, "shafts__counter__geared_to": "loose"}, "has no pivot"),
    ({"shafts__idler__geared_to": "frame", "shafts__idler__carrier": "frame"}, "carries this wheel"),
)


def test_wheel_in_mesh_with_a_planet_about_the_sun__is_placed():
    order(Scene.model_validate(changed(WATT, shafts__counter__geared_to="sun", shafts__counter__pivot="F")))
