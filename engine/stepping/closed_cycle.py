"""The cycle that comes back to its own energy, in lanes: Newton's method on the return map.

The return map takes the kinetic energy E at the begin of a cycle to the energy P(E) at its end. Its derivative comes
along with it, ln(dP/dE) = ∮ ∂M/∂E dφ. Motions never cross, so P grows with E: a machine that stalls from some energy
stalls from every lower one, and one that is faster after a cycle than before settles at a higher energy. The search
begins at an energy at which loads should win and keeps to what is known to lie below and above. Steps are laid for the
first cycle, and then repeated as long as they miss little enough.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, hand_out, in_lanes
from engine.compiling.decorators import driver, routine
from engine.compiling.memory import memory
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import one, rows
from engine.stepping.walk import (
    FULL,
    GOAL,
    GOING,
    STEEP,
    Printed,
    Room,
    WalkBatch,
    WalkTask,
    find_edge,
    give_out,
    lay_steps,
    repeat_steps,
    rows_of,
    take_in,
)
from engine.words.verdicts import Verdict

OK, STALLS, RUNS_AWAY, ANY_SPEED, NOT_FINITE = (
    float(v) for v in (Verdict.OK, Verdict.STALLS, Verdict.RUNS_AWAY, Verdict.ANY_SPEED, Verdict.NOT_FINITE)
)
# A lane whose energy is still searched; one whose motor is too steep for these steps.
SEARCHING, TOO_STEEP = -1.0, -2.0
# Cycles at most. An energy is found where the next one differs by a smaller share of itself, or of what steps miss; or
# by NEARLY_CLOSED of itself where rounding lets it come no nearer.
MOST_CYCLES, CLOSED, UNTOLD, NEARLY_CLOSED = 60, 1e-12, 0.01, 1e-8
# Repeated steps that miss so many times what is allowed are laid anew before their cycle counts.
ALLOWED = 10.0
# Energies are raised by so much, and fall to no less than so much of themselves or of the way to one that is too low.
RAISED, LEFT = 8.0, 0.25
# Where moments do less work than this share of their magnitude, and disturbances fade by no more, it is rounding.
NO_WORK = 1e-9
# A stretch so short between an energy that falls and one that stalls holds no motion that repeats itself.
NARROW = 1e-3


class CycleSearch(NamedTuple):
    """Rows of the search, a number for each lane.

    Attributes
    ----------
    energy : row
        At the begin of the cycle that is gone through.
    low, high : row
        Greatest energy that is known to rise or to stall, least one that is known to fall [J].
    stalls : row
        1 where the lower one stalls.
    rising : row
        1 where the last whole cycle rose.
    off, cycles : row
        |P(E) − E|/E of the last cycle, and how many there were.
    moved : row
        1 where any step was ever made.
    verdict : row
    laying : row
        1 where the steps of the next cycle are laid.
    """

    energy: Row
    low: Row
    high: Row
    stalls: Row
    rising: Row
    off: Row
    cycles: Row
    moved: Row
    verdict: Row
    laying: Row


search_of = memory(one(CycleSearch))
TOLD = ("off", "verdict")


class CycleRoom(NamedTuple):
    """Memory for a block."""

    walk: Room
    search: np.ndarray


class CycleBatch(NamedTuple):
    """What the search is given, and what comes of it.

    Attributes
    ----------
    walks : WalkBatch
        From the energies that are tried first; they are carried to the ends of the cycles found.
    energies : ndarray (variants,)
        At the begins of the cycles found.
    told : ndarray (TOLD, variants)
    fading : int
        Row of the states in which ∮ ∂M/∂E dφ is gathered.
    """

    walks: WalkBatch
    energies: np.ndarray
    told: np.ndarray
    fading: int


def new_cycle_room(room: Room) -> CycleRoom:
    """Memory for a block."""
    return CycleRoom(room, rows(len(CycleSearch._fields)))


@routine
def begin_cycle(lane: int, energy: float, edges: int, task: WalkTask, room: CycleRoom) -> None:
    """Stand at the begin of a cycle."""
    own, search, begin, doubts = (
        rows_of(room.walk.lane),
        search_of(room.search),
        in_lanes(room.walk.begin),
        in_lanes(room.walk.doubts),
    )
    for q in range(task.width):
        begin[q, lane], doubts[q, lane] = 0.0, 0.0
    begin[0, lane], search.energy[lane] = energy, energy
    own.at[lane], own.turned[lane], own.steps[lane], own.trials[lane] = 0.0, 0.0, 0.0, 0.0
    own.scale[lane] = 0.0 if search.laying[lane] > 0.0 else own.scale[lane]
    own.why[lane] = GOING
    find_edge(lane, edges, task, room.walk)


@routine
def judge_cycle(lane: int, fading: int, edges: int, task: WalkTask, room: CycleRoom) -> None:
    """See what the cycle says of the energy it began with, and begin the next one; or find that the search is over."""
    own, search, end = rows_of(room.walk.lane), search_of(room.search), in_lanes(room.walk.begin)
    laid, before, after = search.laying[lane] > 0.0, search.energy[lane], end[0, lane]
    search.moved[lane] = 1.0 if own.steps[lane] > 0.0 else search.moved[lane]
    if laid and (own.why[lane] == STEEP or own.why[lane] == FULL):
        search.verdict[lane] = TOO_STEEP
        return
    whole = own.why[lane] == GOAL if laid else own.able[lane] > 0.0
    if not laid and not whole:
        search.laying[lane] = 1.0
        begin_cycle(lane, before, edges, task, room)
        return
    search.cycles[lane] += 1.0
    newton, multiplier = math.nan, math.nan
    if whole:
        multiplier = math.exp(min(end[fading, lane], 700.0))
        off, last = abs(after - before) / before, search.off[lane]
        newton = before + (after - before) / (1.0 - multiplier) if multiplier != 1.0 else math.nan
        unsure = in_lanes(room.walk.doubts)[0, lane] / abs(1.0 - multiplier)
        settled = abs(newton - before) <= max(CLOSED * before, UNTOLD * unsure)
        settled = settled or (abs(newton - before) <= NEARLY_CLOSED * before and off >= 0.5 * last)
        search.off[lane] = off
        # Where the work is too small to show in the energy, it goes on as before.
        search.rising[lane] = search.rising[lane] if after == before else 1.0 if after > before else 0.0
        first = search.low[lane] == 0.0 and not search.high[lane] < math.inf
        if first and abs(after - before) <= NO_WORK * own.scale[lane] and abs(multiplier - 1.0) <= NO_WORK:
            search.verdict[lane] = ANY_SPEED
            return
        if settled and (laid or own.worst[lane] <= ALLOWED):
            search.verdict[lane] = OK
            return
        if settled:
            search.laying[lane], search.off[lane] = 1.0, math.inf
            begin_cycle(lane, newton, edges, task, room)
            return
        if after > before and before > search.low[lane]:
            search.low[lane], search.stalls[lane] = before, 0.0
        elif after < before:
            search.high[lane] = min(search.high[lane], before)
    elif before > search.low[lane]:
        search.low[lane], search.stalls[lane] = before, 1.0
    low, high = search.low[lane], search.high[lane]
    none = search.stalls[lane] > 0.0 and high - low <= NARROW * high and not newton > low
    if search.cycles[lane] >= MOST_CYCLES or none or low >= high:
        away = search.rising[lane] > 0.0 and not high < math.inf
        search.verdict[lane] = RUNS_AWAY if away else STALLS if search.moved[lane] > 0.0 else NOT_FINITE
        return
    search.laying[lane] = 1.0 if not whole or own.kept[lane] <= 0.0 else 0.0
    begin_cycle(lane, next_energy(whole, newton, multiplier, before, after, low, high), edges, task, room)


@routine
def next_energy(
    whole: bool, newton: float, multiplier: float, before: float, after: float, low: float, high: float
) -> float:
    """Energy to try next between one that is too low and one that is too high."""
    sound = whole and multiplier < 1.0 - NO_WORK
    if not high < math.inf:
        return newton if sound and before < newton < RAISED * before else RAISED * before
    if not whole:
        return 0.5 * (low + high)
    if after > before:
        return newton if sound and newton < high else 0.5 * (low + high)
    least = low + LEFT * (before - low)
    lower = newton if sound else after
    return lower if least < lower < before else least


@driver
def find_cycles(
    begin: int,
    end: int,
    places: Callable,
    rates: Callable,
    watch: Callable,
    batch: CycleBatch,
    task: WalkTask,
    room: CycleRoom,
) -> None:
    """Find the cycles of the blocks begin … end − 1 of variants that come back to their own energies.

    Parameters
    ----------
    begin, end : int
    places, rates, watch : callable
        Printed functions.
    batch : CycleBatch
    task : WalkTask
        Along the angle, with an end after a cycle.
    room : CycleRoom
    """
    walks, search = batch.walks, search_of(room.search)
    own, printed = rows_of(room.walk.lane), Printed(places, rates, watch, walks.memory)
    edges, slots = walks.edges.shape[0] // 2, room.walk.lengths.shape[0]
    for b in range(begin, end):
        first = b * LANES
        take_in(first, walks, task, room.walk)
        for lane in range(LANES):
            search.low[lane], search.high[lane], search.off[lane] = 0.0, math.inf, math.inf
            search.stalls[lane], search.rising[lane], search.moved[lane] = 0.0, 0.0, 0.0
            search.cycles[lane], search.laying[lane] = 0.0, 1.0
            search.verdict[lane] = SEARCHING if own.why[lane] == GOING else OK
            begin_cycle(lane, in_lanes(room.walk.begin)[0, lane], edges, task, room)
        while True:
            going, most = False, 0
            for lane in range(LANES):
                goes = search.verdict[lane] == SEARCHING
                lays = goes and search.laying[lane] > 0.0
                going = going or goes
                own.halt[lane] = math.inf if lays else -math.inf
                own.able[lane] = 1.0 if goes and not lays else 0.0
                own.kept[lane] = (0.0 if slots > 1 else -1.0) if lays else own.kept[lane]
                own.pace[lane] = own.farthest[lane] if lays else own.pace[lane]
                most = max(most, int(own.kept[lane]) if own.able[lane] > 0.0 else 0)
            if not going:
                break
            lay_steps(first, printed, walks, task, room.walk)
            if most > 0:
                repeat_steps(most, printed, task, room.walk)
            for lane in range(LANES):
                if search.verdict[lane] == SEARCHING:
                    judge_cycle(lane, batch.fading, edges, task, room)
        give_out(first, walks, task, room.walk)
        hand_out(in_lanes(room.search[0:1]), first, batch.energies.reshape(1, batch.energies.shape[0]))
        for lane in range(min(LANES, batch.energies.shape[0] - first)):
            batch.told[0, first + lane], batch.told[1, first + lane] = search.off[lane], search.verdict[lane]
