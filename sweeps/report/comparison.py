"""Two results beside each other: what differs in scene and study, and which values agree within their figures."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from engine import Scene, Verdict, described_dimension, scene_numbers
from sweeps.report.sweep_result import SweepResult
from sweeps.text.engineer_units import quantity_text
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

# What is rounding whatever the figures say, as a share of a value.
ROUNDING = 4 * np.finfo(float).eps
# Differences that are listed of a scene and study.
MOST_LISTED = 40
# Of a record what is told otherwise, or says nothing to a reader.
_NOT_COMPARED = ("scene", "groups", "parameters", "units")


class Comparison(NamedTuple):
    """How two results differ.

    Attributes
    ----------
    text : str
    agrees : bool
        Whether all common values of all common variants agree within their figures.
    """

    text: str
    agrees: bool


def comparison(one: SweepResult, other: SweepResult) -> Comparison:
    """Compare two results.

    Parameters
    ----------
    one, other : SweepResult

    Raises
    ------
    InputError
        They have no variant in common.
    """
    told = [*_of_records(one, other)]
    parts = ["Scene and study:", *(told[:MOST_LISTED] or ["  the same"])]
    if len(told) > MOST_LISTED:
        parts.append(f"  and {len(told) - MOST_LISTED} more")
    here, there = _common(one, other)
    parts.append(f"Variants: {one.description.variants} and {other.description.variants}, {here.size} in common")
    apart = one.columns["status"][here] != other.columns["status"][there]
    if apart.any():
        first = int(np.argmax(apart))
        pair = [Verdict(int(r.columns["status"][v[first]])).name.lower() for r, v in ((one, here), (other, there))]
        parts.append(f"  {int(apart.sum())} with another status, first variant {here[first]}: {' and '.join(pair)}")
    shared = [name for name in one.summaries if name in other.summaries]
    rows = [("", "within", "outside", "the farthest apart")]
    agrees = not apart.any()
    for name in shared:
        row, outside = _of_summary(name, one, other, here, there)
        rows.append(row)
        agrees &= outside == 0
    parts += ["Summaries, as many variants within and outside the sum of both error figures:", table(rows, "  ")]
    for result, names in ((one, set(one.summaries) - set(shared)), (other, set(other.summaries) - set(shared))):
        if names:
            parts.append(f"Only in {result.path}: {', '.join(sorted(names))}")
    return Comparison("\n".join(parts), bool(agrees))


def _of_records(one: SweepResult, other: SweepResult) -> Iterator[str]:
    """Lines on what differs in scenes and studies."""
    scenes = [scene_numbers(result.scene) for result in (one, other)]
    for path in dict.fromkeys((*scenes[0], *scenes[1])):
        numbers = [scene.get(path) for scene in scenes]
        if numbers[0] != numbers[1]:
            shown = [
                quantity_text(n.value, described_dimension(n.dimension).unit) if n else "not there" for n in numbers
            ]
            yield f"  {path}: {shown[0]} and {shown[1]}"
    texts = [dict(_leaves(result.record, "")) | dict(_texts(result.scene)) for result in (one, other)]
    for key in dict.fromkeys((*texts[0], *texts[1])):
        pair = [_shown(text[key]) if key in text else "not there" for text in texts]
        if pair[0] != pair[1]:
            yield f"  {key}: {pair[0]} and {pair[1]}"


def _leaves(data: Any, path: str) -> Iterator[tuple[str, Any]]:
    """What a record says, by path; lists whole."""
    if isinstance(data, dict):
        for key, value in data.items():
            if path or key not in _NOT_COMPARED:
                yield from _leaves(value, f"{path}.{key}" if path else key)
    else:
        yield path, data


def _texts(scene: Scene) -> Iterator[tuple[str, Any]]:
    """What a scene has besides its numbers."""
    known = scene_numbers(scene)
    return ((path, value) for path, value in _leaves(scene.model_dump(mode="json"), "scene") if path[6:] not in known)


def _shown(value: object) -> str:
    text = str(value) if value not in ("", None) else "nothing"
    return text if len(text) <= 60 else text[:57] + "..."


def _common(one: SweepResult, other: SweepResult) -> tuple[np.ndarray, np.ndarray]:
    """Variants with the same parameters, in each result."""
    names = [name for name in one.parameters if name in other.parameters]
    if set(one.parameters) ^ set(other.parameters) or not names:
        count = min(one.description.variants, other.description.variants)
        if one.description.variants != other.description.variants:
            message = f"{other.path} varies other parameters, and has another number of variants: nothing to compare"
            raise InputError(str(one.path), [(None, "", message)])
        return np.arange(count), np.arange(count)
    rows = [np.stack([result.columns[name] for name in names], axis=1).tolist() for result in (one, other)]
    places = {tuple(row): i for i, row in enumerate(rows[1])}
    pairs = [(i, places[tuple(row)]) for i, row in enumerate(rows[0]) if tuple(row) in places]
    if not pairs:
        raise InputError(str(one.path), [(None, "", f"has no variant in common with {other.path}")])
    here, there = np.array(pairs).T
    return here, there


def _of_summary(
    name: str, one: SweepResult, other: SweepResult, here: np.ndarray, there: np.ndarray
) -> tuple[tuple[str, ...], int]:
    """Row on a summary, and in how many variants it is outside the figures."""
    a, b = one.columns[name][here], other.columns[name][there]
    figures = one.columns[f"{name}_error"][here] + other.columns[f"{name}_error"][there]
    with np.errstate(invalid="ignore"):
        gap = np.abs(a - b)
        within = gap <= np.nan_to_num(figures) + ROUNDING * np.maximum(np.abs(a), np.abs(b))
    within |= np.isnan(a) & np.isnan(b)
    outside = int((~within).sum())
    if not outside:
        return (name, str(a.size), "0", ""), 0
    farthest = int(np.nanargmax(np.where(within, -1.0, np.nan_to_num(gap, nan=np.inf))))
    unit = one.units[name]
    values = [quantity_text(float(v[farthest]), unit) for v in (a, b)]
    return (
        name,
        str(a.size - outside),
        str(outside),
        f"variant {here[farthest]}: {values[0]} and {values[1]}",
    ), outside
