"""Steady running of machines with friction in their pairs: the fixed point of a cycle run in time, by secants."""

from collections.abc import Sequence

import numpy as np

from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.quantities import INSTANT
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_instants import RunInstants
from engine.motion.runs.run_progress import ADAPTIVE, Ends, RunOutcome, Standing
from engine.motion.runs.watching import Observer, RunFields
from engine.motion.settled.steady import Steady, steady_motion
from engine.words.verdicts import Verdict

# Relative tolerance of the return residual, and most cycles.
RETURNED, MOST_CYCLES = 1e-9, 60
# If errors of the steps prevent that, the cycle is accepted once the residual stops decreasing and is below this.
NEARLY = 1e-6
# Ratio of the second trial energy to the first; relative change of energy below which the secant slope is unreliable.
SECOND, TELLING = 0.8, 1e-4
# If disturbances neither grow nor decay, within this, any speed is an equilibrium.
UNDECIDED = 1e-9
# Samples in a cycle.
STEPS = 720


def settled_motion(
    dynamics: Dynamics, variants: Variants, tolerance: float, longer: float, asked: np.ndarray | None = None
) -> Steady:
    """Steady running, with friction in pairs if there is any.

    Parameters
    ----------
    dynamics, variants, tolerance, asked
        As for `steady_motion`.
    longer : float
        One of `WALKS`: for comparison, errors shift the motion or, with friction, its steps are longer.
    """
    if not dynamics.rubs:
        steady, off = steady_motion(dynamics, variants, tolerance, asked)
        return steady.shifted(off) if longer > 1.0 else steady
    with np.errstate(all="ignore"):
        return _settled(dynamics, variants, longer, asked)


def _settled(dynamics: Dynamics, variants: Variants, longer: float, asked: np.ndarray | None) -> Steady:
    count, zero = variants.count, np.zeros(variants.count)
    inertia = dynamics.inertia(variants, zero)
    energy = 0.5 * inertia * dynamics.no_load_speed(variants)[0] ** 2
    verdict, multiplier = np.full(count, Verdict.RUNS_AWAY, np.uint8), np.full(count, np.nan)
    # The last energy at which a cycle was completed, and the energy after it.
    known, returned = np.full(count, np.nan), np.full(count, np.nan)
    pending, left = np.arange(count), np.full(count, np.inf)
    for turn in range(MOST_CYCLES):
        if not pending.size:
            break
        here = energy[pending]
        outcome = _cycle(dynamics, variants.some(pending), np.sqrt(2.0 * here / inertia[pending]), longer)
        came, before = outcome.ended, known[pending]
        gone = outcome.verdict == Verdict.OK
        slope = (came - returned[pending]) / (here - before)
        telling = gone & (np.abs(here - before) > TELLING * here)
        multiplier[pending] = np.where(telling, slope, multiplier[pending])
        slope = np.where(telling, slope, multiplier[pending])
        off = np.abs(came - here) / here
        settled = gone & ((off <= RETURNED) | ((off <= NEARLY) & (off >= 0.5 * left[pending]) & np.isfinite(slope)))
        left[pending] = off
        falls = np.where(np.isfinite(slope) & (slope < 1.0 - UNDECIDED), slope, 0.0)
        ahead = SECOND * here if turn == 0 else here + (came - here) / (1.0 - falls)
        ahead = np.where(ahead > 0.0, ahead, 0.25 * here)
        # If the machine stalls, restart closer to the last energy at which it did not.
        energy[pending] = np.where(settled, here, np.where(gone, ahead, 0.5 * (here + before)))
        verdict[pending[settled]] = Verdict.OK
        lost = ~gone & ~np.isfinite(before)
        verdict[pending[lost]] = outcome.verdict[lost]
        slower = gone & ~settled & (came < here)
        verdict[pending[slower]], verdict[pending[gone & ~settled & ~slower]] = Verdict.STALLS, Verdict.RUNS_AWAY
        undecided = gone & ~settled & (turn > 0) & (np.abs(slope - 1.0) <= UNDECIDED)
        verdict[pending[undecided]] = Verdict.ANY_SPEED
        known[pending[gone]], returned[pending[gone]] = here[gone], came[gone]
        pending = pending[~settled & ~lost & ~undecided]
    return _measured(dynamics, variants, energy, inertia, multiplier, verdict, longer, asked)


def _measured(
    dynamics: Dynamics,
    variants: Variants,
    energy: np.ndarray,
    inertia: np.ndarray,
    multiplier: np.ndarray,
    verdict: np.ndarray,
    longer: float,
    asked: np.ndarray | None,
) -> Steady:
    """The cycle from the energies found, with all requested results."""
    count = variants.count
    nodes = 0 if asked is None else asked.shape[0]
    rows, record = np.full((7, count), np.nan), np.full((3, nodes, count), np.nan)
    works = np.full((len(dynamics.channels) + 1, count), np.nan)
    good = np.flatnonzero(verdict == Verdict.OK)
    if good.size:
        part, zero = variants.some(good), np.zeros(good.size)
        along = RunFields(dynamics, part, zero, zero, None, frozenset())
        names = ("kinetic_energy", INSTANT)
        seen = RunInstants(along, names, asked[:, good], over_time=False) if nodes else None
        omega = np.sqrt(2.0 * energy[good] / inertia[good])
        outcome = _cycle(dynamics, part, omega, longer, [seen] if nodes else [])
        state = outcome.state
        residual = np.abs(outcome.ended - energy[good]) / energy[good]
        own = (energy[good], outcome.ended, residual, state.time, outcome.slowest, outcome.fastest, state.squares)
        rows[:, good], works[:, good] = own, state.works
        if nodes:
            seen.finish(outcome)
            record[:2, :, good] = [seen.rows[name].T for name in names]
    begun, ended, residual, period, slowest, fastest, squares = rows
    multiplier = np.where(verdict == Verdict.OK, multiplier, np.nan)
    fluctuation = 2.0 * (fastest - slowest) / (fastest + slowest)
    found = begun, ended, multiplier, residual, period, slowest, fastest, fluctuation, squares, works, record
    return Steady(verdict, *found, np.zeros(verdict.size))


def _cycle(
    dynamics: Dynamics, variants: Variants, omega: np.ndarray, longer: float, observers: Sequence[Observer] = ()
) -> RunOutcome:
    """A cycle from a given speed at φ = 0."""
    zero = np.zeros(variants.count)
    ends = Ends.never(variants.count, turned=np.full(variants.count, dynamics.cycle))
    begin, stepping = Standing(zero, omega, zero, zero.astype(np.uint8)), ADAPTIVE._replace(longer=longer)
    return run_to_end(dynamics, variants, begin, ends, STEPS, stepping, observers)
