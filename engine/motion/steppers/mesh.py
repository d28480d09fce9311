"""Steps over a cycle, as many in each lane as its motion needs, with the machine's rows at their places.

No step goes across a break of the moments. What a step misses is judged against the greatest work of a step so far, or
of the loads over a step of fair length: it is the fluctuation of the energy that matters, however heavy the flywheel.
"""

import math
from collections.abc import Callable

import numpy as np

from engine.compiling.blocks import in_lanes
from engine.compiling.decorators import inlined, routine
from engine.compiling.widths import LANES
from engine.cycle.panels.lanes import Memory
from engine.cycle.panels.series import larger, smaller
from engine.laws.runge_kutta import Method
from engine.motion.steppers.one_step import (
    FROM_MOTORS,
    MOMENT,
    ROOTS,
    ROW_OF,
    SLOWNESS,
    SPEED,
    add_weighted,
    estimate,
    make_stages,
)
from engine.motion.steppers.places import INVERSE, Form, Source, fill_place

# Rows of a block's state: crank angle at the begin, way, inertia of the flywheel, tolerance; energy, energy after the
# step, errors of both integrals, error of the step by what is allowed, greatest work of a step taken, and with the step
# under way, worst error; and for the mesh: angle turned, next edge, length to try, whether the lane's mesh is being
# laid, and speed to keep (0: the motion's own); then rows to work in.
START, WAY, WHEEL, TOLERANCE, E, E_AFTER, ERROR, ERROR_T, MISSED, SCALE, WORK, WORST = range(12)
TURNED, NEXT, TRY, LAYING, KEPT, SPARE = range(12, 18)
MESH_STATE = SPARE + ROOTS
# Rows of a step: its length, where it begins, and between which angles its places lie.
LENGTH, FROM, LOW, HIGH = range(4)
STEP_ROWS = 4

# The estimated error of a step of order eight goes with its length to the eighth power.
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# A step of fair length [rad].
FAIR_STEP = 0.25
# Rounding of a step, as a share of its energy.
ROUNDED = 4.0 * float(np.finfo(float).eps)
# Steps shorter than this share of the cycle are taken whatever they miss.
SHORTEST = 1e-7


@routine
def judge_step(wide: int, method: Method, cycle: float, state: Memory, steps: Memory, at: int, stages: Memory) -> None:
    """Estimate what a step misses, of its energy and its time; MISSED is its error by what is allowed."""
    for lane in range(wide):
        state[WORK, lane] = state[SCALE, lane]
    for s in range(method.stages):
        for lane in range(wide):
            stages[SLOWNESS + s, lane] = 1.0 / stages[SPEED + s, lane]
            moment, loads = stages[MOMENT + s, lane], stages[MOMENT + s, lane] - stages[FROM_MOTORS + s, lane]
            work = larger(abs(steps[at + LENGTH, lane] * moment), FAIR_STEP * abs(loads))
            state[WORK, lane] = larger(work, state[WORK, lane])
    estimate(wide, method, steps[at + LENGTH], stages, ROW_OF[SLOWNESS], state, SPARE, state[ERROR_T])
    estimate(wide, method, steps[at + LENGTH], stages, ROW_OF[MOMENT], state, SPARE, state[ERROR])
    for lane in range(wide):
        allowed = state[TOLERANCE, lane] * state[WORK, lane] + ROUNDED * state[E, lane]
        of_time = abs(state[ERROR_T, lane]) * stages[SPEED, lane] / (cycle * state[TOLERANCE, lane])
        state[MISSED, lane] = larger(abs(state[ERROR, lane]) / allowed, of_time)


@inlined
def stay_between(lane: int, k: int, edges: Memory, sides: Memory, steps: Memory, at: int) -> None:
    """Take the places of a step between edges k − 1 and k, a little beside both; between close ones in their middle."""
    middle = 0.5 * (edges[k - 1, lane] + edges[k, lane])
    steps[at + LOW, lane] = smaller(edges[k - 1, lane] + sides[k - 1, lane], middle)
    steps[at + HIGH, lane] = larger(edges[k, lane] - sides[k, lane], middle)


@routine
def choose_steps(edges: Memory, sides: Memory, count: int, state: Memory, steps: Memory, at: int) -> None:
    """Length of each lane's next step: that to try, or an equal part of the way to the next edge."""
    for lane in range(LANES):
        turned, k = state[TURNED, lane], int(state[NEXT, lane])
        if state[LAYING, lane] == 0.0 or k >= count:
            end = edges[count - 1, lane]
            steps[at + LENGTH, lane], steps[at + FROM, lane] = 0.0, end
            steps[at + LOW, lane], steps[at + HIGH, lane] = end, end - sides[count - 1, lane]
            continue
        rest = edges[k, lane] - turned
        parts = math.ceil(rest / state[TRY, lane] * (1.0 - 1e-9))
        steps[at + LENGTH, lane] = rest / parts if parts > 1.0 else rest
        steps[at + FROM, lane] = turned
        stay_between(lane, k, edges, sides, steps, at)


