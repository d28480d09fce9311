"""A run: motion from a given state until an angle, a time, a speed, or rest.

While the machine moves briskly the energy form carries it over a grid of nodes; near rest, backwards, and where a
moment depends on time, the form in time does. Every variant goes its own way between the two. Ends are met exactly:
the last step is shortened until the wanted angle, time or speed is reached.
"""

import numpy as np

from engine.motion.runs.run_in_angle import stretch
from engine.motion.runs.run_in_time import set_off, step
from engine.motion.runs.run_progress import Progress, RunOutcome
from engine.verdicts import Verdict

# The energy form takes over where moments change the energy by less than twice this share per radian. It doesn't depend
# on the step: so near to rest that it would, 1/ω is a root of the angle, and no refinement of the grid helps.
BRISK = 2.0
# Steps in time before a run is given up: it neither ends nor gets going.
MOST_TIME_STEPS = 40_000


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
    started = runs.energy()
    runs.note_now()
    set_off(runs, np.flatnonzero((runs.facing == 0.0) & ~runs.done))
    runs.feel_motors(np.arange(runs.variants.count))
    if runs.ends.rest and runs.dynamics.fades:
        # What vanishes with the speed stops no machine in finite time.
        runs.give_up(np.flatnonzero(~runs.done & np.isinf(runs.ends.time)), Verdict.NO_END)
    brisk = _brisk(runs, np.arange(runs.variants.count))
    time_steps = np.zeros(runs.variants.count, np.int64)
    while not runs.done.all():
        fast = np.flatnonzero(brisk & ~runs.done)
        if fast.size:
            stretch(runs, fast)
            brisk[fast] = False
        set_off(runs, np.flatnonzero((runs.facing == 0.0) & ~runs.done))
        slow = np.flatnonzero(~brisk & ~runs.done & (runs.facing != 0.0))
        if slow.size:
            step(runs, slow)
            brisk[slow] = _brisk(runs, slow)
            time_steps[slow] += 1
            runs.give_up(np.flatnonzero(~runs.done & (time_steps > MOST_TIME_STEPS)), Verdict.NO_END)
    history = None if runs.notes is None else np.concatenate(runs.notes, axis=1)
    return RunOutcome(
        runs.verdict,
        runs.state,
        runs.slowest,
        runs.fastest,
        runs.peak,
        started,
        runs.energy(),
        history,
    )


def _brisk(runs: Progress, who: np.ndarray) -> np.ndarray:
    """Which variants move forward with so much energy that it lasts for a radian, whatever acts on them."""
    if runs.dynamics.timed:
        return np.zeros(who.size, bool)
    state, way = runs.part(who), np.where(runs.facing[who] < 0.0, -1.0, 1.0)
    rows, moments = runs.form(who).at(state.turned, state.omega, state.time + runs.clock[who], way)
    twice_energy = rows.inertia[0] * state.omega**2
    return (state.omega > 0.0) & (np.abs(moments.total[0]) < BRISK * twice_energy)
