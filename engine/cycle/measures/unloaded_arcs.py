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

from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.chebyshev import DEGREE, PLACES, POSITIONS
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.record import HALF, SCALE, TAIL, Record, known_slot

# Share of the greatest load below which a bearing counts as unloaded.
LEAST_LOAD = 1e-3
TURN = 2.0 * math.pi
# Rows of the result: the arc and its error, its middle and its error.
ARC, ARC_ERROR, ARC_MIDDLE, MIDDLE_ERROR = range(4)
ARCS = 4
# Of a stretch of directions: its ends LOW and HIGH, counted from its own panel's first direction; what they may be off
# by; where they are in the panel; whether they are known between the positions, too.
LOW, HIGH, LOW_ERROR, HIGH_ERROR, LOW_PLACE, HIGH_PLACE, LOW_KNOWN, HIGH_KNOWN, STEP = range(9)
STRETCH = 9
# A force that turns by more from one position to the next [rad] may be nearly 0 in between, and turn either way.
SHARP = 0.5
# What a force is followed to between positions, instead of a value of its square: where it turns back, or is least.
TURNS_BACK, IS_LEAST = 0.0, -1.0
# Stretches that there is room for; halvings of the interval between two positions.
MOST_STRETCHES, HALVINGS = 1024, 50


class ForceSeries(NamedTuple):
    """A force in one lane and panel, as series of its components.

    Attributes
    ----------
    x, y : rows (POSITIONS, LANES)
        Coefficients.
    lane : int
    """

    x: Memory
    y: Memory
    lane: int


@inlined
def value_and_slope(series: Memory, lane: int, x: float) -> tuple[float, float]:
    """A series and its derivative at x."""
    b = b_before = d = d_before = 0.0
    for i in range(DEGREE):
        d, d_before = 2.0 * b + (2.0 * x * d - d_before), d
        b, b_before = series[DEGREE - i, lane] + (2.0 * x * b - b_before), b
    return series[0, lane] + (x * b - b_before), b + (x * d - d_before)


@routine
def force_at(force: ForceSeries, x: float) -> tuple[float, float, float, float]:
    """Components of a force; how fast it turns times its square, half of how fast its square grows."""
    fx, slope_x = value_and_slope(force.x, force.lane, x)
    fy, slope_y = value_and_slope(force.y, force.lane, x)
    return fx, fy, fx * slope_y - fy * slope_x, fx * slope_x + fy * slope_y


@routine
def place_where(force: ForceSeries, low: float, high: float, square: float) -> float:
    """Where between two places the force turns back or is least, or its square takes a value; else the second one."""
    fx, fy, turning, growing = force_at(force, low)
    at_low = fx * fx + fy * fy - square if square > 0.0 else (turning if square == TURNS_BACK else growing)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        fx, fy, turning, growing = force_at(force, middle)
        here = fx * fx + fy * fy - square if square > 0.0 else (turning if square == TURNS_BACK else growing)
        beside_low = (here > 0.0) == (at_low > 0.0)
        low, high = middle if beside_low else low, high if beside_low else middle
    return 0.5 * (low + high)


@inlined
def turn_to(x: float, y: float, x_after: float, y_after: float) -> float:
    """Angle from one vector to another, from −π to π [rad]."""
    return math.atan2(x * y_after - y * x_after, x * x_after + y * y_after)


@routine
def add_stretch(angle: float, step: int, j: int, count: int, stretches: np.ndarray) -> int:
    """Enter a stretch that is one direction so far, where there is room; returns how many there are, or would be."""
    if count < stretches.shape[0]:
        stretches[count, LOW] = stretches[count, HIGH] = angle
        stretches[count, LOW_PLACE] = stretches[count, HIGH_PLACE] = j
        stretches[count, LOW_ERROR] = stretches[count, HIGH_ERROR] = 0.0
        stretches[count, LOW_KNOWN] = stretches[count, HIGH_KNOWN] = 0.0
        stretches[count, STEP] = step
    return count + 1


