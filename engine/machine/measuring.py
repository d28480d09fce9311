"""Measurement of a machine's requested quantities on the cycle of every variant.

Summaries are expressions with measurements as leaves. The measurements determine the curves required of the graph and
the plan of the cycle that measures them. The results are returned as numbers with error estimates.
"""

import dataclasses
import math
from collections import defaultdict
from collections.abc import Callable, Hashable, Sequence
from functools import cached_property, partial
from itertools import chain
from operator import attrgetter
from typing import NamedTuple

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.cycle import machine as cycle
from engine.cycle.measured import Measured
from engine.cycle.measures.extremes import BOTH, EACH_TURN, GREATEST, LEAST, LEAST_MAGNITUDE
from engine.cycle.panels.chebyshev import COARSE, DEGREE
from engine.cycle.plan import CycleSpeed, Difference, Kept, Measure, Plan, Recorded, Running, VectorAngle
from engine.graph.functions import Functions, functions_of
from engine.graph.nodes import Constant, Node, Stage, reached
from engine.graph.values import LevelValues
from engine.laws.rounding import EPS
from engine.machine.conditions import Margin, margins_against_jamming, margins_at_cams, taking_part, wound_springs
from engine.mechanism.assembly import Vanishing
from engine.mechanism.mechanics import Mechanics
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
    Speed,
    SteadyCycle,
    StrokeEnd,
    Unbalanced,
    UnloadedArc,
    VariantNumber,
    Work,
    evaluated,
    measurements,
    square_of,
)
from engine.quantities.flywheel_sizes import SteadyMeasurements, without_result
from engine.scene.scene import Numbers
from engine.words.verdicts import Verdict

# Truncation error allowed for each curve's series, relative to the curve's peak, if no accuracy is requested.
CLOSELY = 1e-9
# The transmission index is computed to FINER times the accuracy, limited to FINELY: near a dead centre all measurements
# depend on how small it is. Verdicts alone compare it with 1e-7, for which CLOSELY suffices.
FINER, FINELY = 1e3, 1e-12
# Truncation error allowed for margins against jamming if no accuracy is requested: three digits suffice.
LOOSELY = 1e-4
# Rounding error of accelerations and forces at a transmission angle of 90°, relative to their peak: a few roundings.
ROUNDING_OF_RATES = 8.0 * EPS
# An excess work below this share of its moment's maximum possible work is rounding.
NEGLIGIBLE = 1e-9
# Requested accuracy from which panels of a quarter turn are tried: they usually suffice.
COARSELY = 1e-4
# Requested accuracy from which a cycle with cuts has panels of lower degree: its pieces are short.
VERY_COARSELY = 1e-3
# Tolerance of curves for which panels are not refined.
ANY = 1e30

_SIDES = {"least": LEAST, "greatest": GREATEST}
# Reads a result from what the cycle returns.
Read = Callable[[cycle.CycleOutcome], Measured]


