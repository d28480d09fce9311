"""A run: motion from a given state until an angle, a time, a speed, or rest.

While the machine moves briskly the energy form carries it over a grid of nodes; near rest, backwards, where a moment
depends on time, and where the input doesn't turn fully, the form in time does. Every variant goes its own way between
the two. Ends are met exactly: the last step is shortened until the wanted angle, time or speed is reached.
"""

import numpy as np

from engine.motion.runs.run_in_angle import TIMES_TO_THE_END, stretch
from engine.motion.runs.run_in_time import set_off, step
from engine.motion.runs.run_progress import Progress, RunOutcome
from engine.verdicts import Verdict

# A machine whose steps are looked within goes in time until moments change its energy by less than so many times itself
# per radian.
BRISK = 0.4
# Steps in time, none of them a cycle farther than before, after which a run without an end in time is given up.
MOST_TIME_STEPS = 40_000
# So many steps in a row that change neither the angle nor the time by more than these shares of them lead nowhere:
# beside a dead centre of the driven side the inertia grows beyond all bounds.
MOST_STUCK, NO_ANGLE, NO_TIME = 100, 1e-14, 1e-9


def run_to_end(runs: Progress) -> RunOutcome:
    """Carry runs to their end.

    Parameters
    ----------
    runs : Progress
        At their begin; carried on in place.
    """
    # What isn't finite ends as a verdict, not as a warning.
    with np.errstate(all="ignore"):
        return _run(runs)


def _run(runs: Progress) -> RunOutcome:
    started, count = runs.energy(), runs.variants.count
    set_off(runs, np.flatnonzero((runs.facing == 0.0) & ~runs.done))
    runs.see_begin()
    if runs.ends.standing and runs.dynamics.fades:
        # What vanishes with the speed stops no machine in finite time.
        runs.give_up(np.flatnonzero(~runs.done & np.isinf(runs.ends.time)), Verdict.NO_END)
    brisk = _brisk(runs, np.arange(count))
    time_steps, stuck, reached = np.zeros(count, np.int64), np.zeros(count, np.int64), np.zeros(count)
    while not runs.done.all():
        fast = np.flatnonzero(brisk & ~runs.done)
        if fast.size:
            stretch(runs, fast, run_to_end)
            brisk[fast] = False
        set_off(runs, np.flatnonzero((runs.facing == 0.0) & ~runs.done))
        slow = np.flatnonzero(~brisk & ~runs.done & (runs.facing != 0.0))
        if slow.size:
            before = runs.part(slow)
            step(runs, slow, run_to_end)
            runs.known[slow], runs.changed.omega[slow] = False, 0.0
            after = runs.part(slow)
            still = np.abs(after.turned - before.turned) <= NO_ANGLE * np.abs(runs.start[slow] + after.turned)
            still &= after.time - before.time <= NO_TIME * after.time
            stuck[slow] = np.where(still, stuck[slow] + 1, 0)
            runs.give_up(slow[~runs.done[slow] & (stuck[slow] > MOST_STUCK)], Verdict.NOT_FINITE)
            brisk[slow] = _brisk(runs, slow)
            gained = runs.state.turned > reached + runs.dynamics.cycle
            reached[gained], time_steps[gained] = runs.state.turned[gained], 0
            time_steps[slow] += 1
            lost = (time_steps > MOST_TIME_STEPS) & np.isinf(runs.ends.time)
            runs.give_up(np.flatnonzero(~runs.done & lost), Verdict.NO_END)
    return RunOutcome(
        runs.verdict,
        runs.state,
        runs.slowest,
        runs.fastest,
        started,
        runs.energy(),
        runs.arrived,
        runs.changed,
        runs.known,
        runs.covered,
    )


def _brisk(runs: Progress, who: np.ndarray) -> np.ndarray:
    """Which variants move forward with so much energy that moments don't change it at once."""
    if runs.dynamics.timed or runs.dynamics.friction is not None or not runs.dynamics.reduction.has_cycle:
        return np.zeros(who.size, bool)
    state, way = runs.part(who), np.where(runs.facing[who] < 0.0, -1.0, 1.0)
    rows, moments = runs.form(who).at(state.turned, state.omega, state.time + runs.clock[who], way)
    brisk = TIMES_TO_THE_END if runs.to_the_end else BRISK
    energy = 0.5 * rows.inertia[0] * state.omega**2
    return (state.omega > 0.0) & (np.abs(moments.total[0]) < brisk * energy)
