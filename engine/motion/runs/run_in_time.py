"""Runs in time: near rest, backwards, with friction in pairs, and with torques that depend on time."""

import numpy as np

from engine.cycle.regula_falsi import bisected
from engine.motion.fields.recorded_motion import OneSpeedMotion
from engine.motion.one_speed import TimeEnd
from engine.motion.runs.one_speed_run import OneSpeedRuns
from engine.motion.runs.run_in_angle import TIMES_TO_THE_END
from engine.motion.runs.run_progress import State
from engine.motion.runs.settled_runs import pass_mark
from engine.stepping.recorded import RECORDED, made_steps
from engine.stepping.system import RECORDED_AT, Start, Walks
from engine.stepping.walk_task import Why
from engine.words.verdicts import Verdict

# Number of instants at which a resting machine is tested for start.
WAITS = 1000
# Time for these tests with formulas, in cycles at the scene's speed, if nothing else ends them.
MOST_CYCLES = 100.0
# Longest step with a formula over time, relative to the interval between tests.
STRIDE = 20.0
# Shortest interval between tests, relative to the time: more than the width of a jump.
AT_ONCE = 1e-9
# Fraction of the peak speed below which a machine that nothing stops has practically ended its motion.
FADED = 1e-9
# The same fraction for a machine that something stops.
STILL = 1e-12
# Maximum step with observers [rad].
CLOSELY = 0.1
# With dense output, a machine remains in the time form until its relative energy change per radian is below this.
BRISK_TO_LOOK = 0.4
# Even positions of a swing at which resistance at standstill is looked for; its least size, relative to all torques.
SWING_SAMPLES, RESISTED = 64, 1e-9
# Swings within this range end as a geometric series [rad, or in units of `reach`]; comparison runs end them some swings
# earlier, which shows the error of that.
NARROW = 1e-7
# Many steps that change neither the angle (in total) nor the time (each) by more than these fractions make no progress:
# at a dead centre of the driven side the inertia grows without bound.
NO_ANGLE, NO_TIME = 1e-14, 1e-9
TURNED, SPEED = range(2)


def set_off(runs: OneSpeedRuns, who: np.ndarray) -> None:
    """Choose the direction of machines at rest; those that remain at rest have reached their end, or do not start."""
    if not who.size:
        return
    if runs.dynamics.with_servos:
        turned, time = runs.state.turned[who], runs.clock[who] + runs.state.time[who]
        epsilon, _ = runs.form.of(who).acceleration(turned, np.zeros(who.size), time, np.ones(who.size))
        # Servos may have moved their links apart, or leave the first input no inertia.
        runs.jammed(who[np.isnan(epsilon)])
        who = who[~np.isnan(epsilon)]
    runs.facing[who] = runs.form.of(who).sets_off(runs.state.turned[who], runs.clock[who] + runs.state.time[who])
    # A stop holds an input that is pressed against it.
    runs.facing[who[runs.ahead(who) <= 0.0]] = 0.0
    stays = who[runs.facing[who] == 0.0]
    begun = runs.state.turned[stays] != 0.0
    if runs.ends.standing:
        runs.done[stays[begun]] = True
        stays = stays[~begun]
    # The machine stays at rest until a torque over time changes, or until the time is over; second inputs that keep
    # moving would do work meanwhile, which no steps gather.
    later = np.minimum(_next_look(runs, stays) - runs.clock[stays], runs.ends.time[stays])
    waits = np.isfinite(later) & (not runs.dynamics.moved)
    later[waits] = _starts_by(runs, stays[waits], later[waits])
    runs.state.time[stays[waits]] = later[waits]
    runs.done[stays[waits & (later >= runs.ends.time[stays])]] = True
    if runs.ends.standing:
        runs.done[stays[~waits]] = True
    else:
        runs.give_up(stays[~waits], Verdict.STALLS)


