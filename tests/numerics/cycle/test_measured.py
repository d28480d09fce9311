import math

import mpmath
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from motion_scenes import ask, slider_crank

from engine.cycle.measured import Measured, atan2, maximum, measured, minimum, sqrt, where

numbers = st.floats(-1e6, 1e6, allow_nan=False).filter(lambda x: x == 0.0 or abs(x) > 1e-6)
shares = st.floats(0.0, 1e-3)
asides = st.floats(-1.0, 1.0)


def inside(found, exact):
    """Whether an exact result is within the error estimate, a hundredth more for the second order."""
    return abs(mpmath.mpf(float(found.value)) - exact) <= float(found.error) * 1.01


def operands(x, share, aside):
    """A value with an error, and what it might be instead."""
    error = abs(x) * share
    return Measured(x, error), mpmath.mpf(x) + mpmath.mpf(error) * mpmath.mpf(aside)


@given(numbers, shares, asides, numbers, shares, asides)
def test_sums_products_and_quotients_cover_what_operands_may_be(x, u, a, y, v, b):
    with mpmath.workdps(50):
        first, true_first = operands(x, u, a)
        second, true_second = operands(y, v, b)
        assert inside(first + second, true_first + true_second)
        assert inside(first - second, true_first - true_second)
        assert inside(first * second, true_first * true_second)
        if y != 0.0:
            assert inside(first / second, true_first / true_second)


@given(st.floats(1e-6, 1e6), shares, asides)
def test_square_root_covers_what_its_operand_may_be(x, share, aside):
    with mpmath.workdps(50):
        found, true = operands(x, share, aside)
        assert inside(sqrt(found), mpmath.sqrt(true))


# Half of the least subnormal number is 0.
@given(st.floats(0.0, 1e-6, allow_subnormal=False), st.floats(0.0, 1.0))
def test_root_of_what_may_be_zero_is_off_by_no_more_than_its_figure(error, share):
    # The true value lies between 0 and twice the error; the root found is that of less than the error.
    found = sqrt(Measured(0.5 * error, error))
    assert abs(float(found.value) - math.sqrt(share * 1.5 * error)) <= float(found.error) * (1.0 + 1e-12)


@given(numbers, shares, asides, numbers, shares, asides)
def test_larger_and_smaller_cover_what_operands_may_be(x, u, a, y, v, b):
    with mpmath.workdps(50):
        first, true_first = operands(x, u, a)
        second, true_second = operands(y, v, b)
        assert inside(maximum(first, second), max(true_first, true_second))
        assert inside(minimum(first, second), min(true_first, true_second))


@given(st.floats(0.0, 2.0 * math.pi), st.floats(1e-3, 1e3), st.floats(0.0, 1e-4), asides, asides)
def test_angle_covers_what_its_direction_may_be(angle, length, share, a, b):
    error = share * length
    y, x = length * math.sin(angle), length * math.cos(angle)
    found = atan2(Measured(y, error), Measured(x, error))
    true = math.atan2(y + a * error, x + b * error)
    apart = abs(math.remainder(float(found.value) - true, 2.0 * math.pi))
    # Second order: the square of the relative error, no more than 1e-4 of it.
    assert apart <= float(found.error) * 1.001 + 1e-15


@pytest.mark.parametrize("exponent", [2.0, 3.0, 0.5, -1.0])
def test_powers_follow_their_derivative(exponent):
    found = Measured([2.0, 5.0], [1e-6, 1e-7]) ** exponent
    assert np.allclose(found.value, np.array([2.0, 5.0]) ** exponent, rtol=1e-15)
    slope = abs(exponent) * np.array([2.0, 5.0]) ** (exponent - 1.0)
    assert np.allclose(found.error, slope * [1e-6, 1e-7], rtol=1e-6)


def test_what_is_not_known_stays_unknown():
    unknown = Measured([math.nan, 1.0], [0.0, 0.1])
    more = 1.0 / unknown, sqrt(unknown), abs(unknown), maximum(unknown, measured(0.0))
    for result in (unknown + 1.0, 2.0 * unknown, *more):
        assert np.isnan(result.value[0])
        assert np.isfinite(result.value[1])
        assert np.isfinite(result.error[1])


def test_division_by_what_may_be_zero_says_nothing():
    assert np.isinf((1.0 / Measured(1e-9, 1e-8)).error)
    assert (1.0 / Measured(4.0)).error < 1e-15


def test_arrays_on_the_left_give_measured_values():
    found = np.array([1.0, 2.0]) * Measured([3.0, 4.0], [0.1, 0.2])
    assert isinstance(found, Measured)
    assert np.allclose(found.error, [0.1, 0.4], rtol=1e-12)


def test_choice_takes_values_with_their_errors():
    found = where(np.array([True, False]), Measured([1.0, 2.0], 0.1), Measured([3.0, 4.0], 0.2))
    assert np.array_equal(found.value, [1.0, 4.0])
    assert np.array_equal(found.error, [0.1, 0.2])


# Statistics of the magnitude of a force, and of a component.
OF_FORCE = [f"input.reaction.{key}" for key in ("min", "max", "range", "amplitude", "peak", "mean", "rms")]
OF_FORCE += ["input.reaction_x.rms"]


def test_forces_whose_squares_vanish__are_known_by_their_figures():
    scene = slider_crank({}) | {"moments": {}, "shafts": {}, "bodies": {}, "gravity": 0.0}
    scene["forces"] = {"f": {"type": "constant", "on": "B", "angle": 0.3, "force": 1.0}}
    del scene["flywheel"]
    forces = [1.0, 1e-100, 1e-150, 1e-156, 1e-160, 1e-170, 1e-300, 0.0]
    found = ask(scene, " ".join([*OF_FORCE, "accuracy_reached"]), varied={"forces.f.force": forces})
    for name in OF_FORCE:
        values, errors = found.values[name], found.errors[name]
        assert (np.abs(values - np.array(forces) * values[0]) <= errors + 1e-12 * np.abs(values)).all(), name
    assert found.values["accuracy_reached"][[0, 1, 2, -1]].tolist() == [1.0, 1.0, 1.0, 1.0]
