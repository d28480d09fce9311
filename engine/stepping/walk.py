"""The walk of a motion: step after step, each lane with lengths of its own, until something ends it.

A walk goes along the crank angle or along time. Whatever the system, a step is the same: the stages of a method, their
rates from the printed functions, an estimated error, and guards. A guard is a number that is positive as long as the
motion may go on as it does; the step in which it vanishes is repeated, ever more exactly shortened, to end there.
Nothing is interpolated.

Along the angle, what depends on the position alone is the same in every cycle. The steps of a cycle are laid once, with
what they need of their positions, and then repeated as long as they miss little enough.
"""

import math
from collections.abc import Callable
from enum import IntEnum
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import Row, Rows, gather, hand_out, in_lanes
from engine.compiling.decorators import driver, inlined, routine
from engine.compiling.memory import memory
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import ASIDE, one, rows
from engine.laws.elementary import direction_of, exponential
from engine.laws.rounding import EPS
from engine.stepping.methods import at_stage, step_end

# Steps that are laid for a cycle, at most; lanes that need more go on without repeating theirs.
MOST_SLOTS = 160
# Steps after which a walk can be interrupted.
MOST_STEPS = 1 << 13
# A repeated step may miss so many times what a new one may.
ROUGHLY = 100.0
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# How far a disturbance may fade or grow within an explicit step; what share of the way between two edges a step along
# time goes at most, where that isn't as narrow a share of the farthest step.
STEEPEST, AT_ONCE, NARROW = 5.0, 0.25, 1e-3
# Steps of a second walk may be so many times as long, and miss so many times as much, but for what tells nothing:
# whatever limits them, all are others, and the difference of both walks tells what the first misses.
LONGER, COARSER, COARSEST = 2.0, 2.0**7, 1e-2
# An implicit method is worth its price where after so many steps they are shorter than this share of the farthest one
# while disturbances fade within them by so much.
MANY, WORTH_SOLVING, FADES = 100, 0.05, 0.3
# Rounds for the stages of an implicit step, what they are found to, or nearly so where rounding keeps them from it, and
# how much of itself a state may lose in one.
MOST_ROUNDS, FOUND_TO, NEARLY_FOUND, LEAST_LEFT = 12, 1e-14, 1e-11, 0.1
# The real eigenvalue of the matrix of Radau's method with five stages is 0.159; what of it counts in estimated errors.
OWN_SHARE = 0.25 * 0.159
# A rate that depends on itself is found to so much of itself, within so many trials; after some of them, rounding
# alone keeps it from coming nearer.
SOLVED_TO, MOST_SECANTS, SURE_SECANTS = 1e-13, 20, 6
# Share of its length by which the step to a guard's root is known, and how many steps are tried for it.
ROOT, MOST_TRIALS = 4e-16, 60
# What stands for the zero of a guard at the begin of a step.
TINY = 1e-292
# Of a guard below this share of what it comes to, the straight line tells nothing; so far into the step is then tried.
NEXT_TO_NOTHING, LEAP = 1e-3, 0.1
# An extreme of the speed is met where the slope is less than this share of its terms, for the speed is flat there. To
# have it on both sides, a step to it goes on by a share of the bracket, and the second one by a share of its own way.
FLAT, BEYOND, BEHIND = 1e-5, 1e-5, 0.2
# Errors below this share of a state are rounding; so is what is left of the way to an edge.
ROUNDED = 4.0 * float(np.finfo(float).eps)
# A cycle that ends so near to the goal, as a share of it, ends there.
NEARLY = 1e-12
# What a step misses is rounding, of forces that are in balance and such, where it is no more than this and falls to no
# smaller a share when the step is shortened; it counts as so much of what a step may miss, for steps shall grow again.
NOISE, FALLS, FORGIVEN = 1e-11, 0.5, 0.05
# A way is divided into equal steps where there are no more than so many.
MOST_PARTS = 1e6
# A step in time is refused that turns more than so many times the farthest that a step may.
TOO_FAR = 2.0
# Steps shorter than this share of what they go along miss whatever is tried; at the begin, of this time [s].
SHORTEST, LEAST_TIME = 1e-13, 1e-7


def coarser(tolerance: float) -> float:
    """What a step of a second walk may miss, for comparison."""
    return max(tolerance, min(COARSER * tolerance, COARSEST))


class Why(IntEnum):
    """Why a walk ended.

    STEEP where an implicit method is worth more, FADED where the speed is next to nothing; from GUARD on, the guard of
    that number.
    """

    GOING = -1
    GOAL = 0
    RANGE = 1
    LOST = 2
    STEEP = 3
    FULL = 4
    OTHER_GOAL = 5
    FADED = 6
    GUARD = 7


GOING, GOAL, RANGE, LOST, STEEP, FULL, OTHER_GOAL, FADED, GUARD = (int(why) for why in Why)
# What `watch` gives of a state before its guards: the speed, the magnitudes that the rate of the first state is made
# of, its derivative by that state, what has the sign of the speed's slope, and from RESPONSES on derivatives of what is
# gathered by the first state.
SPEED, SIZE, STEEPNESS, SLOPE, RESPONSES = range(5)
# Guards that are no rows of `rates`: the edge ahead, the other goal, an extreme of the speed.
EDGE, OTHER, RISE, FIRST = range(4)


class WalkTask(NamedTuple):
    """What a walk is to do, the same for all its variants.

    Attributes
    ----------
    along_time : bool
        Whether it goes along time, the angle turned being its first state; else along the angle.
    method, stages : int
        Number of the method, and its stages.
    fixed : bool
        Whether steps have fixed lengths.
    longer : float
        1, or LONGER of a second walk, for comparison.
    steepest : float
        How far a disturbance may fade or grow within an explicit step.
    nodes, parts : ndarray
        Of the method.
    implicit : bool
        Whether its stages are found by Newton's method.
    solved : int
        How many states it solves for: the energy, or the speeds; 0 where it can't.
    slopes : int
        Row that `watch` fills with the first derivative of their rates by each of them.
    solves : int
        The state whose rate depends on itself, −1: none; its row of P follows those of the states.
    matrix, inverse : ndarray
        Of an implicit method.
    states, width : int
        Rows of `rates`: those of the states, and with what is gathered.
    scales : int
        Row from which on `watch` fills what errors of the states are measured by along time; −1: by the states.
    watched, guards : int
        Rows that `watch` fills, and how many of them are guards, the last ones.
    ends : ndarray of bool
        Whether each guard ends the walk; others change what is held.
    carries : bool
        Whether what steps may be off by is carried along.
    first_place, places, rated : int
        Rows of P that the printed function `places` fills, and how many of them `rates` reads; those of the states
        follow.
    clock : int
        Row of P that holds the time; −1: none.
    extremes : bool
        Whether steps end at the extremes of the speed.
    root : float
        Share of its length by which the step to a guard's root is known.
    shown : ndarray
        Shares of a step at which its polynomial is recorded.
    cycle : float
        After which angle everything repeats itself; infinite if never [rad].
    held : ndarray of int
        Rows of P that a guard changes where it ends a step, to what `watch` fills before the guards.
    signed : bool
        Whether speeds may be negative.
    """

    along_time: bool
    method: int
    stages: int
    fixed: bool
    longer: float
    steepest: float
    implicit: bool
    solved: int
    slopes: int
    scales: int
    solves: int
    nodes: np.ndarray
    matrix: np.ndarray
    inverse: np.ndarray
    parts: np.ndarray
    states: int
    width: int
    watched: int
    guards: int
    ends: np.ndarray
    carries: bool
    first_place: int
    places: int
    rated: int
    clock: int
    extremes: bool
    root: float
    shown: np.ndarray
    cycle: float
    held: np.ndarray
    signed: bool