def _next_look(runs: OneSpeedRuns, who: np.ndarray) -> np.ndarray:
    """Time of the next start test of machines at rest; infinite if no torque over time changes any more.

    A table changes between its first and last instant; a formula may change at any time.
    """
    begun, instants = runs.clock[who], runs.variants.instants[:, who]
    now = begun + runs.state.time[who]
    first = np.fmin.reduce(instants, axis=0, initial=np.inf)
    last = runs.last_change(who)
    pause = np.where(now < first, first - now, (last - first) / WAITS)
    if runs.dynamics.changing:
        last = begun + _span(runs, who)
        pause = (last - begun) / WAITS
    ahead = np.where(instants > now * (1.0 + 1e-15), instants, np.inf)
    look = np.minimum(now + np.maximum(pause, AT_ONCE * now), np.minimum.reduce(ahead, axis=0, initial=np.inf))
    return np.where(now < last, look, np.inf)


def _span(runs: OneSpeedRuns, who: np.ndarray) -> np.ndarray:
    """Time from the start of a run during which a formula over time is followed."""
    speed = np.abs(np.broadcast_to(runs.variants.numbers["input.speed"], runs.start.shape))
    cycle = (runs.spacing * runs.steps / speed)[who]
    return np.fmin(runs.ends.time[who], np.fmax(runs.last_change(who) - runs.clock[who], MOST_CYCLES * cycle))


def _starts_by(runs: OneSpeedRuns, who: np.ndarray, look: np.ndarray) -> np.ndarray:
    """Start time of machines that would start before the next test; its time for the others."""
    form, turned = runs.form.of(who), runs.state.turned[who]

    def start(time: np.ndarray) -> np.ndarray:
        facing = form.sets_off(turned, runs.clock[who] + time)
        # A stop holds an input that is pressed against it.
        return (facing != 0.0) & (runs.ahead(who, facing) > 0.0)

    started = start(look)
    if not started.any():
        return look
    _, first = bisected(lambda time: ~start(time), runs.state.time[who], look)
    return np.where(started, first, look)


def stretch_over_time(runs: OneSpeedRuns, who: np.ndarray, method: int) -> tuple[np.ndarray, np.ndarray]:
    """Integrate a stretch in time in one direction: to an end of the run, to rest, or until the energy changes slowly.

    It also ends where a motor is so steep that an implicit method is faster.

    Returns
    -------
    brisk : ndarray of bool
        Which variants can continue in the energy form.
    steps : ndarray
        Number of steps.
    """
    state, facing = runs.part(who), runs.facing[who]
    forward, share = facing > 0.0, FADED if runs.dynamics.fades else STILL
    floor = share * np.maximum(runs.fastest[who], np.abs(runs.slowest[who]))
    ahead = np.minimum(np.minimum(runs.ends.turned[who], runs.ends.most_turned[who]), runs.mark[who])
    goal = np.where(forward, ahead, _backward_goal(runs, who))
    gone = _walk(runs, who, method, goal, floor)
    why = gone.why
    if runs.observers and (gone.steps > 0.0).any():
        runs.see(_seen(runs, who, state, gone))
    _take(runs, who, state, gone, goal)
    runs.pace[who] = gone.pace
    runs.steep[who[why == Why.STEEP]] = 1.0
    runs.end(who, why, goal)
    runs.done[who[why == Why.GOAL]] = True
    runs.arrive(who[(why == Why.RANGE) | (~runs.done[who] & (why != TimeEnd.REST) & (runs.ahead(who) <= 0.0))])
    _turn_round(runs, who[why == TimeEnd.REST], forward[why == TimeEnd.REST])
    speed = np.abs(runs.state.omega[who])
    # A machine that has turned a cycle backwards from rest is never slower there again.
    runs.give_up_endless(who[((why == Why.OTHER_GOAL) & ~forward) | ((speed > 0.0) & (speed < floor))])
    # The steps changed neither the position nor the time.
    stuck = np.abs(runs.state.turned[who] - state.turned) <= NO_ANGLE * np.abs(runs.start[who] + state.turned)
    stuck &= (why == Why.FULL) & (gone.at <= NO_TIME * gone.steps * runs.state.time[who])
    runs.give_up(who[~runs.done[who] & stuck], Verdict.NOT_FINITE)
    marked = runs.at_mark(who[(why == Why.OTHER_GOAL) & forward & ~runs.done[who]])
    if marked.size:
        pass_mark(runs, marked)
    return why == TimeEnd.BRISK, gone.steps


