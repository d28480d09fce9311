"""Runs in crank angle: stretches in the energy form while the machine moves briskly."""

from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE, LANES
from engine.motion.moments.grid import edges_of
from engine.motion.regula_falsi import regula_falsi
from engine.motion.runs.run_progress import Progress
from engine.motion.steppers.dormand_prince import ORDER_EIGHT
from engine.motion.steppers.energy_form import ABOVE, ANGLE, BELOW, NEAR_REST, STIFF, TIME
from engine.motion.steppers.going import FOUND, go_on_to_end, new_going_room
from engine.motion.steppers.places import form_of, source_of
from engine.motion.steppers.radau import ORDER_NINE
from engine.motion.steppers.tableaux import Method
from engine.motion.steppers.time_form import State
from engine.verdicts import Verdict

# For motors that aren't steep, and those that are.
METHODS = (ORDER_EIGHT, ORDER_NINE)
# What a single step may miss: anything.
WHATEVER = 1e30


class Limits(NamedTuple):
    """Ends of a stretch, each (variants,): angle [rad], time [s], speeds from below and above [rad/s].

    A speed `below` that is negative says that the stretch goes on as long as there is energy, near to rest as well.
    """

    turned: np.ndarray
    time: np.ndarray
    above: np.ndarray
    below: np.ndarray


class Stretch(NamedTuple):
    """How a stretch went, each (variants,): why it stopped, angle turned, energy, time, and what was gathered.

    `tried` is the length of the step that would have passed the end [rad].
    """

    stop: np.ndarray
    turned: np.ndarray
    energy: np.ndarray
    time: np.ndarray
    works: np.ndarray
    squares: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray
    tried: np.ndarray


def stretch(runs: Progress, who: np.ndarray) -> None:
    """A stretch in the energy form, up to an end of the run or to where the machine slows down."""
    steep = np.zeros(who.size, bool)
    while who.size:
        goal = np.minimum(runs.ends.turned[who], runs.ends.most_turned[who]) - runs.state.turned[who]
        # What is noted is noted cycle by cycle.
        near = goal if runs.notes is None else np.minimum(goal, runs.dynamics.cycle)
        ends = Limits(
            near, runs.ends.time[who] - runs.state.time[who], runs.above[who], np.maximum(runs.below[who], 0.0)
        )
        before, after = runs.part(who), _gone(runs, who, steep, ends, runs.tolerance, runs.notes is not None)
        _take(runs, who, after)
        onward = (after.stop == ANGLE) & (near < goal)
        becomes_steep = after.stop == STIFF
        over = ~onward & ~becomes_steep
        _finish(runs, who[over], steep[over], Stretch(*(x[..., over] for x in after)), before.turned[over], goal[over])
        steep = (steep | becomes_steep)[~over]
        who = who[~over]


def _gone(
    runs: Progress, who: np.ndarray, steep: np.ndarray, ends: Limits, tolerance: float, note: bool = False
) -> Stretch:
    """Go from where they stand: explicitly, or implicitly where a motor is steep."""
    parts = [(method, np.flatnonzero(steep == implicit)) for implicit, method in enumerate(METHODS)]
    found = [
        (some, _carried(method, runs, who[some], Limits(*(x[some] for x in ends)), tolerance, note))
        for method, some in parts
        if some.size
    ]
    if len(found) == 1:
        return found[0][1]
    whole = [np.empty((*x.shape[:-1], who.size), x.dtype) for x in found[0][1]]
    for some, part in found:
        for into, values in zip(whole, part, strict=True):
            into[..., some] = values
    return Stretch(*whole)


