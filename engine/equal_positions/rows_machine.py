"""A machine evaluated over equally spaced positions: what is not yet measured on the cycle."""

import math
from collections.abc import Iterable, Mapping

import numpy as np

from engine.compiling.jit import run_kernel, threads
from engine.elements.element_columns import ElementColumns, element_summaries
from engine.equal_positions.analyses import Analyses
from engine.equal_positions.shared_shapes import shared_shapes
from engine.equal_positions.text.demand import Demand
from engine.equal_positions.text.kernel_text import SINGULAR_SINE, Form
from engine.equal_positions.text.kernels import KernelWriter, Source
from engine.flywheels.wheel import wheel_columns, wheel_summaries
from engine.laws.tables import table_value
from engine.machine.checks import check_names, check_positions, given_numbers
from engine.machine.model import Model
from engine.machine.quantities.quantities import STATISTICS, Quantity, has_cycle
from engine.machine.results import AskError, Outcome, blank, field_room, front_of
from engine.mechanism.mechanics import Mechanics
from engine.motion.quantities import cycle_statistics, kept_from, motion_fields, motion_summaries
from engine.motion.regimes_in_order import Schedule
from engine.scene.parts import CrankInput
from engine.scene.scene import Numbers, Scene, scene_numbers
from engine.verdicts import Verdict

ROUNDING = 16