def _backward_goal(runs: OneSpeedRuns, who: np.ndarray) -> np.ndarray:
    """Angle turned down to which variants move backwards in one walk: a cycle from the last reversal."""
    cycle, turned = runs.dynamics.cycle, runs.state.turned[who]
    behind = runs.turned_round[who] - cycle
    return np.maximum(np.where(turned > behind, behind, turned - cycle), -runs.ends.most_turned[who])


def _walk(runs: OneSpeedRuns, who: np.ndarray, method: int, goal: np.ndarray, floor: np.ndarray) -> Walks:
    """Walk in time by a method, up to a given angle turned."""
    dynamics, state, facing = runs.dynamics, runs.part(who), runs.facing[who]
    system, brisk = dynamics.by_time, TIMES_TO_THE_END if runs.to_the_end else BRISK_TO_LOOK
    forwards, backwards = (dynamics.moving(system, runs.variants, sign)[:, who] for sign in (1.0, -1.0))
    limits = runs.speed_limits(who, system.sizes, facing) | {system.sizes.brisk: brisk}
    numbers = system.limited(np.where(facing > 0.0, forwards, backwards), limits)
    edges = runs.edges(who, runs.start[who], None if dynamics.reduction.has_cycle else runs.bounds[:, who])
    farthest = runs.farthest_step * runs.reach[who]
    if runs.observers:
        farthest = np.fmin(farthest, CLOSELY * runs.longer * runs.reach[who])
    longest = STRIDE * _span(runs, who) / WAITS if dynamics.changing else np.inf
    pace, new = runs.pace[who], np.isinf(runs.pace[who])
    if new.any():
        clock = runs.clock[who] + state.time
        first = runs.form.of(who).first_step(state.turned, state.omega, clock, facing, runs.spacing[who])
        pace = np.where(new, runs.longer * first, pace)
    goals = {"goal": runs.ends.time[who] - state.time, "other_goal": goal, "floor": floor}
    lanes = runs.lanes(who, facing, farthest=farthest, longest=longest, pace=pace, **goals)
    states = np.zeros((len(system.rates), who.size))
    states[TURNED], states[SPEED] = state.turned, np.abs(state.omega)
    recorded = RECORDED if runs.observers else 0
    task = system.task(dynamics.cycle, method, extremes=runs.finds_extremes, longer=runs.longer)
    begin = Start(numbers, lanes, states, edges, runs.variants.instants[:, who], recorded=recorded)
    return system.run(task, begin)


def _take(runs: OneSpeedRuns, who: np.ndarray, before: State, gone: Walks, goal: np.ndarray) -> None:
    """Store the states at the ends of walks."""
    facing, why, forward = runs.facing[who], gone.why, runs.facing[who] > 0.0
    # Set the end exactly: sums of steps are rounded.
    turned = np.where(why == Why.OTHER_GOAL, goal, gone.states[TURNED])
    omega = np.where(why == TimeEnd.REST, 0.0, facing * gone.states[SPEED])
    time = np.where(why == Why.GOAL, runs.ends.time[who], before.time + gone.at)
    ends = (before.turned, before.omega, before.time), (turned, omega, time)
    started, ended = (runs.energy_at(who, *end) for end in ends)
    dynamics, change = runs.dynamics, ended - started
    works, squares = dynamics.gathered(dynamics.by_time, gone.states, change, -1.0)
    low, high = np.where(forward, gone.slowest, -gone.fastest), np.where(forward, gone.fastest, -gone.slowest)
    runs.slowest[who], runs.fastest[who] = np.fmin(runs.slowest[who], low), np.fmax(runs.fastest[who], high)
    runs.put(who, State(turned, omega, time, before.works + works, before.squares + squares))
    # Remove the rounding of a zero speed.
    rest = who[why == TimeEnd.REST]
    runs.slowest[rest] = np.where(np.abs(runs.slowest[rest]) < 1e-12 * runs.fastest[rest], 0.0, runs.slowest[rest])


