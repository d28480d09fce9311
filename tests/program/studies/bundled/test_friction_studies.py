"""Bundled studies with friction in pairs: they give numbers that a hand calculation confirms."""

import math

import numpy as np
import pytest
from test_studies import FRICTION_STUDY_NAMES, as_it_is, otto_work, sample, variants

from engine.laws.friction.coefficients import WORN_IN
from engine.laws.friction.journals import friction_circle


@pytest.mark.parametrize("name", FRICTION_STUDY_NAMES)
def test_study_with_friction__is_far_from_jamming(name):
    assert (sample(name).summaries["jamming_margin"] > 0.5).all()


def test_toggle_press_study__has_the_force_of_leaning_bars():
    values, o, e = variants("toggle_press")
    load, bar, reach, f = 100e3, 0.150, values["reach"], values["coefficient"]
    circle = np.array([friction_circle(d / 2, c, WORN_IN) for d, c in zip(values["pin"], f, strict=True)])
    # Of the bars' forces the upper leans by one friction circle, the lower by two; the ways by their angle.
    alpha = np.arcsin(reach / bar)
    upper, lower = np.tan(alpha + np.arcsin(circle / bar)), np.tan(alpha + np.arcsin(2 * circle / bar))
    expected = load / (1 - f * lower) * (upper + lower)
    assert (abs(o["input_moment_with_friction.min"] - expected) <= 1e-9 * load).all()
    assert (abs(o["input_moment.min"] - load * 2 * np.tan(alpha)) <= 1e-9 * load).all()
    works = sum(o[f"{pair}.friction_work"] for pair in ("knee.first", "press.first", "press.inner", "press.second"))
    np.testing.assert_allclose(works, o["friction_loss"], rtol=1e-12)
    assert (e["friction_loss"] <= 0.01 * o["friction_loss"]).all()


def test_engine_bearings_study__turns_the_work_of_the_gas_into_work_and_friction():
    _, o, e = variants("engine_bearings")
    swept = math.pi / 4 * 0.088**2 * 2 * 0.032
    work = otto_work(8.0, 59e5, swept)
    expected = 1 - o["friction_loss"] / work
    doubt = e["mechanical_efficiency"] + e["friction_loss"] / work + 1e-3
    assert (abs(o["mechanical_efficiency"] - expected) <= doubt).all()
    parts = sum(o[f"{pair}.friction_work"] for pair in ("input", "drive.first", "drive.second"))
    # What is left is the gudgeon pin's: little, it only swings.
    assert ((parts < o["friction_loss"]) & (o["friction_loss"] < 1.1 * parts)).all()


def test_engine_bearings_scene__carries_the_gas_less_inertia_at_its_peak():
    values, _ = as_it_is("engine_bearings")
    area, r, omega = math.pi / 4 * 0.088**2, 0.032, 3000 * 2 * math.pi / 60
    gas = (59e5 - 1e5) * area
    # At the top the piston and a third of the rod go down with r omega² (1 + r/l), 1.05 kN for each kg or so.
    inertia = (0.42 + 0.35 * 0.3) * r * omega**2 * (1 + 32 / 110)
    # The peak of pressure is passed after some degrees: 5 %.
    assert values["drive.first.reaction.max"][0] == pytest.approx(gas - inertia, rel=0.05)
