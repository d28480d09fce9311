"""A machine prepared for evaluation, of one variant or millions."""

import math
from collections.abc import Iterable, Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np

from engine import elements, machine, motion, warnings
from engine.compiling.blocks import LANES
from engine.compiling.threads import on_all_threads, threads
from engine.cycle.measured import UNKNOWN_ROOT, Measured
from engine.elements.element import Element
from engine.graph.nodes import Found, Node, Return, reached
from engine.machine.checks import (
    allowed_share,
    check_names,
    check_positions,
    check_scene,
    full_names,
    given_numbers,
    names_of,
    size_remarks,
)
from engine.machine.judgement import Failures, judge_cycles, judge_runs
from engine.machine.measuring import MeasuredCycles, Measuring
from engine.machine.results import AskError, Outcome, asked_text, blank, field_room, front_of
from engine.mechanism.mechanics import Mechanics
from engine.parts.skeleton import CrankInput
from engine.quantities.expressions import Angle, Expression, Followed, Speed, Work
from engine.quantities.machine import register_of
from engine.quantities.register import Field, Summary
from engine.scene import structure
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.words.quantity import STATISTICS, Quantity, Rank
from engine.words.verdicts import Verdict

# Errors of quantities that vanish identically: differences of two roots.
SURELY_NOTHING = 4.0 * UNKNOWN_ROOT
# Variants measured together by a thread, so that their data stays in its caches.
VARIANTS_AT_ONCE = 8192
# Variants whose machine curves are computed together for governors.
GOVERNED_AT_ONCE = 1024
# Summaries that are relative differences, zero if two numbers agree.
_RELATIVE_ALREADY = ("_difference", "_residual", "_disagreement")

POSITIONS_USED = Quantity("positions_used", "input positions at which it was evaluated", "1", rank=Rank.CHECK)
ACCURACY_REACHED = Quantity(
    "accuracy_reached",
    "1 where every error estimate is within the requested accuracy, else 0",
    "1",
    rank=Rank.CHECK,
)
OF_ACCURACY = (POSITIONS_USED.name, ACCURACY_REACHED.name)


class _NoElements(NamedTuple):
    """Stand-in for `AskedElements` in a scene without machine elements."""

    names: tuple[str, ...] = ()
    elements: Mapping[str, Element] = {}


class _NoRegimes(NamedTuple):
    """Stand-in for `motion.regimes.Regimes` in a scene without regimes."""

    summaries: Mapping[str, Quantity] = {}
    fields: Mapping[str, Quantity] = {}
    asked: tuple[str, ...] = ()
    kept_at: Mapping[str, "motion.quantities.KeptAt"] = {}
    in_order: None = None
    nodes: tuple[Node, ...] = ()


