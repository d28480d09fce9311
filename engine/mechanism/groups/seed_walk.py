"""The path of a group along the input, step by proved step, of many variants side by side."""

import math
from collections.abc import Callable
from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.decorators import driver, routine
from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE, LANES, TileFunction
from engine.cycle.panels.lanes import rows
from engine.graph.functions import Functions
from engine.laws.kinematics.seeds import PROVES, turned

# Corrections of a step before it is accepted, and halvings of a step before a path ends.
_CORRECTIONS, _HALVINGS = 3, 24
# Of the quality of transmission at least this share is left after a step.
LEAST_SHARE = 0.2
# What the unknowns at the end of a turn may differ by from those at its beginning [rad, or shares of the group's size].
_CLOSED = 1e-6


class _Room(NamedTuple):
    """Memory for a block of variants.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
    at : ndarray (3, 1, LANES)
        Position with cosine and sine.
    tile : ndarray (curves, 1, LANES)
    level_tile : ndarray (levels, 1, LANES)
    now, ahead : ndarray (unknowns' values, LANES)
    rates : ndarray (2 unknowns, LANES)
    path : ndarray (6, LANES)
        Position, step, halvings of it, where the path ends, the step that is tried (NaN once it failed), quality of
        transmission.
    """

    block: np.ndarray
    at: np.ndarray
    tile: np.ndarray
    level_tile: np.ndarray
    now: np.ndarray
    ahead: np.ndarray
    rates: np.ndarray
    path: np.ndarray


_Q, _STEP, _HALVED, _LOST, _TRIED, _SINE = range(6)


def _new_room(functions: Functions, values: int, unknowns: int, curves: int) -> _Room:
    return _Room(
        rows(len(functions.rows)),
        np.zeros((3, 1, LANES)),
        rows(curves, 1),
        rows(max(len(functions.level_rows), 1), 1),
        rows(values),
        rows(values),
        rows(2 * unknowns),
        rows(6),
    )


@routine
def _load(
    first: int, table: np.ndarray, levels: Callable, level_rows: np.ndarray, memory: np.ndarray, room: _Room
) -> None:
    """Numbers of a block of variants; lanes beyond the last repeat it."""
    for row in range(table.shape[0]):
        for lane in range(LANES):
            room.block[row, lane] = table[row, min(first + lane, table.shape[1] - 1)]
    if level_rows.size > 0:
        levels(room.block, memory, room.at[0], room.at[1], room.at[2], room.level_tile)
        for i in range(level_rows.size):
            for lane in range(LANES):
                room.block[level_rows[i], lane] = room.level_tile[i, 0, lane]


@routine
def _put(values: np.ndarray, given: np.ndarray, block: np.ndarray) -> None:
    """Put the unknowns among the numbers."""
    for i in range(given.size):
        for lane in range(LANES):
            block[given[i], lane] = values[i, lane]


@routine
def _place(at: np.ndarray) -> None:
    """Cosine and sine of the positions."""
    for lane in range(LANES):
        at[1, 0, lane], at[2, 0, lane] = math.cos(at[0, 0, lane]), math.sin(at[0, 0, lane])


@routine
def _move(values: np.ndarray, slides: np.ndarray, tile: np.ndarray) -> None:
    """Add corrections to the unknowns."""
    i = 0
    for k in range(slides.size):
        if slides[k]:
            for lane in range(LANES):
                values[i, lane] += tile[k, 0, lane]
            i += 1
        else:
            for lane in range(LANES):
                values[i, lane], values[i + 1, lane] = turned(values[i, lane], values[i + 1, lane], tile[k, 0, lane])
            i += 2


@routine
def _predict(slides: np.ndarray, room: _Room) -> None:
    """Unknowns a step ahead, by their first and second rate."""
    i, count = 0, slides.size
    for k in range(count):
        for lane in range(LANES):
            step = room.path[_TRIED, lane]
            delta = step * (room.rates[k, lane] + 0.5 * step * room.rates[count + k, lane])
            if slides[k]:
                room.ahead[i, lane] = room.now[i, lane] + delta
            else:
                room.ahead[i, lane], room.ahead[i + 1, lane] = turned(room.now[i, lane], room.now[i + 1, lane], delta)
        i += 1 if slides[k] else 2


