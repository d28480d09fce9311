"""Progress of runs: their ends, current states, and events so far."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import MachineSystem
from engine.motion.runs.watching import Observer, Piece
from engine.stepping.walk import LONGER, coarser
from engine.words.verdicts import Verdict

# Tolerance of a step in time, and of a step over the angle, whose errors add up over many cycles; maximum step.
TOLERANCE, OVER_ANGLE, FARTHEST_STEP = 1e-10, 3e-12, 0.25 * np.pi
# Fraction of a cycle before a mark within which it counts as passed: rounding.
AT_MARK = 1e-9


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


def gathered(
    system: MachineSystem, dynamics: Dynamics, rows: np.ndarray, change: np.ndarray, sign: float
) -> tuple[np.ndarray, np.ndarray]:
    """Works of the motors and of each channel, and the integral of the squared motor torque; zero if not accumulated.

    The work of loads in a single channel is the change of energy minus the motors' work.

    Parameters
    ----------
    system : MachineSystem
    dynamics : Dynamics
    rows : ndarray (states and gathered, variants)
        Rows of the system.
    change : ndarray (variants,)
        Change of the energy.
    sign : float
        −1; +1 if all are error estimates.
    """
    names, nothing = system.names, np.zeros_like(change)
    motors, squares = (rows[names[name]] if name in names else nothing for name in ("motors", "squares"))
    loads = [rows[names[name]] for name in dynamics.channels] if dynamics.works else [change + sign * motors]
    return np.stack([motors, *loads]), squares


class Begin(NamedTuple):
    """Initial state of runs, (variants,): crank angle [rad], speed in the direction of motion [rad/s], time [s]."""

    angle: np.ndarray
    omega: np.ndarray
    clock: np.ndarray

    def some(self, chosen: np.ndarray) -> "Begin":
        """A subset of the variants, by index."""
        return Begin(*(row[chosen] for row in self))


class Ends(NamedTuple):
    """Ends of runs, (variants,): angle turned from the start of the run [rad], time [s], speed [rad/s]; inf for never.

    `rest`: the run ends at permanent rest; `reversal`: at any rest, also a momentary one; `arrival`: only at an end of
    the input's range. At `most_turned` [rad] it is abandoned.
    """

    turned: np.ndarray
    time: np.ndarray
    speed: np.ndarray
    rest: bool
    most_turned: np.ndarray
    arrival: bool = False
    reversal: bool = False

    @property
    def standing(self) -> bool:
        """Whether a run ends at rest, permanent or momentary."""
        return self.rest or self.reversal

    def some(self, chosen: np.ndarray) -> "Ends":
        """A subset of the variants, by index."""
        own = {key: getattr(self, key)[chosen] for key in ("turned", "time", "speed", "most_turned")}
        return self._replace(**own)


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


class RunOutcome(NamedTuple):
    """Outcome of runs; arrays (variants,) unless stated.

    Attributes
    ----------
    verdict : ndarray of uint8
    state : State
        Final state; angle and time from the start of the run.
    slowest, fastest : ndarray
        Minimum and maximum speed [rad/s].
    started, ended : ndarray
        Initial and final kinetic energy [J].
    arrived : ndarray of int
        End of its range at which the input arrived: −1 the lower, 1 the upper, 0 none.
    changed : Changed
        Error estimates of these.
    known : ndarray of bool
        Whether the error estimates are complete.
    covered : ndarray (2, variants)
        Minimum and maximum angle turned [rad].
    steep : ndarray
        1 if a steep motor required implicit steps, else 0.
    """

    verdict: np.ndarray
    state: State
    slowest: np.ndarray
    fastest: np.ndarray
    started: np.ndarray
    ended: np.ndarray
    arrived: np.ndarray
    changed: Changed
    known: np.ndarray
    covered: np.ndarray
    steep: np.ndarray

    def shifted(self, by: Changed) -> "RunOutcome":
        """The same with its final values changed."""
        now = self.state
        state = now._replace(
            turned=now.turned + by.turned,
            omega=now.omega + by.omega,
            time=now.time + by.time,
            works=now.works + by.works,
            squares=now.squares + by.squares,
        )
        speeds = self.slowest - by.slowest, self.fastest + by.fastest
        return self._replace(state=state, ended=self.ended + by.energy, slowest=speeds[0], fastest=speeds[1])

    def with_others(self, who: np.ndarray, others: "RunOutcome") -> "RunOutcome":
        """The same with the outcome of some variants replaced."""

        def put(mine: np.ndarray, new: np.ndarray) -> np.ndarray:
            whole = mine.copy()
            whole[..., who] = new
            return whole

        def together(mine: tuple, new: tuple) -> tuple:
            return type(mine)(*(put(*pair) for pair in zip(mine, new, strict=True)))

        parts = {name: together(getattr(self, name), getattr(others, name)) for name in ("state", "changed")}
        rest = {name: put(getattr(self, name), getattr(others, name)) for name in self._fields if name not in parts}
        return RunOutcome(**parts, **rest)


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
    """

    tolerance: float = TOLERANCE
    over_angle: float = OVER_ANGLE
    farthest: float = FARTHEST_STEP
    classical: bool = False
    extremes: bool = True


