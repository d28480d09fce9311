"""Runge–Kutta methods as data: all conditions of their orders, by rooted trees."""

import math
from collections.abc import Iterator
from functools import cache
from itertools import combinations_with_replacement

import numpy as np
import pytest

from engine.laws.runge_kutta import DORMAND_PRINCE, ERRORS, MATRIX, NODES, ORDER_EIGHT, Method, Tableau, part_at
from engine.stepping.tableaux import ORDER_NINE, RADAU

# A rooted tree is the tuple of the trees that grow from its root.
Tree = tuple


def forests(vertices: int, most: int) -> Iterator[Tree]:
    """Sets of trees with so many vertices in all, none with more than `most`, larger ones first."""
    if vertices == 0:
        yield ()
    for largest in range(min(vertices, most), 0, -1):
        for number in range(1, vertices // largest + 1):
            for same in combinations_with_replacement(trees(largest), number):
                for rest in forests(vertices - number * largest, largest - 1):
                    yield same + rest


@cache
def trees(vertices: int) -> tuple[Tree, ...]:
    """All rooted trees with so many vertices."""
    return tuple(forests(vertices - 1, vertices - 1))


def order_of(tree: Tree) -> int:
    return 1 + sum(map(order_of, tree))


def density(tree: Tree) -> int:
    """γ: the product of the orders of all subtrees."""
    return order_of(tree) * int(np.prod([density(branch) for branch in tree], dtype=int))


def elementary(matrix: np.ndarray, tree: Tree) -> np.ndarray:
    """What a tree weighs at each stage."""
    found = np.ones(len(matrix))
    for branch in tree:
        found = found * (matrix @ elementary(matrix, branch))
    return found


def missed(matrix: np.ndarray, weights: np.ndarray, order: int, theta: float = 1.0) -> float:
    """By how much the conditions up to an order are missed, at a share θ of the step, in units of what is added up."""
    worst = 0.0
    for vertices in range(1, order + 1):
        for tree in trees(vertices):
            found = weights @ elementary(matrix, tree)
            size = np.abs(weights) @ elementary(np.abs(matrix), tree)
            worst = max(worst, abs(found - theta**vertices / density(tree)) / max(size, 1e-3))
    return worst


def test_trees__are_as_many_as_counted():
    # A. Cayley's numbers of rooted trees.
    assert [len(trees(n)) for n in range(1, 9)] == [1, 1, 2, 4, 9, 20, 48, 115]


# Sums of some hundred products of up to eight factors, each rounded in its 16th digit; those of Radau IIA follow from
# polynomials of degree five, whose own coefficients are rounded.
ROUNDED = 1e-13


@pytest.mark.parametrize(("method", "order"), [(DORMAND_PRINCE, 8), (RADAU, 9)], ids=["DP8", "Radau"])
def test_method__has_its_order_and_no_more(method: Tableau, order: int):
    assert np.abs(method.matrix.sum(axis=1) - method.nodes).max() < ROUNDED
    assert missed(method.matrix, method.weights, order) < ROUNDED
    assert missed(method.matrix, method.weights, order + 1) > 1e-6


@pytest.mark.parametrize(("row", "order"), [(0, 5), (1, 3)])
def test_embedded_formulas__have_their_orders_and_no_more(row: int, order: int):
    weights = DORMAND_PRINCE.weights - ERRORS[row]
    assert missed(DORMAND_PRINCE.matrix, weights, order) < ROUNDED
    assert missed(DORMAND_PRINCE.matrix, weights, order + 1) > 1e-6


def estimated(weights: np.ndarray, slopes: np.ndarray, length: float) -> float:
    """As of DOP853, with the root of the squares of all formulas of order five."""
    fine = length * np.linalg.norm(weights @ slopes)
    (coarse,) = length * (ORDER_EIGHT.coarse @ slopes)
    return fine**2 / np.hypot(fine, coarse)


def test_estimated_error__hardly_vanishes_where_a_rate_depends_on_the_angle_alone():
    # The work of a trapezium's flank against a link's velocity, say: two formulas of order five vanish together at
    # zeros of the fifth derivative. ∫ dφ/(a + cos φ) = 2 atan(√((a-1)/(a+1)) tan(φ/2))/√(a² - 1).
    few, all_three = [], []
    for a in (1.3, 2.0, 4.0):
        root = math.sqrt(a * a - 1.0)

        def integral(phi: float, a: float = a, root: float = root) -> float:
            return 2.0 * math.atan(math.sqrt((a - 1.0) / (a + 1.0)) * math.tan(0.5 * phi)) / root

        for begin in np.linspace(-3.0, 2.2, 200):
            for length in np.geomspace(0.2, 0.8, 20):
                slopes = 1.0 / (a + np.cos(begin + length * NODES[: ORDER_EIGHT.stages]))
                error = abs(length * (DORMAND_PRINCE.weights @ slopes) - integral(begin + length) + integral(begin))
                if error > 1e-13:
                    few.append(estimated(ORDER_EIGHT.fine[:2], slopes, length) / error)
                    all_three.append(estimated(ORDER_EIGHT.fine, slopes, length) / error)
    # Two alone fall short twentyfold, all three by less than half, at hardly larger estimates.
    assert min(few) < 0.05
    assert min(all_three) > 0.5
    assert np.median(all_three) < 2.0 * np.median(few)


def test_estimated_error__hardly_vanishes_at_any_length_of_a_step():
    # y' = y cos t, y = exp sin t: at some lengths one formula of order five happens to give what that of order eight
    # does, and alone would estimate that nothing is missed.
    alone, both = [], []
    for begin in np.linspace(0.0, 6.0, 25):
        for length in np.geomspace(0.4, 1.5, 400):
            slopes, value = np.zeros(ORDER_EIGHT.stages), np.exp(np.sin(begin))
            for s in range(ORDER_EIGHT.stages):
                at = value + length * (DORMAND_PRINCE.matrix[s] @ slopes)
                slopes[s] = at * np.cos(begin + length * NODES[s])
            error = abs(value + length * (DORMAND_PRINCE.weights @ slopes) - np.exp(np.sin(begin + length)))
            # What rounds says nothing.
            if error > 1e-13:
                alone.append(estimated(ORDER_EIGHT.fine[:1], slopes, length) / error)
                both.append(estimated(ORDER_EIGHT.fine, slopes, length) / error)
    # Once in a thousand steps the estimate of one falls short ten thousand times, that of both a hundred times.
    assert np.quantile(alone, 0.001) < 1e-4
    assert min(both) > 3e-3
    assert np.quantile(both, 0.001) > 1e-2


@pytest.mark.parametrize("theta", [0.1, 0.37, 0.5, 0.9, 1.0])
@pytest.mark.parametrize(("method", "order"), [(ORDER_EIGHT, 7), (ORDER_NINE, 5)], ids=["DP8", "Radau"])
def test_polynomial_within_the_step__has_its_order(method: Method, order: int, theta: float):
    assert np.abs(method.matrix.sum(axis=1) - method.nodes).max() < ROUNDED
    weights = sum(part * part_at(i, theta) for i, part in enumerate(method.parts))
    assert missed(method.matrix, weights, order, theta) < ROUNDED


def test_nodes_of_dormand_and_prince__are_the_sums_of_rows():
    assert np.abs(MATRIX.sum(axis=1) - NODES).max() < ROUNDED


def test_formulas_of_lower_order__of_radau_miss_polynomials_of_their_degree_only():
    nodes = RADAU.nodes
    for (less,), count in ((ORDER_NINE.fine, 4), (ORDER_NINE.coarse, 3)):
        # Weights of both formulas integrate what the fewer nodes determine.
        assert max(abs(less @ nodes**k) for k in range(count)) < ROUNDED
        assert abs(less @ nodes**count) > 1e-4
