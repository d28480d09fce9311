"""Runs to a speed or to rest that settle before they reach it: detected from one cycle, without waiting.

In an autonomous system the speeds ω(φ) of two forward motions never cross, and a motion shifted by a cycle is also a
motion. So a machine that is not faster after one cycle never will be: if it is below its target speed, it stalls or
settles. If a second motion starts faster, also misses the target and is not faster after a cycle, both stay below that
motion for ever.
"""

import numpy as np

from engine.motion.runs.one_speed_run import OneSpeedRuns


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
        endless[doubtful] = runs.held_back(others, rising)
    runs.give_up(who[endless])
    runs.omega_at_mark[who] = np.where(runs.past_tables(who), omega, np.nan)
    runs.set_marks(who)
