"""The cycle that comes back to its own energy, in lanes: steps laid, its energy found, everything asked of it gathered.

The steps of a cycle are laid once, with the machine's rows at all their places. A cycle then costs motors and roots
alone, and the return map P(E) of the cycle and its derivative come together: ln(dP/dE) = ∮ ∂M/∂E dφ is one more
integral of order eight along the cycle. Everything is gathered twice, the second time with every step changed by its
estimated error.
"""

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.compiling.blocks import gather, hand_out, in_lanes
from engine.compiling.decorators import driver, inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import ASIDE, Memory, any_positive, rows
from engine.cycle.panels.series import larger, smaller
from engine.laws.runge_kutta import DENSE_PARTS, ORDER_EIGHT, Method
from engine.motion.moments.at_speed import KLOSS, PER_MOTOR, POLYNOMIAL, add_power, polynomial
from engine.motion.steppers.mesh import (
    E_AFTER,
    ERROR,
    FROM,
    HIGH,
    KEPT,
    LAYING,
    LENGTH,
    LOW,
    MESH_STATE,
    MISSED,
    NEXT,
    SCALE,
    SPARE,
    START,
    STEP_ROWS,
    TOLERANCE,
    TRY,
    WAY,
    WHEEL,
    WORK,
    WORST,
    E,
    fill_step,
    judge_step,
    lay_mesh,
)
from engine.motion.steppers.one_step import (
    CHANNEL,
    ENERGY,
    FROM_MOTORS,
    MOMENT,
    MOTOR_SLOPE,
    ROW_OF,
    SLOPE,
    SLOWNESS,
    SPEED,
    SQUARE,
    STAGE_ROWS,
    add_weighted,
    cubic_extreme,
    estimate,
    make_polynomial,
    make_stages,
    slope_within,
    value_within,
)
from engine.motion.steppers.places import (
    INVERSE,
    LOADS,
    Form,
    Source,
    add_share,
    moments_at_place,
    slopes_at_place,
)
from engine.motion.steppers.radau import ORDER_NINE
from engine.verdicts import Verdict

# Rows of a block's state beside those of the mesh: what is given …
GUESS, TOP, DRIVEN = range(MESH_STATE, MESH_STATE + 3)
# … what the return map is searched with …
BEGIN, LOG, PENDING, RESIDUAL, HIGHEST, STALLED, LAST, VERDICT = range(MESH_STATE + 3, MESH_STATE + 11)
# … what is gathered over the cycle …
TIME, MOTOR, SQUARES, T_AFTER, SPEED_HERE, RISE_HERE, NODE = range(MESH_STATE + 11, MESH_STATE + 18)
# … and of the least and the greatest speed each: itself, which step it lies in, where, how strongly it bends there, and
# how unsure it is besides.
SLOWEST, FASTEST = MESH_STATE + 18, MESH_STATE + 23
EXTREME, IN_STEP, AT, BEND, UNSURE = range(5)
# Greatest estimated errors of a step: of the energy, the time, the motors' work and squares, and ln of the multiplier.
OF_E, OF_TIME, OF_MOTOR, OF_SQUARES, OF_LOG = range(MESH_STATE + 28, MESH_STATE + 33)
# Sums of the estimated errors, of all but the energy; the error of the step under way.
TIME_ERROR, MOTOR_ERROR, SQUARES_ERROR, LOG_ERROR, LOST = range(MESH_STATE + 33, MESH_STATE + 38)
# Sum of the errors of the energy that is left at the end of a cycle, as a share of it.
DRIFT = MESH_STATE + 38
STATE = MESH_STATE + 39

# Rows of what is found: verdict, energy at the begin, ln of the multiplier, residual, time, work of the motors, their
# moment squared over time, least and greatest speed, worst error of a step by what is allowed, energy at the end, the
# highest energy that was thought of, and by how much more the fluctuation of the speed changes than its extremes do;
# then works of channels.
FOUND = 13

MOST_ROUNDS, MOST_RAISES, BISECTIONS = 30, 60, 30
CLOSED = 1e-12
# Moments whose mean over a cycle is a smaller share of their mean magnitude are taken to do no work: it is rounding.
NO_WORK = 1e-9
# The mean moment is looked at from standstill to the speed without load, and more closely just below that.
SHARES_OF_TOP = np.sort(
    np.concatenate((np.geomspace(1e-7, 5e-4, 8), np.linspace(0.001, 1.0, 200), 1.0 - np.geomspace(1e-6, 0.05, 100)))
)
STALLS, RUNS_AWAY, ANY_SPEED, NOT_FINITE = (
    float(v) for v in (Verdict.STALLS, Verdict.RUNS_AWAY, Verdict.ANY_SPEED, Verdict.NOT_FINITE)
)
# A cycle of more steps than were provided for; one that comes to no end from any energy, with these steps; one that
# comes to no end from the energy that its steps were laid from.
TOO_MANY_STEPS, STALLS_HERE, STALLS_AT_ONCE = 254.0, 253.0, 252.0
OF_GREATEST = 0.3
# How many time constants a motor goes through within a step where the moment is known better by the energy's change.
STEEP = 200.0
# How far from the top of its parabola an extreme is met, of the way to it.
NEAR_TOP = 0.1
# Share of what the step to an extreme puts right that may be left to be put right.
LEFT_OVER = 0.01
# Share of the estimated errors of a cycle, as far as they don't fade, that the energy may drift between the extremes of
# the speed. Estimates are those of a formula of a lower order, some hundred times what a step misses.
OF_DRIFT = 0.1


