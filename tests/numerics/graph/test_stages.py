"""Nodes of every stage in the functions where they are computed: those of a panel and of a cycle among them."""

import numpy as np
import pytest

from engine.compiling.printed import load_printed
from engine.compiling.widths import LANES, PANEL_POSITIONS
from engine.graph.functions import functions_of
from engine.graph.nodes import Graph
from engine.laws.loads import constant_against_motion


@pytest.fixture(scope="module")
def printed():
    """A curve with a product of two held signs, and a crossing at a distance from an end of the stroke."""
    graph = Graph()
    first, last = graph.derived("first", lambda n: 0.0), graph.derived("last", lambda n: 6.0)
    x, rate = graph.cos_q, -graph.sin_q
    signs = [graph.held(graph.apply(constant_against_motion, 1.0, node)) for node in (x, rate)]
    low = graph.found(x, rate, "low")
    graph.switches(x, rate, low + 0.25)
    found = functions_of(graph, "test", first, last, [signs[0] * signs[1] * x])
    return found, load_printed(found.text)


def positions(count, q):
    every = np.full((count, LANES), q)
    return every, np.cos(every), np.sin(every)


def test_what_follows_from_held_nodes__is_computed_from_their_rows(printed):
    functions, module = printed
    numbers = np.zeros((len(functions.rows), LANES))
    numbers[list(functions.held_rows)] = [[1.0], [-1.0]]
    tile = np.zeros((1, PANEL_POSITIONS, LANES))
    module.curves(numbers, functions.memory, *positions(PANEL_POSITIONS, 0.5), tile)
    assert (tile == -np.cos(0.5)).all()


def test_levels__follow_from_the_ends_of_strokes(printed):
    functions, module = printed
    numbers = np.zeros((len(functions.rows), LANES))
    numbers[functions.landmarks[0].low] = -1.0
    tile = np.zeros((len(functions.level_rows), 1, LANES))
    module.levels(numbers, functions.memory, *positions(1, 0.0), tile)
    assert (tile == -0.75).all()
