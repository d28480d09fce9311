import math

import numpy as np
import pytest
import scipy.special as sp
from cycle_machines import ORDERS, peak_curve, planned, rounding_curves, smooth, smooth_numbers, wave_curve

from engine.cycle.cycle_machine import CycleMachine

TURN = 2.0 * math.pi


@pytest.fixture(scope="module")
def curves():
    """Smooth curves of many eccentricities and phases."""
    rng = np.random.default_rng(1)
    return rng.uniform(0.01, 0.9, 3000), rng.uniform(0.0, TURN, 3000)


def evaluated(curves, tolerance):
    machine = smooth(integrals=(0, 1, 2, 3), extremes=(0, 1, 2, 3), tolerance=tolerance)
    return machine.evaluate(smooth_numbers(*curves))


def covered(found, error, exact):
    return np.abs(found - exact) <= error


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10, 1e-13])
def test_integrals_and_their_errors_against_closed_forms(curves, tolerance):
    e, _ = curves
    found = evaluated(curves, tolerance).integrals
    # ∫ 1/(1 + e cos x) = 2π/√(1 − e²); ∫ √(1 − e² sin² x) = 4 E(e); ∫ cos = 0.
    exact = np.array([TURN / np.sqrt(1.0 - e**2), 4.0 * sp.ellipe(e**2), np.zeros(e.size), np.full(e.size, 2.5 * TURN)])
    scale = np.array([[1.0 / (1.0 - e.max())], [1.0], [1.0], [2.5]])
    # What is left beyond a series is less than the tolerance, and what an integral misses less than a tenth of that.
    assert np.all(np.abs(found.value - exact) <= TURN * scale * (0.1 * tolerance + 4e-16))
    assert np.mean(covered(found.value, found.error, exact)) > 0.999
    true = np.abs(found.value[0] - exact[0])
    told = true > 1e-13
    if told.any():
        assert np.median(found.error[0][told] / true[told]) < 10.0


@pytest.mark.parametrize("tolerance", [1e-4, 1e-7, 1e-10])
def test_extremes_and_their_errors_against_closed_forms(curves, tolerance):
    e, phase = curves
    found = evaluated(curves, tolerance).extremes
    least = np.array([1.0 / (1.0 + e), np.sqrt(1.0 - e**2), -np.ones(e.size)])
    greatest = np.array([1.0 / (1.0 - e), np.ones(e.size), np.ones(e.size)])
    assert np.mean(covered(found.least.value[:3], found.least.error[:3], least)) > 0.999
    assert np.mean(covered(found.greatest.value[:3], found.greatest.error[:3], greatest)) > 0.999
    for side, at in ((found.greatest_at, phase), (found.least_at, phase + math.pi)):
        apart = np.abs(np.remainder(side.value[2] - at + math.pi, TURN) - math.pi)
        assert np.mean(apart <= side.error[2] + 1e-14) > 0.999
    off = np.abs(found.greatest.value[0] - greatest[0])
    told = off > 1e-13
    assert np.median(found.greatest.error[0][told] / off[told]) < 10.0


def test_a_constant_curve_is_found_constant_exactly(curves):
    found = evaluated(curves, 1e-10)
    assert np.all(found.extremes.least.value[3] == 2.5)
    assert np.all(found.extremes.greatest.value[3] == 2.5)
    assert np.all(found.extremes.range.value[3] == 0.0)


def test_a_finer_tolerance_takes_more_panels(curves):
    coarse, fine = evaluated(curves, 1e-4).panels, evaluated(curves, 1e-13).panels
    assert np.all(fine >= coarse)
    assert fine.mean() > 1.3 * coarse.mean()


def test_ranges_that_differ_and_run_backwards():
    rng = np.random.default_rng(3)
    first, last = rng.uniform(-4.0, 4.0, 500), rng.uniform(-4.0, 4.0, 500)
    phase = rng.uniform(0.0, TURN, 500)
    found = smooth(integrals=(2,), extremes=(2,)).evaluate(smooth_numbers(0.3, phase, first, last))
    exact = np.sin(last - phase) - np.sin(first - phase)
    assert np.all(np.abs(found.integrals.value[0] - exact) <= found.integrals.error[0])
    assert np.all(found.integrals.error[0] < 1e-13)
    dense = np.cos(np.linspace(first, last, 20001) - phase)
    assert np.all(found.extremes.greatest.value[0] >= dense.max(0) - 1e-14)
    assert np.all(found.extremes.greatest.value[0] <= dense.max(0) + 1e-6)


def test_what_is_not_finite_is_told_with_its_first_position_and_spoils_no_other_variant():
    # The root is real as long as e sin x is at most 1.
    e, phase = np.array([0.5, 1.25, 0.5, np.nan]), np.zeros(4)
    found = smooth(integrals=(1, 2), extremes=(1, 2)).evaluate(smooth_numbers(e, phase))
    assert np.array_equal(np.isnan(found.integrals.value[0]), [False, True, False, True])
    assert np.array_equal(np.isnan(found.extremes.least.value[0]), [False, True, False, True])
    assert np.array_equal(np.isnan(found.extremes.greatest_at.error[0]), [False, True, False, True])
    assert np.allclose(found.integrals.value[0, ::2], 4.0 * sp.ellipe(0.25), rtol=1e-14)
    assert np.isnan(found.broken_at[[0, 2]]).all()
    # Positions lie no more than a tenth of a panel apart.
    assert 0.0 <= found.broken_at[1] - math.asin(0.8) < 0.13
    assert found.broken_at[3] == 0.0


