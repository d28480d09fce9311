"""Motion in the energy form over as many steps as it takes to an end, in lanes, each step as long as its error allows.

Every step evaluates the machine where it stands; none goes across a break of the moments.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import driver, routine
from engine.compiling.tiles import LANES
from engine.cycle.driver import gather, hand_out
from engine.cycle.panels.lanes import ASIDE, Memory, in_lanes, rows
from engine.cycle.panels.series import larger, smaller
from engine.motion.moments.at_speed import KLOSS, PER_MOTOR
from engine.motion.steppers.energy_form import ABOVE, ANGLE, BELOW, NEAR_REST, STIFF
from engine.motion.steppers.energy_form import TIME as TIME_OVER
from engine.motion.steppers.mesh import (
    E_AFTER,
    ERROR,
    ERROR_T,
    FROM,
    HIGH,
    LENGTH,
    LOW,
    NEXT,
    OTHER,
    SCALE,
    START,
    STEP_ROWS,
    TOLERANCE,
    TRY,
    TURNED,
    WAY,
    WHEEL,
    WORK,
    E,
    fill_step,
    judge_step,
)
from engine.motion.steppers.one_step import (
    FROM_MOTORS,
    MOMENT,
    ROW_OF,
    SLOWNESS,
    SPEED,
    SQUARE,
    STAGE_ROWS,
    add_weighted,
    estimate,
    make_polynomial,
    make_stages,
)
from engine.motion.steppers.places import INVERSE, Form, Source, fill_place
from engine.motion.steppers.settling import (
    FASTEST,
    MOTOR,
    OF_E,
    OF_TIME,
    SLOWEST,
    SQUARES,
    STATE,
    T_AFTER,
    TIME,
    add_cycle_works,
    look_for_extremes,
    record_within,
)
from engine.motion.steppers.tableaux import DENSE_PARTS, Method

# Rows of a block's state beside those of a cycle that settles: cycles gone through, whole cycles and rest of one to go,
# ends of time and speed, longest step, steps since the last cycle, whether the lane moves, and why it stopped.
CYCLES, WHOLE, REST, UNTIL, ABOVE_ALL, BELOW_ALL, LONGEST, TAKEN, MOVING, WHY, PASSED, TRIED = range(STATE, STATE + 12)
ALL_STATE = STATE + 12
# Rows of what is found: why it stopped, cycles and angle turned in the last one, energy, time, work of the motors,
# their moment squared over time, least and greatest speed, length of the step that wasn't taken, length of the next
# one; then works of channels.
FOUND = 11
# Numbers of each variant that are given, in this order.
GIVEN_ROWS = (START, WAY, WHEEL, TOLERANCE, E, WHOLE, REST, UNTIL, ABOVE_ALL, BELOW_ALL, LONGEST, TRY)

# Too near to rest for the energy form: where loads take so many times the energy per radian 1/ω is a root of the
# angle.
TIMES_PER_RADIAN = 4.0
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# Few variants take as many lanes as a multiple of what a processor computes at once.
VECTOR = 8
# Share of the greatest error by the angle that is kept from step to step.
FADING = 0.9
# Steps of a cycle after which an explicit method is given up, and a step that is taken whatever it misses [rad].
MOST_EXPLICIT, SHORTEST = 400.0, 1e-9
# Steps that are told to be short aren't so many for the motor's sake: all together would turn so far [rad].
FAR = 100.0


class GoingRoom(NamedTuple):
    """Memory for a block."""

    numbers: np.ndarray
    position: np.ndarray
    tile: np.ndarray
    drive: np.ndarray
    exponents: np.ndarray
    edges: np.ndarray
    sides: np.ndarray
    given: np.ndarray
    state: np.ndarray
    steps: np.ndarray
    places: np.ndarray
    packed: np.ndarray
    stages: np.ndarray
    works: np.ndarray
    parts: np.ndarray


def new_going_room(form: Form, parameters: int, edges: int, curves: int, method: Method) -> GoingRoom:
    """Memory for machines of so many numbers, edges and curves."""
    return GoingRoom(
        rows(parameters),
        rows(3),
        rows(curves, 1),
        rows(KLOSS + PER_MOTOR * form.motors),
        rows(form.laws),
        rows(edges),
        rows(edges),
        rows(len(GIVEN_ROWS)),
        rows(ALL_STATE),
        rows(STEP_ROWS),
        rows(form.width * method.shares.size),
        rows(form.width),
        rows(STAGE_ROWS, aside=ASIDE),
        # Totals, greatest errors and sums of errors of each channel; and totals before the step.
        rows(4 * form.channels),
        rows(2 * DENSE_PARTS),
    )


@routine
def repeat_few(own: int, count: int, numbers: Memory, state: Memory) -> None:
    """Repeat the first lanes of a block in the others: so many numbers, and what the places of a step need."""
    for lane in range(own, LANES):
        for row in range(count):
            numbers[row, lane] = numbers[row, lane % own]
        state[WAY, lane], state[WHEEL, lane] = state[WAY, lane % own], state[WHEEL, lane % own]


@routine
def fill_few(
    own: int,
    method: Method,
    fill: Callable,
    source: Source,
    numbers: np.ndarray,
    position: np.ndarray,
    tile: np.ndarray,
    width: int,
    state: Memory,
    steps: Memory,
    places: Memory,
    packed: Memory,
) -> None:
    """Fill all places of a step of few variants at once, each place in a lane of its own."""
    at, last = in_lanes(position), method.shares.shape[0] - 1
    for lane in range(LANES):
        s, v = min(lane // own, last), lane % own
        turned = steps[FROM, v] + method.shares[s] * steps[LENGTH, v]
        turned = smaller(larger(turned, steps[LOW, v]), steps[HIGH, v])
        at[0, lane] = state[START, v] + state[WAY, v] * turned
    fill_place(fill, source, numbers, position, tile, state[WAY], state[WHEEL], width, packed, 0)
    for s in range(last + 1):
        for row in range(width):
            for v in range(own):
                places[width * s + row, v] = packed[row, s * own + v]


@routine
def lose_of_energy(wide: int, steps: Memory, state: Memory) -> None:
    """Change energy and time after a step by their estimated errors, to the side of a machine that turns faster.

    What follows in the run grows or fades as the motion does; for all go to one side, nothing makes up for another.
    The greatest of the steps just before, fading, is the least: an estimate may happen to be small.
    """
    for lane in range(wide):
        length = steps[LENGTH, lane]
        for greatest, of in ((OF_E, ERROR), (OF_TIME, ERROR_T)):
            error = abs(state[of, lane])
            # Steps that aren't taken say nothing.
            known = (state[OTHER, lane] <= 1.0) & (length > 0.0)
            rate = larger(error / length, FADING * state[greatest, lane])
            state[greatest, lane] = rate if known else state[greatest, lane]
        state[E_AFTER, lane] += larger(abs(state[ERROR, lane]), state[OF_E, lane] * length)
        state[T_AFTER, lane] -= larger(abs(state[ERROR_T, lane]), state[OF_TIME, lane] * length)


@routine
def keep_doubts(wide: int, steps: Memory, state: Memory) -> None:
    """Keep the greatest estimated errors of energy and time of the steps just before, fading, without changing any."""
    for lane in range(wide):
        # Steps that aren't taken say nothing.
        known = (state[OTHER, lane] <= 1.0) & (steps[LENGTH, lane] > 0.0)
        for greatest, of in ((OF_E, ERROR), (OF_TIME, ERROR_T)):
            doubt = larger(abs(state[of, lane]), FADING * state[greatest, lane])
            state[greatest, lane] = doubt if known else state[greatest, lane]


@routine
def lose(wide: int, method: Method, step: Memory, row: int, state: Memory, stages: Memory, total: Memory) -> None:
    """Take the estimated error of an integral over a step from its total.

    To the same side as the energy: the faster a machine turns, the less motors give, and the more loads take.
    """
    estimate(wide, method, step, stages, row, state[OTHER], state[ERROR])
    for lane in range(wide):
        total[lane] -= abs(state[ERROR, lane])


@routine
def choose_next(wide: int, edges: Memory, sides: Memory, state: Memory, steps: Memory) -> None:
    """Length of each lane's next step: that to try, or an equal part of the way to the next edge or the goal."""
    for lane in range(wide):
        k, turned = int(state[NEXT, lane]), state[TURNED, lane]
        goal = state[REST, lane] if state[CYCLES, lane] >= state[WHOLE, lane] else math.inf
        end = smaller(edges[k, lane], goal)
        rest = end - turned
        parts = math.ceil(rest / smaller(state[TRY, lane], state[LONGEST, lane]) * (1.0 - 1e-9))
        steps[LENGTH, lane] = rest / parts if parts > 1.0 else rest
        steps[LENGTH, lane] = steps[LENGTH, lane] if state[MOVING, lane] > 0.0 else 0.0
        steps[FROM, lane] = turned
        steps[LOW, lane] = edges[k - 1, lane] + sides[k - 1, lane]
        steps[HIGH, lane] = edges[k, lane] - sides[k, lane]
        state[PASSED, lane] = 1.0 if parts <= 1.0 else 0.0


