"""Integration of a motion step by step, each lane with its own step lengths, until an event ends it.

A walk follows the crank angle or time. Every system is integrated alike: the stages of a method, their rates from the
printed functions, an error estimate and guards. A guard is a number that is positive while the motion continues
unchanged. A step in which it vanishes is repeated with refined lengths until it ends at the root; no event is located
by interpolation.

Along the angle, quantities of the position alone are the same in every cycle. The mesh of one cycle is laid once and
its position-dependent values are stored; later cycles repeat it while the errors stay small enough.
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

# Maximum number of stored steps per cycle; lanes that need more don't repeat theirs.
MOST_SLOTS = 160
# Steps after which a walk can be interrupted.
MOST_STEPS = 1 << 13
# A repeated step may exceed the tolerance of a new one by this factor.
ROUGHLY = 100.0
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# Limit of |h ∂f/∂y| for an explicit step. Along time, a step spans at most the fraction AT_ONCE of the interval between
# two edges, unless that is less than the fraction NARROW of the longest step.
STEEPEST, AT_ONCE, NARROW = 5.0, 0.25, 1e-3
# A comparison walk uses steps LONGER times as long, which grow LONGER times as fast, and a tolerance COARSER times as
# large, but at most COARSEST, beyond which it says nothing. Its steps differ even where growth, an instant or a longest
# step limits them, so the difference of the walks estimates the error.
LONGER, COARSER, COARSEST = 2.0, 2.0**7, 1e-1
# After MANY steps an implicit method pays where steps are shorter than the fraction WORTH_SOLVING of the longest step
# and |h ∂f/∂y| exceeds FADES.
MANY, WORTH_SOLVING, FADES = 100, 0.05, 0.3
# Newton iterations for the stages of an implicit step; their tolerance; the tolerance accepted where rounding stalls
# them; the fraction of a state that an iteration leaves at least.
MOST_ROUNDS, FOUND_TO, NEARLY_FOUND, LEAST_LEFT = 12, 1e-14, 1e-11, 0.1
# The real eigenvalue of the matrix of Radau's method with five stages is 0.159; 1/4 of it filters error estimates.
OWN_SHARE = 0.25 * 0.159
# Implicit rates: relative tolerance, maximum number of secant iterations, and the iterations after which only rounding
# prevents further convergence.
SOLVED_TO, MOST_SECANTS, SURE_SECANTS = 1e-13, 20, 6
# Relative tolerance of the length of the step to a guard's root, and maximum number of trials.
ROOT, MOST_TRIALS = 4e-16, 60
# Replaces a guard of zero at the start of a step.
TINY = 1e-292
# Below this fraction of its final value a guard is too small for the secant; try this fraction of the step instead.
NEXT_TO_NOTHING, LEAP = 1e-3, 0.1
# An extreme of the speed is found once the slope is below the fraction FLAT √tolerance of its terms: the speed misses
# the extreme by the square of that. To bracket it, a trial step overshoots by the fraction BEYOND of the bracket, the
# second by BEHIND of its own distance.
FLAT, BEYOND, BEHIND = 0.1, 1e-5, 0.2
# Errors below this fraction of a state are rounding; so is a distance to an edge.
ROUNDED = 4.0 * float(np.finfo(float).eps)
# A cycle that ends this close to the goal, as a fraction of the cycle, ends at it.
NEARLY = 1e-12
# A step error below NOISE is rounding (of torques in balance, say) if a shorter step leaves at least the fraction FALLS
# of it. It then counts as the fraction FORGIVEN of the tolerance, so that steps grow again.
NOISE, FALLS, FORGIVEN = 1e-11, 0.5, 0.05
# An interval is divided into equal steps only if there are at most this many.
MOST_PARTS = 1e6
# A step along time is rejected if it turns by more than this multiple of the largest permitted angle.
TOO_FAR = 2.0
# Steps below this fraction of the distance covered fail; at the start along time, of LEAST_TIME [s].
SHORTEST, LEAST_TIME = 1e-13, 1e-7


def coarser(tolerance: float) -> float:
    """Step tolerance of a comparison walk."""
    return max(tolerance, min(COARSER * tolerance, COARSEST))


class Why(IntEnum):
    """Why a walk ended.

    STEEP: an implicit method would be faster. FADED: the speed has dropped below `floor`. From GUARD on: the guard of
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
# First rows of `watch`: speed; magnitude of the terms of the first state's rate; derivative of that rate with respect
# to the first state; a number with the sign of the speed's slope; from RESPONSES on, derivatives of the integrands
# with respect to the first state.
SPEED, SIZE, STEEPNESS, SLOPE, RESPONSES = range(5)
# Guards that aren't rows of `watch`: the edge ahead, the other goal, an extreme of the speed.
EDGE, OTHER, RISE, FIRST = range(4)


