"""Extremes of a row between its positions, its means, and what either may be off by, against closed forms."""

import itertools
import math

import mpmath
import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.optimize import minimize_scalar

from engine.equal_positions.extremes import (
    doubt_of_extreme,
    doubt_of_mean,
    extreme_and_place,
    extreme_of,
    least_magnitude,
    means,
    place_of_extreme,
    smooth_top,
)
from engine.equal_positions.rows import mean_of, roughness

EPS = 2.3e-16
TURN = 2 * math.pi

few = settings(deadline=None, max_examples=80)
lengths = st.integers(2, 100)
rows = lengths.flatmap(lambda n: arrays(np.float64, n, elements=st.floats(-1e6, 1e6, allow_subnormal=False)))
bad = st.sampled_from([math.nan, math.inf, -math.inf])


def angles(n):
    return np.arange(n) * (TURN / n)


def wave(seed, harmonics=4):
    """A random sum of harmonics."""
    rng = np.random.default_rng(seed)
    orders = np.arange(1, harmonics + 1)
    amplitudes = rng.uniform(-1, 1, harmonics) / orders
    phases = rng.uniform(0, TURN, harmonics)
    return lambda phi: np.cos(np.multiply.outer(phi, orders) + phases) @ amplitudes


def top_of(curve):
    """Greatest value of a curve over a turn, and where."""
    fine = angles(4000)
    k = int(curve(fine).argmax())
    found = minimize_scalar(
        lambda x: -curve(x), bracket=(fine[k] - TURN / 4000, fine[k], fine[k] + TURN / 4000), tol=1e-15
    )
    return -found.fun, found.x % TURN


# Means


@few
@given(rows)
def test_means_of_a_cycle__are_those_of_numpy(row):
    mean, rms = means(row, 1, True)
    rounding = row.size * EPS
    assert mean == pytest.approx(row.mean(), abs=rounding * np.abs(row).max())
    assert mean_of(row) == pytest.approx(row.mean(), abs=rounding * np.abs(row).max())
    assert rms == pytest.approx(math.sqrt((row**2).mean()), rel=rounding, abs=1e-300)


@few
@given(rows)
def test_means_of_a_range__are_those_of_the_trapezoid_rule(row):
    mean, rms = means(row, 1, False)
    n = row.size - 1
    rounding = row.size * EPS
    assert mean == pytest.approx(np.trapezoid(row) / n, abs=2 * rounding * np.abs(row).max())
    # The ends are added whole and then halved: a square root of what may be left of nothing.
    assert rms == pytest.approx(math.sqrt(np.trapezoid(row**2) / n), abs=math.sqrt(rounding) * np.abs(row).max())


@pytest.mark.parametrize("periodic", [True, False])
def test_means_of_every_second_position__are_those_of_a_row_of_them(periodic):
    row = np.cos(3 * np.linspace(0, 5, 97))
    np.testing.assert_allclose(means(row, 2, periodic), means(row[::2].copy(), 1, periodic), rtol=50 * EPS)


@few
@given(rows, st.data(), bad, st.booleans())
def test_undefined_position__leaves_no_statistics(row, data, value, periodic):
    row[data.draw(st.integers(0, row.size - 1))] = value
    for values in (row, row.astype(np.float32)):
        assert np.isnan(means(values, 1, periodic)).all()
        assert np.isnan(extreme_of(values, 1.0, periodic)).all()
        assert np.isnan(place_of_extreme(values, -1.0, 0.0, 1.0, periodic, EPS)).all()
    assert not math.isfinite(mean_of(row))


def test_mean_over_a_cycle__is_spectrally_exact():
    # The trapezoid rule over a period integrates every harmonic below n exactly; ∫exp(cos φ) dφ/2π = I0(1).
    assert means(np.exp(np.cos(angles(24))), 1, True)[0] == pytest.approx(float(mpmath.besseli(0, 1)), rel=4 * EPS)


def mean_and_doubt(curve, n):
    """Mean of a curve over n positions, and its doubt."""
    row = curve(angles(n))
    mean, half, quarter = (means(row, step, True)[0] for step in (1, 2, 4))
    rough, rough_half = roughness(row, True), roughness(row[::2].copy(), True)
    return mean, doubt_of_mean(mean, half, quarter, rough, rough_half, 0.75 * rough / n)


