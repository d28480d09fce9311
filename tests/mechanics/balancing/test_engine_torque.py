"""Firing of engines and their torque by orders: gas and inertia."""

import math

import mpmath
import numpy as np
import pytest
from engine_samples import ALL, RIGHT, angles, few
from hypothesis import given
from hypothesis import strategies as st
from mpmath import mpf
from numpy.testing import assert_allclose

from engine.elements.engines.engine_layout import LayoutError, boxer_engine, in_line_engine, radial_engine, v_engine
from engine.elements.engines.engine_torque import CylinderParts, Indicator, cylinder_torque
from engine.elements.engines.firing import (
    FOUR_STROKE,
    even_firing_order,
    firing_angles,
    firing_intervals,
    firing_sums,
)


def test_firing__is_even_in_the_known_orders():
    for layout, order in (
        (in_line_engine(4).layout(), (1, 3, 4, 2)),
        (in_line_engine(4).layout(), (1, 2, 4, 3)),
        (in_line_engine(5).layout(), (1, 2, 4, 5, 3)),
        (in_line_engine(6).layout(), (1, 5, 3, 6, 2, 4)),
        (in_line_engine(8).layout(), (1, 6, 2, 5, 8, 3, 7, 4)),
        (radial_engine(9).layout(), (1, 3, 5, 7, 9, 2, 4, 6, 8)),
    ):
        intervals = firing_intervals(firing_angles(layout, order))
        assert_allclose(intervals, FOUR_STROKE / len(order), rtol=1e-12)


def test_firing_of_odd_engines__has_the_known_intervals():
    def degrees(layout, order):
        return np.rint(np.degrees(firing_intervals(firing_angles(layout, order)))).astype(int).tolist()

    assert sorted(degrees(v_engine(2).layout(math.radians(45)), (1, 2))) == [315, 405]
    assert sorted(degrees(v_engine(2).layout(RIGHT), (1, 2))) == [270, 450]
    assert degrees(v_engine(6).layout(RIGHT), (1, 5, 2, 6, 3, 4)) == [150, 90] * 3
    # Split by 30° the same engine fires evenly.
    assert even_firing_order(v_engine(6).layout(RIGHT, math.radians(30))) is not None
    assert even_firing_order(v_engine(6).layout(RIGHT)) is None


@pytest.mark.parametrize("cylinders", [1, 3, 4, 5, 6, 8])
def test_even_firing_order__is_even(cylinders):
    layout = in_line_engine(cylinders).layout()
    order = even_firing_order(layout)
    assert_allclose(firing_intervals(firing_angles(layout, order)), FOUR_STROKE / cylinders, rtol=1e-12)


@pytest.mark.parametrize(
    ("order", "message"),
    [
        ((1, 2, 3, 3), "1-2-3-3: it must name each of the cylinders 1 to 4 once"),
        ((1, 4, 2, 3), "900° to the last cylinder, the cycle has 720°; 1-3-4-2 fires evenly"),
    ],
)
def test_firing_order_that_cannot_be__is_refused(order, message):
    with pytest.raises(LayoutError, match=message):
        firing_angles(in_line_engine(4).layout(), order)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: v_engine(5), "5 cylinders can't stand in 2 banks"),
        (lambda: boxer_engine(3), "pairs of cylinders, not 3"),
        (lambda: radial_engine(1), "two cylinders at least"),
        (lambda: in_line_engine(4, [0.0, 1.0]), "2 throws are given; this layout has 4"),
    ],
)
def test_layout_that_cannot_be__is_refused(call, message):
    with pytest.raises(LayoutError, match=message):
        call()


@pytest.mark.parametrize(("cylinders", "left"), [(4, [2, 4, 6]), (5, [2.5, 5]), (6, [3, 6]), (8, [4])])
def test_even_firing__leaves_the_multiples_of_the_firings_per_turn(cylinders, left):
    layout = in_line_engine(cylinders).layout()
    orders = np.arange(1, 13) / 2
    sums = np.abs(firing_sums(orders, firing_angles(layout, even_firing_order(layout))))
    remain = np.isin(orders, left)
    assert_allclose(sums[remain], cylinders, rtol=1e-13)
    assert (sums[~remain] <= 1e-13 * cylinders).all()


def inertia_torque(parts, orders):
    """Of one cylinder: without a difference of pressures the gas gives none."""
    outside = 1e5
    still = Indicator(0.1, outside, outside, outside, 0.0, 0.0, outside)
    return cylinder_torque(still, np.array(0.1), CylinderParts(*map(np.asarray, parts)), orders).orders


@few
@given(st.floats(0.05, 0.4), st.floats(-0.15, 0.15), st.floats(0.1, 2.0), st.floats(0, 0.1), angles)
def test_inertia_torque__is_the_rate_of_the_kinetic_energy(ratio, aside, mass, correction, phi):
    with mpmath.workdps(30):
        rod, offset = 1 / mpf(ratio), mpf(aside / ratio)
        top = mpmath.asin(offset / (rod + 1))

        def energy(t):
            lean = mpmath.asin((offset - mpmath.sin(t)) / rod)
            rate = mpmath.sin(t - lean) / mpmath.cos(lean)
            swing = -mpmath.cos(t) / (rod * mpmath.cos(lean))
            return (mpf(mass) * rate**2 + mpf(correction) * swing**2) / 2

        expected = float(-mpmath.diff(energy, top + mpf(phi)))
    parts = (1.0, 1 / ratio, aside / ratio, mass, correction, 1.0)
    found = (inertia_torque(parts, ALL) @ np.exp(1j * np.array(ALL) * phi)).real
    # Beyond order 24 at λ + |ε| = 0.55: 25 exp(−24 · arccosh(0.85/0.4)).
    assert abs(found - expected) <= 1e-12 * (mass + correction)
