"""Nodes of a machine's equations: what each is computed from, and how often it changes.

A node is the position of the input, a number, a law applied to nodes, or arithmetic on nodes. A `Graph` makes each node
once: the same law applied to the same nodes is the same node. Arithmetic reads like a textbook, `v = w * r - u`, and
zeros and ones are simplified away.

A node's `Stage` states how often it changes. A number of the scene belongs to the variant; a result of the ends of
a stroke to the variant's cycle; the active segment of a table to the panel; a node of the speed, the acceleration or
the time of a motion to its state; every other node to the position.
"""

import operator
from collections.abc import Callable, Iterable, Mapping, Sequence
from enum import IntEnum
from functools import cache, partial
from typing import Literal, NamedTuple, get_args, get_type_hints

import numpy as np

Compute = Callable[[Mapping[str, float | np.ndarray]], float | np.ndarray]


class Stage(IntEnum):
    """How often a node changes, least often first."""

    VARIANT = 0
    CYCLE = 1
    PANEL = 2
    POSITION = 3
    STATE = 4


class Node:
    """A quantity with one value for each variant and position.

    Attributes
    ----------
    graph : Graph
    stage : Stage
    operands : tuple of Node
        Nodes it is computed from.
    label : str
        Name for readers; printed code names variables after it.
    """

    __slots__ = ("graph", "label", "operands", "stage")

    def __init__(self, graph: "Graph", stage: Stage, operands: tuple["Node", ...] = (), label: str = "") -> None:
        self.graph, self.stage, self.operands, self.label = graph, stage, operands, label

    def __add__(self, other: "Node | float") -> "Node":
        return self.graph.operation("+", self, other)

    def __radd__(self, other: "Node | float") -> "Node":
        return self.graph.operation("+", other, self)

    def __sub__(self, other: "Node | float") -> "Node":
        return self.graph.operation("-", self, other)

    def __rsub__(self, other: "Node | float") -> "Node":
        return self.graph.operation("-", other, self)

    def __mul__(self, other: "Node | float") -> "Node":
        # A vector multiplies its components itself, in `Vector.__rmul__`.
        return NotImplemented if isinstance(other, tuple) else self.graph.operation("*", self, other)

    def __rmul__(self, other: "Node | float") -> "Node":
        return self.graph.operation("*", other, self)

    def __truediv__(self, other: "Node | float") -> "Node":
        return self.graph.operation("/", self, other)

    def __rtruediv__(self, other: "Node | float") -> "Node":
        return self.graph.operation("/", other, self)

    def __neg__(self) -> "Node":
        return self.graph.function("neg", self)

    def __abs__(self) -> "Node":
        return self.graph.function("abs", self)

    def __repr__(self) -> str:
        return f"<{type(self).__name__} {self.label}>" if self.label else f"<{type(self).__name__}>"


class Constant(Node):
    """A number that is the same for all machines."""

    __slots__ = ("value",)

    def __init__(self, graph: "Graph", value: float) -> None:
        super().__init__(graph, Stage.VARIANT, label=repr(value))
        self.value = value


def _written(compute: Compute) -> tuple:
    """What a function computes, as far as can be compared: its code, and the texts and numbers it refers to."""
    function, given = (compute.func, compute.args) if isinstance(compute, partial) else (compute, ())
    given += tuple(cell.cell_contents for cell in getattr(function, "__closure__", None) or ())
    return getattr(function, "__code__", function), *(x for x in given if isinstance(x, (str, int, float)))


class Number(Node):
    """A number of the variant, computed from the scene's numbers.

    Attributes
    ----------
    compute : callable
        Returns its value, or its values for all variants (SI), from the numbers by path.
    """

    __slots__ = ("compute",)

    def __init__(self, graph: "Graph", label: str, compute: Compute) -> None:
        super().__init__(graph, Stage.VARIANT, label=label)
        self.compute = compute


