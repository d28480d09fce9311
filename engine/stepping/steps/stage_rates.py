"""Rates of the states at the stages of a step, implicit ones by secants; the record of a step."""

import math

import numpy as np

from engine.compiling.blocks import LANES, in_lanes
from engine.compiling.decorators import inlined, routine
from engine.laws.elementary import direction_of
from engine.stepping.methods import at_stage
from engine.stepping.steps.step_lanes import Printed, Room
from engine.stepping.walk_task import WalkTask

# Newton iterations for the stages of an implicit step; their tolerance; the tolerance accepted where rounding stalls
# them; the fraction of an energy that an iteration leaves at least.
MOST_ROUNDS, FOUND_TO, NEARLY_FOUND, LEAST_LEFT = 12, 1e-14, 1e-11, 0.1
# Implicit rates: relative tolerance, maximum number of secant iterations, and the iterations after which only rounding
# prevents further convergence.
SOLVED_TO, MOST_SECANTS, SURE_SECANTS = 1e-13, 20, 6


# A step


@inlined
def places_at(stage: int, task: WalkTask) -> int:
    """Number of position-dependent values at a stage; `watch` needs those that `rates` doesn't at a step's ends."""
    return task.places if stage == 0 or stage == task.stages else task.rated


@routine
def set_position(share: float, stage: int, slot: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Put the position and the time of a stage into P; a negative `slot` computes the position's values afresh."""
    own, position, state = room.lane, in_lanes(room.position), in_lanes(room.numbers)
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
        kept, at = room.places, (slot * (task.stages + 1) + stage) * count
        for i in range(places_at(stage, task)):
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

    The search starts at the rate of the previous stage, or at 0, so that no step depends on others or on other lanes.
    Where the iteration fails, the rate is NaN and the step is rejected.
    """
    own, row = room.lane, task.first_place + task.places
    here, state = in_lanes(room.numbers)[row + task.states], in_lanes(room.numbers)[row + task.solves]
    found = in_lanes(room.rates)[stage * task.width + task.solves]
    before, left_before = room.secants[0], room.secants[1]
    known = in_lanes(room.rates)[max(stage - 1, 0) * task.width + task.solves]
    for lane in range(LANES):
        here[lane] = known[lane] if stage > 0 else 0.0
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
    tile = room.rates[stage * width : (stage + 1) * width]
    printed.rates(room.numbers, printed.memory, room.position[0:1], room.position[1:2], room.position[2:3], tile)


@inlined
def look(end: int, printed: Printed, task: WalkTask, room: Room) -> None:
    """Evaluate `watch` at the start of a step, 0, or at its end, 1."""
    count = task.watched
    tile = room.watched[end * count : (end + 1) * count]
    printed.watch(room.numbers, printed.memory, room.position[0:1], room.position[1:2], room.position[2:3], tile)


@routine
def keep_place(stage: int, task: WalkTask, room: Room) -> None:
    """Store the position-dependent values of a stage in the slot of each lane's trial step, after its stored steps."""
    own, kept, numbers = room.lane, room.places, in_lanes(room.numbers)
    for lane in range(LANES):
        slot = int(own.kept[lane])
        at = (slot * (task.stages + 1) + stage) * task.places
        for i in range(places_at(stage, task) if 0 <= slot < room.lengths.shape[0] else 0):
            kept[at + i, lane] = numbers[task.first_place + i, lane]


@routine
def record(first: int, printed: Printed, recorded: np.ndarray, task: WalkTask, room: Room) -> None:
    """Record accepted steps: start, length, direction, and polynomials at the fractions RECORDED_AT."""
    own, k, begin = room.lane, in_lanes(room.rates), room.begin
    state, dense = in_lanes(room.numbers[task.first_place + task.places :]), task.nodes.shape[0]
    carried_errors, weights, last = room.carried_errors, task.recorded, task.recorded.shape[0] - 1
    for s in range(task.stages, dense):
        at_stage(task.method, s, task.states, task.width, begin, own.length, k, state)
        set_position(task.nodes[s], s, -1, printed, task, room)
        rate(s, printed, task, room)
    for lane in range(LANES):
        if own.taken[lane] > 0.0 and first + lane < recorded.shape[2]:
            step = recorded[int(own.steps[lane]), :, first + lane]
            step[0], step[1], step[2] = own.at[lane], own.length[lane], own.facing[lane]
    # There may be no integral.
    for q in range(min(task.states + 1, task.width)):
        for j in range(last + 1):
            mean = state[0]
            for lane in range(LANES):
                mean[lane] = 0.0
            for s in range(dense):
                for lane in range(LANES):
                    mean[lane] += weights[j, s] * k[s * task.width + q, lane]
            for lane in range(LANES):
                if own.taken[lane] > 0.0 and first + lane < recorded.shape[2]:
                    # Between the ends of the step the polynomial is off by its last term, as one of a lower degree
                    # would be.
                    base, by = (carried_errors, abs(mean[lane])) if j == last else (begin, mean[lane])
                    row = 3 + q * (last + 1) + j
                    recorded[int(own.steps[lane]), row, first + lane] = base[q, lane] + own.length[lane] * by
