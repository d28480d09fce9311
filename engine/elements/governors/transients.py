"""Response to a change of load: the motion of governors and their engines.

A walk along time ends where friction stops or releases the sleeve, and at the stops, which absorb all of its velocity.
A step also ends, without ending the walk, where a valve switches, where the engine speed enters or leaves its band,
where a sleeve without friction reverses, so that no contact with a stop is missed, and at extremes of the velocity of
one with friction, so that no reversal is missed. Error estimates come from a second run with longer steps, and with
every second position of the curves if the engine is a mechanism.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.elements.element import Element
from engine.elements.governors.equilibria import GovernorVariants, Marks
from engine.elements.governors.governed_engine import TableThrottle
from engine.elements.governors.governor_nodes import by_table, numbers
from engine.graph.nodes import Given, Graph, Number, Stage
from engine.laws.governors import motion
from engine.laws.governors.equilibrium import moving_inertia, speed_with_friction
from engine.laws.senses import past
from engine.stepping.recorded import RECORDED, made_steps
from engine.stepping.records import put, some
from engine.stepping.runs import WalkedRuns
from engine.stepping.system import SHOWN, Guard, PrintedSystem, System, Walks
from engine.stepping.walk_task import Why
from engine.words.verdicts import Verdict

# Step tolerance, as a fraction of the range and of SPEED_SCALE times the speed, since governors work within a few
# hundredths of it; largest angle of a step if the engine is a mechanism [rad].
TOLERANCE, SPEED_SCALE, FARTHEST_TURN = 1e-7, 0.01, 0.25 * math.pi
# Number of steps after which a run is given up.
MOST_STEPS = 100_000
# Start of the last part of a run, in which the swing is measured, as a fraction of the run.
LAST_PART = 0.75
# Maximum number of steps recorded per walk, and minimum number of steps of a recorded run.
LEAST_RECORDED = 500
# Number of equally spaced crank angles of the curves over a mechanism's cycle.
CYCLE_POSITIONS = 360
# Guards are offset by BEHIND of the range so that none vanishes at the start of a step; what turns has turned at TURNED
# of its reference.
BEHIND, TURNED = 1e-15, 1e-4
# Start of an on-off valve's run, as a fraction of the way from the inner stop to its switch. From the switch itself the
# swing would build up from nothing, at the rate of the rounding errors.
BELOW_SWITCH = 0.99
# Relative tolerance of event times in a step: the speed, exact to rounding, allows no smaller one.
ROOT = 1e-12
ENDINGS = ("stalls", "inner", "outer", "reverses", "rises", "falls")
STALLS, INNER, OUTER, REVERSES, RISES, FALLS = (Why.GUARD + i for i in range(len(ENDINGS)))


class Moving(NamedTuple):
    """States: angle and speed of the engine, rate of the governor's position, and that position from its origin."""

    turned: Given | np.ndarray
    speed: Given | np.ndarray
    velocity: Given | np.ndarray
    position: Given | np.ndarray


class SleeveMode(NamedTuple):
    """Numbers that are constant during a walk.

    Attributes
    ----------
    moves : node or ndarray
        1 if the sleeve moves, 0 if it rests.
    sense : node or ndarray
        +1 or −1 if friction opposes a rising or falling sleeve, else 0.
    low, high : node or ndarray
        Positions of the stops; infinite for a resting sleeve.
    rises, falls : node or ndarray
        Engine speeds at which a resting sleeve starts to rise or fall [rad/s]; infinite otherwise.
    """

    moves: Given | np.ndarray
    sense: Given | np.ndarray
    low: Given | np.ndarray
    high: Given | np.ndarray
    rises: Given | np.ndarray
    falls: Given | np.ndarray


class Flipped(NamedTuple):
    """Numbers that guards change during a walk, or their rows.

    Attributes
    ----------
    inside, crossed : node or int
        +1 or −1: whether the speed is in its band; time in the walk at which it last entered or left the band [s].
    opens : node or int
        +1 or −1: whether a valve is open.
    rising : node or int
        +1 or −1: whether a sleeve without friction rises, or the velocity of one with friction.
    """

    inside: Given | int
    crossed: Given | int
    opens: Given | int
    rising: Given | int


