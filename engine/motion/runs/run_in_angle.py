"""Runs in crank angle: stretches in the energy form while the machine moves briskly, over a grid of nodes."""

import numpy as np

from engine.motion.regula_falsi import regula_falsi
from engine.motion.runs.run_progress import Progress
from engine.motion.steppers.energy_form import ABOVE, ANGLE, BELOW, NEAR_REST, NODES, TIME, Course, Limits, Tables
from engine.motion.steppers.stepping import advance
from engine.motion.steppers.time_form import State
from engine.verdicts import Verdict


def stretch(runs: Progress, who: np.ndarray) -> None:
    """A stretch in the energy form, up to an end of the run or to where the machine slows down."""
    part, state = runs.variants.some(who), runs.part(who)
    begin = runs.start[who] + part.direction * state.turned
    nodes, tables = runs.dynamics.nested(part, begin, runs.steps, runs.half)
    goal = np.minimum(runs.ends.turned[who], runs.ends.most_turned[who]) - state.turned
    cycles = np.floor(goal / runs.dynamics.cycle)
    whole = (nodes <= (goal - cycles * runs.dynamics.cycle) * (1.0 + 1e-14)).sum(axis=0) - 1
    limits = Limits(
        (cycles * tables.steps.shape[0] + whole).astype(np.int64),
        runs.ends.time[who] - state.time,
        runs.above[who],
        np.maximum(runs.below[who], 0.0),
    )
    energy = 0.5 * tables.inertia[0] * state.omega**2
    record = None
    if runs.notes is not None:
        record = np.empty((2, min(int(limits.steps[0]) + 1, 2_000_000), 1))
    course = advance(runs.dynamics, part, tables, energy, limits, record)
    made, per = course.made, tables.steps.shape[0]
    k = made % per
    turned = made // per * runs.dynamics.cycle + nodes[k, np.arange(who.size)]
    inertia = tables.at(2 * k, np.arange(who.size)).inertia[0]
    omega = np.sqrt(2.0 * course.energy / inertia)
    if record is not None:
        _note_nodes(runs, record, int(made[0]), tables, nodes)
    _take(runs, who, state, turned, omega, course)
    _finish(runs, who, course.stop, tables.steps[k, np.arange(who.size)], goal - turned)


def _note_nodes(runs: Progress, record: np.ndarray, made: int, tables: Tables, nodes: np.ndarray) -> None:
    per = tables.steps.shape[0]
    index = np.arange(1, min(made + 1, record.shape[1]))
    omega = np.sqrt(2.0 * record[0, index, 0] / tables.inertia[NODES][index % per, 0])
    turned = index // per * runs.dynamics.cycle + nodes[index % per, 0]
    runs.note(record[1, index, 0] + runs.state.time, turned + runs.state.turned, omega)


def _take(runs: Progress, who: np.ndarray, state: State, turned: np.ndarray, omega: np.ndarray, course: Course) -> None:
    runs.put(
        who,
        State(
            state.turned + turned,
            omega,
            state.time + course.time,
            state.works + course.works,
            state.squares + course.squares,
        ),
    )
    runs.slowest[who] = np.minimum(runs.slowest[who], course.slowest)
    runs.fastest[who] = np.maximum(runs.fastest[who], course.fastest)


def _finish(runs: Progress, who: np.ndarray, stop: np.ndarray, step: np.ndarray, rest: np.ndarray) -> None:
    """Go the last piece to the end of the run, part of a step, where there is one."""
    lost = (stop == ANGLE) & (runs.ends.most_turned[who] < runs.ends.turned[who])
    ending = np.isin(stop, (ANGLE, TIME, ABOVE, BELOW)) & ~lost
    sub = np.flatnonzero(ending)
    if sub.size:
        length = np.where(stop[sub] == ANGLE, np.maximum(rest[sub], 0.0), 0.0)
        searched = np.flatnonzero(stop[sub] != ANGLE)
        if searched.size:
            length[searched] = _length_to_end(runs, who[sub[searched]], stop[sub[searched]], step[sub[searched]])
        _piece(runs, who[sub], length, take=True)
        runs.done[who[sub]] = True
    runs.give_up(who[lost], Verdict.NO_END)
    # What is left slows down towards rest, and goes on in time.
    runs.facing[who[stop == NEAR_REST]] = 1.0


def _piece(runs: Progress, who: np.ndarray, length: np.ndarray, take: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """Time and speed after a single step of the given length [rad]."""
    part, state = runs.variants.some(who), runs.part(who)
    begin = runs.start[who] + part.direction * state.turned
    places = begin + part.direction * length * np.array([[0.0], [0.5], [1.0]])
    rows = runs.dynamics.rows(part, places)
    tables = Tables(length[None], rows.inertia, rows.loads, rows.powers)
    free = np.full(who.size, np.inf)
    limits = Limits(np.ones(who.size, np.int64), free, free, np.full(who.size, -1.0))
    course = advance(runs.dynamics, part, tables, 0.5 * rows.inertia[0] * state.omega**2, limits)
    omega = np.sqrt(2.0 * course.energy / rows.inertia[2])
    if take:
        _take(runs, who, state, length, omega, course)
        runs.note_now()
    return state.time + course.time, omega


def _length_to_end(runs: Progress, who: np.ndarray, stop: np.ndarray, step: np.ndarray) -> np.ndarray:
    """How far [rad] it is to the wanted time or speed, less than a step."""

    def excess(length: np.ndarray) -> np.ndarray:
        time, omega = _piece(runs, who, length)
        above, below = omega - runs.above[who], runs.below[who] - omega
        return np.where(stop == TIME, time - runs.ends.time[who], np.where(stop == ABOVE, above, below))

    return regula_falsi(excess, np.zeros(who.size), step)
