"""Why no variant answers the question: which conditions fail, and the variant that comes closest."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

import engine
from engine import Verdict
from sweeps.report.sweep_result import SweepResult, drop_counts
from sweeps.study.study_content import number_units
from sweeps.text.conditions import Condition, Judgement, Where, parts_of

# Limits that are missed by more than this factor are reported without it.
_FAR = 10.0


class _Asked(NamedTuple):
    """Conditions that no variant meets, and the verdict of the variants to examine."""

    conditions: tuple[Condition, ...]
    verdict: Verdict

    @property
    def names(self) -> list[str]:
        """Names in the conditions."""
        return [name for condition in self.conditions for name in condition.names]


def drop_lines(conditions: Sequence[str], missed: Iterable[np.ndarray], sampled: bool = False) -> list[str]:
    """Variants that fail each condition, and those that fail only it: how many, or their share.

    Parameters
    ----------
    conditions : sequence of str
    missed : iterable of ndarray of bool (conditions, variants)
        Failed conditions, by parts of the variants.
    sampled : bool
        Whether only a sample is given.
    """
    counts, alone, seen = drop_counts(len(conditions), missed)
    lines = []
    for text, *found in zip(conditions, counts.tolist(), alone.tolist(), strict=True):
        first, only = (f"about {100.0 * c / seen:.3g} %" if sampled else f"{c}" for c in found)
        lines.append(f"{text}: {first}" + (f", {only} only by this condition" if len(conditions) > 1 else ""))
    return lines


def outside_lines(
    scene: engine.Scene, columns: Mapping[str, np.ndarray], chosen: np.ndarray | slice = slice(None)
) -> list[str]:
    """For each number with values outside its limits: how many, one of them, and the limits.

    Parameters
    ----------
    scene : engine.Scene
    columns : mapping of str to ndarray (variants,)
        Numbers of variants by path (SI), possibly among others.
    chosen : ndarray of bool, or slice
        Variants to count.
    """
    numbers, units, lines = engine.scene_numbers(scene), number_units(scene), []
    varied = {path: values[chosen] for path, values in columns.items() if path in numbers}
    for path, outside in engine.outside_limits(numbers, varied).items():
        value = varied[path][outside.argmax()] if path in varied else numbers[path].value
        given, allowed = engine.quantity_text(float(value), units[path]), engine.allowed_text(numbers[path])
        lines.append(f"{path}: {outside.sum()}, such as {given}; must be {allowed}")
    return lines


def undecided_text(result: SweepResult, where: Where) -> str:
    """Number of variants undecided within error estimates, as a clause; "" if none."""
    count = result.undecided(where)
    return f"; {count} {'is' if count == 1 else 'are'} undecided within error estimates" if count else ""


def no_answer_text(result: SweepResult, noun: str = "variant") -> str:
    """Why no variant answers the question: how many miss each condition, and which one comes closest.

    Parameters
    ----------
    result : SweepResult
        With an aim that no variant meets.
    noun : str
        What a variant is called.
    """
    aim, counts = result.aim, result.verdict_counts
    if result.count_meeting(aim.where):
        met = " that meet the conditions" if aim.where else ""
        return f"{aim.goal} is undefined for all {noun}s{met}."
    head = f"No {noun} meets all conditions{undecided_text(result, aim.where)}."
    asked = _asked(result)
    if asked is None:
        return f"{head} None could be computed."
    texts, missed = [condition.text for condition in asked.conditions], (rows for _, rows, _ in _judged(result, asked))
    lines = [f"{head} Of {engine.counted(counts[asked.verdict], noun)}, the conditions exclude:"]
    lines += [f"  {line}" for line in drop_lines(texts, missed)]
    return "\n".join([*lines, _closest_text(result, asked, noun)])


def _asked(result: SweepResult) -> _Asked | None:
    """Conditions on the computed variants, or if none is computed those that dropped the others."""
    counts, conditions = result.verdict_counts, parts_of(result.aim.where)
    if counts[Verdict.OK] and conditions:
        return _Asked(conditions, Verdict.OK)
    if counts[Verdict.DROPPED]:
        return _Asked(tuple(part for one in result.requirements.conditions for part in one.parts), Verdict.DROPPED)
    return None


def _judged(result: SweepResult, asked: _Asked) -> Iterator[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Variants, whether they miss each condition, and by which margins (conditions, variants), in parts."""
    for part in result.parts():
        chosen = part.start + np.flatnonzero(result.columns["status"][part] == asked.verdict)
        known = result.known(chosen, asked.names)
        judged: list[Judgement] = [condition.judged(*known, chosen.size) for condition in asked.conditions]
        margins = [condition.margins(*known, chosen.size).max(axis=0) for condition in asked.conditions]
        yield chosen, ~np.array([one.met for one in judged]), np.array(margins)


def _closest_text(result: SweepResult, asked: _Asked, noun: str) -> str:
    """The variant with the smallest miss, and by how much.

    A choice of parameters, `forces.load.scale == 1`, can't be missed by a little: variants that meet all of these come
    first.
    """
    parameters, computed = set(result.parameters), asked.verdict == Verdict.OK
    fixed = [computed and parameters.issuperset(condition.names) for condition in asked.conditions]
    best, nearest = (np.inf, np.inf), (0, np.zeros(len(fixed), bool))
    for chosen, missed, margins in _judged(result, asked):
        if not chosen.size:
            continue
        wrong = (missed & np.array(fixed)[:, None]).sum(axis=0)
        worst = np.where(missed, np.maximum(margins, 0.0), 0.0).max(axis=0)
        k = int(np.lexsort((worst, wrong))[0])
        if (wrong[k], worst[k]) < best:
            best, nearest = (wrong[k], worst[k]), (int(chosen[k]), missed[:, k])
    variant, missed = nearest
    known = result.known(np.array([variant]), asked.names)
    words = [_miss_words(result, c, known) for c, out in zip(asked.conditions, missed, strict=True) if out]
    return f"Closest: {noun} {variant}, which {' and '.join(words)}."


def _miss_words(result: SweepResult, condition: Condition, known: tuple) -> str:
    """By how much a variant misses a condition, such as "exceeds required_power ≤ 1200 kW by 3 %"."""
    plain = condition.text.replace("'", "").replace("<=", "≤").replace(">=", "≥")
    sides = condition.sides(*known)
    if sides is None:
        return f"misses {plain}"
    sign, left, right = sides
    verb = {"<": "exceeds", ">": "falls short of"}.get(sign[0], "misses")
    gap = abs(left - right)
    if not np.isfinite(gap):
        return f"has no value for {plain}"
    if gap == 0.0:
        return f"lies on the limit of {plain}"
    if right != 0.0 and gap <= _FAR * abs(right):
        return f"{verb} {plain} by {engine.figure_text(100 * gap / abs(right), None, 2)} %"
    name = condition.names[0] if len(condition.names) == 1 else ""
    return f"{verb} {plain} by {engine.quantity_text(gap, result.units.get(name, '1'))}" if name else f"misses {plain}"