class Lane(NamedTuple):
    """Rows of a block, a number for each lane.

    Given are those up to `pace`; handed out are those from `turned` to `steps`.

    Attributes
    ----------
    start, direction : row
        Crank angle at the begin [rad], and the way in which the angle turned is counted, +1 or −1.
    facing : row
        The way in which it goes, +1 or −1.
    clock : row
        Time at the begin [s].
    goal, other_goal : row
        Where along its way it ends; at which angle turned on a way along time, and at which time along the angle.
    tolerance, farthest : row
        What a step may miss, and how far it may turn [rad].
    longest, floor : row
        On a way along time, how long a step may be [s], and a speed below which the motion has faded [rad/s]; where
        speeds may be negative, the least size by which errors of states are judged.
    turned, pace : row
        The angle turned, and the length that is tried next.
    at : row
        How far it has come along its way.
    slowest, fastest, slow_off, fast_off : row
        Least and greatest speed at the ends of steps, and what these may be off by.
    slope : row
        What has the sign of the speed's slope, at the end.
    why, steps : row
        Why it ended, and after how many steps.
    scale, work, size : row
        Greatest work of the steps taken; the same with the step that is tried; what a step's error is divided by.
    length, missed : row
        Of the step that is tried, and what it misses by what it may.
    edge, base : row
        Number of the edge behind it, and where its cycle begins.
    low, high, begins, ends : row
        Between which angles turned and times a step looks.
    short, long, trials, side : row
        Lengths of steps before and behind a guard's root, how many were tried for it, and which of both stayed last.
    short_speed, long_speed : row
        Speeds at the ends of these.
    fired : row
        1 where a guard ends the step.
    halt : row
        Where along its way the cycle that is laid or repeated ends.
    taken, able : row
        1 where the step is taken, and where a cycle is repeated.
    kept : row
        How many steps of a cycle are kept; −1 where none are.
    free : row
        Where along its way steps may be kept again.
    worst : row
        What the worst of the steps that were repeated misses, by what it may.
    doubt : row
        What the first state may be off by at the begin of the step.
    ended : row
        Number of the guard that ends the step; −1: none.
    refused : row
        What the step missed, by what it may, that was refused last; infinite where none was since one was taken.
    """

    start: Row
    direction: Row
    facing: Row
    clock: Row
    goal: Row
    other_goal: Row
    tolerance: Row
    farthest: Row
    longest: Row
    floor: Row
    turned: Row
    pace: Row
    at: Row
    slowest: Row
    fastest: Row
    slow_off: Row
    fast_off: Row
    slope: Row
    why: Row
    steps: Row
    scale: Row
    work: Row
    size: Row
    length: Row
    missed: Row
    edge: Row
    base: Row
    low: Row
    high: Row
    begins: Row
    ends: Row
    short: Row
    long: Row
    trials: Row
    side: Row
    short_speed: Row
    long_speed: Row
    fired: Row
    halt: Row
    taken: Row
    able: Row
    kept: Row
    free: Row
    worst: Row
    doubt: Row
    ended: Row
    refused: Row


GIVEN, FOUND = Lane._fields[:12], Lane._fields[10:20]
FIRST_FOUND = 10


class Room(NamedTuple):
    """Memory for a block; arrays of lanes."""

    numbers: np.ndarray
    position: np.ndarray
    lane: np.ndarray
    edges: np.ndarray
    instants: np.ndarray
    rates: np.ndarray
    watched: np.ndarray
    begin: np.ndarray
    after: np.ndarray
    errors: np.ndarray
    doubts: np.ndarray
    ending: np.ndarray
    equations: np.ndarray
    before: np.ndarray
    guards: np.ndarray
    lengths: np.ndarray
    places: np.ndarray


def new_room(task: WalkTask, numbers: int, edges: int, instants: int, repeats: bool) -> Room:
    """Memory for a block of machines with so many numbers, edges in a cycle and instants; whether cycles repeat."""
    laid, unknown = MOST_SLOTS if repeats else 1, task.stages * task.solved
    return Room(
        rows(numbers),
        rows(3),
        rows(len(Lane._fields)),
        rows(2 * edges),
        rows(max(instants, 1)),
        rows(task.width * max(len(task.nodes), task.stages + 1), aside=ASIDE),
        rows(2 * task.watched),
        rows(task.width),
        rows(task.width, aside=ASIDE),
        rows(task.width),
        rows(task.width),
        rows(task.width),
        rows((unknown * (unknown + 1) + task.stages * task.states if task.implicit else 0) + 2),
        rows(2 * (2 * task.width + 1)),
        rows(2 * (FIRST + task.guards)),
        rows(laid),
        rows(laid * (task.stages + 1) * max(task.places, 1)),
    )


class Printed(NamedTuple):
    """The printed functions of a system, and the memory of all tables."""

    places: Callable
    rates: Callable
    watch: Callable
    memory: np.ndarray


class WalkBatch(NamedTuple):
    """What a number of walks are given, and what comes of them.

    Attributes
    ----------
    memory : ndarray
        All tables.
    numbers : ndarray (numbers, variants)
        Those that are held are carried on.
    edges : ndarray (2 × edges, variants)
        Angles turned at the edges of a cycle, its begin and end among them, and their sides [rad].
    instants : ndarray (instants, variants)
    given : ndarray (GIVEN, variants)
    states : ndarray (width, variants)
        States and what is gathered at the begin; they are carried on.
    doubts : ndarray (width, variants)
        What these may be off by, carried on too.
    ending : ndarray (width, variants)
        Their rates at the end.
    found : ndarray (FOUND, variants)
    recorded : ndarray (steps, 3 + (states + 1) × (1 + places), variants)
        Of each step where it begins, its length and its way; of each state and of what is gathered first its polynomial
        and what it may be off by at the begin.
    """

    memory: np.ndarray
    numbers: np.ndarray
    edges: np.ndarray
    instants: np.ndarray
    given: np.ndarray
    states: np.ndarray
    doubts: np.ndarray
    ending: np.ndarray
    found: np.ndarray
    recorded: np.ndarray


rows_of = memory(one(Lane))


# A step


