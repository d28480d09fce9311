"""Measurement of a machine's requested quantities on the cycle of every variant.

Summaries are expressions with measurements as leaves. The measurements determine the curves required of the graph and
the plan of the cycle that measures them. The results are returned as numbers with error estimates.
"""

import dataclasses
import math
from collections.abc import Hashable, Sequence
from functools import cached_property, partial
from itertools import chain
from operator import attrgetter

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.cycle import cycle_machine as cycle
from engine.cycle.measured import Measured
from engine.cycle.measures.extremes import BOTH, EACH_TURN, GREATEST, LEAST, LEAST_MAGNITUDE
from engine.cycle.panels.chebyshev import COARSE, DEGREE
from engine.cycle.plan import CycleSpeed, Difference, Kept, Measure, Plan, Recorded, Running, VectorAngle
from engine.graph.nodes import Node, reached
from engine.graph.values import LevelValues
from engine.machine.measuring.measured_cycles import MeasuredCycles, Planned, Read
from engine.machine.measuring.required_curves import RequiredCurves
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
    RootIntegral,
    Speed,
    Unbalanced,
    UnloadedArc,
    Work,
)
from engine.scene.scene import Numbers
from engine.words.verdicts import Verdict

# Truncation error allowed for each curve's series, relative to the curve's peak, if no accuracy is requested.
CLOSELY = 1e-9
# The same as a fraction of a requested accuracy: what is computed from the curves may have a larger error than they.
OF_ACCURACY = 0.03
# The transmission index is computed to FINER times the accuracy, limited to FINELY: near a dead centre all measurements
# depend on how small it is. If only verdicts compare it with 1e-7, CLOSELY suffices.
FINER, FINELY = 1e3, 1e-12
# Truncation error allowed for margins against jamming if no accuracy is requested: three digits suffice.
LOOSELY = 1e-4
# Requested accuracy from which panels of a quarter turn are tried: they usually suffice.
COARSELY = 1e-4
# Requested accuracy from which a cycle with cuts has panels of lower degree: its pieces are short.
VERY_COARSELY = 1e-3
# Tolerance of curves for which panels are not refined.
ANY = 1e30

_SIDES = {"least": LEAST, "greatest": GREATEST}


class Measuring(RequiredCurves):
    """Functions and plan of the cycle for the measurements that some expressions require.

    Parameters
    ----------
    mechanics, expressions, fields, followed, elsewhere
        As for `RequiredCurves`.
    grid : tuple of int
        Number of intervals and number of positions of these fields.
    accuracy : float or None
        Permitted error of measurements, as in `Machine`.
    """

    def __init__(
        self,
        mechanics: Mechanics,
        expressions: Sequence[Expression],
        fields: Sequence[Node],
        followed: Sequence[Followed],
        grid: tuple[int, int],
        accuracy: float | None,
        elsewhere: Sequence[Node],
    ) -> None:
        super().__init__(mechanics, expressions, fields, followed, elsewhere)
        self._grid, self._accuracy = grid, accuracy
        self._levels = LevelValues(self.functions)

    def _planned(self, speeds: bool) -> Planned:
        """The compiled functions with a plan of the cycle, with or without speed fluctuations."""
        plan = self._plan()
        readers = self._readers(plan, speeds)
        cycle.compile_driver_ahead(plan)
        functions = (PrintedFunction(self.functions.codes.get(name)) for name in ("curves", "events", "levels"))
        return Planned(cycle.CycleMachine(plan, *functions), readers)

    def _plan(self) -> Plan:
        """Plan of the cycle, without any requested results yet."""
        f, of, accuracy = self.functions, self._of, self._accuracy
        curve = f.curves
        unresolved = {a.curve for a in of[Extreme] if not a.resolved}.union(self._auxiliary)
        unresolved = (unresolved - self._resolved()).union(self._jumping)
        # An extreme that lasts, as in a cam's dwell, has no definite position: its error estimate covers the dwell.
        closes = self.mechanics.has_cycle and not self.mechanics.scene.cams
        turns = getattr(self.mechanics.scene.input, "revolutions", 1)
        share = 0.0 if accuracy is None else accuracy
        # The direction of a force that nearly vanishes turns over within a panel; few positions don't show it.
        turning = of[UnloadedArc] or any(isinstance(c, Angle) and c.vanishes for c in self._followed)
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
        """Add all measurements to a plan, with or without speed fluctuations; return a reader of each result."""
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
                wheel = self.cycle_of(steady).wheel
                return CycleSpeed((curve[steady.moment], curve[steady.inertia]), row[steady.speed], row[wheel])

    def _resolved(self) -> set[Node]:
        """Curves for which panels are refined."""
        asked = (a for a in chain(*self._of.values()) if getattr(a, "resolved", True))
        return {c for a in (*asked, *self._followed) for c in a.curves}

    def _tolerance(self, curve: Node, accuracy: float | None, unresolved: set[Node]) -> float:
        """Truncation error allowed for a curve's series."""
        if curve in unresolved:
            return ANY
        if accuracy is None and any(m.curve is curve and m.verdict == Verdict.JAMS for m in self.margins):
            return LOOSELY
        asked = CLOSELY if accuracy is None else OF_ACCURACY * accuracy
        finest = FINELY if self._asked or self._followed else CLOSELY
        return min(asked, max(finest, asked / FINER)) if Vanishing(curve) in self.vanishing else asked

    @cached_property
    def _whole(self) -> Planned:
        return self._planned(speeds=True)

    @cached_property
    def _first_pass(self) -> Planned:
        """Plan without speed fluctuations, if these require flywheels that are computed from the cycle."""
        given = any(steady.wheel is not None and steady.unknown_wheel is None for steady in self._steady)
        return self._whole if given else self._planned(speeds=False)

    @property
    def machine(self) -> cycle.CycleMachine:
        """The compiled functions with the plan of all measurements."""
        return self._whole.machine

    def numbers(self, numbers: Numbers, variants: int) -> np.ndarray:
        """P of all variants, (numbers, variants), without numbers found on the cycle and those that depend on them."""
        return self._levels.table(numbers, variants)

    def fill_found(self, table: np.ndarray, landmarks: cycle.Extremes) -> None:
        """Copy the numbers found on the cycle into the table of the variants, and compute those that depend on them.

        Parameters
        ----------
        table : ndarray (numbers, variants)
            Modified in place.
        landmarks : Extremes
            Extremes of the switching functions.
        """
        self._levels.fill_found(table, lambda which: landmarks.at_end(which).value)

    def __call__(self, table: np.ndarray) -> MeasuredCycles:
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


def _least_magnitude(least: Read, curve: int, outcome: cycle.CycleOutcome) -> Measured:
    """Minimum magnitude of a curve that keeps the sign of its first value."""
    found, sense = least(outcome), np.where(outcome.firsts[curve] < 0.0, -1.0, 1.0)
    value = found.value * sense
    return Measured(np.where(value < 0.0, 0.0, value), found.error)