ADAPTIVE = Stepping()


class Progress:
    """Runs of a set of variants in progress; both forms of the equation of motion update them.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    begin : Begin
    ends : Ends
    steps : int
        Number of samples in a cycle for observers.
    half : bool
        Whether this is a comparison run: looser tolerance and twice the maximum step; equal steps are twice as long.
    observers : sequence of Observer
    stepping : Stepping

    Attributes
    ----------
    start, clock : ndarray
        Initial crank angle [rad] and time [s].
    state : State
        Current state; angle and time from the start of the run.
    verdict, slowest, fastest, covered, steep : ndarray
        As in `RunOutcome`, so far.
    done : ndarray of bool
        Whether the run is over.
    pace : ndarray
        Length of the next step in time [s]; infinite if not yet known.
    tolerance, over_angle, farthest_step : float
        Relative tolerance of a step in time and over the angle, and maximum step in units of `reach`.
    reach : ndarray
        Unit of angle: one radian or, for an input of limited range, its range divided by 2π.
    spacing : ndarray
        Distance between samples.
    bounds : ndarray (2, variants)
        Angle turned at the ends of the input's range, backwards and forwards; infinite if it rotates fully.
    arrived : ndarray of int
        As in `RunOutcome`, so far.
    classical, extremes : bool
        As in `Stepping`.
    to_the_end : bool
        Whether no values within steps are needed.
    facing : ndarray
        +1 or −1, the direction of motion in time; 0 at rest.
    above, below : ndarray
        Target speed [rad/s], to be reached from below or from above; infinite if not applicable.
    carried : ndarray (rows of the system by angle, variants)
        Error estimates of kinetic energy [J], time [s] and integrals so far, from steps over the angle.
    changed : Changed
        Error estimates of the ends, as in `RunOutcome`.
    known : ndarray of bool
        Whether these are complete: steps in time and equal steps require a comparison run.
    turned_round, farthest : ndarray
        Angle turned at the last rest, and at the last reversal from forward motion [rad].
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
        begin: Begin,
        ends: Ends,
        steps: int,
        half: bool = False,
        observers: Sequence[Observer] = (),
        stepping: Stepping = ADAPTIVE,
    ) -> None:
        self.dynamics, self.variants = dynamics, variants
        self.start, omega, self.clock = begin
        self.ends, self.steps, self.half, self.observers = ends, steps, half, observers
        count, channels = variants.count, len(dynamics.channels)
        low, high = dynamics.reduction.range_of(variants.numbers, count)
        self.spacing = (high - low) / steps
        self.reach, self.bounds = np.ones(count), np.array([[-np.inf], [np.inf]]) * np.ones(count)
        if not dynamics.reduction.has_cycle:
            self.reach = (high - low) / (2.0 * np.pi)
            self.bounds = np.sort(variants.direction * (np.array([low, high]) - self.start), axis=0)
        self.arrived, self.carried = np.zeros(count, int), np.zeros((0, count))
        self.known = np.full(count, not stepping.classical)
        nothing = {name: np.zeros(count) for name in Changed._fields}
        self.changed = Changed(**nothing | {"works": np.zeros((channels + 1, count))})
        works = np.zeros((channels + 1, count))
        self.state = State(np.zeros(count), omega.astype(float), np.zeros(count), works, np.zeros(count))
        self.verdict = np.full(count, Verdict.OK, np.uint8)
        self.slowest, self.fastest = self.state.omega.copy(), self.state.omega.copy()
        self.covered, self.steep = np.zeros((2, count)), np.zeros(count)
        self.pace = np.full(count, np.inf)
        self.classical, self.extremes = stepping.classical, stepping.extremes
        self.to_the_end = not (stepping.classical or observers)
        # A looser tolerance alone may leave the steps unchanged; lengthen them, too.
        self.longer = LONGER if half else 1.0
        self.farthest_step = stepping.farthest * self.longer
        self.tolerance, self.over_angle = (coarser(share) if half else share for share in stepping[:2])
        self.done = np.zeros(count, bool)
        # A target speed is above or below the initial speed.
        self.above = np.where(ends.speed > omega, ends.speed, np.inf)
        self.below = np.where(ends.speed < omega, ends.speed, -np.inf)
        self.facing = np.sign(self.state.omega)
        self.done |= ends.speed == omega
        self.turned_round, self.farthest = np.zeros(count), np.full(count, np.nan)
        endless = np.isinf(ends.turned) & np.isinf(ends.time)
        self.by_speed = endless & dynamics.reduction.has_cycle & (not dynamics.changing)
        self.mark = np.where(self.by_speed, dynamics.cycle, np.inf)
        self.omega_at_mark = np.full(count, np.nan) if dynamics.timed else self.state.omega.copy()
        self.marks = np.zeros(count, int)
        self._last_inertia = np.zeros(0, int), np.zeros(0), np.zeros(0)
        self.arrive(np.flatnonzero((self.facing != 0.0) & (self.ahead(np.arange(count)) <= 0.0)))

    def ahead(self, who: np.ndarray) -> np.ndarray:
        """Distance of variants to the end of the input's range in the direction they face."""
        (low, high), turned = self.bounds[:, who], self.state.turned[who]
        return np.where(self.facing[who] < 0.0, turned - low, high - turned)

    def arrive(self, who: np.ndarray) -> None:
        """End the runs of variants at the end of the range that they face."""
        way = np.where(self.facing[who] < 0.0, -1, 1)
        self.state.turned[who] = np.where(way < 0, *self.bounds[:, who])
        self.arrived[who] = way * self.variants.direction[who].astype(int)
        self.done[who] = True
        if not (self.ends.arrival or self.ends.standing):
            early = np.isfinite(self.ends.speed[who]) | np.isfinite(self.ends.turned[who])
            self.verdict[who[early]] = Verdict.NO_END

    def energy(self) -> np.ndarray:
        """Current kinetic energy [J]."""
        return 0.5 * self.inertia(np.arange(self.variants.count), self.state.turned) * self.state.omega**2

    def inertia(self, who: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """Reduced inertia of variants at given angles turned [kg·m²].

        The last result is cached: the next stretch starts where the previous one ends.
        """
        last_who, last_turned, known = self._last_inertia
        if np.array_equal(who, last_who) and np.array_equal(turned, last_turned):
            return known
        part = self.variants.some(who)
        found = self.dynamics.inertia(part, self.start[who] + part.direction * turned)
        self._last_inertia = who, turned.copy(), found
        return found

    def see(self, who: np.ndarray, piece: Piece) -> None:
        """Pass a piece of the motion of variants to all observers."""
        for observer in self.observers:
            observer.see(who, piece)

    def see_begin(self) -> None:
        """Pass the initial states to all observers; a machine at rest faces forwards."""
        if self.observers:
            state, facing = self.state, np.where(self.facing < 0.0, -1.0, 1.0)
            every = np.arange(facing.size)
            # At a jump, evaluate the torques after it.
            turned = state.turned + facing * self.equation(every).beside(state.turned)
            now = [x[None].copy() for x in (state.time, turned, state.omega)]
            self.see(every, Piece(*now, facing, np.empty((0, facing.size)), np.full_like(now[0], np.nan)))

    def give_up(self, who: np.ndarray, verdict: Verdict) -> None:
        """End the runs of variants with a verdict."""
        self.verdict[who], self.done[who] = verdict, True

    def begin_cycles(self, who: np.ndarray) -> None:
        """Set the first mark of variants that have not yet completed a cycle."""
        first = who[self.by_speed[who] & (self.mark[who] <= self.dynamics.cycle)]
        self.mark[first] = self.state.turned[first] + self.dynamics.cycle
        self.omega_at_mark[first] = self.state.omega[first]

    def at_mark(self, who: np.ndarray) -> np.ndarray:
        """Which variants are at their marks, by index."""
        return who[self.state.turned[who] >= self.mark[who] - AT_MARK * self.dynamics.cycle]

    def past_tables(self, who: np.ndarray) -> np.ndarray:
        """Whether the last instant is over, after which no table depends on time."""
        last = np.fmax.reduce(self.variants.instants[:, who], axis=0, initial=-np.inf)
        return self.clock[who] + self.state.time[who] > last

    def set_marks(self, who: np.ndarray) -> None:
        """Set the marks of variants ahead of them, by whole cycles."""
        behind = np.floor((self.state.turned[who] - self.mark[who]) / self.dynamics.cycle + AT_MARK)
        self.mark[who] += np.maximum(behind + 1.0, 0.0) * self.dynamics.cycle

    def put(self, who: np.ndarray, state: State) -> None:
        """Store the new state of variants."""
        for mine, new in zip(self.state, state, strict=True):
            mine[..., who] = new
        self.slowest[who] = np.minimum(self.slowest[who], state.omega)
        self.fastest[who] = np.maximum(self.fastest[who], state.omega)
        self.covered[0, who] = np.fmin(self.covered[0, who], state.turned)
        self.covered[1, who] = np.fmax(self.covered[1, who], state.turned)

    def part(self, who: np.ndarray) -> State:
        """State of a subset of the variants."""
        return State(*(x[..., who] for x in self.state))

    def equation(self, who: np.ndarray) -> EquationOfMotion:
        """The equation of motion of a subset of the variants."""
        return EquationOfMotion(self.dynamics, self.variants, self.start, who)