class WalkTask(NamedTuple):
    """Settings of a walk, common to all variants.

    Attributes
    ----------
    along_time : bool
        Whether time is the independent variable and the angle turned the first state; otherwise the angle is the
        independent variable.
    method, stages : int
        Number of the method, and of its stages.
    fixed : bool
        Whether steps have fixed lengths.
    longer : float
        1, or LONGER for a comparison walk.
    steepest : float
        Limit of |h ∂f/∂y| for an explicit step.
    nodes, parts : ndarray
        Nodes and dense polynomial of the method.
    implicit : bool
        Whether Newton's method finds the stages.
    solved : int
        Number of states Newton's method solves for: the energy, or the speeds; 0 if it can't.
    slopes : int
        First row of the Jacobian of their rates in `watch`.
    solves : int
        State with an implicit rate, −1: none; the row of that rate in P follows those of the states.
    matrix, inverse : ndarray
        Of an implicit method.
    states, width : int
        Rows of `rates`: those of the states, and those including the integrals.
    scales : int
        First row of the error scales of the states in `watch`, along time; −1: the states themselves.
    watched, guards : int
        Number of rows of `watch`, and of the guards, which are the last ones.
    ends : ndarray of bool
        Whether each guard ends the walk; others change held numbers.
    carries : bool
        Whether error estimates are propagated.
    first_place, places, rated : int
        First row of P that the printed function `places` fills, the number of these rows, and how many of them `rates`
        reads; the rows of the states follow.
    clock : int
        Row of P that holds the time; −1: none.
    extremes : bool
        Whether steps end at the extremes of the speed.
    root : float
        Relative tolerance of the length of the step to a guard's root.
    shown : ndarray
        Fractions of a step at which its polynomial is recorded.
    cycle : float
        Period of the angle; infinite if there is none [rad].
    held : ndarray of int
        Rows of P that change where a guard ends a step; their new values are the rows of `watch` before the guards.
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
    """Rows of a block, one number per lane.

    Inputs are the rows up to `pace`; outputs are those from `turned` to `steps`.

    Attributes
    ----------
    start, direction : row
        Crank angle at the start [rad], and the direction in which the angle turned is counted, +1 or −1.
    facing : row
        Direction of motion, +1 or −1.
    clock : row
        Time at the start [s].
    goal, other_goal : row
        Independent variable at the end; for a walk along time, the angle turned at the end, along the angle the time.
    tolerance, farthest : row
        Step tolerance, and largest angle of a step [rad].
    longest, floor : row
        For a walk along time, the longest step [s] and the speed below which the motion has faded [rad/s]; where speeds
        may be negative, the minimum scale of the errors of the states.
    turned, pace : row
        Angle turned, and length of the next trial step.
    at : row
        Independent variable, from the start.
    slowest, fastest, slow_off, fast_off : row
        Minimum and maximum speed at the ends of steps, and their error estimates.
    slope : row
        A number with the sign of the speed's slope at the end.
    why, steps : row
        Why the walk ended (`Why`), and its number of steps.
    scale, work, size : row
        Maximum work of the accepted steps; the same including the trial step; scale of a step's error.
    length, missed : row
        Length of the trial step, and its error estimate relative to the tolerance.
    edge, base : row
        Number of the edge behind, and the angle turned at which its cycle starts.
    low, high, begins, ends : row
        Limits of the angle turned and of the time at which a step evaluates its stages.
    behind, ahead : row
        Distances from the start and the end of a step along the angle to these limits, where it meets an edge [rad].
    short, long, trials, side : row
        Bracket of step lengths around a guard's root, number of trials, and side of the last one: −1 before the root,
        +1 beyond.
    short_speed, long_speed : row
        Speeds at the ends of the bracket.
    fired : row
        1 if a guard ends the step.
    halt : row
        Independent variable at the end of the cycle that is laid or repeated.
    taken, able : row
        1 if the step is accepted; 1 if a cycle is repeated.
    kept : row
        Number of stored steps of a cycle; −1: none.
    free : row
        Independent variable from which steps may be stored again.
    worst : row
        Maximum error estimate of the repeated steps relative to the tolerance.
    carried_error : row
        Error estimate of the first state at the start of the step.
    ended : row
        Number of the guard that ends the step; −1: none.
    refused : row
        Error estimate, relative to the tolerance, of the last rejected step; infinite if none since an accepted step.
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
    behind: Row
    ahead: Row
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
    carried_error: Row
    ended: Row
    refused: Row


