"""Runs at two speeds: from a given state to an angle, a time, a speed, rest, or the lock-up of the clutch.

A walk along time lasts as long as the joining of the sides doesn't change. It ends where a clutch stops slipping or
breaks loose, where a side stops or starts, where a time-dependent quantity changes, and at the end of the run.
"""

from collections.abc import Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from engine.motion.coupled.coupled_fields import CoupledMotion
from engine.motion.coupled.sides_at import SidesAt
from engine.motion.coupled.two_sides import APART, BACKWARDS, FORWARDS, TOGETHER, CoupledSides, Joined, faced_directions
from engine.motion.coupled.two_speeds import CRANK_SPEED, SHAFT_SPEED, SHAFT_TURNED, TURNED, Ending
from engine.motion.fields.recorded_motion import Observer
from engine.motion.moments.breaks import JUMP
from engine.motion.runs.run_progress import NEARLY, CoupledStanding, Ends, MachineRuns, Standing, Stepping
from engine.stepping.methods import EIGHT, NINE
from engine.stepping.recorded import EXCEEDS, RECORDED, made_steps, tops_in_steps, weighted, weights_at
from engine.stepping.records import on_arrays, put, some
from engine.stepping.system import RECORDED_AT, Start, Walks
from engine.stepping.walk_task import Why
from engine.words.verdicts import Verdict

# Fractions of a step at which a slip is sought, and the weights of the recorded samples there.
LOOKS = np.arange(1, 16)[:, None] / 16
AT_LOOKS = weights_at(LOOKS)
# Relative change of the speeds in each cycle that counts as none; fraction of the maximum speed that counts as rest
# where nothing stops a machine.
SETTLED, FADED = 1e-8, 1e-9
# A peak counts as later only if it is higher by more than this fraction.
SAME_PEAK = 1e-12
# Speeds between those of the crank and of the shaft, as fractions of their difference: a crank and a shaft that start
# there and part from each other over a cycle keep the real ones apart for ever.
BETWEEN = (0.3, 0.7), (0.1, 0.2), (0.8, 0.9), (0.45, 0.55)
# Speeds of the motion itself and of slower ones, as fractions of the present speed.
NOT_FASTER = 1.0, 0.5, 0.1
# Steps of a standing machine to the next change.
WAITS = 4


class Seen(NamedTuple):
    """Recorded steps of a walk.

    Attributes
    ----------
    column : ndarray of int (steps,)
        The variant of each step, among those that walk.
    begin, length : ndarray (steps,)
        From the start of the walk [s].
    here : SidesAt
        States of both sides at the fractions RECORDED_AT, (RECORDED_AT, steps).
    moment : ndarray (RECORDED_AT, steps)
        Torque of the coupling on the crank [N·m]; 0 where nothing depends on it.
    """

    column: np.ndarray
    begin: np.ndarray
    length: np.ndarray
    here: SidesAt
    moment: np.ndarray


class RunMark(NamedTuple):
    """What a run without an end is compared with after some cycles, (variants,) unless stated.

    Attributes
    ----------
    speeds : ndarray (2, variants)
        Of the crank and the shaft [rad/s].
    turned, shaft_turned : ndarray
        Angles turned [rad].
    moves : ndarray
        1 if the crank moves, else 0.
    mode : ndarray
        As in `Joined`.
    time, slip_time : ndarray
        From the start of the run, and that of slip so far [s].
    """

    speeds: np.ndarray
    turned: np.ndarray
    shaft_turned: np.ndarray
    moves: np.ndarray
    mode: np.ndarray
    time: np.ndarray
    slip_time: np.ndarray


