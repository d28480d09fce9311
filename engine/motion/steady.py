"""Steady state: the motion that comes back to its own speed after every cycle, found directly.

The return map takes the kinetic energy E at the first node to the energy P(E) one cycle later. Steady motion is a
fixed point; its multiplier λ = dP/dE = exp ∮ ∂M/∂E dφ tells how a small disturbance grows from cycle to cycle, and
the steady motion is stable where |λ| < 1. Newton's method on P(E) − E with that λ converges in a few cycles, where
waiting takes hundreds.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.steppers.energy_form import NODES, Course, Limits, Tables
from engine.motion.steppers.stepping import advance
from engine.verdicts import Verdict

MOST_ROUNDS = 30
CLOSED = 1e-12
SPEEDS = 200
# Moments whose mean over a cycle is a smaller share of their mean magnitude are taken to do no work: it is rounding.
NO_WORK = 1e-9


class Steady(NamedTuple):
    """Steady motion of a set of variants; NaN where there is none.

    Attributes
    ----------
    verdict : ndarray (variants,) of uint8
    energy : ndarray (variants,)
        Kinetic energy at the first node [J].
    multiplier : ndarray (variants,)
        λ.
    residual : ndarray (variants,)
        |P(E) − E|/E, what is left.
    rounds : int
        Cycles computed.
    omega, time : ndarray (nodes, variants)
        Speed [rad/s] and time [s] over the cycle.
    course : Course
    """

    verdict: np.ndarray
    energy: np.ndarray
    multiplier: np.ndarray
    residual: np.ndarray
    rounds: int
    omega: np.ndarray
    time: np.ndarray
    course: Course


def steady_motion(dynamics: Dynamics, variants: Variants, tables: Tables, energy: np.ndarray | None = None) -> Steady:
    """Find the steady motion.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    tables : Tables
        Of one cycle.
    energy : ndarray (variants,), optional
        Where to begin [J]; otherwise with the speed at which the mean moment over the cycle is zero.
    """
    count = variants.count
    verdict, highest = np.full(count, Verdict.OK, np.uint8), np.full(count, np.inf)
    if energy is None:
        speed, top, verdict = balanced_speed(dynamics, variants, tables)
        energy, highest = 0.5 * tables.inertia[0] * speed * speed, 0.5 * tables.inertia[0] * top * top
    energy = energy.copy()
    multiplier, residual = np.full((2, count), np.nan)
    # The return map grows with E, so a machine that stalls from some energy stalls from every lower one.
    stalls_at, last = np.zeros(count), np.full(count, np.inf)
    pending, rounds = np.flatnonzero(verdict == Verdict.OK), 0
    while pending.size and rounds < MOST_ROUNDS:
        rounds += 1
        part, rows = variants.some(pending), tables.some(pending)
        before = energy[pending]
        after, _, log_multiplier, _, _ = one_cycle(dynamics, part, rows, before)
        with np.errstate(all="ignore"):
            lam = np.exp(np.minimum(log_multiplier, 700.0))
            change, off = (after - before) / (1.0 - lam), np.abs(after - before) / before
        whole = np.isfinite(after) & np.isfinite(change)
        stalls_at[pending] = np.where(whole, stalls_at[pending], before)
        hopeless = ~whole & (before >= highest[pending])
        verdict[pending[hopeless]] = Verdict.STALLS
        multiplier[pending], residual[pending] = lam, off
        closed = whole & (np.abs(change) <= CLOSED * before)
        # No progress any more, so near to the end that it is rounding.
        stuck = whole & (off >= 0.5 * last[pending]) & (np.abs(change) < 1e-8 * before)
        last[pending] = off
        lowest = 0.5 * (stalls_at[pending] + before)
        energy[pending] = np.where(
            whole, np.maximum(before + change, lowest), np.minimum(highest[pending], 8.0 * before)
        )
        pending = pending[~(closed | stuck | hopeless)]
    verdict[pending] = Verdict.STALLS
    failed = verdict != Verdict.OK
    energy[failed] = multiplier[failed] = residual[failed] = np.nan
    _, course, _, omega, time = one_cycle(dynamics, variants, tables, energy)
    return Steady(verdict, energy, multiplier, residual, rounds, omega, time, course)


def one_cycle(
    dynamics: Dynamics, variants: Variants, tables: Tables, energy: np.ndarray
) -> tuple[np.ndarray, Course, np.ndarray, np.ndarray, np.ndarray]:
    """Energy after one cycle (NaN where it isn't completed), its course, log λ, and speed and time at the nodes."""
    count, steps = variants.count, tables.steps.shape[0]
    record = np.full((2, steps + 1, count), np.nan)
    free = np.full(count, np.inf)
    # Nothing else could carry a machine through a cycle in which it nearly stops.
    limits = Limits(np.full(count, steps), free, free, np.full(count, -1.0))
    course = advance(dynamics, variants, tables, energy, limits, record)
    whole = course.made == steps
    record[:, :, ~whole] = np.nan
    inertia = tables.inertia[0::2]
    with np.errstate(all="ignore"):
        omega = np.sqrt(2.0 * record[0] / inertia)
        slope = dynamics.moments(variants, tables.at(NODES), omega).slope / (inertia * omega)
        # One after another: NumPy sums a single column in another order, and the last bit would depend on company.
        log_multiplier = np.cumsum(0.5 * tables.steps * (slope[1:] + slope[:-1]), axis=0)[-1]
    return np.where(whole, course.energy, np.nan), course, log_multiplier, omega, record[1]


# Where to begin


def balanced_speed(dynamics: Dynamics, variants: Variants, tables: Tables) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Speed at which the mean moment over the cycle is zero and falls with the speed, the greatest of several.

    Returns
    -------
    speed : ndarray (variants,)
        [rad/s]; NaN where there is none.
    top : ndarray (variants,)
        A speed at which the loads win.
    verdict : ndarray (variants,) of uint8
        STALLS where the loads win at every speed, RUNS_AWAY where the drive does, ANY_SPEED where neither does at any,
        NOT_FINITE where the moments aren't finite.
    """
    means = mean_rows(tables)
    top, driven = no_load_speed(variants)

    def moment(omega: np.ndarray) -> np.ndarray:
        return dynamics.moments(variants, means, omega).total

    top = rising(moment, top, driven)
    share = np.concatenate((np.linspace(0.001, 1.0, SPEEDS), 1.0 - np.geomspace(1e-6, 0.05, SPEEDS // 2)))
    speeds = np.sort(share)[:, None] * top
    with np.errstate(all="ignore"):
        values = moment(speeds)
    falls = (values[:-1] > 0.0) & (values[1:] <= 0.0)
    last = falls.shape[0] - 1 - falls[::-1].argmax(axis=0)
    columns = np.arange(variants.count)
    low, high = speeds[last, columns], speeds[last + 1, columns]
    for _ in range(40):
        middle = 0.5 * (low + high)
        with np.errstate(all="ignore"):
            drives = moment(middle[None])[0] > 0.0
        low, high = np.where(drives, middle, low), np.where(drives, high, middle)
    exists = falls.any(axis=0)
    runs_away = ~exists & (values[-1] > 0.0)
    verdict = np.where(exists, Verdict.OK, np.where(runs_away, Verdict.RUNS_AWAY, Verdict.STALLS)).astype(np.uint8)
    to_and_fro = mean_rows(tables._replace(loads=np.abs(tables.loads))).loads[:, 0, 0].sum(axis=0)
    idle = (np.abs(values) <= NO_WORK * to_and_fro).all(axis=0)
    exists, verdict[idle] = exists & ~idle, Verdict.ANY_SPEED
    verdict[~np.isfinite(values).any(axis=0)] = Verdict.NOT_FINITE
    return np.where(exists, 0.5 * (low + high), np.nan), top, verdict


def no_load_speed(variants: Variants) -> tuple[np.ndarray, np.ndarray]:
    """Speed beyond which no motor drives, and whether there is a motor at all; else the scene's own speed."""
    drive, own = variants.drive, np.abs(np.broadcast_to(variants.numbers["input.speed"], (variants.count,)))
    with np.errstate(all="ignore"):
        speeds = [np.where(drive.line[1] < 0.0, -drive.line[0] / drive.line[1], 0.0)]
    speeds += [constants[3] / constants[4] for constants in drive.kloss]
    top = np.max(speeds, axis=0)
    return np.where(top > 0.0, top, own), top > 0.0


def rising(moment: Callable[[np.ndarray], np.ndarray], top: np.ndarray, driven: np.ndarray) -> np.ndarray:
    """A speed at which the loads win, looking beyond the motors' own where something else drives."""
    for _ in range(60):
        with np.errstate(all="ignore"):
            wins = moment(top[None])[0] > 0.0
        if not wins.any():
            break
        top = np.where(wins, np.where(driven, 1.05, 1.5) * top, top)
    return top


def mean_rows(tables: Tables) -> Tables:
    """Means of the loads over the cycle, by Simpson's rule; everything else as at the first node."""
    h = tables.steps
    length = h.sum(axis=0)

    def mean(rows: np.ndarray) -> np.ndarray:
        parts = rows[..., 0:-2:2, :] + 4.0 * rows[..., 1::2, :] + rows[..., 2::2, :]
        return (h / 6.0 * parts).sum(axis=-2, keepdims=True) / length

    return Tables(h, mean(tables.inertia), mean(tables.loads), mean(tables.powers))


def refined_extremes(omega: np.ndarray, slope: np.ndarray, steps: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Least and greatest speed of each variant, from nodes and the cubics between them.

    Parameters
    ----------
    omega, slope : ndarray (nodes, variants)
        Speed and its derivative by φ.
    steps : ndarray (nodes − 1, variants)
    """
    low, high = omega.min(axis=0), omega.max(axis=0)
    rise, m0, m1 = omega[1:] - omega[:-1], steps * slope[:-1], steps * slope[1:]
    # A cubic says something only where the slopes at both ends go with the rise: not beside a jump, and not where the
    # speed follows a steep motor within the step.
    turns = ((m0 > 0.0) != (m1 > 0.0)) & (np.abs(m0 + m1 - 2.0 * rise) <= 0.5 * (np.abs(m0) + np.abs(m1)))
    with np.errstate(all="ignore"):
        a = 3.0 * (m0 + m1 - 2.0 * rise)
        b = 3.0 * rise - 2.0 * m0 - m1
        root = np.sqrt(b * b - a * m0)
        t = np.where(m0 > 0.0, m0 / (root - b), -m0 / (root + b))
        extreme = omega[:-1] + t * (m0 + t * (b + t * a / 3.0))
        extreme = np.where(turns & (t > 0.0) & (t < 1.0), extreme, omega[:-1])
    return np.minimum(low, extreme.min(axis=0)), np.maximum(high, extreme.max(axis=0))
