"""Dyads out of reach and at their dead centres, where whole machines only show a verdict."""

import math

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.laws.kinematics.rpr import rpr_position, rpr_rates
from engine.laws.kinematics.vectors import oblique_components

mode = st.sampled_from([1.0, -1.0])


@settings(max_examples=30)
@given(st.floats(-3.2, 3.2), st.floats(-6.0, 6.0), st.floats(1e-9, 1e6), mode, mode)
def test_rpr_pin_inside_the_offset__nan(at, size, miss, side, sign):
    distance = 10**size
    a = (distance * math.cos(at), distance * math.sin(at))
    found = rpr_position(a, (0.0, 0.0), side * distance * (1 + miss), sign)
    assert all(math.isnan(x) for x in found)


@pytest.mark.parametrize("sign", [1.0, -1.0])
@pytest.mark.parametrize("offset", [5.0, -5.0])
def test_rpr_dead_centre__place_finite_rates_not(offset, sign):
    c, s, slide, sine = rpr_position((4.0, 5.0), (1.0, 1.0), offset, sign)
    # The pin is wholly to the left (right) of the slot's line: n = ±(0.6, 0.8).
    assert (c, s) == pytest.approx((0.8 * offset / 5, -0.6 * offset / 5), rel=1e-15)
    assert (slide, sine) == (0.0, 0.0)
    w, rate = rpr_rates((0.3, -0.2), (c, s), offset, slide)
    assert not math.isfinite(w)
    assert not math.isfinite(rate)


def test_rpr_pin_on_the_pivot__nan():
    # The slot may then point anywhere: there is no position.
    assert all(math.isnan(x) for x in rpr_position((1.0, 1.0), (1.0, 1.0), 0.0, 1.0)[:2])


@pytest.mark.parametrize("direction", [(1.0, 0.0), (0.0, -1.0)])
@pytest.mark.parametrize("gap", [(0.3, 0.1), (0.8, 0.0), (0.0, -0.2)])
def test_oblique_components_of_parallel_directions__not_finite(gap, direction):
    # Directions oblique to the axes are parallel to rounding only: a machine judges by their sine.
    c, s = direction
    assert not any(math.isfinite(x) for x in oblique_components(gap, (c, s), (-c, -s)))
