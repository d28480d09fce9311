"""Text report on sweep results."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from shlex import quote

import numpy as np

import engine
from sweeps.report import accuracy_words
from sweeps.report.answers.shown_results import hidden_text, lacks_lines, shown_parameters, shown_summaries
from sweeps.report.answers.unmet_conditions import drop_lines, no_answer_text, outside_lines, undecided_text
from sweeps.report.regime_words import MOTION_VERDICTS, by_regime, failure_text, part_words, regime_words
from sweeps.report.sweep_result import SweepResult
from sweeps.text.conditions import Where
from sweeps.text.tables import table


def contents_text(result: SweepResult) -> str:
    """Content of a result: variants done, axes with their sizes, kept fields by axis, and verdicts."""
    count, done = result.file.variants, result.done
    words = f"{engine.counted(count, 'variant')}, all done {result.finished}".rstrip()
    if done < count:
        words = f"{done} of {engine.counted(count, 'variant')} done; run the study again to resume"
    lines = [f"{result.file.title}: {words}"]
    if count > 1:
        axes = [("+".join(axis["names"]), axis["size"]) for axis in result.record["vary"]]
        axes = [("+".join(result.varied), count)] if "search" in result.record else axes
        lines.append(f"varied: {' x '.join(f'{names}[{size}]' for names, size in axes)}")
    kept: dict[str, list[str]] = {}
    for name in result.fields:
        axis = result.along(name)
        over = "positions" if axis.over_positions else f"values of {axis.name}"
        kept.setdefault(f"fields over {axis.values.size} {over}", []).append(name)
    lines += [f"{over}: {', '.join(names)}" for over, names in kept.items()]
    return "\n".join([*lines, counts_text(result)])


def meeting_text(result: SweepResult, where: Where, listed: int = 0) -> str:
    """Number of variants that meet a condition, and of undecided ones; without one, of those that work.

    Parameters
    ----------
    result : SweepResult
    where : Where
    listed : int
        Number of those that are listed below this text.
    """
    count = result.count_meeting(where)
    verb = "meet" if where else "work"
    words = f"variant {verb}s" if count == 1 else f"variants {verb}"
    below = ":" if listed == count else f"; the first {listed}:"
    return f"{count} {words}{' the condition' if where else ''}{undecided_text(result, where)}{below if listed else ''}"


def counts_text(result: SweepResult) -> str:
    """Variants per verdict, with the failing groups and angles."""
    rows = []
    for verdict, count in result.verdict_counts.items():
        sentence = "" if verdict == engine.Verdict.OK else verdict.sentence
        rows.append((f"{count}", verdict.short, sentence))
        dropped = verdict == engine.Verdict.DROPPED
        lines = drop_lines(result.record["require"], result.missed()) if dropped else blame_lines(result, verdict)
        if verdict == engine.Verdict.OUTSIDE_LIMITS:
            lines += outside_lines(result.scene, result.columns, result.columns["status"] == verdict)
        if verdict == engine.Verdict.NOT_FINITE:
            first = result.first_with(verdict)
            lines += [f"variant {first}, the first one, {line}" for line in _lacking(result, first)]
        if verdict in MOTION_VERDICTS and result.file.variants > 1:
            shown = f"sweeps plot {quote(str(result.path))} --variant {result.first_with(verdict)}"
            lines += [f"motion of the first one up to its failure: {shown}"]
        rows += [("", "", line) for line in lines]
    return "\n".join([table(rows), *accuracy_words.of_result(result)])


def _lacking(result: SweepResult, variant: int) -> list[str]:
    """Which summaries a variant lacks; no line if it has none."""
    lacking = [name for name in result.summaries if not np.isfinite(result.columns[name][variant])]
    return lacks_lines(lacking) if len(lacking) < len(result.summaries) else []


def blame_lines(result: SweepResult, verdict: engine.Verdict) -> list[str]:
    """For each failing group, element or regime: count, and range of its first failing positions if it has any.

    Parameters
    ----------
    result : SweepResult
    verdict : Verdict
    """
    groups = result.record["groups"]
    if verdict == engine.Verdict.OK or not groups:
        return []
    status, number, at = (result.columns[name] for name in ("status", "status_group", "status_at"))
    counts, least, most = np.zeros(len(groups), int), np.full(len(groups), np.inf), np.full(len(groups), -np.inf)
    for part in result.parts():
        failed = status[part] == verdict
        for i in np.unique(number[part][failed & (number[part] >= 0)]):
            chosen = at[part][failed & (number[part] == i)]
            counts[i] += chosen.size
            least[i], most[i] = np.fmin.reduce(chosen, initial=least[i]), np.fmax.reduce(chosen, initial=most[i])
    lines = []
    for i in np.flatnonzero(counts):
        first, last = (engine.quantity_text(float(v), result.units["status_at"]) for v in (least[i], most[i]))
        place = f" at {first}" if first == last else f" at {first} … {last}"
        count, place = (f": {counts[i]}", f", first{place}") if result.file.variants > 1 else ("", place)
        lines.append(f"{part_words(groups[i])}{count}{place if least[i] <= most[i] else ''}")
    return lines


def variants_text(result: SweepResult, variants: Iterable[int], names: Sequence[str] = (), every: bool = False) -> str:
    """Table of some variants: parameters and summaries.

    Parameters
    ----------
    result : SweepResult
    variants : iterable of int
    names : sequence of str
        Columns to show with the parameters (default: the answers).
    every : bool
        All summaries, and derived helper numbers.
    """
    shown = list(dict.fromkeys([*shown_parameters(result, every), *(names or shown_summaries(result, every))]))
    variants = [int(variant) for variant in variants]
    units = {name: engine.display_unit(result.units[name], result.columns[name][variants]) for name in shown}
    rows = [["variant", *shown], ["", *(label if label != "1" else "" for _, label in units.values())]]
    for variant in variants:
        cells = [str(variant)]
        for name, (factor, _) in units.items():
            value = result.columns[name][variant]
            error = result.columns.get(f"{name}_error")
            shown = None if error is None else error[variant] * factor
            decides = name in result.deciding(variant)
            cells.append(engine.figure_text(value * factor, shown, 6, decides) if np.isfinite(value) else "–")
        rows.append(cells)
    return table(rows)


def tie_text(rivals: int) -> str:
    """What a number of variants that tie with the best mean."""
    others = f"{rivals} other variants tie" if rivals > 1 else "Another variant ties"
    return f"{others} with the best within the error estimates; choose between them on other grounds."


def answer_text(result: SweepResult, every: bool = False) -> str:
    """The answer to the study's question: the best variant's parameters and results.

    Parameters
    ----------
    result : SweepResult
    every : bool
        All results, also further ones, checks, and derived helper numbers.
    """
    goal, lines = result.goal, [result.question] if result.question else []
    if result.file.variants == 1:
        return "\n".join([*lines, _summaries_text(result, 0, every)])
    if goal is None:
        return no_goal_text(result)
    best = result.best()
    if best is None:
        return "\n".join([*lines, no_answer_text(result)])
    rivals = result.rivals(best)
    lines += [*best_lines(result, best, every), *ends_text(result, best)]
    if undecided_text(result, goal.where):
        lines.append(f"{meeting_text(result, goal.where)}.")
    if rivals:
        lines.append(tie_text(rivals))
    return "\n".join(lines)


def no_goal_text(result: SweepResult) -> str:
    """Why a study has no best variant, and what finds one."""
    if result.record["optimise"]:
        return "The study has no [best], but [optimise]: `sweeps optimise` searches for the best variant."
    return "The study has no [best], so there is no best variant."


def variant_text(result: SweepResult, variant: int, every: bool = False) -> str:
    """A variant's verdict, parameters and summaries.

    Parameters
    ----------
    result : SweepResult
    variant : int
    every : bool
        As for `answer_text`.
    """
    verdict = engine.Verdict(int(result.columns["status"][variant]))
    given = [(name, "=", value_text(result, name, variant)) for name in shown_parameters(result, every)]
    number, groups = result.columns["status_group"][variant], result.record["groups"]
    part = f"{part_words(groups[number])}: " if number >= 0 else ""
    parts = [f"variant {variant}: {part}{verdict.sentence}", table(given, "  ")]
    parts += _lacking(result, variant) if verdict == engine.Verdict.NOT_FINITE else []
    return "\n".join(filter(None, [*parts, _summaries_text(result, variant, every)]))


def _summaries_text(result: SweepResult, variant: int, every: bool) -> str:
    """Summaries of a variant, grouped by regime, or why its motion fails."""
    scene, verdict = result.scene, engine.Verdict(int(result.columns["status"][variant]))
    if not result.summaries:
        plot = f"sweeps plot {quote(str(result.path))}"
        return f"Kept: {', '.join(result.fields)}; `{plot}` draws the machine with its diagrams."
    failed = None if verdict == engine.Verdict.OK else variant
    shown, hidden = shown_summaries(result, every), hidden_text(result, every, failed)
    if failed is not None or not (every or scene.input is None):
        # A link that turns fully has no swing, a dwell no quick-return ratio.
        shown = [name for name in shown if not np.isnan(result.columns[name][variant])]
    if not scene.regimes:
        return "\n".join([table(summary_rows(result, variant, shown), "  "), *hidden])
    parts, moves = [], verdict not in MOTION_VERDICTS
    for regime, names in by_regime(scene, shown).items():
        if regime and not moves:
            continue
        head = f"{regime}: {regime_words(scene, regime)}" if regime else _cycle_words(scene)
        parts.append(f"{head}\n{table(summary_rows(result, variant, names), '  ')}")
    if not moves:
        parts.append(failure_text(result.scene_of(variant), verdict))
    return "\n".join([*parts, *hidden])


def _cycle_words(scene: engine.Scene) -> str:
    speed = engine.quantity_text(abs(scene.input.speed), engine.InputUnits.of(scene).speed)
    if not scene.has_cycle:
        return f"over its range at constant {speed}"
    braked = any(isinstance(moment, engine.Brake) for moment in scene.moments.values())
    return f"cycle at {speed}, constant drive torque, all loads{' except brakes' if braked else ''}"


def summary_rows(result: SweepResult, variant: int, names: Iterable[str]) -> list[tuple[str, ...]]:
    """Summaries of a variant: name, value and meaning."""
    return [(name, "→", value_text(result, name, variant), result.long_names[name]) for name in names]


def ends_text(result: SweepResult, variant: int) -> list[str]:
    """A line on the variables of a variant that lie at an end of their range, if there are any."""
    found = [f"{name} = {value} ({end} of {span})" for name, value, end, span in end_rows(result, variant)]
    return [f"At the end of its range: {', '.join(found)}; a wider range may give a better answer."] if found else []


def end_rows(result: SweepResult, variant: int) -> Iterator[tuple[str, str, str, str]]:
    """Name, value, end and range of each variable of a variant that lies at an end of its range."""
    for name, end in result.range_ends(variant).items():
        span = " … ".join(engine.quantity_text(limit, result.units[name]) for limit in (end.low, end.high))
        yield name, value_text(result, name, variant), end.word, span


def value_text(result: SweepResult, name: str, variant: int) -> str:
    """A variant's value with its unit, and its error estimate if that matters."""
    columns = result.columns
    error = float(columns[f"{name}_error"][variant]) if f"{name}_error" in columns else None
    decides = name in result.deciding(variant)
    return engine.quantity_text(float(columns[name][variant]), result.units[name], error, decides)


