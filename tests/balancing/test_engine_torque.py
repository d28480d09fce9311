"""Firing of engines and their torque by orders: gas and inertia."""

import math

import mpmath
import numpy as np
import pytest
from engine_samples import ALL, RIGHT, angles, engines, few
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose

from engine.balancing.engines.engine_layout import Engine, LayoutError, MasterRod, boxer, in_line, radial, v
from engine.balancing.engines.firing import FOUR_STROKE, TWO_STROKE, even_firing_order, firing_angles, firing_intervals
from engine.balancing.engines.master_rod import positions
from engine.balancing.engines.torque_orders import (
    Indicator,
    firing_sums,
    gas_torque,
    inertia_torque,
    superposed,
    torque_harmonics,
)


def test_firing__is_even_in_the_known_orders():
    for layout, order in (
        (in_line(4).layout(), (1, 3, 4, 2)),
        (in_line(4).layout(), (1, 2, 4, 3)),
        (in_line(5).layout(), (1, 2, 4, 5, 3)),
        (in_line(6).layout(), (1, 5, 3, 6, 2, 4)),
        (in_line(8).layout(), (1, 6, 2, 5, 8, 3, 7, 4)),
        (radial(9).layout(), (1, 3, 5, 7, 9, 2, 4, 6, 8)),
    ):
        intervals = firing_intervals(firing_angles(layout, order))
        assert_allclose(intervals, FOUR_STROKE / len(order), rtol=1e-12)


def test_firing_of_odd_engines__has_the_known_intervals():
    def degrees(layout, order):
        return np.rint(np.degrees(firing_intervals(firing_angles(layout, order)))).astype(int).tolist()

    assert sorted(degrees(v(2).layout(math.radians(45)), (1, 2))) == [315, 405]
    assert sorted(degrees(v(2).layout(RIGHT), (1, 2))) == [270, 450]
    assert degrees(v(6).layout(RIGHT), (1, 5, 2, 6, 3, 4)) == [150, 90] * 3
    # Split by 30° the same engine fires evenly.
    assert even_firing_order(v(6).layout(RIGHT, math.radians(30))) is not None
    assert even_firing_order(v(6).layout(RIGHT)) is None


@pytest.mark.parametrize("cylinders", [1, 3, 4, 5, 6, 8])
def test_even_firing_order__is_even(cylinders):
    layout = in_line(cylinders).layout()
    order = even_firing_order(layout)
    assert_allclose(firing_intervals(firing_angles(layout, order)), FOUR_STROKE / cylinders, rtol=1e-12)


def test_even_firing_order_of_two_strokes__fires_every_throw_once_a_turn():
    layout = in_line(4, [0, math.pi, 1.5 * math.pi, RIGHT]).layout()
    order = even_firing_order(layout, TWO_STROKE)
    assert_allclose(firing_intervals(firing_angles(layout, order, TWO_STROKE), TWO_STROKE), RIGHT, rtol=1e-12)


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ((1, 2, 3, 3), "1-2-3-3: it must name each of the cylinders 1 to 4 once"),
        ((1, 4, 2, 3), "900° to the last cylinder, the cycle has 720°; 1-3-4-2 fires evenly"),
    ],
)
def test_firing_order_that_cannot_be__is_refused(order, message):
    with pytest.raises(LayoutError, match=message):
        firing_angles(in_line(4).layout(), order)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: v(5), "5 cylinders can't stand in 2 banks"),
        (lambda: boxer(3), "pairs of cylinders, not 3"),
        (lambda: radial(1), "two cylinders at least"),
        (lambda: in_line(4, [0.0, 1.0]), "2 throws are given; this layout has 4"),
    ],
)
def test_layout_that_cannot_be__is_refused(call, message):
    with pytest.raises(LayoutError, match=message):
        call()


INDICATOR = Indicator(1 / 8.5, 0.9e5, 1.05e5, 50e5, 1.32, 1.27)


@pytest.mark.parametrize("offset", [0.0, 0.012])
def test_gas_torque__does_the_work_of_the_diagram(offset):
    bore, r, rod = 0.08, 0.04, 0.14
    count = 20_000
    torque = gas_torque(INDICATOR, bore, r, rod, offset, count)
    swept = math.pi / 4 * bore**2 * (math.sqrt((rod + r) ** 2 - offset**2) - math.sqrt((rod - r) ** 2 - offset**2))
    least = INDICATOR.clearance * swept
    ratio = (swept + least) / least
    expansion = 50e5 * least / 0.27 * (1 - ratio**-0.27)
    compression = 0.9e5 * least * ratio / 0.32 * (ratio**0.32 - 1)
    work = expansion - compression - 0.15e5 * swept
    # A trapezoid rule whose curve jumps at four dead centres, where the piston stands still.
    assert_allclose(torque.mean() * 4 * math.pi, work, rtol=1e-6)


