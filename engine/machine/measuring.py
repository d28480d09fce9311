"""What is asked of a machine, measured on the cycle of every variant.

Summaries are expressions whose leaves are measurements. From these follow the curves that are asked of the graph, and
the plan of the cycle that measures them; its answers are put back in their places, as numbers with error figures.
"""

from collections.abc import Iterable, Sequence

import numpy as np

from engine.compiling.printed import load_printed
from engine.cycle import machine as cycle
from engine.cycle.measured import Measured, maximum, where
from engine.graph.functions import Functions, functions_of
from engine.graph.nodes import Constant, Node, Stage, reached
from engine.mechanism.mechanics import Mechanics
from engine.quantities.expressions import (
    AtFirst,
    Evaluation,
    Expression,
    Extreme,
    Integral,
    Measurement,
    Place,
    RunningExtreme,
    SteadyCycle,
    StrokeEnd,
    VariantNumber,
    measurements,
)
from engine.scene.scene import Numbers

# What may be left of the quality of force transmission: near a dead centre all else depends on how small it is.
FINELY = 1e-12
# Tolerance of curves that panels needn't be made shorter for.
ANY = 1e30


class Measuring:
    """Functions and plan for the measurements that some expressions need.

    Parameters
    ----------
    mechanics : Mechanics
    expressions : sequence of Expression
    fields : sequence of Node
        Kept fields, whose numbers are to be laid out too.
    accuracy : float
        What of each curve may be left beyond its series, as a share of its greatest magnitude.

    Attributes
    ----------
    functions : Functions
    groups : tuple of str
        Structural groups that take part, in the order of the scene.
    curves : list of Node
        All that is computed at a position.
    margins : dict of str to Node
        Margin against jamming of each group on whose friction something depends.
    """

    def __init__(
        self, mechanics: Mechanics, expressions: Sequence[Expression], fields: Sequence[Node], accuracy: float
    ) -> None:
        self.mechanics, self.expressions = mechanics, tuple(expressions)
        self._asked = measurements(expressions)
        of = {kind: [a for a in self._asked if isinstance(a, kind)] for kind in _KINDS}
        curves = [a.curve for kind in (Integral, Extreme, Place, AtFirst) for a in of[kind]]
        curves += [a.rate for a in of[RunningExtreme]]
        curves += [node for a in of[SteadyCycle] for node in (a.moment, a.inertia)]
        ends = [a for a in of[StrokeEnd] if a.coordinate.stage == Stage.POSITION]
        found = [mechanics.graph.found(a.coordinate, a.rate, a.which) for a in ends]
        self.groups = self._taking_part([*curves, *fields, *(a.coordinate for a in of[StrokeEnd])])
        self._sines = [mechanics.kinematics.sines[group] for group in self.groups]
        self.margins = self._margins([*curves, *fields])
        curves = list(dict.fromkeys([*curves, *self._sines, *self.margins.values()]))
        self.curves = list(dict.fromkeys([*curves, *fields]))
        self._steady = [_Steady(a, mechanics) for a in dict.fromkeys(_shared(a) for a in of[SteadyCycle])]
        numbers = [number for steady in self._steady for number in steady.numbers]
        numbers += [a.number for a in of[VariantNumber]]
        self.functions: Functions = functions_of(
            mechanics.graph,
            f"The functions of one machine: {mechanics.scene.title or 'untitled'}.",
            mechanics.first,
            mechanics.last,
            curves,
            found,
            [*fields, *numbers],
        )
        self._plan(of, accuracy)

    def _taking_part(self, nodes: Iterable[Node]) -> tuple[str, ...]:
        """Groups on whose position some nodes depend."""
        behind = set(reached(nodes))
        kinematics = self.mechanics.kinematics
        return tuple(g for g in kinematics.sines if behind.intersection(kinematics.solution(g)))

    def _margins(self, nodes: Iterable[Node]) -> dict[str, Node]:
        """Margins against jamming of the groups on whose friction some nodes depend."""
        if not self.mechanics.scene.friction:
            return {}
        behind = set(reached(nodes))
        settlings = self.mechanics.reactions.settlings
        return {g: s.margin for g, s in settlings.items() if behind.intersection((s.margin, *s.margin.operands))}

    def _plan(self, of: dict[type, list], accuracy: float) -> None:
        f = self.functions
        row, curve = f.rows, f.curves
        sines = set(self._sines)
        self._integrals = list(dict.fromkeys(a.curve for a in of[Integral]))
        self._extremes = list(
            dict.fromkeys([*(a.curve for a in (*of[Extreme], *of[Place])), *self._sines, *self.margins.values()])
        )
        self._values = list(dict.fromkeys(a.curve for a in of[AtFirst]))
        self._works = list(dict.fromkeys([*(a.rate for a in of[RunningExtreme]), *(s.of.moment for s in self._steady)]))
        needed = [c for kind in (Integral, Place, AtFirst) for c in (a.curve for a in of[kind])]
        needed += [a.curve for a in of[Extreme] if a.resolved] + self._works + [s.of.inertia for s in self._steady]
        needed += [*self._sines, *self.margins.values()]
        residuals = {a.curve for a in of[Extreme] if not a.resolved}.difference(needed)
        self._combinations = [c for steady in self._steady for c in steady.combinations]
        self._fluctuations = [s.fluctuation for s in self._steady if s.fluctuation is not None]
        self.plan = cycle.Plan(
            ends=(row[self.mechanics.first], row[self.mechanics.last]),
            curves=len(curve),
            landmarks=[tuple(mark[1:]) for mark in f.landmarks],
            levels=f.level_rows,
            states=f.held_rows,
            crossings=f.crossings,
            integrals=[curve[c] for c in self._integrals],
            extremes=[curve[c] for c in self._extremes],
            works=[curve[c] for c in self._works],
            combinations=[(curve[m], curve[i], row[c]) for m, i, c in self._combinations],
            fluctuations=[(curve[m], curve[i], row[w], row[j]) for m, i, w, j in self._fluctuations],
            values=[(curve[c], row[self.mechanics.first]) for c in self._values],
            tolerance=[ANY if c in residuals else min(accuracy, FINELY) if c in sines else accuracy for c in curve],
        )
        self._machine: cycle.Machine | None = None

    @property
    def machine(self) -> cycle.Machine:
        """The compiled functions with their plan."""
        if self._machine is None:
            module = load_printed(self.functions.text)
            self._machine = cycle.Machine(self.plan, module.curves, module.events, module.levels, module.states)
        return self._machine

    def numbers(self, numbers: Numbers, variants: int) -> np.ndarray:
        """P of all variants, (numbers, variants); what is found on the cycle is still missing."""
        table = np.full((len(self.functions.rows), variants), np.nan)
        # An overflow on the way to a number ends as a status, not as a warning.
        with np.errstate(all="ignore"):
            for node in self.functions.numbers:
                table[self.functions.rows[node]] = node.value if isinstance(node, Constant) else node.compute(numbers)
        return table

    def __call__(self, table: np.ndarray) -> "Answers":
        """Measure all variants.

        Parameters
        ----------
        table : ndarray (numbers, variants)
            From `numbers`.
        """
        return Answers(self, table, self.machine.evaluate(table, self.functions.memory))


