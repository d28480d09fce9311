"""A step of order eight in time, I·ε + ½ω²·dI/dφ = M(φ, ω, t), of all lanes of a block.

Every stage evaluates the machine at the angles and the time it comes to.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import gather, hand_out, in_lanes
from engine.compiling.decorators import driver, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import ASIDE, Memory, rows
from engine.cycle.panels.series import larger, smaller
from engine.laws.runge_kutta import DENSE_PARTS, Method
from engine.motion.moments.at_speed import KLOSS, PER_MOTOR, POLYNOMIAL, add_power, polynomial
from engine.motion.steppers.one_step import (
    ROOTS,
    ROW_OF,
    add_weighted,
    cubic_extreme,
    estimate,
    make_polynomial,
    slope_within,
    value_within,
)
from engine.motion.steppers.places import INVERSE, LOADS, Form, Source, add_share, fill_place, moments_at_speed
from engine.motion.steppers.rubbing import Rubbing, RubbingRoom, add_friction, begin_friction

# What a step is given: crank angle at the begin, way, flywheel; angle turned, speed, time; length, the way the machine
# moves, and an angle turned that no stage goes beyond.
START, WAY, WHEEL, TURNED, OMEGA, TIME, LENGTH, FACING, GOAL = range(9)
GIVEN = 9
# What is found: angle turned and speed after it, work of the motors, their moment squared over time, error by what is
# allowed, least and greatest speed on the way; then works of channels.
AFTER, OMEGA_AFTER, MOTOR, SQUARES, MISSED, SLOWEST, FASTEST = range(7)
FOUND = 7
# Rows to work in.
ERROR, REACH, CHANGE = range(3)
ROOT = CHANGE + 1 + DENSE_PARTS
SPARE = ROOT + ROOTS
# Between so many equal shares of a step extremes of the speed are searched.
LOOKS = 8
# Rows of stages: angle, speed, acceleration, moments of the motors and of everything, power of the motors, their moment
# squared, power of a channel, and moment of friction in pairs.
MOST_STAGES = 16
ANGLE, SPEED, RISE, FROM_MOTORS, MOMENT, POWER, SQUARE, CHANNEL, RUBBED = (i * MOST_STAGES for i in range(9))
STAGE_ROWS = 9 * MOST_STAGES


class TimeRoom(NamedTuple):
    """Memory for a block."""

    numbers: np.ndarray
    position: np.ndarray
    tile: np.ndarray
    drive: np.ndarray
    exponents: np.ndarray
    given: np.ndarray
    found: np.ndarray
    spare: np.ndarray
    places: np.ndarray
    stages: np.ndarray
    rubbing: RubbingRoom


def new_time_room(form: Form, parameters: int, curves: int, rubbing: RubbingRoom) -> TimeRoom:
    """Memory for machines of so many numbers and curves, beside that for friction in pairs."""
    return TimeRoom(
        rows(parameters),
        rows(3),
        rows(curves, 1),
        rows(KLOSS + PER_MOTOR * form.motors),
        rows(form.laws),
        rows(GIVEN),
        rows(FOUND + form.channels),
        rows(SPARE),
        rows(form.width * MOST_STAGES),
        rows(STAGE_ROWS, aside=ASIDE),
        rubbing,
    )


@routine
def face(form: Form, facing: Memory, places: Memory, at: int) -> None:
    """Turn the odd order of resistances, which are those of a machine that moves backwards, to the speed's own sign."""
    for lane in range(LANES):
        places[at + LOADS + 1, lane] *= facing[lane]
    if form.channels > 1:
        first = at + LOADS + POLYNOMIAL + form.laws
        for channel in range(form.channels):
            for lane in range(LANES):
                places[first + POLYNOMIAL * channel + 1, lane] *= facing[lane]


