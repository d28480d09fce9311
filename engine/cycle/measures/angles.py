"""Angle of a vector of two kept curves, continuous over the cycle.

From one position to the next the vector is taken to turn by less than π. Where it turns sharply, its series show on
which side it passes zero; where the dip is within their errors, or the vector reverses at once, the turn is unknown.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, Rows
from engine.compiling.decorators import inlined, routine
from engine.cycle.panels.chebyshev import DEGREE, PLACES
from engine.cycle.panels.integrals import ROUNDING
from engine.cycle.panels.record import Record, keep_derived, known_slot
from engine.cycle.panels.series import TINY, larger, series_at, smaller
from engine.laws.elementary import angle_of

# A vector that turns by more than this between two positions [rad] may pass near zero and turn in either sense.
SHARP = 0.5
# A turn within this of π [rad] is a reversal.
BACK = 1e-9
# Targets of `place_where`, apart from a value of the square: where the vector reverses its turning, or is shortest.
TURNS_BACK, IS_LEAST = 0.0, -1.0
# Bisections of the interval between two positions.
HALVINGS = 50


class VectorSeries(NamedTuple):
    """A vector in one lane and panel, as series of its components.

    Attributes
    ----------
    x, y : rows (POSITIONS, LANES)
        Coefficients.
    lane : int
    """

    x: Rows
    y: Rows
    lane: int


class FollowedAngle(NamedTuple):
    """Scratch rows for following an angle.

    Attributes
    ----------
    reached : row
        Angle so far [rad].
    x, y : row
        The vector there.
    shortest : row
        Minimum length of the vector in a panel.
    sharpest : row
        Maximum turn between two positions of the panel [rad].
    off : row
        Error estimate of the vector in the panel.
    unknown : row
        Sum of the turns so far whose sense is unknown [rad].
    """

    reached: Row
    x: Row
    y: Row
    shortest: Row
    sharpest: Row
    off: Row
    unknown: Row


@routine
def vector_at(vector: VectorSeries, x: float) -> tuple[float, float, float, float]:
    """Components of a vector, its rate of turn times its square, and half the rate of its square."""
    fx, slope_x, _ = series_at(vector.x, vector.lane, x)
    fy, slope_y, _ = series_at(vector.y, vector.lane, x)
    return fx, fy, fx * slope_y - fy * slope_x, fx * slope_x + fy * slope_y


@routine
def place_where(vector: VectorSeries, low: float, high: float, square: float) -> float:
    """Position where a vector reverses its turning, is shortest, or its square takes a value; else `high`."""
    fx, fy, turning, growing = vector_at(vector, low)
    at_low = fx * fx + fy * fy - square if square > 0.0 else (turning if square == TURNS_BACK else growing)
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        fx, fy, turning, growing = vector_at(vector, middle)
        here = fx * fx + fy * fy - square if square > 0.0 else (turning if square == TURNS_BACK else growing)
        like_low = (here > 0.0) == (at_low > 0.0)
        low, high = middle if like_low else low, high if like_low else middle
    return 0.5 * (low + high)


@inlined
def turn_to(x: float, y: float, x_after: float, y_after: float) -> float:
    """Angle from one vector to another, between −π and π [rad]."""
    return math.atan2(x * y_after - y * x_after, x * x_after + y * y_after)


@routine
def _follow(of_x: Rows, of_y: Rows, degree: int, half: Row, angle: Rows, state: FollowedAngle) -> None:
    """Compute the angles at the positions of a step; lanes without a panel keep theirs."""
    for lane in range(LANES):
        state.shortest[lane], state.sharpest[lane] = np.inf, 0.0
    for j in range(degree + 1):
        for lane in range(LANES):
            x, y, x_before, y_before = of_x[j, lane], of_y[j, lane], state.x[lane], state.y[lane]
            reached, shortest, size = state.reached[lane], state.shortest[lane], np.sqrt(x * x + y * y)
            turned = angle_of(x_before * x + y_before * y, x_before * y - y_before * x)
            # A zero vector doesn't turn.
            turned = 0.0 if size == 0.0 else turned
            panel = half[lane] != 0.0
            taken = panel & (size != 0.0)
            angle[j, lane] = reached + turned
            state.reached[lane] = reached + turned if taken else reached
            state.x[lane], state.y[lane] = x if taken else x_before, y if taken else y_before
            state.shortest[lane] = smaller(size, shortest) if panel else shortest
            state.sharpest[lane] = larger(abs(turned) if taken else 0.0, state.sharpest[lane])
            state.unknown[lane] += math.tau if taken & (abs(turned) > math.pi - BACK) else 0.0


@routine
def _pass_dips(vector: VectorSeries, of_x: Rows, of_y: Rows, degree: int, angle: Rows, state: FollowedAngle) -> None:
    """Correct a lane's angles in a panel where the vector passes zero on the other side between two positions."""
    lane, shift, stride = vector.lane, 0.0, DEGREE // degree
    for j in range(1, degree + 1):
        x, y, x_after, y_after = of_x[j - 1, lane], of_y[j - 1, lane], of_x[j, lane], of_y[j, lane]
        turned = turn_to(x, y, x_after, y_after)
        if abs(turned) > SHARP:
            dip_x, dip_y, _, _ = vector_at(
                vector, place_where(vector, PLACES[stride * (j - 1)], PLACES[stride * j], IS_LEAST)
            )
            past = turn_to(x, y, dip_x, dip_y) + turn_to(dip_x, dip_y, x_after, y_after)
            shift += math.floor((past - turned) / math.tau + 0.5) * math.tau
            if dip_x * dip_x + dip_y * dip_y <= state.off[lane] * state.off[lane]:
                state.unknown[lane] += math.tau
        angle[j, lane] += shift
    state.reached[lane] += shift


