"""Closed forms of motion against mpmath: the textbooks' formulas, quadrature and the equation of motion itself."""

import math

import mpmath
import numpy as np
import pytest
from exact import EPS, assert_within, exactly, polynomial_roots
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose

from engine.motion.closed_forms.closed_forms import (
    constant_moment,
    constant_moment_to_angle,
    constant_moment_to_speed,
    linear_moment,
    linear_moment_squares,
    linear_moment_to_speed,
    quadratic_moment,
    quadratic_moment_to_speed,
)

NEVER = (math.nan, math.nan)

sizes = st.floats(-5.0, 5.0).map(lambda exponent: 10.0**exponent)
zero_or_sizes = st.just(0.0) | sizes
numbers = st.builds(lambda size, sign: size * sign, zero_or_sizes, st.sampled_from([1.0, -1.0]))


# Constant moment


def test_block_brake_example__stops_after_fifty_seconds():
    time, angle = constant_moment_to_speed(0.4, -0.8, 100.0, 0.0)
    assert (time, angle) == (50.0, 2500.0)
    assert round(angle / (2 * math.pi)) == 398
    assert constant_moment(0.4, -0.8, 100.0, 50.0) == (0.0, 2500.0)
    assert constant_moment_to_angle(0.4, -0.8, 100.0, 2500.0) == (50.0, 0.0)


@settings(deadline=None, max_examples=100)
@given(sizes, numbers, numbers, zero_or_sizes)
def test_constant_moment__is_the_parabola(inertia, moment, omega0, t):
    omega, phi = constant_moment(inertia, moment, omega0, t)
    with mpmath.workdps(50):
        i, m, w, time = exactly(inertia, moment, omega0, t)
        # Six roundings at most, of terms that may cancel.
        assert_within(omega, w + m / i * time, 6 * EPS * (abs(w) + abs(m) / i * time))
        assert_within(phi, w * time + m / i * time**2 / 2, 6 * EPS * (abs(w) * time + abs(m) / i * time**2))


@settings(deadline=None, max_examples=100)
@given(sizes, numbers, numbers, numbers)
def test_constant_moment_to_speed__is_the_quotient_or_never(inertia, moment, omega0, omega):
    got = constant_moment_to_speed(inertia, moment, omega0, omega)
    if (omega - omega0) * moment <= 0.0 and omega != omega0:
        np.testing.assert_equal(got, NEVER)
        return
    with mpmath.workdps(50):
        i, m, w0, w = exactly(inertia, moment, omega0, omega)
        time = i * (w - w0) / m if w != w0 else mpf(0)
        # One rounding in each of the difference, the sum and at most six products and quotients.
        assert_within(got[0], time, 8 * EPS * time)
        assert_within(got[1], time * (w + w0) / 2, 8 * EPS * abs(time * (w + w0) / 2))


@settings(deadline=None, max_examples=200)
@given(sizes, numbers, numbers, numbers.filter(bool))
def test_constant_moment_to_angle__is_the_first_root_ahead(inertia, moment, omega0, angle):
    got = constant_moment_to_angle(inertia, moment, omega0, angle)
    with mpmath.workdps(50):
        i, m, w, phi = exactly(inertia, moment, omega0, angle)
        terms = [w**2, 2 * m * phi / i]
        square = sum(terms)
        lost = float(sum(map(abs, terms)) / abs(square)) if square else math.inf
        assume(lost < 1e12 or not any(terms))
        halves = [m / i / 2, w, -phi]
        ahead = [root for root in polynomial_roots(halves) if root > 0]
        if not ahead:
            np.testing.assert_equal(got, NEVER)
            return
        # The square of the speed is right to some EPS of its terms, which may cancel.
        assert_within(got[0], min(ahead), 10 * EPS * lost * min(ahead))
        assert_within(got[1], w + m / i * min(ahead), 10 * EPS * lost * mpmath.sqrt(square))


def test_no_angle__takes_no_time():
    assert constant_moment_to_angle(1.0, 5.0, -3.0, 0.0) == (0.0, -3.0)


def ode(moment, inertia, omega0, t):
    """Speed and angle by Taylor series of the equation of motion at 30 digits."""
    with mpmath.workdps(30):
        i = mpf(inertia)
        solution = mpmath.odefun(lambda time, y: [moment(time, y[0]) / i, y[0]], 0, [mpf(omega0), mpf(0)])
        return [float(value) for value in solution(mpf(t))]


# Moment that falls with the speed


