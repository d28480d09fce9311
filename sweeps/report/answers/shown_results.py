"""Which numbers of a result are shown: the answers first, checks and helper numbers only on request."""

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from shlex import quote

import numpy as np

from engine import Rank, any_quantity, made_ready, parse_expression, scene_numbers
from sweeps.report.sweep_result import SweepResult
from sweeps.study.default_summaries import answers, default_summaries
from sweeps.study.study_content import ReadyMachine
from sweeps.study.study_text import Best

# Maximum number of undefined results named in a line.
MOST_LACKING = 4


def shown_parameters(result: SweepResult, every: bool = False) -> tuple[str, ...]:
    """Parameters to show: numbers of the machine, variables, and numbers in conditions.

    Parameters
    ----------
    result : SweepResult
    every : bool
        Also helper numbers that the study derives.
    """
    if every:
        return result.parameters
    numbers = {*scene_numbers(result.scene), *result.varied, *_in_conditions(result)}
    return tuple(name for name in result.parameters if name in numbers)


@lru_cache(4)
def shown_summaries(result: SweepResult, every: bool = False) -> tuple[str, ...]:
    """Summaries to show: those that the study requests, without checks, or the answers if it requests none.

    Parameters
    ----------
    result : SweepResult
    every : bool
        All of them.
    """
    if every:
        return result.summaries
    machine = made_ready(result.scene) if result.study is None else result.study.machine()
    return answers_among(machine, result.summaries, _in_conditions(result))


def answers_among(machine: ReadyMachine, summaries: Sequence[str], in_conditions: Iterable[str]) -> tuple[str, ...]:
    """Summaries that an engineer wants, in the order in which they are read.

    Parameters
    ----------
    machine : Machine or ElementsAlone
    summaries : sequence of str
        Those of a study.
    in_conditions : iterable of str
        Names that its goal and conditions use, which belong to the answers.
    """
    wanted, asked = set(in_conditions), answers(machine)
    if set(default_summaries(machine)) <= set(summaries):
        chosen = (*asked, *(name for name in summaries if name in wanted))
        return tuple(name for name in dict.fromkeys(chosen) if name in summaries)
    checks = {name for name, quantity in machine.available_summaries.items() if quantity.rank == Rank.CHECK} - wanted
    first = [name for name in asked if name in summaries]
    return tuple(name for name in dict.fromkeys([*first, *summaries]) if name not in checks)


def hidden_text(result: SweepResult, every: bool = False, failed: int | None = None) -> list[str]:
    """A line on the number of results that are not shown, and how to show them, if there are any.

    Of a `failed` variant only the known ones count.
    """
    hidden = {*result.parameters, *result.summaries} - {*shown_parameters(result, every)}
    hidden -= {*shown_summaries(result, every)}
    if failed is not None:
        hidden = {name for name in hidden if not np.isnan(result.columns[name][failed])}
    return [f"{len(hidden)} more with `sweeps show {quote(str(result.path))} --all`."] if hidden else []


def lacks_lines(names: Sequence[str]) -> list[str]:
    """A line on the results that are infinite or undefined, if there are any."""
    more = f" and {len(names) - MOST_LACKING} more" if len(names) > MOST_LACKING else ""
    return [f"lacks {', '.join(names[:MOST_LACKING])}{more}"] if names else []


def _in_conditions(result: SweepResult) -> Iterator[str]:
    """Names that the goal and the conditions of a study use."""
    return names_in_conditions(result.record["require"], result.aim)


def names_in_conditions(require: Iterable[str], aim: Best | None) -> Iterator[str]:
    """Names that some conditions and a goal use."""
    texts = [*require, *(aim.where if aim else ())]
    yield from (name for text in texts for name in parse_expression(text, any_quantity).names)
    if aim:
        yield aim.goal
