"""Graphs of nodes: arithmetic as on paper, stages, and printed functions against the same graph worked out by NumPy."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from printed_calls import call_printed, filled

from engine.compiling.blocks import LANES, PANEL_POSITIONS
from engine.compiling.decorators import scalar
from engine.graph.functions import field_function, functions_at, functions_of
from engine.graph.nodes import (
    Constant,
    Graph,
    Held,
    LawResult,
    Node,
    Number,
    Operation,
    Position,
    Stage,
    Sum,
    reached,
)


@scalar
def turned(x: float, y: float, c: float, s: float) -> tuple[float, float]:
    """A vector turned by an angle."""
    return x * c - y * s, x * s + y * c


@scalar
def step_of(x: float) -> float:
    """1 above zero, else 0."""
    return 1.0 if x > 0.0 else 0.0


def test_arithmetic__is_simplified_as_on_paper():
    g = Graph()
    x = g.q
    assert x + 0 is x
    assert x - 0 is x
    assert x * 1 is x
    assert x / 1 is x
    assert x * 0 is g.zero
    assert 0 / x is g.zero
    assert x - x is g.zero
    opposite = -x
    assert -opposite is x
    assert (0 - x) is -x
    assert (g.constant(2) + g.constant(3)).value == 5
    assert g.combination([(g.zero, x), (g.one, g.zero)]) is g.zero


def test_same_operation__is_the_same_node():
    g = Graph()
    assert g.q * g.cos_q is g.q * g.cos_q
    assert g.apply(turned, g.q, 1, g.cos_q, g.sin_q)[1] is g.apply(turned, g.q, 1, g.cos_q, g.sin_q)[1]
    assert g.number("a") * g.number("b") is g.number("a") * g.number("b")


def test_stages__are_the_latest_of_what_a_node_depends_on():
    g = Graph()
    a, b = g.number("a"), g.number("b")
    assert isinstance(a * b, Number)
    assert (a * b).compute({"a": 3.0, "b": 2.0}) == 6.0
    low = g.found(g.q * a, a, "low")
    assert (low.stage, (low + b).stage) == (Stage.CYCLE, Stage.CYCLE)
    held = g.held(g.apply(step_of, g.q - a))
    assert held.stage == Stage.PANEL
    assert (held * a).stage == Stage.PANEL
    assert (held * g.q).stage == Stage.POSITION
    # What doesn't change within a cycle isn't found, nor held.
    assert g.found(a, g.zero, "high") is a
    assert g.held(low) is low


OPERATIONS = {"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide}
OPERATIONS |= {"sqrt": np.sqrt, "abs": np.abs, "neg": np.negative}


def values_of(nodes: list[Node], numbers: dict[str, np.ndarray], q: np.ndarray) -> list[np.ndarray]:
    """The same mathematics, node by node in NumPy."""
    laws = {"turned": lambda x, y, c, s: (x * c - y * s, x * s + y * c), "step_of": lambda x: (x > 0) * 1.0}
    known: dict[Node, object] = {}
    for node in reached(nodes):
        of = [known[o] for o in node.operands if o in known]
        match node:
            case Constant():
                known[node] = node.value
            case Number():
                known[node] = node.compute(numbers)
            case Position():
                known[node] = {"q": q, "cos_q": np.cos(q), "sin_q": np.sin(q)}[node.which]
            case Operation():
                known[node] = OPERATIONS[node.symbol](*of)
            case Sum():
                known[node] = sum(known[c] * known[b] for c, b in node.terms)
            case Held():
                known[node] = of[0]
            case LawResult():
                known[node] = of[0] if node.index is None else of[0][node.index]
            case _:
                known[node] = laws[node.law.py_func.__name__](*of)
    return [np.broadcast_to(known[node], q.shape) for node in nodes]


def some_graph() -> tuple[Graph, list[Node]]:
    """A graph with every kind of node, and what is asked of it."""
    g = Graph()
    a, b, load = g.number("a"), g.number("b"), g.number("load")
    x, y = g.apply(turned, a + g.q, b, g.cos_q, g.sin_q)
    shared = x * y - a / (2 + g.cos_q)
    root = g.function("sqrt", shared * shared + 1.0)
    deep = shared
    for i in range(9):
        deep = deep * 0.9 + (g.sin_q if i % 2 else b)
    switch = g.held(g.apply(step_of, x - b))
    moment = g.combination([(load, root), (g.one, deep), (a * load, g.one)])
    return g, [x, shared, root, deep, moment, switch * x, abs(y), -root, a * g.q]


Q = np.linspace(0, 6, PANEL_POSITIONS * LANES).reshape(PANEL_POSITIONS, LANES)
NUMBERS = {"a": np.linspace(0.5, 2, LANES), "b": np.linspace(-1, 1, LANES), "load": np.linspace(3, 9, LANES)}


def prepared(graph: Graph, asked: list[Node]) -> tuple[object, np.ndarray]:
    """Functions of a graph and its numbers in lanes."""
    first, last = graph.derived("first", lambda n: 0.0), graph.derived("last", lambda n: 2 * math.pi)
    functions = functions_of(graph, first, last, asked)
    numbers = np.zeros((len(functions.rows), LANES))
    for row, node in enumerate(functions.numbers):
        numbers[row] = node.value if isinstance(node, Constant) else node.compute(NUMBERS)
    return functions, numbers


def test_printed_tile__is_the_graph_worked_out_by_numpy():
    graph, asked = some_graph()
    functions, numbers = prepared(graph, asked)
    middle = Q[8:9].copy()
    switching = 2 * len(functions.events)
    held = filled(functions, "events", numbers, middle, switching + len(functions.held_rows))[switching:]
    for row, values in zip(functions.held_rows, held, strict=True):
        numbers[row] = values[0]
    tile = filled(functions, "curves", numbers, Q, len(asked))
    expected = values_of(asked, NUMBERS, Q)
    # What switches keeps the value of the panel's middle.
    switched = values_of([asked[0] - graph.number("b")], NUMBERS, middle)[0] > 0
    expected[5] = switched * expected[0]
    for found, value in zip(tile, expected, strict=True):
        np.testing.assert_allclose(found, value, rtol=1e-13, atol=1e-13)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_printed_fields__are_the_graph_worked_out_by_numpy(dtype):
    graph, asked = some_graph()
    functions, numbers = prepared(graph, asked)
    nodes = np.linspace(0, 6, 700)
    fields = np.empty((len(asked), 5, nodes.size), dtype)
    fill = field_function(asked, functions.rows, dtype)
    for v in range(5):
        call_printed(fill, numbers[:, v].copy(), functions.memory, nodes, np.cos(nodes), np.sin(nodes), v, fields)
    # Sums of some twenty terms of up to a hundred, computed in double precision whatever they are kept in.
    tolerance = max(2e3 * np.finfo(float).eps, np.finfo(dtype).eps)
    for v in range(5):
        own = {name: values[v] for name, values in NUMBERS.items()}
        for found, value in zip(fields[:, v], values_of(asked, own, nodes), strict=True):
            np.testing.assert_allclose(found, value, rtol=tolerance, atol=tolerance)


@scalar
def total(terms: tuple[float, ...]) -> float:
    found = 0.0
    for term in terms:
        found += term
    return found


def test_law__may_take_tuples_of_several_lengths_in_one_function():
    g = Graph()
    a, b = g.number("a"), g.number("b")
    asked = [g.apply(total, (a, g.cos_q)), g.apply(total, (a, b, g.sin_q)), g.apply(total, (b, g.q))]
    functions, numbers = prepared(g, asked)
    tile = filled(functions, "curves", numbers, Q, len(asked))
    a, b = NUMBERS["a"], NUMBERS["b"]
    np.testing.assert_allclose(tile, [a + np.cos(Q), a + b + np.sin(Q), b + Q], rtol=1e-14, atol=1e-15)


def test_crossings__are_those_of_curves_that_what_is_asked_depends_on():
    g = Graph()
    a = g.number("a")
    g.switches(g.q, g.one, a)
    g.switches(g.cos_q, -g.sin_q)
    within = g.held(g.apply(step_of, g.q - a))
    assert prepared(g, [within * g.sin_q])[0].crossings == ((0, prepared(g, [within * g.sin_q])[0].rows[a], 0.0),)
    assert prepared(g, [g.sin_q])[0].crossings == ()


def test_position_by_position__given_numbers_are_read_and_what_is_held_is_computed_there():
    g = Graph()
    first, last, speed = g.derived("first", lambda n: 0.0), g.derived("last", lambda n: 6.0), g.given("speed")
    g.switches(g.cos_q, -g.sin_q)
    curve = g.held(g.apply(step_of, g.cos_q)) * (speed * speed)
    assert curve.stage == Stage.POSITION
    functions = functions_at(g, first, last, [curve], [], [g.number("a")])
    numbers = np.zeros((len(functions.rows), LANES))
    numbers[functions.rows[speed]] = np.arange(LANES)
    q = np.linspace(0.0, 6.0, LANES)[None]
    tile = filled(functions, "curves_at", numbers, q, 1)
    np.testing.assert_array_equal(tile[0], np.where(np.cos(q) > 0.0, np.arange(LANES) ** 2.0, 0.0))
    assert functions.crossings == ((0, functions.rows[g.zero], 0.0),)
    assert functions.held_rows == ()


def test_crossing__is_one_however_often_it_was_named():
    g = Graph()
    for _ in range(3):
        g.switches(g.cos_q, -g.sin_q, 0.5)
    assert [(crossing.level, crossing.offset) for crossing in g.crossings] == [(g.zero, 0.5)]


@settings(max_examples=10)
@given(st.lists(st.sampled_from("+-*/"), min_size=1, max_size=12), st.randoms(use_true_random=False))
def test_any_expression__is_printed_as_it_is_meant(symbols, random):
    g = Graph()
    nodes: list[Node] = [g.q, g.cos_q, g.sin_q, g.number("a"), g.constant(2.5)]
    for symbol in symbols:
        a, b = random.choice(nodes), random.choice(nodes)
        divisor = g.function("sqrt", b * b + 1.0)
        nodes.append(g.operation(symbol, a, divisor if symbol == "/" else b))
    asked = list(dict.fromkeys(nodes[-3:]))
    functions, numbers = prepared(g, asked)
    tile = filled(functions, "curves", numbers, Q, len(asked))
    for found, value in zip(tile, values_of(asked, NUMBERS, Q), strict=True):
        np.testing.assert_allclose(found, value, rtol=1e-12, atol=1e-12)


def test_multiples_of_one_curve__are_one_term():
    g = Graph()
    numbers = {f"n{i}": 0.1 * i - 3.0 for i in range(3000)}
    curves = [g.cos_q, g.sin_q, g.cos_q * g.sin_q]
    rng = np.random.default_rng(0)
    terms, expected, q = [], 0.0, np.linspace(0.0, 6.0, 7)
    for i, c in enumerate(rng.integers(3, size=1000)):
        a, b, d = (g.number(f"n{3 * i + k}") for k in range(3))
        curve = [(curves[c] * b) * d, (-curves[c]) * b, curves[c], -(b * curves[c])][i % 4]
        terms.append((a, curve))
        expected = expected + a.compute(numbers) * values_of([curve], numbers, q)[0]
    # As many terms as curves, however many loads there are: and no number is a sum nested a thousand times.
    assert len(g.combination(terms).terms) == 3
    np.testing.assert_allclose(values_of([g.combination(terms)], numbers, q)[0], expected, rtol=1e-10, atol=1e-6)
    apart = g.combination([(g.number("n1"), g.cos_q * g.number("n2")), (g.number("n3"), g.sin_q)])
    assert [curve for _, curve in apart.terms] == [g.cos_q * g.number("n2"), g.sin_q]


def test_label_of_a_number__stands_for_one_number():
    graph = Graph()

    def scaled(factor):
        return graph.derived("drag at speed", lambda n: factor * n["speed"])

    assert scaled(2.0) is scaled(2.0)
    with pytest.raises(ValueError, match="'drag at speed' stands for two numbers"):
        scaled(3.0)