@pytest.mark.parametrize(
    ("m0", "m1", "omega0", "t"),
    [(4.0, 0.5, 0.0, 1.5), (-4.0, 0.5, 20.0, 0.4), (4.0, -0.5, 1.0, 2.0), (4.0, 1e-9, 3.0, 1.0), (0.0, 2.0, 9.0, 1.0)],
)
def test_linear_moment__is_the_ode(m0, m1, omega0, t):
    exact = ode(lambda _, w: mpf(m0) - mpf(m1) * w, 0.6, omega0, t)
    # x = m1 t/I <= 3.4 and terms that cancel to a third at most: some ten EPS.
    assert_allclose(linear_moment(0.6, m0, m1, omega0, t), exact, rtol=50 * EPS)


def linear_terms(inertia, m0, m1, omega0, t):
    """The four terms of speed and angle at many digits, as the textbooks write them."""
    i, a, b, w, time = exactly(inertia, m0, m1, omega0, t)
    if b == 0 or time == 0:
        return w, a * time / i, w * time, a * time**2 / i / 2
    x = b * time / i
    fall = 1 - mpmath.exp(-x)
    return w * mpmath.exp(-x), a / b * fall, w * i / b * fall, a / b * (time - i / b * fall)


@settings(deadline=None, max_examples=200)
@given(sizes, numbers, st.floats(-300.0, 600.0) | numbers, numbers, sizes)
def test_linear_moment__is_the_exponential(inertia, m0, x, omega0, t):
    # Below 1e-30 the textbooks' formula runs out of its 100 digits.
    assume(-300.0 < x < 600.0 and (abs(x) > 1e-30 or x == 0.0))
    m1 = x * inertia / t
    got = linear_moment(inertia, m0, m1, omega0, t)
    with mpmath.workdps(100):
        terms = linear_terms(inertia, m0, m1, omega0, t)
        # x has three roundings, which the exponential magnifies by x; ten more in the rest.
        part = EPS * (10 + 4 * abs(x))
        assert_within(got[0], terms[0] + terms[1], part * (abs(terms[0]) + abs(terms[1])))
        assert_within(got[1], terms[2] + terms[3], part * (abs(terms[2]) + abs(terms[3])))


@settings(deadline=None, max_examples=200)
@given(sizes, numbers, numbers, numbers, numbers)
def test_linear_moment_to_speed__is_the_logarithm_or_never(inertia, m0, m1, omega0, omega):
    assume(omega != omega0)
    got = linear_moment_to_speed(inertia, m0, m1, omega0, omega)
    with mpmath.workdps(100):
        i, a, b, w0, w = exactly(inertia, m0, m1, omega0, omega)
        ends = [a - b * w0, a - b * w]
        sums = [abs(a) + abs(b * w0), abs(a) + abs(b * w)]
        assume(all(abs(end) > 1e-12 * total for end, total in zip(ends, sums, strict=True)))
        if ends[0] * ends[1] <= 0 or (w - w0) * ends[0] <= 0:
            np.testing.assert_equal(got, NEVER)
            return
        time = i / b * mpmath.log(ends[0] / ends[1]) if b else i * (w - w0) / a
        # A moment is known to EPS of its terms, and the time has at most the relative error of both.
        part = EPS * (20 + 2 * sum(total / abs(end) for end, total in zip(ends, sums, strict=True)))
        assert_within(got[0], time, part * time)
        terms = linear_terms(inertia, m0, m1, omega0, time)
        allowed = part * time * abs(w) + EPS * (10 + 4 * abs(b * time / i)) * (abs(terms[2]) + abs(terms[3]))
        assert_within(got[1], terms[2] + terms[3], allowed)


@settings(deadline=None, max_examples=200)
@given(sizes, numbers, st.floats(-300.0, 600.0) | st.floats(-1.5, 1.5), numbers, sizes)
def test_linear_moment_squares__is_the_integral_of_the_exponential(inertia, m0, x, omega0, t):
    m1 = x * inertia / t
    assume(abs(x) > 1e-30 or x == 0.0)
    got = linear_moment_squares(inertia, m0, m1, omega0, t)
    with mpmath.workdps(200):
        i, a, b, w, time = exactly(inertia, m0, m1, omega0, t)
        gained = a * time / i
        exact_x = b * time / i
        if b:
            final, off = a / b, w - a / b
            once, twice = (1 - mpmath.exp(-n * exact_x) for n in (1, 2))
            integral = final**2 * time + (2 * final * off * once + off**2 * twice / 2) * i / b
            speed = abs(w) * mpmath.exp(-exact_x) + abs(a / b) * abs(once)
            way = abs(w * i / b * once) + abs(a / b) * abs(time - i / b * once)
        else:
            integral = (w**2 + w * gained + gained**2 / 3) * time
        if abs(x) < 1.0:
            # Sums of some ten terms, the greatest of them the squares.
            terms = time * (abs(w) * (1 + abs(exact_x)) + abs(gained)) ** 2
        else:
            # The balance of energy: angle and speed as accurate as they are themselves.
            terms = (abs(a) * way + i * (speed + abs(w)) ** 2) / abs(b)
        assert_within(got, integral, EPS * (20 + 4 * abs(exact_x)) * terms)