MOST_PLACES = max(method.shares.size for method in (ORDER_EIGHT, ORDER_NINE))


class Settling(NamedTuple):
    """What a set of variants settles from, each (…, variants).

    Attributes
    ----------
    parameters, drive, exponents : ndarray
        Of the machine, and as of `Drive`.
    edges, sides : ndarray (edges, variants)
        Angles turned where moments jump or bend, with begin and end of the cycle, in order [rad]; how far from each
        the moments are taken.
    numbers : ndarray (8, variants)
        Crank angle at the begin, way, flywheel, tolerance; speed or energy to begin with, speed without load, whether
        there is a motor; 1 where the first is an energy.
    """

    parameters: np.ndarray
    drive: np.ndarray
    exponents: np.ndarray
    edges: np.ndarray
    sides: np.ndarray
    numbers: np.ndarray


class BlockRoom(NamedTuple):
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
    stages: np.ndarray
    nodes: np.ndarray
    missed: np.ndarray
    works: np.ndarray
    parts: np.ndarray


def new_block_room(form: Form, given: Settling, curves: int, most: int) -> BlockRoom:
    """Memory for cycles of at most so many steps."""
    return BlockRoom(
        rows(given.parameters.shape[0]),
        rows(3),
        rows(curves, 1),
        rows(KLOSS + PER_MOTOR * form.motors),
        rows(form.laws),
        rows(given.edges.shape[0]),
        rows(given.edges.shape[0]),
        rows(given.numbers.shape[0]),
        rows(STATE),
        rows(STEP_ROWS * (most + 2)),
        rows(form.width * (MOST_PLACES * (most + 2) + 1)),
        rows(STAGE_ROWS, aside=ASIDE),
        rows(most + 1),
        rows(most + 1),
        rows(3 * form.channels),
        rows(2 * DENSE_PARTS),
    )


@routine
def take_means(
    wide: int,
    made: int,
    cycle: float,
    method: Method,
    form: Form,
    places: Memory,
    at: int,
    steps: Memory,
    state: Memory,
) -> None:
    """Means of the loads over the cycle into a place at row `at`, with 2/I = 1; their mean magnitude into MISSED."""
    for row in range(form.width):
        for lane in range(LANES):
            places[at + row, lane] = 0.0
    for lane in range(wide):
        places[at + INVERSE, lane], state[MISSED, lane] = 1.0, 0.0
    for k in range(made):
        step, first = steps[STEP_ROWS * k + LENGTH], form.width * method.shares.shape[0] * k
        for s in range(method.stages):
            for row in range(LOADS, LOADS + POLYNOMIAL + form.laws):
                add_share(wide, method.weights[s] / cycle, step, places[first + form.width * s + row], places[at + row])
            for lane in range(wide):
                size = abs(places[first + form.width * s + LOADS, lane])
                state[MISSED, lane] += size * step[lane] / (method.stages * cycle)


@routine
def mean_moment(
    wide: int, form: Form, drive: Memory, exponents: Memory, places: Memory, at: int, stages: Memory
) -> None:
    """Mean moment over the cycle at the speeds in the first row ENERGY, in the first row MOMENT."""
    for lane in range(wide):
        stages[ENERGY, lane] *= stages[ENERGY, lane]
    moments_at_place(
        wide, form, drive, exponents, places, at, stages[ENERGY], stages[SPEED], stages[FROM_MOTORS], stages[MOMENT]
    )


