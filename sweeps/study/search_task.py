"""The task of a search: objectives, conditions, variables and start, read from a study."""

import hashlib
import json
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

import engine
from sweeps.study.search_variables import Variables
from sweeps.study.sensitivity import Tolerance, read_tolerances
from sweeps.study.study import KnownNames, Study
from sweeps.study.study_text import Optimise
from sweeps.text.conditions import Condition, numeric_expression
from sweeps.text.toml_text import Problems

EVOLUTION, GENETIC, LOCAL = "differential evolution", "NSGA-II", "local"


class Objective(NamedTuple):
    """An objective, minimised (sign +1) or maximised (−1): expression, SI unit and column."""

    name: str
    expression: engine.TextExpression
    sign: float
    units: str

    @property
    def way(self) -> str:
        """Its key in the study."""
        return "minimise" if self.sign > 0 else "maximise"

    @property
    def is_column(self) -> bool:
        """Whether it is a column of the result."""
        return self.name == self.expression.tree


@dataclass(frozen=True, eq=False)
class SearchTask:
    """A search task.

    Attributes
    ----------
    study : Study
        With all required summaries and without fields.
    variables : Variables
    objectives : tuple of Objective
    conditions : tuple of Condition
        Conditions on results, without those on parameters.
    method : {"differential evolution", "NSGA-II", "local"}
    population, generations, seed : int
    start : ndarray (variables,)
        Coordinates of the first candidate.
    tolerances : tuple of Tolerance
    """

    study: Study
    variables: Variables
    objectives: tuple[Objective, ...]
    conditions: tuple[Condition, ...]
    method: str
    population: int
    generations: int
    seed: int
    start: np.ndarray
    tolerances: tuple[Tolerance, ...]

    @property
    def digest(self) -> str:
        """Name of the search's content."""
        content = [self.study.digest, search_record(self), self.tolerances]
        return hashlib.sha256(json.dumps(content).encode()).hexdigest()


def search_record(task: SearchTask) -> dict[str, Any]:
    """The task in JSON types, for the result file.

    Parameters
    ----------
    task : SearchTask

    Returns
    -------
    dict
        `objectives` (column, direction and expression), `where` (conditions as written), `ranges` (name, low,
        high, logarithmic), `method`, `population`, `generations`, `seed`, and coordinates of the `start`.
    """
    return {
        "objectives": [
            {"name": o.name, "way": o.way, "expression": " ".join(o.expression.text.split())} for o in task.objectives
        ],
        "where": [condition.text for condition in task.conditions],
        "ranges": [span._asdict() for span in task.variables.ranges],
        "method": task.method,
        "population": task.population,
        "generations": task.generations,
        "seed": task.seed,
        "start": task.start.tolist(),
    }


def task_of(study: Study) -> SearchTask:
    """The search task of a study: its [optimise], or its [best] over all variables.

    Raises
    ------
    InputError
        All problems of the task.
    """
    return _TaskReader(study).task()


