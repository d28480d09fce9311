"""Motors against the equivalent circuit, mpmath's solution of the nameplate equations and energy."""

import math
from itertools import pairwise

import mpmath
import numpy as np
import pytest
from each_case import refusals
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from pydantic import TypeAdapter

from engine.graph.nodes import Graph, Stage
from engine.graph.over_arrays import NodesOverArrays
from engine.laws.motor_characteristics import (
    BY_SPEED,
    dc_motor_from_nameplate,
    induction_motor,
    induction_motor_curvature,
    induction_motor_slope,
    kloss_from_nameplate,
    nameplate_trouble,
)
from engine.parts.actions import MomentAction
from engine.parts.motors import MotorCurve

EPS = np.finfo(float).eps
SYNCHRONOUS = 157.07963267948966


def circuit_torque(stator, rotor, reactance, slip):
    """Torque of the equivalent circuit with the magnetising branch left out, per (phases V^2/omega_s)."""
    return (rotor / slip) / ((stator + rotor / slip) ** 2 + reactance**2)


@settings(max_examples=50)
@given(st.floats(0.01, 0.5), st.floats(0.0, 3.0), st.floats(-0.9, 1.5))
def test_induction_motor__slope_and_curvature_are_the_derivatives_of_kloss_formula(breakdown_slip, ratio, turn):
    with mpmath.workdps(50):
        own = [mpmath.mpf(x) for x in (300.0, breakdown_slip, ratio, SYNCHRONOUS)]

        def torque(omega):
            most, critical, share, synchronous = own
            slip = 1 - omega / synchronous
            return most * (2 + share * critical) / (slip / critical + critical / slip + share * critical)

        omega = turn * SYNCHRONOUS
        # Kloss's quotients need a slip.
        assume(abs(1.0 - turn) > 1e-3)
        # Beyond the synchronous speed the denominator may vanish; near that neither derivative is known to bits.
        slip = 1.0 - turn
        whole = slip**2 + breakdown_slip**2 + ratio * breakdown_slip**2 * slip
        parts = slip**2 + breakdown_slip**2 + ratio * breakdown_slip**2 * abs(slip)
        assume(whole > 0.1 * parts)
        for order, law in ((1, induction_motor_slope), (2, induction_motor_curvature)):
            exact = float(mpmath.diff(torque, omega, order))
            # The slip loses what the speed is greater than it; each power of the denominator passes that on.
            room = 100 * EPS * 300.0 * (parts / whole) ** 3 / (breakdown_slip * SYNCHRONOUS) ** order / breakdown_slip
            assert abs(law(300.0, breakdown_slip, ratio, SYNCHRONOUS, omega) - exact) <= room + 1e-13 * abs(exact)


@settings(max_examples=50)
@given(
    st.floats(0.0, 3.0), st.floats(0.01, 3.0), st.floats(0.1, 3.0), st.floats(-3.0, 3.0).filter(lambda s: abs(s) > 1e-6)
)
def test_kloss__is_the_equivalent_circuit(stator, rotor, reactance, slip):
    omega = SYNCHRONOUS * (1.0 - slip)
    with mpmath.workdps(50):
        r1, r2, x = map(mpmath.mpf, (stator, rotor, reactance))
        impedance = mpmath.sqrt(r1**2 + x**2)
        breakdown = float(1 / (2 * (r1 + impedance)))
        breakdown_slip = float(r2 / impedance)
        exact_slip = (mpmath.mpf(SYNCHRONOUS) - mpmath.mpf(omega)) / mpmath.mpf(SYNCHRONOUS)
        expected = float(circuit_torque(r1, r2, x, exact_slip))
    torque = induction_motor(breakdown, breakdown_slip, 2.0 * stator / rotor, SYNCHRONOUS, omega)
    # Generating, (R1 + R2/s)^2 cancels against X^2 at worst as (R1/X)^2 < 900, a s_b stays below 2; some ten
    # roundings of EPS enter each term of the denominator.
    assert_allclose(torque, expected, rtol=20 * 900 * EPS)


def test_kloss_between_its_poles__is_nan_not_a_driving_generator():
    # a s_b = 4: poles where s^2 + 4 s_b s + s_b^2 = 0, s = -s_b (2 -+ sqrt 3) = -0.0536 and -0.746.
    torque = [induction_motor(1.0, 0.2, 20.0, 1.0, 1.0 - s) for s in (-0.05, -0.06, -0.74, -0.75)]
    assert torque[0] < 0.0
    assert np.isnan(torque[1:3]).all()
    assert torque[3] < 0.0
    assert induction_motor(300.0, 0.1, 0.5, SYNCHRONOUS, SYNCHRONOUS) == 0.0


def curve_of(motor: dict) -> MotorCurve:
    made = TypeAdapter(MomentAction).validate_python({"on": "crank"} | motor)
    return made.curve("m", {f"m.{key}": value for key, value in made.model_dump().items()})


def torque_of(motor: dict, speed: float) -> float:
    return curve_of(motor).moment(speed)


