"""A study: its variants, its machine, and the identity of its results."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from typing import NamedTuple

import numpy as np

from engine import ElementsAlone, Machine, TextExpression, made_ready
from sweeps.study.sensitivity import Sensitivity
from sweeps.study.study_content import StudyContent
from sweeps.study.study_record import study_digest
from sweeps.text.conditions import Condition, Values, errors_in, value_with_error


class Requirements(NamedTuple):
    """Conditions on a variant's parameters, and their derivation.

    Attributes
    ----------
    conditions : sequence of Condition
    derived : mapping of str to TextExpression
        Derived parameters by path, in order, for propagating rounding.
    fixed : mapping of str to float
        Numbers of the scene (SI).
    """

    conditions: Sequence[Condition]
    derived: Mapping[str, TextExpression]
    fixed: Mapping[str, float]

    def misses(self, values: Mapping[str, np.ndarray], count: int) -> np.ndarray:
        """Which variants fail which condition, within rounding.

        Parameters
        ----------
        values : mapping of str to float or ndarray (count,)
            Parameters of the variants (SI).
        count : int
            Number of variants.

        Returns
        -------
        ndarray (conditions, count) of bool
        """
        known = self.known(values) if self.conditions else ({}, {})
        found = [~condition.judged(*known, count).met for condition in self.conditions]
        return np.array(found, bool).reshape(len(self.conditions), count)

    def known(self, columns: Mapping[str, np.ndarray]) -> tuple[Values, Values]:
        """Values and error estimates of all names in conditions.

        Parameters
        ----------
        columns : mapping of str to float or ndarray
            Of some variants (SI), estimates in NAME_error; including the sources of derived parameters.
        """
        values, errors = {**self.fixed, **columns}, errors_in(columns)
        with np.errstate(all="ignore"):
            for path, expression in self.derived.items():
                if path in columns:
                    errors[path] = value_with_error(expression.tree, values, errors)[1]
        return values, errors

    def behind(self, names: Iterable[str]) -> tuple[str, ...]:
        """Some names and their sources, if derived.

        Parameters
        ----------
        names : iterable of str
        """
        found = list(names)
        for path, expression in reversed(self.derived.items()):
            found += expression.names if path in found else ()
        return tuple(dict.fromkeys(found))


class Study(StudyContent):
    """A study's content with its variants and machine."""

    def __repr__(self) -> str:
        axes = " × ".join(f"{axis.size} {', '.join(axis.names)}" for axis in self.design.axes)
        asked = ", ".join((*self.summaries, *self.fields))
        return (
            f"<Study {self.title or self.name!r}: {self.design.size} variants{f' of {axes}' if axes else ''}; {asked}>"
        )

    def __getstate__(self) -> dict[str, object]:
        # Cached results and compiled code aren't pickled.
        return {attribute.name: getattr(self, attribute.name) for attribute in fields(self)}

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """Derivatives and tolerance bands of the variants.

        Raises
        ------
        AskError
            Something requested doesn't exist or has no derivative.
        """
        return Sensitivity(self)

    def machine(self) -> Machine | ElementsAlone:
        """The machine (or machine elements) of the study, cached.

        Raises
        ------
        AskError
            A requested summary or field doesn't exist.
        """
        return self._machine

    @cached_property
    def _machine(self) -> Machine | ElementsAlone:
        return made_ready(
            self.scene,
            self.summaries,
            self.fields,
            self.paths,
            self.positions,
            np.dtype(self.field_precision).type,
            self.accuracy,
        )

    def values(self, start: int, stop: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Parameters of the variants start … stop − 1 (SI) and which of them are dropped by a condition.

        They are independent of the block size.
        """
        values, missed = self.values_and_misses(start, stop)
        return values, missed.any(axis=0)

    def values_and_misses(self, start: int, stop: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Parameters of the variants start … stop − 1 (SI), and which of them fail which condition of `require`."""
        return self.completed(self.design.values(start, stop), stop - start)

    def completed(self, varied: Mapping[str, np.ndarray], count: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Varied and derived parameters of `count` variants, and which fail which condition."""
        values = dict(varied)
        for path, expression in self.derived.items():
            values[path] = np.broadcast_to(expression.evaluate(self.fixed | values), (count,)).astype(float)
        return values, self.requirements.misses(values, count)

    @cached_property
    def requirements(self) -> Requirements:
        """Requirements on parameters."""
        return Requirements(self.require, self.derived, self.fixed)

    @property
    def digest(self) -> str:
        """Name of the study's content, as for `study_digest`."""
        return study_digest(self)
