"""Steady running: the motion that returns to its own speed after every cycle, found directly.

The return map takes the kinetic energy E at the start of a cycle to the energy P(E) one cycle later. Steady running is
a fixed point; its multiplier λ = dP/dE is the growth factor of a small disturbance from cycle to cycle, and it is
stable if |λ| < 1. Newton's method finds it in a few cycles, where waiting takes hundreds; a final cycle computes the
requested results.
"""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from engine.compiling.packed import Packed
from engine.motion.fields.recorded_motion import Observer, OneSpeedMotion
from engine.motion.moments.breaks import edges_of
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import CHANNELS
from engine.stepping.closed_cycle import TOO_STEEP
from engine.stepping.methods import EIGHT, NINE
from engine.stepping.recorded import RECORDED, made_steps
from engine.stepping.records import put, some
from engine.stepping.system import RECORDED_AT, Closed, Start, Walks
from engine.stepping.walk_task import Why
from engine.words.verdicts import Verdict

# Maximum steps: during the search, in the final cycle, and in the final cycle if it is recorded.
FARTHEST, CLOSER, CLOSEST = 0.5 * np.pi, 0.25 * np.pi, 0.125 * np.pi
ENERGY, TIME = range(2)
# Number of motor time constants in a step above which the change of energy gives the torque more accurately.
STEEP = 200.0


class Steady(NamedTuple):
    """Steady running of a set of variants; NaN without steady running. All (variants,) except works.

    Attributes
    ----------
    verdict : ndarray of uint8
    energy, ended : ndarray
        Kinetic energy at the start and the end of the cycle [J].
    multiplier : ndarray
        λ.
    residual : ndarray
        Return residual |P(E) − E|/E.
    period : ndarray
        [s].
    slowest, fastest : ndarray
        Minimum and maximum speed [rad/s].
    fluctuation : ndarray
        δ.
    squares : ndarray
        Integral of the squared motor torque over time [N²·m²·s].
    works : ndarray (channels + 1, variants)
        Work of the motors and of each channel [J].
    steep : ndarray
        1 if a steep motor required implicit steps, else 0.
    """

    verdict: np.ndarray
    energy: np.ndarray
    ended: np.ndarray
    multiplier: np.ndarray
    residual: np.ndarray
    period: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray
    fluctuation: np.ndarray
    squares: np.ndarray
    works: np.ndarray
    steep: np.ndarray

    def shifted(self, by: "Steady") -> "Steady":
        """The same with every number changed."""
        return Steady(self.verdict, *(mine + off for mine, off in zip(self[1:], by[1:], strict=True)))


def steady_motion(
    dynamics: Dynamics,
    variants: Variants,
    tolerance: float,
    observers: Sequence[Observer] = (),
    off_observers: Sequence[Observer] = (),
    extremes: bool = True,
) -> tuple[Steady, Steady]:
    """Find steady running, and the error estimates of its numbers.

    Parameters
    ----------
    dynamics : Dynamics
        With the integral "fading".
    variants : Variants
    tolerance : float
        Tolerance of a step, relative to the maximum work in a step.
    observers, off_observers : sequence of Observer
        They see the cycle, and the cycle shifted by the error estimates of its energy and time.
    extremes : bool
        Whether the minimum and maximum speed are also located within steps.
    """
    with np.errstate(all="ignore"):
        recorded = bool(observers or off_observers)
        motion, key = _Motion(dynamics, variants, tolerance, extremes, recorded), ("closed", extremes, recorded)
        if key not in variants.kept:
            closed = motion.closed(np.arange(variants.count), False)
            steep = closed.verdict == TOO_STEEP
            if steep.any():
                put(closed, np.flatnonzero(steep), motion.closed(np.flatnonzero(steep), True))
            variants.kept[key] = closed, steep
        closed, steep = variants.kept[key]
        verdict = np.where(closed.verdict == TOO_STEEP, Verdict.NOT_FINITE, closed.verdict)
        return motion.final_cycles(closed, steep.copy(), verdict.astype(np.uint8), (observers, off_observers))