def spread_text(result: SweepResult, name: str, variant: int) -> str:
    """A variant's value as by `value_text`, and its standard deviation from tolerances if known."""
    column, text = result.columns, value_text(result, name, variant)
    if f"{name}.tolerance" not in column:
        return text
    # In the value's unit, for comparison.
    factor, label = engine.display_unit(result.units[name], column[name][[variant]])
    return f"{text}, σ {factor * column[f'{name}.tolerance'][variant]:.2g}{'' if label == '1' else f' {label}'}"


def best_lines(result: SweepResult, best: int, every: bool, notes: Mapping[str, str] = {}) -> list[str]:
    """The best variant by the aim of a result, with its parameters and results.

    Parameters
    ----------
    result : SweepResult
    best : int
    every : bool
        Also checks and helper numbers.
    notes : mapping of str to str
        Remarks on parameters.
    """
    goal = result.aim
    condition = f" where {goal.condition}" if goal.where else ""
    head = f"Answer: {goal.word} {goal.goal}{condition}: {spread_text(result, goal.goal, best)}, variant {best}:"
    rows = [(n, "=", spread_text(result, n, best), notes.get(n, "")) for n in shown_parameters(result, every)]
    shown = [name for name in shown_summaries(result, every) if name != goal.goal]
    rows += [(n, "→", spread_text(result, n, best), result.long_names[n]) for n in shown]
    return [head, table(rows, "  "), *hidden_text(result, every)]
