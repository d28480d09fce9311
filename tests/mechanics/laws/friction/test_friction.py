"""Coefficients, guides and journals against equilibrium solved as it stands and integrals over the contact."""

import math

import mpmath
import numpy as np
import pytest
from element_samples import GUIDE, JOURNAL, element, one
from friction_ranges import frictions, loads, quick, sizes
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose

from engine.laws.friction.coefficients import MATERIALS, stribeck

EPS = np.finfo(float).eps

# Coefficients


def test_materials__have_coefficients_below_1():
    assert all(0 < coefficient < 1 for coefficient in MATERIALS.values())
    assert MATERIALS["steel on steel"] == 0.18


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
@given(sizes, loads, st.floats(-20.0, 20.0), frictions)
def test_slider__is_in_equilibrium_on_its_edges(resistance, load, overhang, friction):
    numbers = {"resistance": resistance, "load": load, "overhang": overhang, "friction": friction, "length": 2.0}
    with np.errstate(divide="ignore", invalid="ignore"):
        found = element(GUIDE).values({key: np.array([value]) for key, value in numbers.items()})
    drive, rubbing, front, rear, tilts = (
        float(found[name][0])
        for name in ("drive_force", "friction_force", "front_edge_force", "rear_edge_force", "tilts")
    )
    left = 1 - friction * abs(overhang)
    if left <= 0.0:
        assert drive == math.inf
        return
    size = abs(front) + abs(rear)
    assert_allclose(front + rear, load, rtol=0, atol=4 * EPS * size)
    assert_allclose(front - rear, drive * overhang, rtol=0, atol=4 * EPS * size)
    # 1 - f e/a loses digits near jamming, by 1/(1 - f e/a).
    assert_allclose(drive, resistance + rubbing, rtol=8 * EPS / left)
    assert_allclose(rubbing, friction * size, rtol=4 * EPS)
    if abs(abs(drive * overhang) - abs(load)) > 1e-12 * abs(load):
        assert tilts == (np.sign(front) * np.sign(rear) < 0)


# Journals


@pytest.mark.parametrize(("contact", "pressure"), [("worn in", mpmath.cos), ("new", lambda angle: mpf(1))])
@quick
@given(sizes, frictions)
def test_journal__is_the_integral_of_pressure_and_friction_over_the_bush(contact, pressure, radius, friction):
    # Pressure acts towards the middle and friction f p along the surface, both resolved along the bush's middle.
    ends, f, r = [-mpmath.pi / 2, mpmath.pi / 2], mpf(friction), mpf(radius)
    along = mpmath.quad(lambda a: pressure(a) * (mpmath.cos(a) - f * mpmath.sin(a)), ends) * r
    across = mpmath.quad(lambda a: pressure(a) * (mpmath.sin(a) + f * mpmath.cos(a)), ends) * r
    moment = mpmath.quad(lambda a: f * pressure(a), ends) * r * r
    reaction = mpmath.hypot(along, across)
    given = {"load": float(reaction), "diameter": 2.0 * radius, "friction": friction, "contact": contact}
    found = one(JOURNAL, "friction_circle", "friction_moment", **given)
    assert_allclose(found, [float(moment / reaction), float(moment)], rtol=10 * EPS)