class _Motion:
    """Machines whose steady running is sought."""

    def __init__(
        self, dynamics: Dynamics, variants: Variants, tolerance: float, extremes: bool, recorded: bool
    ) -> None:
        self.extremes, self.farthest = extremes, 0.0 if recorded else CLOSER if extremes else np.inf
        self.dynamics, self.variants, self.tolerance, self.system = dynamics, variants, tolerance, dynamics.by_angle
        sizes = self.system.sizes
        # No guard ends the cycle while there is any energy. No load depends on time.
        limits = {sizes.above: np.inf, sizes.below: -np.inf, sizes.brisk: np.inf, self.system.system.clock: 0.0}
        self.numbers = self.system.limited(dynamics.moving(self.system, variants), limits)
        self.edges = np.concatenate(edges_of(variants.direction, variants.breaks, dynamics.cycle))

    def _start(self, who: np.ndarray, farthest: float, energy: np.ndarray, error: np.ndarray | float = 0.0) -> Start:
        """A walk over a cycle with steps of at most a length [rad], from an energy with its error estimate [J]."""
        states, errors = np.zeros((2, len(self.system.rates), who.size))
        states[ENERGY], errors[ENERGY], pace = energy, error, np.full(who.size, farthest)
        lanes = {"direction": self.variants.direction[who], "turned": np.zeros(who.size), "pace": pace}
        lanes |= {"goal": self.dynamics.cycle, "tolerance": self.tolerance, "farthest": farthest}
        return Start(self.numbers[:, who], lanes, states, self.edges[:, who], None, errors)

    def closed(self, who: np.ndarray, implicit: bool) -> Closed:
        """Cycles that return to their own energies; the search starts at the no-load speed, where loads dominate."""
        part = self.variants.some(who)
        top = 0.5 * self.dynamics.inertia(part, np.zeros(who.size)) * self.dynamics.no_load_speed(part)[0] ** 2
        task, last = self._task(implicit, False), self._task(implicit, self.extremes)
        return self.system.close(task, self._start(who, FARTHEST, top), last, self.farthest)

    def _task(self, implicit: bool, extremes: bool) -> Packed:
        return self.system.task(self.dynamics.cycle, NINE if implicit else EIGHT, extremes=extremes, timed=False)

    def final_cycles(
        self, closed: Closed, steep: np.ndarray, verdict: np.ndarray, observers: tuple[Sequence[Observer], ...]
    ) -> tuple[Steady, Steady]:
        """The cycles found, computed with all requested results, and their error estimates."""
        count = self.variants.count
        shapes = [(count,)] * 9 + [(1 + len(CHANNELS), count)]
        found, off = ([np.full(shape, np.nan) for shape in shapes] for _ in range(2))
        for implicit in (False, True):
            who = np.flatnonzero((verdict == Verdict.OK) & (steep == implicit))
            if not who.size:
                continue
            begin = closed.energy[who], closed.carried_error[who]
            gone = self._cycle(who, implicit, *begin, observers) if any(observers) else some(closed.cycle, who)
            # A cycle with shorter steps may reveal that a motor is steep.
            steep[who] |= gone.why == Why.STEEP
            verdict[who[(gone.why != Why.GOAL) & (implicit | (gone.why != Why.STEEP))]] = Verdict.NOT_FINITE
            own, other = self._numbers_of(*begin, closed.off[who], gone)
            for mine, new in zip((*found, *off), (*own, *other), strict=True):
                mine[..., who] = np.where(gone.why == Why.GOAL, new, np.nan)
        return Steady(verdict, *found, steep.astype(float)), Steady(verdict, *off, np.zeros(count))

    def _numbers_of(
        self, energy: np.ndarray, carried_error: np.ndarray, residual: np.ndarray, gone: Walks
    ) -> tuple[list[np.ndarray], list[np.ndarray]]:
        """Numbers of cycles in the order of `Steady`, without the verdict, and their error estimates."""
        names, gathered = self.system.names, partial(self.dynamics.gathered, self.system)
        ended, fading = gone.states[ENERGY], gone.states[names["fading"]]
        multiplier = np.exp(np.minimum(fading, 700.0))
        low, high = gone.slowest, gone.fastest
        fluctuation = 2.0 * (high - low) / (high + low)
        # An initial error, as far as it does not decay, shifts both extremes by the same ratio and leaves δ unchanged.
        common = 0.5 * multiplier * carried_error / energy
        apart = np.maximum(gone.slow_off / low - common, 0.0) + np.maximum(gone.fast_off / high - common, 0.0)
        fluctuation_off = fluctuation * carried_error / energy + apart
        between = np.maximum(gone.carried_errors[ENERGY] - multiplier * carried_error, 0.0)
        works, squares = gathered(gone.states, ended - energy, -1.0)
        works_off, squares_off = gathered(gone.carried_errors, between + np.abs(ended - energy), 1.0)
        period = gone.states[TIME]
        own = [energy, ended, multiplier, residual, period, low, high, fluctuation, squares, works]
        ended_off = carried_error + np.abs(ended - energy) + between
        off = [
            carried_error,
            ended_off,
            multiplier * gone.carried_errors[names["fading"]],
            residual,
            gone.carried_errors[TIME],
        ]
        off += [gone.slow_off, gone.fast_off, fluctuation_off, squares_off, works_off]
        return own, off

    def _cycle(
        self,
        who: np.ndarray,
        implicit: bool,
        energy: np.ndarray,
        carried_error: np.ndarray,
        observers: tuple[Sequence[Observer], ...],
    ) -> Walks:
        """A cycle from given energies, seen by observers and by those of the shifted cycle."""
        task, start = self._task(implicit, True), self._start(who, CLOSEST, energy, carried_error)
        start, whole, left = start._replace(recorded=RECORDED), None, np.arange(who.size)
        while left.size:
            gone = self.system.run(task, some(start, left))
            self._show(gone, who[left], observers)
            whole = gone if whole is None else _joined(whole, left, gone)
            lanes = start.lanes | {"turned": whole.turned, "pace": whole.pace}
            start = start._replace(lanes=lanes, states=whole.states, carried_errors=whole.carried_errors)
            left = left[(gone.why == Why.FULL) & (gone.steps > 0.0)]
        return whole._replace(recorded=np.empty((0, 0, who.size)))

    def _show(self, gone: Walks, who: np.ndarray, observers: tuple[Sequence[Observer], ...]) -> None:
        """Show recorded steps to observers; the speed determines the torque unless the motor is very steep."""
        made = made_steps(gone.recorded, gone.steps)
        if not made.variant.size:
            return
        variants = self.variants
        equation = EquationOfMotion(self.dynamics, variants, np.zeros(variants.count))
        steep = (-gone.states[self.system.names["fading"]] > STEEP * gone.steps)[made.variant]
        turned, facing = made.begin + RECORDED_AT[:, None] * made.length, np.ones(made.variant.size)
        for seers, off in zip(observers, (0.0, made.errors[:, None]), strict=True):
            states = made.samples + off
            samples = np.array([states[TIME], turned, states[ENERGY]])
            motion = OneSpeedMotion(equation, who[made.variant], facing, samples, made.length, steep)
            for seer in seers:
                seer.see(motion)


def _joined(whole: Walks, who: np.ndarray, gone: Walks) -> Walks:
    """Walks continued by others, with the extremes of both parts."""
    made = [row.copy() for row in whole[:-1]]
    for mine, new in zip(made, gone[:-1], strict=True):
        mine[..., who] = new
    joined = Walks(*made, whole.numbers)
    for extreme, off, better in (("slowest", "slow_off", np.less), ("fastest", "fast_off", np.greater)):
        kept = ~better(getattr(gone, extreme), getattr(whole, extreme)[who])
        for name in (extreme, off):
            getattr(joined, name)[who[kept]] = getattr(whole, name)[who[kept]]
    return joined
