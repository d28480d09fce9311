"""Runs in time: step by step near rest, backwards, and where a moment depends on time."""

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.motion.moments.grid import JUMP
from engine.motion.runs.run_progress import Progress
from engine.motion.runs.settled_runs import Carry, pass_mark
from engine.motion.runs.watching import BetweenNodes, piece_in_time
from engine.motion.steppers.time_form import State, Step, TimeForm
from engine.verdicts import Verdict

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
# How far a step may turn that is looked at within, by a polynomial of degree five [rad].
CLOSELY = 0.1
# A step's estimated error goes with its length to the eighth power.
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# Widths of jumps that are gone through in one step [rad]; how far beyond a break a step may go, of the way to it.
ACROSS, BEYOND = 4.0 * JUMP, 1.02
# So many times the rounding of the angle ahead a break is passed; share of a step through it that counts as its end.
MOST_ROUNDED, AT_END = 4.0, 0.25
# Of the ends that a step in time may meet, the first and the last two.
REST, RANGE, BREAK = 0, 4, 5


def set_off(runs: Progress, who: np.ndarray) -> None:
    """Choose the way for machines at rest; those that stay are at the end, or don't start."""
    if not who.size:
        return
    runs.facing[who] = runs.form(who).at_rest(runs.absolute(runs.part(who), who))
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


def step(runs: Progress, who: np.ndarray, carry: Carry) -> None:
    """One step in time of some variants, or less of it where an end is met."""
    form, state, facing = runs.form(who), runs.absolute(runs.part(who), who), runs.facing[who]
    end = runs.clock[who] + runs.ends.time[who]
    ahead = np.minimum(_next_instant(runs.variants.instants[:, who], state.time), end)
    longest = ahead - state.time
    if runs.dynamics.changing:
        longest = np.minimum(longest, STRIDE * (_span(runs, who) / WAITS))
    goal = _next_break(runs, who, state.turned, facing)
    goal = np.where(facing > 0.0, np.fmin(goal, runs.mark[who]), goal)
    h, step = _good_step(runs, form, who, state, goal, longest)
    after, slowest, fastest = step.after, step.slowest, step.fastest
    lost = ~np.isfinite(after.omega)
    # Reactions aren't finite where friction leaves no equilibrium.
    runs.give_up(who[lost], Verdict.NOT_FINITE if runs.dynamics.friction is None else Verdict.JAMS)
    over = _overshoot(runs, after, who, facing, goal)
    late, which = (over > 0.0).any(axis=0) & ~lost, np.full(who.size, -1)
    if late.any():
        sub = np.flatnonzero(late)
        shorter, which[sub] = _first_end(runs, form, state, h, facing, goal, who, over[:, sub], sub)
        part = form.step(state, _scattered(shorter, sub, h), facing, goal, runs.tolerance)
        after = _merged(after, part.after, late)
        slowest, fastest = np.where(late, part.slowest, slowest), np.where(late, part.fastest, fastest)
    kept = ~lost
    if runs.observers and kept.any():
        before, own = (State(*(x[..., kept] for x in one)) for one in (state, after))
        form, within = runs.form(who[kept]), _within(runs, who[kept], before, facing[kept], goal[kept])
        piece = piece_in_time(form, before, own, runs.clock[who[kept]], facing[kept], runs.spacing[who[kept]], within)
        runs.see(who[kept], piece)
    runs.slowest[who[kept]] = np.minimum(runs.slowest[who[kept]], slowest[kept])
    runs.fastest[who[kept]] = np.maximum(runs.fastest[who[kept]], fastest[kept])
    runs.put(who[kept], State(*(x[..., kept] for x in after))._replace(time=(after.time - runs.clock[who])[kept]))
    _after_step(runs, who[kept], which[kept])
    marked = runs.at_mark(who[kept & ~runs.done[who]])
    if marked.size:
        pass_mark(runs, marked, carry)


def _within(runs: Progress, who: np.ndarray, before: State, facing: np.ndarray, goal: np.ndarray) -> BetweenNodes:
    """Places within a step in time of some variants, from its begin."""

    def step(columns: np.ndarray, _: np.ndarray, lengths: np.ndarray) -> tuple[np.ndarray, ...]:
        own = State(*(x[..., columns] for x in before))
        form = runs.form(who[columns])
        there = form.step(own, lengths, facing[columns], goal[columns], runs.tolerance).after
        time = there.time - runs.clock[who[columns]]
        return time, there.turned, there.omega, np.full_like(time, np.nan)

    return BetweenNodes(True, step)


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
    look = np.minimum(now + np.maximum(pause, AT_ONCE * now), _next_instant(instants, now))
    return np.where(now < last, look, np.inf)


