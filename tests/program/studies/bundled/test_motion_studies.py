"""Bundled studies of motion: they run whole, and a hand calculation confirms what they answer."""

import functools
import math

import numpy as np
import pytest

from engine import Machine, Verdict
from sweeps import SweepResult, read_study, run_study
from sweeps.study.bundled import bundled_studies

STUDIES = ("accumulator_press", "emergency_stop", "engine_idling", "press_start")
TURN = 2 * math.pi
RPM = TURN / 60

# Work of a stroke of the press at the crank: trapezium of the punch's force, full over 2.4 mm with flanks of 0.8 mm
# and 1.6 mm; stripping over 9 mm; friction over the turn.
PUNCHING = 703.7e3 * (0.0024 + (0.0008 + 0.0016) / 2)
STROKE = PUNCHING + 28e3 * 0.009 + 250 * TURN


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Function that gives a study's result by its name; each study is run once."""
    folder = tmp_path_factory.mktemp("studies")

    @functools.cache
    def result(name):
        return SweepResult(run_study(read_study(bundled_studies()[name]), folder / f"{name}.h5"))

    return result


def done(result):
    """Columns of the variants that were computed."""
    keep = result.columns["status"] == Verdict.OK
    return {name: column[keep] for name, column in result.columns.items()}


def beside(result, variant, name, step):
    """Variant that differs from another by some steps along one axis of the grid."""
    place = list(np.unravel_index(variant, result.shape))
    place[result.varied.index(name)] += step
    return int(np.ravel_multi_index(place, result.shape))


def within(columns, name, expected):
    """Whether a column is within its error estimates, and rounding, of what it should be."""
    room = columns[f"{name}_error"] + 1e-9 * np.abs(expected)
    return bool((np.abs(columns[name] - expected) <= room).all())


@pytest.mark.parametrize("name", STUDIES)
def test_study__gives_each_variant_finite_numbers_or_a_reason(name, table):
    result = table(name)
    expected = {Verdict.OK, Verdict.STALLS, Verdict.DROPPED}
    assert set(np.unique(result.columns["status"])) <= expected
    found = done(result)
    assert found["status"].size > 0.7 * result.file.variants
    for summary in result.summaries:
        assert np.isfinite(found[summary]).all(), summary
        assert np.isfinite(found[f"{summary}_error"]).all(), summary


# Start of the press


@pytest.mark.parametrize("name", ["press_start", "accumulator_press"])
def test_press__takes_the_work_of_a_stroke_at_the_speed_of_its_slip(name, table):
    found = done(table(name))
    assert within(found, "work.motor_power", STROKE * found["work.mean_speed"] / TURN)
    assert within(found, "work.motor_slip", 1 - 36 * found["work.mean_speed"] / (1500 * RPM))


def test_press__does_the_work_of_a_stroke_within_its_error_at_any_accuracy():
    # The punch's force bends at corners, beside which it is evaluated; the closed form has no error.
    scene = read_study(bundled_studies()["press_start"]).scene
    for accuracy in (1e-2, 1e-4, 1e-6, 1e-8, 1e-10):
        found = Machine(scene, ["work.useful_work"], accuracy=accuracy).evaluate({})
        error = abs(found.summaries["work.useful_work"][0] - (PUNCHING + 28e3 * 0.009))
        assert error <= found.errors["work.useful_work"][0] <= 1e-6 * PUNCHING


def test_press_start__answers_with_the_heaviest_flywheel_and_the_stiffest_motor_allowed(table):
    result = table("press_start")
    best, c = result.best(), result.columns
    assert c["moments.motor.power"][best] == 4000
    assert c["flywheel.inertia"][best] == pytest.approx(1300)
    assert c["rated_slip"][best] == pytest.approx(0.03)
    heavier, stiffer = beside(result, best, "flywheel.inertia", 1), beside(result, best, "rated_slip", -1)
    assert c["start.time"][best] <= 3 < c["start.time"][heavier]
    assert c["work.motor_moment_rms"][best] <= c["rated_moment"][best]
    assert c["work.motor_moment_rms"][stiffer] > c["rated_moment"][stiffer]
    # Rim of 1 m and 0.8 m on a shaft 7.5 times as fast.
    assert c["wheel_mass"][best] == pytest.approx(1300 / 7.5**2 / ((0.5**2 + 0.4**2) / 2), rel=1e-9)


# Motor and flywheel sized together


def test_accumulator_press__has_the_fluctuation_that_was_asked(table):
    found = done(table("accumulator_press"))
    # The flywheel is found to a part in 10^10 or so of the fluctuation.
    assert np.allclose(found["work.speed_fluctuation"], found["flywheel.speed_fluctuation"], rtol=1e-8, atol=0)


def test_accumulator_press__drops_motors_below_the_mean_moment(table):
    c = table("accumulator_press").columns
    dropped = c["status"] == Verdict.DROPPED
    assert (dropped == (c["rated_moment"] < STROKE / TURN)).all()
    assert (c["moments.motor.power"][dropped] == 2200).all()


