"""Firing orders of engines: known ones, their intervals, and the torque orders that even firing leaves."""

import math

import numpy as np
import pytest
from each_case import refusals
from engine_samples import RIGHT
from numpy.testing import assert_allclose

from engine.elements.engines.engine_layout import boxer_engine, in_line_engine, radial_engine, v_engine
from engine.elements.engines.firing import FOUR_STROKE, even_firing_order, firing_angles, firing_intervals, firing_sums


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
    (lambda: radial_engine(1), "at least two cylinders"),
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
