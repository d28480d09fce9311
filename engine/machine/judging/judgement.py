"""Verdicts on variants that fail on their cycle or on a part of it, with the group responsible and the position."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.machine import judging
from engine.machine.measuring.conditions import ON_MARGINS, SINGULAR_SINE
from engine.machine.measuring.measured_cycles import MeasuredCycles
from engine.machine.measuring.measuring import Measuring
from engine.machine.results import Outcome
from engine.scene.scene import Numbers
from engine.words.verdicts import Verdict

# A run that reverses within this distance of a singular position counts as having reached it [rad, for a range of 2π]:
# near a dead centre of the driven side, only the step error decides where the input comes to a standstill.
NEAR_SINGULAR = 1e-6
# Verdicts of a group of free links on its assembly mode.
_ON_MODES = (Verdict.CANNOT_ASSEMBLE, Verdict.SINGULAR, Verdict.MODE_NOT_REACHED, Verdict.OTHER_MODE)


class Failures(NamedTuple):
    """Positions at which groups of some variants fail; arrays (variants,).

    Attributes
    ----------
    verdict : ndarray of uint8
        OK if there is no such position.
    group : ndarray of int
        Index of the group responsible among all of the machine; −1 if there is none.
    place : ndarray
        Position of the input; NaN if there is none.
    """

    verdict: np.ndarray
    group: np.ndarray
    place: np.ndarray

    @classmethod
    def none(cls, variants: int) -> "Failures":
        """No failures yet."""
        return cls(np.full(variants, Verdict.OK, np.uint8), np.full(variants, -1), np.full(variants, np.nan))

    def blame(self, who: np.ndarray, verdict: Verdict | np.ndarray, group: int, place: np.ndarray) -> None:
        """Blame a group for the failure of the variants `who`."""
        self.verdict[who], self.group[who], self.place[who] = verdict, group, place

    def write(self, outcome: Outcome, who: np.ndarray) -> None:
        """Write them into an outcome, in which the variants have the indices `who`."""
        fails = self.verdict != Verdict.OK
        for column, part in zip((outcome.status, outcome.status_group, outcome.status_at), self, strict=True):
            column[who[fails]] = part[fails]


class Watched(NamedTuple):
    """A curve of a group that fails, and failures that lie between the positions examined: variants, positions."""

    group: int
    curve: Node
    hidden: np.ndarray
    place: np.ndarray


def judge_cycles(
    measuring: Measuring,
    numbers: Numbers,
    table: np.ndarray,
    answers: MeasuredCycles,
    undefined: np.ndarray,
    outcome: Outcome,
    keep: np.ndarray,
) -> None:
    """Give every variant the verdict on its cycle, and failing ones the group responsible and the position.

    Parameters
    ----------
    measuring : Measuring
    numbers : Numbers
        Numbers of the variants.
    table : ndarray (numbers, variants)
        Including the numbers found on the cycle.
    answers : MeasuredCycles
        Measurements for this table.
    undefined : ndarray (variants,) of bool
        Whether a requested quantity is undefined.
    outcome : Outcome
        Modified in place.
    keep : ndarray of int
        Indices of the variants in it.
    """
    failures_of(measuring, table, answers).write(outcome, keep)
    for verdict in ON_MARGINS:
        ok = outcome.status[keep] == Verdict.OK
        _failing_margins(measuring, table, answers, verdict, ok).write(outcome, keep)
    for winding in measuring.windings:
        wound = np.abs(answers.value_of(winding).value) > math.pi
        outcome.status[keep[wound & (outcome.status[keep] == Verdict.OK)]] = Verdict.DOES_NOT_CLOSE
    outcome.status[keep[undefined & (outcome.status[keep] == Verdict.OK)]] = Verdict.NOT_FINITE
    for group, tables in measuring.mechanics.kinematics.seed_tables.items():
        if group in measuring.groups:
            found, k = tables(numbers), measuring.all_groups.index(group)
            _judge_modes(*(np.broadcast_to(part, keep.shape) for part in (found.verdict, found.at)), k, outcome, keep)


def _judge_modes(verdict: np.ndarray, at: np.ndarray, group: int, outcome: Outcome, keep: np.ndarray) -> None:
    """Judge variants in which a group of free links doesn't keep its assembly mode."""
    # A failure in an earlier group leaves this one without a path.
    fails = np.isin(outcome.status_group[keep], [-1, group]) & np.isin(verdict, _ON_MODES)
    failures = Failures.none(keep.size)
    failures.blame(fails, verdict[fails], group, at[fails])
    failures.write(outcome, keep)
    # A complete path has all positions, but between two of its seeds none may be proved.
    lost = (outcome.status_group[keep] == group) & (outcome.status[keep] == Verdict.CANNOT_ASSEMBLE)
    outcome.status[keep[lost & (verdict == Verdict.OK)]] = Verdict.MODE_NOT_REACHED