GIVEN, FOUND = Lane._fields[:12], Lane._fields[10:20]
FIRST_FOUND = 10


class Room(NamedTuple):
    """Scratch arrays for one block, lanes last."""

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
    carried_errors: np.ndarray
    ending: np.ndarray
    equations: np.ndarray
    before: np.ndarray
    guards: np.ndarray
    lengths: np.ndarray
    limits: np.ndarray
    places: np.ndarray


def new_room(task: WalkTask, numbers: int, edges: int, instants: int, repeats: bool) -> Room:
    """Scratch arrays for one block; `repeats` adds room for the stored steps of a cycle."""
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
        rows(2 * laid),
        rows(laid * (task.stages + 1) * max(task.places, 1)),
    )


class Printed(NamedTuple):
    """The printed functions of a system, and the memory of all tables."""

    places: Callable
    rates: Callable
    watch: Callable
    memory: np.ndarray


class WalkBatch(NamedTuple):
    """Inputs and results of a number of walks.

    Attributes
    ----------
    memory : ndarray
        All tables.
    numbers : ndarray (numbers, variants)
        Held numbers are updated in place.
    edges : ndarray (2 × edges, variants)
        Angles turned at the edges of a cycle, including its start and end, and the margins at them [rad].
    instants : ndarray (instants, variants)
    given : ndarray (GIVEN, variants)
    states : ndarray (width, variants)
        States and integrals at the start, updated in place.
    carried_errors : ndarray (width, variants)
        Their error estimates, updated in place.
    ending : ndarray (width, variants)
        Their rates at the end.
    found : ndarray (FOUND, variants)
    recorded : ndarray (steps, 3 + (states + 1) × (1 + places), variants)
        Start, length and direction of each step; for each state and the first integral, its polynomial and its error
        estimate at the start.
    """

    memory: np.ndarray
    numbers: np.ndarray
    edges: np.ndarray
    instants: np.ndarray
    given: np.ndarray
    states: np.ndarray
    carried_errors: np.ndarray
    ending: np.ndarray
    found: np.ndarray
    recorded: np.ndarray


rows_of = memory(one(Lane))


# A step


