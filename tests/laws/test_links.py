"""Directions of angles against mpmath."""

import math

import mpmath as mp
import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.laws.kinematics.links import direction_of


def missed(angle: float) -> float:
    """How far the cosine and the sine are from the true ones, whichever is farther."""
    with mp.workdps(40):
        exact = mp.cos(mp.mpf(angle)), mp.sin(mp.mpf(angle))
        return max(
            abs(float(mp.mpf(float(made)) - true)) for made, true in zip(direction_of(angle), exact, strict=True)
        )


# Polynomials and their sums round to about an ulp of 1 (2.2e-16); π/2 in float64 is off by 6e-17, as often as the
# angle holds right angles, which is less than an ulp of the angle itself.
@settings(deadline=None, max_examples=400)
@given(st.floats(-1e6, 1e6))
def test_direction__is_that_of_the_c_library_to_rounding(angle):
    assert missed(angle) <= 4.5e-16 + np.spacing(abs(angle))


def test_direction__is_right_around_every_eighth_of_a_turn():
    eighths = [k * math.pi / 4 + d for k in range(-33, 34) for d in (-1e-9, -1e-16, 0.0, 1e-16, 1e-9)]
    assert max(missed(angle) for angle in eighths) <= 4.5e-16 + 8.0 * math.pi * 2.0**-53


def test_direction__has_length_one():
    angles = np.random.default_rng(0).uniform(-20.0, 20.0, 2000)
    lengths = [math.hypot(*direction_of(a)) for a in angles]
    assert max(abs(length - 1.0) for length in lengths) <= 4.5e-16


def test_direction__of_no_number__is_none():
    assert all(math.isnan(x) for x in direction_of(math.nan))
