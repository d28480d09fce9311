"""A result file: parameters, summaries, verdicts, and selection of variants."""

from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

import engine
from sweeps.report.recorded_study import recorded_scene, recorded_study
from sweeps.store import FieldAxis, MappedResult
from sweeps.study.study import Requirements, Study
from sweeps.study.study_content import number_units
from sweeps.study.study_text import Best
from sweeps.text.conditions import Condition, Judgement, Values, Where, all_of, parts_of
from sweeps.text.input_files import InputError, check_file
from sweeps.text.scene_text import with_values

# Variants per part in sequential passes.
VARIANTS_AT_A_TIME = 1 << 19
# Variants per part in random access.
CHOSEN_AT_A_TIME = 1 << 14
# Closer to an end of a range than this share of it counts as at the end.
AT_END = 1e-6


class RangeEnd(NamedTuple):
    """The end of a variable's range, "minimum" or "maximum", and the range."""

    word: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class SweepResult:
    """The content of a result file; its fields are read on request.

    Attributes
    ----------
    path : Path
    study : Study, optional
        The study of the file, if known.
    where : str or sequence of str, optional
        Conditions in place of the study's.
    """

    path: Path
    study: Study | None = None
    where: Where = None

    @cached_property
    def file(self) -> MappedResult:
        """The file: its texts, what it says of its columns, and its progress."""
        check_file(self.path)
        return MappedResult(self.path)

    @property
    def altered(self) -> list[str]:
        """Warnings on modified texts that numbers don't depend on."""
        self.file.refuse_damage(())
        return [f"{self.path}: {name} was modified" for name in self.file.edited]

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        """All columns over variants, mapped from the file; use `parts` for many variants."""
        return self.file.numbers()

    @cached_property
    def _fields(self) -> dict[str, np.ndarray]:
        self.file.refuse_damage(("fields",))
        return {name: self.file.columns[name] for name in self.fields}

    def parts(self, size: int | None = None) -> Iterator[slice]:
        """Consecutive slices of variants, of a size; the memory of each is released after use."""
        size = size or VARIANTS_AT_A_TIME
        for start in range(0, self.file.variants, size):
            yield slice(start, min(start + size, self.file.variants))
            self.file.release()

    def release(self) -> None:
        """Release memory, as `parts` does."""
        self.file.release()

    @cached_property
    def units(self) -> dict[str, str]:
        """Unit of every column."""
        return {c.name: c.units for c in self.file.described}

    @cached_property
    def long_names(self) -> dict[str, str]:
        """Meaning of every column."""
        return {c.name: c.long_name for c in self.file.described}

    @cached_property
    def record(self) -> dict[str, Any]:
        """The study as data, see `recorded_study`.

        Raises
        ------
        DamagedError
            The file has no matching study.
        """
        return recorded_study(self.file)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of the variables."""
        return tuple(self.record["parameters"])

    @property
    def varied(self) -> tuple[str, ...]:
        """Independent variables; the others are derived."""
        return tuple(name for axis in self.record["vary"] for name in axis["names"])

    @property
    def summaries(self) -> tuple[str, ...]:
        """Names of the summaries."""
        return tuple(n for n in self.file.flat if f"{n}_error" in self.units)

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields."""
        return tuple(self.file.fields)

    def along(self, field: str) -> FieldAxis:
        """Axis of a field: input positions, or times of a run."""
        self.file.refuse_damage(())
        last = next(c.dims[-1] for c in self.file.described if c.name == field)
        axis = self.file.axes[last]
        words = "input position" if last == "position" else axis["long_name"]
        return FieldAxis(axis["name"], words, axis["units"], self.file.columns[axis["name"]])

    @property
    def accuracy(self) -> float | None:
        """Requested relative accuracy of every summary, if any."""
        return self.record["accuracy"]

    @property
    def done(self) -> int:
        """Number of variants computed or dropped so far."""
        return self.file.variants - self.verdict_counts()[engine.Verdict.NOT_COMPUTED]

    @property
    def finished(self) -> str:
        """When the last variant was computed, "2026-11-28 01:49 UTC"; "" if some are missing."""
        text = self.file.attributes.get("finished", "")
        return f"{text[:16].replace('T', ' ')} UTC" if text else ""

    def verdict_counts(self) -> Counter[engine.Verdict]:
        """Number of variants per verdict."""
        status = self.columns["status"]
        # bincount converts to eight-byte integers.
        there = sum(np.bincount(status[part], minlength=256) for part in self.parts())
        return Counter({verdict: int(there[verdict]) for verdict in engine.Verdict if there[verdict]})

    def first_with(self, verdict: engine.Verdict) -> int | None:
        """Index of the first variant with a verdict, or None."""
        status = self.columns["status"]
        for part in self.parts():
            if (found := status[part] == verdict).any():
                return part.start + int(np.argmax(found))
        return None

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the design's axes, the last fastest; searches have none."""
        if "search" in self.record:
            return (self.file.variants,)
        return tuple(axis["size"] for axis in self.record["vary"]) or (self.file.variants,)

    @property
    def question(self) -> str:
        """The design question of the study."""
        return self.file.attributes.get("question", "")

    @cached_property
    def scene(self) -> engine.Scene:
        """The study's scene, including tables."""
        return recorded_scene(self.record, self.file) if self.study is None else self.study.scene

    @property
    def mechanics(self) -> engine.Mechanics | None:
        """Mechanics of the study's machine, if known."""
        return None if self.study is None else self.study.machine().mechanics

    @cached_property
    def symbols(self) -> dict[str, str]:
        """Textbook symbols of the columns of a mechanism, if known."""
        if self.mechanics is None:
            return {}
        register = self.study.machine().register
        known = {name: register.fields.get(name) or register.summary(name) for name in self.units}
        return {name: quantity.symbol for name, quantity in known.items() if quantity}

    def show_own_units(self) -> None:
        """Display the scene's units, as for `show_units`."""
        engine.show_units(self.record.get("units", {}))

    def variant_values(self, variant: int) -> dict[str, float]:
        """Numbers (SI) of a variant that replace the scene's.

        Raises
        ------
        InputError
            There is no such variant.
        """
        count = self.file.variants
        if not 0 <= variant < count:
            raise InputError.of(str(self.path), f"{variant} is not one of 0 … {count - 1}", key="variant")
        known = engine.scene_numbers(self.scene)
        return {p: float(self.columns[p][variant]) for p in self.parameters if p in known}

    def scene_of(self, variant: int) -> engine.Scene:
        """The scene with the numbers of a variant; errors as for `variant_values` and `with_values`."""
        return with_values(self.scene, self.variant_values(variant))

    @property
    def goal(self) -> Best | None:
        """The objective and conditions."""
        if not self.record["best"]:
            return None
        return Best.model_validate(self.record["best"] | ({"where": all_of(self.where)} if self.where else {}))

    @property
    def condition(self) -> str:
        """Condition on candidates for the best variant, "" for none."""
        return all_of(self.where) or (self.goal.condition if self.goal else "")

    @property
    def aim(self) -> Best | None:
        """The objective and condition; of a search its first objective and all conditions on results."""
        if "search" not in self.record:
            return self.goal
        search = self.record["search"]
        objective = search["objectives"][0]
        return Best(**{objective["way"]: objective["name"]}, where=search["where"])

    def need(self, names: Iterable[str], key: str, known: Iterable[str] = ()) -> None:
        """Refuse names that the result doesn't have, and say where to ask for those that its machine has.

        Parameters
        ----------
        names : iterable of str
        key : str
            The option that names them.
        known : iterable of str, optional
            Names allowed, if not those of the columns.

        Raises
        ------
        InputError
        """
        known = {*(known or self.columns)}
        for name in (name for name in names if name not in known):
            raise InputError.of(str(self.path), self._absence(name, known), key=key)

    def _absence(self, name: str, known: set[str]) -> str:
        summary = "is not in this result: add it to the summaries of [outputs], and run the study again"
        field = f"is a curve: name one of its numbers, such as {name}.max; as a field of [outputs] it can be exported"
        for words, *asked in ((summary, [name]), (field, [], [name])):
            with suppress(engine.AskError, engine.SceneError):
                engine.made_ready(self.scene, *asked)
                return f"{name!r} {words}"
        return engine.unknown_name_message(name, (other for other in known if not other.endswith("_error")))

    def select(
        self, where: Where = None, sort: str | None = None, descending: bool = False, most: int | None = None
    ) -> np.ndarray:
        """Numbers of the computed variants that meet a condition, sorted.

        Parameters
        ----------
        where : str or sequence of str, optional
            Conditions over parameters and summaries, such as "speed_fluctuation < 0.02 and wheel_mass < 900 kg".
        sort : str, optional
            Column to sort by; undefined values come last.
        descending : bool
        most : int, optional
            Maximum number.

        Raises
        ------
        InputError
            The condition can't be read, or names a column that doesn't exist.
        """
        self.need([sort] if sort else (), "sort")
        met, sign = self.meets(where), -1.0 if descending else 1.0
        found: list[tuple[np.ndarray, np.ndarray]] = []
        for part in self.parts():
            here = part.start + np.flatnonzero(met(part))
            found.append((here, here if sort is None else sign * self.columns[sort][here]))
            if most is not None:
                found = [_first(found, most)]
        return _first(found, most)[0]

    def count_meeting(self, where: Where) -> int:
        """Number of computed variants that meet a condition, as for `select`."""
        met = self.meets(where)
        return sum(int(np.count_nonzero(met(part))) for part in self.parts())

    def undecided(self, where: Where) -> int:
        """Number of computed variants for which a condition is undecided within the error estimates.

        Parameters
        ----------
        where : str or sequence of str, optional
            As for `select`.

        Raises
        ------
        InputError
            As for `select`.
        """
        if not where:
            return 0
        status, judged = self.columns["status"], self._judged(where)
        parts = ((status[part] == engine.Verdict.OK) & judged(part).undecided for part in self.parts())
        return sum(int(np.count_nonzero(part)) for part in parts)

    def meets(self, where: Where) -> Callable[[slice | np.ndarray], np.ndarray]:
        """Function that marks computed variants that meet a condition, as for `select`.

        Raises
        ------
        InputError
            As for `select`.
        """
        status = self.columns["status"]
        if not where:
            return lambda part: status[part] == engine.Verdict.OK
        judged = self._judged(where)
        return lambda part: (status[part] == engine.Verdict.OK) & judged(part).met

    def _judged(self, where: Where) -> Callable[[slice | np.ndarray], Judgement]:
        """A condition's judgement of some variants; recomputed, as 1e8 of them would fill memory."""
        known = number_units(self.scene) | self.units
        try:
            self.need(Condition.parse(all_of(where)).names, "where", known)
            condition = Condition.read_all(where, engine.dimensions_by_unit(known))
        except engine.ExpressionError as error:
            raise InputError.of(str(self.path), str(error), key="where") from None

        return lambda part: condition.judged(*self.known(part, condition.names), self.columns["status"][part].size)

    def chosen_parts(self, met: Callable[[slice | np.ndarray], np.ndarray] | None, most: int) -> Iterator[np.ndarray]:
        """Indices of the variants that meet a condition, in parts.

        Parameters
        ----------
        met : callable or None
            From `meets`; None for all variants.
        most : int
        """
        empty = True
        for part in self.parts():
            here = np.arange(part.start, part.stop)
            here = here if met is None else here[met(part)]
            for start in range(0, here.size, most):
                yield here[start : start + most]
                self.release()
                empty = False
        if empty:
            yield np.zeros(0, int)

    def field_rows(self, name: str, chosen: np.ndarray | slice) -> np.ndarray:
        """Rows of a field (chosen, places) of some variants, in memory.

        Raises
        ------
        StoreError
            The fields of the file are damaged.
        """
        rows = np.array(self._fields[name][chosen])
        self.file.release()
        return rows

    def taken(self, chosen: np.ndarray | slice) -> dict[str, np.ndarray]:
        """All columns of some variants, in memory."""
        found = {}
        for name, column in self.columns.items():
            found[name] = np.concatenate([np.array(column[piece]) for piece in self._pieces(chosen)])
        return found

    def _pieces(self, chosen: np.ndarray | slice) -> Iterator[np.ndarray | slice]:
        """Some variants in parts; the memory of each is released after use.

        Each access maps at least a page of the file.
        """
        whole = isinstance(chosen, slice)
        for start in range(0, 1 if whole else max(chosen.size, 1), CHOSEN_AT_A_TIME):
            yield chosen if whole else chosen[start : start + CHOSEN_AT_A_TIME]
            self.file.release()

    def rows(self, part: slice | np.ndarray, names: Iterable[str]) -> dict[str, np.ndarray]:
        """Some columns of some variants, and their error estimates where they have any."""
        pairs = (name for wish in names for name in (wish, f"{wish}_error"))
        return {name: self.columns[name][part] for name in pairs if name in self.columns}

    def known(self, part: slice | np.ndarray, names: Iterable[str]) -> tuple[Values, Values]:
        """Values and error estimates of some variants for conditions on some names, as from `Requirements.known`."""
        return self.requirements.known(self.rows(part, self.requirements.behind(names)))

    def candidates(self, chosen: np.ndarray | slice = slice(None)) -> np.ndarray:
        """Which variants were computed and meet the condition for the best."""
        met = self.meets(self.condition)
        return np.concatenate([met(piece) for piece in self._pieces(chosen)])

    @cached_property
    def requirements(self) -> Requirements:
        """The study's `require`."""
        return Requirements(
            [Condition.parse(text) for text in self.record["require"]],
            {path: engine.parse_expression(text, engine.any_quantity) for path, text in self.record["derive"].items()},
            {path: number.value for path, number in engine.scene_numbers(self.scene).items()},
        )

    def missed(self) -> Iterator[np.ndarray]:
        """Which variants fail which condition of `require` (conditions, variants), in parts.

        Without variants not computed yet. Recomputed from the parameters, as the file only marks dropped variants.
        """
        required = self.requirements
        names = required.behind(name for condition in required.conditions for name in condition.names)
        for part in self.parts():
            found = required.misses(self.rows(part, names), part.stop - part.start)
            yield found & (self.columns["status"][part] != engine.Verdict.NOT_COMPUTED)

    def best(self, goal: Best | None = None) -> int | None:
        """Index of the best variant; None without a goal or candidates.

        Parameters
        ----------
        goal : Best, optional
            Default: the study's.
        """
        goal = goal or self.goal
        if goal is None:
            return None
        chosen = self.select(goal.where, goal.goal, goal.sign < 0, most=1)
        return int(chosen[0]) if chosen.size and np.isfinite(self.columns[goal.goal][chosen[0]]) else None

    def rivals(self, best: int, goal: Best | None = None) -> int:
        """Number of variants that tie with the best within both error estimates.

        Parameters
        ----------
        best : int
        goal : Best, optional
            Default: the study's.
        """
        ties = self._tying(best, goal or self.goal)
        return sum(int(np.count_nonzero(ties(part))) for part in self.parts()) - 1

    def _tying(self, best: int, goal: Best) -> Callable[[slice | np.ndarray], np.ndarray]:
        """Function that marks the best variant and those that tie with it."""
        met, values, errors = self.meets(goal.where), self.columns[goal.goal], self.columns.get(f"{goal.goal}_error")

        def ties(part: slice | np.ndarray) -> np.ndarray:
            gap = goal.sign * (values[part] - values[best])
            return met(part) & (gap <= (0.0 if errors is None else errors[part] + errors[best]))

        return ties

    @property
    def lists(self) -> dict[str, int]:
        """Number of entries of each variable that takes those of a list."""
        axes = self.record["vary"]
        found = {axis["names"][0]: axis["size"] for axis in axes if axis["kind"] == "Listed"}
        return found | {name: len(sizes) for axis in axes for name, sizes in axis.get("sizes", {}).items()}

    @cached_property
    def ranges(self) -> dict[str, tuple[float, float]]:
        """Range of each variable: of a search as given, else over all variants."""
        if "search" in self.record:
            return {span["name"]: (span["low"], span["high"]) for span in self.record["search"]["ranges"]}
        found = {name: (np.inf, -np.inf) for name in self.varied if self.lists.get(name, 3) > 2}
        for part in self.parts():
            for name, (low, high) in found.items():
                here = self.columns[name][part]
                found[name] = min(low, float(here.min())), max(high, float(here.max()))
        return found

    def range_ends(self, variant: int) -> dict[str, RangeEnd]:
        """Variables of a variant at an end of their range, without those that a condition fixes.

        A wider range may give a better answer. Of two listed values one is always at an end, which means nothing.

        Parameters
        ----------
        variant : int
        """
        parts = parts_of(self.aim.where if self.aim else None)
        fixed = {name for part in parts if part.is_equality for name in part.names}
        found = {}
        for name, (low, high) in self.ranges.items():
            value, near = float(self.columns[name][variant]), AT_END * (high - low)
            if name not in fixed and low < high and (value - low <= near or high - value <= near):
                found[name] = RangeEnd("minimum" if value - low <= near else "maximum", low, high)
        return found

    def deciding(self, variant: int) -> frozenset[str]:
        """Names whose error estimates decide whether a variant meets the condition or ties with the best."""
        if variant not in self._deciding:
            self._deciding[variant] = frozenset(self._decided_by_errors(variant))
        return self._deciding[variant]

    @cached_property
    def _deciding(self) -> dict[int, frozenset[str]]:
        return {}

    def _decided_by_errors(self, variant: int) -> Iterator[str]:
        aim, only = self.aim, np.array([variant])
        if aim is None or self.columns["status"][variant] != engine.Verdict.OK:
            return
        for part in parts_of(aim.where):
            if self._judged(part.text)(only).undecided[0]:
                yield from part.names
        best, rivals = self._leader
        if rivals and self._tying(best, aim)(only)[0]:
            yield aim.goal

    @cached_property
    def _leader(self) -> tuple[int, int]:
        """The best variant by the aim, and the number that tie with it; (0, 0) without one."""
        best = self.best(self.aim)
        return (0, 0) if best is None else (best, self.rivals(best, self.aim))


def drop_counts(conditions: int, missed: Iterable[np.ndarray]) -> tuple[np.ndarray, np.ndarray, int]:
    """Number of variants that fail each condition, that fail only it, and that were checked.

    Parameters
    ----------
    conditions : int
        Number of conditions.
    missed : iterable of ndarray of bool (conditions, variants)
        Failed conditions, by parts of the variants.
    """
    counts, alone, seen = np.zeros(conditions, int), np.zeros(conditions, int), 0
    for part in missed:
        counts += part.sum(axis=1)
        alone += (part & (part.sum(axis=0) == 1)).sum(axis=1)
        seen += part.shape[1]
    return counts, alone, seen


def _first(found: list[tuple[np.ndarray, np.ndarray]], most: int | None) -> tuple[np.ndarray, np.ndarray]:
    """The variants with the smallest values, and these values; ties go to the first, undefined values come last."""
    variants, values = (np.concatenate(rows) for rows in zip(*found, strict=True))
    if most is not None and most < values.size:
        # Sorting a million takes a tenth of a second.
        near = ~(values > np.partition(values, most - 1)[most - 1])
        variants, values = variants[near], values[near]
    order = np.argsort(values, kind="stable")[:most]
    return variants[order], values[order]
