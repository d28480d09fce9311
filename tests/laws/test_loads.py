"""Loads against their definitions in 50 digits, and against the energy they must take from the machine."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from numpy.testing import assert_allclose
from packed import assert_packed

from engine.compiling.tiles import TILE_OPTIONS
from engine.laws.loads import (
    acts_in_direction,
    constant_against_motion,
    linear_drag,
    power_law_drag,
    quadratic_drag,
    spring,
)

EPS = np.finfo(float).eps
# Wide, but with products that stay inside float64's range.
speeds = st.floats(-1e5, 1e5, allow_subnormal=False).filter(lambda v: v == 0.0 or abs(v) > 1e-30)
sizes = st.floats(1e-12, 1e12)


@settings(deadline=None, max_examples=100)
@given(sizes, speeds)
def test_constant_linear_quadratic__are_their_definitions(c, v):
    with mpmath.workdps(50):
        linear = -mpmath.mpf(c) * mpmath.mpf(v)
        quadratic = linear * abs(mpmath.mpf(v))
    # One rounding for each product.
    assert constant_against_motion(c, v) == -c * np.sign(v)
    assert_allclose(linear_drag(c, v), float(linear), rtol=EPS)
    assert_allclose(quadratic_drag(c, v), float(quadratic), rtol=2 * EPS)


@settings(deadline=None, max_examples=100)
@given(sizes, st.floats(0.0, 4.0), speeds)
def test_power_law__agrees_with_mpmath(c, exponent, v):
    with mpmath.workdps(50):
        expected = float(-c * mpmath.sign(v) * abs(mpmath.mpf(v)) ** mpmath.mpf(exponent))
    # pow is good to 1 ulp, the product adds half of one; the fast-math rules may re-form pow (x**2, x**0.5).
    assert_allclose(power_law_drag(c, exponent, v), expected, rtol=4 * EPS)


@settings(deadline=None, max_examples=60)
@given(sizes, speeds)
def test_power_law__covers_the_other_resistances(c, v):
    assert power_law_drag(c, 0.0, v) == constant_against_motion(c, v)
    assert_allclose(power_law_drag(c, 1.0, v), linear_drag(c, v), rtol=4 * EPS)
    assert_allclose(power_law_drag(c, 2.0, v), quadratic_drag(c, v), rtol=4 * EPS)


@settings(deadline=None, max_examples=60)
@given(sizes, speeds, st.floats(0.0, 4.0))
def test_resistances__never_feed_the_machine_and_are_odd(c, v, exponent):
    for load in (
        lambda u: constant_against_motion(c, u),
        lambda u: linear_drag(c, u),
        lambda u: quadratic_drag(c, u),
        lambda u: power_law_drag(c, exponent, u),
    ):
        assert load(v) * v <= 0.0
        assert load(-v) == -load(v)
        assert load(0.0) == 0.0


def test_braking_by_a_constant_moment__stops_after_the_textbook_angle():
    # A_braking = I omega0^2/2: 0.4 kg m^2 at 100 rad/s against 0.8 N m turns 2500 rad. Velocity is linear in
    # time over 50 s, so 2000 trapezoids integrate the power 0.8 omega to rounding.
    t = np.linspace(0.0, 50.0, 2001)
    omega = 100.0 - 2.0 * t
    power = np.array([constant_against_motion(0.8, w) * w for w in omega])
    assert_allclose(np.trapezoid(power, t), -0.5 * 0.4 * 100.0**2, rtol=1e-12)


@settings(deadline=None, max_examples=60)
@given(sizes, st.floats(1e-6, 10.0), st.floats(1e-6, 10.0))
def test_spring__does_the_work_of_its_energy(stiffness, free_length, length):
    # The force is linear in the length, so the trapezoid over one step is its exact work -k (l - l0)^2/2; the
    # rounded l0 - l is the same number (but for its sign) on both sides.
    work = (
        (spring(stiffness, free_length, free_length) + spring(stiffness, free_length, length))
        / 2
        * (length - free_length)
    )
    assert_allclose(work, -stiffness * (length - free_length) ** 2 / 2, rtol=8 * EPS)
    assert spring(stiffness, 1.0, 0.5) > 0.0


@pytest.mark.parametrize(
    ("direction", "v", "factor"),
    [
        (1, 2.0, 1),
        (1, -2.0, 0),
        (1, 0.0, 0),
        (-1, 2.0, 0),
        (-1, -2.0, 1),
        (-1, 0.0, 0),
        (0, 2.0, 1),
        (0, 0.0, 1),
    ],
)
def test_acts_in_direction__is_one_in_its_direction_only(direction, v, factor):
    assert acts_in_direction(float(direction), v) == factor


def test_unknown_velocity__gives_nan():
    loads = [
        constant_against_motion(1.0, math.nan),
        linear_drag(1.0, math.nan),
        quadratic_drag(1.0, math.nan),
        power_law_drag(1.0, 0.0, math.nan),
        power_law_drag(1.0, 1.5, math.nan),
        spring(1.0, 1.0, math.nan),
        acts_in_direction(1.0, math.nan),
    ]
    assert np.isnan(loads).all()


def test_a_loop_over_speeds__is_compiled_to_packed_instructions():
    @njit(**{**TILE_OPTIONS, "cache": False})
    def loop(x, out):
        for i in range(x.size):
            out[i] = power_law_drag(3.0, 1.4, x[i])

    x, out = np.linspace(-2.0, 2.0, 37), np.empty(37)
    loop(x, out)
    assert_allclose(out, [power_law_drag(3.0, 1.4, v) for v in x], rtol=4 * EPS)
    assert_packed(loop, 1)
