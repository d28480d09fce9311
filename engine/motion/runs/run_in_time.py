"""Runs in time: near rest, backwards, with friction in pairs, and where a moment depends on time."""

import numpy as np

from engine.motion.moments.breaks import JUMP, beside
from engine.motion.moments.grid import edges_of
from engine.motion.runs.run_in_angle import TIMES_TO_THE_END
from engine.motion.runs.run_progress import Progress, State, gathered
from engine.motion.runs.settled_runs import Carry, pass_mark
from engine.motion.runs.watching import BetweenNodes, Piece, side_by_side
from engine.stepping.methods import EIGHT
from engine.stepping.recorded import read_steps
from engine.stepping.system import SHOWN, Walks
from engine.stepping.walk import Why
from engine.words.verdicts import Verdict

# Times that a machine at rest looks whether a moment over time sets it going.
WAITS = 1000
# Time that it waits for a formula, in cycles at the speed of the scene, where nothing else ends its waiting.
MOST_CYCLES = 100.0
# Longest step where a formula over time is at work: so many times as long as between two looks.
STRIDE = 20.0
# Share of the time that it never looks sooner after: farther than both sides of a jump are apart.
AT_ONCE = 1e-9
HALVINGS = 60
# Swings that differ by no more are the same but for the error of the steps [rad].
SAME_SWING = 1e-6
# Share of its greatest speed below which a machine that nothing stops has all its way behind it.
FADED = 1e-9
# What stops does so from a speed that isn't next to nothing.
STILL = 1e-12
# How far a step may turn that is looked at within [rad], and how often it is looked at there, at least.
CLOSELY, LEAST_LOOKS = 0.1, 4
# A machine whose steps are looked within goes over time until moments change its energy by less than so many times
# itself per radian.
BRISK_TO_LOOK = 0.4
# Steps that are recorded at a time.
RECORDED = 64
# Many steps lead nowhere that change neither the angle, all together, nor the time, each, by more than these shares of
# them: beside a dead centre of the driven side the inertia grows beyond all bounds.
NO_ANGLE, NO_TIME = 1e-14, 1e-9
# Why a walk ends besides those of every walk, in the order of the guards of the system over time.
ABOVE, BELOW, TURNS_BRISK, REST = range(int(Why.GUARD), int(Why.GUARD) + 4)
TURNED, SPEED = range(2)


def set_off(runs: Progress, who: np.ndarray) -> None:
    """Choose the way for machines at rest; those that stay are at the end, or don't start."""
    if not who.size:
        return
    runs.facing[who] = runs.equation(who).sets_off(runs.state.turned[who], runs.clock[who] + runs.state.time[who])
    # An end of its range holds what is pressed against it.
    runs.facing[who[runs.ahead(who) <= 0.0]] = 0.0
    stays = who[runs.facing[who] == 0.0]
    begun = runs.state.turned[stays] != 0.0
    if runs.ends.standing:
        runs.done[stays[begun]] = True
        stays = stays[~begun]
    # It stands until a moment over time changes, or until the time is over.
    later = np.minimum(_next_look(runs, stays) - runs.clock[stays], runs.ends.time[stays])
    waits = np.isfinite(later)
    if runs.dynamics.changing:
        later[waits] = _starts_by(runs, stays[waits], later[waits])
    runs.state.time[stays[waits]] = later[waits]
    runs.done[stays[waits & (later >= runs.ends.time[stays])]] = True
    if runs.ends.standing:
        runs.done[stays[~waits]] = True
    else:
        runs.give_up(stays[~waits], Verdict.STALLS)


def _next_look(runs: Progress, who: np.ndarray) -> np.ndarray:
    """When machines at rest look again whether a moment over time sets them going; infinite where none ever will.

    What a table gives changes between its first and its last instant; what a formula gives, at any time.
    """
    begun, instants = runs.clock[who], runs.variants.instants[:, who]
    now = begun + runs.state.time[who]
    first = np.fmin.reduce(instants, axis=0, initial=np.inf)
    last = np.fmax.reduce(instants, axis=0, initial=-np.inf)
    pause = np.where(now < first, first - now, (last - first) / WAITS)
    if runs.dynamics.changing:
        last = begun + _span(runs, who)
        pause = (last - begun) / WAITS
    ahead = np.where(instants > now * (1.0 + 1e-15), instants, np.inf)
    look = np.minimum(now + np.maximum(pause, AT_ONCE * now), np.minimum.reduce(ahead, axis=0, initial=np.inf))
    return np.where(now < last, look, np.inf)