def test_accumulator_press__answers_with_the_least_slip_that_does_not_overheat(table):
    result = table("accumulator_press")
    best, c = result.best(), result.columns
    assert c["moments.motor.power"][best] == 4000
    assert c["flywheel.speed_fluctuation"][best] == 0.2
    assert c["rated_slip"][best] == pytest.approx(0.05)
    stiffer, smaller = beside(result, best, "rated_slip", -1), beside(result, best, "moments.motor.power", -1)
    assert c["work.motor_moment_rms"][best] <= c["rated_moment"][best]
    assert c["work.motor_moment_rms"][stiffer] > c["rated_moment"][stiffer]
    assert c["work.motor_moment_rms"][smaller] > c["rated_moment"][smaller]
    assert c["work.mean_speed"][best] >= 38 * RPM


# Idling engine

CRANK, AREA = 0.032, math.pi / 4 * 0.088**2
SWEPT = AREA * 2 * CRANK
INTAKE, EXHAUST, COMPRESSION, EXPANSION = 0.4e5, 1.05e5, 1.32, 1.28


def gas_work(peak):
    """Work of a cycle: polytropes between clearance and eight times as much, and the exchange of gas."""
    clearance = SWEPT / 7
    expansion = peak * clearance / (EXPANSION - 1) * (1 - 8 ** (1 - EXPANSION))
    compression = INTAKE * clearance * 8 / (COMPRESSION - 1) * (8 ** (COMPRESSION - 1) - 1)
    return expansion - compression - (EXHAUST - INTAKE) * SWEPT


def test_engine_idling__does_the_work_of_the_ideal_cycle_against_friction_and_fan(table):
    found = done(table("engine_idling"))
    work = gas_work(found["cylinders.gas.peak"])
    assert within(found, "idle.driving_work", work)
    room = found["idle.harmful_work_error"] + found["idle.useful_work_error"] + found["idle.driving_work_error"]
    assert (np.abs(found["idle.harmful_work"] + found["idle.useful_work"] - work) <= room + 1e-9 * work).all()


def test_engine_idling__stalls_with_too_light_a_flywheel(table):
    result = table("engine_idling")
    c = result.columns
    (k,) = np.flatnonzero(np.isclose(c["cylinders.gas.peak"], 13.5e5) & (c["flywheel.inertia"] == 0.0))
    assert c["status"][k] == Verdict.STALLS
    assert np.isnan(c["idle.mean_speed"][k])
    # A heavier flywheel or a higher pressure never makes it stall; each of them makes it run more evenly.
    runs = (c["status"] == Verdict.OK).reshape(result.shape)
    fluctuation = c["idle.speed_fluctuation"].reshape(result.shape)
    for axis in (0, 1):
        assert (np.diff(runs.astype(int), axis=axis) >= 0).all()
        rise = np.diff(fluctuation, axis=axis)
        assert (rise[np.isfinite(rise)] < 0).all()


def test_engine_idling__answers_with_the_lightest_flywheel_that_is_even_enough_at_800_rpm(table):
    result = table("engine_idling")
    best, c = result.best(), result.columns
    assert c["cylinders.gas.peak"][best] == pytest.approx(13.5e5)
    assert c["flywheel.inertia"][best] == pytest.approx(0.045)
    lighter, richer = beside(result, best, "flywheel.inertia", -1), beside(result, best, "cylinders.gas.peak", 1)
    assert c["idle.speed_fluctuation"][best] <= 0.2 < c["idle.speed_fluctuation"][lighter]
    assert c["idle.mean_speed"][best] <= 800 * RPM < c["idle.mean_speed"][richer]
    # Rim of 250 mm and 200 mm.
    assert c["wheel_mass"][best] == pytest.approx(0.045 / ((0.125**2 + 0.1**2) / 2), rel=1e-9)


# Emergency stop


def test_emergency_stop__heats_the_drum_with_moment_times_angle(table):
    found = done(table("emergency_stop"))
    moment = 2 * found["moments.brake.friction"] * found["moments.brake.force"] * 0.150 * 20
    # Both have an error estimate.
    room = found["stop.brake_heat_error"] + moment * found["stop.angle_error"] + 1e-9 * found["stop.brake_heat"]
    assert (np.abs(found["stop.brake_heat"] - moment * found["stop.angle"]) <= room).all()


def test_emergency_stop__answers_with_all_the_force_the_shaft_bears(table):
    result = table("emergency_stop")
    best, c = result.best(), result.columns
    assert c["moments.brake.force"][best] == pytest.approx(4000)
    assert c["shock"][best] == pytest.approx(600)
    assert c["flywheel.inertia"][best] == pytest.approx(1300)
    lighter, stronger = beside(result, best, "flywheel.inertia", -1), beside(result, best, "moments.brake.force", 1)
    assert c["work.speed_fluctuation"][best] <= 0.04 < c["work.speed_fluctuation"][lighter]
    assert c["status"][stronger] == Verdict.DROPPED
