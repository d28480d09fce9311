"""Runs over the crank angle: stretches in the energy form while the energy changes slowly."""

import numpy as np

from engine.motion.fields.recorded_motion import OneSpeedMotion
from engine.motion.one_speed import AngleEnd
from engine.motion.runs.one_speed_run import OneSpeedRuns
from engine.motion.runs.run_progress import AT_SPEED, State
from engine.motion.runs.settled_runs import pass_mark
from engine.stepping.methods import EIGHT, FOUR, NINE
from engine.stepping.recorded import RECORDED, made_steps
from engine.stepping.records import put, some, variant_columns
from engine.stepping.system import RECORDED_AT, Start, Walks
from engine.stepping.walk_task import LONGER, WALKS, Why

# Relative energy change per radian above which the energy form is abandoned: near rest 1/ω is singular as the inverse
# root of the angle. The limit is lower if values within steps are needed, as dense output resolves it less far.
TIMES_PER_RADIAN, TIMES_TO_THE_END = 4.0, 40.0
# Minimum tolerance of steps; maximum step, relative to that in time.
LEAST, FARTHER = 1e-14, 2.0
# Reduction of the maximum step if dense output is used: it has a lower order than the step.
CLOSELY = 0.5
# Cycles before the first test whether a run still approaches a speed; the number doubles each time.
FIRST_CYCLES = 8
# Relative difference of speeds that are equal but for rounding.
SAME = 1e-14
ENERGY, TIME = range(2)


def stretch_over_angle(runs: OneSpeedRuns, who: np.ndarray) -> None:
    """Integrate a stretch in the energy form, to an end of the run or until the machine slows down."""
    steep, many = np.zeros(who.size, bool), np.full(who.size, FIRST_CYCLES)
    pace = np.full(who.size, FARTHER * runs.farthest_step)
    system = runs.dynamics.by_angle
    if not len(runs.carried):
        runs.carried = np.zeros((len(system.rates), runs.variants.count))
    runs.begin_cycles(who)
    while who.size:
        state = runs.part(who)
        goal = np.minimum(runs.ends.turned[who], runs.ends.most_turned[who]) - state.turned
        # Observers receive one cycle at a time.
        cycles = np.ones_like(many) if runs.observers else many
        to_mark = runs.mark[who] - state.turned + (cycles - 1) * runs.dynamics.cycle
        marked = runs.by_speed[who]
        near = np.minimum(goal, np.where(marked, to_mark, runs.dynamics.cycle if runs.observers else np.inf))
        why = np.empty(who.size)
        for implicit in (False, True):
            own = np.flatnonzero(steep == implicit)
            if own.size:
                why[own], pace[own] = _walk(runs, who[own], implicit, near[own], pace[own])
        at_goal = why == Why.GOAL
        onward = at_goal & (near < goal)
        pass_mark(runs, who[onward & marked])
        lost = at_goal & ~onward & (runs.ends.most_turned[who] < runs.ends.turned[who])
        exact = at_goal & ~onward & ~lost
        # Set the angle exactly: sums of steps are rounded.
        runs.state.turned[who[exact]] = (state.turned + goal)[exact]
        runs.done[who[exact | np.isin(why, (Why.OTHER_GOAL, *AT_SPEED))]] = True
        runs.give_up(who[lost])
        # The others slow down towards rest, and continue in time.
        runs.facing[who[np.isin(why, (AngleEnd.SLOW, Why.LOST))]] = 1.0
        onward |= np.isin(why, (Why.STEEP, Why.FULL))
        runs.set_marks(who[~onward & marked])
        left = onward & ~runs.done[who]
        if runs.longer == LONGER:
            _add_errors(runs, who[~left])
        runs.steep[who[why == Why.STEEP]] = 1.0
        many = np.where(at_goal, 2 * many, many)
        steep, many, pace, who = (steep | (why == Why.STEEP))[left], many[left], pace[left], who[left]


def _add_errors(runs: OneSpeedRuns, who: np.ndarray) -> None:
    """Add the error estimates at the end of a stretch to its state."""
    put(runs.state, who, some(runs.changed, who).added_to(runs.part(who)))


