"""Pictures of elements over their coefficient of friction: their curves are the textbook's formulas."""

import math

import numpy as np
import pytest
from element_samples import BELT, GUIDE, INCLINE, JOURNAL, scene

from sweeps.pictures.elements.element_pictures import element_sheet


def curves(element) -> dict:
    figure = element_sheet(scene(it=element).elements["it"], "it")
    return {line.get_label(): np.array(line.get_data()) for ax in figure.axes for line in ax.get_lines()}


def test_belt__its_tensions_are_eytelweins():
    drawn = curves(BELT)
    friction, ratio = drawn["tension ratio"]
    assert friction[-1] == pytest.approx(0.6)
    assert ratio == pytest.approx(np.exp(friction * 3.0), rel=1e-12)
    # In kN, as the shaft bears more than one at the friction given.
    assert drawn["slack tension"][1] == pytest.approx(0.9 / ratio, rel=1e-12)


def test_incline__its_efficiency_is_that_of_the_plane():
    friction, efficiency = curves(INCLINE)["efficiency"]
    # Of a pull along the plane: tan α / (tan α + μ).
    assert efficiency == pytest.approx(math.tan(0.35) / (math.tan(0.35) + friction), rel=1e-12)


def test_guide__its_curves_end_where_it_jams():
    friction, force = curves({**GUIDE, "overhang": 0.4, "load": 0.0})["drive force"]
    # A slider of length l pushed at an overhang h jams from l/(2h) on.
    assert (np.isnan(force) == (friction >= 0.25)).all()


def drawn_by(element) -> dict:
    figure = element_sheet(scene(it=element).elements["it"], "it")
    return {line.get_label(): np.array(line.get_data()) for line in figure.axes[1].get_lines()}


def test_journal__its_moments_go_by_the_sine_of_the_angle_of_friction():
    drawn = drawn_by({**JOURNAL, "load": 100.0, "diameter": 0.06, "friction": 0.1})
    friction, moment = drawn["line"]
    # M = R r sin atan f, and nearly so many times as much in a bush that is worn in, or new.
    assert moment == pytest.approx(100.0 * 0.03 * np.sin(np.arctan(friction)), rel=1e-12)
    assert drawn["worn in"][1][5] / moment[5] == pytest.approx(4.0 / math.pi, rel=1e-2)
    assert drawn["new"][1][5] / moment[5] == pytest.approx(math.pi / 2.0, rel=1e-2)


def test_roller__its_pull_grows_with_the_arm_until_it_slides():
    roller = {"type": "roller", "load": 5000.0, "diameter": 0.4, "rolling_arm": 0.03, "friction": 0.2}
    arm, pull = drawn_by(roller)["force that moves it"]
    # k in mm, F = N k/r up to f N, in kN.
    assert pull == pytest.approx(np.minimum(5.0 * arm / 200.0, 1.0), rel=1e-12)