def test_linear_moment__comes_to_its_final_speed_with_its_time_constant():
    # Final speed m0/m1, time constant I/m1.
    omega, time_constant = 8.0, 1.2
    assert_allclose(linear_moment(0.6, 4.0, 0.5, 3.0, 60 * time_constant)[0], omega, rtol=4 * EPS)
    # After one time constant 1 - 1/e of the way is done.
    assert_allclose(linear_moment_to_speed(0.6, 4.0, 0.5, 0.0, 8 * (1 - math.exp(-1)))[0], time_constant, rtol=20 * EPS)
    np.testing.assert_equal(linear_moment_to_speed(0.6, 4.0, 0.5, 0.0, 8.0), NEVER)


# Moment that falls with the square of the speed


@pytest.mark.parametrize(
    ("m0", "m2", "omega0", "t"),
    [
        (4.0, 0.5, 0.0, 0.2),
        (4.0, 0.5, 0.0, 1.5),
        (4.0, 0.5, 20.0, 0.4),
        (0.0, 0.5, 20.0, 3.0),
        (-4.0, 0.5, 20.0, 0.5),
        (4.0, 1e-12, 2.0, 1.0),
    ],
)
def test_quadratic_moment__is_the_ode(m0, m2, omega0, t):
    exact = ode(lambda _, w: mpf(m0) - mpf(m2) * w * w, 0.6, omega0, t)
    # The run-down with m0 < 0 loses a factor of 3 to cancellation, the others less.
    assert_allclose(quadratic_moment(0.6, m0, m2, omega0, t), exact, rtol=50 * EPS)


def quadratic_motion(inertia, m0, m2, omega0, t):
    """The textbooks' tanh, quotient and tan, at many digits."""
    i, a, b, w, time = exactly(inertia, m0, m2, omega0, t)
    if b == 0:
        return w + a * time / i, w * time + a * time**2 / i / 2
    if a == 0:
        return w / (1 + b * w * time / i), i / b * mpmath.log(1 + b * w * time / i)
    scale, kt = mpmath.sqrt(abs(a) / b), mpmath.sqrt(abs(a) * b) / i * time
    if a > 0:
        tanh = mpmath.tanh(kt)
        speed = scale * (w + scale * tanh) / (scale + w * tanh)
        return speed, i / b * mpmath.log(mpmath.cosh(kt) + w / scale * mpmath.sinh(kt))
    begun = mpmath.atan(w / scale)
    return scale * mpmath.tan(begun - kt), i / b * mpmath.log(mpmath.cos(begun - kt) / mpmath.cos(begun))


def assert_is_the_textbook_motion(inertia, m0, m2, omega0, t):
    got = quadratic_moment(inertia, m0, m2, omega0, t)
    with mpmath.workdps(100):
        # All terms are positive; only ln((1 + ...)/2) + k t loses a factor of 4 at k t = 1.
        for value, exact in zip(got, quadratic_motion(inertia, m0, m2, omega0, t), strict=True):
            assert_within(value, exact, 40 * EPS * exact)


@settings(deadline=None, max_examples=200)
@given(sizes, sizes, st.floats(-6.0, 4.0), zero_or_sizes, sizes)
def test_quadratic_moment_that_drives__is_the_tanh(inertia, m0, decade, share, t):
    # k t = 10^decade, and omega0 as a share of the final speed.
    m2 = (10.0**decade * inertia / t) ** 2 / m0
    assert_is_the_textbook_motion(inertia, m0, m2, share * math.sqrt(m0 / m2), t)


@settings(deadline=None, max_examples=100)
@given(sizes, zero_or_sizes, zero_or_sizes, sizes, st.booleans())
def test_quadratic_moment_without_drive_or_fan__is_the_quotient_or_the_parabola(inertia, moment, omega0, t, fan):
    assert_is_the_textbook_motion(inertia, *((0.0, moment) if fan else (moment, 0.0)), omega0, t)


@settings(deadline=None, max_examples=200)
@given(sizes, sizes, zero_or_sizes, sizes, st.floats(1e-6, 2.0) | st.floats(2.0, 50.0))
def test_quadratic_moment_that_brakes__is_the_tangent_until_rest(inertia, m0, m2, omega0, part):
    with mpmath.workdps(100):
        i, a, b, w = exactly(inertia, m0, m2, omega0)
        stop = i / mpmath.sqrt(a * b) * mpmath.atan(w * mpmath.sqrt(b / a)) if b else i * w / a
        t = float(part * stop)
        got = quadratic_moment(inertia, -m0, m2, omega0, t)
        if part > 1.0 + 1e-9:
            np.testing.assert_equal(got, NEVER)
            return
        assume(part < 1.0 - 1e-9)
        speed, angle = quadratic_motion(inertia, -m0, m2, omega0, t)
        kt = mpmath.sqrt(a * b) / i * t
        tangent = mpmath.tan(kt) / kt if kt else mpf(1)
        # Numerator and k t carry some EPS: the first of its terms, the second as an error in t.
        terms = (w + a * t / i * tangent) / (1 + b * w * t / i * tangent)
        assert_within(got[0], speed, 10 * EPS * (terms + (a + b * speed**2) / i * t))
        assert_within(got[1], angle, 60 * EPS * angle)


