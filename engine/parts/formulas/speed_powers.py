"""A formula as a sum of powers of the input speed, Σ c_n |ω|ⁿ, if it is one.

A machine's velocities are its transfer functions times the input speed. A formula that combines them by products, sums,
fixed powers, roots, absolute values and signs is therefore a sum of powers of that speed, with coefficients that depend
on position (and time) only. The equation of motion takes its moments in this form.
"""

from collections.abc import Collection, Mapping
from fractions import Fraction

from engine.parts.formulas.expressions import (
    TextOperation,
    Tree,
    evaluate_tree,
    is_zero,
    names_in_tree,
)
from engine.parts.formulas.switching import operations

# Whole powers of sums are expanded up to this one.
LARGEST_POWER = 8
# Products of sums with more terms aren't expanded.
MOST_PRODUCTS = 100
# Operations that jump where their operands cross.
JUMPS = ("<", "<=", ">", ">=", "sign", "atan2")
# Powers such as 1/3 are rounded numbers.
_LARGEST_DENOMINATOR = 1000

Powers = Mapping[Fraction, Tree]
_ZERO, _ONE = Fraction(0), Fraction(1)


class NoPowerError(ValueError):
    """A formula that depends on the speed other than by powers; `operation` is the place."""

    def __init__(self, operation: TextOperation) -> None:
        super().__init__(operation.name)
        self.operation = operation


def powers_of_speed(tree: Tree, velocities: Collection[str]) -> Powers:
    """Decompose a formula into powers of the input speed.

    Parameters
    ----------
    tree : float, TextQuantity, str or TextOperation
        The structure of the formula.
    velocities : collection of str
        Names of quantities proportional to the speed.

    Returns
    -------
    mapping of Fraction to tree
        Coefficient of each power; velocities in it are taken at unit speed, in the direction of the motion.

    Raises
    ------
    NoPowerError
        The formula is not a sum of powers.
    """
    if not isinstance(tree, TextOperation):
        return {_ONE if isinstance(tree, str) and tree in velocities else _ZERO: tree}
    if not any(name in velocities for name in names_in_tree(tree)):
        return {_ZERO: tree}
    if tree.name == "**":
        return _power(tree, velocities)
    if tree.name == "if":
        condition, *choices = tree.operands
        parts = [powers_of_speed(choice, velocities) for choice in choices]
        same = _condition(condition, velocities)
        exponents = dict.fromkeys(n for part in parts for n in part)
        return {n: tree._replace(operands=(same, *(part.get(n, 0.0) for part in parts))) for n in exponents}
    parts = [powers_of_speed(operand, velocities) for operand in tree.operands]
    match tree.name:
        case "+" | "-":
            return _sum(tree, *parts)
        case "*":
            return _product(tree, *parts)
        case "negative":
            return {n: tree._replace(operands=(part,)) for n, part in parts[0].items()}
        case "/":
            (below,) = _alike(tree, [parts[1]])
            return {n - below: tree._replace(operands=(part, parts[1][below])) for n, part in parts[0].items()}
        case "sqrt":
            (n,) = _alike(tree, parts)
            return {n / 2: tree._replace(operands=(parts[0][n],))}
        case "abs" | "min" | "max":
            (n,) = _alike(tree, parts)
            return {n: _of_alike(tree, parts)}
        case "sign" | "atan2":
            _alike(tree, parts)
            return {_ZERO: _of_alike(tree, parts)}
        case _:
            raise NoPowerError(tree)


def jump_at_a_speed(tree: Tree, velocities: Collection[str]) -> TextOperation | None:
    """The operation of a formula that jumps at a certain speed, whatever the position; None if there is none."""
    for operation in operations(tree):
        if operation.name in JUMPS:
            try:
                _alike(operation, [powers_of_speed(operand, velocities) for operand in operation.operands])
            except NoPowerError:
                return operation
    return None


def _condition(tree: TextOperation, velocities: Collection[str]) -> TextOperation:
    """A condition that doesn't depend on the speed, with velocities at unit speed."""
    if tree.name in ("and", "or", "not"):
        return tree._replace(operands=tuple(_condition(part, velocities) for part in tree.operands))
    parts = [powers_of_speed(operand, velocities) for operand in tree.operands]
    _alike(tree, parts)
    return _of_alike(tree, parts)


def _alike(tree: TextOperation, parts: list[Powers]) -> set[Fraction]:
    """The common power of all parts; zero has any power."""
    found = {n for part in parts for n, factor in part.items() if not is_zero(factor)} or {_ZERO}
    if len(found) > 1 or any(len(part) > 1 for part in parts):
        raise NoPowerError(tree)
    return found


def _of_alike(tree: TextOperation, parts: list[Powers]) -> TextOperation:
    return tree._replace(operands=tuple(next(iter(part.values())) for part in parts))


def _sum(tree: TextOperation, left: Powers, right: Powers) -> Powers:
    found = {}
    for n in dict.fromkeys([*left, *right]):
        if n not in left:
            found[n] = TextOperation("negative", (right[n],), tree.column) if tree.name == "-" else right[n]
        else:
            found[n] = tree._replace(operands=(left[n], right[n])) if n in right else left[n]
    return found


def _product(tree: TextOperation, left: Powers, right: Powers) -> Powers:
    found: dict[Fraction, Tree] = {}
    if len(left) * len(right) > MOST_PRODUCTS:
        raise NoPowerError(tree)
    for n, a in left.items():
        for m, b in right.items():
            term = TextOperation("*", (a, b), tree.column)
            found[n + m] = TextOperation("+", (found[n + m], term), tree.column) if n + m in found else term
    return found


def _power(tree: TextOperation, velocities: Collection[str]) -> Powers:
    base, exponent = powers_of_speed(tree.operands[0], velocities), tree.operands[1]
    if names_in_tree(exponent):
        raise NoPowerError(tree)
    power = Fraction(evaluate_tree(exponent, {}).item()).limit_denominator(_LARGEST_DENOMINATOR)
    if len(base) == 1:
        ((n, factor),) = base.items()
        return {n * power: tree._replace(operands=(factor, exponent))}
    if power.denominator != 1 or not 1 <= power <= LARGEST_POWER:
        raise NoPowerError(tree)
    found = base
    for _ in range(int(power) - 1):
        found = _product(tree, found, base)
    return found
