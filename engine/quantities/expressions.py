"""Numbers of a variant as expressions: what is measured on its cycle, and arithmetic on that.

A summary is declared as an expression, `mean(moment) * speed`. What it needs follows from it: the measurements at its
leaves. Its value and its error figure follow together, as measured numbers carry theirs through arithmetic.
"""

import math
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from engine.cycle import measured as numbers
from engine.cycle.measured import Measured
from engine.graph.nodes import Node, Operation
from engine.mechanism.vectors import Vector

Compute = Callable[..., Measured]


class Expression:
    """A number of each variant, with its error figure."""

    def __add__(self, other: "Expression | float") -> "Expression":
        return Formula(lambda a, b: a + b, (self, _expression(other)))

    def __radd__(self, other: float) -> "Expression":
        return _expression(other) + self

    def __sub__(self, other: "Expression | float") -> "Expression":
        return Formula(lambda a, b: a - b, (self, _expression(other)))

    def __rsub__(self, other: float) -> "Expression":
        return _expression(other) - self

    def __mul__(self, other: "Expression | float") -> "Expression":
        return Formula(lambda a, b: a * b, (self, _expression(other)))

    __rmul__ = __mul__

    def __truediv__(self, other: "Expression | float") -> "Expression":
        return Formula(lambda a, b: a / b, (self, _expression(other)))

    def __rtruediv__(self, other: float) -> "Expression":
        return _expression(other) / self

    def __neg__(self) -> "Expression":
        return Formula(lambda a: -a, (self,))

    def __abs__(self) -> "Expression":
        return Formula(abs, (self,))


@dataclass(frozen=True, eq=False)
class Formula(Expression):
    """A function of measured numbers applied to expressions."""

    does: Compute
    operands: tuple[Expression, ...]


class Measurement(Expression):
    """What is measured on a variant's cycle, or known of it beforehand; equal ones are measured once."""


@dataclass(frozen=True)
class Exactly(Measurement):
    """The same number for all variants."""

    value: float


@dataclass(frozen=True)
class VariantNumber(Measurement):
    """A number of the variant, known before its cycle."""

    number: Node


@dataclass(frozen=True)
class Integral(Measurement):
    """Integral of a curve over the range of the input."""

    curve: Node


@dataclass(frozen=True)
class RootIntegral(Measurement):
    """Integral of the root of a curve over the range of the input."""

    square: Node


@dataclass(frozen=True)
class Angle:
    """A direction as an angle, continuous over the range."""

    direction: Vector


@dataclass(frozen=True)
class Work:
    """Work of a moment about its mean since the first position."""

    moment: Node


@dataclass(frozen=True)
class Speed:
    """Speed of the input, by magnitude, over the steady cycle that a `SteadyCycle` describes."""

    steady: "SteadyCycle"


# Curves that are followed over the whole cycle, as their values at a position depend on those before it.
Followed = Angle | Work | Speed


@dataclass(frozen=True)
class Extreme(Measurement):
    """Minimum or maximum of a curve over the range of the input.

    Attributes
    ----------
    curve : Node or Followed
    sense : {"least", "greatest"}
    resolved : bool
        Whether panels are made as short as the curve needs. A curve that is rounding alone never becomes smooth.
    rooted : bool
        Whether the root of the value is asked.
    """

    curve: Node | Followed
    sense: Literal["least", "greatest"]
    resolved: bool = True
    rooted: bool = False


@dataclass(frozen=True)
class ExtremePosition(Measurement):
    """Position of the input where a curve has its least or greatest value."""

    curve: Node | Followed
    sense: Literal["least", "greatest"]


@dataclass(frozen=True)
class LeastMagnitude(Measurement):
    """Least magnitude of a curve that never changes its sign, and 0 where it does."""

    curve: Node


@dataclass(frozen=True)
class Average(Measurement):
    """Mean of a curve that is followed, or of its square (power 2)."""

    curve: Followed
    power: Literal[1, 2]


@dataclass(frozen=True)
class Unbalanced(Measurement):
    """Greatest difference between the change of a curve and the integral of its derivative, by magnitude."""

    curve: Node
    rate: Node


@dataclass(frozen=True)
class UnloadedArc(Measurement):
    """Widest arc that a force never points to, or its middle: see `engine.cycle.measures.unloaded_arcs`.

    Attributes
    ----------
    force : Vector
        In the axes of a link.
    square : Node
        Of its magnitude.
    which : {"arc", "middle"}
    """

    force: Vector
    square: Node
    which: Literal["arc", "middle"]


@dataclass(frozen=True)
class StrokeEnd(Measurement):
    """End of the stroke of a coordinate, or the position of the input there (dead centre)."""

    coordinate: Node
    rate: Node
    which: Literal["low", "high", "low_at", "high_at"]


@dataclass(frozen=True)
class SteadyCycle(Measurement):
    """A result of the steady cycle under the constant moment that closes it: see `engine.cycle.measures.fluctuation`.

    Attributes
    ----------
    inertia, moment : Node
        Reduced moment of inertia, and reduced moment of all but the driver.
    speed : Node
        Mean speed of the input.
    fluctuation, first_kind, wheel : Node or None
        Coefficient of speed fluctuation asked for, constant part of the inertia, inertia of a given flywheel.
    result : str
        Which of its results.
    """

    inertia: Node
    moment: Node
    speed: Node
    fluctuation: Node | None
    first_kind: Node
    wheel: Node | None
    result: str