@routine
def stages_in_time(
    begin: int,
    end: int,
    wide: int,
    fill: Callable,
    source: Source,
    method: Method,
    form: Form,
    numbers: np.ndarray,
    position: np.ndarray,
    tile: np.ndarray,
    drive: Memory,
    exponents: Memory,
    given: Memory,
    places: Memory,
    stages: Memory,
    rub: Callable,
    rubbing: Rubbing,
    rubbing_room: RubbingRoom,
) -> None:
    """Stages begin … end − 1 of a step: angle, speed, acceleration, moments and powers."""
    own, block = in_lanes(position), in_lanes(numbers)
    for s in range(begin, end):
        for lane in range(wide):
            stages[ANGLE + s, lane], stages[SPEED + s, lane] = given[TURNED, lane], given[OMEGA, lane]
        for k in range(s):
            if method.matrix[s, k] != 0.0:
                add_share(wide, method.matrix[s, k], given[LENGTH], stages[SPEED + k], stages[ANGLE + s])
                add_share(wide, method.matrix[s, k], given[LENGTH], stages[RISE + k], stages[SPEED + s])
        clock = method.shares[method.place_of[s]]
        for lane in range(LANES):
            turned, goal = stages[ANGLE + s, lane], given[GOAL, lane]
            turned = smaller(turned, goal) if given[FACING, lane] > 0.0 else larger(turned, goal)
            own[0, lane] = given[START, lane] + given[WAY, lane] * turned
            now = given[TIME, lane] + clock * given[LENGTH, lane]
            for i in range(source.clocks.shape[0]):
                block[source.clocks[i], lane] = now
        at = form.width * s
        fill_place(fill, source, numbers, position, tile, given[WAY], given[WHEEL], form.width, places, at)
        face(form, given[FACING], places, at)
        moments_at_speed(
            wide, form, drive, exponents, places, at, stages[SPEED + s], stages[FROM_MOTORS + s], stages[MOMENT + s]
        )
        if rubbing.curve >= 0:
            slope = places[at + form.width - 1]
            add_friction(
                rub,
                rubbing,
                position,
                given[WAY],
                given[TIME],
                clock,
                given[LENGTH],
                places[at + INVERSE],
                slope,
                stages[SPEED + s],
                stages[MOMENT + s],
                stages[RUBBED + s],
                rubbing_room,
            )
        for lane in range(wide):
            omega, motors = stages[SPEED + s, lane], stages[FROM_MOTORS + s, lane]
            rest = stages[MOMENT + s, lane] - 0.5 * omega * omega * places[at + form.width - 1, lane]
            stages[RISE + s, lane] = 0.5 * rest * places[at + INVERSE, lane]
            stages[POWER + s, lane], stages[SQUARE + s, lane] = motors * omega, motors * motors


@routine
def judge_step_in_time(
    wide: int, method: Method, tolerance: float, given: Memory, stages: Memory, spare: Memory, found: Memory
) -> None:
    """Estimated error of a step, of its angle and its speed, by what is allowed.

    Allowed is a share of how far it goes, and of the speed or how much that changes.
    """
    step = given[LENGTH]
    for lane in range(wide):
        spare[REACH, lane], spare[CHANGE, lane] = 0.0, abs(given[OMEGA, lane])
    for s in range(method.stages):
        for lane in range(wide):
            spare[REACH, lane] = larger(abs(step[lane] * stages[SPEED + s, lane]), spare[REACH, lane])
            spare[CHANGE, lane] = larger(abs(step[lane] * stages[RISE + s, lane]), spare[CHANGE, lane])
    estimate(wide, method, step, stages, ROW_OF[SPEED], spare, ROOT, spare[ERROR])
    for lane in range(wide):
        found[MISSED, lane] = abs(spare[ERROR, lane]) / (tolerance * spare[REACH, lane])
    estimate(wide, method, step, stages, ROW_OF[RISE], spare, ROOT, spare[ERROR])
    for lane in range(wide):
        of_speed = abs(spare[ERROR, lane]) / (tolerance * spare[CHANGE, lane])
        # What doesn't move at all misses nothing.
        found[MISSED, lane] = found[MISSED, lane] if found[MISSED, lane] > of_speed else of_speed
        moves = (spare[REACH, lane] != 0.0) | (spare[CHANGE, lane] != 0.0)
        found[MISSED, lane] = found[MISSED, lane] if moves else 0.0


