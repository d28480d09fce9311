"""A study: a scene, what varies in it, what is asked of it; from a text file or from Python."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from engine import (
    AskError,
    ElementsAlone,
    ExpressionError,
    Machine,
    Scene,
    SceneError,
    TextExpression,
    described_dimension,
    dimensions_by_unit,
    made_ready,
    scene_numbers,
)
from sweeps.study.default_summaries import default_summaries
from sweeps.study.sampling import Design
from sweeps.study.search_task import task_of
from sweeps.study.sensitivity import AskedDerivative, Sensitivity, refusals
from sweeps.study.study_reader import StudyReader
from sweeps.study.study_record import study_digest
from sweeps.study.study_text import Best, Optimise, StudyText, ToleranceText
from sweeps.text.conditions import Condition, UnknownNameError, value_with_error
from sweeps.text.input_files import InputError, read_text
from sweeps.text.scene_text import scene_from
from sweeps.text.toml_text import line_of, parse_toml


class Requirements(NamedTuple):
    """What parameters of a variant must meet, and how they follow from each other.

    Attributes
    ----------
    conditions : sequence of Condition
    derived : mapping of str to TextExpression
        How some parameters follow from others, by path, in order: rounding is carried through these.
    fixed : mapping of str to float
        Numbers of the scene (SI).
    """

    conditions: Sequence[Condition]
    derived: Mapping[str, TextExpression]
    fixed: Mapping[str, float]

    def misses(self, values: Mapping[str, np.ndarray], count: int) -> np.ndarray:
        """Which variants fail which condition; what differs by rounding is equal.

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
        values, errors = self.fixed | values, {}
        if self.conditions:
            with np.errstate(all="ignore"):
                for path, expression in self.derived.items():
                    errors[path] = value_with_error(expression.tree, values, errors)[1]
        found = [~condition.judged(values, errors, count).met for condition in self.conditions]
        return np.array(found, bool).reshape(len(self.conditions), count)


