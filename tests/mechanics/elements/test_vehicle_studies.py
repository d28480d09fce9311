"""Bundled studies of vehicles: their answers against closed forms."""

import math

import numpy as np

from engine import ElementsAlone, Verdict
from sweeps.study.bundled import bundled_studies
from sweeps.study.study_reader import read_study


def evaluated(name):
    """Values of a study's paths and what its scene answers to all that it asks."""
    study = read_study(bundled_studies()[name])
    values, _ = study.values(0, study.design.size)
    paths = {path: values[path] for path in study.paths}
    outcome = ElementsAlone(study.scene, study.summaries, varied=list(paths)).evaluate(paths)
    assert (outcome.status == Verdict.OK).all()
    return values, outcome.summaries


def test_locomotive__sways_by_what_is_not_balanced_and_hammers_by_what_is():
    values, found = evaluated("locomotive")
    share, speed = values["elements.axle.balanced_reciprocating"], values["elements.axle.speed"]
    each = 180.0 * 0.325 * speed**2
    # Cranks at a right angle: forces as a diagonal, couples at half the spacing of the cylinders.
    np.testing.assert_allclose(
        found["axle.tractive_variation"], math.sqrt(2) * (1 - share) * each, rtol=1e-12, atol=1e-6
    )
    couple = math.sqrt(2) * (1 - share) * each * 0.35
    np.testing.assert_allclose(found["axle.swaying_couple"], couple, rtol=1e-12, atol=1e-6)
    # A cylinder's weight is split between wheels 1.5 m apart by levers, 1.1 m and 0.4 m; both throws, at a right angle.
    blow = share * each * math.hypot(1.1, 0.4) / 1.5
    np.testing.assert_allclose(found["axle.left_hammer_blow"], blow, rtol=1e-12, atol=1e-6)
    np.testing.assert_allclose(found["axle.least_wheel_load"], 80e3 - blow, rtol=1e-11)


def test_car__stops_by_equilibrium_of_moments_and_evenly():
    values, found = evaluated("braking_car")
    speed, friction = values["speed"], values["friction"]
    # Moments about the other axle: f·g·(rear distance)/(wheelbase − f·height), and so on.
    front, rear = (
        friction * 9.80665 * 1.45 / (2.6 - friction * 0.55),
        friction * 9.80665 * 1.15 / (2.6 + friction * 0.55),
    )
    for name, slows in (("all", friction * 9.80665), ("front", front), ("rear", rear)):
        np.testing.assert_allclose(found[f"{name}.deceleration"], slows, rtol=1e-12)
        np.testing.assert_allclose(found[f"{name}.stopping_distance"], speed + speed**2 / (2 * slows), rtol=1e-12)
