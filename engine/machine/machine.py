"""A machine prepared for evaluation, of one variant or millions."""

import math
from collections.abc import Iterable, Mapping
from functools import cached_property

import numpy as np

from engine import machine, stepping
from engine.compiling.blocks import LANES
from engine.compiling.threads import on_all_threads, threads
from engine.cycle.measured import UNKNOWN_ROOT, Measured
from engine.graph.nodes import Found, Node, Return, reached
from engine.machine.asked_quantities import ACCURACY_REACHED, POSITIONS_USED, AskedQuantities
from engine.machine.checks import (
    check_positions,
    check_scene,
    check_varied,
    given_numbers,
    names_of,
    relative_accuracy,
    size_remarks,
)
from engine.machine.elements.attached_elements import AttachedElements
from engine.machine.judging.judgement import judge_cycles, judge_runs
from engine.machine.measuring.measured_cycles import MeasuredCycles
from engine.machine.measuring.measuring import Measuring
from engine.machine.results import Outcome, asked_text, blank, field_room, front_of
from engine.mechanism.mechanics import Mechanics
from engine.parts.skeleton import CrankInput
from engine.quantities.expressions import Angle, Expression, Followed, Speed, Work
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.words.quantity import STATISTICS, Quantity
from engine.words.verdicts import Verdict