@routine
def find_balance(
    wide: int, form: Form, drive: Memory, exponents: Memory, places: Memory, at: int, state: Memory, stages: Memory
) -> None:
    """Speed at which the mean moment is zero and falls with the speed, the greatest of several, in GUESS.

    TOP becomes a speed at which the loads win; VERDICT says where there is none.
    """
    for _ in range(MOST_RAISES):
        wins = 0.0
        for lane in range(wide):
            stages[ENERGY, lane] = state[TOP, lane]
        mean_moment(wide, form, drive, exponents, places, at, stages)
        for lane in range(wide):
            more = 1.05 if state[DRIVEN, lane] > 0.0 else 1.5
            won = stages[MOMENT, lane] > 0.0
            state[TOP, lane] *= more if won else 1.0
            wins += 1.0 if won else 0.0
        if wins == 0.0:
            break
    # Bracket, moment at the speed before, whether one was found, whether moments are zero, and whether any is a number.
    low, high, before, idle, known = (
        stages[SLOPE],
        stages[SLOPE + 1],
        stages[SLOPE + 2],
        stages[SLOPE + 3],
        stages[SLOPE + 4],
    )
    for lane in range(wide):
        low[lane], high[lane], before[lane], idle[lane], known[lane] = 0.0, 0.0, -1.0, 1.0, 0.0
    for i in range(SHARES_OF_TOP.shape[0]):
        for lane in range(wide):
            stages[ENERGY, lane] = SHARES_OF_TOP[i] * state[TOP, lane]
        mean_moment(wide, form, drive, exponents, places, at, stages)
        for lane in range(wide):
            value, speed = stages[MOMENT, lane], stages[SPEED, lane]
            falls = (before[lane] > 0.0) & (value <= 0.0)
            low[lane] = state[LAST, lane] if falls else low[lane]
            high[lane] = speed if falls else high[lane]
            idle[lane] = idle[lane] if abs(value) <= NO_WORK * state[MISSED, lane] else 0.0
            known[lane] = 1.0 if abs(value) < math.inf else known[lane]
            before[lane], state[LAST, lane] = value, speed
    for lane in range(wide):
        found = 0.0 if high[lane] > 0.0 else STALLS
        found = RUNS_AWAY if (found > 0.0) & (before[lane] > 0.0) else found
        found = ANY_SPEED if idle[lane] > 0.0 else found
        state[VERDICT, lane] = found if known[lane] > 0.0 else NOT_FINITE
    for _ in range(BISECTIONS):
        for lane in range(wide):
            stages[ENERGY, lane] = 0.5 * (low[lane] + high[lane])
        mean_moment(wide, form, drive, exponents, places, at, stages)
        for lane in range(wide):
            middle, drives = 0.5 * (low[lane] + high[lane]), stages[MOMENT, lane] > 0.0
            low[lane], high[lane] = middle if drives else low[lane], high[lane] if drives else middle
    for lane in range(wide):
        state[GUESS, lane] = 0.5 * (low[lane] + high[lane])


@routine
def turn_once(
    wide: int,
    made: int,
    doubt: float,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    steps: Memory,
    missed: Memory,
    state: Memory,
    stages: Memory,
) -> None:
    """Energy E after the cycle from the energy BEGIN, and ln of the multiplier."""
    for lane in range(wide):
        state[E, lane], state[LOG, lane] = state[BEGIN, lane], 0.0
    for k in range(made):
        first, step = form.width * method.shares.shape[0] * k, steps[STEP_ROWS * k + LENGTH]
        make_stages(
            ROW_OF[0], method.stages, wide, method, form, drive, exponents, places, first, state[E], step, stages
        )
        make_slopes(wide, method, form, drive, exponents, places, first, stages)
        add_weighted(wide, method.weights, step, stages, ROW_OF[MOMENT], state[E])
        add_weighted(wide, method.weights, step, stages, ROW_OF[SLOPE], state[LOG])
        for lane in range(wide):
            state[E, lane] += doubt * missed[k, lane]


@routine
def make_slopes(
    wide: int,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    first: int,
    stages: Memory,
) -> None:
    """∂M/∂E at the stages of a step."""
    for s in range(method.stages):
        at = first + form.width * s
        slopes_at_place(
            wide, form, drive, exponents, places, at, stages[SPEED + s], stages[MOTOR_SLOPE + s], stages[SLOPE + s]
        )


