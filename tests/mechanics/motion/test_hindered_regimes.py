"""What keeps a regime from being computed at all: brakes that lock by themselves, and inertia that vanishes."""

import math

import numpy as np
import pytest
from each_case import refusals
from motion_scenes import ask, run, slider_crank, steady

from engine import Scene, Verdict
from sweeps.report.regime_words import failure_text

SLACK, FRICTION, WRAP = 0.05, 0.3, 4.0
# Moments about the lever's fulcrum, with T1 = T2 e^(f alpha): T2 (slack + tight e^(f alpha)) = F l has no positive T2
# from this arm of the tight end on.
LOCKING = -SLACK * math.exp(-FRICTION * WRAP)


def braked(regime: dict, tight_arm: float = 0.0) -> dict:
    """The slider-crank with a differential band brake in place of its block brake."""
    scene = slider_crank({"stop": regime})
    band = {"force": 100.0, "lever_arm": 0.5, "slack_arm": SLACK, "tight_arm": tight_arm, "radius": 0.1}
    scene["moments"]["brake"] = {"type": "band_brake", "on": "crank", "friction": FRICTION, "wrap": WRAP} | band
    return scene


@pytest.mark.parametrize(
    ("regime", "asked"),
    [(run("brake", from_speed=20.0, rest=True), "stop.time"), (steady("dc brake"), "stop.mean_speed")],
    ids=["run", "steady"],
)
def test_band_brake__locks_by_itself_from_the_arm_at_which_its_moment_has_no_bound(regime, asked):
    arms = LOCKING * np.array([0.0, 0.999, 1.001, 1.5, 4.0])
    found = ask(braked(regime), asked, varied={"moments.brake.tight_arm": arms})
    # At four times that arm the lever's force slackens the band: there is no moment.
    assert found.status[2:] == [Verdict.LOCKS, Verdict.LOCKS, Verdict.NOT_FINITE]
    assert np.isnan(found.values[asked][2:]).all()
    if asked == "stop.time":
        assert found.status[:2] == [Verdict.OK, Verdict.OK]


def test_band_lined_with_blocks__stops_as_the_band_that_grips_alike():
    scene = braked(run("brake", from_speed=20.0, rest=True), 0.0)
    band = scene["moments"]["brake"]
    plain = ask(scene, "stop.time").values["stop.time"][0]
    half = math.tanh(FRICTION * WRAP / 16) / FRICTION
    del band["wrap"]
    band |= {"blocks": 8, "block_angle": 2 * math.atan(half)}
    assert ask(scene, "stop.time").values["stop.time"][0] == pytest.approx(plain, rel=1e-12)


def banded(keys):
    scene = braked(run("brake", from_speed=20.0, rest=True), 0.0)
    scene["moments"]["brake"] |= keys
    return Scene.model_validate(scene)


test_band_that_cannot_brake_or_is_none__is_refused = refusals(
    banded,
    ({"blocks": 8}, "blocks and block_angle belong together"),
    ({"blocks": 8, "block_angle": 0.2}, "give wrap, or blocks with block_angle"),
    ({"wrap": None}, "give wrap, or blocks with block_angle"),
    ({"tight_arm": -SLACK}, "the lever slackens the band"),
    ({"slack_arm": -0.01, "tight_arm": -0.02}, "the lever slackens the band"),
)


def test_locking_brake__is_told_by_name():
    scene = Scene.model_validate(braked(run("brake dc", from_speed=20.0, rest=True), 1.5 * LOCKING))
    assert failure_text(scene, Verdict.LOCKS).startswith("regime stop, brake: a band brake locks by itself")


@pytest.mark.parametrize(
    ("regime", "offset"),
    [
        (run("dc", from_speed=20.0, cycles=3.0), 0.03),
        (run("dc", from_angle=1.0, cycles=3.0), 0.0),
        (steady("dc oil"), 0.03),
    ],
    ids=["run", "from rest", "steady"],
)
def test_inertia_that_vanishes_at_a_dead_centre__is_told_at_once(regime, offset):
    scene = slider_crank({"go": regime})
    scene["guides"]["way"]["y"] = offset
    scene["bodies"]["eccentric"] |= {"mass": 0.0, "inertia": 0.0}
    scene["bodies"]["rod_body"] = {"link": "rod", "mass": 0.0, "x": 0.1}
    # The pin goes on where the ram stands still, and the rod's centre with it.
    bodies, wheels = [0.0, 1.0, 0.0], [0.0, 0.0, 0.02]
    found = ask(scene, "go.speed_max", varied={"bodies.rod_body.mass": bodies, "flywheel.inertia": wheels})
    assert found.status == [Verdict.NO_INERTIA, Verdict.OK, Verdict.OK]


def test_machine_without_any_mass__has_no_inertia():
    scene = slider_crank({"go": run("dc", cycles=3.0)})
    scene["bodies"]["eccentric"] |= {"mass": 0.0, "inertia": 0.0}
    scene["bodies"]["ram_body"]["mass"] = 0.0
    assert ask(scene, "go.time").status == [Verdict.NO_INERTIA]
    told = failure_text(Scene.model_validate(scene), Verdict.NO_INERTIA)
    assert told.startswith("regime go: the reduced inertia is zero at a dead centre")
