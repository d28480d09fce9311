"""Values of nodes by NumPy: the graph as it is, without any function being printed."""

import operator
from collections.abc import Callable, Mapping, Sequence
from itertools import chain

import numpy as np

from engine.graph.nodes import (
    Application,
    Constant,
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
)

_OPERATIONS = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}
_OPERATIONS |= {"sqrt": np.sqrt, "abs": np.abs, "neg": np.negative}


class NodeValues:
    """Values of nodes at any positions of the input.

    Parameters
    ----------
    graph : Graph
    numbers : mapping of path to float or ndarray (positions,)
        Of one variant, or of a variant of its own at each position.
    cycle_value : callable, optional
        Value of a `Found` node, where there are such.
    """

    def __init__(
        self, graph: Graph, numbers: Mapping[str, float], cycle_value: Callable[[Node], float] | None = None
    ) -> None:
        self._graph, self._numbers, self._cycle_value = graph, numbers, cycle_value
        # Values of the variant and of its cycle, which are the same at all positions.
        self._once: dict[Node, object] = {}

    def __call__(
        self, nodes: Sequence[Node], q: np.ndarray, known: Mapping[Node, np.ndarray] | None = None
    ) -> list[np.ndarray]:
        """Values at positions, (positions,) for each node.

        Parameters
        ----------
        nodes : sequence of Node
        q : ndarray (positions,)
        known : mapping of Node to ndarray, optional
            Values of nodes that are given or held; a node that is held has elsewhere the value of the position itself.
        """
        found: dict[Node, object] = {**self._once, **(known or {})}
        with np.errstate(all="ignore"):
            for node in reached(nodes, found.__contains__):
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
                # Where its first number lies in memory, and how far the next one is: as in lanes, of each variant.
                rows = np.array(np.broadcast_arrays(*operands), float).reshape(len(operands), -1)
                variants = rows.shape[1]
                return rows.ravel(), np.arange(variants) if variants > 1 else 0, variants
            case TableMemory():
                return self._graph.all_tables
            case Position():
                return q if node.which == "q" else getattr(np, node.which.removesuffix("_q"))(q)
            case Operation():
                return _OPERATIONS[node.symbol](*operands)
            case Application():
                given = node.arguments(found[o] for o in node.operands)
                tables = node.arguments(isinstance(o, NumberTable) for o in node.operands)
                # A table of numbers is several arguments.
                return node.law(*chain(*(g if t is True else (g,) for g, t in zip(given, tables, strict=True))))
            case LawResult(index=None):
                return operands[0]
            case LawResult():
                return operands[0][node.index]
            case Sum():
                return sum(found[c] * found[b] for c, b in node.terms)
        return operands[0] if operands else self._cycle_value(node)
