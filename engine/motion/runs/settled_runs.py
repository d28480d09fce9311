"""Runs to a speed, or to rest, that settle before they come to it: told from a cycle, not by waiting.

Where nothing depends on time, the speeds ω(φ) of two motions that go forward never cross, and one shifted by a cycle
is a motion as well. So a machine that isn't faster after a cycle never will be: one that falls short of its speed
either stalls or settles. And where one that begins faster than it, and doesn't come to the speed either, isn't faster
after a cycle, both stay below that one for ever.
"""

from collections.abc import Callable

import numpy as np

from engine.motion.runs.run_progress import Begin, Progress, RunOutcome, Stepping
from engine.words.verdicts import Verdict

# How much of the way to the speed that it is to come to others are ahead of a machine: to tell soon where nothing else
# lies between, and where a speed from which it would stall does.
SHARES = (0.9, 0.1)

Carry = Callable[[Progress], RunOutcome]


def pass_mark(runs: Progress, who: np.ndarray, carry: Carry) -> None:
    """Give up those of some variants at their marks that never come to their ends.

    Parameters
    ----------
    runs : Progress
    who : ndarray of int
    carry : callable
        Carries runs to their ends.
    """
    omega, before = runs.state.omega[who], runs.omega_at_mark[who]
    # One that gets slower may still stall.
    endless = (omega == before) | ((omega > before) & ~np.isfinite(runs.above[who]))
    runs.marks[who] += 1
    # Others are worth their time now and then.
    power_of_two = runs.marks[who] & (runs.marks[who] - 1) == 0
    doubtful = np.flatnonzero(~endless & np.isfinite(before) & power_of_two)
    if doubtful.size:
        some, rising = who[doubtful], (omega > before)[doubtful]
        endless[doubtful] = np.any([_held_back(runs, some, rising, share, carry) for share in SHARES], axis=0)
    runs.give_up(who[endless], Verdict.NO_END)
    runs.omega_at_mark[who] = np.where(runs.past_tables(who), omega, np.nan)
    runs.set_marks(who)


def _held_back(runs: Progress, who: np.ndarray, rising: np.ndarray, share: float, carry: Carry) -> np.ndarray:
    """Which variants, rising or falling in speed, a motion so much of the way ahead keeps from their ends."""
    omega, cycle = runs.state.omega[who], runs.dynamics.cycle
    # Speeds of neighbouring motions keep about their proportion.
    below = np.maximum(runs.below[who], 0.0)
    to_end = np.where(
        rising, runs.above[who] / runs.fastest[who], below / np.where(below > 0.0, runs.slowest[who], 1.0)
    )
    begin = omega * (1.0 + share * (to_end - 1.0))
    way = runs.variants.direction[who]
    ends = runs.ends.some(who)._replace(turned=np.full(who.size, cycle), most_turned=np.full(who.size, np.inf))
    stepping = Stepping(runs.tolerance, runs.over_angle, runs.farthest_step, runs.classical, False)
    here = runs.start[who] + way * runs.state.turned[who], begin, runs.clock[who] + runs.state.time[who]
    ahead = Progress(runs.dynamics, runs.variants.some(who), Begin(*here), ends, runs.steps, stepping=stepping)
    gone = carry(ahead)
    whole = (gone.verdict == Verdict.OK) & (gone.state.turned >= cycle * (1.0 - 1e-12))
    return whole & np.where(rising, gone.state.omega <= begin, gone.state.omega >= begin)
