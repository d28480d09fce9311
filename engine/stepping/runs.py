"""Runs of a number of variants: one walk after another, until the run of each variant is over."""

import numpy as np

from engine.stepping.walk_task import tolerance_of_walk
from engine.words.verdicts import Verdict


class WalkedRuns:
    """Runs of a number of variants, in progress.

    Parameters
    ----------
    count : int
        Number of variants.
    tolerance : float
        Relative tolerance of a step in time, if steps aren't longer.
    longer : float
        One of `WALKS`.

    Attributes
    ----------
    tolerance : float
        That of these runs.
    pace : ndarray (variants,)
        Length of the next step in time [s]; infinite if not yet known.
    verdict : ndarray (variants,) of uint8
        So far.
    done : ndarray (variants,) of bool
        Whether the run is over.
    """

    # Walks after which runs that aren't over are given up.
    most_walks = 100_000

    def __init__(self, count: int, tolerance: float, longer: float) -> None:
        self.longer, self.tolerance = longer, tolerance_of_walk(tolerance, longer)
        self.pace = np.full(count, np.inf)
        self.verdict, self.done = np.full(count, Verdict.OK, np.uint8), np.zeros(count, bool)

    def go_to_end(self) -> None:
        """Carry the runs to their end, in place."""
        # Infinite and undefined values become verdicts, not warnings.
        with np.errstate(all="ignore"):
            for _ in range(self.most_walks):
                live = np.flatnonzero(~self.done)
                if not live.size:
                    return
                self.advance(live)
            self.give_up(np.flatnonzero(~self.done))

    def advance(self, who: np.ndarray) -> None:
        """Walk with the variants whose runs aren't over until something changes, and handle the change."""
        raise NotImplementedError

    def endless(self, who: np.ndarray) -> np.ndarray | Verdict:
        """Verdicts on runs that never end."""
        return Verdict.NO_END

    def give_up(self, who: np.ndarray, verdict: np.ndarray | Verdict | None = None) -> None:
        """End the runs of some variants with a verdict, by default that on runs that never end."""
        self.verdict[who] = self.endless(who) if verdict is None else verdict
        self.done[who] = True