def judge_runs(
    measuring: Measuring, numbers: Numbers, covered: np.ndarray, verdict: np.ndarray, outcome: Outcome, who: np.ndarray
) -> np.ndarray:
    """Give variants that fail somewhere on the cycle the verdict of their runs, if no run reaches the failure.

    A run that becomes infinite or NaN has failed at a position of the cycle.

    Parameters
    ----------
    measuring : Measuring
    numbers : Numbers
        Numbers of the variants.
    covered : ndarray (runs, 2, variants)
        Minimum and maximum position of each run, as for `failures_within`.
    verdict : ndarray (variants,)
        Verdicts on the runs.
    outcome : Outcome
        Modified in place.
    who : ndarray of int
        Indices of the variants in it.

    Returns
    -------
    ndarray (variants,)
        Rounding error of accelerations in the runs.
    """
    rounding, ran = np.zeros(who.size), verdict != Verdict.NOT_FINITE
    outcome.status[who[ran]], outcome.status_group[who[ran]], outcome.status_at[who[ran]] = verdict[ran], -1, np.nan
    # The first run that fails gives the verdict.
    for positions in covered[::-1]:
        failures, of_run = failures_within(measuring, numbers, positions)
        rounding = np.fmax(rounding, of_run)
        failures.write(outcome, who)
    return rounding


def failures_of(measuring: Measuring, table: np.ndarray, answers: MeasuredCycles) -> Failures:
    """Dead centres of variants, and positions at which they can't be assembled; parameters as for `judge_cycles`."""
    broken, count = answers.outcome.broken_at, table.shape[1]
    failures, singular, sines = Failures.none(count), np.zeros(count, bool), answers.sines()
    groups = [measuring.all_groups.index(group) for group in measuring.groups]
    # If all groups can be assembled, infinite values may result from the dead centre.
    assembled = ~np.isnan([least for least, _ in sines]).any(axis=0)
    for group, (least, place) in zip(groups, sines, strict=True):
        fails = (least < SINGULAR_SINE) & ~singular & assembled
        failures.blame(fails, Verdict.SINGULAR, group, place[fails])
        singular |= fails
    lost = np.flatnonzero(~np.isnan(broken) & ~singular)
    # At the limit of the links' reach, positions differ by rounding.
    watched = [
        Watched(group, curve, np.isnan(least) & np.isfinite(broken), broken)
        for group, (curve, _), (least, _) in zip(groups, measuring.vanishing, sines, strict=True)
    ]
    _blame_first(failures, measuring, table, lost, Verdict.CANNOT_ASSEMBLE, watched)
    return failures


def failures_within(measuring: Measuring, numbers: Numbers, covered: np.ndarray) -> tuple[Failures, np.ndarray]:
    """Failures of variants over the ranges of the input that their runs cover.

    Parameters
    ----------
    measuring : Measuring
    numbers : Numbers
        Numbers of the variants.
    covered : ndarray (2, variants)
        Minimum and maximum position; a range longer than a cycle is limited to one; a NaN range has no failures.

    Returns
    -------
    failures : Failures
        Groups that are singular, or can't be assembled.
    rounding : ndarray (variants,)
        Rounding error of accelerations and forces at the worst transmission, relative to their maximum.
    """
    table, ends = measuring.numbers(numbers, covered.shape[1]), list(measuring.ends)
    (low, high), bounds = covered, np.sort(table[ends], axis=0)
    length = bounds[1] - bounds[0]
    if measuring.mechanics.has_cycle:
        turns = np.floor(low / length) * length
        low, high = low - turns - NEAR_SINGULAR, np.fmin(high - turns + NEAR_SINGULAR, low - turns + length)
    else:
        near = NEAR_SINGULAR * length / math.tau
        low, high = np.fmax(low - near, bounds[0]), np.fmin(high + near, bounds[1])
    table[ends] = np.where(np.isnan(covered), np.nan, [low, high])
    answers = measuring(table)
    measuring.fill_found(table, answers.outcome.landmarks)
    found = failures_of(measuring, table, answers)
    if measuring.mechanics.has_cycle:
        found = found._replace(place=np.mod(found.place, length))
    return found, answers.rounding_of_rates


def _failing_margins(
    measuring: Measuring, table: np.ndarray, answers: MeasuredCycles, verdict: Verdict, ok: np.ndarray
) -> Failures:
    """Failures of variants `ok` in which one of the margins with this verdict is not positive throughout."""
    failures, watched = Failures.none(ok.size), []
    for margin in measuring.margins:
        if margin.verdict == verdict:
            least, place = answers.least_of(margin)
            watched.append(Watched(measuring.all_groups.index(margin.group), margin.curve, least <= 0.0, place))
    fails = ok & np.any([one.hidden for one in watched], axis=0)
    _blame_first(failures, measuring, table, np.flatnonzero(fails), verdict, watched, lambda values: ~(values > 0.0))
    return failures


def _blame_first(
    failures: Failures,
    measuring: Measuring,
    table: np.ndarray,
    who: np.ndarray,
    verdict: Verdict,
    watched: Sequence[Watched],
    fails: Callable[[np.ndarray], np.ndarray] = np.isnan,
) -> None:
    """Blame the group whose curve fails first for the failure of the variants `who`."""
    if not (who.size and watched):
        return
    at, place = judging.first_failure.first_failure(measuring, [one.curve for one in watched], table[:, who], fails)
    for k, one in enumerate(watched):
        hidden = (at < 0) & one.hidden[who]
        here = (at == k) | hidden
        at[hidden] = k
        failures.blame(who[here], verdict, one.group, np.where(hidden, one.place[who], place)[here])
