"""A block of variants carried side by side in the energy form, explicitly or implicitly.

Both ways make a step that isn't taken yet: the speeds and the motors' moments at the stages, and the energy at the end.
What follows from these, and whether the step passes an end of the stretch, is the same for both.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.decorators import driver, inlined, routine
from engine.compiling.tiles import LANES
from engine.cycle.driver import fill, gather
from engine.cycle.panels.lanes import ASIDE, Memory, in_lanes, lane_of, rows
from engine.cycle.panels.series import larger, smaller
from engine.motion.moments.at_speed import (
    KLOSS,
    PER_MOTOR,
    POLYNOMIAL,
    add_power,
    polynomial,
)
from engine.motion.steppers.energy_form import (
    ABOVE,
    ANGLE,
    BELOW,
    NEAR_REST,
    SHARE_PER_STEP,
    STIFF,
    STIFF_SHARE,
    TIME,
    TIMES_PER_RADIAN,
    Course,
    Limits,
    Tables,
)
from engine.motion.steppers.places import INVERSE, LOADS, Form, add_share, moments_at_place, slopes_at_place
from engine.motion.steppers.tableaux import CLASSICAL, LOBATTO_IIIC

# Stages of the two methods lie at nodes of the tables and in the middle between them.
A, STAGES = CLASSICAL.matrix, CLASSICAL.stages
WEIGHTS, PLACES = CLASSICAL.weights, (2.0 * CLASSICAL.nodes).astype(np.int64)
IMPLICIT_A, IMPLICIT_STAGES = LOBATTO_IIIC.matrix, LOBATTO_IIIC.stages
IMPLICIT_WEIGHTS, IMPLICIT_PLACES = LOBATTO_IIIC.weights, (2.0 * LOBATTO_IIIC.nodes).astype(np.int64)
MOST_STAGES = max(STAGES, IMPLICIT_STAGES)

# Rows of a block's state: what has gathered, whether a lane is on its way and takes the step, limits …
E, T, MOTOR, SQUARES, SLOW, FAST, PEAK, MOVING, GOES, STEPS, UNTIL, OVER, UNDER = range(13)
# … and of the step under way.
E_AFTER, T_STEP, W_AFTER, MOTOR_STEP, SQUARES_STEP, STIFFNESS, H = range(13, 20)
STATE = 20
# Rows of its stages: speed, motors' moment, moment of everything; slope and energy where the step is implicit.
SPEED, FROM_MOTORS, MOMENT, SLOPE, ENERGY = (i * MOST_STAGES for i in range(5))
STAGE_ROWS = 5 * MOST_STAGES
# Lanes that the compiled code takes at once, or a multiple of that: what is left over would go a scalar way. Loops over
# a number that the compiler doesn't know aren't unrolled, so that the code of a step stays small enough to be decoded
# once.
TOGETHER = 32

MOST_ROUNDS = 60
SOLVED = 1e-14


@routine
def pack(tables: Tables, first: int, width: int, places: Memory) -> None:
    """Gather the tables of a block, place by place, the loads of all channels together; `width` rows a place."""
    last = tables.inertia.shape[1] - 1
    for j in range(tables.inertia.shape[0]):
        at = width * j
        for lane in range(LANES):
            places[at + INVERSE, lane] = 2.0 / tables.inertia[j, min(first + lane, last)]
        for order in range(POLYNOMIAL):
            row = at + LOADS + order
            for lane in range(LANES):
                places[row, lane] = tables.loads[0, order, j, min(first + lane, last)]
            for channel in range(1, tables.loads.shape[0]):
                for lane in range(LANES):
                    places[row, lane] += tables.loads[channel, order, j, min(first + lane, last)]
        for law in range(tables.powers.shape[0]):
            for lane in range(LANES):
                places[at + LOADS + POLYNOMIAL + law, lane] = tables.powers[law, j, min(first + lane, last)]
        # Works need each channel by itself.
        row = at + LOADS + POLYNOMIAL + tables.powers.shape[0]
        for channel in range(tables.loads.shape[0] if row < at + width else 0):
            for order in range(POLYNOMIAL):
                for lane in range(LANES):
                    places[row, lane] = tables.loads[channel, order, j, min(first + lane, last)]
                row += 1


@routine
def begin_block(energy: np.ndarray, limits: Limits, first: int, width: int, places: Memory, state: Memory) -> None:
    """Set a block to its first node; lanes from `width` on are left over and don't move."""
    last = energy.shape[0] - 1
    for row in range(STATE):
        for lane in range(LANES):
            state[row, lane] = 0.0
    for lane in range(LANES):
        v = min(first + lane, last)
        speed = math.sqrt(energy[v] * places[INVERSE, lane])
        state[E, lane], state[SLOW, lane], state[FAST, lane] = energy[v], speed, speed
        state[MOVING, lane] = 1.0 if lane < width else 0.0
        state[STEPS, lane], state[UNTIL, lane] = float(limits.steps[v]), limits.time[v]
        state[OVER, lane], state[UNDER, lane] = limits.above[v], limits.below[v]


