"""Curves kept over the whole cycle, for what is asked of them once all of it is known: extremes, works, zeros.

A record grows by a step at a time. In each, some lanes took a panel; others didn't, and the half length of theirs is 0.
"""

from typing import NamedTuple

import numpy as np

from engine.cycle.chebyshev import POSITIONS
from engine.cycle.compiling import routine
from engine.cycle.lanes import ASIDE, LANES, in_lanes, in_panels, rows, tiles
from engine.cycle.panels import ACCEPTED, TAKEN
from engine.cycle.panels import HALF as PANEL_HALF
from engine.cycle.panels import MIDDLE as PANEL_MIDDLE
from engine.cycle.series import MAGNITUDE, larger
from engine.cycle.series import MISSING as FIGURE_MISSING
from engine.cycle.series import TAIL as FIGURE_TAIL
from engine.cycle.transforms import to_coefficients

# Rows of a curve in a step: what lies beyond the series, and what the sum over the positions misses of the integral.
TAIL, MISSING = range(2)
# Rows of a step.
MIDDLE, HALF = range(2)
# Rows of a curve: greatest magnitude, value at the first position, what values may be off by more than by rounding.
SCALE, FIRST, OFFSET = range(3)


class Record(NamedTuple):
    """Kept curves; that of curve k in step i lies in slot i · curves + k.

    Attributes
    ----------
    curves : int
        How many are kept.
    values : ndarray (slots, POSITIONS, LANES)
        Values at the positions of each panel.
    coefficients : ndarray (slots, POSITIONS, LANES)
        Of their Chebyshev series, where `known`.
    known : ndarray (slots,) of int
        1 where the coefficients are known.
    errors : ndarray (slots, 2, LANES)
        Rows TAIL and MISSING.
    panels : ndarray (steps, 2, LANES)
        Rows MIDDLE and HALF: middle and half the length of each lane's panel.
    whole : ndarray (curves, 3, LANES)
        Rows SCALE, FIRST and OFFSET, of the whole cycle.
    work : ndarray (3, POSITIONS, LANES)
        Used by transforms.
    """

    curves: int
    values: np.ndarray
    coefficients: np.ndarray
    known: np.ndarray
    errors: np.ndarray
    panels: np.ndarray
    whole: np.ndarray
    work: np.ndarray


def new_record(curves: int, steps: int) -> Record:
    """An empty record with room for so many steps."""
    slots = curves * steps
    return Record(
        curves,
        tiles(slots),
        tiles(slots),
        np.zeros(slots, np.int64),
        rows(slots, 2, aside=ASIDE),
        rows(steps, 2, aside=ASIDE),
        rows(curves, 3, aside=ASIDE),
        tiles(3),
    )


@routine
def begin_record(record: Record) -> None:
    """Forget what a record holds."""
    known, whole = record.known, in_lanes(record.whole)
    for slot in range(known.shape[0]):
        known[slot] = 0
    for k in range(record.curves):
        for lane in range(LANES):
            whole[k, SCALE, lane] = whole[k, FIRST, lane] = whole[k, OFFSET, lane] = 0.0


@routine
def keep_panels(walk: np.ndarray, step: int, panels: np.ndarray) -> None:
    """Enter each lane's panel of a step; the half length of those that aren't accepted is 0."""
    walk, panels = in_lanes(walk), in_lanes(panels)
    for lane in range(LANES):
        panels[step, MIDDLE, lane] = walk[PANEL_MIDDLE, lane]
        panels[step, HALF, lane] = walk[PANEL_HALF, lane] if walk[ACCEPTED, lane] > 0.0 else 0.0


@routine
def keep_curve(
    tile: np.ndarray, curve: int, figures: np.ndarray, walk: np.ndarray, record: Record, kept: int, step: int
) -> None:
    """Enter a curve of a tile as a curve of a step."""
    tile, figures, walk = in_panels(tile), in_lanes(figures), in_lanes(walk)
    values, errors, whole = in_panels(record.values), in_lanes(record.errors), in_lanes(record.whole)
    slot = step * record.curves + kept
    for j in range(POSITIONS):
        for lane in range(LANES):
            values[slot, j, lane] = tile[curve, j, lane]
    for lane in range(LANES):
        errors[slot, TAIL, lane] = figures[curve, FIGURE_TAIL, lane]
        errors[slot, MISSING, lane] = figures[curve, FIGURE_MISSING, lane]
        accepted, first = walk[ACCEPTED, lane] > 0.0, walk[TAKEN, lane] == 1.0
        scale = larger(figures[curve, MAGNITUDE, lane], whole[kept, SCALE, lane])
        whole[kept, SCALE, lane] = scale if accepted else whole[kept, SCALE, lane]
        whole[kept, FIRST, lane] = tile[curve, 0, lane] if accepted & first else whole[kept, FIRST, lane]


@routine
def known_slot(record: Record, matrix: np.ndarray, curve: int, step: int) -> int:
    """Slot of a curve in a step, with its coefficients known; `matrix` as of `to_coefficients`."""
    slot = step * record.curves + curve
    if record.known[slot] == 0:
        to_coefficients(matrix, record.values, slot, record.work, record.coefficients)
        record.known[slot] = 1
    return slot