@settings(deadline=None, max_examples=200)
@given(sizes, numbers, zero_or_sizes, zero_or_sizes, zero_or_sizes)
def test_quadratic_moment_to_speed__is_the_inverse_or_never(inertia, m0, m2, omega0, omega):
    assume(omega != omega0)
    time, angle = quadratic_moment_to_speed(inertia, m0, m2, omega0, omega)
    with mpmath.workdps(100):
        i, a, b, w0, w = exactly(inertia, m0, m2, omega0, omega)
        ends = [a - b * w0**2, a - b * w**2]
        sums = [abs(a) + b * w0**2, abs(a) + b * w**2]
        assume(all(abs(end) > 1e-12 * total or not total for end, total in zip(ends, sums, strict=True)))
        if ends[0] * ends[1] <= 0 or (w - w0) * ends[0] <= 0:
            np.testing.assert_equal((time, angle), NEVER)
            return
        exact = i / (2 * b) * mpmath.log(ends[0] / ends[1]) if b else i * (w**2 - w0**2) / a / 2
        if a == 0:
            until = i / b * (1 / w - 1 / w0)
        elif b == 0:
            until = i * (w - w0) / a
        else:
            # atanh beyond 1 has the same imaginary part at both ends; below 0 the root makes it the arctangent.
            scale = mpmath.sqrt(b / a)
            until = mpmath.re(i / (a * scale) * (mpmath.atanh(scale * w) - mpmath.atanh(scale * w0)))
        # A moment is known to EPS of its terms, the same holds for 1 - r, and both ends enter.
        part = EPS * (20 + 4 * sum(total / abs(end) for end, total in zip(ends, sums, strict=True)))
        assert_within(angle, exact, part * exact)
        assert_within(time, until, part * until)


def test_fan_backwards__is_refused():
    np.testing.assert_equal(quadratic_moment(1.0, 1.0, 1.0, -0.5, 1.0), NEVER)
    np.testing.assert_equal(quadratic_moment_to_speed(1.0, 1.0, 1.0, -0.5, 0.5), NEVER)
    np.testing.assert_equal(quadratic_moment_to_speed(1.0, -1.0, 1.0, 0.5, -0.5), NEVER)


# Laws that all of them keep

MOTIONS = [
    (constant_moment, constant_moment_to_speed, (0.6, -2.0)),
    (linear_moment, linear_moment_to_speed, (0.6, 4.0, 0.5)),
    (linear_moment, linear_moment_to_speed, (0.6, 4.0, -0.5)),
    (quadratic_moment, quadratic_moment_to_speed, (0.6, 4.0, 0.5)),
    (quadratic_moment, quadratic_moment_to_speed, (0.6, 0.0, 0.5)),
    (quadratic_moment, quadratic_moment_to_speed, (0.6, -4.0, 0.5)),
]


@pytest.mark.parametrize(("motion", "to_speed", "machine"), MOTIONS)
@pytest.mark.parametrize("omega0", [2.5, 7.0])
def test_motion__goes_on_from_where_it_is_and_back_to_its_time(motion, to_speed, machine, omega0):
    omega, phi = motion(*machine, omega0, 0.15)
    later = motion(*machine, omega, 0.1)
    # Errors of some ten EPS in a speed grow at most by e^(m1 t/I) or lose at most a factor of 10 in the inverse.
    assert_allclose((later[0], phi + later[1]), motion(*machine, omega0, 0.25), rtol=100 * EPS)
    assert_allclose(to_speed(*machine, omega0, omega), (0.15, phi), rtol=200 * EPS)
    assert to_speed(*machine, omega0, omega0) == (0.0, 0.0)
    np.testing.assert_equal(to_speed(*machine, omega, omega0), NEVER)


@pytest.mark.parametrize(("motion", "to_speed", "machine"), MOTIONS)
@pytest.mark.parametrize("function", ["motion", "to_speed"])
def test_unknown_number__gives_nan(motion, to_speed, machine, function):
    arguments = [*machine, 3.0, 0.2 if function == "motion" else 2.9]
    for place in range(len(arguments)):
        unknown = [math.nan if k == place else number for k, number in enumerate(arguments)]
        assert math.isnan((motion if function == "motion" else to_speed)(*unknown)[1])