@routine
def finish(wide: int, weights: np.ndarray, inverse: Memory, stages: Memory, state: Memory) -> None:
    """What follows from the stages of a step: its time, work and squares of the motors, and the speed at its end.

    `inverse` is 2/I there, (LANES,).
    """
    for lane in range(wide):
        state[T_STEP, lane], state[MOTOR_STEP, lane], state[SQUARES_STEP, lane] = 0.0, 0.0, 0.0
        state[W_AFTER, lane] = math.sqrt(state[E_AFTER, lane] * inverse[lane])
    for s in range(weights.shape[0]):
        for lane in range(wide):
            motor, share = stages[FROM_MOTORS + s, lane], weights[s] * state[H, lane]
            time = share / stages[SPEED + s, lane]
            state[T_STEP, lane] += time
            state[MOTOR_STEP, lane] += share * motor
            state[SQUARES_STEP, lane] += motor * motor * time


@routine
def explicit_step(
    wide: int, form: Form, drive: Memory, exponents: Memory, places: Memory, first: int, state: Memory, stages: Memory
) -> None:
    """A step of the classical method of all lanes, from the place that begins at row `first`."""
    for s in range(STAGES + 1):
        energy = stages[ENERGY + s] if s < STAGES else state[E_AFTER]
        for lane in range(wide):
            energy[lane] = state[E, lane]
        for k in range(s):
            share = A[s, k] if s < STAGES else WEIGHTS[k]
            if share != 0.0:
                add_share(wide, share, state[H], stages[MOMENT + k], energy)
        if s < STAGES:
            at, speed, motors = first + form.width * PLACES[s], stages[SPEED + s], stages[FROM_MOTORS + s]
            moments_at_place(wide, form, drive, exponents, places, at, energy, speed, motors, stages[MOMENT + s])
    for lane in range(wide):
        e, h, near = state[E, lane], state[H, lane], stages[MOMENT, lane]
        # M differs between the second and the third stage by its dependence on E alone, and E there as the
        # first two stages do: the ratio says how near an explicit method is to being unstable.
        change, before = stages[MOMENT + 2, lane] - stages[MOMENT + 1, lane], stages[MOMENT + 1, lane] - near
        stiff = (abs(change) - abs(before)) * h > STIFF_SHARE * e
        careful = state[UNDER, lane] >= 0.0
        slowing = careful & ((-near > TIMES_PER_RADIAN * e) | (-near * h > SHARE_PER_STEP * e))
        state[STIFFNESS, lane] = 1.0 if stiff else 0.0
        state[GOES, lane] = 0.0 if (stiff | slowing) else 1.0
    finish(wide, WEIGHTS, places[first + 2 * form.width + INVERSE], stages, state)


@inlined
def solved(
    a11: float,
    a12: float,
    a13: float,
    a21: float,
    a22: float,
    a23: float,
    a31: float,
    a32: float,
    a33: float,
    b1: float,
    b2: float,
    b3: float,
) -> tuple[float, float, float]:
    """Solution of three linear equations by Cramer's rule; Newton's method puts right what it loses."""
    c11, c12, c13 = a22 * a33 - a23 * a32, a23 * a31 - a21 * a33, a21 * a32 - a22 * a31
    inverse = 1.0 / (a11 * c11 + a12 * c12 + a13 * c13)
    x = b1 * c11 + b2 * (a13 * a32 - a12 * a33) + b3 * (a12 * a23 - a13 * a22)
    y = b1 * c12 + b2 * (a11 * a33 - a13 * a31) + b3 * (a13 * a21 - a11 * a23)
    z = b1 * c13 + b2 * (a12 * a31 - a11 * a32) + b3 * (a11 * a22 - a12 * a21)
    return x * inverse, y * inverse, z * inverse


