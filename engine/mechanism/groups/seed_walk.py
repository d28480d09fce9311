"""The path of a group along the input in proved steps, for many variants in parallel."""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, copy_rows, gather, in_lanes, scatter_rows
from engine.compiling.decorators import driver, routine
from engine.compiling.printed_functions import PrintedFunction
from engine.compiling.running import spread
from engine.cycle.panels.lanes import rows
from engine.graph.functions import Functions, functions_at
from engine.graph.nodes import Node
from engine.graph.values import LevelValues
from engine.laws.kinematics.seeds import CLOSE, LEAST_SHARE, PROVES, between_seeds, same_unknowns
from engine.scene.scene import Numbers

# Corrections of a step before its acceptance.
_CORRECTIONS = 3
# The shortest step before a path ends, relative to the longest.
_SHORTEST_STEP = 2.0**-24
# Limits of the change of the step length, and the share of CLOSE aimed at in the middle of the next step.
_SHORTER, _LONGER, _AIM = 0.1, 2.0, 0.3
# The error of a quintic is proportional to the sixth power of the step length.
_STEP_EXPONENT = 1.0 / 6.0
# A path is abandoned when it has this many times as many seeds as its table has intervals.
_ABANDONED = 4


class SeedPaths(NamedTuple):
    """Seed tables of some variants, and how their paths end.

    Attributes
    ----------
    seeds : ndarray (entries, variants)
        Per seed: its position as a share of the range, infinite if unused; the unknowns, their first and second rates;
        NaN beyond the end of a path.
    ends_at : ndarray (variants,)
        Position at which modes meet and a path ends; NaN if it does not.
    short_at : ndarray (variants,)
        Position beyond which the table is full; NaN if it is not.
    closes : ndarray (variants,) of bool
        Whether a turn ends as it began; also true if the input does not turn, or if the path ends earlier.
    """

    seeds: np.ndarray
    ends_at: np.ndarray
    short_at: np.ndarray
    closes: np.ndarray


class _Group(NamedTuple):
    """Functions of a group, its variants, and the layout of their numbers.

    Attributes
    ----------
    fill : callable
    given : ndarray of int
        Rows for the unknowns.
    table : ndarray (numbers, variants)
    memory : ndarray
        All tables.
    """

    fill: Callable
    given: np.ndarray
    table: np.ndarray
    memory: np.ndarray


class _Paths(NamedTuple):
    """Initial values of paths, and results.

    Attributes
    ----------
    start : ndarray (unknowns, variants)
    sines : ndarray (variants,)
    most : int
        Capacity of a table in intervals.
    longest : float
        Longest interval as a share of the range.
    seeds : ndarray (entries, variants)
    reached : ndarray (2 + unknowns, variants)
        Number of seeds, position and unknowns at the end.
    """

    start: np.ndarray
    sines: np.ndarray
    most: int
    longest: float
    seeds: np.ndarray
    reached: np.ndarray


class _Path(NamedTuple):
    """Progress of each lane on its path.

    Attributes
    ----------
    place : ndarray (LANES,)
        Position of the last seed, as a share of the range.
    step, tried : ndarray (LANES,)
        Length of the next step, and of the current trial step.
    sine, sine_ahead : ndarray (LANES,)
        Transmission index at the last seed, and after the step.
    refused : ndarray (LANES,)
        1 if a step leads to no proved root, or across a dead centre.
    found : ndarray (LANES,)
        Number of seeds found.
    active : ndarray (LANES,)
        1 until the path ends.
    """

    place: np.ndarray
    step: np.ndarray
    tried: np.ndarray
    sine: np.ndarray
    sine_ahead: np.ndarray
    refused: np.ndarray
    found: np.ndarray
    active: np.ndarray


