"""A machine over its cycle: four functions and what is asked of them, evaluated over variants.

Each of the four has the signature `engine.compiling.tiles.TILE_SIGNATURE`,

    curves(P, T, q, cos_q, sin_q, tile)

with P (numbers, LANES) the numbers of each lane's variant, T tables that all lanes share, q, cos_q and sin_q
(positions, LANES) input positions with cosine and sine, each lane its own, and tile (curves, at least as many
positions, LANES), which it fills in at the positions of q.

- `events` gives switching functions and their derivatives by q by turns: rows 2i and 2i + 1 are f_i and f_i′.
- `levels` is called once, at a position that means nothing, when the landmarks of these functions (their least and
  greatest values, and the places of those) stand in P: it gives numbers that follow from them.
- `states` is called at the middle of each panel: it gives what switches between one panel and the next.
- `curves` gives what is asked. Within a panel, its ends included, curves are smooth.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import numba
import numpy as np
from numba import types

from engine.compiling.nothing import nothing
from engine.compiling.running import prepare, spread
from engine.compiling.tiles import TileFunction
from engine.compiling.widths import LANES
from engine.cycle.driver import (
    DriverAnswers,
    EvaluatedVariants,
    MachineFunctions,
    Task,
    Workspace,
    evaluate_blocks,
    new_workspace,
)
from engine.cycle.events import MOST_ROOTS, LandmarkRows
from engine.cycle.measured import Measured, maximum
from engine.cycle.measures.averages import Averages
from engine.cycle.measures.extremes import BOTH, ExtremeRows
from engine.cycle.measures.fluctuation import Fluctuation
from engine.cycle.measures.unloaded_arcs import Arc, new_stretches

# What is the same in a plan and in its task.
_SAME = ("ends", "levels", "states", "cuts", "kinks", "integrals", "rooted", "speeds")
# Steps of the walk that there is room for to begin with, besides two for each level of a crossing; blocks that
# need more are evaluated again.
_STEPS = 24
# How often positions scanned, and room for roots, are doubled for variants that need more, before they have no results.
MOST_DOUBLINGS = 6


@dataclass(frozen=True)
class Plan:
    """What is asked of a machine, by the numbers of its curves and of rows of P.

    Attributes
    ----------
    ends : tuple of int
        Rows with the first and the last position of the input; it may run backwards.
    curves : int
        How many curves there are.
    landmarks : sequence of tuples
        For each switching function the rows that receive its least and greatest value and their places, in this order;
        −1 where none does.
    levels, states : sequence of int
        Rows that receive what these functions give.
    crossings : sequence of tuples
        Switching functions, rows with levels of theirs, and how far beyond these: the cycle is cut where a function
        takes that value.
    cuts : sequence of int
        Rows with input positions where the cycle is cut; NaN: nowhere.
    kinks : sequence of int
        Curves at whose zeros others bend: panels end there where those need it.
    integrals : sequence of int
        Curves to integrate over the cycle.
    roots : sequence of int
        Curves that are nowhere negative, whose roots are to be integrated over the cycle.
    rooted : sequence of int
        Curves that are nowhere negative and whose roots count: panels are as short as these need.
    extremes : sequence of int or tuples
        Curves whose least and greatest values are asked; with one of LEAST, GREATEST and LEAST_MAGNITUDE of
        `engine.cycle.measures.extremes` after it that alone.
    works : sequence of int
        Moments whose work about their mean is asked.
    combinations : sequence of tuples
        Moment, inertia, row with a factor c, and perhaps LEAST or GREATEST: extremes of W − c (I − I_1) are asked, of
        the work W about the mean of the moment and the inertia I, I_1 at the first position.
    fluctuations : sequence of tuples
        Moment, inertia, rows with mean speed and flywheel's inertia: the speed fluctuation is asked.
    compared : sequence of tuples
        A curve, another, and a row with a factor c: extremes of R − c (b − b₀) are asked, of the running integral R of
        the one and the other b.
    angles : sequence of tuples
        Curves with the components of vectors whose angles, followed over the cycle, are asked; where what is looked for
        is told, as in `engine.cycle.measures.extremes`, that.
    speeds : sequence of int
        Which fluctuations' speeds over the cycle are asked.
    averages : sequence of tuples
        Mean and mean square are asked of "works", "angles" or "speeds", and which of them.
    spaced : sequence of tuples
        The same, whose values at equally spaced positions are asked.
    intervals, positions : int
        Into how many parts those divide the range, and how many there are.
    arcs : sequence of tuples
        Curves with the components of forces and with the squares of their magnitudes, whose unloaded arcs are asked.
    tolerance : float or sequence of float
        What of each curve may be left beyond its series, as a share of its greatest magnitude.
    longest : float
        Longest panel, no more than π/2 where the input is an angle.
    period, turn : float
        After which length of the input all is the same again, and after which its crank is where it was; infinite where
        the range is no cycle.
    scan : int
        Positions over the range at which switching functions are looked at, doubled for variants that need more.
    looks : int
        How many times they are: twice where some of them depend on landmarks of others.
    turns : int
        Turns of the input in the range, for each of which there is room for `MOST_ROOTS`.
    """

    ends: tuple[int, int]
    curves: int
    landmarks: Sequence[tuple[int, int, int, int]] = ()
    levels: Sequence[int] = ()
    states: Sequence[int] = ()
    crossings: Sequence[tuple[int, int, float]] = ()
    cuts: Sequence[int] = ()
    kinks: Sequence[int] = ()
    integrals: Sequence[int] = ()
    roots: Sequence[int] = ()
    rooted: Sequence[int] = ()
    extremes: Sequence[int | tuple[int, int]] = ()
    works: Sequence[int] = ()
    combinations: Sequence[tuple[int, ...]] = ()
    fluctuations: Sequence[tuple[int, int, int, int]] = ()
    compared: Sequence[tuple[int, int, int]] = ()
    angles: Sequence[tuple[int, int]] = ()
    speeds: Sequence[int] = ()
    averages: Sequence[tuple[str, int]] = ()
    spaced: Sequence[tuple[str, int]] = ()
    intervals: int = 1
    positions: int = 0
    arcs: Sequence[tuple[int, int, int]] = ()
    tolerance: float | Sequence[float] = 1e-10
    longest: float = 1.26
    period: float = math.inf
    turn: float = math.inf
    scan: int = 36
    looks: int = 1
    turns: int = 1


@dataclass(frozen=True)
class Extremes:
    """Least and greatest values over the cycle with their places.

    Attributes
    ----------
    least, least_at, greatest, greatest_at : Measured (asked, variants)
    """

    least: Measured
    least_at: Measured
    greatest: Measured
    greatest_at: Measured

    @property
    def greatest_magnitude(self) -> Measured:
        """Greatest magnitude of the values."""
        return maximum(self.greatest, -self.least)

    @property
    def range(self) -> Measured:
        """Greatest less least value."""
        return self.greatest - self.least


@dataclass(frozen=True)
class Fluctuations:
    """Speed fluctuation of steady cycles with given flywheels.

    Attributes
    ----------
    delta : Measured (asked, variants)
        δ; NaN where the machine would stop within the cycle.
    slowest_at, fastest_at : Measured (asked, variants)
        Places of the least and the greatest speed.
    top : Measured (asked, variants)
        max[W − ½ω_max² (I − I_1)], for the kinetic energy at the first position: ½ω_max² (I_1 + I_F) less this.
    """

    delta: Measured
    slowest_at: Measured
    fastest_at: Measured
    top: Measured


@dataclass(frozen=True)
class CycleOutcome:
    """What was asked of a machine, per variant in the last dimension.

    Attributes
    ----------
    integrals, roots : Measured (asked, variants)
        Integrals of curves, and of roots of curves.
    sizes : ndarray (curves, variants)
        Greatest magnitudes.
    lengths : ndarray (variants,)
        Last less first position of the input.
    extremes, works, combinations, compared, angles, speeds, landmarks : Extremes
        Of what the plan asks, NaN where one side alone was asked; of the switching functions.
    fluctuations : Fluctuations
    averages, squares : Measured (asked, variants)
        Mean, and mean of the square.
    arcs, arc_middles : Measured (asked, variants)
        Widest arcs that forces never point to, and their middles.
    spaced : ndarray (asked, variants, positions)
        Values at equally spaced positions.
    firsts : dict of int to ndarray (variants,)
        Values at the first position of the curves that anything but integrals is asked of.
    panels : ndarray (variants,) of int
        How many panels were taken.
    broken_at : ndarray (variants,)
        First input position found where a curve isn't finite; NaN where all are; infinite, and all results NaN, where a
        switching function goes up and down too often to be looked at.
    """

    integrals: Measured
    roots: Measured
    sizes: np.ndarray
    lengths: np.ndarray
    extremes: Extremes
    works: Extremes
    combinations: Extremes
    compared: Extremes
    angles: Extremes
    speeds: Extremes
    landmarks: Extremes
    fluctuations: Fluctuations
    averages: Measured
    squares: Measured
    arcs: Measured
    arc_middles: Measured
    spaced: np.ndarray
    firsts: dict[int, np.ndarray]
    panels: np.ndarray
    broken_at: np.ndarray

    @property
    def means(self) -> Measured:
        """Means of the curves that were integrated."""
        return self.integrals / Measured(self.lengths)


def _integers(values: Sequence, columns: int = 0) -> np.ndarray:
    return np.array(values, dtype=np.int64).reshape((-1, columns) if columns else -1)


def _record(kind: type, answers: np.ndarray) -> tuple:
    """The answers (asked, fields, variants) of a record, as far as it is handed out, by name."""
    return kind(*np.moveaxis(answers, 1, 0), *[None] * (len(kind._fields) - answers.shape[1]))


def _measured(kind: type, answers: np.ndarray, *names: str) -> list[Measured]:
    """Answers of a record by name, each with its error."""
    found = _record(kind, answers)
    return [Measured(getattr(found, name), getattr(found, f"{name}_error")) for name in names]


def _extremes(answers: np.ndarray) -> Extremes:
    return Extremes(*(part for side in range(2) for part in _measured(ExtremeRows, answers[:, side], "value", "at")))


@dataclass(frozen=True)
class CycleMachine:
    """A machine's functions and what is asked of them.

    Attributes
    ----------
    plan : Plan
    curves, events, levels, states : callable
        See this module's text.
    """

    plan: Plan
    curves: Callable
    events: Callable = nothing
    levels: Callable = nothing
    states: Callable = nothing
    _task: Task = field(init=False)
    # The kinds of arguments that the driver is ready for.
    _prepared: set[tuple] = field(init=False, default_factory=set)
    # Each thread's workspace, for the next call.
    _of_thread: threading.local = field(init=False, default_factory=threading.local)

    def __post_init__(self) -> None:
        plan = self.plan
        moments = list(
            dict.fromkeys([*plan.works, *(c[0] for c in plan.combinations), *(f[0] for f in plan.fluctuations)])
        )
        rates = list(dict.fromkeys(c[0] for c in plan.compared))
        sought = [e if isinstance(e, tuple) else (e, BOTH) for e in plan.extremes]
        others = [*plan.roots, *(c for c, _ in sought)] + [
            c[1] for c in (*plan.combinations, *plan.fluctuations, *plan.compared)
        ]
        parts = [c for group in (*(a[:2] for a in plan.angles), *plan.arcs) for c in group]
        kept = list(dict.fromkeys([*moments, *rates, *others, *parts]))
        curve = {number: k for k, number in enumerate(kept)}
        derived = [("works", m) for m in moments] + [("runs", r) for r in rates]
        derived += [("angles", k) for k in range(len(plan.angles))] + [("speeds", k) for k in range(len(plan.speeds))]
        row = {name: len(kept) + k for k, name in enumerate(derived)}
        own = {("works", k): row["works", m] for k, m in enumerate(plan.works)}
        own |= {name: row[name] for name in derived if name[0] in ("angles", "speeds")}
        extremes = [
            *((curve[c], curve[c], -1, side) for c, side in sought),
            *((own["works", k], own["works", k], -1, BOTH) for k in range(len(plan.works))),
            *((row["works", m], curve[i], c, *(side or (BOTH,))) for m, i, c, *side in plan.combinations),
            *((row["runs", r], curve[b], c, BOTH) for r, b, c in plan.compared),
            *(
                (own["angles", k], own["angles", k], -1, *(side or (BOTH,)))
                for k, (_, _, *side) in enumerate(plan.angles)
            ),
            *((own["speeds", k], own["speeds", k], -1, BOTH) for k in range(len(plan.speeds))),
        ]
        same = {name: _integers(getattr(plan, name)) for name in _SAME}
        task = Task(
            **same,
            **{name: getattr(plan, name) for name in ("scan", "looks", "intervals", "longest", "period", "turn")},
            landmarks=_integers(plan.landmarks, 4),
            crossings=np.array(plan.crossings, float).reshape(-1, 3),
            most_roots=MOST_ROOTS * plan.turns,
            roots=_integers([curve[r] for r in plan.roots]),
            kept=_integers(kept),
            works=_integers([*((curve[m], 1) for m in moments), *((curve[r], 0) for r in rates)], 2),
            angles=_integers([(curve[x], curve[y]) for x, y, *_ in plan.angles], 2),
            extremes=_integers(extremes, 4),
            fluctuations=_integers([(row["works", m], curve[i], *given) for m, i, *given in plan.fluctuations], 4),
            averages=_integers([own[name] for name in plan.averages]),
            arcs=_integers([[curve[c] for c in arc] for arc in plan.arcs], 3),
            spaced=_integers([own[name] for name in plan.spaced]),
            tolerance=np.broadcast_to(np.asarray(plan.tolerance, dtype=float), (plan.curves,)).copy(),
            only_integrals=np.array([float(c in plan.integrals and c not in kept) for c in range(plan.curves)]),
        )
        object.__setattr__(self, "_task", task)

    @cached_property
    def _functions(self) -> MachineFunctions:
        return MachineFunctions(*(TileFunction(f) for f in (self.events, self.levels, self.states, self.curves)))

    @property
    def task(self) -> Task:
        """The plan as the driver takes it."""
        return self._task

    def evaluate(self, numbers: np.ndarray, tables: np.ndarray | None = None) -> CycleOutcome:
        """Evaluate variants, on all threads.

        Parameters
        ----------
        numbers : ndarray (numbers, variants)
            P of all variants; rows that the machine's functions fill in may hold anything.
        tables : ndarray, optional
            T.
        """
        task = self._task
        numbers = np.ascontiguousarray(numbers, dtype=float)
        tables = np.zeros(1) if tables is None else np.ascontiguousarray(tables, dtype=float)
        answers = self._answers(task, numbers, tables)
        for _ in range(MOST_DOUBLINGS):
            coarse = np.flatnonzero(np.isinf(answers.broken_at))
            if not coarse.size:
                break
            # In blocks of their own: what a variant is told depends on nothing but the variant.
            task = task._replace(scan=2 * task.scan, most_roots=2 * task.most_roots)
            again = self._answers(task, np.ascontiguousarray(numbers[:, coarse]), tables)
            for part, finer in zip(answers[:-2], again[:-2], strict=True):
                part[..., coarse] = finer
            answers.spaced[:, coarse] = again.spaced
        return self._outcome(numbers, answers)

    def _answers(self, task: Task, numbers: np.ndarray, tables: np.ndarray) -> DriverAnswers:
        blocks = np.arange(-(-numbers.shape[1] // LANES))
        answers = self._new_answers(numbers.shape[1], blocks.size)
        steps = _STEPS + 2 * len(task.crossings)
        while blocks.size:
            self._run(task, EvaluatedVariants(blocks, numbers, tables), answers, steps)
            blocks, steps = np.flatnonzero(answers.short_of_room), 2 * steps
        return answers

    def _new_answers(self, variants: int, blocks: int) -> DriverAnswers:
        plan, kept = self.plan, self._task.kept.size
        shapes = {
            "integrals": (len(plan.integrals), 2),
            "roots": (len(plan.roots), 2),
            "sizes": (plan.curves,),
            "extremes": (len(self._task.extremes), 2, 4),
            "fluctuations": (len(plan.fluctuations), 8),
            "averages": (len(plan.averages), 4),
            "arcs": (len(plan.arcs), len(Arc._fields)),
            "landmarks": (len(plan.landmarks), len(LandmarkRows._fields)),
            "firsts": (kept,),
            "panels": (),
            "broken_at": (),
        }
        return DriverAnswers(
            **{name: np.empty((*shape, variants)) for name, shape in shapes.items()},
            spaced=np.full((len(plan.spaced), variants, plan.positions), np.nan),
            short_of_room=np.zeros(blocks, np.bool_),
        )

    def _run(self, task: Task, variants: EvaluatedVariants, answers: DriverAnswers, steps: int) -> None:
        stretches = new_stretches if self.plan.arcs else lambda: None

        def arguments() -> tuple:
            work = self._workspace(task, len(variants.numbers), steps)
            return self._functions, task, variants, answers, work, stretches()

        kinds = (variants.numbers.flags.writeable, variants.tables.flags.writeable)
        if kinds not in self._prepared:
            prepare(evaluate_blocks, [types.intp, types.intp, *(numba.typeof(a) for a in arguments())])
            self._prepared.add(kinds)
        spread(evaluate_blocks, len(variants.blocks), arguments)

    def _workspace(self, task: Task, numbers: int, steps: int) -> Workspace:
        """Memory for this thread: that of the call before where it is large enough."""
        mine = self._of_thread.__dict__
        size = (task.scan, numbers, steps)
        if mine.get("size") != size:
            mine["size"], mine["work"] = size, new_workspace(task, numbers, steps)
        return mine["work"]

    def _outcome(self, numbers: np.ndarray, answers: DriverAnswers) -> CycleOutcome:
        plan = self.plan
        kinds = (plan.extremes, plan.works, plan.combinations, plan.compared, plan.angles, plan.speeds)
        extremes = np.split(answers.extremes, np.cumsum([len(kind) for kind in kinds])[:-1])
        first, last = (numbers[row] for row in plan.ends)
        marks = _record(LandmarkRows, answers.landmarks)
        of_value = marks.value_error
        return CycleOutcome(
            Measured(answers.integrals[:, 0], answers.integrals[:, 1]),
            Measured(answers.roots[:, 0], answers.roots[:, 1]),
            answers.sizes,
            last - first,
            *(_extremes(of) for of in extremes),
            Extremes(
                Measured(marks.least, of_value),
                Measured(marks.least_at, marks.least_at_error),
                Measured(marks.greatest, of_value),
                Measured(marks.greatest_at, marks.greatest_at_error),
            ),
            Fluctuations(*_measured(Fluctuation, answers.fluctuations, "delta", "slowest_at", "fastest_at", "top")),
            *_measured(Averages, answers.averages, "mean", "square"),
            *_measured(Arc, answers.arcs, "arc", "middle"),
            answers.spaced,
            dict(zip(self._task.kept.tolist(), answers.firsts, strict=True)),
            answers.panels.astype(np.int64),
            answers.broken_at,
        )
