"""Indicator diagrams against the closed-form work of their cycles and the efficiency of the Otto cycle."""

import math
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import quad

from engine.laws.indicator_diagrams import four_stroke_engine, polytropic_compressor, pump, two_stroke_engine

EPS = np.finfo(float).eps
STROKE = 0.08
ATMOSPHERE = 101325.0

clearances = st.floats(0.01, 0.3)
exponents = st.floats(1.05, 1.67)


def work(pressure, *corners):
    """Integral of p over the travel per unit of piston area, from piece to smooth piece of the diagram."""
    ends = [0.0, *sorted(corner for corner in corners if 0.0 < corner < STROKE), STROKE]
    # Gauss-Kronrod on a smooth power law: 1e-12 is reached without subdivision trouble.
    return sum(quad(pressure, low, high, epsabs=0.0, epsrel=1e-12)[0] for low, high in pairwise(ends))


@settings(deadline=None, max_examples=30)
@given(clearances, st.floats(1.5, 8.0), exponents, exponents)
def test_compressor_cycle__takes_the_work_of_the_closed_form(clearance, ratio, n, m):
    suction, discharge = ATMOSPHERE, ratio * ATMOSPHERE
    least, most = clearance * STROKE, (1.0 + clearance) * STROKE
    delivery, opening = most * ratio ** (-1.0 / n), least * ratio ** (1.0 / m)
    if delivery <= least or opening >= most:
        return

    def pressure(travel, toward_head):
        return polytropic_compressor(travel, STROKE, clearance, toward_head, suction, discharge, n, m)

    got = work(lambda x: pressure(x, True), delivery - least) - work(lambda x: pressure(x, False), opening - least)
    # W = n/(n-1) p_s V_1 (r^((n-1)/n) - 1) - m/(m-1) p_s V_4 (r^((m-1)/m) - 1), V_4 = V_min r^(1/m).
    expected = suction * (
        n / (n - 1.0) * most * (ratio ** ((n - 1.0) / n) - 1.0)
        - m / (m - 1.0) * opening * (ratio ** ((m - 1.0) / m) - 1.0)
    )
    # The two strokes are each of size discharge * most and good to 1e-12; the corners are rounded in quad.
    assert_allclose(got, expected, rtol=0, atol=1e-11 * discharge * most)


def test_compressor_without_clearance__takes_in_the_whole_stroke():
    # W = n/(n-1) p_s V_s (r^((n-1)/n) - 1), also with the piston at the head itself.
    n, ratio = 1.3, 4.0
    pressures = [
        polytropic_compressor(x, STROKE, 0.0, toward, 1e5, 4e5, n, n) for x in (0.0, -1e-18) for toward in (True, False)
    ]
    assert pressures == [4e5, 1e5, 4e5, 1e5]
    got = work(
        lambda x: polytropic_compressor(x, STROKE, 0.0, True, 1e5, 4e5, n, n), STROKE * ratio ** (-1 / n)
    ) - work(lambda x: polytropic_compressor(x, STROKE, 0.0, False, 1e5, 4e5, n, n))
    assert_allclose(got, n / (n - 1) * 1e5 * STROKE * (ratio ** ((n - 1) / n) - 1), rtol=1e-11)


@settings(deadline=None, max_examples=60)
@given(clearances, st.floats(1.01, 50.0), exponents, exponents, st.floats(0.0, 1.0), st.booleans())
def test_compressor__stays_between_its_lines(clearance, ratio, n, m, fraction, toward_head):
    pressure = polytropic_compressor(
        fraction * STROKE, STROKE, clearance, toward_head, ATMOSPHERE, ratio * ATMOSPHERE, n, m
    )
    # travel + clearance of a full stroke may round an ulp above V_max, hence p an ulp or two below suction.
    assert ATMOSPHERE * (1 - 8 * EPS) <= pressure <= ratio * ATMOSPHERE


def test_compressor_that_never_delivers__gives_its_work_back():
    # 1 + 1/c = 3, 3^1.3 = 4.17 < 6: both strokes follow the same polytrope, so the cycle takes no work.
    def pressure(travel, toward_head):
        return polytropic_compressor(travel, STROKE, 0.5, toward_head, 1e5, 6e5, 1.3, 1.3)

    for travel in np.linspace(0.0, STROKE, 9):
        assert_allclose(pressure(travel, False), pressure(travel, True), rtol=20 * EPS)


def test_compressor_dead_centres__have_the_value_of_their_stroke():
    def at(travel, toward_head):
        return polytropic_compressor(travel, STROKE, 0.05, toward_head, 1e5, 4e5, 1.3, 1.2)

    # pow of a ratio of exactly 1 is exact; (travel + c s)/(s + c s) may be an ulp off 1.
    assert_allclose([at(STROKE, True), at(STROKE, False)], [1e5, 1e5], rtol=8 * EPS)
    assert [at(0.0, True), at(0.0, False)] == [4e5, 4e5]


