"""Brakes that lock by themselves, in regimes."""

import math

import numpy as np
import pytest
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


def test_locking_brake__is_told_by_name():
    scene = Scene.model_validate(braked(run("brake dc", from_speed=20.0, rest=True), 1.5 * LOCKING))
    assert failure_text(scene, Verdict.LOCKS).startswith("regime stop, brake: a band brake locks by itself")