class _TaskReader:
    """Reads the task from a study, collecting problems with their lines."""

    def __init__(self, study: Study) -> None:
        self.study, self.raw = study, study.optimise or Optimise()
        self.problems = Problems(f"{study.name}.toml", study.text)
        self.names = KnownNames(study)
        self.units = self.names.units

    def task(self) -> SearchTask:
        texts = [
            (key, text, sign) for key, sign in (("minimise", 1.0), ("maximise", -1.0)) for text in self._goals(key)
        ]
        objectives, conditions = [], []
        for number, (key, text, sign) in enumerate(texts, 1):
            with self.problems.noted(engine.ExpressionError, ["optimise", key], text):
                objectives.append(self._objective(text, sign, number))
        for text in self._conditions():
            with self.problems.noted(engine.ExpressionError, ["optimise", "where"], text):
                conditions.append(self.names.condition(text))
        variables = Variables.of(self.study.design)
        method = self.raw.method or (EVOLUTION if len(texts) < 2 else GENETIC)
        self._check_method(method, len(texts), variables)
        start, tolerances = self._start(variables), read_tolerances(self.study.scene, self.study.tolerances)
        self.problems.refuse()
        study = replace(self.study, summaries=self.names.summaries, fields=(), derivatives=(), tolerances={})
        found = (tuple(objectives), tuple(conditions), method)
        numbers = (self.raw.population, self.raw.generations, self.raw.seed)
        return SearchTask(study, variables, *found, *numbers, start, tolerances)

    # Objectives and conditions

    def _goals(self, key: str) -> list[str]:
        raw, best = self.raw, self.study.best
        if raw.minimise or raw.maximise:
            return getattr(raw, key)
        if best is not None:
            return [goal] if (goal := getattr(best, key)) else []
        if key == "minimise":
            message = "no objective: give minimise or maximise, expressions of summaries and parameters"
            self.problems.add(["optimise"], message)
        return []

    def _conditions(self) -> list[str]:
        best, own = self.study.best, self.raw.minimise or self.raw.maximise
        return [*(best.where if best and not own else ()), *self.raw.where]

    def _objective(self, text: str, sign: float, number: int) -> Objective:
        expression = numeric_expression(text)
        if isinstance(expression.tree, str):
            self.names.request_goal(expression.tree)
        for name in expression.names:
            self.names.request(name)
        known = engine.dimensions_by_unit({name: self.units[name] for name in expression.names})
        dimension = None if None in known.values() else engine.dimension_of(expression, known)
        if isinstance(expression.tree, str):
            return Objective(expression.tree, expression, sign, self.units[expression.tree])
        units = "" if dimension is None else engine.unit_of_dimension(dimension) or "1"
        return Objective(f"objective_{number}", expression, sign, units)

    # Method, start, tolerances

    def _check_method(self, method: str, objectives: int, variables: Variables) -> None:
        keys = ["optimise", "method"]
        if not variables.varies or not self.study.paths:
            self.problems.add(["vary"], "nothing varies; give ranges or lists of variables")
        elif method == LOCAL and not variables.free.any():
            message = f"{LOCAL!r} needs ranges, but only lists vary: give low and high, or use {EVOLUTION!r}"
            self.problems.add(keys, message)
        if method == GENETIC and objectives == 1:
            self.problems.add(keys, f"{GENETIC!r} needs several objectives: use {EVOLUTION!r}")
        if method != GENETIC and objectives > 1:
            message = f"{method!r} needs one objective, but there are {objectives}: use {GENETIC!r}, or combine them"
            self.problems.add(keys, message)

    def _start(self, variables: Variables) -> np.ndarray:
        """Coordinates of the start: as given, else of the unmodified scene."""
        given, numbers = {}, engine.scene_numbers(self.study.scene)
        for name, value in self.raw.start.items():
            if name not in variables.names:
                self.problems.add(["optimise", "start", name], engine.unknown_name_message(name, variables.names))
                continue
            with self.problems.noted(engine.UnitError, ["optimise", "start", name]):
                known = name in numbers
                given[name] = engine.in_text(value, numbers[name].dimension) if known else engine.recognised(value)[0]
        place = variables.coordinates(self.study.fixed | given)
        found = variables.values(place[None])
        for name, value in given.items():
            # Allow for rounding in the conversion.
            if not np.isclose(found[name][0], value, rtol=1e-12, atol=0):
                keys, text = ["optimise", "start", name], engine.quantity_text(value, self.units[name])
                self.problems.add(keys, f"{text} is not allowed by vary.{name}; {self._allowed(name, variables)}")
        return place

    def _allowed(self, name: str, variables: Variables) -> str:
        span = next((s for s in variables.spans if s.name == name), None)
        if span is not None:
            low, high = (engine.quantity_text(end, self.units[name]) for end in (span.low, span.high))
            return f"allowed: {low} to {high}"
        axis = next(a for a in variables.choices if name in a.names)
        listed = dict.fromkeys(axis.values(np.arange(axis.size))[name].tolist())
        return f"allowed: {', '.join(engine.quantity_text(value, self.units[name]) for value in listed)}"
