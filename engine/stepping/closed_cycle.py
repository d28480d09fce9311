"""The cycle that returns to its own energy, in lanes: Newton's method on the return map.

The return map takes the kinetic energy E at the start of a cycle to the energy P(E) at its end. Its derivative is
computed along with it, ln(dP/dE) = ∮ ∂M/∂E dφ. Motions never cross, so P increases with E: a machine that stalls from
some energy stalls from every lower one, and one that is faster after a cycle settles at a higher energy. The search
starts at an energy at which loads should dominate, and stays within the known bounds. Step lengths are chosen in the
first cycle and then reused as long as their errors are small enough. A last cycle, from the energy found, has the
results; all lanes make it together, so that it can also end steps at the extremes of the speed.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import LANES, Row, scatter_rows
from engine.compiling.decorators import driver, routine
from engine.compiling.packed import call_at
from engine.cycle.panels.lanes import one, rows
from engine.stepping.steps.step_edges import find_edge
from engine.stepping.steps.step_lanes import Room, WalkBatch, store_block
from engine.stepping.walk import StepAddresses, take_in
from engine.stepping.walk_task import FULL, GOAL, GOING, STEEP, WalkTask
from engine.words.verdicts import Verdict

OK, STALLS, RUNS_AWAY, ANY_SPEED, NOT_FINITE = (
    float(v) for v in (Verdict.OK, Verdict.STALLS, Verdict.RUNS_AWAY, Verdict.ANY_SPEED, Verdict.NOT_FINITE)
)
# Verdict of a lane still being searched, and of one whose motor is too steep for explicit steps.
SEARCHING, TOO_STEEP = -1.0, -2.0
# Most cycles. An energy is accepted if Newton's method leaves less than CLOSED (relative) or NEGLIGIBLE (fraction of
# the error of the steps), or less than NEARLY_CLOSED if rounding prevents that. What it leaves may exceed its forecast
# by the factor UNSTEADY, as the curvature of the map still changes.
MOST_CYCLES, CLOSED, NEGLIGIBLE, NEARLY_CLOSED, UNSTEADY = 60, 1e-12, 0.1, 1e-8, 30.0
# Reused steps whose error exceeds the tolerance by this factor are chosen again before the cycle is accepted.
ALLOWED = 10.0
# Largest factor by which an energy is raised; smallest fraction, of its distance to the lower bound, to which it drops.
RAISED, LEFT = 8.0, 0.25
# If the work relative to its terms, and the decay of disturbances, are below this, they are rounding.
NO_WORK = 1e-9
# An interval of this relative width between a falling and a stalling energy contains no steady running.
NARROW = 1e-3


class CycleSearch(NamedTuple):
    """Rows of the search, a number for each lane.

    Attributes
    ----------
    energy : row
        At the start of the current cycle.
    off : row
        |P(E) − E|/E of the cycle found.
    verdict : row
    carried_error : row
        Error estimate of the energy found [J]; 0 before. The error of a cycle recurs in the next one, so it is the sum
        of a geometric series.
    low, high : row
        Highest energy known to rise or to stall, lowest energy known to fall [J].
    stalls : row
        1 if the machine stalls from the lower one.
    rising : row
        1 if the energy rose in the last complete cycle.
    cycles : row
        Their number.
    change : row
        Correction by which Newton's method led to the current energy; infinite if it didn't [J].
    moved : row
        1 if any step was made.
    laying : row
        1 if the next cycle chooses its steps.
    last : row
        1 in the cycle from the energy found.
    """

    energy: Row
    off: Row
    verdict: Row
    carried_error: Row
    low: Row
    high: Row
    stalls: Row
    rising: Row
    cycles: Row
    change: Row
    moved: Row
    laying: Row
    last: Row


# The first rows are the outcome of the search.
OUTCOME = CycleSearch._fields[: CycleSearch._fields.index("low")]


class CycleRoom(NamedTuple):
    """Scratch arrays for a block."""

    walk: Room
    search: one(CycleSearch)


class CycleBatch(NamedTuple):
    """Input and output of the search.

    Attributes
    ----------
    walks : WalkBatch
        From the first trial energies; updated to the ends of the last cycles.
    last : WalkTask
        Settings of the last cycle.
    farthest : float
        Its largest step [rad]; infinite if it takes those of the search, 0 if there is none.
    outcome : ndarray (OUTCOME, variants)
    fading : int
        Row of the states with ∮ ∂M/∂E dφ.
    """

    walks: WalkBatch
    last: WalkTask
    farthest: float
    outcome: np.ndarray
    fading: int


def new_cycle_room(room: Room) -> CycleRoom:
    """Scratch arrays for a block."""
    return CycleRoom(room, rows(len(CycleSearch._fields)))


@routine
def begin_cycle(lane: int, energy: float, edges: int, task: WalkTask, room: CycleRoom) -> None:
    """Set a lane to the start of a cycle."""
    own, search = room.walk.lane, room.search
    begin, carried_errors = room.walk.begin, room.walk.carried_errors
    for q in range(task.width):
        begin[q, lane], carried_errors[q, lane] = 0.0, 0.0
    begin[0, lane], search.energy[lane] = energy, energy
    carried_errors[0, lane] = search.carried_error[lane]
    own.slowest[lane], own.fastest[lane] = math.inf, -math.inf
    own.at[lane], own.turned[lane], own.steps[lane], own.trials[lane] = 0.0, 0.0, 0.0, 0.0
    own.scale[lane] = 0.0 if search.laying[lane] > 0.0 else own.scale[lane]
    own.why[lane] = GOING
    find_edge(lane, edges, task, room.walk)


@routine
def judge_cycle(lane: int, fading: int, edges: int, task: WalkTask, room: CycleRoom) -> None:
    """Evaluate a cycle and start the next one, or set the verdict of the search."""
    own, search, end = room.walk.lane, room.search, room.walk.begin
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
    if search.last[lane] > 0.0:
        own.why[lane], search.verdict[lane] = GOAL, OK if whole else NOT_FINITE
        return
    search.cycles[lane] += 1.0
    newton, multiplier = math.nan, math.nan
    if whole:
        multiplier = math.exp(min(end[fading, lane], 700.0))
        newton = before + (after - before) / (1.0 - multiplier) if multiplier != 1.0 else math.nan
        change, last = abs(newton - before), search.change[lane]
        unsure = room.walk.carried_errors[0, lane] / abs(1.0 - multiplier)
        # Newton's corrections fall quadratically, so the last two forecast the next one.
        left = change * min(UNSTEADY * (change / last) ** 2, 1.0) if last < math.inf else change
        settled = left <= max(CLOSED * before, NEGLIGIBLE * unsure)
        settled = settled or (change <= NEARLY_CLOSED * before and 0.5 * last <= change)
        # If the work is too small to change the energy, keep the previous direction.
        search.rising[lane] = search.rising[lane] if after == before else 1.0 if after > before else 0.0
        first = search.low[lane] == 0.0 and not search.high[lane] < math.inf
        if first and abs(after - before) <= NO_WORK * own.scale[lane] and abs(multiplier - 1.0) <= NO_WORK:
            search.verdict[lane] = ANY_SPEED
            return
        if settled and (laid or own.worst[lane] <= ALLOWED):
            search.off[lane], search.carried_error[lane] = left * abs(1.0 - multiplier) / newton, unsure + left
            search.last[lane], search.laying[lane] = 1.0, 1.0 if own.kept[lane] <= 0.0 else 0.0
            begin_cycle(lane, newton, edges, task, room)
            return
        if settled:
            # New steps disturb the cycle, by less than the energy itself.
            search.laying[lane], search.change[lane] = 1.0, newton
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
    energy = next_energy(whole, newton, multiplier, before, after, low, high)
    search.change[lane] = abs(newton - before) if energy == newton else math.inf
    begin_cycle(lane, energy, edges, task, room)


@routine
def next_energy(
    whole: bool, newton: float, multiplier: float, before: float, after: float, low: float, high: float
) -> float:
    """Next trial energy between a lower and an upper bound."""
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


@routine
def make_cycles(
    first: int, last: float, addresses: StepAddresses, batch: CycleBatch, task: WalkTask, room: CycleRoom
) -> None:
    """Go through cycles, those of the search or, if `last` is 1, the last ones, until all lanes have made theirs."""
    walks, own, search = batch.walks, room.walk.lane, room.search
    edges, slots = walks.edges.shape[0] // 2, room.walk.lengths.shape[0]
    while True:
        going, most = False, 0
        for lane in range(LANES):
            goes = search.verdict[lane] == SEARCHING and search.last[lane] == last
            lays = goes and search.laying[lane] > 0.0
            going = going or goes
            own.halt[lane] = math.inf if lays else -math.inf
            own.able[lane] = 1.0 if goes and not lays else 0.0
            # Nothing repeats the last cycle.
            stores = slots > 1 and last == 0.0
            own.kept[lane] = (0.0 if stores else -1.0) if lays else own.kept[lane]
            own.pace[lane] = own.farthest[lane] if lays else own.pace[lane]
            most = max(most, int(own.kept[lane]) if own.able[lane] > 0.0 else 0)
        if not going:
            break
        call_at(addresses.lay_steps, (first, addresses, walks, task, room.walk))
        if most > 0:
            call_at(addresses.repeat_steps, (most, addresses, walks, task, room.walk))
        for lane in range(LANES):
            if search.verdict[lane] == SEARCHING and search.last[lane] == last:
                judge_cycle(lane, batch.fading, edges, task, room)


@driver
def find_cycles(
    begin: int, end: int, addresses: StepAddresses, batch: CycleBatch, task: WalkTask, room: CycleRoom
) -> None:
    """Find the cycles that return to their own energies, for the blocks begin … end − 1 of variants.

    Parameters
    ----------
    begin, end : int
    addresses : StepAddresses
    batch : CycleBatch
    task : WalkTask
        Over the angle, to the end of a cycle.
    room : CycleRoom
    """
    walks, own, search = batch.walks, room.walk.lane, room.search
    edges = walks.edges.shape[0] // 2
    for b in range(begin, end):
        first = b * LANES
        take_in(first, walks, task, room.walk)
        for lane in range(LANES):
            search.low[lane], search.high[lane], search.change[lane] = 0.0, math.inf, math.inf
            search.off[lane] = math.inf
            search.stalls[lane], search.rising[lane], search.moved[lane] = 0.0, 0.0, 0.0
            search.cycles[lane], search.laying[lane] = 0.0, 1.0
            search.carried_error[lane], search.last[lane] = 0.0, 0.0
            search.verdict[lane] = SEARCHING if own.why[lane] == GOING else OK
            begin_cycle(lane, room.walk.begin[0, lane], edges, task, room)
        make_cycles(first, 0.0, addresses, batch, task, room)
        for lane in range(LANES):
            if search.verdict[lane] == SEARCHING and batch.farthest == 0.0:
                search.verdict[lane] = OK
            elif search.verdict[lane] == SEARCHING and batch.farthest < math.inf:
                own.farthest[lane], search.laying[lane] = batch.farthest, 1.0
                begin_cycle(lane, search.energy[lane], edges, task, room)
        make_cycles(first, 1.0, addresses, batch, batch.last, room)
        store_block(first, walks, task, room.walk)
        scatter_rows(search, first, batch.outcome)
