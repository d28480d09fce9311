"""One mass on a spring: against mpmath's solution of its equation, integration, energy, and textbook values."""

import math

import mpmath
import numpy as np
import pytest
from each_case import refusals
from element_samples import element, figures, one, results
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from engine import Verdict

OSCILLATOR = {"type": "oscillator", "mass": 2.0, "stiffness": 800.0}
some = settings(max_examples=20)
ratios = st.one_of(st.floats(0.0, 3.0), st.sampled_from([0.0, 1.0, 1 - 1e-9, 1 + 1e-9, 1 - 1e-14, 1 + 1e-6, 50.0]))
starts = st.floats(-2.0, 2.0).filter(lambda x: x == 0 or abs(x) > 1e-6)


def free_exact(ratio, q, v, t, w=20.0):
    """Displacement and velocity with 50 digits, from the roots of the characteristic equation."""
    with mpmath.workdps(50):
        z, q, v, t, w = (mpmath.mpf(x) for x in (ratio, q, v, t, w))
        root = mpmath.sqrt(mpmath.mpc(z * z - 1))
        if root == 0:
            c = v + w * q
            return float(mpmath.exp(-w * t) * (q + c * t)), float(mpmath.exp(-w * t) * (c - w * (q + c * t)))
        a, b = w * (-z + root), w * (-z - root)
        first = (v - b * q) / (a - b)
        terms = first * mpmath.exp(a * t), (q - first) * mpmath.exp(b * t)
        return float(mpmath.re(sum(terms))), float(mpmath.re(a * terms[0] + b * terms[1]))


@some
@given(ratios, starts, starts, st.floats(0.0, 3.0))
def test_free_motion__is_that_of_the_roots_within_its_figure(ratio, q, v, t):
    data = OSCILLATOR | {"damping_ratio": ratio, "start": {"displacement": q, "velocity": v, "time": t}}
    found = figures(data, "free_displacement", "free_velocity")
    for (value, error), exact in zip(found, free_exact(ratio, q, v, t), strict=True):
        # 50 digits of numbers up to 1e3 leave 1e-46.
        assert abs(value - exact) <= error + 1e-46
        assert error <= 1e-6 * (abs(q) + abs(v)) + 1e-300


