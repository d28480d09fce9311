"""Pictures of belts, guides, journals and vehicles: their curves are the textbook's formulas."""

import math

import numpy as np
import pytest
from element_samples import BELT, DISC, GUIDE, INCLINE, JOURNAL, LEVER, WOUND, one, scene

from engine import body_ellipsoid
from sweeps.pictures.elements.element_pictures import element_sheet
from sweeps.pictures.picture_error import PictureError


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


PLATE = {"type": "tilted_body", "mass": 8.0, "semi_axis_x": 0.1, "semi_axis_y": 0.06, "semi_axis_z": 0.02}

TIE = {"type": "tethered_body", "mass": 2.0, "length": 1.2, "stiffness": 4e4, "strength": 3e3, "speed": 25.0}


def axes_of(figure, label):
    return next(ax for ax in figure.axes if ax.get_title().lower().startswith(label))


def test_lever__shows_the_hyperbolic_cosine_and_the_coriolis_force_on_it():
    figure = element_sheet(scene(it=LEVER).elements["it"], "lever")
    time, distance = axes_of(figure, "distance").get_lines()[0].get_data()
    assert distance == pytest.approx(100.0 * np.cosh(20.0 * time), rel=1e-12)
    assert (time[-1], distance[-1]) == pytest.approx((math.acosh(5.0) / 20.0, 500.0), rel=1e-12)
    _, force = axes_of(figure, "reaction").get_lines()[0].get_data()
    assert force == pytest.approx(2 * 0.4 * 20.0 * 0.1 * 20.0 * np.sinh(20.0 * time), rel=1e-12, abs=1e-12)


def test_curves_of_a_wound_flywheel__are_its_results():
    parting, bore, layer = one(WOUND, "parting_speed", "bore_stress", "layer_stress")
    figure = element_sheet(scene(it=WOUND).elements["it"], "tape")
    drawn = {line.get_label(): line.get_ydata() for line in axes_of(figure, "hoop").get_lines()}
    assert parting > WOUND["speed"]
    assert drawn["at its speed"][0] * 1e6 == pytest.approx(bore, rel=1e-12)
    assert drawn["at its speed"].max() * 1e6 == pytest.approx(layer, rel=1e-6)
    faster = scene(it=WOUND | {"speed": 1.1 * parting}).elements["it"]
    loose = element_sheet(faster, "tape")
    assert "at its speed" not in {line.get_label() for line in axes_of(loose, "hoop").get_lines()}


def test_polygon_of_a_flat_rotor__is_closed_by_the_mass_that_balances_it():
    (ax,) = element_sheet(scene(it=DISC).elements["it"], "disc").axes
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
    semi_axes, axes = body_ellipsoid(scene(it=turned | moments).elements["it"])
    assert semi_axes == pytest.approx([a, b, c], rel=1e-12)
    # The longest one lies where yaw and pitch turn x to.
    along = [math.cos(0.4) * math.cos(1.1), math.sin(0.4) * math.cos(1.1), math.sin(1.1)]
    assert abs(axes[:, 0] @ along) == pytest.approx(1.0, rel=1e-12)


def test_outline_of_a_tilted_body__goes_as_far_as_the_ellipsoid():
    element = scene(it=PLATE | {"pitch": 0.5, "x": 0.012, "z": 0.03}).elements["it"]
    front = element_sheet(element, "plate").axes[0]
    x, z = next(line for line in front.get_lines() if line.get_label() == "outline").get_data()
    # The farthest point in a direction n is √(nᵀ R diag(a², b², c²) Rᵀ n) away.
    high = 1e3 * math.hypot(0.1 * math.sin(0.5), 0.02 * math.cos(0.5))
    wide = 1e3 * math.hypot(0.1 * math.cos(0.5), 0.02 * math.sin(0.5))
    assert (z.max(), z.min()) == pytest.approx((30.0 + high, 30.0 - high), rel=1e-12)
    assert (x.max(), x.min()) == pytest.approx((12.0 + wide, 12.0 - wide), rel=1e-12)


def test_moments_that_no_body_has__are_not_drawn():
    moments = {"inertia_x": 1.0, "inertia_y": 1.0, "inertia_z": 3.0}
    element = scene(it={"type": "tilted_body", "mass": 8.0} | moments).elements["it"]
    with pytest.raises(PictureError, match="no results"):
        element_sheet(element, "none")


def test_way_on_an_elastic_tie__stretches_it_as_far_as_energy_and_moment_of_momentum_allow():
    plan, pull = element_sheet(scene(it=TIE).elements["it"], "tie").axes
    x, y = next(line for line in plan.get_lines() if line.get_label() == "after the impulse").get_data()
    (stretch,) = one(TIE, "impulse_stretch")
    # The way is followed to 1e-8 a step, and drawn at places between which its distance stays within 1e-5 of its peak.
    assert np.hypot(x, y).max() == pytest.approx(1e3 * (TIE["length"] + stretch), rel=1e-5)
    assert np.hypot(x, y).min() == pytest.approx(1e3 * TIE["length"], rel=1e-5)
    (burst,) = one(TIE, "impulse_burst_speed")
    speed, force = next(line for line in pull.get_lines() if line.get_label() == "by an impulse").get_data()
    # Straight between places that are a few hundredths of the speed apart.
    assert np.interp(burst, speed, force) == pytest.approx(1e-3 * TIE["strength"], rel=1e-4)
