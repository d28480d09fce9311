"""Conditions on parameters and results, such as "wheel_mass < '900 kg'".

Results are known within their error estimates, all numbers within rounding. Two sides that agree within their estimates
count as equal: `>=`, `<=` and `==` accept them, `>`, `<` and `!=` don't. So a condition and its negation are never both
met or both missed. If other values within the estimates would change the outcome, the variant is reported as undecided.
"""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, cached_property
from typing import NamedTuple

import numpy as np

import engine

WORST = 1.0
# Relative rounding of a number read, converted or derived, and of a comparison.
ROUNDING = 4 * float(np.finfo(float).eps)
# Sides whose estimates are below this share of their terms count as exactly equal.
NEGLIGIBLE = 1e-9
# Operations whose magnitude follows from those of their operands.
_WITH_TERMS = ("+", "-", "*", "/", "abs", "max", "min")


class UnknownNameError(engine.ExpressionError):
    """A condition with an unknown name."""


Values = Mapping[str, float | np.ndarray]
# A condition, or several that must all hold.
Where = str | Sequence[str] | None


def all_of(where: Where) -> str:
    """Conditions that must all hold, as one text; "" for none."""
    texts = [where] if isinstance(where, str) else [*(where or ())]
    if len(texts) < 2:
        return "".join(texts)
    return " and ".join(f"({text})" if re.search(r"\bor\b", text) else text for text in texts)


def numeric_expression(text: str) -> engine.TextExpression:
    """Parse an expression of a number.

    Raises
    ------
    ExpressionError
        Not an expression, or a condition.
    """
    expression = engine.parse_expression(text, engine.any_quantity)
    if expression.is_condition:
        raise engine.ExpressionError(f"{text!r} is a condition; a number is needed here")
    return expression


class Judgement(NamedTuple):
    """Whether each variant meets a condition, and whether other values within the estimates would change that."""

    met: np.ndarray
    undecided: np.ndarray


@dataclass(frozen=True, eq=False)
class Condition:
    """A parsed condition.

    Attributes
    ----------
    expression : TextExpression

    Raises
    ------
    ExpressionError
        The expression is numeric.
    """

    expression: engine.TextExpression

    def __post_init__(self) -> None:
        if not self.expression.is_condition:
            raise engine.ExpressionError(f"{self.text!r} compares nothing; a condition such as 'a < b' is needed here")

    @classmethod
    def parse(cls, text: str) -> "Condition":
        """Parse a condition, without a check of its names and dimensions.

        Raises
        ------
        ExpressionError
            Invalid, or numeric.
        """
        return cls(engine.parse_expression(text, engine.any_quantity))

    @classmethod
    def read(cls, text: str, dimensions: Mapping[str, engine.Powers | None]) -> "Condition":
        """Read a condition over names of known dimensions, and check it.

        Parameters
        ----------
        text : str
        dimensions : mapping of str to Powers or None
            As for `check`.

        Raises
        ------
        ExpressionError
            Invalid, numeric, unknown names, or different dimensions.
        """
        condition = cls.parse(text)
        condition.check(dimensions)
        return condition

    @property
    def text(self) -> str:
        """The condition as written, on one line."""
        return " ".join(self.expression.text.split())

    @property
    def names(self) -> tuple[str, ...]:
        """Names used."""
        return self.expression.names

    def check(self, dimensions: Mapping[str, engine.Powers | None]) -> None:
        """Check names and dimensions.

        Parameters
        ----------
        dimensions : mapping of str to Powers or None
            Dimension of every allowed name; None skips the check of dimensions.

        Raises
        ------
        ExpressionError
        """
        for name in self.names:
            if name not in dimensions:
                raise UnknownNameError(engine.unknown_name_message(name, dimensions))
        if all(dimensions[name] is not None for name in self.names):
            engine.dimension_of(self.expression, dimensions)
        angles = {name for name in self.names if dimensions[name] == engine.dimension_of_unit("rad")}
        for sides in _compared(self.expression.tree):
            # In formulas a bare number is in radians; here it would be taken for degrees, as angles are shown.
            bare = next((side for side in sides if isinstance(side, float) and side), None)
            if bare is not None and not angles.isdisjoint(filter(lambda side: isinstance(side, str), sides)):
                hint = f"{bare:g} has no unit: write '{bare:g} deg' or '{bare:g} rad'"
                raise engine.ExpressionError(f"{self.text!r} compares an angle with a plain number; {hint}")

    @property
    def is_equality(self) -> bool:
        """Whether it only compares by ==."""
        return self.expression.tree.name == "=="

    @cached_property
    def parts(self) -> tuple["Condition", ...]:
        """The conditions joined by `and`, separately."""
        return tuple(Condition.parse(part) for part in engine.joined_by_and(self.text))

    def judged(self, values: Values, errors: Values, count: int) -> Judgement:
        """Which variants meet it.

        Parameters
        ----------
        values : mapping of str to float or ndarray (count,)
            A value (SI) of each of its names.
        errors : mapping of str to float or ndarray (count,)
            Error estimates; a name without one is exact within rounding, NaN means unknown, so that nothing is met.
        count : int
            Number of variants.
        """
        tree, compared, joins = self.expression.tree, _compare(values, errors), (np.logical_and, np.logical_or)
        with np.errstate(all="ignore"):
            met = _folded(tree, compared, True, _Comparison.is_accepted, joins)
            decided = [_folded(tree, compared, wanted, _Comparison.is_sure, joins) for wanted in (True, False)]
        undecided = np.logical_not(np.logical_or(*decided))
        return Judgement(*(np.broadcast_to(found, (count,)).copy() for found in (met, undecided)))

    def sides(self, values: Values, errors: Values) -> tuple[str, float, float] | None:
        """Sign, left and right side of a comparison for one variant; None for conditions joined by `or` or `not`.

        Parameters
        ----------
        values, errors : mapping of str to float or ndarray (1,)
            As for `judged`.
        """
        tree = self.expression.tree
        if tree.name in ("and", "or", "not"):
            return None
        left, right = (float(np.ravel(value_with_error(side, values, errors)[0])[0]) for side in tree.operands)
        return tree.name, left, right

    def margins(self, values: Values, errors: Values, count: int) -> np.ndarray:
        """Margin of each part joined by `and`: positive where missed.

        The margin of a ≤ b is (a − b) / (|a| + |b|), less the error estimate of a − b over the same sum, from −1 to 1
        in any unit; a side of several terms counts by the sum of their magnitudes, so that |a − c| ≤ b has a slope
        where b is small. Parts joined by `or` count by their minimum. Undefined numbers give 1.

        Parameters
        ----------
        values, errors : mapping of str to float or ndarray (count,)
            As for `judged`.
        count : int
            Number of variants.

        Returns
        -------
        ndarray (parts, count)
            A part is met if its margin is 0 or less, except strict inequalities on their limit.
        """
        compared, joins = _compare(values, errors), (np.maximum, np.minimum)
        with np.errstate(all="ignore"):
            trees = [part.expression.tree for part in self.parts]
            each = [_folded(tree, compared, True, _Comparison.margin, joins) for tree in trees]
        found = [np.broadcast_to(margin, (count,)) for margin in each]
        return np.where(np.isnan(found), WORST, np.clip(found, -WORST, WORST))


