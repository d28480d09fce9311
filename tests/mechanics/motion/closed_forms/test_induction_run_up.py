"""Run-up of induction motors against quadrature by mpmath, the textbook's formula and the equation of motion."""

import math

import mpmath
import numpy as np
import pytest
from exact import EPS, assert_within, exactly, polynomial_roots
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp

from engine.laws.motor_characteristics import induction_motor
from engine.motion.closed_forms.induction_run_up import induction_motor_over_slip, induction_motor_to_slip

NEVER = (math.nan, math.nan)

sizes = st.floats(-5.0, 5.0).map(lambda exponent: 10.0**exponent)


def kloss_reference(inertia, breakdown, slip_b, ratio, synchronous, load, start, end):
    """Time and angle by quadrature of the equation of motion, and the condition number of the time.

    The moment is written with quotients, as in the textbooks. The integrand peaks near the breakdown.
    """
    arguments = exactly(inertia, breakdown, slip_b, ratio, synchronous, load, start, end)
    i, m_b, s_b, a, w, m_l, s0, s = arguments
    peaks = sorted((p for p in (s_b, -s_b) if min(s, s0) < p < max(s, s0)), reverse=bool(s > s0))
    points = [s, *peaks, s0]

    def surplus(x):
        return m_b * (2 + a * s_b) * x / s_b / (x**2 / s_b**2 + 1 + a * x) - m_l

    with mpmath.workdps(50):
        time = mpmath.quad(lambda x: i * w / surplus(x), points)
        angle = mpmath.quad(lambda x: i * w**2 * (1 - x) / surplus(x), points)
    with mpmath.workdps(15):
        # Sensitivity to the load and to M_b at every slip, and to both ends.
        inside = mpmath.quad(lambda x: i * w * (abs(m_l) + abs(m_l + surplus(x))) / surplus(x) ** 2, points)
        ends = [abs(x * i * w / surplus(x)) for x in (s0, s)]
        return time, angle, 1 + (abs(inside) + sum(ends)) / abs(time)


loads = (
    st.floats(-3.0, 3.0)
    | st.floats(-10.0, -1.0).map(lambda exponent: 1.0 - 10.0**exponent)
    | st.floats(-16.0, -2.0).map(lambda exponent: 10.0**exponent)
    | st.floats(-16.0, -2.0).map(lambda exponent: -(10.0**exponent))
    | st.sampled_from([0.0, 1.0])
)
# Below the least, a double root of the balance parts by less than 50 digits tell.
dampings = st.just(0.0) | st.floats(1e-9, 1.9)
parts = st.floats(0.001, 0.999) | st.floats(-6.0, -0.1).map(lambda exponent: 10.0**exponent)


@settings(deadline=None, max_examples=80)
@given(st.floats(-2.0, 0.3), dampings, loads, st.integers(0, 2), parts, parts, st.booleans(), st.booleans())
def test_induction_motor_to_slip__is_the_integral_or_never(
    decade, damping, share, interval, part, other, upper, clockwise
):
    breakdown_slip, turn = 10.0**decade, -1.0 if clockwise else 1.0
    machine = (0.7, turn * 30.0, breakdown_slip, damping / breakdown_slip, turn * 157.0, turn * 30.0 * share)
    assume(abs(part - other) > 1e-3 * max(part, other))
    with mpmath.workdps(50):
        # Slips, over s_b, at which motor and load balance split the range into intervals that can't be left.
        load, d = mpf(machine[5]) / machine[1], mpf(machine[3]) * breakdown_slip
        balanced = polynomial_roots([load, load * d - (2 + d), load]) if load else [mpf(0)]
        bounds = sorted([mpf(-3), *(root for root in balanced if -3 < root < 10), mpf(10)])
        low, high = bounds[interval % (len(bounds) - 1) :][:2]
        assume(high - low > 1e-3)
        both = [high - (high - low) * p if upper else low + (high - low) * p for p in (part, other)]
        start, end = (float(breakdown_slip * x) for x in both)
    time, angle, condition = kloss_reference(*machine, start, end)
    if time < 0:
        np.testing.assert_equal(induction_motor_to_slip(*machine, start, end), NEVER)
        start, end, time, angle = end, start, -time, -angle
    got = induction_motor_to_slip(*machine, start, end)
    # Some ten roundings in what is as sensitive as the integral itself; the angle is omega_s (t - int s dt).
    assert_within(got[0], time, 20 * EPS * condition * time)
    assert_within(got[1], angle, 20 * EPS * condition * 157.0 * time * (1 + max(abs(start), abs(end))))


