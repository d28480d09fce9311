"""Curves of one variant as series: as many panels as their features need, and few for what is rounding alone."""

import math

import numpy as np

from engine.cycle.one_variant import OneVariant
from engine.graph.nodes import Graph
from engine.laws.elementary import direction_of


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