def test_a_range_that_is_unknown_gives_nothing():
    found = smooth(integrals=(2,), extremes=(2,)).evaluate(smooth_numbers(0.3, 0.0, np.array([0.0, np.nan]), TURN))
    assert np.array_equal(np.isnan(found.extremes.greatest.value[0]), [False, True])
    assert np.array_equal(found.panels > 0, [True, False])


def test_a_record_longer_than_foreseen(monkeypatch):
    monkeypatch.setattr("engine.cycle.cycle_machine._SLOTS", 0)
    # e so near 1 that dozens of panels are needed.
    e = np.array([0.2, 0.999999])
    found = smooth(integrals=(0,), extremes=(0,), tolerance=1e-12).evaluate(smooth_numbers(e, 1.0))
    assert found.panels[1] > 24
    exact = TURN / np.sqrt((1.0 - e) * (1.0 + e))
    assert np.allclose(found.integrals.value[0], exact, rtol=1e-10)
    assert np.allclose(found.extremes.greatest.value[0], 1.0 / (1.0 - e), rtol=1e-8)


def test_extremes_of_waves_with_many_tops():
    rng = np.random.default_rng(7)
    parts = rng.normal(size=(2 * (ORDERS - 1), 1500))
    numbers = np.vstack([np.zeros(1500), np.full(1500, TURN), parts])
    plan = planned(ends=(0, 1), curves=1, extremes=(0,), tolerance=1e-12)
    found = CycleMachine(plan, wave_curve()).evaluate(numbers).extremes
    q = np.linspace(0.0, TURN, 2881)
    k = np.arange(1, ORDERS)[:, None] * q
    waves = np.einsum("kv,kq->vq", parts[0::2], np.cos(k)) + np.einsum("kv,kq->vq", parts[1::2], np.sin(k))
    for sign, side, at in ((1.0, found.greatest, found.greatest_at), (-1.0, found.least, found.least_at)):
        value, place = sign * side.value[0], at.value[0]
        # A parabola through three of the positions, 0.002 rad apart, is off by some 1e-7.
        here = np.argmax(sign * waves[:, 1:-1], axis=1) + 1
        a, b, c = (np.take_along_axis(sign * waves, here[:, None] + i, axis=1)[:, 0] for i in (-1, 0, 1))
        top = b + 0.125 * (c - a) ** 2 / (2.0 * b - a - c)
        assert np.all(np.abs(value - top) < 1e-6)
        at_place = np.arange(1, ORDERS)[:, None] * place
        there = (parts[0::2] * np.cos(at_place) + parts[1::2] * np.sin(at_place)).sum(axis=0)
        assert np.mean(np.abs(value - sign * there) <= side.error[0] + 2e-15 * np.abs(parts).sum(axis=0)) > 0.999


def test_rounding_takes_few_panels_and_narrow_peaks_as_many_as_they_need():
    rounding = CycleMachine(planned(ends=(0, 1), curves=2, integrals=(0, 1), tolerance=1e-11), rounding_curves())
    found = rounding.evaluate(np.array([np.zeros(2), np.full(2, TURN)]))
    assert np.all(found.panels <= 60)
    # Half a unit in the last place of what was added up before it was taken away again.
    assert np.all(np.abs(found.integrals.value[:, 0]) <= TURN * np.array([1e3 * 2.3e-16, 0.6e-10]))
    assert np.all(found.integrals.error[:, 0] < TURN * np.array([1e3 * 6e-16, 1e-10]))
    peaks = CycleMachine(planned(ends=(0, 1), curves=1, integrals=(0,), extremes=(0,), tolerance=1e-11), peak_curve())
    rng = np.random.default_rng(8)
    phase, width = rng.uniform(0.0, TURN, 200), 10.0 ** rng.uniform(-6.0, -1.0, 200)
    numbers = np.array([np.zeros(200), np.full(200, TURN), width, np.cos(phase), np.sin(phase)])
    found = peaks.evaluate(numbers)
    # ∫ 1/(1 + w − cos x) = 2π/√(w (2 + w)); 1 − cos is rounded to 1e-16 of what may be as small as w.
    exact = TURN / np.sqrt(width * (2.0 + width))
    assert np.all(np.abs(found.integrals.value[0] / exact - 1.0) < 1e-15 / width + 1e-11)
    greatest = found.extremes.greatest
    assert np.all(np.abs(greatest.value[0] * width - 1.0) < 1e-15 / width + 1e-10)
    # Rounding is amplified at the peak alone, which is anywhere.
    assert np.all(covered(greatest.value[0], greatest.error[0], 1.0 / width))
    # Over a short range the ends of the shortest panels round.
    phase, width = rng.uniform(-1.0, 1.0, 500), 10.0 ** rng.uniform(-16.0, -10.0, 500)
    beside = 1e-3 * rng.uniform(0.1, 1.0, (2, 500))
    short = peaks.evaluate(np.array([phase - beside[0], phase + beside[1], width, np.cos(phase), np.sin(phase)]))
    assert np.all(short.panels <= 60)
