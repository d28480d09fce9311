"""Runs of machines in progress, at one speed or two: how they begin and end, their steps, and their outcome."""

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import NamedTuple

import numpy as np

from engine.graph.nodes import Given
from engine.motion.fields.recorded_motion import Observer, RecordedMotion
from engine.motion.moments.breaks import edges_of
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import Sizes, TimeEnd
from engine.stepping.records import some
from engine.stepping.runs import WalkedRuns
from engine.stepping.walk_task import Why
from engine.words.verdicts import Verdict

# Tolerance of a step in time, and of a step over the angle, whose errors add up over many cycles; maximum step.
TOLERANCE, OVER_ANGLE, FARTHEST_STEP = 1e-10, 3e-12, 0.25 * np.pi
# Reasons for the end of a walk at a target speed, the first guards of each system.
AT_SPEED = (TimeEnd.ABOVE, TimeEnd.BELOW)
# Starting speeds of other motions, as fractions of the distance to the target speed: the first detects early
# without another steady motion between, the second with a speed from which the machine would stall.
SHARES = (0.9, 0.1)
# Angles this close to the end of a cycle, as a fraction of it, count as its end.
NEARLY = 1e-9
# Swings that differ by less are equal within the error of the steps [rad].
SAME_SWING = 1e-6


class State(NamedTuple):
    """State of each variant, (variants,): angle turned [rad], speed [rad/s], time [s]; works (kinds, variants) [J].

    `works` contains the work of the motors and of each channel of loads, `squares` the integral of the squared motor
    torque over time [N²·m²·s].
    """

    turned: np.ndarray
    omega: np.ndarray
    time: np.ndarray
    works: np.ndarray
    squares: np.ndarray


class CoupledStanding(NamedTuple):
    """State of a coupling's shaft between two regimes, (variants,).

    Its speed reduced to the crank, in the direction of motion [rad/s], and the time since the engagement [s].
    """

    speed: np.ndarray
    engaged: np.ndarray


class Standing(NamedTuple):
    """State of every variant between two regimes: crank angle [rad], speed [rad/s], time [s], verdict.

    `coupled` is the state of a shaft behind a coupling; None if it turns with the crank.
    """

    angle: np.ndarray
    omega: np.ndarray
    clock: np.ndarray
    verdict: np.ndarray
    coupled: CoupledStanding | None = None


class Ends(NamedTuple):
    """Ends of runs, (variants,): angle turned from the start of the run [rad], time [s], speed [rad/s]; inf for never.

    `rest`: the run ends at permanent rest; `reversal`: at any rest, also a momentary one; `arrival`: only at an end of
    the input's range; `lock_up`: when a clutch locks. At `most_turned` [rad] it is abandoned.
    """

    turned: np.ndarray
    time: np.ndarray
    speed: np.ndarray
    most_turned: np.ndarray
    rest: bool = False
    reversal: bool = False
    arrival: bool = False
    lock_up: bool = False

    @classmethod
    def never(cls, count: int, **given: np.ndarray) -> "Ends":
        """Ends of runs that only the given conditions end."""
        return cls(**{name: np.full(count, np.inf) for name in ("turned", "time", "speed", "most_turned")} | given)

    @property
    def standing(self) -> bool:
        """Whether a run ends at rest, permanent or momentary."""
        return self.rest or self.reversal


class Changed(NamedTuple):
    """Propagated error estimates of the ends of runs, (variants,) each, works (works, variants)."""

    turned: np.ndarray
    omega: np.ndarray
    energy: np.ndarray
    time: np.ndarray
    squares: np.ndarray
    works: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray

    def added_to(self, state: State) -> State:
        """A state changed by them."""
        return State(*(mine + getattr(self, name) for name, mine in zip(State._fields, state, strict=True)))


