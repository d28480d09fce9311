"""Cams that drive links of a mechanism: against mechanisms of lower pairs, against cams alone, by what must balance."""

import math

import numpy as np
import pytest
from cam_samples import ARM, ROLLER, cam_answers
from driving_cams import CIRCLE, SLIDING, SWINGING, asked, changed
from each_case import refusals
from machines import rpp, rrp

from engine import AskError, Machine, Scene, Verdict
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps


def answers(data: dict, summaries: str = "", fields: str = "", varied: dict | None = None, positions: int = 48):
    varied = varied or {}
    machine = Machine(Scene.model_validate(data), summaries.split(), fields.split(), list(varied), positions)
    return machine.evaluate(varied)


# An eccentric circle under a flat face is a Scotch yoke.

YOKE = changed(
    SLIDING,
    points__top__x=0,
    guides__way__x=0,
    cams=None,
    springs__closing__free_length="260 mm",
    groups={"drive": rpp(("block", "A"), ("tappet", "way"), math.pi / 2)},
)


def test_eccentric_circle_under_a_flat_face__is_a_scotch_yoke():
    """The yoke's slot goes through the circle's centre, e above the crank's axis at most; the face lies R higher."""
    radius = 0.05
    cam = changed(
        SLIDING,
        points__top__x=0,
        guides__way__x=0,
        cams__cam__sections=CIRCLE,
        cams__cam__base_radius=radius - 0.02,
        cams__cam__begin="-90 deg",
        cams__cam__follower={"type": "translating", "link": "tappet", "guide": "way", "contact": "flat"},
        springs__closing__free_length="260 mm",
        points__end={"link": "tappet", "x": -radius, "y": 0},
        bodies__own__x=-radius,
    )
    names = ["tappet.velocity", "tappet.acceleration", "input.reaction_x", "input.reaction_y"]
    names += ["reduced_inertia", "input_moment_by_equilibrium", "input_moment_by_power", "end.y"]
    _, ours = asked(cam, [*names, "cam.guide.reaction", "cam.contact_force"], 48)
    _, theirs = asked(YOKE, [*names, "drive.second.reaction", "drive.first.reaction_y"], 48)
    for name in names:
        own, other = ours[name], theirs[name]
        # Both are some twenty roundings of what they are made of; angles of half turns differ by one.
        size = np.abs(theirs[name.replace("_x", "_y")]).max()
        np.testing.assert_allclose(own, other, rtol=0, atol=100 * EPS * size, err_msg=name)
    other = theirs["drive.first.reaction_y"]
    np.testing.assert_allclose(ours["cam.contact_force"], other, rtol=100 * EPS)
    side = ours["cam.guide.reaction"]
    np.testing.assert_allclose(side, theirs["drive.second.reaction"], atol=100 * EPS * np.abs(other).max())


# Against the cam as an element of its own


def element_like(cam: dict, **changes: object) -> dict:
    """Results of the element `cam` at 300 rpm with the sections of `SLIDING` or `SWINGING`."""
    values, errors, status = cam_answers(cam, speed="300 rpm", **changes)
    assert status == Verdict.OK
    return {name: (values[name], errors[name]) for name in values}


def assert_agree(data: dict, true: dict[str, tuple[float, float]]) -> None:
    """A machine's results and some values, each with its error estimate."""
    found = answers(data, " ".join(true))
    assert found.status[0] == Verdict.OK
    for name, (value, error) in true.items():
        apart = abs(found.summaries[name][0] - value)
        assert apart <= found.errors[name][0] + error + 8 * EPS * abs(value), name


# The spring is 190 − (200 − d) mm long at d.
PRELOAD = 8e3 * (math.sqrt(0.038**2 - 0.005**2) - 0.010)


def test_follower_that_slides__has_the_angles_and_forces_of_the_element():
    # Weight presses too.
    sections = SLIDING["cams"]["cam"]["sections"]
    known = element_like(ROLLER, sections=sections, follower__preload=PRELOAD, follower__load=0.5 * 9.81)
    true = {
        "cam.pressure_angle.max": known["rise_pressure_angle"],
        "cam.contact_force.max": known["greatest_contact_force"],
        "cam.contact_force.min": known["least_contact_force"],
        "input_moment_by_power.max": known["greatest_moment"],
        "cam.curvature.max": (1 / known["convex_radius"][0], 1e-12 / known["convex_radius"][0]),
        "tappet.stroke": (0.02, 0.0),
    }
    assert_agree(SLIDING, true)


