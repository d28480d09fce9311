"""Kept fields: curves at equally spaced positions, one variant after the other."""

import math
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, gather, in_lanes
from engine.compiling.decorators import driver, routine
from engine.compiling.printed_functions import PrintedFunction
from engine.compiling.running import spread
from engine.cycle.measures.angles import SHARP
from engine.graph.functions import Functions, field_function
from engine.graph.nodes import Node
from engine.laws.elementary import angle_or_zero, direction_of
from engine.quantities.expressions import Angle

# Rows of the ends of each variant's range, if the positions are the same for all variants.
NONE = (-1, -1)
# Shortest step, as a fraction of the position, in which a direction that turns sharply is followed: shorter ones are
# lost in the rounding of a position far from zero.
LEAST_STEP = 2.0**-50


def field_node(curve: Node | Angle) -> Node:
    """Node computed at a position: the curve; for an angle, its value between −π and π."""
    if isinstance(curve, Angle):
        x, y = curve.direction
        return x.graph.apply(angle_or_zero, x, y)
    return curve


class KeptFields:
    """Fields that are kept.

    Parameters
    ----------
    curves : sequence of Node or Angle
    functions : Functions
        Functions of the machine, with the numbers of these curves' `field_node` in their layout.
    dtype : float64 or float32
        Type in which they are stored; they are computed in double precision.
    """

    def __init__(self, curves: Sequence[Node | Angle], functions: Functions, dtype: np.dtype) -> None:
        self._functions, self._dtype = functions, np.dtype(dtype)
        self._followed = np.array([i for i, curve in enumerate(curves) if isinstance(curve, Angle)], np.intp)
        self.code = field_function([field_node(curve) for curve in curves], functions.rows, self._dtype)

    @cached_property
    def _function(self) -> PrintedFunction:
        return PrintedFunction(self.code)

    def fill(
        self, table: np.ndarray, q: np.ndarray, fields: np.ndarray, places: np.ndarray, ends: tuple[int, int] = NONE
    ) -> np.ndarray:
        """Fill the fields of some variants.

        Parameters
        ----------
        table : ndarray (numbers, variants)
            Including the numbers of the cycle, see `Measuring.fill_found`.
        q : ndarray (positions,)
            Input positions; with `ends`, as shares of each variant's range.
        fields : ndarray (fields, variants, positions)
            Output.
        places : ndarray (variants,) of int
            Index in the fields of each variant in the table.
        ends : tuple of int
            Rows of the table with the ends of each variant's range.

        Returns
        -------
        ndarray (variants,) of bool
            Whether all values of each variant are finite.
        """
        finite = np.empty(table.shape[1], np.bool_)
        positions = np.stack([q, np.cos(q), np.sin(q)])
        table, memory = np.ascontiguousarray(table), self._functions.memory
        kept = _Kept(table, memory, places, positions, ends, self._followed)

        def arguments() -> tuple:
            return self._function, kept, fields, finite, _new_scratch(len(table), positions, fields)

        spread(_fill, -(-table.shape[1] // LANES), arguments)
        return finite


@routine
def _follow(function: Callable, memory: np.ndarray, scratch: "_Scratch", row: np.ndarray, i: int) -> None:
    """Unwrap angles between −π and π of a direction, field `i`."""
    sharp = False
    for k in range(1, row.shape[0]):
        sharp |= abs(row[k] - row[k - 1]) > SHARP
    if not sharp:
        return
    before, turns = row[0], 0.0
    for k in range(1, row.shape[0]):
        here = row[k]
        step = here - before
        if abs(step) > SHARP:
            turned = _turned(function, memory, scratch, i, (k, before, here))
            # Positions without a value keep the turns so far.
            turns += np.rint((turned - step) / math.tau) if abs(turned) < math.inf else 0.0
        row[k] = here + turns * math.tau
        before = here


@routine
def _turned(
    function: Callable, memory: np.ndarray, scratch: "_Scratch", i: int, ends: tuple[int, float, float]
) -> float:
    """Angle by which the direction turns before position k, from one angle to another: `ends` are k and both.

    It is followed in steps that turn it by at most SHARP, halved and doubled as required, unless it jumps.
    """
    k, here, last = ends
    q, stop = scratch.at[0, k - 1], scratch.at[0, k]
    total, least, step = 0.0, LEAST_STEP * max(abs(q), abs(stop)), stop - q
    while q != stop:
        ahead, angle = q + step, last
        if abs(stop - q) <= abs(step):
            ahead = stop
        else:
            scratch.near[0, 0] = ahead
            scratch.near[1, 0], scratch.near[2, 0] = direction_of(ahead)
            function(scratch.p, memory, scratch.near[0], scratch.near[1], scratch.near[2], 0, scratch.found)
            angle = float(scratch.found[i, 0, 0])
        by = angle - here
        by -= math.tau * np.rint(by / math.tau)
        if abs(by) > SHARP and abs(step) > least:
            step *= 0.5
            continue
        total, here, q, step = total + by, angle, ahead, 2.0 * step
    return total


@routine
def _is_finite(row: np.ndarray) -> bool:
    """Whether all numbers of a row are finite."""
    lost = False
    for k in range(row.shape[0]):
        lost |= not abs(row[k]) < math.inf
    return not lost


class _Kept(NamedTuple):
    """Variants whose fields are kept; see `KeptFields.fill`.

    Attributes
    ----------
    table : ndarray (numbers, variants)
    memory : ndarray
        All tables.
    places : ndarray (variants,) of int
    positions : ndarray (3, positions)
        Input positions with cosine and sine.
    ends : tuple of int
    followed : ndarray of int
        Fields that are angles.
    """

    table: np.ndarray
    memory: np.ndarray
    places: np.ndarray
    positions: np.ndarray
    ends: tuple[int, int]
    followed: np.ndarray


class _Scratch(NamedTuple):
    """Scratch arrays for one block of variants.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
        Numbers of the block's variants.
    p : ndarray (numbers,)
        Numbers of one of them.
    at : ndarray (3, positions)
        Input positions of one variant, with cosine and sine.
    near : ndarray (3, 1)
        The same of a position between two of them.
    found : ndarray (fields, 1, 1)
        Fields there.
    """

    block: np.ndarray
    p: np.ndarray
    at: np.ndarray
    near: np.ndarray
    found: np.ndarray


def _new_scratch(numbers: int, positions: np.ndarray, fields: np.ndarray) -> _Scratch:
    found = np.empty((len(fields), 1, 1), fields.dtype)
    return _Scratch(np.empty((numbers, LANES)), np.empty(numbers), positions.copy(), np.empty((3, 1)), found)


@driver
def _fill(
    begin: int,
    end: int,
    function: Callable,
    kept: _Kept,
    fields: np.ndarray,
    finite: np.ndarray,
    scratch: _Scratch,
) -> None:
    """Fill the fields of blocks `begin` … `end` − 1 of LANES variants; see `KeptFields.fill`."""
    block, p, ends = scratch.block, scratch.p, kept.ends
    q, cos_q, sin_q = scratch.at[0], scratch.at[1], scratch.at[2]
    for b in range(begin, end):
        first = b * LANES
        gather(kept.table, first, in_lanes(block))
        for lane in range(min(LANES, finite.size - first)):
            place = kept.places[first + lane]
            for row in range(p.size):
                p[row] = block[row, lane]
            if ends[0] >= 0:
                start, stop = block[ends[0], lane], block[ends[1], lane]
                for k in range(q.shape[0]):
                    here = start + (stop - start) * kept.positions[0, k]
                    q[k] = here
                    cos_q[k], sin_q[k] = direction_of(here)
            function(p, kept.memory, q, cos_q, sin_q, place, fields)
            for i in kept.followed:
                _follow(function, kept.memory, scratch, fields[i, place], i)
            every = True
            for i in range(fields.shape[0]):
                every &= _is_finite(fields[i, place])
            finite[first + lane] = every