@some
@given(st.floats(0.0, 3.0).filter(lambda z: abs(z - 1) > 1e-6), starts, starts)
def test_greatest_free_displacement__is_not_passed_and_is_reached(ratio, q, v):
    data = OSCILLATOR | {"damping_ratio": ratio, "start": {"displacement": q, "velocity": v}}
    (greatest, _), (when, _) = figures(data, "free_greatest", "free_greatest_at")
    times = np.linspace(0, 1.0, 2001)
    moved = np.abs([free_exact(ratio, q, v, t)[0] for t in times[:: 2001 // 200]])
    assert moved.max() <= greatest * (1 + 1e-9)
    assert abs(free_exact(ratio, q, v, when)[0]) == pytest.approx(greatest, rel=1e-9, abs=1e-300)


@some
@given(st.floats(1e-4, 0.99))
def test_damping_given_in_four_ways__is_the_same(ratio):
    names = ["damping", "damping_ratio", "decrement", "energy_absorption"]
    values = one(OSCILLATOR | {"damping_ratio": ratio}, *names)
    for name, value in zip(names, values, strict=True):
        assert one(OSCILLATOR | {name: value}, *names) == pytest.approx(values, rel=1e-13)
    # Successive maxima of the free motion fall by the decrement.
    first, later = (free_exact(ratio, 1.0, 0.0, k * math.tau / (20 * math.sqrt(1 - ratio**2)))[0] for k in range(2))
    if later > 1e-200:
        assert values[2] == pytest.approx(math.log(first / later), rel=1e-9)


def steady_exact(eta, ratio, kind):
    """Complex amplitude over its unit, from the equation of motion with 50 digits."""
    with mpmath.workdps(50):
        eta, ratio = mpmath.mpf(eta), mpmath.mpf(ratio)
        push = {"force": 1, "unbalance": eta**2, "support_motion": 1 + 2j * ratio * eta}[kind]
        found = push / (1 - eta**2 + 2j * ratio * eta)
        return float(abs(found)), float(-mpmath.arg(found))


@some
@given(
    st.sampled_from(["force", "unbalance", "support_motion"]),
    st.one_of(st.floats(0.01, 5), st.sampled_from([1 - 1e-9, 1.0, 1 + 1e-12])),
    st.floats(1e-6, 2.0),
)
def test_forced_vibration__solves_the_equation_and_balances_work(kind, eta, ratio):
    excitation = {"type": kind, "speed": eta * 20.0}
    excitation |= {"mass": 0.1, "radius": 0.02} if kind == "unbalance" else {"amplitude": 3.0}
    unit = {"force": 3.0 / 800.0, "unbalance": 0.1 * 0.02 / 2.0, "support_motion": 3.0}[kind]
    data = OSCILLATOR | {"damping_ratio": ratio, "excitation": excitation}
    names = ["dynamic_factor", "amplitude", "phase_lag", "transmitted_force", "dissipated_power", "damping"]
    found = figures(data, *names)
    # The speed as the element is given it.
    factor, lag = steady_exact(float(excitation["speed"]) / 20.0, ratio, kind)
    assert abs(found[0][0] - factor) <= found[0][1]
    assert abs(found[2][0] - lag) <= found[2][1] + 1e-15
    amplitude, speed = found[1][0], eta * 20.0
    assert amplitude == pytest.approx(unit * factor, rel=1e-9)
    # Work of the force over a cycle against what the damper takes, and its force: all from complex amplitudes.
    q = unit * factor * np.exp(-1j * lag) - (unit if kind == "support_motion" else 0.0)
    force = (800.0 + 1j * speed * found[5][0]) * q
    assert found[3][0] == pytest.approx(abs(force), rel=1e-6)
    assert found[4][0] == pytest.approx(0.5 * found[5][0] * speed**2 * abs(q) ** 2, rel=1e-6)


@pytest.mark.parametrize("kind", ["force", "unbalance", "support_motion"])
@pytest.mark.parametrize("ratio", [0.01, 0.2, 0.6])
def test_resonance__is_the_greatest_of_all_speeds(kind, ratio):
    excitation = {"type": kind, "speed": 1.0}
    excitation |= {"mass": 0.1, "radius": 0.02} if kind == "unbalance" else {"amplitude": 3.0}
    data = OSCILLATOR | {"damping_ratio": ratio, "excitation": excitation}
    best, greatest = one(data, "resonance_speed", "resonance_amplitude")
    speeds = best * np.array([1 - 1e-4, 1.0, 1 + 1e-4])
    ((values, _),) = figures(data, "amplitude", excitation__speed=speeds)
    assert values[1] == pytest.approx(greatest, rel=1e-12)
    assert max(values[0], values[2]) < values[1]


def test_resonance_without_damping__is_a_status_never_a_number():
    data = OSCILLATOR | {"excitation": {"type": "force", "amplitude": 1.0, "speed": 20.0}}
    values, _, status = results(data, "amplitude", excitation__speed=[19.0, 20.0])
    assert list(status) == [Verdict.OK, Verdict.RESONANCE]
    assert np.isnan(values["amplitude"][1])
    assert values["amplitude"][0] > 0


def test_cantilever__carries_its_mass_with_3_e_i_over_l_cubed():
    beam = {"length": 0.4, "diameter": 0.03, "bore": 0.01, "elastic_modulus": 2.1e11}
    data = {"type": "oscillator", "mass": 5.0, "cantilever": beam}
    stiffness, frequency = one(data, "stiffness", "natural_frequency")
    expected = 3 * 2.1e11 * math.pi * (0.03**4 - 0.01**4) / 64 / 0.4**3
    assert stiffness == pytest.approx(expected, rel=1e-13)
    assert frequency == pytest.approx(math.sqrt(expected / 5.0), rel=1e-13)


ROTOR = OSCILLATOR | {
    "excitation": {"type": "unbalance", "mass": 0.1, "radius": 0.02, "speed": 30.0},
    "run_through": {"start": 40.0, "acceleration": -2.0},
}


def integrated_peak(ratio, start, acceleration, w=20.0):
    """Greatest amplitude over the eccentricity, by integration of the equation of motion."""
    beta = ratio * w
    steady = start**2 / (w**2 - start**2 + 2j * beta * start)

    def motion(t, y):
        speed = start + acceleration * t
        push = (speed**2 - 1j * acceleration) * np.exp(1j * (start + acceleration * t / 2) * t)
        return [y[1], push - 2 * beta * y[1] - w**2 * y[0]]

    end = (w - start) / acceleration + 8 / math.sqrt(abs(acceleration)) * max(
        1, 2 * beta / math.sqrt(abs(acceleration))
    )
    # A rotor that runs down stops.
    end = min(end, -start / acceleration) if acceleration < 0.0 else end
    times = np.linspace(0, end, 8001)
    found = solve_ivp(
        motion, (0, end), [steady + 0j, 1j * start * steady], method="DOP853", rtol=1e-10, atol=1e-11, t_eval=times
    )
    return np.abs(found.y[0]).max()


@pytest.mark.parametrize(
    ("ratio", "start", "acceleration"),
    [
        (0.02, 40.0, -2.0),
        (0.0, 0.0, 8.0),
        (0.3, 0.0, 3.0),
        (0.1, 24.0, -200.0),
        (0.005, 0.0, 40.0),
        (0.0042, 36.8, -26.4),
        (0.4, 30.0, -9.0),
    ],
)
def test_run_through_resonance__is_that_of_the_integrated_equation(ratio, start, acceleration):
    data = ROTOR | {"damping_ratio": ratio, "run_through": {"start": start, "acceleration": acceleration}}
    ((amplitude, error),) = figures(data, "run_through_amplitude")
    # The instants of the integration miss the top by less than 1e-6 of it.
    assert amplitude == pytest.approx(0.1 * 0.02 / 2 * integrated_peak(ratio, start, acceleration), rel=2e-6)
    assert 0 < error < 1e-9 * amplitude


def test_run_that_moves_away_from_the_resonance__has_no_amplitude():
    data = ROTOR | {"damping_ratio": 0.05, "run_through": {"start": 30.0, "acceleration": 2.0}}
    assert np.isnan(one(data, "run_through_amplitude")).all()


test_oscillator_that_cannot_be__says_what_to_mend = refusals(
    lambda change: element(OSCILLATOR | change),
    ({"stiffness": None}, "give stiffness or cantilever"),
    ({"damping": 1.0, "decrement": 0.1}, "damping and decrement are given"),
    ({"run_through": {"start": 1.0, "acceleration": 1.0}}, "give excitation with type = 'unbalance'"),
    (ROTOR | {"run_through": {"start": 1.0, "acceleration": 0.0}}, "the speed must change"),
    ({"stiffness": -1.0}, "greater than 0"),
)
