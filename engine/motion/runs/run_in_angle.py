"""Runs in crank angle: stretches in the energy form while the machine moves briskly."""

from typing import NamedTuple

import numba
import numpy as np
from numba import types

from engine.compiling.running import prepare, spread
from engine.compiling.tiles import FILLS_TILE
from engine.compiling.widths import LANES
from engine.cycle.regula_falsi import regula_falsi
from engine.laws.runge_kutta import ORDER_EIGHT, Method
from engine.motion.moments.grid import edges_of
from engine.motion.runs.run_progress import COARSER, Progress
from engine.motion.runs.settled_runs import Carry, pass_mark
from engine.motion.runs.watching import BetweenNodes, Piece
from engine.motion.steppers.classical import ORDER_FOUR
from engine.motion.steppers.energy_form import ABOVE, ANGLE, BELOW, NEAR_REST, STIFF, TIME
from engine.motion.steppers.going import FOUND, IN_DOUBT, go_on_to_end, new_going_room
from engine.motion.steppers.places import form_of, source_of
from engine.motion.steppers.radau import ORDER_NINE, ORDER_THIRTEEN
from engine.motion.steppers.time_form import State
from engine.verdicts import Verdict

# For motors that aren't steep, and those that are; where steps are looked within, and where only their ends count.
LOOKED_WITHIN, TO_THE_END = (ORDER_EIGHT, ORDER_NINE), (ORDER_THIRTEEN, ORDER_NINE)
# Places of a step between which extremes are searched, for comparison: some of those that a method names.
FEWER = [0, 2, 5]
# Steps of the order thirteen may turn so many times as far.
FARTHER = 4.0
# Cycles after which it is first looked whether a run comes nearer to a speed; then twice as many each time.
FIRST_CYCLES = 8
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

    `tried` is the length of the step that would have passed the end [rad]. `doubts` are as of `Progress`.
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
    doubts: np.ndarray


def stretch(runs: Progress, who: np.ndarray, carry: Carry) -> None:
    """A stretch in the energy form, up to an end of the run or to where the machine slows down."""
    steep, many = np.zeros(who.size, bool), np.full(who.size, FIRST_CYCLES)
    runs.begin_cycles(who)
    while who.size:
        goal = np.minimum(runs.ends.turned[who], runs.ends.most_turned[who]) - runs.state.turned[who]
        # What is looked at is looked at cycle by cycle.
        cycles = np.ones_like(many) if runs.observers else many
        to_mark = runs.mark[who] - runs.state.turned[who] + (cycles - 1) * runs.dynamics.cycle
        marked = runs.by_speed[who]
        near = np.minimum(goal, np.where(marked, to_mark, runs.dynamics.cycle if runs.observers else np.inf))
        ends = Limits(
            near, runs.ends.time[who] - runs.state.time[who], runs.above[who], np.maximum(runs.below[who], 0.0)
        )
        before, after = runs.part(who), _gone(runs, who, steep, ends, runs.tolerance, look=True)
        _take(runs, who, after)
        onward = (after.stop == ANGLE) & (near < goal)
        pass_mark(runs, who[onward & marked], carry)
        becomes_steep = after.stop == STIFF
        over = ~onward & ~becomes_steep
        _finish(
            runs,
            who[over],
            steep[over],
            Stretch(*(x[..., over] for x in after)),
            State(*(x[..., over] for x in before)),
            goal[over],
        )
        runs.set_marks(who[over & marked])
        goes_on = ~over & ~runs.done[who]
        steep, many, who = (steep | becomes_steep)[goes_on], np.where(onward, 2 * many, many)[goes_on], who[goes_on]


def _gone(
    runs: Progress, who: np.ndarray, steep: np.ndarray, ends: Limits, tolerance: float, look: bool = False
) -> Stretch:
    """Go from where they stand: explicitly, or implicitly where a motor is steep."""
    look, before, parts = look and len(runs.observers) > 0, runs.part(who), []
    methods = TO_THE_END if runs.to_the_end else LOOKED_WITHIN
    for newton, method in enumerate((ORDER_FOUR,) if runs.classical else methods):
        some = np.flatnonzero(steep == newton)
        if not some.size:
            continue
        own, state = who[some], State(*(x[..., some] for x in before))
        asked = _nodes(runs, own, state) if look else np.empty((0, some.size))
        gone, record = _carried(method, runs, own, state, Limits(*(x[some] for x in ends)), tolerance, asked)
        if look:
            runs.see(own, _piece_of(method, runs, own, state, asked, record, gone))
        parts.append((some, gone))
    if len(parts) == 1:
        return parts[0][1]
    whole = [np.empty((*x.shape[:-1], who.size), x.dtype) for x in parts[0][1]]
    for some, part in parts:
        for into, values in zip(whole, part, strict=True):
            into[..., some] = values
    return Stretch(*whole)


