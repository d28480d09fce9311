"""Panels: integrals, running integrals and extremes against closed forms, and how the range is cut."""

import math

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.equal_positions.flywheel import energy_slopes
from engine.panels.panel_curves import extreme
from engine.panels.panel_rows import (
    extreme_of,
    fluctuation_with_flywheel,
    flywheel_sizes,
    means,
    place_of_extreme,
    roughness,
    signed_extreme,
    stroke_ends,
)
from engine.panels.panels import (
    CLEAR,
    LONG,
    SAME,
    Panels,
    accumulated,
    cosine_near_zero,
    cut,
    halve,
    integral_of,
    lay_half,
    lay_positions,
    mean_of,
    most_edges,
    sine_near_zero,
)

TURN = 2 * math.pi
few = settings(deadline=None, max_examples=30)
EPS = np.finfo(float).eps


def edges_of(breaks, longest: float = math.pi / 2, last: float = TURN) -> np.ndarray:
    places = np.sort(np.array([breaks], float).reshape(1, -1), axis=1)
    edges = np.empty((1, most_edges(places.shape[1], last, longest)))
    cut(1, places, 0.0, last, longest, edges)
    return edges[0]


def panels_of(breaks=(), longest: float = math.pi / 2, last: float = TURN) -> Panels:
    edges = edges_of(breaks, longest, last)
    starts, halves = np.empty(edges.size, np.int64), np.empty(edges.size)
    nodes, cosines, sines = np.empty((3, edges.size * (LONG + 1)))
    count, n = lay_positions(edges, 0.25 * longest, CLEAR, starts, halves, nodes, cosines, sines)
    # Sums of two products with factors known to an ulp or two.
    assert np.abs(cosines[:n] - np.cos(nodes[:n])).max() < 4 * EPS
    assert np.abs(sines[:n] - np.sin(nodes[:n])).max() < 4 * EPS
    return Panels(starts[: count + 1], halves[:count], nodes[:n])


@few
@given(st.lists(st.floats(-1, 8), max_size=12), st.floats(0.05, 3))
def test_cut__covers_the_range_with_an_end_at_every_break(breaks, longest):
    edges = edges_of([*breaks, math.nan], longest)
    edges = edges[np.isfinite(edges)]
    assert edges[0] == 0.0
    assert edges[-1] == TURN
    assert (np.diff(edges) > 0).all()
    assert np.diff(edges).max() <= longest * (1 + 1e-9)
    for b in breaks:
        if SAME < b < TURN - SAME:
            # Breaks that lie together share one end.
            assert np.abs(edges - b).min() <= len(breaks) * SAME


def test_integral__of_polynomials_up_to_the_degree_is_exact():
    panels = panels_of([1.0, 1.2])
    for power in range(9):
        exact = TURN ** (power + 1) / (power + 1)
        # Positions next to an end are moved by CLEAR, where weights are some 1 % of the panel.
        assert integral_of(panels, panels.nodes**power) == pytest.approx(exact, rel=50 * EPS + CLEAR)


def test_running_integral__of_a_jumping_row_is_that_of_its_pieces():
    panels = panels_of([2.0, 4.5])
    row = np.where(panels.nodes < 2.0, np.sin(panels.nodes), np.where(panels.nodes < 4.5, 7.0, -1.0))
    work = np.empty_like(row)
    total = accumulated(panels, row, 0.25, work)
    q = panels.nodes
    first, second = 1 - math.cos(2.0), 7 * 2.5
    exact = np.where(q < 2, 1 - np.cos(q), np.where(q < 4.5, first + 7 * (q - 2), first + second - (q - 4.5))) - q / 4
    # A step's end is off by CLEAR times the greatest value.
    assert work == pytest.approx(exact, abs=2e-9)
    assert total == pytest.approx(first + second - (TURN - 4.5) - TURN / 4, abs=1e-11)


