"""The flywheel's four methods against closed forms, root finding, and integration of the equation of motion."""

import math

import numpy as np
import pytest
from engine.equal_positions.flywheel import (
    cumulative_work,
    fluctuation_with_flywheel,
    flywheel_sizes,
    speed_row,
    work_doubt,
)
from engine.equal_positions.rows_machine import RowsMachine as Machine
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from machines import slider_crank
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from engine import Scene

EPS = 2.3e-16

few = settings(deadline=None, max_examples=50)
powers = st.floats(-4, 4).map(lambda e: 10.0**e)
seeds = st.integers(0, 2**32 - 1)
nodes = np.arange(720) * (2 * math.pi / 720)
step = nodes[1]


def work_of(moment, h=step):
    work = np.empty_like(moment)
    cumulative_work(moment, moment.mean(), h, work)
    return work


def random_loop(seed, variation=0.4, harmonics=4):
    """Reduced inertia above 0.6 and work of the order of 1, each a random sum of harmonics."""
    rng = np.random.default_rng(seed)
    orders = np.arange(1, harmonics + 1)
    waves = np.cos(np.outer(orders, nodes) + rng.uniform(0, 2 * math.pi, (harmonics, 1)))
    inertia, work = (rng.uniform(-1, 1, (2, harmonics)) / orders) @ waves
    return 1 + variation * inertia / np.abs(inertia).max(), work - work[0]


def speeds_by_root_finding(inertia, work, flywheel, omega):
    """Least and greatest speed of the cycle whose mean (ω_max + ω_min)/2 is ω, by bracketing; NaN if it would stop."""

    def speeds(energy):
        squares = 2 * (energy + work) / (inertia + flywheel)
        return math.sqrt(max(squares.min(), 0.0)), math.sqrt(squares.max())

    floor = -work.min()
    top = floor + np.ptp(work) + 10 * (inertia.max() + flywheel) * omega**2
    if sum(speeds(floor)) / 2 > omega:
        return math.nan, math.nan
    energy = brentq(lambda e: sum(speeds(e)) / 2 - omega, floor, top, xtol=0.1 * EPS * top, rtol=4 * EPS)
    return speeds(energy)


def speeds_with_flywheel(inertia, work, flywheel, omega):
    """Initial energy, least and greatest speed of the cycle, from its fluctuation."""
    energy, delta = fluctuation_with_flywheel(inertia, work, flywheel, omega)
    return energy, omega * (1 - delta / 2), omega * (1 + delta / 2)


# Closed forms, constant inertia


@few
@given(powers, st.integers(1, 8), powers, powers, st.floats(-8, -0.1).map(lambda e: 10.0**e))
def test_harmonic_moment_constant_inertia__follows_the_closed_form(a, n, inertia, omega, delta):
    moment = a * np.cos(n * nodes)
    work = work_of(moment)
    excess, by_excess, merzalov, wittenbauer = flywheel_sizes(np.full(720, inertia), work, omega, delta, inertia)
    # ∫a cos nφ dφ = (a/n) sin nφ; the trapezoid rule turns 1/n into (h/2) cot(nh/2). Peaks of sin nφ that miss the
    # positions, which are 2π/720 apart, lose less than (nh)²/8 of it.
    closed = a * step / math.tan(n * step / 2)
    assert excess == pytest.approx(closed, rel=(n * step) ** 2 / 8 + 1e-13)
    assert excess == pytest.approx(2 * a / n, rel=(n * step) ** 2 / 4)
    assert by_excess == pytest.approx(excess / (delta * omega**2), rel=1e-13)
    # With constant inertia every method is exact and subtracts what is there: Iε is lost to rounding, over δ.
    lost = 8 * EPS * inertia / delta + 1e-12 * by_excess
    assert merzalov == pytest.approx(by_excess - inertia, abs=lost)
    assert wittenbauer == pytest.approx(by_excess - inertia, abs=lost)


