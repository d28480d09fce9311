"""Per-variant numbers as expressions: measurements on a variant's cycle, and arithmetic with them.

A summary is declared as an expression, `mean(moment) * speed`. Its leaves are the measurements it requires. Its value
and its error estimate are computed together, as measured numbers propagate their errors through arithmetic.
"""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import reduce
from typing import ClassVar, Literal

import numpy as np

from engine.cycle import measured as numbers
from engine.cycle.measured import Measured
from engine.graph.nodes import Node, Operation
from engine.laws.rounding import EPS
from engine.mechanism.vectors import Vector

Compute = Callable[..., Measured]


class Expression:
    """A per-variant number with its error estimate."""

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


class OverCycle:
    """A result of curves over a variant's cycle."""

    @property
    def curves(self) -> tuple[Node, ...]:
        """The curves."""
        return tuple(_curves_in(tuple(vars(self).values())))


def _curves_in(part: object) -> Iterator[Node]:
    match part:
        case Node():
            yield part
        case OverCycle():
            yield from part.curves
        case tuple():
            for inner in part:
                yield from _curves_in(inner)


class Measurement(Expression, OverCycle):
    """A measurement on a variant's cycle, or a number known before it; equal ones are measured once."""


@dataclass(frozen=True)
class Exactly(Measurement):
    """The same number for all variants."""

    value: float


@dataclass(frozen=True)
class VariantNumber(Measurement):
    """A per-variant number, known before the cycle is computed."""

    number: Node
    curves: ClassVar[tuple[Node, ...]] = ()


@dataclass(frozen=True)
class Integral(Measurement):
    """Integral of a curve over the range of the input."""

    curve: Node


@dataclass(frozen=True)
class RootIntegral(Measurement):
    """Integral of the square root of a curve over the range of the input."""

    square: Node


class Followed(OverCycle):
    """A curve integrated over the whole cycle: its value at a position depends on earlier positions."""


@dataclass(frozen=True)
class Angle(Followed):
    """Angle of a vector, continuous over the range; `vanishes`: the vector may come near zero, as a force does."""

    direction: Vector
    vanishes: bool = False


@dataclass(frozen=True)
class Work(Followed):
    """Work of a moment minus its mean, from the first position on."""

    moment: Node


@dataclass(frozen=True)
class Speed(Followed):
    """Magnitude of the input speed over the steady cycle described by a `SteadyCycle`."""

    steady: "SteadyCycle"


@dataclass(frozen=True)
class Extreme(Measurement):
    """Minimum or maximum of a curve over the range of the input.

    Attributes
    ----------
    curve : Node or Followed
    sense : {"least", "greatest"}
        Minimum or maximum.
    resolved : bool
        Whether panels are refined until they resolve the curve. A curve of pure rounding errors never becomes smooth.
    rooted : bool
        Whether the result is the root of the extreme value.
    """

    curve: Node | Followed
    sense: Literal["least", "greatest"]
    resolved: bool = True
    rooted: bool = False


@dataclass(frozen=True)
class ExtremePosition(Measurement):
    """Position of the input at the minimum or maximum of a curve."""

    curve: Node | Followed
    sense: Literal["least", "greatest"]


@dataclass(frozen=True)
class LeastMagnitude(Measurement):
    """Minimum magnitude of a curve that never changes sign; 0 for one that does."""

    curve: Node


@dataclass(frozen=True)
class Average(Measurement):
    """Mean of a followed curve, or of its square (power 2)."""

    curve: Followed
    power: Literal[1, 2]


@dataclass(frozen=True)
class Unbalanced(Measurement):
    """Maximum magnitude of the difference between the change of a curve and the integral of its derivative."""

    curve: Node
    rate: Node


@dataclass(frozen=True)
class UnloadedArc(Measurement):
    """Widest arc of directions in which a force never points, or its middle; see `engine.cycle.measures.unloaded_arcs`.

    Attributes
    ----------
    force : Vector
        In the axes of a link.
    square : Node
        Square of the force's magnitude.
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
    # It is located by the scan of the cycle.
    curves: ClassVar[tuple[Node, ...]] = ()


@dataclass(frozen=True)
class SteadyCycle(Measurement):
    """A result of the steady cycle under a constant drive torque; see `engine.cycle.measures.fluctuation`.

    Attributes
    ----------
    inertia, moment : Node
        Reduced moment of inertia, and reduced moment of all loads except the drive.
    speed : Node
        Mean speed of the input.
    fluctuation, first_kind, wheel : Node or None
        Required coefficient of speed fluctuation, constant part of the inertia, inertia of a given flywheel.
    result : str
        Name of the result.
    """

    inertia: Node
    moment: Node
    speed: Node
    fluctuation: Node | None
    first_kind: Node
    wheel: Node | None
    result: str

    @property
    def curves(self) -> tuple[Node, ...]:
        """Moment and inertia; all others are numbers."""
        return self.moment, self.inertia


def _expression(value: Expression | float) -> Expression:
    return value if isinstance(value, Expression) else Exactly(float(value))


def length_of_range(first: Node, last: Node) -> Expression:
    """Length of the input's range."""
    return VariantNumber(last - first)