@driver
def _walk(
    begin: int,
    end: int,
    fill: Callable,
    levels: Callable,
    level_rows: np.ndarray,
    given: np.ndarray,
    slides: np.ndarray,
    table: np.ndarray,
    memory: np.ndarray,
    start: np.ndarray,
    sines: np.ndarray,
    intervals: int,
    seeds: np.ndarray,
    ends_at: np.ndarray,
    room: _Room,
) -> None:
    """Tables of blocks `begin` … `end` − 1 of LANES variants; see `walk_seeds`."""
    variants, count = table.shape[1], slides.size
    path, now, ahead, rates, tile = room.path, room.now, room.ahead, room.rates, room.tile
    for b in range(begin, end):
        first = b * LANES
        _load(first, table, levels, level_rows, memory, room)
        for lane in range(LANES):
            path[_Q, lane] = room.block[0, lane]
            path[_STEP, lane] = (room.block[1, lane] - room.block[0, lane]) / intervals
            path[_HALVED, lane], path[_LOST, lane] = 0.0, math.nan
            path[_SINE, lane] = sines[min(first + lane, variants - 1)]
            for i in range(now.shape[0]):
                now[i, lane] = start[i, min(first + lane, variants - 1)]
            for i in range(2 * count):
                rates[i, lane] = 0.0
        for seed in range(intervals + 1):
            going = True
            while going:
                for lane in range(LANES):
                    q0, q1 = room.block[0, lane], room.block[1, lane]
                    target = q1 if seed == intervals else q0 + (q1 - q0) * seed / intervals
                    left = target - path[_Q, lane]
                    if abs(left) > abs(path[_STEP, lane]):
                        left = path[_STEP, lane]
                    path[_TRIED, lane] = left if path[_LOST, lane] != path[_LOST, lane] else 0.0
                    room.at[0, 0, lane] = path[_Q, lane] + path[_TRIED, lane]
                _place(room.at)
                _predict(slides, room)
                _put(ahead, given, room.block)
                fill(room.block, memory, room.at[0], room.at[1], room.at[2], tile)
                for lane in range(LANES):
                    if not tile[3 * count, 0, lane] <= PROVES and path[_LOST, lane] != path[_LOST, lane]:
                        # A step that isn't proved: marked by NaN, halved below.
                        path[_TRIED, lane] = math.nan
                for _ in range(_CORRECTIONS - 1):
                    _move(ahead, slides, tile)
                    _put(ahead, given, room.block)
                    fill(room.block, memory, room.at[0], room.at[1], room.at[2], tile)
                _move(ahead, slides, tile)
                for lane in range(LANES):
                    # Two modes that meet have determinants of unlike sign: a step across such a place is none.
                    share = tile[3 * count + 1, 0, lane] / path[_SINE, lane]
                    if not share > LEAST_SHARE:
                        path[_TRIED, lane] = math.nan
                going = False
                for lane in range(LANES):
                    if path[_LOST, lane] == path[_LOST, lane]:
                        continue
                    if path[_TRIED, lane] == path[_TRIED, lane]:
                        path[_Q, lane] = room.at[0, 0, lane]
                        path[_SINE, lane] = tile[3 * count + 1, 0, lane]
                        for i in range(now.shape[0]):
                            now[i, lane] = ahead[i, lane]
                        for i in range(2 * count):
                            rates[i, lane] = tile[count + i, 0, lane]
                        if path[_HALVED, lane] > 0.0:
                            path[_HALVED, lane] -= 1.0
                            path[_STEP, lane] *= 2.0
                        q0, q1 = room.block[0, lane], room.block[1, lane]
                        target = q1 if seed == intervals else q0 + (q1 - q0) * seed / intervals
                        going |= path[_Q, lane] != target
                    else:
                        path[_HALVED, lane] += 1.0
                        path[_STEP, lane] *= 0.5
                        if path[_HALVED, lane] > _HALVINGS:
                            path[_LOST, lane] = path[_Q, lane]
                        else:
                            going = True
            i, j = 0, seed * (now.shape[0] + count)
            for k in range(count):
                for _ in range(1 if slides[k] else 2):
                    for lane in range(min(LANES, variants - first)):
                        lost = path[_LOST, lane] == path[_LOST, lane]
                        seeds[j, first + lane] = math.nan if lost else now[i, lane]
                    i += 1
                    j += 1
                for lane in range(min(LANES, variants - first)):
                    lost = path[_LOST, lane] == path[_LOST, lane]
                    seeds[j, first + lane] = math.nan if lost else rates[k, lane]
                j += 1
        for lane in range(min(LANES, variants - first)):
            ends_at[first + lane] = path[_LOST, lane]


