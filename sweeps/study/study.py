"""A study: its variants, its machine, and the identity of its results."""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from functools import cached_property
from typing import NamedTuple

import numpy as np

import engine
from sweeps.study.sensitivity import RSS, WORST_CASE, Sensitivity
from sweeps.study.study_content import ReadyMachine, StudyContent, number_units
from sweeps.study.study_record import study_digest
from sweeps.text.conditions import Condition, UnknownNameError, Values, errors_in, value_with_error


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
    derived: Mapping[str, engine.TextExpression]
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
        size = engine.counted(self.design.size, "variant")
        return f"<Study {self.title or self.name!r}: {size}{f' of {axes}' if axes else ''}; {asked}>"

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

    def machine(self) -> ReadyMachine:
        """The machine (or machine elements) of the study, cached.

        Raises
        ------
        AskError
            A requested summary or field doesn't exist.
        """
        return self._machine

    @cached_property
    def _machine(self) -> ReadyMachine:
        asked, dtype = (self.summaries, self.fields, self.paths, self.positions), np.dtype(self.field_precision).type
        return engine.made_ready(self.scene, *asked, dtype, self.accuracy)

    def values(self, start: int, stop: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Parameters of the variants start … stop − 1 (SI) and which of them are dropped by a condition.

        They are independent of the block size.
        """
        values, missed = self.completed(self.design.values(start, stop), stop - start)
        return values, missed.any(axis=0)

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


def check_study(study: object) -> None:
    """Check that a study is run.

    Raises
    ------
    AskError
        It is another object, such as the name of a file.
    """
    if not isinstance(study, Study):
        raise engine.AskError(f"{study!r} is not a study; read one from a file by sweeps.read_study('study.toml')")


class KnownNames:
    """Names in goals and conditions of a study: numbers, and results, which are thereby requested.

    Attributes
    ----------
    units : dict of str to str
        SI unit of each; "" if unknown.
    summaries : tuple of str
        Those of the study, then the requested ones.
    """

    def __init__(self, study: Study) -> None:
        self.study, self._summaries = study, dict.fromkeys(study.summaries)
        self.units = number_units(study.scene) | {name: study.unit(name) for name in study.parameters}
        self.units |= {quantity.name: quantity.units for quantity in study.sensitivity.quantities}
        self._numbers = {**self.units}
        self.units |= {name: quantity.units for name, quantity in study.machine().available_summaries.items()}

    @property
    def summaries(self) -> tuple[str, ...]:
        """Requested summaries."""
        return tuple(self._summaries)

    def request(self, name: str) -> None:
        """Request a result, unless it is there.

        Raises
        ------
        UnknownNameError
            It is neither a number nor a result.
        """
        if name in self._numbers or name in self._summaries:
            return
        of, _, ending = name.rpartition(".")
        if self.study.tolerances and ending in (WORST_CASE, RSS):
            self.request(of)
            self.units[name] = self.units[of]
            return
        if name not in self.units:
            try:
                self.units[name] = engine.made_ready(self.study.scene, [name]).available_summaries[name].units
            except engine.AskError as error:
                near = engine.nearest_names(name, self._numbers)
                hint = f"; did you mean the number {near[0]!r}?" if near else ""
                raise UnknownNameError(f"{error}{hint}") from None
        self._summaries[name] = None

    def request_goal(self, name: str) -> None:
        """Request the name of an objective, unless it is there.

        Raises
        ------
        ExpressionError
            It is neither a number nor a result, or the same for all variants.
        """
        if not isinstance(engine.parse_expression(name, engine.any_quantity).tree, str):
            raise engine.ExpressionError(f"{name!r}: [best] takes one name; write an expression in [optimise]")
        self.request(name)
        if name in self.study.fixed and name not in self.study.parameters:
            raise engine.ExpressionError(
                f"{name!r} is the same for all variants: vary it, or name another number or result"
            )

    def condition(self, text: str) -> Condition:
        """Read a condition, and request the results in it.

        Raises
        ------
        ExpressionError
            As for `Condition.read`.
        """
        condition = Condition.parse(text)
        for name in condition.names:
            self.request(name)
        condition.check(engine.dimensions_by_unit({name: self.units[name] for name in condition.names}))
        return condition