class RunOutcome(NamedTuple):
    """Outcome of runs; arrays (variants,) unless stated.

    Attributes
    ----------
    verdict : ndarray of uint8
    state : State
        Final state; angle and time from the start of the run.
    slowest, fastest : ndarray
        Minimum and maximum speed [rad/s].
    started, ended, energy : ndarray
        Initial, final, and approximate maximum kinetic energy [J].
    covered : ndarray (2, variants)
        Minimum and maximum angle turned [rad].
    steep : ndarray
        1 if a steep motor required implicit steps, else 0.
    arrived : ndarray of int
        End of its range at which the input arrived: −1 the lower, 1 the upper, 0 none.
    changed : Changed or None
        Error estimates of these; None at two speeds.
    known : ndarray of bool or None
        Whether the error estimates are complete.
    coupled : CoupledStanding or None
        State of the shaft behind a coupling.
    values : dict of str to ndarray
        Results of a coupling by their names in a regime, without the prefixes of the coupling and its shaft.
    """

    verdict: np.ndarray
    state: State
    slowest: np.ndarray
    fastest: np.ndarray
    started: np.ndarray
    ended: np.ndarray
    energy: np.ndarray
    covered: np.ndarray
    steep: np.ndarray
    arrived: np.ndarray
    changed: Changed | None = None
    known: np.ndarray | None = None
    coupled: CoupledStanding | None = None
    values: Mapping[str, np.ndarray] = MappingProxyType({})

    def shifted(self, by: Changed) -> "RunOutcome":
        """The same with its final values changed."""
        speeds = self.slowest - by.slowest, self.fastest + by.fastest
        ended = self.ended + by.energy
        return self._replace(state=by.added_to(self.state), ended=ended, slowest=speeds[0], fastest=speeds[1])


class Stepping(NamedTuple):
    """Step control of runs.

    Attributes
    ----------
    tolerance, over_angle : float
        Relative tolerance of a step in time and of a step over the angle.
    farthest : float
        Maximum step [rad].
    classical : bool
        Whether all steps over the angle have that length, with the classical method of order four.
    extremes : bool
        Whether the minimum and maximum speed are also located within steps.
    peaks : bool
        Whether the peak torque of a coupling is located.
    longer : float
        One of `WALKS`: the tolerances of a comparison run are looser, and its equal steps longer.
    """

    tolerance: float = TOLERANCE
    over_angle: float = OVER_ANGLE
    farthest: float = FARTHEST_STEP
    classical: bool = False
    extremes: bool = True
    peaks: bool = True
    longer: float = 1.0


ADAPTIVE = Stepping()


