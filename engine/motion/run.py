"""A run: motion from a given state until an angle, a time, a speed, or rest.

While the machine moves briskly the energy form carries it over a grid of nodes; near rest, backwards, and where a
moment depends on time, the form in time does. Every variant goes its own way between the two. Ends are met exactly:
the last step is shortened until the wanted angle, time or speed is reached.
"""

from typing import NamedTuple

import numpy as np

from engine.motion.breaks import regula_falsi
from engine.motion.dynamics import Dynamics, Variants
from engine.motion.energy_form import ABOVE, ANGLE, BELOW, NEAR_REST, NODES, TIME, Course, Limits, Tables
from engine.motion.grid import JUMP
from engine.motion.stepping import advance
from engine.motion.time_form import State, TimeForm, state_at
from engine.verdicts import Verdict

# The energy form takes over where moments change the energy by less than twice this share per radian. It doesn't depend
# on the step: so near to rest that it would, 1/ω is a root of the angle, and no refinement of the grid helps.
BRISK = 2.0
# Steps in time before a run is given up: it neither ends nor gets going.
MOST_TIME_STEPS = 40_000
# Times that a machine at rest looks whether a moment over time sets it going.
WAITS = 1000
HALVINGS = 60
# Of the ends that a step in time may meet, the first and the last.
REST, BREAK = 0, 4


class Ends(NamedTuple):
    """Where runs end, (variants,): angle turned from the run's begin [rad], time [s], speed [rad/s]; inf for never.

    `rest` says whether the run ends at rest; `most_turned` [rad] is where it is given up.
    """

    turned: np.ndarray
    time: np.ndarray
    speed: np.ndarray
    rest: bool
    most_turned: np.ndarray


class Outcome(NamedTuple):
    """How runs went; arrays (variants,) unless said.

    Attributes
    ----------
    verdict : ndarray of uint8
    state : State
        At the end; angle and time counted from the begin of the run.
    slowest, fastest, peak : ndarray
        Least and greatest speed [rad/s], greatest moment of the motors by magnitude [N·m].
    started, ended : ndarray
        Kinetic energy at begin and end [J].
    history : ndarray (3, instants) or None
        Time [s], angle turned [rad] and speed [rad/s] of the only variant, where recorded.
    """

    verdict: np.ndarray
    state: State
    slowest: np.ndarray
    fastest: np.ndarray
    peak: np.ndarray
    started: np.ndarray
    ended: np.ndarray
    history: np.ndarray | None


