"""A machine over its cycle: its three functions and a plan of the results, evaluated for many variants.

Each of the three fills a tile,

    curves(P, T, q, cos_q, sin_q, tile)

with P (numbers, LANES) the numbers of each lane's variant, T the tables shared by all lanes, q, cos_q and sin_q
(positions, LANES) the input positions of each lane with cosine and sine, and tile (curves, at least as many
positions, LANES), which the function fills at the positions of q.

- `events` fills switching functions and their derivatives by q: rows 2i and 2i + 1 are f_i and f_i′. Behind them it
  fills the nodes held throughout a panel, which are taken at the panel's middle.
- `levels` is called once, when the landmarks of these functions (minimum, maximum and their positions) are in P, with
  arbitrary q: it fills numbers that follow from the landmarks.
- `curves` fills the curves of the plan. They are smooth within a panel, its ends included.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numba import types

from engine.compiling.ahead import compile_ahead, wait_until_compiled
from engine.compiling.blocks import LANES
from engine.compiling.memory import Memory
from engine.compiling.packed import Packed
from engine.compiling.printed_functions import PrintedFunction
from engine.compiling.running import address_of, run_piece, spread
from engine.compiling.threads import kept_by_thread
from engine.cycle.block_measures import MEASURES, SEARCHES
from engine.cycle.driver import (
    DriverAnswers,
    EvaluatedVariants,
    Task,
    evaluate_blocks,
    find_cuts,
    new_workspace,
    recorded_curves,
)
from engine.cycle.events import LandmarkRows
from engine.cycle.measured import Measured, maximum
from engine.cycle.measures.averages import Averages
from engine.cycle.measures.extremes import ExtremeRows, SoughtExtreme, find_in_record
from engine.cycle.measures.fluctuation import Fluctuation
from engine.cycle.measures.unloaded_arcs import Arc
from engine.cycle.panels.lanes import one
from engine.cycle.plan import Plan, is_cut, without_cuts

# Initial room for steps of the walk, and for those of all curves together; blocks that need more are evaluated again.
# The operating system provides memory only for the part in use.
_STEPS, _SLOTS = 24, 4096
# Doublings of the scan positions and of the room for roots, after which a variant that needs more has no results.
MOST_DOUBLINGS = 6


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

    def at_end(self, which: str) -> Measured:
        """Values or positions at an end of strokes: "low", "low_at", "high" or "high_at"."""
        return getattr(self, which.replace("low", "least").replace("high", "greatest"))

    def of(self, result: int) -> Extremes:
        """Those of one result, (variants,)."""
        parts = self.least, self.least_at, self.greatest, self.greatest_at
        return Extremes(*(part[result] for part in parts))

    @property
    def greatest_magnitude(self) -> Measured:
        """Maximum magnitude."""
        return maximum(self.greatest, -self.least)

    @property
    def range(self) -> Measured:
        """Maximum minus minimum."""
        return self.greatest - self.least


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
    extremes, landmarks : Extremes
        Of the requested curves, NaN for a side not requested; and of the switching functions.
    fluctuations : Measured (results, variants)
        δ of steady cycles with given flywheels; NaN if the machine would stop within the cycle.
    averages, squares : Measured (results, variants)
        Mean and mean square.
    arcs, arc_middles : Measured (results, variants)
        Widest unloaded arcs, and their middles [rad].
    crossings : ndarray (crossings, roots, variants)
        Positions of the crossings of each level, NaN for missing ones; empty unless the plan requests them.
    spaced : ndarray (results, variants, positions)
        Values at equally spaced positions.
    firsts : ndarray (curves, variants)
        Initial values of the curves kept over the cycle, the first ones of the plan.
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
    landmarks: Extremes
    fluctuations: Measured
    averages: Measured
    squares: Measured
    arcs: Measured
    arc_middles: Measured
    crossings: np.ndarray
    spaced: np.ndarray
    firsts: np.ndarray
    panels: np.ndarray
    broken_at: np.ndarray


def _record(kind: type, answers: np.ndarray) -> tuple:
    """Results (results, fields, variants) as a record; None for the fields that aren't stored."""
    return kind(*np.moveaxis(answers, 1, 0), *[None] * (len(kind._fields) - answers.shape[1]))


def _measured(kind: type, answers: np.ndarray, *names: str) -> list[Measured]:
    """Named fields of stored results, each with its error estimate."""
    found = _record(kind, answers)
    return [Measured(getattr(found, name), getattr(found, f"{name}_error")) for name in names]


def _extremes(answers: np.ndarray) -> Extremes:
    return Extremes(*(part for side in range(2) for part in _measured(ExtremeRows, answers[:, side], "value", "at")))


@kept_by_thread
def workspace_of(asked: Packed, numbers: int, steps: int) -> Packed:
    """Workspace of the calling thread for a `Task`, with a given number of rows of P and of steps of the walk."""
    room = new_workspace(asked.record, numbers, steps)
    if any(len(getattr(asked.record, name)) for name in SEARCHES):
        kind, row = Packed(room).kind, Memory(())
        sought = types.NamedTuple((types.intp, types.intp, row, row, types.float64), SoughtExtreme)
        address = address_of(find_in_record, kind.kind_of("record"), sought, kind.kind_of("search"), one(ExtremeRows))
        room = room._replace(search=room.search._replace(finder=address))
    return Packed(room)


def compile_driver(plan: Plan) -> None:
    """Compile the driver and the measures that a plan without cuts wants."""
    CycleMachine(plan, None).compile_shared()


