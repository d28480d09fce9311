"""Steady running of machines with friction in their pairs: the fixed point of a cycle run in time."""

from collections.abc import Sequence

import numpy as np

from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.quantities import INSTANT
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_instants import RunInstants
from engine.motion.runs.run_progress import ADAPTIVE, Ends, RunOutcome, Standing
from engine.motion.runs.watching import Observer, RunFields
from engine.motion.settled.return_map import Returned, returning_speeds
from engine.motion.settled.steady import Steady, steady_motion
from engine.words.verdicts import Verdict

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
    def cycle(who: np.ndarray, speeds: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        gone = _cycle(dynamics, variants.some(who), speeds[0], longer)
        return gone.state.omega[None], gone.verdict

    verdict = np.full(variants.count, Verdict.OK, np.uint8)
    found = returning_speeds(cycle, dynamics.no_load_speed(variants)[0][None], verdict)
    return _measured(dynamics, variants, found, longer, asked)


def _measured(
    dynamics: Dynamics, variants: Variants, found: Returned, longer: float, asked: np.ndarray | None
) -> Steady:
    """The cycle from the speeds found, with all requested results."""
    count = variants.count
    nodes = 0 if asked is None else asked.shape[0]
    rows, record = np.full((7, count), np.nan), np.full((3, nodes, count), np.nan)
    works = np.full((len(dynamics.channels) + 1, count), np.nan)
    good = np.flatnonzero(found.verdict == Verdict.OK)
    if good.size:
        part, zero = variants.some(good), np.zeros(good.size)
        along = RunFields(dynamics, part, zero, zero, None, frozenset())
        names = ("kinetic_energy", INSTANT)
        seen = RunInstants(along, names, asked[:, good], over_time=False) if nodes else None
        omega = found.speeds[0, good]
        outcome = _cycle(dynamics, part, omega, longer, [seen] if nodes else [])
        state, energy = outcome.state, 0.5 * dynamics.inertia(part, zero) * omega**2
        residual = np.abs(outcome.ended - energy) / energy
        own = (energy, outcome.ended, residual, state.time, outcome.slowest, outcome.fastest, state.squares)
        rows[:, good], works[:, good] = own, state.works
        if nodes:
            seen.finish(outcome)
            record[:2, :, good] = [seen.rows[name].T for name in names]
    begun, ended, residual, period, slowest, fastest, squares = rows
    fluctuation = 2.0 * (fastest - slowest) / (fastest + slowest)
    own = begun, ended, found.multiplier, residual, period, slowest, fastest, fluctuation, squares, works, record
    return Steady(found.verdict, *own, np.zeros(count))


def _cycle(
    dynamics: Dynamics, variants: Variants, omega: np.ndarray, longer: float, observers: Sequence[Observer] = ()
) -> RunOutcome:
    """A cycle from a given speed at φ = 0."""
    zero = np.zeros(variants.count)
    ends = Ends.never(variants.count, turned=np.full(variants.count, dynamics.cycle))
    begin, stepping = Standing(zero, omega, zero, zero.astype(np.uint8)), ADAPTIVE._replace(longer=longer)
    return run_to_end(dynamics, variants, begin, ends, STEPS, stepping, observers)
