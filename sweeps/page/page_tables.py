"""Tables of the report: the best machine, its active conditions, its sensitivities, the best variants."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from engine import Verdict, display_unit, figure_text, quantity_text
from sweeps.page.digest import Digest
from sweeps.report.answers.shown_results import shown_summaries
from sweeps.report.regime_words import by_regime, regime_words
from sweeps.report.result_report import blame_lines, end_rows, value_text
from sweeps.report.sweep_result import drop_counts
from sweeps.study.sensitivity import RSS, WORST_CASE

MOST_ROWS = 20
# Relative distance from a limit below which a variant counts as on it.
NEAR = 1e-6


class PageTable(NamedTuple):
    """A table of the report.

    Attributes
    ----------
    head : sequence of str
        Headings, or nothing.
    rows : sequence of sequence of str
    numbers : sequence of int
        Columns of numbers, right-aligned.
    """

    head: Sequence[str]
    rows: Sequence[Sequence[str]]
    numbers: Sequence[int] = ()


def value_tables(digest: Digest) -> Iterator[tuple[str, PageTable]]:
    """Tables of the best or only machine; some may be empty."""
    result, variant = digest.result, digest.drawn
    if variant is None:
        return
    names = result.long_names
    rows = [(name, value_text(result, name, variant)) for name in result.parameters]
    yield f"Numbers of variant {variant}", PageTable(("number", "value"), rows, (1,))
    shown = shown_summaries(result)
    head = ("result", "value ± error estimate", "meaning")
    for regime, chosen in by_regime(result.scene, shown).items():
        rows = [(name, value_text(result, name, variant), names[name]) for name in chosen]
        heading = f"{regime}: {regime_words(result.scene, regime)}" if regime else "Results"
        yield heading, PageTable(head, rows, (1,))
    rows = [(name, value_text(result, name, variant), names[name]) for name in result.summaries if name not in shown]
    yield "Further results and checks", PageTable(head, rows, (1,))


# Limits and sensitivities


def limit_tables(digest: Digest) -> Iterator[tuple[str, PageTable]]:
    """Tables of the best variant's limits, each with a caption; some may be empty."""
    aim = digest.aim
    if aim is None:
        return
    rows = []
    for price in digest.prices:
        without, gain = "", ""
        if price.without is not None:
            without = f"{value_text(digest.result, aim.goal, price.without)}, variant {price.without}"
            gain = "inactive" if price.without == digest.best else "active"
        rows.append((price.text, _room(price.margin), gain, without))
    words = "Active: without this condition the optimum would change. Margin: relative distance from the limit."
    yield words, PageTable(("condition", "margin", "", f"{aim.word} {aim.goal} without it"), rows, (1,))
    required = digest.result.record["require"]
    if required:
        counts, alone, _ = drop_counts(len(required), digest.result.missed())
        rows = [(text, *map(str, found)) for text, *found in zip(required, counts, alone, strict=True)]
        head = ("required", "variants dropped", "only by this")
        yield "Variants dropped before computation:", PageTable(head, rows, (1, 2))
    if digest.best is not None:
        words = "These numbers lie at the end of their range; a wider range may give a better answer:"
        yield words, PageTable(("number", "value", "", "tried"), [*end_rows(digest.result, digest.best)], (1,))


def _room(margin: float) -> str:
    if np.isnan(margin):
        return "–"
    return "on its limit" if abs(margin) < NEAR else f"{margin:.2%}"


def sensitivity_tables(digest: Digest) -> Iterator[tuple[str, PageTable]]:
    """Tables of the best variant's sensitivities, each with a caption; some may be empty."""
    result, best = digest.result, digest.drawn
    variant = 0 if digest.is_one else best
    if variant is None:
        return
    asked = [name for name in result.summaries if ".by." in name]
    rows = [(*name.split(".by.", 1), value_text(result, name, variant)) for name in asked]
    yield f"Derivatives at variant {variant}:", PageTable(("of", "by", "derivative ± error estimate"), rows, (2,))
    banded = [name for name in result.summaries if f"{name}.{RSS}" in result.units]
    rows = [
        (name, *(f"± {value_text(result, f'{name}.{kind}', variant)}" for kind in (WORST_CASE, RSS))) for name in banded
    ]
    head = ("result", "worst case", "root of the sum of squares")
    yield "Effect of tolerances, to first order:", PageTable(head, rows, (1, 2))
    if digest.aim is None or digest.best is None:
        return
    best = value_text(result, digest.aim.goal, digest.best)
    rows = [(", ".join(n.names), _step(digest, n.below), best, _step(digest, n.above)) for n in digest.neighbours]
    head, words = ("number", "one step below", "best", "one step above"), f"{digest.aim.goal} one grid step away"
    yield f"{words} (in brackets: misses the condition):", PageTable(head, rows, (1, 2, 3))
    words = (
        f"Correlation of {digest.aim.goal} with each variable over the variants shown (Spearman's rank "
        "correlation: 1 always rising, −1 always falling):"
    )
    yield words, PageTable(("number", "rank correlation"), _ranks(digest), (1,))


