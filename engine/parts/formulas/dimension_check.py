"""Dimensional analysis of expressions: which quantities may be added, compared and raised to a power.

The angle matters when a result is named (rad/s is an angular speed) but never makes two quantities incompatible: with
radians, r φ is a length and ω r a speed.
"""

import functools
import math
from collections.abc import Iterable, Mapping
from fractions import Fraction

from engine.parts.formulas.expressions import (
    ExpressionError,
    TextExpression,
    TextOperation,
    TextQuantity,
    Tree,
    is_zero,
    pointed_out,
)
from engine.units.dimensions import DIMENSIONS, Powers, common_units
from engine.units.reading import dimension_of_unit, in_any_unit

# Roots of powers of roots have small denominators; any other fraction is a rounded number such as 0.333.
_LARGEST_DENOMINATOR = 1000
_COMPARISONS = {"<", "<=", ">", ">=", "==", "!="}
_ALIKE = {"+", "-", "min", "max", "atan2"} | _COMPARISONS
_KEPT = {"negative", "abs", "min", "max", "+", "-"}
_TO_ANGLE = {"asin", "acos", "atan", "atan2", "radians"}


def unit_of_dimension(dimension: Powers) -> str:
    """SI unit of a dimension in the CF conventions' spelling: the usual one, such as "N m", else such as "m3 s-1".

    Empty for fractional powers, such as the root of a length, which the conventions can't spell.
    """
    names = _names(dimension)
    if names:
        return DIMENSIONS[names[0]].unit
    whole = all(power.denominator == 1 for power in dimension.plain)
    return dimension.plain.spelled if whole else ""


def dimension_in_words(dimension: Powers) -> str:
    """A dimension in words, such as "a length" or "a plain number"."""
    names = [name.replace("_", " ") for name in _names(dimension)]
    if not names:
        return f"a quantity in {dimension.plain.spelled}"
    words = "plain number" if names == ["number"] else " or ".join(names)
    return f"{'an' if words[0] in 'aei' else 'a'} {words}"


def dimension_of(expression: TextExpression, known: Mapping[str, Powers]) -> Powers:
    """Dimension of an expression's value; a condition is a plain number.

    Parameters
    ----------
    expression : TextExpression
    known : mapping of str to Powers
        Dimension of each name in the expression.

    Raises
    ------
    ExpressionError
        The expression adds or compares different dimensions, has a power that isn't a fixed number, or applies a
        function to a quantity with a dimension; the message shows the place.
    """
    return _Checker(expression.text, known).dimension(expression.tree)


def check_yields(expression: TextExpression, wanted: Powers, known: Mapping[str, Powers]) -> None:
    """Check that an expression gives a quantity of the wanted dimension; zero has every dimension.

    Parameters
    ----------
    expression : TextExpression
    wanted : Powers
    known : mapping of str to Powers
        As in `dimension_of`.

    Raises
    ------
    ExpressionError
        The dimension is another one, or the parts of the expression do not match.
    """
    found = dimension_of(expression, known)
    if found.plain != wanted.plain and not is_zero(expression.tree):
        hint = _unit_hint([expression.tree], wanted)
        gives, wants = dimension_in_words(found), dimension_in_words(wanted)
        raise ExpressionError(f"{expression.text!r} gives {gives}, but this is {wants}{hint}")


def dimensions_by_unit(units: Mapping[str, str]) -> dict[str, Powers | None]:
    """Dimensions of names from their SI units in CF spelling; None if the unit is "", unknown."""
    return {name: dimension_of_unit(unit) if unit else None for name, unit in units.items()}


@functools.cache
def _names(dimension: Powers) -> list[str]:
    """Names of a dimension, including its angles if such names exist, else without."""
    units = {name: dimension_of_unit(d.unit) for name, d in DIMENSIONS.items()}
    exact = [name for name, other in units.items() if other == dimension]
    return exact or [name for name, other in units.items() if other.plain == dimension.plain]


_NUMBER = Powers()
_AN_ANGLE = Powers(angle=1)


def _bare_number(tree: Tree) -> float | None:
    """The value of a number without a unit, with its sign; None for any other tree."""
    if isinstance(tree, TextOperation) and tree.name == "negative":
        inner = _bare_number(tree.operands[0])
        return None if inner is None else -inner
    return tree if isinstance(tree, float) else None


