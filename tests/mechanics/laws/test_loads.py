"""Loads on a point or link: their signs, and the energy they take from the machine or store."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from engine.laws.loads import (
    acts_in_direction,
    constant_against_motion,
    spring,
)

EPS = np.finfo(float).eps
# Wide, but with products that stay inside float64's range.
speeds = st.floats(-1e5, 1e5, allow_subnormal=False).filter(lambda v: v == 0.0 or abs(v) > 1e-30)
sizes = st.floats(1e-12, 1e12)


@settings(deadline=None, max_examples=100)
@given(sizes, speeds)
def test_constant_resistance__is_its_magnitude_against_the_motion(c, v):
    assert constant_against_motion(c, v) == -c * np.sign(v)


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
        spring(1.0, 1.0, math.nan),
        acts_in_direction(1.0, math.nan),
    ]
    assert np.isnan(loads).all()