def parts_of(where: Where) -> tuple[Condition, ...]:
    """The conditions of a text joined by `and`, separately; none of no text."""
    return Condition.parse(all_of(where)).parts if where else ()


def met_by(conditions: Iterable[Condition], values: Values, errors: Values, count: int) -> np.ndarray:
    """Which of `count` variants meet all of some conditions."""
    return np.all([np.ones(count, bool), *(one.judged(values, errors, count).met for one in conditions)], axis=0)


def errors_in(columns: Mapping[str, np.ndarray]) -> dict[str, np.ndarray]:
    """Error estimates by name: for each column NAME with a column NAME_error.

    Parameters
    ----------
    columns : mapping of str to ndarray
    """
    return {name: columns[f"{name}_error"] for name in columns if f"{name}_error" in columns}


def value_with_error(tree: engine.ExpressionTree, values: Values, errors: Values) -> tuple[np.ndarray, np.ndarray]:
    """A number and its error estimate, propagated from its names and rounding.

    Parameters
    ----------
    tree : float, QuotedQuantity, str or TextOperation
        Tree of a numeric expression.
    values, errors : mapping of str to float or ndarray
        As for `Condition.judged`.
    """
    (value, shifted), error = _shifted(tree, values, errors), np.float64(0.0)
    for ends in shifted.values():
        # One end may be outside the domain.
        error = error + np.fmax(*(np.abs(end - value) for end in ends))
    # Infinite values need no estimate; unknown estimates are infinite.
    error = np.where(np.isfinite(value), np.where(np.isnan(error), np.inf, error), 0.0)
    return value, error


class _Shifted(NamedTuple):
    """A value, and its values at both ends of the error of each name in it."""

    value: np.ndarray
    ends: dict[str, tuple[np.ndarray, np.ndarray]]


def _shifted(tree: engine.ExpressionTree, values: Values, errors: Values) -> _Shifted:
    if isinstance(tree, engine.TextOperation):
        parts = [_shifted(operand, values, errors) for operand in tree.operands]
        ends = {}
        for name in dict.fromkeys(name for part in parts for name in part.ends):
            both = zip(*(part.ends.get(name, (part.value, part.value)) for part in parts), strict=True)
            ends[name] = tuple(engine.apply_operation(tree.name, operands) for operands in both)
        return _Shifted(engine.apply_operation(tree.name, [part.value for part in parts]), ends)
    value = engine.evaluate_tree(tree, values)
    if not isinstance(tree, str):
        return _Shifted(value, {})
    off = np.maximum(errors.get(tree, 0.0), ROUNDING * np.abs(value))
    return _Shifted(value, {tree: (value + off, value - off)})


