"""What is followed over the whole cycle: angles, changes of curves, means of magnitudes; curves of one variant."""

import math

import numpy as np
import pytest
import scipy.special as sp
from cycle_machines import at_positions, force_numbers, forces, planned, smooth, smooth_numbers, squares
from scipy.optimize import brentq, minimize_scalar

from engine.cycle.cycle_machine import CycleMachine
from engine.cycle.measures.unloaded_arcs import LEAST_LOAD
from engine.cycle.one_variant import OneVariant
from engine.cycle.panels.chebyshev import PLACES
from engine.cycle.panels.sampled import tops
from engine.cycle.plan import Difference, Running, VectorAngle
from engine.graph.nodes import Graph
from engine.laws.elementary import direction_of

TURN = 2.0 * math.pi
EPS = np.finfo(float).eps


def drawn(variants=500):
    rng = np.random.default_rng(7)
    return rng.uniform(0.05, 3.0, variants), rng.uniform(0.0, TURN, variants)


def within(found, exact, share=0.999):
    return np.mean(np.abs(found.value - exact) <= found.error + 4 * EPS * np.abs(exact)) >= share


def test_angle_of_a_swinging_vector__against_closed_forms():
    swing, phase = drawn()
    found = forces(extremes=[VectorAngle((0, 1))], averages=[VectorAngle((0, 1))], tolerance=1e-10).evaluate(
        force_numbers(swing, phase)
    )
    assert within(found.extremes.greatest[0], swing)
    assert within(found.extremes.least[0], -swing)
    assert within(found.averages[0], 0.0 * swing)
    assert within(found.squares[0], 0.5 * swing**2)
    assert np.median(found.extremes.greatest.error[0]) < 1e-8
    at = np.abs(np.remainder(found.extremes.greatest_at.value[0] - phase - 0.5 * math.pi + math.pi, TURN) - math.pi)
    assert np.mean(at <= found.extremes.greatest_at.error[0] + 1e-12) > 0.999


def test_change_of_a_curve__is_the_integral_of_its_rate():
    swing, phase = drawn()
    numbers = np.vstack([force_numbers(swing, phase), np.ones(swing.size)])
    machine = forces(extremes=[Difference(Running((6,), about_mean=False), 6, 4)], tolerance=1e-11)
    rate = machine.evaluate(numbers).extremes
    # R − (b − b₀) of R = a (sin x − sin x₀), b = a cos x: a √2 sin(x − π/4) and a constant.
    offset = swing * (np.cos(phase) + np.sin(phase))
    assert within(rate.greatest[0], math.sqrt(2.0) * swing + offset)
    assert within(rate.least[0], -math.sqrt(2.0) * swing + offset)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-5, 1e-7])
def test_averages_of_a_running_integral__are_covered(tolerance):
    swing, phase = drawn()
    numbers = np.vstack([force_numbers(swing, phase), np.ones(swing.size)])
    found = forces(averages=[Running((6,), about_mean=False)], tolerance=tolerance).evaluate(numbers)
    # R = a (sin x + sin phase).
    assert within(found.averages[0], swing * np.sin(phase))
    assert within(found.squares[0], swing**2 * (0.5 + np.sin(phase) ** 2))


def test_least_magnitude__of_curves_that_keep_their_sign():
    e, phase = np.random.default_rng(3).uniform(0.01, 0.9, 300), np.linspace(0.0, 6.0, 300)
    found = smooth(extremes=[(0, 4), (2, 1)], tolerance=1e-10).evaluate(smooth_numbers(e, phase))
    assert within(found.extremes.least[0], 1.0 / (1.0 + e))
    assert within(found.extremes.least[1], -np.ones(300))
    assert np.isnan(found.extremes.greatest.value).all()


@pytest.mark.parametrize("tolerance", [1e-5, 1e-8, 1e-9])
def test_mean_of_a_magnitude_with_sharp_dips__is_covered_and_takes_no_panels_for_them(tolerance):
    rng = np.random.default_rng(2)
    least = np.append(10.0 ** rng.uniform(-12.0, 0.0, 1000), 0.0)
    numbers = smooth_numbers(least, rng.uniform(0.0, TURN, least.size))
    found = squares(roots=(0,), rooted=(0,), tolerance=tolerance).evaluate(numbers)
    # ∫ √(cos² x + b² sin² x) dx over a turn is 4 E(1 − b²).
    off = np.abs(found.roots.value[0] - 4.0 * sp.ellipe(1.0 - least**2))
    assert np.mean(off <= found.roots.error[0] + 1e-15) > 0.999
    assert off.max() < 1e-6
    # Of the sharpest dips little is known; of most as much as is asked.
    assert found.roots.error[0].max() < 1e-2
    assert np.median(found.roots.error[0]) < 10.0 * tolerance
    smooth = squares(integrals=(0,), extremes=(0,), tolerance=tolerance).evaluate(numbers)
    assert found.panels.max() <= 3 * smooth.panels.max()