def test_follower_that_swings__has_the_angles_and_forces_of_the_element():
    load = {"load": {"type": "constant", "on": "arm", "moment": "6 N m"}}
    follower = ARM["follower"] | {"pivot_distance": math.hypot(0.07, 0.04), "preload": 0, "stiffness": 0, "load": 6}
    known = element_like(ARM, sections=SWINGING["cams"]["cam"]["sections"], follower=follower)
    true = {
        "cam.pressure_angle.max": max(known["rise_pressure_angle"], known["return_pressure_angle"]),
        "cam.contact_force.max": known["greatest_contact_force"],
        "cam.contact_force.min": known["least_contact_force"],
        "input_moment_by_power.max": known["greatest_moment"],
    }
    assert_agree(changed(SWINGING, moments=load, shafts__camshaft__ratio=1, bodies__own__x=0), true)


# What must balance, whatever the cam

KINDS = {
    "roller beside the axis": SLIDING,
    "knife edge on a shaft turning backwards": changed(
        SLIDING,
        points__C={"x": "150 mm", "y": "-20 mm"},
        input__pivot="C",
        shafts={"camshaft": {"geared_to": "crank", "ratio": -3, "pivot": "O"}},
        cams__cam__on="camshaft",
        cams__cam__follower={"type": "translating", "link": "tappet", "guide": "way", "contact": "knife edge"},
    ),
    "arm": SWINGING,
    "arm on the other side, in a groove": changed(
        SWINGING, moments=None, cams__cam__follower__mode=1, cams__cam__closure="form", shafts__camshaft__ratio=1
    ),
    "face through its pivot": changed(
        SWINGING,
        cams__cam__base_radius="45 mm",
        cams__cam__follower={"type": "oscillating", "link": "arm", "pivot": "Q", "contact": "flat", "mode": -1},
    ),
    "group on the follower": changed(
        SWINGING,
        points__tip={"link": "arm", "x": "-40 mm", "y": "20 mm"},
        guides={"way": {"y": "-40 mm"}},
        groups={"out": rrp("B", ("rod", "tip", "90 mm"), "slider", "way")},
        bodies__slider_body={"link": "slider", "mass": "0.5 kg"},
    ),
}


@pytest.mark.parametrize("kind", KINDS)
def test_every_kind__balances(kind):
    """Input moments by virtual power, which are those by equilibrium, and by the energy agree."""
    _, rows = asked(KINDS[kind], ["input_moment", "input_moment_by_power"], 48)
    energy, power = rows.values()
    np.testing.assert_allclose(power, energy, rtol=0, atol=1e-13 * np.abs(energy).max())


def test_motion_on_a_half_speed_shaft__begins_where_it_is_told():
    """The rise of 3-4-5 over 100° of the cam goes from 30° to 230° of the crank."""
    data = changed(
        SLIDING,
        input__revolutions=2,
        points__C={"x": "150 mm", "y": 0},
        input__pivot="C",
        shafts={"camshaft": {"geared_to": "crank", "ratio": "-1/2", "pivot": "O"}},
        cams__cam__on="camshaft",
        cams__cam__begin="30 deg",
        cams__cam__sections__out__law="3-4-5",
    )
    q, rows = asked(data, ["cam.displacement", "tappet.slide_phi"], 72)
    phi = np.degrees(q)
    u = (phi - 30) / 200
    s = 0.02 * u**3 * (10 - 15 * u + 6 * u**2)
    rate = 0.02 * 30 * (u * (1 - u)) ** 2 / math.radians(200)
    rising = (phi >= 30) & (phi <= 230)
    for name, true in (("cam.displacement", s), ("tappet.slide_phi", rate)):
        np.testing.assert_allclose(rows[name][rising], true[rising], atol=1e-15)
    assert np.all(rows["cam.displacement"][phi < 30] == 0.0)


# Verdicts