def compile_driver_ahead(plan: Plan) -> None:
    """Compile the driver in a second process; if there are cuts, whose function is as large, also the measures."""
    others = without_cuts(plan) if is_cut(plan) else Plan(plan.ends, plan.curves)
    compile_ahead(evaluate_blocks, compile_driver, others)


@dataclass(frozen=True)
class CycleMachine:
    """A machine's functions and the plan of its results.

    Attributes
    ----------
    plan : Plan
    curves, events, levels : PrintedFunction or None
        See the module docstring; None where there is nothing to fill.
    """

    plan: Plan
    curves: PrintedFunction | None
    events: PrintedFunction | None = None
    levels: PrintedFunction | None = None
    _packed: Packed = field(init=False)

    def __post_init__(self) -> None:
        task = self.plan.task((self.events, self.levels, self.curves))
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
            apart = ("crossings", "spaced", "short_of_room")
            for name in DriverAnswers._fields:
                if name not in apart:
                    getattr(answers, name)[..., coarse] = getattr(again, name)
            more = again.crossings.shape[1] - answers.crossings.shape[1]
            crossings = np.pad(answers.crossings, ((0, 0), (0, more), (0, 0)), constant_values=np.nan)
            crossings[..., coarse] = again.crossings
            answers = answers._replace(crossings=crossings)
            answers.spaced[:, coarse] = again.spaced
        return self._outcome(numbers, answers)

    def _answers(self, asked: Packed, numbers: np.ndarray, tables: np.ndarray) -> DriverAnswers:
        blocks = np.arange(-(-numbers.shape[1] // LANES))
        answers = self._new_answers(asked.record, numbers.shape[1], blocks.size)
        steps, both = max(_STEPS, _SLOTS // max(recorded_curves(self.task), 1)), (asked, Packed(answers))
        while blocks.size:
            given = *both, Packed(EvaluatedVariants(blocks, numbers, tables)), steps
            spread(evaluate_blocks, blocks.size, partial(self._arguments, *given))
            blocks, steps = np.flatnonzero(answers.short_of_room), 2 * steps
        return answers

    def _arguments(self, asked: Packed, answers: Packed, variants: Packed, steps: int) -> tuple:
        """Arguments of the driver after its range; what they call is compiled now, or loaded from the cache."""
        room = workspace_of(asked, len(variants.record.numbers), steps)
        cuts = address_of(find_cuts, asked.kind, variants.kind, room.kind) if is_cut(asked.record) else 0
        wait_until_compiled(evaluate_blocks)
        return asked, answers, room, variants, cuts, self._measures(asked, answers, room)

    def compile_shared(self) -> None:
        """Compile what machines share, or load it from the cache, without evaluating any variant."""
        none = EvaluatedVariants(np.zeros(0, np.int64), np.zeros((1 + max(self.plan.ends), 0)), np.zeros(1))
        answers = self._new_answers(self.task, 0, 0)
        run_piece(evaluate_blocks, (0, 0), self._arguments(self._packed, Packed(answers), Packed(none), 1))

    def _new_answers(self, task: Task, variants: int, blocks: int) -> DriverAnswers:
        shapes = {
            "integrals": (len(task.integrals), 2),
            "roots": (len(task.roots), 2),
            "sizes": (task.tolerance.size,),
            "extremes": (len(task.extremes), 2, 4),
            "fluctuations": (len(task.fluctuations), 2),
            "averages": (len(task.averages), 4),
            "arcs": (len(task.arcs), len(Arc._fields)),
            "landmarks": (len(task.landmarks), len(LandmarkRows._fields)),
            "firsts": (task.kept,),
            "panels": (),
            "broken_at": (),
        }
        return DriverAnswers(
            **{name: np.empty((*shape, variants)) for name, shape in shapes.items()},
            crossings=np.full((self.plan.tells_crossings * len(task.crossings), task.most_roots, variants), np.nan),
            spaced=np.full((len(task.spaced), variants, self.plan.positions), np.nan),
            short_of_room=np.zeros(blocks, np.bool_),
        )

    def _measures(self, *records: Packed) -> np.ndarray:
        """Addresses of the measures that the plan needs."""
        kinds = (*(record.kind for record in records), types.intp)
        needed = [measure for name, measure in MEASURES.items() if len(getattr(self.task, name))]
        return np.array([address_of(measure, *kinds) for measure in needed], np.int64)

    def _outcome(self, numbers: np.ndarray, answers: DriverAnswers) -> CycleOutcome:
        first, last = (numbers[row] for row in self.plan.ends)
        marks = _record(LandmarkRows, answers.landmarks)
        of_value = marks.value_error
        return CycleOutcome(
            Measured(answers.integrals[:, 0], answers.integrals[:, 1]),
            Measured(answers.roots[:, 0], answers.roots[:, 1]),
            answers.sizes,
            last - first,
            _extremes(answers.extremes),
            Extremes(
                Measured(marks.least, of_value),
                Measured(marks.least_at, marks.least_at_error),
                Measured(marks.greatest, of_value),
                Measured(marks.greatest_at, marks.greatest_at_error),
            ),
            *_measured(Fluctuation, answers.fluctuations, "delta"),
            *_measured(Averages, answers.averages, "mean", "square"),
            *_measured(Arc, answers.arcs, "arc", "middle"),
            answers.crossings,
            answers.spaced,
            answers.firsts,
            answers.panels.astype(np.int64),
            answers.broken_at,
        )