def _step(digest: Digest, variant: int | None) -> str:
    if variant is None:
        return "end of its range"
    result, goal = digest.result, digest.aim.goal
    verdict = Verdict(int(result.columns["status"][variant]))
    if verdict != Verdict.OK:
        return verdict.short
    value = quantity_text(float(result.columns[goal][variant]), result.units[goal])
    return value if result.meets(digest.where)(np.array([variant]))[0] else f"({value})"


def _ranks(digest: Digest) -> list[tuple[str, str]]:
    # Slow import (0.5 s).
    from scipy.stats import spearmanr

    rows, goal = digest.rows, digest.aim.goal
    works, found = np.isfinite(rows[goal]), {}
    for name in digest.result.varied:
        pair = rows[name][works], rows[goal][works]
        if works.sum() > 10 and all(np.ptp(values) > 0 for values in pair):
            found[name] = float(spearmanr(*pair).statistic)
    ordered = sorted(found.items(), key=lambda pair: -abs(pair[1]))
    return [(name, f"{rank:+z.2f}".replace("-", "\N{MINUS SIGN}")) for name, rank in ordered]


# Tables of all variants


def leaders_table(digest: Digest) -> PageTable:
    """The best variants, one per row."""
    result, shown = digest.result, digest.leaders[:MOST_ROWS]
    decisive = [digest.aim.goal] if digest.aim else []
    asked = [name for part in digest.conditions for name in part.names if name in result.summaries]
    # A printed page only has space for the first ones.
    names = list(dict.fromkeys([*decisive, *result.varied, *asked, *result.parameters, *result.summaries]))
    head, columns = ["variant"], [map(str, shown)]
    for name in names:
        values = result.columns[name][shown]
        factor, unit = display_unit(result.units[name], values)
        head.append(name if unit in ("", "1") else f"{name}, {unit}")
        columns.append([figure_text(factor * value, None, 6) if np.isfinite(value) else "–" for value in values])
    return PageTable(head, list(zip(*columns, strict=True)), range(len(head)))


def errors_table(digest: Digest) -> PageTable:
    """Error estimates of the shown variant, and the largest ones."""
    result, variant, rows = digest.result, digest.drawn, []
    for name, share in digest.worst_errors.items():
        error = None if variant is None else float(result.columns[f"{name}_error"][variant])
        here = "–" if error is None else quantity_text(error, result.units[name])
        rows.append((name, here, f"{share:.1g}" if share else "0"))
    where = "error estimate" if variant is None else f"error estimate of variant {variant}"
    return PageTable(("result", where, "maximum, relative"), rows, (1, 2))


def verdicts_table(digest: Digest) -> PageTable:
    """Number of variants per verdict."""
    rows = [
        (verdict.short, str(count), "; ".join(blame_lines(digest.result, verdict)), verdict.sentence)
        for verdict, count in sorted(digest.result.verdict_counts.items())
    ]
    return PageTable(("verdict", "variants", "where", "meaning"), rows, (1,))


def provenance_table(digest: Digest) -> PageTable:
    """Origin of a result."""
    result = digest.result
    attributes = result.file.attributes
    rows = [
        ("result file", result.path.name),
        ("study", attributes.get("study_hash", "")),
        ("computed on", result.finished),
        ("computed by", attributes.get("versions", "")),
        ("machine", attributes.get("machine", "")),
    ]
    if result.accuracy:
        rows.append(("requested accuracy", f"{result.accuracy:g}"))
    if "source" in result.record["scene"] and result.record["scene"]["source"]:
        rows.append(("scene from", str(result.record["scene"]["source"])))
    if "search" in result.record:
        search = result.record["search"]
        rows.append(("searched by", f"{search['method']}, seed {search['seed']}"))
    return PageTable((), rows)