class NumberTable(Node):
    """Numbers of the variant, in consecutive rows, that a law looks up by index.

    A law takes the table as three arguments: the flat memory of numbers, the index of the first number in it, and the
    distance from one number to the next.
    """

    __slots__ = ()


class Found(Node):
    """A number of the variant's cycle that is located by a scan of the cycle, such as an end of a stroke.

    Attributes
    ----------
    curve, rate : Node
        The curve and its derivative by the input.
    which : {"low", "high", "low_at", "high_at"}
        Minimum or maximum of the curve, or the position of the input there.
    """

    __slots__ = ("curve", "rate", "which")

    def __init__(self, graph: "Graph", curve: Node, rate: Node, which: str) -> None:
        super().__init__(graph, Stage.CYCLE, label=f"{curve.label} {which}")
        self.curve, self.rate, self.which = curve, rate, which


class Position(Node):
    """The position of the input: q [rad], or its cosine or sine."""

    __slots__ = ("which",)

    def __init__(self, graph: "Graph", which: Literal["q", "cos_q", "sin_q"]) -> None:
        super().__init__(graph, Stage.POSITION, label=which)
        self.which = which


class Given(Node):
    """A number that the caller supplies for each variant, position or state, according to its stage.

    Functions read it like a number of the variant, so it is equal at all positions of one call.
    """

    __slots__ = ()


class TableMemory(Node):
    """The flat memory of all tables: the first argument of every law that looks something up."""

    __slots__ = ()


class Operation(Node):
    """Arithmetic on two nodes, or an elementary function of one.

    Attributes
    ----------
    symbol : str
        "+", "-", "*", "/", "sqrt", "abs" or "neg".
    """

    __slots__ = ("symbol",)

    def __init__(self, graph: "Graph", symbol: str, operands: tuple[Node, ...]) -> None:
        super().__init__(graph, max(o.stage for o in operands), operands)
        self.symbol = symbol


class Application(Node):
    """A law applied to nodes; its results are separate nodes.

    Attributes
    ----------
    law : callable
        A compiled scalar function.
    sizes : tuple of int
        Number of operands in each argument of the law that is a tuple; 0 for a scalar argument.
    """

    __slots__ = ("law", "sizes")

    def __init__(self, graph: "Graph", law: Callable, operands: tuple[Node, ...], sizes: tuple[int, ...]) -> None:
        # A law of the variant's numbers only still runs in compiled code, so its stage is the cycle at the earliest.
        super().__init__(graph, max(Stage.CYCLE, *(o.stage for o in operands)), operands, name_of(law))
        self.law, self.sizes = law, sizes

    def arguments(self, operands: Iterable) -> list:
        """Group values, one for each operand, as the law takes them: a tuple for each argument that is a tuple."""
        each = iter(operands)
        return [tuple(next(each) for _ in range(size)) if size else next(each) for size in self.sizes]


class LawResult(Node):
    """One result of an application.

    Attributes
    ----------
    index : int or None
        Index among several results; None if the law has a single result.
    """

    __slots__ = ("index",)

    def __init__(self, graph: "Graph", application: Application, index: int | None) -> None:
        super().__init__(graph, application.stage, (application,))
        self.index = index

    @property
    def application(self) -> Application:
        """The application that yields this result."""
        return self.operands[0]


class Held(Node):
    """A node that keeps its mid-panel value throughout a panel.

    Switches are held: the sign of a velocity, the segment of a table. Panels end where they switch, so that curves are
    smooth within each panel up to its ends.
    """

    __slots__ = ()

    def __init__(self, graph: "Graph", operand: Node) -> None:
        super().__init__(graph, Stage.PANEL, (operand,), operand.label)


class Sum(Node):
    """A linear combination: a constant plus coefficients times curves.

    Attributes
    ----------
    terms : tuple of (Node, Node)
        Coefficient, which belongs to the variant, and curve.
    """

    __slots__ = ("terms",)

    def __init__(self, graph: "Graph", terms: tuple[tuple[Node, Node], ...]) -> None:
        operands = tuple(node for term in terms for node in term)
        super().__init__(graph, max(o.stage for o in operands), operands)
        self.terms = terms