@few
@given(st.lists(st.floats(-1, 1), min_size=8, max_size=8), st.sampled_from([1.0, -1.0]))
def test_extreme__of_a_trigonometric_polynomial_lies_between_positions(numbers, sign):
    def curve(q):
        return sum(a * np.cos((k + 1) * q) + b * np.sin((k + 1) * q) for k, (a, b) in enumerate(pairs))

    pairs = [(numbers[2 * k], numbers[2 * k + 1]) for k in range(4)]
    panels = panels_of()
    row = curve(panels.nodes)
    value, at = extreme(panels, row, row, 0.0, sign)
    dense = sign * curve(np.linspace(0, TURN, 20_001))
    # The polynomial of degree 16 on a quarter turn follows cos 4q to some 4·(4·π/4)^17/(2^16·17!) = 5e-11, the others
    # far better; a dense sample misses at most (h²/8)·max|f''|, where |f''| ≤ 2·(1 + 4 + 9 + 16).
    near = 1e-10
    assert value >= dense.max() - near
    assert value <= dense.max() + 60 * (TURN / 20_000) ** 2 / 8 + near
    assert sign * curve(at) == pytest.approx(value, abs=near)


def test_extreme__beside_the_end_of_a_panel_beyond_which_a_jump_is_higher():
    # At 2 the row falls by 6e-6 from a rising line to a parabola, which rises by 16e-6 more before the next position.
    panels = panels_of([2.0])
    row = np.where(panels.nodes < 2.0, panels.nodes - 2.0 - 1e-5, -((panels.nodes - 2.004) ** 2))
    first = panels.nodes[panels.nodes > 2.0][:2]
    assert 0.5 * first.sum() > 2.004
    value, at = extreme(panels, row, row, 0.0, 1.0)
    # Rounding of a row of some 18, and the root of it over the bend of 2 for its place.
    assert value == pytest.approx(0.0, abs=100 * EPS * 18)
    assert at == pytest.approx(2.004, abs=math.sqrt(100 * EPS * 18))


def test_half__is_every_second_position_of_each_panel():
    panels = panels_of([1.0, 1.1])
    starts, nodes = np.empty(panels.starts.size, np.int64), np.empty(panels.nodes.size)
    n = lay_half(panels, starts, nodes)
    row = np.empty(n)
    halve(panels, panels.nodes, row)
    assert (row == nodes[:n]).all()
    half = Panels(starts, panels.halves, nodes[:n])
    # exp(cos q): the degree 8 on a quarter turn is good for some 1e-9, 16 for rounding.
    exact = float(mpmath.besseli(0, 1))
    assert mean_of(panels, np.exp(np.cos(panels.nodes))) == pytest.approx(exact, rel=1e-14)
    assert 1e-13 < abs(mean_of(half, np.exp(np.cos(half.nodes))) / exact - 1) < 1e-7


@pytest.mark.parametrize("x", np.linspace(-math.pi / 4, math.pi / 4, 41))
def test_series__to_two_units_in_the_last_place(x):
    assert abs(cosine_near_zero(x) - float(mpmath.cos(mpmath.mpf(float(x))))) <= 2 * np.spacing(1.0)
    assert abs(sine_near_zero(x) - float(mpmath.sin(mpmath.mpf(float(x))))) <= 2 * np.spacing(max(abs(x), 1e-300))


def test_statistics__of_a_sawtooth():
    panels = panels_of([3.0])
    row = np.where(panels.nodes < 3.0, panels.nodes, panels.nodes - 10.0)
    (low, below), (high, above) = (extreme_of(panels, row, sign, True) for sign in (-1.0, 1.0))
    mean, rms = means(panels, row, 1, True)
    assert abs(high - 3.0) <= above <= 1e-9
    assert abs(low + 7.0) <= below <= 1e-9
    # Straight lines are integrated exactly, but for rounding.
    assert roughness(panels, row, True) < 1e-12
    assert mean == pytest.approx((TURN**2 / 2 - 10 * (TURN - 3.0)) / TURN, rel=1e-11)
    square = (27 / 3 + ((TURN - 10) ** 3 + 343) / 3) / TURN
    assert rms == pytest.approx(math.sqrt(square), rel=1e-11)


def test_stroke__of_a_slider_crank_whose_dead_centres_lie_between_positions():
    panels = panels_of()
    q = panels.nodes + 0.123
    d = 0.05 * np.cos(q) + np.sqrt(0.2**2 - (0.05 * np.sin(q)) ** 2)
    v = -0.05 * np.sin(q) - 0.05**2 * np.sin(q) * np.cos(q) / np.sqrt(0.2**2 - (0.05 * np.sin(q)) ** 2)
    low, high, low_at, high_at = stroke_ends(panels, d, v, 0.0, 0.0, True)
    # sqrt(1 − (r/l)² sin²) is analytic with its singularity at Im q = asinh(√(16 − 1)) ≈ 2: the panel's polynomial
    # converges like (2/(π/4)·2)^−16, about 1e-11 of the oblique term.
    assert high == pytest.approx(0.25, abs=1e-13)
    assert low == pytest.approx(0.15, abs=1e-13)
    # The places are zeros of the velocity, whose polynomial is as good, over its slope of some 0.05.
    assert low_at == pytest.approx(math.pi - 0.123, abs=1e-10)
    assert high_at == pytest.approx(TURN - 0.123, abs=1e-10)


