"""Starts and sudden loads of two masses with backlash: closed forms, momentum along the way, limits."""

import math

import numpy as np
import pytest
from each_case import refusals
from element_samples import TWO_MASSES, element, figures, one
from hypothesis import example, given, settings
from hypothesis import strategies as st

from engine.elements.elastic_drives.two_mass_drive import drive_history
from engine.elements.elastic_drives.two_masses import TOLERANCE
from engine.stepping.walk_task import COARSER, LONGEST

DRIVE = TWO_MASSES | {"motor_moment": 100.0}
KEYS = ("motor_inertia", "load_inertia", "stiffness", "damping", "backlash", "motor_moment", "load_moment")


def peak_of_start(first, second, k, gap, motor, load):
    """Greatest moment of a start without damping: by the work of the motor, then the vibration of both masses."""
    v0 = 2 * motor * gap / first
    held = load / k
    v1 = v0 + 2 / first * (motor * held - k * held**2 / 2)
    square = k * (1 / first + 1 / second)
    twist = (motor / first + load / second) / square
    return k * (twist + math.sqrt((held - twist) ** 2 + v1 / square))


sizes = st.floats(-1, 1).map(lambda x: 10**x)


@settings(max_examples=25)
@given(sizes, sizes, st.floats(2, 6), st.floats(0, 0.1), st.floats(1, 300), st.floats(0, 1))
@example(10.0, 1.0, 2.0, 5e-324, 1.0, 0.0)
@example(10.0, 1.0, 2.0, 1e-300, 1.0, 0.0)
@example(10.0, 1.0, 2.0, 1e-290, 1.0, 0.0)
@example(1.0, 1.0, 2.0, 0.0, 1.0, 5e-14)
@example(10.0, 0.1, 3.5, 2.2e-6, 282.0, 0.0)
def test_first_peak_of_a_start__is_the_closed_form(first, second, k, gap, motor, share):
    k, load = 10**k, share * motor
    # Long enough for the gap, and for a half wave after it.
    time = math.sqrt(2 * gap * first / motor) + math.pi * math.sqrt(first / k)
    drive = DRIVE | dict(zip(KEYS, (first, second, k, None, gap, motor, load), strict=True)) | {"time": time}
    ((value, error),) = figures(drive, "greatest_moment")
    exact = peak_of_start(first, second, k, gap, motor, load)
    assert abs(value - exact) <= error + 4e-15 * exact
    # The walks compared take ten steps to the peak, each within their tolerance.
    assert error <= 10 * LONGEST**COARSER * TOLERANCE * exact


@pytest.mark.parametrize(
    "change",
    [
        {},
        {"damping": 30.0},
        {"damping_ratio": 2.0},
        {"load_moment": 130.0},
        {"begin": "running", "speed": 1.0, "load_before": 10.0, "load_moment": 400.0},
    ],
)
def test_history__keeps_momentum_and_ends_as_the_results_do(change):
    drive = DRIVE | {"time": 0.4} | change
    history = drive_history(element(drive), 200_001)
    step = history.time[1]
    impulse = np.concatenate([[0], np.cumsum(0.5 * (history.moment[1:] + history.moment[:-1]) * step)])
    gained = 0.5 * (history.motor_speed - history.motor_speed[0])
    # The trapezoidal rule misses jumps of the damper's moment by half a step.
    room = step * 40 * np.abs(history.moment).max()
    assert np.abs(gained - (100.0 * history.time - impulse)).max() < room
    apart = history.motor_speed - history.load_speed
    slid = np.concatenate([[0], np.cumsum(0.5 * step * (apart[1:] + apart[:-1]))])
    assert np.abs(history.gap - history.gap[0] - slid).max() < 1e-6
    greatest, *speeds = one(drive, "greatest_moment", "motor_speed", "load_speed")
    assert [history.motor_speed[-1], history.load_speed[-1]] == pytest.approx(speeds, abs=1e-9)
    # Instants miss the peak of a damper that is hit with full speed.
    assert np.abs(history.moment).max() == pytest.approx(greatest, rel=5e-3)


def test_parts_of_the_shaft__count_as_their_series():
    parts = {"a": {"type": "coupling", "stiffness": 3e4}, "b": {"type": "coupling", "stiffness": 6e4}}
    drive = DRIVE | {"stiffness": None, "parts": parts}
    assert one(drive, "greatest_moment") == pytest.approx(one(DRIVE, "greatest_moment"), rel=1e-12)


test_drive_that_cannot_be__says_what_to_mend = refusals(
    lambda change: element(DRIVE | change),
    ({"stiffness": None}, "give stiffness or parts"),
    ({"damping": 1.0, "damping_ratio": 0.1}, "give one of damping, damping_ratio, or none"),
    ({"begin": "running"}, "speed is missing"),
    ({"speed": 3.0, "load_before": 1.0}, "speed goes with begin = 'running'"),
    ({"backlash": -0.1}, "must be at least 0"),
)
