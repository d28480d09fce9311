"""Flywheels from turning-moment diagrams: exact integrals, and diagrams that are refused."""

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from each_case import refusals
from exact import table_value
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from engine.cycle.turning_moment import fluctuation, turning_moment_from_areas, turning_moment_from_table
from engine.laws.tables import make_table

EPS = 2.3e-16
TURN = 2 * math.pi

few = settings(max_examples=40)
moments = st.integers(3, 12).flatmap(lambda n: arrays(np.float64, n, elements=st.floats(-100, 100).map(round)))


def even(moment):
    """Angles of rows spread evenly over a turn, the first one closing it."""
    return np.arange(len(moment)) * (TURN / len(moment))


def work_by_sampling(phi, moment, interpolation, samples):
    """Excess work of a table: a fine midpoint sum of its values."""
    table = make_table(phi, moment, interpolation, TURN)
    middles = (np.arange(samples) + 0.5) * (TURN / samples)
    values = table_value(table, middles)
    work = np.concatenate(([0.0], np.cumsum(values - values.mean()))) * (TURN / samples)
    return values.mean(), np.ptp(work)


@few
@given(moments, st.sampled_from(["linear", "pchip", "spline"]))
def test_excess_work__is_that_of_a_fine_sum(moment, interpolation):
    phi = even(moment)
    found = turning_moment_from_table(phi, moment, 10.0, 0.02, cycle=TURN, interpolation=interpolation)
    mean, excess = work_by_sampling(phi, moment, interpolation, 6000)
    # Midpoint sums miss h²/24·|M″| of the integral and h²/8·|M′| at an extreme; a spline of 12 rows has M′ < 4/h.
    size = np.abs(moment).max() + 1e-9
    assert found.mean_moment == pytest.approx(mean, abs=1e-5 * size)
    assert found.excess_work == pytest.approx(excess, abs=1e-4 * size)


@few
@given(moments)
def test_straight_lines__are_integrated_without_an_error(moment):
    phi = even(moment)
    found = turning_moment_from_table(phi, moment, 10.0, 0.02, cycle=TURN)
    # Areas of trapezoids and of the triangles where a line crosses the mean, with 40 digits.
    with mpmath.workdps(40):
        h, closed = 2 * mpmath.pi / len(moment), [mpmath.mpf(m) for m in [*moment, moment[0]]]
        mean = sum(closed[:-1]) / len(moment)
        work, ends = mpmath.mpf(0), [mpmath.mpf(0)]
        for before, after in pairwise(closed):
            a, b = before - mean, after - mean
            if a * b < 0:
                ends.append(work + a * (h * a / (a - b)) / 2)
            work += (a + b) * h / 2
            ends.append(work)
    size = np.abs(moment).max() + 1e-300
    assert found.mean_moment == pytest.approx(float(mean), abs=100 * EPS * size)
    assert found.excess_work == pytest.approx(float(max(ends) - min(ends)), abs=1000 * EPS * size)


@few
@given(moments, st.floats(0.1, 300), st.floats(1e-8, 1), st.floats(0, 10))
def test_flywheel__gives_the_fluctuation_asked_for(moment, speed, delta, inertia):
    found = turning_moment_from_table(even(moment), moment, -speed, delta, cycle=TURN, inertia=inertia)
    if found.flywheel_inertia > 0:
        assert found.speed_fluctuation == delta
        whole = found.flywheel_inertia + inertia
        fast, slow = speed * (1 + delta / 2), speed * (1 - delta / 2)
        # Exact in ω_m = (ω_max + ω_min)/2, not only to first order in δ; the squares lose 1/δ.
        assert whole * (fast**2 - slow**2) / 2 == pytest.approx(found.excess_work, rel=1e-13 + 4 * EPS / delta)
    elif inertia > 0:
        assert found.speed_fluctuation == pytest.approx(found.excess_work / (inertia * speed**2))
        assert found.speed_fluctuation <= delta * (1 + 1e-14)


def test_steps__are_extremes_too():
    found = turning_moment_from_table([0, math.pi, math.pi, TURN, TURN], [3, 3, 1, 1, 3], 10.0, 0.01)
    assert found.mean_moment == pytest.approx(2)
    assert found.excess_work == pytest.approx(math.pi)
    assert (found.slowest_at, found.fastest_at) == pytest.approx((0, math.pi))


def test_equal_peaks__are_told_by_the_first():
    phi = np.arange(13) * (TURN / 12)
    found = turning_moment_from_table(phi, np.tile([0.0, 1.0, 0.0, -1.0], 4)[:13], 10.0, 0.01)
    assert (found.slowest_at, found.fastest_at) == pytest.approx((0, phi[2]))


@pytest.mark.parametrize(("share", "delta"), [(0.5, 0.5), (1.999, 1.999), (2.0, math.nan), (3.0, math.nan)])
def test_fluctuation__is_nan_where_the_machine_would_stop(share, delta):
    assert fluctuation(share * 3 * 16, 3.0, -4.0) == pytest.approx(delta, nan_ok=True)


# What is refused


FROM_TABLE = {"phi": [0, 1, TURN], "moment": [0, 1, 0], "speed": 10.0, "speed_fluctuation": 0.02}
FROM_AREAS = {"areas": [1, -0.99], "energy_per_area": 2.0, "speed": 10.0, "speed_fluctuation": 0.02}


def test_what_is_refused_but_for_a_change__is_right():
    turning_moment_from_table(**FROM_TABLE)
    turning_moment_from_areas(**FROM_AREAS)


test_from_table__says_what_is_wrong = refusals(
    lambda change: turning_moment_from_table(**(FROM_TABLE | change)),
    ({"speed": 0.0}, "speed = 0.0"),
    ({"speed": math.inf}, "speed = inf"),
    ({"speed_fluctuation": 0.0}, "between 0 and 2"),
    ({"speed_fluctuation": 2.5}, "speed_fluctuation = 2.5"),
    ({"speed_fluctuation": math.nan}, "speed_fluctuation = nan"),
    ({"inertia": -1.0}, "inertia = -1.0"),
    ({"cycle": 0.0}, "cycle = 0.0"),
    ({"cycle": -TURN}, "leave it out"),
    ({"cycle": 1.0}, "more than one period"),
    ({"phi": [0, 2, 1]}, "sort the rows"),
    ({"phi": [0, 1]}, "x has 2 rows"),
    ({"moment": [0, 1, 2]}, "make them equal"),
    ({"moment": [0, math.nan, 0]}, "row 2"),
    ({"interpolation": "cubic"}, "choose one of"),
)
test_from_areas__says_what_is_wrong = refusals(
    lambda change: turning_moment_from_areas(**(FROM_AREAS | change)),
    ({"areas": [1, 1]}, "sum is 2"),
    ({"areas": [1, -0.9]}, "balance"),
    ({"areas": [1]}, "at least 2"),
    ({"areas": [[1, -1]]}, "one list"),
    ({"areas": [1, math.nan]}, "area 2"),
    ({"areas": ["a", 1]}, "plain numbers"),
    ({"energy_per_area": 0.0}, "energy_per_area = 0.0"),
    ({"speed": 0.0}, "speed = 0.0"),
)
