"""Balance of engines: counterweights, Lanchester's and other balance shafts."""

import math

import pytest
from engine_samples import EPS, RIGHT, engines, few
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from engine.elements.engines.engine_layout import Engine, in_line_engine, v_engine
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
