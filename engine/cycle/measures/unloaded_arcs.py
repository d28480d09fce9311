"""Where on its circumference a bearing is never loaded: the widest arc that a force over the cycle never points to.

A film of oil is fed where it is never loaded. In the axes of the link that holds the bush the force on it points to the
place that is pressed; in those of the link with the journal it points away from it. Where the force is less than
`LEAST_LOAD` of its greatest it counts as none.

Over each panel the force, where it counts, sweeps stretches of directions. The widest gap between all of these is found
from the positions; then the directions on either side of it are found between the positions, too, until no other
may reach into the widest gap.

Source: any course of machine elements, chapter on plain bearings (polar diagrams of bearing load; place of the oil
hole).
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row
from engine.compiling.decorators import routine
from engine.compiling.widths import LANES
from engine.cycle.measures.angles import (
    IS_LEAST,
    SHARP,
    TURN,
    TURNS_BACK,
    VectorSeries,
    place_where,
    turn_to,
    vector_at,
)
from engine.cycle.panels.chebyshev import DEGREE, PLACES, POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import new_record, one
from engine.cycle.panels.record import Record, known_slot

# Share of the greatest load below which a bearing counts as unloaded.
LEAST_LOAD = 1e-3
# Stretches that there is room for.
MOST_STRETCHES = 1024


class Arc(NamedTuple):
    """The widest arc that a force never points to.

    Attributes
    ----------
    arc, arc_error : row
    middle, middle_error : row
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
        Counted from the panel's first direction.
    places : ndarray (stretches, 2) of int
        Their positions in the panel.
    known : ndarray (stretches, 2) of bool
        Whether they are known between the positions, too.
    order : ndarray (stretches,) of int
        Stretches by their lower ends.
    arc : Arc
        Receives what is found.
    """

    step: np.ndarray
    ends: np.ndarray
    errors: np.ndarray
    places: np.ndarray
    known: np.ndarray
    order: np.ndarray
    arc: one(Arc)


class Force(NamedTuple):
    """A force in one lane.

    Attributes
    ----------
    x, y : int
        Curves of the record.
    lane : int
    least : float
        Below this magnitude it counts as none.
    """

    x: int
    y: int
    lane: int
    least: float


def new_stretches() -> Stretches:
    """Memory for stretches."""
    pairs = {name: np.zeros((MOST_STRETCHES, 2)) for name in ("ends", "errors")}
    places, known = np.zeros((MOST_STRETCHES, 2), np.int64), np.zeros((MOST_STRETCHES, 2), np.bool_)
    step, order = (np.zeros(MOST_STRETCHES, np.int64) for _ in range(2))
    return new_record(Stretches, step=step, places=places, known=known, order=order, **pairs)


@routine
def add_stretch(angle: float, step: int, j: int, count: int, stretches: Stretches) -> int:
    """Enter a stretch that is one direction so far, where there is room; returns how many there are, or would be."""
    if count < stretches.ends.shape[0]:
        stretches.step[count] = step
        for side in range(2):
            stretches.ends[count, side], stretches.places[count, side] = angle, j
            stretches.errors[count, side], stretches.known[count, side] = 0.0, False
    return count + 1


@routine
def find_stretches(record: Record, force: Force, stretches: Stretches) -> int:
    """Stretches of directions of a force over the panels of a lane, from its values at the positions.

    Where it begins or ceases to count, or turns sharply, it may turn there and back between two positions: those beside
    are stretches of their own, too.

    Returns
    -------
    int
        How many there are, one more than there is room for where there are too many.
    """
    lane, least, ends, places, count = force.lane, force.least, stretches.ends, stretches.places, 0
    for step in range(record.steps[0]):
        if record.panels[step].half[lane] == 0.0:
            continue
        of_x, of_y = record.values[step * record.curves + force.x], record.values[step * record.curves + force.y]
        loaded, angle = False, 0.0
        x_before = y_before = 0.0
        for j in range(POSITIONS):
            fx, fy = of_x[j, lane], of_y[j, lane]
            counts = fx * fx + fy * fy >= least * least
            turned = turn_to(x_before, y_before, fx, fy)
            goes_on = counts & loaded & (abs(turned) <= SHARP)
            if loaded and not goes_on:
                count = add_stretch(angle, step, j - 1, count, stretches)
            angle, x_before, y_before = angle + turned if goes_on else math.atan2(fy, fx), fx, fy
            if counts and not goes_on:
                count = add_stretch(angle, step, j, count, stretches) if j > 0 else count
                count = add_stretch(angle, step, j, count, stretches)
            if count > ends.shape[0]:
                return count
            loaded = counts
            if counts and angle < ends[count - 1, 0]:
                ends[count - 1, 0], places[count - 1, 0] = angle, j
            if counts and angle > ends[count - 1, 1]:
                ends[count - 1, 1], places[count - 1, 1] = angle, j
    return count


@routine
def extend(record: Record, force: Force, stretches: Stretches, i: int, side: int) -> None:
    """Move one end of a stretch to where it is between the positions, and say what that may be off by."""
    step, j, sense = stretches.step[i], stretches.places[i, side], 2.0 * side - 1.0
    lane, least = force.lane, force.least
    slot_x, slot_y = known_slot(record, force.x, step), known_slot(record, force.y, step)
    series = VectorSeries(record.coefficients[slot_x], record.coefficients[slot_y], lane)
    of_x, of_y = record.values[slot_x], record.values[slot_y]
    fx, fy = of_x[j, lane], of_y[j, lane]
    off = record.left[slot_x].tail[lane] + record.left[slot_y].tail[lane]
    off += ROUNDING * (record.whole[force.x].scale[lane] + record.whole[force.y].scale[lane])
    farthest, error = 0.0, off / math.sqrt(fx * fx + fy * fy)
    for beside in (j - 1, j + 1):
        if beside < 0 or beside > DEGREE:
            continue
        gx, gy = of_x[beside, lane], of_y[beside, lane]
        limit = PLACES[beside]
        if abs(turn_to(fx, fy, gx, gy)) > SHARP:
            limit = place_where(series, PLACES[j], limit, IS_LEAST)
            gx, gy, _, _ = vector_at(series, limit)
        _, _, turning, _ = vector_at(series, PLACES[j])
        away = turning * sense * (limit - PLACES[j]) > 0.0
        ends = gx * gx + gy * gy < least * least
        if not (away or ends):
            continue
        place = place_where(series, PLACES[j], limit, least * least if ends else TURNS_BACK)
        hx, hy, turning, growing = vector_at(series, place)
        turned = turn_to(fx, fy, hx, hy)
        if turned * sense > farthest:
            farthest, size = turned * sense, math.sqrt(hx * hx + hy * hy)
            # Where it begins to count isn't known better than the force.
            moved = abs(turning / growing) * off / size if ends else 0.0
            error = off / size + moved
    stretches.ends[i, side] += sense * farthest
    stretches.errors[i, side], stretches.known[i, side] = min(error, math.pi), True


@routine
def margin_of(record: Record, force: Force, stretches: Stretches, i: int, side: int) -> float:
    """How far one end of a stretch may be beyond its position: as far as the force turns to its neighbours.

    Where it turns sharply, it may be anywhere.
    """
    slot, j, lane, most = stretches.step[i] * record.curves, stretches.places[i, side], force.lane, 0.0
    of_x, of_y = record.values[slot + force.x], record.values[slot + force.y]
    for beside in range(max(j - 1, 0), min(j + 1, DEGREE) + 1):
        turned = abs(turn_to(of_x[j, lane], of_y[j, lane], of_x[beside, lane], of_y[beside, lane]))
        most = max(most, turned if turned <= SHARP else math.pi)
    return most


@routine
def extend_near(record: Record, force: Force, stretches: Stretches, count: int, edge: float, side: int) -> bool:
    """Extend the ends of stretches that may reach beyond an edge of the widest gap; whether there were any."""
    any_extended = False
    for i in range(count):
        if stretches.known[i, side]:
            continue
        short = (edge - stretches.ends[i, side]) * (2.0 * side - 1.0)
        short -= math.floor(short / TURN + 0.5) * TURN
        if short <= margin_of(record, force, stretches, i, side):
            extend(record, force, stretches, i, side)
            any_extended = True
    return any_extended


@routine
def widest_gap(stretches: Stretches, count: int) -> tuple[float, int, int]:
    """Widest gap between stretches on the circle: its width, the stretch before it and the one after."""
    ends, order = stretches.ends, stretches.order
    for i in range(count):
        turns = math.floor((ends[i, 0] + math.pi) / TURN) * TURN
        ends[i, 0] -= turns
        ends[i, 1] -= turns
        k = i
        while k > 0 and ends[order[k - 1], 0] > ends[i, 0]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = i
    widest, before, after, last = -1.0, order[0], order[0], order[0]
    reach = ends[last, 1]
    # Stretches that begin before the turn's end may go on beyond its begin.
    for i in range(count):
        if ends[i, 1] - TURN > reach:
            last, reach = i, ends[i, 1] - TURN
    for k in range(1, count + 1):
        i = order[k % count]
        begins = ends[i, 0] + (TURN if k == count else 0.0)
        if begins - reach > widest:
            widest, before, after = begins - reach, last, i
        if ends[i, 1] > reach:
            last, reach = i, ends[i, 1]
    return widest, before, after


@routine
def find_unloaded_arcs(record: Record, x: int, y: int, greatest: Row, stretches: Stretches) -> None:
    """Widest arc that a force never points to, and its middle.

    Parameters
    ----------
    record : Record
    x, y : int
        Curves of the record: the force in the axes of a link.
    greatest : row
        Its greatest magnitude.
    stretches : Stretches
        Its `arc` receives them [rad]; the arc is a whole turn, without a middle, where there is no force at all, and
        less than nothing is 0; NaN where a force isn't finite, or has too many stretches.
    """
    found, ends, errors = stretches.arc, stretches.ends, stretches.errors
    for lane in range(LANES):
        found.arc[lane] = found.arc_error[lane] = found.middle[lane] = found.middle_error[lane] = math.nan
        if greatest[lane] == 0.0:
            found.arc[lane], found.arc_error[lane] = TURN, 0.0
        if not 0.0 < greatest[lane] < math.inf:
            continue
        force = Force(x, y, lane, LEAST_LOAD * greatest[lane])
        count = find_stretches(record, force, stretches)
        if count == 0 or count > ends.shape[0]:
            continue
        arc, before, after = widest_gap(stretches, count)
        going = arc > 0.0
        while going:
            going = extend_near(record, force, stretches, count, ends[before, 1], 1)
            going |= extend_near(record, force, stretches, count, ends[after, 0], 0)
            arc, before, after = widest_gap(stretches, count)
        error = errors[before, 1] + errors[after, 0] + 2.0 * ROUNDING * TURN
        middle = ends[before, 1] + 0.5 * arc
        found.arc[lane], found.arc_error[lane] = max(arc, 0.0), error
        found.middle_error[lane] = 0.5 * error if error < arc else math.pi
        # Above −π by more than its error.
        found.middle[lane] = middle - math.ceil((middle - found.middle_error[lane]) / TURN - 0.5) * TURN
