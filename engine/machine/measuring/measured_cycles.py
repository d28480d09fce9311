"""Measurements on the cycles of variants, as numbers with error estimates."""

from collections.abc import Callable, Hashable
from functools import cached_property
from typing import NamedTuple

import numpy as np

from engine.cycle import cycle_machine as cycle
from engine.cycle.measured import Measured
from engine.graph.nodes import Constant, Node, Stage
from engine.laws.rounding import EPS
from engine.machine.measuring.conditions import Margin
from engine.machine.measuring.required_curves import RequiredCurves
from engine.quantities.expressions import (
    Angle,
    Average,
    Expression,
    Extreme,
    ExtremePosition,
    Followed,
    Integral,
    LeastMagnitude,
    Measurement,
    RootIntegral,
    SteadyCycle,
    StrokeEnd,
    UnloadedArc,
    VariantNumber,
    evaluated,
    square_of,
)

# Rounding error of accelerations and forces at a transmission angle of 90°, relative to their peak: a few roundings.
ROUNDING_OF_RATES = 8.0 * EPS
# An excess work below this share of its moment's maximum possible work is rounding.
NEGLIGIBLE = 1e-9

# Reads a result from what the cycle returns.
Read = Callable[[cycle.CycleOutcome], Measured]


class Planned(NamedTuple):
    """A machine's functions with a plan of its cycle, and a reader of each measurement's result.

    Keys are the measurements, and: a curve integrated over the cycle, for its peak; ("spaced", curve) for its values;
    ("range", curve); ("place", minimum magnitude); a steady cycle, for δ; and (steady cycle, slope), for an extreme of
    work − slope × inertia.
    """

    machine: cycle.CycleMachine
    readers: dict[Hashable, Read]


def defined_where(arc: Measured, middle: Measured) -> Measured:
    """Middle of an arc; undefined if the arc does not exceed its error."""
    exists = arc.value > arc.error
    return Measured(np.where(exists, middle.value, np.nan), np.where(exists, middle.error, np.nan))


