"""Coefficients, guides and journals against equilibrium solved as it stands and integrals over the contact."""

import math

import mpmath
import numpy as np
import pytest
from friction_ranges import frictions, loads, quick, sizes
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose

from engine.laws.friction.coefficients import NEW, SLIDING, STATIC_AND_KINETIC, WORN_IN, stribeck
from engine.laws.friction.guides import edge_forces, overhung_drive, slider_friction, tilts, vee_friction
from engine.laws.friction.journals import friction_circle, journal_moment

EPS = np.finfo(float).eps

# Coefficients


def test_tables__have_static_above_kinetic_and_ranges_in_order():
    assert all(0 < low <= high < 1 for low, high in SLIDING.values())
    assert all(0 < kinetic <= static <= 1 for static, kinetic in STATIC_AND_KINETIC.values())
    assert SLIDING["steel on steel"].low == 0.18


@quick
@given(frictions, frictions, st.floats(-5.0, 5.0), st.sampled_from([0.5, 1.0, 2.0]))
def test_stribeck__is_its_formula(static, kinetic, speed, exponent):
    with mpmath.workdps(50):
        fall = mpmath.exp(-((abs(mpf(speed)) / mpf(0.3)) ** exponent))
        expected = float(mpf(kinetic) + (mpf(static) - mpf(kinetic)) * fall)
    # The power's rounding, at most 2 eps of 300 at d = 2, counts by x e^-x < 0.4; the rest is a few roundings.
    assert_allclose(
        stribeck(static, kinetic, speed, 0.3, exponent), expected, rtol=0, atol=6 * EPS * (static + kinetic)
    )


# Guides


@quick
@given(st.floats(0.01, math.pi / 2), sizes, frictions)
def test_vee_guide__is_friction_on_two_faces_that_carry_the_load(half_angle, load, friction):
    face = load / (2 * math.sin(half_angle))
    assert_allclose(vee_friction(friction, half_angle) * load, 2 * friction * face, rtol=4 * EPS)


@quick
@given(loads, loads, sizes, frictions)
def test_slider_under_force_and_moment__is_in_equilibrium_on_its_edges(normal, moment, half_length, friction):
    front, rear = edge_forces(normal, moment, half_length)
    size = abs(front) + abs(rear)
    # Two roundings of the greater edge.
    assert_allclose(front + rear, normal, rtol=0, atol=4 * EPS * size)
    assert_allclose((front - rear) * half_length, moment, rtol=0, atol=4 * EPS * size * half_length)
    expected = friction * max(abs(normal), abs(moment) / half_length)
    assert_allclose(slider_friction(normal, moment, half_length, friction), expected, rtol=6 * EPS)
    assert tilts(normal, moment, half_length) == (abs(moment) > abs(normal) * half_length)
    if abs(abs(moment) - abs(normal) * half_length) > 1e-12 * abs(moment):
        assert tilts(normal, moment, half_length) == (np.sign(front) * np.sign(rear) < 0)


@quick
@given(st.floats(-2.0, 2.0), st.floats(0.0, 0.999))
def test_one_sided_slider__rubs_alike_under_pressure_spread_along_it(mean, lean):
    # Pressure that rises linearly over the length of 2, nowhere negative, has the force and the moment.
    def summed(weight):
        return mpmath.quad(lambda x: weight(x) * 10.0**mean * (1 + lean * x), [-1, 1])

    normal, moment = float(summed(lambda x: 1)), float(summed(lambda x: x))
    rubbing = 0.3 * float(summed(lambda x: 1))
    assert_allclose(slider_friction(normal, moment, 1.0, 0.3), rubbing, rtol=8 * EPS)


@quick
@given(sizes, sizes, st.floats(0.0, 20.0), frictions)
def test_overhung_drive__satisfies_its_equilibrium(resistance, normal, overhang, friction):
    drive = overhung_drive(resistance, normal, overhang, 1.0, friction)
    if friction * overhang >= 1:
        assert drive == math.inf
        return
    rubbing = slider_friction(normal, drive * overhang, 1.0, friction)
    # 1 - f e/a loses digits near jamming, by 1/(1 - f e/a).
    assert_allclose(drive, resistance + rubbing, rtol=8 * EPS / (1 - friction * overhang))


# Journals


@pytest.mark.parametrize(("factor", "pressure"), [(WORN_IN, mpmath.cos), (NEW, lambda angle: mpf(1))])
@quick
@given(sizes, frictions)
def test_journal__is_the_integral_of_pressure_and_friction_over_the_bush(factor, pressure, radius, friction):
    # Pressure acts towards the middle and friction f p along the surface, both resolved along the bush's middle.
    ends, f, r = [-mpmath.pi / 2, mpmath.pi / 2], mpf(friction), mpf(radius)
    along = mpmath.quad(lambda a: pressure(a) * (mpmath.cos(a) - f * mpmath.sin(a)), ends) * r
    across = mpmath.quad(lambda a: pressure(a) * (mpmath.sin(a) + f * mpmath.cos(a)), ends) * r
    moment = mpmath.quad(lambda a: f * pressure(a), ends) * r * r
    reaction = mpmath.hypot(along, across)
    assert_allclose(friction_circle(radius, friction, factor), float(moment / reaction), rtol=8 * EPS)
    assert_allclose(journal_moment(float(-reaction), radius, friction, factor), float(moment), rtol=10 * EPS)
