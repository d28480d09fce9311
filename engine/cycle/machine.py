"""A machine over its cycle: its four functions and a plan of the results, evaluated for many variants.

Each of the four has the signature `engine.compiling.tiles.TILE_SIGNATURE`,

    curves(P, T, q, cos_q, sin_q, tile)

with P (numbers, LANES) the numbers of each lane's variant, T the tables shared by all lanes, q, cos_q and sin_q
(positions, LANES) the input positions of each lane with cosine and sine, and tile (curves, at least as many
positions, LANES), which the function fills at the positions of q.

- `events` fills switching functions and their derivatives by q: rows 2i and 2i + 1 are f_i and f_i′.
- `levels` is called once, when the landmarks of these functions (minimum, maximum and their positions) are in P, with
  arbitrary q: it fills numbers that follow from the landmarks.
- `states` is called at the middle of each panel: it fills the nodes held throughout the panel.
- `curves` fills the curves of the plan. They are smooth within a panel, its ends included.
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numba import types

from engine.compiling.packed import Packed
from engine.compiling.running import address_of, spread
from engine.compiling.tiles import TileFunction
from engine.compiling.widths import LANES
from engine.cycle.block_measures import MEASURES
from engine.cycle.driver import (
    DriverAnswers,
    EvaluatedVariants,
    MachineFunctions,
    Task,
    evaluate_blocks,
    new_workspace,
)
from engine.cycle.events import MOST_ROOTS, LandmarkRows
from engine.cycle.measured import Measured, maximum
from engine.cycle.measures.averages import Averages
from engine.cycle.measures.extremes import BOTH, ExtremeRows
from engine.cycle.measures.fluctuation import Fluctuation
from engine.cycle.measures.unloaded_arcs import Arc
from engine.cycle.panels.chebyshev import DEGREE

# Fields that are equal in a plan and its task: as arrays, and as they are.
_SHARED = ("ends", "levels", "states", "cuts", "kinks", "integrals", "rooted", "speeds")
_SAME = ("scan", "looks", "intervals", "degree", "longest", "period", "turn")
# Initial room for steps of the walk, plus two for each crossing; blocks that need more are evaluated again.
_STEPS = 24
# Doublings of the scan positions and of the room for roots, after which a variant that needs more has no results.
MOST_DOUBLINGS = 6


@dataclass(frozen=True)
class Plan:
    """Results wanted of a machine, by indices of its curves and of rows of P.

    Attributes
    ----------
    ends : tuple of int
        Rows with the first and last position of the input; it may run backwards.
    curves : int
        Number of curves.
    landmarks : sequence of tuples
        For each switching function the rows that receive its minimum, its maximum and their positions, in this order;
        −1 for none.
    levels, states : sequence of int
        Rows that receive the outputs of these functions.
    crossings : sequence of tuples
        Switching function, row with a level of it, and an offset: the cycle is cut where the function equals their sum.
    cuts : sequence of int
        Rows with input positions at which the cycle is cut; NaN for none.
    kinks : sequence of int
        Curves at whose zeros other curves have kinks: panels end there if those curves require it.
    integrals : sequence of int
        Curves to integrate over the cycle.
    roots : sequence of int
        Nonnegative curves whose square roots are integrated over the cycle.
    rooted : sequence of int
        Nonnegative curves whose square roots must meet the tolerance too.
    extremes : sequence of int or tuples
        Curves whose minimum and maximum are wanted, or (curve, kind) with LEAST, GREATEST or LEAST_MAGNITUDE of
        `engine.cycle.measures.extremes`.
    works : sequence of int
        Moments whose work about their mean is wanted.
    combinations : sequence of tuples
        Moment, inertia I, row with a factor c, and optionally LEAST or GREATEST: extremes of W − c (I − I_1) are
        wanted, with W the work of the moment about its mean and I_1 the inertia at the first position.
    fluctuations : sequence of tuples
        Moment, inertia, and rows with mean speed and flywheel inertia: the speed fluctuation is wanted.
    compared : sequence of tuples
        Curves r and b, and a row with a factor c: extremes of R − c (b − b₀) are wanted, with R the running integral of
        r and b₀ the initial value of b.
    angles : sequence of tuples
        Curves with the components of vectors whose continuous angles are wanted, and optionally the kind of extreme, as
        for `extremes`.
    speeds : sequence of int
        Indices of the fluctuations whose speeds over the cycle are wanted.
    averages : sequence of tuples
        "works", "angles" or "speeds", and an index among them: mean and mean square are wanted.
    spaced : sequence of tuples
        Likewise: values at equally spaced positions are wanted.
    intervals, positions : int
        Number of intervals into which those positions divide the range, and number of positions.
    arcs : sequence of tuples
        Curves with the components and the squared magnitudes of forces whose unloaded arcs are wanted.
    degree : int
        Degree of the panels: DEGREE, or COARSE if little accuracy is requested.
    tolerance : float or sequence of float
        Admissible remainder of each curve beyond its series, relative to its maximum magnitude.
    longest : float
        Maximum length of a panel; at most π/2 if the input is an angle.
    period, turn : float
        Length of the input after which the cycle, or the crank's position, recurs; infinite if the range isn't a cycle.
    scan : int
        Number of positions over the range at which switching functions are sampled; doubled for variants that need
        more.
    looks : int
        Number of scans: 2 if some switching functions depend on landmarks of others.
    turns : int
        Turns of the input in the range; there is room for `MOST_ROOTS` roots in each.
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
    degree: int = DEGREE
    tolerance: float | Sequence[float] = 1e-10
    longest: float = 1.26
    period: float = math.inf
    turn: float = math.inf
    scan: int = 36
    looks: int = 1
    turns: int = 1


