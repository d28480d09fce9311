"""Brakes against published problems, Machinery's Handbook and quadrature over the rubbing surface."""

import math

import mpmath
import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from engine.laws.brakes import (
    band_and_block_grip,
    band_brake,
    long_block_factor,
    pressed_brake,
    uniform_pressure_radius,
    uniform_wear_radius,
)

EPS = np.finfo(float).eps

lengths = st.floats(-3.0, 1.0).map(lambda exponent: 10.0**exponent)
frictions = st.floats(0.001, 1.0)


# Published problems, to the digits printed


def test_long_block_on_a_lever__khurmi():
    # Khurmi & Gupta, chapter 19: drum 250 mm, 2 theta = 90 degrees, 700 N at 450 mm, block at 200 mm, friction
    # 50 mm from the fulcrum and pressing the block on, f = 0.35, hence f' = 0.385. The MP Vyapam examination of
    # 2018 prints 83.75 N·m, from rounded numbers.
    friction = 0.35 * long_block_factor(math.pi / 4)
    assert round(friction, 3) == 0.385
    normal = 700.0 * 0.45 / (0.2 - friction * 0.05)
    assert_allclose(pressed_brake(normal, friction, 0.125, 1.0), 83.75, atol=0.15)


# Independent computations


@settings(max_examples=40)
@given(st.floats(1e-9, math.pi / 2))
def test_long_block_factor__is_friction_over_resultant_normal_force(half_angle):
    def pressed(weight):
        return quad(lambda angle: math.cos(angle) * weight(angle), -half_angle, half_angle, epsabs=0, epsrel=1e-13)[0]

    # The pressure cos(angle) rubs everywhere at the radius, but only its part along the middle carries the force.
    expected = pressed(lambda angle: 1.0) / pressed(math.cos)
    assert_allclose(long_block_factor(half_angle), expected, rtol=1e-12)


@settings(max_examples=40)
@given(lengths, lengths, st.sampled_from(["new", "worn"]))
def test_mean_radius_of_a_disc__is_the_quadrature_over_the_ring(inner, width, state):
    outer = inner + width
    radius = uniform_pressure_radius if state == "new" else uniform_wear_radius
    power = 0 if state == "new" else -1
    with mpmath.workdps(30):
        ring = [mpmath.mpf(inner), mpmath.mpf(outer)]
        moment = mpmath.quad(lambda r: r**power * r * r, ring)
        force = mpmath.quad(lambda r: r**power * r, ring)
        # Some six roundings of positive numbers.
        assert_allclose(radius(inner, outer), float(moment / force), rtol=6 * EPS)
    assert_allclose(
        pressed_brake(7.0, 0.3, radius(inner, outer), 4.0), 7.0 * 0.3 * 4 * float(moment / force), rtol=9 * EPS
    )


@settings(max_examples=40)
@given(st.floats(1.0, 1e4), lengths, lengths, st.floats(-3.0, 3.0), frictions, st.floats(0.01, 20.0), lengths)
def test_band_brake__is_euler_on_a_lever_in_equilibrium(force, lever_arm, arm, other, friction, wrap, radius):
    slack_arm, tight_arm = arm, other * arm
    moment = band_brake(force, lever_arm, slack_arm, tight_arm, friction, wrap, radius)
    if other <= -1.0:
        assert math.isnan(moment)
        return
    with mpmath.workdps(50):
        # d(tension)/d(angle) = f tension along the band.
        growth = mpmath.exp(mpmath.mpf(friction) * mpmath.mpf(wrap))
        left = mpmath.mpf(slack_arm) + tight_arm * growth
        part = float((slack_arm + abs(tight_arm) * growth) / abs(left))
        assume(part < 1e10)
        if left <= 0:
            assert moment == math.inf
            return
        slack = mpmath.mpf(force) * lever_arm / left
        expected = float((growth - 1) * slack * radius)
    # The exponential has an error of EPS f alpha, the lever's equation may cancel.
    assert_allclose(moment, expected, rtol=EPS * (10 + friction * wrap) * (1 + part))


def test_released_brake__has_no_moment():
    for force in (0.0, -5.0):
        assert pressed_brake(force, 0.3, 0.1, 2.0) == 0.0
        assert band_brake(force, 0.5, 0.15, -0.035, 0.3, 4.0, 0.1) == 0.0
        assert band_brake(force, 0.5, 0.15, -0.1, 0.3, 4.0, 0.1) == 0.0


def test_unknown_number__gives_nan():
    for function, arguments in [
        (pressed_brake, [20.0, 0.2, 0.1, 2.0]),
        (long_block_factor, [0.5]),
        (uniform_wear_radius, [0.1, 0.2]),
        (uniform_pressure_radius, [0.1, 0.2]),
        (band_brake, [10.0, 0.5, 0.15, -0.03, 0.3, 4.0, 0.1]),
    ]:
        for place in range(len(arguments)):
            unknown = [math.nan if k == place else number for k, number in enumerate(arguments)]
            assert math.isnan(function(*unknown)), (function, place)


# Band and blocks


@settings(max_examples=40)
@given(frictions, st.floats(0.01, 1.2), st.integers(1, 20))
def test_band_and_blocks__has_every_block_in_equilibrium(friction, block_angle, blocks):
    half = block_angle / 2
    tension = 1.0
    for _ in range(blocks):
        # Unknown: tension beyond the block and the normal force on it.
        equations = [[math.cos(half), -friction], [math.sin(half), -1.0]]
        tension = np.linalg.solve(equations, [tension * math.cos(half), -tension * math.sin(half)])[0]
    # Each block's rounding is carried by those after it.
    assert_allclose(math.exp(band_and_block_grip(friction, block_angle, blocks)), tension, rtol=40 * EPS * blocks)


def test_block_that_sticks__grips_without_bound():
    assert math.isinf(band_and_block_grip(1.0, math.pi / 2 + 1e-9, 3.0))
