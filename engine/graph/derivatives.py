"""Derivatives of nodes: differentiation rules along the graph, and derivatives of laws."""

from collections.abc import Callable, Mapping

from engine.graph.nodes import LawResult, Node, Operation, Sum, reached
from engine.laws.elementary import angle_of, direction_of, exponential, logarithm, power
from engine.laws.senses import angle_on_side, kept_positive, sense, side

# Derivatives of each law by some of its operands, by operand index; each builds a node from a result of the law and its
# operands.
Slopes = Mapping[Callable, Mapping[int, Callable[..., Node]]]


def _turned(cosine_or_sine: LawResult, angle: Node) -> Node:
    cosine, sine = angle.graph.apply(direction_of, angle)
    return cosine if cosine_or_sine is sine else -sine


_ELEMENTARY: Slopes = {
    exponential: {0: lambda y, x: y},
    logarithm: {0: lambda _, x: 1.0 / x},
    power: {
        0: lambda _, x, n: n * x.graph.apply(power, x, n - 1.0),
        1: lambda y, x, n: y * x.graph.apply(logarithm, x),
    },
    direction_of: {0: _turned},
    angle_of: {0: lambda _, x, y: -y / (x * x + y * y), 1: lambda _, x, y: x / (x * x + y * y)},
    angle_on_side: {1: lambda _, __, x, y: -y / (x * x + y * y), 2: lambda _, __, x, y: x / (x * x + y * y)},
    kept_positive: {1: lambda _, __, x: x.graph.one},
    # A sign is constant on either side of its switch.
    sense: {0: lambda _, x: x.graph.zero},
    side: {0: lambda _, x: x.graph.zero},
}
# Step of the central difference for laws without a known derivative: BESIDE times the operand plus LEAST. Its error is
# of the order of the step squared, plus rounding divided by the step.
BESIDE, LEAST = 2.0**-17, 2.0**-30


def derivative(node: Node, known: Mapping[Node, Node], slopes: Slopes | None = None) -> Node:
    """Derivative of a node.

    Parameters
    ----------
    node : Node
    known : mapping of Node to Node
        Nodes with their derivatives: 1 for the variable. Nodes that depend on none of these are constant.
    slopes : mapping, optional
        Derivatives of laws, apart from the elementary ones; others are differentiated by central differences.
    """
    graph, slopes = node.graph, {**_ELEMENTARY, **(slopes or {})}
    found = dict(known)
    for n in reached([node], known.__contains__):
        if n not in known and any(o in found for o in _operands(n)):
            found[n] = _rule(n, {o: found.get(o, graph.zero) for o in _operands(n)}, slopes)
    return found.get(node, graph.zero)


def _operands(node: Node) -> tuple[Node, ...]:
    return node.application.operands if isinstance(node, LawResult) else node.operands


def _rule(node: Node, d: Mapping[Node, Node], slopes: Slopes) -> Node:
    graph = node.graph
    if isinstance(node, LawResult):
        return _of_law(node, d, slopes)
    if isinstance(node, Sum):
        return sum((d[c] * b + c * d[b] for c, b in node.terms), graph.zero)
    if not isinstance(node, Operation):
        return graph.zero
    a, *rest = node.operands
    match node.symbol:
        case "+":
            return d[a] + d[rest[0]]
        case "-":
            return d[a] - d[rest[0]]
        case "*":
            return d[a] * rest[0] + a * d[rest[0]]
        case "/":
            return (d[a] - node * d[rest[0]]) / rest[0]
        case "sqrt":
            return d[a] * (1.0 / node) * 0.5
        case "abs":
            # At rest the derivative is 0, the middle of its range.
            return d[a] * graph.apply(sense, a)
    return -d[a]


def _of_law(result: LawResult, d: Mapping[Node, Node], slopes: Slopes) -> Node:
    graph, law, operands = result.graph, result.application.law, result.application.operands
    known, total = slopes.get(law, {}), graph.zero
    for i, operand in enumerate(operands):
        if d[operand] is graph.zero:
            continue
        if i in known:
            total = total + known[i](result, *operands) * d[operand]
            continue
        step = BESIDE * abs(operand) + LEAST
        high, low = (
            _law_at(result, [*operands[:i], operand + side * step, *operands[i + 1 :]]) for side in (1.0, -1.0)
        )
        total = total + (high - low) / (2.0 * step) * d[operand]
    return total


def _law_at(result: LawResult, operands: list[Node]) -> Node:
    application = result.application
    made = result.graph.apply(application.law, *application.arguments(operands))
    return made if result.index is None else made[result.index]