def governed_system(governor: Element, machine: bool) -> tuple[System, Graph, SleeveMode, Flipped]:
    """Equations of motion of a governor and its engine, from `engine.laws.governors.motion`.

    Parameters
    ----------
    governor : Governor
    machine : bool
        Whether the engine is a mechanism, whose curves are in memory.
    """
    graph = Graph()
    states = Moving(*(graph.given(label, Stage.STATE) for label in Moving._fields))
    _, speed, velocity, position = states
    held = SleeveMode(*(graph.given(label, Stage.VARIANT) for label in SleeveMode._fields))
    flipped = Flipped(*(graph.given(label, Stage.STATE) for label in Flipped._fields))
    keys = ("ball_mass", "sleeve_mass", "engine.ratio", "damping", "friction", "engine.self_regulation")
    ball, sleeve, ratio, damping, friction, regulation = numbers(graph, *keys)
    x = graph.number("origin") + position
    link = governor.linkage(graph, x)
    lift, square = link.height - graph.number("zero"), ratio * ratio
    slope, _, _ = governor.held(graph, x, link, lift)
    change, change_slope, share, other = graph.zero, graph.zero, graph.one, graph.zero
    if machine:
        at = numbers(graph, "curves", "positions", "cycle")
        change, change_slope, share, other = graph.apply(motion.curves_of_cycle, graph.memory, *at, graph.q)
    driving = graph.number("moment") - graph.number("fall") * lift
    if isinstance(governor.engine.throttle, TableThrottle):
        driving, _ = by_table(graph, governor.engine.throttle.table, lift)
    elif governor.has_valve:
        full, closed = numbers(graph, "engine.throttle.full", "engine.throttle.closed")
        driving = 0.5 * (full + closed) + 0.5 * (full - closed) * flipped.opens
    load, mean = numbers(graph, "engine.new_load", "mean speed")
    moment = driving * share - regulation * (speed - mean) - load + other - 0.5 * change_slope * speed * speed
    whirl_rate = 4.0 * ball * link.radius * link.radius_rate
    inertia = graph.number("engine.inertia") + change + square * (2.0 * ball * link.radius * link.radius)
    rise = graph.apply(motion.engine_acceleration, moment, inertia, square * whirl_rate, velocity, speed)
    hindered = link.lift_rate * (damping * link.lift_rate * velocity + friction * held.sense)
    pull = 0.5 * square * speed * speed * whirl_rate - slope - hindered
    own = graph.apply(moving_inertia, ball, sleeve, link.radius_rate, link.rise, link.lift_rate)
    rates = (link.radius_rate, link.radius_rate_rate, link.rise, link.rise_rate, link.lift_rate, link.lift_rate_rate)
    own_rate = graph.apply(motion.moving_inertia_rate, ball, sleeve, *rates)
    acceleration = graph.apply(motion.governor_acceleration, pull, own, own_rate, velocity)
    steady, band, swift = numbers(graph, "steady", "band", "swift")
    ends = {
        "stalls": speed,
        "inner": position - held.low,
        "outer": held.high - position,
        "reverses": held.sense * velocity + BEHIND * swift,
        "rises": held.rises - speed,
        "falls": speed - held.falls,
    }
    clock = graph.given("time", Stage.STATE)
    # Within a step the velocity of a sleeve with friction, or the position of one without, has one root at most.
    rubs = held.sense * held.sense
    turning = (1.0 - rubs) * velocity + rubs * (graph.number("width") / swift) * acceleration
    turns = flipped.rising * turning + TURNED * swift
    in_band = flipped.inside * (band - abs(speed - steady)) + BEHIND * steady
    guards = [
        *(Guard(name, ends[name]) for name in ENDINGS),
        Guard("band", in_band, False),
        Guard("turns", turns, False),
    ]
    changed = {
        flipped.crossed: graph.apply(past, in_band, flipped.crossed, clock),
        flipped.inside: graph.apply(past, in_band, flipped.inside, -flipped.inside),
        flipped.rising: graph.apply(past, turns, flipped.rising, -flipped.rising),
    }
    if governor.has_valve:
        below = flipped.opens * (graph.number("engine.throttle.switch") - lift) + BEHIND * graph.number("width")
        guards.append(Guard("switches", below, False))
        changed[flipped.opens] = graph.apply(past, below, flipped.opens, -flipped.opens)
    system = System(
        along="time",
        states=states,
        rates=(speed, rise, held.moves * acceleration, held.moves * velocity),
        speed=speed,
        slope=rise,
        guards=tuple(guards),
        clock=clock,
        held=changed,
        scales=(graph.one, SPEED_SCALE * steady, swift, graph.number("width")),
    )
    return system, graph, held, flipped


