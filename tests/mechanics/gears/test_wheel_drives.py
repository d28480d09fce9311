"""Friction wheels and chain drives against their geometry: polygons turned, chains laid round circles."""

import math

import numpy as np
import pytest
from element_samples import CHAIN, FRICTION, element, one, results, solved
from hypothesis import given, settings
from hypothesis import strategies as st

from engine import Verdict
from sweeps.pictures.elements.element_pictures import element_sheet

EPS = np.finfo(float).eps


def near(found, exact):
    value, error = found
    assert abs(value - exact) <= error + 8 * EPS * abs(exact)


def test_friction_wheels__lag_by_their_creep_and_lose_it():
    found = solved(FRICTION)
    near(found["driven_speed"], -50 * 0.1 * 0.99 / 0.25)
    near(found["tangential_force"], 160.0)
    near(found["needed_press_force"], 1.5 * 160 / 0.2)
    # What is lost is the force times the speed of sliding.
    lost = found["input_power"][0] - 20 * abs(found["driven_speed"][0])
    assert lost == pytest.approx(160 * 0.01 * 50 * 0.05, rel=1e-12)
    near(found["efficiency"], 1 - lost / found["input_power"][0])
    assert one(FRICTION | {"internal": True}, "driven_speed")[0] > 0


def test_friction_wheels__slide_where_less_presses_them_than_suffices():
    pressed = np.array([700.0, 799.9, 800.1, 1200.0])
    found, _, status = results(FRICTION | {"press_force": 1000.0}, press_force=pressed)
    assert list(status) == [Verdict.SLIDES, Verdict.SLIDES, Verdict.OK, Verdict.OK]
    assert np.isnan(found["driven_speed"][:2]).all()
    np.testing.assert_allclose(found["traction_share"], 800 / pressed, rtol=1e-14)
    # Faces of a groove of 60 deg press twice as hard.
    grooved = solved(FRICTION | {"press_force": 401.0, "groove_angle": math.radians(60)})
    near(grooved["needed_press_force"], 600.0)


def test_wheel_in_a_ring__is_smaller_than_the_ring():
    found, _, status = results(FRICTION | {"internal": True}, driven_diameter=[0.09, 0.1, 0.11])
    assert list(status) == [Verdict.DOES_NOT_FIT, Verdict.DOES_NOT_FIT, Verdict.OK]
    assert list(np.isnan(found["tangential_force"])) == [True, True, False]


@given(z=st.integers(5, 60), ratio=st.floats(1, 5), speed=st.floats(1, 500))
@settings(max_examples=20)
def test_chain_speed__is_that_of_a_polygon_that_turns(z, ratio, speed):
    """The tight strand leaves along a tangent: its speed is that of the joint that carries it."""
    found = solved(CHAIN | {"driving_teeth": z, "driven_teeth": round(ratio * z), "speed": speed})
    radius = 0.0127 / (2 * math.sin(math.pi / z))
    # Half a pitch angle on both sides of the top, ends and middle among the samples.
    angle = np.linspace(-math.pi / z, math.pi / z, 2001)
    along = speed * radius * np.cos(angle)
    near(found["greatest_chain_speed"], along.max())
    assert found["speed_ripple"][0] == pytest.approx(1 - along.min() / along.max(), rel=1e-9)
    # The mean of a cosine over the same angle.
    near(found["chain_speed"], speed * radius * math.sin(math.pi / z) / (math.pi / z))
    near(found["greatest_acceleration"], speed**2 * radius * math.sin(math.pi / z))


def length_round(r1, r2, distance):
    """Length of a line laid tight round two circles."""
    lean = math.asin((r2 - r1) / distance)
    return 2 * distance * math.cos(lean) + r1 * (math.pi - 2 * lean) + r2 * (math.pi + 2 * lean)


@pytest.mark.parametrize(("z1", "z2", "distance"), [(17, 51, 0.5), (25, 25, 0.3), (19, 76, 0.8), (30, 40, 0.21)])
def test_links__lie_round_both_sprockets(z1, z2, distance):
    found = solved(CHAIN | {"driving_teeth": z1, "driven_teeth": z2, "distance": distance})
    pitch = 0.0127
    # Along circles with as long a rim as there are teeth; ((r₂ − r₁)/a)⁴/12 of the distance is left out.
    r1, r2 = (z * pitch / math.tau for z in (z1, z2))
    slip = ((r2 - r1) / distance) ** 4
    assert found["links"][0] * pitch == pytest.approx(length_round(r1, r2, distance), abs=slip * distance + 1e-12)
    fitted = found["fitted_distance"][0]
    links = round(length_round(r1, r2, fitted) / pitch)
    assert links % 2 == 0
    assert length_round(r1, r2, fitted) == pytest.approx(links * pitch, abs=slip * distance + 1e-12)
    assert abs(fitted - distance) <= 0.51 * pitch


def test_chain__pulls_by_the_driven_moment_and_its_own_mass():
    found = solved(CHAIN | {"linear_density": 0.7})
    near(found["pull"], 60 / (0.0127 / (2 * math.sin(math.pi / 51))))
    near(found["driving_moment"], 20.0)
    near(found["centrifugal_tension"], 0.7 * (50 * 17 * 0.0127 / math.tau) ** 2)


def test_sprockets__have_whole_teeth_and_room():
    status = results(CHAIN | {"distance": 0.4}, driving_teeth=[17, 17.5])[2]
    assert list(status) == [Verdict.OK, Verdict.FRACTION_OF_A_TOOTH]
    assert results(CHAIN | {"distance": 0.12})[2] == Verdict.DOES_NOT_FIT
    # Their radii are 137.7 mm together. At 140 mm the chain has 58.7 links; with 58 they would overlap.
    status = results(CHAIN | {"distance": 0.14}, distance=[0.14, 0.144])[2]
    assert list(status) == [Verdict.DOES_NOT_FIT, Verdict.OK]


@pytest.mark.parametrize("speed", [50.0, -50.0])
def test_drawn_chain__touches_both_pitch_circles_and_is_tight_where_it_is_drawn_in(speed):
    drive = element(CHAIN | {"distance": 0.4, "speed": speed})
    layout, _ = element_sheet(drive).axes
    tight = next(line for line in layout.get_lines() if line.get_label() == "tight strand")
    (x, y), radii = np.array(tight.get_data()), [0.5e3 * 0.0127 / math.sin(math.pi / z) for z in (17, 51)]
    along = np.array([np.diff(x)[0], np.diff(y)[0]]) / math.hypot(np.diff(x)[0], np.diff(y)[0])
    for point, radius, centre in zip(zip(x, y, strict=True), radii, (0.0, 400.0), strict=True):
        arm = np.array(point) - (centre, 0.0)
        assert arm @ along == pytest.approx(0.0, abs=1e-12 * radius)
        assert np.hypot(*arm) == pytest.approx(radius, rel=1e-13)
    # There the rim of the driving sprocket moves away from the driven one, and draws the chain along.
    assert speed * (x[0] * along[1] - y[0] * along[0]) < 0.0
