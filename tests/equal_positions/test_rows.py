"""Sums and extremes of rows at their positions, against NumPy."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from engine.equal_positions.rows import (
    combined_max,
    combined_min,
    derivative_residual,
    greatest,
    halve,
    least,
    place_of,
)

EPS = 2.3e-16

few = settings(deadline=None, max_examples=80)
lengths = st.integers(2, 100)
values = st.floats(-1e6, 1e6, allow_subnormal=False)
rows = lengths.flatmap(lambda n: arrays(np.float64, n, elements=values))
pairs = lengths.flatmap(lambda n: st.tuples(*[arrays(np.float64, n, elements=values)] * 2))


def angles(n):
    return np.arange(n) * (2 * math.pi / n)


def wave(seed, phi, harmonics=4):
    """A random sum of harmonics and its derivative, the same curve for every phi."""
    rng = np.random.default_rng(seed)
    orders = np.arange(1, harmonics + 1)
    amplitudes = rng.uniform(-1, 1, harmonics) / orders
    phases = np.outer(phi, orders) + rng.uniform(0, 2 * math.pi, harmonics)
    return np.cos(phases) @ amplitudes, -np.sin(phases) @ (amplitudes * orders)


# Extremes


@few
@given(pairs, st.floats(-100, 100))
def test_combined_extremes__are_those_of_numpy(pair, slope):
    a, b = pair
    # A fused multiply-add rounds once where NumPy rounds twice.
    rounding = 2 * EPS * (np.abs(a) + np.abs(slope * b)).max()
    assert combined_max(a, b, slope) == pytest.approx((a - slope * b).max(), abs=rounding)
    assert combined_min(a, b, slope) == pytest.approx((a - slope * b).min(), abs=rounding)


@few
@given(rows)
def test_extremes__are_values_of_the_row_at_their_places(row):
    assert greatest(row) == row.max()
    assert least(row) == row.min()
    assert place_of(row, greatest(row)) == row.argmax()
    assert place_of(row, least(row)) == row.argmin()


def test_place_of__is_nan_for_a_value_that_does_not_occur():
    assert math.isnan(place_of(np.arange(4.0), 2.5))
    assert math.isnan(place_of(np.arange(4.0), math.nan))


# Half the positions


@pytest.mark.parametrize("n", [8, 9, 720, 721])
def test_halve__takes_every_second_position(n):
    row = np.arange(float(n))
    half = np.empty((n + 1) // 2)
    halve(row, half)
    np.testing.assert_array_equal(half, row[::2])


# The derivative against the row


@few
@given(st.integers(1, 12), st.integers(60, 400), st.floats(0, 2 * math.pi), st.floats(-3, 3).map(lambda e: 10.0**e))
def test_derivative_residual__is_that_of_a_sixth_order_difference(order, n, phase, size):
    phi, h = angles(n), 2 * math.pi / n
    row, derivative = size * np.sin(order * phi + phase), size * order * np.cos(order * phi + phase)
    x = order * h
    # sin(kφ) is an eigenvector of central differences: 45·2 sin x − 9·2 sin 2x + 2 sin 3x over 60h.
    seen = (90 * math.sin(x) - 18 * math.sin(2 * x) + 2 * math.sin(3 * x)) / (60 * h)
    # The sines know their argument, up to 2πk, to 1e-16 of it; their differences are divided by x.
    rounding = 4 * EPS * (1 + order * 2 * math.pi) / x
    assert derivative_residual(row, derivative, h) == pytest.approx(abs(seen / order - 1), abs=rounding)
    assert abs(seen / order - 1) == pytest.approx(x**6 / 140, rel=0.5 * x**2 + 1e-6, abs=rounding)


def test_derivative_residual__falls_with_the_sixth_power_of_the_step():
    residuals = []
    for n in (64, 128):
        row, derivative = wave(5, angles(n), 6)
        residuals.append(derivative_residual(row, derivative, 2 * math.pi / n))
    assert residuals[0] / residuals[1] == pytest.approx(64, rel=0.1)


def test_derivative_residual__sees_a_wrong_derivative():
    row, derivative = wave(6, angles(720))
    h = 2 * math.pi / 720
    assert derivative_residual(row, derivative, h) < 1e-9
    assert derivative_residual(row, 1.01 * derivative, h) == pytest.approx(0.01 / 1.01, rel=1e-6)
    shifted = derivative.copy()
    shifted[100] += 0.5 * np.abs(derivative).max()
    assert derivative_residual(row, shifted, h) >= 0.3


@pytest.mark.parametrize("which", [0, 1])
def test_derivative_residual__is_nan_where_a_value_is_undefined(which):
    pair = wave(7, angles(16))
    pair[which][5] = math.nan
    assert math.isnan(derivative_residual(*pair, 0.1))


def test_derivative_residual__is_zero_at_rest_and_absolute_without_a_derivative():
    flat = np.full(16, 3.0)
    assert derivative_residual(flat, np.zeros(16), 0.1) == 0.0
    assert derivative_residual(np.sin(angles(16)), np.zeros(16), angles(16)[1]) == pytest.approx(1, rel=1e-2)
