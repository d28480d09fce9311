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
from sweeps.study.sampling import Axis, Columns, Design, Linear, Listed, Logarithmic, Sampled, SamplingError
from sweeps.study.search_task import task_of
from sweeps.study.sensitivity import refusals
from sweeps.study.study import KnownNames, Study
from sweeps.study.study_content import AskedDerivative
from sweeps.study.variant_tables import read_variant_table
from sweeps.text.conditions import Condition, UnknownNameError
from sweeps.text.csv_text import TableColumn
from sweeps.text.input_files import InputError, read_text
from sweeps.text.scene_text import scene_from, with_numbers
from sweeps.text.toml_text import line_of, line_of_entry, parse_toml, problems_in, validate

# Keys that are attributes of a study.
_AS_GIVEN = ("positions", "field_precision", "accuracy", "question", "best", "optimise", "tolerances")
# Larger results fit on no disk.
MOST_VARIANTS = 10**12


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
        self.problems: list[tuple[int | None, str, str]] = []
        self.dimensions = {
            path: engine.dimension_of_unit(engine.described_dimension(n.dimension).unit)
            for path, n in self.numbers.items()
        }

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
        derived = self._derived(names)
        require = tuple(e for i, t in enumerate(self.raw.require) if (e := self._condition(t, i)))
        derivatives = self._derivatives()
        if self.problems:
            raise InputError(self.path.name, self.problems)
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
            "derivatives": derivatives,
            "name": self.path.stem,
            "title": self.raw.title or self.scene.title,
            "text": self.text,
            "scene_text": self.scene_text,
            "free_units": {name: engine.unit_of_dimension(self.dimensions[name]) for name in free},
        }

    def _derivatives(self) -> tuple[AskedDerivative, ...]:
        found = []
        for text in dict.fromkeys(self.raw.outputs.derivatives):
            try:
                found.append(AskedDerivative.read(text))
            except engine.AskError as error:
                self._problem(["outputs", "derivatives"], str(error))
        return tuple(found)

    def _problem(self, keys: list[str], message: str, line: int | None = None) -> None:
        line = line or line_of(self.text, keys) or line_of(self.text, _split(keys))
        self.problems.append((line, ".".join(keys), message))
        if len(self.problems) >= engine.MOST_PROBLEMS:
            raise InputError(self.path.name, self.problems)

    # Variables

    def _design(self) -> Design | None:
        axes: list[Axis] = []
        sampled: dict[str, study_text.Between | study_text.Sizes] = {}
        samples = self.raw.sampling or any(isinstance(axis, study_text.Between) for axis in self.raw.vary.values())
        for path, axis in self.raw.vary.items():
            if not self._is_variable(path, ["vary", path]):
                continue
            if isinstance(axis, study_text.Between) or (samples and isinstance(axis, study_text.Sizes)):
                sampled[path] = axis
            else:
                self._add(axes, path, axis)
        if self.raw.variants is not None:
            self._add_columns(axes, self.raw.variants)
        if sampled:
            self._add_sampled(axes, sampled)
        elif self.raw.sampling is not None:
            self._problem(
                ["sampling"], "nothing is sampled; give low and high, or choose, for a variable, or remove this"
            )
        try:
            design = Design(tuple(axes))
        except SamplingError as error:
            self._problem(["vary"], str(error))
            return None
        if design.size > MOST_VARIANTS:
            message = f"{design.size} variants, at most {MOST_VARIANTS}; reduce a count, or sample with low and high"
            self._problem(["vary"], message)
        return design

    def _is_variable(self, path: str, keys: list[str], others: Iterable[str] = ()) -> bool:
        if message := self._why_no_variable(path, others):
            self._problem(keys, message)
        return not message

    def _why_no_variable(self, path: str, others: Iterable[str] = ()) -> str:
        """Why a name can't vary, or ""."""
        if path in self.numbers:
            refusal = self._refusal(path, others)
            return refusal and f"can't vary in this scene: {refusal}"
        if path.isidentifier() and path in self._names_used:
            return ""
        return f"is not a number of the scene. {engine.unknown_name_message(path, self.numbers)}"

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

    def _quantities(self, path: str, values: Iterable[float | str], keys: list[str]) -> list[float] | None:
        """Values in SI units; None if one is invalid."""
        try:
            if path in self.numbers:
                return [engine.in_text(value, self.numbers[path].dimension) for value in values]
            found = [engine.recognised(value) for value in values]
        except engine.UnitError as error:
            self._problem(keys, str(error))
            return None
        # A bare 0 is valid in any unit.
        kinds = dict.fromkeys(kind for number, kind in found if number or kind != "number") or ["number"]
        if len(kinds) > 1:
            words = " and ".join(kind.replace("_", " ") for kind in kinds)
            self._problem(keys, f"has values of several dimensions ({words}); use one dimension")
            return None
        self.dimensions[path] = engine.dimension_of_unit(engine.described_dimension(next(iter(kinds))).unit)
        return [number for number, _ in found]

    def _sizes(self, path: str, axis: study_text.Sizes, keys: list[str]) -> list[float] | None:
        """Sizes in SI units, ascending; None if there are none."""
        if isinstance(axis, study_text.SizeList):
            listed = self._quantities(path, axis.choose, keys)
            return None if listed is None else sorted(set(listed))
        series = engine.STANDARD_SIZES[axis.choose]
        described = engine.described_dimension(series.dimension)
        dimension = engine.dimension_of_unit(described.unit)
        if self.dimensions.setdefault(path, dimension) != dimension:
            example = engine.described_dimension(self.numbers[path].dimension).example
            self._problem(keys, f"{axis.choose!r} is a series of {series.dimension}s; list the sizes: ['{example}', …]")
            return None
        try:
            low, high = (engine.in_text(end, series.dimension) for end in (axis.low, axis.high))
        except engine.UnitError as error:
            self._problem(keys, str(error))
            return None
        if not 0 < low <= high:
            self._problem(keys, f"low {axis.low!r} must be above 0 and not above high {axis.high!r}")
            return None
        sizes = series.between(low, high)
        if not sizes:
            near = " and ".join(engine.quantity_text(size, described.unit) for size in series.around(low, high))
            self._problem(keys, f"no size of {axis.choose!r} lies from {axis.low!r} to {axis.high!r}; nearest: {near}")
        return sizes or None

    def _add(self, axes: list[Axis], path: str, axis: study_text.Range | study_text.Listing | study_text.Sizes) -> None:
        keys = ["vary", path]
        if isinstance(axis, study_text.Sizes):
            numbers = self._sizes(path, axis, keys)
        else:
            ends = axis.values if isinstance(axis, study_text.Listing) else (axis.start, axis.stop)
            numbers = self._quantities(path, ends, keys)
        if numbers is None:
            return
        try:
            if isinstance(axis, study_text.Listing | study_text.Sizes):
                axes.append(Listed(path, tuple(numbers)))
            else:
                kind = Linear if axis.spacing == "linear" else Logarithmic
                axes.append(kind(path, *numbers, axis.count))
        except SamplingError as error:
            self._problem(keys, str(error))

    def _add_columns(self, axes: list[Axis], name: str) -> None:
        try:
            columns = read_variant_table(self.folder / name)
        except InputError as error:
            self._problem(["variants"], str(error))
            return
        table = [self._column(path, column, columns) for path, column in columns.items()]
        if len(table) == len(columns) and None not in table:
            axes.append(Columns(tuple(columns), tuple(table)))

    def _column(self, path: str, column: TableColumn, others: Iterable[str]) -> list[float] | None:
        """Values of a table column in SI units; None if invalid."""
        try:
            if message := self._why_no_variable(path, others):
                raise column.problem(0, message)
            if path in self.numbers:
                return column.numbers(self.numbers[path].dimension)
            dimension = column.dimension
            self.dimensions[path] = engine.dimension_of_unit(engine.described_dimension(dimension).unit)
            return column.numbers(dimension)
        except InputError as error:
            self._problem(["variants"], str(error))
            return None

    def _add_sampled(self, axes: list[Axis], sampled: dict[str, study_text.Between | study_text.Sizes]) -> None:
        sampling = self.raw.sampling
        if sampling is None and self.raw.optimise is not None:
            # Optional for a search; a sweep then uses the population size.
            sampling = study_text.Sampling(
                method="latin", count=self.raw.optimise.population, seed=self.raw.optimise.seed
            )
        if sampling is None:
            self._problem(["vary", next(iter(sampled))], "low and high need a [sampling] table with method and count")
            return
        chosen = {
            p: self._sizes(p, a, ["vary", p]) for p, a in sampled.items() if not isinstance(a, study_text.Between)
        }
        ranges = {p: a for p, a in sampled.items() if isinstance(a, study_text.Between)}
        ends = {p: self._quantities(p, (a.low, a.high), ["vary", p]) for p, a in ranges.items()}
        if self.problems:
            return
        ends |= {path: (sizes[0], sizes[-1]) for path, sizes in chosen.items()}
        lows, highs = zip(*(ends[path] for path in sampled), strict=True)
        logs = tuple(path in ranges and ranges[path].spacing == "log" for path in sampled)
        how = (sampling.count, sampling.method, sampling.seed)
        try:
            axes.append(Sampled(tuple(sampled), lows, highs, *how, logs, chosen))
        except SamplingError as error:
            self._problem(["sampling"], str(error))

    # Expressions

    def _derived(self, varied: tuple[str, ...]) -> dict[str, engine.TextExpression]:
        found: dict[str, engine.TextExpression] = {}
        for path, text in self.raw.derive.items():
            keys = ["derive", path]
            if path in varied:
                self._problem(keys, "varies already; a number is either varied or derived")
            elif self._is_variable(path, keys):
                expression = self._expression(text, keys, {*self.numbers, *varied, *found})
                if expression and expression.is_condition:
                    self._problem(keys, f"{text!r} is a condition; a number is needed here")
                elif expression and self._has_dimension(expression, path, keys):
                    found[path] = expression
        return found

    def _has_dimension(self, expression: engine.TextExpression, path: str, keys: list[str]) -> bool:
        """Whether a derived number has the dimension of its path; a free one takes its expression's."""
        try:
            if path in self.numbers:
                engine.check_yields(expression, self.dimensions[path], self.dimensions)
            else:
                self.dimensions[path] = engine.dimension_of(expression, self.dimensions)
        except engine.ExpressionError as error:
            self._problem(keys, str(error))
            return False
        return True

    def _condition(self, text: str, entry: int) -> Condition | None:
        try:
            return Condition.read(text, self.dimensions)
        except engine.ExpressionError as error:
            message, number = str(error), f"entry {entry + 1}, " if len(self.raw.require) > 1 else ""
            if isinstance(error, UnknownNameError) and (result := self._result_in(text)):
                message = f"{result!r} is a result; require drops variants before they are computed, so write where"
            self._problem(["require"], f"{number}{message}", line_of_entry(self.text, ["require"], text))
            return None

    def _result_in(self, text: str) -> str:
        """A result that a condition names, or ""."""
        for name in Condition.parse(text).names:
            if name not in self.dimensions:
                with suppress(engine.AskError, engine.SceneError):
                    engine.made_ready(self.scene, [name])
                    return name
        return ""

    def _expression(self, text: str, keys: list[str], known: Iterable[str]) -> engine.TextExpression | None:
        try:
            expression = engine.parse_expression(text, engine.any_quantity)
        except engine.ExpressionError as error:
            self._problem(keys, str(error))
            return None
        unknown = [name for name in expression.names if name not in set(known)]
        for name in unknown:
            self._problem(keys, engine.unknown_name_message(name, known))
        return None if unknown else expression


def _split(keys: list[str]) -> list[str]:
    return [part for key in keys for part in key.split(".")]


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
        study = Study(
            scene,
            summaries=default_summaries(engine.made_ready(scene)),
            name=path.stem,
            title=scene.title,
            text=text,
            scene_text=text,
        )
    else:
        study = Study(**StudyReader(path, text, data).content())
    return _checked(study, path)


def _with_best(study: Study, source: str) -> Study:
    """The study, with the results requested that its [best] names."""
    best, names, problems = study.best, KnownNames(study), []
    try:
        names.request_goal(best.goal)
    except engine.ExpressionError as error:
        problems += problems_in(study.text, [(f"best.{best.key}", str(error))])
    for text in best.where:
        try:
            names.condition(text)
        except engine.ExpressionError as error:
            problems.append((line_of_entry(study.text, ["best", "where"], text), "best.where", str(error)))
    if problems:
        raise InputError(source, problems)
    return study if names.summaries == study.summaries else replace(study, summaries=names.summaries)


def _checked(study: Study, path: Path) -> Study:
    """The study, if all requested outputs exist."""
    try:
        study.machine()
        if found := refusals(study):
            raise InputError(path.name, problems_in(study.text, found))
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
