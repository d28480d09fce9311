"""Derivatives of nodes: each elementary law, by each of its operands, against mpmath's numerical differentiation."""

import mpmath
import numpy as np
import pytest
from mpmath import mp

from engine.graph.derivatives import derivative
from engine.graph.nodes import Graph
from engine.graph.values import NodeValues
from engine.laws.elementary import angle_of, direction_of, exponential, logarithm, power
from engine.laws.senses import angle_on_side, kept_positive, sense, side


def turned(x: mpmath.mpf, y: mpmath.mpf) -> mpmath.mpf:
    return mp.atan2(y, x)


# A law, its operands, those by which it is differentiated, and each of its results.
LAWS = [
    (exponential, (0.7,), (0,), [mp.exp]),
    (logarithm, (0.7,), (0,), [mp.log]),
    (power, (1.3, -2.4), (0, 1), [mp.power]),
    (direction_of, (2.1,), (0,), [mp.cos, mp.sin]),
    (angle_of, (-0.4, 0.9), (0, 1), [turned]),
    (angle_on_side, (1.0, -0.4, 0.9), (1, 2), [lambda _, x, y: turned(x, y)]),
    (kept_positive, (1.0, 0.3), (1,), [lambda _, x: x]),
    (sense, (0.3,), (0,), [lambda _: mp.one]),
    (side, (-0.3,), (0,), [lambda _: -mp.one]),
]


@pytest.mark.parametrize(("law", "at", "by", "true"), LAWS)
def test_elementary_law__has_the_slope_of_its_function(law, at, by, true):
    graph = Graph()
    operands = [graph.given(f"operand {i}") for i in range(len(at))]
    results = graph.apply(law, *operands)
    known = {node: np.array([value]) for node, value in zip(operands, at, strict=True)}
    for result, function in zip(results if isinstance(results, tuple) else (results,), true, strict=True):
        for i in by:
            slope = derivative(result, {operands[i]: graph.one})
            (found,) = NodeValues(graph, {})([slope], np.zeros(1), known)
            order = tuple(int(k == i) for k in range(len(at)))
            with mp.workdps(40):
                wanted = mp.diff(function, tuple(map(mp.mpf, at)), order)
            # A few operations, four ulp each.
            assert abs(found[0] - float(wanted)) <= 1e-14 * max(abs(float(wanted)), 1.0), i