class Machine:
    """A scene with the requested summaries and fields.

    Summaries are measured on the cycle of every variant, which is split where a load of that variant switches, and
    refined as its curves require. Fields are kept at equally spaced positions.

    Parameters
    ----------
    scene : Scene
    summaries, fields : str or iterable of str
        Names from `available_summaries` and `available_fields`.
    varied : str or iterable of str
        Paths of the scene's numbers whose values are passed to `evaluate`.
    positions : int
        Intervals of the kept fields per cycle, or over the input's range; even, at least 8.
    dtype : float64 or float32
        Type of the kept fields; summaries are always computed in float64.
    accuracy : float or str, optional
        Permitted error of every summary, such as 0.001 or "0.1 %", relative to its magnitude; of a statistic of a
        field, relative to the field's peak. By default summaries are as accurate as is possible at little extra cost.

    Attributes
    ----------
    kept_at : dict of str to KeptAt
        Where requested fields of runs are kept: at instants, or at angles turned. All others are kept at `nodes`.
    fields_with_error : tuple of str
        Requested fields of regimes, which have an error estimate for each variant.

    Raises
    ------
    SceneError
        The scene can't be ordered into structural groups.
    AskError
        A requested quantity doesn't exist.

    Examples
    --------
    >>> from engine import Machine, Scene
    >>> scene = Scene.model_validate({
    ...     "points": {"O": {"x": 0, "y": 0}},
    ...     "guides": {"way": {}},
    ...     "input": {"type": "crank", "pivot": "O", "pin": "A", "length": "50 mm", "speed": "60 rpm"},
    ...     "groups": {"g": {"type": "RRP", "inner": "B",
    ...                      "first": {"link": "rod", "joint": "A", "length": "200 mm"},
    ...                      "second": {"link": "ram", "guide": "way"}}},
    ... })
    >>> outcome = Machine(scene, summaries=["ram.stroke"]).evaluate({})
    >>> round(float(outcome.summaries["ram.stroke"][0]), 12)
    0.1
    """

    def __init__(
        self,
        scene: Scene,
        summaries: Iterable[str] = (),
        fields: Iterable[str] = (),
        varied: Iterable[str] = (),
        positions: int = 720,
        dtype: type = np.float64,
        accuracy: float | str | None = None,
    ) -> None:
        check_scene(scene)
        check_positions(positions)
        self.scene, self.positions, self.dtype = scene, positions, np.dtype(dtype)
        self.accuracy, self.varied = allowed_share(accuracy), names_of(varied)
        self._limits = scene_numbers(scene)
        check_names(self.varied, self._limits, "number")
        if isinstance(scene.input, CrankInput) and {"input.start", "input.stop"} & set(self.varied):
            raise AskError("input.start and input.stop of a crank are the same for all variants; vary another number")
        fixed = [path for path in self.varied if path.startswith("near.")]
        if fixed:
            raise AskError(f"{fixed[0]} selects the scene's assembly mode for all variants; vary another number")
        turning = {f"shafts.{cam.on}.ratio": name for name, cam in scene.cams.items()}
        fixed = [path for path in self.varied if path in turning]
        if fixed:
            raise AskError(f"{fixed[0]} turns cam {turning[fixed[0]]!r}, whose cycle must close; vary another number")
        fixed = sorted(set(self.varied) & structure.input_laws.fixed_by_laws(scene)) if scene.inputs else []
        if fixed:
            raise AskError(f"{fixed[0]}: its turns in a cycle are the same for all variants; vary another number")
        self.mechanics = Mechanics(scene, frozenset(self.varied))
        self.register = register_of(self.mechanics)
        self._ask(summaries, fields)

    def _ask(self, summaries: Iterable[str], fields: Iterable[str]) -> None:
        """Resolve the requested names."""
        scene, positions, accuracy = self.scene, self.positions, self.accuracy
        summaries, fields = names_of(summaries), names_of(fields)
        self.asked_summaries = list(dict.fromkeys(full_names(scene, name) for name in summaries))
        self.asked_fields = list(dict.fromkeys(full_names(scene, name) for name in fields))
        asked_as = {name: full_names(scene, name) for name in (*summaries, *fields)}
        self._asked_as = {name: full for name, full in asked_as.items() if name != full}
        # Warnings require summaries that may not have been requested.
        self._warnings = self._asked_warnings()
        required = self._warnings.reads if self._warnings else ()
        self._computed = list(dict.fromkeys((*self.asked_summaries, *required)))
        self._elements = (
            machine.elements.asked_elements.AskedElements(scene, self._computed) if scene.elements else _NoElements()
        )
        of_machine = {n: e for n, e in self._elements.elements.items() if any(e.machine_needed())}
        self._trains = [name for name, element in of_machine.items() if element.type == "torsional_train"]
        drives = [name for name, element in of_machine.items() if element.type == "machine_drive"]
        self._governing = [name for name in of_machine if name not in (*self._trains, *drives)]
        self._drives = machine.drives.elastic_drives.ElasticDrives(self.mechanics, drives) if drives else None
        asked = (*self._computed, *self.asked_fields)
        self.regimes = (
            motion.regimes.Regimes(self.mechanics, asked, positions, accuracy) if scene.regimes else _NoRegimes()
        )
        self._check_asked()
        others = {*self._elements.names, *OF_ACCURACY, *self.regimes.asked, *self._warning_names}
        measured = [name for name in self._computed if name not in others]
        self._summaries: dict[str, Summary] = {name: self.register.summary(name) for name in measured}
        self._fields: dict[str, Field] = {
            name: self.register.fields[name] for name in self.asked_fields if name not in others
        }
        self.kept_at = {name: at for name, at in self.regimes.kept_at.items() if name in self.asked_fields}
        self.fields_with_error = tuple(name for name in self.asked_fields if name in self.regimes.fields)

    def __repr__(self) -> str:
        return asked_text(self)

    def _check_asked(self) -> None:
        """Reject unknown names, with similar ones in the message."""
        fields = {**self.register.fields, **self.regimes.fields}
        for name in self.asked_summaries:
            if name in fields and name not in self.available_summaries:
                statistics = ", ".join(f"{name}.{statistic}" for statistic in STATISTICS)
                raise AskError(f"{name!r} is a field, a curve: ask for it as a field, or for its {statistics}")
        for name in self.asked_fields:
            if name not in fields and self.register.summary(name) is not None:
                raise AskError(f"{name!r} is a summary, a single number: ask for it as a summary")
        check_names(self.asked_fields, fields, "field")
        known = {*self._elements.names, *OF_ACCURACY, *self.regimes.asked, *self._warning_names}
        unknown = [n for n in self.asked_summaries if n not in known and self.register.summary(n) is None]
        if unknown:
            statistics = [f"{field}.{statistic}" for field in self.register.fields for statistic in STATISTICS]
            check_names(unknown, [*self.available_summaries, *statistics], "summary")
        for name in (*self.asked_summaries, *self.asked_fields):
            why = self.register.why_not(name)
            if why is not None:
                raise AskError(why)

    # Available quantities

    @property
    def available_fields(self) -> dict[str, Quantity]:
        """Every field of this scene."""
        own = {name: field.quantity for name, field in self.register.available_fields.items()}
        return own | self.regimes.fields

    @property
    def available_summaries(self) -> dict[str, Quantity]:
        """Every summary, except the statistics of fields: FIELD.max, FIELD.rms, … (see STATISTICS)."""
        of_warnings = warnings.asked_warnings.warning_summaries(self.scene, self._has_summary)
        return self._computed_summaries | {q.name: q for q in of_warnings}

    @property
    def _computed_summaries(self) -> dict[str, Quantity]:
        """All except the warnings, which are plain numbers."""
        names = [name for name in self.register.summaries if self.register.why_not(name) is None]
        summaries = {name: self.register.summary(name) for name in (*names, *self.asked_summaries)}
        own = {name: summary.quantity for name, summary in summaries.items() if summary is not None}
        of_scene = machine.elements.asked_elements.element_summaries(self.scene) if self.scene.elements else []
        others = {q.name: q for q in (*of_scene, POSITIONS_USED, ACCURACY_REACHED)}
        return own | self.regimes.summaries | others

    def _has_summary(self, name: str) -> bool:
        """Whether a summary of the cycle or of a regime exists."""
        if self.register.summary(name) is not None:
            return self.register.why_not(name) is None
        return bool(self.scene.regimes) and name in {q.name for q in motion.quantities.motion_summaries(self.scene)}

    def _asked_warnings(self) -> "warnings.asked_warnings.AskedWarnings | None":
        """Warnings among the requested summaries; None if there are none."""
        if not any(map(warnings.is_warning, self.asked_summaries)):
            return None
        return warnings.asked_warnings.AskedWarnings(self.scene, self.asked_summaries, self._has_summary)

    @property
    def _warning_names(self) -> list[str]:
        return self._warnings.names if self._warnings else []

    # Positions of the kept fields

    @property
    def has_cycle(self) -> bool:
        """Whether the input turns fully."""
        return self.mechanics.has_cycle

    @property
    def nodes(self) -> np.ndarray:
        """Positions of the kept fields: crank angles [rad], or shares of the range of a sliding input."""
        drive = self.scene.input
        if self.has_cycle:
            return np.arange(self.positions) * (math.tau * drive.revolutions / self.positions)
        share = np.arange(self.positions + 1) / self.positions
        return drive.start + (drive.stop - drive.start) * share if isinstance(drive, CrankInput) else share

    @property
    def input_values(self) -> np.ndarray:
        """Values of the input at these positions, with the scene's numbers [rad, or m for a sliding input]."""
        drive = self.scene.input
        if isinstance(drive, CrankInput):
            return self.nodes
        return drive.start + (drive.stop - drive.start) * self.nodes

    # Computed quantities

    @cached_property
    def _curves(self) -> dict[str, Node | Followed]:
        """Curves of the kept fields."""
        return {name: field.curve() for name, field in self._fields.items()}

    @cached_property
    def _followed(self) -> dict[str, Work | Speed]:
        """Kept fields that are read off the measured cycle."""
        return {name: curve for name, curve in self._curves.items() if isinstance(curve, Work | Speed)}

    @cached_property
    def _kept_curves(self) -> dict[str, Node | Angle]:
        """Kept fields that are computed position by position."""
        return {name: curve for name, curve in self._curves.items() if name not in self._followed}

    @cached_property
    def _spaced(self) -> list[str]:
        """Fields kept at `nodes`, first those that are computed position by position: rows of the buffer."""
        others = [name for name in self.asked_fields if name not in {*self.kept_at, *self._kept_curves}]
        return [*self._kept_curves, *others]

    @cached_property
    def _kept(self) -> "machine.kept_fields.KeptFields":
        measuring = self._measuring
        return machine.kept_fields.KeptFields(list(self._kept_curves.values()), measuring.functions, self.dtype)

    @cached_property
    def _harmonics(self) -> list[Expression]:
        """Excitation of torsional trains by the machine."""
        if not self._trains:
            return []
        return machine.drives.excited_trains.machine_harmonics(self.mechanics)

    @cached_property
    def _measuring(self) -> Measuring:
        """Functions and plan for all measurements; they also decide whether the regimes' groups can be assembled."""
        expressions = [summary.expression() for summary in self._summaries.values()]
        expressions += self._harmonics
        followed, grid = list(self._followed.values()), (self.positions, self.nodes.size)
        kept = [machine.kept_fields.field_node(c) for c in self._kept_curves.values()]
        return Measuring(self.mechanics, expressions, kept, followed, grid, self.accuracy, self._moving)

    @cached_property
    def _returns(self) -> list[Return]:
        """Conditions on which everything requested returns to its initial value."""
        return self.mechanics.returns_of([*self._measuring.curves, *self._moving])

    @property
    def _moving(self) -> list[Node]:
        """Position-dependent nodes required by regimes and elastic drives."""
        return [*self.regimes.nodes, *(self._drives.nodes if self._drives else ())]

    @property
    def groups(self) -> tuple[str, ...]:
        """Structural groups, then paths of elements and regimes, in the order of the indices in `status_group`."""
        tables = {"elements": self.scene.elements, "regimes": self.scene.regimes}
        return *self.mechanics.kinematics.sines, *(f"{key}.{name}" for key, table in tables.items() for name in table)

    def source(self) -> str:
        """Source text of the printed functions."""
        kept = {"fields": self._kept.code} if self._kept_curves else {}
        codes = {**self._measuring.functions.codes, **kept}
        return "\n".join(f"; {name}\n{code.text}" for name, code in codes.items())

    @property
    def numbers_kept(self) -> int:
        """Numbers per variant in the layout of the printed functions."""
        return len(self._measuring.functions.rows)

    @property
    def computed(self) -> dict[str, list[str]]:
        """Levels (position, velocity, …) of points, links and groups that are computed at a position."""
        return machine.computed.computed_levels(self.mechanics, [*self._measuring.curves, *self._moving])

    @property
    def left_out(self) -> dict[str, list[str]]:
        """Levels that no requested quantity needs."""
        everything, kept = machine.computed.all_levels(self.mechanics), self.computed
        missing = {s: [level for level in levels if level not in kept.get(s, ())] for s, levels in everything.items()}
        return {subject: levels for subject, levels in missing.items() if levels}

    @property
    def has_regimes(self) -> bool:
        """Whether a quantity of a regime is requested, such as a run or steady running."""
        return self.regimes.in_order is not None

    def new_buffer(self, variants: int) -> np.ndarray:
        """Allocate memory for the requested fields of a number of variants; reuse it from block to block."""
        return field_room((len(self._spaced), variants, self.nodes.size), self.dtype)

    # Evaluation

    def evaluate(
        self,
        varied: Mapping[str, np.ndarray],
        drop: np.ndarray | None = None,
        buffer: np.ndarray | None = None,
    ) -> Outcome:
        """Evaluate a set of variants.

        Parameters
        ----------
        varied : mapping of path to ndarray (variants,), or to texts with units such as "50 mm"
            Values of the varied paths, plain numbers in SI; empty for the scene's numbers, one variant.
        drop : ndarray (variants,) of bool, optional
            Variants not to evaluate; their status is DROPPED.
        buffer : ndarray (fields over positions, at least variants, positions), optional
            Memory for those fields, from `new_buffer`; the outcome's fields are views of it.

        Raises
        ------
        AskError
            The paths differ from the machine's varied paths, or a value is invalid.
        """
        arrays, status = given_numbers(self._limits, self.varied, varied, drop)
        variants, whole = status.size, Numbers(self._limits, arrays)
        closes = self.mechanics.closes(whole, self._returns)
        status[(status == Verdict.OK) & ~np.asarray(closes)] = Verdict.DOES_NOT_CLOSE
        keep = np.flatnonzero(status == Verdict.OK)
        room = front_of(self.new_buffer(variants) if buffer is None else buffer, variants)
        # Only variants whose status is OK so far are filled in; the rest is NaN.
        room[:, slice(None) if self.regimes.asked else status != Verdict.OK] = np.nan
        spaced = dict(zip(self._spaced, room, strict=True))
        instants = {n: np.full((variants, at.values.size), np.nan, self.dtype) for n, at in self.kept_at.items()}
        fields = {name: spaced[name] if name in spaced else instants[name] for name in self.asked_fields}
        outcome = blank(status, self._computed, fields, self.fields_with_error)
        if keep.size:
            self._fill(outcome, room, keep, whole if keep.size == variants else whole.of_variants(keep))
        if self._warnings:
            self._warnings.fill(outcome.status, outcome.summaries, outcome.errors, whole)
        remarks = () if (status == Verdict.OK).any() else size_remarks(self._limits, arrays)
        outcome = outcome.with_summaries(self.asked_summaries)._replace(units=self._units, remarks=remarks)
        return outcome.with_names(self._asked_as) if self._asked_as else outcome

    @cached_property
    def _units(self) -> dict[str, str]:
        """SI unit of every requested quantity."""
        known = self._computed_summaries | self.available_fields
        names = (*self.asked_summaries, *self.asked_fields)
        return {name: known[name].units if name in known else "1" for name in names}

    def _fill(self, outcome: Outcome, room: np.ndarray, keep: np.ndarray, numbers: Numbers) -> None:
        """Evaluate the variants `keep`, and write their summaries, fields and verdicts."""
        if self.has_regimes:
            self.regimes.compile_ahead()
        # Whole blocks of lanes for each thread.
        batch = min(-(-keep.size // (threads() * LANES)) * LANES, VARIANTS_AT_ONCE)
        batches = [slice(first, first + batch) for first in range(0, keep.size, batch)]
        measured = on_all_threads(
            lambda some: self._measure(outcome, room, keep[some], numbers.of_variants(some)), batches
        )
        panels, excess, of_trains = zip(*measured, strict=True)
        excitation = {key: np.concatenate([found[key] for found in of_trains]) for key in of_trains[0]}
        of_machine = {f"elements.{t}.{key}": row for t in self._trains for key, row in excitation.items()}
        if self._drives is not None:
            of_machine |= self._drives.numbers(numbers, outcome.status[keep] == Verdict.OK)
        if self._elements.elements:
            self._fill_elements(outcome, keep, numbers.with_values(of_machine))
        if self.has_regimes:
            self._move(outcome, keep, numbers)
        self._note_accuracy(outcome, keep, np.concatenate(panels), np.concatenate(excess))

    def _fill_elements(self, outcome: Outcome, keep: np.ndarray, numbers: Numbers) -> None:
        """Write the requested results of machine elements for the variants `keep`."""
        batch = GOVERNED_AT_ONCE if self._governing else keep.size
        for first in range(0, keep.size, batch):
            some = slice(first, first + batch)
            own = self._governed(outcome, keep[some], numbers.of_variants(some))
            self._elements.fill(outcome, keep[some], own, self.groups)

    def _governed(self, outcome: Outcome, keep: np.ndarray, numbers: Numbers) -> Numbers:
        """Numbers in which the engine of each governor of this machine has the machine's inertia and curves.

        Verdicts on the machine pass to the variants `keep`.
        """
        if not self._governing:
            return numbers
        engines, mechanism = self._governed_engines
        found = mechanism.evaluate({path: np.broadcast_to(numbers[path], keep.shape) for path in self.varied})
        Failures(*found[:3]).write(outcome, keep)
        return numbers.with_values(engines.numbers(found, numbers))

    @cached_property
    def _governed_engines(self) -> "tuple[machine.drives.governed_engines.GovernedEngines, Machine]":
        """Engines of the governors of this machine, and the machine with the quantities they require."""
        engines = machine.drives.governed_engines.GovernedEngines(self.scene, self._governing)
        positions = elements.governors.transients.CYCLE_POSITIONS
        return engines, Machine(self.scene, engines.summaries, engines.fields, self.varied, positions)

    def _measure(
        self, outcome: Outcome, room: np.ndarray, keep: np.ndarray, numbers: Numbers
    ) -> tuple[np.ndarray, np.ndarray, dict[str, np.ndarray]]:
        """Evaluate the cycles of the variants `keep`.

        Returns
        -------
        panels : ndarray (variants,)
            Number of panels used for each.
        excess : ndarray (variants,)
            Maximum ratio of error estimate to permitted error of each, if requested, else 0.
        of_trains : dict of str to ndarray
            Excitation of torsional trains.
        """
        table = self._measuring.numbers(numbers, keep.size)
        answers = self._measuring(table)
        undefined, excess = np.zeros(keep.size, bool), np.zeros(keep.size)
        own = slice(keep[0], keep[-1] + 1) if keep[-1] - keep[0] == keep.size - 1 else keep
        for (name, summary), expression in zip(self._summaries.items(), self._measuring.expressions, strict=False):
            # An overflow in a calculation results in a status, not in a warning.
            with np.errstate(all="ignore"):
                found = answers.value_of(expression)
                if ACCURACY_REACHED.name in self.asked_summaries and not name.endswith("_at"):
                    excess = np.fmax(excess, self._excess(name, expression, found, answers))
            value, error = found.value, found.error
            nothing = np.broadcast_to(~np.isfinite(value), keep.shape)
            if nothing.any():
                undefined |= nothing & (not summary.may_be_undefined)
                value, error = np.where(nothing, np.nan, value), np.where(nothing, np.nan, error)
            outcome.summaries[name][own], outcome.errors[name][own] = value, error
        self._measuring.fill_found(table, answers.outcome.landmarks)
        if self._fields:
            undefined |= ~self._keep(room, keep, table, answers)
        judge_cycles(self._measuring, numbers, table, answers, undefined, outcome, keep)
        failed = keep[outcome.status[keep] != Verdict.OK]
        if failed.size:
            for name in self._summaries:
                outcome.summaries[name][failed] = outcome.errors[name][failed] = np.nan
        return answers.outcome.panels, excess, self._for_trains(answers, numbers, keep.size)

    def _for_trains(self, answers: MeasuredCycles, numbers: Numbers, variants: int) -> dict[str, np.ndarray]:
        """Excitation of torsional trains by the machine; empty without trains."""
        if not self._trains:
            return {}
        harmonics = self._harmonics
        return machine.drives.excited_trains.machine_numbers(
            numbers, self.mechanics, harmonics, answers.value_of, variants
        )

    def _move(self, outcome: Outcome, keep: np.ndarray, numbers: Numbers) -> None:
        """Compute the regimes of the variants `keep` whose status is OK so far.

        If only runs are requested, a group may fail at positions that the runs don't reach.
        """
        failing = np.isin(outcome.status[keep], (Verdict.CANNOT_ASSEMBLE, Verdict.SINGULAR))
        failing &= failing.any() and self._runs_alone_count
        ready = np.flatnonzero((outcome.status[keep] == Verdict.OK) | failing)
        if not ready.size:
            return
        moved, answers = keep[ready], self.regimes.answers(numbers.of_variants(ready), ready.size)
        verdict = answers.verdict.copy()
        if failing.any():
            some, rounding = np.flatnonzero(failing[ready]), np.zeros(ready.size)
            own, covered = numbers.of_variants(ready[some]), answers.covered[:, :, some]
            rounding[some] = judge_runs(self._measuring, own, covered, verdict[some], outcome, moved[some])
            verdict[some] = outcome.status[moved[some]]
            answers = answers.judged(verdict != answers.verdict, rounding)
        outcome.status[moved] = verdict
        of_regime = (answers.failing >= 0) & (verdict == answers.verdict)
        first = len(self.groups) - len(self.scene.regimes)
        outcome.status_group[moved[of_regime]] = first + answers.failing[of_regime]
        for name, value in answers.values.items():
            outcome.summaries[name][moved], outcome.errors[name][moved] = value, answers.errors[name]
        for name, rows in answers.fields.items():
            outcome.fields[name][moved], outcome.errors[name][moved] = rows, answers.errors[name]

    @property
    def _runs_alone_count(self) -> bool:
        """Whether no requested quantity depends on the cycle as a whole, for instance by the ends of a stroke."""
        in_order = self.regimes.in_order
        if in_order is None or self._summaries or self._fields or self._trains or self._governing or self._drives:
            return False
        strokes = any(isinstance(node, Found) for node in reached(self._moving))
        return in_order.steady.isdisjoint(in_order.needed) and not strokes and not self._measuring.windings

    def _keep(self, room: np.ndarray, keep: np.ndarray, table: np.ndarray, answers: MeasuredCycles) -> np.ndarray:
        """Fill the kept fields; return which variants have finite values only."""
        finite = np.ones(keep.size, bool)
        if self._kept_curves:
            ends = self._measuring.ends if self._ranges_vary else machine.kept_fields.NONE
            finite = self._kept.fill(table, self._positions_kept, room[: len(self._kept_curves)], keep, ends)
        for name, curve in self._followed.items():
            # A value may become infinite in single precision.
            with np.errstate(over="ignore"):
                values = answers.spaced(curve).astype(self.dtype, copy=False)
            room[self._spaced.index(name)][keep] = values
            finite &= np.isfinite(values).all(axis=1)
        return finite

    @property
    def _ranges_vary(self) -> bool:
        """Whether the input's range differs between variants."""
        return not isinstance(self.scene.input, CrankInput) and bool({"input.start", "input.stop"} & set(self.varied))

    @property
    def _positions_kept(self) -> np.ndarray:
        """Input positions of the fields, or shares of each variant's range."""
        return self.nodes if self._ranges_vary else self.input_values

    # Accuracy

    def _note_accuracy(self, outcome: Outcome, keep: np.ndarray, panels: np.ndarray, excess: np.ndarray) -> None:
        """Fill the columns for the number of positions used and for whether the requested accuracy is reached."""
        failed = outcome.status[keep] != Verdict.OK
        if POSITIONS_USED.name in self.asked_summaries:
            used = panels * (self._measuring.machine.plan.degree + 1.0)
            self._column(outcome, keep, POSITIONS_USED.name, np.where(failed, np.nan, used))
        if ACCURACY_REACHED.name in self.asked_summaries:
            reached = (excess <= 1.0).astype(float)
            self._column(outcome, keep, ACCURACY_REACHED.name, np.where(failed, np.nan, reached))

    @staticmethod
    def _column(outcome: Outcome, keep: np.ndarray, name: str, values: np.ndarray) -> None:
        outcome.summaries[name][keep], outcome.errors[name][keep] = values, np.where(np.isnan(values), np.nan, 0.0)

    def _excess(self, name: str, expression: Expression, found: Measured, answers: MeasuredCycles) -> np.ndarray:
        """Ratio of a summary's error estimate to the permitted error.

        A quantity that may vanish is judged by the peaks of the curves it is computed from: the statistic of a field by
        the field's peak, others by their error if these curves were off by the permitted accuracy. Positions of
        extremes don't count: at a flat extreme the position is hardly defined, and nothing depends on it.
        """
        accuracy, (field, _, statistic) = self.accuracy or 1.0, name.rpartition(".")
        own = accuracy * (1.0 if name.endswith(_RELATIVE_ALREADY) else np.abs(found.value))
        if statistic in STATISTICS:
            allowed = accuracy * answers.peak(self.register.fields[field].curve())
        else:
            allowed = answers.allowed(expression, accuracy)
        share = np.where(found.error <= SURELY_NOTHING, 0.0, found.error / np.fmax(own, allowed))
        return np.where(np.isfinite(found.value), share, 0.0)


def numbers_for_trains(made: Machine) -> dict[str, np.ndarray]:
    """Excitation of torsional trains by a machine with the scene's numbers, as one variant: numbers by key.

    Parameters
    ----------
    made : Machine
        With a requested quantity of a train; otherwise the result is empty.
    """
    numbers = Numbers(made._limits, {})
    return made._for_trains(made._measuring(made._measuring.numbers(numbers, 1)), numbers, 1)


def seconds_of_runs(made: Machine, varied: Mapping[str, np.ndarray]) -> float:
    """Forecast computing time of one variant's runs on elastic shafts [s], averaged over variants; 0 without runs.

    Parameters
    ----------
    made : Machine
    varied : mapping of path to ndarray (variants,)
        As in `Machine.evaluate`.
    """
    if made._drives is None or not made._drives.runs:
        return 0.0
    arrays, status = given_numbers(made._limits, made.varied, varied, None)
    well = np.flatnonzero(status == Verdict.OK)
    numbers = Numbers(made._limits, arrays)
    return made._drives.seconds_of_runs(numbers.of_variants(well), well.size) if well.size else 0.0