@few
@given(st.floats(0, 6), st.floats(1e-4, 2))
def test_magnitude_near_zero__is_followed_by_its_square(begins, least):
    # |F|² = (cos² + least² sin²) is smooth, |F| all but has a corner where the force nearly vanishes.
    panels = panels_of()
    q = panels.nodes + begins
    row = np.sqrt(np.cos(q) ** 2 + (least * np.sin(q)) ** 2)
    low, apart = signed_extreme(panels, row, -1.0)
    high, _ = signed_extreme(panels, row, 1.0)
    assert abs(low - min(1.0, least)) <= apart + 1e-12
    assert high == pytest.approx(max(1.0, least), abs=1e-6)
    if least < 0.29:
        # cos 2q on a quarter turn is followed to a few 1e-12; the root of it near a zero to that over twice the value.
        assert abs(low - least) <= 1e-11 / least


@few
@given(st.floats(0.3, 6), st.sampled_from([1.0, -1.0]))
def test_place_of_an_extreme__lies_within_its_doubt(begins, sign):
    panels = panels_of()
    row = sign * np.exp(np.cos(panels.nodes - begins))
    place, doubt = place_of_extreme(panels, row, sign, 0.0, 0.0, True, 16.0 * EPS)
    # Half the degree follows exp cos to some 1e-5, and its place is as unsure as the root of that.
    assert abs(place - begins) <= doubt <= 1e-2


def test_flywheel__by_three_methods_of_a_closed_form():
    # I = 3 + cos 2q and W = 5 sin q: W − s·I has its extremes where 5 cos q + 2 s sin 2q = 0.
    panels = panels_of()
    q, omega, delta = panels.nodes, 2.0, 0.1
    inertia, work = 3 + np.cos(2 * q), 5 * np.sin(q)
    dense = np.linspace(0, TURN, 400_001)
    slow, middle, fast = energy_slopes(omega, delta)

    def swing(upper, lower):
        rows = [5 * np.sin(dense) - s * np.cos(2 * dense) for s in (upper, lower)]
        return rows[0].max() - rows[1].min()

    found = flywheel_sizes(panels, inertia, work, omega, delta, 2.0)
    size = delta * omega**2
    # The dense sample misses a curvature of 5 + 4·s ≤ 15 over h²/8 = 3e-11; the division by δω² makes it 1e-9.
    expected = (10.0, 10.0 / size, swing(middle, middle) / size - 2.0, swing(fast, slow) / size - 3.0)
    assert found == pytest.approx(expected, abs=2e-9)


@pytest.mark.parametrize("flywheel", [0.5, 10.0, 1e4, 1e8])
def test_fluctuation__gives_back_the_flywheel_it_was_made_for(flywheel):
    panels = panels_of()
    q, omega = panels.nodes, 3.0
    inertia, work = 3 + np.cos(2 * q + 0.4), 5 * np.sin(q)
    energy, delta = fluctuation_with_flywheel(panels, inertia, work, flywheel, omega)
    by_tangents = flywheel_sizes(panels, inertia, work, omega, delta, 0.0)[3]
    # δ is known to a few roundings of the excess work; its flywheel to as many of I + I_F.
    assert by_tangents == pytest.approx(flywheel, abs=1e-12 * (flywheel + 4))
    speed = np.sqrt(2 * (energy + work) / (inertia + flywheel))
    highest = extreme(panels, speed, speed, 0.0, 1.0)[0]
    lowest = -extreme(panels, speed, speed, 0.0, -1.0)[0]
    # The root of a smooth row is as smooth as its least value allows; δ/ω of 1e-9 for the lightest flywheel.
    assert 0.5 * (highest + lowest) == pytest.approx(omega, rel=1e-8)
    assert (highest - lowest) / omega == pytest.approx(delta, rel=1e-7, abs=1e-14)