@dataclass(frozen=True)
class Extremes:
    """Minima and maxima over the cycle and their positions.

    Attributes
    ----------
    least, least_at, greatest, greatest_at : Measured (results, variants)
    """

    least: Measured
    least_at: Measured
    greatest: Measured
    greatest_at: Measured

    @property
    def greatest_magnitude(self) -> Measured:
        """Maximum magnitude."""
        return maximum(self.greatest, -self.least)

    @property
    def range(self) -> Measured:
        """Maximum minus minimum."""
        return self.greatest - self.least


@dataclass(frozen=True)
class Fluctuations:
    """Speed fluctuation of steady cycles with given flywheels.

    Attributes
    ----------
    delta : Measured (results, variants)
        δ; NaN if the machine would stop within the cycle.
    slowest_at, fastest_at : Measured (results, variants)
        Positions of minimum and maximum speed.
    top : Measured (results, variants)
        max[W − ½ω_max² (I − I_1)]; the kinetic energy at the first position is ½ω_max² (I_1 + I_F) minus this.
    """

    delta: Measured
    slowest_at: Measured
    fastest_at: Measured
    top: Measured


@dataclass(frozen=True)
class CycleOutcome:
    """Results of a machine's plan; the last dimension is that of the variants.

    Attributes
    ----------
    integrals, roots : Measured (results, variants)
        Integrals of curves, and of square roots of curves.
    sizes : ndarray (curves, variants)
        Maximum magnitudes.
    lengths : ndarray (variants,)
        Last minus first position of the input.
    extremes, works, combinations, compared, angles, speeds, landmarks : Extremes
        As in the plan, NaN for a side that wasn't wanted; `landmarks` are those of the switching functions.
    fluctuations : Fluctuations
    averages, squares : Measured (results, variants)
        Mean and mean square.
    arcs, arc_middles : Measured (results, variants)
        Widest unloaded arcs, and their middles [rad].
    spaced : ndarray (results, variants, positions)
        Values at equally spaced positions.
    firsts : dict of int to ndarray (variants,)
        Initial values of the curves that aren't only integrated.
    panels : ndarray (variants,) of int
        Number of panels.
    broken_at : ndarray (variants,)
        First input position at which a curve is NaN or infinite, or NaN; infinite, with all results NaN, if a switching
        function oscillates too fast to be scanned.
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
        """Mean values of the integrated curves."""
        return self.integrals / Measured(self.lengths)


def _integers(values: Sequence, columns: int = 0) -> np.ndarray:
    return np.array(values, dtype=np.int64).reshape((-1, columns) if columns else -1)


def _record(kind: type, answers: np.ndarray) -> tuple:
    """Results (results, fields, variants) as a record; None for the fields that aren't stored."""
    return kind(*np.moveaxis(answers, 1, 0), *[None] * (len(kind._fields) - answers.shape[1]))


def _measured(kind: type, answers: np.ndarray, *names: str) -> list[Measured]:
    """Named fields of stored results, each with its error estimate."""
    found = _record(kind, answers)
    return [Measured(getattr(found, name), getattr(found, f"{name}_error")) for name in names]