class Run:
    """Runs of a set of variants with one set of actions.

    Parameters
    ----------
    dynamics : Dynamics
    variants : Variants
    start : ndarray (variants,)
        Crank angle at the begin [rad].
    omega : ndarray (variants,)
        Speed at the begin, in the direction of motion [rad/s].
    clock : ndarray (variants,)
        Time at the begin, for moments that depend on time [s].
    ends : Ends
    steps : int
        Steps a cycle.
    half : bool
        Whether to make half as many, for comparison.
    record : bool
        Whether to keep the history (of a single variant).
    """

    def __init__(
        self,
        dynamics: Dynamics,
        variants: Variants,
        start: np.ndarray,
        omega: np.ndarray,
        clock: np.ndarray,
        ends: Ends,
        steps: int,
        half: bool = False,
        record: bool = False,
    ) -> None:
        self.dynamics, self.variants, self.start, self.clock = dynamics, variants, start, clock
        self.ends, self.steps, self.half = ends, steps, half
        self.spacing = dynamics.cycle / (steps // 2 if half else steps)
        count, channels = variants.count, len(dynamics.channels)
        self.state = state_at(np.zeros(count), omega.astype(float), np.zeros(count), channels)
        self.verdict = np.full(count, Verdict.OK, np.uint8)
        self.slowest, self.fastest, self.peak = self.state.omega.copy(), self.state.omega.copy(), np.zeros(count)
        self.done = np.zeros(count, bool)
        # A speed to be reached lies above or below the first.
        self.above = np.where(ends.speed > omega, ends.speed, np.inf)
        self.below = np.where(ends.speed < omega, ends.speed, -np.inf)
        self.facing = np.sign(self.state.omega)
        self.done |= ends.speed == omega
        self.notes: list[np.ndarray] | None = [] if record else None
        self.breaks = variants.breaks

    def __call__(self) -> Outcome:
        """Run to the end."""
        started = self._energy()
        self._note(self.state.time, self.state.turned, self.state.omega)
        self._set_off(np.flatnonzero((self.facing == 0.0) & ~self.done))
        self._feel_motors(np.arange(self.variants.count))
        brisk = self._brisk(np.arange(self.variants.count))
        time_steps = np.zeros(self.variants.count, np.int64)
        while not self.done.all():
            fast = np.flatnonzero(brisk & ~self.done)
            if fast.size:
                self._in_angle(fast)
                brisk[fast] = False
            self._set_off(np.flatnonzero((self.facing == 0.0) & ~self.done))
            slow = np.flatnonzero(~brisk & ~self.done & (self.facing != 0.0))
            if slow.size:
                brisk[slow] = self._in_time(slow)
                time_steps[slow] += 1
                self._give_up(np.flatnonzero(~self.done & (time_steps > MOST_TIME_STEPS)), Verdict.NO_END)
        history = None if self.notes is None else np.concatenate(self.notes, axis=1)
        return Outcome(
            self.verdict,
            self.state,
            self.slowest,
            self.fastest,
            self.peak,
            started,
            self._energy(),
            history,
        )

    # Bookkeeping

    def _energy(self) -> np.ndarray:
        return 0.5 * self._inertia() * self.state.omega**2

    def _inertia(self) -> np.ndarray:
        places = (self.start + self.variants.direction * self.state.turned)[None]
        return self.dynamics.rows(self.variants, places, self.state.time[None]).inertia[0]

    def _note(self, time: np.ndarray, turned: np.ndarray, omega: np.ndarray) -> None:
        if self.notes is not None:
            self.notes.append(np.array([np.atleast_1d(x).ravel() for x in (time, turned, omega)]))

    def _give_up(self, who: np.ndarray, verdict: Verdict) -> None:
        self.verdict[who], self.done[who] = verdict, True

    def _put(self, who: np.ndarray, state: State) -> None:
        """Take over the new state of some variants."""
        for mine, new in zip(self.state, state, strict=True):
            mine[..., who] = new
        self.slowest[who] = np.minimum(self.slowest[who], state.omega)
        self.fastest[who] = np.maximum(self.fastest[who], state.omega)

    def _part(self, who: np.ndarray) -> State:
        return State(*(x[..., who] for x in self.state))

    # In time

    def _form(self, who: np.ndarray) -> TimeForm:
        return TimeForm(self.dynamics, self.variants.some(who), self.start[who])

    def _absolute(self, state: State, who: np.ndarray) -> State:
        return state._replace(time=state.time + self.clock[who])

    def _set_off(self, who: np.ndarray) -> None:
        """Choose the way for machines at rest; those that stay are at the end, or don't start."""
        if not who.size:
            return
        self.facing[who] = self._form(who).at_rest(self._absolute(self._part(who), who))
        stays = who[self.facing[who] == 0.0]
        begun = self.state.turned[stays] != 0.0
        if self.ends.rest:
            self.done[stays[begun]] = True
            stays = stays[~begun]
        # It stands until a moment over time changes, or until the time is over.
        now, instants = self.clock[stays] + self.state.time[stays], self.dynamics.instants
        last = instants[-1] if instants.size else -np.inf
        pause = (last - instants[0]) / WAITS if instants.size else 0.0
        later = np.where(now < last, np.maximum(np.minimum(now + pause, last), now), np.inf) - self.clock[stays]
        later = np.minimum(later, self.ends.time[stays])
        waits = np.isfinite(later)
        self.state.time[stays[waits]] = later[waits]
        self.done[stays[waits & (later >= self.ends.time[stays])]] = True
        if self.ends.rest:
            self.done[stays[~waits]] = True
        else:
            self._give_up(stays[~waits], Verdict.STALLS)

    def _feel_motors(self, who: np.ndarray) -> None:
        """Note the moment of the motors where they are now."""
        state, way = self._part(who), np.where(self.facing[who] < 0.0, -1.0, 1.0)
        moment = self._form(who).acceleration(state.turned, state.omega, state.time + self.clock[who], way)[2]
        self.peak[who] = np.maximum(self.peak[who], np.abs(moment))

    def _in_time(self, who: np.ndarray) -> np.ndarray:
        """One step in time; returns which variants now move briskly."""
        form, state, facing = self._form(who), self._absolute(self._part(who), who), self.facing[who]
        end = self.clock[who] + self.ends.time[who]
        h = np.minimum(form.proper_step(state, self.spacing, facing), self._next_instant(state.time, end) - state.time)
        goal = self._next_break(who, state.turned, facing)
        h, after = self._short_enough(form, state, h, facing, goal)
        lost = ~np.isfinite(after.omega)
        self._give_up(who[lost], Verdict.NOT_FINITE)
        over = self._overshoot(after, who, facing, goal)
        late, which = (over > 0.0).any(axis=0) & ~lost, np.full(who.size, -1)
        if late.any():
            sub = np.flatnonzero(late)
            shorter, which[sub] = self._first_end(form, state, h, facing, goal, who, over[:, sub], sub)
            after = _merged(after, form.step(state, _scattered(shorter, sub, h), facing, goal), late)
        kept = ~lost
        self._put(who[kept], State(*(x[..., kept] for x in after))._replace(time=(after.time - self.clock[who])[kept]))
        self._feel_motors(who[kept])
        self._note(self.state.time, self.state.turned, self.state.omega)
        self._after_step(who[kept], which[kept])
        return self._brisk(who)

    def _next_instant(self, time: np.ndarray, end: np.ndarray) -> np.ndarray:
        """The next time at which a moment over time jumps or bends, or the end."""
        instants = np.append(self.dynamics.instants, np.inf)
        return np.minimum(instants[np.searchsorted(instants, time * (1.0 + 1e-15), side="right")], end)

    @staticmethod
    def _short_enough(
        form: TimeForm, state: State, h: np.ndarray, facing: np.ndarray, goal: np.ndarray
    ) -> tuple[np.ndarray, State]:
        """A step that doesn't come back to rest where it sets off from rest: its length, and the state after it."""
        for _ in range(HALVINGS):
            after = form.step(state, h, facing, goal)
            back = (state.omega == 0.0) & (after.omega * facing <= 0.0)
            if not back.any():
                break
            h = np.where(back, 0.5 * h, h)
        return h, after

    def _next_break(self, who: np.ndarray, turned: np.ndarray, facing: np.ndarray) -> np.ndarray:
        """Angle turned at the next edge of a break of the moments: no step goes across one."""
        angles, cycle = self.breaks.angles[:, who], self.dynamics.cycle
        if not angles.size:
            return facing * np.inf
        here = self.start[who] + self.variants.direction[who] * turned
        ahead = np.mod(self.variants.direction[who] * facing * (angles - here), cycle)
        edges = np.concatenate((ahead - JUMP, ahead + JUMP, ahead - cycle + JUMP))
        edges = np.where(edges > 0.1 * JUMP, edges, np.inf)
        return turned + facing * np.nan_to_num(edges, nan=np.inf).min(axis=0)

    def _overshoot(self, state: State, who: np.ndarray, facing: np.ndarray, goal: np.ndarray) -> np.ndarray:
        """How far a state is beyond rest, the end angle, the speed above and below, and a break; (5, variants)."""
        return np.array(
            [
                -state.omega * facing,
                state.turned - self.ends.turned[who],
                state.omega - self.above[who],
                self.below[who] - state.omega,
                (state.turned - goal) * facing,
            ]
        )

    def _first_end(
        self,
        form: TimeForm,
        state: State,
        h: np.ndarray,
        facing: np.ndarray,
        goal: np.ndarray,
        who: np.ndarray,
        over: np.ndarray,
        sub: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Which end the variants `sub` meet first within the step, and the length of the step to there."""
        shortest, first = h[sub].copy(), np.full(sub.size, -1)
        for end in np.flatnonzero((over > 0.0).any(axis=1)):

            def excess(length: np.ndarray, end: int = end) -> np.ndarray:
                after = form.step(state, _scattered(length, sub, h), facing, goal)
                return self._overshoot(after, who, facing, goal)[end, sub]

            length = regula_falsi(excess, np.zeros(sub.size), h[sub])
            sooner = (over[end] > 0.0) & ((length < shortest) | (first < 0))
            shortest, first = np.where(sooner, length, shortest), np.where(sooner, end, first)
        return shortest, first

    def _after_step(self, who: np.ndarray, which: np.ndarray) -> None:
        """What follows from an end that was met: the run is over, or the machine turns round."""
        ended = self.state.time[who] >= self.ends.time[who] * (1.0 - 1e-15)
        self.done[who[ended | ((which > REST) & (which < BREAK))]] = True
        rest = who[which == REST]
        self.state.omega[rest] = 0.0
        # What rounding left of a speed.
        self.slowest[rest] = np.where(np.abs(self.slowest[rest]) < 1e-12 * self.fastest[rest], 0.0, self.slowest[rest])
        if self.ends.rest:
            self.done[rest] = True
        else:
            self.facing[rest] = 0.0
            self._set_off(rest)
        lost = who[~self.done[who] & (np.abs(self.state.turned[who]) >= self.ends.most_turned[who])]
        self._give_up(lost, Verdict.NO_END)

    def _brisk(self, who: np.ndarray) -> np.ndarray:
        """Which variants move forward with so much energy that it lasts for a radian, whatever acts on them."""
        if self.dynamics.timed:
            return np.zeros(who.size, bool)
        state, way = self._part(who), np.where(self.facing[who] < 0.0, -1.0, 1.0)
        rows, moments = self._form(who).at(state.turned, state.omega, state.time + self.clock[who], way)
        twice_energy = rows.inertia[0] * state.omega**2
        return (state.omega > 0.0) & (np.abs(moments.total[0]) < BRISK * twice_energy)

    # In angle

    def _in_angle(self, who: np.ndarray) -> None:
        """A stretch in the energy form, up to an end of the run or to where the machine slows down."""
        part, state = self.variants.some(who), self._part(who)
        begin = self.start[who] + part.direction * state.turned
        nodes, tables = self.dynamics.nested(part, begin, self.steps, self.half)
        goal = np.minimum(self.ends.turned[who], self.ends.most_turned[who]) - state.turned
        cycles = np.floor(goal / self.dynamics.cycle)
        whole = (nodes <= (goal - cycles * self.dynamics.cycle) * (1.0 + 1e-14)).sum(axis=0) - 1
        limits = Limits(
            (cycles * tables.steps.shape[0] + whole).astype(np.int64),
            self.ends.time[who] - state.time,
            self.above[who],
            np.maximum(self.below[who], 0.0),
        )
        energy = 0.5 * tables.inertia[0] * state.omega**2
        record = None
        if self.notes is not None:
            record = np.empty((2, min(int(limits.steps[0]) + 1, 2_000_000), 1))
        course = advance(self.dynamics, part, tables, energy, limits, record)
        made, per = course.made, tables.steps.shape[0]
        k = made % per
        turned = made // per * self.dynamics.cycle + nodes[k, np.arange(who.size)]
        inertia = tables.at(2 * k, np.arange(who.size)).inertia[0]
        omega = np.sqrt(2.0 * course.energy / inertia)
        if record is not None:
            self._note_nodes(record, int(made[0]), tables, nodes)
        self._take(who, state, turned, omega, course)
        self._finish(who, course.stop, tables.steps[k, np.arange(who.size)], goal - turned)

    def _note_nodes(self, record: np.ndarray, made: int, tables: Tables, nodes: np.ndarray) -> None:
        per = tables.steps.shape[0]
        index = np.arange(1, min(made + 1, record.shape[1]))
        omega = np.sqrt(2.0 * record[0, index, 0] / tables.inertia[NODES][index % per, 0])
        turned = index // per * self.dynamics.cycle + nodes[index % per, 0]
        self._note(record[1, index, 0] + self.state.time, turned + self.state.turned, omega)

    def _take(self, who: np.ndarray, state: State, turned: np.ndarray, omega: np.ndarray, course: Course) -> None:
        self._put(
            who,
            State(
                state.turned + turned,
                omega,
                state.time + course.time,
                state.works + course.works,
                state.squares + course.squares,
            ),
        )
        self.slowest[who] = np.minimum(self.slowest[who], course.slowest)
        self.fastest[who] = np.maximum(self.fastest[who], course.fastest)
        self.peak[who] = np.maximum(self.peak[who], course.peak)

    def _finish(self, who: np.ndarray, stop: np.ndarray, step: np.ndarray, rest: np.ndarray) -> None:
        """Go the last piece to the end of the run, part of a step, where there is one."""
        lost = (stop == ANGLE) & (self.ends.most_turned[who] < self.ends.turned[who])
        ending = np.isin(stop, (ANGLE, TIME, ABOVE, BELOW)) & ~lost
        sub = np.flatnonzero(ending)
        if sub.size:
            length = np.where(stop[sub] == ANGLE, np.maximum(rest[sub], 0.0), 0.0)
            searched = np.flatnonzero(stop[sub] != ANGLE)
            if searched.size:
                length[searched] = self._length_to_end(who[sub[searched]], stop[sub[searched]], step[sub[searched]])
            self._piece(who[sub], length, take=True)
            self.done[who[sub]] = True
        self._give_up(who[lost], Verdict.NO_END)
        # What is left slows down towards rest, and goes on in time.
        self.facing[who[stop == NEAR_REST]] = 1.0

    def _piece(self, who: np.ndarray, length: np.ndarray, take: bool = False) -> tuple[np.ndarray, np.ndarray]:
        """Time and speed after a single step of the given length [rad]."""
        part, state = self.variants.some(who), self._part(who)
        begin = self.start[who] + part.direction * state.turned
        places = begin + part.direction * length * np.array([[0.0], [0.5], [1.0]])
        rows = self.dynamics.rows(part, places)
        tables = Tables(length[None], rows.inertia, rows.loads, rows.powers)
        free = np.full(who.size, np.inf)
        limits = Limits(np.ones(who.size, np.int64), free, free, np.full(who.size, -1.0))
        course = advance(self.dynamics, part, tables, 0.5 * rows.inertia[0] * state.omega**2, limits)
        omega = np.sqrt(2.0 * course.energy / rows.inertia[2])
        if take:
            self._take(who, state, length, omega, course)
            self._note(self.state.time, self.state.turned, self.state.omega)
        return state.time + course.time, omega

    def _length_to_end(self, who: np.ndarray, stop: np.ndarray, step: np.ndarray) -> np.ndarray:
        """How far [rad] it is to the wanted time or speed, less than a step."""

        def excess(length: np.ndarray) -> np.ndarray:
            time, omega = self._piece(who, length)
            above, below = omega - self.above[who], self.below[who] - omega
            return np.where(stop == TIME, time - self.ends.time[who], np.where(stop == ABOVE, above, below))

        return regula_falsi(excess, np.zeros(who.size), step)


def _scattered(values: np.ndarray, places: np.ndarray, base: np.ndarray) -> np.ndarray:
    whole = base.copy()
    whole[places] = values
    return whole


def _merged(one: State, other: State, take_other: np.ndarray) -> State:
    return State(*(np.where(take_other, b, a) for a, b in zip(one, other, strict=True)))
