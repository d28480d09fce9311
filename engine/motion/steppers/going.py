"""Motion in the energy form over as many steps as it takes to an end, in lanes, each step as long as its error allows.

Every step evaluates the machine where it stands; none goes across a break of the moments.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import gather, in_lanes
from engine.compiling.decorators import driver, routine
from engine.compiling.instructions import chosen, held
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import ASIDE, Memory, rows
from engine.cycle.panels.series import larger, smaller
from engine.laws.runge_kutta import DENSE_PARTS, Method
from engine.motion.moments.at_speed import KLOSS, PER_MOTOR, POLYNOMIAL, add_power_slope, polynomial_slope
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
    MISSED,
    NEXT,
    SCALE,
    SPARE,
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
    stay_between,
)
from engine.motion.steppers.one_step import (
    ENERGY,
    EQUATIONS,
    FROM_MOTORS,
    LEFT,
    MOMENT,
    MOTOR_SLOPE,
    ROUNDS,
    ROW_OF,
    SLOPE,
    SLOWNESS,
    SPEED,
    SQUARE,
    STAGE_ROWS,
    add_weighted,
    correct_stages,
    estimate,
    make_polynomial,
    make_stages,
    solve_by_factors,
)
from engine.motion.steppers.places import INVERSE, LOADS, Form, Source, fill_place
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

# Rows of a block's state beside those of a cycle that settles: cycles gone through, whole cycles and rest of one to go,
# ends of time and speed, longest step, steps since the last cycle, whether the lane moves, why it stopped, whether its
# step passes an edge, how long the last one was that was tried, and which variant it is.
CYCLES, WHOLE, REST, UNTIL, ABOVE_ALL, BELOW_ALL, LONGEST = range(STATE, STATE + 7)
TAKEN, MOVING, WHY, PASSED, TRIED, WHO = range(STATE + 7, STATE + 13)
# What a step may be off by in energy and time; then what a lane is in doubt by: energy, time, and the motors' moment
# squared over time and work.
LOST_ENERGY, LOST_TIME = range(STATE + 13, STATE + 15)
DOUBTS = OF_ENERGY, OF_CLOCK, OF_HEAT, OF_WORK = tuple(range(STATE + 15, STATE + 19))
ALL_STATE = STATE + 19
# Rows of what is found: why it stopped, cycles and angle turned in the last one, energy, time, work of the motors,
# their moment squared over time, least and greatest speed, length of the step that wasn't taken, length of the next
# one, and what it is in doubt by; then works of channels and their doubts.
IN_DOUBT = 11
FOUND = IN_DOUBT + len(DOUBTS)
# Numbers of each variant that are given, in this order.
GIVEN_ROWS = (START, WAY, WHEEL, TOLERANCE, E, WHOLE, REST, UNTIL, ABOVE_ALL, BELOW_ALL, LONGEST, TRY)

# Too near to rest for the energy form: where loads take so many times the energy per radian 1/ω is a root of the
# angle. A polynomial within a step follows it less far than what is found at its end.
TIMES_PER_RADIAN, TIMES_TO_THE_END = 4.0, 40.0
# Share of its energy that a machine may lose before it is near to rest.
MUCH = 0.5
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# After so many corrections of its stages no step is longer than the last; where they don't come to an end, shorter.
MANY_ROUNDS, SHORTER = 4.0, 0.5
# Steps over which a motor takes back so many times what disturbs the energy are refused.
STEEPEST = 4.0
# Where corrections don't even come to an end in steps of so much [rad], a motor is steep.
SHORT = 0.01
# Few variants take as many lanes as a multiple of what a processor computes at once.
VECTOR = 8
# Doubts of an energy up to this share of it change as they do when they are small, nearly.
LITTLE = 1e-2
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
        # Totals, greatest errors and sums of errors of each channel; totals before the step; and doubts.
        rows(5 * form.channels),
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
def judge_corrections(wide: int, method: Method, stages: Memory, state: Memory) -> None:
    """Add what corrections leave to the estimated error of the energy, and refuse steps in which a motor is steep.

    Where a disturbance is forgotten before the first place of a step, none of its places knows of it.
    """
    for lane in range(wide):
        missed, steepest = abs(state[ERROR, lane]) + stages[LEFT, lane], 0.0
        for s in range(method.stages):
            steepest = larger(abs(stages[SLOPE + s, lane]), steepest)
        state[ERROR, lane] = math.copysign(missed, state[ERROR, lane])
        cube = (steepest / STEEPEST) ** 3
        too_steep = (cube > 1.0) & (state[MISSED, lane] < cube**4)
        state[MISSED, lane] = cube**4 if too_steep else state[MISSED, lane]


@routine
def lose_of_energy(wide: int, steps: Memory, state: Memory) -> None:
    """What a step may be off by in energy and time: its estimated errors, but no less than those just before, fading.

    An estimate may happen to be small.
    """
    for lane in range(wide):
        length = steps[LENGTH, lane]
        for greatest, of, lost in ((OF_E, ERROR, LOST_ENERGY), (OF_TIME, ERROR_T, LOST_TIME)):
            error = abs(state[of, lane])
            # Steps that aren't taken say nothing.
            known = (state[MISSED, lane] <= 1.0) & (length > 0.0)
            rate = larger(error / length, FADING * state[greatest, lane])
            state[greatest, lane] = rate if known else state[greatest, lane]
            state[lost, lane] = larger(error, state[greatest, lane] * length)


@routine
def follow_doubts(wide: int, method: Method, step: Memory, stages: Memory, state: Memory) -> None:
    """Carry over a step what a lane is in doubt by, and add what the step may be off by.

    All to the side of a machine that turns faster, for nothing to make up for another. What changes the energy by
    little grows or fades as the motion does, by equations whose factors are those of the stages' corrections; the
    faster a machine turns, the less time it takes, and the less its motors give. Source: E. Hairer, S. P. Nørsett and
    G. Wanner, Solving Ordinary Differential Equations I, section I.14.
    """
    count = method.stages
    for s in range(count):
        for lane in range(wide):
            stages[EQUATIONS + s, lane] = state[OF_ENERGY, lane]
    solve_by_factors(wide, count, stages)
    for s in range(count):
        for lane in range(wide):
            change, energy, slowness = stages[EQUATIONS + s, lane], stages[ENERGY + s, lane], stages[SLOWNESS + s, lane]
            motors, gain = stages[FROM_MOTORS + s, lane], stages[MOTOR_SLOPE + s, lane] * change
            # Rows of a step that isn't taken may hold anything.
            weight = method.weights[s] if step[lane] > 0.0 else 0.0
            later = -0.5 * change / energy * slowness
            state[OF_CLOCK, lane] += weight * step[lane] * later if weight != 0.0 else 0.0
            state[OF_WORK, lane] += weight * gain if weight != 0.0 else 0.0
            heat = motors * (2.0 * gain * slowness + step[lane] * motors * later)
            state[OF_HEAT, lane] += weight * heat if weight != 0.0 else 0.0
    for lane in range(wide):
        after = stages[EQUATIONS + count - 1, lane] + state[LOST_ENERGY, lane]
        # So great a doubt doesn't change as it does when it is small.
        after = after if abs(after) <= LITTLE * state[E_AFTER, lane] else math.nan
        state[OF_ENERGY, lane] = after if step[lane] > 0.0 else state[OF_ENERGY, lane]
        state[OF_CLOCK, lane] -= state[LOST_TIME, lane] if step[lane] > 0.0 else 0.0
    lose(wide, method, step, ROW_OF[FROM_MOTORS], state, stages, state[OF_WORK])
    lose(wide, method, step, ROW_OF[SQUARE], state, stages, state[OF_HEAT])


@routine
def follow_doubts_of_works(
    wide: int,
    method: Method,
    form: Form,
    channel_of: np.ndarray,
    exponents: Memory,
    places: Memory,
    step: Memory,
    state: Memory,
    stages: Memory,
    works: Memory,
) -> None:
    """The same of the works of all channels, from what the energies of the stages change by."""
    begin, slope = LOADS + POLYNOMIAL + form.laws, state[SPARE]
    for channel in range(form.channels):
        doubts, errors = works[4 * form.channels + channel], works[2 * form.channels + channel]
        for s in range(method.stages):
            at, speed = form.width * s, stages[SPEED + s]
            for lane in range(wide):
                slope[lane] = polynomial_slope(places, at + begin + POLYNOMIAL * channel, lane, speed[lane])
            for law in range(form.laws):
                if channel_of[law] == channel:
                    add_power_slope(wide, places[at + LOADS + POLYNOMIAL + law], exponents[law], speed, slope)
            for lane in range(wide):
                by_energy = 0.5 * places[at + INVERSE, lane] / speed[lane] * slope[lane]
                gain = method.weights[s] * step[lane] * by_energy * stages[EQUATIONS + s, lane]
                doubts[lane] += gain if step[lane] > 0.0 else 0.0
        for lane in range(wide):
            doubts[lane] -= errors[lane] if step[lane] > 0.0 else 0.0


@routine
def keep_doubts(wide: int, steps: Memory, state: Memory) -> None:
    """Keep the greatest estimated errors of energy and time of the steps just before, fading, without changing any."""
    for lane in range(wide):
        # Steps that aren't taken say nothing.
        known = (state[MISSED, lane] <= 1.0) & (steps[LENGTH, lane] > 0.0)
        for greatest, of in ((OF_E, ERROR), (OF_TIME, ERROR_T)):
            doubt = larger(abs(state[of, lane]), FADING * state[greatest, lane])
            state[greatest, lane] = doubt if known else state[greatest, lane]


@routine
def lose(wide: int, method: Method, step: Memory, row: int, state: Memory, stages: Memory, total: Memory) -> None:
    """Take the estimated error of an integral over a step from its total.

    To the same side as the energy: the faster a machine turns, the less motors give, and the more loads take.
    """
    estimate(wide, method, step, stages, row, state, SPARE, state[ERROR])
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
        stay_between(lane, k, edges, sides, steps, 0)
        state[PASSED, lane] = 1.0 if parts <= 1.0 else 0.0


@routine
def decide(
    wide: int, method: Method, times: float, places: Memory, row: int, steps: Memory, state: Memory, stages: Memory
) -> None:
    """Take the step where it misses little enough and passes no end: what follows for each lane.

    LENGTH becomes zero where it isn't taken. `row` is where the end of the step stands among the places.
    """
    for lane in range(wide):
        if state[MOVING, lane] == 0.0:
            continue
        length, missed = steps[LENGTH, lane], state[MISSED, lane]
        lost = not missed < math.inf
        good = (missed <= 1.0) | ((length < SHORTEST) & (not lost))
        slowly = method.implicit and not method.newton
        share = (SHORTER if slowly else SHRINK) if lost else GROW
        if missed > 0.0 and not lost:
            share = smaller(larger(SAFETY * missed ** (-method.exponent), SHRINK), GROW)
        if slowly and good and stages[ROUNDS, lane] > MANY_ROUNDS:
            share = smaller(share, 1.0)
        state[TRIED, lane] = length
        # How far the next one goes follows from what was tried, were it cut short by an edge; where corrections are
        # many, the next one is shorter.
        shorter = slowly and share < 1.0 and length >= SHORTEST
        state[TRY, lane] = larger(length * share, state[TRY, lane]) if good and not shorter else length * share
        energy, speed = state[E_AFTER, lane], math.sqrt(state[E_AFTER, lane] * places[row + INVERSE, lane])
        why, takes = -1.0, -stages[MOMENT, lane]
        slows = takes > times * state[E, lane]
        # A steep motor answers before much of the energy is gone.
        slows &= not (method.newton and takes < -MUCH * state[E, lane] * stages[SLOPE, lane])
        if good and slows and state[BELOW_ALL, lane] >= 0.0:
            why = float(NEAR_REST)
        elif not good:
            state[TAKEN, lane] += 1.0
            too_many = (state[TAKEN, lane] > larger(MOST_EXPLICIT, FAR / state[LONGEST, lane])) and not method.newton
            why = float(NEAR_REST) if length < SHORTEST else (float(STIFF) if too_many else -1.0)
            why = float(STIFF) if slowly and lost and length < SHORT else why
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
        if state[TAKEN, lane] > larger(MOST_EXPLICIT, FAR / state[LONGEST, lane]) and not method.newton:
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


@routine
def ready_lane(lane: int, variant: int, moves: bool, edges: Memory, count: int, state: Memory) -> None:
    """Make a lane ready whose numbers are those of a variant, and whose state is zero but for what is given."""
    k = 1
    while k < count - 1 and edges[k, lane] <= 0.0:
        k += 1
    state[NEXT, lane], state[SLOWEST, lane], state[FASTEST, lane] = float(k), math.inf, -math.inf
    ended = state[WHOLE, lane] <= 0.0 and state[REST, lane] <= 0.0
    state[MOVING, lane], state[WHY, lane] = 0.0 if ended or not moves else 1.0, float(ANGLE)
    state[WHO, lane] = float(variant)


@routine
def take_over(
    lane: int,
    variant: int,
    parameters: np.ndarray,
    drives: np.ndarray,
    every_exponent: np.ndarray,
    every_edge: np.ndarray,
    every_side: np.ndarray,
    every_given: np.ndarray,
    numbers: Memory,
    drive: Memory,
    exponents: Memory,
    edges: Memory,
    sides: Memory,
    state: Memory,
    totals: int,
    works: Memory,
) -> None:
    """Let a lane that came to its end go on with another variant."""
    for i in range(parameters.shape[0]):
        numbers[i, lane] = parameters[i, variant]
    for i in range(drives.shape[0]):
        drive[i, lane] = drives[i, variant]
    for i in range(every_exponent.shape[0]):
        exponents[i, lane] = every_exponent[i, variant]
    for i in range(every_edge.shape[0]):
        edges[i, lane], sides[i, lane] = every_edge[i, variant], every_side[i, variant]
    for i in range(ALL_STATE):
        state[i, lane] = 0.0
    for i in range(len(GIVEN_ROWS)):
        state[GIVEN_ROWS[i], lane] = every_given[i, variant]
    for i in range(totals):
        works[i, lane] = 0.0
    ready_lane(lane, variant, True, edges, every_edge.shape[0], state)


@routine
def hand_over(lane: int, shorter: bool, channels: int, works: Memory, state: Memory, found: np.ndarray) -> None:
    """Write down what was found of the variant in a lane; with energy and time changed where it is `shorter`."""
    v = int(state[WHO, lane])
    if shorter:
        # What a motion forgets within the run, no run of longer steps shows; and their last may be as short.
        state[E, lane] += state[OF_E, lane]
        state[TIME, lane] -= state[OF_TIME, lane]
    found[0, v], found[1, v], found[2, v] = state[WHY, lane], state[CYCLES, lane], state[TURNED, lane]
    found[3, v], found[4, v], found[5, v] = state[E, lane], state[TIME, lane], state[MOTOR, lane]
    found[6, v], found[7, v], found[8, v] = state[SQUARES, lane], state[SLOWEST, lane], state[FASTEST, lane]
    found[9, v], found[10, v] = state[TRIED, lane], state[TRY, lane]
    for i in range(len(DOUBTS)):
        found[IN_DOUBT + i, v] = state[DOUBTS[i], lane]
    for channel in range(channels):
        found[FOUND + channel, v] = works[channel, lane]
        found[FOUND + channels + channel, v] = works[4 * channels + channel, lane]


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

    `every_given` (…, variants) holds the numbers of `GIVEN_ROWS`; `found` (FOUND + 2 · channels, variants) is for what
    is found, with least and greatest speed where `extremes` are wanted, and with doubts where stages are corrected;
    `record` (3, nodes, variants) as of `settle`, at `asked` angles turned in the first cycle. Where it is `doubtful`,
    every step is changed by its estimated error; after those by Newton's method the end is, by what the last steps are
    estimated to miss.
    """
    drive, exponents = in_lanes(room.drive), in_lanes(room.exponents)
    edges, sides, given = in_lanes(room.edges), in_lanes(room.sides), in_lanes(room.given)
    state, steps, places = in_lanes(room.state), in_lanes(room.steps), in_lanes(room.places)
    stages, works, parts = in_lanes(room.stages), in_lanes(room.works), in_lanes(room.parts)
    numbers, position, tile, width, count = room.numbers, room.position, room.tile, form.width, every_edge.shape[0]
    packed, row, within = in_lanes(room.packed), width * (method.stages - 1), extremes or asked.shape[0] > 0
    # Places of the polynomial within a step come last.
    count_of_places = method.shares.shape[0] if within or method.newton else method.stages
    corrected = method.implicit and not method.newton
    # Where steps are looked within, what is recorded of a block lies side by side.
    times = TIMES_TO_THE_END if method.implicit and not within else TIMES_PER_RADIAN
    blocks, shorter = 1 if within else end - begin, doubtful and method.newton
    for b in range(begin, end, blocks):
        first, last = b * LANES, min((b + blocks) * LANES, found.shape[1])
        own = min(LANES, last - first)
        following = first + own
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
        for channel in range(5 * form.channels):
            for lane in range(LANES):
                works[channel, lane] = 0.0
        for lane in range(LANES):
            ready_lane(lane, first + lane, lane < own, edges, count, state)
        moving = 0.0
        for lane in range(wide):
            moving += state[MOVING, lane]
        while moving > 0.0 or following < last:
            for lane in range(own):
                while state[MOVING, lane] == 0.0 and following < last:
                    hand_over(lane, shorter, form.channels, works, state, found)
                    take_over(
                        lane,
                        following,
                        parameters,
                        drives,
                        every_exponent,
                        every_edge,
                        every_side,
                        every_given,
                        in_lanes(numbers),
                        drive,
                        exponents,
                        edges,
                        sides,
                        state,
                        5 * form.channels,
                        works,
                    )
                    following += 1
                    moving += state[MOVING, lane]
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
            if corrected:
                correct_stages(wide, method, form, drive, exponents, places, state[E], step, state[TOLERANCE], stages)
            else:
                make_stages(
                    ROW_OF[0], method.stages, wide, method, form, drive, exponents, places, 0, state[E], step, stages
                )
            judge_step(wide, method, cycle, state, steps, 0, stages)
            if corrected:
                judge_corrections(wide, method, stages, state)
            add_weighted(wide, method.weights, step, stages, ROW_OF[MOMENT], state[E_AFTER])
            add_weighted(wide, method.weights, step, stages, ROW_OF[SLOWNESS], state[T_AFTER])
            if doubtful and method.newton:
                keep_doubts(wide, steps, state)
            elif doubtful or corrected:
                lose_of_energy(wide, steps, state)
            if doubtful and not method.newton:
                # To the side of a machine that turns faster: nothing makes up for another, and what follows in the run
                # grows or fades as the motion does.
                for lane in range(wide):
                    state[E_AFTER, lane] += state[LOST_ENERGY, lane]
                    state[T_AFTER, lane] -= state[LOST_TIME, lane]
            decide(wide, method, times, places, row, steps, state, stages)
            for s in range(method.stages):
                for lane in range(wide):
                    # A step that isn't taken may have led nowhere.
                    motors = chosen(step[lane] > 0.0, held(stages[FROM_MOTORS + s, lane]), 0.0)
                    slowness = chosen(step[lane] > 0.0, stages[SLOWNESS + s, lane], 0.0)
                    stages[FROM_MOTORS + s, lane] = motors
                    stages[SQUARE + s, lane] = motors * motors * slowness
            add_weighted(wide, method.weights, step, stages, ROW_OF[FROM_MOTORS], state[MOTOR])
            add_weighted(wide, method.weights, step, stages, ROW_OF[SQUARE], state[SQUARES])
            if corrected and not doubtful:
                follow_doubts(wide, method, step, stages, state)
            if doubtful and not method.newton:
                lose(wide, method, step, ROW_OF[FROM_MOTORS], state, stages, state[MOTOR])
                lose(wide, method, step, ROW_OF[SQUARE], state, stages, state[SQUARES])
            if form.channels > 1:
                for channel in range(form.channels):
                    for lane in range(wide):
                        works[3 * form.channels + channel, lane] = works[channel, lane]
                own_doubt = 0.0 if corrected or (doubtful and not method.newton) else 1.0
                add_cycle_works(
                    wide, own_doubt, method, form, channel_of, exponents, places, 0, step, state, stages, works
                )
                if corrected and not doubtful:
                    follow_doubts_of_works(
                        wide, method, form, channel_of, exponents, places, step, state, stages, works
                    )
                for channel in range(form.channels):
                    for lane in range(wide):
                        errors = works[2 * form.channels + channel, lane]
                        works[channel, lane] -= errors if doubtful else 0.0
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
                    record_within(method.newton, first, own, asked, record, 0, False, steps, state, stages, parts)
                if extremes:
                    look_for_extremes(wide, 0, method, form, drive, exponents, places, 0, steps, state, stages, parts)
            for lane in range(wide):
                taken = step[lane] > 0.0
                state[E, lane] = chosen(taken, state[E_AFTER, lane], held(state[E, lane]))
                state[TIME, lane] = chosen(taken, state[T_AFTER, lane], held(state[TIME, lane]))
            moving = move_on(wide, edges, count, state, steps)
        for lane in range(own):
            hand_over(lane, shorter, form.channels, works, state, found)