@routine
def fill_step(
    begin: int,
    end: int,
    method: Method,
    fill: Callable,
    source: Source,
    numbers: np.ndarray,
    position: np.ndarray,
    tile: np.ndarray,
    width: int,
    state: Memory,
    steps: Memory,
    at: int,
    places: Memory,
    first: int,
) -> None:
    """Fill the places begin … end − 1 of a step."""
    own = in_lanes(position)
    for s in range(begin, end):
        for lane in range(LANES):
            turned = steps[at + FROM, lane] + method.shares[s] * steps[at + LENGTH, lane]
            turned = smaller(larger(turned, steps[at + LOW, lane]), steps[at + HIGH, lane])
            own[0, lane] = state[START, lane] + state[WAY, lane] * turned
        fill_place(fill, source, numbers, position, tile, state[WAY], state[WHEEL], width, places, first + width * s)


@routine
def go_on(wide: int, cycle: float, edges: Memory, count: int, state: Memory, steps: Memory, at: int) -> float:
    """Take the step in the lanes where it misses little enough, or make it shorter; how many lanes go on."""
    going = 0.0
    for lane in range(wide):
        missed, length = state[MISSED, lane], steps[at + LENGTH, lane]
        # A lane without a number where it comes to never gets there.
        lost = not missed < math.inf
        taken = (missed <= 1.0) | ((length < SHORTEST * cycle) & (not lost))
        root = math.sqrt(math.sqrt(math.sqrt(missed)))
        share = smaller(larger(SAFETY / root, SHRINK), GROW) if missed > 0.0 else GROW
        share = SHRINK if lost else share
        if state[LAYING, lane] == 0.0:
            continue
        # How far the next one goes follows from what was tried, were it cut short by an edge.
        state[TRY, lane] = larger(length * share, state[TRY, lane]) if taken else length * share
        if not taken:
            steps[at + LENGTH, lane] = 0.0
            if lost & (length < SHORTEST * cycle):
                state[LAYING, lane] = 0.0
            going += state[LAYING, lane]
            continue
        k = int(state[NEXT, lane])
        rest = edges[k, lane] - state[TURNED, lane]
        state[TURNED, lane] = edges[k, lane] if length >= rest else state[TURNED, lane] + length
        state[E, lane], state[SCALE, lane] = state[E_AFTER, lane], state[WORK, lane]
        while k < count and edges[k, lane] <= state[TURNED, lane]:
            k += 1
        state[NEXT, lane] = float(k)
        if k >= count:
            state[LAYING, lane] = 0.0
        going += state[LAYING, lane]
    return going


@routine
def lay_mesh(
    wide: int,
    most: int,
    method: Method,
    cycle: float,
    fill: Callable,
    source: Source,
    form: Form,
    numbers: np.ndarray,
    position: np.ndarray,
    tile: np.ndarray,
    drive: Memory,
    exponents: Memory,
    edges: Memory,
    sides: Memory,
    count: int,
    state: Memory,
    steps: Memory,
    places: Memory,
    stages: Memory,
) -> int:
    """Lay the steps of a cycle in lanes that are LAYING, from the energy E on; returns how many there are.

    In other lanes they are of no length. A lane that is still LAYING has more than `most`.
    """
    for lane in range(LANES):
        state[TURNED, lane], state[NEXT, lane], state[SCALE, lane] = 0.0, 1.0, 0.0
        k = 1
        while k < count and edges[k, lane] <= 0.0:
            k += 1
        state[NEXT, lane] = float(k)
    made, going = 0, 1.0
    while going > 0.0 and made < most:
        at, first = STEP_ROWS * made, form.width * method.shares.shape[0] * made
        choose_steps(edges, sides, count, state, steps, at)
        fill_step(
            0,
            method.shares.shape[0] if method.implicit else method.stages,
            method,
            fill,
            source,
            numbers,
            position,
            tile,
            form.width,
            state,
            steps,
            at,
            places,
            first,
        )
        for lane in range(wide):
            speed = state[KEPT, lane]
            kept = speed * speed / places[first + INVERSE, lane]
            state[E, lane] = kept if speed > 0.0 else state[E, lane]
            state[E_AFTER, lane] = state[E, lane]
        step = steps[at + LENGTH]
        make_stages(
            ROW_OF[0], method.stages, wide, method, form, drive, exponents, places, first, state[E], step, stages
        )
        add_weighted(wide, method.weights, step, stages, ROW_OF[MOMENT], state[E_AFTER])
        judge_step(wide, method, cycle, state, steps, at, stages)
        going = go_on(wide, cycle, edges, count, state, steps, at)
        made += 1
    return made
