"""Tables against SciPy's interpolants, exact values and what a table must do outside its rows."""

import math

import numpy as np
import pytest
from each_case import each, refusals
from exact import table_value
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose, assert_array_equal
from scipy.interpolate import CubicSpline, PchipInterpolator, make_interp_spline

from engine.laws.tables import in_memory, make_table, table_segment

EPS = np.finfo(float).eps


def values(table, x):
    return table_value(table, x)


def segment_value(left: float, c3: float, c2: float, c1: float, c0: float, x: float) -> float:
    t = x - left
    return ((c3 * t + c2) * t + c1) * t + c0


@st.composite
def rows(draw, least=2):
    gaps = draw(st.lists(st.floats(0.05, 20.0), min_size=least - 1, max_size=11))
    start = draw(st.floats(-50.0, 50.0))
    x = start + np.concatenate(([0.0], np.cumsum(gaps)))
    y = draw(st.lists(st.floats(-1e6, 1e6, allow_subnormal=False), min_size=x.size, max_size=x.size))
    return x, np.array(y)


def rounding(table, largest):
    """Bound on the rounding of one evaluation at |x| up to `largest`.

    Horner's rule for a cubic: 2·3 EPS/2 of the sum of the terms' sizes at the far end of the piece
    (N. J. Higham, Accuracy and Stability of Numerical Algorithms, 5.1), twice for two evaluations that are
    compared, and a reserve of 2. The rounding of x (and of x + period) is EPS |x| times the steepest slope.
    """
    gaps = np.diff(table.breaks)[:, None]
    sizes = np.abs(table.coefficients) * gaps ** [3, 2, 1, 0]
    slopes = np.abs(table.coefficients[:, :3]) * gaps ** [2, 1, 0] * [3, 2, 1]
    return 12 * EPS * sizes.sum(axis=1).max() + 4 * EPS * largest * slopes.sum(axis=1).max()


@settings(max_examples=40)
@given(rows(), st.integers(0, 2**32 - 1), st.sampled_from(["linear", "pchip", "spline"]))
def test_interpolants__are_those_of_scipy_inside_and_hold_outside(row, seed, interpolation):
    x, y = row
    u = np.random.default_rng(seed).uniform(x[0] - 5.0, x[-1] + 5.0, 40)
    references = {
        "linear": lambda: make_interp_spline(x, y, 1),
        "pchip": lambda: PchipInterpolator(x, y),
        "spline": lambda: CubicSpline(x, y, bc_type="natural"),
    }
    expected = np.where(u < x[0], y[0], np.where(u > x[-1], y[-1], references[interpolation]()(u)))
    table = make_table(x, y, interpolation)
    assert_allclose(values(table, u), expected, rtol=0, atol=rounding(table, np.abs(u).max()))


@pytest.mark.parametrize("interpolation", ["linear", "pchip", "spline"])
def test_rows__are_returned_as_given(interpolation):
    x, y = np.array([-1.0, 0.5, 2.0, 7.0]), np.array([3.0, -4.0, 4.0, 0.1])
    # At its own break a piece is its constant term; only the last row is a piece's far end, and that is held.
    assert_array_equal(values(make_table(x, y, interpolation), x), y)


@pytest.mark.parametrize("interpolation", ["linear", "pchip", "spline"])
def test_zero_outside__keeps_the_end_rows_and_nothing_beyond(interpolation):
    x, y = [0.1, 0.2, 0.4], [5.0, 7.0, 6.0]
    table = make_table(x, y, interpolation, outside="zero")
    beyond = [-1e9, np.nextafter(0.1, 0.0), np.nextafter(0.4, 1.0), 1e9]
    assert_array_equal(values(table, beyond), 0.0)
    # The last row is the far end of a cubic whose terms are below 20.
    assert_allclose(values(table, [0.1, 0.4]), [5.0, 6.0], rtol=0, atol=100 * EPS)


BEFORE = np.nextafter(1.0, 0.0)


@each("x, y, options, at, expected", [
    *(([0, 1, 1, 2], [0, 1, 5, 6], {"outside": out}, [BEFORE, 1, 1.5], [BEFORE, 5, 5.5]) for out in ("hold", "zero")),
    ([0, 1, 1], [0, 1, 9], {}, [BEFORE, 1, 2], [BEFORE, 9, 9]),
    ([0, 1, 1], [0, 1, 9], {"outside": "zero"}, [BEFORE, 1, 2], [BEFORE, 9, 0]),
    ([0, 0, 1], [3, 8, 9], {}, [-1, 0, 0.5], [3, 8, 8.5]),
    ([0, 1, 1], [0, 1, 0], {"period": 1.0}, [0, 0.75, 1, 5.25, -0.25], [0, 0.75, 0, 0.25, 0.75]),
    ([0, 0, 1], [1, 0, 1], {"period": 1.0}, [0, 0.75, 1, 5.25, -0.25], [0, 0.75, 0, 0.25, 0.75]),
])  # fmt: skip
def test_step__takes_the_value_after_it_but_before_the_first_row(x, y, options, at, expected):
    assert_array_equal(values(make_table(x, y, "linear", **options), at), expected)