@routine
def implicit_step(
    wide: int, form: Form, drive: Memory, exponents: Memory, places: Memory, first: int, state: Memory, stages: Memory
) -> None:
    """A step of Lobatto IIIC of all lanes; parameters as of `explicit_step`.

    dE/dφ = M(φ, √(2E/I)) is collocated at the first node, the middle and the last node, and the three energies are
    found by Newton's method. Steps of any length are stable: a motor that holds its speed within a fraction of a step
    is simply followed.
    """
    for s in range(IMPLICIT_STAGES):
        for lane in range(wide):
            stages[ENERGY + s, lane] = state[E, lane]
    for lane in range(wide):
        state[STIFFNESS, lane], state[GOES, lane] = 0.0, 0.0
    pending = 1.0
    for _ in range(MOST_ROUNDS):
        for s in range(IMPLICIT_STAGES):
            at, energy, speed = first + form.width * IMPLICIT_PLACES[s], stages[ENERGY + s], stages[SPEED + s]
            motors, moment, slope = stages[FROM_MOTORS + s], stages[MOMENT + s], stages[SLOPE + s]
            moments_at_place(wide, form, drive, exponents, places, at, energy, speed, motors, moment)
            slopes_at_place(wide, form, drive, exponents, places, at, speed, slope)
        # Once more after all are found, so that nothing depends on which of them was the last.
        if pending == 0.0:
            break
        pending = newton_step(wide, state, stages)
    for lane in range(wide):
        end = stages[ENERGY + IMPLICIT_STAGES - 1, lane]
        state[E_AFTER, lane] = end if (state[GOES, lane] > 0.0) & (end > 0.0) else math.nan
    finish(wide, IMPLICIT_WEIGHTS, places[first + 2 * form.width + INVERSE], stages, state)


@routine
def newton_step(wide: int, state: Memory, stages: Memory) -> float:
    """Improve the energies of an implicit step in lanes where they aren't found yet; how many those are now.

    GOES is 1 of a lane whose energies are found, −1 of one that has none.
    """
    pending = 0.0
    for lane in range(wide):
        h, e = state[H, lane], state[E, lane]
        m1, m2, m3 = stages[MOMENT, lane], stages[MOMENT + 1, lane], stages[MOMENT + 2, lane]
        d1, d2, d3 = h * stages[SLOPE, lane], h * stages[SLOPE + 1, lane], h * stages[SLOPE + 2, lane]
        e1, e2, e3 = stages[ENERGY, lane], stages[ENERGY + 1, lane], stages[ENERGY + 2, lane]
        by1, by2, by3 = solved(
            1.0 - IMPLICIT_A[0, 0] * d1,
            -IMPLICIT_A[0, 1] * d2,
            -IMPLICIT_A[0, 2] * d3,
            -IMPLICIT_A[1, 0] * d1,
            1.0 - IMPLICIT_A[1, 1] * d2,
            -IMPLICIT_A[1, 2] * d3,
            -IMPLICIT_A[2, 0] * d1,
            -IMPLICIT_A[2, 1] * d2,
            1.0 - IMPLICIT_A[2, 2] * d3,
            e + h * (IMPLICIT_A[0, 0] * m1 + IMPLICIT_A[0, 1] * m2 + IMPLICIT_A[0, 2] * m3) - e1,
            e + h * (IMPLICIT_A[1, 0] * m1 + IMPLICIT_A[1, 1] * m2 + IMPLICIT_A[1, 2] * m3) - e2,
            e + h * (IMPLICIT_A[2, 0] * m1 + IMPLICIT_A[2, 1] * m2 + IMPLICIT_A[2, 2] * m3) - e3,
        )
        worst = larger(larger(abs(by1) / e1, abs(by2) / e2), abs(by3) / e3)
        done = state[GOES, lane] != 0.0
        stages[ENERGY, lane] = e1 if done else larger(e1 + by1, 0.1 * e1)
        stages[ENERGY + 1, lane] = e2 if done else larger(e2 + by2, 0.1 * e2)
        stages[ENERGY + 2, lane] = e3 if done else larger(e3 + by3, 0.1 * e3)
        known = abs(by1) + abs(by2) + abs(by3) < math.inf
        now = (1.0 if worst < SOLVED else 0.0) if known else -1.0
        state[GOES, lane] = state[GOES, lane] if done else now
    for lane in range(wide):
        pending += 1.0 if state[GOES, lane] == 0.0 else 0.0
    return pending


