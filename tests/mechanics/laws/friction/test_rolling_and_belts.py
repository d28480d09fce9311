"""Rolling and belts against equilibrium solved as it stands and the differential equation of a belt."""

import math

import mpmath
import numpy as np
from friction_ranges import frictions, quick, sizes
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose

from engine.laws.brakes import band_brake
from engine.laws.friction.belts import (
    belt_moment,
    centrifugal_tension,
    gripped_share,
    slack_share,
    speed_of_most_power,
    tension_ratio,
)
from engine.laws.friction.rolling import (
    pull,
    reduced_friction,
    reduced_radius,
    rollers_moment,
    rolling_moment,
    rolls,
)

EPS = np.finfo(float).eps

# Rolling


@quick
@given(sizes, st.floats(1e-6, 1e-2), st.floats(0.01, 1.0), frictions)
def test_roller__does_whichever_needs_less(normal, arm, height, friction):
    force = pull(normal, arm, height, friction)
    if rolls(arm, height, friction):
        assert_allclose(force * height, rolling_moment(normal, arm), rtol=4 * EPS)
        assert force <= friction * normal * (1 + 4 * EPS)
    else:
        assert_allclose(force, friction * normal, rtol=2 * EPS)
        assert force * height <= rolling_moment(normal, arm) * (1 + 4 * EPS)
    assert_allclose(reduced_friction(arm, height) * height, arm, rtol=2 * EPS)


@quick
@given(sizes, sizes, sizes, st.sampled_from([1.0, -1.0]))
def test_two_rollers__lose_with_the_difference_of_their_speeds(normal, radius, mate, way):
    if way < 0:
        mate = -(mate + radius)
    moment = rollers_moment(normal, 1e-4, radius, mate)
    # No slip at the contact: outside each other they turn in opposite directions, within each other in the same.
    other = -radius / mate
    assert_allclose(moment, normal * 1e-4 * abs(1.0 - other), rtol=4 * EPS)
    assert_allclose(moment, abs(normal * 1e-4 * radius / reduced_radius(radius, mate)), rtol=8 * EPS)


# Belts


@quick
@given(frictions, st.floats(0.01, 20.0))
def test_euler__is_the_equilibrium_of_every_element(friction, wrap):
    # dT = f T dalpha at every place: the logarithm of the tension grows evenly.
    assert_allclose(math.log(tension_ratio(friction, wrap)), friction * wrap, rtol=2 * EPS, atol=2 * EPS)
    with mpmath.workdps(50):
        exact = mpmath.exp(-mpf(friction) * mpf(wrap))
        grip = float(1 - exact)
    # The product's rounding in the exponent, at most 24.
    assert_allclose(slack_share(friction, wrap), float(exact), rtol=26 * EPS)
    assert_allclose(gripped_share(friction, wrap), grip, rtol=4 * EPS)


def test_belt_with_little_friction__grips_with_the_arc_it_rubs_on():
    # (T1 - T2)/T1 -> f alpha; the next term is half of its square.
    assert_allclose(gripped_share(1e-12, 3.0), 3e-12, rtol=2e-12)
    assert gripped_share(0.0, 3.0) == 0.0


def test_belt__is_a_band_pulled_at_its_tight_end():
    for friction, wrap in ((0.3, 2.0), (0.05, 12.0)):
        band = band_brake(700.0, 1.0, 0.0, 1.0, friction, wrap, 0.2)
        assert_allclose(belt_moment(700.0, 0.0, friction, wrap, 0.2), band, rtol=4 * EPS)


def test_speed_of_most_power__is_the_maximum():
    tight, density = 2000.0, 0.9

    def power(speed):
        return belt_moment(tight, centrifugal_tension(density, speed), 0.3, 3.0, 1.0) * speed

    best = speed_of_most_power(tight, density)
    assert_allclose(centrifugal_tension(density, best), tight / 3, rtol=4 * EPS)
    # Derivative of v (T - q v²) is 0; by differences of 1e-4 its third derivative leaves about 1e-8.
    assert abs(power(best * 1.0001) - power(best / 1.0001)) < 1e-7 * power(best)
    assert power(best) > power(best * 1.01)
    assert power(best) > power(best / 1.01)
    assert belt_moment(tight, centrifugal_tension(density, 3 * best), 0.3, 3.0, 1.0) == 0.0