@routine
def close_cycle(
    wide: int,
    made: int,
    doubt: float,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    steps: Memory,
    missed: Memory,
    state: Memory,
    stages: Memory,
) -> None:
    """Find the energy BEGIN that the cycle comes back to, by Newton's method; PENDING is 0 where it was.

    The return map grows with E, so a machine that stalls from some energy stalls from every lower one.
    """
    for lane in range(wide):
        state[STALLED, lane], state[LAST, lane] = 0.0, math.inf
        state[PENDING, lane] = 1.0 if state[VERDICT, lane] == 0.0 else 0.0
    for _ in range(MOST_ROUNDS):
        if not any_positive(state[PENDING]):
            break
        turn_once(wide, made, doubt, method, form, drive, exponents, places, steps, missed, state, stages)
        for lane in range(wide):
            before, after = state[BEGIN, lane], state[E, lane]
            multiplier = math.exp(smaller(state[LOG, lane], 700.0))
            change, off = (after - before) / (1.0 - multiplier), abs(after - before) / before
            whole, searched = (abs(after) < math.inf) & (abs(change) < math.inf), state[PENDING, lane] > 0.0
            state[STALLED, lane] = before if searched & (not whole) else state[STALLED, lane]
            hopeless = searched & (not whole) & (before >= state[HIGHEST, lane])
            closed = whole & (abs(change) <= CLOSED * before)
            # No progress any more, so near to the end that it is rounding.
            stuck = whole & (off >= 0.5 * state[LAST, lane]) & (abs(change) < 1e-8 * before)
            state[VERDICT, lane] = STALLS_HERE if hopeless else state[VERDICT, lane]
            state[RESIDUAL, lane] = off if searched else state[RESIDUAL, lane]
            state[LAST, lane] = off if searched else state[LAST, lane]
            better = larger(before + change, 0.5 * (state[STALLED, lane] + before))
            better = better if whole else smaller(state[HIGHEST, lane], 8.0 * before)
            state[BEGIN, lane] = better if searched else before
            state[PENDING, lane] = 0.0 if closed | stuck | hopeless else state[PENDING, lane]
    for lane in range(wide):
        state[VERDICT, lane] = STALLS_HERE if state[PENDING, lane] > 0.0 else state[VERDICT, lane]


@routine
def add_cycle_works(
    wide: int,
    doubt: float,
    method: Method,
    form: Form,
    channel_of: np.ndarray,
    exponents: Memory,
    places: Memory,
    first: int,
    step: Memory,
    state: Memory,
    stages: Memory,
    works: Memory,
) -> None:
    """Add the works of all channels over a step."""
    begin = LOADS + POLYNOMIAL + form.laws
    for channel in range(form.channels):
        for s in range(method.stages):
            at, own, speed = first + form.width * s, stages[CHANNEL + s], stages[SPEED + s]
            for lane in range(wide):
                own[lane] = polynomial(places, at + begin + POLYNOMIAL * channel, lane, speed[lane])
            for law in range(form.laws):
                if channel_of[law] == channel:
                    add_power(wide, places[at + LOADS + POLYNOMIAL + law], exponents[law], speed, own)
        greatest, errors = works[form.channels + channel], works[2 * form.channels + channel]
        add_with_error(wide, doubt, method, step, ROW_OF[CHANNEL], state, stages, works[channel], greatest, errors)


@routine
def add_with_error(
    wide: int,
    doubt: float,
    method: Method,
    step: Memory,
    row: int,
    state: Memory,
    stages: Memory,
    total: Memory,
    greatest: Memory,
    errors: Memory,
) -> None:
    """Add an integral over a step to its total; where there is no doubt, its estimated error to the sum of errors."""
    add_weighted(wide, method.weights, step, stages, row, total)
    if doubt == 0.0:
        estimate(wide, method, step, stages, row, state, SPARE, state[ERROR])
        for lane in range(wide):
            error = abs(state[ERROR, lane])
            greatest[lane] = larger(error, greatest[lane])
            errors[lane] += error


@routine
def spread_errors(
    wide: int,
    made: int,
    cycle: float,
    form: Form,
    state: Memory,
    steps: Memory,
    nodes: Memory,
    missed: Memory,
    works: Memory,
) -> None:
    """Take a share of the greatest error besides: an estimate may happen to be small.

    Of steps shorter than the longest, as much less.
    """
    for lane in range(wide):
        longest = 0.0
        for k in range(made):
            longest = larger(steps[STEP_ROWS * k + LENGTH, lane], longest)
        rate = OF_GREATEST / longest
        state[DRIFT, lane] = 0.0
        for k in range(made):
            missed[k, lane] += rate * state[OF_E, lane] * steps[STEP_ROWS * k + LENGTH, lane]
            # A disturbance fades along the cycle by e^∮∂M/∂E dφ, taken as spread evenly.
            fades = math.exp(smaller(state[LOG, lane], 0.0) * steps[STEP_ROWS * k + LENGTH, lane] / cycle)
            state[DRIFT, lane] = fades * state[DRIFT, lane] + missed[k, lane] / nodes[k, lane]
        state[TIME_ERROR, lane] += rate * cycle * state[OF_TIME, lane]
        state[MOTOR_ERROR, lane] += rate * cycle * state[OF_MOTOR, lane]
        state[SQUARES_ERROR, lane] += rate * cycle * state[OF_SQUARES, lane]
        state[LOG_ERROR, lane] += rate * cycle * state[OF_LOG, lane]
        for channel in range(form.channels):
            greatest = works[form.channels + channel, lane]
            works[2 * form.channels + channel, lane] += rate * cycle * greatest