@settings(max_examples=40)
@given(rows(least=3), st.integers(-1000, 1000), st.sampled_from(["linear", "pchip", "spline"]), st.booleans())
def test_periodic__wraps_to_the_first_period(row, turns, interpolation, closed):
    x, y = row
    period = x[-1] - x[0]
    y[-1] = y[0]
    table = make_table(x if closed else x[:-1], y if closed else y[:-1], interpolation, period=period)
    u = np.linspace(x[0], x[-1], 23)[1:-1]
    error = rounding(table, np.abs(u).max() + abs(turns) * period)
    assert_allclose(values(table, u + turns * period), values(table, u), rtol=0, atol=error)


def test_periodic_spline__agrees_with_scipy():
    x = np.array([0.0, 0.7, 1.9, 3.0, 4.4, 5.1])
    y = np.array([1.0, 3.0, -2.0, 0.5, 2.0, -1.0])
    reference = CubicSpline(np.append(x, 6.0), np.append(y, 1.0), bc_type="periodic")
    u = np.linspace(-20.0, 20.0, 301)
    table = make_table(x, y, "spline", period=6.0)
    assert_allclose(values(table, u), reference(u), rtol=0, atol=rounding(table, 20.0))


@pytest.mark.parametrize("period", [0.0, 1.0])
def test_spline_over_gaps_of_all_sizes__bends_alike_on_both_sides_of_a_row(period):
    """To the rounding of its neighbours, not to that of the steepest rows of the table."""
    rng = np.random.default_rng(3)
    for _ in range(50):
        x = np.cumsum(10.0 ** rng.uniform(-5.0, 0.0, 20))
        x *= 0.99 / (x[-1] - x[0])
        table = make_table(x, np.sin(6.0 * x) ** 4, "spline", period)
        h, pieces = np.diff(table.breaks), table.coefficients
        # Without a period, a piece on either side holds the end values.
        h, (c3, c2, c1, _) = (h, pieces.T) if period else (h[1:-1], pieces[1:-1].T)
        end = c1 + h * (2.0 * c2 + 3.0 * c3 * h)
        size = (np.abs(c1) + np.abs(end) + np.abs(c1 + h * (c2 + c3 * h))) / h
        jump = (c2 + 3.0 * c3 * h)[:-1] - c2[1:]
        assert np.all(np.abs(jump) <= 16 * EPS * (size[:-1] + size[1:]))


def test_periodic_pchip__has_one_slope_at_the_seam():
    x, y = np.array([0.0, 1.0, 2.5, 3.0]), np.array([2.0, 5.0, 4.0, 1.0])
    tiled = PchipInterpolator(np.concatenate((x - 4.0, x, x + 4.0)), np.tile(y, 3))
    u = np.linspace(0.0, 4.0, 101)
    table = make_table(x, y, "pchip", period=4.0)
    assert_allclose(values(table, u), tiled(u), rtol=0, atol=rounding(table, 4.0))


@given(st.floats(-12.0, -5.0))
def test_step_just_before_the_seam__stays_where_it_is(exponent):
    period = 2 * math.pi
    step = period - 10.0**exponent
    table = make_table([0.0, step, step, period], [1.0, 1.0, 3.0, 1.0], "linear", period=period)
    assert_array_equal(values(table, [np.nextafter(step, 0.0), step, 0.0]), [1.0, 3.0, 1.0])


def test_rounded_period__closes():
    # 360 degrees written as 6.2832 rad is 1.2e-6 of a revolution too long.
    table = make_table([0.0, 3.1416, 6.2832], [1.0, -1.0, 1.0], "linear", period=2 * math.pi)
    assert table.breaks[-1] == 2 * math.pi


@pytest.mark.parametrize("period", [0.0, 4.0])
def test_unknown_x__gives_nan(period):
    table = make_table([0.0, 1.0, 4.0], [1.0, 2.0, 1.0], "spline", period=period)
    assert math.isnan(table_value(table, math.nan))