@pytest.mark.parametrize("n", [48, 96, 360])
def test_doubt_of_a_mean__bounds_what_a_smooth_cycle_leaves(n):
    rng = np.random.default_rng(n)
    for a in rng.uniform(0.0, 0.85, 300):
        # ∫dφ/(1 − a cos φ)/2π = 1/√(1 − a²); its harmonics fall by a/(1 + √(1 − a²)), the error of n positions like
        # the n-th power of that.
        true, shift = 1 / math.sqrt(1 - a * a), rng.uniform(0, TURN)
        mean, doubt = mean_and_doubt(lambda phi, a=a, shift=shift: 1 / (1 - a * np.cos(phi - shift)), n)
        assert abs(mean - true) <= doubt + 16 * EPS * true


def test_doubt_of_a_mean__is_far_less_than_its_last_change_where_the_cycle_is_smooth():
    # The error of n positions is 2·0.268ⁿ here: rounding from 24 on.
    doubts = [mean_and_doubt(lambda phi: 1 / (1 - 0.5 * np.cos(phi)), n)[1] for n in (96, 192, 384, 768)]
    # A jump may hide in sixth differences, which fall by 64, of a mean of twice as many by √2 more.
    for coarse, fine in itertools.pairwise(doubts):
        assert fine < coarse / 50
    assert doubts[-1] < 1e-13


@pytest.mark.parametrize("n", [25, 49, 361])
def test_doubt_of_a_mean__bounds_the_trapezoid_rule_s_error_over_a_range(n):
    # The rule's error is h²/12 of the difference of the slopes at the ends, a third of the change from half of them.
    row = np.exp(np.linspace(0, 1, n))
    mean, half, quarter = (means(row, step, False)[0] for step in (1, 2, 4))
    rough, rough_half = roughness(row, False), roughness(row[::2].copy(), False)
    doubt = doubt_of_mean(mean, half, quarter, rough, rough_half, 0.75 * rough / n)
    error = mean - (math.e - 1)
    assert error == pytest.approx((math.e - 1) / (12 * (n - 1) ** 2), rel=1e-2)
    assert error <= doubt <= 4 * error + rough


@few
@given(st.floats(0.1, 3), st.floats(3.2, 6), st.sampled_from([48, 96, 360]))
def test_doubt_of_a_mean__bounds_that_of_a_pulse(begin, end, n):
    mean, doubt = mean_and_doubt(lambda phi: np.where((phi > begin) & (phi < end), 1.0, 0.2 * np.cos(phi)), n)
    true = (end - begin + 0.2 * (math.sin(begin) - math.sin(end))) / TURN
    assert abs(mean - true) <= doubt


# Extremes where a row is smooth


@few
@given(st.lists(st.floats(-0.05, 0.05), min_size=3, max_size=3), st.floats(-0.4, 0.4), st.floats(0.1, 10))
def test_top_of_a_quartic__is_exact(higher, shift, size):
    # A fall of a square and small higher powers about the top, which the five neighbours know.
    third, fourth, _ = higher

    def curve(k):
        t = k - shift
        return size * (1 - t * t * (1 + 0.3 * third * t + 0.1 * (fourth + 0.06) * t * t))

    row = [curve(k) for k in range(-3, 4)]
    assume(max(row) == row[3])
    smooth, rise, t, off, aside = smooth_top(*row, 0.0)
    assert smooth
    # Differences of six orders have coefficients that add up to 64.
    assert row[3] + rise == pytest.approx(size, abs=64 * EPS * size)
    assert t == pytest.approx(shift, abs=1e-12)
    assert off <= 1e-13 * size
    assert aside <= 1e-12


