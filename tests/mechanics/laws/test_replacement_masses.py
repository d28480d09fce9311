"""Replacement masses: what they conserve, against closed forms and a linear solver.

Where nothing else is said, tolerances are some roundings (EPS) of the sum of the magnitudes of all terms.
"""

import math

import numpy as np
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from oracle import EPS

from engine.laws.masses.replacement_masses import (
    coincident,
    dynamic_four,
    dynamic_in_line,
    dynamic_three,
    dynamic_two,
    static_three,
    static_two,
)

MASSES = st.floats(1e-12, 1e9)
SCALES = st.floats(1e-6, 1e6)
SHARES = st.floats(0.05, 20.0)
GYRATIONS = st.just(0.0) | st.floats(1e-3, 20.0)
TURNS = st.floats(-math.pi, math.pi)


def polar(radius, angle):
    return radius * math.cos(angle), radius * math.sin(angle)


def check_conserved(found, mass, inertia=None, roundings=32.0):
    """Whole mass, both first moments and, where given, the moment of inertia, each to roundings of its terms."""
    assert found.possible
    total = sum(abs(m) for m in found.masses)
    # A first moment of points far off the axis is the difference of products as large as their distance.
    sway = total * max(math.hypot(*p) for p in found.points)
    equations = [([1.0 for _ in found.points], mass, total)]
    equations += [([p[axis] for p in found.points], 0.0, sway) for axis in (0, 1)]
    if inertia is not None:
        squares = [p[0] ** 2 + p[1] ** 2 for p in found.points]
        about = sum(abs(m) * s for m, s in zip(found.masses, squares, strict=True))
        equations.append((squares, inertia, about))
    for factors, expected, size in equations:
        missed = sum(m * f for m, f in zip(found.masses, factors, strict=True)) - expected
        assert abs(missed) <= roundings * EPS * (size + abs(expected))


@settings(deadline=None, max_examples=200)
@given(MASSES, SCALES, TURNS, SHARES, st.floats(-20.0, -0.05) | SHARES)
def test_static_two__keeps_mass_and_centre(mass, scale, angle, first, second):
    assume(abs(first - second) > 0.01)
    found = static_two(mass, polar(scale * first, angle), polar(scale * second, angle))
    # m₁ = m·r₂/(r₂ − r₁) loses digits as the points come together.
    check_conserved(found, mass, roundings=32.0 * (abs(first) + abs(second)) / abs(first - second))
    assert math.isclose(found.masses[0], mass * second / (second - first), rel_tol=1e-11)


@settings(deadline=None, max_examples=200)
@given(MASSES, SCALES, st.tuples(*[TURNS] * 3), st.tuples(*[SHARES] * 3))
def test_static_three__keeps_mass_and_centre(mass, scale, angles, radii):
    points = [polar(scale * r, a) for r, a in zip(radii, angles, strict=True)]
    (ax, ay), (bx, by), (cx, cy) = points
    twice = abs((bx - ax) * (cy - ay) - (by - ay) * (cx - ax))
    assume(twice > 1e-3 * (scale * max(radii)) ** 2)
    found = static_three(mass, *points)
    # A mass is the ratio of two triangles; the smaller the whole one, the more its rounding counts.
    check_conserved(found, mass, roundings=16.0 * (scale * max(radii)) ** 2 / twice)


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
@given(MASSES, SCALES, st.tuples(TURNS, TURNS), st.tuples(SHARES, SHARES), st.floats(0.05, 5.0), st.floats(-2.0, 2.0))
def test_dynamic_three__keeps_all_four_with_a_chosen_mass(mass, scale, angles, radii, gyration, share):
    assume(abs(share - 1.0) > 0.05)
    inertia = mass * (scale * gyration) ** 2
    first, second = (polar(scale * r, a) for r, a in zip(radii, angles, strict=True))
    centre = [-share * x / (1 - share) for x in first]
    arm = math.dist(second, centre) / scale
    rest = gyration**2 - share * radii[0] ** 2 - share**2 * radii[0] ** 2 / (1 - share)
    # Far from the figures that have no answer: the second point in the rest's centre, the rest's J about it zero.
    reach = max(*radii, math.hypot(*centre) / scale)
    assume(arm > 0.05 * reach)
    assume(abs((1 - share) * arm**2 + rest) > 0.05 * (arm**2 + abs(rest)))
    found = dynamic_three(mass, inertia, first, share * mass, second)
    assert found.masses[0] == share * mass
    assert found.points[:2] == (first, second)
    # Each of the three margins multiplies what rounding does: 20 for the arm, twice 20 for the two differences.
    check_conserved(found, mass, inertia, roundings=32.0 * 20**3)


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


@settings(deadline=None, max_examples=200)
@given(MASSES, SCALES, TURNS, st.tuples(*[st.floats(0.2, 5.0)] * 4), st.tuples(*[st.floats(-0.3, 0.3)] * 4), SHARES)
def test_dynamic_four__keeps_all_four(mass, scale, turn, radii, jitter, gyration):
    angles = [turn + k * math.pi / 2 + d for k, d in enumerate(jitter)]
    points = [polar(scale * r, a) for r, a in zip(radii, angles, strict=True)]
    inertia = mass * (scale * gyration) ** 2
    matrix = np.array([[1.0, x / scale, y / scale, (x * x + y * y) / scale**2] for x, y in points]).T
    condition = np.linalg.cond(matrix)
    assume(condition < 1e4)
    check_conserved(dynamic_four(mass, inertia, *points), mass, inertia, roundings=16.0 * condition)


def test_variants__fail_each_for_itself():
    found = static_two(1.0, (np.array([0.1, 0.1, 0.3]), np.array([0.0, 0.05, 0.0])), (-0.1, 0.0))
    assert found.possible.tolist() == [True, False, True]
    np.testing.assert_allclose(found.masses[0], [0.5, np.nan, 0.25], rtol=4 * EPS)


def test_coincident__names_the_first_pair():
    assert coincident(((0.0, 0.0), (1.0, 0.0), (1.0, 1e-12))) == (1, 2)
    assert coincident(((0.0, 0.0), (1.0, 0.0), (1.0, 1e-6))) is None
