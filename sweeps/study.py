"""A study: a scene, what varies in it, what is asked of it; from a text file or from Python."""

import hashlib
import json
from collections.abc import Iterable, Mapping
from contextlib import suppress
from dataclasses import dataclass, field
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np

from engine import AskError, Machine, Scene, SceneError, scene_numbers
from engine.jit import sources_digest
from engine.scene import SceneNumber
from engine.units import UnitError, any_quantity, in_text, recognised
from sweeps.expressions import Expression, ExpressionError, parse, unknown_name_message
from sweeps.sampling import Axis, Columns, Design, Linear, Listed, Logarithmic, Sampled, SamplingError
from sweeps.scenefile import read_csv, read_scene, scene_from
from sweeps.studyfile import AXIS_KEYS, Best, Between, Listing, Range, StudyText, flatten
from sweeps.textfile import InputError, line_of, parse_toml, read_text, validate

STUDIES = Path(str(files("sweeps") / "studies"))


@dataclass(frozen=True, eq=False)
class Study:
    """A scene with what varies in it and what is asked of it.

    Attributes
    ----------
    scene : Scene
    design : Design
        The variants: the product of the axes, the last fastest.
    derived : dict of str to Expression
        Numbers tied to the varied ones, by path.
    require : tuple of Expression
        Conditions; a variant that fails one is dropped.
    summaries, fields : tuple of str
        What is asked.
    positions : int
    precision : {"float64", "float32"}
    name, title, question, text : str
    best : Best or None
    """

    scene: Scene
    design: Design = field(default_factory=lambda: Design(()))
    derived: Mapping[str, Expression] = field(default_factory=dict)
    require: tuple[Expression, ...] = ()
    summaries: tuple[str, ...] = ()
    fields: tuple[str, ...] = ()
    positions: int = 720
    precision: str = "float64"
    name: str = "study"
    title: str = ""
    question: str = ""
    text: str = ""
    best: Best | None = None
    free_dimensions: Mapping[str, str] = field(default_factory=dict)

    @property
    def paths(self) -> tuple[str, ...]:
        """Numbers of the scene that differ between variants."""
        numbers = scene_numbers(self.scene)
        return tuple(p for p in self.parameters if p in numbers)

    @property
    def parameters(self) -> tuple[str, ...]:
        """All varied and derived numbers, free parameters too."""
        return (*self.design.names, *self.derived)

    def parameter_number(self, name: str) -> SceneNumber:
        """Nominal value and dimension of a parameter; that of a free one from its values, "" where it is derived."""
        free = SceneNumber(float("nan"), self.free_dimensions.get(name, ""), ())
        return scene_numbers(self.scene).get(name, free)

    def machine(self) -> Machine:
        """The machine that answers the study.

        Raises
        ------
        AskError
            An asked summary or field doesn't exist.
        """
        return Machine(
            self.scene, self.summaries, self.fields, self.paths, self.positions, np.dtype(self.precision).type
        )

    def values(self, start: int, stop: int) -> tuple[dict[str, np.ndarray], np.ndarray]:
        """Parameters of the variants start … stop − 1 (SI) and which of them are dropped by a condition.

        They depend on the study and the variants' numbers alone, not on how variants are split into blocks.
        """
        count = stop - start
        values = dict(self.design.values(start, stop))
        fixed = {path: number.value for path, number in scene_numbers(self.scene).items()}
        with np.errstate(all="ignore"):
            for path, expression in self.derived.items():
                values[path] = np.broadcast_to(expression.evaluate(fixed | values), (count,)).astype(float)
            drop = np.zeros(count, bool)
            for condition in self.require:
                drop |= ~np.broadcast_to(condition.evaluate(fixed | values), (count,)).astype(bool)
        return values, drop

    @property
    def digest(self) -> str:
        """Name of the study's content: the scene, what varies, what is asked, and the engine that computes it."""
        content = {
            "scene": self.scene.model_dump(mode="json", exclude={"title", "source"}),
            "axes": [_axis_content(axis) for axis in self.design.axes],
            "derived": {path: e.text for path, e in self.derived.items()},
            "require": [e.text for e in self.require],
            "asked": [self.summaries, self.fields, self.positions, self.precision],
            "engine": sources_digest(),
        }
        return hashlib.sha256(json.dumps(content, sort_keys=True, default=str).encode()).hexdigest()


def _axis_content(axis: Axis) -> dict[str, Any]:
    return {"kind": type(axis).__name__} | {
        key: np.asarray(value).tolist() if isinstance(value, (np.ndarray, list, tuple)) else value
        for key, value in vars(axis).items()
    }


def bundled() -> dict[str, Path]:
    """Studies that come with the package, by name."""
    return {path.stem: path for path in sorted(STUDIES.glob("*.toml"))}


