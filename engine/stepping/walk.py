"""Integration of a motion step by step, each lane with its own step lengths, until an event ends it.

A walk follows the crank angle or time. Every system is integrated alike: the stages of a method, their rates from the
printed functions, an error estimate and guards. A guard is a number that is positive while the motion continues
unchanged. A step in which it vanishes is repeated with refined lengths until it ends at the root; no event is located
by interpolation.

Along the angle, quantities of the position only are the same in every cycle. The mesh of one cycle is laid once and
its position-dependent values are stored; later cycles repeat it while the errors stay small enough.
"""

import math
from typing import NamedTuple

from engine.compiling.blocks import LANES, gather, in_lanes
from engine.compiling.decorators import driver, inlined, routine, separate
from engine.compiling.packed import call_at, unpacked
from engine.stepping.methods import at_stage, step_end
from engine.stepping.steps.repeated_steps import NEARLY, cycles_ahead, go_back, may_repeat, remember
from engine.stepping.steps.stage_rates import keep_place, look, rate, record, set_position
from engine.stepping.steps.step_edges import (
    MOST_PARTS,
    NEARLY_ALL,
    edge_ahead,
    ends_at_instant,
    equal_part,
    find_edge,
    look_ahead,
    next_instant,
    pass_edge,
)
from engine.stepping.steps.step_errors import (
    GROW,
    ROUNDED,
    SAFETY,
    carry_errors,
    energy_beside,
    is_rounding,
    judge_steps,
    shorten,
)
from engine.stepping.steps.step_guards import (
    aims_at_kink,
    fires,
    hides_top,
    hides_two,
    is_crossed,
    missed_top,
    narrow,
    next_root,
    settles,
    steepness,
    switch,
    switches,
)
from engine.stepping.steps.step_lanes import (
    EDGE,
    FIRST,
    OTHER,
    RISE,
    SLOPE,
    SPEED,
    Room,
    WalkBatch,
    store_block,
)
from engine.stepping.walk_task import FADED, FULL, GOAL, GOING, GUARD, LONGEST, LOST, OTHER_GOAL, RANGE, WalkTask

# Steps after which a walk can be interrupted.
MOST_STEPS = 1 << 13
# A repeated step may exceed the tolerance of a new one by this factor.
ROUGHLY = 100.0
# Limit of |h ∂f/∂y| for an explicit step. Along time, a step spans at most the fraction AT_ONCE of the interval between
# two edges, unless that is less than the fraction NARROW of the longest step.
STEEPEST, AT_ONCE, NARROW = 5.0, 0.25, 1e-3


class StepAddresses(NamedTuple):
    """Addresses of the functions that all walks share; of `find_stages` only for an implicit method, else 0."""

    find_stages: int
    attempt: int
    lay_steps: int
    repeat_steps: int


@separate
def attempt(kept: int, keeps: bool, addresses: StepAddresses, batch: WalkBatch, task: WalkTask, packed: Room) -> None:
    """Try a step in all lanes: its stages, its end and its error estimate.

    The position-dependent values come from slot `kept` unless it is negative; if `keeps`, they are stored.
    """
    room, printed = unpacked(packed), batch.printed
    own, k, begin = room.lane, in_lanes(room.rates), room.begin
    after, errors = room.after, room.errors
    state = in_lanes(room.numbers[task.first_place + task.places :])
    for q in range(task.states):
        for lane in range(LANES):
            state[q, lane] = begin[q, lane]
    if task.implicit:
        call_at(addresses.find_stages, (printed, task, packed))
    else:
        for s in range(task.stages):
            if s > 0:
                at_stage(task.method, s, task.states, task.width, begin, own.length, k, state)
            set_position(task.nodes[s], s, kept, printed, task, room)
            rate(s, printed, task, room)
            if s == 0:
                look(0, printed, task, room)
            if keeps:
                keep_place(s, task, room)
    judged = task.width if task.carries or task.displaces != 0.0 else task.states
    step_end(task.method, judged, task.width, begin, own.length, k, after, errors)
    if task.implicit:
        count, first = task.stages * task.solved, 1 if task.along_time else 0
        for q in range(first, task.states, 2):
            last = room.equations[count * (count + 1) + (task.stages - 1) * task.states + q]
            for lane in range(LANES):
                # The last stage is the end, without the rounding of a steep motor's torque.
                after[q, lane] = last[lane]
    for q in range(task.states):
        for lane in range(LANES):
            state[q, lane] = after[q, lane]
    set_position(1.0, task.stages, kept, printed, task, room)
    if task.solves >= 0:
        rate(task.stages, printed, task, room)
    look(1, printed, task, room)
    if keeps:
        keep_place(task.stages, task, room)
    judge_steps(task, room)