class Measuring:
    """Functions and plan for the measurements that some expressions require.

    Parameters
    ----------
    mechanics : Mechanics
    expressions : sequence of Expression
    fields : sequence of Node
        Kept fields, whose numbers are included in the layout.
    followed : sequence of Followed
        Kept fields that are integrated over the cycle.
    grid : tuple of int
        Number of intervals and number of positions of these fields.
    accuracy : float or None
        Permitted error of measurements, as in `Machine`.
    elsewhere : sequence of Node
        Nodes of the machine that are computed elsewhere: the groups they depend on take part.

    Attributes
    ----------
    functions : Functions
    groups : tuple of str
        Structural groups that take part, in the order of the scene.
    vanishing : list of Vanishing
        What vanishes where they are singular.
    curves : list of Node
        All nodes computed at a position.
    margins : list of Margin
        Margins against jamming of groups whose friction matters, and of cams that take part.
    windings : list of Integral
        Angles by which the cycle winds up torsion springs that matter.
    """

    def __init__(
        self,
        mechanics: Mechanics,
        expressions: Sequence[Expression],
        fields: Sequence[Node],
        followed: Sequence[Followed],
        grid: tuple[int, int],
        accuracy: float | None,
        elsewhere: Sequence[Node] = (),
    ) -> None:
        self.mechanics, self.expressions = mechanics, tuple(expressions)
        self._spaced, self._grid, self._accuracy = list(dict.fromkeys(followed)), grid, accuracy
        self._asked = measurements(expressions)
        of = self._of = defaultdict(list)
        for asked in self._asked:
            of[type(asked)].append(asked)
        asked = [a.curve for a in (*of[Extreme], *of[ExtremePosition], *of[Average])]
        self._followed = list(dict.fromkeys([*self._spaced, *(c for c in asked if not isinstance(c, Node))]))
        cycles = [*of[SteadyCycle], *(f.steady for f in self._followed if isinstance(f, Speed))]
        curves = [*(a.curve for a in (*of[Integral], *of[LeastMagnitude])), *(c for c in asked if isinstance(c, Node))]
        # The order decides in which order the compiler adds, and so the last bits.
        curves += [c for a in (*of[RootIntegral], *cycles, *of[Unbalanced], *of[UnloadedArc]) for c in a.curves]
        curves += [c for f in self._followed for c in f.curves]
        ends = [a for a in of[StrokeEnd] if a.coordinate.stage == Stage.POSITION]
        found = [mechanics.graph.found(a.coordinate, a.rate, a.which) for a in ends]
        parts = [*curves, *fields, *elsewhere, *(a.coordinate for a in of[StrokeEnd])]
        wound = wound_springs(mechanics, parts)
        self.windings = [Integral(rate) for rate in wound]
        of[Integral] += self.windings
        curves += wound
        self.margins = [
            *margins_against_jamming(mechanics, [*curves, *fields]),
            *margins_at_cams(mechanics, parts),
        ]
        self.groups = taking_part(mechanics, [*parts, *(margin.curve for margin in self.margins)])
        self.vanishing = [mechanics.kinematics.vanishing(group) for group in self.groups]
        sines = [v.curve for v in self.vanishing]
        # Pressing forces become infinite where a group jams first.
        jamming = [margin for margin in self.margins if margin.verdict == Verdict.JAMS]
        pressing = [mechanics.reactions.settlings[margin.group].pressing[0] for margin in jamming]
        curves = list(dict.fromkeys([*curves, *sines, *(m.curve for m in self.margins), *pressing]))
        of[LeastMagnitude] += map(LeastMagnitude, sines)
        for margin in self.margins:
            of[Extreme].append(Extreme(margin.curve, "least"))
            of[ExtremePosition].append(ExtremePosition(margin.curve, "least"))
        self._kinks = mechanics.graph.kinks_behind(curves)
        curves = list(dict.fromkeys([*curves, *self._kinks]))
        # At kinks margins jump, however short a panel is; near 0 the requested forces keep panels short enough.
        self._jumping = {margin.curve for margin in jamming if self._kinks}
        self._auxiliary = [*self._kinks, *pressing]
        self.curves = list(dict.fromkeys([*curves, *fields]))
        shared = dict.fromkeys(without_result(a) for a in cycles)
        self._steady = [
            SteadyMeasurements(s, {a.result for a in cycles if without_result(a) == s}, mechanics) for s in shared
        ]
        numbers = [number for steady in self._steady for number in steady.numbers]
        numbers += [a.number for a in of[VariantNumber]]
        numbers += [v.beyond for v in self.vanishing if v.beyond is not None]
        self._one = mechanics.graph.derived("one", lambda n: 1.0)
        numbers += [self._one] if of[Unbalanced] else []
        self.functions: Functions = functions_of(
            mechanics.graph,
            mechanics.first,
            mechanics.last,
            curves,
            found,
            [*fields, *numbers],
        )
        self._levels = LevelValues(self.functions)

    def _planned(self, speeds: bool) -> "_Planned":
        """The compiled functions with a plan of the cycle, with or without speed fluctuations."""
        plan = self._plan()
        readers = self._readers(plan, speeds)
        cycle.compile_driver_ahead(plan)
        functions = (PrintedFunction(self.functions.codes.get(name)) for name in ("curves", "events", "levels"))
        return _Planned(cycle.CycleMachine(plan, *functions), readers)

    def _plan(self) -> Plan:
        """Plan of the cycle, in which nothing is wanted yet."""
        f, of, accuracy = self.functions, self._of, self._accuracy
        curve = f.curves
        unresolved = {a.curve for a in of[Extreme] if not a.resolved}.union(self._auxiliary)
        unresolved = (unresolved - self._resolved()).union(self._jumping)
        # An extreme that lasts, as in a cam's dwell, has no definite position: its error estimate covers the dwell.
        closes = self.mechanics.has_cycle and not self.mechanics.scene.cams
        turns = getattr(self.mechanics.scene.input, "revolutions", 1)
        share = 0.0 if accuracy is None else accuracy
        # The direction of a force that nearly vanishes turns over within a panel; few positions don't show it.
        turning = of[UnloadedArc] or any(isinstance(c, Angle) for c in self._followed)
        coarsely = share >= VERY_COARSELY and (f.crossings or self._kinks) and not turning
        rooted = [
            *(a.square for a in of[RootIntegral]),
            *(a.curve for a in of[Extreme] if a.rooted and a.sense == "least"),
        ]
        return Plan(
            ends=self.ends,
            curves=len(curve),
            landmarks=f.landmarks,
            levels=f.found_levels,
            states=f.held_rows,
            crossings=f.crossings,
            looks=f.looks,
            kinks=[curve[c] for c in self._kinks],
            rooted=[curve[c] for c in dict.fromkeys(rooted)],
            turns=turns,
            longest=0.25 * math.tau if share >= COARSELY else Plan.longest,
            period=math.tau * self.mechanics.scene.input.revolutions if closes else math.inf,
            turn=math.tau if closes else math.inf,
            intervals=self._grid[0],
            positions=self._grid[1],
            degree=COARSE if coarsely else DEGREE,
            tolerance=[self._tolerance(c, accuracy, unresolved) for c in curve],
        )

    def _readers(self, plan: Plan, speeds: bool) -> dict[Hashable, Read]:
        """Want all measurements of a plan, with or without speed fluctuations, and say where to read the results."""
        row, curve, found = self.functions.rows, self.functions.curves, {}

        def measure(kind: Measure, wanted: Hashable, part: str) -> Read:
            number, get = plan.find(kind, wanted), attrgetter(part)
            return lambda outcome: get(outcome)[number]

        def extreme(wanted: Recorded | Difference, sides: int, part: str) -> Read:
            number, get = plan.find_extremes(wanted, sides), attrgetter(part)
            return lambda outcome: get(outcome.extremes.of(number))

        for c in self._followed if speeds else [c for c in self._followed if not isinstance(c, Speed)]:
            # An angle that repeats with each turn of the crank has its extremes in every turn.
            every = isinstance(c, Angle) and self.mechanics.graph.q not in reached(c.direction)
            found[c] = extreme(self._recorded(c), BOTH + EACH_TURN if every else BOTH, "greatest_magnitude")
        for c in self._spaced:
            if c in found:
                found["spaced", c] = measure("spaced", self._recorded(c), "spaced")
        for a in chain(*self._of.values()):
            match a:
                case Extreme(Speed()) | ExtremePosition(Speed()) | Average(Speed()) if not speeds:
                    continue
                case Integral(c):
                    found[a] = measure("integrals", curve[c], "integrals")
                case RootIntegral(square):
                    found[a] = measure("roots", curve[square], "roots")
                case Extreme(c, sense):
                    found[a] = extreme(self._recorded(c), _SIDES[sense], sense)
                case ExtremePosition(c, sense):
                    found[a] = extreme(self._recorded(c), _SIDES[sense], f"{sense}_at")
                case LeastMagnitude(c):
                    least = extreme(self._recorded(c), LEAST_MAGNITUDE, "least")
                    found[a] = partial(_least_magnitude, least, curve[c])
                    found["place", a] = extreme(self._recorded(c), LEAST_MAGNITUDE, "least_at")
                case Average(c, power):
                    found[a] = measure("averages", self._recorded(c), "averages" if power == 1 else "squares")
                case Unbalanced(c, rate):
                    change = Difference(Running((curve[rate],), about_mean=False), curve[c], row[self._one])
                    found[a] = extreme(change, BOTH, "greatest_magnitude")
                case UnloadedArc(force, square, which):
                    arc = tuple(curve[c] for c in (*force, square))
                    # Whether the middle exists depends on the arc.
                    found[UnloadedArc(force, square, "arc")] = measure("arcs", arc, "arcs")
                    if which == "middle":
                        found[a] = measure("arcs", arc, "arc_middles")
        for steady in self._steady:
            work = Work(steady.of.moment)
            if steady.asks_works:
                found["range", work] = extreme(self._recorded(work), BOTH, "range")
            for slope, (sides, part) in steady.slopes.items():
                difference = Difference(self._recorded(work), curve[steady.of.inertia], row[slope])
                found[steady.of, slope] = extreme(difference, sides, part)
            if steady.wheel is not None and speeds:
                found[steady.of] = measure("fluctuations", self._recorded(Speed(steady.of)), "fluctuations")
        return found

    def _recorded(self, of: Node | Followed) -> Recorded:
        """A curve, for a plan."""
        row, curve = self.functions.rows, self.functions.curves
        match of:
            case Node():
                return Kept((curve[of],))
            case Angle(direction):
                return VectorAngle(tuple(curve[c] for c in direction))
            case Work(moment):
                return Running((curve[moment],), about_mean=True)
            case Speed(steady):
                wheel = self._cycle_of(steady).wheel
                return CycleSpeed((curve[steady.moment], curve[steady.inertia]), row[steady.speed], row[wheel])

    def _resolved(self) -> set[Node]:
        """Curves for which panels are refined."""
        asked = (a for a in chain(*self._of.values()) if getattr(a, "resolved", True))
        return {c for a in (*asked, *self._followed) for c in a.curves}

    def _cycle_of(self, asked: SteadyCycle) -> SteadyMeasurements:
        """The steady cycle to which a result belongs."""
        return next(s for s in self._steady if s.of == without_result(asked))

    def _tolerance(self, curve: Node, accuracy: float | None, unresolved: set[Node]) -> float:
        """Truncation error allowed for a curve's series."""
        if curve in unresolved:
            return ANY
        if accuracy is None and any(m.curve is curve and m.verdict == Verdict.JAMS for m in self.margins):
            return LOOSELY
        asked = CLOSELY if accuracy is None else 1e-2 * accuracy
        finest = FINELY if self._asked or self._followed else CLOSELY
        return min(asked, max(finest, asked / FINER)) if Vanishing(curve) in self.vanishing else asked

    @cached_property
    def _whole(self) -> "_Planned":
        return self._planned(speeds=True)

    @cached_property
    def _first_pass(self) -> "_Planned":
        """Without speed fluctuations, if these require flywheels that are computed from the cycle."""
        given = any(steady.wheel is not None and steady.unknown_wheel is None for steady in self._steady)
        return self._whole if given else self._planned(speeds=False)

    @property
    def ends(self) -> tuple[int, int]:
        """Rows of P with the ends of the input's range."""
        return self.functions.rows[self.mechanics.first], self.functions.rows[self.mechanics.last]

    @property
    def all_groups(self) -> tuple[str, ...]:
        """All structural groups of the scene."""
        return tuple(self.mechanics.kinematics.sines)

    @property
    def machine(self) -> cycle.CycleMachine:
        """The compiled functions with the plan of all measurements."""
        return self._whole.machine

    def numbers(self, numbers: Numbers, variants: int) -> np.ndarray:
        """P of all variants, (numbers, variants), without what is found on the cycle and what follows from it."""
        return self._levels.table(numbers, variants)

    def fill_found(self, table: np.ndarray, landmarks: cycle.Extremes) -> None:
        """Copy the numbers found on the cycle into the table of the variants, and fill what follows from them.

        Parameters
        ----------
        table : ndarray (numbers, variants)
            Modified in place.
        landmarks : Extremes
            Extremes of the switching functions.
        """
        self._levels.fill_found(table, lambda which: landmarks.at_end(which).value)

    def __call__(self, table: np.ndarray) -> "MeasuredCycles":
        """Measure all variants.

        Parameters
        ----------
        table : ndarray (numbers, variants)
            From `numbers`.
        """
        answers = MeasuredCycles(self, table, self._first_pass)
        unknown = [steady for steady in self._steady if steady.unknown_wheel is not None]
        again = False
        for steady in unknown:
            with np.errstate(all="ignore"):
                found = answers.value_of(dataclasses.replace(steady.of, result="flywheel_used"))
            table[self.functions.rows[steady.unknown_wheel]] = found.value
            # With the required flywheel the fluctuation is known, unless the machine needs no flywheel.
            again |= steady.speed_asked or not (found.value > 0.0).all()
        return MeasuredCycles(self, table, self._whole) if again else answers


