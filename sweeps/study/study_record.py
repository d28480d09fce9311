"""A study as JSON data, stored in result files next to its text."""

import hashlib
import json
from collections.abc import Mapping
from typing import Any

import numpy as np

from engine import sources_digest
from sweeps.study.sampling import Axis, Columns
from sweeps.study.study_content import StudyContent

# The part that results depend on.
_DECISIVE = ("vary", "derive", "require", "outputs", "positions", "field_precision", "accuracy", "tolerances")
_OF_A_VARIANT = ("derive", "positions", "accuracy")
_WORDS = ("title", "source", "units")


def study_record(study: StudyContent) -> dict[str, Any]:
    """A study as parsed data, numbers in SI.

    Parameters
    ----------
    study : StudyContent

    Returns
    -------
    dict
        `scene` (for `Scene.model_validate`), `parameters` (SI units by name), `vary` (a table per axis: kind, names,
        size and data), `derive` and `require` (expressions as written), `outputs`,
        `positions`, `field_precision`, `accuracy`, `best`, `optimise`, `tolerances`; `engine`, a digest of its sources.
    """
    return {
        "scene": study.scene.model_dump(mode="json"),
        "parameters": {name: study.unit(name) for name in study.parameters},
        "vary": [_axis_record(axis) for axis in study.design.axes],
        "derive": {path: expression.text for path, expression in study.derived.items()},
        "require": [condition.text for condition in study.require],
        "outputs": {
            "summaries": list(study.summaries),
            "fields": list(study.fields),
            "derivatives": [derivative._asdict() for derivative in study.derivatives],
        },
        "positions": study.positions,
        "field_precision": study.field_precision,
        "accuracy": study.accuracy,
        "best": study.best.model_dump() if study.best else None,
        "optimise": study.optimise.model_dump() if study.optimise else None,
        "tolerances": {path: tolerance.model_dump() for path, tolerance in study.tolerances.items()},
        "engine": sources_digest(),
    }


def numbers_record(record: Mapping[str, Any]) -> dict[str, Any]:
    """The part of a study's record that its numbers depend on, without the engine."""
    return {key: record[key] for key in _DECISIVE} | {"scene": _without_words(record["scene"])}


def machine_record(record: Mapping[str, Any]) -> dict[str, Any]:
    """The part of a study's record that a single variant depends on."""
    kept = {key: record[key] for key in (*_OF_A_VARIANT, "engine")}
    return kept | {"scene": _without_words(record["scene"]), "parameters": sorted(record["parameters"])}


def _without_words(scene: Mapping[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in scene.items() if key not in _WORDS}


def study_digest(study: StudyContent) -> str:
    """Digest of a study: scene, variables, outputs and engine.

    Parameters
    ----------
    study : StudyContent
    """
    record = study_record(study)
    content = numbers_record(record) | {"engine": record["engine"]}
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _axis_record(axis: Axis) -> dict[str, Any]:
    """An axis; for a table only the digest, as the result file has its columns."""
    record: dict[str, Any] = {"kind": type(axis).__name__, "names": list(axis.names), "size": axis.size}
    if isinstance(axis, Columns):
        return record | {"sha256": hashlib.sha256(np.ascontiguousarray(axis.table, "<f8").tobytes()).hexdigest()}
    made_of = {key: value for key, value in vars(axis).items() if key not in ("name", "names")}
    return record | {key: value.tolist() if isinstance(value, np.ndarray) else value for key, value in made_of.items()}