# Step lengths and decisions


@inlined
def first_part(length: float, lane: int, task: WalkTask, room: Room) -> float:
    """Length of the first step to an end or event; from a common start, only the walk of longest steps makes it in one.

    Otherwise all walks would make the same step, and their comparison would show no error.
    """
    parts = (task.along_time or task.fixed) and room.lane.alone[lane] > 0.0
    return task.longer / LONGEST * length if parts else length


@routine
def choose(edges: int, instants: int, most_steps: int, task: WalkTask, room: Room) -> bool:
    """Choose the length of each lane's next step: an equal part of the distance to its next end, or 0 for no step.

    Returns whether any lane makes a step.
    """
    own, state, goes = room.lane, room.begin, False
    for lane in range(LANES):
        own.length[lane] = 0.0
        if own.why[lane] != GOING or not own.at[lane] < own.halt[lane]:
            continue
        if own.steps[lane] >= most_steps:
            own.why[lane] = FULL
            continue
        goes = True
        if own.trials[lane] > 0.0:
            own.length[lane] = next_root(lane, task, room)
            continue
        look_ahead(lane, edges, room)
        until, most = min(own.goal[lane], own.halt[lane]), own.pace[lane]
        if task.along_time:
            if instants > 0:
                until = min(until, next_instant(lane, instants, room) - own.clock[lane])
            speed, between = abs(state[1, lane]), AT_ONCE * task.longer * (own.high[lane] - own.low[lane])
            # Edges may be as close as rounding.
            freely = between < NARROW * own.farthest[lane] or own.farthest[lane] < between
            farthest = own.farthest[lane] if freely else between
            most = most if most * speed < farthest else farthest / speed
            longest = task.longer * own.longest[lane]
            most = most if most < longest else longest
        else:
            until, most = min(until, edge_ahead(lane, room)), min(most, own.farthest[lane])
            most = equal_part(most, lane, task, room) if task.fixed else most
        rest = min(until - own.at[lane], own.aim[lane])
        own.aim[lane] = math.inf
        # A distance of too many steps isn't divided.
        parts = math.ceil(rest / most * NEARLY_ALL) if rest < MOST_PARTS * most else 0
        # All walks might divide the distance from a common start into as many equal parts, and make the same steps.
        apart = task.longer == LONGEST and own.alone[lane] > 0.0 and not task.fixed
        if parts == 1:
            own.length[lane] = first_part(rest, lane, task, room)
        else:
            own.length[lane] = most if parts == 0 or apart else rest / parts
        if not own.length[lane] > 0.0:
            # No step starts from a NaN or infinite state.
            own.length[lane], own.why[lane] = 0.0, LOST
    return goes


@routine
def decide_steps(task: WalkTask, room: Room) -> bool:
    """Set `taken` in lanes that accept the step; other lanes try another length. Returns whether any lane accepts."""
    own, took, bends = room.lane, False, task.kinks.shape[0] > 0
    fires(task.extremes, task, room)
    for lane in range(LANES):
        own.taken[lane] = 0.0
        if own.length[lane] > 0.0:
            if bends and aims_at_kink(lane, task, room):
                continue
            if not own.missed[lane] <= 1.0 and not is_rounding(lane, room):
                shorten(lane, task, room)
            elif hides_top(lane, task, room):
                own.pace[lane] = SAFETY / steepness(lane, task, room)
            elif hides_two(lane, task, room):
                own.pace[lane] = 0.5 * own.length[lane]
            elif own.fired[lane] == 0.0 and own.trials[lane] == 0.0:
                own.taken[lane], took = 1.0, True
            elif narrow(lane, task, room):
                part = first_part(own.length[lane], lane, task, room)
                if part < own.length[lane]:
                    own.pace[lane], own.trials[lane], own.alone[lane] = part, 0.0, 0.0
                else:
                    own.taken[lane], took = 1.0, True
    return took