class Crossing(NamedTuple):
    """Positions at which something switches: where a curve crosses `level` + `offset`.

    Attributes
    ----------
    curve, rate : Node
        The curve and its derivative by the input.
    level : Node
        Belongs to the variant or to its cycle.
    offset : float
        Rows of a table at known distances from one level are data, not nodes.
    """

    curve: Node
    rate: Node
    level: Node
    offset: float


class Return(NamedTuple):
    """A condition on which nodes return to their initial values at the end of a cycle.

    Attributes
    ----------
    of : str
        Path of the part of the scene that the condition belongs to.
    turns : Node
        Number of the variant: turns, or periods, over the cycle.
    none : bool
        Whether `turns` must be zero; otherwise it must be an integer.
    """

    of: str
    turns: Node
    none: bool = False


class Alike(NamedTuple):
    """A curve of a kind closed under weighted sums, such as all tables over one abscissa.

    Attributes
    ----------
    kind : tuple
        Equal for curves that can be summed into one.
    data : object
        Distinguishes this curve from others of its kind.
    total : callable
        Returns the weighted sum from a list of (weight, data); a weight is a number of the variant.
    """

    kind: tuple
    data: object
    total: Callable[[list[tuple["Number | Constant", object]]], Node]


OPERATIONS = {"+": operator.add, "-": operator.sub, "*": operator.mul, "/": operator.truediv}
OPERATIONS |= {"sqrt": np.sqrt, "abs": np.abs, "neg": np.negative}


def name_of(law: Callable) -> str:
    """Name of a compiled function."""
    return law.py_func.__name__


def value_of(number: Node, numbers: Mapping[str, float | np.ndarray]) -> float | np.ndarray:
    """Value of a constant or of a number of the variant."""
    return number.value if isinstance(number, Constant) else number.compute(numbers)


@cache
def _annotated(law: Callable) -> object:
    return get_type_hints(law.py_func)["return"]


