"""Reading a study: scene, variables, expressions with dimensions; problems with their lines."""

import math
import re
from collections.abc import Iterable
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from pathlib import Path
from typing import Any

import engine
from sweeps.study import study_text
from sweeps.study.default_summaries import default_summaries
from sweeps.study.sampling import Axis, Columns, Design, Listed, Sampled, SamplingError, Steps
from sweeps.study.search_task import task_of
from sweeps.study.sensitivity import Sensitivity, read_tolerances
from sweeps.study.study import KnownNames, Study
from sweeps.study.study_content import AskedDerivative, number_units
from sweeps.study.variant_tables import read_variant_table
from sweeps.text.conditions import Condition, UnknownNameError, numeric_expression
from sweeps.text.csv_text import TableColumn
from sweeps.text.input_files import InputError, read_text
from sweeps.text.scene_text import scene_from, unknown_number_text, with_numbers
from sweeps.text.toml_text import Problems, line_of, parse_toml, problems_in, validate

# Keys that are attributes of a study.
_AS_GIVEN = ("positions", "field_precision", "accuracy", "question", "best", "optimise", "tolerances")


class StudyReader:
    """Reads the text of a study, collecting problems with their lines.

    Parameters
    ----------
    path : Path
        Path of the study; named files are relative to it.
    text : str
    data : dict
        The parsed text.

    Raises
    ------
    InputError
        Invalid keys, or an invalid scene.
    """

    def __init__(self, path: Path, text: str, data: dict[str, Any]) -> None:
        self.path, self.text, self.folder = path, text, path.parent
        for key, leaves in (
            ("vary", study_text.AXIS_KEYS),
            ("derive", None),
            ("tolerances", study_text.TOLERANCE_KEYS),
        ):
            if isinstance(data.get(key), dict):
                data[key] = study_text.flatten(data[key], leaves)
        if isinstance(data.get("optimise"), dict) and isinstance(data["optimise"].get("start"), dict):
            data["optimise"]["start"] = study_text.flatten(data["optimise"]["start"], None)
        self.raw = validate(study_text.StudyText, data, text, path.name)
        self.scene = self._scene()
        self.raw = validate(study_text.StudyText, self._with_full_names(data), text, path.name)
        self.numbers = engine.scene_numbers(self.scene)
        self.problems = Problems(path.name, text)
        self.dimensions = engine.dimensions_by_unit(number_units(self.scene))

    def _scene(self) -> engine.Scene:
        self.scene_text = ""
        own = {"units": self.raw.units} if self.raw.units else {}
        if isinstance(self.raw.scene, dict):
            return scene_from(self.raw.scene | own, self.text, self.path.name, self.folder, ("scene",))
        path = self.folder / self.raw.scene
        try:
            text = read_text(path)
        except InputError as error:
            raise InputError.of(self.path.name, str(error), line_of(self.text, ["scene"]), "scene") from None
        self.scene_text, data = text, parse_toml(text, path.name)
        if "scene" in data:
            message = f"{path.name} is a study; name the file of a scene, one with a table [input]"
            raise InputError.of(self.path.name, message, line_of(self.text, ["scene"]), "scene")
        return scene_from(data | own, text, path.name, path.parent)

    def _with_full_names(self, data: Any) -> Any:
        """The text's data, forces in joints by their full names."""
        if isinstance(data, str):
            return engine.full_names(self.scene, data)
        if isinstance(data, list):
            return [self._with_full_names(entry) for entry in data]
        if isinstance(data, dict):
            as_given = ("scene", "title", "question", "source")
            return {k: v if k in as_given else self._with_full_names(v) for k, v in data.items()}
        return data

    def content(self) -> dict[str, Any]:
        """The content, by the names of `Study`'s attributes.

        Raises
        ------
        InputError
            All problems with variables and expressions.
        """
        design = self._design()
        names = design.names if design else ()
        # Expressions may use columns of a rejected table of variants: don't report these names, too.
        derived = {} if self.raw.variants and self.problems.found else self._derived(names)
        require, derivatives = self._required(), []
        for text in dict.fromkeys(self.raw.outputs.derivatives):
            with self.problems.noted(engine.AskError, ["outputs", "derivatives"]):
                derivatives.append(AskedDerivative.read(text))
        self.problems.refuse()
        outputs = self.raw.outputs
        summaries = tuple(dict.fromkeys(outputs.summaries))
        if not summaries and not outputs.fields:
            summaries = default_summaries(engine.made_ready(self.scene))
        if self.raw.accuracy is not None:
            summaries = tuple(dict.fromkeys((*summaries, *engine.ACCURACY_SUMMARIES)))
        free = (name for name in (*names, *derived) if name not in self.numbers)
        return {key: getattr(self.raw, key) for key in _AS_GIVEN} | {
            "scene": self.scene,
            "design": design,
            "derived": derived,
            "require": require,
            "summaries": summaries,
            "fields": tuple(dict.fromkeys(outputs.fields)),
            "derivatives": tuple(derivatives),
            "name": self.path.stem,
            "title": self.raw.title or self.scene.title,
            "text": self.text,
            "scene_text": self.scene_text,
            "free_units": {name: engine.unit_of_dimension(self.dimensions[name]) for name in free},
        }

    # Variables

    def _design(self) -> Design | None:
        axes: list[Axis] = []
        ranges: dict[str, list[float]] = {}
        sizes: dict[str, list[float]] = {}
        samples = self.raw.sampling or any(isinstance(axis, study_text.Between) for axis in self.raw.vary.values())
        for path, axis in self.raw.vary.items():
            with self.problems.noted((engine.UnitError, SamplingError), ["vary", path]):
                self._check_variable(path)
                if isinstance(axis, study_text.Between):
                    ranges[path] = low, high = self._quantities(path, (axis.low, axis.high))
                    if low > high:
                        raise SamplingError(f"low {axis.low!r} is above high {axis.high!r}; exchange them")
                elif samples and isinstance(axis, study_text.Sizes):
                    sizes[path] = self._sizes(path, axis)
                else:
                    axes.append(self._axis(path, axis))
        if self.raw.variants is not None:
            self._add_columns(axes, self.raw.variants)
        if ranges or sizes:
            self._add_sampled(axes, ranges, sizes)
        elif self.raw.sampling is not None:
            message = "nothing is sampled; give low and high, or choose, for a variable, or remove this"
            self.problems.add(["sampling"], message)
        with self.problems.noted(SamplingError, ["vary"]):
            return Design(tuple(axes))
        return None

    def _check_variable(self, path: str) -> None:
        if message := self._why_no_variable(path):
            raise SamplingError(message)

    def _why_no_variable(self, path: str, others: Iterable[str] = ()) -> str:
        """Why a name can't vary, or ""."""
        if path in self.numbers:
            refusal = self._refusal(path, others)
            return refusal and f"can't vary in this scene: {refusal}"
        if path.isidentifier() and path in self._names_used:
            return ""
        return unknown_number_text(self.scene, path)

    def _refusal(self, path: str, others: Iterable[str]) -> str:
        """Why a number of the scene can't vary (it has no effect), or "".

        Other variables may give it an effect.
        """
        varying = (p for p in (*self.raw.vary, *self.raw.derive, *others, path) if p in self.numbers)
        beside = {p: math.nextafter(self.numbers[p].value, math.inf) for p in varying}
        value, refusals = self.numbers[path].value, []
        # Its neighbours, and that of a count.
        alone = [{path: other} for other in (beside[path], value + 1.0, math.nextafter(value, -math.inf))]
        for values in (*alone, beside):
            try:
                with_numbers(self.scene, values)
            except engine.SceneError as error:
                refusals.append(error.problems[0][1])
            else:
                return ""
        return refusals[0]

    @cached_property
    def _names_used(self) -> set[str]:
        """Names used by all expressions, at least; invalid ones are reported later."""
        found: set[str] = set()
        for text in (*self.raw.derive.values(), *self.raw.require):
            try:
                found.update(engine.parse_expression(text, engine.any_quantity).names)
            except engine.ExpressionError:
                found.update(re.findall(r"[^\W\d][\w.]*", text))
        return found

    def _quantities(self, path: str, values: Iterable[float | str]) -> list[float]:
        """Values in SI units."""
        if path in self.numbers:
            return [engine.in_text(value, self.numbers[path].dimension) for value in values]
        found = [engine.recognised(value) for value in values]
        # A bare 0 is valid in any unit.
        kinds = dict.fromkeys(kind for number, kind in found if number or kind != "number") or ["number"]
        if len(kinds) > 1:
            words = " and ".join(kind.replace("_", " ") for kind in kinds)
            raise SamplingError(f"has values of several dimensions ({words}); use one dimension")
        self.dimensions[path] = _powers(next(iter(kinds)))
        return [number for number, _ in found]

    def _sizes(self, path: str, axis: study_text.Sizes) -> list[float]:
        """Sizes in SI units, ascending."""
        if isinstance(axis, study_text.SizeList):
            return sorted(set(self._quantities(path, axis.choose)))
        series = engine.STANDARD_SIZES[axis.choose]
        dimension = _powers(series.dimension)
        if self.dimensions.setdefault(path, dimension) != dimension:
            example = engine.described_dimension(self.numbers[path].dimension).example
            words = f"{axis.choose!r} is a series of {series.dimension}s; list the sizes: ['{example}', …]"
            raise SamplingError(words)
        low, high = (engine.in_text(end, series.dimension) for end in (axis.low, axis.high))
        if not 0 < low <= high:
            raise SamplingError(f"low {axis.low!r} must be above 0 and not above high {axis.high!r}")
        if sizes := series.between(low, high):
            return sizes
        unit = engine.described_dimension(series.dimension).unit
        near = " and ".join(engine.quantity_text(size, unit) for size in series.around(low, high))
        raise SamplingError(f"no size of {axis.choose!r} lies from {axis.low!r} to {axis.high!r}; nearest: {near}")

    def _axis(self, path: str, axis: study_text.Range | study_text.Listing | study_text.Sizes) -> Axis:
        if isinstance(axis, study_text.Sizes):
            return Listed(path, tuple(self._sizes(path, axis)))
        if isinstance(axis, study_text.Listing):
            return Listed(path, tuple(self._quantities(path, axis.values)))
        return Steps(path, *self._quantities(path, (axis.start, axis.stop)), axis.count, axis.spacing == "log")

    def _add_columns(self, axes: list[Axis], name: str) -> None:
        columns, table = {}, []
        with self.problems.noted(InputError, ["variants"]):
            columns = read_variant_table(self.folder / name)
        for path, column in columns.items():
            with self.problems.noted(InputError, ["variants"]):
                table.append(self._column(path, column, columns))
        if columns and len(table) == len(columns):
            axes.append(Columns(tuple(columns), tuple(table)))

    def _column(self, path: str, column: TableColumn, others: Iterable[str]) -> list[float]:
        """Values of a table column in SI units."""
        if message := self._why_no_variable(path, others):
            raise column.problem(0, message)
        if path in self.numbers:
            return column.numbers(self.numbers[path].dimension)
        dimension = column.dimension
        self.dimensions[path] = _powers(dimension)
        return column.numbers(dimension)

    def _add_sampled(self, axes: list[Axis], ranges: dict[str, list[float]], sizes: dict[str, list[float]]) -> None:
        sampling, paths = self.raw.sampling, tuple(path for path in self.raw.vary if path in ranges or path in sizes)
        if sampling is None and self.raw.optimise is not None:
            # Optional for a search; a sweep then uses the population size.
            sampling = study_text.Sampling(
                method="latin", count=self.raw.optimise.population, seed=self.raw.optimise.seed
            )
        if sampling is None:
            self.problems.add(["vary", paths[0]], "low and high need a [sampling] table with method and count")
        if self.problems.found:
            return
        lows, highs = zip(*(ranges.get(path) or (sizes[path][0], sizes[path][-1]) for path in paths), strict=True)
        logs = tuple(path in ranges and self.raw.vary[path].spacing == "log" for path in paths)
        how = (sampling.count, sampling.method, sampling.seed)
        with self.problems.noted(SamplingError, ["sampling"]):
            axes.append(Sampled(paths, lows, highs, *how, logs, sizes))

    # Expressions

    def _derived(self, varied: tuple[str, ...]) -> dict[str, engine.TextExpression]:
        found: dict[str, engine.TextExpression] = {}
        tried = set(self.raw.vary)
        for path, text in self.raw.derive.items():
            # Don't report a rejected name as unknown, too.
            refused = tried - found.keys()
            tried.add(path)
            with self.problems.noted((engine.ExpressionError, SamplingError), ["derive", path]):
                if path in varied:
                    raise SamplingError("varies already; a number is either varied or derived")
                self._check_variable(path)
                expression, known = numeric_expression(text), {*self.numbers, *varied, *found}
                below = [
                    name
                    for name in expression.names
                    if name not in tried and self._is_derived_independently(name, path)
                ]
                unknown = [name for name in expression.names if name not in known and name not in below]
                for name in below:
                    self.problems.add(
                        ["derive", path], f"{name} is derived further below: move its line above this one"
                    )
                for name in (name for name in unknown if name not in refused):
                    self.problems.add(["derive", path], engine.unknown_name_message(name, known))
                if unknown or below:
                    continue
                if path in self.numbers:
                    engine.check_yields(expression, self.dimensions[path], self.dimensions)
                else:
                    self.dimensions[path] = engine.dimension_of(expression, self.dimensions)
                found[path] = expression
        return found

    def _is_derived_independently(self, name: str, path: str) -> bool:
        """Whether a number is derived, and not from `path`, directly or indirectly."""
        pending, seen = [name], set()
        while pending and path not in pending:
            here = pending.pop()
            if here in self.raw.derive and here not in seen:
                with suppress(engine.ExpressionError):
                    pending += numeric_expression(self.raw.derive[here]).names
            seen.add(here)
        return name in self.raw.derive and path not in pending

    def _required(self) -> tuple[Condition, ...]:
        found = []
        for number, text in enumerate(self.raw.require, 1):
            try:
                found.append(Condition.read(text, self.dimensions))
            except engine.ExpressionError as error:
                if isinstance(error, UnknownNameError) and self.problems.found:
                    # The name may have been rejected already.
                    continue
                message, place = str(error), f"entry {number}, " if len(self.raw.require) > 1 else ""
                if isinstance(error, UnknownNameError) and (result := self._result_in(text)):
                    message = f"{result!r} is a result; require drops variants before they are computed, so write where"
                self.problems.add(["require"], f"{place}{message}", text)
        return tuple(found)

    def _result_in(self, text: str) -> str:
        """A result that a condition names, or ""."""
        for name in Condition.parse(text).names:
            if name not in self.dimensions:
                with suppress(engine.AskError, engine.SceneError):
                    engine.made_ready(self.scene, [name])
                    return name
        return ""