@routine
def add_angle(record: Record, x: int, y: int, angle: int, state: FollowedAngle) -> None:
    """Compute the angle [rad] of a vector of two kept curves as another kept curve.

    Parameters
    ----------
    record : Record
    x, y : int
        Curves of the record.
    angle : int
        Curve of the record that receives the angle.
    state : FollowedAngle
        Scratch.
    """
    values, of_x, of_y, offset = record.values, record.whole[x], record.whole[y], record.whole[angle].offset
    # Angles start from the x-axis.
    for lane in range(LANES):
        state.reached[lane] = state.y[lane] = state.unknown[lane] = 0.0
        state.x[lane] = 1.0
    for step in range(record.steps[0]):
        slot, half = step * record.curves, record.panels[step].half
        tail_x, tail_y, tail = record.left[slot + x].tail, record.left[slot + y].tail, record.left[slot + angle].tail
        _follow(values[slot + x], values[slot + y], record.degree, half, values[slot + angle], state)
        for lane in range(LANES):
            rounding = ROUNDING * larger(of_x.scale[lane], of_y.scale[lane])
            rounding += of_x.offset[lane] + of_y.offset[lane]
            state.off[lane] = tail_x[lane] + tail_y[lane] + rounding
            shortest = larger(state.shortest[lane], TINY)
            offset[lane] = larger(smaller(rounding / shortest, np.pi), offset[lane])
            if half[lane] != 0.0 and state.sharpest[lane] > SHARP:
                vector_x, vector_y = known_slot(record, x, step), known_slot(record, y, step)
                vector = VectorSeries(record.coefficients[vector_x], record.coefficients[vector_y], lane)
                of_angle = values[slot + angle]
                _pass_dips(vector, values[slot + x], values[slot + y], record.degree, of_angle, state)
        keep_derived(record, step, angle)
        for lane in range(LANES):
            both, shortest = tail_x[lane] + tail_y[lane], larger(state.shortest[lane], TINY)
            tail[lane] += smaller(both / shortest, np.pi)
    for lane in range(LANES):
        offset[lane] += state.unknown[lane]