@routine
def look_for_extremes(
    wide: int,
    k: int,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    first: int,
    steps: Memory,
    state: Memory,
    stages: Memory,
    parts: Memory,
) -> None:
    """Look for the least and the greatest speed within a step, at some of its places and between them by cubics."""
    at = STEP_ROWS * k
    for i in range(method.looked_at.shape[0]):
        s = method.looked_at[i]
        row, share = first + form.width * s, method.shares[s]
        before = method.shares[method.looked_at[i - 1]] if i > 0 else 0.0
        for lane in range(wide):
            stages[ENERGY, lane] = value_within(parts, 0, lane, state[E, lane], share)
        moments_at_place(
            wide, form, drive, exponents, places, row, stages[ENERGY], stages[SPEED], stages[SQUARE], stages[CHANNEL]
        )
        for lane in range(wide):
            speed, inverse = stages[SPEED, lane], places[row + INVERSE, lane]
            bend = 0.5 * speed * speed * places[row + form.width - 1, lane]
            rise = 0.5 * inverse * (stages[CHANNEL, lane] - bend) / speed
            length = steps[at + LENGTH, lane]
            gap = (share - before) * length
            base, slope = state[SPEED_HERE, lane], state[RISE_HERE, lane]
            base, slope = (base, slope) if i > 0 else (speed, rise)
            value, t, second = cubic_extreme(base, speed - base, slope * gap, rise * gap)
            place = steps[at + FROM, lane] + before * length + t * gap
            # Of what isn't steeper than the cubic, second derivatives are by the angle.
            second = second / (gap * gap) if gap > 0.0 else 0.0
            for which in (SLOWEST, FASTEST):
                sign = 1.0 if which == FASTEST else -1.0
                for own, where, bends in (
                    (value, place, second),
                    (speed, steps[at + FROM, lane] + share * length, 0.0),
                ):
                    more = (sign * own > sign * state[which + EXTREME, lane]) & (length > 0.0)
                    state[which + EXTREME, lane] = own if more else state[which + EXTREME, lane]
                    state[which + IN_STEP, lane] = float(k) if more else state[which + IN_STEP, lane]
                    state[which + AT, lane] = where if more else state[which + AT, lane]
                    state[which + BEND, lane] = bends if more else state[which + BEND, lane]
            state[SPEED_HERE, lane], state[RISE_HERE, lane] = speed, rise


@routine
def record_within(
    implicit: bool,
    first: int,
    width: int,
    asked: np.ndarray,
    record: np.ndarray,
    at: int,
    last: bool,
    steps: Memory,
    state: Memory,
    stages: Memory,
    parts: Memory,
) -> None:
    """Write down energy, time and, of an implicit step, the moment at the asked angles within it."""
    for lane in range(width):
        v, node = first + lane, int(state[NODE, lane])
        begin, length = steps[at + FROM, lane], steps[at + LENGTH, lane]
        # What isn't taken says nothing.
        if length <= 0.0 and not last:
            continue
        while node < asked.shape[0] and (asked[node, v] <= begin + length or last):
            share = min((asked[node, v] - begin) / length, 1.0) if length > 0.0 else 0.0
            record[0, node, v] = value_within(parts, 0, lane, state[E, lane], share)
            record[1, node, v] = value_within(parts, DENSE_PARTS, lane, state[TIME, lane], share)
            # Of a steep motor the moment is less sure by the energy than its change is.
            smooth = implicit and -stages[SLOPE, lane] * length > STEEP
            record[2, node, v] = slope_within(parts, 0, lane, share) / length if smooth else math.nan
            node += 1
        state[NODE, lane] = float(node)