@routine
def decide(wide: int, implicit: bool, places: Memory, row: int, steps: Memory, state: Memory, stages: Memory) -> None:
    """Take the step where it misses little enough and passes no end: what follows for each lane.

    LENGTH becomes zero where it isn't taken. `row` is where the end of the step stands among the places.
    """
    for lane in range(wide):
        if state[MOVING, lane] == 0.0:
            continue
        length, missed = steps[LENGTH, lane], state[OTHER, lane]
        lost = not missed < math.inf
        good = (missed <= 1.0) | ((length < SHORTEST) & (not lost))
        share = SHRINK if lost else GROW
        if missed > 0.0 and not lost:
            share = smaller(larger(SAFETY / math.sqrt(math.sqrt(math.sqrt(missed))), SHRINK), GROW)
        state[TRIED, lane] = length
        # How far the next one goes follows from what was tried, were it cut short by an edge.
        state[TRY, lane] = larger(length * share, state[TRY, lane]) if good else length * share
        energy, speed = state[E_AFTER, lane], math.sqrt(state[E_AFTER, lane] * places[row + INVERSE, lane])
        why = -1.0
        if -stages[MOMENT, lane] > TIMES_PER_RADIAN * state[E, lane] and state[BELOW_ALL, lane] >= 0.0:
            why = float(NEAR_REST)
        elif not good:
            state[TAKEN, lane] += 1.0
            too_many = (state[TAKEN, lane] > larger(MOST_EXPLICIT, FAR / state[LONGEST, lane])) and not implicit
            why = float(NEAR_REST) if length < SHORTEST else (float(STIFF) if too_many else -1.0)
        elif not energy > 0.0:
            why = float(NEAR_REST)
        elif speed >= state[ABOVE_ALL, lane]:
            why = float(ABOVE)
        elif speed <= state[BELOW_ALL, lane]:
            why = float(BELOW)
        elif state[T_AFTER, lane] >= state[UNTIL, lane]:
            why = float(TIME_OVER)
        if why >= 0.0:
            state[WHY, lane], state[MOVING, lane] = why, 0.0
        if why >= 0.0 or not good:
            steps[LENGTH, lane] = 0.0
            state[E_AFTER, lane], state[T_AFTER, lane] = state[E, lane], state[TIME, lane]
            continue
        state[SCALE, lane], state[TAKEN, lane] = state[WORK, lane], state[TAKEN, lane] + 1.0
        if state[TAKEN, lane] > larger(MOST_EXPLICIT, FAR / state[LONGEST, lane]) and not implicit:
            state[WHY, lane], state[MOVING, lane] = float(STIFF), 0.0