def _walk(
    runs: OneSpeedRuns, who: np.ndarray, implicit: bool, goal: np.ndarray, pace: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Walk by an angle with one method; return the reason for each end, and the length of the next step."""
    dynamics, system, state = runs.dynamics, runs.dynamics.by_angle, runs.part(who)
    direction, classical = runs.variants.direction[who], runs.stepping.classical
    begin = runs.start[who] + direction * state.turned
    method = FOUR if classical else NINE if implicit else EIGHT
    longer = runs.longer if classical else WALKS[0]
    task = system.task(dynamics.cycle, method, extremes=runs.finds_extremes, longer=longer)
    brisk = TIMES_TO_THE_END if runs.to_the_end else TIMES_PER_RADIAN
    limits = runs.speed_limits(who, system.sizes, np.ones(who.size))
    limits[system.sizes.below] = np.maximum(limits[system.sizes.below], 0.0)
    share = CLOSELY if runs.observers else 1.0 if runs.finds_extremes else FARTHER
    farthest = runs.farthest_step * (1.0 if classical else share)
    lanes = {"start": begin, "direction": direction, "tolerance": max(runs.over_angle, LEAST), "farthest": farthest}
    lanes |= {"goal": goal, "other_goal": runs.ends.time[who] - state.time, "pace": np.minimum(pace, farthest)}
    states = np.zeros((len(system.rates), who.size))
    states[ENERGY] = 0.5 * runs.inertia(who, state.turned) * state.omega**2
    numbers = variant_columns(dynamics.moving(system, runs.variants), who)
    numbers = system.limited(numbers, limits | {system.sizes.brisk: brisk})
    recorded = RECORDED if runs.observers else 0
    edges, carried = runs.edges(who, begin), runs.carried[:, who]
    gone = system.run(task, Start(numbers, lanes, states, edges, carried_errors=carried, recorded=recorded))
    if runs.observers and (gone.steps > 0.0).any():
        runs.see(_seen(runs, who, state, gone, implicit))
    _take(runs, who, states[ENERGY], gone)
    return gone.why, gone.pace


def _take(runs: OneSpeedRuns, who: np.ndarray, before: np.ndarray, gone: Walks) -> None:
    """Store the states at the ends of walks, and their error estimates."""
    state, energy = runs.part(who), gone.states[ENERGY]
    turned = state.turned + gone.turned
    omega = np.sqrt(2.0 * energy / runs.inertia(who, turned))
    # An error of the time or speed that ends the run shifts its end.
    by_time, by_speed = gone.why == Why.OTHER_GOAL, np.isin(gone.why, AT_SPEED)
    slides = np.where(by_time, gone.carried_errors[TIME] * omega, 0.0)
    slides = np.where(by_speed, gone.carried_errors[ENERGY] / np.abs(gone.slope), slides)
    off = gone.carried_errors + np.where(slides > 0.0, np.abs(gone.ending) * slides, 0.0)
    speed_off = gone.carried_errors[ENERGY] + np.where(slides > 0.0, np.abs(gone.slope) * slides, 0.0)
    speed_off = np.where(by_speed, 0.0, 0.5 * omega / energy * speed_off)
    system = runs.dynamics.by_angle
    works, squares = runs.dynamics.gathered(system, gone.states, energy - before, -1.0)
    works_off, squares_off = runs.dynamics.gathered(system, off, off[ENERGY], 1.0)
    time_off = np.where(by_time, 0.0, off[TIME])
    new = slides, speed_off, off[ENERGY], time_off, squares_off, works_off
    for mine, changed in zip(runs.changed[: len(new)], new, strict=True):
        mine[..., who] = changed
    runs.carried[:, who] = gone.carried_errors
    slower, faster = gone.slowest < runs.slowest[who], gone.fastest > runs.fastest[who]
    # An extreme at the end shifts with the end.
    slow_off, fast_off = (
        np.where(np.abs(extreme - omega) <= SAME * omega, np.maximum(off, speed_off), off)
        for extreme, off in ((gone.slowest, gone.slow_off), (gone.fastest, gone.fast_off))
    )
    runs.changed.slowest[who] = np.where(slower, slow_off, runs.changed.slowest[who])
    runs.changed.fastest[who] = np.where(faster, fast_off, runs.changed.fastest[who])
    runs.slowest[who] = np.fmin(runs.slowest[who], gone.slowest)
    runs.fastest[who] = np.fmax(runs.fastest[who], gone.fastest)
    runs.put(who, State(turned, omega, state.time + gone.states[TIME], state.works + works, state.squares + squares))


def _seen(runs: OneSpeedRuns, who: np.ndarray, before: State, gone: Walks, implicit: bool) -> OneSpeedMotion:
    """The recorded steps of walks; of a comparison run, with their error estimates."""
    made = made_steps(gone.recorded, gone.steps)
    variant, states = made.variant, made.samples + (made.errors[:, None] if runs.longer > 1.0 else 0.0)
    turned = before.turned[variant] + made.begin + RECORDED_AT[:, None] * made.length
    samples = np.array([before.time[variant] + states[TIME], turned, states[ENERGY]])
    return OneSpeedMotion(runs.form, who[variant], np.ones(variant.size), samples, made.length, implicit)