@at_positions
def sharp_force(P, lane, q, c, s, tile, i, room):
    # It turns by 0.9 q and fades, but for a narrow peak.
    beside = (q - P[3, lane]) / P[4, lane]
    size = (0.5 * (1.0 + c)) ** 2 * (1.0 + P[2, lane] / (1.0 + beside * beside))
    x, y = size * math.cos(0.9 * q), size * math.sin(0.9 * q)
    tile[i, lane], tile[room + i, lane], tile[2 * room + i, lane] = x, y, size * size


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_unloaded_arc__is_as_uncertain_as_the_peak_by_which_its_force_ceases_to_count(tolerance):
    random, count = np.random.default_rng(7), 200
    high, at = random.uniform(2.0, 9.0, count), random.uniform(-1.0, 1.0, count)
    width, exact = random.uniform(0.05, 0.2, count), np.zeros(count)
    machine = CycleMachine(planned(ends=(0, 1), curves=3, arcs=((0, 1, 2),), tolerance=tolerance), sharp_force())
    found = machine.evaluate(np.array([np.full(count, -math.pi), np.full(count, math.pi), high, at, width])).arcs
    for k in range(count):

        def over(q, least=0.0, k=k):
            return np.cos(0.5 * q) ** 4 * (1.0 + high[k] / (1.0 + ((q - at[k]) / width[k]) ** 2)) - least

        near = (at[k] - 0.5 * width[k], at[k] + 0.5 * width[k])
        top = over(minimize_scalar(lambda q, f=over: -f(q), bounds=near, options={"xatol": 1e-12}).x)
        ends = [brentq(over, side, 2.0 * side, args=(LEAST_LOAD * top,), xtol=1e-15) for side in (-1.5, 1.5)]
        exact[k] = TURN - 0.9 * (ends[1] - ends[0])
    assert within(found, exact), (np.abs(found.value - exact) / found.error).max()


@at_positions
def bent_curve(P, lane, q, c, s, tile, i, room):
    # It has kinks where the other curve is zero, and its top at the kink in P[2].
    other = math.sin(q - P[2, lane]) + P[3, lane] * math.sin(2.0 * (q - P[2, lane]))
    tile[i, lane], tile[room + i, lane] = other, 0.5 * math.cos(q - P[2, lane] - 0.3) - abs(other)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_top_at_a_kink__is_as_uncertain_as_the_place_of_the_kink(tolerance):
    random, count = np.random.default_rng(6), 400
    at, share = random.uniform(-3.0, 3.0, count), random.uniform(0.1, 0.3, count)
    machine = CycleMachine(planned(ends=(0, 1), curves=2, kinks=(0,), extremes=[1], tolerance=tolerance), bent_curve())
    found = machine.evaluate(np.array([np.full(count, -math.pi), np.full(count, math.pi), at, share])).extremes
    assert within(found.greatest[0], 0.5 * math.cos(0.3), share=1.0)
    assert within(found.greatest_at[0], at, share=1.0)
    assert np.median(found.greatest_at.error[0]) < tolerance


@at_positions
def dipping_force(P, lane, q, c, s, tile, i, room):
    # It nearly vanishes at the phase, where it turns by almost π, and turns back on either side.
    turned = math.sin(q - P[4, lane])
    x, y = turned, P[2, lane] + P[3, lane] * turned * turned
    tile[i, lane], tile[room + i, lane], tile[2 * room + i, lane] = x, y, x * x + y * y


@at_positions
def fading_force(P, lane, q, c, s, tile, i, room):
    # It points to every direction in turn, but fades at the phase.
    turned = q - P[4, lane]
    size = P[2, lane] + 1.0 - math.cos(turned)
    x, y = size * math.cos(turned), size * math.sin(turned)
    tile[i, lane], tile[room + i, lane], tile[2 * room + i, lane] = x, y, size * size


