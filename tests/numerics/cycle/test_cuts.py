import math
from functools import cache

import numpy as np
import pytest
from cycle_machines import OFFSET, at_positions, planned, press, press_numbers, slide
from numba import njit

from engine.compiling.blocks import LANES
from engine.compiling.memory import memory
from engine.cycle.cycle_machine import CycleMachine
from engine.cycle.events import sort_edges
from engine.cycle.panels.lanes import many
from engine.cycle.panels.walk import Edge

TURN = 2.0 * math.pi


@cache
def cut_press():
    return press(integrals=(1,), extremes=(1,))


def test_a_window_where_stroke_begins_and_ends_sets_in_at_the_dead_centres():
    numbers = press_numbers(3, force=100.0, near_share=np.array([0.0, 0.0, 0.9]), far_share=np.array([1.0, 0.1, 1.0]))
    numbers[OFFSET] = 0.0
    found = cut_press().evaluate(numbers)
    exact = -100.0 * np.array([1.0, 0.1, 0.1]) * 0.2
    assert np.all(np.abs(found.integrals.value[0] - exact) <= found.integrals.error[0])
    # Roots beside a dead centre would each add a panel.
    assert np.all(found.panels <= 9)


def test_levels_that_are_never_reached_and_no_levels_cut_nothing():
    shares = {"near_share": -0.2, "far_share": 1.2}
    never, none = press_numbers(1, **shares), press_numbers(1, **dict.fromkeys(shares, np.nan))
    assert cut_press().evaluate(never).panels[0] == cut_press().evaluate(none).panels[0]


def test_a_range_that_ends_before_a_dead_centre_takes_the_ends_for_landmarks():
    rng = np.random.default_rng(4)
    first, last = rng.uniform(0.3, 1.5, 100), rng.uniform(1.6, 2.8, 100)
    numbers = press_numbers(100, first=first, last=last, force=100.0, near_share=0.25, far_share=0.75)
    there, back = (
        cut_press().evaluate(numbers),
        press_numbers(100, first=last, last=first, near_share=0.25, far_share=0.75),
    )
    ends = slide(numbers, first), slide(numbers, last)
    assert np.all(np.abs(there.landmarks.greatest.value[0] - ends[0]) < 4e-16)
    assert np.all(there.landmarks.least_at.value[0] == last)
    exact = -100.0 * 0.5 * (ends[0] - ends[1])
    assert np.all(np.abs(there.integrals.value[0] - exact) <= there.integrals.error[0])
    # Backwards the rate by q is the same, so the force acts there too; the range is negative.
    back[7] = 100.0
    found = cut_press().evaluate(back)
    assert np.all(np.abs(found.integrals.value[0] + exact) <= found.integrals.error[0])
    assert np.all(found.integrals.value[0] / found.lengths < 0.0)


@at_positions
def wavy_events(P, lane, q, c, s, tile, i, room):
    tile[i, lane], tile[room + i, lane] = math.sin(P[2, lane] * q), P[2, lane] * math.cos(P[2, lane] * q)


@at_positions
def constant_curve(P, lane, q, c, s, tile, i, room):
    tile[i, lane] = 1.0


def test_what_switches_ever_more_often_is_looked_at_more_closely_until_it_has_no_results_and_spoils_no_other():
    plan = planned((0, 1), 1, landmarks=[(-1, -1, -1, -1)], crossings=[(0, 3, 0.0)], integrals=[0], extremes=[0])
    machine = CycleMachine(plan, constant_curve(), events=wavy_events())
    # A sine of n waves has 2 n zeros, and at first there is room for twelve; among waves at 2304 positions it is lost.
    waves = np.array([1.0, 6.0, 7.0, 35.0, 300.0, 2e4, 3.0])
    found = machine.evaluate(np.stack([np.zeros(7), np.full(7, TURN), waves, np.zeros(7)]))
    known = waves <= 300.0
    assert found.landmarks.greatest.value[0][known] == pytest.approx(1.0, abs=1e-12)
    assert found.integrals.value[0][known] == pytest.approx(TURN, rel=1e-14)
    assert np.isnan(found.integrals.value[0][~known]).all()
    assert np.isnan(found.extremes.greatest.value[0][~known]).all()
    assert (np.isinf(found.broken_at) == ~known).all()


in_edges = memory(many(Edge))


@njit(error_model="numpy")
def sorted_edges(edges):
    sort_edges(edges.shape[0], in_edges(edges))