def test_dc_motor__does_the_power_of_its_line():
    # M = M0 (1 - w/w0) has its greatest power M0 w0/4 at half speed; halves and quarters are exact.
    motor = {"type": "dc_motor", "stall_moment": 8.0, "no_load_speed": 64.0}
    assert torque_of(motor, 32.0) * 32.0 == 8.0 * 64.0 / 4
    assert [torque_of(motor, speed) for speed in (0.0, 64.0, 80.0)] == [8.0, 0.0, -2.0]


@pytest.mark.parametrize("law", BY_SPEED, ids=lambda law: law.__name__)
def test_slope_of_a_motor__is_the_difference_quotient_by_the_speed(law):
    every = {4: (300.0, 0.1, 0.5, SYNCHRONOUS), 2: (8.0, -0.5), 5: (8.0, -0.5, 10.0, 0.0, 50.0)}
    constants = every[law.py_func.__code__.co_argcount - 1]
    speed, h = np.array([-40.0, 30.0, 90.0, 200.0]), 1e-3
    rise = (law(*constants, speed + h) - law(*constants, speed - h)) / (2 * h)
    slope = np.zeros(4) if BY_SPEED[law] is None else BY_SPEED[law](*constants, speed)
    assert_allclose(slope, rise, rtol=1e-6, atol=1e-9)


def test_motor_by_a_table__goes_through_its_rows_and_on():
    motor = {"type": "table_motor", "speed": [0, 8, 16, 24], "moment": [10, 6, 12, 0], "scale": 2.0}
    speeds = np.array([-8.0, 0.0, 4.0, 8.0, 12.0, 16.0, 20.0, 24.0, 32.0])
    # Straight lines, the outermost going on; halves and quarters are exact.
    expected = [28.0, 20.0, 16.0, 12.0, 18.0, 24.0, 12.0, 0.0, -24.0]
    assert [torque_of(motor, speed) for speed in speeds] == expected


@pytest.mark.parametrize("width", [1.0, 1e-6, 2e-9])
def test_motor_by_a_table__is_exact_beside_a_steep_fall(width):
    motor = {"type": "table_motor", "speed": [0, 8, 8 + width, 24], "moment": [10, 10, 6, 0]}
    expected = 6.0 * (24.0 - 16.0) / (16.0 - width)
    assert_allclose([torque_of(motor, speed) for speed in (4.0, 16.0)], [10.0, expected], rtol=8 * EPS)


@pytest.mark.parametrize(
    ("moment", "no_load"),
    [([10, 12, 6], 6.0), ([10, 12, -4], 3.5), ([10, 0, -1], 2.0), ([10, 0, 0], 2.0), ([-1, 4, -12], 2.5)],
)
def test_motor_by_a_table__does_not_drive_above_its_no_load_speed(moment, no_load):
    motor = {"type": "table_motor", "on": "crank", "speed": [0, 2, 4], "moment": moment}
    assert TypeAdapter(MomentAction).validate_python(motor).no_load_speed == no_load


@pytest.mark.parametrize(
    "motor",
    [
        {"type": "dc_motor", "stall_moment": 8.0, "no_load_speed": 64.0},
        {"type": "induction_motor", "synchronous_speed": 64.0, "breakdown_moment": 9.0, "breakdown_slip": 0.2},
        {"type": "table_motor", "speed": [0, 8, 16, 24], "moment": [10, 6, 12, 0], "scale": 2.0},
    ],
    ids=lambda motor: motor["type"],
)
def test_curve_of_nodes__is_that_of_numbers(motor):
    curve, graph, speeds = curve_of(motor), Graph(), np.linspace(-10.0, 80.0, 91)
    nodes = MotorCurve.of_nodes(curve.laws, lambda label, law, index: graph.given(label, Stage.VARIANT))
    speed = graph.given("speed", Stage.VARIANT)
    rows = [*(value for own in curve.constants for value in own), speeds]
    given = [*(node for own in nodes.constants for node in own), speed]
    found = NodesOverArrays(given, [nodes.moment(speed)])(np.array(np.broadcast_arrays(*rows), float))[0]
    assert_allclose(found, curve.moment(speeds), rtol=10 * EPS, atol=10 * EPS * np.abs(found).max())
    # Between its peaks a torque rises or falls throughout.
    for low, high in pairwise([-10.0, *sorted(peak for peak in curve.peaks if -10.0 < peak < 80.0), 80.0]):
        change = np.diff(curve.moment(np.linspace(low, high, 50)))
        assert (change >= 0.0).all() or (change <= 0.0).all()


TABLE_MOTOR = {"type": "table_motor", "on": "crank", "speed": [0, 2, 4], "moment": [3, 4, 0]}
test_motor_by_a_table_that_is_none__is_refused = refusals(
    lambda change: TypeAdapter(MomentAction).validate_python(TABLE_MOTOR | change),
    ({"moment": [1, 2, 2]}, "the last rows must fall"),
    ({"moment": [1, -2, -1]}, "the last rows must fall"),
    ({"moment": [0, -2, -3]}, "no row is above 0"),
    ({"speed": [0, 2, 2]}, "every row must lie above the one before"),
    ({"speed": [0, 2]}, "one moment for every speed"),
    ({"scale": 0.0}, "greater than 0"),
)