@inlined
def stand(share: float, stage: int, slot: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Put the position and the time of a stage into P; a negative `slot` computes the position's values afresh."""
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
        # `watch` needs the other rows, but only at the ends of the step.
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
    """Rates of a stage by secants, where the rate of a state depends on itself, as friction does on the acceleration.

    Where the iteration fails, the rate is NaN and the step is rejected.
    """
    own, row = rows_of(room.lane), task.first_place + task.places
    here, state = in_lanes(room.numbers)[row + task.states], in_lanes(room.numbers)[row + task.solves]
    found = in_lanes(room.rates)[stage * task.width + task.solves]
    # The rows behind the equations of an implicit step.
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
    """Evaluate `watch` at the start of a step, 0, or at its end, 1."""
    count = task.watched
    filled_rows = room.watched[end * count : (end + 1) * count].reshape(count, 1, LANES)
    printed.watch(room.numbers, printed.memory, room.position[0:1], room.position[1:2], room.position[2:3], filled_rows)


@inlined
def keep_place(stage: int, task: WalkTask, room: Room) -> None:
    """Store the position-dependent values of a stage in the slot of each lane's trial step, behind those it keeps."""
    own, kept, numbers = rows_of(room.lane), in_lanes(room.places), in_lanes(room.numbers)
    for lane in range(LANES):
        slot = int(own.kept[lane])
        at = (slot * (task.stages + 1) + stage) * task.places
        for i in range(task.places if 0 <= slot < room.lengths.shape[0] else 0):
            kept[at + i, lane] = numbers[task.first_place + i, lane]


@routine
def attempt(kept: int, keeps: bool, printed: Printed, task: WalkTask, room: Room) -> None:
    """Try a step in all lanes: its stages, its end and its error estimate.

    The position-dependent values come from slot `kept` unless it is negative; if `keeps`, they are stored.
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
                # The last stage is the end, without the rounding of a steep motor's torque.
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
    """Find the stages of an implicit step by Newton's method; without convergence the rates are NaN.

    The unknowns are the energy at all stages, or the speeds; angles follow from the rates of the previous iteration.
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
            # Converged lanes stay as they are while others iterate.
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
    """Angles at the stages of an implicit step along time, from the latest rates."""
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
    """Accelerations at the stages of an implicit step from the speeds there, which a steep coupling rounds less."""
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
    """Rates of a stage of an implicit step at its current iterate."""
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
    """Solve linear equations by Gaussian elimination; the solution replaces the right-hand sides."""
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
    """Error estimate of the step relative to the tolerance.

    Along the angle, the scales are the maximum work of a step and the time of a cycle; along time, those of the system,
    or the angle turned in the step, and the speed or its change.
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
        # A steep motor damps an implicit step's error. Source: E. Hairer and G. Wanner, Solving Ordinary
        # Differential Equations II, section IV.8.
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
                # A rejected step says nothing about the work of accepted ones.
                own.work[lane] = size if size > own.scale[lane] else own.scale[lane]
                own.size[lane] = own.work[lane]
        elif not task.along_time:
            for lane in range(LANES):
                # Scale of the time: one cycle at this speed.
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
            # A state at rest has no error, and no scale either.
            off = off if errors[q, lane] != 0.0 else 0.0
            own.missed[lane] = off if off > own.missed[lane] or off != off else own.missed[lane]
    for q in range(width):
        for lane in range(LANES):
            own.missed[lane] = own.missed[lane] if abs(after[q, lane]) < math.inf else math.inf
    for lane in range(LANES if task.along_time else 0):
        # Beyond this angle the error estimate is blind.
        far = abs(after[0, lane] - begin[0, lane]) > TOO_FAR * own.farthest[lane]
        own.missed[lane] = math.inf if far else own.missed[lane]
    for q in range(1, task.states if task.along_time and not task.signed else 0, 2):
        for lane in range(LANES):
            # A side that starts from rest can't return to rest within a step.
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
    """Limits of the angles at which a lane's step evaluates: its edges, less their margins."""
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
    """Move a lane past the edge ahead; false where the range ends there."""
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
    """Find the edges on either side of a lane; at an edge, take the interval ahead."""
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
    """Next instant at which a function of time jumps or bends; set the time limits of the step."""
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


@inlined
def behind_instant(lane: int, count: int, room: Room) -> bool:
    """Whether a lane's step starts at an instant at which a function of time jumps or bends."""
    own = rows_of(room.lane)
    now = own.clock[lane] + own.at[lane]
    return count > 0 and now - own.begins[lane] <= ROUNDED * abs(now)


# Step lengths and decisions


@routine
def choose(edges: int, instants: int, most_steps: int, task: WalkTask, room: Room) -> bool:
    """Choose the length of each lane's next step: an equal part of the distance to its next end, or 0 for no step.

    Returns whether any lane makes a step.
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
            longest = task.longer * own.longest[lane]
            most = most if most < longest else longest
        else:
            until, most = min(until, edge_ahead(lane, room)), min(most, own.farthest[lane])
        rest = until - own.at[lane]
        # A distance of too many steps isn't divided.
        parts = math.ceil(rest / most * (1.0 - 1e-9)) if rest < MOST_PARTS * most else 0
        if task.along_time and task.longer == 1.0 and (own.steps[lane] == 0.0 or behind_instant(lane, instants, room)):
            # A single step to the next end would have no comparison: make two.
            parts = parts if parts != 1 else 2
        own.length[lane] = most if parts == 0 else (rest / parts if parts > 1 else rest)
        if not own.length[lane] > 0.0:
            # No step starts from a NaN or infinite state.
            own.length[lane], own.why[lane] = 0.0, LOST
    return goes


@inlined
def next_root(lane: int, task: WalkTask, room: Room) -> float:
    """Length of the step to the first root within the bracket, by the secant; the longer end once the root is found.

    Extremes of the speed follow from the cubic through its values and slopes.
    """
    own, guards, count = rows_of(room.lane), in_lanes(room.guards), FIRST + task.guards
    short, long = own.short[lane], own.long[lane]
    best = long
    if long - short > task.root * long and own.trials[lane] <= MOST_TRIALS:
        for g in range(count):
            near, far = guards[g, lane], guards[count + g, lane]
            if near > 0.0 and far <= 0.0:
                share = top_between(near, far, lane, room) if g == RISE else near / (near - far)
                # A guard that starts at its zero, or just after it, is too small for the secant.
                share = LEAP if g != RISE and short == 0.0 and share < NEXT_TO_NOTHING else share
                # Aim beyond the root rather than before it.
                root = short + (long - short) * share + 0.5 * task.root * long
                best = root if root < best else best
    return best


@inlined
def top_between(leaves: float, comes: float, lane: int, room: Room) -> float:
    """Fraction of the bracket at which the speed is extreme; `leaves` and `comes` are its slopes at the two ends.

    The slope at the start of the step is taken as positive.

    Source: Hermite's cubic, whose slope is a quadratic with one root between slopes of different signs.
    """
    own, watched = rows_of(room.lane), in_lanes(room.watched)
    way = own.long[lane] - own.short[lane]
    a, b = leaves * way, comes * way
    c = math.copysign(1.0, watched[SLOPE, lane]) * (own.long_speed[lane] - own.short_speed[lane])
    linear, squared = 6.0 * c - 4.0 * a - 2.0 * b, 3.0 * (a + b) - 6.0 * c
    share = 2.0 * a / (math.sqrt(max(linear * linear - 4.0 * squared * a, 0.0)) - linear)
    # The second trial approaches from the other side.
    overshoot = BEYOND if own.trials[lane] != 2.0 else BEHIND * (share if own.side[lane] < 0.0 else share - 1.0)
    share += overshoot
    return share if 0.0 < share < 1.0 else 0.5


@inlined
def speed_slope(lane: int, end: int, task: WalkTask, room: Room) -> float:
    """Derivative of the speed at the start of a step, 0, or its end, 1; along the angle dω/dφ = ω/(2E) · I ω dω/dφ."""
    watched, energy = in_lanes(room.watched), in_lanes(room.begin) if end == 0 else in_lanes(room.after)
    slope, speed = watched[end * task.watched + SLOPE, lane], watched[end * task.watched + SPEED, lane]
    return slope if task.along_time else 0.5 * slope * speed / energy[0, lane]


@inlined
def guard(g: int, lane: int, end: int, task: WalkTask, room: Room) -> float:
    """Value of a guard of a lane at the start of a step, 0, or at its end, 1."""
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
        # In a motion in balance the slope's sign is rounding.
        off = FOUND_TO * abs(in_lanes(room.begin)[last, lane])
        unsure = ROUNDED * watched[SIZE, lane] + abs(watched[STEEPNESS, lane]) * off
        sense = math.copysign(1.0, slope) if abs(slope) > unsure else 0.0
        return sense * speed_slope(lane, end, task, room) if task.extremes else 1.0
    return watched[row + task.watched - task.guards + g - FIRST, lane]


@inlined
def is_crossed(g: int, lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a guard vanishes within a step; where guards change held numbers, a step may start at a guard's zero."""
    near, far = guard(g, lane, 0, task, room), guard(g, lane, 1, task, room)
    return (near > 0.0 and not far > 0.0) or (near == 0.0 and far < 0.0 and task.held.shape[0] > 0)


@routine
def fires(rises: bool, task: WalkTask, room: Room) -> None:
    """Set `fired` in lanes where a guard that is positive at the start of the step isn't positive at its end.

    If `rises`, extremes of the speed count too.
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
    """Whether an extreme of the speed within the step may exceed the extremes so far or trigger a guard.

    It lies roughly within the triangle of the chord and the end tangents, and certainly within twice its height.
    """
    own, watched = rows_of(room.lane), in_lanes(room.watched)
    near, far = watched[SPEED, lane], watched[task.watched + SPEED, lane]
    leaves, comes = speed_slope(lane, 0, task, room), speed_slope(lane, 1, task, room)
    # Intersection of the tangents.
    top = near + leaves * (far - near - comes * own.length[lane]) / (leaves - comes)
    end = max(near, far) if leaves > 0.0 else min(near, far)
    beyond = top - end if leaves > 0.0 else end - top
    # An intersection between the end speeds means that a steep motor bends the curve otherwise.
    if not beyond >= 0.0:
        return True
    for g in range(task.guards):
        first, last = guard(FIRST + g, lane, 0, task, room), guard(FIRST + g, lane, 1, task, room)
        if not task.ends[g] and first > 0.0 and not min(first, last) > 2.0 * beyond:
            return True
    return top + beyond > own.fastest[lane] if leaves > 0.0 else top - beyond < own.slowest[lane]


@routine
def decide_steps(task: WalkTask, room: Room) -> bool:
    """Set `taken` in lanes that accept the step; other lanes try another length. Returns whether any lane accepts."""
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
    """Whether a step's error is rounding: below NOISE, and at least FALLS times that of the step rejected before."""
    own = rows_of(room.lane)
    before, own.refused[lane] = own.refused[lane], own.missed[lane]
    rounding = own.missed[lane] * own.tolerance[lane] <= NOISE and own.missed[lane] >= FALLS * before
    if rounding:
        own.missed[lane] = FORGIVEN
    return rounding


@inlined
def narrow(lane: int, task: WalkTask, room: Room) -> bool:
    """Narrow the bracket of a guard's root in a lane; true where the step ends at the root.

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
        # Replace the value at this end; reduce the weight of the end that stays twice. Slopes keep theirs.
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
    """Whether a step that ends beyond the roots of guards ends at the first of them, by the secant."""
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
    """Whether only an extreme of the speed ends the step, and the speed is flat there to tolerance."""
    watched, end = in_lanes(room.watched), task.watched
    for g in range(FIRST + task.guards):
        if g != RISE and is_crossed(g, lane, task, room):
            return False
    flat = FLAT * math.sqrt(rows_of(room.lane).tolerance[lane])
    return abs(watched[end + SLOPE, lane]) <= flat * (abs(watched[SLOPE, lane]) + watched[SIZE, lane])


@inlined
def missed_top(lane: int, task: WalkTask, room: Room) -> float:
    """Speed by which a step that ends at an extreme of the speed misses it: twice the height of the parabola there."""
    own, near = rows_of(room.lane), in_lanes(room.guards)[RISE, lane]
    far = guard(RISE, lane, 1, task, room)
    found = own.trials[lane] > 0.0 and near > 0.0 and far < 0.0
    return far * far * (own.length[lane] - own.short[lane]) / (near - far) if found else 0.0


@inlined
def is_short(length: float, lane: int, task: WalkTask, room: Room) -> bool:
    """Whether a step turns by so little that an implicit one pays."""
    own = rows_of(room.lane)
    turns = length * abs(in_lanes(room.begin)[1, lane]) if task.along_time else length
    return turns < WORTH_SOLVING * own.farthest[lane]


@inlined
def shorten(lane: int, task: WalkTask, room: Room) -> None:
    """Choose a shorter step in a lane with too large an error; the lane is lost below the minimum length."""
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
    """Propagate the error estimates of the energy and the integrals over the step, and add those of the step.

    An error of the energy grows or fades as neighbouring motions diverge or converge, by exp ∫∂M/∂E dφ; those of the
    integrals follow by their derivatives. Every step adds rounding, and at an edge the change of the rates up to where
    they are evaluated. All are magnitudes, so none cancel. Source: E. Hairer, S. P. Nørsett and G. Wanner, Solving
    Ordinary Differential Equations I, section I.14.
    """
    own, watched, k = rows_of(room.lane), in_lanes(room.watched), in_lanes(room.rates)
    carried_errors, errors, begin, end = (
        in_lanes(room.carried_errors),
        in_lanes(room.errors),
        in_lanes(room.begin),
        task.watched,
    )
    width, last = task.width, (task.stages - 1) * task.width
    for q in range(width):
        for lane in range(LANES):
            behind = own.behind[lane] * abs(k[width + q, lane] - k[q, lane])
            ahead = own.ahead[lane] * abs(k[last + q, lane] - k[last - width + q, lane])
            errors[q, lane] = abs(errors[q, lane]) + behind + ahead
    most, rounded = (-3.0, 4.0 * FOUND_TO) if task.implicit else (-1.0, 0.25 * EPS)
    for lane in range(LANES):
        grows = 0.5 * own.length[lane] * (watched[STEEPNESS, lane] + watched[end + STEEPNESS, lane])
        # A step damps an error no more than its method does.
        grows = grows if grows > most else most
        own.carried_error[lane] = carried_errors[0, lane]
        step = errors[0, lane] + rounded * begin[0, lane]
        after = own.carried_error[lane] * exponential(grows) + step
        carried_errors[0, lane] = after if own.taken[lane] > 0.0 else carried_errors[0, lane]
    for q in range(1, task.width):
        row = RESPONSES + q - 1
        for lane in range(LANES):
            follows = (
                abs(watched[row, lane]) * own.carried_error[lane]
                + abs(watched[end + row, lane]) * carried_errors[0, lane]
            )
            more = carried_errors[q, lane] + 0.5 * own.length[lane] * follows + errors[q, lane]
            carried_errors[q, lane] = more if own.taken[lane] > 0.0 else carried_errors[q, lane]


@routine
def advance(task: WalkTask, room: Room) -> None:
    """Accept the states at the end of the step in lanes that take it."""
    own, watched, begin, after = rows_of(room.lane), in_lanes(room.watched), in_lanes(room.begin), in_lanes(room.after)
    row, carried_errors = task.watched + SPEED, in_lanes(room.carried_errors)
    if task.carries:
        carry_errors(task, room)
    for q in range(task.width):
        for lane in range(LANES):
            begin[q, lane] = after[q, lane] if own.taken[lane] > 0.0 else begin[q, lane]
    for lane in range(LANES):
        speed, took = watched[row, lane], own.taken[lane] > 0.0
        off = 0.5 * speed * carried_errors[0, lane] / begin[0, lane] if task.carries else math.nan
        off += missed_top(lane, task, room)
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
    """Set a lane's held numbers to their values after the guard that ended its step."""
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
    """Accept the step in lanes that take it, and find out what ends there."""
    own, begin, watched = rows_of(room.lane), in_lanes(room.begin), in_lanes(room.watched)
    k, ending, last = in_lanes(room.rates), in_lanes(room.ending), (task.stages - 1) * task.width
    for q in range(task.width):
        for lane in range(LANES):
            # The last stage is the end of the step.
            ending[q, lane] = k[last + q, lane] if own.taken[lane] > 0.0 else ending[q, lane]
    for lane in range(LANES):
        own.ended[lane] = -1.0
        if own.taken[lane] > 0.0 and own.trials[lane] > 0.0:
            for g in range(FIRST + task.guards):
                # An extreme of the speed ends only the step.
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
            most = GROW * task.longer
            ahead = own.length[lane] * (share if share < most else most)
            own.pace[lane] = ahead if ahead > own.pace[lane] else own.pace[lane]
            fades = own.pace[lane] * abs(watched[task.watched + STEEPNESS, lane])
            short = own.steps[lane] > MANY and is_short(own.pace[lane], lane, task, room)
            if own.why[lane] == GOING and short and fades > FADES and task.solved > 0 and not task.implicit:
                own.why[lane] = STEEP


@routine
def record(first: int, printed: Printed, recorded: np.ndarray, task: WalkTask, room: Room) -> None:
    """Record accepted steps: start, length, direction, and polynomials at the fractions `shown`."""
    own, k, begin = rows_of(room.lane), in_lanes(room.rates), in_lanes(room.begin)
    state, dense = in_lanes(room.numbers[task.first_place + task.places :]), task.nodes.shape[0]
    carried_errors = in_lanes(room.carried_errors)
    for s in range(task.stages, dense):
        at_stage(task.method, s, task.states, task.width, begin, own.length, k, state)
        stand(task.nodes[s], s, -1, printed, task, room)
        rate(s, printed, task, room)
    for lane in range(LANES):
        if own.taken[lane] == 0.0 or first + lane >= recorded.shape[2]:
            continue
        i, v, shown = int(own.steps[lane]), first + lane, task.shown.shape[0]
        recorded[i, 0, v], recorded[i, 1, v], recorded[i, 2, v] = own.at[lane], own.length[lane], own.facing[lane]
        # There may be no integral.
        for q in range(min(task.states + 1, task.width)):
            at = 3 + q * (shown + 1)
            recorded[i, at + shown, v] = carried_errors[q, lane]
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
    """Make new steps: one cycle's, to be stored, in lanes with several cycles ahead; all remaining ones in others.

    The lanes are independent.
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
    """Make new steps up to each lane's halt, and store them in lanes that keep them."""
    own, lengths, limits = rows_of(room.lane), in_lanes(room.lengths), in_lanes(room.limits)
    slots, edges, records = room.lengths.shape[0], batch.edges.shape[0] // 2, batch.recorded.shape[0] > 0
    most_steps = batch.recorded.shape[0] if records else MOST_STEPS
    while choose(edges, batch.instants.shape[0], most_steps, task, room):
        keeps = False
        for lane in range(LANES):
            keeps |= own.kept[lane] >= 0.0 and own.length[lane] > 0.0
            end = own.at[lane] + own.length[lane]
            own.behind[lane], own.ahead[lane] = max(own.low[lane] - own.at[lane], 0.0), max(end - own.high[lane], 0.0)
        attempt(-1, keeps, printed, task, room)
        took = decide_steps(task, room)
        if records and took:
            record(first, printed, batch.recorded, task, room)
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


@inlined
def cycles_ahead(task: WalkTask) -> float:
    """Minimum number of cycles ahead of a lane that repeats one."""
    return (2.0 if task.extremes else 1.0) - NEARLY


@inlined
def remember(first: bool, lane: int, task: WalkTask, room: Room) -> None:
    """Store the state at the start of a lane's cycle, and that of the cycle before unless this is the `first`."""
    own, before, width = rows_of(room.lane), in_lanes(room.before), task.width
    begin, carried_errors, one = in_lanes(room.begin), in_lanes(room.carried_errors), 2 * task.width + 1
    for i in range(one):
        now = own.at[lane] if i == 2 * width else begin[i, lane] if i < width else carried_errors[i - width, lane]
        before[i, lane] = now if first else before[one + i, lane]
        before[one + i, lane] = now


@inlined
def go_back(lane: int, task: WalkTask, room: Room) -> None:
    """Return a lane to the start of the previous cycle; its steps are new up to the end of the cycle it left."""
    own, before, width = rows_of(room.lane), in_lanes(room.before), task.width
    begin, carried_errors = in_lanes(room.begin), in_lanes(room.carried_errors)
    for i in range(width):
        begin[i, lane], carried_errors[i, lane] = before[i, lane], before[width + i, lane]
    own.at[lane], own.free[lane] = before[2 * width, lane], before[4 * width + 1, lane] + task.cycle


@routine
def repeat(printed: Printed, batch: WalkBatch, task: WalkTask, room: Room) -> None:
    """Repeat the steps of a cycle in lanes with enough cycles ahead, as long as the errors stay small.

    The speed curves over the angle of a motion and of the same motion one cycle later never cross. The extremes of a
    walk are therefore those of its first and last cycles, whose steps are computed again.
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
                # The lane left the stored steps within the cycle; make new ones from there.
                if task.extremes:
                    go_back(lane, task, room)
                own.turned[lane], own.halt[lane] = own.at[lane], math.inf
                find_edge(lane, batch.edges.shape[0] // 2, task, room)
            elif own.why[lane] == GOING:
                own.halt[lane] = math.inf


@routine
def repeat_steps(slots: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Repeat the stored steps in lanes that are `able`; a lane with too large an error no longer is."""
    own, lengths, limits = rows_of(room.lane), in_lanes(room.lengths), in_lanes(room.limits)
    for lane in range(LANES):
        own.worst[lane] = 0.0
    for slot in range(slots):
        for lane in range(LANES):
            goes = own.able[lane] > 0.0 and slot < own.kept[lane]
            own.length[lane] = lengths[slot, lane] if goes else 0.0
            own.behind[lane], own.ahead[lane] = limits[2 * slot, lane], limits[2 * slot + 1, lane]
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
    """Load a block of variants, starting at number `first`, at their initial states."""
    own, edges, last = rows_of(room.lane), batch.edges.shape[0] // 2, min(LANES, batch.given.shape[1] - first)
    gather(batch.numbers, first, in_lanes(room.numbers))
    gather(batch.edges, first, in_lanes(room.edges))
    gather(batch.instants, first, in_lanes(room.instants))
    gather(batch.given, first, in_lanes(room.lane))
    gather(batch.states, first, in_lanes(room.begin))
    gather(batch.carried_errors, first, in_lanes(room.carried_errors))
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
    """Store the final states of a block of variants."""
    hand_out(in_lanes(room.begin), first, batch.states)
    hand_out(in_lanes(room.carried_errors), first, batch.carried_errors)
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
    """Integrate the variants of blocks begin … end − 1 to the end of their walks.

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