def _turn_round(runs: OneSpeedRuns, rest: np.ndarray, forward: np.ndarray) -> None:
    """Let machines that came to rest stay or reverse; those that swing no farther forwards than before never will."""
    if runs.ends.reversal:
        runs.done[rest] = True
        return
    before = runs.turned_round[rest]
    runs.facing[rest] = 0.0
    set_off(runs, rest)
    runs.turned_round[rest] = runs.turned[rest]
    _end_swings(runs, rest[forward], before[forward])
    runs.compare_swings(rest[forward], np.abs(runs.turned[rest] - before)[forward])


def _end_swings(runs: OneSpeedRuns, who: np.ndarray, back: np.ndarray) -> None:
    """End the swings of machines that never stop them, or that stop them within a narrow range.

    Where nothing resists motion at standstill, swings only fade. Where a load that jumps turns a machine back from both
    sides, infinitely many swings take a finite time: their durations form a geometric series.

    Parameters
    ----------
    who : ndarray of int
        Variants at rest after moving forwards.
    back : ndarray
        Angle turned at the rest before [rad].
    """
    swing = ~runs.done[who] & (back < runs.turned[who]) & runs.past_tables(who) & (not runs.dynamics.changing)
    who, back = who[swing], back[swing]
    if not who.size:
        return
    ahead, form, time = runs.turned[who], runs.form.of(who), runs.clock[who] + runs.state.time[who]
    places = back + np.linspace(0.0, 1.0, SWING_SAMPLES)[:, None] * (ahead - back)
    # A narrow resistance begins and ends at breaks.
    start = runs.start[who] + runs.variants.direction[who] * back
    bounds = None if runs.dynamics.reduction.has_cycle else runs.bounds[:, who] - back
    breaks = back + np.clip(np.split(runs.edges(who, start, bounds), 2)[0], 0.0, ahead - back)
    places = np.sort(np.concatenate((places, 0.5 * (breaks[1:] + breaks[:-1]))), axis=0)
    one, still = np.ones(who.size), np.zeros_like(places)
    forwards, backwards = (form.acceleration(places, still, time + still, sign * one)[0] for sign in (1.0, -1.0))
    resisted = (np.abs(forwards - backwards) > RESISTED * np.abs(backwards)).any(axis=0)
    if runs.ends.standing:
        # A run may begin with a speed, and swing farther backwards.
        again = np.isfinite(runs.farthest_swing[who])
        runs.give_up_endless(who[again & ~resisted & runs.dynamics.smooth])
    # Beyond the jump: away from it and towards it; before it: towards and away.
    out, home, on, off = -forwards[-1], -backwards[-1], forwards[0], backwards[0]
    jump = ahead + form.to_break(ahead)
    peak = np.sqrt(2.0 * home * (ahead - jump))
    again = peak * np.sqrt(on / off)
    share = again / peak * np.sqrt(home / out)
    rest = (peak / home + peak / off + again / on + again / out) / (1.0 - share)
    narrow = ahead - back <= NARROW * runs.longer**8 * runs.reach[who]
    caught = narrow & resisted & (back <= jump) & (jump <= ahead) & (share < 1.0)
    own = who[caught]
    runs.turned[own], runs.facing[own] = jump[caught], 0.0
    runs.time[own] = np.fmin(runs.time[own] + rest[caught], runs.ends.time[own])
    set_off(runs, own)


def _seen(runs: OneSpeedRuns, who: np.ndarray, before: State, gone: Walks) -> OneSpeedMotion:
    """The recorded steps of walks."""
    variant, begin, length, samples, _ = made_steps(gone.recorded, gone.steps)
    time = before.time[variant] + begin + RECORDED_AT[:, None] * length
    states = np.array([time, samples[TURNED], samples[SPEED]])
    return OneSpeedMotion(runs.form, who[variant], runs.facing[who[variant]], states)
