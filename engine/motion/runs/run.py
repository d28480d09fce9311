"""A run: motion from a given state to an angle, a time, a speed, or rest.

While the energy changes slowly, the independent variable is the crank angle. It is time near rest, backwards, with
torques that depend on time, with friction in pairs, and for an input of limited range. Each variant switches between
the two independently. Ends are met exactly: the last step is shortened to the given angle, time or speed.
"""

import numpy as np

from engine.motion.runs.run_in_angle import TIMES_TO_THE_END, stretch_over_angle
from engine.motion.runs.run_in_time import BRISK_TO_LOOK, set_off, stretch_over_time
from engine.motion.runs.run_progress import Progress, RunOutcome
from engine.words.verdicts import Verdict

# A run is abandoned if this number of steps gains neither a cycle nor this fraction of its time.
MOST_TIME_STEPS, OF_ITS_TIME = 40_000, 0.01


def run_to_end(runs: Progress) -> RunOutcome:
    """Integrate runs to their end.

    Parameters
    ----------
    runs : Progress
        In the initial state; updated in place.
    """
    # Infinite or NaN numbers cause a verdict, not a warning.
    with np.errstate(all="ignore"):
        return _run(runs)


def _run(runs: Progress) -> RunOutcome:
    started, count = runs.energy(), runs.variants.count
    set_off(runs, np.flatnonzero((runs.facing == 0.0) & ~runs.done))
    runs.see_begin()
    if runs.ends.standing and runs.dynamics.fades:
        # Torques that vanish with the speed stop no machine in finite time.
        runs.give_up(np.flatnonzero(~runs.done & np.isinf(runs.ends.time)), Verdict.NO_END)
    brisk = _brisk(runs)
    steps, reached, until = np.zeros(count), np.zeros(count), np.zeros(count)
    while not runs.done.all():
        fast = np.flatnonzero(brisk & ~runs.done)
        if fast.size:
            stretch_over_angle(runs, fast, run_to_end)
            brisk[fast], runs.pace[fast] = False, np.inf
        set_off(runs, np.flatnonzero((runs.facing == 0.0) & ~runs.done))
        slow = np.flatnonzero(~brisk & ~runs.done & (runs.facing != 0.0))
        if slow.size:
            runs.known[slow], runs.changed.omega[slow] = False, 0.0
            brisk[slow], made = stretch_over_time(runs, slow, run_to_end)
            steps[slow] += made
            turned, time = runs.state.turned, runs.state.time
            gained = (turned > reached + runs.dynamics.cycle) | (time > until + OF_ITS_TIME * runs.ends.time)
            reached[gained], until[gained], steps[gained] = turned[gained], time[gained], 0.0
            runs.give_up(np.flatnonzero(~runs.done & (steps > MOST_TIME_STEPS)), Verdict.NO_END)
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
        runs.steep,
    )


def _brisk(runs: Progress) -> np.ndarray:
    """Which variants move forwards with energy that changes slowly."""
    state = runs.state
    if runs.dynamics.in_time:
        return np.zeros(runs.variants.count, bool)
    brisk, share = state.omega > 0.0, TIMES_TO_THE_END if runs.to_the_end else BRISK_TO_LOOK
    moving = np.flatnonzero(brisk)
    omega = state.omega[moving]
    now = state.turned[moving], omega, (state.time + runs.clock)[moving], np.ones(moving.size)
    found = runs.equation(moving).along(*now)
    brisk[moving] = np.abs(found.total) < share * 0.5 * found.inertia * omega**2
    return brisk