@routine
def advance(task: WalkTask, room: Room) -> None:
    """Accept the states at the end of the step in lanes that take it."""
    own, watched, begin, after = room.lane, in_lanes(room.watched), room.begin, room.after
    row, carried_errors = task.watched + SPEED, room.carried_errors
    if task.carries:
        carry_errors(task, room)
    for q in range(task.width if task.displaces != 0.0 else 0):
        for lane in range(LANES):
            displaced = after[q, lane] + task.displaces * abs(room.errors[q, lane])
            # A side that moves doesn't come to rest by this.
            after[q, lane] = displaced if displaced * after[q, lane] > 0.0 else after[q, lane]
    for q in range(task.width):
        for lane in range(LANES):
            begin[q, lane] = after[q, lane] if own.taken[lane] > 0.0 else begin[q, lane]
    for lane in range(LANES):
        speed, took = watched[row, lane], own.taken[lane] > 0.0
        off = carried_errors[0, lane] + energy_beside(lane, task, room)
        off = 0.5 * speed * off / begin[0, lane] if task.carries else math.nan
        off += own.top_off[lane]
        slower, faster = took and speed < own.slowest[lane], took and speed > own.fastest[lane]
        own.slowest[lane] = speed if slower else own.slowest[lane]
        own.slow_off[lane] = off if slower else own.slow_off[lane]
        own.fastest[lane] = speed if faster else own.fastest[lane]
        own.fast_off[lane] = off if faster else own.fast_off[lane]
        own.slope[lane] = watched[task.watched + SLOPE, lane] if took else own.slope[lane]
        own.scale[lane] = own.work[lane] if took else own.scale[lane]
        own.steps[lane] += own.taken[lane]


@routine
def take(edges: int, task: WalkTask, room: Room) -> None:
    """Accept the step in lanes that take it, and find out what ends there."""
    own, begin, watched = room.lane, room.begin, in_lanes(room.watched)
    k, ending, last = in_lanes(room.rates), room.ending, (task.stages - 1) * task.width
    for q in range(task.width):
        for lane in range(LANES):
            # The last stage is the end of the step.
            ending[q, lane] = k[last + q, lane] if own.taken[lane] > 0.0 else ending[q, lane]
    for lane in range(LANES):
        own.ended[lane] = -1.0
        if own.taken[lane] > 0.0 and own.trials[lane] > 0.0:
            for g in range(FIRST + task.endings):
                # An extreme of the speed ends only the step.
                if is_crossed(g, lane, task, room) and not (g == RISE and own.ended[lane] >= 0.0):
                    own.ended[lane] = float(g)
    for lane in range(LANES):
        own.top_off[lane] = missed_top(lane, task, room)
        rise = settles(lane, task, room) if own.fired[lane] > 0.0 else 0.0
        own.settled[lane] = watched[SPEED, lane] + rise if rise != 0.0 else math.nan
    advance(task, room)
    for lane in range(LANES):
        if own.taken[lane] == 0.0:
            continue
        # A step from before an extreme to beyond it may have its more extreme speed at its start.
        missed = watched[task.watched + SPEED, lane] + math.copysign(own.top_off[lane], watched[SLOPE, lane])
        for speed in (own.settled[lane], missed):
            above, below = speed - own.fastest[lane], own.slowest[lane] - speed
            own.fast_off[lane] = above if above > own.fast_off[lane] else own.fast_off[lane]
            own.slow_off[lane] = below if below > own.slow_off[lane] else own.slow_off[lane]
        at, edge = own.at[lane] + own.length[lane], edge_ahead(lane, room)
        if task.along_time:
            at_edge = own.ended[lane] == EDGE
            begin[0, lane] = edge if at_edge else begin[0, lane]
            own.at[lane], own.turned[lane] = at, begin[0, lane]
        else:
            at_edge = at >= edge - ROUNDED * (abs(edge) + own.length[lane])
            own.at[lane] = edge if at_edge else at
            own.turned[lane] = own.at[lane]
        if at_edge and not pass_edge(lane, edges, task, room):
            own.why[lane] = RANGE
        for end in (own.halt[lane], own.goal[lane]):
            if end - own.at[lane] <= ROUNDED * abs(own.at[lane]):
                own.at[lane] = end
                own.turned[lane] = own.turned[lane] if task.along_time else end
        if own.at[lane] >= own.goal[lane]:
            own.why[lane] = GOAL
        switched = switches(lane, task, room)
        if switched:
            switch(lane, task, room)
        if own.ended[lane] == OTHER or own.ended[lane] >= FIRST:
            own.why[lane] = OTHER_GOAL if own.ended[lane] == OTHER else GUARD + own.ended[lane] - FIRST
        speed = watched[task.watched + SPEED, lane]
        if task.along_time and not task.signed and own.why[lane] == GOING and 0.0 < speed < own.floor[lane]:
            own.why[lane] = FADED
        own.trials[lane], own.aims[lane], own.refused[lane] = 0.0, 0.0, math.inf
        own.alone[lane] = 1.0 if at_edge or switched or ends_at_instant(lane, room) else 0.0
        if task.fixed:
            own.pace[lane] = own.farthest[lane]
        else:
            share = SAFETY / math.sqrt(math.sqrt(math.sqrt(own.missed[lane])))
            most = GROW * task.longer * task.longer
            own.exact[lane] = 1.0 if share > most else 0.0
            ahead = own.length[lane] * (share if share < most else most)
            own.pace[lane] = ahead if ahead > own.pace[lane] else own.pace[lane]


