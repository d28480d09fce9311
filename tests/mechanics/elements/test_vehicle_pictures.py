"""Pictures of locomotives and cars: their curves are the textbook's formulas."""

import math

import numpy as np
import pytest
from element_samples import scene

from sweeps.pictures.elements.element_pictures import element_sheet

AXLE = {
    "type": "locomotive",
    "cylinder_spacing": 0.7,
    "wheel_spacing": 1.5,
    "stroke": 0.6,
    "rotating_mass": 150.0,
    "reciprocating_mass": 180.0,
    "balance_radius": 0.6,
    "speed": 10 * math.pi,
    "wheel_load": 40e3,
}
CAR = {
    "type": "car",
    "speed": 15.0,
    "friction": 0.6,
    "wheelbase": 2.8,
    "rear_distance": 1.2,
    "height": 0.6,
    "gravity": 9.81,
    "reaction_time": 0.8,
}


def curves(ax) -> dict:
    return {line.get_label(): np.array(line.get_data()) for line in ax.get_lines()}


def test_locomotive__has_the_curves_of_two_cylinders_at_a_right_angle():
    figure = element_sheet(scene(axle=AXLE).elements["axle"], "axle")
    forces, blows, couple = (
        next(ax for ax in figure.axes if ax.get_title().lower().startswith(label))
        for label in ("unbalanced", "peak", "swaying")
    )
    # A third of the reciprocating masses: (1 − c) m ω² r (cos φ − sin φ), and (a/2)(…)(−cos φ − sin φ).
    left_over = 180 * 0.3 * (10 * math.pi) ** 2 / 3
    angle, pull = curves(forces)["along the track"]
    phi = np.radians(angle)
    assert pull * 1e3 == pytest.approx(left_over * (np.cos(phi) - np.sin(phi)), abs=1e-9 * left_over)
    _, sway = next(iter(curves(couple).values()))
    assert sway * 1e3 == pytest.approx(0.35 * left_over * (-np.cos(phi) - np.sin(phi)), abs=1e-9 * left_over)
    # Hammer blows go with the square of the speed, up to beyond the one at which a wheel lifts off.
    speed, blow = curves(blows)["hammer blow, left"]
    assert blow == pytest.approx(blow[-1] * (speed / speed[-1]) ** 2, rel=1e-12)
    arms = math.hypot(1.5 + 0.7, 1.5 - 0.7) / 3.0
    assert blow[-1] * 1e3 == pytest.approx(120 * 0.3 * arms * (speed[-1] * math.pi / 30) ** 2, rel=1e-12)
    assert blow.max() > 40.0


@pytest.mark.parametrize("brakes", ["front", "rear", "all"])
def test_car__comes_to_rest_where_its_results_say(brakes):
    figure = element_sheet(scene(car=CAR | {"brakes": brakes}).elements["car"], "car")
    over_speed, along = figure.axes
    speed, way = curves(over_speed)[f"brakes: {brakes}"]
    (thick,) = (line for line in along.get_lines() if line.get_linewidth() > 1.0)
    passed, left = thick.get_data()
    assert (left[0], left[-1]) == (pytest.approx(15.0), 0.0)
    # At 15 m/s, two thirds of the greatest speed; linear between points 1/240 apart the square misses 1e-5 of it.
    assert passed[-1] == pytest.approx(np.interp(15.0, speed, way), rel=1e-4)
    assert passed[1] == pytest.approx(12.0)
