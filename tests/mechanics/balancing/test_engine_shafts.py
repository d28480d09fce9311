"""Balance of engines: counterweights, Lanchester's and other balance shafts, firing orders."""

import math

import numpy as np
import pytest
from each_case import refusals
from engine_samples import EPS, RIGHT, engines, few
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from engine.elements.engines.engine_layout import Engine, boxer_engine, in_line_engine, radial_engine, v_engine
from engine.elements.engines.firing import (
    FOUR_STROKE,
    even_firing_order,
    firing_angles,
    firing_intervals,
    firing_sums,
)
from engine.elements.engines.harmonics import piston_harmonics
from engine.elements.engines.shafts import balance_shafts, remaining_shaking
from engine.elements.engines.shaking import SHAKING_ORDERS, engine_shaking


@pytest.mark.parametrize("order", [1, 2])
def test_lanchester_shafts__leave_no_force_of_their_order(order):
    engine = Engine(in_line_engine(1).layout(), 0.04, 0.14, 0.5)
    found = engine_shaking(engine)
    shafts = [shaft for shaft in balance_shafts(found, (0.0, 0.0)) if shaft.order == order]
    left = remaining_shaking(found, shafts)
    assert left.forces.major[SHAKING_ORDERS.index(order)] <= 4 * EPS * found.forces.major.max()
    assert (left.couples.major <= 4 * EPS).all()
    # They turn against each other with equal unbalances, half of m r A_n / n² each.
    assert [s.sense for s in shafts] == [1, -1]
    sizes = [abs(s.unbalances[0]) for s in shafts]
    expected = 0.5 * 0.04 * piston_harmonics(0.04 / 0.14, (order,)).real[0] / order**2 / 2
    assert_allclose(sizes, expected, rtol=16 * EPS)


def test_balance_shafts__are_as_few_as_the_engine_needs():
    def proposed(pattern, orders=(1, 2), planes=(-1.0, 1.0), **sizes):
        engine = Engine(pattern.layout(**sizes), 1.0, 4.0)
        return [(s.order, s.sense) for s in balance_shafts(engine_shaking(engine, orders), planes)]

    assert proposed(in_line_engine(4)) == [(2, 1), (2, -1)]
    assert proposed(in_line_engine(6)) == []
    assert proposed(in_line_engine(3)) == [(1, 1), (1, -1), (2, 1), (2, -1)]
    assert proposed(v_engine(6), bank_angle=math.pi / 3, pin_offset=math.pi / 3) == [(1, 1), (2, -1)]
    assert proposed(v_engine(8), bank_angle=RIGHT) == [(1, 1)]
    assert proposed(in_line_engine(3), planes=(0.0, 0.0)) == []
    assert proposed(v_engine(2), planes=(0.0, 0.0), bank_angle=RIGHT) == [(1, 1), (2, 1), (2, -1)]


@few
@given(engines(), st.floats(-3, -0.5), st.floats(0.5, 3))
def test_balance_shafts__leave_neither_force_nor_couple(engine, first, second):
    found = engine_shaking(engine)
    left = remaining_shaking(found, balance_shafts(found, (first, second)))
    # Parts below the tolerance of 1e-9 have no shaft.
    assert (left.forces.major <= 1e-8 * left.force_terms).all()
    assert (left.couples.major <= 1e-8 * left.couple_terms).all()


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


test_firing_order_that_cannot_be__is_refused = refusals(
    lambda order: firing_angles(in_line_engine(4).layout(), order),
    ((1, 2, 3, 3), "1-2-3-3: it must name each of the cylinders 1 to 4 once"),
    ((1, 4, 2, 3), "900° to the last cylinder, the cycle has 720°; 1-3-4-2 fires evenly"),
)


test_layout_that_cannot_be__is_refused = refusals(
    lambda call: call(),
    (lambda: v_engine(5), "5 cylinders can't stand in 2 banks"),
    (lambda: boxer_engine(3), "pairs of cylinders, not 3"),
    (lambda: radial_engine(1), "two cylinders at least"),
    (lambda: in_line_engine(4, [0.0, 1.0]), "2 throws are given; this layout has 4"),
)


@pytest.mark.parametrize(("cylinders", "left"), [(4, [2, 4, 6]), (5, [2.5, 5]), (6, [3, 6]), (8, [4])])
def test_even_firing__leaves_the_multiples_of_the_firings_per_turn(cylinders, left):
    layout = in_line_engine(cylinders).layout()
    orders = np.arange(1, 13) / 2
    sums = np.abs(firing_sums(orders, firing_angles(layout, even_firing_order(layout))))
    remain = np.isin(orders, left)
    assert_allclose(sums[remain], cylinders, rtol=1e-13)
    assert (sums[~remain] <= 1e-13 * cylinders).all()