def test_follower__lifts_off_beyond_the_speed_of_the_element():
    known = element_like(ROLLER, sections=SLIDING["cams"]["cam"]["sections"], follower__preload=PRELOAD)
    limit = known["lift_off_speed"][0]
    outcome = answers(
        changed(SLIDING, gravity=0),
        "cam.contact_force.max",
        varied={"input.speed": limit * np.array([-1.00001, -0.99999, 0.99999, 1.00001])},
    )
    assert outcome.status.tolist() == [Verdict.LIFTS_OFF, Verdict.OK, Verdict.OK, Verdict.LIFTS_OFF]
    assert outcome.status_group[0] == 0
    assert math.radians(50) < outcome.status_at[3] < math.radians(360)


def test_groove__holds_its_follower_at_any_speed():
    outcome = answers(changed(SLIDING, springs={}, cams__cam__closure="form"), "cam.contact_force.min")
    assert outcome.status[0] == Verdict.OK
    assert outcome.summaries["cam.contact_force.min"][0] < 0.0


def test_undercut_and_unreachable_cams__have_their_verdicts():
    varied = {
        "cams.cam.base_radius": np.array([0.03, 0.01, 0.03, 0.03]),
        "guides.way.x": np.array([0.005, 0.005, 0.039, 0.005]),
        "cams.cam.sections.out.angle": np.array([1.7, 0.4, 1.7, 4.0]),
    }
    outcome = answers(changed(SLIDING, input__speed="20 rpm"), "tappet.stroke", varied=varied)
    expected = [Verdict.OK, Verdict.UNDERCUT, Verdict.CANNOT_ASSEMBLE, Verdict.CANNOT_ASSEMBLE]
    assert outcome.status.tolist() == expected


# Motion


def test_run__gains_the_energy_that_is_put_in():
    """By a constant moment from rest, over whole turns, ½Iω² grows by 2πM each; the acceleration jumps on the way."""
    data = changed(
        SLIDING,
        gravity=0,
        springs={},
        cams__cam__closure="form",
        cams__cam__sections__out__law="parabolic",
        bodies__rotor={"link": "crank", "mass": 0, "inertia": "1e-3 kg m2"},
        moments={"push": {"type": "constant", "on": "crank", "moment": "0.4 N m", "role": "driving"}},
        regimes={"start": {"type": "run", "from_speed": 0, "cycles": 3}},
    )
    found = answers(data, "start.final_speed", positions=720)
    # Of the follower the speed is zero there.
    true = math.sqrt(2 * 3 * 2 * math.pi * 0.4 / 1e-3)
    assert found.status[0] == Verdict.OK
    assert found.summaries["start.final_speed"][0] == pytest.approx(true, rel=1e-9)
    assert abs(found.summaries["start.final_speed"][0] - true) <= 10 * found.errors["start.final_speed"][0]


# Refusals


test_wrong_cams__are_refused_in_words = refusals(
    lambda changes: order(Scene.model_validate(changed(SLIDING, **changes))),
    ({"cams__cam__on": "tappet"}, "a cam that nothing turns"),
    ({"cams__cam__on": "cranck"}, "did you mean 'crank'"),
    ({"cams__cam__follower__guide": "wya"}, "did you mean 'way'"),
    ({"cams__cam__sections__out__law": "uniform"}, "the velocity jumps"),
    ({"cams__cam__closure": "form", "cams__cam__follower__contact": "flat"}, "roller_radius goes with"),
    ({"cams__cam__follower__link": "crank"}, "already moved by"),
    ({"cams__cam__sections__out__swing": "3 deg"}, "give lift instead"),
    ({"guides__way__link": "crank"}, "must be on the frame"),
    (
        {"shafts": {"camshaft": {"geared_to": "crank", "ratio": 0.5, "pivot": "O"}}, "cams__cam__on": "camshaft"},
        "'camshaft' makes 0.5 turns in a cycle of 1 of the crank",
    ),
)


def test_ratio_of_a_camshaft__does_not_vary():
    with pytest.raises(AskError, match="turns cam 'cam', whose cycle must close"):
        Machine(Scene.model_validate(SWINGING), varied=["shafts.camshaft.ratio"])
