"""Speeds that return after a cycle: the fixed point of the map from one cycle's start to the next, by Broyden's method.

The Jacobian of the map follows from cycles that start slightly faster and slower; later cycles correct it. At the fixed
point its eigenvalues are the multipliers, factors by which small disturbances grow from cycle to cycle.

Source: J. E. Dennis and R. B. Schnabel, Numerical Methods for Unconstrained Optimization and Nonlinear Equations,
chapter 8.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.words.verdicts import Verdict

# Relative tolerance of the correction of the speeds; the tolerance accepted where step errors stall the convergence.
RETURNED, NEARLY = 1e-10, 1e-7
MOST_ROUNDS = 60
# Relative speed difference for the Jacobian: curvature of the map and step errors weigh about the same.
APART = 3e-4
# Maximum relative change of a speed per iteration.
FARTHEST = 0.3
# Differences are taken again where a correction exceeds this fraction of the one before, and to settle, once it is
# smaller than CLOSE.
CONVERGES, CLOSE = 0.1, 1e-6
# A determinant of 1 − P' below the first, relative to its terms, or below the second leaves the speeds undetermined.
UNDECIDED, ANY = 1e-6, 1e-9


class Returned(NamedTuple):
    """Speeds that return after a cycle.

    Attributes
    ----------
    verdict : ndarray (variants,) of uint8
    speeds : ndarray (speeds, variants)
        At the start of the cycle [rad/s].
    multiplier : ndarray (variants,)
        Largest factor by which a small disturbance grows per cycle.
    residual : ndarray (variants,)
        Relative difference of the speeds after the last cycle of the search.
    """

    verdict: np.ndarray
    speeds: np.ndarray
    multiplier: np.ndarray
    residual: np.ndarray


@np.errstate(all="ignore")
def returning_speeds(
    cycle: Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]],
    guess: np.ndarray,
    verdict: np.ndarray,
    longer: float = 1.0,
) -> Returned:
    """Find speeds that return after a cycle.

    Parameters
    ----------
    cycle : callable
        Takes indices of variants, which may recur, and their speeds at the start, (speeds, …); returns those at the end
        and verdicts.
    guess : ndarray (speeds, variants)
        Where the search starts [rad/s].
    verdict : ndarray (variants,) of uint8
        Only variants that are OK are sought.
    longer : float
        One of `WALKS`: for comparison, the differences for the Jacobian are wider.
    """
    x, verdict, (size, count) = guess.copy(), verdict.copy(), guess.shape
    # The last speeds from which a cycle was completed, and those after it.
    good, after, slopes = x.copy(), np.full(x.shape, np.nan), np.full((count, size, size), np.nan)
    left, residual = np.full((2, count), np.inf)
    # Which variants take differences in their next cycle; those that settle have taken them.
    differs, pending = np.ones(count, bool), np.flatnonzero(verdict == Verdict.OK)
    for _ in range(MOST_ROUNDS):
        if not pending.size:
            break
        here, before, new = x[:, pending], left[pending], differs[pending]
        came, gone, jacobian = _with_differences(cycle, pending, here, new, APART * longer)
        whole, off = gone == Verdict.OK, came - here
        slopes[pending] = _corrected(slopes[pending], here - good[:, pending], came - after[:, pending], whole & ~new)
        slopes[pending[new]] = jacobian
        known = whole & np.isfinite(slopes[pending]).all(axis=(1, 2))
        change, undecided = _newton(np.where(known[:, None, None], slopes[pending], 0.0), off)
        now = np.where(known, np.abs(change / here).max(axis=0), np.inf)
        undecided &= new & known
        settled = new & ~undecided & ((now <= RETURNED) | ((now <= NEARLY) & (now >= 0.5 * before)))
        never = ~whole & (good[:, pending] == here).all(axis=0)
        # Where a cycle fails, go half of the distance back to speeds where one was completed.
        ahead = np.where(whole, here + change / np.maximum(now / FARTHEST, 1.0), 0.5 * (here + good[:, pending]))
        differs[pending] = whole & (~known | (now <= CLOSE) | ((now > CONVERGES * before) & ~new))
        left[pending] = np.where(whole, now, before)
        residual[pending] = np.where(whole, np.abs(off).max(axis=0) / np.abs(here).max(axis=0), residual[pending])
        after[:, pending], good[:, pending] = np.where(whole, (came, here), (after[:, pending], good[:, pending]))
        x[:, pending] = ahead
        verdict[pending] = np.where(ahead[0] < good[0, pending], Verdict.STALLS, Verdict.RUNS_AWAY)
        # A machine that completes no cycle stalls.
        verdict[pending[never]] = np.where(gone[never] == Verdict.NO_END, Verdict.STALLS, gone[never])
        verdict[pending[undecided]] = Verdict.ANY_SPEED
        verdict[pending[settled]] = Verdict.OK
        pending = pending[~settled & ~undecided & ~never]
    found, multiplier = np.flatnonzero(verdict == Verdict.OK), np.full(count, np.nan)
    multiplier[found] = np.abs(np.linalg.eigvals(slopes[found])).max(axis=1, initial=0.0)
    return Returned(verdict, x, multiplier, residual)


def _with_differences(
    cycle: Callable, who: np.ndarray, here: np.ndarray, new: np.ndarray, apart: float
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speeds after a cycle and verdicts, and the Jacobian of the `new` ones, NaN where one of their cycles fails."""
    size, count, near = len(here), who.size, here[:, new]
    offsets = np.concatenate([np.eye(size), -np.eye(size)])
    starts = [here, *(near * (1.0 + apart * offset[:, None]) for offset in offsets)]
    came, gone = cycle(np.concatenate([who, np.tile(who[new], 2 * size)]), np.concatenate(starts, axis=1))
    ends = np.where(gone == Verdict.OK, came, np.nan)[:, count:].reshape(size, 2, size, -1)
    jacobian = np.moveaxis((ends[:, 0] - ends[:, 1]) / (2.0 * apart * near), 2, 0)
    return came[:, :count], gone[:count], jacobian


def _corrected(slopes: np.ndarray, moved: np.ndarray, changed: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Broyden's correction of Jacobians (variants, speeds, speeds) from one cycle to the next."""
    left = changed.T - np.einsum("vij,jv->vi", slopes, moved)
    better = slopes + left[:, :, None] * (moved / (moved * moved).sum(axis=0)).T[:, None, :]
    return np.where((known & np.isfinite(better).all(axis=(1, 2)))[:, None, None], better, slopes)


def _newton(slopes: np.ndarray, off: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Newton's correction of the speeds (speeds, variants), and whether the fixed point is undetermined.

    Where disturbances grow, the correction is one cycle: Newton's method would lead away from a stable motion.
    """
    matrix = np.eye(slopes.shape[1]) - slopes
    det, terms = np.linalg.det(matrix), np.abs(matrix).max(axis=(1, 2)) ** slopes.shape[1]
    undecided = np.abs(det) <= UNDECIDED * terms + ANY
    matrix[undecided | (det <= 0.0)] = np.eye(slopes.shape[1])
    return np.linalg.solve(matrix, off.T[:, :, None])[:, :, 0].T, undecided
