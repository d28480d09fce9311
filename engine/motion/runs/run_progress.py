"""How far runs have come: where they are to end, where each stands, and what it met on its way."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.moments.equation_of_motion import EquationOfMotion
from engine.motion.one_speed import MachineSystem
from engine.motion.runs.watching import Observer, Piece
from engine.stepping.walk import LONGER, coarser
from engine.words.verdicts import Verdict

# What a step in time may miss, and one over the angle, whose errors add up over many cycles; how far they may turn.
TOLERANCE, OVER_ANGLE, FARTHEST_STEP = 1e-10, 3e-12, 0.25 * np.pi
# So much of a cycle before a mark it is passed: all that rounding leaves.
AT_MARK = 1e-9


class State(NamedTuple):
    """State of each variant, (variants,): angle turned [rad], speed [rad/s], time [s]; works (sorts, variants) [J].

    `works` holds the work of the motors and of each channel of loads, `squares` the integral of the motors' moment
    squared over time [N²·m²·s].
    """

    turned: np.ndarray
    omega: np.ndarray
    time: np.ndarray
    works: np.ndarray
    squares: np.ndarray


def gathered(
    system: MachineSystem, dynamics: Dynamics, rows: np.ndarray, change: np.ndarray, sign: float
) -> tuple[np.ndarray, np.ndarray]:
    """Works of the motors and of each channel, and the motors' moment squared over time; zero where not gathered.

    The work of loads in one channel is the change of energy less the motors' work.

    Parameters
    ----------
    system : MachineSystem
    dynamics : Dynamics
    rows : ndarray (states and gathered, variants)
        Of the system.
    change : ndarray (variants,)
        Of the energy.
    sign : float
        −1; +1 for what all of them may be off by.
    """
    names, nothing = system.names, np.zeros_like(change)
    motors, squares = (rows[names[name]] if name in names else nothing for name in ("motors", "squares"))
    loads = [rows[names[name]] for name in dynamics.channels] if dynamics.works else [change + sign * motors]
    return np.stack([motors, *loads]), squares


class Begin(NamedTuple):
    """Where runs begin, (variants,): crank angle [rad], speed in the direction of motion [rad/s], and time [s]."""

    angle: np.ndarray
    omega: np.ndarray
    clock: np.ndarray

    def some(self, chosen: np.ndarray) -> "Begin":
        """Those of some variants, by index."""
        return Begin(*(row[chosen] for row in self))


class Ends(NamedTuple):
    """Where runs end, (variants,): angle turned from the run's begin [rad], time [s], speed [rad/s]; inf for never.

    `rest` says whether the run ends at rest, `reversal` whether wherever it stands, be it for a moment, `arrival`
    whether only at an end of the input's range; `most_turned` [rad] is where it is given up.
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
        """Whether a run ends where it stands, for good or for a moment."""
        return self.rest or self.reversal

    def some(self, chosen: np.ndarray) -> "Ends":
        """Those of some variants, by index."""
        own = {key: getattr(self, key)[chosen] for key in ("turned", "time", "speed", "most_turned")}
        return self._replace(**own)


class Changed(NamedTuple):
    """What the ends of runs may be off by as far as it is carried along, (variants,) each, works (works, variants)."""

    turned: np.ndarray
    omega: np.ndarray
    energy: np.ndarray
    time: np.ndarray
    squares: np.ndarray
    works: np.ndarray
    slowest: np.ndarray
    fastest: np.ndarray