def _unit_hint(trees: Iterable[Tree], wanted: Powers) -> str:
    """Suggestion to write a bare number among the trees with a unit of the wanted dimension."""
    number = next((value for tree in trees if (value := _bare_number(tree)) is not None), None)
    names = _names(wanted)
    if number is None or not names or not wanted.plain:
        return ""
    *others, si = common_units(names[0])
    texts = " or ".join(f"'{number:g} {unit}'" for unit in (si, *others))
    return f"; {number:g} has no unit: write {texts}"


class _Checker:
    """Computes the dimension of each part of an expression."""

    def __init__(self, text: str, known: Mapping[str, Powers]) -> None:
        self.text, self.known = text, known

    def dimension(self, tree: Tree) -> Powers:
        if isinstance(tree, TextQuantity):
            return in_any_unit(tree.text)[1]
        if isinstance(tree, str):
            return self.known[tree]
        if isinstance(tree, float):
            return _NUMBER
        operands = [self.dimension(operand) for operand in tree.operands]
        match tree.name:
            case "*":
                return operands[0] * operands[1]
            case "/":
                return operands[0] / operands[1]
            case "**":
                return self.power(tree, *operands)
            case "sqrt":
                return operands[0] ** Fraction(1, 2)
            case name if name in _ALIKE or name in _KEPT:
                alike = self.alike(tree, operands)
                return alike if name in _KEPT else _AN_ANGLE if name in _TO_ANGLE else _NUMBER
            case "and" | "or" | "not" | "sign":
                return _NUMBER
            case "if":
                return self.alike(tree._replace(operands=tree.operands[1:]), operands[1:])
            case _:
                return self.function(tree, operands[0])

    def alike(self, tree: TextOperation, operands: list[Powers]) -> Powers:
        """The common dimension of the operands."""
        pairs = [(t, d) for t, d in zip(tree.operands, operands, strict=True) if not is_zero(t)]
        kinds = {d.plain for _, d in pairs}
        if len(kinds) > 1:
            first = pairs[0][1]
            second = next(d for _, d in pairs if d.plain != first.plain)
            wanted = first if first.plain else second
            raise self.refusal(tree, _clash(tree.name, first, second) + _unit_hint(tree.operands, wanted))
        exact = {d for _, d in pairs}
        return exact.pop() if len(exact) == 1 else kinds.pop() if kinds else _NUMBER

    def power(self, tree: TextOperation, base: Powers, exponent: Powers) -> Powers:
        if exponent.plain:
            raise self.refusal(tree, f"a power must be a plain number, this is {dimension_in_words(exponent)}")
        if not base.plain:
            return _NUMBER
        # NaN values for the names reveal an exponent that varies.
        number = TextExpression(self.text, (), False, tree.operands[1]).evaluate(dict.fromkeys(self.known, math.nan))
        if not math.isfinite(number):
            words = f"the power of {dimension_in_words(base)} must be a fixed number, or its unit would vary"
            raise self.refusal(tree, words)
        return base ** Fraction(number).limit_denominator(_LARGEST_DENOMINATOR)

    def function(self, tree: TextOperation, operand: Powers) -> Powers:
        if operand.plain:
            taken = "an angle or a plain number" if tree.name in ("sin", "cos", "tan") else "a plain number"
            raise self.refusal(tree, f"{tree.name} takes {taken}, this is {dimension_in_words(operand)}")
        return _AN_ANGLE if tree.name in _TO_ANGLE else _NUMBER

    def refusal(self, tree: TextOperation, what: str) -> ExpressionError:
        return ExpressionError(f"{what}:\n{pointed_out(self.text, tree.column)}")


def _clash(operation: str, first: Powers, second: Powers) -> str:
    one, other = dimension_in_words(first), dimension_in_words(second)
    match operation:
        case "+":
            return f"adds {other} to {one}"
        case "-":
            return f"subtracts {other} from {one}"
        case "if":
            return f"gives {one} or {other}"
        case "min" | "max" | "atan2":
            return f"takes the {operation} of {one} and {other}"
        case _:
            return f"compares {one} with {other}"
