"""The study recorded in a result file, validated, as files are untrusted."""

import json
import math
from typing import Any

from pydantic import BaseModel, ValidationError

from engine import ExpressionError, Scene, SceneError, any_quantity, parse_expression, wrong_input
from sweeps.store import DamagedError, MappedResult
from sweeps.study.search_variables import Span
from sweeps.study.study_text import Best
from sweeps.text.versions import origin_text


class _Axis(BaseModel):
    names: list[str]
    size: int


class _Objective(BaseModel):
    name: str
    way: str


class _Search(BaseModel):
    objectives: list[_Objective]
    where: list[str]
    ranges: list[Span]
    method: str
    seed: int


class _Record(BaseModel):
    """The validated part of a study's record, see `study_record`."""

    scene: dict[str, Any]
    parameters: dict[str, str]
    vary: list[_Axis]
    require: list[str]
    groups: list[str]
    accuracy: float | None
    best: Best | None
    search: _Search | None = None


def recorded_study(file: MappedResult) -> dict[str, Any]:
    """The study of a result file, see `study_record`; for a search with its task, see `search_record`.

    Parameters
    ----------
    file : MappedResult

    Raises
    ------
    DamagedError
        It is missing or contradicts the file.
    """
    text = file.attributes.get("study_json")
    if text is None:
        raise _wrong(file, "is missing")
    try:
        data = json.loads(text)
        record = _Record.model_validate(data)
    except ValidationError as error:
        place, words = wrong_input(_Record, data, error)[0]
        raise _wrong(file, f"has an invalid {place or 'it'} ({words})") from None
    except (ValueError, TypeError, RecursionError):
        raise _wrong(file, "can't be read") from None
    if wrong := _mismatch(record, file):
        raise _wrong(file, wrong)
    return data


def recorded_scene(record: dict[str, Any], file: MappedResult) -> Scene:
    """The scene of a result file.

    Parameters
    ----------
    record : dict
        From `recorded_study`.
    file : MappedResult

    Raises
    ------
    DamagedError
        It is invalid.
    """
    try:
        return Scene.model_validate(record["scene"])
    except (ValueError, TypeError, KeyError) as error:
        words = error.problems[0][1] if isinstance(error, SceneError) else str(error).splitlines()[0]
        raise _wrong(file, f"has an invalid scene ({words})") from None


def _mismatch(record: _Record, file: MappedResult) -> str:
    """A contradiction between record and file, or ""."""
    columns = {column.name for column in file.described}
    goals = [record.best.goal] if record.best else []
    goals += [objective.name for objective in record.search.objectives] if record.search else []
    for name in ("status", "status_group", "status_at", *record.parameters, *goals):
        if name not in columns:
            return f"names {name}, which has no column"
    if record.vary and not record.search and math.prod(axis.size for axis in record.vary) != file.variants:
        return f"has a number of variants other than the file's {file.variants}"
    judges = [judge for judge in (record.search, record.best) if judge]
    for condition in [*record.require, *(text for judge in judges for text in judge.where)]:
        try:
            parse_expression(condition, any_quantity)
        except ExpressionError:
            return f"has the invalid condition {condition!r}"
    return ""


def _wrong(file: MappedResult, what: str) -> DamagedError:
    origin = origin_text(str(file.attributes.get("versions", "")))
    return DamagedError(f"{file.path}: its attribute study_json {what}: {origin}. Run its study again to repair it.")