def walk_seeds(
    fill: TileFunction,
    levels: TileFunction,
    functions: Functions,
    given: np.ndarray,
    slides: np.ndarray,
    table: np.ndarray,
    start: np.ndarray,
    sines: np.ndarray,
    intervals: int,
    turns: bool,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Tables of seeds over the range of the input.

    Parameters
    ----------
    fill, levels : TileFunction
        Corrections, rates, second rates, certificate, quality of transmission and size at given values of the unknowns;
        numbers of the cycle.
    functions : Functions
        Of both; the first two rows of numbers are the ends of the input's range.
    given : ndarray of int
        Rows of the unknowns' values.
    slides : ndarray of bool
        Which unknowns are slides.
    table : ndarray (numbers, variants)
    start : ndarray (values, variants)
        Unknowns at the first position.
    sines : ndarray (variants,)
        Quality of transmission there.
    intervals : int
        Of a table.
    turns : bool
        Whether the last position is the first again.

    Returns
    -------
    seeds : ndarray (entries, variants)
        Of each seed and unknown cosine, sine and rate, or slide and rate; NaN beyond the end of a path.
    ends_at : ndarray (variants,)
        Where a path ends, NaN where it doesn't.
    closes : ndarray (variants,) of bool
        Whether a turn ends as it began; true where the input doesn't turn, or where a path ends before.
    """
    values, count, variants = len(given), slides.size, table.shape[1]
    seeds = np.empty(((intervals + 1) * (values + count), variants))
    ends_at = np.full(variants, np.nan)
    arrays = (
        np.array(functions.level_rows, np.int64),
        given,
        slides,
        np.ascontiguousarray(table),
        functions.memory,
        np.ascontiguousarray(start),
        np.ascontiguousarray(sines),
        intervals,
        seeds,
        ends_at,
    )

    def arguments() -> tuple:
        return (fill, levels, *arrays, _new_room(functions, values, count, len(functions.curves)))

    prepare(_walk, [types.intp, types.intp, FILLS_TILE, FILLS_TILE, *(numba.typeof(a) for a in arguments()[2:])])
    spread(_walk, -(-variants // LANES), arguments)
    one, last = seeds[: values + count], seeds[-(values + count) :]
    apart = np.abs(last - one) / np.maximum(1.0, np.abs(one))
    closes = np.ones(variants, bool) if not turns else ~(apart > _CLOSED).any(axis=0)
    return seeds, ends_at, closes


@driver
def _correct(
    begin: int,
    end: int,
    fill: Callable,
    levels: Callable,
    level_rows: np.ndarray,
    given: np.ndarray,
    table: np.ndarray,
    memory: np.ndarray,
    unknowns: np.ndarray,
    q: np.ndarray,
    found: np.ndarray,
    room: _Room,
) -> None:
    """Curves of blocks `begin` … `end` − 1 of LANES variants; see `correct_at`."""
    variants = table.shape[1]
    for b in range(begin, end):
        first = b * LANES
        for lane in range(LANES):
            room.at[0, 0, lane] = q[min(first + lane, variants - 1)]
        _place(room.at)
        _load(first, table, levels, level_rows, memory, room)
        for i in range(given.size):
            for lane in range(LANES):
                room.now[i, lane] = unknowns[i, min(first + lane, variants - 1)]
        _put(room.now, given, room.block)
        fill(room.block, memory, room.at[0], room.at[1], room.at[2], room.tile)
        for i in range(found.shape[0]):
            for lane in range(min(LANES, variants - first)):
                found[i, first + lane] = room.tile[i, 0, lane]


def correct_at(
    fill: TileFunction,
    levels: TileFunction,
    functions: Functions,
    given: np.ndarray,
    table: np.ndarray,
    unknowns: np.ndarray,
    q: np.ndarray,
    curves: int,
) -> np.ndarray:
    """Curves at given values of the unknowns and of the input.

    Parameters
    ----------
    fill, levels, functions, given, table
        As for `walk_seeds`; what is filled may be any curves.
    unknowns : ndarray (values, variants)
    q : ndarray (variants,)
    curves : int
        How many there are.

    Returns
    -------
    ndarray (curves, variants)
    """
    found = np.empty((curves, table.shape[1]))
    arrays = (
        np.array(functions.level_rows, np.int64),
        given,
        np.ascontiguousarray(table),
        functions.memory,
        np.ascontiguousarray(unknowns),
        np.ascontiguousarray(q),
        found,
    )

    def arguments() -> tuple:
        return (fill, levels, *arrays, _new_room(functions, len(given), len(given), curves))

    prepare(_correct, [types.intp, types.intp, FILLS_TILE, FILLS_TILE, *(numba.typeof(a) for a in arguments()[2:])])
    spread(_correct, -(-table.shape[1] // LANES), arguments)
    return found
