"""Values of a graph's nodes by NumPy, without any function being printed, and the panels of a cycle by bisection."""

from collections.abc import Mapping, Sequence

import numpy as np

from engine.graph.nodes import (
    Application,
    Constant,
    Found,
    Graph,
    Held,
    LawResult,
    Node,
    Number,
    NumberTable,
    Operation,
    Position,
    Sum,
    TableMemory,
    reached,
)
from engine.parts.skeleton import CrankInput
from engine.scene.scene import Numbers, Scene, scene_numbers

ARITHMETIC = {"+": np.add, "-": np.subtract, "*": np.multiply, "/": np.divide}
FUNCTIONS = {"sqrt": np.sqrt, "abs": np.abs, "neg": np.negative}
SAMPLES = 180
# Bisections until a bracket of 4π/SAMPLES is as wide as a rounding.
HALVINGS = 50


class GraphValues:
    """Values of nodes for one machine, at any positions of its input.

    Held nodes have the value of the position itself, unless others are given.
    """

    def __init__(self, scene: Scene, graph: Graph) -> None:
        self.graph, self.numbers = graph, Numbers(scene_numbers(scene), {})
        self.memory = np.concatenate([np.zeros(0), *graph.tables])
        drive = scene.input
        full = isinstance(drive, CrankInput) and drive.start is None
        ends = (0.0, 2 * np.pi * drive.revolutions) if full else (drive.start, drive.stop)
        self.first, self.last = sorted(ends)
        self.samples = np.linspace(self.first, self.last, SAMPLES + 1)
        self._found: dict[Node, float] = {}

    def __call__(
        self, nodes: Sequence[Node], q: np.ndarray, held: Mapping[Node, np.ndarray] | None = None
    ) -> list[np.ndarray]:
        q = np.asarray(q, float)
        known: dict[Node, np.ndarray] = dict(held or {})
        # Laws may divide by zero, and take the logarithm of zero, on their way.
        with np.errstate(all="ignore"):
            for node in reached(nodes, lambda node: node in known):
                if node not in known:
                    known[node] = self._value(node, q, known)
        return [np.broadcast_to(known[node], q.shape) for node in nodes]

    def _value(self, node: Node, q: np.ndarray, known: dict) -> np.ndarray:
        operands = [known[o] for o in node.operands]
        match node:
            case Constant():
                return np.float64(node.value)
            case Number():
                return np.float64(node.compute(self.numbers))
            case Position():
                return {"q": lambda: q, "cos_q": lambda: np.cos(q), "sin_q": lambda: np.sin(q)}[node.which]()
            case TableMemory():
                return self.memory
            case NumberTable():
                return np.array(operands, float).ravel(), 0, 1
            case Held():
                return operands[0]
            case Found():
                return self._end(node)
            case Operation():
                return {**ARITHMETIC, **FUNCTIONS}[node.symbol](*operands)
            case Application():
                return self._applied(node, operands)
            case LawResult():
                return operands[0] if node.index is None else operands[0][node.index]
            case Sum():
                return sum(known[c] * known[b] for c, b in node.terms)
        raise TypeError(node)

    @staticmethod
    def _applied(node: Application, operands: list) -> np.ndarray | tuple:
        # Tables come first among a law's arguments, one of numbers as three of them.
        leading, first = [], 0
        for n, o in zip(node.operands, operands, strict=True):
            leading += [o] if isinstance(n, TableMemory) else o if isinstance(n, NumberTable) else []
            first += isinstance(n, (TableMemory, NumberTable))
        rest = np.broadcast_arrays(*operands[first:])
        return np.vectorize(lambda *x: node.law(*leading, *node.arguments((*[None] * first, *x))[first:]))(*rest)

    def _end(self, node: Found) -> float:
        if node not in self._found:
            turns = np.array([self.first, self.last, *self.roots(node.rate)])
            values = self([node.curve], turns)[0]
            at = (np.argmin if node.which.startswith("low") else np.argmax)(values)
            self._found[node] = turns[at] if node.which.endswith("_at") else values[at]
        return self._found[node]

    def roots(self, curve: Node, level: float = 0.0, also: Sequence[float] = ()) -> np.ndarray:
        """Where a curve passes a level, each place found once if the curve is monotone between samples and `also`."""
        grid = np.unique([*self.samples, *also])
        above = self([curve], grid)[0] > level
        places = np.flatnonzero(above[1:] != above[:-1])
        left, right, rising = grid[places], grid[places + 1], above[places + 1]
        for _ in range(HALVINGS if places.size else 0):
            middle = 0.5 * (left + right)
            beyond = (self([curve], middle)[0] > level) == rising
            left, right = np.where(beyond, left, middle), np.where(beyond, middle, right)
        return 0.5 * (left + right)

    def cuts(self) -> np.ndarray:
        """Ends of the panels: where anything that the graph says may switch does, and the ends of the cycle."""
        found, turns = [self.first, self.last], {}
        for crossing in self.graph.crossings:
            if crossing.curve not in turns:
                turns[crossing.curve] = self.roots(crossing.rate)
            level = float(self([crossing.level], np.zeros(1))[0][0]) + crossing.offset
            found.extend(self.roots(crossing.curve, level, turns[crossing.curve]))
        return np.unique(found)

    def in_panel(self, nodes: Sequence[Node], left: float, right: float, q: np.ndarray) -> list[np.ndarray]:
        """Values of nodes in a panel, what is held being that of its middle."""
        held = [n for n in reached(nodes) if isinstance(n, Held)]
        middle = self(held, np.array([0.5 * (left + right)]))
        return self(nodes, q, {node: value[0] for node, value in zip(held, middle, strict=True)})
