"""Sums and extremes of rows against NumPy, and what their error figures promise."""

import math

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from engine.rows import (
    combined_max,
    combined_min,
    derivative_residual,
    greatest,
    halve,
    least,
    least_magnitude,
    mean_of,
    place_of,
    roughness,
    statistics,
)

EPS = 2.3e-16

few = settings(deadline=None, max_examples=80)
lengths = st.integers(2, 100)
values = st.floats(-1e6, 1e6, allow_subnormal=False)
rows = lengths.flatmap(lambda n: arrays(np.float64, n, elements=values))
pairs = lengths.flatmap(lambda n: st.tuples(*[arrays(np.float64, n, elements=values)] * 2))
bad = st.sampled_from([math.nan, math.inf, -math.inf])


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


@few
@given(rows)
def test_least_magnitude__is_zero_where_the_sign_changes(row):
    positive = np.abs(row) + 1e-3
    assert least_magnitude(positive) == positive.min()
    assert least_magnitude(-positive) == positive.min()
    expected = 0.0 if row.min() <= 0 <= row.max() else np.abs(row).min()
    assert least_magnitude(row) == expected


# Statistics


@few
@given(rows)
def test_statistics_of_a_cycle__are_those_of_numpy(row):
    low, high, mean, rms, _, _ = statistics(row, True)
    rounding = row.size * EPS
    assert (low, high) == (row.min(), row.max())
    assert mean == pytest.approx(row.mean(), abs=rounding * np.abs(row).max())
    assert mean_of(row) == pytest.approx(row.mean(), abs=rounding * np.abs(row).max())
    assert rms == pytest.approx(math.sqrt((row**2).mean()), rel=rounding, abs=1e-300)


@few
@given(rows)
def test_statistics_of_a_range__are_those_of_the_trapezoid_rule(row):
    low, high, mean, rms, _, _ = statistics(row, False)
    n = row.size - 1
    rounding = row.size * EPS
    assert (low, high) == (row.min(), row.max())
    assert mean == pytest.approx(np.trapezoid(row) / n, abs=2 * rounding * np.abs(row).max())
    # The ends are added whole and then halved: a square root of what may be left of nothing.
    assert rms == pytest.approx(math.sqrt(np.trapezoid(row**2) / n), abs=math.sqrt(rounding) * np.abs(row).max())


@few
@given(rows, st.data(), bad, st.booleans())
def test_undefined_position__leaves_no_statistics(row, data, value, periodic):
    row[data.draw(st.integers(0, row.size - 1))] = value
    assert np.isnan(statistics(row, periodic)).all()
    assert np.isnan(statistics(row.astype(np.float32), periodic)).all()
    assert not math.isfinite(mean_of(row))


@few
@given(rows, st.data())
def test_nan_anywhere__leaves_no_least_magnitude(row, data):
    row[data.draw(st.integers(0, row.size - 1))] = math.nan
    assert math.isnan(least_magnitude(row))


def test_mean_over_a_cycle__is_spectrally_exact():
    # The trapezoid rule over a period integrates every harmonic below n exactly; ∫exp(cos φ) dφ/2π = I0(1).
    assert statistics(np.exp(np.cos(angles(24))), True)[2] == pytest.approx(1.2660658777520084, rel=4 * EPS)


# How far extremes are missed


@few
@given(st.floats(-5, 5), st.floats(0.1, 10), st.floats(-0.5, 0.5))
def test_missed__is_half_the_curvature_of_a_parabola(top, curvature, shift):
    k = np.arange(21.0)
    row = top - curvature * (k - 10 - shift) ** 2
    missed = statistics(row, False)[4]
    # Its other extreme is at an open end, where only the neighbour inside has a second difference, the same one.
    assert missed == pytest.approx(0.5 * 2 * curvature, abs=1e-13 * (abs(top) + 400 * curvature))
    assert missed >= (top - row.max()) * (1 - 1e-12)


@few
@given(st.floats(-5, 5), st.floats(0.1, 10), st.floats(0, 1))
def test_missed__bounds_a_kink_between_two_positions(top, slope, place):
    k = np.arange(21.0)
    row = top - slope * abs(k - 10 - place)
    # Hidden is slope · min(p, 1 − p); the second differences beside it are 2 slope · p and 2 slope · (1 − p).
    assert statistics(row, False)[4] >= (top - row.max()) * (1 - 1e-9) - 1e-14


@few
@given(st.floats(0.1, 10), st.integers(10, 60), st.integers(100, 160))
def test_roughness__adds_jumps_as_squares_and_passes_over_what_is_smooth(jump, first, second):
    phi = angles(256)
    smooth = np.cos(phi) + 0.3 * np.sin(3 * phi)
    # A harmonic m leaves sixth differences of (2 sin(m h/2))⁶, here 0.3 (3h)⁶ = 5e-8; jumps far apart don't interfere.
    stepped = smooth + np.where((np.arange(256) >= first) & (np.arange(256) < second), jump, 0.0)
    assert roughness(smooth, True) < 256**0.5 * 5e-8
    assert roughness(stepped, True) == pytest.approx(2**0.5 * jump, rel=1e-4)


@pytest.mark.parametrize("n", [48, 96, 360])
def test_missed__bounds_what_lies_between_the_positions(n):
    within = 0
    for seed in range(200):
        fine, _ = wave(seed, angles(360 * 48))
        row, _ = wave(seed, angles(n))
        low, high, _, _, missed, _ = statistics(row, True)
        beyond = max(fine.max() - high, low - fine.min())
        half = statistics(np.ascontiguousarray(row[::2]), True)
        change = max(high - half[1], half[0] - low)
        # The figure of an extreme: its change from half the positions, or half of the bend about it.
        within += -1e-12 <= beyond <= max(change, missed) + 1e-12
    # Of two peaks of nearly equal height the higher one may lie between positions: measured, 1 of 1000 at n = 48.
    assert within >= 199


@few
@given(st.floats(-4, 4), st.floats(5, 50), st.floats(0, 1), st.sampled_from([1, -1]))
def test_missed__beside_a_jump_is_a_step_of_the_branch_not_the_jump(slope, jump, place, side):
    # A straight branch up to a jump between two positions, as a force that sets in or ends: its end is the extreme.
    k = np.arange(41.0)[::side]
    row = np.ascontiguousarray(np.where(k < 20 + place, slope * (k - 20), slope * (k - 20) - jump))
    top = max(slope * place, slope * -20.0)
    # Of two tops nearly as high the figure knows the one that shows at the positions.
    assume(not 0.0 < 20 * slope - jump < slope * place)
    missed = statistics(row, False)[4]
    assert missed >= (top - row.max()) - 1e-12
    assert missed <= abs(slope) * (1 + 1e-12) + 1e-12


def test_missed__is_nothing_in_a_straight_row():
    assert statistics(np.linspace(0, 1, 9), False)[4] < 1e-15
    assert statistics(np.linspace(0, 1, 9), True)[4] > 0.0
    assert statistics(np.ones(9), True)[4] == 0.0


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