def _span(runs: Progress, who: np.ndarray) -> np.ndarray:
    """Time over which a formula over time is followed from the begin of a run on."""
    speed = np.abs(np.broadcast_to(runs.variants.numbers["input.speed"], runs.start.shape))
    cycle = (runs.spacing * runs.steps / speed)[who]
    last = np.fmax.reduce(runs.variants.instants[:, who], axis=0, initial=-np.inf)
    return np.fmin(runs.ends.time[who], np.fmax(last - runs.clock[who], MOST_CYCLES * cycle))


def _starts_by(runs: Progress, who: np.ndarray, look: np.ndarray) -> np.ndarray:
    """When machines at rest start, of those that would at the time of the next look; of others that time."""
    form, part = runs.form(who), runs.part(who)

    def start(time: np.ndarray) -> np.ndarray:
        return form.at_rest(runs.absolute(part._replace(time=time), who)) != 0.0

    started, low, high = start(look), part.time, look
    for _ in range(HALVINGS if started.any() else 0):
        middle = 0.5 * (low + high)
        there = start(middle)
        low, high = np.where(there, low, middle), np.where(there, middle, high)
    return np.where(started, high, look)


def _next_instant(instants: np.ndarray, time: np.ndarray) -> np.ndarray:
    """The next time at which a moment over time jumps or bends."""
    later = np.where(instants > time * (1.0 + 1e-15), instants, np.inf)
    return np.minimum.reduce(later, axis=0, initial=np.inf)


def _good_step(
    runs: Progress, form: TimeForm, who: np.ndarray, state: State, goal: np.ndarray, longest: np.ndarray
) -> tuple[np.ndarray, Step]:
    """A step that misses little enough, and its length, no more than the longest."""
    facing, h = runs.facing[who], runs.pace[who]
    if np.isinf(h).any():
        h = np.where(np.isinf(h), form.first_step(state, runs.spacing[who], facing), h)
    speed, ahead = np.abs(state.omega), np.abs(goal - state.turned)
    with np.errstate(all="ignore"):
        farthest = np.fmin(runs.farthest_step, CLOSELY * (2.0 if runs.half else 1.0) if runs.observers else np.inf)
        farthest = farthest * runs.reach[who]
        h = np.fmin(np.fmin(h, farthest / speed), longest)
        # Through a jump at once.
        across = (ahead < ACROSS) & (speed * h > ahead)
        h = np.where(across, ahead / speed, h)
    # What begins to hold at its end holds nowhere within it.
    within = np.where(across, goal - AT_END * (goal - state.turned), goal)
    for _ in range(HALVINGS):
        step = form.step(state, h, facing, within, runs.tolerance)
        after, missed = step.after, step.missed
        with np.errstate(all="ignore"):
            share = np.clip(SAFETY * missed ** (-1.0 / 8.0), SHRINK, GROW)
        share = np.where(np.isnan(share), SHRINK, share)
        # From rest, a step mustn't come back to it.
        back = (state.omega == 0.0) & (after.omega * facing <= 0.0)
        far = np.where(back, 0.0, np.abs(after.turned - state.turned))
        # What moments do beyond a break isn't known: to just behind it.
        beyond = far > BEYOND * ahead
        worse = ~(missed <= 1.0) & ~across
        again = back | worse
        if not again.any():
            break
        with np.errstate(all="ignore"):
            h = np.where(again, h * np.where(beyond & ~back, np.fmin(share, BEYOND * ahead / far), share), h)
            h = np.where(back, np.fmin(h, 0.5 * h), h)
    runs.pace[who] = np.where(across, runs.pace[who], h * share)
    after.turned[across] = goal[across]
    return h, step


def _next_break(runs: Progress, who: np.ndarray, turned: np.ndarray, facing: np.ndarray) -> np.ndarray:
    """Angle turned at the next edge of a break of the moments, or at the end of the range: no step goes across one.

    A break has an edge on either side, and itself; for comparison it is gone through at once, so that figures tell what
    a work misses there.
    """
    angles, cycle = runs.variants.breaks.angles[:, who], runs.dynamics.cycle
    end = np.where(facing < 0.0, *runs.bounds[:, who])
    if not angles.size:
        return end
    here = runs.start[who] + runs.variants.direction[who] * turned
    ahead = runs.variants.direction[who] * facing * (angles - here)
    sides = (-JUMP, JUMP) if runs.half else (-JUMP, 0.0, JUMP)
    ahead = np.concatenate([ahead + side for side in sides])
    ahead = np.mod(ahead, cycle) if np.isfinite(cycle) else ahead
    # What rounding leaves of an edge that was just passed is none ahead.
    passed = MOST_ROUNDED * np.spacing(np.abs(here) + np.abs(turned))
    ahead = np.nan_to_num(np.where(ahead > passed, ahead, np.inf), nan=np.inf)
    return facing * np.fmin((turned * facing) + ahead.min(axis=0), facing * end)


