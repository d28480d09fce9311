"""Conditions on parameters and results, such as "wheel_mass < '900 kg'": read, checked and judged here only.

A result is known but for its error figure. A condition holds for sure where it holds for all that the figures allow,
and is missed for sure where it holds for none of it; what lies between is undecided: 90 mm ± 1 mm is neither greater
than 90 mm nor not.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from pint.util import UnitsContainer

from engine import (
    ExpressionError,
    ExpressionTree,
    TextExpression,
    TextOperation,
    any_quantity,
    dimension_of,
    evaluate_tree,
    joined_by_and,
    names_in_tree,
    parse_expression,
    unknown_name_message,
)

WORST = 1.0


class UnknownNameError(ExpressionError):
    """A condition with a name that may not be used in it."""


Values = Mapping[str, float | np.ndarray]


class Judgement(NamedTuple):
    """What is sure about a condition, for each of many variants: that it is met, that it is missed, or neither."""

    met: np.ndarray
    missed: np.ndarray

    @property
    def undecided(self) -> np.ndarray:
        """Where the error figures leave both open."""
        return ~(self.met | self.missed)


@dataclass(frozen=True, eq=False)
class Condition:
    """A condition, read once and judged as often as needed.

    Attributes
    ----------
    expression : TextExpression

    Raises
    ------
    ExpressionError
        The expression is a number.
    """

    expression: TextExpression

    def __post_init__(self) -> None:
        if not self.expression.is_condition:
            raise ExpressionError(f"{self.text!r} is a number; a condition such as 'a < b' is needed here")

    @classmethod
    def read(cls, text: str, dimensions: Mapping[str, UnitsContainer | None]) -> "Condition":
        """Read a condition over names of known dimensions, and check it.

        Parameters
        ----------
        text : str
        dimensions : mapping of str to UnitsContainer or None
            As for `check`.

        Raises
        ------
        ExpressionError
            It can't be read, is a number, has other names, or compares what differs in dimension.
        """
        condition = cls(parse_expression(text, any_quantity))
        condition.check(dimensions)
        return condition

    @property
    def text(self) -> str:
        """The condition as written, on one line."""
        return " ".join(self.expression.text.split())

    @property
    def names(self) -> tuple[str, ...]:
        """Names that it uses."""
        return self.expression.names

    def check(self, dimensions: Mapping[str, UnitsContainer | None]) -> None:
        """See that all names are known, and that like is compared with like.

        Parameters
        ----------
        dimensions : mapping of str to UnitsContainer or None
            Of every name that may be used; None where it isn't known: nothing is then said of the dimensions.

        Raises
        ------
        ExpressionError
        """
        for name in self.names:
            if name not in dimensions:
                raise UnknownNameError(unknown_name_message(name, dimensions))
        if all(dimensions[name] is not None for name in self.names):
            dimension_of(self.expression, dimensions)

    @property
    def is_equality(self) -> bool:
        """Whether it compares by == alone."""
        return self.expression.tree.name == "=="

    @cached_property
    def parts(self) -> tuple["Condition", ...]:
        """The conditions that `and` joins in this one, each by itself."""
        return tuple(Condition(parse_expression(part, any_quantity)) for part in joined_by_and(self.text))

    def met(self, values: Values, count: int) -> np.ndarray:
        """Which variants meet it, taking all values as exact.

        Parameters
        ----------
        values : mapping of str to float or ndarray (count,)
            A value (SI) of each of its names.
        count : int
            Number of variants.

        Returns
        -------
        ndarray (count,) of bool
        """
        return np.broadcast_to(self.expression.evaluate(values), (count,)).astype(bool)

    def judged(self, values: Values, errors: Values, count: int) -> Judgement:
        """For which variants it is met or missed for sure.

        Parameters
        ----------
        values : mapping of str to float or ndarray (count,)
            As for `met`.
        errors : mapping of str to float or ndarray (count,)
            Error figures of values; a name without one is exact, NaN is no figure, so that all is possible.
        count : int
            Number of variants.
        """
        with np.errstate(all="ignore"):
            sure, possible = _bounds(self.expression.tree, values, errors)
        return Judgement(*(np.broadcast_to(found, (count,)).copy() for found in (sure, np.logical_not(possible))))

    def margins(self, values: Values, errors: Values, count: int) -> np.ndarray:
        """By how much it is missed, for each part that `and` joins: above 0 where that isn't met for sure.

        The margin of a ≤ b is (a − b) / (|a| + |b|), and the error figure of a − b over the same: at least −1, at most
        1, whatever the units. Of parts joined by `or` the least counts. Where a number is undefined it is 1.

        Parameters
        ----------
        values, errors : mapping of str to float or ndarray (count,)
            As for `judged`.
        count : int
            Number of variants.

        Returns
        -------
        ndarray (parts, count)
            A part is met for sure where its margin is 0 or less, but for strict inequalities just on their limit.
        """
        with np.errstate(all="ignore"):
            found = [
                np.broadcast_to(_margin(part, values, errors, 1.0), (count,)) for part in _joined(self.expression.tree)
            ]
        return np.where(np.isnan(found), WORST, np.clip(found, -WORST, WORST))


def errors_in(columns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Error figures by the names of what they belong to: of each column NAME that has a column NAME_error beside it.

    Parameters
    ----------
    columns : mapping of str to ndarray
    """
    return {name: columns[f"{name}_error"] for name in columns if f"{name}_error" in columns}


