"""Stages of an implicit step, by Newton's method for each lane."""

import math

from engine.compiling.blocks import LANES, Rows, in_lanes
from engine.compiling.decorators import inlined, routine, separate
from engine.stepping.steps.stage_rates import FOUND_TO, LEAST_LEFT, MOST_ROUNDS, NEARLY_FOUND, look, rate, set_position
from engine.stepping.steps.step_lanes import Printed, Room
from engine.stepping.walk_task import WalkTask


@separate
def find_stages(printed: Printed, task: WalkTask, room: Room) -> None:
    """Find the stages of an implicit step by Newton's method; without convergence the rates are NaN.

    The unknowns are the energy at all stages, which stays positive, or the speeds: of both sides of a coupling, or of
    an engine and of its governor's sleeve, in different units. Angles and positions follow from the rates of the
    previous iteration. A correction is compared with the sum of the magnitudes of a stage's unknowns.
    """
    own, k, begin, equations = room.lane, in_lanes(room.rates), room.begin, room.equations
    watched, kept, worst = in_lanes(room.watched), room.places, room.errors[0]
    numbers, stages, width, states = in_lanes(room.numbers), task.stages, task.width, task.states
    each, first = task.solved, 1 if task.along_time else 0
    count = stages * each
    found, slopes = count * (count + 1), task.watched + task.slopes
    set_position(0.0, 0, -1, printed, task, room)
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
            set_position(task.nodes[s], s, -1, printed, task, room)
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
        # Along time, all stages of the first iteration are at the angle of the step's start.
        unsure = math.inf if task.along_time and turn == 0 else 0.0
        pending = False
        for lane in range(LANES):
            # Converged lanes stay as they are while others iterate.
            own.able[lane] = 1.0 if worst[lane] > FOUND_TO else 0.0
            worst[lane] = unsure if worst[lane] > FOUND_TO else worst[lane]
        for s in range(stages):
            for i in range(each):
                at, q = (s * each + i) * (count + 1) + count, found + s * states + first + 2 * i
                for lane in range(LANES):
                    by, before, whole = equations[at, lane], equations[q, lane], 0.0
                    for j in range(each):
                        now, then = abs(equations[found + s * states + first + 2 * j, lane]), begin[first + 2 * j, lane]
                        # A speed may vanish within the step.
                        whole += max(now, abs(then)) if task.along_time else now
                    by = by if own.able[lane] > 0.0 else 0.0
                    size = abs(by) / whole
                    worst[lane] = worst[lane] if worst[lane] > size else size
                    left = -math.inf if task.along_time else LEAST_LEFT * before
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
    own, k, begin, equations = room.lane, in_lanes(room.rates), room.begin, room.equations
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
    own, k, begin, equations = room.lane, in_lanes(room.rates), room.begin, room.equations
    count, stages, sure = task.stages * task.solved, task.stages, room.errors[1]
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
    kept, numbers, count = room.places, in_lanes(room.numbers), task.stages * task.solved
    state, own = task.first_place + task.places, room.equations
    found = count * (count + 1) + stage * task.states
    for q in range(task.states):
        for lane in range(LANES):
            numbers[state + q, lane] = own[found + q, lane]
    if task.along_time:
        set_position(task.nodes[stage], stage, -1, printed, task, room)
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