def _span(runs: Progress, who: np.ndarray) -> np.ndarray:
    """Time over which a formula over time is followed from the begin of a run on."""
    speed = np.abs(np.broadcast_to(runs.variants.numbers["input.speed"], runs.start.shape))
    cycle = (runs.spacing * runs.steps / speed)[who]
    last = np.fmax.reduce(runs.variants.instants[:, who], axis=0, initial=-np.inf)
    return np.fmin(runs.ends.time[who], np.fmax(last - runs.clock[who], MOST_CYCLES * cycle))


def _starts_by(runs: Progress, who: np.ndarray, look: np.ndarray) -> np.ndarray:
    """When machines at rest start, of those that would at the time of the next look; of others that time."""
    form, turned = runs.equation(who), runs.state.turned[who]

    def start(time: np.ndarray) -> np.ndarray:
        return form.sets_off(turned, runs.clock[who] + time) != 0.0

    started, low, high = start(look), runs.state.time[who], look
    for _ in range(HALVINGS if started.any() else 0):
        middle = 0.5 * (low + high)
        there = start(middle)
        low, high = np.where(there, low, middle), np.where(there, middle, high)
    return np.where(started, high, look)


def stretch_over_time(runs: Progress, who: np.ndarray, carry: Carry) -> tuple[np.ndarray, np.ndarray]:
    """A stretch in time, one way: to an end of the run, to rest, or until the machine moves briskly.

    Returns
    -------
    brisk : ndarray of bool
        Which of the variants move briskly now.
    steps : ndarray
        How many steps were made.
    """
    state, facing = runs.part(who), runs.facing[who]
    forward, share = facing > 0.0, FADED if runs.dynamics.fades else STILL
    floor = share * np.maximum(runs.fastest[who], np.abs(runs.slowest[who]))
    goal = np.where(forward, _forward_goal(runs, who), _backward_goal(runs, who))
    gone = _walk(runs, who, goal, floor)
    why, moved = gone.why, np.flatnonzero(gone.steps > 0.0)
    if runs.observers and moved.size:
        before = State(*(rows[..., moved] for rows in state))
        runs.see(who[moved], _piece_of(runs, who[moved], before, gone.some(moved)))
    _take(runs, who, state, gone, goal)
    runs.pace[who] = gone.pace
    # Reactions aren't finite where friction leaves no equilibrium.
    lost = why == Why.LOST
    runs.give_up(who[lost], Verdict.NOT_FINITE if runs.dynamics.friction is None else Verdict.JAMS)
    runs.done[who[np.isin(why, (Why.GOAL, ABOVE, BELOW))]] = True
    met = (why == Why.OTHER_GOAL) & forward
    runs.done[who[met & (goal == runs.ends.turned[who])]] = True
    runs.arrive(who[(why == Why.RANGE) | (~runs.done[who] & (why != REST) & (runs.ahead(who) <= 0.0))])
    _turn_round(runs, who[why == REST], forward[why == REST])
    speed = np.abs(runs.state.omega[who])
    _give_up_endless(runs, who[((why == Why.OTHER_GOAL) & ~forward) | ((speed > 0.0) & (speed < floor))])
    far = np.abs(runs.state.turned[who]) >= runs.ends.most_turned[who]
    runs.give_up(who[~runs.done[who] & far], Verdict.NO_END)
    # The steps left neither the place nor the instant.
    stuck = np.abs(runs.state.turned[who] - state.turned) <= NO_ANGLE * np.abs(runs.start[who] + state.turned)
    stuck &= (why == Why.FULL) & (gone.at <= NO_TIME * gone.steps * runs.state.time[who])
    runs.give_up(who[~runs.done[who] & stuck], Verdict.NOT_FINITE)
    marked = runs.at_mark(who[met & ~runs.done[who]])
    if marked.size:
        pass_mark(runs, marked, carry)
    return why == TURNS_BRISK, gone.steps


def _forward_goal(runs: Progress, who: np.ndarray) -> np.ndarray:
    """Angle turned up to which some variants go forward at once."""
    return np.minimum(np.minimum(runs.ends.turned[who], runs.ends.most_turned[who]), runs.mark[who])