_KINDS = (Integral, Extreme, Place, AtFirst, RunningExtreme, SteadyCycle, StrokeEnd, VariantNumber)


def _shared(steady: SteadyCycle) -> SteadyCycle:
    """The steady cycle without the result that is asked of it."""
    return SteadyCycle(
        steady.inertia, steady.moment, steady.speed, steady.fluctuation, steady.first_kind, steady.wheel, ""
    )


class _Steady:
    """What a steady cycle asks of the plan: works, their combinations with the inertia, the speed fluctuation."""

    def __init__(self, of: SteadyCycle, mechanics: Mechanics) -> None:
        self.of = of
        half_square = 0.5 * mechanics.speed_squared
        self.slopes: tuple[Node, ...] = ()
        if of.fluctuation is not None:
            slow, fast = 1.0 - 0.5 * of.fluctuation, 1.0 + 0.5 * of.fluctuation
            self.slopes = (half_square * slow * slow, half_square, half_square * fast * fast)
        asked = of.wheel is not None or of.fluctuation is not None
        nothing = mechanics.graph.derived("no flywheel", lambda n: 0.0, "load")
        self.fluctuation = (of.moment, of.inertia, of.speed, of.wheel or nothing) if asked else None
        self.combinations = [(of.moment, of.inertia, slope) for slope in self.slopes]
        self.numbers = [*self.slopes, of.speed, of.wheel or nothing, of.first_kind]
        self.numbers += [of.fluctuation] if of.fluctuation is not None else []