@routine
def gather_cycle(
    wide: int,
    made: int,
    doubt: float,
    cycle: float,
    first_variant: int,
    width: int,
    method: Method,
    form: Form,
    channel_of: np.ndarray,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    steps: Memory,
    state: Memory,
    stages: Memory,
    nodes: Memory,
    missed: Memory,
    works: Memory,
    parts: Memory,
    asked: np.ndarray,
    record: np.ndarray,
) -> None:
    """Go through the cycle once more, from the energy BEGIN, and gather all that is asked of it.

    The extremes of the speed are looked for where there is no doubt.
    """
    for lane in range(wide):
        state[E, lane], state[SCALE, lane], state[WORST, lane] = state[BEGIN, lane], 0.0, 0.0
        state[TIME, lane], state[MOTOR, lane], state[SQUARES, lane], state[NODE, lane] = 0.0, 0.0, 0.0, 0.0
    for channel in range(form.channels):
        for lane in range(wide):
            works[channel, lane] = 0.0
    if doubt == 0.0:
        for lane in range(wide):
            state[SLOWEST, lane], state[FASTEST, lane] = math.inf, -math.inf
            state[OF_E, lane], state[OF_TIME, lane], state[OF_MOTOR, lane] = 0.0, 0.0, 0.0
            state[OF_SQUARES, lane], state[OF_LOG, lane], state[LOG, lane], state[LOG_ERROR, lane] = 0.0, 0.0, 0.0, 0.0
            state[TIME_ERROR, lane], state[MOTOR_ERROR, lane], state[SQUARES_ERROR, lane] = 0.0, 0.0, 0.0
        for channel in range(form.channels):
            for lane in range(wide):
                works[form.channels + channel, lane], works[2 * form.channels + channel, lane] = 0.0, 0.0
    for k in range(made):
        first, at = form.width * method.shares.shape[0] * k, STEP_ROWS * k
        step = steps[at + LENGTH]
        for lane in range(wide):
            nodes[k, lane] = state[E, lane]
            state[E_AFTER, lane], state[T_AFTER, lane] = state[E, lane], state[TIME, lane]
        make_stages(
            ROW_OF[0], method.stages, wide, method, form, drive, exponents, places, first, state[E], step, stages
        )
        judge_step(wide, method, cycle, state, steps, at, stages)
        for lane in range(wide):
            state[WORST, lane] = larger(state[MISSED, lane], state[WORST, lane])
            state[SCALE, lane] = state[WORK, lane]
            # What isn't a number is no less than any.
            state[WORST, lane] = state[WORST, lane] if state[MISSED, lane] < math.inf else math.inf
        for lane in range(wide):
            state[LOST, lane] = 0.0
        total, greatest = state[E_AFTER], state[OF_E]
        add_with_error(wide, doubt, method, step, ROW_OF[MOMENT], state, stages, total, greatest, state[LOST])
        for lane in range(wide):
            missed[k, lane] = state[LOST, lane] if doubt == 0.0 else missed[k, lane]
            state[E_AFTER, lane] += doubt * missed[k, lane]
        if doubt == 0.0:
            make_slopes(wide, method, form, drive, exponents, places, first, stages)
            total, errors = state[LOG], state[LOG_ERROR]
            add_with_error(wide, doubt, method, step, ROW_OF[SLOPE], state, stages, total, state[OF_LOG], errors)
        total, errors = state[T_AFTER], state[TIME_ERROR]
        add_with_error(wide, doubt, method, step, ROW_OF[SLOWNESS], state, stages, total, state[OF_TIME], errors)
        for s in range(method.stages):
            for lane in range(wide):
                motors = stages[FROM_MOTORS + s, lane]
                stages[SQUARE + s, lane] = motors * motors * stages[SLOWNESS + s, lane]
        total, errors = state[MOTOR], state[MOTOR_ERROR]
        add_with_error(wide, doubt, method, step, ROW_OF[FROM_MOTORS], state, stages, total, state[OF_MOTOR], errors)
        total, errors = state[SQUARES], state[SQUARES_ERROR]
        add_with_error(wide, doubt, method, step, ROW_OF[SQUARE], state, stages, total, state[OF_SQUARES], errors)
        if form.channels > 1:
            add_cycle_works(wide, doubt, method, form, channel_of, exponents, places, first, step, state, stages, works)
        if doubt == 0.0 or asked.shape[0] > 0:
            make_stages(
                method.stages,
                method.dense_stages,
                wide,
                method,
                form,
                drive,
                exponents,
                places,
                first,
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
            record_within(
                method.implicit, first_variant, width, asked, record, at, k == made - 1, steps, state, stages, parts
            )
        if doubt == 0.0:
            look_for_extremes(wide, k, method, form, drive, exponents, places, first, steps, state, stages, parts)
        for lane in range(wide):
            state[E, lane], state[TIME, lane] = state[E_AFTER, lane], state[T_AFTER, lane]


@routine
def lay_to_extreme(made: int, which: int, state: Memory, steps: Memory) -> None:
    """Lay a step from the begin of that in which an extreme lies to it; the first or second one after the cycle's."""
    at = STEP_ROWS * (made + (0 if which == SLOWEST else 1))
    for lane in range(LANES):
        k = int(state[which + IN_STEP, lane])
        begin = steps[STEP_ROWS * k + FROM, lane]
        steps[at + FROM, lane], steps[at + LENGTH, lane] = begin, state[which + AT, lane] - begin
        steps[at + LOW, lane], steps[at + HIGH, lane] = (
            steps[STEP_ROWS * k + LOW, lane],
            steps[STEP_ROWS * k + HIGH, lane],
        )


@routine
def go_to_extreme(
    wide: int,
    made: int,
    which: int,
    doubt: float,
    method: Method,
    form: Form,
    drive: Memory,
    exponents: Memory,
    places: Memory,
    steps: Memory,
    state: Memory,
    stages: Memory,
    nodes: Memory,
    missed: Memory,
) -> None:
    """Speed at an extreme, by a step to it, and the rest of the way to the top of its parabola."""
    k = made + (0 if which == SLOWEST else 1)
    at, first = STEP_ROWS * k, form.width * method.shares.shape[0] * k
    for lane in range(wide):
        state[E, lane] = nodes[int(state[which + IN_STEP, lane]), lane]
        state[E_AFTER, lane] = state[E, lane]
    make_stages(
        ROW_OF[0],
        method.stages,
        wide,
        method,
        form,
        drive,
        exponents,
        places,
        first,
        state[E],
        steps[at + LENGTH],
        stages,
    )
    add_weighted(wide, method.weights, steps[at + LENGTH], stages, ROW_OF[MOMENT], state[E_AFTER])
    for lane in range(wide):
        whole = int(state[which + IN_STEP, lane])
        share = steps[at + LENGTH, lane] / steps[STEP_ROWS * whole + LENGTH, lane]
        state[E_AFTER, lane] += doubt * share * missed[whole, lane]
    row = first + form.width * (method.stages - 1)
    moments_at_place(
        wide, form, drive, exponents, places, row, state[E_AFTER], stages[SPEED], stages[SQUARE], stages[CHANNEL]
    )
    for lane in range(wide):
        speed, bend = stages[SPEED, lane], state[which + BEND, lane]
        rise = stages[CHANNEL, lane] - 0.5 * speed * speed * places[row + form.width - 1, lane]
        rise *= 0.5 * places[row + INVERSE, lane] / speed
        # No farther than a part of the step: a steep motor has bent the speed otherwise in a moment.
        near = abs(rise) < NEAR_TOP * abs(bend * steps[at + LENGTH, lane])
        speed -= 0.5 * rise * rise / bend if near else 0.0
        # A part of what the step to it put right.
        left = LEFT_OVER * abs(speed - state[which + EXTREME, lane])
        state[which + UNSURE, lane] = left if doubt == 0.0 else state[which + UNSURE, lane]
        # To the same side as the energies, lest one makes up for the other.
        state[which + EXTREME, lane] = speed + doubt * state[which + UNSURE, lane]


@inlined
def add_own_error(found: np.ndarray, row: int, v: int, error: float) -> None:
    """Move what was found with errors away from what was found without, by the error of the integral itself."""
    found[1, row, v] += math.copysign(error, found[1, row, v] - found[0, row, v])


@inlined
def change_of_fluctuation(found: np.ndarray, v: int, drift: float, unsure: float) -> float:
    """By how much δ is to change besides its extremes, to the same side; `unsure` are both of them [rad/s].

    Where every step misses to the same side, both extremes move along together, and δ says nothing of it. But from the
    one to the other the energy may err by what the steps between miss, ΔE, and with ω² = 2E/I the speed by
    Δω/ω = ΔE/(2E).
    """
    before = (found[0, 8, v] - found[0, 7, v]) / (found[0, 8, v] + found[0, 7, v])
    after = (found[1, 8, v] - found[1, 7, v]) / (found[1, 8, v] + found[1, 7, v])
    return math.copysign(0.5 * OF_DRIFT * drift + 2.0 * unsure / (found[0, 8, v] + found[0, 7, v]), after - before)


@driver
def settle(
    begin: int,
    end: int,
    fill: Callable,
    source: Source,
    method: Method,
    form: Form,
    channel_of: np.ndarray,
    cycle: float,
    most: int,
    given: Settling,
    asked: np.ndarray,
    found: np.ndarray,
    record: np.ndarray,
    memory: BlockRoom,
) -> None:
    """Find the settled cycles of the blocks begin … end − 1 of variants.

    `found` (2, FOUND + channels, variants) receives what is found, then the same with every step changed by its
    estimated error; `record` (2, 3, nodes, variants) energy, time and, where steps are implicit, the moment at the
    `asked` angles turned.
    """
    variants = given.numbers.shape[1]
    drive, exponents = in_lanes(memory.drive), in_lanes(memory.exponents)
    edges, sides, numbers = in_lanes(memory.edges), in_lanes(memory.sides), in_lanes(memory.given)
    state, steps, places = in_lanes(memory.state), in_lanes(memory.steps), in_lanes(memory.places)
    stages, nodes, works = in_lanes(memory.stages), in_lanes(memory.nodes), in_lanes(memory.works)
    missed = in_lanes(memory.missed)
    parts, count = in_lanes(memory.parts), given.edges.shape[0]
    machine, position, tile, width = memory.numbers, memory.position, memory.tile, form.width
    # The machine's rows at mean loads lie after those of all steps.
    at_mean = width * MOST_PLACES * (most + 2)
    for b in range(begin, end):
        first = b * LANES
        own = min(LANES, variants - first)
        gather(given.parameters, first, in_lanes(machine))
        gather(given.drive, first, drive)
        gather(given.exponents, first, exponents)
        gather(given.edges, first, edges)
        gather(given.sides, first, sides)
        gather(given.numbers, first, numbers)
        for lane in range(LANES):
            state[START, lane], state[WAY, lane], state[WHEEL, lane] = (
                numbers[0, lane],
                numbers[1, lane],
                numbers[2, lane],
            )
            state[TOLERANCE, lane], state[TOP, lane] = numbers[3, lane], numbers[5, lane]
            state[DRIVEN, lane], state[LAYING, lane], state[TRY, lane] = numbers[6, lane], 1.0, 0.25 * math.pi
            state[KEPT, lane] = numbers[4, lane] if numbers[7, lane] == 0.0 else 0.0
            state[E, lane] = numbers[4, lane]
        made = lay_mesh(
            LANES,
            most,
            method,
            cycle,
            fill,
            source,
            form,
            machine,
            position,
            tile,
            drive,
            exponents,
            edges,
            sides,
            count,
            state,
            steps,
            places,
            stages,
        )
        for k in range(made):
            fill_step(
                method.stages,
                method.shares.shape[0],
                method,
                fill,
                source,
                machine,
                position,
                tile,
                width,
                state,
                steps,
                STEP_ROWS * k,
                places,
                width * method.shares.shape[0] * k,
            )
        take_means(LANES, made, cycle, method, form, places, at_mean, steps, state)
        find_balance(LANES, form, drive, exponents, places, at_mean, state, stages)
        for lane in range(LANES):
            inverse, chosen = places[width * method.looked_at[0] + INVERSE, lane], numbers[7, lane] > 0.0
            guess = state[GUESS, lane] * state[GUESS, lane] / inverse
            state[HIGHEST, lane] = state[TOP, lane] * state[TOP, lane] / inverse
            state[BEGIN, lane] = numbers[4, lane] if chosen else guess
            # Where the speed is kept, only a motor too steep for any step that is tried makes a lane come to no end.
            endless = (state[LAYING, lane] > 0.0) | (state[KEPT, lane] > 0.0)
            broken = TOO_MANY_STEPS if endless else STALLS_AT_ONCE
            known = state[VERDICT, lane] != NOT_FINITE
            state[VERDICT, lane] = broken if (state[NEXT, lane] < count) & known else state[VERDICT, lane]
            state[RESIDUAL, lane] = math.nan
        for again in range(2):
            doubt = float(again)
            close_cycle(LANES, made, doubt, method, form, drive, exponents, places, steps, missed, state, stages)
            gather_cycle(
                LANES,
                made,
                doubt,
                cycle,
                first,
                own,
                method,
                form,
                channel_of,
                drive,
                exponents,
                places,
                steps,
                state,
                stages,
                nodes,
                missed,
                works,
                parts,
                asked,
                record[again],
            )
            for lane in range(own):
                found[again, 10, first + lane], found[again, 11, first + lane] = state[E, lane], state[HIGHEST, lane]
            for which in (SLOWEST, FASTEST):
                if again == 0:
                    lay_to_extreme(made, which, state, steps)
                    k = made + (0 if which == SLOWEST else 1)
                    fill_step(
                        ROW_OF[0],
                        method.stages,
                        method,
                        fill,
                        source,
                        machine,
                        position,
                        tile,
                        width,
                        state,
                        steps,
                        STEP_ROWS * k,
                        places,
                        width * method.shares.shape[0] * k,
                    )
                go_to_extreme(
                    LANES,
                    made,
                    which,
                    doubt,
                    method,
                    form,
                    drive,
                    exponents,
                    places,
                    steps,
                    state,
                    stages,
                    nodes,
                    missed,
                )
            for lane in range(own):
                v = first + lane
                found[again, 0, v], found[again, 1, v] = state[VERDICT, lane], state[BEGIN, lane]
                found[again, 2, v], found[again, 3, v] = state[LOG, lane], state[RESIDUAL, lane]
                found[again, 4, v], found[again, 5, v] = state[TIME, lane], state[MOTOR, lane]
                found[again, 6, v], found[again, 7, v] = state[SQUARES, lane], state[SLOWEST, lane]
                found[again, 8, v], found[again, 9, v] = state[FASTEST, lane], state[WORST, lane]
            hand_out(works, first, found[again, FOUND : FOUND + form.channels])
            if again == 0:
                spread_errors(LANES, made, cycle, form, state, steps, nodes, missed, works)
        for lane in range(own):
            v = first + lane
            unsure = state[SLOWEST + UNSURE, lane] + state[FASTEST + UNSURE, lane]
            found[0, 12, v], found[1, 12, v] = 0.0, change_of_fluctuation(found, v, state[DRIFT, lane], unsure)
            add_own_error(found, 2, v, state[LOG_ERROR, lane])
            add_own_error(found, 4, v, state[TIME_ERROR, lane])
            add_own_error(found, 5, v, state[MOTOR_ERROR, lane])
            add_own_error(found, 6, v, state[SQUARES_ERROR, lane])
            for channel in range(form.channels):
                add_own_error(found, FOUND + channel, v, works[2 * form.channels + channel, lane])