def value_with_error(tree: ExpressionTree, values: Values, errors: Values) -> tuple[np.ndarray, np.ndarray]:
    """A number and its error figure: what the error figures of its names make of it, added up.

    Parameters
    ----------
    tree : float, QuotedQuantity, str or TextOperation
        The structure of an expression that yields a number.
    values, errors : mapping of str to float or ndarray
        As for `Condition.judged`.
    """
    value, error = evaluate_tree(tree, values), np.float64(0.0)
    for name in names_in_tree(tree):
        if name in errors:
            ends = (evaluate_tree(tree, {**values, name: values[name] + way * errors[name]}) for way in (1.0, -1.0))
            error = error + np.maximum(*(np.abs(end - value) for end in ends))
    # What is infinite has no figure to speak of; what has none may be anything.
    error = np.where(np.isfinite(value), np.where(np.isnan(error), np.inf, error), 0.0)
    return value, error


def _bounds(tree: TextOperation, values: Values, errors: Values) -> tuple[np.ndarray, np.ndarray]:
    """Where a condition holds for sure, and where it may hold."""
    if tree.name == "not":
        sure, possible = _bounds(tree.operands[0], values, errors)
        return np.logical_not(possible), np.logical_not(sure)
    if tree.name in ("and", "or"):
        join = np.logical_and if tree.name == "and" else np.logical_or
        ends = [_bounds(part, values, errors) for part in tree.operands]
        return join.reduce([sure for sure, _ in ends]), join.reduce([possible for _, possible in ends])
    if tree.name == "!=":
        sure, possible = _bounds(tree._replace(name="=="), values, errors)
        return np.logical_not(possible), np.logical_not(sure)
    apart, error = value_with_error(TextOperation("-", tree.operands, tree.column), values, errors)
    match tree.name:
        case "<":
            return apart + error < 0, apart - error < 0
        case "<=":
            return apart + error <= 0, apart - error <= 0
        case ">":
            return apart - error > 0, apart + error > 0
        case ">=":
            return apart - error >= 0, apart + error >= 0
        case _:
            return (apart == 0) & (error == 0), np.abs(apart) <= error


def _joined(tree: ExpressionTree) -> list[ExpressionTree]:
    """Parts of a condition that must all hold."""
    if isinstance(tree, TextOperation) and tree.name == "and":
        return [part for operand in tree.operands for part in _joined(operand)]
    return [tree]


def _margin(tree: TextOperation, values: Values, errors: Values, sign: float) -> np.ndarray:
    """Margin of a condition, or with sign −1 of its contrary."""
    if tree.name == "not":
        return _margin(tree.operands[0], values, errors, -sign)
    if tree.name in ("and", "or"):
        worst = (tree.name == "and") == (sign > 0)
        parts = [_margin(part, values, errors, sign) for part in tree.operands]
        return (np.maximum if worst else np.minimum).reduce(parts)
    difference, error = value_with_error(TextOperation("-", tree.operands, tree.column), values, errors)
    whole = sum(np.abs(evaluate_tree(operand, values)) for operand in tree.operands)
    apart, room = (_share(part, whole) for part in (difference, error))
    match tree.name:
        case "<" | "<=":
            return sign * apart + room
        case ">" | ">=":
            return -sign * apart + room
        case name:
            wanted = (name == "==") == (sign > 0)
            return np.abs(apart) + room if wanted else np.where(np.abs(apart) <= room, WORST, room - np.abs(apart))


def _share(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """A part over a whole that is zero only if the part is; an error figure beside nothing is all of it."""
    return np.where(whole != 0, part / np.where(whole != 0, whole, 1.0), np.where(part == 0, 0.0, WORST))
