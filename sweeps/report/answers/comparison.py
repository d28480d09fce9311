"""Comparison of two results: best against best, differing scenes, and values within their error estimates."""

from collections.abc import Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np

from engine import Scene, Verdict, described_dimension, quantity_text, scene_numbers, shortened
from sweeps.report.answers.shown_results import shown_parameters, shown_summaries
from sweeps.report.answers.unmet_conditions import no_answer_text
from sweeps.report.result_report import value_text
from sweeps.report.sweep_result import SweepResult
from sweeps.store import VariantIndex
from sweeps.text.conditions import ROUNDING
from sweeps.text.input_files import InputError
from sweeps.text.tables import table

# Variants of the other result that are matched together, to bound memory.
INDEXED = 1 << 23
# Maximum number of listed differences.
MOST_LISTED = 40
# Parts of a record that appear elsewhere or are internal.
_NOT_COMPARED = ("scene", "groups", "parameters", "units")


class Comparison(NamedTuple):
    """Differences of two results.

    Attributes
    ----------
    text : str
    agrees : bool
        Whether all common values of all common variants agree within their error estimates.
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
        No common variants.
    """
    differing = [*_of_records(one, other)]
    parts = [*_best_text(one, other), "Scene and study:", *(differing[:MOST_LISTED] or ["  the same"])]
    if len(differing) > MOST_LISTED:
        parts.append(f"  and {len(differing) - MOST_LISTED} more")
    shared = {name: _Gap(name, one, other) for name in one.summaries if name in other.summaries}
    common, apart, first = 0, 0, (one.file.variants, 0)
    for here, there in _common(one, other):
        differs = one.columns["status"][here] != other.columns["status"][there]
        if differs.any():
            k = int(np.argmax(differs))
            first = min(first, (int(here[k]), int(there[k])))
        common, apart = common + here.size, apart + int(differs.sum())
        for gap in shared.values():
            gap.take(here, there)
        one.release()
        other.release()
    if not common:
        raise InputError.of(str(one.path), f"has no variant in common with {other.path}")
    parts.append(f"Variants: {one.file.variants} and {other.file.variants}, {common} in common")
    if apart:
        pair = [Verdict(int(r.columns["status"][v])).short for r, v in zip((one, other), first, strict=True)]
        parts.append(f"  {apart} with another status, first variant {first[0]}: {' and '.join(pair)}")
    rows = [("", "within", "outside", "the farthest apart"), *(gap.row(common) for gap in shared.values())]
    parts += ["Summaries, number of variants within and outside the sum of both error estimates:", table(rows, "  ")]
    for result, names in ((one, set(one.summaries) - shared.keys()), (other, set(other.summaries) - shared.keys())):
        if names:
            parts.append(f"Only in {result.path}: {', '.join(sorted(names))}")
    return Comparison("\n".join(parts), not apart and not any(gap.outside for gap in shared.values()))


def _best_text(one: SweepResult, other: SweepResult) -> list[str]:
    """Lines on the answers of two results: which number changed by how many per cent."""
    results = (one, other)
    best = [0 if r.file.variants == 1 else None if r.aim is None else r.best(r.aim) for r in results]
    if None in best:
        return [no_answer_text(r) for r, v in zip(results, best, strict=True) if v is None and r.aim is not None]
    questions = dict.fromkeys(r.question for r in results if r.question)
    words = " and ".join(f"variant {v} of {r.path}" for r, v in zip(results, best, strict=True))
    goals = [r.aim.goal for r in results if r.aim]
    names = [*goals, *shown_parameters(one), *shown_summaries(one)]
    known = {*other.parameters, *other.summaries}
    rows = [
        (name, *(value_text(r, name, v) for r, v in zip(results, best, strict=True)), _change(name, results, best))
        for name in dict.fromkeys(names)
        if name in known
    ]
    return [*questions, f"Best against best, {words}:", table(rows, "  ")]


def _change(name: str, results: Sequence[SweepResult], best: Sequence[int]) -> str:
    """Change of a number from one variant to another in per cent; "" within the error estimates."""
    one, other = (float(r.columns[name][v]) for r, v in zip(results, best, strict=True))
    pairs = [(r.columns.get(f"{name}_error"), v) for r, v in zip(results, best, strict=True)]
    errors = [float(column[v]) for column, v in pairs if column is not None]
    if not abs(other - one) > np.nansum(errors) + ROUNDING * max(abs(one), abs(other)) or one == 0.0:
        return ""
    return f"{100.0 * (other - one) / abs(one):+.3g} %".replace("-", "\N{MINUS SIGN}")


