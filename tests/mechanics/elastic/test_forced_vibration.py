"""Forced vibration of trains: against dense matrices, energy, sampled sums, rigid limits and an engine's own torque."""

import math

import numpy as np
import pytest
from element_samples import element, results, solved
from engine_samples import EPS
from hypothesis import example, given, settings
from hypothesis import strategies as st
from train_samples import BRANCHED, chain, matrices

from engine import Verdict, engine_torque
from engine.elements.torsional_trains.order_sums import extremes_of_orders

some = settings(max_examples=15)


def harmonic(on, order, amplitude, phase=0.0):
    return {"on": on, "order": order, "amplitude": amplitude, "phase": phase}


def dense(train, excitations):
    """Complex amplitudes of all masses for each order, by the matrices of the gear constraints."""
    found = {}
    for e in excitations:
        frequency = e["order"] * train["speed"]
        _, _, dynamic, basis = matrices(train, frequency)
        push = np.array([e["amplitude"] * np.exp(1j * e.get("phase", 0.0)) * (m == e["on"]) for m in train["masses"]])
        found[e["order"]] = found.get(e["order"], 0) + basis @ np.linalg.solve(dynamic, basis.T @ push)
    return {order: dict(zip(train["masses"], angles, strict=True)) for order, angles in found.items()}


def over_time(amplitudes, turns=2):
    """Values of Σ Re A e^(i h φ), finely sampled over some revolutions."""
    phi = np.linspace(0, turns * math.tau, 200_001)
    return sum((a * np.exp(1j * h * phi)).real for h, a in amplitudes.items())


EXCITED = [
    harmonic("motor", 2, 30.0),
    harmonic("table", 0.5, 400.0, 0.7),
    harmonic("fan", 3, -25.0, 2.0),
    harmonic("motor", 3, 10.0),
]


@pytest.mark.parametrize("grounded", [False, True])
def test_vibration_of_a_branched_train__is_that_of_the_dense_matrices(grounded):
    train = BRANCHED | {"excitations": {f"e{i}": e for i, e in enumerate(EXCITED)}}
    if grounded:
        bar = {"between": ["frame", "table"], "stiffness": 5e4, "damping": 2.0, "energy_absorption": 0.1}
        train = train | {"shafts": train["shafts"] | {"bar": bar}}
    angles, found = dense(train, EXCITED), solved(train)
    lost = 0.0
    for mass, data in train["masses"].items():
        swing = over_time({h: a[mass] for h, a in angles.items()})
        # Sampling misses the top by less than (π · 3/50000)²/2.
        assert found[f"{mass}.amplitude"][0] == pytest.approx(np.ptp(swing) / 2, rel=1e-7)
        lost += sum(0.5 * data.get("damping", 0.0) * abs(h * 40.0 * a[mass]) ** 2 for h, a in angles.items())
    for name, shaft in train["shafts"].items():
        stiffness, damping = shaft["stiffness"], shaft.get("damping", 0.0)
        moments = {}
        for h, a in angles.items():
            held = stiffness * (1 + 1j * shaft.get("energy_absorption", 0.0) / math.tau) + 1j * h * 40.0 * damping
            first, second = (0.0 if end == "frame" else a[end] for end in shaft["between"])
            moments[h] = held * (first - second)
            lost += 0.5 * h * 40.0 * held.imag * abs(first - second) ** 2
        swing = over_time(moments)
        assert found[f"{name}.alternating_moment"][0] == pytest.approx(np.ptp(swing) / 2, rel=1e-7)
        assert found[f"{name}.greatest_moment"][0] == pytest.approx(np.abs(swing).max(), rel=1e-7)
        assert found[f"{name}.mean_moment"][0] == 0.0
    # What the moments put in over a cycle, by the angles of the dense matrices.
    put_in = 0.0
    for e in EXCITED:
        turned = np.exp(-1j * e["phase"]) * angles[e["order"]][e["on"]]
        put_in -= 0.5 * e["order"] * 40.0 * e["amplitude"] * turned.imag
    assert found["dissipated_power"][0] == pytest.approx(lost, rel=1e-9)
    assert found["dissipated_power"][0] == pytest.approx(put_in, rel=1e-9)