class Graph:
    """Makes nodes, each of them once.

    Attributes
    ----------
    zero, one : Constant
    q, cos_q, sin_q : Position
    memory : TableMemory
        All tables.
    tables : list of ndarray
        Contents of the memory, in order.
    """

    def __init__(self) -> None:
        self._made: dict[tuple, Node] = {}
        self.zero, self.one = self.constant(0.0), self.constant(1.0)
        self.q, self.cos_q, self.sin_q = (Position(self, which) for which in ("q", "cos_q", "sin_q"))
        self.memory = TableMemory(self, Stage.VARIANT, label="memory")
        self.tables: list[np.ndarray] = []
        self._crossings: dict[tuple[Node, Node, float], Crossing] = {}
        self._bends: dict[Node, set[Node]] = {}
        self._returns: dict[Node, Return] = {}
        self._alike: dict[Node, Alike] = {}

    def _once(self, key: tuple, make: Callable[[], Node]) -> Node:
        node = self._made.get(key)
        if node is None:
            node = self._made[key] = make()
        return node

    def in_order(self, nodes: Iterable[Node]) -> list[Node]:
        """Nodes in the order in which they were first made."""
        made = {node: i for i, node in enumerate(self._made.values())}
        # Positions and the memory are there from the beginning.
        return sorted(dict.fromkeys(nodes), key=lambda node: made.get(node, -1))

    def constant(self, value: float) -> Constant:
        """Return the node of a constant."""
        return self._once(("constant", float(value)), lambda: Constant(self, float(value)))

    def number(self, path: str) -> Number:
        """Return the node of a number of the scene, unchanged."""
        return self.derived(path, lambda numbers: numbers[path])

    def derived(self, label: str, compute: Compute) -> Number:
        """Return a number computed once per variant from the scene's numbers; equal labels mean the same number."""
        found = self._once(("number", label), lambda: Number(self, label, compute))
        if _written(found.compute) != _written(compute):
            raise ValueError(f"the label {label!r} stands for two numbers")
        return found

    def number_table(self, label: str, numbers: Iterable[Number]) -> NumberTable:
        """Return a table of numbers to look up by index; no other node may use these numbers."""
        return self._once(("number table", label), lambda: NumberTable(self, Stage.VARIANT, tuple(numbers), label))

    def found(self, curve: Node, rate: Node, which: Literal["low", "high", "low_at", "high_at"]) -> Node:
        """Minimum or maximum of a curve over the cycle, or its position; a constant curve is returned unchanged."""
        if curve.stage < Stage.POSITION and not which.endswith("_at"):
            return curve
        return self._once(("found", curve, which), lambda: Found(self, curve, rate, which))

    def given(self, label: str, stage: Stage = Stage.POSITION) -> Given:
        """Return a number that the caller supplies, as often as its stage says; equal labels mean the same number."""
        return self._once(("given", label), lambda: Given(self, stage, label=label))

    def operation(self, symbol: str, a: Node | float, b: Node | float) -> Node:
        """Return arithmetic on two nodes, simplified where an operand is zero, one or constant."""
        a, b = (n if isinstance(n, Node) else self.constant(n) for n in (a, b))
        simple = self._simplified(symbol, a, b)
        if simple is not None:
            return simple
        if isinstance(a, (Number, Constant)) and isinstance(b, (Number, Constant)):
            return self._of_numbers(symbol, a, b)
        return self._once((symbol, a, b), lambda: Operation(self, symbol, (a, b)))

    def _simplified(self, symbol: str, a: Node, b: Node) -> Node | None:
        zero, one = self.zero, self.one
        if isinstance(a, Constant) and isinstance(b, Constant) and not (symbol == "/" and b is zero):
            return self.constant(OPERATIONS[symbol](a.value, b.value))
        match symbol:
            case "+" if a is zero:
                return b
            case "+" | "-" if b is zero:
                return a
            case "-" if a is b:
                return zero
            case "-" if a is zero:
                return -b
            case "*" if zero in (a, b):
                return zero
            case "*" if a is one:
                return b
            case "*" | "/" if b is one:
                return a
            case "/" if a is zero:
                return zero
        return None

    def _of_numbers(self, symbol: str, a: Node, b: Node) -> Number:
        """Return arithmetic on numbers of the variant, itself such a number."""
        does = OPERATIONS[symbol]
        return self.derived(
            f"({a.label} {symbol} {b.label})",
            lambda numbers: does(value_of(a, numbers), value_of(b, numbers)),
        )

    def function(self, symbol: Literal["sqrt", "abs", "neg"], x: Node) -> Node:
        """Square root, absolute value or negative of a node."""
        does = OPERATIONS[symbol]
        if isinstance(x, Constant):
            return self.constant(float(does(x.value)) + 0.0)
        if isinstance(x, Number):
            return self.derived(f"{symbol}({x.label})", lambda numbers: does(x.compute(numbers)))
        if symbol == "neg" and isinstance(x, Operation) and x.symbol == "neg":
            return x.operands[0]
        return self._once((symbol, x), lambda: Operation(self, symbol, (x,)))

    def apply(self, law: Callable, *arguments: Node | float | tuple) -> Node | tuple[Node, ...]:
        """Apply a law to nodes and tuples of nodes; returns a node, or a tuple of nodes if the law returns a tuple."""
        sizes = tuple(len(a) if isinstance(a, tuple) else 0 for a in arguments)
        parts = [part for a in arguments for part in (a if isinstance(a, tuple) else (a,))]
        nodes = tuple(n if isinstance(n, Node) else self.constant(n) for n in parts)
        applied = self._once(("law", law, nodes), lambda: Application(self, law, nodes, sizes))
        count = self.results_of(law)
        if count is None:
            return self._result(applied, None)
        return tuple(self._result(applied, i) for i in range(count))

    @staticmethod
    def results_of(law: Callable) -> int | None:
        """Number of results in a law's annotated tuple; None if it returns a single number."""
        return len(get_args(_annotated(law))) or None

    def _result(self, applied: Application, index: int | None) -> Node:
        return self._once(("result", applied, index), lambda: LawResult(self, applied, index))

    def held(self, node: Node) -> Node:
        """Hold a node at its mid-panel value throughout a panel; nodes of other stages are returned unchanged."""
        if node.stage != Stage.POSITION:
            return node
        return self._once(("held", node), lambda: Held(self, node))

    def combination(self, terms: Iterable[tuple[Node, Node]]) -> Node:
        """Sum of coefficients times curves; multiples of one curve, such as loads at one point, merge into one term."""
        kept = [(c, b) for c, b in terms if self.zero not in (c, b)]
        multiples: dict[Node, list[tuple[Node, Node]]] = {}
        for c, b in kept:
            factor, curve = self._multiple(b) if isinstance(c, (Number, Constant)) else (self.one, b)
            multiples.setdefault(curve, []).append((c * factor, (c, b)))
        kept = [
            own[0][1] if len(own) == 1 else (self._total([c for c, _ in own]), curve)
            for curve, own in multiples.items()
        ]
        kept = self._merged(kept)
        if all(isinstance(node, (Number, Constant)) for term in kept for node in term):
            return self._total([c * b for c, b in kept])
        return self._once(("sum", *kept), lambda: Sum(self, tuple(kept)))

    def alike(self, curve: Node, alike: Alike) -> Node:
        """Declare a curve to be one of a kind; returns the curve."""
        self._alike[curve] = alike
        return curve

    def _merged(self, terms: list[tuple[Node, Node]]) -> list[tuple[Node, Node]]:
        """Merge terms with curves of one kind and equal factors: many tables become one lookup."""
        kinds: dict[tuple, list[tuple[Node, Node, Node, Alike | None]]] = {}
        for c, b in terms:
            factor, alike = self._of_kind(b) if isinstance(c, (Number, Constant)) else (self.one, None)
            kinds.setdefault((b,) if alike is None else alike.kind, []).append((c, b, factor, alike))
        found = []
        for kind, own in kinds.items():
            if len(own) == 1:
                found.append(own[0][:2])
                continue
            by_factor: dict[Node, list[tuple[Node, object]]] = {}
            for c, _, factor, alike in own:
                for weight, part in self._parts(factor):
                    by_factor.setdefault(part, []).append((c * weight, alike.data))
            for factor, parts in by_factor.items():
                total = self._once(("total", kind, *parts), partial(own[0][3].total, parts))
                found.append((self.one, factor * total))
        return found

    def _parts(self, curve: Node) -> list[tuple[Node, Node]]:
        """Split a curve into a sum of curves, each with its numerical factor first."""
        if isinstance(curve, Operation) and curve.symbol in ("+", "-"):
            one, other = (self._parts(operand) for operand in curve.operands)
            return one + (other if curve.symbol == "+" else [(-weight, part) for weight, part in other])
        return [self._multiple(curve)]

    def _of_kind(self, curve: Node) -> tuple[Node, Alike | None]:
        """Factor of a curve of some kind, and its kind; None as the kind of any other curve."""
        if curve in self._alike:
            return self.one, self._alike[curve]
        for one, other in (curve.operands, curve.operands[::-1]) if getattr(curve, "symbol", "") == "*" else ():
            factor, alike = self._of_kind(one)
            if alike is not None:
                return factor * other, alike
        return self.one, None

    def _multiple(self, curve: Node) -> tuple[Node, Node]:
        """Split a curve into a numerical factor and the remaining curve."""
        if isinstance(curve, Operation) and curve.symbol == "neg":
            factor, other = self._multiple(curve.operands[0])
            return -factor, other
        if isinstance(curve, Operation) and curve.symbol == "*":
            (f, a), (g, b) = (self._multiple(operand) for operand in curve.operands)
            return f * g, a * b
        return (curve, self.one) if isinstance(curve, (Number, Constant)) else (self.one, curve)

    def _total(self, nodes: Sequence[Node]) -> Node:
        """Sum of nodes; a single number if all of them are numbers."""
        if len(nodes) < 2 or not all(isinstance(node, (Number, Constant)) for node in nodes):
            return sum(nodes, self.zero)
        label = " + ".join(node.label for node in nodes)
        return self.derived(label, lambda numbers: sum(value_of(node, numbers) for node in nodes))

    def switches(self, curve: Node, rate: Node, level: Node | float = 0.0, offset: float = 0.0) -> None:
        """Declare that something switches where a curve crosses a level; `offset` as in `Crossing`."""
        if curve.stage == Stage.POSITION and not (isinstance(level, Node) and level.stage > Stage.CYCLE):
            if not isinstance(level, Node) or isinstance(level, Constant):
                level, offset = self.zero, (level.value if isinstance(level, Node) else float(level)) + offset
            self._crossings.setdefault((curve, level, offset), Crossing(curve, rate, level, offset))

    def bends(self, node: Node, curve: Node) -> None:
        """Declare that a node has a kink where a curve changes sign, as |x| has at the zeros of x."""
        if min(node.stage, curve.stage) >= Stage.POSITION:
            self._bends.setdefault(curve, set()).add(node)

    def kinks_behind(self, nodes: Iterable[Node]) -> list[Node]:
        """Curves at whose zeros some node that `nodes` depend on has a kink."""
        behind = set(reached(nodes))
        return [curve for curve, bent in self._bends.items() if not bent.isdisjoint(behind)]

    def returns(self, nodes: Iterable[Node], condition: Return) -> None:
        """Declare the condition on which nodes return to their initial values at the end of a cycle."""
        self._returns |= {node: condition for node in nodes if node.stage == Stage.POSITION}

    def returns_behind(self, nodes: Iterable[Node]) -> list[Return]:
        """Conditions, without duplicates, on which nodes return to their initial values at the end of a cycle."""
        pending, found, known = list(nodes), {}, set()
        while pending:
            behind = [node for node in reached(pending, self._is_periodic) if node not in known]
            known.update(behind)
            found |= {self._returns[node]: None for node in behind if node in self._returns}
            pending = [curve for node in behind if isinstance(node, Found) for curve in (node.curve, node.rate)]
        return list(found)

    def _is_periodic(self, node: Node) -> bool:
        """Whether a node returns to its initial value although its operands advance from cycle to cycle."""
        return node in self._returns and not self._returns[node].none

    @property
    def crossings(self) -> list[Crossing]:
        """All crossings at which held nodes may switch, without duplicates."""
        return list(self._crossings.values())

    @property
    def all_tables(self) -> np.ndarray:
        """Contents of the memory, which is never empty."""
        return np.concatenate(self.tables) if self.tables else np.zeros(1)

    def store(self, table: np.ndarray) -> Constant:
        """Store a table in the memory, unless it is there already, and return the index at which it begins."""
        flat = np.ascontiguousarray(table, float).ravel()
        begin = 0
        for known in self.tables:
            if np.array_equal(known, flat):
                return self.constant(begin)
            begin += known.size
        self.tables.append(flat)
        return self.constant(begin)


def reached(nodes: Iterable[Node], down_to: Callable[[Node], bool] = lambda node: False) -> list[Node]:
    """All nodes that `nodes` depend on, including themselves, each after its operands.

    Parameters
    ----------
    nodes : iterable of Node
    down_to : callable
        True for a node whose operands aren't followed.
    """
    order: list[Node] = []
    done: set[int] = set()
    pending: list[tuple[Node, bool]] = [(node, False) for node in reversed(list(nodes))]
    while pending:
        node, ready = pending.pop()
        if ready:
            order.append(node)
        elif id(node) not in done:
            done.add(id(node))
            pending.append((node, True))
            if not down_to(node):
                pending.extend((o, False) for o in reversed(node.operands))
    return order
