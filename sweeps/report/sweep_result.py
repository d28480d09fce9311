"""A result file as a whole: its parameters, summaries, verdicts, and the choosing among its variants."""

import re
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np

from engine import Scene, Verdict, any_quantity, scene_numbers
from sweeps.store import Description, describe_result, read_columns
from sweeps.study.study import misses
from sweeps.study.study_text import Best
from sweeps.text.dimension_check import check_condition
from sweeps.text.expressions import ExpressionError, parse
from sweeps.text.input_files import InputError
from sweeps.text.names import unknown_name_message
from sweeps.text.scene_text import scene_from
from sweeps.text.toml_text import parse_toml


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

    @property
    def parameters(self) -> tuple[str, ...]:
        """Names of what varies."""
        listed = self.description.attributes.get("parameters", "")
        return tuple(listed.split()) if listed else ()

    @property
    def varied(self) -> tuple[str, ...]:
        """Parameters that vary by themselves; the others are derived from them."""
        return tuple(self.description.attributes.get("varied", "").split())

    @property
    def summaries(self) -> tuple[str, ...]:
        """Names of the summaries."""
        names = [c.name for c in self.description.columns if c.dims == ("variant",)]
        return tuple(n for n in names if f"{n}_error" in self.units)

    @property
    def fields(self) -> tuple[str, ...]:
        """Names of the fields."""
        return tuple(c.name for c in self.description.columns if "position" in c.dims)

    @property
    def accuracy(self) -> float | None:
        """Allowed error of every summary as a share of its magnitude, if one was asked."""
        text = self.description.attributes.get("accuracy", "")
        return float(text) if text else None

    @property
    def done(self) -> int:
        """How many variants have been computed or dropped so far."""
        return int((self.columns["status"] != Verdict.NOT_COMPUTED).sum())

    @property
    def shape(self) -> tuple[int, ...]:
        """Sizes of the axes of the design, the last fastest."""
        sizes = re.findall(r"\[(\d+)\](?= x |$)", self.description.attributes.get("grid", ""))
        return tuple(int(size) for size in sizes) or (self.description.variants,)

    @property
    def position_name(self) -> str:
        """Name of the coordinate over the positions of fields."""
        return self.description.attributes.get("position", "phi")

    @property
    def question(self) -> str:
        """The design question of the study."""
        return self.description.attributes.get("question", "")

    @cached_property
    def scene(self) -> Scene:
        """The scene as the study gives it, tables and all."""
        text = self.description.attributes["scene"]
        return scene_from(parse_toml(text, str(self.path)), text, f"scene in {self.path.name}", self.path.parent)

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
        words = self.description.attributes.get("best", "").split(" ", 2)
        if len(words) < 2:
            return None
        where = words[2].removeprefix("where ") if len(words) == 3 else None
        return Best(**{words[0]: words[1]}, where=where)

    def select(self, where: str | None = None, sort: str | None = None, descending: bool = False) -> np.ndarray:
        """Numbers of the computed variants that meet a condition, sorted.

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
            keep = keep & self._meets(where)
        chosen = np.flatnonzero(keep)
        if sort is not None:
            if sort not in self.columns:
                raise InputError(str(self.path), [(None, "sort", unknown_name_message(sort, self.columns))])
            order = np.argsort(self.columns[sort][chosen], kind="stable")
            chosen = chosen[order[::-1] if descending else order]
        return chosen

    def _meets(self, where: str) -> np.ndarray:
        try:
            condition = parse(where, any_quantity)
            if not condition.is_condition:
                raise ExpressionError(f"{where!r} is a number; a condition such as 'a < b' is needed")
            check_condition(condition, self.units)
            return np.asarray(condition.evaluate(self.columns), bool)
        except ExpressionError as error:
            raise InputError(str(self.path), [(None, "where", str(error))]) from None

    def candidates(self) -> np.ndarray:
        """Which variants were computed and meet the condition for the best one (variants,)."""
        chosen = np.zeros(self.description.variants, bool)
        chosen[self.select(self.goal.where if self.goal else None)] = True
        return chosen

    def missed(self) -> dict[str, np.ndarray]:
        """For each condition of `require`, which variants fail it (variants,); those not computed yet apart.

        Found anew from the parameters, as the file holds only whether a variant was dropped.
        """
        texts = self.description.attributes.get("require", "").splitlines()
        if not texts:
            return {}
        fixed = {path: number.value for path, number in scene_numbers(self.scene).items()}
        conditions = [parse(text, any_quantity) for text in texts]
        found = misses(conditions, fixed | self.columns, self.description.variants)
        found &= self.columns["status"] != Verdict.NOT_COMPUTED
        return dict(zip(texts, found, strict=True))

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