def _of_records(one: SweepResult, other: SweepResult) -> Iterator[str]:
    """Lines on differences in scenes and studies."""
    scenes = [scene_numbers(result.scene) for result in (one, other)]
    for path in dict.fromkeys((*scenes[0], *scenes[1])):
        numbers = [scene.get(path) for scene in scenes]
        if numbers[0] != numbers[1]:
            shown = [quantity_text(n.value, described_dimension(n.dimension).unit) if n else "missing" for n in numbers]
            yield f"  {path}: {shown[0]} and {shown[1]}"
    texts = [dict(_leaves(result.record, "")) | dict(_texts(result.scene)) for result in (one, other)]
    for key in dict.fromkeys((*texts[0], *texts[1])):
        pair = [_shown(text[key]) if key in text else "missing" for text in texts]
        if pair[0] != pair[1]:
            yield f"  {key}: {pair[0]} and {pair[1]}"


def _leaves(data: Any, path: str) -> Iterator[tuple[str, Any]]:
    """A record by path; entries of a list by their names or their number."""
    if isinstance(data, dict):
        for key, value in data.items():
            if path or key not in _NOT_COMPARED:
                yield from _leaves(value, f"{path}.{key}" if path else key)
    elif isinstance(data, list) and any(isinstance(entry, dict) for entry in data):
        for i, entry in enumerate(data, 1):
            names = entry.get("names") if isinstance(entry, dict) else None
            yield from _leaves(entry, f"{path}.{', '.join(names) if names else i}")
    else:
        yield path, data


def _texts(scene: Scene) -> Iterator[tuple[str, Any]]:
    """A scene without its numbers."""
    known = scene_numbers(scene)
    return ((path, value) for path, value in _leaves(scene.model_dump(mode="json"), "scene") if path[6:] not in known)


def _shown(value: object) -> str:
    value = ", ".join(map(str, value)) if isinstance(value, list) else value
    return shortened(str(value) if value not in ("", None) else "not given")


def _common(one: SweepResult, other: SweepResult) -> Iterator[tuple[np.ndarray, np.ndarray]]:
    """Variants with equal parameters, ascending in the first result, and the same in the other; in parts."""
    names = [name for name in one.parameters if name in other.parameters]
    of_same_numbers = set(one.parameters) ^ set(other.parameters) or not names
    if of_same_numbers and one.file.variants != other.file.variants:
        message = f"{other.path} has different variables and another number of variants: nothing to compare"
        raise InputError.of(str(one.path), message)
    elsewhere = []
    for part in one.parts():
        if of_same_numbers or all(np.array_equal(one.columns[n][part], other.columns[n][part]) for n in names):
            here = np.arange(part.start, part.stop)
            yield here, here
        else:
            elsewhere.append(part)
    # Other studies have the same variants in other rows.
    seen = np.zeros(one.file.variants if elsewhere else 0, bool)
    for some in other.parts(INDEXED) if elsewhere else ():
        index = VariantIndex(other.columns, names, some)
        for part in elsewhere:
            there = index.variants_of(one.columns, part)
            there[seen[part]] = -1
            found = np.flatnonzero(there >= 0)
            seen[part.start + found] = True
            yield part.start + found, there[found]


class _Gap:
    """Differences of a summary between two results for the same variants."""

    def __init__(self, name: str, one: SweepResult, other: SweepResult) -> None:
        self.name, self.results = name, (one, other)
        self.outside, self.widest, self.farthest = 0, -1.0, (0, 0)

    def take(self, here: np.ndarray, there: np.ndarray) -> None:
        """Add some variants of one result, and the same of the other."""
        (one, other), error = (result.columns for result in self.results), f"{self.name}_error"
        a, b, figures = one[self.name][here], other[self.name][there], one[error][here] + other[error][there]
        with np.errstate(invalid="ignore"):
            gap = np.abs(a - b)
            within = gap <= np.nan_to_num(figures) + ROUNDING * np.maximum(np.abs(a), np.abs(b))
        within |= np.isnan(a) & np.isnan(b)
        if within.all():
            return
        self.outside += int((~within).sum())
        gap = np.where(within, -1.0, np.nan_to_num(gap, nan=np.inf))
        k = int(np.argmax(gap))
        if (gap[k], -here[k]) > (self.widest, -self.farthest[0]):
            self.widest, self.farthest = float(gap[k]), (int(here[k]), int(there[k]))

    def row(self, common: int) -> tuple[str, ...]:
        """Row of the table: how many common variants agree."""
        if not self.outside:
            return self.name, str(common), "0", ""
        pairs = zip(self.results, self.farthest, strict=True)
        values = [quantity_text(float(r.columns[self.name][v]), r.units[self.name]) for r, v in pairs]
        widest = f"variant {self.farthest[0]}: {values[0]} and {values[1]}"
        return self.name, str(common - self.outside), str(self.outside), widest