class _Planned(NamedTuple):
    """A machine's functions with a plan of its cycle, and a reader of each measurement's result.

    Further keys are the curves integrated over the cycle, for their peaks; with "spaced" for their values, and with
    "range"; minimum magnitudes with "place"; and steady cycles, for δ, or with one of their slopes, for an extreme of
    work − slope × inertia.
    """

    machine: cycle.CycleMachine
    readers: dict[Hashable, Read]


def _least_magnitude(least: Read, curve: int, outcome: cycle.CycleOutcome) -> Measured:
    """Minimum magnitude of a curve that keeps the sign of its first value."""
    found, sense = least(outcome), np.where(outcome.firsts[curve] < 0.0, -1.0, 1.0)
    value = found.value * sense
    return Measured(np.where(value < 0.0, 0.0, value), found.error)


def defined_where(arc: Measured, middle: Measured) -> Measured:
    """Middle of an arc; undefined if the arc does not exceed its error."""
    exists = arc.value > arc.error
    return Measured(np.where(exists, middle.value, np.nan), np.where(exists, middle.error, np.nan))


class MeasuredCycles:
    """Measurements on the cycles of some variants.

    Parameters
    ----------
    measuring : Measuring
    table : ndarray (numbers, variants)
    planned : _Planned

    Attributes
    ----------
    outcome : engine.cycle.machine.CycleOutcome
    """

    def __init__(self, measuring: Measuring, table: np.ndarray, planned: _Planned) -> None:
        self._m, self._table, self._readers = measuring, table, planned.readers
        self.outcome = planned.machine.evaluate(table, measuring.functions.memory)
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
        """For each group, the minimum of its transmission index, or of its arm over its scale, and the place."""
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
            loops = len(free[group].closure.slides) if group in free else 1
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
                return self._m._cycle_of(asked).result(asked, self)
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