@routine
def take_step(wide: int, last: int, done: int, state: Memory, stages: Memory) -> float:
    """Take the step in the lanes where it passes no end of the stretch; returns how many do."""
    going, count = 0.0, float(done)
    for lane in range(wide):
        w, t = state[W_AFTER, lane], state[T, lane] + state[T_STEP, lane]
        inside = (w > state[UNDER, lane]) & (w < state[OVER, lane]) & (w > 0.0)
        inside &= (t < state[UNTIL, lane]) & (count < state[STEPS, lane])
        goes = (state[GOES, lane] > 0.0) & (state[MOVING, lane] > 0.0) & inside
        state[GOES, lane] = 1.0 if goes else 0.0
    for lane in range(wide):
        goes, w = state[GOES, lane] > 0.0, state[W_AFTER, lane]
        peak = larger(abs(stages[FROM_MOTORS, lane]), abs(stages[FROM_MOTORS + last, lane]))
        state[E, lane] = state[E_AFTER, lane] if goes else state[E, lane]
        state[T, lane] += state[T_STEP, lane] if goes else 0.0
        state[SQUARES, lane] += state[SQUARES_STEP, lane] if goes else 0.0
        state[MOTOR, lane] += state[MOTOR_STEP, lane] if goes else 0.0
        state[SLOW, lane] = smaller(state[SLOW, lane], w) if goes else state[SLOW, lane]
        state[FAST, lane] = larger(state[FAST, lane], w) if goes else state[FAST, lane]
        state[PEAK, lane] = larger(state[PEAK, lane], peak) if goes else state[PEAK, lane]
    for lane in range(wide):
        going += state[GOES, lane]
    return going


@routine
def add_works(
    wide: int,
    form: Form,
    channel_of: np.ndarray,
    exponents: Memory,
    weights: np.ndarray,
    nodes: np.ndarray,
    places: Memory,
    first: int,
    state: Memory,
    stages: Memory,
    moment: Memory,
    works: Memory,
) -> None:
    """Works of all channels over the step, where it is taken, with the speeds of its stages."""
    channels = LOADS + POLYNOMIAL + form.laws
    for s in range(weights.shape[0]):
        at, weight, speed = first + form.width * nodes[s], weights[s], stages[SPEED + s]
        for channel in range(form.channels):
            for lane in range(wide):
                gained = weight * state[H, lane] * polynomial(places, at + channels + 3 * channel, lane, speed[lane])
                works[channel, lane] += gained if state[GOES, lane] > 0.0 else 0.0
        for law in range(form.laws):
            for lane in range(wide):
                moment[lane] = 0.0
            add_power(wide, places[at + LOADS + POLYNOMIAL + law], exponents[law], speed, moment)
            for lane in range(wide):
                gained = weight * state[H, lane] * moment[lane]
                works[channel_of[law], lane] += gained if state[GOES, lane] > 0.0 else 0.0


@routine
def why(state: Memory, lane: int, done: int) -> int:
    """Why a lane can't take the step."""
    w = state[W_AFTER, lane]
    if done >= state[STEPS, lane]:
        return ANGLE
    if w >= state[OVER, lane]:
        return ABOVE
    if 0.0 < w <= state[UNDER, lane]:
        return BELOW
    if state[T, lane] + state[T_STEP, lane] >= state[UNTIL, lane]:
        return TIME
    return STIFF if state[STIFFNESS, lane] > 0.0 else NEAR_REST


