"""Laws of what switches in formulas: which of two numbers is greater, which of two holds; NaN for what is not known."""

import math

import pytest

from engine.laws.senses import either, exceeds, kept_positive

NAN, INF = math.nan, math.inf


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [(2.0, 1.0, 1.0), (1.0, 2.0, 0.0), (1.0, 1.0, 0.0), (INF, 1.0, 1.0), (-INF, INF, 0.0), (INF, INF, 0.0)],
)
def test_exceeds__says_which_is_greater(a, b, expected):
    assert exceeds(a, b) == expected


@pytest.mark.parametrize(("a", "b"), [(NAN, 1.0), (1.0, NAN), (NAN, NAN)])
def test_exceeds__says_nothing_of_what_is_not_known(a, b):
    assert math.isnan(exceeds(a, b))


def test_either__reads_the_one_that_holds():
    assert either(1.0, 3.0, NAN) == 3.0
    assert either(0.0, INF, 4.0) == 4.0
    assert math.isnan(either(1.0, NAN, 4.0))
    assert math.isnan(either(NAN, 3.0, 4.0))


def test_kept_positive__takes_for_zero_what_rounding_puts_below():
    assert kept_positive(1.0, -1e-17) == 0.0
    assert kept_positive(1.0, 2.0) == 2.0
    assert kept_positive(0.0, 0.0) == 0.0
    for forward, x in ((-1.0, -2.0), (-1.0, 1e-17), (NAN, 1.0), (1.0, NAN)):
        assert math.isnan(kept_positive(forward, x))