def _backward_goal(runs: Progress, who: np.ndarray) -> np.ndarray:
    """Angle turned down to which some variants go backwards at once: a cycle from where they turned round."""
    cycle, turned = runs.dynamics.cycle, runs.state.turned[who]
    behind = runs.turned_round[who] - cycle
    return np.maximum(np.where(turned > behind, behind, turned - cycle), -runs.ends.most_turned[who])


def _walk(runs: Progress, who: np.ndarray, goal: np.ndarray, floor: np.ndarray) -> Walks:
    """Walk in time, up to an angle turned at most."""
    dynamics, part, state, facing = runs.dynamics, runs.variants.some(who), runs.part(who), runs.facing[who]
    system, forward, now = dynamics.by_time, facing > 0.0, runs.clock[who] + state.time
    brisk = TIMES_TO_THE_END if runs.to_the_end else BRISK_TO_LOOK
    numbers = np.where(forward, *(dynamics.moving(system, runs.variants, brisk, way)[:, who] for way in (1.0, -1.0)))
    sizes, (above, below) = system.sizes, (runs.above[who], runs.below[who])
    limits = {sizes.above: np.where(forward, above, -below), sizes.below: np.where(forward, below, -above)}
    numbers = system.limited(numbers, limits)
    bounds = None if dynamics.reduction.has_cycle else runs.bounds[:, who]
    edges = np.concatenate(edges_of(part.direction, part.breaks, dynamics.cycle, runs.start[who], bounds))
    # A speed may be met within a step and left again.
    extremes = (runs.extremes and not runs.observers) or bool(np.isfinite(runs.ends.speed).any())
    farthest = runs.farthest_step * runs.reach[who]
    if runs.observers:
        farthest = np.fmin(farthest, CLOSELY * runs.longer * runs.reach[who])
    longest = STRIDE * _span(runs, who) / WAITS if dynamics.changing else np.inf
    pace, new = runs.pace[who], np.isinf(runs.pace[who])
    if new.any():
        first = runs.equation(who).first_step(state.turned, state.omega, now, facing, runs.spacing[who])
        pace = np.where(new, runs.longer * first, pace)
    lanes = {"start": runs.start[who], "direction": part.direction, "facing": facing, "clock": now}
    lanes |= {"goal": runs.ends.time[who] - state.time, "other_goal": goal, "tolerance": runs.tolerance}
    lanes |= {"farthest": farthest, "longest": longest, "floor": floor, "turned": state.turned, "pace": pace}
    states = np.zeros((len(system.rates), who.size))
    states[TURNED], states[SPEED] = state.turned, np.abs(state.omega)
    recorded = RECORDED if runs.observers else 0
    task = system.task(dynamics.cycle, EIGHT, extremes, runs.longer)
    return system.run(task, numbers, edges, runs.variants.instants[:, who], lanes, states, recorded=recorded)


def _take(runs: Progress, who: np.ndarray, before: State, gone: Walks, goal: np.ndarray) -> None:
    """Take over where walks ended."""
    facing, why, forward = runs.facing[who], gone.why, runs.facing[who] > 0.0
    # No sum of steps comes to an end so exactly.
    turned = np.where(why == Why.OTHER_GOAL, goal, gone.states[TURNED])
    omega = np.where(why == REST, 0.0, facing * gone.states[SPEED])
    time = np.where(why == Why.GOAL, runs.ends.time[who], before.time + gone.at)
    energies = [0.5 * runs.inertia(who, at) * w**2 for at, w in ((before.turned, before.omega), (turned, omega))]
    works, squares = gathered(runs.dynamics.by_time, runs.dynamics, gone.states, energies[1] - energies[0], -1.0)
    low, high = np.where(forward, gone.slowest, -gone.fastest), np.where(forward, gone.fastest, -gone.slowest)
    runs.slowest[who], runs.fastest[who] = np.fmin(runs.slowest[who], low), np.fmax(runs.fastest[who], high)
    runs.put(who, State(turned, omega, time, before.works + works, before.squares + squares))
    # What rounding left of a speed.
    rest = who[why == REST]
    runs.slowest[rest] = np.where(np.abs(runs.slowest[rest]) < 1e-12 * runs.fastest[rest], 0.0, runs.slowest[rest])


