"""Steady running at two speeds, through a fluid coupling: speeds of both sides that return after a cycle.

The initial guess is the pair of speeds at which the mean torques over a cycle balance.
"""

from collections.abc import Sequence

import numpy as np

from engine.compiling.running import mean_of_rows
from engine.motion.coupled.coupled_answers import run_coupled
from engine.motion.coupled.sides_at import Pull, SidesAt
from engine.motion.coupled.two_sides import FLUID, CoupledSides, Joined
from engine.motion.fields.recorded_motion import Observer
from engine.motion.runs.run_progress import CoupledStanding, Ends, RunOutcome, Standing, Stepping
from engine.motion.settled.return_map import Returned, returning_speeds
from engine.words.verdicts import Verdict

# Numbers of speeds and of crank angles at which mean torques are computed; highest speed over the no-load speed.
SPEEDS, PLACES, HIGHEST = 96, 64, 1.3


def settled_at_two_speeds(sides: CoupledSides, stepping: Stepping) -> Returned:
    """Find the steady running of machines with a fluid coupling.

    Parameters
    ----------
    sides : CoupledSides
        Starting at φ = 0.
    stepping : Stepping

    Returns
    -------
    Returned
        With the speeds of the crank and of the shaft, reduced to the crank.
    """

    def cycle(who: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        gone = one_cycle(sides.some(who), speeds, stepping)
        return np.array([gone.state.omega, gone.coupled.speed]), gone.verdict

    with np.errstate(all="ignore"):
        verdict, guess = _in_balance(sides)
        return returning_speeds(cycle, guess, verdict, stepping.longer)


def one_cycle(
    sides: CoupledSides, speeds: np.ndarray, stepping: Stepping, observers: Sequence[Observer] = ()
) -> RunOutcome:
    """One cycle of the crank, starting at φ = 0.

    Parameters
    ----------
    sides : CoupledSides
    speeds : ndarray (2, variants)
        Initial speeds of the crank and of the shaft, reduced to the crank [rad/s].
    stepping, observers
        As for `run_coupled`.
    """
    zero = np.zeros(sides.count)
    begin = Standing(zero, speeds[0], zero, zero.astype(np.uint8), CoupledStanding(speeds[1], zero))
    ends = Ends.never(sides.count, turned=np.full(sides.count, sides.crank.dynamics.cycle))
    return run_coupled(sides, begin, ends, stepping, observers)


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
        return SidesAt(sides, joined, moving, np.zeros_like(moving[0])).pull(moves=False)

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