def find_study(name: str) -> Path:
    """Path of a study: a file, or the name of a bundled one.

    Raises
    ------
    InputError
        There is neither.
    """
    path = Path(name)
    if path.is_file():
        return path
    known = bundled()
    if name in known:
        return known[name]
    message = unknown_name_message(name, known)
    raise InputError(name, [(None, "", f"there is no such file, and no bundled study of that name. {message}")])


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
    if "scene" not in data and "input" in data:
        scene = read_scene(path)
        return _checked(
            Study(scene, summaries=default_summaries(scene), name=path.stem, title=scene.title, text=text), path
        )
    return _Reader(path, text, data).study()


def default_summaries(scene: Scene) -> tuple[str, ...]:
    """What is asked of a machine where nothing is named: everything about its cycle and its flywheel, and strokes."""
    left_out = ("first_kind_inertia", "power_balance_residual")
    available = Machine(scene).available_summaries
    return tuple(n for n in available if n not in left_out and ("." not in n or n.endswith((".stroke", "_angle"))))


class _Reader:
    """Turns the text of a study into a Study, collecting problems with their lines."""

    def __init__(self, path: Path, text: str, data: dict[str, Any]) -> None:
        self.path, self.text, self.folder = path, text, path.parent
        for key, leaves in (("vary", AXIS_KEYS), ("derive", None)):
            if isinstance(data.get(key), dict):
                data[key] = flatten(data[key], leaves)
        self.raw = validate(StudyText, data, text, path.name)
        self.scene = self._scene()
        self.numbers = scene_numbers(self.scene)
        self.problems: list[tuple[int | None, str, str]] = []
        self.free_dimensions: dict[str, str] = {}

    def _scene(self) -> Scene:
        if isinstance(self.raw.scene, dict):
            return scene_from(self.raw.scene, self.text, self.path.name, self.folder, ("scene",))
        return read_scene(self.folder / self.raw.scene)

    def study(self) -> Study:
        """The study.

        Raises
        ------
        InputError
        """
        design = self._design()
        names = design.names if design else ()
        derived = self._derived(names)
        known = {*self.numbers, *names, *derived}
        require = tuple(e for i, t in enumerate(self.raw.require) if (e := self._condition(t, ["require"], known, i)))
        if self.problems:
            raise InputError(self.path.name, self.problems)
        outputs = self.raw.outputs
        summaries = tuple(dict.fromkeys(outputs.summaries))
        if not summaries and not outputs.fields:
            summaries = default_summaries(self.scene)
        if self.raw.best and self.raw.best.goal not in summaries:
            summaries = (*summaries, self.raw.best.goal)
        study = Study(
            self.scene,
            design,
            derived,
            require,
            summaries,
            tuple(dict.fromkeys(outputs.fields)),
            self.raw.positions,
            self.raw.precision,
            self.path.stem,
            self.raw.title or self.scene.title,
            self.raw.question,
            self.text,
            self.raw.best,
            self.free_dimensions,
        )
        return _checked(study, self.path)

    def _problem(self, keys: list[str], message: str) -> None:
        self.problems.append((line_of(self.text, keys) or line_of(self.text, _split(keys)), ".".join(keys), message))

    # What varies

    def _design(self) -> Design | None:
        axes: list[Axis] = []
        sampled: dict[str, Between] = {}
        for path, axis in self.raw.vary.items():
            if not self._is_variable(path, ["vary", path]):
                continue
            if isinstance(axis, Between):
                sampled[path] = axis
            else:
                self._add(axes, path, axis)
        if self.raw.variants is not None:
            self._add_columns(axes, self.raw.variants)
        if sampled:
            self._add_sampled(axes, sampled)
        elif self.raw.sampling is not None:
            self._problem(["sampling"], "nothing is sampled; give low and high for what varies, or leave this out")
        try:
            return Design(tuple(axes))
        except SamplingError as error:
            self._problem(["vary"], str(error))
            return None

    def _is_variable(self, path: str, keys: list[str]) -> bool:
        if path in self.numbers or (path.isidentifier() and self._used(path)):
            return True
        message = unknown_name_message(path, self.numbers)
        self._problem(keys, f"is not a number of the scene. {message}")
        return False

    def _used(self, name: str) -> bool:
        """Whether a free parameter enters any expression."""
        for text in (*self.raw.derive.values(), *self.raw.require):
            with suppress(ExpressionError):
                if name in parse(text, any_quantity).names:
                    return True
        return False

    def _quantity(self, path: str, value: float | str, keys: list[str]) -> float:
        try:
            if path in self.numbers:
                return in_text(value, self.numbers[path].dimension)
            number, self.free_dimensions[path] = recognised(value)
            return number
        except UnitError as error:
            self._problem(keys, str(error))
            return float("nan")

    def _add(self, axes: list[Axis], path: str, axis: Range | Listing) -> None:
        keys, before = ["vary", path], len(self.problems)
        if isinstance(axis, Listing):
            numbers = [self._quantity(path, v, keys) for v in axis.values]
        else:
            numbers = [self._quantity(path, v, keys) for v in (axis.start, axis.stop)]
        if len(self.problems) > before:
            return
        try:
            if isinstance(axis, Listing):
                axes.append(Listed(path, tuple(numbers)))
            else:
                kind = Linear if axis.spacing == "linear" else Logarithmic
                axes.append(kind(path, *numbers, axis.count))
        except SamplingError as error:
            self._problem(keys, str(error))

    def _add_columns(self, axes: list[Axis], name: str) -> None:
        try:
            columns = read_csv(self.folder / name)
        except InputError as error:
            self._problem(["variants"], str(error))
            return
        before = len(self.problems)
        table = []
        for path, (unit, values) in columns.items():
            if self._is_variable(path, ["variants"]):
                table.append([self._quantity(path, f"{v} {unit}".strip(), ["variants"]) for v in values])
        if len(self.problems) == before:
            axes.append(Columns(tuple(columns), tuple(tuple(t) for t in table)))

    def _add_sampled(self, axes: list[Axis], sampled: dict[str, Between]) -> None:
        if self.raw.sampling is None:
            self._problem(["vary", next(iter(sampled))], "low and high need a [sampling] table with method and count")
            return
        ends = {p: [self._quantity(p, v, ["vary", p]) for v in (a.low, a.high)] for p, a in sampled.items()}
        if self.problems:
            return
        s = self.raw.sampling
        lows, highs = zip(*ends.values(), strict=True)
        logs = tuple(a.spacing == "log" for a in sampled.values())
        try:
            axes.append(Sampled(tuple(sampled), lows, highs, s.count, s.method, s.seed, logs))
        except SamplingError as error:
            self._problem(["sampling"], str(error))

    # Expressions

    def _derived(self, varied: tuple[str, ...]) -> dict[str, Expression]:
        found: dict[str, Expression] = {}
        for path, text in self.raw.derive.items():
            keys = ["derive", path]
            if path in varied:
                self._problem(keys, "varies already; a number is either varied or derived")
            elif self._is_variable(path, keys):
                known = {*self.numbers, *varied, *found}
                expression = self._expression(text, keys, known)
                if expression and expression.is_condition:
                    self._problem(keys, f"{text!r} is a condition; a number is needed here")
                elif expression:
                    found[path] = expression
        return found

    def _condition(self, text: str, keys: list[str], known: Iterable[str], number: int) -> Expression | None:
        expression = self._expression(text, keys, known)
        if expression and not expression.is_condition:
            self._problem(
                keys, f"entry {number + 1}, {text!r}, is a number; a condition such as 'a < b' is needed here"
            )
            return None
        return expression

    def _expression(self, text: str, keys: list[str], known: Iterable[str]) -> Expression | None:
        try:
            expression = parse(text, any_quantity)
        except ExpressionError as error:
            self._problem(keys, str(error))
            return None
        unknown = [name for name in expression.names if name not in set(known)]
        for name in unknown:
            self._problem(keys, unknown_name_message(name, known))
        return None if unknown else expression