@settings(deadline=None, max_examples=100)
@given(sizes, st.floats(0.01, 2.0), st.floats(0.001, 2.0), st.floats(0.001, 0.999))
def test_idle_induction_motor__runs_up_by_the_textbook_formula(inertia, slip_b, start, part):
    end = start * part
    time, _ = induction_motor_to_slip(inertia, 30.0, slip_b, 0.0, 157.0, 0.0, start, end)
    # t = I omega_s/(2 M_b) ((s0² - s²)/(2 s_b) + s_b ln(s0/s)); ends that are near magnify EPS.
    textbook = (start + end) * (start - end) / (2 * slip_b) + slip_b * math.log(start / end)
    assert_allclose(time, inertia * 157.0 / 60.0 * textbook, rtol=20 * EPS / (1 - part))


def test_idle_induction_motor__starts_soonest_with_the_textbook_breakdown_slip():
    # d/ds_b of the textbook formula is 0 at s_b² = (1 - s²)/(2 ln(1/s)): 0.408 for a start to s = 0.05.
    best = math.sqrt((1 - 0.05**2) / (2 * math.log(20)))
    assert round(best, 3) == 0.408
    soonest, *others = (
        induction_motor_to_slip(1.0, 30.0, slip, 0.0, 157.0, 0.0, 1.0, 0.05)[0]
        for slip in (best, 0.99 * best, 1.01 * best)
    )
    assert soonest < min(others)


@pytest.mark.parametrize(
    ("ratio", "load", "start", "end"),
    [
        (0.0, 11.0, 1.0, 0.06),
        (4.0, 13.5, 1.0, 0.1),
        (4.0, -80.0, 0.9, -0.3),
        (4.0, 31.0, 0.02, 1.2),
        (2.0, 15.0, -0.3, 0.0),
    ],
)
def test_induction_motor_to_slip__is_the_motion_under_its_torque(ratio, load, start, end):
    time, angle = induction_motor_to_slip(0.7, 30.0, 0.2, ratio, 157.0, load, start, end)
    assert time > 0.0
    done = solve_ivp(
        lambda _, y: [(induction_motor(30.0, 0.2, ratio, 157.0, y[0]) - load) / 0.7, y[0]],
        (0.0, time),
        [157.0 * (1.0 - start), 0.0],
        method="DOP853",
        rtol=1e-12,
        atol=1e-12,
    )
    # Local errors of 1e-12 over some hundred steps.
    assert_allclose(done.y[:, -1], (157.0 * (1.0 - end), angle), rtol=1e-9)


@pytest.mark.parametrize(
    ("ratio", "load", "start", "end"),
    [
        # Stays at the slip of balance, which is not reached either; runs up from below the breakdown.
        (0.0, 15.0, 1.0, 0.02),
        (0.0, 0.0, 1.0, 0.0),
        (0.0, 0.0, 1.0, -0.1),
        (0.0, 29.0, 1.0, 0.1),
        (0.0, 29.0, 0.1, 1.0),
        (0.0, 10.0, 1.5, 0.5),
        (0.0, 10.0, 0.5, 1.5),
        (0.0, 30.0, 0.9, 0.1),
        # Between and beyond the poles of a fit with a s_b >= 2.
        (20.0, -5.0, 0.5, -0.06),
        (20.0, 0.0, -0.3, -0.5),
    ],
)
def test_slip_out_of_reach__is_never_reached(ratio, load, start, end):
    np.testing.assert_equal(induction_motor_to_slip(0.7, 30.0, 0.2, ratio, 157.0, load, start, end), NEVER)