@routine
def find_stretches(record: Record, steps: int, x: int, y: int, lane: int, least: float, stretches: np.ndarray) -> int:
    """Stretches of directions of a force over the panels of a lane, from its values at the positions.

    Where it begins or ceases to count, or turns sharply, it may turn there and back between two positions: those beside
    are stretches of their own, too.

    Returns
    -------
    int
        How many there are, one more than there is room for where there are too many.
    """
    values, count = record.values, 0
    for step in range(steps):
        if record.panels[step, HALF, lane] == 0.0:
            continue
        of_x, of_y, loaded = step * record.curves + x, step * record.curves + y, False
        angle = x_before = y_before = 0.0
        for j in range(POSITIONS):
            fx, fy = values[of_x, j, lane], values[of_y, j, lane]
            counts = fx * fx + fy * fy >= least * least
            turned = turn_to(x_before, y_before, fx, fy)
            goes_on = counts & loaded & (abs(turned) <= SHARP)
            if loaded and not goes_on:
                count = add_stretch(angle, step, j - 1, count, stretches)
            angle, x_before, y_before = angle + turned if goes_on else math.atan2(fy, fx), fx, fy
            if counts and not goes_on:
                count = add_stretch(angle, step, j, count, stretches) if j > 0 else count
                count = add_stretch(angle, step, j, count, stretches)
            if count > stretches.shape[0]:
                return count
            loaded = counts
            if counts and angle < stretches[count - 1, LOW]:
                stretches[count - 1, LOW], stretches[count - 1, LOW_PLACE] = angle, j
            if counts and angle > stretches[count - 1, HIGH]:
                stretches[count - 1, HIGH], stretches[count - 1, HIGH_PLACE] = angle, j
    return count


@routine
def extend(
    record: Record, matrix: np.ndarray, x: int, y: int, lane: int, least: float, side: int, stretch: np.ndarray
) -> None:
    """Move one end of a stretch to where it is between the positions, and say what that may be off by."""
    step, j, sense = int(stretch[STEP]), int(stretch[LOW_PLACE + side]), 2.0 * side - 1.0
    slot_x, slot_y = known_slot(record, matrix, x, step), known_slot(record, matrix, y, step)
    force = ForceSeries(record.coefficients[slot_x], record.coefficients[slot_y], lane)
    fx, fy = record.values[slot_x, j, lane], record.values[slot_y, j, lane]
    off = record.errors[slot_x, TAIL, lane] + record.errors[slot_y, TAIL, lane]
    off += ROUNDING * (record.whole[x, SCALE, lane] + record.whole[y, SCALE, lane])
    farthest, error = 0.0, off / math.sqrt(fx * fx + fy * fy)
    for beside in (j - 1, j + 1):
        if beside < 0 or beside > DEGREE:
            continue
        gx, gy = record.values[slot_x, beside, lane], record.values[slot_y, beside, lane]
        limit = PLACES[beside]
        if abs(turn_to(fx, fy, gx, gy)) > SHARP:
            limit = place_where(force, PLACES[j], limit, IS_LEAST)
            gx, gy, _, _ = force_at(force, limit)
        _, _, turning, _ = force_at(force, PLACES[j])
        away = turning * sense * (limit - PLACES[j]) > 0.0
        ends = gx * gx + gy * gy < least * least
        if not (away or ends):
            continue
        place = place_where(force, PLACES[j], limit, least * least if ends else TURNS_BACK)
        hx, hy, turning, growing = force_at(force, place)
        turned = turn_to(fx, fy, hx, hy)
        if turned * sense > farthest:
            farthest, size = turned * sense, math.sqrt(hx * hx + hy * hy)
            # Where it begins to count isn't known better than the force.
            moved = abs(turning / growing) * off / size if ends else 0.0
            error = off / size + moved
    stretch[LOW + side] += sense * farthest
    stretch[LOW_ERROR + side], stretch[LOW_KNOWN + side] = min(error, math.pi), 1.0


@routine
def margin_of(record: Record, x: int, y: int, lane: int, side: int, stretch: np.ndarray) -> float:
    """How far one end of a stretch may be beyond its position: as far as the force turns to its neighbours.

    Where it turns sharply, it may be anywhere.
    """
    slot, j, most = int(stretch[STEP]) * record.curves, int(stretch[LOW_PLACE + side]), 0.0
    fx, fy = record.values[slot + x, j, lane], record.values[slot + y, j, lane]
    for beside in range(max(j - 1, 0), min(j + 1, DEGREE) + 1):
        gx, gy = record.values[slot + x, beside, lane], record.values[slot + y, beside, lane]
        turned = abs(turn_to(fx, fy, gx, gy))
        most = max(most, turned if turned <= SHARP else math.pi)
    return most


