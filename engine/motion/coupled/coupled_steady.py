"""Steady running at two speeds, through a fluid coupling: speeds of both sides that return after a cycle.

They are the fixed point of the map from one cycle of the crank to the next, found by Newton's method. The Jacobian of
the map follows from differences of cycles that start slightly faster and slower. The initial guess is the pair of
speeds at which the mean torques over a cycle balance.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.compiling.running import mean_of_rows
from engine.motion.coupled.coupled_answers import run_coupled
from engine.motion.coupled.two_sides import FLUID, CoupledSides, Joined, Pull, coupling_pull
from engine.motion.runs.run_progress import CoupledStanding, Ends, RunOutcome, Standing, Stepping
from engine.motion.runs.watching import Observer
from engine.words.verdicts import Verdict

# Relative tolerance of the speeds after a cycle; the tolerance accepted where step errors stall the convergence.
RETURNED, NEARLY = 1e-10, 1e-7
MOST_ROUNDS = 40
# Relative speed difference for the Jacobian: curvature of the map and step errors weigh about the same.
APART = 3e-4
# Maximum relative change of a speed per iteration.
FARTHEST = 0.3
# Relative tolerance within which a multiplier of 1 leaves the speed undetermined.
UNDECIDED = 1e-6
# Numbers of speeds and of crank angles at which mean torques are computed; highest speed over the no-load speed.
SPEEDS, PLACES, HIGHEST = 96, 64, 1.3


class CoupledSteady(NamedTuple):
    """Steady running at two speeds; arrays (variants,).

    Attributes
    ----------
    verdict : ndarray of uint8
    speeds : ndarray (2, variants)
        Of the crank and of the shaft at φ = 0, reduced to the crank [rad/s].
    multiplier : ndarray
        Largest factor by which a small disturbance grows per cycle.
    residual : ndarray
        Relative difference of the speeds after a cycle.
    """

    verdict: np.ndarray
    speeds: np.ndarray
    multiplier: np.ndarray
    residual: np.ndarray


def settled_at_two_speeds(sides: CoupledSides, stepping: Stepping) -> CoupledSteady:
    """Find the steady running of machines with a fluid coupling.

    Parameters
    ----------
    sides : CoupledSides
        Starting at φ = 0.
    stepping : Stepping
    """
    count = sides.count
    # A cycle from the speeds themselves, and from each of them slightly raised and lowered.
    begun = np.array([[1.0, 1.0 + APART, 1.0 - APART, 1.0, 1.0], [1.0, 1.0, 1.0, 1.0 + APART, 1.0 - APART]])
    ways = begun.shape[1]
    every = sides.some(np.tile(np.arange(count), ways)) if count else sides
    with np.errstate(all="ignore"):
        verdict, x = _in_balance(sides)
    good, multiplier = x.copy(), np.full(count, np.nan)
    residual, pending = np.full(count, np.inf), np.flatnonzero(verdict == Verdict.OK)
    for _ in range(MOST_ROUNDS):
        if not pending.size:
            break
        who = (pending + count * np.arange(ways)[:, None]).ravel()
        start = (begun[:, :, None] * x[:, None, pending]).reshape(2, -1)
        gone = one_cycle(every.some(who), start, stepping)
        after = np.array([gone.state.omega, gone.coupled.speed]).reshape(2, ways, -1)
        went = (gone.verdict == Verdict.OK).reshape(ways, -1)
        here = x[:, pending]
        slopes = np.stack([(after[:, i] - after[:, i + 1]) / (2.0 * APART * here[i // 2]) for i in (1, 3)], axis=1)
        off = np.abs(after[:, 0] - here).max(axis=0) / np.abs(here).max(axis=0)
        whole = went.all(axis=0) & np.isfinite(slopes).all(axis=(0, 1))
        growth, change, undecided = _newton(np.where(whole, slopes, 0.0), after[:, 0] - here)
        settled = whole & ((off <= RETURNED) | ((off <= NEARLY) & (off >= 0.5 * residual[pending])))
        residual[pending] = np.where(whole, off, residual[pending])
        multiplier[pending] = np.where(whole, growth, multiplier[pending])
        limit = np.abs(change / here).max(axis=0) / FARTHEST
        change = change / np.maximum(limit, 1.0)
        good[:, pending] = np.where(whole, here, good[:, pending])
        # Where a cycle fails, go half of the distance back to speeds where one succeeded.
        ahead = np.where(whole, here + change, 0.5 * (here + good[:, pending]))
        x[:, pending] = np.where(settled, here, ahead)
        verdict[pending[whole & undecided & ~settled]] = Verdict.ANY_SPEED
        never = ~whole & (good[:, pending] == here).all(axis=0)
        verdict[pending[never]] = gone.verdict.reshape(ways, -1).max(axis=0)[never]
        pending = pending[~settled & ~(whole & undecided) & ~never]
    slower = pending[x[0, pending] < good[0, pending]]
    verdict[pending], verdict[slower] = Verdict.RUNS_AWAY, Verdict.STALLS
    return CoupledSteady(verdict, x, multiplier, residual)


def one_cycle(
    sides: CoupledSides, speeds: np.ndarray, stepping: Stepping, observers: Sequence[Observer] = ()
) -> RunOutcome:
    """One cycle of the crank, starting at φ = 0.

    Parameters
    ----------
    sides : CoupledSides
    speeds : ndarray (2, variants)
        Of the crank and of the shaft at the start, reduced to the crank [rad/s].
    stepping, observers
        As for `run_coupled`.
    """
    zero = np.zeros(sides.count)
    begin = Standing(zero, speeds[0], zero, zero.astype(np.uint8), CoupledStanding(speeds[1], zero))
    ends = Ends.never(sides.count, turned=np.full(sides.count, sides.crank.dynamics.cycle))
    return run_coupled(sides, begin, ends, stepping, observers)


def _newton(slopes: np.ndarray, off: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Largest multiplier, Newton's correction of both speeds, and whether the fixed point is undetermined."""
    (a, b), (c, d) = slopes
    (p, q), det = (1.0 - a, 1.0 - d), (1.0 - a) * (1.0 - d) - b * c
    change = np.array([q * off[0] + b * off[1], c * off[0] + p * off[1]]) / det
    half, root = 0.5 * (a + d), np.sqrt((0.25 * (a - d) ** 2 + b * c).astype(complex))
    growth = np.maximum(np.abs(half + root), np.abs(half - root))
    return growth, change, np.abs(det) <= UNDECIDED * (np.abs(p * q) + np.abs(b * c) + UNDECIDED)


