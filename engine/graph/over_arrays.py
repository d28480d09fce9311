"""Laws and nodes over arrays: printed as a function over lanes, compiled once, its machine code cached."""

import math
from collections.abc import Callable, Mapping, Sequence
from functools import cache

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.graph.at_points import NOWHERE, Points, fill_points
from engine.graph.functions import function_at
from engine.graph.nodes import Given, Graph, Node, Number, Stage, reached


class NodesOverArrays:
    """Nodes as a function of arrays: of numbers of the variant, and of numbers that are given.

    Parameters
    ----------
    given : sequence of Given
        Their rows come first.
    results : sequence of Node
    """

    def __init__(self, given: Sequence[Given], results: Sequence[Node]) -> None:
        self._numbers = [node for node in reached(results) if isinstance(node, Number)]
        rows = {node: row for row, node in enumerate([*given, *self._numbers])}
        code, self._results = function_at(results, rows, Stage.CYCLE), len(results)
        self._function, self._tables = PrintedFunction(code), results[0].graph.all_tables
        self._given = len(given)

    def table(self, numbers: Mapping[str, np.ndarray], variants: int) -> np.ndarray:
        """Table (numbers, variants) for a call: rows for the given numbers, still 0, then those of the variants."""
        table = np.zeros((self._given + len(self._numbers), variants))
        for row, node in enumerate(self._numbers, self._given):
            table[row] = node.compute(numbers)
        return table

    def __call__(self, table: np.ndarray, found: np.ndarray | None = None) -> np.ndarray:
        """Results (results, variants) of rows as in `table`, written to `found` where that is given."""
        found = np.empty((self._results, table.shape[1])) if found is None else found
        return fill_points(self._function, Points(table, self._tables, NOWHERE, found))


def over_arrays(law: Callable, *arguments: float | np.ndarray) -> np.ndarray:
    """Apply a scalar law to arrays; returns its results (results, …).

    Parameters
    ----------
    law : callable
        A compiled scalar law that returns a float or a tuple of floats.
    arguments : float or ndarray (…)
        At least one is an array; broadcast against each other.
    """
    table = np.array(np.broadcast_arrays(*arguments), float)
    shape = table.shape[1:]
    found = _of_law(law, len(arguments))(table.reshape(len(table), math.prod(shape)))
    return found.reshape(len(found), *shape)


@cache
def _of_law(law: Callable, count: int) -> NodesOverArrays:
    """A law of `count` numbers over arrays."""
    graph = Graph()
    given = [graph.given(f"number {i}", Stage.VARIANT) for i in range(count)]
    results = graph.apply(law, *given)
    return NodesOverArrays(given, results if isinstance(results, tuple) else (results,))
