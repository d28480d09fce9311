"""The study recorded in a result file, validated: files come from anywhere."""

import json
import math
from typing import Any

from pydantic import BaseModel, ValidationError

from engine import ExpressionError, Scene, any_quantity, parse_expression
from sweeps.store import DamagedError, Description
from sweeps.study.study_text import Best
from sweeps.text.versions import origin_text


class _Axis(BaseModel):
    names: list[str]
    size: int


class _Objective(BaseModel):
    name: str
    way: str


class _Range(BaseModel):
    name: str
    low: float
    high: float


class _Search(BaseModel):
    objectives: list[_Objective]
    subject_to: list[str]
    ranges: list[_Range]
    method: str
    seed: int


class _Record(BaseModel):
    """What is read of a study's record, see `study_record`; there may be more."""

    scene: dict[str, Any]
    parameters: dict[str, str]
    vary: list[_Axis]
    require: list[str]
    groups: list[str]
    accuracy: float | None
    best: Best | None
    search: _Search | None = None


def recorded_study(described: Description) -> dict[str, Any]:
    """The study of a result file as data, see `study_record`; for a search also its task, see `search_record`.

    Parameters
    ----------
    described : Description
        Of the file.

    Raises
    ------
    DamagedError
        It is missing or contradicts the file; the message says where.
    """
    text = described.attributes.get("study_json")
    if text is None:
        raise _wrong(described, "is missing")
    try:
        data = json.loads(text)
        record = _Record.model_validate(data)
    except ValidationError as error:
        first = error.errors()[0]
        place = ".".join(map(str, first["loc"])) or "it"
        raise _wrong(described, f"has no such {place} as results have ({first['msg']})") from None
    except (ValueError, TypeError, RecursionError):
        raise _wrong(described, "can't be read") from None
    if wrong := _mismatch(record, described):
        raise _wrong(described, wrong)
    return data


def recorded_scene(record: dict[str, Any], described: Description) -> Scene:
    """The scene of a result file.

    Parameters
    ----------
    record : dict
        As `recorded_study` returns it.
    described : Description
        Of the file.

    Raises
    ------
    DamagedError
        It is none.
    """
    try:
        return Scene.model_validate(record["scene"])
    except (ValueError, TypeError, KeyError) as error:
        words = error.errors()[0]["msg"] if isinstance(error, ValidationError) else str(error).splitlines()[0]
        raise _wrong(described, f"holds a scene that is none ({words})") from None


def _mismatch(record: _Record, described: Description) -> str:
    """What of a record doesn't fit its file; "" if all does."""
    columns = {column.name for column in described.columns}
    goals = [record.best.goal] if record.best else []
    goals += [objective.name for objective in record.search.objectives] if record.search else []
    for name in ("status", "status_group", "status_at", *record.parameters, *goals):
        if name not in columns:
            return f"names {name}, of which there is no column"
    if record.vary and not record.search and math.prod(axis.size for axis in record.vary) != described.variants:
        return f"makes up another number of variants than the {described.variants} there are"
    texts = [*record.require, *(record.search.subject_to if record.search else [])]
    for condition in [*texts, *([record.best.where] if record.best and record.best.where else [])]:
        try:
            parse_expression(condition, any_quantity)
        except ExpressionError:
            return f"holds the condition {condition!r}, which can't be read"
    return ""


def _wrong(described: Description, what: str) -> DamagedError:
    origin = origin_text(str(described.attributes.get("versions", "")))
    return DamagedError(
        f"{described.path}: its attribute study_json {what}: {origin}. Run its study again to have it whole."
    )