def _split(keys: list[str]) -> list[str]:
    return [part for key in keys for part in key.split(".")]


def _check_where(study: Study, where: str) -> None:
    """See that a condition is one, and uses what the result will hold."""
    condition = parse(where, any_quantity)
    if not condition.is_condition:
        raise ExpressionError(f"{where!r} is a number; a condition such as 'a < b' is needed")
    known = (*study.parameters, *study.summaries)
    for name in condition.names:
        if name not in known:
            raise ExpressionError(f"{unknown_name_message(name, known)}; name it under outputs.summaries to have it")


def _checked(study: Study, path: Path) -> Study:
    """The study, if everything asked of it exists."""
    try:
        study.machine()
        if study.best and study.best.where:
            _check_where(study, study.best.where)
    except AskError as error:
        key = next((k for k in ("positions", "vary") if k in str(error)), "outputs")
        if study.best and repr(study.best.goal) in str(error):
            key = f"best.{'minimise' if study.best.minimise else 'maximise'}"
        raise InputError(path.name, [(line_of(study.text, key.split(".")), key, str(error))]) from None
    except SceneError as error:
        problems = [(line_of(study.text, key.split(".")), key, message) for key, message in error.problems]
        raise InputError(path.name, problems) from None
    except ExpressionError as error:
        raise InputError(path.name, [(line_of(study.text, ["best", "where"]), "best.where", str(error))]) from None
    return study