# Phase curves of a machine on which nothing depends on time never cross. So a swing that doesn't reach beyond the last
# one lies within it, as do all after it; and a machine that has turned a cycle backwards from where it stood is never
# slower there again.


def _turn_round(runs: Progress, rest: np.ndarray, forward: np.ndarray) -> None:
    """Let machines that came to rest stand, or turn round; those that come no farther forward than before never will.

    A run to rest goes on as long as its swings become smaller.
    """
    if runs.ends.reversal:
        runs.done[rest] = True
        return
    runs.facing[rest] = 0.0
    set_off(runs, rest)
    turned = runs.state.turned[rest]
    runs.turned_round[rest] = turned
    same = SAME_SWING * runs.reach[rest]
    again = turned <= runs.farthest[rest] + same
    if runs.ends.rest:
        # What is lost in each swing brings it to rest.
        again &= turned >= runs.farthest[rest] - same
    again &= forward
    runs.farthest[rest[forward]] = turned[forward]
    _give_up_endless(runs, rest[again])


def _give_up_endless(runs: Progress, who: np.ndarray) -> None:
    """Give up runs that can't come to their end: backwards for ever, or ever more slowly."""
    instants, now = runs.variants.instants[:, who], runs.clock[who] + runs.state.time[who]
    # After the last instant of its tables nothing depends on time any more; on a formula it may for ever.
    last = np.fmax.reduce(instants, axis=0, initial=-np.inf)
    settled = ((now > last) & (len(instants) > 0) | (not runs.dynamics.timed)) & (not runs.dynamics.changing)
    runs.give_up(who[settled & ~runs.done[who] & np.isinf(runs.ends.time[who])], Verdict.NO_END)


# What is seen of walks on their way


def _piece_of(runs: Progress, who: np.ndarray, before: State, gone: Walks) -> Piece:
    """The recorded steps of walks, each looked at between its ends about as often as a cycle is.

    Where two steps meet, both have a node: between them something may jump.
    """
    made, shown, spacing = gone.steps.astype(int), SHOWN.size, runs.spacing[who]
    step, column = np.nonzero(np.arange(made.max())[:, None] < made)
    order = np.lexsort((step, column))
    step, column = step[order], column[order]
    at, length, _, *rows = gone.recorded[step, :, column].T
    first, last = rows[0], rows[shown - 1]
    reach = np.abs(last - first)
    # How often follows from the variant alone, whichever others go with it.
    looks = np.maximum(LEAST_LOOKS, np.ceil(reach / spacing[column])).astype(int)
    of = np.repeat(np.arange(looks.size), looks + 1)
    k = np.arange(of.size) - np.repeat(np.cumsum(looks + 1) - looks - 1, looks + 1)
    time, columns = at[of] + k / looks[of] * length[of], column[of]

    def read(columns: np.ndarray, time: np.ndarray) -> np.ndarray:
        found = np.empty((3, time.size))
        read_steps(time.size, gone.recorded, gone.steps, columns, time, False, found)
        return found[:2]

    facing = runs.facing[who]
    turned, speed = read(columns, time)
    aside = np.where(reach > 4.0 * JUMP, 1.0, 0.0) * facing[column]
    breaks = (runs.variants.direction * (runs.variants.breaks.angles - runs.start))[:, who[column]]
    begins, ends = (aside * beside(breaks, at_end, runs.dynamics.cycle) for at_end in (first, last))
    turned = np.where(k == 0, first[of] + begins[of], np.where(k == looks[of], last[of] - ends[of], turned))
    counts = np.bincount(columns, minlength=who.size)
    steps = np.where(k < looks[of], (reach / looks)[of], 0.0)
    every = before.time[columns] + time, turned, facing[columns] * speed, steps
    *nodes, steps = (side_by_side(row, counts) for row in every)

    def within(columns: np.ndarray, nodes_at: np.ndarray, lengths: np.ndarray) -> tuple[np.ndarray, ...]:
        now = nodes[0][nodes_at, columns] + lengths
        turned, speed = read(columns, now - before.time[columns])
        return now, turned, facing[columns] * speed, np.full_like(now, np.nan)

    return Piece(*nodes, facing, steps[:-1], np.full_like(nodes[0], np.nan), BetweenNodes(True, within))
