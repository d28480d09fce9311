"""Friction between cams and followers, and in what holds those: by equilibrium of the follower, and by power."""

import math

import numpy as np
import pytest
from driving_cams import SLIDING, SWINGING, asked, changed
from each_case import refusals

from engine import Machine, Scene, Verdict
from engine.scene.structure.ordering import order

EPS = np.finfo(float).eps
CONTACT = {"pair": "cam.contact", "coefficient": 0.12}
FLAT = {"type": "translating", "link": "tappet", "guide": "way", "contact": "flat"}
MOMENTS = ["input_moment", "input_moment_with_friction", "cam.contact_force", "cam.closing_force"]


def test_flat_face__is_dragged_along_by_what_presses():
    """The face is square to the guide: the force stays P, and the cam needs μ P at the height of the contact."""
    data = changed(SLIDING, cams__cam__follower=FLAT, friction={"face": CONTACT})
    wanted = [*MOMENTS, "cam.contact.friction_force", "cam.contact_y", "cam.contact.friction_power"]
    _, rows = asked(data, wanted, 96)
    pressing = rows["cam.contact_force"]
    assert pressing.min() > 0.0
    np.testing.assert_allclose(pressing, rows["cam.closing_force"], rtol=64 * EPS)
    np.testing.assert_allclose(np.abs(rows["cam.contact.friction_force"]), 0.12 * pressing, rtol=64 * EPS)
    extra = np.abs(rows["input_moment_with_friction"] - rows["input_moment"])
    np.testing.assert_allclose(extra, 0.12 * pressing * rows["cam.contact_y"], rtol=1e-11)
    omega = Scene.model_validate(data).input.speed
    np.testing.assert_allclose(rows["cam.contact.friction_power"], extra * abs(omega), rtol=1e-11)


def test_guide_of_a_roller__leans_against_its_motion():
    """N cos α = P ± μ N sin α, by the sense of the follower; nothing presses on the guide but the roller."""
    data = changed(SLIDING, friction={"stem": {"pair": "cam.guide", "coefficient": 0.2}})
    _, rows = asked(data, [*MOMENTS, "cam.pressure_angle", "tappet.slide_phi", "cam.guide.friction_force"], 96)
    lean, way = np.abs(np.sin(rows["cam.pressure_angle"])), np.sign(np.round(rows["tappet.slide_phi"], 12))
    known = rows["cam.closing_force"] / (np.cos(rows["cam.pressure_angle"]) - 0.2 * lean * way)
    np.testing.assert_allclose(rows["cam.contact_force"], known, rtol=1e-11)
    np.testing.assert_allclose(rows["cam.guide.friction_force"], -0.2 * known * lean * way, atol=1e-10)


@pytest.mark.parametrize("sample", [SLIDING, SWINGING])
def test_roller__rubs_on_its_pin(sample):
    """Of the pin's friction the surface of the roller feels μ d/2R of what presses, as at a face that slides."""
    radius = Scene.model_validate(sample).cams["cam"].follower.roller_radius
    pin = CONTACT | {"diameter": 0.6 * radius}
    held = "guide" if sample is SLIDING else "pivot"
    other = {"pair": f"cam.{held}", "coefficient": 0.1} | ({"diameter": 0.01} if held == "pivot" else {})
    fields = [*MOMENTS, "cam.contact.friction_force", "cam.contact.friction_power", f"cam.{held}.friction_power"]
    _, rows = asked(changed(sample, friction={"pin": pin, "other": other}), fields, 96)
    share = 0.12 * 0.3
    np.testing.assert_allclose(
        np.abs(rows["cam.contact.friction_force"]), share * np.abs(rows["cam.contact_force"]), rtol=1e-12
    )
    omega = abs(Scene.model_validate(sample).input.speed)
    extra = (rows["input_moment_with_friction"] - rows["input_moment"]) * math.copysign(
        omega, Scene.model_validate(sample).input.speed
    )
    lost = rows["cam.contact.friction_power"] + rows[f"cam.{held}.friction_power"]
    np.testing.assert_allclose(extra, lost, atol=1e-11 * np.abs(lost).max() + 1e4 * EPS * omega)


test_wrong_friction_at_cams__is_refused_in_words = refusals(
    lambda friction: order(Scene.model_validate(changed(SLIDING, friction={"f": friction}))),
    (CONTACT, "is missing: a roller rubs on its pin"),
    (CONTACT | {"diameter": 0.01, "length": 0.1}, "doesn't belong to the contact of a cam"),
    ({"pair": "cam.pivot", "coefficient": 0.1, "diameter": 0.01}, "is not a pair of this scene"),
)


def test_loss_of_a_cam__does_not_depend_on_where_the_cycle_begins():
    """The sliding turns once between rise and return, and rests for half of the cycle, before that or after."""
    sections = {
        "out": {"type": "rise", "law": "3-4-5", "angle": "80 deg", "lift": "10 mm"},
        "back": {"type": "return", "law": "cycloidal", "angle": "90 deg"},
        "low": {"type": "dwell"},
    }
    data = changed(SLIDING, cams__cam__sections=sections, friction={"stem": {"pair": "cam.guide", "coefficient": 0.2}})
    machine = Machine(Scene.model_validate(data), ["friction_loss"], varied=["cams.cam.begin"])
    outcome = machine.evaluate({"cams.cam.begin": np.radians(np.arange(0.0, 360.0, 15.0))})
    assert (outcome.status == Verdict.OK).all()
    loss = outcome.summaries["friction_loss"]
    assert np.ptp(loss) <= 2.0 * outcome.errors["friction_loss"].max()