@routine
def record_stops(
    first: int, width: int, done: int, channels: int, state: Memory, works: Memory, course: Course
) -> None:
    """Write down the lanes that stop here."""
    for lane in range(width):
        if state[MOVING, lane] > state[GOES, lane]:
            v = first + lane
            state[MOVING, lane] = 0.0
            course.energy[v], course.time[v], course.made[v] = state[E, lane], state[T, lane], done
            course.stop[v] = why(state, lane, done)
            course.slowest[v], course.fastest[v] = state[SLOW, lane], state[FAST, lane]
            course.peak[v], course.squares[v] = state[PEAK, lane], state[SQUARES, lane]
            course.works[0, v] = state[MOTOR, lane]
            for channel in range(channels):
                course.works[channel + 1, v] = works[channel, lane]


class BlockMemory(NamedTuple):
    """Memory for a block, each (…, LANES).

    Attributes
    ----------
    drive, exponents, steps, places : ndarray
        What belongs to its variants: as of `Drive`, lengths of steps, and rows of all places.
    state, stages : ndarray
    moment, works : ndarray
        Moment of a load, and works of all channels.
    """

    drive: np.ndarray
    exponents: np.ndarray
    steps: np.ndarray
    places: np.ndarray
    state: np.ndarray
    stages: np.ndarray
    moment: np.ndarray
    works: np.ndarray


def new_block_memory(form: Form, steps: int) -> BlockMemory:
    """Memory for tables of so many steps."""
    return BlockMemory(
        rows(KLOSS + PER_MOTOR * form.motors),
        rows(form.laws),
        rows(steps),
        rows((2 * steps + 1) * form.width),
        rows(STATE),
        rows(STAGE_ROWS, aside=ASIDE),
        rows(1),
        rows(form.channels),
    )


@driver
def carry(
    begin: int,
    end: int,
    implicit: bool,
    form: Form,
    tables: Tables,
    drives: np.ndarray,
    every_exponent: np.ndarray,
    channel_of: np.ndarray,
    energy: np.ndarray,
    limits: Limits,
    record: np.ndarray,
    course: Course,
    block: BlockMemory,
) -> None:
    """Carry the blocks begin … end − 1 of variants to the end of their stretch; see `advance`.

    Energy and time at every node go into `record` (2, nodes, variants), as far as it reaches; the rest into `course`.
    After the last node of the tables comes the first.
    """
    cycle, variants = tables.steps.shape[0], energy.shape[0]
    drive, exponents, steps, places = (
        in_lanes(block.drive),
        in_lanes(block.exponents),
        in_lanes(block.steps),
        in_lanes(block.places),
    )
    state, stages = in_lanes(block.state), in_lanes(block.stages)
    moment, works = lane_of(block.moment), in_lanes(block.works)
    weights, nodes = (IMPLICIT_WEIGHTS, IMPLICIT_PLACES) if implicit else (WEIGHTS, PLACES)
    for b in range(begin, end):
        first = b * LANES
        width = min(LANES, variants - first)
        wide = -(-width // TOGETHER) * TOGETHER
        gather(drives, first, drive)
        gather(every_exponent, first, exponents)
        gather(tables.steps, first, steps)
        pack(tables, first, form.width, places)
        begin_block(energy, limits, first, width, places, state)
        fill(form.channels, works, 0.0)
        # Of a type that the loop doesn't change: what is called here is then compiled once.
        moving, done = float(width), 0 * width
        while moving > 0.0:
            if done < record.shape[1]:
                for lane in range(width):
                    record[0, done, first + lane], record[1, done, first + lane] = state[E, lane], state[T, lane]
            k = done % cycle
            at = 2 * k * form.width
            for lane in range(wide):
                state[H, lane] = steps[k, lane]
            if implicit:
                implicit_step(wide, form, drive, exponents, places, at, state, stages)
            else:
                explicit_step(wide, form, drive, exponents, places, at, state, stages)
            going = take_step(wide, weights.shape[0] - 1, done, state, stages)
            if form.channels > 1:
                add_works(wide, form, channel_of, exponents, weights, nodes, places, at, state, stages, moment, works)
            if going < moving:
                record_stops(first, width, done, form.channels, state, works, course)
            moving, done = going, done + 1
        if form.channels == 1:
            # What the motors didn't give.
            for lane in range(width):
                v = first + lane
                course.works[1, v] = course.energy[v] - energy[v] - course.works[0, v]
