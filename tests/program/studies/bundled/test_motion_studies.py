"""Bundled studies of motion, at a fifth of the values of each range: a hand calculation confirms what they answer."""

import functools
import math
import re
import shutil

import numpy as np
import pytest

from engine import Verdict
from sweeps import SweepResult, read_study, run_study
from sweeps.study.bundled import STUDIES

NAMES = ("accumulator_press", "emergency_stop", "engine_idling", "press_start")
TURN = 2 * math.pi
RPM = TURN / 60

# Work of a stroke of the press at the crank: trapezium of the punch's force, full over 2.4 mm with flanks of 0.8 mm
# and 1.6 mm; stripping over 9 mm; friction over the turn.
PUNCHING = 703.7e3 * (0.0024 + (0.0008 + 0.0016) / 2)
STROKE = PUNCHING + 28e3 * 0.009 + 250 * TURN


@pytest.fixture(scope="module")
def table(tmp_path_factory):
    """Function that gives a study's result by its name; each study is run once."""
    folder = tmp_path_factory.mktemp("motion") / "studies"
    shutil.copytree(STUDIES, folder)

    @functools.cache
    def result(name):
        (path,) = folder.rglob(f"{name}.toml")
        text = path.read_text(encoding="utf8")
        path.write_text(re.sub(r"count = (\d+)", lambda n: f"count = {(int(n[1]) + 8) // 5}", text), encoding="utf8")
        return SweepResult(run_study(read_study(path), folder / f"{name}.h5"))

    return result


def done(result):
    """Columns of the variants that were computed."""
    keep = result.columns["status"] == Verdict.OK
    return {name: column[keep] for name, column in result.columns.items()}


def within(columns, name, expected):
    """Whether a column is within its error estimates, and rounding, of what it should be."""
    room = columns[f"{name}_error"] + 1e-9 * np.abs(expected)
    return bool((np.abs(columns[name] - expected) <= room).all())


@pytest.mark.parametrize("name", NAMES)
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


# Emergency stop


def test_emergency_stop__heats_the_drum_with_moment_times_angle(table):
    found = done(table("emergency_stop"))
    moment = 2 * found["moments.brake.friction"] * found["moments.brake.force"] * 0.150 * 20
    # Both have an error estimate.
    room = found["stop.brake_heat_error"] + moment * found["stop.angle_error"] + 1e-9 * found["stop.brake_heat"]
    assert (np.abs(found["stop.brake_heat"] - moment * found["stop.angle"]) <= room).all()