@dataclass(frozen=True, eq=False, repr=False)
class Study:
    """A scene with what varies in it and what is asked of it.

    Attributes
    ----------
    scene : Scene
    design : Design
        The variants: the product of the axes, the last fastest.
    derived : dict of str to Expression
        Numbers tied to the varied ones, by path.
    require : tuple of Condition
        A variant that fails one is dropped.
    summaries, fields : tuple of str
        What is asked.
    positions : int
    field_precision : {"float64", "float32"}
        In which kept fields are stored; all is computed in float64.
    accuracy : float or None
        Allowed error of every summary, as a share of its magnitude.
    name, title, question, text : str
    scene_text : str
        What the scene was read from, as TOML; "" where it is a part of the study's text.
    best : Best or None
    optimise : Optimise or None
        What a search looks for.
    tolerances : dict of str to ToleranceText
        How far numbers of the machine as built may be off, by path.
    derivatives : tuple of AskedDerivative
        Derivatives of summaries by numbers of the scene or free parameters.
    free_units : dict of str to str
        SI unit of each parameter that is no number of the scene, as CF spells it.
    """

    scene: Scene
    design: Design = field(default_factory=lambda: Design(()))
    derived: Mapping[str, TextExpression] = field(default_factory=dict)
    require: tuple[Condition, ...] = ()
    summaries: tuple[str, ...] = ()
    fields: tuple[str, ...] = ()
    positions: int = 720
    field_precision: str = "float64"
    accuracy: float | None = None
    name: str = "study"
    title: str = ""
    question: str = ""
    text: str = ""
    scene_text: str = ""
    best: Best | None = None
    optimise: Optimise | None = None
    tolerances: Mapping[str, ToleranceText] = field(default_factory=dict)
    derivatives: tuple[AskedDerivative, ...] = ()
    free_units: Mapping[str, str] = field(default_factory=dict)

    def __repr__(self) -> str:
        axes = " × ".join(f"{axis.size} {', '.join(axis.names)}" for axis in self.design.axes)
        asked = ", ".join((*self.summaries, *self.fields))
        return (
            f"<Study {self.title or self.name!r}: {self.design.size} variants{f' of {axes}' if axes else ''}; {asked}>"
        )

    def __getstate__(self) -> dict[str, object]:
        # Machine code isn't sent to other processes, nor whatever else follows from the study.
        return {attribute.name: getattr(self, attribute.name) for attribute in fields(self)}

    @cached_property
    def fixed(self) -> dict[str, float]:
        """Numbers of the scene as it is (SI), by path."""
        return {path: number.value for path, number in scene_numbers(self.scene).items()}

    @cached_property
    def sensitivity(self) -> Sensitivity:
        """Derivatives and tolerance bands of the variants.

        Raises
        ------
        AskError
            Something asked doesn't exist or has no derivative.
        """
        return Sensitivity(self)

    @property
    def paths(self) -> tuple[str, ...]:
        """Numbers of the scene that differ between variants."""
        return tuple(p for p in self.parameters if p in self.fixed)

    @property
    def parameters(self) -> tuple[str, ...]:
        """All varied and derived numbers, free parameters too."""
        return (*self.design.names, *self.derived)

    def unit(self, name: str) -> str:
        """SI unit of a parameter as CF spells it; "" where that isn't known."""
        number = scene_numbers(self.scene).get(name)
        return described_dimension(number.dimension).unit if number else self.free_units.get(name, "")

    def machine(self) -> Machine | ElementsAlone:
        """The machine, or the machine elements alone, that answer the study; made once.

        Raises
        ------
        AskError
            An asked summary or field doesn't exist.
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

        They depend on the study and the variants' numbers alone, not on how variants are split into blocks.
        """
        values, missed = self.values_and_misses(start, stop)
        return values, missed.any(axis=0)

    def values_and_misses(self, start: int, stop: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Parameters of the variants start … stop − 1 (SI), and which of them fail which condition of `require`."""
        return self.completed(self.design.values(start, stop), stop - start)

    def completed(self, varied: Mapping[str, np.ndarray], count: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Varied parameters of `count` variants with those derived from them, and which fail which condition."""
        values = dict(varied)
        for path, expression in self.derived.items():
            values[path] = np.broadcast_to(expression.evaluate(self.fixed | values), (count,)).astype(float)
        return values, Requirements(self.require, self.derived, self.fixed).misses(values, count)

    @property
    def digest(self) -> str:
        """Name of the study's content, as for `study_digest`."""
        return study_digest(self)


def read_study(path: Path | str) -> Study:
    """Study from a TOML file; a scene file is read as a study of one variant.

    Parameters
    ----------
    path : Path or str

    Raises
    ------
    InputError
        Anything wrong with the text, its scene, its axes, expressions or outputs.
    """
    path = Path(path)
    text = read_text(path)
    data = parse_toml(text, path.name)
    if not data:
        message = "is empty; `sweeps new slider_crank` writes a scene to start from"
        raise InputError(str(path), [(None, "", message)])
    if not data.keys() & {*StudyText.model_fields, *Scene.model_fields}:
        message = "is neither a study (it has no key 'scene') nor a scene (it has no table 'input')"
        raise InputError(str(path), [(None, "", message)])
    if "scene" not in data and data.keys() & (Scene.model_fields.keys() - StudyText.model_fields.keys()):
        scene = scene_from(data, text, path.name, path.parent)
        study = Study(
            scene, summaries=default_summaries(scene), name=path.stem, title=scene.title, text=text, scene_text=text
        )
    else:
        study = Study(**StudyReader(path, text, data).content())
    return _checked(study, path)


def _check_where(study: Study, machine: Machine | ElementsAlone, where: str) -> None:
    """See that a condition can be judged by what the result will hold."""
    units = {name: study.unit(name) for name in study.parameters}
    units |= {name: machine.available_summaries[name].units for name in study.summaries}
    units |= {quantity.name: quantity.units for quantity in study.sensitivity.quantities}
    try:
        Condition.read(where, dimensions_by_unit(units))
    except UnknownNameError as error:
        raise ExpressionError(f"{error}; name it under outputs.summaries to have it") from None


def _checked(study: Study, path: Path) -> Study:
    """The study, if everything asked of it exists."""
    try:
        machine = study.machine()
        if found := refusals(study):
            raise InputError(path.name, [(line_of(study.text, key.split(".")), key, text) for key, text in found])
        if study.best and study.best.where:
            _check_where(study, machine, study.best.where)
    except AskError as error:
        key = next((k for k in ("accuracy", "positions", "vary") if k in str(error)), "outputs")
        if study.best and str(error).startswith(repr(study.best.goal)):
            key = f"best.{'maximise' if study.best.minimise is None else 'minimise'}"
        raise InputError(path.name, [(line_of(study.text, key.split(".")), key, str(error))]) from None
    except SceneError as error:
        problems = [(line_of(study.text, key.split(".")), key, message) for key, message in error.problems]
        raise InputError(path.name, problems) from None
    except ExpressionError as error:
        raise InputError(path.name, [(line_of(study.text, ["best", "where"]), "best.where", str(error))]) from None
    if study.optimise is not None:
        task_of(study)
    return study
