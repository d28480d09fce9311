"""A step of order eight in time of both sides of a coupling, of all lanes of a block.

Every stage evaluates the machine at the angles and the time it comes to. Nothing on the shaft depends on its angle, so
that what loads it is a place like the crank's, but the same throughout the step.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import gather, hand_out, in_lanes
from engine.compiling.decorators import driver, inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import ASIDE, Memory, rows
from engine.cycle.panels.series import larger, smaller
from engine.laws.runge_kutta import DENSE_PARTS, Method
from engine.motion.moments.at_speed import KLOSS, PER_MOTOR, POLYNOMIAL, add_power, polynomial
from engine.motion.steppers.one_step import MOST_STAGES, ROOTS, add_weighted, estimate, make_polynomial
from engine.motion.steppers.places import INVERSE, LOADS, Form, Source, add_share, fill_place, moments_at_speed

# What a step is given: crank angle at the begin, way, flywheel; angle turned by the crank, its speed and the shaft's;
# time, length, the way the crank moves, an angle turned that no stage goes beyond; how the sides are joined, whether
# each of them moves, for how long the coupling has been engaged, and the moment of a fluid coupling over λ ω².
(
    START,
    WAY,
    WHEEL,
    TURNED,
    CRANK_OMEGA,
    SHAFT_OMEGA,
    TIME,
    LENGTH,
    FACING,
    GOAL,
    MODE,
    MOVES,
    SHAFT_MOVES,
    ENGAGED,
    FLUID,
) = range(15)
GIVEN = 15
# Rows of stages: angle of the crank; speed and acceleration of the crank, of the shaft; power of the coupling's heat,
# slip, motors' moment squared, power of the motors, of a channel; the coupling's moment; moments of the motors and of
# everything on the crank, and on the shaft.
(
    ANGLE,
    SPEED,
    RISE,
    SHAFT_SPEED,
    SHAFT_RISE,
    HEATING,
    SLIP,
    SQUARE,
    POWER,
    CHANNEL,
    PULL,
    MOTORS,
    MOMENT,
    SHAFT_MOTORS,
    SHAFT_MOMENT,
) = (i * MOST_STAGES for i in range(15))
STAGE_ROWS = 15 * MOST_STAGES
# What moves: the derivatives of angle and speed of the crank, and of the shaft; then what is gathered beside.
_MOVING, _GATHERED = np.array([SPEED, RISE, SHAFT_SPEED, SHAFT_RISE]), np.array([HEATING, SLIP, SQUARE, POWER])
_CHANNELS = np.array([CHANNEL])
ROWS_MOVING, ROWS_GATHERED = 4, 4
# Rows to work in.
ERROR, REACH, ROOT = range(3)
SPARE = ROOT + ROOTS


# What joins the sides: nothing, a friction clutch, or a fluid.
NONE, CLUTCH, BY_FLUID = range(3)


class SideRoom(NamedTuple):
    """Memory for what drives and loads a side of a block."""

    drive: np.ndarray
    exponents: np.ndarray
    places: np.ndarray


class BothRoom(NamedTuple):
    """Memory for a block."""

    numbers: np.ndarray
    position: np.ndarray
    tile: np.ndarray
    crank: SideRoom
    shaft: SideRoom
    times: np.ndarray
    capacity: np.ndarray
    given: np.ndarray
    found: np.ndarray
    spare: np.ndarray
    stages: np.ndarray


def new_both_room(crank: Form, shaft: Form, parameters: int, curves: int, knots: int) -> BothRoom:
    """Memory for machines of so many numbers and curves, whose clutch has so many knots."""
    return BothRoom(
        rows(parameters),
        rows(3),
        rows(curves, 1),
        _side_room(crank, MOST_STAGES),
        _side_room(shaft, 1),
        rows(knots),
        rows(knots),
        rows(GIVEN),
        rows(found_rows(crank)),
        rows(SPARE),
        rows(STAGE_ROWS, aside=ASIDE),
    )


def _side_room(form: Form, places: int) -> SideRoom:
    return SideRoom(rows(KLOSS + PER_MOTOR * form.motors), rows(form.laws), rows(form.width * places))


def found_rows(form: Form) -> int:
    """How many rows are found: changes of what moves and is gathered, error, polynomials, moments of the coupling."""
    return ROWS_MOVING + ROWS_GATHERED + form.channels + 1 + ROWS_MOVING * DENSE_PARTS + 2


@inlined
def clutch_capacity(times: Memory, capacity: Memory, knots: int, lane: int, engaged: float) -> float:
    """Greatest moment of a clutch that has been engaged for some time: straight from knot to knot, then held."""
    value = capacity[0, lane]
    for i in range(knots - 1):
        begin, end, low, high = times[i, lane], times[i + 1, lane], capacity[i, lane], capacity[i + 1, lane]
        inside = low + (high - low) * smaller((engaged - begin) / (end - begin), 1.0)
        value = inside if engaged > begin else value
    return value


@inlined
def fluid_pull(breaks: np.ndarray, pieces: np.ndarray, factor: float, crank: float, shaft: float) -> float:
    """Moment of a fluid coupling on the crank, by the speeds of both sides and λ by the slip, piece by piece."""
    shaft_drives = abs(shaft) >= abs(crank)
    fast, slow = (shaft, crank) if shaft_drives else (crank, shaft)
    slip = 1.0 - slow / fast if fast != 0.0 else 0.0
    k = 0
    for i in range(1, pieces.shape[1]):
        k = i if slip >= breaks[i] else k
    value, beyond = 0.0, slip - breaks[k]
    for i in range(pieces.shape[0]):
        value = value * beyond + pieces[i, k]
    moment = factor * value * fast * abs(fast)
    return moment if shaft_drives else -moment


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
def stages_of_both(
    begin: int,
    end: int,
    fill: Callable,
    source: Source,
    method: Method,
    form: Form,
    other: Form,
    joint: int,
    knots: int,
    breaks: np.ndarray,
    pieces: np.ndarray,
    room: BothRoom,
) -> None:
    """Stages begin … end − 1 of a step: angle, speeds, accelerations, moments and powers."""
    numbers, position, tile = room.numbers, room.position, room.tile
    own, block, given, stages = in_lanes(position), in_lanes(numbers), in_lanes(room.given), in_lanes(room.stages)
    places, shaft = in_lanes(room.crank.places), in_lanes(room.shaft.places)
    drive, exponents = in_lanes(room.crank.drive), in_lanes(room.crank.exponents)
    other_drive, other_exponents = in_lanes(room.shaft.drive), in_lanes(room.shaft.exponents)
    times, capacity = in_lanes(room.times), in_lanes(room.capacity)
    for s in range(begin, end):
        for lane in range(LANES):
            stages[ANGLE + s, lane], stages[SPEED + s, lane] = given[TURNED, lane], given[CRANK_OMEGA, lane]
            stages[SHAFT_SPEED + s, lane] = given[SHAFT_OMEGA, lane]
        for k in range(s):
            share = method.matrix[s, k]
            if share != 0.0:
                add_share(LANES, share, given[LENGTH], stages[SPEED + k], stages[ANGLE + s])
                add_share(LANES, share, given[LENGTH], stages[RISE + k], stages[SPEED + s])
                add_share(LANES, share, given[LENGTH], stages[SHAFT_RISE + k], stages[SHAFT_SPEED + s])
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
            LANES, form, drive, exponents, places, at, stages[SPEED + s], stages[MOTORS + s], stages[MOMENT + s]
        )
        moments_at_speed(
            LANES,
            other,
            other_drive,
            other_exponents,
            shaft,
            0,
            stages[SHAFT_SPEED + s],
            stages[SHAFT_MOTORS + s],
            stages[SHAFT_MOMENT + s],
        )
        for lane in range(LANES):
            w1, w2, mode = stages[SPEED + s, lane], stages[SHAFT_SPEED + s, lane], given[MODE, lane]
            # Places have 2/I.
            inverse, second_inverse = 0.5 * places[at + INVERSE, lane], 0.5 * shaft[INVERSE, lane]
            first = stages[MOMENT + s, lane] - 0.5 * w1 * w1 * places[at + form.width - 1, lane]
            second = stages[SHAFT_MOMENT + s, lane]
            holds = (mode == 0.0) & (joint == CLUTCH)
            together = (first + second) / (1.0 / inverse + 1.0 / second_inverse)
            pull = 0.0
            if joint == BY_FLUID:
                pull = fluid_pull(breaks, pieces, given[FLUID, lane], w1, w2)
            elif joint == CLUTCH:
                engaged = given[ENGAGED, lane] + clock * given[LENGTH, lane]
                pull = mode * clutch_capacity(times, capacity, knots, lane, engaged)
            pull = second - together / second_inverse if holds else pull
            slip = 0.0 if holds else w2 - w1
            stages[RISE + s, lane] = (together if holds else (first + pull) * inverse) * given[MOVES, lane]
            rise = together if holds else (second - pull) * second_inverse
            stages[SHAFT_RISE + s, lane] = rise * given[SHAFT_MOVES, lane]
            motors, of_shaft = stages[MOTORS + s, lane], stages[SHAFT_MOTORS + s, lane]
            stages[PULL + s, lane], stages[HEATING + s, lane], stages[SLIP + s, lane] = pull, pull * slip, abs(slip)
            stages[SQUARE + s, lane] = (motors + of_shaft) * (motors + of_shaft)
            stages[POWER + s, lane] = motors * w1 + of_shaft * w2


@routine
def add_channel(
    channel: int,
    s: int,
    at: int,
    form: Form,
    channel_of: np.ndarray,
    places: Memory,
    exponents: Memory,
    speeds: int,
    motors: int,
    moments: int,
    load: Memory,
    stages: Memory,
) -> None:
    """Add the power of a channel of loads on a side at a stage; `load` is a row to work in."""
    speed = stages[speeds + s]
    if form.channels > 1:
        begins = at + LOADS + POLYNOMIAL + form.laws + POLYNOMIAL * channel
        for lane in range(LANES):
            load[lane] = polynomial(places, begins, lane, speed[lane])
        for law in range(form.laws):
            if channel_of[law] == channel:
                add_power(LANES, places[at + LOADS + POLYNOMIAL + law], exponents[law], speed, load)
    else:
        for lane in range(LANES):
            load[lane] = stages[moments + s, lane] - stages[motors + s, lane]
    for lane in range(LANES):
        stages[CHANNEL + s, lane] += load[lane] * speed[lane]


@routine
def judge_both(method: Method, tolerance: float, given: Memory, stages: Memory, spare: Memory, missed: Memory) -> None:
    """Estimated error of what moves, by what is allowed: a share of how far it goes, of speeds, or of their change."""
    step = given[LENGTH]
    for lane in range(LANES):
        missed[lane] = 0.0
    for i in range(ROWS_MOVING):
        row = _MOVING[i]
        for lane in range(LANES):
            speed = given[CRANK_OMEGA, lane] if i == 1 else given[SHAFT_OMEGA, lane]
            spare[REACH, lane] = abs(speed) if i % 2 == 1 else 0.0
        for s in range(method.stages):
            for lane in range(LANES):
                spare[REACH, lane] = larger(abs(step[lane] * stages[row + s, lane]), spare[REACH, lane])
        estimate(LANES, method, step, stages, row, spare, ROOT, spare[ERROR])
        for lane in range(LANES):
            error, worst = abs(spare[ERROR, lane]), missed[lane]
            own = 0.0 if error == 0.0 else error / (tolerance * spare[REACH, lane])
            # What isn't a number stays none.
            missed[lane] = own if (own > worst) | (own != own) else worst


@driver
def step_of_both(
    begin: int,
    end: int,
    fill: Callable,
    source: Source,
    method: Method,
    form: Form,
    other: Form,
    channel_of: np.ndarray,
    other_channel_of: np.ndarray,
    tolerance: float,
    joint: int,
    breaks: np.ndarray,
    pieces: np.ndarray,
    parameters: np.ndarray,
    drives: np.ndarray,
    every_exponent: np.ndarray,
    other_drives: np.ndarray,
    other_exponents: np.ndarray,
    every_shaft: np.ndarray,
    every_time: np.ndarray,
    every_capacity: np.ndarray,
    every_given: np.ndarray,
    every_found: np.ndarray,
    room: BothRoom,
) -> None:
    """Make a step of the blocks begin … end − 1 of variants: from `every_given` to `every_found`, rows of variants.

    `every_shaft` is the place of the shaft's side, `breaks` and `pieces` are those of λ by the slip.
    """
    given, found, spare, stages = (
        in_lanes(room.given),
        in_lanes(room.found),
        in_lanes(room.spare),
        in_lanes(room.stages),
    )
    crank, shaft, knots = in_lanes(room.crank.places), in_lanes(room.shaft.places), every_time.shape[0]
    exponents, second_exponents = in_lanes(room.crank.exponents), in_lanes(room.shaft.exponents)
    gathered = ROWS_MOVING + ROWS_GATHERED
    error = gathered + form.channels
    count = error + 1 + ROWS_MOVING * DENSE_PARTS + 2
    for b in range(begin, end):
        first = b * LANES
        gather(parameters, first, in_lanes(room.numbers))
        gather(drives, first, in_lanes(room.crank.drive))
        gather(every_exponent, first, exponents)
        gather(other_drives, first, in_lanes(room.shaft.drive))
        gather(other_exponents, first, second_exponents)
        gather(every_shaft, first, shaft)
        gather(every_time, first, in_lanes(room.times))
        gather(every_capacity, first, in_lanes(room.capacity))
        gather(every_given, first, given)
        for row in range(count):
            for lane in range(LANES):
                found[row, lane] = 0.0
        step = given[LENGTH]
        stages_of_both(0, method.stages, fill, source, method, form, other, joint, knots, breaks, pieces, room)
        for i in range(ROWS_MOVING):
            add_weighted(LANES, method.weights, step, stages, _MOVING[i], found[i])
        for i in range(ROWS_GATHERED):
            add_weighted(LANES, method.weights, step, stages, _GATHERED[i], found[ROWS_MOVING + i])
        for channel in range(form.channels):
            for s in range(method.stages):
                for lane in range(LANES):
                    stages[CHANNEL + s, lane] = 0.0
                at, load = form.width * s, spare[ROOT]
                add_channel(channel, s, at, form, channel_of, crank, exponents, SPEED, MOTORS, MOMENT, load, stages)
                add_channel(
                    channel,
                    s,
                    0,
                    other,
                    other_channel_of,
                    shaft,
                    second_exponents,
                    SHAFT_SPEED,
                    SHAFT_MOTORS,
                    SHAFT_MOMENT,
                    load,
                    stages,
                )
            add_weighted(LANES, method.weights, step, stages, _CHANNELS[0], found[gathered + channel])
        judge_both(method, tolerance, given, stages, spare, found[error])
        stages_of_both(
            method.stages,
            method.dense_stages,
            fill,
            source,
            method,
            form,
            other,
            joint,
            knots,
            breaks,
            pieces,
            room,
        )
        for i in range(ROWS_MOVING):
            make_polynomial(LANES, method, step, stages, _MOVING[i], found, error + 1 + DENSE_PARTS * i)
        for lane in range(LANES):
            found[count - 2, lane] = stages[PULL, lane]
            found[count - 1, lane] = stages[PULL + method.stages, lane]
        hand_out(found, first, every_found[:count])
