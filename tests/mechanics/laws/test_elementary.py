"""Elementary functions against mpmath over all of their range, and that loops over them are packed instructions."""

import math

import mpmath as mp
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from packed import assert_packed

from engine.compiling.compilers import Apart
from engine.compiling.decorators import RULES
from engine.laws import elementary


def compiled(law):
    """A law as compiled code computes it: its sums and products are rounded once."""
    return njit(lambda *numbers: law(*numbers))


angle_of, direction_of, exponential, logarithm, power = map(
    compiled,
    (elementary.angle_of, elementary.direction_of, elementary.exponential, elementary.logarithm, elementary.power),
)
LEAST, GREATEST = 2.0**-1021, float(np.finfo(float).max)
many = settings(max_examples=80)
# Numbers of every size, and numbers about 1, whose logarithms are small.
positive = st.one_of(
    st.floats(-1022.0, 1023.9).map(lambda e: 2.0**e),
    st.floats(0.5, 2.0),
    st.tuples(st.sampled_from([-1.0, 1.0]), st.floats(-52.0, -1.0)).map(lambda p: 1.0 + p[0] * 2.0 ** p[1]),
)
sizes = st.tuples(st.sampled_from([-1.0, 1.0]), st.floats(-1000.0, 1000.0)).map(lambda p: p[0] * 2.0 ** p[1])


def ulps(found: float, true: mp.mpf) -> float:
    """Error in units in the last place of the true value."""
    return float(abs(mp.mpf(found) - true)) / math.ulp(float(true))


@pytest.fixture(autouse=True)
def _forty_digits():
    with mp.workdps(40):
        yield


# Bounds are those of the docstrings. Of the exponential: the last sum ½ ulp, the sum before it and the reduced argument
# ¼ each in the worst place, where the result is just above a power of two.


@many
@given(st.one_of(st.floats(-707.7, 709.7), st.floats(-1.0, 1.0), st.floats(-1e-6, 1e-6)))
def test_exponential__mpmath(x):
    assert ulps(exponential(x), mp.exp(x)) <= 1.0


@many
@given(positive)
def test_logarithm__mpmath(x):
    assert ulps(logarithm(x), mp.log(x)) <= 0.51


@many
@given(positive, st.one_of(st.floats(-1.0, 1.0), st.floats(-1000.0, 1000.0)))
def test_power__mpmath(x, share):
    # Exponents over all that gives a result in range, and, with x about 1, very large ones.
    n = share if abs(share) > 1.0 else share * 707.0 / max(abs(math.log(x)), 1e-9)
    if abs(n * math.log(x)) < 707.0:
        assert ulps(power(x, n), mp.mpf(x) ** mp.mpf(n)) <= 1.5


@many
@given(
    st.one_of(
        st.tuples(sizes, sizes),
        st.builds(
            lambda angle, exponent: (10.0**exponent * math.cos(angle), 10.0**exponent * math.sin(angle)),
            st.floats(-math.pi, math.pi),
            st.floats(-300.0, 300.0),
        ),
    )
)
def test_angle_of_any_direction__mpmath(vector):
    x, y = vector
    true = mp.atan2(y, x)
    # An angle below the least normal number keeps its digits as far as there are any.
    if abs(true) >= LEAST:
        assert ulps(angle_of(x, y), true) <= 2.0


def missed(angle: float) -> float:
    """How far the cosine and the sine are from the true ones, whichever is farther."""
    true = mp.cos(angle), mp.sin(angle)
    return max(float(abs(mp.mpf(found) - t)) for found, t in zip(direction_of(angle), true, strict=True))


# Two roundings of numbers of at most 1, and of one below 1/√2 before. π/2 as rounded is off by 3.9e-17 of itself.
@many
@given(st.one_of(st.floats(-20.0, 20.0), st.floats(-1e14, 1e14)))
def test_direction__mpmath(angle):
    assert missed(angle) <= 2e-16 + 4e-17 * abs(angle)


@pytest.mark.parametrize("turns", [-7, -1, 1, 2, 40])
def test_direction_after_whole_turns__is_that_of_the_beginning(turns):
    assert direction_of(turns * 2.0 * math.pi) == (1.0, 0.0)


def test_direction__is_right_around_every_eighth_of_a_turn():
    eighths = [k * math.pi / 4 + d for k in range(-33, 34) for d in (-1e-9, -1e-16, 0.0, 1e-16, 1e-9)]
    assert max(missed(angle) for angle in eighths) <= 2e-16 + 4e-17 * 33 * math.pi / 4


