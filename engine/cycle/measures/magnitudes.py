"""Integrals of magnitudes |F| = √S over the cycle, from the series of their squares.

S is smooth where |F| dips or, where F vanishes, has a kink. So panels need only be as short as the series of S asks.
Where the root doesn't follow in such a panel, the panel is walked over once more in parts, the shorter, the nearer they
are to the dip, with values of S from its series: nothing of the machine is evaluated again.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, PLACES, POSITIONS
from engine.cycle.panels.integrals import END, ERROR, INTEGRAL, ROUNDING, VALUE
from engine.cycle.panels.lanes import ASIDE, Memory, any_positive, in_lanes, rows
from engine.cycle.panels.record import HALF, MIDDLE, OFFSET, OPENED, SCALE, TAIL, Record, known_slot
from engine.cycle.panels.series import FIGURES, MAGNITUDE, MISSING, SUM, larger, of_figures, panel_figures
from engine.cycle.panels.transforms import FOLDED, SHIFTED
from engine.cycle.panels.walk import (
    ACCEPTED,
    EDGES,
    GREATEST,
    ONE_EDGE,
    SCALES,
    WALK,
    compare_with_tolerance,
    find_kink,
    judge,
    next_panels,
    note_rounding,
    of_edges,
    of_scales,
    set_out,
)
from engine.cycle.panels.walk import HALF as PART_HALF
from engine.cycle.panels.walk import MIDDLE as PART_MIDDLE
from engine.cycle.panels.walk import ROUNDING as SO_FAR

# Share of what may be left of the square that may be missing of the root's mean in a panel.
OF_TOLERANCE = 1e-3
# The coefficients of a root fall more slowly in the end than before, as it has branch points: so many times more may be
# missing of its integral.
OF_ROOT = 16.0
# Rows used meanwhile: ends of the range of parts, which is empty in lanes whose panel needs none; what the square may
# be off by between the positions.
_LOW, _HIGH, _OFF = range(3)
MAGNITUDE_ROWS = 3
# The tile of the record's work that receives slopes.
_SLOPES = FOLDED


class PartsRoom(NamedTuple):
    """Arrays for a walk over the parts of panels.

    Attributes
    ----------
    walk : ndarray (WALK, LANES)
    edges : ndarray (1, EDGES, LANES)
        None.
    figures : ndarray (1, FIGURES, LANES)
    scales : ndarray (1, SCALES, LANES)
    rows : ndarray (MAGNITUDE_ROWS, LANES)
    """

    walk: np.ndarray
    edges: np.ndarray
    figures: np.ndarray
    scales: np.ndarray
    rows: np.ndarray


def new_parts() -> PartsRoom:
    """Arrays for a walk over the parts of panels."""
    return PartsRoom(
        rows(WALK, aside=ASIDE),
        rows(1, EDGES, aside=ASIDE),
        rows(1, FIGURES, aside=ASIDE),
        rows(1, SCALES, aside=ASIDE),
        rows(MAGNITUDE_ROWS, aside=ASIDE),
    )


@routine
def _roots_at_positions(record: Record, slot: int) -> None:
    """Roots of the values at a panel's positions."""
    values, work = record.values, record.work
    for j in range(POSITIONS):
        for lane in range(LANES):
            work[SHIFTED, j, lane] = math.sqrt(values[slot, j, lane])


@routine
def _roots_in_part(record: Record, slot: int, walk: Memory) -> None:
    """Roots of the series, and its slopes, at the positions of each lane's part of the panel."""
    coefficients, work = record.coefficients, record.work
    for j in range(POSITIONS):
        for lane in range(LANES):
            x = walk[PART_MIDDLE, lane] + walk[PART_HALF, lane] * PLACES[j]
            b = b_before = d = d_before = 0.0
            for i in range(DEGREE):
                d, d_before = 2.0 * b + ((x + x) * d - d_before), d
                b, b_before = coefficients[slot, DEGREE - i, lane] + ((x + x) * b - b_before), b
            square = coefficients[slot, 0, lane] + (x * b - b_before)
            work[SHIFTED, j, lane] = math.sqrt(0.0 if square < 0.0 else square)
            work[_SLOPES, j, lane] = b + (x * d - d_before)