def _in_balance(sides: CoupledSides) -> tuple[np.ndarray, np.ndarray]:
    """Verdicts, and the highest speeds of both sides, (2, variants), at which the mean torques balance."""
    crank, shaft, count = sides.crank, sides.shaft.form, sides.count
    (own, on_crank), (_, on_shaft) = tops = [side.dynamics.no_load_speed(side.variants) for side in (crank, shaft)]
    top = HIGHEST * np.where(on_crank | on_shaft, np.fmax(*(top * driven for top, driven in tops)), own)
    speeds = top * np.linspace(1.0, 1.0 / SPEEDS, SPEEDS)[:, None]
    turned = np.broadcast_to(np.linspace(0.0, crank.dynamics.cycle, PLACES, endpoint=False)[:, None], (PLACES, count))
    zero, one = np.zeros(count), np.ones(count)
    joined = Joined(np.full(count, FLUID), one, one, zero, zero, one)
    left, others = np.empty((SPEEDS, count)), np.empty((SPEEDS, count))

    def at(turned: np.ndarray, speed: np.ndarray, other: np.ndarray) -> Pull:
        moving = np.array(np.broadcast_arrays(turned, speed, 0.0, other))
        return coupling_pull(sides, joined, moving, np.zeros_like(moving[0]), moves=False)

    of_shaft = at(zero, speeds, speeds).shaft.total
    for k, speed in enumerate(speeds):
        mean = mean_of_rows(at(turned, speed, speed).crank.total)
        passed = sides.coupling.fluid_moment(np.broadcast_to(speed, speeds.shape), speeds)
        others[k] = _highest_balance(speeds, of_shaft - passed)
        left[k] = mean + sides.coupling.fluid_moment(speed, others[k])
    found = _highest_balance(speeds, left)
    verdict = np.where(np.isfinite(found), Verdict.OK, np.where(left[0] > 0.0, Verdict.RUNS_AWAY, Verdict.STALLS))
    other = np.array([np.interp(found[v], speeds[::-1, v], others[::-1, v]) for v in range(count)]).reshape(count)
    return verdict.astype(np.uint8), np.array([found, other])


def _highest_balance(speeds: np.ndarray, moments: np.ndarray) -> np.ndarray:
    """Highest of descending speeds (speeds, variants) below which the torques drive; NaN if none."""
    drives = (moments[1:] >= 0.0) & (moments[:-1] < 0.0)
    at, lane = drives.argmax(axis=0), np.arange(moments.shape[1])
    low, high = moments[at + 1, lane], moments[at, lane]
    share = np.where(low > high, low / (low - high), 0.0)
    found = speeds[at + 1, lane] + share * (speeds[at, lane] - speeds[at + 1, lane])
    return np.where(drives.any(axis=0), found, np.nan)