@inlined
def stand(share: float, stage: int, slot: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Put into P what a stage needs of its position and time; its place is filled anew where `slot` is negative."""
    own, position, state = rows_of(room.lane), in_lanes(room.position), in_lanes(room.numbers)
    first, count = task.first_place, task.places
    if slot < 0 and count > 0:
        for lane in range(LANES):
            turned = state[first + count, lane] if task.along_time else own.at[lane] + share * own.length[lane]
            turned = turned if turned < own.high[lane] else own.high[lane]
            turned = turned if turned > own.low[lane] else own.low[lane]
            position[0, lane] = own.start[lane] + own.direction[lane] * turned
        for lane in range(LANES):
            position[1, lane], position[2, lane] = direction_of(position[0, lane])
        tile = room.numbers[first : first + count].reshape(count, 1, LANES)
        printed.places(room.numbers, printed.memory, room.position[0:1], room.position[1:2], room.position[2:3], tile)
    elif count > 0:
        kept, at = in_lanes(room.places), (slot * (task.stages + 1) + stage) * count
        # Within the step nothing is watched.
        for i in range(count if stage == 0 or stage == task.stages else task.rated):
            for lane in range(LANES):
                state[first + i, lane] = kept[at + i, lane]
    if task.clock >= 0:
        for lane in range(LANES):
            now = own.clock[lane] + own.at[lane] + share * own.length[lane]
            now = now if now < own.ends[lane] else own.ends[lane]
            state[task.clock, lane] = now if now > own.begins[lane] else own.begins[lane]


@inlined
def rate(stage: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Rates of a stage."""
    if task.solves >= 0:
        solve_rates(stage, printed, task, room)
    else:
        fill_rates(stage, printed, task, room)


@routine
def solve_rates(stage: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Rates of a stage where a state's rate depends on itself, as friction does on the acceleration; by secants.

    Where no rate is found, it is NaN, and the step is refused.
    """
    own, row = rows_of(room.lane), task.first_place + task.places
    here, state = in_lanes(room.numbers)[row + task.states], in_lanes(room.numbers)[row + task.solves]
    found = in_lanes(room.rates)[stage * task.width + task.solves]
    # Behind the equations of an implicit step.
    last = room.equations.shape[0] - 1
    before, left_before = in_lanes(room.equations)[last - 1], in_lanes(room.equations)[last]
    for lane in range(LANES):
        here[lane] = here[lane] if abs(here[lane]) < math.inf else 0.0
    for turn in range(MOST_SECANTS):
        fill_rates(stage, printed, task, room)
        pending = False
        for lane in range(LANES):
            left = found[lane] - here[lane]
            gains = turn < SURE_SECANTS or abs(left) < abs(left_before[lane])
            if abs(left) > SOLVED_TO * (abs(found[lane]) + abs(here[lane])) and gains:
                pending = True
                secant = here[lane] - left * (here[lane] - before[lane]) / (left - left_before[lane])
                ahead = secant if turn > 0 and abs(secant) < math.inf else found[lane]
                before[lane], left_before[lane], here[lane] = here[lane], left, ahead
        if not pending:
            break
    for lane in range(LANES):
        off = own.length[lane] * abs(found[lane] - here[lane])
        sure = off <= NEARLY_FOUND * (abs(state[lane]) + own.length[lane] * abs(found[lane]))
        found[lane] = found[lane] if sure else math.nan


@inlined
def fill_rates(stage: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Rates of a stage from its state."""
    width = task.width
    filled_rows = room.rates[stage * width : (stage + 1) * width].reshape(width, 1, LANES)
    printed.rates(room.numbers, printed.memory, room.position[0:1], room.position[1:2], room.position[2:3], filled_rows)


@inlined
def look(end: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Watch the begin of a step, 0, or its end, 1."""
    count = task.watched
    filled_rows = room.watched[end * count : (end + 1) * count].reshape(count, 1, LANES)
    printed.watch(room.numbers, printed.memory, room.position[0:1], room.position[1:2], room.position[2:3], filled_rows)


@inlined
def keep_place(stage: int, task: WalkTask, room: Room) -> None:
    """Keep what a stage needs of its position, in the slot of the step that each lane tries."""
    own, kept, numbers = rows_of(room.lane), in_lanes(room.places), in_lanes(room.numbers)
    most = room.lengths.shape[0] - 1
    for lane in range(LANES):
        at = (min(max(int(own.kept[lane]), 0), most) * (task.stages + 1) + stage) * task.places
        for i in range(task.places):
            kept[at + i, lane] = numbers[task.first_place + i, lane]


@routine
def attempt(kept: int, keeps: bool, printed: Printed, task: WalkTask, room: Room) -> None:
    """Try a step in all lanes: its stages, its end and what it misses.

    From the places of slot `kept` where it isn't negative; else they are kept where it `keeps` them.
    """
    own, k, begin = rows_of(room.lane), in_lanes(room.rates), in_lanes(room.begin)
    after, errors = in_lanes(room.after), in_lanes(room.errors)
    state = in_lanes(room.numbers[task.first_place + task.places :])
    for q in range(task.states):
        for lane in range(LANES):
            state[q, lane] = begin[q, lane]
    if task.implicit:
        find_stages(printed, task, room)
    else:
        for s in range(task.stages):
            if s > 0:
                at_stage(task.method, s, task.states, task.width, begin, own.length, k, state)
            stand(task.nodes[s], s, kept, printed, task, room)
            rate(s, printed, task, room)
            if s == 0:
                look(0, printed, task, room)
            if keeps:
                keep_place(s, task, room)
    judged = task.width if task.carries else task.states
    step_end(task.method, judged, task.width, begin, own.length, k, after, errors)
    if task.implicit:
        count, first = task.stages * task.solved, 1 if task.along_time else 0
        for q in range(first, task.states, 2):
            last = in_lanes(room.equations)[count * (count + 1) + (task.stages - 1) * task.states + q]
            for lane in range(LANES):
                # The last stage is the end, without the rounding of a steep motor's moment.
                after[q, lane] = last[lane]
    for q in range(task.states):
        for lane in range(LANES):
            state[q, lane] = after[q, lane]
    stand(1.0, task.stages, kept, printed, task, room)
    if task.solves >= 0:
        rate(task.stages, printed, task, room)
    look(1, printed, task, room)
    if keeps:
        keep_place(task.stages, task, room)
    judge_steps(task, room)


@routine
def find_stages(printed: Printed, task: WalkTask, room: Room) -> None:
    """Find the stages of an implicit step by Newton's method; where it doesn't, the rates are NaN.

    Unknown is the energy in all stages, or are the speeds; angles follow from the speeds of the round before.
    """
    own, k, begin, equations = rows_of(room.lane), in_lanes(room.rates), in_lanes(room.begin), in_lanes(room.equations)
    watched, kept, worst = in_lanes(room.watched), in_lanes(room.places), in_lanes(room.errors)[0]
    numbers, stages, width, states = in_lanes(room.numbers), task.stages, task.width, task.states
    each, first = task.solved, 1 if task.along_time else 0
    count = stages * each
    found, slopes = count * (count + 1), task.watched + task.slopes
    stand(0.0, 0, -1, printed, task, room)
    if task.solves >= 0:
        rate(0, printed, task, room)
    look(0, printed, task, room)
    for lane in range(LANES):
        worst[lane] = math.inf
    for s in range(stages):
        for q in range(states):
            for lane in range(LANES):
                equations[found + s * states + q, lane] = begin[q, lane]
        if not task.along_time:
            stand(task.nodes[s], s, -1, printed, task, room)
            for i in range(task.places):
                for lane in range(LANES):
                    kept[s * task.places + i, lane] = numbers[task.first_place + i, lane]
    for turn in range(MOST_ROUNDS):
        if task.along_time and turn > 0:
            turn_stages(task, room)
        for s in range(stages):
            rate_found(s, printed, task, room)
            look(1, printed, task, room)
            for r in range(stages):
                share = task.matrix[r, s]
                for i in range(each):
                    for j in range(each):
                        row, column = r * each + i, s * each + j
                        same = 1.0 if row == column else 0.0
                        for lane in range(LANES):
                            slope = share * own.length[lane] * watched[slopes + i * each + j, lane]
                            equations[row * (count + 1) + column, lane] = same - slope
        for s in range(stages):
            for i in range(each):
                at, q = (s * each + i) * (count + 1) + count, first + 2 * i
                for lane in range(LANES):
                    equations[at, lane] = begin[q, lane] - equations[found + s * states + q, lane]
                for r in range(stages):
                    for lane in range(LANES):
                        equations[at, lane] += task.matrix[s, r] * own.length[lane] * k[r * width + q, lane]
        eliminate(count, equations)
        pending = False
        for lane in range(LANES):
            # Others may need more rounds.
            own.able[lane] = 1.0 if worst[lane] > FOUND_TO else 0.0
            worst[lane] = 0.0 if worst[lane] > FOUND_TO else worst[lane]
        for s in range(stages):
            for i in range(each):
                at, q = (s * each + i) * (count + 1) + count, found + s * states + first + 2 * i
                for lane in range(LANES):
                    by, before, whole = equations[at, lane], equations[q, lane], 0.0
                    for j in range(each):
                        whole += equations[found + s * states + first + 2 * j, lane]
                    by = by if own.able[lane] > 0.0 else 0.0
                    size = abs(by) / whole
                    worst[lane] = worst[lane] if worst[lane] > size else size
                    left = LEAST_LEFT * before
                    equations[q, lane] = before + by if before + by > left else left
        for lane in range(LANES):
            pending |= own.length[lane] > 0.0 and worst[lane] > FOUND_TO
        if not pending:
            break
    for s in range(stages):
        rate_found(s, printed, task, room)
    for lane in range(LANES):
        end = (stages - 1) * width + first
        k[end, lane] = k[end, lane] if worst[lane] <= NEARLY_FOUND else math.nan
    if task.along_time:
        rise_stages(task, room)


@routine
def turn_stages(task: WalkTask, room: Room) -> None:
    """Angles in the stages of an implicit step along time, by the rates found for them."""
    own, k, begin, equations = rows_of(room.lane), in_lanes(room.rates), in_lanes(room.begin), in_lanes(room.equations)
    count, stages = task.stages * task.solved, task.stages
    for s in range(stages):
        for q in range(0, task.states, 2):
            angle = equations[count * (count + 1) + s * task.states + q]
            for lane in range(LANES):
                angle[lane] = begin[q, lane]
            for r in range(stages):
                for lane in range(LANES):
                    angle[lane] += task.matrix[s, r] * own.length[lane] * k[r * task.width + q, lane]


@routine
def rise_stages(task: WalkTask, room: Room) -> None:
    """Accelerations in the stages of an implicit step from the speeds there: of a steep coupling these are surer."""
    own, k, begin, equations = rows_of(room.lane), in_lanes(room.rates), in_lanes(room.begin), in_lanes(room.equations)
    count, stages, sure = task.stages * task.solved, task.stages, in_lanes(room.errors)[1]
    for q in range(1, task.states, 2):
        for s in range(stages):
            for lane in range(LANES):
                sure[lane] = 0.0
            for r in range(stages):
                found = equations[count * (count + 1) + r * task.states + q]
                for lane in range(LANES):
                    sure[lane] += task.inverse[s, r] * (found[lane] - begin[q, lane])
            rise = k[s * task.width + q]
            for lane in range(LANES):
                rise[lane] = sure[lane] / own.length[lane] if rise[lane] == rise[lane] else math.nan


@inlined
def rate_found(stage: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Rates of a stage of an implicit step in the state that was found for it."""
    kept, numbers, count = in_lanes(room.places), in_lanes(room.numbers), task.stages * task.solved
    state, own = task.first_place + task.places, in_lanes(room.equations)
    found = count * (count + 1) + stage * task.states
    for q in range(task.states):
        for lane in range(LANES):
            numbers[state + q, lane] = own[found + q, lane]
    if task.along_time:
        stand(task.nodes[stage], stage, -1, printed, task, room)
    else:
        for i in range(task.places):
            for lane in range(LANES):
                numbers[task.first_place + i, lane] = kept[stage * task.places + i, lane]
    rate(stage, printed, task, room)


@routine
def eliminate(count: int, equations: Rows) -> None:
    """Solve linear equations by Gauss' elimination; the solution is where the right-hand sides were."""
    for pivot in range(count):
        own = pivot * (count + 1)
        for k in range(pivot + 1, count + 1):
            for lane in range(LANES):
                equations[own + k, lane] /= equations[own + pivot, lane]
        for s in range(count):
            row = s * (count + 1)
            for k in range(pivot + 1, count + 1 if s != pivot else 0):
                for lane in range(LANES):
                    equations[row + k, lane] -= equations[row + pivot, lane] * equations[own + k, lane]


@routine
def judge_steps(task: WalkTask, room: Room) -> None:
    """What the step misses, by what it may.

    Along the angle that is a share of the greatest work of a step and of the time of a cycle; along time, of the scales
    of the system, or of the angle turned, and of the speed or its change.
    """
    own, k, begin = rows_of(room.lane), in_lanes(room.rates), in_lanes(room.begin)
    after, errors, width = in_lanes(room.after), in_lanes(room.errors), task.width
    cycle = task.cycle if task.cycle < math.inf else 2.0 * math.pi
    watched, count = in_lanes(room.watched), task.watched
    rounded = max(ROUNDED, 4.0 * FOUND_TO if task.implicit else 0.0)
    for lane in range(LANES):
        own.missed[lane] = 0.0
    judged = task.states if task.along_time else task.states + 1
    for lane in range(LANES if task.implicit and not task.along_time else 0):
        # A steep motor takes back the rest of an implicit step's error. Source: E. Hairer and G. Wanner, Solving
        # Ordinary Differential Equations II, section IV.8.
        fades = -own.length[lane] * watched[count + STEEPNESS, lane]
        errors[0, lane] /= 1.0 + (OWN_SHARE * fades if fades > 0.0 else 0.0)
    for q in range(0 if task.fixed else judged):
        if not task.along_time and q == 0:
            for lane in range(LANES):
                size = (
                    watched[SIZE, lane]
                    if watched[SIZE, lane] > watched[count + SIZE, lane]
                    else watched[count + SIZE, lane]
                )
                size *= own.length[lane]
                # A step that isn't taken says nothing of the works of those that are.
                own.work[lane] = size if size > own.scale[lane] else own.scale[lane]
                own.size[lane] = own.work[lane]
        elif not task.along_time:
            for lane in range(LANES):
                # Of time, what a cycle takes at this speed.
                own.size[lane] = cycle * k[q, lane]
        elif task.scales >= 0:
            for lane in range(LANES):
                own.size[lane] = watched[task.scales + q, lane]
        else:
            for lane in range(LANES):
                own.size[lane] = abs(begin[q, lane]) if q % 2 == 1 or task.signed else 0.0
                own.size[lane] = (
                    own.size[lane] if own.size[lane] > own.floor[lane] or not task.signed else own.floor[lane]
                )
            for s in range(task.stages):
                for lane in range(LANES):
                    made = abs(own.length[lane] * k[s * width + q, lane])
                    own.size[lane] = made if made > own.size[lane] else own.size[lane]
        for lane in range(LANES):
            off = abs(errors[q, lane]) / (own.tolerance[lane] * own.size[lane] + rounded * abs(begin[q, lane]))
            # What doesn't move at all misses nothing.
            off = off if errors[q, lane] != 0.0 else 0.0
            own.missed[lane] = off if off > own.missed[lane] or off != off else own.missed[lane]
    for q in range(width):
        for lane in range(LANES):
            own.missed[lane] = own.missed[lane] if abs(after[q, lane]) < math.inf else math.inf
    for lane in range(LANES if task.along_time else 0):
        # Beyond what a step may turn its estimate is blind.
        far = abs(after[0, lane] - begin[0, lane]) > TOO_FAR * own.farthest[lane]
        own.missed[lane] = math.inf if far else own.missed[lane]
    for q in range(1, task.states if task.along_time and not task.signed else 0, 2):
        for lane in range(LANES):
            # What sets off from rest may not come back to it within a step.
            back = begin[q, lane] <= 0.0 and after[q, lane] <= 0.0 and k[q, lane] != 0.0
            own.missed[lane] = math.inf if back else own.missed[lane]
    for lane in range(LANES):
        steep, end = abs(own.length[lane] * watched[STEEPNESS, lane]) > task.steepest, watched[count + SLOPE, lane]
        sound = own.missed[lane] == own.missed[lane] and end == end
        sound = sound and not (steep and not (task.fixed or task.implicit))
        own.missed[lane] = own.missed[lane] if sound else math.inf


# Edges: angles at which something jumps or bends


@inlined
def look_ahead(lane: int, count: int, room: Room) -> None:
    """Between which angles a lane's step looks: no nearer to either edge than its side."""
    own, edges, sides = rows_of(room.lane), in_lanes(room.edges), in_lanes(room.edges[count:])
    k = int(own.edge[lane])
    low, high = edges[k, lane] + sides[k, lane], edges[k + 1, lane] - sides[k + 1, lane]
    middle = 0.5 * (edges[k, lane] + edges[k + 1, lane])
    own.low[lane] = own.base[lane] + (low if low < middle else middle)
    own.high[lane] = own.base[lane] + (high if high > middle else middle)


@inlined
def edge_ahead(lane: int, room: Room) -> float:
    """Angle turned at the edge ahead of a lane."""
    own = rows_of(room.lane)
    return own.base[lane] + in_lanes(room.edges)[int(own.edge[lane]) + (1 if own.facing[lane] > 0.0 else 0), lane]


@inlined
def pass_edge(lane: int, count: int, task: WalkTask, room: Room) -> bool:
    """Go on behind the edge ahead of a lane; false where the range ends there."""
    own, edges = rows_of(room.lane), in_lanes(room.edges)
    way, k = (1 if own.facing[lane] > 0.0 else -1), int(own.edge[lane])
    for _ in range(count + 1):
        k += way
        if k < 0 or k + 1 >= count:
            if not task.cycle < math.inf:
                return False
            own.base[lane] += way * task.cycle
            k = 0 if way > 0 else count - 2
        if edges[k + 1, lane] > edges[k, lane]:
            break
    own.edge[lane] = float(k)
    return True


@inlined
def find_edge(lane: int, count: int, task: WalkTask, room: Room) -> None:
    """Find between which edges a lane is; at an edge, on the side that it faces."""
    own, edges = rows_of(room.lane), in_lanes(room.edges)
    cycle, way = task.cycle, own.facing[lane]
    near = way * ROUNDED * (abs(own.turned[lane]) + (cycle if cycle < math.inf else 0.0))
    own.base[lane] = math.floor((own.turned[lane] + near) / cycle) * cycle if cycle < math.inf else 0.0
    within, k = own.turned[lane] - own.base[lane] + near, 0
    while k + 2 < count and edges[k + 1, lane] < within:
        k += 1
    own.edge[lane] = float(k)


@inlined
def next_instant(lane: int, count: int, room: Room) -> float:
    """The next instant at which something over time jumps or bends; between two of them a step looks."""
    own, instants = rows_of(room.lane), in_lanes(room.instants)
    now = own.clock[lane] + own.at[lane]
    now += ROUNDED * abs(now)
    before, after = -math.inf, math.inf
    for i in range(count):
        x = instants[i, lane]
        if x > now:
            after = x if x < after else after
        elif x <= now:
            before = x if x > before else before
    own.begins[lane], own.ends[lane] = before, after
    return after


# Lengths of steps, and what they come to


@routine
def choose(edges: int, instants: int, most_steps: int, task: WalkTask, room: Room) -> bool:
    """Length of each lane's next step: an equal part of the way to what ends it; 0 where it goes no farther.

    Whether any lane makes a step.
    """
    own, state, goes = rows_of(room.lane), in_lanes(room.begin), False
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
            most = most if most < own.longest[lane] else own.longest[lane]
        else:
            until, most = min(until, edge_ahead(lane, room)), min(most, own.farthest[lane])
        rest = until - own.at[lane]
        # Nobody counts the steps of a way without an end.
        parts = math.ceil(rest / most * (1.0 - 1e-9)) if rest < MOST_PARTS * most else 0
        if task.along_time and task.longer == 1.0 and own.steps[lane] == 0.0:
            # A walk that a single step could make is made in two.
            parts = parts if parts != 1 else 2
        own.length[lane] = most if parts == 0 else (rest / parts if parts > 1 else rest)
        if not own.length[lane] > 0.0:
            # From a state that isn't finite no step leads on.
            own.length[lane], own.why[lane] = 0.0, LOST
    return goes


@inlined
def next_root(lane: int, task: WalkTask, room: Room) -> float:
    """Length of the step to the first root between two, by the straight line; the longer one once it is known.

    Extremes of the speed by the cubic of its values and slopes.
    """
    own, guards, count = rows_of(room.lane), in_lanes(room.guards), FIRST + task.guards
    short, long = own.short[lane], own.long[lane]
    best = long
    if long - short > task.root * long and own.trials[lane] <= MOST_TRIALS:
        for g in range(count):
            near, far = guards[g, lane], guards[count + g, lane]
            if near > 0.0 and far <= 0.0:
                share = top_between(near, far, lane, room) if g == RISE else near / (near - far)
                # What begins at its zero, or has just set in, is next to nothing there, wherever it vanishes.
                share = LEAP if g != RISE and short == 0.0 and share < NEXT_TO_NOTHING else share
                # Beyond the root rather than before it.
                root = short + (long - short) * share + 0.5 * task.root * long
                best = root if root < best else best
    return best


@inlined
def top_between(leaves: float, comes: float, lane: int, room: Room) -> float:
    """Share of the way between two lengths at which the speed is extreme, by its slopes towards the extreme there.

    Source: Hermite's cubic, whose slope is a quadratic with one root between slopes of different signs.
    """
    own, watched = rows_of(room.lane), in_lanes(room.watched)
    way = own.long[lane] - own.short[lane]
    a, b = leaves * way, comes * way
    c = math.copysign(1.0, watched[SLOPE, lane]) * (own.long_speed[lane] - own.short_speed[lane])
    linear, squared = 6.0 * c - 4.0 * a - 2.0 * b, 3.0 * (a + b) - 6.0 * c
    share = 2.0 * a / (math.sqrt(max(linear * linear - 4.0 * squared * a, 0.0)) - linear)
    # The second trial closes in on it from the other side.
    overshoot = BEYOND if own.trials[lane] != 2.0 else BEHIND * (share if own.side[lane] < 0.0 else share - 1.0)
    share += overshoot
    return share if 0.0 < share < 1.0 else 0.5


@inlined
def speed_slope(lane: int, end: int, task: WalkTask, room: Room) -> float:
    """Derivative of the speed along the way, at the begin of a step, 0, or its end, 1; dω/dφ = ω/(2E) · I ω dω/dφ."""
    watched, energy = in_lanes(room.watched), in_lanes(room.begin) if end == 0 else in_lanes(room.after)
    slope, speed = watched[end * task.watched + SLOPE, lane], watched[end * task.watched + SPEED, lane]
    return slope if task.along_time else 0.5 * slope * speed / energy[0, lane]


@inlined
def guard(g: int, lane: int, end: int, task: WalkTask, room: Room) -> float:
    """A guard of a lane at the begin of a step, 0, or at its end, 1."""
    own, watched = rows_of(room.lane), in_lanes(room.watched)
    states = in_lanes(room.begin) if end == 0 else in_lanes(room.after)
    row = end * task.watched
    if g == EDGE:
        return (edge_ahead(lane, room) - states[0, lane]) * own.facing[lane] if task.along_time else 1.0
    if g == OTHER:
        if task.along_time:
            return (own.other_goal[lane] - states[0, lane]) * own.facing[lane]
        return own.other_goal[lane] - states[task.states, lane]
    if g == RISE:
        slope, last = watched[SLOPE, lane], task.states - 1
        # Of a motion in balance, the slope's sign is that of rounding.
        off = FOUND_TO * abs(in_lanes(room.begin)[last, lane])
        unsure = ROUNDED * watched[SIZE, lane] + abs(watched[STEEPNESS, lane]) * off
        sense = math.copysign(1.0, slope) if abs(slope) > unsure else 0.0
        return sense * speed_slope(lane, end, task, room) if task.extremes else 1.0
    return watched[row + task.watched - task.guards + g - FIRST, lane]


@inlined
def is_crossed(g: int, lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a guard vanishes within a step; where guards change what is held, a step may begin at the zero of one."""
    near, far = guard(g, lane, 0, task, room), guard(g, lane, 1, task, room)
    return (near > 0.0 and not far > 0.0) or (near == 0.0 and far < 0.0 and task.held.shape[0] > 0)


@routine
def fires(rises: bool, task: WalkTask, room: Room) -> None:
    """In which lanes a guard that is positive at the begin of the step isn't at its end, into the row `fired`.

    Extremes of the speed count where it `rises`.
    """
    own = rows_of(room.lane)
    for lane in range(LANES):
        own.fired[lane] = 0.0
    for g in range(FIRST + task.guards):
        if (g != EDGE or task.along_time) and (g != RISE or rises):
            for lane in range(LANES):
                crossed = is_crossed(g, lane, task, room) and (
                    g != RISE or own.trials[lane] > 0.0 or may_exceed(lane, task, room)
                )
                own.fired[lane] = 1.0 if crossed else own.fired[lane]


@inlined
def may_exceed(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether an extreme of the speed within the step may lie beyond all before it, or where a guard ends the step.

    It lies about within the triangle of the chord and the tangents at its ends, and surely within twice its height.
    """
    own, watched = rows_of(room.lane), in_lanes(room.watched)
    near, far = watched[SPEED, lane], watched[task.watched + SPEED, lane]
    leaves, comes = speed_slope(lane, 0, task, room), speed_slope(lane, 1, task, room)
    # Where the tangents meet.
    top = near + leaves * (far - near - comes * own.length[lane]) / (leaves - comes)
    end = max(near, far) if leaves > 0.0 else min(near, far)
    beyond = top - end if leaves > 0.0 else end - top
    # Where it isn't beyond both ends, a steep motor bends the speed in some other way.
    if not beyond >= 0.0:
        return True
    for g in range(task.guards):
        first, last = guard(FIRST + g, lane, 0, task, room), guard(FIRST + g, lane, 1, task, room)
        if not task.ends[g] and first > 0.0 and not min(first, last) > 2.0 * beyond:
            return True
    return top + beyond > own.fastest[lane] if leaves > 0.0 else top - beyond < own.slowest[lane]


@routine
def decide_steps(task: WalkTask, room: Room) -> bool:
    """In which lanes the step is taken, into the row `taken`; in others another length is tried. Whether in any."""
    own, took = rows_of(room.lane), False
    fires(task.extremes, task, room)
    for lane in range(LANES):
        own.taken[lane] = 0.0
        if own.length[lane] > 0.0:
            if not own.missed[lane] <= 1.0 and not is_rounding(lane, room):
                shorten(lane, task, room)
            elif (own.fired[lane] == 0.0 and own.trials[lane] == 0.0) or narrow(lane, task, room):
                own.taken[lane], took = 1.0, True
    return took


@inlined
def is_rounding(lane: int, room: Room) -> bool:
    """Whether rounding alone is what a step misses: so little, and no less than when a longer one was refused."""
    own = rows_of(room.lane)
    before, own.refused[lane] = own.refused[lane], own.missed[lane]
    rounding = own.missed[lane] * own.tolerance[lane] <= NOISE and own.missed[lane] >= FALLS * before
    if rounding:
        own.missed[lane] = FORGIVEN
    return rounding


@inlined
def narrow(lane: int, task: WalkTask, room: Room) -> bool:
    """Narrow down the root of a guard in a lane; true where the step ends at it.

    Source: N. Anderson and Å. Björck, A new high order method of regula falsi type, BIT 13 (1973).
    """
    own, guards, count = rows_of(room.lane), in_lanes(room.guards), FIRST + task.guards
    length, fired, watched = own.length[lane], own.fired[lane] > 0.0, in_lanes(room.watched)
    if own.trials[lane] == 0.0:
        own.short[lane], own.long[lane], own.side[lane] = 0.0, length, 0.0
        own.short_speed[lane] = watched[SPEED, lane]
        for g in range(count):
            near = guard(g, lane, 0, task, room)
            guards[g, lane] = TINY if near == 0.0 and task.held.shape[0] > 0 else near
    if fired and own.trials[lane] > 0.0 and (beyond_root(lane, task, room) or is_flat(lane, task, room)):
        return True
    side = 1.0 if fired else -1.0
    again = own.side[lane] == side
    for g in range(count):
        # The end that stays counts less, the other one is new; slopes are what they are.
        here, same, other = guard(g, lane, 1, task, room), g + (count if fired else 0), g + (0 if fired else count)
        less = 1.0 - here / guards[same, lane]
        guards[other, lane] *= (less if less > 0.0 else 0.5) if again and g != RISE else 1.0
        guards[same, lane] = here if fired or guards[same, lane] > 0.0 else guards[same, lane]
    speed = watched[task.watched + SPEED, lane]
    if fired:
        own.long[lane], own.long_speed[lane] = length, speed
    else:
        own.short[lane], own.short_speed[lane] = length, speed
    own.side[lane] = side
    own.trials[lane] += 1.0
    return False


@inlined
def beyond_root(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a step that ends beyond the roots of guards ends at the first of them, by the straight line."""
    own, guards = rows_of(room.lane), in_lanes(room.guards)
    length, off = own.length[lane], 0.0
    for g in range(FIRST + task.guards):
        near, far = guards[g, lane], guard(g, lane, 1, task, room)
        if near > 0.0 and not far > 0.0:
            share = far / (far - near)
            off = share if not share <= off else off
    return length >= own.long[lane] or off * (length - own.short[lane]) <= task.root * length


@inlined
def is_flat(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether nothing but an extreme of the speed ends the step, and it is as good as met."""
    watched, end = in_lanes(room.watched), task.watched
    for g in range(FIRST + task.guards):
        if g != RISE and is_crossed(g, lane, task, room):
            return False
    return abs(watched[end + SLOPE, lane]) <= FLAT * (abs(watched[SLOPE, lane]) + watched[SIZE, lane])


@inlined
def is_short(length: float, lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a step turns so little that an implicit one is worth its price."""
    own = rows_of(room.lane)
    turns = length * abs(in_lanes(room.begin)[1, lane]) if task.along_time else length
    return turns < WORTH_SOLVING * own.farthest[lane]


@inlined
def shorten(lane: int, task: WalkTask, room: Room) -> None:
    """Choose a shorter step in a lane that misses too much; it is lost where none is short enough."""
    own, watched = rows_of(room.lane), in_lanes(room.watched)
    length, share = own.length[lane], SHRINK
    if own.missed[lane] < math.inf:
        share = SAFETY / math.sqrt(math.sqrt(math.sqrt(own.missed[lane])))
        share = share if share > SHRINK else SHRINK
    fades = 0.0 if task.implicit else abs(length * watched[STEEPNESS, lane])
    steepest = task.steepest
    if fades > steepest:
        share = max(SHRINK, SAFETY * steepest / fades)
    own.pace[lane], own.trials[lane] = length * share, 0.0
    least = SHORTEST * (abs(own.at[lane]) + (LEAST_TIME if task.along_time else own.farthest[lane]))
    worth_solving = fades > steepest and task.solved > 0 and is_short(length * share, lane, task, room)
    if worth_solving or not length * share > least:
        own.why[lane] = STEEP if fades > steepest and task.solved > 0 else LOST


@routine
def carry_errors(task: WalkTask, room: Room) -> None:
    """Carry over the step what the energy and what is gathered may be off by, and add what the step may be off by.

    What the energy is off by grows or fades as neighbouring motions part or meet, by e^∫∂M/∂E dφ; what is gathered
    follows by its derivative. Every step rounds. All are magnitudes: nothing makes up for another. Source: E. Hairer,
    S. P. Nørsett and G. Wanner, Solving Ordinary Differential Equations I, section I.14.
    """
    own, watched = rows_of(room.lane), in_lanes(room.watched)
    doubts, errors, begin, end = in_lanes(room.doubts), in_lanes(room.errors), in_lanes(room.begin), task.watched
    most, rounded = (-3.0, 4.0 * FOUND_TO) if task.implicit else (-1.0, 0.25 * EPS)
    for lane in range(LANES):
        grows = 0.5 * own.length[lane] * (watched[STEEPNESS, lane] + watched[end + STEEPNESS, lane])
        # A step forgets no more than its method does.
        grows = grows if grows > most else most
        own.doubt[lane] = doubts[0, lane]
        step = abs(errors[0, lane]) + rounded * begin[0, lane]
        after = own.doubt[lane] * exponential(grows) + step
        doubts[0, lane] = after if own.taken[lane] > 0.0 else doubts[0, lane]
    for q in range(1, task.width):
        row = RESPONSES + q - 1
        for lane in range(LANES):
            follows = abs(watched[row, lane]) * own.doubt[lane] + abs(watched[end + row, lane]) * doubts[0, lane]
            more = doubts[q, lane] + 0.5 * own.length[lane] * follows + abs(errors[q, lane])
            doubts[q, lane] = more if own.taken[lane] > 0.0 else doubts[q, lane]


@routine
def advance(task: WalkTask, room: Room) -> None:
    """Take over the states at the end of the step in lanes that take it."""
    own, watched, begin, after = rows_of(room.lane), in_lanes(room.watched), in_lanes(room.begin), in_lanes(room.after)
    row, doubts = task.watched + SPEED, in_lanes(room.doubts)
    if task.carries:
        carry_errors(task, room)
    for q in range(task.width):
        for lane in range(LANES):
            begin[q, lane] = after[q, lane] if own.taken[lane] > 0.0 else begin[q, lane]
    for lane in range(LANES):
        speed, took = watched[row, lane], own.taken[lane] > 0.0
        off = 0.5 * speed * doubts[0, lane] / begin[0, lane] if task.carries else math.nan
        slower, faster = took and speed < own.slowest[lane], took and speed > own.fastest[lane]
        own.slowest[lane] = speed if slower else own.slowest[lane]
        own.slow_off[lane] = off if slower else own.slow_off[lane]
        own.fastest[lane] = speed if faster else own.fastest[lane]
        own.fast_off[lane] = off if faster else own.fast_off[lane]
        own.slope[lane] = watched[task.watched + SLOPE, lane] if took else own.slope[lane]
        own.scale[lane] = own.work[lane] if took else own.scale[lane]
        own.steps[lane] += own.taken[lane]


@inlined
def switches(lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a guard that doesn't end the walk ended a lane's step."""
    if rows_of(room.lane).trials[lane] > 0.0:
        for g in range(task.guards):
            if not task.ends[g] and is_crossed(FIRST + g, lane, task, room):
                return True
    return False


@inlined
def switch(lane: int, task: WalkTask, room: Room) -> None:
    """Change what a lane holds to what it is behind the guard that ended its step."""
    watched, numbers, begin = in_lanes(room.watched), in_lanes(room.numbers), in_lanes(room.begin)
    first, count = task.first_place + task.places, task.held.shape[0]
    for i in range(count):
        row, value = task.held[i], watched[2 * task.watched - task.guards - count + i, lane]
        if row < first:
            numbers[row, lane] = value
        else:
            begin[row - first, lane] = value


@routine
def take(edges: int, task: WalkTask, room: Room) -> None:
    """Take the step in lanes that do, and see what ends there."""
    own, begin, watched = rows_of(room.lane), in_lanes(room.begin), in_lanes(room.watched)
    k, ending, last = in_lanes(room.rates), in_lanes(room.ending), (task.stages - 1) * task.width
    for q in range(task.width):
        for lane in range(LANES):
            # The last stage stands at the end of the step.
            ending[q, lane] = k[last + q, lane] if own.taken[lane] > 0.0 else ending[q, lane]
    for lane in range(LANES):
        own.ended[lane] = -1.0
        if own.taken[lane] > 0.0 and own.trials[lane] > 0.0:
            for g in range(FIRST + task.guards):
                # An extreme of the speed ends nothing but the step.
                if g == RISE and own.ended[lane] >= 0.0:
                    continue
                if is_crossed(g, lane, task, room) and (g < FIRST or task.ends[g - FIRST]):
                    own.ended[lane] = float(g)
    advance(task, room)
    for lane in range(LANES):
        if own.taken[lane] == 0.0:
            continue
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
        if switches(lane, task, room):
            switch(lane, task, room)
        if own.ended[lane] == OTHER or own.ended[lane] >= FIRST:
            own.why[lane] = OTHER_GOAL if own.ended[lane] == OTHER else GUARD + own.ended[lane] - FIRST
        speed = watched[task.watched + SPEED, lane]
        if task.along_time and not task.signed and own.why[lane] == GOING and 0.0 < speed < own.floor[lane]:
            own.why[lane] = FADED
        own.trials[lane], own.refused[lane] = 0.0, math.inf
        if task.fixed:
            own.pace[lane] = own.farthest[lane]
        else:
            share = SAFETY / math.sqrt(math.sqrt(math.sqrt(own.missed[lane])))
            ahead = own.length[lane] * (share if share < GROW else GROW)
            own.pace[lane] = ahead if ahead > own.pace[lane] else own.pace[lane]
            fades = own.pace[lane] * abs(watched[task.watched + STEEPNESS, lane])
            short = own.steps[lane] > MANY and is_short(own.pace[lane], lane, task, room)
            if own.why[lane] == GOING and short and fades > FADES and task.solved > 0 and not task.implicit:
                own.why[lane] = STEEP


@routine
def record(first: int, printed: Printed, recorded: np.ndarray, task: WalkTask, room: Room) -> None:
    """Write down the steps of lanes that take one: where each begins, its length, and its polynomial at some places."""
    own, k, begin = rows_of(room.lane), in_lanes(room.rates), in_lanes(room.begin)
    state, dense = in_lanes(room.numbers[task.first_place + task.places :]), task.nodes.shape[0]
    doubts = in_lanes(room.doubts)
    for s in range(task.stages, dense):
        at_stage(task.method, s, task.states, task.width, begin, own.length, k, state)
        stand(task.nodes[s], s, -1, printed, task, room)
        rate(s, printed, task, room)
    for lane in range(LANES):
        if own.taken[lane] == 0.0 or first + lane >= recorded.shape[2]:
            continue
        i, v, shown = int(own.steps[lane]), first + lane, task.shown.shape[0]
        recorded[i, 0, v], recorded[i, 1, v], recorded[i, 2, v] = own.at[lane], own.length[lane], own.facing[lane]
        # There may be nothing that is gathered.
        for q in range(min(task.states + 1, task.width)):
            at = 3 + q * (shown + 1)
            recorded[i, at + shown, v] = doubts[q, lane]
            for j in range(shown):
                theta, value, factor = task.shown[j], 0.0, 1.0
                for p in range(task.parts.shape[0]):
                    factor *= theta if p % 2 == 0 else 1.0 - theta
                    part = 0.0
                    for s in range(dense):
                        part += task.parts[p, s] * k[s * task.width + q, lane]
                    value += factor * part
                recorded[i, at + j, v] = begin[q, lane] + own.length[lane] * value


# The walk


@routine
def lay(first: int, printed: Printed, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Make new steps: those of a cycle, which are kept, in lanes with several ahead; all in others.

    Whatever a lane does depends on itself alone.
    """
    own, slots = rows_of(room.lane), room.lengths.shape[0]
    for lane in range(LANES):
        several = slots > 1 and own.at[lane] + (cycles_ahead(task) + 1.0) * task.cycle <= own.goal[lane]
        later = own.at[lane] < own.free[lane]
        own.halt[lane] = own.free[lane] if later else own.at[lane] + task.cycle if several else math.inf
        own.kept[lane] = 0.0 if several and not later else -1.0
    lay_steps(first, printed, batch, task, room)


@routine
def lay_steps(first: int, printed: Printed, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Make new steps as far as each lane is to go; they are kept in lanes that keep them."""
    own, lengths = rows_of(room.lane), in_lanes(room.lengths)
    slots, edges, records = room.lengths.shape[0], batch.edges.shape[0] // 2, batch.recorded.shape[0] > 0
    most_steps = batch.recorded.shape[0] if records else MOST_STEPS
    while choose(edges, batch.instants.shape[0], most_steps, task, room):
        keeps = False
        for lane in range(LANES):
            keeps |= own.kept[lane] >= 0.0 and own.length[lane] > 0.0
        attempt(-1, keeps, printed, task, room)
        took = decide_steps(task, room)
        if records and took:
            record(first, printed, batch.recorded, task, room)
        for lane in range(LANES if keeps else 0):
            if own.taken[lane] > 0.0 and own.kept[lane] >= 0.0:
                slot = int(own.kept[lane])
                if slot < slots:
                    lengths[slot, lane] = own.length[lane]
                    own.kept[lane] += 1.0
                else:
                    own.halt[lane], own.kept[lane] = math.inf, -1.0
        take(edges, task, room)


@inlined
def cycles_ahead(task: WalkTask) -> float:
    """How many cycles a lane has ahead that repeats one."""
    return (2.0 if task.extremes else 1.0) - NEARLY


@inlined
def remember(first: bool, lane: int, task: WalkTask, room: Room) -> None:
    """Remember where a lane begins a cycle, and where it began the one before, if that isn't the `first`."""
    own, before, width = rows_of(room.lane), in_lanes(room.before), task.width
    begin, doubts, one = in_lanes(room.begin), in_lanes(room.doubts), 2 * task.width + 1
    for i in range(one):
        now = own.at[lane] if i == 2 * width else begin[i, lane] if i < width else doubts[i - width, lane]
        before[i, lane] = now if first else before[one + i, lane]
        before[one + i, lane] = now


@inlined
def go_back(lane: int, task: WalkTask, room: Room) -> None:
    """Go back to where a lane began the cycle before; its steps are made anew up to the end of the one it left."""
    own, before, width = rows_of(room.lane), in_lanes(room.before), task.width
    begin, doubts = in_lanes(room.begin), in_lanes(room.doubts)
    for i in range(width):
        begin[i, lane], doubts[i, lane] = before[i, lane], before[width + i, lane]
    own.at[lane], own.free[lane] = before[2 * width, lane], before[4 * width + 1, lane] + task.cycle


@routine
def repeat(printed: Printed, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Repeat the steps of a cycle in lanes that have one ahead, as long as they miss little enough.

    Speeds over the angle of a motion and of the same one a cycle later never cross. So the extremes of a walk are those
    of its first and its last cycle, whose steps are made anew.
    """
    own, first = rows_of(room.lane), True
    while True:
        able, slots = 0, 0
        for lane in range(LANES):
            whole = own.why[lane] == GOING and own.at[lane] >= own.halt[lane] and own.kept[lane] > 0.0
            whole = whole and own.at[lane] + cycles_ahead(task) * task.cycle <= own.goal[lane]
            own.able[lane] = 1.0 if whole else 0.0
            able += 1 if whole else 0
            slots = max(slots, int(own.kept[lane]) if whole else 0)
        if able == 0:
            break
        for lane in range(LANES if task.extremes else 0):
            if own.able[lane] > 0.0:
                remember(first, lane, task, room)
        first = False
        repeat_steps(slots, printed, task, room)
        for lane in range(LANES):
            if own.able[lane] > 0.0:
                own.halt[lane] += task.cycle
                own.at[lane], own.base[lane] = own.halt[lane], own.base[lane] + task.cycle
                if own.at[lane] >= own.goal[lane] - NEARLY * task.cycle:
                    own.at[lane], own.why[lane] = own.goal[lane], GOAL
                own.turned[lane] = own.at[lane]
            elif own.why[lane] == GOING and own.at[lane] != own.turned[lane]:
                # It left its steps on the way; new ones begin from there.
                if task.extremes:
                    go_back(lane, task, room)
                own.turned[lane], own.halt[lane] = own.at[lane], math.inf
                find_edge(lane, batch.edges.shape[0] // 2, task, room)
            elif own.why[lane] == GOING:
                own.halt[lane] = math.inf


@routine
def repeat_steps(slots: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Repeat the steps that are kept in lanes that are able to; they no longer are where one misses too much."""
    own, lengths = rows_of(room.lane), in_lanes(room.lengths)
    for lane in range(LANES):
        own.worst[lane] = 0.0
    for slot in range(slots):
        for lane in range(LANES):
            goes = own.able[lane] > 0.0 and slot < own.kept[lane]
            own.length[lane] = lengths[slot, lane] if goes else 0.0
        attempt(slot, False, printed, task, room)
        fires(False, task, room)
        for lane in range(LANES):
            sound = own.length[lane] == 0.0 or (own.missed[lane] <= ROUGHLY and own.fired[lane] == 0.0)
            own.able[lane] = own.able[lane] if sound else 0.0
            own.taken[lane] = own.able[lane] if own.length[lane] > 0.0 else 0.0
            missed = own.missed[lane] if own.taken[lane] > 0.0 else 0.0
            own.worst[lane] = missed if missed > own.worst[lane] else own.worst[lane]
        advance(task, room)
        for lane in range(LANES):
            own.at[lane] += own.taken[lane] * own.length[lane]


@routine
def take_in(first: int, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Take in a block of variants from the first one on, all lanes where they begin."""
    own, edges, last = rows_of(room.lane), batch.edges.shape[0] // 2, min(LANES, batch.given.shape[1] - first)
    gather(batch.numbers, first, in_lanes(room.numbers))
    gather(batch.edges, first, in_lanes(room.edges))
    gather(batch.instants, first, in_lanes(room.instants))
    gather(batch.given, first, in_lanes(room.lane))
    gather(batch.states, first, in_lanes(room.begin))
    gather(batch.doubts, first, in_lanes(room.doubts))
    for lane in range(LANES):
        own.at[lane] = 0.0 if task.along_time else own.turned[lane]
        own.slowest[lane], own.fastest[lane], own.slope[lane] = math.inf, -math.inf, math.nan
        own.slow_off[lane], own.fast_off[lane] = math.nan, math.nan
        own.steps[lane], own.scale[lane], own.trials[lane], own.free[lane] = 0.0, 0.0, 0.0, -math.inf
        own.begins[lane], own.ends[lane], own.refused[lane] = -math.inf, math.inf, math.inf
        own.why[lane] = GOING if lane < last and own.at[lane] < own.goal[lane] else GOAL
        find_edge(lane, edges, task, room)
        look_ahead(lane, edges, room)


@routine
def give_out(first: int, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Hand out where a block of variants ended."""
    hand_out(in_lanes(room.begin), first, batch.states)
    hand_out(in_lanes(room.doubts), first, batch.doubts)
    hand_out(in_lanes(room.ending), first, batch.ending)
    hand_out(in_lanes(room.lane[FIRST_FOUND:]), first, batch.found)
    if task.held.shape[0] > 0:
        hand_out(in_lanes(room.numbers), first, batch.numbers)


@driver
def walk(
    begin: int,
    end: int,
    places: Callable,
    rates: Callable,
    watch: Callable,
    batch: WalkBatch,
    task: WalkTask,
    room: Room,
) -> None:
    """Carry the blocks begin … end − 1 of variants to the end of their walks.

    Parameters
    ----------
    begin, end : int
    places, rates, watch : callable
        Printed functions.
    batch : WalkBatch
    task : WalkTask
    room : Room
    """
    own, printed = rows_of(room.lane), Printed(places, rates, watch, batch.memory)
    for b in range(begin, end):
        first = b * LANES
        take_in(first, batch, task, room)
        going = True
        while going:
            lay(first, printed, batch, task, room)
            if room.lengths.shape[0] > 1:
                repeat(printed, batch, task, room)
            going = False
            for lane in range(LANES):
                going = going or own.why[lane] == GOING
        give_out(first, batch, task, room)