class RowsMachine:
    """A scene with what is asked of it: fields and summaries.

    Parameters
    ----------
    scene : Scene
    summaries, fields : iterable of str
        Names from `available_summaries` and `available_fields`.
    varied : iterable of str
        Paths of the scene's numbers that `evaluate` will be given.
    positions : int
        Intervals per cycle (or over the input's range), even, at least 8.
    dtype : float64 or float32

    Raises
    ------
    SceneError
        The scene can't be ordered into structural groups.
    AskError
        Something asked doesn't exist.

    Examples
    --------
    >>> from engine import Scene
    >>> scene = Scene.model_validate({
    ...     "points": {"O": {"x": 0, "y": 0}},
    ...     "guides": {"way": {}},
    ...     "input": {"type": "crank", "pivot": "O", "pin": "A", "length": "50 mm", "speed": "60 rpm"},
    ...     "groups": {"g": {"type": "RRP", "inner": "B",
    ...                      "first": {"link": "rod", "joint": "A", "length": "200 mm"},
    ...                      "second": {"link": "ram", "guide": "way"}}},
    ... })
    >>> outcome = RowsMachine(scene, summaries=["ram.stroke"]).evaluate({})
    >>> round(float(outcome.summaries["ram.stroke"][0]), 12)
    0.1
    """

    # The form that shows what is evaluated.
    form: Form = "whole"

    def __init__(
        self,
        scene: Scene,
        summaries: Iterable[str] = (),
        fields: Iterable[str] = (),
        varied: Iterable[str] = (),
        positions: int = 720,
        dtype: type = np.float64,
    ) -> None:
        self.scene, self.positions, self.dtype = scene, positions, np.dtype(dtype)
        self.varied = tuple(varied)
        self._motion_quantities = {q.name: q for q in motion_summaries(scene)}
        self.mechanics = Mechanics(scene, frozenset(self.varied))
        self._motion_fields = {q.name: q for q in motion_fields(self.mechanics)}
        # Fields of the kernel first, so that they lie together in memory.
        self.asked_summaries = list(summaries)
        self.asked_fields = sorted(fields, key=lambda name: name in self._motion_fields)
        check_positions(positions)
        self._limits = scene_numbers(scene)
        check_names(self.varied, self._limits, "number of the scene")
        if isinstance(scene.input, CrankInput) and {"input.start", "input.stop"} & set(self.varied):
            raise AskError("input.start and input.stop of a crank are the same for all variants; vary another number")
        self.model = Model(scene, frozenset(self.varied))
        for name, message in kept_from(self.mechanics, (*self.asked_summaries, *self.asked_fields)):
            raise AskError(f"{name}: {message}")
        check_names(self.asked_fields, self.available_fields, "field")
        self.analyses = Analyses(self.model)
        self._add_statistics()
        check_names(self.asked_summaries, self.available_summaries, "summary")
        self._wheel = [name for name in self.asked_summaries if name in self.wheel_quantities]
        self._elements = ElementColumns(scene, self.asked_summaries)
        apart = {*self._wheel, *self._elements.names, *self._motion_quantities}
        computed = [n for n in self.asked_summaries if n not in apart]
        self.schedule = self._schedule()
        needs = [*(self.wheel_needs if self._wheel else ()), *(self._motion_needs if self.schedule else ())]
        self._computed = list(dict.fromkeys([*computed, *needs]))
        self._kernel_fields = [name for name in self.asked_fields if name not in self._motion_fields]
        self._computed += self._jams
        self._writer = self._make_writer()
        self._sources: dict[Form, Source] = {}
        self.forms_used: set[Form] = set()

    def _make_writer(self) -> KernelWriter:
        return KernelWriter(self.model, self.analyses, self._kernel_fields, self._computed)

    @property
    def available_fields(self) -> dict[str, Quantity]:
        """Every field one may ask of this scene."""
        return self.model.fields | self._motion_fields

    @property
    def available_summaries(self) -> dict[str, Quantity]:
        """Every summary one may ask, besides the statistics of fields: FIELD.max, FIELD.rms, … (see STATISTICS)."""
        elements = {q.name: q for q in element_summaries(self.scene)}
        return self.analyses.summaries | self.wheel_quantities | self._motion_quantities | elements

    def _schedule(self) -> Schedule | None:
        """The regimes, where anything of them is asked."""
        asked = {n for n in (*self.asked_summaries, *self.asked_fields) if n in self._motion_quantities}
        asked |= set(self.asked_fields) & set(self._motion_fields)
        return Schedule(self.mechanics, asked, self.positions) if asked else None

    @property
    def _motion_needs(self) -> list[str]:
        """Summaries that show whether every group which takes part in the motion can be assembled."""
        for field in ("reduced_inertia", "reduced_moment"):
            self.analyses.add_statistics(self.model.fields[field])
        loaded = self.schedule.loads.groups if self.schedule.loads else ()
        return ["reduced_inertia.min", "reduced_moment.mean", *(f"{group}.transmission_angle" for group in loaded)]

    @property
    def _jams(self) -> list[str]:
        """Where each group jams whose friction is needed."""
        if not self.scene.friction:
            return []
        return [f"jams__{g}" for g in Demand(self.model, self.analyses, self._kernel_fields, self._computed).settled]

    @property
    def wheel_quantities(self) -> dict[str, Quantity]:
        """Summaries of the flywheel as a wheel, computed from others after the kernel."""
        return {q.name: q for q in wheel_summaries(self.scene)}

    @property
    def wheel_needs(self) -> tuple[str, str]:
        """Summaries that a wheel is made for: its inertia and the greatest speed."""
        return ("flywheel_used", "speed_max")

    @property
    def groups(self) -> tuple[str, ...]:
        """Structural groups that are evaluated, in the order that `Outcome.status_group` counts."""
        return self.source(self.form).groups

    @property
    def nodes(self) -> np.ndarray:
        """Input positions: crank angles [rad], or displacement as a fraction of the range of a sliding input."""
        drive = self.scene.input
        if has_cycle(self.scene):
            return np.arange(self.positions) * (2 * math.pi * drive.revolutions / self.positions)
        share = np.arange(self.positions + 1) / self.positions
        if isinstance(drive, CrankInput):
            return drive.start + (drive.stop - drive.start) * share
        return share

    @property
    def has_cycle(self) -> bool:
        """Whether the input turns fully."""
        return has_cycle(self.scene)

    @property
    def input_values(self) -> np.ndarray:
        """Values of the input at the positions of the scene as it is [rad, or m of a sliding input]."""
        drive = self.scene.input
        if isinstance(drive, CrankInput):
            return self.nodes
        return drive.start + (drive.stop - drive.start) * self.nodes

    def _add_statistics(self) -> None:
        for name in self.asked_summaries:
            field, _, suffix = name.rpartition(".")
            if suffix in STATISTICS and field in self._motion_fields:
                self._motion_quantities |= {q.name: q for q in cycle_statistics(self._motion_fields[field])}
            elif suffix in STATISTICS and field in self.available_fields:
                self.analyses.add_statistics(self.available_fields[field])

    def source(self, form: Form) -> Source:
        """Generated source of the kernel, to be read, in its "whole" or "factorised" form."""
        if form not in self._sources:
            self._sources[form] = self._writer.source(form, self.dtype, self.positions)
        return self._sources[form]

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
        varied : mapping of path to ndarray (variants,)
            Values (SI) of the paths named as varied; empty for the scene as it is, one variant.
        drop : ndarray (variants,) of bool, optional
            Variants not to evaluate; their status is DROPPED.
        buffer : ndarray (asked fields, at least variants, positions), optional
            Memory for the fields, from `new_buffer`; the outcome's fields are views of it.

        Raises
        ------
        AskError
            The paths are not those the machine was made for.
        """
        arrays, status = given_numbers(self._limits, self.varied, varied, drop)
        variants = status.size
        keep = np.flatnonzero(status == Verdict.OK)
        room = front_of(self.new_buffer(variants) if buffer is None else buffer, variants)
        outcome = blank(status, self.asked_summaries, dict(zip(self.asked_fields, room, strict=True)))
        if keep.size:
            chosen = {path: values[keep] for path, values in arrays.items()} if keep.size < variants else arrays
            packed = room if keep.size == variants else self.new_buffer(keep.size)
            self._fill(outcome, keep, Numbers(self._limits, chosen), packed)
            if keep.size < variants:
                room[:] = np.nan
                room[:, keep] = packed
        return outcome

    def new_buffer(self, variants: int) -> np.ndarray:
        """Memory for the asked fields of a number of variants; worth reusing from block to block."""
        return field_room((len(self.asked_fields), variants, self.nodes.size), self.dtype)

    def _fill(self, outcome: Outcome, keep: np.ndarray, numbers: Numbers, fields: np.ndarray) -> None:
        """Evaluate the variants `keep`, their fields packed into `fields`, and write their summaries and verdicts."""
        source = self.source(self.form)
        # An overflow on the way to a parameter ends as a status, not as a warning.
        with np.errstate(all="ignore"):
            parameters = self.model.parameters(list(source.slots), numbers, keep.size, self.dtype)
        values, errors, troubles, checks = self._run(parameters, numbers, fields[: len(self._kernel_fields)])
        undefined = ~np.isfinite(values)
        values[undefined] = errors[undefined] = np.nan
        computed = {name: (values[:, i], errors[:, i]) for i, name in enumerate(self._computed)}
        if self._wheel:
            wheels = wheel_columns(self.scene, *(computed[name] for name in self.wheel_needs), numbers)
            computed |= {name: wheels[name] for name in self._wheel}
        for name in self.asked_summaries:
            if name in computed:
                outcome.summaries[name][keep], outcome.errors[name][keep] = computed[name]
        not_finite = ~np.isfinite(checks) | self._undefined(undefined)
        self._judge(outcome, keep, parameters, values, troubles, not_finite)
        self._elements.fill(outcome.status, outcome.summaries, outcome.errors, keep, numbers)
        if self.schedule is not None:
            self._move(outcome, keep, numbers, fields)

    def _run(
        self, parameters: np.ndarray, numbers: Numbers, fields: np.ndarray
    ) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
        """Run the kernel: values and error figures (variants, summaries), troubles and checks (variants,)."""
        form, grouping = self._form(parameters, self.source(self.form))
        self.forms_used.add(form)
        source = self.source(form)
        variants = parameters.shape[1]
        values = np.empty((variants, len(self._computed)))
        errors, troubles, checks = np.empty_like(values), np.empty(variants), np.empty(variants)
        run_kernel(
            source.text,
            "kernel",
            variants if grouping is None else grouping[0].size - 1,
            parameters,
            *self._places(self.nodes.astype(self.dtype)),
            self.dtype.type(self.nodes[1] - self.nodes[0]),
            ROUNDING * float(np.finfo(self.dtype).eps),
            *(grouping or ()),
            *self._tables(source),
            values,
            errors,
            fields,
            troubles,
            checks,
        )
        return values, errors, troubles, checks

    def _move(self, outcome: Outcome, keep: np.ndarray, numbers: Numbers, fields: np.ndarray) -> None:
        """Compute the regimes of the variants `keep` that can be assembled."""
        fields[len(self._kernel_fields) :] = np.nan
        ready = np.flatnonzero(outcome.status[keep] == Verdict.OK)
        if not ready.size:
            return
        answers = self.schedule.answers(numbers.of_variants(ready), ready.size)
        moved = keep[ready]
        outcome.status[moved] = answers.verdict
        for name in self.asked_summaries:
            if name in self._motion_quantities:
                outcome.summaries[name][moved] = answers.values[name]
                outcome.errors[name][moved] = answers.errors[name]
        for i, name in enumerate(self.asked_fields):
            if name in self._motion_fields:
                fields[i, ready] = answers.fields[name]
        missing = np.zeros(ready.size, bool)
        for name, value in answers.values.items():
            # Nothing drives a machine that runs down: it has no efficiency.
            if not name.endswith(".efficiency"):
                missing |= ~np.isfinite(value)
        outcome.status[moved[missing & (answers.verdict == Verdict.OK)]] = Verdict.NOT_FINITE

    def _places(self, nodes: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Positions and their cosines and sines, one table for all variants."""
        return nodes, np.cos(self.nodes).astype(self.dtype), np.sin(self.nodes).astype(self.dtype)

    def _form(self, parameters: np.ndarray, source: Source) -> tuple[Form, tuple[np.ndarray, np.ndarray] | None]:
        """Which form to use: factorised where each shape serves several variants and loads only enter sums."""
        grouping = None
        if self._writer.demand.separable:
            grouping = shared_shapes(parameters[: source.shape_slots], 4 * threads())
        return ("whole" if grouping is None else "factorised"), grouping

    def _tables(self, source: Source) -> list[object]:
        arguments: list[object] = []
        for name in source.tables:
            table = self.model.moments.tables[name]
            arguments += [table.breaks, table.coefficients, table.start, table.period]
        for name in source.angle_tables:
            table = self.model.moments.angle_tables[name]
            arguments.append(np.array([table_value(*table, q) for q in self.nodes], self.dtype))
        return arguments

    # Verdicts

    def _judge(
        self,
        outcome: Outcome,
        keep: np.ndarray,
        parameters: np.ndarray,
        values: np.ndarray,
        troubles: np.ndarray,
        not_finite: np.ndarray,
    ) -> None:
        """Give every variant its verdict, and those that fail the place and the group to blame."""
        least = SINGULAR_SINE[self.dtype]
        # NaN where something isn't finite, whatever the reason.
        doubtful = np.flatnonzero(~(troubles == 0))
        if doubtful.size:
            places, sines = np.empty((doubtful.size, 2), np.int64), np.empty(doubtful.size)
            nodes = self._places(self.nodes.astype(self.dtype))
            # Both forms share the order of slots, and `diagnose` is the same in both.
            text = self.source(self.form).text
            run_kernel(text, "diagnose", doubtful.size, parameters, *nodes, doubtful, places, sines)
            failed = sines < least
            blamed, (groups, at) = keep[doubtful[failed]], places[failed].T
            outcome.status[blamed] = np.where(sines[failed] < 0, Verdict.CANNOT_ASSEMBLE, Verdict.SINGULAR)
            outcome.status_group[blamed] = groups
            outcome.status_at[blamed] = self._at(at, parameters[:, doubtful[failed]])
        self._blame_friction(outcome, keep, parameters, values)
        blamed = keep[not_finite & (outcome.status[keep] == Verdict.OK)]
        outcome.status[blamed] = Verdict.NOT_FINITE

    def _blame_friction(self, outcome: Outcome, keep: np.ndarray, parameters: np.ndarray, values: np.ndarray) -> None:
        """Give jammed variants their verdict, with the place and the group that jams first."""
        columns = {name.removeprefix("jams__"): i for i, name in enumerate(self._computed) if name.startswith("jams__")}
        for group, column in columns.items():
            others = np.delete(values[:, list(columns.values())], list(columns).index(group), axis=1)
            first = np.isfinite(values[:, column]) & ~(others < values[:, column : column + 1]).any(axis=1)
            first &= outcome.status[keep] == Verdict.OK
            outcome.status[keep[first]] = Verdict.JAMS
            outcome.status_group[keep[first]] = self.groups.index(group)
            outcome.status_at[keep[first]] = self._jammed_at(values[first, column], parameters[:, first])

    def _jammed_at(self, places: np.ndarray, parameters: np.ndarray) -> np.ndarray:
        """Input positions from what `jams__…` says of them."""
        return self._at(places.astype(int), parameters)

    def _undefined(self, undefined: np.ndarray) -> np.ndarray:
        """Variants with an undefined summary that should have a value."""
        must = [i for i, n in enumerate(self._computed) if not self.analyses.results[n].may_be_undefined]
        return undefined[:, must].any(axis=1)

    def _at(self, places: np.ndarray, parameters: np.ndarray) -> np.ndarray:
        """Input positions of variants at given indices."""
        if isinstance(self.scene.input, CrankInput):
            return self.nodes[places]
        slots = self.source(self.form).slots
        start, stop = (parameters[slots.index(f"num__input__{key}")] for key in ("start", "stop"))
        return start + (stop - start) * self.nodes[places]