def _nodes(runs: Progress, who: np.ndarray, state: State) -> np.ndarray:
    """Angles turned from a state on (nodes, variants) at which a cycle is looked at."""
    part, cycle = runs.variants.some(who), runs.dynamics.cycle
    # A force may jump where its moment only bends, for want of motion: at a dead centre.
    sided = part._replace(breaks=part.breaks.two_sided())
    steps = runs.dynamics.grid(sided, _place(runs, who, state), cycle, runs.steps).steps
    return np.minimum(np.concatenate((np.zeros((1, who.size)), np.cumsum(steps, axis=0))), cycle)


def _place(runs: Progress, who: np.ndarray, state: State) -> np.ndarray:
    return runs.start[who] + runs.variants.direction[who] * state.turned


def _carried(
    method: Method,
    runs: Progress,
    who: np.ndarray,
    state: State,
    ends: Limits,
    tolerance: float,
    asked: np.ndarray,
) -> tuple[Stretch, np.ndarray]:
    """Go from a state; with the stretch comes what is recorded at the asked angles (3, nodes, variants)."""
    dynamics, part = runs.dynamics, runs.variants.some(who)
    count, cycle, begin = who.size, dynamics.cycle, _place(runs, who, state)
    doubtful = runs.half and not runs.classical
    if doubtful and not method.newton:
        method = method._replace(looked_at=method.looked_at[FEWER])
    elif doubtful:
        # A steep motor answers to every change of the energy with one that it has to be followed through.
        tolerance *= COARSER
    form = form_of(dynamics, len(part.drive.kloss))
    source, tabulation = source_of(dynamics, form), dynamics.reduction.tabulation
    energy = 0.5 * runs.inertia(who, state.turned) * state.omega**2
    with np.errstate(all="ignore"):
        whole = np.floor(ends.turned / cycle)
        rest = np.where(np.isfinite(whole), ends.turned - whole * cycle, np.inf)
    farther = FARTHER if method.implicit and not method.newton else 1.0
    longest = np.full(count, farther * runs.farthest_step)
    first = np.where(np.isfinite(ends.turned), np.minimum(longest, ends.turned), longest)
    longest, first = (np.where(tolerance < WHATEVER, x, 2.0 * cycle) for x in (longest, first))
    numbers = [begin, part.direction, part.flywheel, np.full(count, tolerance), energy, whole, rest]
    numbers = np.array([*numbers, ends.time, ends.above, ends.below, longest, first], float)
    edges, sides = edges_of(part.direction, part.breaks, cycle, begin)
    record, found = np.full((3, asked.shape[0], count), np.nan), np.empty((FOUND + 2 * form.channels, count))
    given = [part.parameters, part.drive.rows, part.drive.exponents, edges, sides, numbers, asked]
    given = [np.require(x, requirements="CW") for x in given]

    def arguments() -> tuple:
        room = new_going_room(form, part.parameters.shape[0], edges.shape[0], source.target.size, method)
        fill, laws = tabulation.function("curves_at"), dynamics.channel_of_laws
        return fill, source, method, form, laws, cycle, doubtful, *given, record, found, runs.extremes, room

    if not go_on_to_end.overloads:
        kinds = (numba.typeof(x) for x in arguments()[1:])
        prepare(go_on_to_end, [types.intp, types.intp, FILLS_TILE, *kinds])
    spread(go_on_to_end, -(-count // LANES), arguments)
    stop, cycles, turned, after, time, motors, squares, slowest, fastest, tried, _ = found[:IN_DOUBT]
    works = np.concatenate((motors[None], found[FOUND : FOUND + form.channels]))
    doubts = np.concatenate((found[IN_DOUBT:FOUND], found[FOUND + form.channels :]))
    if form.channels == 1:
        # What the motors didn't give.
        works[1] = after - energy - motors
        doubts[-1] = doubts[0] - doubts[3]
    if not method.implicit or method.newton or doubtful:
        doubts[:] = np.nan
    turned = cycles * cycle + turned
    return Stretch(stop.astype(int), turned, after, time, works, squares, slowest, fastest, tried, doubts), record


def _piece_of(
    method: Method,
    runs: Progress,
    who: np.ndarray,
    before: State,
    asked: np.ndarray,
    record: np.ndarray,
    gone: Stretch,
) -> Piece:
    """What was recorded of a stretch at the asked angles; its end stands in for those beyond it, and once more."""
    part, begin, passed = runs.variants.some(who), _place(runs, who, before), np.isfinite(record[0])
    last = np.full((1, part.count), False)
    passed = np.concatenate((passed, last))

    def up_to_end(rows: np.ndarray, end: np.ndarray) -> np.ndarray:
        return np.where(passed, np.concatenate((rows, np.zeros_like(rows[:1]))), end)

    turned = up_to_end(asked, gone.turned)
    energy, time = up_to_end(record[0], gone.energy), up_to_end(record[1], gone.time)
    moment = np.where(passed, np.concatenate((record[2], record[2][-1:])), np.nan)
    inertia = runs.dynamics.rows(part, begin + part.direction * turned).inertia
    with np.errstate(all="ignore"):
        omega = np.sqrt(2.0 * energy / inertia)
    steps, way = np.diff(turned, axis=0), np.ones(part.count)
    time, turned = before.time + time, before.turned + turned

    def step(columns: np.ndarray, nodes: np.ndarray, lengths: np.ndarray) -> tuple[np.ndarray, ...]:
        own, blank = who[columns], State(*(x[..., columns] for x in before))
        here = blank._replace(turned=turned[nodes, columns], omega=omega[nodes, columns], time=time[nodes, columns])
        free = np.full(own.size, np.inf)
        ends = Limits(lengths, free, free, np.full(own.size, -1.0))
        there, seen = _carried(method, runs, own, here, ends, WHATEVER, lengths[None])
        place = _place(runs, own, here._replace(turned=here.turned + lengths))
        inertia = runs.dynamics.rows(runs.variants.some(own), place[None]).inertia[0]
        speed = np.sqrt(2.0 * there.energy / inertia)
        return here.time + there.time, here.turned + lengths, speed, seen[2, 0]

    return Piece(time, turned, omega, way, steps, moment, BetweenNodes(False, step))


def _take(runs: Progress, who: np.ndarray, after: Stretch) -> None:
    state = runs.part(who)
    turned = state.turned + after.turned
    omega = np.sqrt(2.0 * after.energy / runs.inertia(who, turned))
    works, squares = state.works + after.works, state.squares + after.squares
    runs.put(who, State(turned, omega, state.time + after.time, works, squares))
    runs.slowest[who] = np.fmin(runs.slowest[who], after.slowest)
    runs.fastest[who] = np.fmax(runs.fastest[who], after.fastest)


def _finish(
    runs: Progress, who: np.ndarray, steep: np.ndarray, after: Stretch, before: State, goal: np.ndarray
) -> None:
    """Go the last piece to the end of the run, part of a step, where there is one."""
    stop = after.stop
    lost = (stop == ANGLE) & (runs.ends.most_turned[who] < runs.ends.turned[who])
    exact = (stop == ANGLE) & ~lost
    # No sum of steps comes to it so exactly.
    runs.state.turned[who[exact]] = (before.turned + goal)[exact]
    whole = exact & (before.time == 0.0)
    runs.doubts[:, who[whole]] = after.doubts[:, whole]
    sub = np.flatnonzero(np.isin(stop, (TIME, ABOVE, BELOW)))
    if sub.size:
        length = _length_to_end(runs, who[sub], steep[sub], stop[sub], after.tried[sub])
        _take(runs, who[sub], _last_step(runs, who[sub], steep[sub], length, look=True))
    runs.done[who[exact]], runs.done[who[sub]] = True, True
    runs.give_up(who[lost], Verdict.NO_END)
    # What is left slows down towards rest, and goes on in time.
    runs.facing[who[stop == NEAR_REST]] = 1.0


def _last_step(runs: Progress, who: np.ndarray, steep: np.ndarray, length: np.ndarray, look: bool = False) -> Stretch:
    """A single step of the given length [rad]."""
    free = np.full(who.size, np.inf)
    return _gone(runs, who, steep, Limits(length, free, free, np.full(who.size, -1.0)), WHATEVER, look)


def _length_to_end(
    runs: Progress, who: np.ndarray, steep: np.ndarray, stop: np.ndarray, step: np.ndarray
) -> np.ndarray:
    """How far [rad] it is to the wanted time or speed, less than a step."""
    part, state = runs.variants.some(who), runs.part(who)
    begin = runs.start[who] + part.direction * state.turned

    def excess(length: np.ndarray) -> np.ndarray:
        gone = _last_step(runs, who, steep, length)
        inertia = runs.dynamics.rows(part, (begin + part.direction * length)[None]).inertia[0]
        omega = np.sqrt(2.0 * gone.energy / inertia)
        above, below = omega - runs.above[who], runs.below[who] - omega
        time = state.time + gone.time - runs.ends.time[who]
        return np.where(stop == TIME, time, np.where(stop == ABOVE, above, below))

    return regula_falsi(excess, np.zeros(who.size), step)
