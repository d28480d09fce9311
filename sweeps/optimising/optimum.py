"""The answer of a search: its best candidate, or chosen ones of its front, and the active limits."""

from typing import NamedTuple

import numpy as np

from engine import Verdict
from sweeps.report.answers.shown_results import hidden_text, shown_parameters, shown_summaries
from sweeps.report.answers.unmet_conditions import no_answer_text
from sweeps.report.result_report import best_lines, ends_text, spread_text
from sweeps.report.sweep_result import SweepResult
from sweeps.text.conditions import Condition, met_by
from sweeps.text.tables import table

# Closer to a limit than this share of the range counts as on it.
ON_LIMIT = 1e-6
BOUNDS = {"minimum": "lower bound", "maximum": "upper bound"}


class Choice(NamedTuple):
    """A notable candidate of a front, and why."""

    variant: int
    why: str


def is_front(result: SweepResult) -> bool:
    """Whether a result file is a finished search with several objectives."""
    return is_search(result) and len(objectives(result)) > 1


def is_search(result: SweepResult) -> bool:
    """Whether a result file is a finished search."""
    return "search" in result.record and "front" in result.columns


def objectives(result: SweepResult) -> list[tuple[str, float]]:
    """Columns that were minimised (sign +1) or maximised (−1)."""
    goals = result.record["search"]["objectives"]
    return [(goal["name"], 1.0 if goal["way"] == "minimise" else -1.0) for goal in goals]


def front(result: SweepResult) -> np.ndarray:
    """Variants on the Pareto front, in order."""
    places = result.columns["front"]
    there = np.flatnonzero(places)
    return there[np.argsort(places[there])]


def met(result: SweepResult) -> np.ndarray:
    """Feasible candidates (candidates,)."""
    there, known = result.columns["status"] == Verdict.OK, result.requirements.known(result.columns)
    return there & met_by(_conditions(result), *known, there.size)


def _conditions(result: SweepResult) -> list[Condition]:
    """Conditions on results, not on parameters."""
    return [Condition.parse(text) for text in result.record["search"]["where"]]


def choices(result: SweepResult) -> list[Choice]:
    """The best of each objective, and the knee of the front.

    Objectives are scaled by their range over the front. For two objectives the knee is the point farthest from the line
    through the ends of the front (Das, "On characterizing the knee of the Pareto curve", Struct. Optim. 18, 1999).
    """
    there, goals = front(result), objectives(result)
    if not there.size:
        return []
    costs = np.column_stack([sign * result.columns[name][there] for name, sign in goals])
    words = [f"{'minimum' if sign > 0 else 'maximum'} {name}" for name, sign in goals]
    # Ties go to the better one in the other objectives.
    ends = [int(np.lexsort((costs.sum(axis=1), column))[0]) for column in costs.T]
    found = [Choice(int(there[k]), why) for k, why in zip(ends, words, strict=True)]
    ranges = np.ptp(costs, axis=0)
    if len(goals) > 1 and (ranges > 0).all():
        knee = int(there[np.argmin((costs / ranges).sum(axis=1))])
        if knee not in [choice.variant for choice in found]:
            found.append(Choice(knee, "knee"))
    return found


def answering(result: SweepResult) -> list[int]:
    """Variants that answer the question: the only one, the choices of a search, or the best."""
    if is_search(result):
        return [choice.variant for choice in choices(result)]
    best = 0 if result.file.variants == 1 else result.best()
    return [] if best is None else [best]


def optimum_text(result: SweepResult, every: bool = False) -> str:
    """The answer of a search: the best candidate with its active limits, or chosen candidates of the front.

    Parameters
    ----------
    result : SweepResult
    every : bool
        All results, also further ones, checks, and derived helper numbers.
    """
    search, there = result.record["search"], front(result)
    head = [result.question] if result.question else []
    found = f"{search['method']}, seed {search['seed']}: {result.file.attributes.get('outcome', '')}"
    if not there.size:
        return "\n".join([*head, no_answer_text(result, "candidate"), found])
    if is_front(result):
        return "\n".join([*head, _choices_text(result, every), f"{found}, {there.size} of them on the front"])
    return "\n".join([*head, _best_text(result, int(there[0]), every), found])


def _choices_text(result: SweepResult, every: bool) -> str:
    chosen = choices(result)
    goals = [name for name, _ in objectives(result)]
    rows = [("", *(f"variant {choice.variant}" for choice in chosen)), ("", *(choice.why for choice in chosen))]
    for name in dict.fromkeys([*goals, *shown_parameters(result, every), *shown_summaries(result, every)]):
        rows.append((name, *(spread_text(result, name, choice.variant) for choice in chosen)))
    return "\n".join(["Chosen from the front:", table(rows, "  "), *hidden_text(result, every)])


def _best_text(result: SweepResult, best: int, every: bool) -> str:
    ends = {name: BOUNDS[end.word] for name, end in result.range_ends(best).items()}
    lines = best_lines(result, best, every, ends)
    limits = _limits(result, best)
    lines += [f"on the limit of: {text}" for text in limits]
    lines += ends_text(result, best)
    if not limits and not ends:
        lines.append("inside all ranges and conditions")
    return "\n".join(lines)


def _limits(result: SweepResult, variant: int) -> list[str]:
    """Active conditions of a candidate, split at `and`; equalities are always active."""
    known = result.requirements.known({name: row[variant : variant + 1] for name, row in result.columns.items()})
    found = []
    for part in (part for one in (*result.requirements.conditions, *_conditions(result)) for part in one.parts):
        if not part.is_equality and (np.abs(part.margins(*known, 1)) <= ON_LIMIT).any():
            found.append(part.text)
    return found