@few
@given(powers, powers, powers)
def test_speed_constant_inertia__follows_the_closed_form(a, inertia, omega):
    work = work_of(a * np.cos(nodes))
    delta = np.ptp(work) / (inertia * omega**2)
    assume(abs(delta - 2) > 1e-3)
    energy, slowest, fastest = speeds_with_flywheel(np.full(720, inertia / 4), work, 3 * inertia / 4, omega)
    if delta > 2:
        assert np.isnan([energy, slowest, fastest]).all()
    else:
        # Near δ = 2 the least speed is the root of a small difference; 1e-3 away from it, 1e-16 grows to 1e-13.
        assert fastest == pytest.approx(omega * (1 + delta / 2), rel=1e-11)
        assert slowest == pytest.approx(omega * (1 - delta / 2), abs=1e-11 * omega)


def test_steps_of_moment__give_triangles_of_work():
    # +1 over half a turn, −1 over the other: W rises by π and falls; a jump costs half an interval.
    moment = np.where(nodes < math.pi, 1.0, -1.0)
    work = work_of(moment)
    error = abs(np.ptp(work) - math.pi)
    assert error <= work_doubt(moment, step) * (1 + 1e-9)
    # Two jumps of 2: ½ h √(2² + 2²).
    assert work_doubt(moment, step) == pytest.approx(step * math.sqrt(2), rel=1e-12)