@pytest.mark.parametrize("count", [0, 1, 2, 17, 300])
def test_edges__are_put_in_order_in_every_lane(count):
    rng = np.random.default_rng(count)
    edges = np.round(rng.normal(size=(count, 2, LANES)), 1)
    edges[:, 0][rng.random((count, LANES)) < 0.1] = np.nan
    expected = np.where(np.isnan(edges[:, 0]), np.inf, edges[:, 0]) + 1j * -edges[:, 1]
    sorted_edges(edges)
    finite = np.isfinite(edges[:, 0])
    found = np.where(finite, edges[:, 0] - 1j * edges[:, 1], 1e9)
    np.testing.assert_array_equal(found, np.sort(np.where(np.isfinite(expected), expected, 1e9), axis=0))


@at_positions
def two_top_velocity(P, lane, q, c, s, tile, i, room):
    x = q - P[3, lane]
    over = math.cos(x) - math.cos(P[2, lane])
    tile[i, lane] = 2.0 * over * math.sin(x)
    tile[room + i, lane] = 2.0 * (over * math.cos(x) - math.sin(x) ** 2)
    tile[2 * room + i, lane] = 1.0 if over * math.sin(x) > 0.0 else -1.0


@at_positions
def two_top_power(P, lane, q, c, s, tile, i, room):
    x = q - P[3, lane]
    tile[i, lane] = P[5, lane] * 2.0 * (math.cos(x) - math.cos(P[2, lane])) * math.sin(x)


def test_a_load_against_a_ram_with_two_tops_acts_on_both_rises():
    plan = planned((0, 1), 1, landmarks=[(-1, -1, -1, -1)], crossings=[(0, 4, 0.0)], states=[5], integrals=[0])
    machine = CycleMachine(plan, two_top_power(), events=two_top_velocity())
    rng = np.random.default_rng(4)
    # The ram is at −(cos x − cos h)²: its tops, at ±h, are 2 h apart, anywhere in the cycle and at its ends.
    h, phase, zeros = 10.0 ** rng.uniform(-7.0, -0.3, 2000), rng.uniform(0.0, TURN, 2000), np.zeros(2000)
    phase[::5] = rng.uniform(-2.0, 2.0, 400) * h[::5]
    found = machine.evaluate(np.stack([zeros, np.full(2000, TURN), h, phase, zeros, zeros])).integrals
    # Twice its ways up from the bottom and from the dip.
    exact = 2.0 * ((1.0 + np.cos(h)) ** 2 + (2.0 * np.sin(0.5 * h) ** 2) ** 2)
    off = np.abs(found.value[0] - exact)
    assert np.all(off <= found.error[0] + 1e-14 * exact), (h[off > found.error[0]], off.max())


@at_positions
def tilted_tops(P, lane, q, c, s, tile, i, room):
    x = q - P[2, lane]
    over, tilt = math.cos(x) - math.cos(P[3, lane]), P[4, lane]
    tile[i, lane] = tilt * math.sin(x) - over * over
    tile[room + i, lane] = tilt * math.cos(x) + 2.0 * over * math.sin(x)


def tilted_top(h, tilt):
    """Height of the higher top: slope and curvature are exact where h is small."""
    best = np.full(h.size, -np.inf, np.longdouble)
    for side in (-1.0, 1.0):
        x, h = side * h.astype(np.longdouble), h.astype(np.longdouble)
        for _ in range(50):
            over = 2.0 * np.sin(0.5 * (h - x)) * np.sin(0.5 * (h + x))
            slope = tilt * np.cos(x) + 2.0 * over * np.sin(x)
            x -= slope / (2.0 * (over * np.cos(x) - np.sin(x) ** 2) - tilt * np.sin(x))
        best = np.fmax(best, tilt * np.sin(x) - over**2)
    return best.astype(float)


def test_the_end_of_a_stroke_with_two_close_tops_is_the_higher_one():
    plan = planned((0, 1), 1, landmarks=[(-1, -1, -1, -1)], integrals=[0])
    machine = CycleMachine(plan, constant_curve(), events=tilted_tops())
    rng = np.random.default_rng(5)
    h, phase, zeros = 10.0 ** rng.uniform(-5.0, -0.3, 2000), rng.uniform(0.0, TURN, 2000), np.zeros(2000)
    phase[::5] = rng.uniform(-2.0, 2.0, 400) * h[::5]
    # Up to ±0.3 h³, at which two tops remain.
    tilt = rng.uniform(-0.3, 0.3, 2000) * h**3
    found = machine.evaluate(np.stack([zeros, np.full(2000, TURN), phase, h, tilt])).landmarks.greatest
    off = np.abs(found.value[0] - tilted_top(h, tilt))
    assert np.all(off <= found.error[0]), (h[off > found.error[0]], off.max())