# Errors of quantities that vanish identically: differences of two roots.
SURELY_NOTHING = 4.0 * UNKNOWN_ROOT
# Variants measured together by a thread, so that their data stays in its caches.
VARIANTS_AT_ONCE = 8192
# Summaries that are relative differences, zero if two numbers agree.
_RELATIVE_ALREADY = ("_difference", "_residual", "_disagreement")
# Summaries that are directions and arcs of a load: zero is a place like any other.
_OF_A_RADIAN = ("load_direction_of_", "unloaded_arc_of_", "unloaded_middle_of_")


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
        self.accuracy, self.varied = relative_accuracy(accuracy), names_of(varied)
        self._limits = scene_numbers(scene)
        check_varied(scene, self.varied, self._limits)
        self.mechanics = Mechanics(scene, frozenset(self.varied))
        asked = AskedQuantities(self.mechanics, summaries, fields, positions, self.accuracy)
        self._asked, self.register, self.regimes = asked, asked.register, asked.regimes
        self._attached = AttachedElements(self.mechanics, asked.computed, self._asked_otherwise)
        self.asked_summaries, self.asked_fields = asked.summaries, asked.fields
        self.kept_at = {name: at for name, at in self.regimes.kept_at.items() if name in asked.fields}
        self.fields_with_error = tuple(name for name in asked.fields if name in self.regimes.fields)

    def _asked_otherwise(self, summaries: Iterable[str], fields: Iterable[str], positions: int) -> "Machine":
        """The machine with other requested quantities."""
        return Machine(self.scene, summaries, fields, self.varied, positions)

    def __repr__(self) -> str:
        return asked_text(self)

    @property
    def available_fields(self) -> dict[str, Quantity]:
        """Every field of this scene."""
        return self._asked.available_fields

    @property
    def available_summaries(self) -> dict[str, Quantity]:
        """Every summary, except the statistics of fields: FIELD.max, FIELD.rms, … (see STATISTICS)."""
        return self._asked.available_summaries

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
        return {name: field.curve() for name, field in self._asked.of_mechanism.items()}

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
    def _kept(self) -> "machine.measuring.kept_fields.KeptFields":
        measuring = self._measuring
        return machine.measuring.kept_fields.KeptFields(
            list(self._kept_curves.values()), measuring.functions, self.dtype
        )

    @cached_property
    def _measuring(self) -> Measuring:
        """Functions and plan for all measurements; they also decide whether the regimes' groups can be assembled."""
        expressions = [summary.expression() for summary in self._asked.measured.values()]
        expressions += self._attached.harmonics
        followed, grid = list(self._followed.values()), (self.positions, self.nodes.size)
        kept = [machine.measuring.kept_fields.field_node(c) for c in self._kept_curves.values()]
        return Measuring(self.mechanics, expressions, kept, followed, grid, self.accuracy, self._moving)

    @cached_property
    def _returns(self) -> list[Return]:
        """Conditions on which everything requested returns to its initial value."""
        return self.mechanics.returns_of([*self._measuring.curves, *self._moving])

    @property
    def _moving(self) -> list[Node]:
        """Position-dependent nodes required by regimes and elastic drives."""
        return [*self.regimes.nodes, *self._attached.nodes]

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
        outcome = blank(status, self._asked.computed, fields, self.fields_with_error)
        if keep.size:
            self._fill(outcome, room, keep, whole if keep.size == variants else whole.of_variants(keep))
        if self._asked.warnings:
            self._asked.warnings.fill(outcome.status, outcome.summaries, outcome.errors, whole)
        remarks = () if (status == Verdict.OK).any() else size_remarks(self._limits, arrays)
        outcome = outcome.with_summaries(self.asked_summaries)._replace(units=self._asked.units, remarks=remarks)
        return outcome.with_names(self._asked.other_names)

    def _fill(self, outcome: Outcome, room: np.ndarray, keep: np.ndarray, numbers: Numbers) -> None:
        """Evaluate the variants `keep`, and write their summaries, fields and verdicts."""
        if self.has_regimes:
            stepping.system.compile_walks_ahead()
        # Whole blocks of lanes for each thread.
        batch = min(-(-keep.size // (threads() * LANES)) * LANES, VARIANTS_AT_ONCE)
        batches = [slice(first, first + batch) for first in range(0, keep.size, batch)]
        measured = on_all_threads(
            lambda some: self._measure(outcome, room, keep[some], numbers.of_variants(some)), batches
        )
        panels, excess, excitation = zip(*measured, strict=True)
        self._attached.fill_all(outcome, keep, numbers, self.groups, excitation)
        if self.has_regimes:
            self._move(outcome, keep, numbers)
        self._note_accuracy(outcome, keep, np.concatenate(panels), np.concatenate(excess))

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
        excitation : dict of str to ndarray
            Excitation of torsional trains.
        """
        table = self._measuring.numbers(numbers, keep.size)
        answers = self._measuring(table)
        undefined, excess = np.zeros(keep.size, bool), np.zeros(keep.size)
        own = slice(keep[0], keep[-1] + 1) if keep[-1] - keep[0] == keep.size - 1 else keep
        for (name, summary), expression in zip(self._asked.measured.items(), self._measuring.expressions, strict=False):
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
        if self._asked.of_mechanism:
            undefined |= ~self._keep(room, keep, table, answers)
        judge_cycles(self._measuring, numbers, table, answers, undefined, outcome, keep)
        failed = keep[outcome.status[keep] != Verdict.OK]
        if failed.size:
            for name in self._asked.measured:
                outcome.summaries[name][failed] = outcome.errors[name][failed] = np.nan
        return answers.outcome.panels, excess, self._attached.excitation(answers, numbers, keep.size)

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
        if in_order is None or self._asked.measured or self._asked.of_mechanism or self._attached.need_machine:
            return False
        strokes = any(isinstance(node, Found) for node in reached(self._moving))
        return in_order.steady.isdisjoint(in_order.needed) and not strokes and not self._measuring.windings

    def _keep(self, room: np.ndarray, keep: np.ndarray, table: np.ndarray, answers: MeasuredCycles) -> np.ndarray:
        """Fill the kept fields; return which variants have finite values only."""
        finite = np.ones(keep.size, bool)
        if self._kept_curves:
            ends = self._measuring.ends if self._ranges_vary else machine.measuring.kept_fields.NONE
            # Input positions, or shares of each variant's range.
            positions = self.nodes if self._ranges_vary else self.input_values
            finite = self._kept.fill(table, positions, room[: len(self._kept_curves)], keep, ends)
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
        the field's peak, others by their error if these curves were off by the permitted accuracy, the direction of a
        load by a radian. Positions of extremes don't count: at a flat extreme the position is hardly defined, and
        nothing depends on it.
        """
        accuracy, (field, _, statistic) = self.accuracy or 1.0, name.rpartition(".")
        of_one = name.endswith(_RELATIVE_ALREADY) or statistic.startswith(_OF_A_RADIAN)
        own = accuracy * (1.0 if of_one else np.abs(found.value))
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
    return made._attached.excitation(made._measuring(made._measuring.numbers(numbers, 1)), numbers, 1)


def seconds_of_runs(made: Machine, varied: Mapping[str, np.ndarray]) -> float:
    """Forecast computing time of one variant's runs on elastic shafts [s], averaged over variants; 0 without runs.

    Parameters
    ----------
    made : Machine
    varied : mapping of path to ndarray (variants,)
        As in `Machine.evaluate`.
    """
    drives = made._attached.drives
    if drives is None:
        return 0.0
    arrays, status = given_numbers(made._limits, made.varied, varied, None)
    well = np.flatnonzero(status == Verdict.OK)
    return drives.seconds_of_runs(Numbers(made._limits, arrays).of_variants(well), well.size)
