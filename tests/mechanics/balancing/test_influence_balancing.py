"""Balancing by trial runs: influence coefficients, amplitudes alone, and what noise leaves."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.special import gammaincinv

from engine.elements.rotors.influence import (
    four_runs,
    influence_coefficients,
    influence_correction,
    residual_confidence,
)

EPS = np.finfo(float).eps

few = settings(max_examples=25)
seeds = st.integers(0, 2**32 - 1)


def complex_normal(rng, *shape):
    return rng.normal(size=shape) + 1j * rng.normal(size=shape)


# Influence coefficients


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
    # Half a chi-squared variable with two degrees of freedom for each plane.
    assert (joint <= gammaincinv(planes, 0.9)).mean() == pytest.approx(0.9, abs=0.0075)


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