class MachineRuns(WalkedRuns):
    """Runs of machines: what one speed and two have in common.

    Parameters
    ----------
    form : EquationOfMotion
        Equation for the crank, with the initial crank angles.
    standing : Standing
        Initial state.
    ends : Ends
    stepping : Stepping
    observers : sequence of Observer

    Attributes
    ----------
    turned, omega, time : ndarray
        Angle turned by the crank from the start of the run [rad], its speed in the direction of motion [rad/s], and
        time from the start [s]: views of the current state.
    clock : ndarray
        Time at the start [s].
    farthest_step : float
        Maximum step, in units of `reach`.
    reach : ndarray
        Unit of angle: one radian or, for an input of limited range, its range divided by 2π.
    above, below : ndarray
        Target speed [rad/s], to be reached from below or from above; infinite if not applicable.
    covered, steep : ndarray
        As in `RunOutcome`, so far.
    farthest_swing : ndarray
        Angle turned at the last reversal from forward motion [rad].
    """

    turned: np.ndarray
    omega: np.ndarray
    time: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray

    def __init__(
        self,
        form: EquationOfMotion,
        standing: Standing,
        ends: Ends,
        stepping: Stepping,
        observers: Sequence[Observer],
    ) -> None:
        self.form, self.dynamics, self.variants, self.start = form, form.dynamics, form.variants, form.start
        count, omega = self.variants.count, standing.omega
        super().__init__(count, stepping.tolerance, stepping.longer)
        self.clock, self.ends, self.stepping, self.observers = standing.clock, ends, stepping, observers
        self.farthest_step, self.reach = stepping.farthest * self.longer, np.ones(count)
        # A target speed is above or below the initial speed.
        self.above = np.where(ends.speed > omega, ends.speed, np.inf)
        self.below = np.where(ends.speed < omega, ends.speed, -np.inf)
        self.done |= ends.speed == omega
        self.covered, self.steep = np.zeros((2, count)), np.zeros(count)
        self.farthest_swing = np.full(count, np.nan)
        self._last_inertia = np.zeros(0, int), np.zeros(0), np.zeros(0)

    def see(self, motion: RecordedMotion) -> None:
        """Pass a part of the motion to all observers."""
        for observer in self.observers:
            observer.see(motion)

    def energy(self) -> np.ndarray:
        """Current kinetic energy [J]."""
        return self.energy_at(np.arange(self.turned.size), self.turned, self.omega, self.time)

    def energy_at(self, who: np.ndarray, turned: np.ndarray, omega: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Kinetic energy of variants at given states [J]."""
        if not self.dynamics.with_servos:
            return 0.5 * self.inertia(who, turned) * omega**2
        facing = np.where(omega < 0.0, -1.0, 1.0)
        return self.form.of(who).with_servos(turned, omega, self.clock[who] + time, facing)[0]

    def inertia(self, who: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """Reduced inertia of variants at given angles turned [kg·m²].

        The last result is cached: the next stretch starts where the previous one ends.
        """
        last_who, last_turned, known = self._last_inertia
        if np.array_equal(who, last_who) and np.array_equal(turned, last_turned):
            return known
        found = self.form.of(who).inertia(turned)
        self._last_inertia = who, turned.copy(), found
        return found

    def cover(self, who: np.ndarray) -> None:
        """Count the current angles of variants among those covered."""
        self.covered[0, who] = np.fmin(self.covered[0, who], self.turned[who])
        self.covered[1, who] = np.fmax(self.covered[1, who], self.turned[who])

    def speed_limits(self, who: np.ndarray, sizes: Sizes, facing: np.ndarray) -> dict[Given, np.ndarray]:
        """The target speeds for motion in given directions."""
        forward, above, below = facing > 0.0, self.above[who], self.below[who]
        return {sizes.above: np.where(forward, above, -below), sizes.below: np.where(forward, below, -above)}

    def edges(self, who: np.ndarray, start: np.ndarray, bounds: np.ndarray | None = None) -> np.ndarray:
        """Breaks of the torques of variants from given crank angles on, as for a walk."""
        own = self.variants.some(who)
        return np.concatenate(edges_of(own.direction, own.breaks, self.dynamics.cycle, start, bounds))

    def lanes(self, who: np.ndarray, facing: np.ndarray, **others: np.ndarray | float) -> dict[str, np.ndarray | float]:
        """Numbers of a walk over time from the current states, in the directions faced."""
        own = {"start": self.start[who], "direction": self.variants.direction[who], "facing": facing}
        own |= {"clock": self.clock[who] + self.time[who], "tolerance": self.tolerance, "turned": self.turned[who]}
        return own | others

    def end(self, who: np.ndarray, why: np.ndarray, goal: np.ndarray) -> None:
        """End the runs whose walks over time met an end of all runs, or turned too far, or can't move on.

        Parameters
        ----------
        who : ndarray of int
        why : ndarray
            Why their walks ended.
        goal : ndarray
            Angle turned up to which they walked [rad].
        """
        self.jammed(who[why == Why.LOST])
        met = (why == Why.OTHER_GOAL) & (goal == self.ends.turned[who])
        self.done[who[met | np.isin(why, AT_SPEED)]] = True
        far = who[np.abs(self.turned[who]) >= self.ends.most_turned[who]]
        self.give_up(far[~self.done[far]])

    def jammed(self, who: np.ndarray) -> None:
        """End runs that can't move on; with friction, where no equilibrium exists, reactions are infinite or NaN."""
        self.give_up(who, Verdict.JAMS if self.dynamics.rubs else Verdict.NOT_FINITE)

    def last_change(self, who: np.ndarray) -> np.ndarray:
        """Clock time of the last change of a torque by a table over time [s]."""
        return np.fmax.reduce(self.variants.instants[:, who], axis=0, initial=-np.inf)

    def past_tables(self, who: np.ndarray) -> np.ndarray:
        """Whether the last instant is over, after which no table depends on time."""
        return self.last_change(who) <= (self.clock[who] + self.time[who]) * (1.0 + 1e-15)

    def never_changes(self, who: np.ndarray) -> np.ndarray:
        """Whether nothing depends on time any more, and no time ends the run; a formula may change at any time."""
        return self.past_tables(who) & np.isinf(self.ends.time[who]) & (not self.dynamics.changing)

    @property
    def seeks_speed(self) -> bool:
        """Whether a speed ends any of the runs: it may be reached within a step and left again."""
        return bool(np.isfinite(self.ends.speed).any())

    def speeds(self, who: np.ndarray) -> np.ndarray:
        """All speeds of variants [rad/s], (speeds, variants)."""
        return self.omega[None, who]

    def held_back(self, who: np.ndarray, rises: np.ndarray) -> np.ndarray:
        """Which variants, accelerating or decelerating, never reach their target speed: others ahead fall back."""
        return np.any([self._held_back(who, rises, share) for share in SHARES], axis=0)

    def _held_back(self, who: np.ndarray, rises: np.ndarray, share: float) -> np.ndarray:
        """The same by one other motion, ahead by a share of the distance to the end."""
        # Speeds of neighbouring motions stay roughly proportional.
        below = np.maximum(self.below[who], 0.0)
        falls_to = below / np.where(below > 0.0, self.slowest[who], 1.0)
        to_end = np.where(rises, self.above[who] / self.fastest[who], falls_to)
        begin = self.speeds(who) * (1.0 + share * (to_end - 1.0))
        ahead = self.beside(who, some(self.ends, who), begin)
        whole = (ahead.verdict == Verdict.OK) & (ahead.turned >= self.dynamics.cycle * (1.0 - NEARLY))
        gained = np.where(rises, 1.0, -1.0) * (ahead.speeds(np.arange(who.size)) - begin)
        return whole & (gained <= 0.0).all(axis=0)

    def beside(self, who: np.ndarray, ends: Ends, speeds: np.ndarray) -> "MachineRuns":
        """Runs over a cycle with other speeds from where some variants are now; `ends` may end them before.

        Runs at two speeds start whole cycles before that.
        """
        place = self.start[who] + self.variants.direction[who] * self.turned[who]
        shaft, sound = self._shaft_beside(who, speeds), np.zeros(who.size, np.uint8)
        begin = Standing(place, speeds[0], self.clock[who] + self.time[who], sound, shaft)
        ends = ends._replace(turned=np.full(who.size, self.dynamics.cycle), most_turned=np.full(who.size, np.inf))
        others = self._others(who, begin, ends, self.stepping._replace(extremes=True, peaks=False))
        others.go_to_end()
        return others

    def _shaft_beside(self, who: np.ndarray, speeds: np.ndarray) -> CoupledStanding | None:
        """State of a shaft behind a coupling at the beginning of other runs; None if it turns with the crank."""
        return None

    def _others(self, who: np.ndarray, standing: Standing, ends: Ends, stepping: Stepping) -> "MachineRuns":
        """Runs of some variants from other states, without observers."""
        raise NotImplementedError

    def give_up_endless(self, who: np.ndarray) -> None:
        """Abandon runs that cannot reach their end unless something changes."""
        self.give_up(who[~self.done[who] & self.never_changes(who)])

    # Phase curves of an autonomous machine never cross. So a swing that does not exceed the previous one lies within
    # it, as do all later ones.

    def compare_swings(self, rest: np.ndarray, width: np.ndarray | float = np.inf) -> None:
        """Abandon runs of machines that came to rest no farther forwards than at the last swing.

        A run to rest continues as long as its swings, of a given width [rad], decrease.
        """
        compared = ~self.done[rest] & self.never_changes(rest)
        same = SAME_SWING * np.fmin(self.reach[rest], width)[compared]
        rest = rest[compared]
        turned, before = self.turned[rest], self.farthest_swing[rest]
        again = turned <= before + same
        if self.ends.rest:
            again &= turned >= before - same
        self.farthest_swing[rest] = turned
        self.give_up(rest[again])
