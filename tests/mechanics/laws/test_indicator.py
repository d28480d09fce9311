"""Indicator diagrams, branch by branch: the pressure along each, and what ends it."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numba import njit
from numpy.testing import assert_allclose
from packed import assert_packed

from engine.compiling.tiles import TILE_OPTIONS
from engine.laws.indicator_diagrams import (
    COMPRESSION,
    EXPANSION,
    INFLOW,
    OUTFLOW,
    branch_pressure,
    compressor_branch,
    compressor_opening_travels,
    compressor_peak,
    four_stroke_branch,
    line_pressure,
    pump_branch,
    two_stroke_branch,
)

EPS = np.finfo(float).eps
STROKE = 0.08
ATMOSPHERE = 101325.0
# Cylinder, pressures and exponents.
GAS = (STROKE, 0.1, 0.8), (1e5, 4e5, 50e5), (1.35, 1.25)

clearances = st.floats(0.01, 0.3)
exponents = st.floats(1.05, 1.67)


# Branches, and the pressure along them

shares = st.one_of(st.floats(0.0, 1.0), st.sampled_from([0.0, 1.0]))
# A power of a ratio that is rounded twice: so many eps of the exponent, and of the products with it. Clearance and
# stroke enter V_max, V_min and V once each.
ROUNDINGS = 16 * EPS


@settings(deadline=None, max_examples=100)
@given(st.floats(1e-3, 3.0), st.floats(1.01, 50.0), exponents, exponents)
def test_valves__open_where_the_polytropes_reach_the_lines(clearance, ratio, n, m):
    suction, discharge = ATMOSPHERE, ratio * ATMOSPHERE
    discharge_opens, suction_opens = compressor_opening_travels(clearance, suction, discharge, n, m)
    peak = compressor_peak(clearance, suction, discharge, n)
    if discharge_opens > 0.0:
        assert peak == discharge
        compressed = suction * ((1.0 + clearance) / (discharge_opens + clearance)) ** n
        # The travel is a difference of terms of about 1 + c, with a rounding each.
        assert_allclose(compressed, discharge, rtol=16 * EPS * (1.0 + clearance) / (discharge_opens + clearance))
    else:
        assert peak <= discharge
    expanded = peak * (clearance / (suction_opens + clearance)) ** m
    assert_allclose(expanded, suction, rtol=32 * EPS)


@pytest.mark.parametrize("missed", [-1e-9, 0.0, 1e-9])
@pytest.mark.parametrize("way", [1.0, -1.0])
def test_firing_angle_within_rounding_of_a_dead_centre__is_that_one(missed, way):
    # Just after it the piston leaves the head, whichever way the crank turns.
    assert four_stroke_branch(1.0, 0.3 + way * 0.1, 0.3, 0.3 + missed, way) == EXPANSION


@pytest.mark.parametrize(("rate", "closed"), [(-1.0, COMPRESSION), (1.0, EXPANSION)])
def test_ports__are_open_beyond_their_place(rate, closed):
    place = 0.8 * STROKE
    branches = [two_stroke_branch(travel, STROKE, rate, 0.8) for travel in (place, np.nextafter(place, 1.0))]
    assert branches == [closed, OUTFLOW]


@pytest.mark.parametrize("branch", [EXPANSION, OUTFLOW, INFLOW, COMPRESSION])
def test_branch__goes_on_beyond_its_ends(branch):
    # Along the whole stroke the pressure is a polytrope, or constant: p V^n is.
    travels = np.linspace(0.0, STROKE, 9)
    pressure = np.array([branch_pressure(branch, x, *GAS) for x in travels])
    exponent = {EXPANSION: 1.25, COMPRESSION: 1.35}.get(branch, 0.0)
    constant = pressure * (travels + 0.1 * STROKE) ** exponent
    assert_allclose(constant, constant[0], rtol=ROUNDINGS)
    start = {EXPANSION: 50e5, OUTFLOW: 4e5, INFLOW: 1e5, COMPRESSION: 1e5 * 9.0**1.35}[branch]
    assert_allclose(pressure[0], start, rtol=ROUNDINGS)


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


def test_a_loop_over_positions_of_all_branches__is_compiled_to_packed_instructions():
    cylinder, pressures, exponents = GAS

    @njit(**TILE_OPTIONS)
    def loop(branch, travel, out):
        for i in range(travel.size):
            out[i] = branch_pressure(branch[i], travel[i], cylinder, pressures, exponents)

    branch, travel = np.arange(37.0) % 4.0, np.linspace(0.0, STROKE, 37)
    out = np.empty(37)
    loop(branch, travel, out)
    alone = [branch_pressure(b, x, *GAS) for b, x in zip(branch, travel, strict=True)]
    # Sums of products may be fused in one of the two.
    assert_allclose(out, alone, rtol=ROUNDINGS)
    assert_packed(loop, 1)


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