@routine
def extend_near(
    record: Record,
    matrix: np.ndarray,
    x: int,
    y: int,
    lane: int,
    least: float,
    edge: float,
    side: int,
    count: int,
    stretches: np.ndarray,
) -> bool:
    """Extend the ends of stretches that may reach beyond an edge of the widest gap; whether there were any."""
    any_extended = False
    for i in range(count):
        if stretches[i, LOW_KNOWN + side] > 0.0:
            continue
        short = (edge - stretches[i, LOW + side]) * (2.0 * side - 1.0)
        short -= math.floor(short / TURN + 0.5) * TURN
        if short <= margin_of(record, x, y, lane, side, stretches[i]):
            extend(record, matrix, x, y, lane, least, side, stretches[i])
            any_extended = True
    return any_extended


@routine
def widest_gap(count: int, stretches: np.ndarray, order: np.ndarray) -> tuple[float, int, int]:
    """Widest gap between stretches on the circle: its width, the stretch before it and the one after."""
    for i in range(count):
        turns = math.floor((stretches[i, LOW] + math.pi) / TURN) * TURN
        stretches[i, LOW] -= turns
        stretches[i, HIGH] -= turns
        k = i
        while k > 0 and stretches[order[k - 1], LOW] > stretches[i, LOW]:
            order[k] = order[k - 1]
            k -= 1
        order[k] = i
    widest, before, after, last = -1.0, order[0], order[0], order[0]
    reach = stretches[last, HIGH]
    # Stretches that begin before the turn's end may go on beyond its begin.
    for i in range(count):
        if stretches[i, HIGH] - TURN > reach:
            last, reach = i, stretches[i, HIGH] - TURN
    for k in range(1, count + 1):
        i = order[k % count]
        begins = stretches[i, LOW] + (TURN if k == count else 0.0)
        if begins - reach > widest:
            widest, before, after = begins - reach, last, i
        if stretches[i, HIGH] > reach:
            last, reach = i, stretches[i, HIGH]
    return widest, before, after


@routine
def find_unloaded_arcs(
    record: Record,
    matrix: np.ndarray,
    steps: int,
    x: int,
    y: int,
    greatest: Memory,
    stretches: np.ndarray,
    order: np.ndarray,
    result: Memory,
) -> None:
    """Widest arc that a force never points to, and its middle.

    Parameters
    ----------
    record : Record
    matrix : ndarray
        `chebyshev.TO_COEFFICIENTS`.
    steps : int
        How many steps the record has.
    x, y : int
        Curves of the record: the force in the axes of a link.
    greatest : row (LANES,)
        Its greatest magnitude.
    stretches : ndarray (MOST_STRETCHES, STRETCH)
    order : ndarray (MOST_STRETCHES,) of int
        Used meanwhile.
    result : rows (ARCS, LANES)
        Receives them [rad]; the arc is a whole turn, without a middle, where there is no force at all, and less than
        nothing is 0; NaN where a force isn't finite, or has too many stretches.
    """
    for lane in range(LANES):
        for part in range(ARCS):
            result[part, lane] = math.nan
        if greatest[lane] == 0.0:
            result[ARC, lane], result[ARC_ERROR, lane] = TURN, 0.0
        if not 0.0 < greatest[lane] < math.inf:
            continue
        least = LEAST_LOAD * greatest[lane]
        count = find_stretches(record, steps, x, y, lane, least, stretches)
        if count == 0 or count > stretches.shape[0]:
            continue
        arc, before, after = widest_gap(count, stretches, order)
        going = arc > 0.0
        while going:
            going = extend_near(record, matrix, x, y, lane, least, stretches[before, HIGH], 1, count, stretches)
            going |= extend_near(record, matrix, x, y, lane, least, stretches[after, LOW], 0, count, stretches)
            arc, before, after = widest_gap(count, stretches, order)
        error = stretches[before, HIGH_ERROR] + stretches[after, LOW_ERROR] + 2.0 * ROUNDING * TURN
        middle = stretches[before, HIGH] + 0.5 * arc
        result[ARC, lane], result[ARC_ERROR, lane] = max(arc, 0.0), error
        result[ARC_MIDDLE, lane] = middle - math.floor(middle / TURN + 0.5) * TURN
        result[MIDDLE_ERROR, lane] = 0.5 * error if error < arc else math.pi
