"""Steady running of machines with friction in their pairs: the fixed point of a cycle run in time."""

from collections.abc import Callable, Sequence

import numpy as np

from engine.motion.fields.recorded_motion import Observer
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.one_speed import CHANNELS
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_progress import ADAPTIVE, Ends, RunOutcome, Standing
from engine.motion.settled.return_map import Returned, returning_speeds
from engine.motion.settled.steady import Steady, steady_motion
from engine.words.verdicts import Verdict

Watch = Callable[[np.ndarray], Sequence[Observer]]
# Samples in a cycle.
STEPS = 720


def settled_motion(
    dynamics: Dynamics,
    variants: Variants,
    tolerance: float,
    longer: float,
    watch: Watch | None = None,
) -> Steady:
    """Steady running, with friction in pairs if there is any.

    Parameters
    ----------
    dynamics, variants, tolerance
        As for `steady_motion`.
    longer : float
        One of `WALKS`: for comparison, errors shift the motion or, with friction, its steps are longer.
    watch : callable, optional
        Makes the observers of the cycle, given the indices of the variants that run in it.
    """
    if not dynamics.rubs:
        observers = () if watch is None else watch(np.arange(variants.count))
        steady, off = steady_motion(dynamics, variants, tolerance, observers)
        return steady.shifted(off) if longer > 1.0 else steady
    with np.errstate(all="ignore"):
        return _settled(dynamics, variants, longer, watch)


def _settled(dynamics: Dynamics, variants: Variants, longer: float, watch: Watch | None) -> Steady:
    def cycle(who: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        gone = _cycle(dynamics, variants.some(who), speeds[0], longer)
        return gone.state.omega[None], gone.verdict

    verdict = np.full(variants.count, Verdict.OK, np.uint8)
    found = returning_speeds(cycle, dynamics.no_load_speed(variants)[0][None], verdict, longer)
    return _measured(dynamics, variants, found, longer, watch)


def _measured(dynamics: Dynamics, variants: Variants, found: Returned, longer: float, watch: Watch | None) -> Steady:
    """The cycle from the speeds found, with all requested results."""
    count = variants.count
    rows, works = np.full((8, count), np.nan), np.full((len(CHANNELS) + 1, count), np.nan)
    good = np.flatnonzero(found.verdict == Verdict.OK)
    observers = () if watch is None else watch(good)
    if good.size:
        part, zero = variants.some(good), np.zeros(good.size)
        omega = found.speeds[0, good]
        outcome = _cycle(dynamics, part, omega, longer, observers)
        state, energy = outcome.state, 0.5 * dynamics.inertia(part, zero) * omega**2
        residual = np.abs(outcome.ended - energy) / energy
        extremes = outcome.slowest, outcome.fastest
        own = energy, outcome.ended, residual, state.time, *extremes, state.squares, outcome.steep
        rows[:, good], works[:, good] = own, state.works
    begun, ended, residual, period, slowest, fastest, squares, steep = rows
    fluctuation = 2.0 * (fastest - slowest) / (fastest + slowest)
    own = begun, ended, found.multiplier, residual, period, slowest, fastest, fluctuation, squares, works
    return Steady(found.verdict, *own, steep)


def _cycle(
    dynamics: Dynamics, variants: Variants, omega: np.ndarray, longer: float, observers: Sequence[Observer] = ()
) -> RunOutcome:
    """A cycle from a given speed at φ = 0."""
    zero = np.zeros(variants.count)
    ends = Ends.never(variants.count, turned=np.full(variants.count, dynamics.cycle))
    begin, stepping = Standing(zero, omega, zero, zero.astype(np.uint8)), ADAPTIVE._replace(longer=longer)
    return run_to_end(dynamics, variants, begin, ends, STEPS, stepping, observers)