test_wrong_rows__are_named_with_the_mend = refusals(
    lambda x, y, options: make_table(x, y, **{"interpolation": "linear", **options}),
    ([0, 2, 1], [0, 0, 0], {}, "row 3: x is below that of row 2; sort"),
    ([0, 1], [0, 1, 2], {}, r"x has 2 rows, y has 3"),
    ([1], [1], {}, "1 row(s); give at least 2"),
    ([0, 1, 2], [0, math.nan, 1], {}, r"row 2: y = nan is not finite"),
    ([0, math.inf, 2], [0, 1, 1], {}, r"row 2: x = inf is not finite"),
    ([0, "a"], [0, 1], {}, "x: … 'a' … number"),
    ([[0, 1]], [[0, 1]], {}, r"x has 2 dimensions"),
    ([0, 1, 1], [0, 1, 2], {"interpolation": "pchip"}, 'row 3: x = 1.0 is also row 2\'s … "linear"'),
    ([0, 1, 1, 1], [0, 1, 2, 3], {}, "row 4: x = 1.0 for the third time"),
    ([1, 1], [0, 1], {}, "every row has x = 1.0"),
    ([0, 1], [0, 1], {"interpolation": "splin"}, "'splin' … did you mean 'spline'"),
    ([0, 1], [0, 1], {"outside": "nil"}, "outside = 'nil'; choose one of: hold, zero"),
    ([0, 1], [0, 1], {"period": -1.0}, "period = -1.0: give a positive"),
    ([0, 1], [0, 1], {"period": math.nan}, r"period = nan"),
    ([0, 1, 5], [0, 1, 0], {"period": 4.0}, "row 3: x = 5 is more than one period (4)"),
    (
        [0, 1, 4],
        [0, 1, 2],
        {"period": 4.0},
        "row 3: y = 2 one period after … y = 0; make them equal: repeat row 1 there",
    ),
    ([0, 5e-324, 1], [0, 1, 2], {}, "rows 1 and 2: … too close"),
    ([0, 1e-310, 1], [0, 1, 2], {"interpolation": "spline"}, "rows 1 and 2: … too close"),
)


# Segments of tables in memory


@settings(max_examples=40)
@given(rows(least=3), st.integers(0, 2**32 - 1), st.sampled_from(["linear", "pchip", "spline"]), st.booleans())
def test_segment__has_the_value_of_the_table(row, seed, interpolation, periodic):
    x, y = row
    period = (x[-1] - x[0]) * 1.25 if periodic else 0.0
    table = make_table(x, y, interpolation, period)
    other = make_table([0.0, 1.0], [2.0, 3.0], "linear")
    memory = np.concatenate((in_memory(other), in_memory(table), in_memory(other)))
    offset = float(in_memory(other).size)
    # Every break itself, and places up to three periods away.
    reach = 3.0 * (x[-1] - x[0])
    u = np.concatenate((x, np.random.default_rng(seed).uniform(x[0] - reach, x[-1] + reach, 40)))
    found = [segment_value(*table_segment(memory, offset, float(v)), float(v)) for v in u]
    # The distance in the piece is found from x and the piece's break some periods on: a rounding of each.
    assert_allclose(found, values(table, u), rtol=0, atol=rounding(table, np.abs(u).max()))


def test_segment__is_held_beyond_its_ends():
    table = make_table([0.0, 1.0, 2.0], [0.0, 1.0, 0.0], "spline")
    held = table_segment(in_memory(table), 0.0, 1.5)
    left, *coefficients = held
    assert left == 1.0
    # The second piece of the natural spline is 1 - 3/2 t² + t³/2, and goes on so at t = -1/2 and 3/2.
    assert_allclose(coefficients, [0.5, -1.5, 0.0, 1.0], rtol=0, atol=8 * EPS)
    assert_allclose([segment_value(*held, x) for x in (0.5, 2.5)], [9 / 16, -11 / 16], rtol=0, atol=16 * EPS)


def test_segment_at_a_step__is_the_one_after_it():
    table = make_table([0.0, 1.0, 1.0, 2.0], [5.0, 5.0, 7.0, 7.0], "linear")
    memory = in_memory(table)
    before = table_segment(memory, 0.0, np.nextafter(1.0, 0.0))
    assert segment_value(*before, 1.0) == 5.0
    assert segment_value(*table_segment(memory, 0.0, 1.0), 1.0) == 7.0


def test_segment__of_no_number_has_no_value():
    for period in (0.0, 3.0):
        held = table_segment(in_memory(make_table([0.0, 1.0], [2.0, 2.0], "linear", period)), 0.0, math.nan)
        assert math.isnan(segment_value(*held, math.nan))