def _carried(method: Method, runs: Progress, who: np.ndarray, ends: Limits, tolerance: float, note: bool) -> Stretch:
    dynamics, part, state = runs.dynamics, runs.variants.some(who), runs.part(who)
    count, cycle = who.size, dynamics.cycle
    begin = runs.start[who] + part.direction * state.turned
    form = form_of(dynamics, len(part.drive.kloss))
    source, tabulation = source_of(dynamics, form), dynamics.reduction.tabulation
    energy = 0.5 * dynamics.rows(part, begin[None]).inertia[0] * state.omega**2
    with np.errstate(all="ignore"):
        whole = np.floor(ends.turned / cycle)
        rest = np.where(np.isfinite(whole), ends.turned - whole * cycle, np.inf)
    longest = np.full(count, runs.farthest_step)
    first = np.where(np.isfinite(ends.turned), np.minimum(longest, ends.turned), longest)
    longest, first = (np.where(tolerance < WHATEVER, x, 2.0 * cycle) for x in (longest, first))
    numbers = [begin, part.direction, part.flywheel, np.full(count, tolerance), energy, whole, rest]
    numbers = np.array([*numbers, ends.time, ends.above, ends.below, longest, first], float)
    edges, sides = edges_of(part.direction, part.breaks, cycle, begin)
    asked = np.empty((0, count))
    if note:
        asked = np.arange(1, runs.steps + 1)[:, None] * (cycle / runs.steps)
    record, found = np.full((3, asked.shape[0], count), np.nan), np.empty((FOUND + form.channels, count))
    given = [part.parameters, part.drive.rows, part.drive.exponents, edges, sides, numbers, asked]
    given = [np.require(x, requirements="CW") for x in given]

    def arguments() -> tuple:
        room = new_going_room(form, part.parameters.shape[0], edges.shape[0], source.target.size, method)
        fill, laws = tabulation.function("curves_at"), dynamics.channel_of_laws
        return fill, source, method, form, laws, cycle, *given, record, found, room

    if not go_on_to_end.overloads:
        kinds = (numba.typeof(x) for x in arguments()[1:])
        prepare(go_on_to_end, [types.intp, types.intp, FILLS_TILE, *kinds])
    spread(go_on_to_end, -(-count // LANES), arguments)
    stop, cycles, turned, after, time, motors, squares, slowest, fastest, tried, _ = found[:FOUND]
    works = np.concatenate((motors[None], found[FOUND:]))
    if form.channels == 1:
        # What the motors didn't give.
        works[1] = after - energy - motors
    if note:
        _note_nodes(runs, record[:, :, 0], asked[:, 0])
    turned = cycles * cycle + turned
    return Stretch(stop.astype(int), turned, after, time, works, squares, slowest, fastest, tried)


def _note_nodes(runs: Progress, record: np.ndarray, asked: np.ndarray) -> None:
    known = np.isfinite(record[0])
    if not known.any():
        return
    turned = runs.state.turned + asked[known]
    places = (runs.start + runs.variants.direction * turned)[:, None]
    inertia = runs.dynamics.rows(runs.variants, places).inertia[:, 0]
    runs.note(record[1, known] + runs.state.time, turned, np.sqrt(2.0 * record[0, known] / inertia))


def _take(runs: Progress, who: np.ndarray, after: Stretch) -> None:
    state, part = runs.part(who), runs.variants.some(who)
    turned = state.turned + after.turned
    inertia = runs.dynamics.rows(part, (runs.start[who] + part.direction * turned)[None]).inertia[0]
    omega = np.sqrt(2.0 * after.energy / inertia)
    works, squares = state.works + after.works, state.squares + after.squares
    runs.put(who, State(turned, omega, state.time + after.time, works, squares))
    runs.slowest[who] = np.fmin(runs.slowest[who], after.slowest)
    runs.fastest[who] = np.fmax(runs.fastest[who], after.fastest)


def _finish(
    runs: Progress, who: np.ndarray, steep: np.ndarray, after: Stretch, begun: np.ndarray, goal: np.ndarray
) -> None:
    """Go the last piece to the end of the run, part of a step, where there is one."""
    stop = after.stop
    lost = (stop == ANGLE) & (runs.ends.most_turned[who] < runs.ends.turned[who])
    exact = (stop == ANGLE) & ~lost
    # No sum of steps comes to it so exactly.
    runs.state.turned[who[exact]] = (begun + goal)[exact]
    sub = np.flatnonzero(np.isin(stop, (TIME, ABOVE, BELOW)))
    if sub.size:
        length = _length_to_end(runs, who[sub], steep[sub], stop[sub], after.tried[sub])
        _take(runs, who[sub], _piece(runs, who[sub], steep[sub], length))
    if sub.size or exact.any():
        runs.note_now()
    runs.done[who[exact]], runs.done[who[sub]] = True, True
    runs.give_up(who[lost], Verdict.NO_END)
    # What is left slows down towards rest, and goes on in time.
    runs.facing[who[stop == NEAR_REST]] = 1.0


def _piece(runs: Progress, who: np.ndarray, steep: np.ndarray, length: np.ndarray) -> Stretch:
    """A single step of the given length [rad]."""
    free = np.full(who.size, np.inf)
    return _gone(runs, who, steep, Limits(length, free, free, np.full(who.size, -1.0)), WHATEVER)


def _length_to_end(
    runs: Progress, who: np.ndarray, steep: np.ndarray, stop: np.ndarray, step: np.ndarray
) -> np.ndarray:
    """How far [rad] it is to the wanted time or speed, less than a step."""
    part, state = runs.variants.some(who), runs.part(who)
    begin = runs.start[who] + part.direction * state.turned

    def excess(length: np.ndarray) -> np.ndarray:
        gone = _piece(runs, who, steep, length)
        inertia = runs.dynamics.rows(part, (begin + part.direction * length)[None]).inertia[0]
        omega = np.sqrt(2.0 * gone.energy / inertia)
        above, below = omega - runs.above[who], runs.below[who] - omega
        time = state.time + gone.time - runs.ends.time[who]
        return np.where(stop == TIME, time, np.where(stop == ABOVE, above, below))

    return regula_falsi(excess, np.zeros(who.size), step)
