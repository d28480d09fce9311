"""Curves in the pictures of elements are closed forms, and the results of the element."""

import math

import numpy as np
import pytest
from element_samples import CAR, DISC, LEVER, TIE, WOUND, element, one

from engine import body_ellipsoid
from sweeps.pictures.elements.element_pictures import element_sheet

PLATE = {"type": "tilted_body", "mass": 8.0, "semi_axis_x": 0.1, "semi_axis_y": 0.06, "semi_axis_z": 0.02}


def axes_of(figure, label):
    return next(ax for ax in figure.axes if ax.get_title().lower().startswith(label))


def test_lever__shows_the_hyperbolic_cosine_and_the_coriolis_force_on_it():
    figure = element_sheet(element(LEVER), "lever")
    time, distance = axes_of(figure, "distance").get_lines()[0].get_data()
    assert distance == pytest.approx(100.0 * np.cosh(20.0 * time), rel=1e-12)
    assert (time[-1], distance[-1]) == pytest.approx((math.acosh(5.0) / 20.0, 500.0), rel=1e-12)
    _, force = axes_of(figure, "reaction").get_lines()[0].get_data()
    assert force == pytest.approx(2 * 0.4 * 20.0 * 0.1 * 20.0 * np.sinh(20.0 * time), rel=1e-12, abs=1e-12)


def test_curves_of_a_wound_flywheel__are_its_results():
    parting, bore, layer = one(WOUND, "parting_speed", "bore_stress", "layer_stress")
    figure = element_sheet(element(WOUND), "tape")
    drawn = {line.get_label(): line.get_ydata() for line in axes_of(figure, "hoop").get_lines()}
    assert parting > WOUND["speed"]
    assert drawn["at its speed"][0] * 1e6 == pytest.approx(bore, rel=1e-12)
    assert drawn["at its speed"].max() * 1e6 == pytest.approx(layer, rel=1e-6)
    faster = element(WOUND | {"speed": 1.1 * parting})
    loose = element_sheet(faster, "tape")
    assert "at its speed" not in {line.get_label() for line in axes_of(loose, "hoop").get_lines()}


def test_polygon_of_a_flat_rotor__is_closed_by_the_mass_that_balances_it():
    (ax,) = element_sheet(element(DISC), "disc").axes
    drawn = {line.get_label(): np.array(line.get_data()) for line in ax.get_lines()}
    start, end = drawn["balance mass, added"].T
    unbalance, angle = one(DISC, "unbalance", "correction_angle")
    way = 1e3 * unbalance * np.array([math.cos(angle), math.sin(angle)])
    assert end - start == pytest.approx(way, abs=1e-12 * 1e3 * unbalance)
    assert end == pytest.approx(0.0, abs=1e-12)


def test_moments_of_an_ellipsoid__give_it_back():
    a, b, c = 0.1, 0.06, 0.02
    moments = {"inertia_x": 1.6 * (b**2 + c**2), "inertia_y": 1.6 * (c**2 + a**2), "inertia_z": 1.6 * (a**2 + b**2)}
    turned = {"type": "tilted_body", "mass": 8.0, "yaw": 0.4, "pitch": -1.1, "roll": 2.0}
    semi_axes, axes = body_ellipsoid(element(turned | moments))
    assert semi_axes == pytest.approx([a, b, c], rel=1e-12)
    # The longest one lies where yaw and pitch turn x to.
    along = [math.cos(0.4) * math.cos(1.1), math.sin(0.4) * math.cos(1.1), math.sin(1.1)]
    assert abs(axes[:, 0] @ along) == pytest.approx(1.0, rel=1e-12)


def test_outline_of_a_tilted_body__goes_as_far_as_the_ellipsoid():
    plate = element(PLATE | {"pitch": 0.5, "x": 0.012, "z": 0.03})
    front = element_sheet(plate, "plate").axes[0]
    x, z = next(line for line in front.get_lines() if line.get_label() == "outline").get_data()
    # The farthest point in a direction n is √(nᵀ R diag(a², b², c²) Rᵀ n) away.
    high = 1e3 * math.hypot(0.1 * math.sin(0.5), 0.02 * math.cos(0.5))
    wide = 1e3 * math.hypot(0.1 * math.cos(0.5), 0.02 * math.sin(0.5))
    assert (z.max(), z.min()) == pytest.approx((30.0 + high, 30.0 - high), rel=1e-12)
    assert (x.max(), x.min()) == pytest.approx((12.0 + wide, 12.0 - wide), rel=1e-12)


def test_way_on_an_elastic_tie__stretches_it_as_far_as_energy_and_moment_of_momentum_allow():
    plan, pull = element_sheet(element(TIE), "tie").axes
    x, y = next(line for line in plan.get_lines() if line.get_label() == "after the impulse").get_data()
    (stretch,) = one(TIE, "impulse_stretch")
    # The way is followed to 1e-8 a step, and drawn at places between which its distance stays within 1e-5 of its peak.
    assert np.hypot(x, y).max() == pytest.approx(1e3 * (TIE["length"] + stretch), rel=1e-5)
    assert np.hypot(x, y).min() == pytest.approx(1e3 * TIE["length"], rel=1e-5)
    (burst,) = one(TIE, "impulse_burst_speed")
    speed, force = next(line for line in pull.get_lines() if line.get_label() == "by an impulse").get_data()
    # Straight between places that are a few hundredths of the speed apart.
    assert np.interp(burst, speed, force) == pytest.approx(1e-3 * TIE["strength"], rel=1e-4)


# Cars


def curves(ax) -> dict:
    return {line.get_label(): np.array(line.get_data()) for line in ax.get_lines()}


@pytest.mark.parametrize("brakes", ["front", "rear", "all"])
def test_car__comes_to_rest_where_its_results_say(brakes):
    figure = element_sheet(element(CAR | {"speed": 15.0, "reaction_time": 0.8, "brakes": brakes}), "car")
    over_speed, along = figure.axes
    speed, way = curves(over_speed)[f"brakes: {brakes}"]
    (thick,) = (line for line in along.get_lines() if line.get_linewidth() > 1.0)
    passed, left = thick.get_data()
    assert (left[0], left[-1]) == (pytest.approx(15.0), 0.0)
    # At 15 m/s, two thirds of the greatest speed; linear between points 1/240 apart the square misses 1e-5 of it.
    assert passed[-1] == pytest.approx(np.interp(15.0, speed, way), rel=1e-4)
    assert passed[1] == pytest.approx(12.0)
