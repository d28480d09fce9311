"""Response to a change of load: the motion of governors and their engines.

Friction and stops hold the sleeve or let it go, a valve switches, and the engine's speed enters or leaves its band
where a guard changes what is held. A stop absorbs all of the sleeve's velocity. Steps also end at extremes of that
velocity, so that no reversal within one is missed. Where damping or self-regulation would keep explicit steps short,
the run continues with implicit ones. It is over once the engine has settled. Error estimates come from further runs
with longer steps, and with every second position of the curves if the engine is a mechanism.
"""

import math
from typing import NamedTuple

import numpy as np

from engine.elements.element import Element
from engine.elements.governors.equilibria import GovernorVariants, Marks
from engine.elements.governors.governor_forces import equilibrium_nodes, moving_inertia, numbers, rate_by
from engine.graph.derivatives import derivative
from engine.graph.nodes import Given, Graph, Number, Stage
from engine.laws.governors import motion
from engine.laws.kinematics.closure import greater
from engine.laws.senses import past
from engine.stepping.methods import EIGHT, NINE
from engine.stepping.recorded import made_steps
from engine.stepping.records import put, some
from engine.stepping.runs import WalkedRuns
from engine.stepping.system import RECORDED_AT, PrintedSystem, Start, System, Walks
from engine.stepping.walk import MOST_STEPS
from engine.stepping.walk_task import Why
from engine.words.verdicts import Verdict

# Step tolerance, as a fraction of the range and of SPEED_SCALE times the speed, since governors work within a few
# hundredths of it; largest angle of a step if the engine is a mechanism [rad].
TOLERANCE, SPEED_SCALE, FARTHEST_TURN = 1e-7, 0.01, 0.25 * math.pi
# Start of the last part of a run, in which the swing is measured, as a fraction of the run.
LAST_PART = 0.75
# Minimum number of steps of a recorded run.
LEAST_RECORDED = 500
# Number of equally spaced crank angles of the curves over a mechanism's cycle.
CYCLE_POSITIONS = 360
# Guards are offset by BEHIND of the range so that none vanishes at the start of a step. The sleeve's velocity counts as
# past its extreme once its rate has the other sign by TURNED of its reference. Friction over the sleeve's force is
# increased by SURELY, below the error of any step: a sleeve without friction rests in equilibrium, too.
BEHIND, TURNED, SURELY = 1e-15, 1e-4, 1e-12
# Start of an on-off valve's run, as a fraction of the travel from inner stop to switch. From the switch itself the
# swing would build up from nothing, at the rate of the rounding errors.
BELOW_SWITCH = 0.99
# Relative tolerance of event times in a step: the speed, exact to rounding, allows no smaller one.
ROOT = 1e-12


class Moving(NamedTuple):
    """States: angle and speed of the engine, position of the governor from its inner stop, and its rate."""

    turned: Given | np.ndarray
    speed: Given | np.ndarray
    position: Given | np.ndarray
    velocity: Given | np.ndarray


class GovernorMode(NamedTuple):
    """Numbers that guards change during a walk; arrays (variants,).

    Attributes
    ----------
    inside, crossed : node or ndarray
        +1 or −1: whether the speed is in its band; time at which it last entered or left the band [s].
    opens : node or ndarray
        +1 or −1: whether a valve is open.
    sense : node or ndarray
        +1 or −1 if the sleeve rises or falls, 0 if it rests.
    gains : node or ndarray
        +1 or −1: whether its velocity rises or falls; 0 if it rests.
    inner_hits, outer_hits : node or ndarray
        How often it has hit its stops.
    """

    inside: Given | np.ndarray
    crossed: Given | np.ndarray
    opens: Given | np.ndarray
    sense: Given | np.ndarray
    gains: Given | np.ndarray
    inner_hits: Given | np.ndarray
    outer_hits: Given | np.ndarray


