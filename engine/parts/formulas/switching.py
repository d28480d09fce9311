"""Switching of a formula's pieces: the quantities whose difference changes sign there, and how often it oscillates.

Crossings are searched between the turning points of a curve, whose number per cycle is limited. The curves on which a
formula switches must not have more turning points than that; those of a mechanism don't.
"""

import math
from collections.abc import Iterator

from engine.parts.formulas.expressions import TextOperation, Tree, evaluate_tree, names_in_tree

# Maximum number of turning points per cycle of a curve on which a formula switches.
MOST_TURNS = 12.0
# Typical number of turning points per cycle of a mechanism's curves.
_OF_MECHANISM = 2.0
# Exponent assumed for a power whose exponent varies.
_VARYING_POWER = 3.5


def operations(tree: Tree) -> Iterator[TextOperation]:
    """All operations of a formula, outermost first."""
    if isinstance(tree, TextOperation):
        yield tree
        for operand in tree.operands:
            yield from operations(operand)


def compared(operation: TextOperation) -> list[tuple[Tree, Tree]]:
    """Pairs of quantities that an operation compares."""
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
    """Turning points per cycle of a part of a formula, estimated from its structure; infinite if unknown.

    Parameters
    ----------
    tree : Tree
    cycles : dict of str to float
        For names that grow steadily, the crank angle and the time: their growth per cycle divided by 2π. For constant
        names: 0.
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
    """Change of an angle over a cycle, in periods of 2π."""
    names = names_in_tree(angle)
    if all(cycles.get(name) == 0.0 for name in names):
        return 0.0
    slope = _growth(angle, cycles)
    if slope is not None:
        return abs(slope)
    return math.inf


def _growth(tree: Tree, cycles: dict[str, float]) -> float | None:
    """Growth per cycle, in periods, of a sum of multiples of steadily growing names and of link angles; else None."""
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