def _magnitude(tree: engine.ExpressionTree, values: Values) -> np.ndarray:
    """Sum of the magnitudes of the terms of a number."""
    if isinstance(tree, engine.TextOperation) and tree.name in _WITH_TERMS:
        terms = [_magnitude(operand, values) for operand in tree.operands]
        return sum(terms) if tree.name in ("+", "-") else engine.apply_operation(tree.name, terms)
    return np.abs(engine.evaluate_tree(tree, values))


def _compared(tree: engine.TextOperation) -> Iterator[tuple[engine.ExpressionTree, ...]]:
    """Both sides of each comparison of a condition."""
    if tree.name in ("and", "or", "not"):
        for part in tree.operands:
            yield from _compared(part)
    else:
        yield tree.operands


class _Comparison(NamedTuple):
    """A comparison of left − right with zero, by "<", "<=" or "=="; `negated` for "!=".

    Attributes
    ----------
    sign : str
    negated : bool
    apart, error : ndarray
        The difference and its error estimate; infinite if unknown.
    whole : ndarray
        Sum of the magnitudes of all terms.
    rounding : ndarray
        Error of the difference from rounding only.
    """

    sign: str
    negated: bool
    apart: np.ndarray
    error: np.ndarray
    whole: np.ndarray
    rounding: np.ndarray

    def is_accepted(self, wanted: bool) -> np.ndarray:
        """Where it is accepted, or its negation."""
        return self._holds(wanted, self._accepting)

    def is_sure(self, wanted: bool) -> np.ndarray:
        """Where it holds for all values within the estimates, or its negation.

        Both sides are equal where they agree within their estimates, to nine digits of their terms.
        """
        # A small difference of large numbers is limited by their rounding.
        size = np.maximum(self.whole, self.rounding / ROUNDING)
        equal = (np.abs(self.apart) <= self.error) & (self.error <= NEGLIGIBLE * size)
        return self._holds(wanted, np.where(equal, self._accepting, self.error if wanted else -self.error))

    def margin(self, wanted: bool) -> np.ndarray:
        """Its margin, or that of its negation."""
        apart, room = (_share(part, self.whole) for part in (self.apart, self.error))
        if self.sign == "==":
            margin = np.abs(apart) - room if wanted else np.where(np.abs(apart) <= room, WORST, -np.abs(apart))
        else:
            margin = (apart if wanted else -apart) + (room if (self.sign == "<") == wanted else -room)
        return np.where(np.isinf(self.error), WORST, margin)

    @property
    def _accepting(self) -> np.ndarray:
        """The required margin: negative for comparisons that allow equality."""
        return self.error if self.sign == "<" else -self.error

    def _holds(self, wanted: bool, error: np.ndarray) -> np.ndarray:
        """Whether it holds by a margin of `error`, or its negation; neither without an estimate."""
        apart = np.abs(self.apart) if self.sign == "==" else self.apart
        met = apart + error < 0 if self.sign == "<" else apart + error <= 0
        return (met == wanted) & np.isfinite(self.error)


def _compare(values: Values, errors: Values) -> Callable[[engine.TextOperation], _Comparison]:
    """Function that evaluates comparisons, each once."""

    @cache
    def compared(tree: engine.TextOperation) -> _Comparison:
        difference = engine.TextOperation("-", tree.operands, tree.column)
        apart, error = value_with_error(difference, values, errors)
        _, rounding = value_with_error(difference, values, {}) if errors else (apart, error)
        whole = _magnitude(difference, values)
        error = np.where(np.isfinite(apart), error + ROUNDING * whole, 0.0)
        if tree.name in (">", ">="):
            apart = -apart
        sign = {">": "<", ">=": "<=", "!=": "=="}.get(tree.name, tree.name)
        return _Comparison(sign, tree.name == "!=", apart, error, whole, rounding)

    return compared


def _folded(
    tree: engine.TextOperation,
    compared: Callable[[engine.TextOperation], _Comparison],
    wanted: bool,
    of: Callable[[_Comparison, bool], np.ndarray],
    joins: tuple[np.ufunc, np.ufunc],
) -> np.ndarray:
    """A judgement of a condition, or of its negation: of its comparisons, joined for "and" and for "or"."""
    if tree.name == "not":
        return _folded(tree.operands[0], compared, not wanted, of, joins)
    if tree.name in ("and", "or"):
        # Parts with only fixed numbers are scalars.
        parts = np.broadcast_arrays(*(_folded(part, compared, wanted, of, joins) for part in tree.operands))
        return joins[(tree.name == "and") != wanted].reduce(parts)
    found = compared(tree)
    return of(found, wanted != found.negated)


def _share(part: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """A ratio with 0/0 = 0; an error relative to zero is 1."""
    return np.where(whole != 0, part / np.where(whole != 0, whole, 1.0), np.where(part == 0, 0.0, WORST))
