"""First position on a variant's cycle, or on a part of it, at which the variant fails.

Equally spaced positions are examined, then the interval before the first failure is bisected.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Node
from engine.machine.conditions import SINGULAR_SINE
from engine.machine.kept_fields import KeptFields
from engine.machine.measuring import MeasuredCycles, Measuring
from engine.quantities.expressions import Angle
from engine.scene.scene import Numbers
from engine.words.verdicts import Verdict

# A run that reverses within this distance of a singular position counts as having reached it [rad, for a range of 2π]:
# near a dead centre of the driven side, the step error alone decides where the input comes to a standstill.
BESIDE = 1e-6

# Equally spaced positions at which failing variants are examined, and bisections of the interval between two of them.
LOOKED_AT, HALVINGS = 720, 40


def first_failure(
    curves: KeptFields, table: np.ndarray, ends: tuple[int, int], fails: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """First position at which one of some curves fails.

    Parameters
    ----------
    curves : KeptFields
    table : ndarray (numbers, variants)
        As in `KeptFields.fill`.
    ends : tuple of int
        Rows of the table with the ends of the input's range.
    fails : callable
        Whether values (curves, variants, positions) fail.

    Returns
    -------
    which : ndarray (variants,) of int
        The curve that fails there; −1 if none fails at the positions examined.
    place : ndarray (variants,)
        The position; NaN if there is none.
    """
    count, variants = curves.count, np.arange(table.shape[1])
    share = np.arange(LOOKED_AT + 1) / LOOKED_AT
    values = np.empty((count, variants.size, share.size))
    curves.fill(table, share, values, variants, ends)
    failing = fails(values)
    anywhere = failing.any(axis=(0, 2))
    at = failing.any(axis=0).argmax(axis=1)
    first, length = table[ends[0]], table[ends[1]] - table[ends[0]]
    low, high = first + length * share[np.maximum(at - 1, 0)], first + length * share[at]
    which = failing[:, variants, at].argmax(axis=0)
    own = np.vstack([table, low, high])
    rows, room = (len(table), len(table) + 1), np.empty((count, variants.size, 1))
    for _ in range(HALVINGS):
        curves.fill(own, np.array([0.5]), room, variants, rows)
        here = fails(room[:, :, 0])
        middle, found = 0.5 * (own[-2] + own[-1]), here.any(axis=0)
        which = np.where(found, here.argmax(axis=0), which)
        own[-1], own[-2] = np.where(found, middle, own[-1]), np.where(found, own[-2], middle)
    return np.where(anywhere, which, -1), np.where(anywhere, own[-1], np.nan)


class Failures(NamedTuple):
    """Positions at which groups are singular, or can't be assembled; arrays (variants,).

    Attributes
    ----------
    verdict : ndarray of uint8
        OK if there is no such position.
    group : ndarray of int
        Index of the group responsible in `Measuring.groups`; −1 if there is none.
    place : ndarray
        Position of the input; NaN if there is none.
    rounding : ndarray
        Rounding error of accelerations and forces at the worst transmission, relative to their maximum.
    """

    verdict: np.ndarray
    group: np.ndarray
    place: np.ndarray
    rounding: np.ndarray


def failures_of(measuring: Measuring, table: np.ndarray, answers: MeasuredCycles) -> Failures:
    """Failures of variants over the measured range of the input.

    Parameters
    ----------
    measuring : Measuring
    table : ndarray (numbers, variants)
        Including the numbers found on the cycle.
    answers : MeasuredCycles
        Measurements for this table.
    """
    broken, groups, count = answers.outcome.broken_at, measuring.groups, table.shape[1]
    verdict, rounding = np.full(count, Verdict.OK, np.uint8), answers.rounding_of_rates
    failures = Failures(verdict, np.full(count, -1), np.full(count, np.nan), rounding)

    def blame(who: np.ndarray, verdict: Verdict, group: int, place: np.ndarray) -> None:
        failures.verdict[who], failures.group[who], failures.place[who] = verdict, group, place

    singular, sines = np.zeros(count, bool), answers.sines()
    # If all groups can be assembled, infinite values may result from the dead centre.
    assembled = ~np.isnan([least for least, _ in sines]).any(axis=0)
    for k, (least, place) in enumerate(sines):
        fails = (least < SINGULAR_SINE) & ~singular & assembled
        blame(fails, Verdict.SINGULAR, k, place[fails])
        singular |= fails
    lost = np.flatnonzero(~np.isnan(broken) & ~singular)
    if lost.size and groups:
        fields = curves_of(measuring, [measuring.mechanics.kinematics.sines[group] for group in groups])
        at, place = first_failure(fields, table[:, lost], ends_of(measuring), np.isnan)
        for k in range(len(groups)):
            # At the limit of the links' reach, positions differ by rounding.
            hidden = (at < 0) & np.isnan(sines[k][0][lost]) & np.isfinite(broken[lost])
            here = (at == k) | hidden
            at[hidden] = k
            blame(lost[here], Verdict.CANNOT_ASSEMBLE, k, np.where(hidden, broken[lost], place)[here])
    return failures


def failures_within(measuring: Measuring, numbers: Numbers, covered: np.ndarray) -> Failures:
    """Failures of variants over the ranges of the input that their runs cover.

    Parameters
    ----------
    measuring : Measuring
    numbers : Numbers
        Numbers of the variants.
    covered : ndarray (2, variants)
        Minimum and maximum position; a range longer than a cycle is limited to one; a NaN range has no failures.
    """
    table, ends = measuring.numbers(numbers, covered.shape[1]), list(ends_of(measuring))
    (low, high), bounds = covered, np.sort(table[ends], axis=0)
    length = bounds[1] - bounds[0]
    if measuring.mechanics.has_cycle:
        turns = np.floor(low / length) * length
        low, high = low - turns - BESIDE, np.fmin(high - turns + BESIDE, low - turns + length)
    else:
        beside = BESIDE * length / (2.0 * np.pi)
        low, high = np.fmax(low - beside, bounds[0]), np.fmin(high + beside, bounds[1])
    table[ends] = np.where(np.isnan(covered), np.nan, [low, high])
    answers = measuring(table)
    measuring.fill_found(table, answers.outcome.landmarks)
    found = failures_of(measuring, table, answers)
    return found._replace(place=np.mod(found.place, length)) if measuring.mechanics.has_cycle else found


def curves_of(
    measuring: Measuring, curves: Sequence[Node | Angle], dtype: np.dtype | type[float] = float
) -> KeptFields:
    """Fields of a machine at arbitrary positions.

    Parameters
    ----------
    measuring : Measuring
    curves : sequence of Node or Angle
    dtype : float64 or float32
        Type in which they are stored.
    """
    title = f"The functions of one machine: {measuring.mechanics.scene.title or 'untitled'}."
    return KeptFields(curves, measuring.functions, np.dtype(dtype), title)


def ends_of(measuring: Measuring) -> tuple[int, int]:
    """Rows of the table with the ends of the input's range."""
    rows = measuring.functions.rows
    return rows[measuring.mechanics.first], rows[measuring.mechanics.last]
