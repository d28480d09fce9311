"""Replacement masses: what they conserve, against closed forms and a linear solver.

Where nothing else is said, tolerances are some roundings (EPS) of the sum of the magnitudes of all terms.
"""

import math

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from oracle import EPS

from engine.laws.masses.replacement_masses import (
    coincident,
    dynamic_in_line,
    dynamic_two,
    static_two,
)

MASSES = st.floats(1e-12, 1e9)
SCALES = st.floats(1e-6, 1e6)
SHARES = st.floats(0.05, 20.0)
GYRATIONS = st.just(0.0) | st.floats(1e-3, 20.0)
TURNS = st.floats(-math.pi, math.pi)


def polar(radius, angle):
    return radius * math.cos(angle), radius * math.sin(angle)


def check_conserved(found, mass, inertia):
    """Whole mass, both first moments and the moment of inertia, each to roundings of its terms."""
    assert found.possible
    total = sum(abs(m) for m in found.masses)
    # A first moment of points far off the axis is the difference of products as large as their distance.
    sway = total * max(math.hypot(*p) for p in found.points)
    squares = [p[0] ** 2 + p[1] ** 2 for p in found.points]
    about = sum(abs(m) * s for m, s in zip(found.masses, squares, strict=True))
    equations = [([1.0 for _ in found.points], mass, total), (squares, inertia, about)]
    equations += [([p[axis] for p in found.points], 0.0, sway) for axis in (0, 1)]
    for factors, expected, size in equations:
        missed = sum(m * f for m, f in zip(found.masses, factors, strict=True)) - expected
        assert abs(missed) <= 32.0 * EPS * (size + abs(expected))


@settings(deadline=None, max_examples=200)
@given(MASSES, SCALES, TURNS, SHARES, GYRATIONS)
def test_dynamic_two__keeps_the_moment_of_inertia_at_the_conjugate_point(mass, scale, angle, arm, gyration):
    inertia = mass * (scale * gyration) ** 2
    found = dynamic_two(mass, inertia, polar(scale * arm, angle))
    check_conserved(found, mass, inertia)
    length = math.hypot(*(p - q for p, q in zip(*found.points, strict=True)))
    # The length of the simple pendulum that swings with the body, hung in the first point.
    assert math.isclose(length, (inertia + mass * (scale * arm) ** 2) / (mass * scale * arm), rel_tol=16 * EPS)
    assert all(m >= 0.0 for m in found.masses)


@settings(deadline=None, max_examples=200)
@given(MASSES, SCALES, TURNS, SHARES, SHARES, GYRATIONS)
def test_dynamic_in_line__is_the_rod_of_textbooks(mass, scale, angle, a, b, gyration):
    inertia = mass * (scale * gyration) ** 2
    a, b = scale * a, scale * b
    points = polar(a, angle), (0.0, 0.0), polar(-b, angle)
    found = dynamic_in_line(mass, inertia, *points)
    check_conserved(found, mass, inertia)
    expected = inertia / (a * (a + b)), mass - inertia / (a * b), inertia / (b * (a + b))
    for got, m in zip(found.masses, expected, strict=True):
        assert abs(got - m) <= 16 * EPS * (mass + inertia / (a * b))


def test_variants__fail_each_for_itself():
    found = static_two(1.0, (np.array([0.1, 0.1, 0.3]), np.array([0.0, 0.05, 0.0])), (-0.1, 0.0))
    assert found.possible.tolist() == [True, False, True]
    np.testing.assert_allclose(found.masses[0], [0.5, np.nan, 0.25], rtol=4 * EPS)


def test_coincident__names_the_first_pair():
    assert coincident(((0.0, 0.0), (1.0, 0.0), (1.0, 1e-12))) == (1, 2)
    assert coincident(((0.0, 0.0), (1.0, 0.0), (1.0, 1e-6))) is None