class _Scratch(NamedTuple):
    """Scratch arrays for a block of variants.

    Attributes
    ----------
    block : ndarray (numbers, LANES)
    at, half_way : ndarray (3, 1, LANES)
        Position after a step, and in its middle, with cosine and sine.
    tile : ndarray (curves, 1, LANES)
    now, ahead : ndarray (3 unknowns, LANES)
        At the last seed, and after the step: the unknowns, their first rates, their second rates.
    middle : ndarray (unknowns, LANES)
        The unknowns in the middle of the step.
    path : _Path
    """

    block: np.ndarray
    at: np.ndarray
    half_way: np.ndarray
    tile: np.ndarray
    now: np.ndarray
    ahead: np.ndarray
    middle: np.ndarray
    path: _Path


def _new_scratch(functions: Functions, unknowns: int) -> _Scratch:
    return _Scratch(
        rows(len(functions.rows)),
        np.zeros((3, 1, LANES)),
        np.zeros((3, 1, LANES)),
        rows(len(functions.curves), 1),
        rows(3 * unknowns),
        rows(3 * unknowns),
        rows(unknowns),
        _Path(*(rows(1)[0] for _ in _Path._fields)),
    )


@routine
def _place(at: np.ndarray) -> None:
    """Compute cosine and sine of the positions."""
    for lane in range(LANES):
        at[1, 0, lane], at[2, 0, lane] = math.cos(at[0, 0, lane]), math.sin(at[0, 0, lane])


