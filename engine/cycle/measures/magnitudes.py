"""Integrals of magnitudes |F| = √S over the cycle, from the series of their squares.

S is smooth where |F| dips or, where F vanishes, has a kink. So panels need only be as short as the series of S
requires. A panel in which the root's series doesn't converge is walked again in parts, shorter towards the dip, with
values of S from its series: the machine isn't evaluated again.
"""

import math
from typing import NamedTuple

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import routine
from engine.cycle.panels.chebyshev import DEGREE, PLACES
from engine.cycle.panels.integrals import ROUNDING, IntegralRows
from engine.cycle.panels.lanes import any_positive, fill, many, one
from engine.cycle.panels.record import Record, known_slot
from engine.cycle.panels.series import larger, panel_figures, series_at
from engine.cycle.panels.walk import (
    ONE_EDGE,
    Edge,
    Scales,
    Walk,
    compare_with_tolerance,
    find_kink,
    judge,
    next_panels,
    note_rounding,
    set_out,
)

# Tolerance of the root's mean in a panel, relative to the tolerance of the square.
OF_TOLERANCE = 1e-3
# Safety factor on the integral's remainder: a root has branch points, so its coefficients finally decay more slowly.
OF_ROOT = 16.0
_ROWS = len(IntegralRows._fields)


class Parts(NamedTuple):
    """Arrays for a walk over the parts of panels.

    Attributes
    ----------
    walk : Walk
    edges : many Edge
        Unused: a walk over parts has no edges.
    scales : Scales
    low, high : row
        Ends of the range of parts; empty in lanes whose panel needs none.
    off : row
        Error estimate of the square between the positions.
    none : row
        0: no kinks in a part but those that its series shows.
    """

    walk: one(Walk)
    edges: many(Edge)
    scales: one(Scales)
    low: Row
    high: Row
    off: Row
    none: Row


@routine
def _roots_at_positions(values: Rows, degree: int, roots: Rows) -> None:
    """Square roots of the values at a panel's positions."""
    for j in range(degree + 1):
        for lane in range(LANES):
            roots[j, lane] = math.sqrt(values[j, lane])


@routine
def _roots_in_part(series: Rows, degree: int, walk: Walk, roots: Rows, slopes: Rows) -> None:
    """Square roots of the series, and its slopes, at the positions of each lane's part of the panel."""
    for j in range(degree + 1):
        place = PLACES[DEGREE // degree * j]
        for lane in range(LANES):
            square, slope, _ = series_at(series, lane, walk.middle[lane] + walk.half[lane] * place)
            roots[j, lane], slopes[j, lane] = math.sqrt(0.0 if square < 0.0 else square), slope


@routine
def _add_converged(record: Record, curve: int, step: int, tolerance: float, parts: Parts, sums: IntegralRows) -> bool:
    """Add the panels in which the root's own series converges; returns whether any doesn't."""
    slot, panels, own = step * record.curves + curve, record.panels[step], record.whole[curve]
    roots, figures = record.work.shifted, record.figures
    last, tail = record.values[slot, record.degree], record.left[slot].tail
    for lane in range(LANES):
        half, middle = panels.half[lane], panels.middle[lane]
        scale = math.sqrt(own.scale[lane])
        taken = half != 0.0
        missing = OF_ROOT * figures.missing[lane]
        bends = taken & (missing > tolerance * scale)
        parts.low[lane], parts.high[lane] = -1.0, 1.0 if bends else -1.0
        whole = tail[lane] + own.offset[lane]
        parts.off[lane] = 2.0 * whole + ROUNDING * own.scale[lane]
        # Rounding of the values and of the panel's ends, and jumps at the ends.
        ends = 0.5 * ONE_EDGE * (abs(middle) + abs(half))
        off = figures.magnitude[lane] * (2.0 * ROUNDING * abs(half) + ends)
        off += abs(roots[0, lane] - sums.end[lane]) * panels.opened[lane]
        off += 0.0 if bends else abs(half) * missing
        sums.value[lane] += half * figures.sum[lane] if taken & (not bends) else 0.0
        sums.error[lane] += off if taken else 0.0
        sums.end[lane] = math.sqrt(last[lane]) if taken else sums.end[lane]
    return any_positive(parts.high)


@routine
def _add_parts(record: Record, half_length: Row, parts: Parts, sums: IntegralRows) -> None:
    """Add the accepted parts of panels."""
    roots, figures, walk = record.work.shifted, record.figures, parts.walk
    for lane in range(LANES):
        half, accepted = half_length[lane] * walk.half[lane], walk.accepted[lane] > 0.0
        off, least = parts.off[lane], math.sqrt(parts.off[lane])
        # An error of the square causes an error of the root, larger where the root is smaller.
        total = 0.0
        for j in range(record.degree + 1):
            total += off / larger(roots[j, lane], least)
        missed = abs(half) * (OF_ROOT * figures.missing[lane] + 2.0 * total / (record.degree + 1))
        sums.value[lane] += half * figures.sum[lane] if accepted else 0.0
        sums.error[lane] += missed if accepted else 0.0


@routine
def integrate_roots(record: Record, curve: int, tolerance: float, parts: Parts, sums: IntegralRows) -> None:
    """Integrate the square root of a nonnegative curve of the record over the cycle.

    Parameters
    ----------
    record : Record
    curve : int
    tolerance : float
        Admissible remainder of the curve, relative to its maximum magnitude.
    parts : Parts
        Scratch.
    sums : IntegralRows
        Output: value and error estimate.
    """
    walk, scales, figures = parts.walk, parts.scales, record.figures
    # The roots, and a tile that is free at this point.
    roots, slopes, fine = record.work.shifted, record.work.folded, OF_TOLERANCE * tolerance
    fill(sums, _ROWS, 0.0)
    for step in range(record.steps[0]):
        slot = step * record.curves + curve
        _roots_at_positions(record.values[slot], record.degree, roots)
        panel_figures(roots, record.degree, record.panels[step].bent, figures)
        if not _add_converged(record, curve, step, fine, parts, sums):
            continue
        series = record.coefficients[known_slot(record, curve, step)]
        set_out(parts.low, parts.high, 2.0, walk)
        for lane in range(LANES):
            scales.greatest[lane] = math.sqrt(record.whole[curve].scale[lane])
            scales.rounding[lane] = 0.0
        while next_panels(parts.edges, 0, walk):
            _roots_in_part(series, record.degree, walk, roots, slopes)
            panel_figures(roots, record.degree, parts.none, figures)
            note_rounding(roots, record.degree, scales, walk)
            compare_with_tolerance(figures, fine, 1.0, scales, walk)
            # End parts at the minimum of the square: a part that happens to converge could hide a dip.
            find_kink(slopes, record.degree, walk)
            if judge(2.0, record.degree, walk):
                _add_parts(record, record.panels[step].half, parts, sums)