def _powers(dimension: str) -> engine.Powers:
    return engine.dimension_of_unit(engine.described_dimension(dimension).unit)


def read_study(path: Path | str) -> Study:
    """Study from a TOML file; a scene file is read as a study of one variant.

    Parameters
    ----------
    path : Path or str

    Raises
    ------
    InputError
        Any problem with the text, scene, axes, expressions or outputs.
    """
    path = Path(path)
    text = read_text(path)
    data = parse_toml(text, path.name)
    if not data:
        raise InputError.of(str(path), "is empty; `sweeps new slider_crank` writes a scene to start from")
    if not data.keys() & {*study_text.StudyText.model_fields, *engine.Scene.model_fields}:
        message = "is neither a study (it has no key 'scene') nor a scene (it has no table 'input')"
        raise InputError.of(str(path), message)
    if study_text.is_scene(data):
        scene = scene_from(data, text, path.name, path.parent)
        words = {"name": path.stem, "title": scene.title, "text": text, "scene_text": text}
        study = Study(scene, summaries=default_summaries(engine.made_ready(scene)), **words)
    else:
        study = Study(**StudyReader(path, text, data).content())
    return _checked(study, path)


def _with_best(study: Study, source: str) -> Study:
    """The study, with the results requested that its [best] names."""
    best, names, problems = study.best, KnownNames(study), Problems(source, study.text)
    with problems.noted(engine.ExpressionError, ["best", best.key]):
        names.request_goal(best.goal)
    for text in best.where:
        with problems.noted(engine.ExpressionError, ["best", "where"], text):
            names.condition(text)
    problems.refuse()
    return study if names.summaries == study.summaries else replace(study, summaries=names.summaries)


def _checked(study: Study, path: Path) -> Study:
    """The study, if all requested outputs exist."""
    problems = Problems(path.name, study.text)
    try:
        study.machine()
        for name, tolerance in study.tolerances.items():
            with problems.noted((engine.AskError, engine.UnitError), ["tolerances", name]):
                read_tolerances(study.scene, {name: tolerance})
        problems.refuse()
        with problems.noted(engine.AskError, ["outputs", "derivatives"]):
            Sensitivity(study)
        problems.refuse()
        if study.best:
            study = _with_best(study, path.name)
    except engine.AskError as error:
        named = [key for key in ("accuracy", "positions", "vary") if key in str(error)]
        key = min(named, key=str(error).index, default="outputs")
        raise InputError(path.name, problems_in(study.text, [(key, str(error))])) from None
    except engine.SceneError as error:
        raise InputError(path.name, problems_in(study.text, error.problems)) from None
    if study.optimise is not None:
        task_of(study)
    return study