def _governed_system(governor: Element, machine: bool) -> tuple[System, Graph, GovernorMode]:
    """Equations of motion of a governor and its engine, or `machine`, whose curves are in memory."""
    graph = Graph()
    states = Moving(*(graph.given(label, Stage.STATE) for label in Moving._fields))
    _, speed, position, velocity = states
    held = GovernorMode(*(graph.given(label, Stage.STATE) for label in GovernorMode._fields))
    clock = graph.given("time", Stage.STATE)
    keys = ("ball_mass", "sleeve_mass", "engine.ratio", "damping", "friction", "engine.self_regulation")
    ball, sleeve, ratio, damping, friction, regulation = numbers(graph, *keys)
    steady, rest, band, swift, width = numbers(graph, "steady", "rest", "band", "swift", "width")
    near, *stops = numbers(graph, "settled", "inner", "outer")
    x = stops[0] + position
    there, rates = equilibrium_nodes(governor, graph, x, stops, held.opens), governor.linkage(graph, x).rates(x)
    change, change_slope, share, other = graph.zero, graph.zero, graph.one, graph.zero
    if machine:
        at = numbers(graph, "curves", "positions", "cycle")
        change, change_slope, share, other = graph.apply(motion.curves_of_cycle, graph.memory, *at, graph.q)
    load, mean = numbers(graph, "engine.new_load", "mean speed")
    moment = there.driving * share - regulation * (speed - mean) - load + other - 0.5 * change_slope * speed * speed
    square, whirl_rate = ratio * ratio, 4.0 * ball * there.radius * rates.radius
    inertia = graph.number("engine.inertia") + change + square * there.balls
    rise = (moment - square * whirl_rate * velocity * speed) / inertia
    held_up = there.sleeve + damping * rates.sleeve * velocity + friction * held.sense
    pull = 0.5 * square * speed * speed * whirl_rate - rates.sleeve * held_up
    own = moving_inertia(ball, sleeve, rates)
    acceleration = (pull - 0.5 * rate_by(own, x) * velocity * velocity) / own
    place = position / width
    inner, outer = (graph.apply(motion.room_ahead, *room) for room in ((-held.sense, place), (held.sense, 1.0 - place)))
    ahead = held.sense * velocity + BEHIND * swift
    releasing = graph.apply(motion.releasing_speeds, place, there.speed / ratio, friction / there.sleeve + SURELY)
    margin = graph.apply(motion.holding_margin, held.sense, speed, *releasing)
    turning = held.gains * (width / swift) * acceleration + TURNED * swift
    in_band = held.inside * (band - abs(speed - steady)) + BEHIND * steady
    switches = [inner, outer, ahead, margin, turning, in_band]
    goes_on = graph.apply(motion.goes_on, inner, outer, ahead, margin)
    released = (1.0 - goes_on) * graph.apply(motion.released, speed, *releasing)
    changed = {
        velocity: goes_on * velocity,
        held.sense: goes_on * held.sense + released,
        held.gains: goes_on * graph.apply(past, turning, held.gains, -held.gains) + released,
        held.inner_hits: graph.apply(past, inner, held.inner_hits, held.inner_hits + 1.0),
        held.outer_hits: graph.apply(past, outer, held.outer_hits, held.outer_hits + 1.0),
        held.crossed: graph.apply(past, in_band, held.crossed, clock),
        held.inside: graph.apply(past, in_band, held.inside, -held.inside),
    }
    if governor.has_valve:
        switches.append(held.opens * (graph.number("engine.throttle.switch") - there.lift) + BEHIND * width)
        changed[held.opens] = graph.apply(past, switches[-1], held.opens, -held.opens)
    moves = held.sense * held.sense
    rises = rise, moves * acceleration
    slopes = [[derivative(each, {by: graph.one}) for by in (speed, velocity)] for each in rises]
    scales = SPEED_SCALE * steady, width, swift
    away = zip((speed - steady, position - rest, velocity), scales, strict=True)
    # Nearer to the equilibrium than the tolerance of a step, only the errors of steps move an engine. On a mechanism or
    # a valve it never runs steadily.
    settling = () if machine or governor.has_valve else (sum(abs(each) / scale for each, scale in away) - near,)
    system = System(
        along="time",
        states=states,
        rates=(speed, rise, moves * velocity, moves * acceleration),
        speed=speed,
        slope=rise,
        steepness=graph.apply(greater, *(abs(row[i]) for i, row in enumerate(slopes))),
        slopes=(*slopes[0], *slopes[1]),
        guards=(speed, *settling),
        switches=tuple(switches),
        clock=clock,
        held=changed,
        signed=True,
        scales=(graph.one, *scales),
    )
    return system, graph, held


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

    # Walks of up to MOST_STEPS steps; a run is abandoned if they cover less than this fraction of its duration.
    most_walks, of_its_time = 14, 1e-3

    def __init__(self, g: GovernorVariants, marks: Marks, cycle: np.ndarray, longer: float, records: bool) -> None:
        self.g, self.records, count = g, records, marks.inner.size
        super().__init__(count, TOLERANCE, longer)
        low, width, n, ratio = marks.inner, marks.outer - marks.inner, g.n, g.n["engine.ratio"]
        valve = g.governor.has_valve
        before = low + BELOW_SWITCH * (marks.before - low) if valve else marks.before
        begin, goal, half, outer = g.at(np.stack([before, marks.after, marks.middle, marks.outer])).each()
        self.duration, self.low = n["engine.duration"], low
        self.steady, band = goal.speed / ratio, n["engine.settling_band"] * goal.speed / ratio
        direction = 0.0 * low if valve else goal.speed - begin.speed
        self.upward = np.where(direction == 0.0, n["engine.load"] - n["engine.new_load"], direction) > 0.0
        speed, still = begin.speed / ratio, np.zeros(count)
        self.state = Moving(still.copy(), speed.copy(), before - low, still.copy())
        machine = cycle.size > 0
        system, graph, held = _governed_system(g.governor, machine)
        self.system = PrintedSystem(system, graph, graph.zero, graph.zero)
        swift = width * np.sqrt(half.sleeve / (half.mass * outer.lift))
        self.farthest = FARTHEST_TURN * self.longer if machine else math.inf
        self.implicit = np.zeros(count, bool)
        given = n | {
            "inner": low,
            "outer": marks.outer,
            "mean speed": marks.mean_speed / ratio,
            "steady": self.steady,
            "rest": marks.after - low,
            "settled": np.full(count, self.tolerance),
            "band": band,
            "swift": swift,
            "width": width,
        }
        if machine:
            given |= self._take_curves(cycle, graph, 2 if longer > 1.0 else 1)
        rows = self.system.functions.rows
        self.numbers = np.zeros((len(rows), count))
        for node, row in rows.items():
            if isinstance(node, Number):
                self.numbers[row] = node.compute(given)
        self.system.levels.fill(self.numbers)
        # Views of the rows that change during walks; the sleeve begins at rest.
        self.held = GovernorMode(*(self.numbers[rows[node]] if node in rows else np.empty(count) for node in held))
        self.held.inside[:] = np.where(np.abs(speed - self.steady) <= band, 1.0, -1.0)
        self.held.opens[:] = 1.0
        self.time, self.pace = still, 1e-3 * self.duration
        self.extremes, self.late = np.array([speed, speed]), np.array([np.inf + speed, -np.inf - speed])
        self.recorded: list[np.ndarray] = []

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
        (lowest, highest), (bottom, top), steady, held = self.extremes, self.late, self.steady, self.held
        beyond = np.where(self.upward, highest - steady, steady - lowest)
        settled, swing = np.where(held.inside > 0.0, held.crossed, np.nan), 0.5 * (top - bottom) / steady
        overshoot = np.maximum(beyond, 0.0) / steady
        return np.array([highest, lowest, overshoot, settled, swing, held.inner_hits, held.outer_hits])

    def instants(self) -> np.ndarray:
        """Recorded instants as in `Changes`."""
        if not self.recorded:
            return np.zeros((3, 0))
        time, position, speed = np.concatenate(self.recorded, axis=1)
        lift = self.g.some(np.zeros(time.size, int)).at(self.low[0] + position).lift
        return np.array([time, lift, speed])

    def advance(self, who: np.ndarray) -> None:
        """Walk to the last part of the runs or to their end, to the end of a walk, or to a steep part of the motion."""
        for implicit in (False, True):
            own = who[self.implicit[who] == implicit]
            if own.size:
                self._advance(own, NINE if implicit else EIGHT)

    def _advance(self, who: np.ndarray, method: int) -> None:
        """Walk by a method."""
        time, duration = self.time[who], self.duration[who]
        early = time < LAST_PART * duration
        mark = np.where(early, LAST_PART, 1.0) * duration
        longest = duration / LEAST_RECORDED if self.records else np.inf
        lanes = {"goal": mark - time, "tolerance": self.tolerance, "farthest": self.farthest, "longest": longest}
        lanes |= {"turned": self.state.turned[who], "pace": self.pace[who], "clock": time}
        task = self.system.task(math.inf, method, extremes=True, longer=self.longer, root=ROOT)
        state, numbers = np.array(some(self.state, who)), self.numbers.take(who, axis=1)
        gone = self.system.run(task, Start(numbers, lanes, state, recorded=MOST_STEPS if self.records else 0))
        if self.records:
            self._record(gone)
        why, speed = gone.why, self.state.speed[who]
        for seen, own in ((self.extremes, slice(None)), (self.late, ~early)):
            seen[0, who[own]] = np.min([seen[0, who[own]], gone.slowest[own], speed[own]], axis=0)
            seen[1, who[own]] = np.max([seen[1, who[own]], gone.fastest[own], speed[own]], axis=0)
        put(self.state, who, Moving(*gone.states))
        self.numbers[:, who], self.pace[who] = gone.numbers, gone.pace
        settled = why == Why.GUARD + 1
        self.time[who] = np.where(settled, duration, np.where(why == Why.GOAL, mark, time + gone.at))
        self.done[who] = settled | (why == Why.GOAL) & ~early
        if self.records and settled[0]:
            self.recorded.append(np.array([duration[:1], self.state.position[:1], self.state.speed[:1]]))
        self.late[:, who] = np.where(settled & early, gone.states[1], self.late[:, who])
        self.implicit[who] |= why == Why.STEEP
        self.give_up(who[why == Why.GUARD], Verdict.STALLS)
        self.give_up(who[why == Why.LOST], Verdict.NOT_FINITE)
        self.give_up(who[(why == Why.FULL) & (gone.at < self.of_its_time * duration)])

    def _record(self, gone: Walks) -> None:
        """Record the instants of the steps of the first variant."""
        if gone.steps[0] == 0.0:
            return
        _, at, length, samples, _ = made_steps(gone.recorded[..., :1], gone.steps[:1])
        seen = Moving(*samples[: len(Moving._fields)])
        time = self.time[0] + at + length * RECORDED_AT[:, None]
        self.recorded.append(np.array([row.T.ravel() for row in (time, seen.position, seen.speed)]))