@pytest.mark.parametrize(("n", "within"), [(48, 0.99), (96, 0.999), (360, 0.999)])
def test_extreme__of_harmonics_is_within_its_doubt_and_far_nearer_than_the_highest_position(n, within):
    errors, doubts, aways, asides, misses = [], [], [], [], []
    for seed in range(300):
        curve = wave(seed)
        true, at = top_of(curve)
        row = curve(angles(n))
        value, place, off, aside = extreme_and_place(row, 1.0, True, 0.0)
        errors.append(abs(value - true))
        doubts.append(off + 8 * EPS)
        aways.append(abs((place * TURN / n - at + math.pi) % TURN - math.pi))
        # The minimum of a curve is found by its value to the root of its rounding.
        asides.append(aside * TURN / n + 1e-7)
        misses.append(true - row.max())
        assert extreme_and_place(-row, -1.0, True, 0.0) == (-value, place, off, aside)
    # Where the fifth difference happens to vanish, the sixth isn't enough; of two peaks nearly as high, the higher one
    # may lie between positions of few.
    assert np.mean(np.array(errors) <= doubts) >= within
    assert np.mean(np.array(aways) <= asides) >= within
    # Quartics leave terms of the fifth order of what squares leave of the second: (4h)³ of four harmonics.
    assert np.median(errors) <= (4 * TURN / n) ** 3 * np.median(misses)
    assert np.median(np.array(doubts) / np.maximum(errors, 8 * EPS)) <= 10


@few
@given(st.integers(3, 40), st.floats(0.0, 1.0), st.sampled_from([1.0, -1.0]))
def test_place__of_one_of_two_equal_peaks_may_be_the_other(shift, place, sign):
    n = 96
    row = sign * np.roll(np.cos(2 * (angles(n) + place * TURN / n)), shift)
    # The peaks are half a turn apart, n/2 positions; either may be the one found.
    at, aside = place_of_extreme(row, sign, 0.0, TURN / n, True, EPS)
    assert abs(aside - math.pi) <= TURN / n
    assert min(abs((at + place * TURN / n - shift * TURN / n + t) % math.pi) for t in (0, 1e-6)) <= 2e-6
    # Without a second peak the place is known.
    single = sign * np.roll(np.cos(angles(n) + place * TURN / n), shift)
    assert place_of_extreme(single, sign, 0.0, TURN / n, True, EPS)[1] <= 1e-6


def test_place__before_the_first_position_is_at_the_end_of_the_cycle():
    row = np.cos(angles(48) + 0.3 * TURN / 48)
    assert place_of_extreme(row, 1.0, 0.0, TURN / 48, True, EPS)[0] == pytest.approx(TURN * (1 - 0.3 / 48), abs=1e-6)


def test_extreme__of_two_peaks_at_different_distances_from_positions_is_that_of_the_higher():
    # Two equal bumps, one with its top at a position, the other's in the middle of a step and a little higher.
    phi, n = angles(96), 96
    first, second = phi[20], phi[70] + 0.5 * TURN / n

    def bump(at):
        return np.exp(4 * (np.cos(phi - at) - 1))

    row = bump(first) + 1.001 * bump(second)
    assert row.argmax() == 20
    # What one bump adds at the other: their distance is 3.24 rad.
    value, place, off, _ = extreme_and_place(row, 1.0, True, 0.0)
    assert place == pytest.approx(70.5, abs=1e-2)
    assert abs(value - 1.001) <= off + 4e-4


# Extremes where a row bends or jumps


@few
@given(st.floats(-5, 5), st.floats(0.1, 10), st.floats(0, 1))
def test_doubt__bounds_a_kink_between_two_positions(top, slope, place):
    k = np.arange(21.0)
    row = top - slope * abs(k - 10 - place)
    # Hidden is slope · min(p, 1 − p); the second differences beside it are 2 slope · p and 2 slope · (1 − p).
    high, above = extreme_of(row, 1.0, False)
    assert high == row.max()
    assert top - high <= above * (1 + 1e-9) + 1e-14


@few
@given(st.floats(1.0, 50.0), st.floats(0.0, 1.0), st.floats(0.0, 0.3))
def test_doubt__bounds_a_valley_that_is_not_the_deepest_at_the_positions(slope, place, deeper):
    # Two straight valleys, one with its bottom at a position; the other's, somewhere between two, is deeper.
    n = 96
    phi, h = angles(n), TURN / n
    first, second = phi[20], phi[70] + place * h
    row = np.minimum(slope * abs(phi - first), slope * abs(phi - second) - deeper * slope * h)
    low, below = extreme_of(row, -1.0, True)
    assert low - below <= -deeper * slope * h + 1e-12 * slope


