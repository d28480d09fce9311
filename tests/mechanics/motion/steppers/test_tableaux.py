"""Runge–Kutta methods as data: all conditions of their orders, by rooted trees."""

from collections.abc import Iterator
from functools import cache
from itertools import combinations_with_replacement

import numpy as np
import pytest

from engine.laws.runge_kutta import DORMAND_PRINCE, ERRORS, ORDER_EIGHT, Method, Tableau, part_at
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


@pytest.mark.parametrize("theta", [0.1, 0.37, 0.5, 0.9, 1.0])
@pytest.mark.parametrize(("method", "order"), [(ORDER_EIGHT, 7), (ORDER_NINE, 5)], ids=["DP8", "Radau"])
def test_polynomial_within_the_step__has_its_order(method: Method, order: int, theta: float):
    assert np.abs(method.matrix.sum(axis=1) - method.nodes).max() < ROUNDED
    weights = sum(part * part_at(i, theta) for i, part in enumerate(method.parts))
    assert missed(method.matrix, weights, order, theta) < ROUNDED


def test_formula_of_lower_order__of_radau_misses_polynomials_of_its_degree_only():
    (less,), nodes = ORDER_NINE.fine, RADAU.nodes
    # Weights of both formulas integrate what four nodes determine.
    assert max(abs(less @ nodes**k) for k in range(4)) < ROUNDED
    assert abs(less @ nodes**4) > 1e-4
