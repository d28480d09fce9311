"""A result file: selection of variants by conditions, and the best among them."""

from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

import engine
from sweeps.report.recorded.result_file import ResultFile
from sweeps.study.study import Requirements
from sweeps.study.study_content import number_units
from sweeps.study.study_text import Best
from sweeps.text.conditions import Condition, Judgement, Values, Where, all_of, parts_of
from sweeps.text.input_files import InputError

# Closer to an end of a range than this share of it counts as at the end; samples hardly ever hit it exactly.
AT_END, NEAR_END = 1e-6, 0.01


class RangeEnd(NamedTuple):
    """The end of a variable's range, "minimum" or "maximum", of a sample perhaps "near the maximum", and the range."""

    word: str
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class SweepResult(ResultFile):
    """A result file whose variants can be selected, compared and judged.

    Attributes
    ----------
    path, study
        As in `ResultFile`.
    where : str or sequence of str, optional
        Conditions in place of the study's.
    """

    where: Where = None

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
            condition = Condition.parse(all_of(where))
            self.need(condition.names, "where", known)
            for part in condition.parts:
                part.check(engine.dimensions_by_unit(known))
        except engine.ExpressionError as error:
            raise InputError.of(str(self.path), str(error), key="where") from None

        return lambda part: condition.judged(*self.known(part, condition.names), self.columns["status"][part].size)

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

    def range_ends(self, variant: int) -> dict[str, RangeEnd]:
        """Variables of a variant at an end of their range, without those that a condition fixes.

        A wider range may give a better answer. Lists of two are omitted, since one value is always at an end.

        Parameters
        ----------
        variant : int
        """
        parts = parts_of(self.aim.where if self.aim else None)
        fixed = {name for part in parts if part.is_equality for name in part.names}
        axes = [] if "search" in self.record else self.record["vary"]
        sampled = {name for axis in axes if axis["kind"] == "Sampled" for name in axis["names"]}
        found = {}
        for name, (low, high) in self.ranges.items():
            value = float(self.columns[name][variant])
            word, gap = min(("minimum", value - low), ("maximum", high - value), key=lambda end: end[1])
            if name not in fixed and low < high and gap <= (NEAR_END if name in sampled else AT_END) * (high - low):
                found[name] = RangeEnd(word if gap <= AT_END * (high - low) else f"near the {word}", low, high)
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
