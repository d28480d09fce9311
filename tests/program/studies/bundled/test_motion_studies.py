"""Bundled studies of motion: they run whole, and a hand calculation confirms what they answer."""

import functools
import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

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


# A slider-crank by hand


def slider_crank(angle, crank, rod, centre, side, masses):
    """Inertia on the crank of rod and slider, and how high both rise, per radian; with the slider's speed.

    The guide is upright through the crank's centre, the slider above it (side 1) or below (-1); `centre` is the
    distance of the rod's centre of mass from the pin, `masses` are those of rod and slider and the rod's inertia.
    """
    s, c = math.sin(angle), math.cos(angle)
    root = math.sqrt(rod**2 - (crank * c) ** 2)
    slider = crank * c + side * crank**2 * c * s / root
    across, up = -crank * s * (1 - centre / rod), crank * c * (1 + side * centre * crank * s / (rod * root))
    of_rod, of_slider, turning = masses
    inertia = of_rod * (across**2 + up**2) + turning * (crank * s / root) ** 2 + of_slider * slider**2
    return inertia, of_rod * up + of_slider * slider, slider


# Start of the press


def kloss(power, rated_slip):
    """Moment of the scene's motor over its slip: a formula of three constants through the points of its nameplate."""
    most, start, synchronous = 2.5, 2.2, 1500 * RPM
    rated = power / (synchronous * (1 - rated_slip))

    def damping(slip):
        return (rated_slip / slip + slip / rated_slip - 2 * most) / (most - 1)

    def at(s, slip):
        return most * rated * (2 + damping(slip)) / (s / slip + slip / s + damping(slip))

    # The breakdown slip lies above that of the formula without damping, s_n (λ + √(λ² - 1)).
    least = rated_slip * (most + math.sqrt(most**2 - 1))
    slip = brentq(lambda x: at(1.0, x) - start * rated, least, 1.0)
    return lambda s: at(s, slip)


def shafts_inertia(power):
    """Inertia on the crank of all that turns evenly but the flywheel: eccentric, gear, two shafts."""
    return 4 + 250 * 0.020**2 + 20 + 0.5 * 7.5**2 + 0.004e-3 * power * 36**2


def press_start(power, rated_slip, flywheel):
    """Time and angle of the start, by integration over time from rest."""
    motor, turning = kloss(power, rated_slip), shafts_inertia(power) + flywheel

    def parts(angle):
        inertia, rise, _ = slider_crank(angle, 0.065, 0.650, 0.200, -1, (120, 300, 6))
        return inertia, 9.81 * (rise + 250 * 0.020 * math.cos(angle))

    def rates(time, state):
        angle, omega = state
        inertia, weights = parts(angle)
        # By differences: of 1 to 2 kg m2, so the rounding is no matter.
        bend = (parts(angle + 1e-5)[0] - parts(angle - 1e-5)[0]) / 2e-5
        moment = 36 * motor(1 - 36 * omega / (1500 * RPM)) - weights - 250
        return omega, (moment - 0.5 * omega**2 * bend) / (turning + inertia)

    def fast_enough(time, state):
        return state[1] - 37.5 * RPM

    fast_enough.terminal = True
    run = solve_ivp(rates, (0, 100), (0.0, 0.0), method="DOP853", rtol=1e-10, atol=1e-12, events=fast_enough)
    return run.t[-1], run.y[0, -1]


def test_press_start__goes_as_an_integration_over_time(table):
    found = done(table("press_start"))
    for k in range(0, found["status"].size, 73):
        time, angle = press_start(*(found[n][k] for n in ("moments.motor.power", "rated_slip", "flywheel.inertia")))
        # Tolerance: some ten steps of 1e-10 each, and the error estimate.
        assert found["start.time"][k] == pytest.approx(time, rel=1e-7, abs=2 * found["start.time_error"][k])
        assert found["start.angle"][k] == pytest.approx(angle, rel=1e-7, abs=2 * found["start.angle_error"][k])


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

CRANK, ROD, AREA = 0.032, 0.110, math.pi / 4 * 0.088**2
SWEPT = AREA * 2 * CRANK
INTAKE, EXHAUST, COMPRESSION, EXPANSION = 0.4e5, 1.05e5, 1.32, 1.28


def gas_work(peak):
    """Work of a cycle: polytropes between clearance and eight times as much, and the exchange of gas."""
    clearance = SWEPT / 7
    expansion = peak * clearance / (EXPANSION - 1) * (1 - 8 ** (1 - EXPANSION))
    compression = INTAKE * clearance * 8 / (COMPRESSION - 1) * (8 ** (COMPRESSION - 1) - 1)
    return expansion - compression - (EXHAUST - INTAKE) * SWEPT


