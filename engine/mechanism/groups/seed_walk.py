"""The path of a group along the input, step by proved step, of many variants side by side."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.blocks import copy_rows, gather, hand_out, in_lanes
from engine.compiling.decorators import driver, routine
from engine.compiling.printed import load_printed
from engine.compiling.running import prepare, spread
from engine.compiling.tiles import TileFunction
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import rows
from engine.graph.functions import Functions, functions_at
from engine.graph.nodes import Node, value_of
from engine.laws.kinematics.seeds import CLOSE, LEAST_SHARE, PROVES, direction_between, slide_between, turned
from engine.scene.scene import Numbers

# Corrections of a step before it is accepted.
_CORRECTIONS = 3
# What the unknowns at the end of a turn may differ by from those at its beginning [rad, or shares of the group's size].
_CLOSED = 1e-6
# The shortest step before a path ends, as a share of the longest.
_SHORTEST_STEP = 2.0**-24
# What a step's length changes by, and which share of CLOSE the middle of the next one is to have.
_SHORTER, _LONGER, _AIM = 0.1, 2.0, 0.3
# Quintics miss by the sixth power of a step's length.
_PER_ORDER = 1.0 / 6.0
# A path is followed to its end, but for one that takes so many times as many steps as there are seeds.
_BEYOND = 4


class SeedPaths(NamedTuple):
    """Tables of some variants, and how the paths end that they hold.

    Attributes
    ----------
    seeds : ndarray (entries, variants)
        Of each seed its place as a share of the range, infinite where it isn't used; then of each unknown cosine and
        sine, or slide, with first and second rate; NaN beyond the end of a path.
    ends_at : ndarray (variants,)
        Where modes meet and a path ends; NaN where it doesn't.
    short_at : ndarray (variants,)
        Beyond which position there is no room for more seeds; NaN where there is.
    closes : ndarray (variants,) of bool
        Whether a turn ends as it began; true where the input doesn't turn, or where a path ends before.
    """

    seeds: np.ndarray
    ends_at: np.ndarray
    short_at: np.ndarray
    closes: np.ndarray


class _Functions(NamedTuple):
    """Those of a group."""

    fill: Callable
    levels: Callable


class _Variants(NamedTuple):
    """Variants of a group, and how their numbers are laid out.

    Attributes
    ----------
    level_rows, given : ndarray of int
        Rows that receive the levels and the unknowns.
    slides : ndarray of bool
    table : ndarray (numbers, variants)
    memory : ndarray
        Of all tables.
    """

    level_rows: np.ndarray
    given: np.ndarray
    slides: np.ndarray
    table: np.ndarray
    memory: np.ndarray


class _Paths(NamedTuple):
    """What paths begin at, and what is found.

    Attributes
    ----------
    start : ndarray (values, variants)
    sines : ndarray (variants,)
    most : int
        Intervals that a table has room for.
    longest : float
        Longest of them, as a share of the range.
    seeds : ndarray (entries, variants)
    reached : ndarray (2 + values, variants)
        Number of seeds, place and unknowns at the end.
    """

    start: np.ndarray
    sines: np.ndarray
    most: int
    longest: float
    seeds: np.ndarray
    reached: np.ndarray


class _Path(NamedTuple):
    """How far each lane is on its path, a number for each.

    Attributes
    ----------
    place : ndarray (LANES,)
        Of the last seed, as a share of the range.
    step, tried : ndarray (LANES,)
        Length of the next step, and of the one that is tried.
    sine, sine_ahead : ndarray (LANES,)
        Quality of transmission at the last seed, and after the step.
    refused : ndarray (LANES,)
        1 where a step leads to no root that is proved, or across a dead centre.
    found : ndarray (LANES,)
        How many seeds were found.
    going : ndarray (LANES,)
        1 until the path ends.
    """

    place: np.ndarray
    step: np.ndarray
    tried: np.ndarray
    sine: np.ndarray
    sine_ahead: np.ndarray
    refused: np.ndarray
    found: np.ndarray
    going: np.ndarray


class _Room(NamedTuple):
    """Memory for a block of variants.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
    at, half_way : ndarray (3, 1, LANES)
        Position after a step, and in its middle, with cosine and sine.
    tile : ndarray (curves, 1, LANES)
    level_tile : ndarray (levels, 1, LANES)
    now, ahead, middle : ndarray (unknowns' values, LANES)
        At the last seed, after the step, in its middle.
    rates, rates_ahead : ndarray (2 unknowns, LANES)
    path : _Path
    """

    block: np.ndarray
    at: np.ndarray
    half_way: np.ndarray
    tile: np.ndarray
    level_tile: np.ndarray
    now: np.ndarray
    ahead: np.ndarray
    middle: np.ndarray
    rates: np.ndarray
    rates_ahead: np.ndarray
    path: _Path


def _new_room(functions: Functions, values: int, unknowns: int, curves: int) -> _Room:
    return _Room(
        rows(len(functions.rows)),
        np.zeros((3, 1, LANES)),
        np.zeros((3, 1, LANES)),
        rows(curves, 1),
        rows(max(len(functions.level_rows), 1), 1),
        *(rows(values) for _ in range(3)),
        *(rows(2 * unknowns) for _ in range(2)),
        _Path(*(rows(1)[0] for _ in _Path._fields)),
    )


@routine
def _load(first: int, functions: _Functions, variants: _Variants, room: _Room) -> None:
    """Numbers of a block of variants."""
    gather(variants.table, first, in_lanes(room.block))
    if variants.level_rows.size > 0:
        functions.levels(room.block, variants.memory, room.at[0], room.at[1], room.at[2], room.level_tile)
        copy_rows(in_lanes(room.level_tile), variants.level_rows, in_lanes(room.block))


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
            step = (room.block[1, lane] - room.block[0, lane]) * room.path.tried[lane]
            delta = step * (room.rates[k, lane] + 0.5 * step * room.rates[count + k, lane])
            if slides[k]:
                room.ahead[i, lane] = room.now[i, lane] + delta
            else:
                room.ahead[i, lane], room.ahead[i + 1, lane] = turned(room.now[i, lane], room.now[i + 1, lane], delta)
        i += 1 if slides[k] else 2


@routine
def _interpolate(slides: np.ndarray, room: _Room) -> None:
    """Unknowns in the middle of the step, as they will be found between two seeds."""
    i, count, now, ahead = 0, slides.size, room.now, room.ahead
    for k in range(count):
        for lane in range(LANES):
            step = (room.block[1, lane] - room.block[0, lane]) * room.path.tried[lane]
            v, v_ahead = room.rates[k, lane], room.rates_ahead[k, lane]
            a, a_ahead = room.rates[count + k, lane], room.rates_ahead[count + k, lane]
            if slides[k]:
                room.middle[i, lane] = slide_between(now[i, lane], v, a, ahead[i, lane], v_ahead, a_ahead, 0.5, step)
            else:
                one, two = (
                    (now[i, lane], now[i + 1, lane], v, a),
                    (ahead[i, lane], ahead[i + 1, lane], v_ahead, a_ahead),
                )
                room.middle[i, lane], room.middle[i + 1, lane] = direction_between(one, two, 0.5, step)
        i += 1 if slides[k] else 2


@routine
def _set_out(first: int, paths: _Paths, room: _Room) -> None:
    """Begin the paths of a block; their first step, of no length, finds the rates."""
    path, last = room.path, paths.sines.size - 1
    for lane in range(LANES):
        path.place[lane] = path.step[lane] = path.found[lane] = 0.0
        path.going[lane] = 1.0
        path.sine[lane] = paths.sines[min(first + lane, last)]
        for i in range(room.now.shape[0]):
            room.now[i, lane] = paths.start[i, min(first + lane, last)]
        for i in range(room.rates.shape[0]):
            room.rates[i, lane] = 0.0


@routine
def _judge(longest: float, room: _Room) -> None:
    """Accept each lane's step or not, by how close the quintic is in its middle, and choose the next one's length."""
    path, count = room.path, room.rates.shape[0] // 2
    for lane in range(LANES):
        # Two modes that meet have determinants of unlike sign: a step across such a place is none.
        kept = path.sine_ahead[lane] / path.sine[lane] > LEAST_SHARE
        excess = room.tile[3 * count, 0, lane] / CLOSE
        refused = path.refused[lane] > 0.0 or not kept or not excess < math.inf
        factor = _SHORTER if refused else (_AIM / max(excess, 1e-12)) ** _PER_ORDER
        accepted = path.going[lane] > 0.0 and not refused and excess <= 1.0
        tried = path.tried[lane]
        path.refused[lane] = 0.0 if accepted else 1.0
        if path.going[lane] == 0.0:
            continue
        if not accepted:
            path.step[lane] = tried * min(max(factor, _SHORTER), 0.5)
            path.going[lane] = 1.0 if path.step[lane] > _SHORTEST_STEP * longest else 0.0
            continue
        # A short step before the end says little of how long another may be.
        wanted = max(tried * min(factor, _LONGER), path.step[lane] if factor >= 1.0 else 0.0)
        path.step[lane] = min(wanted, longest) if tried > 0.0 else longest
        path.place[lane] = path.place[lane] + tried if room.at[0, 0, lane] != room.block[1, lane] else 1.0


@routine
def _keep(first: int, slides: np.ndarray, paths: _Paths, room: _Room) -> bool:
    """Keep the seeds that were found, as far as there is room; whether any lane is still on its path."""
    path, values, count, going = room.path, room.now.shape[0], slides.size, False
    most, seeds = paths.most, paths.seeds
    width = 1 + values + 2 * count
    for lane in range(LANES):
        if path.refused[lane] > 0.0:
            going = going or path.going[lane] > 0.0
            continue
        for i in range(values):
            room.now[i, lane] = room.ahead[i, lane]
        for i in range(2 * count):
            room.rates[i, lane] = room.rates_ahead[i, lane]
        path.sine[lane] = path.sine_ahead[lane]
        found = int(path.found[lane])
        path.found[lane] += 1.0
        ends = path.place[lane] == 1.0
        if ends or found >= _BEYOND * most:
            path.going[lane] = 0.0
        going = going or path.going[lane] > 0.0
        if found > most or first + lane >= seeds.shape[1]:
            continue
        seed, v = seeds[found * width : (found + 1) * width], first + lane
        seed[0, v] = path.place[lane]
        i, j = 0, 1
        for k in range(count):
            for _ in range(1 if slides[k] else 2):
                seed[j, v] = room.now[i, lane]
                i += 1
                j += 1
            seed[j, v], seed[j + 1, v] = room.rates[k, lane], room.rates[count + k, lane]
            j += 2
    return going


@driver
def _walk(begin: int, end: int, functions: _Functions, variants: _Variants, paths: _Paths, room: _Room) -> None:
    """Tables of blocks `begin` … `end` − 1 of LANES variants; see `SeedWalk`."""
    fill = functions.fill
    memory, given, slides, count = variants.memory, variants.given, variants.slides, variants.slides.size
    block, at, half_way, path, tile = room.block, room.at, room.half_way, room.path, room.tile
    for b in range(begin, end):
        first = b * LANES
        _load(first, functions, variants, room)
        _set_out(first, paths, room)
        going = True
        while going:
            for lane in range(LANES):
                left = 1.0 - path.place[lane]
                tried = min(path.step[lane], left) if path.going[lane] > 0.0 else 0.0
                path.tried[lane] = tried
                place = block[0, lane] + (block[1, lane] - block[0, lane]) * (path.place[lane] + tried)
                at[0, 0, lane] = block[1, lane] if tried == left else place
            _place(at)
            _predict(slides, room)
            _put(room.ahead, given, block)
            fill(block, memory, at[0], at[1], at[2], tile)
            for lane in range(LANES):
                path.refused[lane] = 0.0 if tile[3 * count, 0, lane] <= PROVES else 1.0
            for _ in range(_CORRECTIONS - 1):
                _move(room.ahead, slides, tile)
                _put(room.ahead, given, block)
                fill(block, memory, at[0], at[1], at[2], tile)
            _move(room.ahead, slides, tile)
            for lane in range(LANES):
                path.sine_ahead[lane] = tile[3 * count + 1, 0, lane]
                for i in range(2 * count):
                    room.rates_ahead[i, lane] = tile[count + i, 0, lane]
            _interpolate(slides, room)
            _put(room.middle, given, block)
            for lane in range(LANES):
                place = path.place[lane] + 0.5 * path.tried[lane]
                half_way[0, 0, lane] = block[0, lane] + (block[1, lane] - block[0, lane]) * place
            _place(half_way)
            fill(block, memory, half_way[0], half_way[1], half_way[2], tile)
            _judge(paths.longest, room)
            going = _keep(first, slides, paths, room)
        reached = paths.reached
        for lane in range(min(LANES, reached.shape[1] - first)):
            reached[0, first + lane], reached[1, first + lane] = path.found[lane], path.place[lane]
        hand_out(in_lanes(room.now), first, reached[2:])


class SeedWalk:
    """The path of one group.

    Parameters
    ----------
    title : str
        Of its printed functions.
    given : sequence of tuple of Node
        Of each unknown the given numbers that hold its value.
    curves : sequence of Node
        Corrections, rates, second rates, certificate, quality of transmission and size at given values of the unknowns.
    span : tuple of Node
        First and last position of the input.
    """

    def __init__(
        self, title: str, given: Sequence[tuple[Node, ...]], curves: Sequence[Node], span: tuple[Node, Node]
    ) -> None:
        numbers = [node for nodes in given for node in nodes]
        self._functions = functions_at(curves[0].graph, title, *span, curves, numbers=numbers)
        module = load_printed(self._functions.text)
        self._fill, self._levels = TileFunction(module.curves_at), TileFunction(module.levels)
        self._given = np.array([self._functions.rows[node] for node in numbers], np.int64)
        self._slides = np.array([len(nodes) == 1 for nodes in given])

    def _table(self, numbers: Numbers, variants: int) -> np.ndarray:
        """P of all variants."""
        table = np.full((len(self._functions.rows), variants), np.nan)
        with np.errstate(all="ignore"):
            for node in self._functions.numbers:
                table[self._functions.rows[node]] = value_of(node, numbers)
        return table

    def __call__(
        self, numbers: Numbers, start: np.ndarray, sines: np.ndarray, intervals: int, longest: float, turns: bool
    ) -> SeedPaths:
        """Tables of seeds over the range of the input, as near to each other as quintics between them need.

        Parameters
        ----------
        numbers : Numbers
        start : ndarray (values, variants)
            Unknowns at the first position.
        sines : ndarray (variants,)
            Quality of transmission there.
        intervals : int
            That a table has room for.
        longest : float
            Longest of them, as a share of the range.
        turns : bool
            Whether the last position is the first again.
        """
        functions, given, slides = self._functions, self._given, self._slides
        table = self._table(numbers, start.shape[1])
        values, count, variants = len(given), slides.size, table.shape[1]
        seeds = np.full((intervals + 1, 1 + values + 2 * count, variants), np.nan)
        seeds[:, 0] = np.inf
        reached = np.empty((2 + values, variants))
        level_rows = np.array(functions.level_rows, np.int64)
        every_variant = _Variants(level_rows, given, slides, np.ascontiguousarray(table), functions.memory)
        begins = np.ascontiguousarray(start), np.ascontiguousarray(sines)
        paths = _Paths(*begins, intervals, longest, seeds.reshape(-1, variants), reached)

        def arguments() -> tuple:
            room = _new_room(functions, values, count, len(functions.curves))
            return _Functions(self._fill, self._levels), every_variant, paths, room

        prepare(_walk, [types.intp, types.intp, *(numba.typeof(argument) for argument in arguments())])
        spread(_walk, -(-variants // LANES), arguments)
        found, place, end = reached[0].astype(np.int64), reached[1], reached[2:]
        whole, short, every = place == 1.0, found > intervals + 1, np.arange(variants)
        last = np.clip(found - 1, 0, intervals)
        closes = (np.abs(end - start) <= _CLOSED * np.maximum(1.0, np.abs(start))).all(axis=0)
        # Beyond the end of a path nothing is known.
        ended = np.flatnonzero(~whole | short)
        final = np.minimum(last[ended], intervals - 1)
        seeds[final + 1, :, ended], seeds[final + 1, 0, ended] = np.nan, np.inf
        begin, length = table[0], table[1] - table[0]
        followed = whole | (found <= _BEYOND * intervals)
        room_ends_at = begin + length * seeds[np.minimum(last, intervals - 1), 0, every]
        return SeedPaths(
            seeds.reshape(-1, variants),
            np.where(followed & ~whole, begin + length * place, np.nan),
            np.where(short, room_ends_at, np.nan),
            closes | ~whole | (not turns),
        )