@routine
def look_at_speeds(wide: int, method: Method, given: Memory, stages: Memory, spare: Memory, found: Memory) -> None:
    """Least and greatest speed of a step, by the polynomial within it."""
    make_polynomial(wide, method, given[LENGTH], stages, ROW_OF[RISE], spare, CHANGE + 1)
    for lane in range(wide):
        low = high = before = given[OMEGA, lane]
        near = slope_within(spare, CHANGE + 1, lane, 0.0) / LOOKS
        for i in range(1, LOOKS + 1):
            speed = value_within(spare, CHANGE + 1, lane, given[OMEGA, lane], i / LOOKS)
            far = slope_within(spare, CHANGE + 1, lane, i / LOOKS) / LOOKS
            top, _, _ = cubic_extreme(before, speed - before, near, far)
            low, high = smaller(smaller(speed, top), low), larger(larger(speed, top), high)
            before, near = speed, far
        found[SLOWEST, lane], found[FASTEST, lane] = low, high


@driver
def step_in_time(
    begin: int,
    end: int,
    fill: Callable,
    source: Source,
    method: Method,
    form: Form,
    channel_of: np.ndarray,
    tolerance: float,
    parameters: np.ndarray,
    drives: np.ndarray,
    every_exponent: np.ndarray,
    every_given: np.ndarray,
    every_found: np.ndarray,
    rub: Callable,
    rubbing: Rubbing,
    every_rubbing: np.ndarray,
    room: TimeRoom,
) -> None:
    """Make a step of the blocks begin … end − 1 of variants: from `every_given` to `every_found`, rows of variants."""
    drive, exponents, given = in_lanes(room.drive), in_lanes(room.exponents), in_lanes(room.given)
    found, spare, places, stages = (
        in_lanes(room.found),
        in_lanes(room.spare),
        in_lanes(room.places),
        in_lanes(room.stages),
    )
    numbers, position, tile, count = room.numbers, room.position, room.tile, FOUND + form.channels
    begins = LOADS + POLYNOMIAL + form.laws
    for b in range(begin, end):
        first = b * LANES
        gather(parameters, first, in_lanes(numbers))
        gather(drives, first, drive)
        gather(every_exponent, first, exponents)
        gather(every_given, first, given)
        gather(every_rubbing, first, in_lanes(room.rubbing.numbers))
        begin_friction(room.rubbing)
        stages_in_time(
            0,
            method.stages,
            LANES,
            fill,
            source,
            method,
            form,
            numbers,
            position,
            tile,
            drive,
            exponents,
            given,
            places,
            stages,
            rub,
            rubbing,
            room.rubbing,
        )
        step = given[LENGTH]
        for row in range(count):
            for lane in range(LANES):
                found[row, lane] = 0.0
        for lane in range(LANES):
            found[AFTER, lane], found[OMEGA_AFTER, lane] = given[TURNED, lane], given[OMEGA, lane]
        add_weighted(LANES, method.weights, step, stages, ROW_OF[SPEED], found[AFTER])
        add_weighted(LANES, method.weights, step, stages, ROW_OF[RISE], found[OMEGA_AFTER])
        add_weighted(LANES, method.weights, step, stages, ROW_OF[POWER], found[MOTOR])
        add_weighted(LANES, method.weights, step, stages, ROW_OF[SQUARE], found[SQUARES])
        for channel in range(form.channels):
            for s in range(method.stages):
                at, own, speed = form.width * s, stages[CHANNEL + s], stages[SPEED + s]
                if form.channels > 1:
                    for lane in range(LANES):
                        own[lane] = polynomial(places, at + begins + POLYNOMIAL * channel, lane, speed[lane])
                    for law in range(form.laws):
                        if channel_of[law] == channel:
                            add_power(LANES, places[at + LOADS + POLYNOMIAL + law], exponents[law], speed, own)
                    for lane in range(LANES if channel == rubbing.channel else 0):
                        own[lane] += stages[RUBBED + s, lane]
                else:
                    for lane in range(LANES):
                        own[lane] = stages[MOMENT + s, lane] - stages[FROM_MOTORS + s, lane]
                for lane in range(LANES):
                    own[lane] *= speed[lane]
            add_weighted(LANES, method.weights, step, stages, ROW_OF[CHANNEL], found[FOUND + channel])
        judge_step_in_time(LANES, method, tolerance, given, stages, spare, found)
        stages_in_time(
            method.stages,
            method.dense_stages,
            LANES,
            fill,
            source,
            method,
            form,
            numbers,
            position,
            tile,
            drive,
            exponents,
            given,
            places,
            stages,
            rub,
            rubbing,
            room.rubbing,
        )
        look_at_speeds(LANES, method, given, stages, spare, found)
        hand_out(found, first, every_found[:count])
