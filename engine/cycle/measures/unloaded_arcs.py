"""Unloaded arc of a bearing: the widest arc of its circumference to which the force never points over the cycle.

Oil is supplied through the unloaded arc. In the axes of the link with the bush, the force on it points to the loaded
spot; in those of the link with the journal it points away from it. A force below `LEAST_LOAD` of its peak counts as
zero.

Over each panel the nonzero force sweeps stretches of directions. The widest gap between them is found from the
positions. Then the directions at its ends are refined between the positions, until no other stretch may reach into the
gap.

Source: any course of machine elements, chapter on plain bearings (polar diagrams of bearing load; location of the oil
hole).
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row
from engine.compiling.decorators import inlined, routine
from engine.cycle.measures.angles import (
    IS_LEAST,
    SHARP,
    TURNS_BACK,
    VectorSeries,
    place_where,
    turn_to,
    vector_at,
)
from engine.cycle.measures.extremes import ExtremeRows
from engine.cycle.panels.chebyshev import DEGREE, PLACES
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import new_record, one
from engine.cycle.panels.record import Record, known_slot

# Fraction of the peak load below which a bearing counts as unloaded.
LEAST_LOAD = 1e-3
# The loads of a bar point along it, to 0 and π: the circle is cut next to π, by more than their errors [rad].
NEAR_CUT = 1e-6
# Room for stretches.
MOST_STRETCHES = 1024
# Between two positions, a force may fall to this fraction of the lower one, or rise to this multiple of the higher.
NEAR_LEAST = 32.0
# Parts of the interval between two positions, in each of which a force turns back, and is shortest, at most once.
PARTS = 4


class Arc(NamedTuple):
    """The widest arc to which a force never points.

    Attributes
    ----------
    arc, arc_error : row
        Width [rad].
    middle, middle_error : row
        Direction of its middle [rad].
    """

    arc: Row
    arc_error: Row
    middle: Row
    middle_error: Row


class Stretches(NamedTuple):
    """Stretches of directions over the panels of a lane; of the two ends of each, the first is the lower.

    Attributes
    ----------
    step : ndarray (stretches,) of int
        Step of the record.
    ends, errors : ndarray (stretches, 2)
        Directions of the ends [rad], continuous along the stretch, and their error estimates.
    places : ndarray (stretches, 2) of int
        Indices of the ends among the panel's positions.
    known : ndarray (stretches, 2) of bool
        Whether an end has been refined between the positions.
    margins : ndarray (stretches, 2)
        Bounds of the extension of the ends between the positions [rad].
    order : ndarray (stretches,) of int
        Stretches in the order of their lower ends.
    arc : Arc
        Output.
    """

    step: np.ndarray
    ends: np.ndarray
    errors: np.ndarray
    places: np.ndarray
    known: np.ndarray
    margins: np.ndarray
    order: np.ndarray
    arc: one(Arc)


class Force(NamedTuple):
    """A force in one lane.

    Attributes
    ----------
    x, y : int
        Curves of the record.
    lane : int
    least, least_error : float
        Magnitude below which it counts as zero, and its error estimate.
    """

    x: int
    y: int
    lane: int
    least: float
    least_error: float


def new_stretches(room: int) -> Stretches:
    """Allocate room for a number of stretches."""
    pairs = {name: np.zeros((room, 2)) for name in ("ends", "errors", "margins")}
    places, known = np.zeros((room, 2), np.int64), np.zeros((room, 2), np.bool_)
    step, order = (np.zeros(room, np.int64) for _ in range(2))
    return new_record(Stretches, step=step, places=places, known=known, order=order, **pairs)


@routine
def add_stretch(angle: float, margin: float, step: int, j: int, count: int, stretches: Stretches) -> int:
    """Add a stretch of one direction if there is room; returns the number of stretches, with one that has no room."""
    if count < stretches.ends.shape[0]:
        stretches.step[count] = step
        for side in range(2):
            stretches.ends[count, side], stretches.places[count, side] = angle, j
            stretches.errors[count, side], stretches.known[count, side] = 0.0, False
            stretches.margins[count, side] = margin
    return count + 1


@routine
def series_of(record: Record, force: Force, step: int) -> VectorSeries:
    """The series of a force in a panel."""
    slot_x, slot_y = known_slot(record, force.x, step), known_slot(record, force.y, step)
    return VectorSeries(record.coefficients[slot_x], record.coefficients[slot_y], force.lane)


@routine
def error_of(record: Record, force: Force, step: int) -> float:
    """Error estimate of a force in a panel, and of the least one that counts."""
    lane, slot = force.lane, step * record.curves
    whole_x, whole_y = record.whole[force.x], record.whole[force.y]
    # Next to a kink inside, the direction may go further by about the remainder of the series.
    bent = 1.0 + record.panels[step].bent[lane]
    off = bent * (record.left[slot + force.x].tail[lane] + record.left[slot + force.y].tail[lane]) + force.least_error
    return off + ROUNDING * (whole_x.scale[lane] + whole_y.scale[lane]) + whole_x.offset[lane] + whole_y.offset[lane]


@routine
def extreme_between(record: Record, force: Force, step: int, j: int) -> tuple[float, float]:
    """Where a force is shortest or longest between two neighbouring positions, j the later, and its square there.

    NaN if it isn't.
    """
    series, stride = series_of(record, force, step), DEGREE // record.degree
    place, limit = PLACES[stride * (j - 1)], PLACES[stride * j]
    if vector_at(series, place)[3] * vector_at(series, limit)[3] >= 0.0:
        return math.nan, math.nan
    place = place_where(series, place, limit, IS_LEAST)
    x, y, _, _ = vector_at(series, place)
    return place, x * x + y * y


@inlined
def ceases_between(record: Record, force: Force, step: int, j: int, square: float) -> bool:
    """Whether a force that counts at two neighbouring positions, j the later, ceases between them.

    `square` is the smaller of its squares there.
    """
    least = force.least * force.least
    return square < NEAR_LEAST * NEAR_LEAST * least and extreme_between(record, force, step, j)[1] < least


@routine
def farthest_turn(series: VectorSeries, place: float, limit: float, sense: float, least: float) -> tuple[float, float]:
    """How far a force turns in a sense from one position to the next while it counts [rad].

    Returns
    -------
    turned : float
    sensitivity : float
        Error of the farthest direction per error of the force.
    """
    x, y, turning, growing = vector_at(series, place)
    way, turned = limit - place, 0.0
    farthest, sensitivity, start = 0.0, 1.0 / math.sqrt(x * x + y * y), place
    for part in range(1, PARTS + 1):
        end = place + way * part / PARTS
        at_end = vector_at(series, end)
        dip = place_where(series, start, end, IS_LEAST) if growing * way < 0.0 <= at_end[3] * way else end
        growing = at_end[3]
        # Where a force nearly vanishes it turns fast, and may turn back on either side.
        for side in (dip, end):
            if side == start:
                continue
            at_side = at_end if side == end else vector_at(series, side)
            turns_back = turning * sense * way > 0.0 >= at_side[2] * sense * way
            back = place_where(series, start, side, TURNS_BACK) if turns_back else side
            turning = at_side[2]
            # Between these corners the force is nowhere farther ahead or smaller than at them.
            for corner in (back, side):
                if corner == start:
                    continue
                hx, hy, _, _ = at_side if corner == side else vector_at(series, corner)
                ceases, moved = hx * hx + hy * hy < least * least, 0.0
                if ceases:
                    hx, hy, turns, grows = vector_at(series, place_where(series, start, corner, least * least))
                    # The position where the force ceases to count is only as accurate as the force.
                    moved = abs(turns / grows)
                turned += turn_to(x, y, hx, hy)
                if turned * sense > farthest:
                    farthest, sensitivity = turned * sense, (1.0 + moved) / math.sqrt(hx * hx + hy * hy)
                if ceases:
                    return farthest, sensitivity
                x, y, start = hx, hy, corner
    return farthest, sensitivity


@routine
def add_between(record: Record, force: Force, step: int, j: int, count: int, stretches: Stretches) -> int:
    """Add the stretch of a force that counts only between two positions, j the later; returns the new number."""
    place, square = extreme_between(record, force, step, j)
    if not square >= force.least * force.least:
        return count
    if count < stretches.ends.shape[0]:
        series, stride = series_of(record, force, step), DEGREE // record.degree
        x, y, _, _ = vector_at(series, place)
        stretches.step[count] = step
        for side in range(2):
            sense, farthest, sensitivity = 2.0 * side - 1.0, 0.0, 1.0 / math.sqrt(square)
            for to in range(2):
                limit = PLACES[stride * (j - to)]
                further, sensitivity_there = farthest_turn(series, place, limit, sense, force.least)
                if further > farthest:
                    farthest, sensitivity = further, sensitivity_there
            stretches.ends[count, side], stretches.known[count, side] = math.atan2(y, x) + sense * farthest, True
            stretches.errors[count, side] = min(error_of(record, force, step) * sensitivity, math.pi)
    return count + 1


@routine
def find_stretches(record: Record, force: Force, stretches: Stretches) -> int:
    """Find the stretches of a force's directions over the panels of a lane, from its values at the positions.

    Where the force starts or ceases to count, also between two positions, or turns sharply, it may turn back and forth
    there: the adjacent positions then become separate stretches too, with a margin of π. A force that counts only
    between two positions is a stretch.

    Returns
    -------
    int
        Number of stretches; one more than there is room for if there are too many.
    """
    lane, least, ends, places, count = force.lane, force.least, stretches.ends, stretches.places, 0
    margins, low, high = stretches.margins, 0.0, 0.0
    for step in range(record.steps[0]):
        if record.panels[step].half[lane] == 0.0:
            continue
        of_x, of_y = record.values[step * record.curves + force.x], record.values[step * record.curves + force.y]
        loaded, angle = False, 0.0
        x_before = y_before = square_before = 0.0
        for j in range(record.degree + 1):
            fx, fy = of_x[j, lane], of_y[j, lane]
            square = fx * fx + fy * fy
            counts, turned = square >= least * least, turn_to(x_before, y_before, fx, fy)
            continues = counts & loaded & (abs(turned) <= SHARP)
            if continues and ceases_between(record, force, step, j, min(square, square_before)):
                continues = False
            if loaded and not continues:
                count = add_stretch(angle, math.pi, step, j - 1, count, stretches)
            angle, x_before, y_before = angle + turned if continues else math.atan2(fy, fx), fx, fy
            if counts and not continues:
                count = add_stretch(angle, math.pi, step, j, count, stretches) if j > 0 else count
                count = add_stretch(angle, 0.0, step, j, count, stretches)
                low = high = angle
            if not (counts | loaded) and max(square, square_before) > least * least / NEAR_LEAST**2 and j > 0:
                count = add_between(record, force, step, j, count, stretches)
            if count > ends.shape[0]:
                return count
            loaded, square_before = counts, square
            if continues:
                # Between positions it may turn further by as much as it turns between the adjacent ones.
                lower, upper = min(angle, angle - turned) - abs(turned), max(angle, angle - turned) + abs(turned)
                low, high = min(low, lower), max(high, upper)
            if counts and angle < ends[count - 1, 0]:
                ends[count - 1, 0], places[count - 1, 0] = angle, j
            if counts and angle > ends[count - 1, 1]:
                ends[count - 1, 1], places[count - 1, 1] = angle, j
            if continues:
                margins[count - 1, 0], margins[count - 1, 1] = ends[count - 1, 0] - low, high - ends[count - 1, 1]
    return count


@routine
def extend(record: Record, force: Force, stretches: Stretches, i: int, side: int) -> None:
    """Refine one end of a stretch between the positions, and estimate its error.

    The farthest direction need not be next to the farthest position.
    """
    step, sense = stretches.step[i], 2.0 * side - 1.0
    lane, least, apart = force.lane, force.least, stretches.margins[i, side] == math.pi
    series, slot = series_of(record, force, step), step * record.curves
    of_x, of_y = record.values[slot + force.x], record.values[slot + force.y]
    j, stride = stretches.places[i, side], DEGREE // record.degree
    farthest, sensitivity = 0.0, 1.0 / math.sqrt(of_x[j, lane] ** 2 + of_y[j, lane] ** 2)
    for way in (-1, 1):
        j, reached, before = stretches.places[i, side], 0.0, SHARP
        while 0 <= j + way <= record.degree:
            fx, fy, gx, gy = of_x[j, lane], of_y[j, lane], of_x[j + way, lane], of_y[j + way, lane]
            turned = turn_to(fx, fy, gx, gy)
            square = min(fx * fx + fy * fy, gx * gx + gy * gy)
            ends = square < least * least or abs(turned) > SHARP
            if not apart and (ends or ceases_between(record, force, step, max(j, j + way), square)):
                break
            # Between positions it may turn further by as much as it turns between the adjacent ones.
            if apart or max(reached, reached + turned * sense) + max(before, abs(turned)) > farthest:
                further, sensitivity_there = farthest_turn(
                    series, PLACES[stride * j], PLACES[stride * (j + way)], sense, least
                )
                if reached + further > farthest:
                    farthest, sensitivity = reached + further, sensitivity_there
            if apart:
                break
            j, reached, before = j + way, reached + turned * sense, abs(turned)
    stretches.ends[i, side] += sense * farthest
    stretches.errors[i, side] = min(error_of(record, force, step) * sensitivity, math.pi)
    stretches.known[i, side] = True


@routine
def extend_near(record: Record, force: Force, stretches: Stretches, count: int, edge: float, side: int) -> bool:
    """Refine the ends of stretches that may reach beyond an edge of the widest gap; returns whether there were any."""
    any_extended = False
    for i in range(count):
        if stretches.known[i, side]:
            continue
        short = (edge - stretches.ends[i, side]) * (2.0 * side - 1.0)
        short -= math.floor(short / math.tau + 0.5) * math.tau
        if short <= stretches.margins[i, side]:
            extend(record, force, stretches, i, side)
            any_extended = True
    return any_extended


@routine
def widest_gap(stretches: Stretches, count: int) -> tuple[float, float, int, int]:
    """Widest gap between stretches on the circle: width and its error [rad], the stretch before it and the one after.

    Of gaps that are equal within their errors, the first from −π; directions within `NEAR_CUT` of π count as −π.
    """
    ends, errors, order = stretches.ends, stretches.errors, stretches.order
    for i in range(count):
        turns = math.floor((ends[i, 0] + math.pi + NEAR_CUT) / math.tau) * math.tau
        ends[i, 0] -= turns
        ends[i, 1] -= turns
        k = i
        while k > 0 and ends[order[k - 1], 0] > ends[i, 0]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = i
    widest, known, off, before, after, last = -1.0, -1.0, 0.0, order[0], order[0], order[0]
    reach = ends[last, 1]
    # Stretches that begin before the end of the turn may extend beyond its start.
    for i in range(count):
        if ends[i, 1] - math.tau > reach:
            last, reach = i, ends[i, 1] - math.tau
    for k in range(1, count + 1):
        i = order[k % count]
        begins = ends[i, 0] + (math.tau if k == count else 0.0)
        gap, off_here = begins - reach, errors[last, 1] + errors[i, 0] + 2.0 * ROUNDING * math.tau
        widest = max(gap, widest)
        if gap > known + off + off_here:
            known, off, before, after = gap, off_here, last, i
        elif gap + off_here > known:
            off = max(off_here, off)
        if ends[i, 1] > reach:
            last, reach = i, ends[i, 1]
    return widest, off, before, after


@routine
def edge_error(stretches: Stretches, count: int, edge: float, side: int) -> float:
    """How far stretches may reach beyond an edge of the widest gap by their errors."""
    error, sense = 0.0, 2.0 * side - 1.0
    for i in range(count):
        short = (edge - stretches.ends[i, side]) * sense
        short -= math.floor(short / math.tau + 0.5) * math.tau
        error = max(error, stretches.errors[i, side] - abs(short))
    return error


@routine
def find_unloaded_arcs(record: Record, x: int, y: int, greatest: ExtremeRows, stretches: Stretches) -> None:
    """Find the widest arc to which a force never points, and its middle.

    Parameters
    ----------
    record : Record
    x, y : int
        Curves of the record: the force in the axes of a link.
    greatest : ExtremeRows
        Maximum of its squared magnitude.
    stretches : Stretches
        Its `arc` is the output [rad]: 2π without a middle if there is no force, 0 if there is no gap, NaN if a force is
        NaN or infinite or has too many stretches.
    """
    found, ends = stretches.arc, stretches.ends
    for lane in range(LANES):
        found.arc[lane] = found.arc_error[lane] = found.middle[lane] = found.middle_error[lane] = math.nan
        most = math.sqrt(greatest.value[lane])
        if most == 0.0:
            found.arc[lane], found.arc_error[lane] = math.tau, 0.0
        if not 0.0 < most < math.inf:
            continue
        force = Force(x, y, lane, LEAST_LOAD * most, LEAST_LOAD * 0.5 * greatest.value_error[lane] / most)
        count = find_stretches(record, force, stretches)
        if count == 0 or count > ends.shape[0]:
            continue
        arc, error, before, after = widest_gap(stretches, count)
        refining = arc > 0.0
        while refining:
            refining = extend_near(record, force, stretches, count, ends[before, 1], 1)
            refining |= extend_near(record, force, stretches, count, ends[after, 0], 0)
            arc, error, before, after = widest_gap(stretches, count)
        # At a kink between two panels both stretches end there, each with its own error.
        edges = edge_error(stretches, count, ends[before, 1], 1) + edge_error(stretches, count, ends[after, 0], 0)
        error = max(error, edges)
        middle = ends[before, 1] + 0.5 * arc
        found.arc[lane], found.arc_error[lane] = max(arc, 0.0), error
        found.middle_error[lane] = 0.5 * error if error < arc else math.pi
        # Above −π by more than its error.
        found.middle[lane] = middle - math.ceil((middle - found.middle_error[lane]) / math.tau - 0.5) * math.tau