@settings(max_examples=40)
@given(st.floats(1.0, 1e6), st.floats(1.0, 1e4), st.floats(1e-3, 0.9), st.sampled_from([1.0, -1.0]))
def test_dc_nameplate__runs_through_the_rated_point(power, rated, droop, turn):
    no_load = rated / (1.0 - droop)
    stall = dc_motor_from_nameplate(power, turn * rated, turn * no_load)
    # The same difference of speeds enters both ways; ten roundings remain.
    assert_allclose(float(stall) * (no_load - rated) / no_load * turn * rated, power, rtol=10 * EPS)


def test_dc_nameplate__is_nan_where_it_is_no_motor():
    stall = dc_motor_from_nameplate([1e3, -1.0, 1e3, 1e3, 1e3], [100.0, 100.0, 120.0, 110.0, -5.0], 110.0)
    np.testing.assert_array_equal(np.isnan(stall), [False, True, True, True, True])


slips = st.floats(0.002, 0.15)
ratios = st.floats(1.2, 5.0)


@settings(max_examples=40)
@given(slips, ratios, st.sampled_from([1.0, -1.0]))
def test_simple_nameplate__runs_through_the_rated_point(rated_slip, most, turn):
    rated = turn * SYNCHRONOUS * (1.0 - rated_slip)
    constants = kloss_from_nameplate(7500.0, rated, turn * SYNCHRONOUS, most)
    torque = induction_motor(*map(float, constants), turn * SYNCHRONOUS, rated)
    assert_allclose(torque, 7500.0 / rated, rtol=50 * EPS)
    assert_allclose(constants[0], most * 7500.0 / rated, rtol=4 * EPS)
    assert constants[1] > rated_slip * (1 - 1e-12)
    assert nameplate_trouble(7500.0, rated, turn * SYNCHRONOUS, most) is None


@settings(max_examples=50)
@given(slips, ratios, st.floats(0.001, 0.999))
def test_nameplate_with_start__runs_through_rated_and_starting_point(rated_slip, most, part):
    rated = SYNCHRONOUS * (1.0 - rated_slip)
    simple = rated_slip * (most + math.sqrt(most**2 - 1.0))
    assume(simple < 0.95)
    least = 2.0 * most / (simple + 1.0 / simple)
    start = least + part * (most - least)
    breakdown, slip, ratio = map(float, kloss_from_nameplate(7500.0, rated, SYNCHRONOUS, most, start))
    assert rated_slip < slip < 1.0
    assert ratio >= 0.0
    # a s_b follows from s_b by the rated point's equation, so that point holds to the rounding of its terms,
    # and the starting point to that of the root: some ten EPS (worst of 400 000 nameplates: 2e-15).
    assert_allclose(induction_motor(breakdown, slip, ratio, SYNCHRONOUS, rated), 7500.0 / rated, rtol=50 * EPS)
    assert_allclose(induction_motor(breakdown, slip, ratio, SYNCHRONOUS, 0.0), start * 7500.0 / rated, rtol=50 * EPS)


TROUBLES = [
    ((-5.0, 150.0, 157.0, 2.5, None), "power = -5 W"),
    ((7500.0, 160.0, 157.0, 2.5, None), "rated_speed = 1527.9 rpm"),
    ((7500.0, 0.0, 157.0, 2.5, None), "rated_speed = 0 rpm"),
    ((7500.0, 150.0, 0.0, 2.5, None), "synchronous speed (0 rpm)"),
    ((7500.0, 150.0, 157.0, 1.0, None), "breakdown_ratio = 1.0"),
    ((7500.0, 150.0, 157.0, math.nan, None), "breakdown_ratio = nan"),
    ((7500.0, 150.0, 157.0, 2.5, 2.5), "starting_ratio = 2.5: the starting torque is below"),
    ((7500.0, 150.0, 157.0, 2.5, 0.3), "starting_ratio = 0.3: with this slip"),
    ((7500.0, 100.0, 157.0, 3.0, 1.5), "at or below standstill"),
]


@pytest.mark.parametrize(("nameplate", "text"), TROUBLES)
def test_impossible_nameplate__is_nan_and_says_why(nameplate, text):
    assert np.isnan(kloss_from_nameplate(*nameplate)).all()
    assert text in nameplate_trouble(*nameplate)


@settings(max_examples=60)
@given(
    st.floats(-1.0, 1e4),
    st.floats(-10.0, 200.0),
    st.floats(-10.0, 200.0),
    st.floats(0.5, 5.0),
    st.none() | st.floats(0.0, 6.0),
)
def test_trouble__is_told_exactly_where_the_answer_is_nan(power, rated, synchronous, most, start):
    constants = np.array(kloss_from_nameplate(power, rated, synchronous, most, start))
    trouble = nameplate_trouble(power, rated, synchronous, most, start)
    assert np.isnan(constants).all() == (trouble is not None)
    assert np.isnan(constants).any() == (trouble is not None)