# Ends of the ranges, and what is no number


@pytest.mark.parametrize(
    ("expected", "numbers"), [(1.0, (0.0, -0.0)), (math.inf, (709.79, math.inf, 1e300)), (0.0, (-707.8, -math.inf))]
)
def test_exponential__ends(expected, numbers):
    assert [exponential(x) for x in numbers] == [expected] * len(numbers)


def test_exponential__reaches_the_greatest_number():
    assert ulps(exponential(709.782712893384), mp.exp(709.782712893384)) <= 1.0


@pytest.mark.parametrize(
    ("x", "expected"), [(0.0, -math.inf), (-0.0, -math.inf), (5e-324, -math.inf), (1.0, 0.0), (math.inf, math.inf)]
)
def test_logarithm__ends(x, expected):
    assert logarithm(x) == expected


@pytest.mark.parametrize(
    ("expected", "cases"),
    [
        (0.0, [(0.0, 1.3), (5e-324, 2.0), (math.inf, -1e-3), (2.0, -1e308), (0.5, 1e5)]),
        (1.0, [(0.0, 0.0), (math.inf, 0.0), (1.0, 1e308), (7.3, 0.0)]),
        (math.inf, [(0.0, -1.3), (math.inf, 1e-3), (2.0, 1e308), (2.0, 1024.0)]),
    ],
)
def test_power__ends(expected, cases):
    assert [power(x, n) for x, n in cases] == [expected] * len(cases)


AXES = [(1.0, 0.0), (-1.0, 0.0), (0.0, 1.0), (0.0, -1.0), (1.0, 1.0), (-1.0, 0.5)]
FAR = [(math.inf, 1.0), (-math.inf, -1.0), (1.0, math.inf), (GREATEST, GREATEST), (-GREATEST, 0.8 * GREATEST)]
NEAR = [(5e-324, 5e-324), (-1e-310, -3e-311)]


@pytest.mark.parametrize(("x", "y"), AXES + FAR + NEAR)
def test_angle__is_that_of_the_c_library_at_ends(x, y):
    assert angle_of(x, y) == pytest.approx(math.atan2(y, x), rel=4e-16)


def test_what_is_no_number__gives_none():
    nan = math.nan
    found = [exponential(nan), logarithm(nan), logarithm(-1.0), logarithm(-math.inf)]
    found += [power(nan, 1.3), power(nan, 0.0), power(2.0, nan), power(-2.0, 2.0), power(-2.0, 0.0)]
    found += [angle_of(nan, 1.0), angle_of(1.0, nan), angle_of(0.0, 0.0), angle_of(math.inf, math.inf)]
    found += [*direction_of(nan), *direction_of(math.inf)]
    assert all(math.isnan(x) for x in found)


def test_nan_with_any_bits__stays_nan():
    payloads = np.array([0x7FF8000000000001, 0x7FF0000000000FFF, -1], np.int64).view(np.float64)
    for nan in payloads:
        found = exponential(nan), logarithm(nan), power(nan, 1.3), power(2.0, nan), angle_of(nan, nan)
        assert all(math.isnan(x) for x in found)


# Vectorised


def test_a_loop_over_each__is_compiled_to_packed_instructions():
    @njit(error_model="numpy", fastmath=set(RULES), pipeline_class=Apart)
    def loops(x, y, out):
        for i in range(x.size):
            out[0, i] = elementary.exponential(x[i])
        for i in range(x.size):
            out[1, i], out[2, i] = elementary.direction_of(x[i])
        for i in range(x.size):
            out[3, i] = elementary.logarithm(x[i])
        for i in range(x.size):
            out[4, i] = elementary.power(x[i], y[i])
        for i in range(x.size):
            out[5, i] = elementary.angle_of(x[i], y[i])

    x, y = np.random.default_rng(1).uniform(0.1, 1.0, (2, 37))
    out = np.empty((6, 37))
    loops(x, y, out)
    # A lane has what the function gives by itself, in the loop's body and in what is left over of it.
    for i, (a, b) in enumerate(zip(x, y, strict=True)):
        alone = [exponential(a), *direction_of(a), logarithm(a), power(a, b), angle_of(a, b)]
        np.testing.assert_array_equal(out[:, i], alone)
    # The last three divide.
    assert_packed(loops, 3)
