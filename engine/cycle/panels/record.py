"""Curves kept over the whole cycle, for what is asked of them once all of it is known: extremes, works, zeros.

A record grows by a step at a time. In each, some lanes took a panel; others didn't, and the half length of theirs is 0.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, POSITIONS
from engine.cycle.panels.chebyshev import MIDDLE as MIDDLE_POSITION
from engine.cycle.panels.lanes import ASIDE, Memory, in_panels, memory, rows, tiles
from engine.cycle.panels.series import MAGNITUDE, SUM, larger, panel_figures
from engine.cycle.panels.series import MISSING as FIGURE_MISSING
from engine.cycle.panels.series import TAIL as FIGURE_TAIL
from engine.cycle.panels.transforms import to_coefficients
from engine.cycle.panels.walk import ACCEPTED, NEXT_OPENED, ROUNDING, TAKEN
from engine.cycle.panels.walk import HALF as PANEL_HALF
from engine.cycle.panels.walk import MIDDLE as PANEL_MIDDLE
from engine.cycle.panels.walk import OPENED as PANEL_OPENED

# Rows of a curve in a step: what lies beyond the series, and what the sum over the positions misses of the integral.
TAIL, MISSING = range(2)
# Rows of a step: middle and half the length of the panel, what the places of the cuts are off by where it begins and
# ends.
MIDDLE, HALF, OPENED, CLOSED = range(4)
PANEL = 4
# Rows of a curve: greatest magnitude, infinite where a value isn't finite; value at the first position; what values may
# be off by, more than by rounding.
SCALE, FIRST, OFFSET = range(3)


# How many times the rounding that was measured values may be off.
OF_ROUNDING = 16.0

of_pairs = memory(2, LANES)
of_wholes = memory(3, LANES)
of_panels = memory(PANEL, LANES)


class Record(NamedTuple):
    """Kept curves; that of curve k in step i lies in slot i · curves + k.

    Attributes
    ----------
    curves : int
        How many are kept.
    values : panels (slots, POSITIONS, LANES)
        Values at the positions of each panel.
    coefficients : panels (slots, POSITIONS, LANES)
        Of their Chebyshev series, where `known`.
    errors : rows (slots, 2, LANES)
        Rows TAIL and MISSING.
    panels : rows (steps, PANEL, LANES)
        Rows MIDDLE, HALF, OPENED and CLOSED of each lane's panel.
    whole : rows (curves, 3, LANES)
        Rows SCALE, FIRST and OFFSET, of the whole cycle.
    work : panels (3, POSITIONS, LANES)
        Used by transforms.
    known : ndarray (slots,) of int
        1 where the coefficients are known.
    """

    curves: int
    values: Memory
    coefficients: Memory
    errors: Memory
    panels: Memory
    whole: Memory
    work: Memory
    known: np.ndarray


class Room(NamedTuple):
    """Arrays for a record."""

    values: np.ndarray
    coefficients: np.ndarray
    errors: np.ndarray
    panels: np.ndarray
    whole: np.ndarray
    work: np.ndarray
    known: np.ndarray


def new_room(curves: int, steps: int) -> Room:
    """Room for a record of so many curves and steps."""
    slots = curves * steps
    return Room(
        tiles(slots),
        tiles(slots),
        rows(slots, 2, aside=ASIDE),
        rows(steps, PANEL, aside=ASIDE),
        rows(curves, 3, aside=ASIDE),
        tiles(3),
        np.zeros(slots, np.int64),
    )


@routine
def record_in(room: Room) -> Record:
    """A record in its room."""
    return Record(
        room.whole.shape[0],
        in_panels(room.values),
        in_panels(room.coefficients),
        of_pairs(room.errors),
        of_panels(room.panels),
        of_wholes(room.whole),
        in_panels(room.work),
        room.known,
    )


@routine
def begin_record(record: Record) -> None:
    """Forget what a record holds."""
    known, whole = record.known, record.whole
    for slot in range(known.shape[0]):
        known[slot] = 0
    for k in range(record.curves):
        for lane in range(LANES):
            whole[k, SCALE, lane] = whole[k, FIRST, lane] = whole[k, OFFSET, lane] = 0.0


@routine
def keep_rounding(scales: Memory, curve: int, record: Record, kept: int) -> None:
    """Note what values of a curve may be off by rounding, as far as its scales in a walk tell."""
    for lane in range(LANES):
        rounding, offset = scales[curve, ROUNDING, lane], record.whole[kept, OFFSET, lane]
        record.whole[kept, OFFSET, lane] = larger(OF_ROUNDING * rounding, offset)


@routine
def keep_panels(walk: Memory, step: int, panels: Memory) -> None:
    """Enter each lane's panel of a step; the half length of those that aren't accepted is 0."""
    for lane in range(LANES):
        panels[step, MIDDLE, lane] = walk[PANEL_MIDDLE, lane]
        panels[step, HALF, lane] = walk[PANEL_HALF, lane] if walk[ACCEPTED, lane] > 0.0 else 0.0
        panels[step, OPENED, lane] = walk[PANEL_OPENED, lane]
        panels[step, CLOSED, lane] = walk[NEXT_OPENED, lane]


@routine
def keep_curve(
    tile: Memory,
    curve: int,
    figures: Memory,
    walk: Memory,
    record: Record,
    kept: int,
    step: int,
) -> None:
    """Enter a curve of a tile as a curve of a step.

    Parameters
    ----------
    tile : panels (curves, POSITIONS, LANES)
    curve : int
    figures : rows (curves, FIGURES, LANES)
    walk : rows (WALK, LANES)
    record : Record
    kept, step : int
        Curve and step of the record.
    """
    values, errors, whole = record.values, record.errors, record.whole
    slot = step * record.curves + kept
    for j in range(POSITIONS):
        for lane in range(LANES):
            values[slot, j, lane] = tile[curve, j, lane]
    for lane in range(LANES):
        errors[slot, TAIL, lane] = figures[curve, FIGURE_TAIL, lane]
        errors[slot, MISSING, lane] = figures[curve, FIGURE_MISSING, lane]
        accepted, first = walk[ACCEPTED, lane] > 0.0, walk[TAKEN, lane] == 1.0
        finite = abs(figures[curve, SUM, lane]) < math.inf
        scale = larger(figures[curve, MAGNITUDE, lane] if finite else math.inf, whole[kept, SCALE, lane])
        whole[kept, SCALE, lane] = scale if accepted else whole[kept, SCALE, lane]
        # What acts from a cut on or up to it moves with it.
        moved = larger(walk[PANEL_OPENED, lane], walk[NEXT_OPENED, lane]) / abs(walk[PANEL_HALF, lane])
        middle = tile[curve, MIDDLE_POSITION, lane]
        moved *= larger(abs(tile[curve, 0, lane] - middle), abs(tile[curve, DEGREE, lane] - middle))
        offset = larger(moved, whole[kept, OFFSET, lane])
        whole[kept, OFFSET, lane] = offset if accepted else whole[kept, OFFSET, lane]
        whole[kept, FIRST, lane] = tile[curve, 0, lane] if accepted & first else whole[kept, FIRST, lane]


@routine
def keep_derived(record: Record, step: int, curve: int, figures: Memory) -> None:
    """Enter what is known of a curve whose values in a step were computed from those of others.

    Parameters
    ----------
    record : Record
    step, curve : int
    figures : rows (1, FIGURES, LANES)
        Receives the figures of its panels.
    """
    errors, whole, slot = record.errors, record.whole, step * record.curves + curve
    panel_figures(record.values, slot, figures, 0)
    for lane in range(LANES):
        errors[slot, TAIL, lane] = figures[0, FIGURE_TAIL, lane]
        errors[slot, MISSING, lane] = figures[0, FIGURE_MISSING, lane]
        finite = abs(figures[0, SUM, lane]) < math.inf
        before = whole[curve, SCALE, lane]
        scale = larger(figures[0, MAGNITUDE, lane] if finite else math.inf, before)
        whole[curve, SCALE, lane] = scale if record.panels[step, HALF, lane] != 0.0 else before


@routine
def known_slot(record: Record, matrix: np.ndarray, curve: int, step: int) -> int:
    """Slot of a curve in a step, with its coefficients known; `matrix` as of `to_coefficients`."""
    slot = step * record.curves + curve
    if record.known[slot] == 0:
        to_coefficients(matrix, record.values, slot, record.work, record.coefficients)
        record.known[slot] = 1
    return slot
