"""Balancing by trial runs: influence coefficients, what noise leaves, and simulated balancing machines."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from engine.balancing.rotors.balancing_machine import (
    RunDown,
    elastic_supports,
    natural_frequencies,
    run_down,
    steady_vibration,
    swinging_frame,
)
from engine.balancing.rotors.correction import correct, corrected
from engine.balancing.rotors.influence import (
    four_runs,
    influence_coefficients,
    influence_correction,
    joint_bound,
    residual_confidence,
)
from engine.balancing.rotors.trial_runs import balance_by_influence, balance_in_turn
from engine.balancing.rotors.unbalance import resultant

EPS = np.finfo(float).eps

few = settings(deadline=None, max_examples=40)
seeds = st.integers(0, 2**32 - 1)


def polar(amplitude, degrees):
    return amplitude * np.exp(1j * np.radians(degrees))


def complex_normal(rng, *shape):
    return rng.normal(size=shape) + 1j * rng.normal(size=shape)


# Influence coefficients


def test_rao_9_2__turbine_rotor_in_two_planes():
    """S. S. Rao, Mechanical Vibrations, example 9.2: vibrations in mils, weights in ounces."""
    initial = polar(np.array([8.5, 6.5]), [60, 205])
    trials = np.array([polar(np.array([6.0, 4.5]), [125, 230]), polar(np.array([6.0, 10.5]), [35, 160])])
    weights = polar(np.array([10.0, 12.0]), [270, 180])
    found = influence_correction(influence_coefficients(initial, trials, weights), initial)
    # The book gives six digits, from data in exact degrees: good to the last.
    assert np.abs(found) == pytest.approx([10.0561, 5.8774], abs=1e-4)
    assert np.degrees(np.angle(found)) % 360 == pytest.approx([325.5548, 68.2559], abs=1e-3)


@few
@given(seeds, st.integers(1, 4), st.integers(0, 3))
def test_influence__planted_unbalances_are_recovered(seed, planes, more):
    rng = np.random.default_rng(seed)
    machine = complex_normal(rng, 20, planes + more, planes)
    planted, weights = complex_normal(rng, 20, planes), complex_normal(rng, 20, planes)
    initial = np.einsum("vsp,vp->vs", machine, planted)
    trials = initial[:, None, :] + np.swapaxes(machine * weights[:, None, :], 1, 2)
    found = influence_correction(influence_coefficients(initial, trials, weights), initial)
    # The difference of two runs is good to roundings of the vibration; small trial weights and badly conditioned
    # machines pass them on.
    condition = np.linalg.cond(machine)[:, None]
    worst = np.abs(initial).max(axis=1) / np.abs(weights).min(axis=1) / np.linalg.norm(machine, 2, axis=(1, 2))
    bound = 1000 * EPS * condition * (1 + worst[:, None] * condition) * np.abs(planted).sum(axis=1, keepdims=True)
    assert (np.abs(found + planted) <= bound).all()


def test_influence__a_plane_that_is_not_felt_gives_no_number():
    coefficients = np.array([[[1, 2], [2, 4]], [[1, 2], [2, 5]], [[np.nan, 2], [2, 5]]], dtype=complex)
    found = influence_correction(coefficients, np.ones(2))
    assert np.isnan(found).all(axis=1).tolist() == [True, False, True]
    assert not np.isfinite(influence_coefficients([1.0], [[2.0]], [0.0])).any()


@few
@given(seeds)
def test_influence__more_readings_than_planes_leave_the_least_vibration(seed):
    """The residual is least where its projection on every influence vanishes."""
    rng = np.random.default_rng(seed)
    coefficients, initial = complex_normal(rng, 6, 2), complex_normal(rng, 6)
    left = initial + coefficients @ influence_correction(coefficients, initial)
    assert np.abs(np.conj(coefficients.T) @ left).max() <= 1e-12 * np.linalg.cond(coefficients) ** 2


# Noise


def noisy_residuals(rng, machine, planted, weights, sigma, runs):
    readings, planes = machine.shape
    clean = np.concatenate([[machine @ planted], (machine @ planted)[None, :] + (machine * weights).T])
    read = clean + sigma * complex_normal(rng, runs, planes + 1, readings)
    coefficients = influence_coefficients(read[:, 0], read[:, 1:], weights)
    return influence_correction(coefficients, read[:, 0]) + planted


@pytest.mark.parametrize(("planes", "readings", "size"), [(1, 1, 1.0), (2, 2, 0.3), (2, 2, 2.0), (2, 4, 1.0)])
def test_confidence__is_what_noisy_runs_leave(planes, readings, size):
    rng = np.random.default_rng(planes + 10 * readings)
    machine, planted = complex_normal(rng, readings, planes), complex_normal(rng, planes)
    weights = size * complex_normal(rng, planes)
    sigma, runs = 1e-4, 40_000
    residuals = noisy_residuals(rng, machine, planted, weights, sigma, runs)
    known = residual_confidence(machine, -planted, weights, sigma, 0.95)
    # Of 40 000 samples: a variance is known to 1/sqrt(40000) = 0.5 percent, a share of 0.95 to 0.0011; five of these,
    # and as the residuals are a few sigma in size, the second order in sigma is below 1e-3 of the first.
    sampled = residuals.T @ np.conj(residuals) / runs
    scale = np.sqrt(np.outer(*[np.diag(known.covariance).real] * 2))
    assert np.abs(sampled - known.covariance).max() <= (0.025 * scale).max()
    assert (np.abs(residuals) <= known.radii).mean(axis=0) == pytest.approx([0.95] * planes, abs=0.0055)
    joint = np.einsum("vi,ij,vj->v", np.conj(residuals), np.linalg.inv(known.covariance), residuals).real
    assert (joint <= joint_bound(planes, 0.9)).mean() == pytest.approx(0.9, abs=0.0075)


def test_confidence__of_one_plane_by_hand():
    # A = 2, trial weight equal to the correction: E|R|² = 2 sigma²/4, exceeded with exp(-r²/E|R|²).
    known = residual_confidence([[2.0]], [1.0], [1.0], 0.1, 0.5)
    assert known.covariance == pytest.approx(np.array([[0.005]]), rel=8 * EPS)
    assert known.radii == pytest.approx([math.sqrt(0.005 * math.log(2))], rel=8 * EPS)


# Four runs without phases


@few
@given(seeds)
def test_four_runs__find_unbalance_and_sensitivity(seed):
    rng = np.random.default_rng(seed)
    planted, weight, a = complex_normal(rng, 10), rng.uniform(0.5, 2, 10), rng.uniform(0.01, 100, 10)
    added = weight[:, None] * np.exp(2j * math.pi / 3 * np.arange(3))
    found = four_runs(a * np.abs(planted), a[:, None] * np.abs(planted[:, None] + added), weight)
    # The squares' mean cancels down to a²W²: roundings grow by (1 + |U|²/W²).
    scale = 50 * EPS * (1 + np.abs(planted) ** 2 / weight**2)
    assert (np.abs(found.unbalance - planted) <= scale * (1 + np.abs(planted)) * (1 + weight)).all()
    assert (np.abs(found.sensitivity - a) <= scale * a).all()


def test_four_runs__that_no_machine_gives_are_no_numbers():
    assert np.isnan(four_runs(2.0, [1.0, 1.0, 1.0], 1.0)).all()


# Machines

SUPPORTS = elastic_supports(40.0, 1.6, 0.3, [0.0, 0.7], [2.0e5, 2.6e5], [150.0, 180.0])
PLANTED, AT = np.array([4e-4 + 1e-4j, -2e-4 + 3e-4j, 1e-4j]), np.array([0.05, 0.35, 0.6])
PLANES = np.array([0.1, 0.55])
RUN = RunDown(start=200.0, stop=120.0, inertia=0.5, constant=4.0, viscous=0.01)


def test_supports__natural_frequencies_of_a_symmetric_rotor():
    # Bounce √(2k/m) and tilting √(2k a²/J).
    symmetric = elastic_supports(10.0, 0.1, 0.0, [-0.2, 0.2], [1e5, 1e5], [0, 0])
    expected = [math.sqrt(2e5 / 10), math.sqrt(2e5 * 0.04 / 0.1)]
    assert natural_frequencies(symmetric) == pytest.approx(expected, rel=16 * EPS)


def test_supports__soft_ones_let_the_rotor_turn_about_its_centre_of_mass():
    # Far above resonance x = -e: the axis runs round the centre of mass.
    soft = elastic_supports(10.0, 0.1, 0.0, [-0.2, 0.2], [1.0, 1.0], [0, 0])
    found = steady_vibration(soft, 1000.0, [2e-3], [0.0], [0.0])
    # k/(m omega²) = 2e-7.
    assert found == pytest.approx([-2e-4], rel=1e-6)


def test_run_down__through_resonance_agrees_with_the_convolution_integral():
    frame = swinging_frame(2.0, 0.0, 2.0 * 80.0**2, 2 * 0.03 * 2.0 * 80.0)
    run = RunDown(start=110.0, stop=60.0, inertia=1.0, constant=25.0)
    unbalances, z = np.array([3e-4 + 2e-4j]), [0.5]
    readings = run_down(frame, run, unbalances, z, [1.0])
    phi = math.tau / 64 * np.arange(64 * (len(readings.speeds) + 5))
    x = frame_motion(frame, run, (unbalances * z).sum(), phi)
    window = np.hanning(2 * 6 * 64 + 1)[1::2]
    for k, found in enumerate(readings.vibrations[:, 0]):
        turns = slice(64 * k, 64 * (k + 6))
        expected = 2 * (window * x[turns] * np.exp(-1j * phi[turns])).sum() / window.sum()
        # DOP853 at 1e-9 a step over some hundred steps.
        assert abs(found - expected) <= 1e-6 * np.abs(readings.vibrations).max()


def frame_motion(frame, run, drive, phi):
    """Angle of a frame with a rotor that slows down evenly, by the convolution integral with its impulse response."""
    m, c, k = (matrix[0, 0] for matrix in (frame.mass, frame.damping, frame.stiffness))
    e, d = -run.constant / run.inertia, c / m / 2
    w = math.sqrt(k / m - d * d)
    times = (np.sqrt(run.start**2 + 2 * e * phi) - run.start) / e
    # Gauss quadrature with 8 nodes in each 64th of a turn: exact to rounding.
    nodes, weights = np.polynomial.legendre.leggauss(8)
    half = np.diff(times)[:, None] / 2
    t = times[:-1, None] + half * (1 + nodes)
    angle, omega = run.start * t + e * t * t / 2, run.start + e * t
    force = ((omega**2 - 1j * e) * drive * np.exp(1j * angle)).real
    pieces = (half * weights * force * np.exp((d - 1j * w) * t)).sum(axis=1)
    driven = np.exp((-d + 1j * w) * times) * np.concatenate([[0], np.cumsum(pieces)])
    start = run.start**2 * drive / (k - run.start**2 * m + 1j * run.start * c)
    x0, v0 = start.real, (1j * run.start * start).real
    free = np.exp(-d * times) * (x0 * np.cos(w * times) + (v0 + d * x0) / w * np.sin(w * times))
    return free + driven.imag / (m * w)


def test_run_down__so_slow_that_it_is_steady_at_every_speed():
    run = RunDown(start=80.0, stop=60.0, inertia=1.0, constant=0.5)
    readings = run_down(SUPPORTS, run, PLANTED, AT, [0.0, 0.7])
    exact = steady_vibration(SUPPORTS, 70.0, PLANTED, AT, [0.0, 0.7])
    # The amplitude lags by about e/(w - omega)², here 0.5/(102 - 70)² = 5e-4.
    assert readings.at(70.0) == pytest.approx(exact, rel=2e-3)
    assert np.isnan(readings.at(90.0)).all()


def test_run_down__peaks_near_resonance_and_the_higher_the_slower_it_passes():
    frame = swinging_frame(2.0, 0.0, 2.0 * 80.0**2, 2 * 0.02 * 2.0 * 80.0)
    runs = [run_down(frame, RunDown(120.0, 50.0, 1.0, moment), [3e-4], [0.5], [1.0]) for moment in (5.0, 50.0)]
    slow, fast = (np.abs(run.vibrations[:, 0]) for run in runs)
    steady = abs(steady_vibration(frame, 80.0, [3e-4], [0.5], [1.0])[0])
    assert fast.max() < slow.max() < steady
    assert abs(runs[0].peaks()[0]) == slow.max()
    # A run-down peaks below resonance, the later the faster it passes.
    assert natural_frequencies(frame) == pytest.approx([80.0])
    assert runs[1].speeds[fast.argmax()] < runs[0].speeds[slow.argmax()] < 80.0


@pytest.mark.parametrize(
    "run",
    [RunDown(100.0, 120.0, 1.0, 1.0), RunDown(100.0, 50.0, 1.0, -1.0), RunDown(100.0, 99.0, 1.0, 1e4)],
)
def test_run_down__that_does_not_run_down_is_refused(run):
    with pytest.raises(ValueError, match="take the 6 turns"):
        run_down(SUPPORTS, run, PLANTED, AT, [0.0])


def test_two_plane_machine__recovers_the_correction_from_a_run_down_and_two_trial_runs():
    def read(added):
        everything, z = np.concatenate([PLANTED, added]), np.concatenate([AT, PLANES])
        return run_down(SUPPORTS, RUN, everything, z, [0.0, 0.7]).at(150.0)

    found = balance_by_influence(read, [2e-4, 2e-4j])
    exact = correct(resultant(PLANTED, AT), PLANES)
    # V changes by 0.007 of itself in a turn here, of which the window lets about a thousandth through.
    assert found.corrections == pytest.approx(exact, rel=2e-5)
    assert np.abs(read(found.corrections)).max() < 2e-5 * np.abs(found.initial).max()


def test_swinging_frame__feels_no_unbalance_in_the_plane_of_its_axis():
    frame = swinging_frame(2.0, PLANES[1], 2.0 * 80.0**2, 10.0)
    assert steady_vibration(frame, 100.0, [1e-3], [PLANES[1]], [0.0]) == 0


def test_swinging_frame__balances_one_plane_and_turned_round_the_other_by_peaks_alone():
    def read(plane, added):
        frame = swinging_frame(2.0, PLANES[1 - plane], 2.0 * 80.0**2, 12.0)
        run = RunDown(start=130.0, stop=50.0, inertia=0.5, constant=20.0)
        everything, z = np.concatenate([PLANTED, added]), np.concatenate([AT, PLANES])
        return abs(run_down(frame, run, everything, z, [PLANES[plane]]).peaks()[0])

    found = balance_in_turn(read, [2e-4, 2e-4])
    rotor = resultant(PLANTED, AT)
    # In resonance V changes by half of itself in a turn, of which the window lets about a thousandth through.
    assert found == pytest.approx(correct(rotor, PLANES), rel=1e-3)
    left = corrected(rotor, found, PLANES)
    assert abs(left.unbalance) < 1e-3 * np.abs(PLANTED).sum()