def test_pump__has_the_rectangular_diagram():
    assert pump(True, 0.6e5, 9e5) == 9e5
    assert pump(False, 0.6e5, 9e5) == 0.6e5


@settings(deadline=None, max_examples=30)
@given(st.floats(1.0 / 14.0, 0.3), st.floats(1.2, 4.0), exponents)
def test_otto_cycle__has_the_efficiency_of_its_compression(clearance, explosion, n):
    compressed = ATMOSPHERE * (1.0 + 1.0 / clearance) ** n
    peak = explosion * compressed

    def net(*strokes):
        return sum(
            sign
            * work(
                lambda x, number=number: four_stroke_engine(
                    x, STROKE, clearance, number, ATMOSPHERE, ATMOSPHERE, peak, n, n
                )
            )
            for number, sign in strokes
        )

    # eta = 1 - (compression ratio)^(1 - gamma); the heat at constant volume is V_min (p3 - p2)/(gamma - 1).
    heat = clearance * STROKE * (peak - compressed) / (n - 1.0)
    efficiency = 1.0 - (1.0 + 1.0 / clearance) ** (1.0 - n)
    got = net((0, 1), (1, -1), (2, 1), (3, -1))
    # Each stroke is good to 1e-12 of at most peak * V_min/(n - 1); explosion - 1 and the efficiency divide
    # that by 0.2 * 0.07.
    assert_allclose(got, efficiency * heat, rtol=1e-9)


def test_gas_exchange__takes_the_pumping_work():
    # (exhaust - intake) * swept volume: constants integrate exactly.
    args = (STROKE, 0.12)
    pressures = (0.4e5, 1.1e5, 50e5, 1.3, 1.3)
    got = work(lambda x: four_stroke_engine(x, *args, 2, *pressures)) - work(
        lambda x: four_stroke_engine(x, *args, 1, *pressures)
    )
    assert_allclose(got, -0.7e5 * STROKE, rtol=1e-12)


def test_four_stroke_dead_centres__have_the_value_of_their_stroke():
    at = [four_stroke_engine(0.0, STROKE, 0.125, number, 1e5, 1.2e5, 60e5, 1.35, 1.25) for number in range(4)]
    # (V_max/V_min)^n = 9^1.35; V_max/V_min carries two roundings, pow one.
    assert_allclose(at, [60e5, 1.2e5, 1e5, 1e5 * 9.0**1.35], rtol=8 * EPS)


@settings(deadline=None, max_examples=30)
@given(clearances, exponents, st.floats(0.5, 0.95))
def test_two_stroke_cycle__has_the_otto_efficiency_of_its_closed_part(clearance, n, port):
    ratio = (port + clearance) / clearance
    compressed = ATMOSPHERE * ratio**n
    peak = 3.0 * compressed

    def pressure(x, number):
        return two_stroke_engine(x, STROKE, clearance, number, ATMOSPHERE, ATMOSPHERE, peak, n, n, port)

    corner = port * STROKE
    got = work(lambda x: pressure(x, 0), corner) - work(lambda x: pressure(x, 1), corner)
    heat = clearance * STROKE * (peak - compressed) / (n - 1.0)
    # As for the Otto cycle; the port's corner is rounded in the same way here and in the function.
    assert_allclose(got, (1.0 - ratio ** (1.0 - n)) * heat, rtol=1e-9)


def test_two_stroke_ports__are_open_beyond_their_edge():
    def at(travel, number):
        return two_stroke_engine(travel, 0.5, 0.125, number, 1.5e5, 1e5, 40e5, 1.3, 1.3, 0.75)

    # 0.375 = 0.75 * 0.5 exactly: (V_port/V)^n is 1 there.
    assert at(np.nextafter(0.375, 1.0), 0) == 1e5
    assert at(np.nextafter(0.375, 1.0), 1) == 1e5
    assert at(0.375, 1) == 1.5e5
    assert_allclose(at(0.375, 0), 40e5 * (1.0 / 7.0) ** 1.3, rtol=8 * EPS)
    assert at(0.0, 0) == 40e5


@pytest.mark.parametrize("toward_head", [True, False])
@pytest.mark.parametrize("clearance", [0.0, 0.1])
def test_unknown_travel__gives_nan(toward_head, clearance):
    pressure = polytropic_compressor(math.nan, STROKE, clearance, toward_head, 1e5, 4e5, 1.3, 1.2)
    assert math.isnan(pressure)
    assert math.isnan(four_stroke_engine(math.nan, STROKE, 0.1, 3, 1e5, 1e5, 4e5, 1.3, 1.2))
    assert math.isnan(two_stroke_engine(math.nan, STROKE, 0.1, 0, 1e5, 1e5, 4e5, 1.3, 1.2, 0.7))