@at_positions
def rising_force(P, lane, q, c, s, tile, i, room):
    # It points to every direction in turn; at the phase it fades, and rises again in the midst.
    turned = q - P[4, lane]
    size = (0.5 * (1.0 - math.cos(turned))) ** 2 + P[2, lane] / (1.0 + (turned / P[3, lane]) ** 2)
    x, y = size * math.cos(turned), size * math.sin(turned)
    tile[i, lane], tile[room + i, lane], tile[2 * room + i, lane] = x, y, size * size


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6, 1e-9])
def test_unloaded_arc__of_a_force_that_nearly_vanishes_between_two_positions(tolerance):
    random, count = np.random.default_rng(3), 400
    ends, phase = np.repeat([[-math.pi], [math.pi]], count, axis=1), random.uniform(-math.pi, math.pi, count)
    plan = planned(ends=(0, 1), curves=3, arcs=((0, 1, 2),), tolerance=tolerance)
    shortest, bend = 10.0 ** random.uniform(-4.0, -1.5, count), random.uniform(0.5, 3.0, count)
    found = CycleMachine(plan, dipping_force()).evaluate(np.array([*ends, shortest, bend, phase])).arcs
    # (d + c s²)/|s| is least, 2 √(c d), at s² = d/c, where the force still counts.
    assert within(found, math.pi + 2.0 * np.arctan(2.0 * np.sqrt(bend * shortest)), share=1.0)
    shortest = random.uniform(0.0, 0.99, count) * 2.0 * LEAST_LOAD / (1.0 - LEAST_LOAD)
    found = CycleMachine(plan, fading_force()).evaluate(np.array([*ends, shortest, bend, phase])).arcs
    off = LEAST_LOAD * (shortest + 2.0)
    assert within(found, 2.0 * np.arccos(1.0 + shortest - off), share=1.0)


@pytest.mark.parametrize("tolerance", [1e-6, 1e-9])
def test_unloaded_arc__of_a_force_that_counts_only_between_two_positions(tolerance):
    random, count = np.random.default_rng(4), 100
    phase, width, exact = random.uniform(-0.5, 0.5, count), random.uniform(0.02, 0.05, count), np.zeros(count)
    high = LEAST_LOAD * (1.0 + 10.0 ** random.uniform(-3.0, -1.0, count))
    plan = planned(ends=(0, 1), curves=3, arcs=((0, 1, 2),), tolerance=tolerance)
    numbers = [phase - math.pi, phase + math.pi, high, width, phase]
    found = CycleMachine(plan, rising_force()).evaluate(np.array(numbers)).arcs
    for k in range(count):

        def over(u, k=k):
            # The peak is at the ends of the range.
            least = LEAST_LOAD * (1.0 + high[k] / (1.0 + (math.pi / width[k]) ** 2))
            return math.sin(0.5 * u) ** 4 + high[k] / (1.0 + (u / width[k]) ** 2) - least

        lowest = minimize_scalar(over, bounds=(0.5 * width[k], 0.4), options={"xatol": 1e-12}, method="bounded").x
        exact[k] = brentq(over, lowest, 1.0, xtol=1e-15) - brentq(over, 0.0, lowest, xtol=1e-15)
    assert within(found, exact, share=1.0)


def of_a_turn():
    graph = Graph()
    return graph, OneVariant(graph, {}, (graph.zero, graph.constant(2.0 * math.pi)), 1)


def test_curve_of_rounding__ends_in_a_few_hundred_panels():
    graph, variant = of_a_turn()
    panels = variant.panels([graph.cos_q * graph.cos_q + graph.sin_q * graph.sin_q - 1.0])
    # Six panels of a turn, each halved six times.
    assert panels.ends.size <= 6 * 2**7
    assert np.abs(panels.series).max() < 1e-15


def test_narrow_peak__is_resolved_where_it_lies():
    graph, variant = of_a_turn()
    # 1/(a − cos φ) is as wide as √(2(a − 1)), 1.4e-3 rad.
    peak = 1.0 / (1.0 + 1e-6 - graph.cos_q)
    panels = variant.panels([peak])
    q = np.linspace(0.0, 2.0 * math.pi, 10_001)
    exact = 1.0 / (1e-6 + 2.0 * np.sin(0.5 * q) ** 2)
    assert np.abs(panels.at(q)[0] - exact).max() <= 1e-9 * 1e6
    assert panels.ends.size < 200


def test_fast_wave__is_resolved_over_the_whole_range():
    graph, variant = of_a_turn()
    panels = variant.panels([graph.apply(direction_of, 1500.0 * graph.q)[0]])
    q = np.linspace(0.0, 2.0 * math.pi, 10_001)
    # A cosine rounds by half a unit in the last place of its angle, up to 1500 turns.
    assert np.abs(panels.at(q)[0] - np.cos(1500.0 * q)).max() <= 1e-10


def test_top_of_a_constant__is_its_first_place():
    values = np.full((3, PLACES.size), 0.3) + EPS * np.random.default_rng(1).uniform(-1, 1, (3, PLACES.size))
    assert (tops(values, np.full(3, 64 * EPS)).places == -1.0).all()