@pytest.mark.parametrize("x", [-1.32, -1.305, -1.0, 1.0, 1.305, 1.32])
def test_lightly_loaded_induction_motor__is_the_integral_on_both_sides_of_the_series_end(x):
    # l = 1/3 and r = 0.382: r x = 0.5 at x = 1.309.
    machine = (0.7, 30.0, 0.25, 0.0, 157.0, 20.0, 0.25 * x, 0.08 if x < 0.0 else 0.12)
    # The tails' differences lose a factor of 20, ends and load some ten.
    assert_allclose(induction_motor_to_slip(*machine), [float(x) for x in kloss_reference(*machine)[:2]], rtol=2e-14)


def test_load_a_trace_above_the_breakdown__is_known_by_their_difference():
    machine = (0.7, 30.0, 0.2, 2.0, 157.0, 30.0 + 2.0**-40, 0.15, 0.3)
    # The difference is exact; as 1 - M_L/M_b it would be right to 2^-8 only.
    assert_allclose(induction_motor_to_slip(*machine), [float(x) for x in kloss_reference(*machine)[:2]], rtol=50 * EPS)


def test_no_change_of_slip__takes_no_time():
    assert induction_motor_to_slip(0.7, 30.0, 0.2, 1.0, 157.0, 15.0, 0.5, 0.5) == (0.0, 0.0)


def test_unknown_number_of_the_induction_motor__gives_nan():
    arguments = [0.7, 30.0, 0.2, 1.0, 157.0, 5.0, 1.0, 0.5]
    for place in range(len(arguments)):
        unknown = [math.nan if k == place else number for k, number in enumerate(arguments)]
        np.testing.assert_equal(induction_motor_to_slip(*unknown), NEVER)


# Torque over the slip


@settings(deadline=None, max_examples=80)
@given(
    st.floats(0.01, 2.0),
    st.floats(0.0, 5.0) | st.sampled_from([0.0, 2.0, 2.0 - 1e-9, 2.0 + 1e-9]),
    st.floats(0.0, 10.0),
    st.floats(0.0, 10.0),
)
def test_induction_motor_over_slip__is_the_integral_of_its_torque(slip_b, damping, start, end):
    assume(abs(start - end) > 1e-3)
    constants = (30.0, slip_b, damping / slip_b)
    got = induction_motor_over_slip(*constants, slip_b * start, slip_b * end)
    with mpmath.workdps(30):
        m, b, a, s0, s = exactly(*constants, slip_b * start, slip_b * end)
        c = a * b
        points = [s, *([b] if min(s, s0) < b < max(s, s0) else []), s0]
        integral = mpmath.quad(lambda x: m * (2 + c) / (x / b + b / x + c) if x else mpf(0), points)
        # The logarithm and the arc tangent cancel where the slips are small; ends known to EPS.
        arc = mpmath.quad(lambda x: m * (2 + c) * c / 2 / ((x / b) ** 2 + 1 + c * x / b), points)
        ends = m * (abs(s0) + abs(s))
        assert_within(got, integral, EPS * (10 * ends + 20 * (abs(integral) + 2 * abs(arc))))


def test_idle_induction_motor_over_slip__is_the_textbook_logarithm():
    # a = 0: M_b s_b ln((s0² + s_b²)/(s² + s_b²)).
    expected = 30.0 * 0.2 * math.log((1.0 + 0.04) / (0.01 + 0.04))
    assert_allclose(induction_motor_over_slip(30.0, 0.2, 0.0, 1.0, 0.1), expected, rtol=10 * EPS)
    assert_allclose(induction_motor_over_slip(30.0, 0.2, 0.0, 0.1, -1.0), -expected, rtol=10 * EPS)
    assert math.isnan(induction_motor_over_slip(30.0, 0.2, 15.0, 0.1, -1.0))
