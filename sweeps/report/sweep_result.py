"""A result file as a whole: its parameters, summaries, verdicts, and the choosing among its variants."""

from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from engine import (
    ExpressionError,
    Scene,
    Verdict,
    any_quantity,
    dimensions_by_unit,
    parse_expression,
    scene_numbers,
    unknown_name_message,
)
from sweeps.report.recorded_study import recorded_scene, recorded_study
from sweeps.store import Description, FieldAxis, describe_result, read_columns
from sweeps.study.study import misses
from sweeps.study.study_text import Best
from sweeps.text.conditions import Condition, Judgement, errors_in
from sweeps.text.engineer_units import show_units
from sweeps.text.input_files import InputError, check_file


@dataclass(frozen=True, eq=False)
class SweepResult:
    """What a result file holds, without its fields.

    Attributes
    ----------
    path : Path
    """

    path: Path

    @cached_property
    def description(self) -> Description:
        """Title, attributes, columns and progress."""
        check_file(self.path)
        return describe_result(self.path)

    @cached_property
    def columns(self) -> dict[str, np.ndarray]:
        """All columns over variants."""
        return read_columns(self.path)

    @cached_property
    def units(self) -> dict[str, str]:
        """Unit of every column."""
        return {c.name: c.units for c in self.description.columns}

    @cached_property
    def long_names(self) -> dict[str, str]:
        """Meaning of every column."""
        return {c.name: c.long_name for c in self.description.columns}

    @cached_property
    def record(self) -> dict[str, Any]:
        """The study as data, see `recorded_study`.

        Raises
        ------
        DamagedError
            The file holds none that fits it.
        """
        return recorded_study(self.description)

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of what varies."""
        return tuple(self.record["parameters"])

    @property
    def varied(self) -> tuple[str, ...]:
        """Parameters that vary by themselves; the others are derived from them."""
        return tuple(name for axis in self.record["vary"] for name in axis["names"])

    @property
    def summaries(self) -> tuple[str, ...]:
        """Names of the summaries."""
        names = [c.name for c in self.description.columns if c.dims == ("variant",)]
        return tuple(n for n in names if f"{n}_error" in self.units)

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields."""
        return tuple(c.name for c in self.description.columns if len(c.dims) > 1)

    def along(self, field: str) -> FieldAxis:
        """What runs along a field: positions of the input, or instants of a run."""
        d = self.description
        last = next(c.dims[-1] for c in d.columns if c.name == field)
        if last == "position":
            name, words, units = d.position_name, "position of the input", d.position_units
        else:
            name, words, units = last, d.axes[last]["long_name"], d.axes[last]["units"]
        return FieldAxis(name, words, units, read_columns(self.path, [name])[name])

    @property
    def accuracy(self) -> float | None:
        """Allowed error of every summary as a share of its magnitude, if one was asked."""
        return self.record["accuracy"]

    @property
    def done(self) -> int:
        """How many variants have been computed or dropped so far."""
        return int((self.columns["status"] != Verdict.NOT_COMPUTED).sum())

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the axes of the design, the last fastest; the candidates of a search form none."""
        if "search" in self.record:
            return (self.description.variants,)
        return tuple(axis["size"] for axis in self.record["vary"]) or (self.description.variants,)

    @property
    def question(self) -> str:
        """The design question of the study."""
        return self.description.attributes.get("question", "")

    @cached_property
    def scene(self) -> Scene:
        """The scene as the study gives it, tables and all."""
        return recorded_scene(self.record, self.description)

    def show_own_units(self) -> None:
        """Show numbers in the units of other systems that the scene was written in, as for `show_units`."""
        show_units(self.record.get("units", {}))

    def variant_values(self, variant: int) -> dict[str, float]:
        """Numbers of the scene (SI) that a variant has in place of the scene's own.

        Raises
        ------
        InputError
            There is no such variant.
        """
        count = self.description.variants
        if not 0 <= variant < count:
            raise InputError(str(self.path), [(None, "variant", f"{variant} is not one of 0 … {count - 1}")])
        known = scene_numbers(self.scene)
        return {p: float(self.columns[p][variant]) for p in self.parameters if p in known}

    @property
    def goal(self) -> Best | None:
        """What decides among the variants."""
        return Best.model_validate(self.record["best"]) if self.record["best"] else None

    def select(self, where: str | None = None, sort: str | None = None, descending: bool = False) -> np.ndarray:
        """Numbers of the computed variants that meet a condition for sure, whatever their error figures allow, sorted.

        Parameters
        ----------
        where : str, optional
            A condition over parameters and summaries, such as "speed_fluctuation < 0.02 and wheel_mass < '900 kg'".
        sort : str, optional
            Column to sort by.
        descending : bool

        Raises
        ------
        InputError
            The condition can't be read, or names a column that isn't there.
        """
        keep = self.columns["status"] == Verdict.OK
        if where:
            keep = keep & self._judged(where).met
        chosen = np.flatnonzero(keep)
        if sort is not None:
            if sort not in self.columns:
                raise InputError(str(self.path), [(None, "sort", unknown_name_message(sort, self.columns))])
            order = np.argsort(self.columns[sort][chosen], kind="stable")
            chosen = chosen[order[::-1] if descending else order]
        return chosen

    def undecided(self, where: str) -> np.ndarray:
        """Numbers of the computed variants whose error figures leave open whether they meet a condition.

        Parameters
        ----------
        where : str
            As for `select`.

        Raises
        ------
        InputError
            As for `select`.
        """
        return np.flatnonzero((self.columns["status"] == Verdict.OK) & self._judged(where).undecided)

    def _judged(self, where: str) -> Judgement:
        try:
            condition = Condition.read(where, dimensions_by_unit(self.units))
        except ExpressionError as error:
            raise InputError(str(self.path), [(None, "where", str(error))]) from None
        return condition.judged(self.columns, errors_in(self.columns), self.description.variants)

    def candidates(self) -> np.ndarray:
        """Which variants were computed and meet the condition for the best one (variants,)."""
        chosen = np.zeros(self.description.variants, bool)
        chosen[self.select(self.goal.where if self.goal else None)] = True
        return chosen

    def missed(self) -> dict[str, np.ndarray]:
        """For each condition of `require`, which variants fail it (variants,); those not yet computed not counted.

        Found anew from the parameters, as the file holds only whether a variant was dropped.
        """
        if not self.record["require"]:
            return {}
        fixed = {path: number.value for path, number in scene_numbers(self.scene).items()}
        conditions = [Condition(parse_expression(text, any_quantity)) for text in self.record["require"]]
        found = misses(conditions, fixed | self.columns, self.description.variants)
        found &= self.columns["status"] != Verdict.NOT_COMPUTED
        return {condition.text: row for condition, row in zip(conditions, found, strict=True)}

    def best(self) -> int | None:
        """Number of the variant that answers the study's question; None without a goal or without candidates."""
        goal = self.goal
        if goal is None:
            return None
        chosen = np.flatnonzero(self.candidates())
        values = goal.sign * self.columns[goal.goal][chosen]
        if not np.isfinite(values).any():
            return None
        return int(chosen[np.nanargmin(values)])

    def rivals(self, best: int) -> int:
        """How many other variants may be as good as the best one, within both error figures."""
        goal = self.goal
        values, errors = self.columns[goal.goal], self.columns[f"{goal.goal}_error"]
        chosen = self.select(goal.where)
        gap = goal.sign * (values[chosen] - values[best])
        return int((gap <= errors[chosen] + errors[best]).sum()) - 1