class CoupledRuns(MachineRuns):
    """Runs at two speeds in progress.

    Parameters
    ----------
    sides : CoupledSides
    standing : Standing
        Initial state, with that of the shaft.
    ends : Ends
    stepping : Stepping
    observers : sequence of Observer
        Each receives the `CoupledMotion` of every walk.

    Attributes
    ----------
    state : ndarray (rows, variants)
        Current angle and speed of the crank and of the shaft, in the direction of motion, angles from the start of the
        run; then the integrals.
    joined : Joined
    lows, highs : ndarray (2, variants)
        Minimum and maximum speeds of the crank and of the shaft [rad/s].
    peak, peak_at : ndarray
        Peak magnitude of the coupling torque [N·m], and its time [s].
    stops, closings : ndarray
        How often the crank came to rest, and how often a backlash closed.
    growing : ndarray
        +1 or −1: whether the torque of a shaft with backlash (its twist, if out of contact) rises or falls. Steps end
        at its extremes, so that none passes over a short contact.
    slip_time : ndarray
        Total time of slip of a clutch [s].
    lock_time, lock_speed : ndarray
        Time of the last lock-up and speed of the crank then; NaN without one.
    """

    def __init__(
        self,
        sides: CoupledSides,
        standing: Standing,
        ends: Ends,
        stepping: Stepping,
        observers: Sequence[Observer],
    ) -> None:
        super().__init__(sides.crank, standing, ends, stepping, observers)
        self.sides, self.cycle, count = sides, self.dynamics.cycle, sides.count
        self.state, self.time, zero = np.zeros((len(sides.two.system.rates), count)), np.zeros(count), np.zeros(count)
        self.turned, self.omega, self.shaft_omega = (self.state[row] for row in (TURNED, CRANK_SPEED, SHAFT_SPEED))
        self.omega[:], self.shaft_omega[:] = standing.omega, standing.coupled.speed
        clock, engaged = standing.clock, standing.coupled.engaged
        self.joined = Joined(np.zeros(count, int), zero.copy(), zero.copy(), clock, engaged, np.ones(count))
        self.lows, self.highs = (np.array([self.omega, self.shaft_omega]) for _ in range(2))
        self.slowest, self.fastest = self.lows[0], self.highs[0]
        self.peak, self.peak_at, self.slip_time = np.zeros(count), np.zeros(count), np.zeros(count)
        self.stops, self.closings = np.zeros(count), np.zeros(count)
        self.growing = np.full(count, np.nan)
        self.lock_time, self.lock_speed = np.full(count, np.nan), np.full(count, np.nan)
        self.unsettled, self.implicit = np.ones(count, bool), np.zeros(count, bool)
        self.marks = RunMark(np.full((2, count), np.nan), *np.full((len(RunMark._fields) - 1, count), np.nan))

    def energies(self) -> tuple[np.ndarray, np.ndarray]:
        """Current kinetic energy of the shaft, and of both sides [J]."""
        shaft = 0.5 * self.sides.shaft.inertia * self.shaft_omega**2
        return shaft, self.energy() + shaft

    def endless(self, who: np.ndarray) -> np.ndarray:
        """Verdicts on runs that never end: with the clutch slipping, with the crank standing, or in motion."""
        slips, stands = np.abs(self.joined.mode[who]) == FORWARDS, self.joined.crank_direction[who] == 0.0
        return np.where(slips, Verdict.SLIPS, np.where(stands, Verdict.STALLS, Verdict.NO_END))

    def last_change(self, who: np.ndarray) -> np.ndarray:
        """Clock time of the last change of a torque over time, or of a clutch's capacity [s]."""
        return np.fmax(super().last_change(who), self.clock[who] + self._knots(who).max(axis=0, initial=-np.inf))

    def _knots(self, who: np.ndarray) -> np.ndarray:
        """Times from the start of the run between which a clutch's capacity is linear [s]."""
        knots = self.sides.coupling.times[:, who] - self.joined.engaged[who]
        return knots[:0] if self.sides.two.open else knots

    def _fades(self, who: np.ndarray) -> np.ndarray:
        """Whether the crank slows down without ever stopping, since all torques vanish with the speed."""
        return self.never_changes(who) & self.dynamics.fades

    def advance(self, live: np.ndarray) -> None:
        """Walk until something changes, and handle the change."""
        self._settle(live[self.unsettled[live]])
        live = live[~self.done[live]]
        for implicit in (False, True):
            own = live[self.implicit[live] == implicit]
            if own.size:
                self._advance(own, NINE if implicit else EIGHT)

    # Joining of the sides

    def _settle(self, who: np.ndarray) -> None:
        """Decide the joining of the sides of some variants, and the direction of each side."""
        if not who.size:
            return
        self.unsettled[who] = self.implicit[who] = False
        here = self._here(who)
        # At a jump, evaluate just after it.
        here.moving[TURNED] += np.sign(here.moving[CRANK_SPEED]) * here.sides.crank.break_offset(here.moving[TURNED])
        mode, *directions = here.joining()
        self.joined.mode[who], self.joined.crank_direction[who], self.joined.shaft_direction[who] = mode, *directions
        holds = mode == TOGETHER
        locks = who[holds & (directions[0] != 0.0) & np.isnan(self.lock_time[who])]
        self.lock_time[locks], self.lock_speed[locks] = self.time[locks], self.state[CRANK_SPEED, locks]
        slips = who[np.abs(mode) == FORWARDS]
        self.lock_time[slips] = self.lock_speed[slips] = np.nan
        self.done[who[holds & (directions[0] != 0.0)]] |= self.ends.lock_up
        stands = who[directions[0] == 0.0]
        begun = self.state[TURNED, stands] != 0.0
        self.done[stands] |= self.ends.standing & begun
        # Both stay at rest until a time-dependent torque or the clutch changes, or until the run's time is over.
        both = who[(directions[0] == 0.0) & (directions[1] == 0.0)]
        both = both[~self.done[both]]
        for_ever = both[~np.isfinite(self._longest(both))]
        self.done[for_ever] = True
        self.verdict[for_ever] = Verdict.OK if self.ends.standing else Verdict.STALLS

    def _here(self, who: np.ndarray) -> SidesAt:
        """Some variants in their current states."""
        return SidesAt(self.sides.some(who), some(self.joined, who), self.state[: SHAFT_SPEED + 1, who], self.time[who])

    # Walks

    def _longest(self, who: np.ndarray) -> np.ndarray:
        """Time to the next change of a time-dependent torque or the clutch, or to the end of the run [s]."""
        instants = self.variants.instants[:, who] - self.clock[who]
        every = np.concatenate((instants, self._knots(who), self.ends.time[who][None]))
        later = np.where(every > self.time[who] * (1.0 + 1e-15), every, np.inf)
        return later.min(axis=0) - self.time[who]

    def _goal(self, who: np.ndarray, faced: np.ndarray) -> np.ndarray:
        """Largest angle turned of a walk: the end of the run, or the next angle at which to check the joining."""
        ends, turned, joined = some(self.ends, who), self.turned[who], some(self.joined, who)
        # Angles in the direction faced. A run ends exactly at its end: a sum of distances may round to another angle.
        goal = np.where(faced > 0.0, np.minimum(ends.turned, ends.most_turned), ends.most_turned)
        # A run without an end is compared with itself after 1, 2, 4, … cycles.
        compared = (np.isinf(ends.turned) | (faced < 0.0)) & np.isinf(ends.time)
        cycles = np.floor(faced * turned / self.cycle + NEARLY)
        cycles = np.where(cycles < 0.0, cycles + 1.0, np.exp2(np.frexp(cycles)[1]))
        goal = np.where(compared, np.minimum(goal, cycles * self.cycle), goal)
        # Where torques jump, a clutch may break loose and a standing side start.
        looks = (joined.mode == TOGETHER) | (joined.shaft_direction == 0.0)
        direction = self.variants.direction[who]
        here = self.start[who] + direction * turned
        breaks = np.mod(faced * direction * (self.variants.breaks.angles[:, who] - here), self.cycle)
        # Rounding may put the jump that was just passed on either side.
        breaks = np.where((breaks > JUMP) & (breaks < self.cycle - JUMP), breaks, np.inf)
        nearest = np.fmin.reduce(breaks, axis=0, initial=np.inf)
        return faced * np.where(looks, np.minimum(goal, faced * turned + nearest), goal)

    def _walk(self, who: np.ndarray, method: int, faced: np.ndarray, goal: np.ndarray, longest: np.ndarray) -> Walks:
        """Walk by a method, for at most a time [s] and up to an angle turned."""
        here, system, state = self._here(who), self.sides.two.system, self.state[:, who]
        sides, joined, sizes = here.sides, here.joined, system.sizes
        crank_moves, shaft_moves = joined.crank_direction != 0.0, joined.shaft_direction != 0.0
        holds, slips = joined.mode == TOGETHER, np.abs(joined.mode) == FORWARDS
        stands = ~crank_moves | ~shaft_moves
        loose = sides.coupling.backlash > 0.0 if sides.is_elastic else np.zeros(who.size, bool)
        acts = {
            Ending.CRANK_RESTS: crank_moves,
            Ending.SHAFT_RESTS: shaft_moves & ~holds,
            Ending.LOCKS_UP: slips,
            # Where one side stands, the slip ends when the other comes to rest.
            Ending.ASTRAY: slips & ~stands,
            Ending.BREAKS_LOOSE: holds & crank_moves,
            Ending.SETS_OFF: stands,
            Ending.TOUCH: loose,
            Ending.TURNS: loose,
        }
        if loose.any():
            self.growing[who] = np.where(np.isnan(self.growing[who]), here.growing(), self.growing[who])
        limits, joining = self.speed_limits(who, sizes.crank, faced[0]), sizes.joining
        limits |= sides.joining(joined) | {joining.growing: self.growing[who]}
        if sides.two.is_fluid:
            limits[joining.piece] = sides.coupling.fluid_piece(state[CRANK_SPEED], state[SHAFT_SPEED])
        if stands.any():
            resisted = (forth - back for forth, back in here.starting())
            limits |= dict(zip((joining.resists, joining.shaft_resists), resisted, strict=True))
        limits |= {
            node: np.where(acts[ending], 0.0, np.inf) for ending, node in zip(Ending, joining.never, strict=True)
        }
        numbers = system.limited(sides.numbers(joined), limits)
        new = np.isinf(self.pace[who])
        if new.any():
            self.pace[who] = np.where(new, self.longer * here.first_pace(), self.pace[who])
        waits = ~crank_moves & ~shaft_moves
        # A machine that nothing stops fades instead of coming to rest.
        floor = np.where(self._fades(who), FADED * self.highs[0, who], 0.0)
        step = {"longest": np.where(waits, longest / WAITS, np.inf), "pace": np.where(waits, longest, self.pace[who])}
        goals = {"goal": longest, "other_goal": goal, "floor": floor}
        lanes = self.lanes(who, faced[0], farthest=self.farthest_step, **step, **goals)
        state[CRANK_SPEED], state[SHAFT_SPEED] = np.abs(state[[CRANK_SPEED, SHAFT_SPEED]])
        task = system.task(self.cycle, method, extremes=self.seeks_speed, longer=self.longer)
        edges = self.edges(who, self.start[who])
        return system.run(task, Start(numbers, lanes, state, edges, recorded=RECORDED))

    def _advance(self, who: np.ndarray, method: int) -> None:
        """Walk by a method until something changes, and handle the change."""
        joined = some(self.joined, who)
        faced, longest = faced_directions(joined), self._longest(who)
        goal = self._goal(who, faced[0])
        gone = self._walk(who, method, faced, goal, longest)
        seen = self._seen(who, joined, gone)
        passed = self._passed_over(who, seen)
        if np.isfinite(passed).any():
            gone = self._walk(who, method, faced, goal, np.minimum(longest, passed))
            seen = self._seen(who, joined, gone)
        why, before = gone.why, self.time[who]
        self._see(who, seen)
        self.state[:, who] = gone.states
        self.state[[[CRANK_SPEED], [SHAFT_SPEED]], who] *= np.array(faced)
        self.state[TURNED, who] = np.where(why == Why.OTHER_GOAL, goal, self.state[TURNED, who])
        ended = (why == Why.GOAL) & (longest == self.ends.time[who] - before)
        self.time[who] = np.where(ended, self.ends.time[who], before + gone.at)
        moves = (joined.crank_direction != 0.0) | (joined.shaft_direction != 0.0)
        self.pace[who] = np.where(moves, gone.pace, self.pace[who])
        self.cover(who)
        self.slip_time[who] += np.where(np.abs(joined.mode) == FORWARDS, gone.at, 0.0)
        steep = why == Why.STEEP
        self.implicit[who] |= steep
        self.steep[who[steep]] = 1.0
        self.jammed(who[steep & (method == NINE)])
        self.end(who, why, goal)
        self.done[who[ended]] = True
        self._after(who, why)

    def _seen(self, who: np.ndarray, joined: Joined, gone: Walks) -> Seen:
        """The recorded steps of a walk."""
        column, begin, length, samples, _ = made_steps(gone.recorded, gone.steps)
        phase, moving, own = some(joined, column), samples[: SHAFT_SPEED + 1], who[column]
        moving[[CRANK_SPEED, SHAFT_SPEED]] *= np.array(faced_directions(phase))[:, None]
        # Only the coupling is asked per step; the sides stay per variant.
        sides = self.sides._replace(coupling=some(self.sides.coupling, own))
        here = SidesAt(sides, phase, moving, self.time[own] + begin + RECORDED_AT[:, None] * length)
        return Seen(column, begin, length, here, self._moments(own, here, column, gone.numbers))

    def _passed_over(self, who: np.ndarray, seen: Seen) -> np.ndarray:
        """Time of a walk at which a clutch slips inside a step, unlike at its ends (held, or opposite slip); or inf.

        Another walk to this time finds the beginning of the slip.
        """
        first, (_, joined, moving, _) = np.full(who.size, np.inf), seen.here
        if not self.sides.two.is_clutch:
            return first
        margin = joined.mode * (moving[SHAFT_SPEED] - moving[CRANK_SPEED])
        holds = joined.holding()
        margin[:, holds] = seen.here.some(holds).grip() - np.abs(seen.moment[:, holds])
        low, high = margin.min(axis=0), margin.max(axis=0)
        may = np.flatnonzero(low - EXCEEDS * (high - low) < 0.0)
        walked = seen.begin[may] + LOOKS * seen.length[may]
        times = np.where(weighted(AT_LOOKS, margin[None, :, may])[0] < 0.0, walked, np.inf)
        np.minimum.at(first, seen.column[may], times.min(axis=0, initial=np.inf))
        return first

    def _see(self, who: np.ndarray, seen: Seen) -> None:
        """Update minima, maxima and peaks from the steps of a walk."""
        every, speeds = who[seen.column], seen.here.moving[[CRANK_SPEED, SHAFT_SPEED]]
        np.fmin.at(self.lows, (slice(None), every), speeds.min(axis=1))
        np.fmax.at(self.highs, (slice(None), every), speeds.max(axis=1))
        if self.stepping.extremes:
            top = tops_in_steps(seen.column, np.concatenate((-speeds, speeds)), who.size)
            self.lows[:, who] = np.fmin(self.lows[:, who], -top.value[:2])
            self.highs[:, who] = np.fmax(self.highs[:, who], top.value[2:])
        if self.stepping.peaks:
            begin, both = self.time[every] + seen.begin, np.array([-seen.moment, seen.moment])
            for value, step, share in zip(*tops_in_steps(seen.column, both, who.size), strict=True):
                # Ties go to the earlier step.
                higher = np.flatnonzero(value > self.peak[who] * (1.0 + SAME_PEAK))
                own = step[higher]
                self.peak_at[who[higher]] = begin[own] + share[higher] * seen.length[own]
                self.peak[who] = np.fmax(self.peak[who], value)
        if self.observers and every.size:
            samples = np.array([seen.here.time, *seen.here.moving, seen.moment])
            self.see(CoupledMotion(self.sides, every, seen.here.joined, samples))

    def _moments(self, who: np.ndarray, here: SidesAt, column: np.ndarray, numbers: np.ndarray) -> np.ndarray:
        """Torques of the coupling at instants of steps, (instants, steps); if only clutches need them, where they hold.

        Parameters
        ----------
        who : ndarray (steps,) of int
        here : SidesAt
            States of the steps.
        column : ndarray (steps,) of int
            Columns of `numbers`, those of the motion.
        """
        found = here.apart_moment() if self.stepping.peaks or self.observers else np.zeros_like(here.time)
        holds = here.joined.holding()
        if holds.size:
            held, system, own = here.some(holds), self.sides.two.system, who[holds]
            (turned, speed, other, shaft_speed), directions = held.moving, held.joined.crank_direction
            crank = self.form.of(own)
            # Torques jump at the ends of a step, not within it.
            turned[0] += directions * crank.break_offset(turned[0])
            turned[-1] -= directions * crank.break_offset(turned[-1])
            places = self.start[own] + self.variants.direction[own] * turned
            states, clock = (turned, directions * speed, other, directions * shaft_speed), held.joined.clock + held.time
            found[:, holds] = system.at(numbers, places, states, [system.rows_of["coupling"]], clock, column[holds])[0]
        return found

    # After a walk

    def _after(self, who: np.ndarray, why: np.ndarray) -> None:
        """Handle the events that ended walks."""

        def met(*whys: int) -> np.ndarray:
            return who[np.isin(why, whys)]

        locked = met(Ending.LOCKS_UP)
        if locked.size:
            # The speeds differ by rounding: take their mean, weighted by inertia.
            crank, shaft = self.inertia(locked, self.turned[locked]), self.sides.shaft.inertia[locked]
            both = (crank * self.omega[locked] + shaft * self.shaft_omega[locked]) / (crank + shaft)
            # A standing side stays at rest.
            stands = (self.joined.crank_direction[locked] == 0.0) | (self.joined.shaft_direction[locked] == 0.0)
            both = np.where(stands, 0.0, both)
            self.state[CRANK_SPEED, locked] = self.state[SHAFT_SPEED, locked] = both
        rest = met(Ending.CRANK_RESTS)
        together = rest[self.joined.mode[rest] == TOGETHER]
        self.state[CRANK_SPEED, rest], self.state[SHAFT_SPEED, together] = 0.0, 0.0
        self.state[SHAFT_SPEED, met(Ending.SHAFT_RESTS)] = 0.0
        torn = met(Ending.BREAKS_LOOSE)
        if torn.size:
            self.joined.mode[torn] = np.where(self._here(torn).pull().moment > 0.0, FORWARDS, BACKWARDS)
            self.lock_time[torn] = self.lock_speed[torn] = np.nan
            self.pace[torn] = np.inf
        self.stops[rest] += 1.0
        turns = np.isin(who, met(Ending.TURNS))
        self.growing[who] = np.where(turns, -self.growing[who], np.where(why == Why.FULL, self.growing[who], np.nan))
        touching = met(Ending.TOUCH)
        if touching.size:
            touch, coupling = self.joined.touch[touching], some(self.sides.coupling, touching)
            sides = np.where(self.state[SHAFT_TURNED, touching] > -0.5 * coupling.backlash, 1.0, -1.0)
            self.closings[touching] += touch == 0.0
            self.joined.touch[touching] = np.where(touch == 0.0, sides, 0.0)
            self.pace[touching] = np.inf
        self.done[rest] |= self.ends.reversal
        self.unsettled[who[~np.isin(why, (Why.FULL, Why.STEEP, Ending.BREAKS_LOOSE, Ending.TURNS))]] = True
        self._abandon_endless(rest, met(Why.OTHER_GOAL), who)

    def _abandon_endless(self, rest: np.ndarray, at_mark: np.ndarray, who: np.ndarray) -> None:
        """Give up runs that never end.

        These are runs that swing no farther forward than at their last stop, that have the same speeds as at their last
        mark, that slow down for ever without stopping, that run away from their end, or whose clutch slips for ever.
        """
        self.compare_swings(rest[self.joined.crank_direction[rest] > 0.0])
        speeds, moves = np.abs(self.state[[CRANK_SPEED, SHAFT_SPEED]]), self.joined.crank_direction != 0.0
        two = self.sides.two
        # Neither does a fluid coupling stop a crank, unless something stops the shaft.
        never_stops = self.ends.standing and two.is_fluid and two.shaft.fades
        low = (speeds[0, who] < FADED * self.highs[0, who]) | never_stops
        faded = who[moves[who] & (speeds[0, who] > 0.0) & low]
        self.give_up(faded[~self.done[faded] & self._fades(faded)])
        stands, marked = who[~moves[who]], self.marks.shaft_turned
        passed = np.floor(self.state[SHAFT_TURNED, stands] / self.cycle) != np.floor(marked[stands] / self.cycle)
        at_mark = at_mark[np.isinf(self.ends.turned[at_mark]) | (self.joined.crank_direction[at_mark] < 0.0)]
        for compared in (at_mark[moves[at_mark]], stands[passed]):
            self._compare(compared[~self.done[compared] & self.never_changes(compared)])

    def _compare(self, who: np.ndarray) -> None:
        """Compare variants with their last marks, give up those that never end, and set their marks."""
        before, mode, moves = some(self.marks, who), self.joined.mode[who], self.joined.crank_direction[who] != 0.0
        turned, times = (self.turned[who], self.state[SHAFT_TURNED, who]), (self.time[who], self.slip_time[who])
        now = RunMark(self.speeds(who), *turned, moves, mode, *times)
        cycles = now.turned / self.cycle
        whole = np.isclose(cycles, np.round(cycles), rtol=0.0, atol=NEARLY)
        change, since = now.speeds - before.speeds, np.fmax(np.abs(now.turned - before.turned) / self.cycle, 1.0)
        same = (np.abs(change) <= SETTLED * since * np.abs(now.speeds).max(axis=0)).all(axis=0)
        slips, slipped, passed = np.abs(mode) == FORWARDS, now.slip_time - before.slip_time, now.time - before.time
        held = np.where(slips, slipped >= passed * (1.0 - NEARLY), slipped == 0.0) & (mode == before.mode)
        # While a clutch holds, slips or is open, a crank that got faster over a cycle gets still faster: it never stops
        # or turns round. It locks only if the shaft follows it. A fluid coupling drives it on if the shaft did so, too.
        (crank, shaft), (crank_speed, shaft_speed), fluid = change, now.speeds, self.sides.two.is_fluid
        parts = self.ends.lock_up | self.ends.standing | (crank_speed < 0.0)
        parts &= (mode * shaft >= -SETTLED * np.abs(shaft_speed)) | (not self.ends.lock_up)
        parts &= np.isin(mode, (TOGETHER, APART)) | (slips & (mode * crank < 0.0)) | (fluid & (crank * shaft >= 0.0))
        parts &= held & (crank * crank_speed > 0.0)
        # A crank that needs no coupling to stand isn't moved by a shaft that slows down behind a fluid coupling.
        idle = ~moves & fluid & (shaft * shaft_speed < 0.0) & self._here(who).stays()
        put(self.marks, who, on_arrays(partial(np.where, whole | ~moves), now, before))
        self.give_up(who[(whole | ~moves) & (moves == before.moves) & (same | parts | idle)])
        count = np.round(np.abs(cycles)).astype(int)
        tested = whole & (count & (count - 1) == 0) & (crank_speed > 0.0) & held & ~self.done[who]
        if tested.any() and (self.ends.lock_up | self.ends.standing):
            slipping = who[tested & slips]
            parted = np.zeros(slipping.size, bool)
            if slipping.size:
                parted = np.any([self._parts(slipping, *between) for between in BETWEEN], axis=0)
            endless = np.concatenate([slipping[parted], who[tested & ((mode == TOGETHER) | fluid)]])
            if not self.ends.lock_up:
                endless = endless[np.any([self._turns_on(endless, share) for share in NOT_FASTER], axis=0)]
            self.give_up(endless)
        to_speed = who[tested & np.isfinite(self.ends.speed[who])]
        if to_speed.size:
            self.give_up(to_speed[self.held_back(to_speed, np.isfinite(self.above[to_speed]))])

    # While a clutch slips at a constant torque, each side moves on its own; while it holds, both move as one. Speeds of
    # two motions of a machine over the crank angle never cross.

    def _parts(self, who: np.ndarray, near: float, far: float) -> np.ndarray:
        """Whether clutches slip for ever: if another motion, with speeds between, slips for a cycle and parts."""
        direction, (crank, shaft) = np.sign(self.joined.mode[who]), self.speeds(who)
        begin = np.array([crank + near * (shaft - crank), crank + far * (shaft - crank)])
        other = self.beside(who, Ends.never(who.size), begin)
        leave = (direction * (other.omega - begin[0]) <= 0.0) & (direction * (other.shaft_omega - begin[1]) >= 0.0)
        apart = np.where(direction > 0.0, other.highs[0] < other.lows[1], other.lows[0] > other.highs[1])
        slips = other.slip_time >= other.time * (1.0 - NEARLY)
        return (other.verdict == Verdict.OK) & slips & leave & apart

    def _turns_on(self, who: np.ndarray, share: float) -> np.ndarray:
        """Whether machines never stop: if their motion, slowed down to a fraction, isn't slower after a cycle."""
        slips, begin = np.abs(self.joined.mode[who]) == FORWARDS, share * self.speeds(who)
        # A shaft that slips behind a clutch doesn't follow the crank.
        begin[1] = np.where(slips, self.shaft_omega[who], begin[1])
        sound = np.ones(who.size, bool)
        # Behind a fluid coupling, the crank loses speed until the slip drives it: ask the second cycle.
        for _ in range(2 if self.sides.two.is_fluid else 1):
            other = self.beside(who, Ends.never(who.size)._replace(reversal=True), begin)
            alike = np.where(slips, other.slip_time >= other.time * (1.0 - NEARLY), other.slip_time == 0.0)
            whole = other.turned >= self.cycle * (1.0 - NEARLY)
            sound &= (other.verdict == Verdict.OK) & alike & whole
            after = other.speeds(np.arange(who.size))
            gained, begin = after >= begin, np.minimum(after, self.speeds(who))
        return sound & gained[0] & (gained[1] | slips)

    def speeds(self, who: np.ndarray) -> np.ndarray:
        """Speeds of the crank and the shaft."""
        return self.state[[CRANK_SPEED, SHAFT_SPEED]][:, who]

    def _shaft_beside(self, who: np.ndarray, speeds: np.ndarray) -> CoupledStanding:
        return CoupledStanding(speeds[1], self.joined.engaged[who] + self.time[who])

    def _others(self, who: np.ndarray, *given: Standing | Ends | Stepping) -> "CoupledRuns":
        return CoupledRuns(self.sides.some(who), *given, ())