@routine
def move_on(wide: int, edges: Memory, count: int, state: Memory, steps: Memory) -> float:
    """Move lanes on over the step they take; how many still move."""
    moving = 0.0
    for lane in range(wide):
        length, k = steps[LENGTH, lane], int(state[NEXT, lane])
        if length > 0.0:
            at_goal = state[CYCLES, lane] >= state[WHOLE, lane] and state[REST, lane] <= edges[k, lane]
            end = state[REST, lane] if at_goal else edges[k, lane]
            passed = state[PASSED, lane] > 0.0
            state[TURNED, lane] = end if passed else state[TURNED, lane] + length
            if passed and at_goal:
                state[WHY, lane], state[MOVING, lane] = float(ANGLE), 0.0
            while k < count and edges[k, lane] <= state[TURNED, lane]:
                k += 1
            if k >= count and state[MOVING, lane] > 0.0:
                state[CYCLES, lane], state[TURNED, lane], state[TAKEN, lane] = state[CYCLES, lane] + 1.0, 0.0, 0.0
                k = 1
                while k < count and edges[k, lane] <= 0.0:
                    k += 1
                if state[CYCLES, lane] >= state[WHOLE, lane] and state[REST, lane] <= 0.0:
                    state[WHY, lane], state[MOVING, lane] = float(ANGLE), 0.0
            state[NEXT, lane] = float(k)
        moving += state[MOVING, lane]
    return moving