class Answers:
    """What was measured on the cycles of some variants.

    Parameters
    ----------
    measuring : Measuring
    table : ndarray (numbers, variants)
    outcome : engine.cycle.machine.Outcome

    Attributes
    ----------
    outcome : as given
    """

    def __init__(self, measuring: Measuring, table: np.ndarray, outcome: cycle.Outcome) -> None:
        self._m, self._table, self.outcome = measuring, table, outcome
        self.value_of = Evaluation(self._measured)

    def number(self, node: Node) -> Measured:
        """A number of the variants; exact but for its rounding."""
        if isinstance(node, Constant):
            return Measured(node.value)
        value = self._table[self._m.functions.rows[node]]
        return Measured(value, np.finfo(float).eps * np.abs(value))

    def sines(self) -> list[tuple[np.ndarray, np.ndarray]]:
        """Of each group the least magnitude of its quality of transmission and the position there."""
        found = []
        for sine in self._m._sines:
            k = self._m._extremes.index(sine)
            extremes = self.outcome.extremes
            low, high = extremes.least[k], extremes.greatest[k]
            # The quality never changes its sign.
            positive = high.value >= -low.value
            least = np.where(positive, low.value - low.error, -high.value - high.error)
            place = np.where(positive, extremes.least_at[k].value, extremes.greatest_at[k].value)
            found.append((least, place))
        return found

    def least_margins(self) -> dict[str, tuple[np.ndarray, np.ndarray]]:
        """Of each group with friction the least margin against jamming and the position there."""
        least, places = self.outcome.extremes.least, self.outcome.extremes.least_at
        rows = {group: self._m._extremes.index(margin) for group, margin in self._m.margins.items()}
        return {group: (least[k].value, places[k].value) for group, k in rows.items()}

    def _measured(self, asked: Measurement) -> Measured:
        m, outcome = self._m, self.outcome
        match asked:
            case VariantNumber(number):
                return self.number(number)
            case Integral(curve):
                return outcome.integrals[m._integrals.index(curve)]
            case Extreme(curve, sense):
                return getattr(outcome.extremes, sense)[m._extremes.index(curve)]
            case Place(curve, sense):
                return getattr(outcome.extremes, f"{sense}_at")[m._extremes.index(curve)]
            case AtFirst(curve):
                return outcome.values[m._values.index(curve)]
            case RunningExtreme(rate, which):
                return getattr(outcome.works, which)[m._works.index(rate)]
            case StrokeEnd(coordinate, _, which):
                return self._stroke_end(coordinate, which)
            case SteadyCycle():
                return self._steady(asked)
        raise TypeError(f"{asked!r} can't be measured")

    def _stroke_end(self, coordinate: Node, which: str) -> Measured:
        if coordinate.stage < Stage.POSITION:
            first = self.number(self._m.mechanics.first)
            return first if which.endswith("_at") else self.number(coordinate)
        event = next(i for i, (node, _) in enumerate(self._m.functions.events) if node is coordinate)
        part = {"low": "least", "high": "greatest", "low_at": "least_at", "high_at": "greatest_at"}[which]
        return getattr(self.outcome.landmarks, part)[event]

    def _steady(self, asked: SteadyCycle) -> Measured:
        steady = next(s for s in self._m._steady if s.of == _shared(asked))
        speed, speed_squared = self.number(asked.speed), self.number(asked.speed) * self.number(asked.speed)
        works = self.outcome.works.range[self._m._works.index(asked.moment)]
        if asked.result == "excess_work":
            return works
        if asked.fluctuation is not None:
            delta = self.number(asked.fluctuation)
            energy = delta * speed_squared
            first = self.outcome.firsts[self._m.functions.curves[asked.inertia]]
            slow, middle, fast = (
                self._m._combinations.index((asked.moment, asked.inertia, slope)) for slope in steady.slopes
            )
            extremes = self.outcome.combinations
            exact = (extremes.greatest[fast] - extremes.least[slow]) / energy - Measured(first)
            sizes = {
                "flywheel_excess_work": lambda: works / energy,
                "flywheel_merzalov": lambda: extremes.range[middle] / energy - self.number(asked.first_kind),
                "flywheel_wittenbauer": lambda: exact,
            }
            if asked.result in sizes:
                return sizes[asked.result]()
        wheel = self.number(asked.wheel) if asked.wheel is not None else maximum(exact, Measured(np.zeros(exact.shape)))
        if asked.result == "flywheel_used":
            return wheel
        found = self.outcome.fluctuations.delta[self._m._fluctuations.index(steady.fluctuation)]
        if asked.wheel is None:
            # With the flywheel that is asked for the fluctuation is the one asked for; it falls as the inertia grows.
            whole = Measured(first) + wheel
            kept = Measured(delta.value * np.ones(wheel.shape), delta.value * wheel.error / whole.value)
            found = where(wheel.value > 0.0, kept, found)
        if asked.result == "speed_fluctuation":
            return found
        half = 0.5 * found
        return abs(speed) * (1.0 - half if asked.result == "speed_min" else 1.0 + half)
