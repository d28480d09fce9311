"""By how much a condition is met or missed, as a number that a search can follow."""

import ast
from collections.abc import Mapping

import numpy as np

from sweeps.text.expressions import Expression, Operation, Tree

WORST = 1.0


def margins(condition: Expression, values: Mapping[str, float | np.ndarray], count: int) -> np.ndarray:
    """Margins of a condition, one for each part that `and` joins: above 0 by how much it is missed.

    The margin of a ≤ b is (a − b) / (|a| + |b|): 0 on the limit, 1 at worst, whatever the units. Of parts joined by
    `or` the least counts. Where a number is undefined the condition is missed at worst.

    Parameters
    ----------
    condition : Expression
    values : mapping of str to float or ndarray (count,)
        A value (SI) of each of its names.
    count : int
        Number of candidates.

    Returns
    -------
    ndarray (parts, count)
        A part is met where its margin is 0 or less, but for strict inequalities just on their limit.
    """
    with np.errstate(all="ignore"):
        found = [np.broadcast_to(_margin(part, values, 1.0), (count,)) for part in _joined(condition.tree)]
    return np.where(np.isnan(found), WORST, found)


def conjuncts(text: str) -> list[str]:
    """Texts of the conditions that `and` joins in one that can be parsed."""
    line = " ".join(text.split())
    tree = ast.parse(line, mode="eval").body
    if not (isinstance(tree, ast.BoolOp) and isinstance(tree.op, ast.And)):
        return [line]
    return [part for value in tree.values for part in conjuncts(ast.get_source_segment(line, value))]


def _joined(tree: Tree) -> list[Tree]:
    """Parts of a condition that must all hold."""
    if isinstance(tree, Operation) and tree.name == "and":
        return [part for operand in tree.operands for part in _joined(operand)]
    return [tree]


def _margin(tree: Operation, values: Mapping[str, float | np.ndarray], sign: float) -> np.ndarray:
    """Margin of a condition, or with sign −1 of its contrary."""
    if tree.name == "not":
        return _margin(tree.operands[0], values, -sign)
    if tree.name in ("and", "or"):
        worst = (tree.name == "and") == (sign > 0)
        return (np.maximum if worst else np.minimum).reduce([_margin(part, values, sign) for part in tree.operands])
    a, b = (Expression("", (), False, operand).evaluate(values) for operand in tree.operands)
    whole = np.abs(a) + np.abs(b)
    apart = np.divide(np.subtract(a, b), whole, out=np.zeros(np.shape(whole)), where=whole != 0)
    match tree.name:
        case "<" | "<=":
            return sign * apart
        case ">" | ">=":
            return -sign * apart
        case "==":
            return np.abs(apart) if sign > 0 else np.where(apart == 0, WORST, -np.abs(apart))
        case _:
            return np.where(apart == 0, WORST, -np.abs(apart)) if sign > 0 else np.abs(apart)