@few
@given(st.floats(0.1, 10), st.integers(10, 60), st.integers(100, 160))
def test_roughness__adds_jumps_as_squares_and_passes_over_what_is_smooth(jump, first, second):
    phi = angles(256)
    smooth = np.cos(phi) + 0.3 * np.sin(3 * phi)
    # A harmonic m leaves sixth differences of (2 sin(m h/2))⁶, here 0.3 (3h)⁶ = 5e-8; jumps far apart don't interfere.
    stepped = smooth + np.where((np.arange(256) >= first) & (np.arange(256) < second), jump, 0.0)
    assert roughness(smooth, True) < 256**0.5 * 5e-8
    assert roughness(stepped, True) == pytest.approx(2**0.5 * jump, rel=1e-4)


@few
@given(st.floats(-4, 4), st.floats(5, 50), st.floats(0, 1), st.sampled_from([1, -1]))
def test_doubt__beside_a_jump_is_a_step_of_the_branch_not_the_jump(slope, jump, place, side):
    # A straight branch up to a jump between two positions, as a force that sets in or ends: its end is the extreme.
    k = np.arange(41.0)[::side]
    row = np.ascontiguousarray(np.where(k < 20 + place, slope * (k - 20), slope * (k - 20) - jump))
    top = max(slope * place, slope * -20.0)
    # Of two tops nearly as high the doubt knows the one that shows at the positions.
    assume(not 0.0 < 20 * slope - jump < slope * place)
    _, above = extreme_of(row, 1.0, False)
    assert above >= (top - row.max()) - 1e-12
    assert above <= abs(slope) * (1 + 1e-12) + 1e-12


def test_doubt__is_nothing_in_a_straight_row():
    for sign in (1.0, -1.0):
        assert extreme_of(np.linspace(0, 1, 9), sign, False)[1] < 1e-15
        assert extreme_of(np.linspace(0, 1, 9), sign, True)[1] > 0.0
        assert extreme_of(np.ones(9), sign, True) == (1.0, 0.0)


@pytest.mark.parametrize("periodic", [True, False])
@pytest.mark.parametrize("n", range(2, 9))
def test_few_positions__have_their_own_extremes_or_better(n, periodic):
    row = np.cos(1.7 * np.arange(float(n)))
    (low, below), (high, above) = (extreme_of(row, sign, periodic) for sign in (-1.0, 1.0))
    assert low <= row.min() + 1e-15
    assert high >= row.max() - 1e-15
    assert min(below, above) >= 0.0


@few
@given(st.floats(0.0, 1.0), st.sampled_from([1.0, -1.0]))
def test_extreme__isn_t_taken_beyond_zero_where_no_position_is(place, sign):
    # 1 + cos φ touches zero between two positions; a quartic misses that by some (h)⁵/1000 on either side.
    row = sign * (1 + np.cos(angles(48) + place * TURN / 48))
    value, off = extreme_of(row, -sign, True)
    assert sign * value >= 0.0
    assert sign * value <= off + EPS <= 1e-6


def test_doubt_of_an_extreme__is_its_change_where_half_the_positions_were_wrong_about_theirs():
    assert doubt_of_extreme(1.0, 1.1, 0.05, 0.2) == 0.05
    assert doubt_of_extreme(1.0, 1.1, 0.001, 0.2) == pytest.approx(0.0125, rel=1e-14)
    assert doubt_of_extreme(1.0, 1.1, 0.01, 0.02) == pytest.approx(0.1, rel=1e-14)
    assert doubt_of_extreme(1.0, 1.1, 0.3, 0.02) == 0.3


@few
@given(st.floats(-5, 5), st.floats(0, 5))
def test_least_magnitude__is_zero_where_the_sign_changes(low, range_):
    fine = np.linspace(low, low + range_, 1001)
    expected = 0.0 if low <= 0 <= low + range_ else np.abs(fine).min()
    assert least_magnitude(low, low + range_) == pytest.approx(expected, abs=1e-15)
    assert math.isnan(least_magnitude(low, math.nan))