@pytest.mark.parametrize("value", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("place", [0, 7, 719])
@pytest.mark.parametrize("which", [0, 1])
def test_undefined_position__leaves_no_flywheel(which, place, value):
    inertia, work = random_loop(8)
    (inertia, work)[which][place] = value
    assert np.isnan(flywheel_sizes(inertia, work, 3.0, 0.02, 0.5)).all()
    assert np.isnan(speeds_with_flywheel(inertia, work, 5.0, 3.0)).all()


# Wittenbauer: exact


@few
@given(seeds, st.floats(-3, 3).map(lambda e: 10.0**e), st.floats(1e-6, 1.9), powers)
def test_wittenbauer__finds_the_flywheel_of_a_known_motion(seed, wheel, delta, omega):
    inertia, _ = random_loop(seed)
    # ω runs through its whole range as ω_m (1 + ½δ cos φ); the work that makes it do so is its kinetic energy's change.
    speed = omega * (1 + delta / 2 * np.cos(nodes))
    energy = 0.5 * (inertia + wheel) * speed**2
    found = flywheel_sizes(inertia, energy - energy[0], omega, delta, 1.0)[3]
    assert found == pytest.approx(wheel, abs=20 * EPS * (1 + wheel) / delta)
    _, slowest, fastest = speeds_with_flywheel(inertia, energy - energy[0], wheel, omega)
    assert fastest - slowest == pytest.approx(delta * omega, abs=1e-12 * omega)


@few
@given(seeds, st.floats(1e-4, 0.5))
def test_wittenbauer__agrees_with_root_finding(seed, delta):
    inertia, work = random_loop(seed)

    def excess_fluctuation(wheel):
        slowest, fastest = speeds_by_root_finding(inertia, work, wheel, 1.0)
        return (fastest - slowest) - delta

    wheel = flywheel_sizes(inertia, work, 1.0, delta, 1.0)[3]
    top = 10 * (np.ptp(work) / delta + 1)
    # Without a flywheel it may need none; the least inertia that has a motion at all then isn't bracketed.
    assume(wheel > 0.5 * np.ptp(work))
    found = brentq(excess_fluctuation, 0.9 * wheel, top, rtol=1e-13)
    # δ is a difference of speeds known to 1e-15, so it is known to 1e-15/δ.
    assert wheel == pytest.approx(found, rel=1e-13 + 1e-14 / delta)


@few
@given(seeds, powers, st.floats(-8, -0.3).map(lambda e: 10.0**e))
def test_round_trip__gives_the_fluctuation_asked_for(seed, omega, delta):
    inertia, work = random_loop(seed)
    wheel = flywheel_sizes(inertia, work, omega, delta, 1.0)[3]
    energy, slowest, fastest = speeds_with_flywheel(inertia, work, max(wheel, 0.0), omega)
    reached = (fastest - slowest) / omega
    # Speeds are known to a few roundings, whatever δ is.
    if wheel > 0:
        assert reached == pytest.approx(delta, abs=20 * EPS)
        speed = np.empty(720)
        speed_row(inertia, work, wheel, energy, speed)
        assert (speed.max(), speed.min()) == pytest.approx((fastest, slowest), rel=10 * EPS)
    elif not math.isnan(reached):
        assert reached <= delta + 20 * EPS


@few
@given(seeds, st.floats(0, 100), st.floats(0.3, 30))
def test_speed_with_flywheel__agrees_with_root_finding(seed, wheel, omega):
    inertia, work = random_loop(seed)
    _, slowest, fastest = speeds_with_flywheel(inertia, work, wheel, omega)
    expected = speeds_by_root_finding(inertia, work, wheel, omega)
    # Close to a standstill the least speed is the root of a small difference, and whether it stops is rounding.
    assume(not slowest < 1e-3 * omega and not expected[0] < 1e-3 * omega)
    assert (slowest, fastest) == pytest.approx(expected, rel=1e-9, nan_ok=True)


# Merzalov and the excess work: approximations


@few
@given(seeds, st.floats(1e-6, 1.5), powers)
def test_merzalov__stays_within_the_inertia_it_neglects(seed, delta, omega):
    inertia, work = random_loop(seed)
    first_kind = 0.25
    _, _, merzalov, wittenbauer = flywheel_sizes(inertia, work, omega, delta, first_kind)
    # It takes ½ω_m²I for ½ω_max²I and ½ω_min²I; the difference of the two is δω_m²I, with I between its extremes.
    error = merzalov + first_kind - wittenbauer
    slack = 20 * EPS * (abs(wittenbauer) + 1) / delta
    assert inertia.min() - slack <= error <= inertia.max() + slack


@few
@given(seeds)
def test_merzalov__tends_to_the_exact_flywheel(seed):
    inertia, work = random_loop(seed)
    differences = []
    for delta in (1e-2, 1e-3, 1e-4):
        _, _, merzalov, wittenbauer = flywheel_sizes(inertia, work, 3.0, delta, 0.0)
        differences.append(merzalov / wittenbauer - 1)
    # What is neglected is I, of what grows as 1/δ: the relative difference is of the order of δ.
    assert differences[1] / differences[0] == pytest.approx(0.1, rel=0.6)
    assert differences[2] / differences[1] == pytest.approx(0.1, rel=0.3)


# Whole machines


def press(flywheel, force):
    scene = slider_crank(
        speed=100.0,
        bodies={"wheel": {"link": "crank", "mass": 5, "inertia": 0.02}, "ram": {"link": "ram", "mass": 1.5}},
        forces={"F": {"on": "B", "angle": 0.0} | force},
        flywheel=flywheel,
    )
    return Scene.model_validate(scene)


DRAG = {"type": "linear_drag", "coefficient": 30.0}
STEPS = {
    "type": "table",
    "slider": "ram",
    "measured_from": "high end",
    "over_stroke": [0, 0.02, 0.02, 0.05],
    "force": [-2000, -2000, -500, -500],
    "interpolation": "linear",
    "outside": "zero",
    "acts": "along",
}
SIZES = ["flywheel_excess_work", "flywheel_merzalov", "flywheel_wittenbauer"]
ASKED = ["excess_work", *SIZES, "speed_fluctuation", "speed_min", "speed_max"]
ASKED += ["required_drive_moment", "required_power"]
VARIED = ["groups.g.first.length", "bodies.ram.mass", "input.speed", "flywheel.speed_fluctuation"]


def random_variants(seed, variants=100):
    rng = np.random.default_rng(seed)
    values = (
        rng.uniform(0.07, 0.4, variants),
        rng.uniform(0.1, 3, variants),
        rng.uniform(10, 300, variants),
        10.0 ** rng.uniform(-8, -0.3, variants),
    )
    return dict(zip(VARIED, values, strict=True))


def evaluate(force, varied, positions=720):
    scene = press({"speed_fluctuation": 0.02}, force)
    return Machine(scene, ASKED, varied=list(varied), positions=positions).evaluate(varied)


@pytest.mark.parametrize(("mass", "delta"), [(1.5, 0.02), (3.0, 0.2)])
def test_machine__moves_with_the_fluctuation_asked_for(mass, delta):
    varied = {"bodies.ram.mass": np.array([mass]), "flywheel.speed_fluctuation": np.array([delta])}
    outcome = evaluate(DRAG, varied, positions=2880)
    wheel, drive = (outcome.summaries[k][0] for k in ("flywheel_wittenbauer", "required_drive_moment"))
    r, length, omega, coefficient = 0.05, 0.2, 100.0, 30.0

    def transfer(phi):
        s, c = math.sin(phi), math.cos(phi)
        root = math.sqrt(length**2 - (r * s) ** 2)
        first = -r * s - r * r * s * c / root
        return first, -r * c - r * r * (c * c - s * s) / root - (r * r * s * c) ** 2 / root**3

    def slope(phi, speed):
        first, second = transfer(phi)
        inertia = 0.02 + wheel + mass * first**2
        moment = drive - coefficient * omega * first**2
        return (moment - speed**2 * mass * first * second) / (inertia * speed)

    def motion(start):
        path = solve_ivp(slope, (0, 2 * math.pi), [start], method="DOP853", rtol=1e-12, atol=1e-12, dense_output=True)
        return path.sol(np.linspace(0, 2 * math.pi, 20_001))[0]

    start = brentq(lambda s: (motion(s).max() + motion(s).min()) / 2 - omega, 0.8 * omega, 1.2 * omega, xtol=1e-10)
    speed = motion(start)
    assert speed[-1] == pytest.approx(speed[0], rel=1e-9)
    # The trapezoid rule in W and extremes between positions: (2h)²/12 + (2h)²/8 for a second harmonic, h = 2π/2880.
    assert np.ptp(speed) / omega == pytest.approx(delta, rel=5e-6)


def test_smooth_machine__converges_with_the_second_order():
    varied = random_variants(0)
    exact = evaluate(DRAG, varied, positions=23_040).summaries["flywheel_wittenbauer"]
    errors = []
    for positions in (90, 180, 360, 720):
        found = evaluate(DRAG, varied, positions).summaries["flywheel_wittenbauer"]
        errors.append(np.mean(np.abs(found - exact) / (np.abs(exact) + 0.01)))
    ratios = np.array(errors[:-1]) / errors[1:]
    # Where an extreme lies between two positions is chance, so the ratio is 4 in the mean over variants only.
    assert ratios == pytest.approx(4, rel=0.25)


@pytest.mark.parametrize(("force", "name"), [(DRAG, "smooth"), (STEPS, "steps")], ids=["smooth", "steps"])
@pytest.mark.parametrize("positions", [72, 360])
def test_error_figures__bound_the_errors(force, name, positions):
    varied = random_variants(1, 400)
    exact, found = evaluate(force, varied, 23_040), evaluate(force, varied, positions)
    for key in ASKED:
        error = np.abs(found.summaries[key] - exact.summaries[key])
        within = error <= found.errors[key] + exact.errors[key]
        # A fall-out is an extreme that fine and coarse positions miss alike: measured, none of 400.
        assert within.mean() >= 0.99, f"{key}, {name}: {within.mean():.1%} of errors are within their figures"


def test_negative_speed__needs_the_same_flywheel():
    varied = random_variants(2)
    forward = evaluate(DRAG, varied)
    backward = evaluate(DRAG, varied | {"input.speed": -varied["input.speed"]})
    for key in ASKED:
        sign = -1 if key == "required_drive_moment" else 1
        # Moments are mirrored by the sign of ω; rounding moves the speeds, and so δ, by parts of 1e-16.
        np.testing.assert_allclose(
            backward.summaries[key], sign * forward.summaries[key], rtol=1e-9, atol=20 * EPS, err_msg=key
        )
        np.testing.assert_array_less(-1e-300, backward.errors[key])


def test_tiny_fluctuation__is_reached_and_its_error_is_honest():
    varied = {"flywheel.speed_fluctuation": np.array([1e-2, 1e-4, 1e-6, 1e-8])}
    outcome = evaluate(DRAG, varied)
    reached = outcome.summaries["speed_fluctuation"]
    error = np.abs(reached - varied["flywheel.speed_fluctuation"])
    # Of a δ of 1e-8 rounding of the speeds leaves 8 digits.
    assert (error <= 20 * EPS).all()
    assert (error <= outcome.errors["speed_fluctuation"]).all()
    wheels = outcome.summaries["flywheel_wittenbauer"]
    assert wheels[3] / wheels[2] == pytest.approx(100, rel=1e-4)
