"""Indicator diagrams, branch by branch: the pressure along each, and what ends it."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from engine.laws.indicator_diagrams import (
    COMPRESSION,
    EXPANSION,
    INFLOW,
    OUTFLOW,
    branch_pressure,
    compressor_branch,
    four_stroke_branch,
    line_pressure,
    pump_branch,
    two_stroke_branch,
)

STROKE = 0.08
# Cylinder, pressures and exponents.
GAS = (STROKE, 0.1, 0.8), (1e5, 4e5, 50e5), (1.35, 1.25)


@pytest.mark.parametrize("missed", [-1e-9, 0.0, 1e-9])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_firing_angle_within_rounding_of_a_dead_centre__is_that_one(missed, way):
    # Just after it the piston leaves the head, whichever way the crank turns.
    assert four_stroke_branch(1.0, 0.3 + way * 0.1, 0.3, 0.3 + missed, way) == EXPANSION


def test_unknown_motion__has_no_branch_and_no_pressure():
    nan = math.nan
    branches = [compressor_branch(nan, STROKE, 1.0, 0.5, 0.2), compressor_branch(0.01, STROKE, nan, 0.5, 0.2)]
    branches += [pump_branch(nan), two_stroke_branch(nan, STROKE, 1.0, 0.8), two_stroke_branch(0.01, STROKE, nan, 0.8)]
    branches += [four_stroke_branch(nan, 1.0, 0.0, 0.0, 1.0), four_stroke_branch(1.0, nan, 0.0, 0.0, 1.0)]
    assert np.isnan(branches).all()
    pressures = [branch_pressure(nan, 0.01, *GAS), line_pressure(nan, 1e5, 4e5)]
    pressures += [branch_pressure(branch, nan, *GAS) for branch in (EXPANSION, OUTFLOW, INFLOW, COMPRESSION)]
    assert np.isnan(pressures).all()


@pytest.mark.parametrize("branch", [EXPANSION, COMPRESSION])
def test_travel_rounded_below_the_dead_centre__is_the_dead_centre(branch):
    assert branch_pressure(branch, -1e-17, *GAS) == branch_pressure(branch, 0.0, *GAS)


@given(st.floats(-4.0, 10.0), st.floats(-10.0, 10.0), st.sampled_from([1.0, -1.0]), st.integers(-3, 3))
def test_four_stroke_at_a_dead_centre__is_on_the_stroke_before_or_after(head_at, firing, forward, turns):
    """Whichever sign rounding gives to the rate there, and to the angle's distance from it."""
    centre = head_at + 2.0 * math.pi * turns

    def branch(apart: float, rate: float) -> float:
        return four_stroke_branch(rate, centre + forward * apart, head_at, firing, forward)

    before, after = branch(-1e-3, -1.0), branch(1e-3, 1.0)
    assert {before, after} in ({COMPRESSION, EXPANSION}, {OUTFLOW, INFLOW})
    for apart in (-1e-14, 0.0, 1e-14):
        assert branch(apart, -1e-17) == before
        assert branch(apart, 1e-17) == after
