"""Runs at one speed in progress: directions, ends of the input's range, marks of cycles, and errors so far."""

import math
from collections.abc import Sequence

import numpy as np

from engine.motion.fields.recorded_motion import Observer, at_instant
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import CHANNELS
from engine.motion.runs.run_progress import ADAPTIVE, Changed, Ends, MachineRuns, Standing, State, Stepping
from engine.stepping.records import put, some
from engine.stepping.walk_task import tolerance_of_walk
from engine.words.verdicts import Verdict

# Fraction of a cycle before a mark within which it counts as passed: rounding.
AT_MARK = 1e-9


class OneSpeedRuns(MachineRuns):
    """Runs at one speed; both forms of the equation of motion update them.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    standing : Standing
        Initial state.
    ends : Ends
    steps : int
        Number of samples in a cycle for observers.
    stepping : Stepping
    observers : sequence of Observer

    Attributes
    ----------
    state : State
        Current state; angle and time from the start of the run.
    slowest, fastest : ndarray
        As in `RunOutcome`, so far.
    over_angle : float
        Relative tolerance of a step over the angle.
    spacing : ndarray
        Distance between samples.
    bounds : ndarray (2, variants)
        Angle turned at the ends of the input's range, backwards and forwards; infinite if it rotates fully.
    arrived : ndarray of int
        As in `RunOutcome`, so far.
    to_the_end : bool
        Whether no values within steps are needed.
    facing : ndarray
        +1 or −1, the direction of motion in time; 0 at rest.
    carried : ndarray (rows of the system by angle, variants)
        Error estimates of kinetic energy [J], time [s] and integrals so far, from steps over the angle.
    changed : Changed
        Error estimates of the ends, as in `RunOutcome`.
    known : ndarray of bool
        Whether these are complete: steps in time and equal steps require comparison runs.
    turned_round : ndarray
        Angle turned at the last rest [rad].
    by_speed : ndarray of bool
        Whether only a speed or rest ends the run, so that comparing cycles may show that it never ends.
    mark, omega_at_mark : ndarray
        Angle turned at which the speed is next compared with that of previous cycles [rad], and that speed, NaN if it
        is not comparable [rad/s].
    marks : ndarray of int
        Number of marks passed.
    """

    def __init__(
        self,
        dynamics: Dynamics,
        variants: Variants,
        standing: Standing,
        ends: Ends,
        steps: int,
        stepping: Stepping = ADAPTIVE,
        observers: Sequence[Observer] = (),
    ) -> None:
        super().__init__(EquationOfMotion(dynamics, variants, standing.angle), standing, ends, stepping, observers)
        self.steps, count = steps, variants.count
        low, high = dynamics.reduction.range_of(variants.numbers, count)
        self.spacing = (high - low) / steps
        self.bounds = np.array([[-np.inf], [np.inf]]) * np.ones(count)
        if not dynamics.reduction.has_cycle:
            self.reach = (high - low) / math.tau
            self.bounds = np.sort(variants.direction * (np.array([low, high]) - self.start), axis=0)
        self.arrived, self.carried = np.zeros(count, int), np.zeros((0, count))
        self.known = np.full(count, not stepping.classical)
        nothing = {name: np.zeros(count) for name in Changed._fields}
        self.changed = Changed(**nothing | {"works": np.zeros((1 + len(CHANNELS), count))})
        works = np.zeros((1 + len(CHANNELS), count))
        self.state = State(np.zeros(count), standing.omega.astype(float), np.zeros(count), works, np.zeros(count))
        self.turned, self.omega, self.time, _, _ = self.state
        self.slowest, self.fastest = self.omega.copy(), self.omega.copy()
        self.to_the_end = not (stepping.classical or observers)
        self.over_angle = tolerance_of_walk(stepping.over_angle, stepping.longer)
        self.facing, self.turned_round = np.sign(self.omega), np.zeros(count)
        endless = np.isinf(ends.turned) & np.isinf(ends.time)
        self.by_speed = endless & dynamics.reduction.has_cycle & (not dynamics.changing)
        self.mark = np.where(self.by_speed, dynamics.cycle, np.inf)
        self.omega_at_mark = np.full(count, np.nan) if dynamics.timed else self.omega.copy()
        self.marks = np.zeros(count, int)
        self.arrive(np.flatnonzero((self.facing != 0.0) & (self.ahead(np.arange(count)) <= 0.0)))

    def _others(self, who: np.ndarray, standing: Standing, ends: Ends, stepping: Stepping) -> "OneSpeedRuns":
        return type(self)(self.dynamics, self.variants.some(who), standing, ends, self.steps, stepping)

    @property
    def finds_extremes(self) -> bool:
        """Whether steps end at the extremes of the speed."""
        return (self.stepping.extremes and not self.observers) or self.seeks_speed

    def ahead(self, who: np.ndarray, facing: np.ndarray | None = None) -> np.ndarray:
        """Distance of variants to the end of the input's range in a direction, by default the one they face."""
        (low, high), turned = self.bounds[:, who], self.state.turned[who]
        return np.where((self.facing[who] if facing is None else facing) < 0.0, turned - low, high - turned)

    def arrive(self, who: np.ndarray) -> None:
        """End the runs of variants at the end of the range that they face."""
        direction = np.where(self.facing[who] < 0.0, -1, 1)
        self.state.turned[who] = np.where(direction < 0, *self.bounds[:, who])
        self.arrived[who] = direction * self.variants.direction[who].astype(int)
        self.done[who] = True
        if not (self.ends.arrival or self.ends.standing):
            early = np.isfinite(self.ends.speed[who]) | np.isfinite(self.ends.turned[who])
            self.verdict[who[early]] = Verdict.NO_END

    def see_begin(self) -> None:
        """Pass the initial states to all observers; a machine at rest faces forwards."""
        if self.observers:
            state, facing = self.state, np.where(self.facing < 0.0, -1.0, 1.0)
            # At a jump, evaluate the torques after it.
            turned = state.turned + facing * self.form.break_offset(state.turned)
            self.see(at_instant(self.form, state.time, turned, state.omega))

    def begin_cycles(self, who: np.ndarray) -> None:
        """Set the first mark of variants that have not yet completed a cycle."""
        first = who[self.by_speed[who] & (self.mark[who] <= self.dynamics.cycle)]
        self.mark[first] = self.state.turned[first] + self.dynamics.cycle
        self.omega_at_mark[first] = self.state.omega[first]

    def at_mark(self, who: np.ndarray) -> np.ndarray:
        """Which variants are at their marks, by index."""
        return who[self.state.turned[who] >= self.mark[who] - AT_MARK * self.dynamics.cycle]

    def set_marks(self, who: np.ndarray) -> None:
        """Set the marks of variants ahead of them, by whole cycles."""
        behind = np.floor((self.state.turned[who] - self.mark[who]) / self.dynamics.cycle + AT_MARK)
        self.mark[who] += np.maximum(behind + 1.0, 0.0) * self.dynamics.cycle

    def put(self, who: np.ndarray, state: State) -> None:
        """Store the new state of variants."""
        put(self.state, who, state)
        self.slowest[who] = np.minimum(self.slowest[who], state.omega)
        self.fastest[who] = np.maximum(self.fastest[who], state.omega)
        self.cover(who)

    def part(self, who: np.ndarray) -> State:
        """State of a subset of the variants."""
        return some(self.state, who)
