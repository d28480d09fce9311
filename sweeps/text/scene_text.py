"""Reading, changing and writing scenes as TOML, with CSV tables."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import tomli_w
from pydantic import ValidationError

import engine
from sweeps.text.csv_text import TableColumn, read_csv
from sweeps.text.input_files import InputError, read_text
from sweeps.text.toml_text import line_of, parse_toml, problems_in, validate

# Tables whose entries may take lists from the columns of a CSV `file`.
TABLES_OF_ROWS = ("forces", "moments", "wanted")
# Significant digits: the first suffice for most doubles, the last for all.
_DIGITS = (15, 16, 17)


def read_scene(path: Path | str) -> engine.Scene:
    """Scene from a TOML file.

    Parameters
    ----------
    path : Path or str

    Raises
    ------
    InputError
        Any problem with the text or mechanism.
    """
    path = Path(path)
    text = read_text(path)
    data = parse_toml(text, path.name)
    if "scene" in data:
        raise InputError.of(path.name, "is a study, not a scene; `read_study` reads it")
    return scene_from(data, text, path.name, path.parent)


def scene_from(
    data: dict[str, Any], text: str, source: str, folder: Path, prefix: tuple[str, ...] = ()
) -> engine.Scene:
    """Scene from parsed tables; checks that the mechanism can be ordered.

    Parameters
    ----------
    data : dict
        Parsed tables of the scene.
    text, source : str
        The text they come from and its name, for error messages.
    folder : Path
        Folder for CSV files.
    prefix : tuple of str
        Keys of the table that contains the scene.
    """
    if (system := engine.show_units_of(data)) != engine.Scene.model_fields["units"].default:
        data = {"units": system} | data
    files: dict[str, tuple[tuple[int | None, str], TableColumn]] = {}
    for table in TABLES_OF_ROWS:
        actions = data.get(table)
        for name, action in actions.items() if isinstance(actions, dict) else ():
            if isinstance(action, dict) and "file" in action:
                where = (line_of(text, [*prefix, table, name, "file"]), f"{table}.{name}.file")
                columns = _table_columns(folder, action.pop("file"), source, where)
                twice = [key for key in columns if key in action]
                if twice:
                    raise InputError.of(source, f"{twice[0]!r} is in both the file and the text; give it once", *where)
                action |= {key: column.texts for key, column in columns.items()}
                files |= {".".join([*prefix, table, name, key]): (where, column) for key, column in columns.items()}
    try:
        scene = validate(engine.Scene, data, text, source, prefix)
    except InputError as error:
        problems = dict.fromkeys(_in_its_file(problem, files) for problem in error.problems)
        raise InputError(source, [*problems]) from None
    try:
        if scene.input is not None:
            engine.order_groups(scene)
    except engine.SceneError as error:
        raise InputError(source, problems_in(text, error.problems, prefix)) from None
    return scene


def _table_columns(folder: Path, name: object, source: str, where: tuple[int | None, str]) -> dict[str, TableColumn]:
    """Columns of a CSV table."""
    try:
        return read_csv(folder / str(name))
    except InputError as error:
        raise InputError.of(source, str(error), *where) from None


def _in_its_file(
    problem: tuple[int | None, str, str], files: Mapping[str, tuple[tuple[int | None, str], TableColumn]]
) -> tuple[int | None, str, str]:
    """A problem, with line and column of the table that it comes from.

    Parameters
    ----------
    problem : tuple
        Line, key and message.
    files : mapping of str to (line and key of the table's name, column)
        By the keys of the columns.
    """
    _, key, message = problem
    column_key, _, entry = key.rpartition(".")
    if key in files:
        where, column = files[key]
        return (*where, str(column.problem(0, message)))
    if column_key in files:
        where, column = files[column_key]
        return (*where, str(column.unit_problem(int(entry) + 1, message)))
    return problem


def in_unit(value: float, unit: str, dimension: str) -> str | None:
    """The shortest text of a number in a unit that reads back exactly; None if there is none."""
    size = engine.in_text(f"1 {unit}", dimension)
    for digits in _DIGITS:
        text = f"{float(f'{value / size:.{digits}g}')!r}".removesuffix(".0") + f" {unit}"
        if engine.in_text(text, dimension) == value:
            return text
    return None


def number_texts(values: Sequence[float], dimension: str) -> list[str | float]:
    """Numbers in scene text, in one unit: the common one in which they are shortest and read back exactly."""
    if dimension == "number":
        return list(values)
    written = ([in_unit(value, unit, dimension) for value in values] for unit in engine.common_units(dimension))
    return min((texts for texts in written if None not in texts), key=lambda texts: sum(map(len, texts)))


def number_text(value: float, dimension: str) -> str | float:
    """A number in scene text, as `number_texts`."""
    return number_texts([value], dimension)[0]


def write_scene(scene: engine.Scene, values: Mapping[str, float] | None = None) -> str:
    """TOML text of a scene, with some of its numbers replaced.

    Parameters
    ----------
    scene : Scene
    values : mapping of str to float, optional
        New values (SI) by path, such as those of one variant of a study.

    Raises
    ------
    SceneError
        An invalid value.
    """
    values = values_of_variant(scene, values or {})
    scene = with_numbers(scene, values)
    data = scene.model_dump(exclude_none=True, exclude_defaults=True, mode="json")
    for path, number in engine.scene_numbers(scene).items():
        table, last = _table_of(path, data)
        if last in table or path in values:
            table[last] = int(number.value) if last == "mode" else number_text(number.value, number.dimension)
    _with_units(scene, data)
    return tomli_w.dumps(data)


def values_of_variant(scene: engine.Scene, values: Mapping[str, float]) -> dict[str, float]:
    """All numbers in which a variant differs from its scene, including `near` points for its assembly modes.

    A variant continues the scene's mode; the scene's `near` may be closer to another one.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        New values (SI); unchanged if they include `near`.

    Raises
    ------
    SceneError
        The variant can't be assembled in the scene's mode.
    """
    if any(path.startswith("near.") for path in values):
        return dict(values)
    found = engine.near_of_variant(scene, values)
    if found is None:
        message = "this variant can't be assembled in the scene's assembly mode; choose another"
        raise engine.SceneError([("near", message)])
    return {**values, **found}


def with_values(scene: engine.Scene, values: Mapping[str, float]) -> engine.Scene:
    """The scene of one variant of a study.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        New values (SI).

    Raises
    ------
    SceneError
        An invalid value, or the scene's assembly mode isn't reached.
    """
    return with_numbers(scene, values_of_variant(scene, values))


def with_numbers(scene: engine.Scene, values: Mapping[str, float]) -> engine.Scene:
    """A copy of a scene with some numbers replaced.

    Parameters
    ----------
    scene : Scene
    values : mapping of path to float
        New values (SI).

    Raises
    ------
    SceneError
        An invalid value.
    """
    by_path: dict[str, Any] = {}
    for path, value in values.items():
        table, last = _table_of(path, by_path)
        table[last] = value
    return _copied(scene, by_path, "") if values else scene


def unknown_number_text(scene: engine.Scene, path: str) -> str:
    """Why a path is not one of a scene's numbers, and what may be meant."""
    words, part = "is not a number that the scene gives", scene
    *tables, last = path.split(".")
    for table in tables:
        part = part.get(table) if isinstance(part, dict) else getattr(part, table, None)
    if last in getattr(type(part), "model_fields", {}) and getattr(part, last) is None:
        return f"{words}; give it there first"
    return engine.unknown_name_message(path, engine.scene_numbers(scene), words)


def given_values(scene: engine.Scene, settings: Sequence[str]) -> dict[str, float]:
    """Numbers of a scene from texts such as "input.length=55 mm".

    Parameters
    ----------
    scene : Scene
    settings : sequence of str

    Returns
    -------
    dict of str to float
        SI, by path.

    Raises
    ------
    InputError
        A text has no =, an unknown number, or an invalid value.
    """
    known, found = engine.scene_numbers(scene), {}
    for text in settings:
        path, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not path:
            raise InputError.of("--set", f"{text!r}: write PATH=VALUE, such as input.length='55 mm'")
        if path not in known:
            raise InputError.of("--set", unknown_number_text(scene, path), key=path)
        try:
            found[path] = engine.in_text(value.strip("\"'"), known[path].dimension)
        except engine.UnitError as error:
            raise InputError.of("--set", str(error), key=path) from None
    return found


def changed_scene(scene: engine.Scene, settings: Sequence[str]) -> engine.Scene:
    """A scene with changed numbers.

    Parameters
    ----------
    scene : Scene
    settings : sequence of str
        As for `given_values`.

    Raises
    ------
    InputError
        As for `given_values`, or an invalid value.
    """
    try:
        return with_numbers(scene, given_values(scene, settings))
    except engine.SceneError as error:
        raise InputError("--set", [(None, path, message) for path, message in error.problems]) from None


def _table_of(path: str, data: dict[str, Any]) -> tuple[dict[str, Any], str]:
    """The table of a number, made if it is missing, and the number's key in it."""
    *tables, last = path.split(".")
    for key in tables:
        data = data.setdefault(key, {})
    return data, last


def _copied(part: engine.ScenePart, changes: Mapping[str, Any] | float, path: str) -> engine.ScenePart:
    """A validated part of a scene with changes; unchanged parts are shared."""
    if isinstance(part, engine.FormulaNumber):
        return part.at(changes)
    given = {key: getattr(part, key) for key in part.model_fields_set}
    for key, change in changes.items():
        here, old = f"{path}{key}.", getattr(part, key)
        if isinstance(old, dict):
            given[key] = old | {name: _copied(old[name], inner, f"{here}{name}.") for name, inner in change.items()}
        elif isinstance(old, engine.ScenePart):
            given[key] = _copied(old, change, here)
        else:
            given[key] = int(change) if isinstance(old, int) else change
    try:
        return type(part).model_validate(given)
    except engine.SceneError as error:
        problems = error.problems
    except ValidationError as error:
        problems = engine.wrong_input(type(part), given, error)
    # The number refused is in SI, not as given.
    found = [(key.partition(".")[0], words.partition(", got ")[0]) for key, words in problems]
    raise engine.SceneError([(f"{path}{key}".rstrip("."), words) for key, words in found])


def _with_units(part: engine.ScenePart, data: dict[str, Any]) -> None:
    """Write the lists of a part and of all within it with their units, in place."""
    for key, field in type(part).model_fields.items():
        value, written = getattr(part, key), data.get(key)
        if isinstance(value, engine.ScenePart) and isinstance(written, dict):
            _with_units(value, written)
        elif isinstance(value, dict) and isinstance(written, dict):
            for name, inner in value.items():
                if isinstance(inner, engine.ScenePart) and isinstance(written[name], dict):
                    _with_units(inner, written[name])
        elif isinstance(value, (list, tuple)) and isinstance(written, list):
            dimension = engine.field_dimension(field)
            for k, inner in enumerate(value):
                if isinstance(inner, engine.ScenePart):
                    _with_units(inner, written[k])
            if dimension is not None:
                written[:] = number_texts(value, dimension)