class MeasuredCycles:
    """Measurements on the cycles of some variants.

    Parameters
    ----------
    required : RequiredCurves
    table : ndarray (numbers, variants)
    planned : Planned

    Attributes
    ----------
    outcome : engine.cycle.cycle_machine.CycleOutcome
    """

    def __init__(self, required: RequiredCurves, table: np.ndarray, planned: Planned) -> None:
        self._m, self._table, self._readers = required, table, planned.readers
        self.outcome = planned.machine.evaluate(table, required.functions.memory)
        self._numbers: dict[Node, Measured] = {}
        self._known: dict[Measurement | int, Measured] = {}

    def value_of(self, expression: Expression) -> Measured:
        """Value of an expression, with its error estimate."""
        return evaluated(expression, self._with_spread, self._known)

    def number(self, node: Node) -> Measured:
        """A per-variant number, exact within rounding."""
        if isinstance(node, Constant):
            return Measured(node.value)
        if node not in self._numbers:
            value = self._table[self._m.functions.rows[node]]
            self._numbers[node] = Measured(value, EPS * np.abs(value))
        return self._numbers[node]

    def sines(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """For each group, the minimum of its transmission index, or of its arm over its scale, and its position."""
        found = []
        for curve, beyond in self._m.vanishing:
            least, place = self.read(LeastMagnitude(curve)), self.read(("place", LeastMagnitude(curve)))
            scale = 1.0 if beyond is None else self.peak(curve) + abs(self.number(beyond).value)
            found.append(((least.value - least.error) / scale, place.value))
        return found

    def least_of(self, margin: Margin) -> tuple[np.ndarray, np.ndarray]:
        """Minimum of a margin and the position there."""
        return tuple(self.read(kind(margin.curve, "least")).value for kind in (Extreme, ExtremePosition))

    def read(self, key: Hashable) -> Measured:
        """A result of the plan, by the key of its reader."""
        return self._readers[key](self.outcome)

    def knows(self, key: Hashable) -> bool:
        """Whether the plan has such a result."""
        return key in self._readers

    def first(self, curve: Node) -> Measured:
        """Value of a curve at the first position."""
        return Measured(self.outcome.firsts[self._m.functions.curves[curve]])

    @cached_property
    def _transmission(self) -> np.ndarray:
        """Divisor of relative errors near dead centres: once for positions, twice for accelerations.

        The rounding error of the sine of a transmission angle, of the transmission index or of an arm is relative to
        its value; a group propagates the errors of the groups before it. Loops that are solved together propagate
        theirs mutually.
        """
        product, free = np.ones(self._table.shape[1]), self._m.mechanics.kinematics.free
        for group, (sine, _) in zip(self._m.groups, self.sines(), strict=True):
            loops = len(free[group].closure.units) if group in free else 1
            product *= np.where((sine > 0.0) & (sine < 1.0), sine, 1.0) / loops
        return product

    @cached_property
    def rounding_of_velocities(self) -> np.ndarray:
        """Rounding error of velocities, relative to their maximum."""
        return ROUNDING_OF_RATES / self._transmission

    @cached_property
    def rounding_of_rates(self) -> np.ndarray:
        """Rounding error of accelerations and forces, relative to their maximum."""
        return ROUNDING_OF_RATES / self._transmission**2

    def _with_spread(self, asked: Measurement) -> Measured:
        """A measurement, with its error estimate increased by the rounding near dead centres."""
        found = self._measured(asked)
        if isinstance(asked, VariantNumber):
            return found
        turning = isinstance(asked, Extreme) and isinstance(asked.curve, Angle)
        relative = self.rounding_of_velocities if turning else self.rounding_of_rates
        spread = relative * self._size(asked, found.value)
        return Measured(found.value, found.error + spread * (found.error != 0.0))

    def allowed(self, expression: Expression, accuracy: float) -> np.ndarray:
        """Error of an expression if each of its curves is off by a share of the curve's peak."""

        def off(asked: Measurement) -> Measured:
            found = self._measured(asked)
            exact = isinstance(asked, VariantNumber)
            return found if exact else Measured(found.value, accuracy * self._size(asked, found.value))

        return evaluated(expression, off, {}).error

    def peak(self, curve: Node | Followed) -> np.ndarray:
        """Maximum magnitude of a measured curve; NaN if neither the curve nor its square is measured."""
        if not isinstance(curve, Node):
            return self.read(curve).value
        square = square_of(curve)
        for known, root in ((curve, False), (square, True), (curve * curve, True)):
            if known in self._m.functions.curves:
                size = self.outcome.sizes[self._m.functions.curves[known]]
                return np.sqrt(size) if root else size
        return np.full(self._table.shape[1], np.nan)

    def _size(self, asked: Measurement, value: np.ndarray) -> np.ndarray:
        """Magnitude to which the relative error of a measurement refers: the curve's, where terms may cancel."""
        length = np.abs(self.outcome.lengths)
        match asked:
            case Integral(curve):
                return self.peak(curve) * length
            case RootIntegral(square):
                return np.sqrt(self.peak(square)) * length
            case Extreme(Node() as curve, _, _, rooted):
                # If a magnitude has the same error everywhere, the error of its square decreases with the magnitude.
                return 2.0 * np.sqrt(np.abs(value) * self.peak(curve)) if rooted else self.peak(curve)
            case Extreme(curve):
                return self.peak(curve)
            case Average(curve, power):
                return self.peak(curve) ** power
            case StrokeEnd(coordinate, _, which) if not which.endswith("_at"):
                ends = (self._stroke_end(coordinate, end).value for end in ("low", "high"))
                return np.maximum(*(np.abs(end) for end in ends))
            case SteadyCycle(moment=moment, result="excess_work"):
                whole = self.peak(moment) * length
                return np.where(np.abs(value) <= NEGLIGIBLE * whole, whole, np.abs(value))
        return np.abs(value)

    def _measured(self, asked: Measurement) -> Measured:
        match asked:
            case VariantNumber(number):
                return self.number(number)
            case StrokeEnd(coordinate, _, which):
                return self._stroke_end(coordinate, which)
            case SteadyCycle():
                return self._m.cycle_of(asked).result(asked, self)
            case UnloadedArc(force, square, "middle"):
                return defined_where(self.read(UnloadedArc(force, square, "arc")), self.read(asked))
        return self.read(asked)

    def spaced(self, curve: Followed) -> np.ndarray:
        """Values of a kept field that is integrated over the cycle, (variants, positions)."""
        return self.read(("spaced", curve))

    def _stroke_end(self, coordinate: Node, which: str) -> Measured:
        if coordinate.stage < Stage.POSITION:
            first = self.number(self._m.mechanics.first)
            return first if which.endswith("_at") else self.number(coordinate)
        event = next(i for i, (node, _) in enumerate(self._m.functions.events) if node is coordinate)
        return self.outcome.landmarks.at_end(which)[event]