def _expression(value: Expression | float) -> Expression:
    return value if isinstance(value, Expression) else Exactly(float(value))


def length_of_range(first: Node, last: Node) -> Expression:
    """Length of the input's range."""
    return VariantNumber(last - first)


def least(curve: Node | Followed) -> Expression:
    """Least value of a curve."""
    return _extreme(curve, "least")


def _extreme(curve: Node | Followed, sense: Literal["least", "greatest"]) -> Expression:
    square = square_of(curve)
    return Extreme(curve, sense) if square is None else sqrt(Extreme(square, sense, rooted=True))


def square_of(curve: Node | Followed) -> Node | None:
    """What a curve is the root of, if it is one: that is smooth where the root nearly has a kink."""
    return curve.operands[0] if isinstance(curve, Operation) and curve.symbol == "sqrt" else None


def of_root(curve: Node | Followed, found: Expression) -> Expression:
    """A statistic of a curve, which may be the root of squares."""
    return found if square_of(curve) is None else Formula(numbers.of_squares, (found,))


def greatest(curve: Node | Followed) -> Expression:
    """Greatest value of a curve."""
    return _extreme(curve, "greatest")


def place_of(curve: Node | Followed, sense: Literal["least", "greatest"]) -> Expression:
    """Position of the input where a curve has its least or greatest value."""
    return ExtremePosition(square_of(curve) or curve, sense)


def peak(curve: Node | Followed) -> Expression:
    """Greatest magnitude of a curve."""
    return greatest(curve) if square_of(curve) is not None else maximum(abs(least(curve)), abs(greatest(curve)))


def unresolved_peak(curve: Node) -> Expression:
    """Greatest magnitude of a curve that is rounding alone where all is well, or of what that is compared with."""
    return maximum(*(abs(Extreme(curve, sense, resolved=False)) for sense in ("least", "greatest")))


def sqrt(x: Expression) -> Expression:
    """Root of a number."""
    return Formula(numbers.sqrt, (x,))


def maximum(*of: Expression) -> Expression:
    """The greatest of some numbers."""
    found = of[0]
    for other in of[1:]:
        found = Formula(numbers.maximum, (found, other))
    return found


def minimum(*of: Expression) -> Expression:
    """The least of some numbers."""
    found = of[0]
    for other in of[1:]:
        found = Formula(numbers.minimum, (found, other))
    return found


def hypot(x: Expression, y: Expression) -> Expression:
    """Magnitude of a vector."""
    return Formula(_hypot, (x, y))


def _hypot(x: Measured, y: Measured) -> Measured:
    size = np.hypot(x.value, y.value)
    return Measured(size, np.hypot(x.error, y.error) + 2.0 * np.finfo(float).eps * size)


def share(part: Expression, whole: Expression) -> Expression:
    """What is left of a check as a share of a whole, without an error figure; 0 where there is nothing of either."""
    return Formula(_share, (part, whole))


def _share(part: Measured, whole: Measured) -> Measured:
    with np.errstate(all="ignore"):
        ratio = np.where(part.value == 0.0, 0.0 * whole.value, part.value / whole.value)
    return Measured(ratio, np.zeros_like(ratio))


def measurements(expressions: Iterable[Expression]) -> list[Measurement]:
    """What some expressions need, each once."""
    found: dict[Measurement, None] = {}
    pending, seen = list(expressions), set()
    while pending:
        expression = pending.pop()
        if isinstance(expression, Measurement):
            found[expression] = None
        elif id(expression) not in seen:
            seen.add(id(expression))
            pending.extend(expression.operands)
    return list(found)


def nodes_of(asked: object) -> Iterator[Node]:
    """All nodes that an expression, or a followed curve, is made of.

    Parameters
    ----------
    asked : Expression, Followed, Node or tuple of such
    """
    if isinstance(asked, Node):
        yield asked
    elif isinstance(asked, Formula):
        yield from nodes_of(tuple(measurements([asked])))
    elif isinstance(asked, (Measurement, Followed)):
        yield from nodes_of(tuple(vars(asked).values()))
    elif isinstance(asked, tuple):
        for part in asked:
            yield from nodes_of(part)


class Evaluation:
    """Values of expressions from what was measured.

    Parameters
    ----------
    measured : callable
        What was measured, for a measurement.
    """

    def __init__(self, measured: Callable[[Measurement], Measured]) -> None:
        self._measured = measured
        self._known: dict[int, Measured] = {}

    def __call__(self, expression: Expression) -> Measured:
        """Value and error figure of an expression."""
        if isinstance(expression, Exactly):
            return Measured(expression.value)
        if isinstance(expression, Measurement):
            return self._measured(expression)
        if id(expression) not in self._known:
            self._known[id(expression)] = expression.does(*(self(o) for o in expression.operands))
        return self._known[id(expression)]


FULL_TURN = 2.0 * math.pi