def resistance(omega):
    """Moment of friction, oil and fan."""
    return 2 + 0.01 * omega + 5.6e-5 * omega**2


def motion(angle, stroke, peak):
    """Inertia without the flywheel, and moment of gas and weights, at a crank angle in one of the four strokes."""
    inertia, rise, rate = slider_crank(angle, CRANK, ROD, 0.033, 1, (0.35, 0.42, 0.0006))
    piston = CRANK * math.sin(angle) + math.sqrt(ROD**2 - (CRANK * math.cos(angle)) ** 2)
    clearance = SWEPT / 7
    volume = clearance + AREA * (ROD + CRANK - piston)
    pressure = (
        peak * (clearance / volume) ** EXPANSION,
        EXHAUST,
        INTAKE,
        INTAKE * (8 * clearance / volume) ** COMPRESSION,
    )[stroke]
    return 0.010 + inertia, -(pressure - 1e5) * AREA * rate - 9.81 * rise


def idling(peak, flywheel, cycles):
    """Mean, least and greatest speed of the last of some cycles, in time, from 800 rpm at ignition; None: stalled."""
    omega = 800 * RPM
    inertia = motion(math.pi / 2, 0, peak)[0] + flywheel
    energy = 0.5 * inertia * omega**2
    for cycle in range(cycles):
        time, speeds = 0.0, []
        for stroke in range(4):

            def rates(angle, state, stroke=stroke):
                inertia, moment = motion(angle, stroke, peak)
                speed = math.sqrt(max(2 * state[0], 1e-12) / (inertia + flywheel))
                return moment - resistance(speed), 1 / speed

            def rest(angle, state):
                return state[0] - 1e-6

            rest.terminal = True
            begin = math.pi / 2 + stroke * math.pi
            last = {"dense_output": True} if cycle == cycles - 1 else {}
            part = solve_ivp(rates, (begin, begin + math.pi), (energy, time), rtol=1e-8, events=rest, **last)
            if part.status == 1:
                return None
            energy, time = part.y[:, -1]
            if last:
                angles = np.linspace(begin, begin + math.pi, 400)
                speeds += [
                    math.sqrt(2 * e / (motion(a, stroke, peak)[0] + flywheel))
                    for a, e in zip(angles, part.sol(angles)[0], strict=True)
                ]
    return 2 * TURN / time, min(speeds), max(speeds)


def test_engine_idling__does_the_work_of_the_ideal_cycle_against_friction_and_fan(table):
    found = done(table("engine_idling"))
    work = gas_work(found["cylinders.gas.peak"])
    assert within(found, "idle.driving_work", work)
    room = found["idle.harmful_work_error"] + found["idle.useful_work_error"] + found["idle.driving_work_error"]
    assert (np.abs(found["idle.harmful_work"] + found["idle.useful_work"] - work) <= room + 1e-9 * work).all()


@pytest.mark.parametrize(("peak", "flywheel"), [(13.5e5, 0.02), (16e5, 0.0)])
def test_engine_idling__runs_as_an_integration_of_many_cycles(peak, flywheel, table):
    c = table("engine_idling").columns
    (k,) = np.flatnonzero(np.isclose(c["cylinders.gas.peak"], peak) & np.isclose(c["flywheel.inertia"], flywheel))
    # What is left of a wrong first speed after so many cycles: below 1e-5.
    cycles = 2 + math.ceil(math.log(1e-5) / math.log(c["idle.multiplier"][k]))
    mean, least, most = idling(peak, flywheel, cycles)
    # The extremes among 400 points of a stroke: within a part in 10^5 of the speed.
    assert c["idle.mean_speed"][k] == pytest.approx(mean, rel=3e-5)
    assert c["idle.speed_min"][k] == pytest.approx(least, rel=1e-4)
    assert c["idle.speed_max"][k] == pytest.approx(most, rel=1e-4)


def test_engine_idling__stalls_with_too_light_a_flywheel_as_an_integration_does(table):
    result = table("engine_idling")
    c = result.columns
    (k,) = np.flatnonzero(np.isclose(c["cylinders.gas.peak"], 13.5e5) & (c["flywheel.inertia"] == 0.0))
    assert c["status"][k] == Verdict.STALLS
    assert np.isnan(c["idle.mean_speed"][k])
    assert idling(13.5e5, 0.0, 100) is None
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