@routine
def _add_whole(
    record: Record, slot: int, step: int, curve: int, tolerance: float, figures: Memory, own: Memory, sums: Memory
) -> bool:
    """Add the panels in which the root's own series says enough; whether any doesn't."""
    panels, work, values = record.panels, record.work, record.values
    for lane in range(LANES):
        half, middle = panels[step, HALF, lane], panels[step, MIDDLE, lane]
        scale = math.sqrt(record.whole[curve, SCALE, lane])
        taken = half != 0.0
        missing = OF_ROOT * figures[0, MISSING, lane]
        bends = taken & (missing > tolerance * scale)
        own[_LOW, lane], own[_HIGH, lane] = -1.0, 1.0 if bends else -1.0
        whole = record.errors[slot, TAIL, lane] + record.whole[curve, OFFSET, lane]
        own[_OFF, lane] = 2.0 * whole + ROUNDING * record.whole[curve, SCALE, lane]
        # Rounding of values, and of the places of the panel's ends; what a jump does there.
        ends = 0.5 * ONE_EDGE * (abs(middle) + abs(half))
        off = figures[0, MAGNITUDE, lane] * (2.0 * ROUNDING * abs(half) + ends)
        off += abs(work[SHIFTED, 0, lane] - sums[END, lane]) * panels[step, OPENED, lane]
        off += 0.0 if bends else abs(half) * missing
        sums[VALUE, lane] += half * figures[0, SUM, lane] if taken & (not bends) else 0.0
        sums[ERROR, lane] += off if taken else 0.0
        sums[END, lane] = math.sqrt(values[slot, DEGREE, lane]) if taken else sums[END, lane]
    return any_positive(own[_HIGH])


@routine
def _add_parts(record: Record, step: int, figures: Memory, walk: Memory, own: Memory, sums: Memory) -> None:
    """Add the accepted parts of panels."""
    work = record.work
    for lane in range(LANES):
        half, accepted = record.panels[step, HALF, lane] * walk[PART_HALF, lane], walk[ACCEPTED, lane] > 0.0
        off, least = own[_OFF, lane], math.sqrt(own[_OFF, lane])
        # An error of the square is one of the root, the greater, the less that is.
        total = 0.0
        for j in range(POSITIONS):
            total += off / larger(work[SHIFTED, j, lane], least)
        missed = abs(half) * (OF_ROOT * figures[0, MISSING, lane] + 2.0 * total / POSITIONS)
        sums[VALUE, lane] += half * figures[0, SUM, lane] if accepted else 0.0
        sums[ERROR, lane] += missed if accepted else 0.0


@routine
def integrate_roots(
    record: Record, matrix: np.ndarray, steps: int, curve: int, tolerance: float, room: PartsRoom, sums: Memory
) -> None:
    """Integral over the cycle of the root of a curve of the record, which is nowhere negative.

    Parameters
    ----------
    record : Record
    matrix : ndarray
        `chebyshev.TO_COEFFICIENTS`.
    steps : int
        How many steps the record has.
    curve : int
    tolerance : float
        What may be left of the curve, as a share of its greatest magnitude.
    room : PartsRoom
    sums : rows (INTEGRAL, LANES)
        Receives VALUE and ERROR, as of `engine.cycle.panels.integrals`.
    """
    figures, scales, edges = of_figures(room.figures), of_scales(room.scales), of_edges(room.edges)
    walk, own = in_lanes(room.walk), in_lanes(room.rows)
    fine = OF_TOLERANCE * tolerance
    for part in range(INTEGRAL):
        for lane in range(LANES):
            sums[part, lane] = 0.0
    for step in range(steps):
        slot = step * record.curves + curve
        _roots_at_positions(record, slot)
        panel_figures(record.work, SHIFTED, figures, 0)
        if not _add_whole(record, slot, step, curve, fine, figures, own, sums):
            continue
        slot = known_slot(record, matrix, curve, step)
        set_out(own[_LOW], own[_HIGH], 2.0, walk)
        for lane in range(LANES):
            scales[0, GREATEST, lane] = math.sqrt(record.whole[curve, SCALE, lane])
            scales[0, SO_FAR, lane] = 0.0
        while next_panels(edges, 0, walk):
            _roots_in_part(record, slot, walk)
            panel_figures(record.work, SHIFTED, figures, 0)
            note_rounding(record.work, SHIFTED, scales, 0, walk)
            compare_with_tolerance(figures, 0, fine, 1.0, scales, walk)
            # Parts end where the square is least: a dip inside may be missed by a part that happens to fit.
            find_kink(record.work, _SLOPES, walk)
            if judge(2.0, walk):
                _add_parts(record, step, figures, walk, own, sums)
