"""Curves at points: a printed function called with another position, and maybe another variant, in each lane."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, gather, in_lanes, rows, scatter_rows
from engine.compiling.decorators import driver
from engine.compiling.printed_functions import PrintedFunction
from engine.compiling.running import spread
from engine.laws.elementary import direction_of

NO_NUMBERS, NO_ROWS = np.empty((0, 0)), np.empty(0, np.int64)
# For functions of the variant's numbers only.
NOWHERE = np.empty(0)
# Rows of a block in addition to numbers and curves: position with cosine and sine.
_ALSO = 3


class Points(NamedTuple):
    """Points, and curves there; point i belongs to variant i modulo their number.

    Attributes
    ----------
    numbers : ndarray (numbers, variants)
    memory : ndarray
        All tables.
    q : ndarray (points,)
        Input positions [rad]; empty if no curve depends on them.
    out : ndarray (curves, points)
    given : ndarray (given, points)
        Numbers that replace those of the variants.
    given_rows : ndarray (given,) of int
        Rows of these.
    """

    numbers: np.ndarray
    memory: np.ndarray
    q: np.ndarray
    out: np.ndarray
    given: np.ndarray = NO_NUMBERS
    given_rows: np.ndarray = NO_ROWS


def fill_points(function: PrintedFunction, points: Points) -> np.ndarray:
    """Fill curves at points, and return them.

    Parameters
    ----------
    function : PrintedFunction
        Fills the curves at one position.
    points : Points
    """
    size = len(points.numbers) + _ALSO + len(points.out)
    spread(_fill, -(-points.out.shape[1] // LANES), lambda: (function, points, rows(size)))
    return points.out


@driver
def _fill(begin: int, end: int, function: Callable, points: Points, room: np.ndarray) -> None:
    """Fill the blocks begin … end − 1 of points; `room` is scratch memory for a block."""
    (count, variants), (curves, size) = points.numbers.shape, points.out.shape
    block, place, tile = room[:count], room[count : count + 3], room[count + 3 :].reshape(curves, 1, LANES)
    numbers, position, filled = in_lanes(block), in_lanes(place), in_lanes(room[count + 3 :])
    for b in range(begin, end):
        first = b * LANES
        # Lanes of successive variants load faster.
        successive = first % variants + LANES <= variants
        if successive or size == variants:
            gather(points.numbers, first % variants, numbers)
        else:
            for lane in range(LANES):
                variant = min(first + lane, size - 1) % variants
                for i in range(count):
                    numbers[i, lane] = points.numbers[i, variant]
        for lane in range(LANES if points.given_rows.size + points.q.size else 0):
            point = min(first + lane, size - 1)
            for i in range(points.given_rows.shape[0]):
                numbers[points.given_rows[i], lane] = points.given[i, point]
            if points.q.size:
                position[0, lane] = points.q[point]
                position[1, lane], position[2, lane] = direction_of(position[0, lane])
        function(block, points.memory, place[0:1], place[1:2], place[2:3], tile)
        scatter_rows(filled, first, points.out)
