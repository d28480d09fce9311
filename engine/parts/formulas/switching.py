"""Where the pieces of a formula switch: the numbers whose difference changes its sign there, and how often that turns.

Crossings are looked for between the turns of a curve, of which a cycle may have so many and no more. So the curves by
which a formula switches must not turn oftener than that, as those of a mechanism don't.
"""

import math
from collections.abc import Iterator

from engine.parts.formulas.expressions import TextOperation, Tree, evaluate_tree, names_in_tree

# Turns of a curve in a cycle, at most, by which a formula switches.
MOST_TURNS = 12.0
# Turns of a curve of a mechanism in a cycle, as a rule.
_OF_MECHANISM = 2.0
# A power whose exponent varies counts as this one.
_VARYING_POWER = 3.5


def operations(tree: Tree) -> Iterator[TextOperation]:
    """All operations of a formula, the outermost first."""
    if isinstance(tree, TextOperation):
        yield tree
        for operand in tree.operands:
            yield from operations(operand)


def compared(operation: TextOperation) -> list[tuple[Tree, Tree]]:
    """Pairs of numbers of which an operation asks which is greater."""
    if operation.name in ("<", "<=", ">", ">=", "min", "max"):
        *others, last = operation.operands
        return [(one, last) for one in others]
    if operation.name in ("abs", "sign"):
        inner = operation.operands[0]
        difference = isinstance(inner, TextOperation) and inner.name == "-"
        return [inner.operands if difference else (inner, 0.0)]
    broken_power = operation.name == "**" and not _exponent(operation.operands[1]).is_integer()
    return [(operation.operands[0], 0.0)] if broken_power or operation.name in ("sqrt", "atan2") else []


def turns(tree: Tree, cycles: dict[str, float]) -> float:
    """How often a part of a formula turns in a cycle, estimated from its structure; infinite where nobody knows.

    Parameters
    ----------
    tree : Tree
    cycles : dict of str to float
        Of names that grow steadily, the crank's angle and the time, how many times 2π or its unit they grow in a cycle;
        other names with a number here don't change.
    """
    if not isinstance(tree, TextOperation):
        return 0.0 if not isinstance(tree, str) or tree in cycles else _OF_MECHANISM
    if tree.name in ("sin", "cos", "tan"):
        return 2.0 * _periods(tree.operands[0], cycles)
    found = [turns(operand, cycles) for operand in tree.operands]
    match tree.name:
        case "+" | "-":
            return max(found)
        case "**":
            return found[0] * _exponent(tree.operands[1]) + found[1]
        case _:
            return sum(found)


def _exponent(tree: Tree) -> float:
    return _VARYING_POWER if names_in_tree(tree) else abs(evaluate_tree(tree, {}).item())


def _periods(angle: Tree, cycles: dict[str, float]) -> float:
    """How many times 2π an angle changes in a cycle."""
    names = names_in_tree(angle)
    if all(cycles.get(name) == 0.0 for name in names):
        return 0.0
    slope = _growth(angle, cycles)
    if slope is not None:
        return abs(slope)
    return math.inf


def _growth(tree: Tree, cycles: dict[str, float]) -> float | None:
    """Periods by which a sum of steadily growing names, each times a number, and of links' angles grows in a cycle."""
    if isinstance(tree, str):
        return cycles.get(tree, 1.0 if tree.endswith(".angle") else None)
    if not isinstance(tree, TextOperation):
        return 0.0
    parts = [_growth(operand, cycles) for operand in tree.operands]
    match tree.name:
        case "+" | "-" if None not in parts:
            return abs(parts[0]) + abs(parts[1])
        case "negative":
            return parts[0]
        case "*" | "/" if None not in parts:
            number, other = (1, 0) if tree.name == "/" or not names_in_tree(tree.operands[1]) else (0, 1)
            if names_in_tree(tree.operands[number]):
                return 0.0 if not any(parts) else None
            factor = evaluate_tree(tree.operands[number], {}).item()
            return parts[other] * (factor if tree.name == "*" else 1.0 / factor)
        case "asin" | "acos" | "atan" | "atan2":
            return 0.5 * turns(tree, cycles)
        case "radians":
            return None if parts[0] is None else math.radians(parts[0])
    return None