def _overshoot(runs: Progress, state: State, who: np.ndarray, facing: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """How far a state is beyond rest, end angle, speed above and below, end of the range, a break; (6, variants)."""
    return np.array(
        [
            -state.omega * facing,
            state.turned - runs.ends.turned[who],
            state.omega - runs.above[who],
            runs.below[who] - state.omega,
            (state.turned - np.where(facing < 0.0, *runs.bounds[:, who])) * facing,
            (state.turned - goal) * facing,
        ]
    )


def _first_end(
    runs: Progress,
    form: TimeForm,
    state: State,
    h: np.ndarray,
    facing: np.ndarray,
    goal: np.ndarray,
    who: np.ndarray,
    over: np.ndarray,
    sub: np.ndarray,
) -> tuple[np.ndarray, np.ndarray]:
    """Which end the variants `sub` meet first within the step, and the length of the step to there."""
    shortest, first = h[sub].copy(), np.full(sub.size, -1)
    for end in np.flatnonzero((over > 0.0).any(axis=1)):

        def excess(length: np.ndarray, end: int = end) -> np.ndarray:
            after = form.step(state, _scattered(length, sub, h), facing, goal, runs.tolerance).after
            return _overshoot(runs, after, who, facing, goal)[end, sub]

        length = regula_falsi(excess, np.zeros(sub.size), h[sub])
        sooner = (over[end] > 0.0) & ((length < shortest) | (first < 0))
        shortest, first = np.where(sooner, length, shortest), np.where(sooner, end, first)
    return shortest, first


def _after_step(runs: Progress, who: np.ndarray, which: np.ndarray) -> None:
    """What follows from an end that was met: the run is over, or the machine turns round."""
    ended = runs.state.time[who] >= runs.ends.time[who] * (1.0 - 1e-15)
    runs.done[who[ended | ((which > REST) & (which < RANGE))]] = True
    runs.arrive(who[(which == RANGE) | ((which != REST) & ~runs.done[who] & (runs.ahead(who) <= 0.0))])
    rest = who[which == REST]
    forward = runs.facing[rest] > 0.0
    runs.state.omega[rest] = 0.0
    # What rounding left of a speed.
    runs.slowest[rest] = np.where(np.abs(runs.slowest[rest]) < 1e-12 * runs.fastest[rest], 0.0, runs.slowest[rest])
    if runs.ends.reversal:
        runs.done[rest] = True
    else:
        runs.facing[rest] = 0.0
        set_off(runs, rest)
        _turn_round(runs, rest, forward)
    _tell_endless(runs, who)
    lost = who[~runs.done[who] & (np.abs(runs.state.turned[who]) >= runs.ends.most_turned[who])]
    runs.give_up(lost, Verdict.NO_END)


# Phase curves of a machine on which nothing depends on time never cross. So a swing that doesn't reach beyond the last
# one lies within it, as do all after it; and a machine that has turned a cycle backwards from where it stood is never
# slower there again.


def _turn_round(runs: Progress, rest: np.ndarray, forward: np.ndarray) -> None:
    """Note where machines turn round; those that come no farther forward than the last time never will.

    A run to rest goes on as long as its swings become smaller.
    """
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


def _tell_endless(runs: Progress, who: np.ndarray) -> None:
    """Give up runs that can't come to their end: backwards for ever, or ever more slowly."""
    backwards = runs.state.turned[who] <= runs.turned_round[who] - runs.dynamics.cycle
    share = FADED if runs.dynamics.fades else STILL
    speed = np.abs(runs.state.omega[who])
    faded = (speed > 0.0) & (speed < share * runs.fastest[who])
    _give_up_endless(runs, who[((runs.facing[who] < 0.0) & backwards) | faded])


def _give_up_endless(runs: Progress, who: np.ndarray) -> None:
    instants, now = runs.variants.instants[:, who], runs.clock[who] + runs.state.time[who]
    # After the last instant of its tables nothing depends on time any more; on a formula it may for ever.
    last = np.fmax.reduce(instants, axis=0, initial=-np.inf)
    settled = ((now > last) & (len(instants) > 0) | (not runs.dynamics.timed)) & (not runs.dynamics.changing)
    runs.give_up(who[settled & ~runs.done[who] & np.isinf(runs.ends.time[who])], Verdict.NO_END)


def _scattered(values: np.ndarray, places: np.ndarray, base: np.ndarray) -> np.ndarray:
    whole = base.copy()
    whole[places] = values
    return whole


def _merged(one: State, other: State, take_other: np.ndarray) -> State:
    return State(*(np.where(take_other, b, a) for a, b in zip(one, other, strict=True)))
