"""Runs to a speed or to rest that settle before they reach it: detected from one cycle, without waiting.

In an autonomous system the speeds ω(φ) of two forward motions never cross, and a motion shifted by a cycle is also a
motion. So a machine that is not faster after one cycle never will be: if it is below its target speed, it stalls or
settles. If a second motion starts faster, also misses the target and is not faster after a cycle, both stay below that
motion for ever.
"""

import numpy as np

from engine.motion.runs.one_speed_run import OneSpeedRuns
from engine.stepping.records import some
from engine.words.verdicts import Verdict

# Starting speeds of the second motion, as fractions of the distance to the target speed: the first detects early if
# there is no other steady motion between, the second if there is a speed from which the machine would stall.
SHARES = (0.9, 0.1)


def pass_mark(runs: OneSpeedRuns, who: np.ndarray) -> None:
    """Abandon those of the variants at their marks that never reach their ends."""
    omega, before = runs.state.omega[who], runs.omega_at_mark[who]
    # A decelerating machine may still stall.
    endless = (omega == before) | ((omega > before) & ~np.isfinite(runs.above[who]))
    runs.marks[who] += 1
    # Test the others at powers of two, to limit the cost.
    power_of_two = runs.marks[who] & (runs.marks[who] - 1) == 0
    doubtful = np.flatnonzero(~endless & np.isfinite(before) & power_of_two)
    if doubtful.size:
        others, rising = who[doubtful], (omega > before)[doubtful]
        endless[doubtful] = np.any([_held_back(runs, others, rising, share) for share in SHARES], axis=0)
    runs.give_up(who[endless])
    runs.omega_at_mark[who] = np.where(runs.past_tables(who), omega, np.nan)
    runs.set_marks(who)


def _held_back(runs: OneSpeedRuns, who: np.ndarray, rising: np.ndarray, share: float) -> np.ndarray:
    """Which variants, accelerating or decelerating, never reach their ends, by a second motion ahead by `share`."""
    omega = runs.state.omega[who]
    # Speeds of neighbouring motions stay roughly proportional.
    below = np.maximum(runs.below[who], 0.0)
    to_end = np.where(
        rising, runs.above[who] / runs.fastest[who], below / np.where(below > 0.0, runs.slowest[who], 1.0)
    )
    begin = omega * (1.0 + share * (to_end - 1.0))
    ahead = runs.beside(who, some(runs.ends, who), begin)
    whole = (ahead.verdict == Verdict.OK) & (ahead.turned >= runs.dynamics.cycle * (1.0 - 1e-12))
    return whole & np.where(rising, ahead.omega <= begin, ahead.omega >= begin)