# The walk


@routine
def lay(first: int, addresses: StepAddresses, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Make new steps: one cycle's, to be stored, in lanes with several cycles ahead; all remaining ones in others.

    The lanes are independent.
    """
    own, slots = room.lane, room.lengths.shape[0]
    for lane in range(LANES):
        several = slots > 1 and own.at[lane] + (cycles_ahead(task) + 1.0) * task.cycle <= own.goal[lane]
        later = own.at[lane] < own.free[lane]
        own.halt[lane] = own.free[lane] if later else own.at[lane] + task.cycle if several else math.inf
        own.kept[lane] = 0.0 if several and not later else -1.0
    call_at(addresses.lay_steps, (first, addresses, batch, task, room))


@separate
def lay_steps(first: int, addresses: StepAddresses, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Make new steps up to each lane's halt, and store them in lanes that keep them."""
    own, lengths, limits = room.lane, in_lanes(room.lengths), room.limits
    slots, edges, records = room.lengths.shape[0], batch.edges.shape[0] // 2, batch.recorded.shape[0] > 0
    most_steps = batch.recorded.shape[0] if records else MOST_STEPS
    while choose(edges, batch.instants.shape[0], most_steps, task, room):
        keeps = False
        for lane in range(LANES):
            keeps |= own.kept[lane] >= 0.0 and own.length[lane] > 0.0
            end = own.at[lane] + own.length[lane]
            own.behind[lane], own.ahead[lane] = max(own.low[lane] - own.at[lane], 0.0), max(end - own.high[lane], 0.0)
        call_at(addresses.attempt, (-1, keeps, addresses, batch, task, room))
        took = decide_steps(task, room)
        if records and took:
            record(first, batch.printed, batch.recorded, task, room)
        for lane in range(LANES if keeps else 0):
            if own.taken[lane] > 0.0 and own.kept[lane] >= 0.0:
                slot = int(own.kept[lane])
                if slot < slots:
                    lengths[slot, lane] = own.length[lane]
                    limits[2 * slot, lane], limits[2 * slot + 1, lane] = own.behind[lane], own.ahead[lane]
                    own.kept[lane] += 1.0
                else:
                    own.halt[lane], own.kept[lane] = math.inf, -1.0
        take(edges, task, room)


@routine
def repeat(addresses: StepAddresses, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Repeat the steps of a cycle in lanes with enough cycles ahead, as long as the errors stay small.

    The speed curves over the angle of a motion and of the same motion one cycle later never cross. The extremes of a
    walk are therefore those of its first and last cycles, whose steps are computed again.
    """
    own, first = room.lane, True
    while True:
        able, slots = 0, 0
        for lane in range(LANES):
            whole = may_repeat(lane, task, room)
            own.able[lane] = 1.0 if whole else 0.0
            able += 1 if whole else 0
            slots = max(slots, int(own.kept[lane]) if whole else 0)
        if able == 0:
            break
        for lane in range(LANES if task.extremes else 0):
            if own.able[lane] > 0.0:
                remember(first, lane, task, room)
        call_at(addresses.repeat_steps, (slots, addresses, batch, task, room))
        for lane in range(LANES):
            if own.able[lane] > 0.0:
                own.halt[lane] += task.cycle
                own.at[lane], own.base[lane] = own.halt[lane], own.base[lane] + task.cycle
                if own.at[lane] >= own.goal[lane] - NEARLY * task.cycle:
                    own.at[lane], own.why[lane] = own.goal[lane], GOAL
                own.turned[lane] = own.at[lane]
            elif may_repeat(lane, task, room) and (own.at[lane] != own.turned[lane] or not first):
                # The lane left the stored steps; make new ones from there.
                if task.extremes:
                    go_back(lane, task, room)
                own.turned[lane], own.halt[lane] = own.at[lane], math.inf
                find_edge(lane, batch.edges.shape[0] // 2, task, room)
            elif own.why[lane] == GOING:
                own.halt[lane] = math.inf
        first = False


@separate
def repeat_steps(slots: int, addresses: StepAddresses, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Repeat the stored steps in lanes that are `able`; a lane with too large an error no longer is."""
    own, lengths, limits = room.lane, in_lanes(room.lengths), room.limits
    for lane in range(LANES):
        own.worst[lane], own.top_off[lane] = 0.0, 0.0
    for slot in range(slots):
        for lane in range(LANES):
            goes = (own.able[lane] > 0.0) & (slot < own.kept[lane])
            own.length[lane] = lengths[slot, lane] if goes else 0.0
            own.behind[lane], own.ahead[lane] = limits[2 * slot, lane], limits[2 * slot + 1, lane]
        call_at(addresses.attempt, (slot, False, addresses, batch, task, room))
        fires(False, task, room)
        for lane in range(LANES):
            sound = (own.length[lane] == 0.0) | ((own.missed[lane] <= ROUGHLY) & (own.fired[lane] == 0.0))
            own.able[lane] = own.able[lane] if sound else 0.0
            own.taken[lane] = own.able[lane] if own.length[lane] > 0.0 else 0.0
            missed = own.missed[lane] if own.taken[lane] > 0.0 else 0.0
            own.worst[lane] = missed if missed > own.worst[lane] else own.worst[lane]
        advance(task, room)
        for lane in range(LANES):
            own.at[lane] += own.taken[lane] * own.length[lane]


@routine
def take_in(first: int, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Load a block of variants, starting at number `first`, at their initial states."""
    own, edges, last = room.lane, batch.edges.shape[0] // 2, min(LANES, batch.given.shape[1] - first)
    gather(batch.numbers, first, in_lanes(room.numbers))
    gather(batch.edges, first, room.edges)
    gather(batch.instants, first, room.instants)
    gather(batch.given, first, room.lane)
    gather(batch.states, first, room.begin)
    gather(batch.carried_errors, first, room.carried_errors)
    for lane in range(LANES):
        own.at[lane] = 0.0 if task.along_time else own.turned[lane]
        own.slowest[lane], own.fastest[lane], own.slope[lane] = math.inf, -math.inf, math.nan
        own.slow_off[lane], own.fast_off[lane] = math.nan, math.nan
        own.steps[lane], own.scale[lane], own.trials[lane], own.free[lane] = 0.0, 0.0, 0.0, -math.inf
        own.begins[lane], own.ends[lane], own.refused[lane] = -math.inf, math.inf, math.inf
        own.aim[lane], own.aims[lane], own.alone[lane], own.exact[lane] = math.inf, 0.0, 1.0, 0.0
        own.why[lane] = GOING if lane < last and own.at[lane] < own.goal[lane] else GOAL
        find_edge(lane, edges, task, room)
        look_ahead(lane, edges, room)


@driver
def walk(begin: int, end: int, addresses: StepAddresses, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Integrate the variants of blocks begin … end − 1 to the end of their walks.

    Parameters
    ----------
    begin, end : int
    addresses : StepAddresses
    batch : WalkBatch
    task : WalkTask
    room : Room
    """
    own = room.lane
    for b in range(begin, end):
        first = b * LANES
        take_in(first, batch, task, room)
        going = True
        while going:
            lay(first, addresses, batch, task, room)
            if room.lengths.shape[0] > 1:
                repeat(addresses, batch, task, room)
            going = False
            for lane in range(LANES):
                going = going or own.why[lane] == GOING
        store_block(first, batch, task, room)