class Changes(NamedTuple):
    """Results of changes of load.

    Attributes
    ----------
    answers : ndarray (answers, variants)
        Maximum and minimum speed [rad/s]; relative overshoot beyond the new steady speed; time after which the speed
        stays in the band [s], NaN if never; half of its relative swing in the last part; how often the sleeve hits its
        inner and its outer stop.
    verdict : ndarray (variants,)
        OK; STALLS if the engine stops; NO_END after too many steps; NOT_FINITE.
    instants : ndarray (3, instants)
        Of the first variant if runs are recorded: time [s], lift [m], speed [rad/s].
    """

    answers: np.ndarray
    verdict: np.ndarray
    instants: np.ndarray


def follow_changes(
    g: GovernorVariants, marks: Marks, verdict: np.ndarray, cycle: np.ndarray, longer: float, records: bool = False
) -> Changes:
    """Simulate engines and their governors after a change of load.

    Parameters
    ----------
    g : GovernorVariants
    marks : Marks
    verdict : ndarray (variants,)
        Only variants with OK are simulated.
    cycle : ndarray (numbers, variants)
        Curves of mechanisms one after another, and lengths of their cycles; without rows for other engines.
    longer : float
        One of `WALKS`.
    records : bool
        Whether instants are recorded.
    """
    found = np.full((7, verdict.size), np.nan)
    verdict, who = verdict.copy(), np.flatnonzero(verdict == Verdict.OK)
    if not who.size:
        return Changes(found, verdict, np.zeros((3, 0)))
    runs = _Runs(g.some(who), some(marks, who), cycle[:, who], longer, records)
    runs.go_to_end()
    with np.errstate(all="ignore"):
        found[:, who], verdict[who] = runs.answers(), runs.verdict
        return Changes(found, verdict, runs.instants())