@routine
def _move(ahead: np.ndarray, tile: np.ndarray) -> None:
    """Add corrections to the unknowns."""
    for k in range(ahead.shape[0] // 3):
        for lane in range(LANES):
            ahead[k, lane] += tile[k, 0, lane]


@routine
def _predict(scratch: _Scratch) -> None:
    """Extrapolate the unknowns over a step, from their first and second rate."""
    now, count = scratch.now, scratch.middle.shape[0]
    for k in range(count):
        for lane in range(LANES):
            step = (scratch.block[1, lane] - scratch.block[0, lane]) * scratch.path.tried[lane]
            change = step * (now[count + k, lane] + 0.5 * step * now[2 * count + k, lane])
            scratch.ahead[k, lane] = now[k, lane] + change


@routine
def _interpolate(scratch: _Scratch) -> None:
    """Interpolate the unknowns at the middle of the step, as they will be between two seeds."""
    now, ahead, count = scratch.now, scratch.ahead, scratch.middle.shape[0]
    for k in range(count):
        for lane in range(LANES):
            step = (scratch.block[1, lane] - scratch.block[0, lane]) * scratch.path.tried[lane]
            one = now[k, lane], now[count + k, lane], now[2 * count + k, lane]
            two = ahead[k, lane], ahead[count + k, lane], ahead[2 * count + k, lane]
            scratch.middle[k, lane] = between_seeds(one, two, 0.5, step)


@routine
def _start_paths(first: int, paths: _Paths, scratch: _Scratch) -> None:
    """Initialise the paths of a block; the first step, of zero length, finds the rates."""
    path, last = scratch.path, paths.sines.size - 1
    for lane in range(LANES):
        path.place[lane] = path.step[lane] = path.found[lane] = 0.0
        path.active[lane] = 1.0
        path.sine[lane] = paths.sines[min(first + lane, last)]
        count = paths.start.shape[0]
        for i in range(count):
            scratch.now[i, lane] = paths.start[i, min(first + lane, last)]
            scratch.now[count + i, lane] = scratch.now[2 * count + i, lane] = 0.0


@routine
def _judge(longest: float, scratch: _Scratch) -> None:
    """Accept or reject each lane's step by the quintic's error at its middle, and choose the next step length."""
    path, count = scratch.path, scratch.middle.shape[0]
    for lane in range(LANES):
        # The determinant changes sign where two modes meet: reject a step across such a position.
        kept = path.sine_ahead[lane] / path.sine[lane] > LEAST_SHARE
        excess = scratch.tile[3 * count, 0, lane] / CLOSE
        refused = path.refused[lane] > 0.0 or not kept or not excess < math.inf
        factor = _SHORTER if refused else (_AIM / max(excess, 1e-12)) ** _STEP_EXPONENT
        accepted = path.active[lane] > 0.0 and not refused and excess <= 1.0
        tried = path.tried[lane]
        path.refused[lane] = 0.0 if accepted else 1.0
        if path.active[lane] == 0.0:
            continue
        if not accepted:
            path.step[lane] = tried * min(max(factor, _SHORTER), 0.5)
            path.active[lane] = 1.0 if path.step[lane] > _SHORTEST_STEP * longest else 0.0
            continue
        # A step shortened by the end of the range says little about the length of the next.
        wanted = max(tried * min(factor, _LONGER), path.step[lane] if factor >= 1.0 else 0.0)
        path.step[lane] = min(wanted, longest) if tried > 0.0 else longest
        path.place[lane] = path.place[lane] + tried if scratch.at[0, 0, lane] != scratch.block[1, lane] else 1.0


@routine
def _store(first: int, paths: _Paths, scratch: _Scratch) -> bool:
    """Store the seeds found, up to the capacity; return whether any lane is still on its path."""
    path, most, seeds, active = scratch.path, paths.most, paths.seeds, False
    width = 1 + scratch.now.shape[0]
    for lane in range(LANES):
        if path.refused[lane] > 0.0:
            active = active or path.active[lane] > 0.0
            continue
        for i in range(width - 1):
            scratch.now[i, lane] = scratch.ahead[i, lane]
        path.sine[lane] = path.sine_ahead[lane]
        found = int(path.found[lane])
        path.found[lane] += 1.0
        ends = path.place[lane] == 1.0
        if ends or found >= _ABANDONED * most:
            path.active[lane] = 0.0
        active = active or path.active[lane] > 0.0
        if found > most or first + lane >= seeds.shape[1]:
            continue
        seed, v = seeds[found * width : (found + 1) * width], first + lane
        seed[0, v] = path.place[lane]
        for i in range(width - 1):
            seed[1 + i, v] = scratch.now[i, lane]
    return active


@driver
def _walk(begin: int, end: int, group: _Group, paths: _Paths, scratch: _Scratch) -> None:
    """Fill the tables of blocks `begin` … `end` − 1 of LANES variants; see `SeedWalk`."""
    # Taken out of the tuple, because Numba warns about functions in tuples.
    fill = group.fill
    memory, given, count = group.memory, group.given, group.given.size
    block, at, half_way, path, tile = scratch.block, scratch.at, scratch.half_way, scratch.path, scratch.tile
    ahead = scratch.ahead
    for b in range(begin, end):
        first = b * LANES
        gather(group.table, first, in_lanes(block))
        _start_paths(first, paths, scratch)
        active = True
        while active:
            for lane in range(LANES):
                left = 1.0 - path.place[lane]
                tried = min(path.step[lane], left) if path.active[lane] > 0.0 else 0.0
                path.tried[lane] = tried
                place = block[0, lane] + (block[1, lane] - block[0, lane]) * (path.place[lane] + tried)
                at[0, 0, lane] = block[1, lane] if tried == left else place
            _place(at)
            _predict(scratch)
            copy_rows(in_lanes(ahead), given, in_lanes(block))
            fill(block, memory, at[0], at[1], at[2], tile)
            for lane in range(LANES):
                path.refused[lane] = 0.0 if tile[3 * count, 0, lane] <= PROVES else 1.0
            for _ in range(_CORRECTIONS - 1):
                _move(ahead, tile)
                copy_rows(in_lanes(ahead), given, in_lanes(block))
                fill(block, memory, at[0], at[1], at[2], tile)
            _move(ahead, tile)
            for lane in range(LANES):
                path.sine_ahead[lane] = tile[3 * count + 1, 0, lane]
                for i in range(count, 3 * count):
                    ahead[i, lane] = tile[i, 0, lane]
            _interpolate(scratch)
            copy_rows(in_lanes(scratch.middle), given, in_lanes(block))
            for lane in range(LANES):
                place = path.place[lane] + 0.5 * path.tried[lane]
                half_way[0, 0, lane] = block[0, lane] + (block[1, lane] - block[0, lane]) * place
            _place(half_way)
            fill(block, memory, half_way[0], half_way[1], half_way[2], tile)
            _judge(paths.longest, scratch)
            active = _store(first, paths, scratch)
        reached = paths.reached
        for lane in range(min(LANES, reached.shape[1] - first)):
            reached[0, first + lane], reached[1, first + lane] = path.found[lane], path.place[lane]
        scatter_rows(in_lanes(scratch.now), first, reached[2:])


class SeedWalk:
    """The path of one group.

    Parameters
    ----------
    given : sequence of Node
        Given numbers for the values of the unknowns.
    curves : sequence of Node
        Corrections, rates, second rates, certificate, transmission index and size at given values of the unknowns.
    span : tuple of Node
        First and last position of the input.
    slides : ndarray of bool
        Which unknowns are slides.
    """

    def __init__(
        self, given: Sequence[Node], curves: Sequence[Node], span: tuple[Node, Node], slides: np.ndarray
    ) -> None:
        self._functions = functions_at(curves[0].graph, *span, curves, numbers=given)
        self._fill, self._levels = PrintedFunction(self._functions.codes["curves_at"]), LevelValues(self._functions)
        self._given = np.array([self._functions.rows[node] for node in given], np.int64)
        self._slides = slides

    def __call__(
        self, numbers: Numbers, start: np.ndarray, sines: np.ndarray, intervals: int, longest: float, turns: bool
    ) -> SeedPaths:
        """Seed tables over the range of the input, as dense as quintics between the seeds require.

        Parameters
        ----------
        numbers : Numbers
        start : ndarray (unknowns, variants)
            Unknowns at the first position.
        sines : ndarray (variants,)
            Transmission index there.
        intervals : int
            Capacity of a table.
        longest : float
            Longest interval as a share of the range.
        turns : bool
            Whether the last position coincides with the first.
        """
        functions, given = self._functions, self._given
        table = self._levels.table(numbers, start.shape[1])
        count, variants = given.size, table.shape[1]
        seeds = np.full((intervals + 1, 1 + 3 * count, variants), np.nan)
        seeds[:, 0] = np.inf
        reached = np.empty((2 + count, variants))
        group = _Group(self._fill, given, np.ascontiguousarray(table), functions.memory)
        begins = np.ascontiguousarray(start), np.ascontiguousarray(sines)
        paths = _Paths(*begins, intervals, longest, seeds.reshape(-1, variants), reached)

        def arguments() -> tuple:
            return group, paths, _new_scratch(functions, count)

        spread(_walk, -(-variants // LANES), arguments)
        found, place, end = reached[0].astype(np.int64), reached[1], reached[2:]
        whole, short, every = place == 1.0, found > intervals + 1, np.arange(variants)
        last = np.clip(found - 1, 0, intervals)
        closes = same_unknowns(start, end, self._slides)
        # Beyond the end of a path the seeds are unknown.
        ended = np.flatnonzero(~whole | short)
        final = np.minimum(last[ended], intervals - 1)
        seeds[final + 1, :, ended], seeds[final + 1, 0, ended] = np.nan, np.inf
        begin, length = table[0], table[1] - table[0]
        followed = whole | (found <= _ABANDONED * intervals)
        full_at = begin + length * seeds[np.minimum(last, intervals - 1), 0, every]
        return SeedPaths(
            seeds.reshape(-1, variants),
            np.where(followed & ~whole, begin + length * place, np.nan),
            np.where(short, full_at, np.nan),
            closes | ~whole | (not turns),
        )
