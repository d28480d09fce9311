"""Curves kept over the whole cycle, for what is asked of them once all of it is known: extremes, works, zeros.

A record grows by a step at a time. In each, some lanes took a panel; others didn't, and the half length of theirs is 0.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.compiling.memory import Memory
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, MIDDLE, POSITIONS, TO_COEFFICIENTS, TO_INTEGRALS
from engine.cycle.panels.lanes import Panels, many, new_record, one
from engine.cycle.panels.series import Figures, larger, panel_figures
from engine.cycle.panels.transforms import Tiles, to_coefficients
from engine.cycle.panels.walk import Scales, Walk

# How many times the rounding that was measured values may be off.
OF_ROUNDING = 16.0


class Left(NamedTuple):
    """What is left of a curve in a step.

    Attributes
    ----------
    tail, missing : row
        What lies beyond the series, and what the sum over the positions misses of the integral.
    """

    tail: Row
    missing: Row


class KeptPanel(NamedTuple):
    """Each lane's panel of a step.

    Attributes
    ----------
    middle, half : row
        Middle and half the length.
    opened, closed : row
        Errors of the places of the cuts where it begins and ends.
    bent : row
        1 where something in it bends, else 0.
    """

    middle: Row
    half: Row
    opened: Row
    closed: Row
    bent: Row


class Whole(NamedTuple):
    """A curve over the whole cycle.

    Attributes
    ----------
    scale : row
        Greatest magnitude, infinite where a value isn't finite.
    first : row
        Value at the first position.
    offset : row
        What values may be off by, more than by rounding.
    """

    scale: Row
    first: Row
    offset: Row


class Record(NamedTuple):
    """Kept curves; that of curve k in step i lies in slot i · curves + k.

    Attributes
    ----------
    curves : int
        How many are kept.
    most_steps : int
        How many steps there is room for.
    steps : ndarray (1,) of int
        How many there are.
    values : panels (slots, POSITIONS, LANES)
        Values at the positions of each panel.
    coefficients : panels (slots, POSITIONS, LANES)
        Of their Chebyshev series, where `known`.
    left : many Left
        Of each slot.
    panels : many KeptPanel
        Of each step.
    whole : many Whole
        Of each curve.
    work : Tiles
    figures : Figures
        Used meanwhile.
    known : ndarray (slots,) of int
        1 where the coefficients are known.
    to_coefficients, to_integrals : ndarray
        The matrices of `engine.cycle.panels.chebyshev`.
    """

    curves: int
    most_steps: int
    steps: np.ndarray
    values: Panels
    coefficients: Panels
    left: many(Left)
    panels: many(KeptPanel)
    whole: many(Whole)
    work: Memory((POSITIONS, LANES), Tiles)
    figures: one(Figures)
    known: np.ndarray
    to_coefficients: np.ndarray
    to_integrals: np.ndarray


def room_for(curves: int, steps: int) -> Record:
    """Arrays for a record of so many curves and steps."""
    slots = curves * steps
    return new_record(
        Record,
        curves=curves,
        most_steps=steps,
        steps=np.zeros(1, np.int64),
        values=slots,
        coefficients=slots,
        left=slots,
        panels=steps,
        whole=curves,
        known=np.zeros(slots, np.int64),
        to_coefficients=TO_COEFFICIENTS,
        to_integrals=TO_INTEGRALS,
    )


@routine
def begin_record(record: Record) -> None:
    """Forget what a record holds."""
    known = record.known
    record.steps[0] = 0
    for slot in range(known.shape[0]):
        known[slot] = 0
    for k in range(record.curves):
        whole = record.whole[k]
        for lane in range(LANES):
            whole.scale[lane] = whole.first[lane] = whole.offset[lane] = 0.0


@routine
def keep_rounding(scales: Scales, whole: Whole) -> None:
    """Note what values of a curve may be off by rounding, as far as its scales in a walk tell."""
    for lane in range(LANES):
        whole.offset[lane] = larger(OF_ROUNDING * scales.rounding[lane], whole.offset[lane])


@routine
def keep_panels(walk: Walk, panels: KeptPanel) -> None:
    """Enter each lane's panel of a step; the half length of those that aren't accepted is 0."""
    for lane in range(LANES):
        panels.middle[lane] = walk.middle[lane]
        panels.half[lane] = walk.half[lane] if walk.accepted[lane] > 0.0 else 0.0
        panels.opened[lane] = walk.opened[lane]
        panels.closed[lane] = walk.next_opened[lane]
        panels.bent[lane] = walk.bent[lane]


@routine
def keep_curve(curve: Rows, figures: Figures, walk: Walk, record: Record, step: int, kept: int) -> None:
    """Enter a curve of a tile as a curve of a step.

    Parameters
    ----------
    curve : rows (POSITIONS, LANES)
    figures : Figures
    walk : Walk
    record : Record
    step, kept : int
        Step and curve of the record.
    """
    slot, whole = step * record.curves + kept, record.whole[kept]
    values, left = record.values[slot], record.left[slot]
    for j in range(POSITIONS):
        for lane in range(LANES):
            values[j, lane] = curve[j, lane]
    for lane in range(LANES):
        left.tail[lane], left.missing[lane] = figures.tail[lane], figures.missing[lane]
        accepted, first = walk.accepted[lane] > 0.0, walk.taken[lane] == 1.0
        whole.scale[lane] = _scale(figures, whole, lane, accepted)
        # What acts from a cut on or up to it moves with it.
        moved = larger(walk.opened[lane], walk.next_opened[lane]) / abs(walk.half[lane])
        middle = curve[MIDDLE, lane]
        moved *= larger(abs(curve[0, lane] - middle), abs(curve[DEGREE, lane] - middle))
        offset = larger(moved, whole.offset[lane])
        whole.offset[lane] = offset if accepted else whole.offset[lane]
        whole.first[lane] = curve[0, lane] if accepted & first else whole.first[lane]


@inlined
def _scale(figures: Figures, whole: Whole, lane: int, taken: bool) -> float:
    """Greatest magnitude of a curve with that in a panel, where it was taken."""
    finite = abs(figures.sum[lane]) < math.inf
    scale = larger(figures.magnitude[lane] if finite else math.inf, whole.scale[lane])
    return scale if taken else whole.scale[lane]


@routine
def keep_derived(record: Record, step: int, curve: int) -> None:
    """Enter what is known of a curve whose values in a step were computed from those of others."""
    slot, whole, figures = step * record.curves + curve, record.whole[curve], record.figures
    left, panels = record.left[slot], record.panels[step]
    panel_figures(record.values[slot], panels.bent, figures)
    for lane in range(LANES):
        left.tail[lane], left.missing[lane] = figures.tail[lane], figures.missing[lane]
        whole.scale[lane] = _scale(figures, whole, lane, panels.half[lane] != 0.0)


@routine
def known_slot(record: Record, curve: int, step: int) -> int:
    """Slot of a curve in a step, with its coefficients known."""
    slot = step * record.curves + curve
    if record.known[slot] == 0:
        to_coefficients(record.to_coefficients, record.values[slot], record.work, record.coefficients[slot])
        record.known[slot] = 1
    return slot