class _Runs(WalkedRuns):
    """Runs of a number of variants, in progress; rows (variants,)."""

    def __init__(self, g: GovernorVariants, marks: Marks, cycle: np.ndarray, longer: float, records: bool) -> None:
        self.g, self.marks, self.records, count = g, marks, records, marks.inner.size
        super().__init__(count, TOLERANCE, longer)
        low, high, n, ratio = marks.inner, marks.outer, g.n, g.n["engine.ratio"]
        valve = g.governor.has_valve
        before = low + BELOW_SWITCH * (marks.before - low) if valve else marks.before
        begin, goal, half, inner, outer = g.at(np.stack([before, marks.after, marks.middle, low, high]), low).each()
        self.duration, self.width = n["engine.duration"], high - low
        self.steady, self.band = goal.speed / ratio, n["engine.settling_band"] * goal.speed / ratio
        direction = 0.0 * low if valve else goal.speed - begin.speed
        self.upward = np.where(direction == 0.0, n["engine.load"] - n["engine.new_load"], direction) > 0.0
        # With this origin all states except the rate of the position are positive.
        self.origin = low - self.width
        position = before - self.origin
        speed = begin.speed / ratio
        self.state = Moving(np.zeros(count), speed.copy(), np.zeros(count), position)
        swift = self.width * np.sqrt(half.sleeve / (half.mass * outer.lift))
        given = n | {
            "origin": self.origin,
            "zero": inner.height,
            "mean speed": marks.mean_speed / ratio,
            "steady": self.steady,
            "band": self.band,
            "swift": swift,
            "width": self.width,
        }
        given["moment"], given["fall"] = g.throttle(0.0 * low, outer.lift)
        machine = cycle.size > 0
        system, graph, held, flipped = governed_system(g.governor, machine)
        self.system = PrintedSystem(system, graph, graph.zero, graph.zero)
        self.farthest = FARTHEST_TURN * self.longer if machine else math.inf
        if machine:
            given |= self._take_curves(cycle, graph, 2 if longer > 1.0 else 1)
        rows = self.system.functions.rows
        self.numbers = np.zeros((len(rows), count))
        for node, row in rows.items():
            if isinstance(node, Number):
                self.numbers[row] = node.compute(given)
        self.system.levels.fill(self.numbers)
        # Views of rows that change between walks, and numbers of rows that change during them.
        self.held = SleeveMode(*(self.numbers[rows[node]] for node in held))
        self.flipped = Flipped(*(rows.get(node, -1) for node in flipped))
        inside = np.abs(speed - self.steady) <= self.band
        self.numbers[self.flipped.inside] = np.where(inside, 1.0, -1.0)
        if valve:
            self.numbers[self.flipped.opens] = 1.0
        self.time, self.pace, self.steps = np.zeros(count), 1e-3 * self.duration, np.zeros(count)
        self.settled = np.where(inside, 0.0, np.nan)
        self.extremes, self.late = np.array([speed, speed]), np.array([np.inf + speed, -np.inf - speed])
        self.hits = np.zeros((2, count))
        self.recorded: list[np.ndarray] = []
        at_stop = (before <= low) | (before >= high)
        rests = (n["friction"] > 0.0) | at_stop
        for way, moves in ((1.0, self.upward), (-1.0, ~self.upward)):
            self._move(np.flatnonzero(~rests & moves), way)
        self._rest(np.flatnonzero(rests))

    def _take_curves(self, cycle: np.ndarray, graph: Graph, stride: int) -> dict[str, np.ndarray]:
        """Load every `stride`-th position of mechanisms' curves into memory; return the numbers that locate them."""
        *curves, length = cycle
        rows, first = np.array(curves).reshape(motion.CURVES, CYCLE_POSITIONS, -1)[:, ::stride], graph.all_tables
        positions = rows.shape[1]
        around = np.arange(-motion.BEFORE, positions + motion.NEIGHBOURS - motion.BEFORE) % positions
        table = rows[:, around].transpose(2, 1, 0)
        self.system.functions = self.system.functions._replace(memory=np.concatenate([first, table.ravel()]))
        begin = first.size + table[0].size * np.arange(length.size)
        return {"curves": begin, "positions": np.full(length.size, float(positions)), "cycle": length}

    def answers(self) -> np.ndarray:
        """Rows of results as in `Changes`."""
        (lowest, highest), (bottom, top), steady = self.extremes, self.late, self.steady
        beyond = np.where(self.upward, highest - steady, steady - lowest)
        swing = 0.5 * (top - bottom) / steady
        return np.array([highest, lowest, np.maximum(beyond, 0.0) / steady, self.settled, swing, *self.hits])

    def instants(self) -> np.ndarray:
        """Recorded instants as in `Changes`."""
        if not self.recorded:
            return np.zeros((3, 0))
        time, position, speed = np.concatenate(self.recorded, axis=1)
        one = np.zeros(time.size, int)
        lift = self.g.some(one).at(self.origin[0] + position, self.marks.inner[one]).lift
        return np.array([time, lift, speed])

    def _rest(self, who: np.ndarray) -> None:
        """Stop the sleeve in some variants, or restart it where friction doesn't hold it."""
        if not who.size:
            return
        g, position, speed = self.g.some(who), self.state.position[who], self.state.speed[who]
        there = g.at(self.origin[who] + position, self.marks.inner[who])
        friction, own = g.n["friction"], there.speed / g.n["engine.ratio"]
        share = np.minimum(friction / there.sleeve, 1.0)
        self.state.velocity[who] = self.held.moves[who] = self.held.sense[who] = 0.0
        self.held.low[who], self.held.high[who] = -np.inf, np.inf
        rises = np.where(position < 2.0 * self.width[who], speed_with_friction(own, share, 1.0), np.inf)
        falls = np.where(position > self.width[who], speed_with_friction(own, -share, 1.0), -np.inf)
        self.held.rises[who], self.held.falls[who] = rises * (1.0 + BEHIND), falls * (1.0 - BEHIND)
        self._move(who[speed > rises], 1.0)
        self._move(who[speed < falls], -1.0)

    def _move(self, who: np.ndarray, sense: float) -> None:
        """Set the sleeve in motion."""
        held, friction, width = self.held, self.g.n["friction"][who], self.width[who]
        held.moves[who], held.rises[who], held.falls[who] = 1.0, np.inf, -np.inf
        held.low[who], held.high[who] = width * (1.0 - BEHIND), width * (2.0 + BEHIND)
        held.sense[who] = np.where(friction > 0.0, sense, 0.0)
        self.numbers[self.flipped.rising, who] = sense

    def _walk(self, who: np.ndarray, mark: np.ndarray) -> Walks:
        """Walk up to a time, or to an earlier change."""
        numbers, crossed = self.numbers.take(who, axis=1), self.flipped.crossed
        numbers[crossed] = np.nan
        longest = self.duration[who] / LEAST_RECORDED if self.records else np.inf
        lanes = {"goal": mark - self.time[who], "tolerance": self.tolerance, "farthest": self.farthest}
        lanes |= {"longest": longest, "turned": self.state.turned[who], "pace": self.pace[who]}
        task = self.system.task(math.inf, extremes=True, longer=self.longer, root=ROOT)
        state, most = np.array(some(self.state, who)), RECORDED if self.records else 0
        gone = self.system.run(task, numbers, None, None, lanes, state, recorded=most)
        self.numbers[:, who] = numbers = gone.numbers
        settled = np.where(numbers[self.flipped.inside] > 0.0, self.time[who] + numbers[crossed], np.nan)
        self.settled[who] = np.where(np.isnan(numbers[crossed]), self.settled[who], settled)
        return gone

    def advance(self, who: np.ndarray) -> None:
        """Walk until something changes, and handle the change."""
        early = self.time[who] < LAST_PART * self.duration[who]
        mark = np.where(early, LAST_PART, 1.0) * self.duration[who]
        gone = self._walk(who, mark)
        if self.records:
            self._record(gone)
        why, before, speed = gone.why, self.time[who], self.state.speed[who]
        lowest, highest = np.minimum(gone.slowest, speed), np.maximum(gone.fastest, speed)
        put(self.state, who, Moving(*gone.states))
        self.time[who] = np.where(why == Why.GOAL, mark, before + gone.at)
        self.pace[who] = gone.pace
        self.steps[who] += gone.steps
        for seen, own in ((self.extremes, slice(None)), (self.late, ~early)):
            seen[0, who[own]] = np.minimum(seen[0, who[own]], lowest[own])
            seen[1, who[own]] = np.maximum(seen[1, who[own]], highest[own])
        self.done[who] = (why == Why.GOAL) & ~early
        for ending, verdict in ((STALLS, Verdict.STALLS), (Why.LOST, Verdict.NOT_FINITE)):
            self.give_up(who[why == ending], verdict)
        self.give_up(who[self.steps[who] >= MOST_STEPS])
        self._after(who, why)

    def _after(self, who: np.ndarray, why: np.ndarray) -> None:
        """Handle the events that ended walks."""

        def met(ending: int) -> np.ndarray:
            return who[why == ending]

        for stop, (ending, share) in enumerate(((INNER, 1.0), (OUTER, 2.0))):
            at_stop = met(ending)
            self.hits[stop, at_stop] += 1.0
            self.state.position[at_stop] = share * self.width[at_stop]
        self._move(met(RISES), 1.0)
        self._move(met(FALLS), -1.0)
        self._rest(who[np.isin(why, (INNER, OUTER, REVERSES))])

    def _record(self, gone: Walks) -> None:
        """Record the instants of the steps of the first variant."""
        if gone.steps[0] == 0.0:
            return
        _, at, length, samples = made_steps(gone.recorded[..., :1], gone.steps[:1])
        seen = Moving(*samples[: len(Moving._fields)])
        time = self.time[0] + at + length * SHOWN[:, None]
        self.recorded.append(np.array([row.T.ravel() for row in (time, seen.position, seen.speed)]))
