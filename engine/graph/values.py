"""Evaluation of nodes in NumPy, directly on the graph, without printing functions."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import chain

import numpy as np

from engine.graph.functions import Functions
from engine.graph.nodes import (
    OPERATIONS,
    Application,
    Constant,
    Found,
    Graph,
    LawResult,
    Node,
    Number,
    NumberTable,
    Operation,
    Position,
    Stage,
    Sum,
    TableMemory,
    reached,
    value_of,
)


class NodeValues:
    """Evaluates nodes at arbitrary positions of the input.

    Parameters
    ----------
    graph : Graph
    numbers : mapping of path to float or ndarray (positions,)
        Numbers of one variant, or of a different variant at each position.
    cycle_value : callable, optional
        Returns the value of a `Found` node; required where there are any.
    """

    def __init__(
        self, graph: Graph, numbers: Mapping[str, float], cycle_value: Callable[[Node], float] | None = None
    ) -> None:
        self._graph, self._numbers, self._cycle_value = graph, numbers, cycle_value
        # Values of the variant and its cycle, equal at all positions.
        self._once: dict[Node, object] = {}
        # Nodes to evaluate, in order, by the requested and the known nodes.
        self._orders: dict[tuple[tuple[Node, ...], frozenset[Node]], list[Node]] = {}

    def for_numbers(self, numbers: Mapping[str, float]) -> "NodeValues":
        """Evaluation of the same nodes with other numbers."""
        other = NodeValues(self._graph, numbers, self._cycle_value)
        other._orders = self._orders
        return other

    def __call__(
        self, nodes: Sequence[Node], q: np.ndarray, known: Mapping[Node, np.ndarray] | None = None
    ) -> list[np.ndarray]:
        """Evaluate nodes at positions; returns an array (positions,) for each node.

        Parameters
        ----------
        nodes : sequence of Node
        q : ndarray (positions,)
            Positions of the input [rad].
        known : mapping of Node to ndarray, optional
            Values of given or held nodes; a held node not among them is evaluated at the position itself.
        """
        known = known or {}
        found: dict[Node, object] = {**self._once, **known}
        wanted = tuple(nodes), frozenset(known)
        if wanted not in self._orders:
            self._orders[wanted] = reached(nodes, known.__contains__)
        with np.errstate(all="ignore"):
            for node in self._orders[wanted]:
                if node not in found:
                    found[node] = value = self._value(node, q, found)
                    if node.stage < Stage.PANEL and not isinstance(node, TableMemory):
                        self._once[node] = value
        return [np.broadcast_to(found[node], q.shape) for node in nodes]

    def _value(self, node: Node, q: np.ndarray, found: Mapping[Node, object]) -> object:
        operands = [found[o] for o in node.operands]
        match node:
            case Constant():
                return np.float64(node.value)
            case Number():
                return np.asarray(node.compute(self._numbers), float)[()]
            case NumberTable():
                # A law takes a table of numbers as the flat memory, the index of the first number and the stride
                # between numbers.
                rows = np.array(np.broadcast_arrays(*operands), float).reshape(len(operands), -1)
                variants = rows.shape[1]
                return rows.ravel(), np.arange(variants) if variants > 1 else 0, variants
            case TableMemory():
                return self._graph.all_tables
            case Position():
                return q if node.which == "q" else getattr(np, node.which.removesuffix("_q"))(q)
            case Operation():
                return OPERATIONS[node.symbol](*operands)
            case Application():
                given = node.arguments(found[o] for o in node.operands)
                tables = node.arguments(isinstance(o, NumberTable) for o in node.operands)
                # A table of numbers is three arguments of the law.
                return node.law(*chain(*(g if t is True else (g,) for g, t in zip(given, tables, strict=True))))
            case LawResult(index=None):
                return operands[0]
            case LawResult():
                return operands[0][node.index]
            case Sum():
                return sum(found[c] * found[b] for c, b in node.terms)
        return operands[0] if operands else self._cycle_value(node)


class LevelValues:
    """P of many variants: numbers of the variant, and numbers of the cycle that follow from them.

    Parameters
    ----------
    functions : Functions
    """

    def __init__(self, functions: Functions) -> None:
        rows = functions.rows
        self._functions, self._levels = functions, {node: rows[node] for node in functions.levels}
        self._behind = set(reached(self._levels))
        made = Operation, Sum, LawResult
        self._given = {node: row for node, row in rows.items() if node in self._behind and not isinstance(node, made)}
        self._found = {node: row for node, row in rows.items() if isinstance(node, Found)}
        self._events = [curve for curve, _ in functions.events]
        self._values = NodeValues(next(iter(rows)).graph, {})

    def table(
        self, numbers: Mapping[str, np.ndarray], variants: int, known: Mapping[Node, np.ndarray | float] | None = None
    ) -> np.ndarray:
        """P (numbers, variants), without numbers found on the cycle and those that depend on them, unless known."""
        table = np.full((len(self._functions.rows), variants), np.nan)
        # An overflow in a number results in a verdict, not in a warning.
        with np.errstate(all="ignore"):
            for node in self._functions.numbers:
                table[self._functions.rows[node]] = value_of(node, numbers)
        for node, values in (known or {}).items():
            if node in self._functions.rows:
                table[self._functions.rows[node]] = values
        self.fill(table)
        return table

    def fill(self, numbers: np.ndarray) -> None:
        """Fill the rows of numbers of the cycle in P (numbers, variants) in place."""
        known = {node: numbers[row] for node, row in self._given.items()}
        found = self._values.for_numbers({})(list(self._levels), np.zeros(numbers.shape[1]), known)
        for row, values in zip(self._levels.values(), found, strict=True):
            numbers[row] = values

    def fill_found(self, numbers: np.ndarray, found: Callable[[str], np.ndarray]) -> None:
        """Fill the rows of P with the ends of strokes and with the numbers that depend on them.

        Parameters
        ----------
        numbers : ndarray (numbers, variants)
            Modified in place.
        found : callable
            The values (switching functions, variants) of an end by its name in `Found.which`.
        """
        for node, row in self._found.items():
            numbers[row] = found(node.which)[self._events.index(node.curve)]
        if self._found:
            self.fill(numbers)

    def depend_on(self, given: Iterable[Node]) -> bool:
        """Whether any of them follows from given nodes."""
        return not self._behind.isdisjoint(given)