def _extremes(answers: np.ndarray) -> Extremes:
    return Extremes(*(part for side in range(2) for part in _measured(ExtremeRows, answers[:, side], "value", "at")))


@dataclass(frozen=True)
class CycleMachine:
    """A machine's functions and the plan of its results.

    Attributes
    ----------
    plan : Plan
    curves, events, levels, states : callable or None
        See the module docstring; None where there is nothing to fill.
    """

    plan: Plan
    curves: Callable | None
    events: Callable | None = None
    levels: Callable | None = None
    states: Callable | None = None
    _packed: Packed = field(init=False)
    # Each thread's workspace, reused by its next call.
    _per_thread: threading.local = field(init=False, default_factory=threading.local)

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
        same = {name: _integers(getattr(plan, name)) for name in _SHARED}
        functions = (self.events, self.levels, self.states, self.curves)
        task = Task(
            MachineFunctions(*map(TileFunction, functions)),
            **same,
            **{name: getattr(plan, name) for name in _SAME},
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
        object.__setattr__(self, "_packed", Packed(task))

    @property
    def task(self) -> Task:
        """The plan in the driver's format."""
        return self._packed.record

    def evaluate(self, numbers: np.ndarray, tables: np.ndarray | None = None) -> CycleOutcome:
        """Evaluate variants on all threads.

        Parameters
        ----------
        numbers : ndarray (numbers, variants)
            P of all variants; rows that the machine's functions fill may hold anything.
        tables : ndarray, optional
            T.
        """
        asked = self._packed
        numbers = np.ascontiguousarray(numbers, dtype=float)
        tables = np.zeros(1) if tables is None else np.ascontiguousarray(tables, dtype=float)
        answers = self._answers(asked, numbers, tables)
        for _ in range(MOST_DOUBLINGS):
            coarse = np.flatnonzero(np.isinf(answers.broken_at))
            if not coarse.size:
                break
            # In separate blocks, so that a variant's results don't depend on the other variants.
            task = asked.record
            asked = Packed(task._replace(scan=2 * task.scan, most_roots=2 * task.most_roots))
            again = self._answers(asked, np.ascontiguousarray(numbers[:, coarse]), tables)
            for part, finer in zip(answers[:-2], again[:-2], strict=True):
                part[..., coarse] = finer
            answers.spaced[:, coarse] = again.spaced
        return self._outcome(numbers, answers)

    def _answers(self, asked: Packed, numbers: np.ndarray, tables: np.ndarray) -> DriverAnswers:
        blocks = np.arange(-(-numbers.shape[1] // LANES))
        answers = self._new_answers(numbers.shape[1], blocks.size)
        steps = _STEPS + 2 * len(self.task.crossings)
        both = asked, Packed(answers)
        while blocks.size:
            variants = Packed(EvaluatedVariants(blocks, numbers, tables))

            def arguments(variants: Packed = variants, steps: int = steps) -> tuple:
                room = self._workspace(asked.record, len(numbers), steps)
                return *both, room, variants, self._measures(*both, room)

            spread(evaluate_blocks, blocks.size, arguments)
            blocks, steps = np.flatnonzero(answers.short_of_room), 2 * steps
        return answers

    def _new_answers(self, variants: int, blocks: int) -> DriverAnswers:
        plan, kept = self.plan, self.task.kept.size
        shapes = {
            "integrals": (len(plan.integrals), 2),
            "roots": (len(plan.roots), 2),
            "sizes": (plan.curves,),
            "extremes": (len(self.task.extremes), 2, 4),
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

    def _measures(self, *records: Packed) -> np.ndarray:
        """Addresses of the measures that the plan needs."""
        kinds = (*(record.kind for record in records), types.intp)
        needed = [measure for name, measure in MEASURES.items() if len(getattr(self.task, name))]
        return np.array([address_of(measure, *kinds) for measure in needed], np.int64)

    def _workspace(self, task: Task, numbers: int, steps: int) -> Packed:
        """Workspace of the calling thread, reused if its size fits."""
        mine = self._per_thread.__dict__
        size = (task.scan, numbers, steps)
        if mine.get("size") != size:
            mine["size"], mine["work"] = size, Packed(new_workspace(task, numbers, steps))
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
            dict(zip(self.task.kept.tolist(), answers.firsts, strict=True)),
            answers.panels.astype(np.int64),
            answers.broken_at,
        )