@some
@given(
    st.lists(st.floats(-2, 2), min_size=4, max_size=4),
    st.lists(st.floats(2, 7), min_size=3, max_size=3),
    st.floats(-1, 3),
    st.floats(0, 0.3),
)
def test_figures_of_amplitudes_and_moments__hold_against_50_digits(inertias, stiffnesses, speed, absorption):
    mpmath = pytest.importorskip("mpmath")
    inertias, stiffnesses, speed = [10.0**x for x in inertias], [10.0**x for x in stiffnesses], 10.0**speed
    train = chain(inertias, stiffnesses, speed=speed, excitations={"e": harmonic("m0", 2, 5.0)})
    for shaft in train["shafts"].values():
        shaft["energy_absorption"] = absorption
    with mpmath.workdps(50):
        w = 2 * mpmath.mpf(speed)
        matrix = mpmath.matrix(4)
        for i, inertia in enumerate(inertias):
            matrix[i, i] -= w**2 * mpmath.mpf(inertia)
        held = [mpmath.mpf(k) * (1 + 1j * mpmath.mpf(absorption) / (2 * mpmath.pi)) for k in stiffnesses]
        for i, k in enumerate(held):
            for a, b, sign in ((i, i, 1), (i + 1, i + 1, 1), (i, i + 1, -1), (i + 1, i, -1)):
                matrix[a, b] += sign * k
        q = mpmath.lu_solve(matrix, mpmath.matrix([5.0, 0, 0, 0]))
        angles = [float(abs(x)) for x in q]
        moments = [float(abs(k * (q[i] - q[i + 1]))) for i, k in enumerate(held)]
    found = solved(train)
    for i, exact in enumerate(angles):
        value, error = found[f"m{i}.amplitude"]
        assert abs(value - exact) <= error
    for i, exact in enumerate(moments):
        value, error = found[f"s{i}.alternating_moment"]
        assert abs(value - exact) <= error


def test_resonance_without_damping__is_a_status_and_with_damping_a_number():
    # ω² = 1e4 · (1 + 1)/(1 · 1) / 2: the order's frequency is exactly 100.
    train = chain([1.0, 1.0], [5e3], speed=50.0, excitations={"e": harmonic("m0", 2, 1.0)})
    values, _, status = results(train, "s0.alternating_moment", speed=[49.0, 50.0, 51.0])
    assert list(status) == [Verdict.OK, Verdict.RESONANCE, Verdict.OK]
    assert np.isnan(values["s0.alternating_moment"][1])
    train["shafts"]["s0"]["damping"] = 0.5
    # At resonance the damper carries all: amplitude of the twist m/(w b) · share, moment with the damper's part.
    twist = 0.5 / (0.5 * 100.0)
    expected = twist * math.hypot(5e3, 0.5 * 100.0)
    assert solved(train, "s0.alternating_moment")["s0.alternating_moment"][0] == pytest.approx(expected, rel=1e-11)


def test_mean_moments_between_two_ends_held__share_by_the_stiffnesses_alone():
    """Hysteresis absorbs energy in cycles only, whatever share of it a shaft has."""
    train = chain([1.0, 1.0], [2e3], speed=50.0, excitations={"e": harmonic("m0", 0, 7.0)})
    train["shafts"]["s0"]["energy_absorption"] = 0.8
    for k, stiffness in enumerate((1e3, 3e3)):
        train["shafts"][f"held{k}"] = {"between": ["frame", f"m{k}"], "stiffness": stiffness, "energy_absorption": k}
    found, beyond = solved(train), 1.0 / (1.0 / 2e3 + 1.0 / 3e3)
    assert found["s0.mean_moment"][0] == pytest.approx(7.0 * beyond / (1e3 + beyond), rel=1e-13)
    assert found["held0.mean_moment"][0] == pytest.approx(-7.0 * 1e3 / (1e3 + beyond), rel=1e-13)