class RunOutcome(NamedTuple):
    """How runs went; arrays (variants,) unless said.

    Attributes
    ----------
    verdict : ndarray of uint8
    state : State
        At the end; angle and time counted from the begin of the run.
    slowest, fastest : ndarray
        Least and greatest speed [rad/s].
    started, ended : ndarray
        Kinetic energy at begin and end [J].
    arrived : ndarray of int
        At which end of its range the input arrived: −1 at the lower one, 1 at the upper one, 0 at none.
    changed : Changed
        What all that may be off by.
    known : ndarray of bool
        Whether it isn't off by more.
    covered : ndarray (2, variants)
        Least and greatest angle turned [rad].
    steep : ndarray
        1 where a motor was so steep that steps were implicit, else 0.
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
        """The same with its end changed."""
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
        """The same with the outcome of some variants in its place."""

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
    """How runs are stepped.

    Attributes
    ----------
    tolerance, over_angle : float
        What a step in time and one over the angle may miss, as a share.
    farthest : float
        How far a step may turn [rad].
    classical : bool
        Whether all steps over the angle are of that length, by the classical method of order four.
    extremes : bool
        Whether the least and the greatest speed are looked for within steps, too.
    """

    tolerance: float = TOLERANCE
    over_angle: float = OVER_ANGLE
    farthest: float = FARTHEST_STEP
    classical: bool = False
    extremes: bool = True


ADAPTIVE = Stepping()


class Progress:
    """Runs of a set of variants on their way: what both forms of the equation of motion carry on.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    begin : Begin
    ends : Ends
    steps : int
        In how many places of a cycle it is looked at.
    half : bool
        Whether it is for comparison: steps may miss more and turn twice as far; those of one length are twice as long.
    observers : sequence of Observer
        What looks at the runs.
    stepping : Stepping

    Attributes
    ----------
    start, clock : ndarray
        Crank angle [rad] and time [s] at the begin.
    state : State
        Now; angle and time counted from the begin of the run.
    verdict, slowest, fastest, covered, steep : ndarray
        As of `RunOutcome`, so far.
    done : ndarray of bool
        Whether the run is over.
    pace : ndarray
        Length of the next step in time [s]; infinite where nothing is known yet.
    tolerance, over_angle, farthest_step : float
        What a step may miss in time and over the angle, as a share, and how far it may turn, of `reach`.
    reach : ndarray
        What counts as a radian: one, or where the input doesn't turn fully its range by 2π.
    spacing : ndarray
        How far apart the places are that are looked at.
    bounds : ndarray (2, variants)
        Angle turned at the ends of the input's range, behind and ahead; infinite where it turns fully.
    arrived : ndarray of int
        As of `RunOutcome`, so far.
    classical, extremes : bool
        As of `Stepping`.
    to_the_end : bool
        Whether nothing within their steps is asked for.
    facing : ndarray
        +1 or −1, the way that a machine moves in time, 0 where it stands.
    above, below : ndarray
        The speed to be reached [rad/s], as one to come up to or to come down to; infinite where it isn't.
    carried : ndarray (rows of the system by angle, variants)
        What kinetic energy [J], time [s] and what is gathered may be off by so far, by steps over the angle.
    changed : Changed
        What the ends may be off by, as in `RunOutcome`.
    known : ndarray of bool
        Whether that is all they may be off by: steps in time and those of one length are compared with others.
    turned_round, farthest : ndarray
        Angle turned where a machine stood last, and where it last turned round on its way forward [rad].
    by_speed : ndarray of bool
        Whether a speed or rest alone ends the run, and comparing cycles may tell that none of them does.
    mark, omega_at_mark : ndarray
        Angle turned at which the speed is next compared with that of cycles ago [rad], and that speed, NaN where
        it says nothing of what follows [rad/s].
    marks : ndarray of int
        At how many marks it was.
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
        # Steps that may miss more are compared with others only where they are longer.
        self.longer = LONGER if half else 1.0
        self.farthest_step = stepping.farthest * self.longer
        self.tolerance, self.over_angle = (coarser(share) if half else share for share in stepping[:2])
        self.done = np.zeros(count, bool)
        # A speed to be reached lies above or below the first.
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
        """How far it is to the end of the input's range, the way that some variants face."""
        (low, high), turned = self.bounds[:, who], self.state.turned[who]
        return np.where(self.facing[who] < 0.0, turned - low, high - turned)

    def arrive(self, who: np.ndarray) -> None:
        """End the runs of some variants at the end of the range that they face."""
        way = np.where(self.facing[who] < 0.0, -1, 1)
        self.state.turned[who] = np.where(way < 0, *self.bounds[:, who])
        self.arrived[who] = way * self.variants.direction[who].astype(int)
        self.done[who] = True
        if not (self.ends.arrival or self.ends.standing):
            early = np.isfinite(self.ends.speed[who]) | np.isfinite(self.ends.turned[who])
            self.verdict[who[early]] = Verdict.NO_END

    def energy(self) -> np.ndarray:
        """Kinetic energy now [J]."""
        return 0.5 * self.inertia(np.arange(self.variants.count), self.state.turned) * self.state.omega**2

    def inertia(self, who: np.ndarray, turned: np.ndarray) -> np.ndarray:
        """Reduced inertia of some variants where they have turned so far [kg·m²].

        Where it was asked for last it is known already: where one stretch ends another one begins.
        """
        last_who, last_turned, known = self._last_inertia
        if np.array_equal(who, last_who) and np.array_equal(turned, last_turned):
            return known
        part = self.variants.some(who)
        places = (self.start[who] + part.direction * turned)[None]
        found = self.dynamics.rows(part, places, self.state.time[who][None]).inertia[0]
        self._last_inertia = who, turned.copy(), found
        return found

    def see(self, who: np.ndarray, piece: Piece) -> None:
        """Let all observers look at a piece of the way of some variants."""
        for observer in self.observers:
            observer.see(who, piece)

    def see_begin(self) -> None:
        """Let all observers look at where the runs begin; what stands is about to move forward."""
        if self.observers:
            state, facing = self.state, np.where(self.facing < 0.0, -1.0, 1.0)
            every = np.arange(facing.size)
            # Where moments jump just there, what is behind the jump.
            turned = state.turned + facing * self.equation(every).beside(state.turned)
            now = [x[None].copy() for x in (state.time, turned, state.omega)]
            self.see(every, Piece(*now, facing, np.empty((0, facing.size)), np.full_like(now[0], np.nan)))

    def give_up(self, who: np.ndarray, verdict: Verdict) -> None:
        """End the runs of some variants with a verdict."""
        self.verdict[who], self.done[who] = verdict, True

    def begin_cycles(self, who: np.ndarray) -> None:
        """Count the cycles of some variants that haven't gone through one from where they are."""
        first = who[self.by_speed[who] & (self.mark[who] <= self.dynamics.cycle)]
        self.mark[first] = self.state.turned[first] + self.dynamics.cycle
        self.omega_at_mark[first] = self.state.omega[first]

    def at_mark(self, who: np.ndarray) -> np.ndarray:
        """Which of some variants are at their marks, by index."""
        return who[self.state.turned[who] >= self.mark[who] - AT_MARK * self.dynamics.cycle]

    def past_tables(self, who: np.ndarray) -> np.ndarray:
        """Where the last instant is over after which no table makes anything depend on time."""
        last = np.fmax.reduce(self.variants.instants[:, who], axis=0, initial=-np.inf)
        return self.clock[who] + self.state.time[who] > last

    def set_marks(self, who: np.ndarray) -> None:
        """Set the marks of some variants ahead of them, whole cycles on."""
        behind = np.floor((self.state.turned[who] - self.mark[who]) / self.dynamics.cycle + AT_MARK)
        self.mark[who] += np.maximum(behind + 1.0, 0.0) * self.dynamics.cycle

    def put(self, who: np.ndarray, state: State) -> None:
        """Take over the new state of some variants."""
        for mine, new in zip(self.state, state, strict=True):
            mine[..., who] = new
        self.slowest[who] = np.minimum(self.slowest[who], state.omega)
        self.fastest[who] = np.maximum(self.fastest[who], state.omega)
        self.covered[0, who] = np.fmin(self.covered[0, who], state.turned)
        self.covered[1, who] = np.fmax(self.covered[1, who], state.turned)

    def part(self, who: np.ndarray) -> State:
        """State of some variants."""
        return State(*(x[..., who] for x in self.state))

    def equation(self, who: np.ndarray) -> EquationOfMotion:
        """The equation of motion of some variants."""
        return EquationOfMotion(self.dynamics, self.variants.some(who), self.start[who])