def test_torque_of_all_cylinders__is_that_of_their_curves_one_after_another():
    orders = np.arange(1, 13) / 2
    curve = gas_torque(INDICATOR, 0.08, 0.04, 0.14, count=1440)
    angles_ = firing_angles(v(2).layout(RIGHT, 0.5 * RIGHT), (1, 2))
    shifted = sum(np.roll(curve, round(math.degrees(f) * 2)) for f in angles_)
    direct = torque_harmonics(shifted, orders)
    found = superposed(torque_harmonics(curve, orders), orders, angles_)
    # Angles are whole steps: rounding of transforms alone.
    assert_allclose(found, direct, rtol=0, atol=1e-13 * np.abs(curve).max())
    step = np.exp(1j * np.outer(orders, 4 * np.pi * np.arange(1440) / 1440))
    assert_allclose(torque_harmonics((direct @ step).real, orders), direct, rtol=0, atol=1e-12 * np.abs(direct).max())


@pytest.mark.parametrize(("cylinders", "left"), [(4, [2, 4, 6]), (5, [2.5, 5]), (6, [3, 6]), (8, [4])])
def test_even_firing__leaves_the_multiples_of_the_firings_per_turn(cylinders, left):
    layout = in_line(cylinders).layout()
    orders = np.arange(1, 13) / 2
    sums = np.abs(firing_sums(orders, firing_angles(layout, even_firing_order(layout))))
    remain = np.isin(orders, left)
    assert_allclose(sums[remain], cylinders, rtol=1e-13)
    assert (sums[~remain] <= 1e-13 * cylinders).all()


def test_inertia_torque__has_the_textbook_harmonics():
    k = 0.05
    found = inertia_torque(Engine(in_line(1).layout(), 1.0, 1 / k, 2.0), (1, 2, 3, 4))
    # Den Hartog: m r² ω² (λ/4 sin − 1/2 sin 2 − 3λ/4 sin 3 − λ²/4 sin 4), the next terms smaller by λ².
    expected = 2.0 * np.array([k / 4, -1 / 2, -3 * k / 4, -(k**2) / 4])
    assert_allclose(-found.imag, expected, rtol=k**2)
    assert (np.abs(found.real) <= 1e-14).all()


@few
@given(engines(), st.floats(0, 0.1), angles)
def test_inertia_torque__is_the_power_of_the_inertia_forces(engine, correction, phi):
    engine = engine._replace(offset=0.0, rod_correction=correction * engine.radius**2)
    layout = engine.layout
    with mpmath.workdps(30):
        r, rod = mpf(engine.radius), mpf(engine.rod)

        def energy(t):
            total = mpf(0)
            for k in range(layout.banks.size):
                theta = t + mpf(float(layout.throws[k])) - mpf(float(layout.banks[k]))
                lean = r * mpmath.cos(theta) / mpmath.sqrt(rod**2 - (r * mpmath.sin(theta)) ** 2)
                rate = -r * mpmath.sin(theta) - lean * r * mpmath.sin(theta)
                total += mpf(float(engine.reciprocating_mass[k])) * rate**2 + mpf(engine.rod_correction) * lean**2
            return total / 2

        expected = float(-mpmath.diff(energy, mpf(phi)))
    found = (inertia_torque(engine, ALL) @ np.exp(1j * np.array(ALL) * phi)).real
    size = 5 * 2.1 * engine.radius**2
    # Beyond order 24 at λ = 0.4: 25 exp(−23 · 1.5).
    assert abs(found - expected) <= 1e-12 * size


def test_inertia_torque_with_a_master_rod__is_the_rate_of_its_energy():
    master = MasterRod(0, 0.8, 2.6, 0.3)
    engine = Engine(radial(5).layout(), 1.0, 3.4, 1.0, master=master)
    fine = np.linspace(0, 2 * math.pi, 4097)[:-1]
    pistons, pins = positions(engine, fine)
    pins = pins + np.exp(1j * fine)
    step = fine[1]
    rates = [(np.roll(x, -1, -1) - np.roll(x, 1, -1)) / (2 * step) for x in (pistons, pins)]
    energy = ((rates[0] ** 2).sum(0) + 0.3 * (np.abs(rates[1][1:]) ** 2).sum(0)) / 2
    torque = -(np.roll(energy, -1) - np.roll(energy, 1)) / (2 * step)
    direct = torque_harmonics(torque, (1, 2, 3), turns=1)
    # Central differences twice: (n h)²/6 each, for n up to 3 and h = 2π/4096, beside higher orders of the rates.
    assert_allclose(inertia_torque(engine, (1, 2, 3)), direct, rtol=0, atol=1e-4)