def test_mean_moments__go_from_the_motor_to_the_load_through_the_gears():
    mean = {"e": harmonic("motor", 0, 80.0)}
    found = solved(BRANCHED | {"excitations": mean, "load": "table"})
    assert found["motor_shaft.mean_moment"][0] == pytest.approx(80.0, rel=1e-13)
    # 4 times the moment on the slow shaft; the table is its first end, and its shaft is driven from the wheel.
    assert found["table_shaft.mean_moment"][0] == pytest.approx(4 * 80.0, rel=1e-13)
    assert found["fan_shaft.mean_moment"][0] == pytest.approx(0.0, abs=1e-12)
    assert found["table.amplitude"][0] == 0.0


def test_mean_moment_without_a_load__accelerates_the_whole_train():
    train = chain([1.0, 2.0, 5.0], [1e4, 1e4], speed=1.0, excitations={"e": harmonic("m0", 0, 16.0)})
    found = solved(train, "s0.mean_moment", "s1.mean_moment")
    assert [found["s0.mean_moment"][0], found["s1.mean_moment"][0]] == pytest.approx([14.0, 10.0], rel=1e-14)


def on_circle(waves, amplitudes):
    """Extremes of a sum of harmonics, from the roots of the polynomial in e^(iφ) that its slope is."""
    top = max(waves)
    slope = np.zeros(2 * top + 1, complex)
    for h, a in zip(waves, amplitudes, strict=True):
        slope[top - h], slope[top + h] = 0.5j * h * a, -0.5j * h * np.conj(a)
    phi = np.angle(np.roots(slope))
    values = (np.array(amplitudes)[:, None] * np.exp(1j * np.multiply.outer(np.array(waves), phi))).real.sum(axis=0)
    return values.min(), values.max()


def extremes_together(orders, amplitudes):
    """Minimum and maximum of orders with a common period."""
    *found, missed = np.array(extremes_of_orders(orders, amplitudes[:, None]))[:, 0]
    # Rounding alone.
    assert missed <= 1e-12 * np.abs(amplitudes).sum()
    return np.array(found)


@some
@given(
    st.lists(st.tuples(st.integers(1, 12), st.integers(1, 9)), min_size=2, max_size=6, unique_by=lambda part: part[0]),
    st.floats(-0.1, 0.1),
    st.floats(-0.1, 0.1),
    st.floats(0, math.tau),
)
# Two peaks beside a sample at which the slope vanishes.
@example([(1, 1), (5, 1)], 0.0625, 0.0, 0.0)
# Both peaks between the same two samples.
@example([(7, 1), (1, 2), (4, 2)], -0.0078125, 0.015625, 2.0)
def test_sums_of_orders__reach_the_peaks_of_flat_tops(parts, curvature, lean, at):
    waves, cosines = np.array([h for h, _ in parts]), np.array([float(a) for _, a in parts])
    # Without curvature at an angle, but for a share: a flat top, or two peaks closer than samples.
    cosines[0] = (curvature * np.abs(cosines).sum() - (waves[1:] ** 2 * cosines[1:]).sum()) / waves[0] ** 2
    amplitudes = (cosines - 1j * lean**3 * cosines.sum()) * np.exp(-1j * waves * at)
    found = extremes_together(waves, amplitudes)
    assert found == pytest.approx(on_circle(waves, amplitudes), abs=1e-12 * np.abs(amplitudes).sum())


@pytest.mark.parametrize("unit", [1 / 13, 17 / 83, 1.0, math.sqrt(2)])
def test_orders_of_a_geared_shaft__have_the_peak_of_their_own_period(unit):
    amplitudes = np.array([1.0, -0.6 + 0.3j, 0.4j])
    found = extremes_together([unit, 2 * unit, 5 * unit], amplitudes)
    assert found == pytest.approx(on_circle([1, 2, 5], amplitudes), rel=1e-13)