def least(curve: Node | Followed) -> Expression:
    """Minimum of a curve."""
    return _extreme(curve, "least")


def _extreme(curve: Node | Followed, sense: Literal["least", "greatest"]) -> Expression:
    square = square_of(curve)
    return Extreme(curve, sense) if square is None else sqrt(Extreme(square, sense, rooted=True))


def square_of(curve: Node | Followed) -> Node | None:
    """Operand of a curve that is a square root, else None: the operand is smooth where the root nearly has a kink."""
    return curve.operands[0] if isinstance(curve, Operation) and curve.symbol == "sqrt" else None


def of_root(curve: Node | Followed, found: Expression) -> Expression:
    """Statistic of a curve, with the error of a root if the curve is one."""
    return found if square_of(curve) is None else Formula(numbers.of_squares, (found,))


def greatest(curve: Node | Followed) -> Expression:
    """Maximum of a curve."""
    return _extreme(curve, "greatest")


def place_of(curve: Node | Followed, sense: Literal["least", "greatest"]) -> Expression:
    """Position of the input at the minimum or maximum of a curve."""
    return ExtremePosition(square_of(curve) or curve, sense)


def peak(curve: Node | Followed) -> Expression:
    """Maximum magnitude of a curve."""
    return greatest(curve) if square_of(curve) is not None else maximum(abs(least(curve)), abs(greatest(curve)))


def unresolved_peak(curve: Node) -> Expression:
    """Maximum magnitude of a curve of pure rounding errors, or of its reference, without refinement of panels."""
    return maximum(*(abs(Extreme(curve, sense, resolved=False)) for sense in ("least", "greatest")))


def sqrt(x: Expression) -> Expression:
    """Square root of a number."""
    return Formula(numbers.sqrt, (x,))


def maximum(*of: Expression) -> Expression:
    """Maximum of some numbers."""
    return reduce(lambda found, other: Formula(numbers.maximum, (found, other)), of)


def minimum(*of: Expression) -> Expression:
    """Minimum of some numbers."""
    return reduce(lambda found, other: Formula(numbers.minimum, (found, other)), of)


def hypot(x: Expression, y: Expression) -> Expression:
    """Magnitude of a vector."""
    return Formula(_hypot, (x, y))


def _hypot(x: Measured, y: Measured) -> Measured:
    size = np.hypot(x.value, y.value)
    return Measured(size, np.hypot(x.error, y.error) + 2.0 * EPS * size)


def share(part: Expression, whole: Expression) -> Expression:
    """Residual relative to a reference, without error estimate; 0 if the residual is 0."""
    return Formula(_share, (part, whole))


def _share(part: Measured, whole: Measured) -> Measured:
    with np.errstate(all="ignore"):
        ratio = np.where(part.value == 0.0, 0.0 * whole.value, part.value / whole.value)
    return Measured(ratio, np.zeros_like(ratio))


def measurements(expressions: Iterable[Expression]) -> list[Measurement]:
    """Measurements required by some expressions, without repetition."""
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
    """All nodes in an expression or a followed curve.

    Parameters
    ----------
    asked : Expression, Followed, Node or tuple of such
    """
    if isinstance(asked, Node):
        yield asked
    elif isinstance(asked, Formula):
        yield from nodes_of(tuple(measurements([asked])))
    elif isinstance(asked, OverCycle):
        yield from nodes_of(tuple(vars(asked).values()))
    elif isinstance(asked, tuple):
        for part in asked:
            yield from nodes_of(part)


def evaluated(
    expression: Expression, measured: Callable[[Measurement], Measured], known: dict[Measurement | int, Measured]
) -> Measured:
    """Value and error estimate of an expression.

    Parameters
    ----------
    expression : Expression
    measured : callable
        Returns the measured number of a measurement.
    known : dict
        Numbers of measurements, and of other expressions by identity, so these must outlive it; it is extended.
    """
    if isinstance(expression, Exactly):
        return Measured(expression.value)
    measures = isinstance(expression, Measurement)
    key = expression if measures else id(expression)
    if key not in known:
        operands = () if measures else [evaluated(operand, measured, known) for operand in expression.operands]
        known[key] = measured(expression) if measures else expression.does(*operands)
    return known[key]