@driver
def go_on_to_end(
    begin: int,
    end: int,
    fill: Callable,
    source: Source,
    method: Method,
    form: Form,
    channel_of: np.ndarray,
    cycle: float,
    doubtful: bool,
    parameters: np.ndarray,
    drives: np.ndarray,
    every_exponent: np.ndarray,
    every_edge: np.ndarray,
    every_side: np.ndarray,
    every_given: np.ndarray,
    asked: np.ndarray,
    record: np.ndarray,
    found: np.ndarray,
    extremes: bool,
    room: GoingRoom,
) -> None:
    """Carry the blocks begin … end − 1 of variants to their ends.

    `every_given` (…, variants) holds the numbers of `GIVEN_ROWS`; `found` (FOUND + channels, variants) receives what is
    found, with least and greatest speed where `extremes` are wanted; `record` (3, nodes, variants) as of `settle`, at
    `asked` angles turned in the first cycle. Where it is `doubtful`, every explicit step is changed by its estimated
    error; after implicit ones the end is, by what the last steps are estimated to miss.
    """
    drive, exponents = in_lanes(room.drive), in_lanes(room.exponents)
    edges, sides, given = in_lanes(room.edges), in_lanes(room.sides), in_lanes(room.given)
    state, steps, places = in_lanes(room.state), in_lanes(room.steps), in_lanes(room.places)
    stages, works, parts = in_lanes(room.stages), in_lanes(room.works), in_lanes(room.parts)
    numbers, position, tile, width, count = room.numbers, room.position, room.tile, form.width, every_edge.shape[0]
    packed, row, within = in_lanes(room.packed), width * (method.stages - 1), extremes or asked.shape[0] > 0
    # Places of the polynomial within a step come last.
    count_of_places = method.shares.shape[0] if within or method.implicit else method.stages
    for b in range(begin, end):
        first = b * LANES
        own = min(LANES, found.shape[1] - first)
        wide = min(LANES, VECTOR * ((own + VECTOR - 1) // VECTOR))
        gather(parameters, first, in_lanes(numbers))
        gather(drives, first, drive)
        gather(every_exponent, first, exponents)
        gather(every_edge, first, edges)
        gather(every_side, first, sides)
        gather(every_given, first, given)
        for r in range(ALL_STATE):
            for lane in range(LANES):
                state[r, lane] = 0.0
        for i in range(len(GIVEN_ROWS)):
            for lane in range(LANES):
                state[GIVEN_ROWS[i], lane] = given[i, lane]
        repeat_few(own, parameters.shape[0], in_lanes(numbers), state)
        for channel in range(4 * form.channels):
            for lane in range(LANES):
                works[channel, lane] = 0.0
        for lane in range(LANES):
            k = 1
            while k < count - 1 and edges[k, lane] <= 0.0:
                k += 1
            state[NEXT, lane], state[SLOWEST, lane], state[FASTEST, lane] = float(k), math.inf, -math.inf
            ended = state[WHOLE, lane] <= 0.0 and state[REST, lane] <= 0.0
            state[MOVING, lane], state[WHY, lane] = 0.0 if ended or lane >= own else 1.0, float(ANGLE)
        moving = 0.0
        for lane in range(wide):
            moving += state[MOVING, lane]
        while moving > 0.0:
            choose_next(wide, edges, sides, state, steps)
            step = steps[LENGTH]
            if own * count_of_places <= LANES:
                fill_few(own, method, fill, source, numbers, position, tile, width, state, steps, places, packed)
            else:
                fill_step(
                    0,
                    count_of_places,
                    method,
                    fill,
                    source,
                    numbers,
                    position,
                    tile,
                    width,
                    state,
                    steps,
                    0,
                    places,
                    0,
                )
            for lane in range(wide):
                state[E_AFTER, lane], state[T_AFTER, lane] = state[E, lane], state[TIME, lane]
            make_stages(
                ROW_OF[0], method.stages, wide, method, form, drive, exponents, places, 0, state[E], step, stages
            )
            judge_step(wide, method, cycle, state, steps, 0, stages)
            add_weighted(wide, method.weights, step, stages, ROW_OF[MOMENT], state[E_AFTER])
            add_weighted(wide, method.weights, step, stages, ROW_OF[SLOWNESS], state[T_AFTER])
            if doubtful and method.implicit:
                keep_doubts(wide, steps, state)
            elif doubtful:
                lose_of_energy(wide, steps, state)
            decide(wide, method.implicit, places, row, steps, state, stages)
            for s in range(method.stages):
                for lane in range(wide):
                    motors = stages[FROM_MOTORS + s, lane]
                    stages[SQUARE + s, lane] = motors * motors * stages[SLOWNESS + s, lane]
                    # A step that isn't taken may have led nowhere.
                    taken = step[lane] > 0.0
                    stages[SQUARE + s, lane] = stages[SQUARE + s, lane] if taken else 0.0
                    stages[FROM_MOTORS + s, lane] = motors if taken else 0.0
            add_weighted(wide, method.weights, step, stages, ROW_OF[FROM_MOTORS], state[MOTOR])
            add_weighted(wide, method.weights, step, stages, ROW_OF[SQUARE], state[SQUARES])
            if doubtful and not method.implicit:
                lose(wide, method, step, ROW_OF[FROM_MOTORS], state, stages, state[MOTOR])
                lose(wide, method, step, ROW_OF[SQUARE], state, stages, state[SQUARES])
            if form.channels > 1:
                for channel in range(form.channels):
                    for lane in range(wide):
                        works[3 * form.channels + channel, lane] = works[channel, lane]
                own_doubt = 0.0 if doubtful and not method.implicit else 1.0
                add_cycle_works(
                    wide, own_doubt, method, form, channel_of, exponents, places, 0, step, state, stages, works
                )
                for channel in range(form.channels):
                    for lane in range(wide):
                        # Where there is none, the estimated error of the step.
                        works[channel, lane] -= works[2 * form.channels + channel, lane]
                        works[2 * form.channels + channel, lane] = 0.0
                        before = works[3 * form.channels + channel, lane]
                        works[channel, lane] = works[channel, lane] if step[lane] > 0.0 else before
            if within:
                make_stages(
                    method.stages,
                    method.dense_stages,
                    wide,
                    method,
                    form,
                    drive,
                    exponents,
                    places,
                    0,
                    state[E],
                    step,
                    stages,
                )
                make_polynomial(wide, method, step, stages, ROW_OF[MOMENT], parts, ROW_OF[0])
                if asked.shape[0] > 0:
                    for s in range(method.stages, method.dense_stages):
                        for lane in range(wide):
                            stages[SLOWNESS + s, lane] = 1.0 / stages[SPEED + s, lane]
                    make_polynomial(wide, method, step, stages, ROW_OF[SLOWNESS], parts, ROW_OF[DENSE_PARTS])
                    record_within(method.implicit, first, own, asked, record, 0, False, steps, state, stages, parts)
                if extremes:
                    look_for_extremes(wide, 0, method, form, drive, exponents, places, 0, steps, state, stages, parts)
            for lane in range(wide):
                taken = step[lane] > 0.0
                state[E, lane] = state[E_AFTER, lane] if taken else state[E, lane]
                state[TIME, lane] = state[T_AFTER, lane] if taken else state[TIME, lane]
            moving = move_on(wide, edges, count, state, steps)
        if doubtful and method.implicit:
            # What a motion forgets within the run, no run of longer steps shows; and their last may be as short.
            for lane in range(own):
                state[E, lane] += state[OF_E, lane]
                state[TIME, lane] -= state[OF_TIME, lane]
        for lane in range(own):
            v = first + lane
            found[0, v], found[1, v], found[2, v] = state[WHY, lane], state[CYCLES, lane], state[TURNED, lane]
            found[3, v], found[4, v], found[5, v] = state[E, lane], state[TIME, lane], state[MOTOR, lane]
            found[6, v], found[7, v], found[8, v] = state[SQUARES, lane], state[SLOWEST, lane], state[FASTEST, lane]
            found[9, v], found[10, v] = state[TRIED, lane], state[TRY, lane]
        hand_out(form.channels, works, first, FOUND, found)