def test_an_order_without_a_common_period__adds_to_the_peak_of_the_others():
    amplitudes = np.array([1.0, -0.6 + 0.3j, 0.25])
    *found, missed = np.array(extremes_of_orders([1.0, 2.0, math.sqrt(3)], amplitudes[:, None]))[:, 0]
    least, greatest = on_circle([1, 2], amplitudes[:2])
    assert found == pytest.approx((least - 0.25, greatest + 0.25), rel=1e-13)
    assert missed < 1e-9


@pytest.mark.parametrize(
    ("orders", "turns", "most"),
    [
        ((1, 2, 41 / 13, 3.5), 26, 0.0),
        ((1, 37 / 29), 29, 0.0),
        ((211 / 199, 1.5, 4), 398, 1.0),
        ((1.001, 2), 1000, 1e-5),
    ],
)
def test_orders_of_a_long_common_period__have_its_peak_within_the_error(orders, turns, most):
    """Dense samples of the whole period miss a peak by less than (π/200)²/2 of the amplitudes."""
    rng = np.random.default_rng(1)
    phi = np.linspace(0.0, math.tau * turns, round(200 * turns * max(orders)), endpoint=False)
    for _ in range(5):
        amplitudes = rng.normal(size=len(orders)) + 1j * rng.normal(size=len(orders))
        *found, missed = np.array(extremes_of_orders(orders, amplitudes[:, None]))[:, 0]
        values = sum((a * np.exp(1j * h * phi)).real for h, a in zip(orders, amplitudes, strict=True))
        slack, size = (math.pi / 200) ** 2 / 2, np.abs(amplitudes).sum()
        for end, sampled in zip(found, (values.min(), values.max()), strict=True):
            assert -1e-12 * size < abs(end) - abs(sampled) <= missed + slack * size
        assert missed <= (most + 1e-12) * size


ENGINE = {
    "type": "engine",
    "layout": "in-line",
    "cylinders": 4,
    "stroke": 0.1,
    "rod": 0.16,
    "piston_mass": 0.9,
    "speed": 150.0,
    "gas": {"bore": 0.09, "clearance": 0.07, "intake": 0.9e5, "exhaust": 1.1e5, "peak": 55e5},
}


def crankshaft(stiffness):
    masses = {name: {"inertia": 0.02} for name in ("t1", "t2", "t3", "t4")} | {"flywheel": {"inertia": 0.6}}
    names = list(masses)
    shafts = {
        f"s{i}": {"between": [names[i], names[i + 1]], "stiffness": stiffness, "energy_absorption": 0.05}
        for i in range(4)
    }
    return {
        "type": "torsional_train",
        "masses": masses,
        "shafts": shafts,
        "engine": ENGINE,
        "cylinders_at": names[:4],
        "load": "flywheel",
    }


def test_engine_on_a_stiff_crankshaft__turns_it_with_its_whole_torque():
    found = solved(crankshaft(1e13), "flywheel.amplitude", "s3.mean_moment", "s3.alternating_moment")
    engine = element(ENGINE)
    orders = [k / 2 for k in range(1, 25)]
    one, torque, _ = engine_torque(engine, engine.own_numbers(), orders)
    assert found["s3.mean_moment"][0] == pytest.approx(4 * one.mean[0], rel=1e-12)
    # The rigid whole: all of the torque's orders on the sum of inertias, of which the flywheel takes its share.
    swing = over_time(dict(zip(orders, torque[0], strict=True)))
    assert found["s3.alternating_moment"][0] == pytest.approx(np.ptp(swing) / 2 * 0.6 / 0.68, rel=1e-6)
    angles = {h: -t / (0.68 * (h * 150.0) ** 2) for h, t in zip(orders, torque[0], strict=True)}
    assert found["flywheel.amplitude"][0] == pytest.approx(np.ptp(over_time(angles)) / 2, rel=1e-6)


def test_numbers_of_the_engine__vary_by_their_paths():
    train = crankshaft(2e5)
    slow, given = solved(train, "margin_1", engine__speed=[100.0, 150.0])["margin_1"][0]
    assert given == pytest.approx(solved(train, "margin_1")["margin_1"][0], rel=8 * EPS)
    assert slow != given
