"""Runs at two speeds: from a given state to an angle, a time, a speed, rest, or the lock-up of the clutch.

A walk along time lasts as long as the joining of the sides doesn't change. It ends where a clutch stops slipping or
breaks loose, where a side stops or starts, where a time-dependent quantity changes, and at the end of the run.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.elements.elastic_drives.shaft_touch import touch_turns
from engine.motion.coupled.coupled_fields import CoupledMotion
from engine.motion.coupled.two_sides import (
    APART,
    BACKWARDS,
    FLUID,
    FORWARDS,
    TOGETHER,
    CoupledSides,
    CouplingNumbers,
    Joined,
    coupling_pull,
    faced_ways,
)
from engine.motion.coupled.two_speeds import CRANK_SPEED, GRIP, SHAFT_SPEED, SHAFT_TURNED, TURNED, Ending
from engine.motion.fields.recorded_motion import Observer
from engine.motion.moments.breaks import JUMP
from engine.motion.runs.run_progress import ADAPTIVE, Ends, MachineRuns, Standing, Stepping
from engine.stepping.methods import EIGHT, NINE
from engine.stepping.recorded import EXCEEDS, RECORDED, made_steps, tops_in_steps, weighted, weights_at
from engine.stepping.records import some
from engine.stepping.system import SHOWN, Start, Walks
from engine.stepping.walk_task import Why
from engine.words.verdicts import Verdict

# Fractions of a step at which a slip is sought, and the weights of the recorded samples there.
LOOKS = np.arange(1, 16)[:, None] / 16
AT_LOOKS = weights_at(LOOKS)
# Relative change of the speeds per cycle that counts as none; fraction of the maximum speed that counts as rest where
# nothing stops a machine.
SETTLED, FADED = 1e-8, 1e-9
# A peak counts as later only if it is higher by more than this fraction.
SAME_PEAK = 1e-12
# Angles this close to the end of a cycle, as a fraction of it, count as its end.
NEARLY = 1e-9
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
    moving : ndarray (rows, SHOWN, steps)
        Angles and speeds of both sides at the fractions SHOWN.
    moment : ndarray (1, SHOWN, steps)
        Torque of the coupling on the crank [N·m]; no row where nothing depends on it.
    """

    column: np.ndarray
    begin: np.ndarray
    length: np.ndarray
    moving: np.ndarray
    moment: np.ndarray


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
        stepping: Stepping = ADAPTIVE,
        observers: Sequence[Observer] = (),
    ) -> None:
        super().__init__(sides.crank, standing, ends, stepping, observers)
        self.sides, self.cycle, count = sides, self.dynamics.cycle, sides.count
        self.state, self.time, zero = np.zeros((len(sides.two.system.rates), count)), np.zeros(count), np.zeros(count)
        self.turned, self.omega, self.shaft_omega = (self.state[row] for row in (TURNED, CRANK_SPEED, SHAFT_SPEED))
        self.omega[:], self.shaft_omega[:] = standing.omega, standing.coupled.speed
        clock, engaged = standing.clock, standing.coupled.engaged
        self.joined = Joined(np.zeros(count, int), zero.copy(), zero.copy(), clock, engaged, np.ones(count))
        self.lows, self.highs = (np.array([self.omega, self.shaft_omega]) for _ in range(2))
        self.peak, self.peak_at, self.slip_time = np.zeros(count), np.zeros(count), np.zeros(count)
        self.stops, self.closings = np.zeros(count), np.zeros(count)
        self.growing = np.full(count, np.nan)
        self.lock_time, self.lock_speed = np.full(count, np.nan), np.full(count, np.nan)
        self.unsettled, self.implicit = np.ones(count, bool), np.zeros(count, bool)
        self.marks = np.full((4, count), np.nan)

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
        sides, joined, moving = self.sides.some(who), some(self.joined, who), self.state[: SHAFT_SPEED + 1, who].copy()
        # At a jump, evaluate just after it.
        moving[TURNED] += np.sign(moving[CRANK_SPEED]) * sides.crank.break_offset(moving[TURNED])
        ways = np.sign(moving[CRANK_SPEED]), np.sign(moving[SHAFT_SPEED])
        mode = np.full(who.size, APART if sides.two.open else FLUID)
        if sides.two.is_clutch:
            mode = self._holding(sides, joined, moving, self.time[who], ways)
        ways = self._ways(sides, joined, moving, self.time[who], mode, ways)
        self.joined.mode[who], self.joined.crank_direction[who], self.joined.shaft_direction[who] = mode, *ways
        holds = mode == TOGETHER
        locks = who[holds & (ways[0] != 0.0) & np.isnan(self.lock_time[who])]
        self.lock_time[locks], self.lock_speed[locks] = self.time[locks], self.state[CRANK_SPEED, locks]
        slips = who[np.abs(mode) == FORWARDS]
        self.lock_time[slips] = self.lock_speed[slips] = np.nan
        self.done[who[holds & (ways[0] != 0.0)]] |= self.ends.lock_up
        stands = who[ways[0] == 0.0]
        begun = self.state[TURNED, stands] != 0.0
        self.done[stands] |= self.ends.standing & begun
        # Both stay at rest until a time-dependent torque or the clutch changes, or until the run's time is over.
        both = who[(ways[0] == 0.0) & (ways[1] == 0.0)]
        both = both[~self.done[both]]
        for_ever = both[~np.isfinite(self._longest(both))]
        self.done[for_ever] = True
        self.verdict[for_ever] = Verdict.OK if self.ends.standing else Verdict.STALLS

    def _holding(
        self, sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray, ways: tuple[np.ndarray, ...]
    ) -> np.ndarray:
        """Joining of clutches: locked, or the direction of slip."""
        slip = np.sign(moving[SHAFT_SPEED] - moving[CRANK_SPEED]).astype(int)
        standing = (ways[0] == 0.0) & (ways[1] == 0.0)
        forth, back, _, shaft_forth, _, shaft_back = self._free(sides, joined, moving, time)
        off = np.where(standing, np.where(forth > 0.0, 1.0, np.where(back < 0.0, -1.0, 0.0)), ways[0])
        capacity = _grip(sides.coupling, joined.engaged + time)
        trial = joined._replace(mode=np.full(slip.size, TOGETHER), crank_direction=off, shaft_direction=off)
        needed = coupling_pull(sides, trial, moving, time).moment
        # Where both are at rest, either side may be held by its own resistance.
        alone = np.where(shaft_forth > capacity, 1, np.where(-shaft_back > capacity, -1, 0))
        crank_forth, crank_back = forth - shaft_forth, back - shaft_back
        alone = np.where(
            alone == 0, np.where(crank_forth > capacity, -1, np.where(-crank_back > capacity, 1, 0)), alone
        )
        torn = np.where(np.abs(needed) > capacity, np.sign(needed).astype(int), 0)
        return np.where(slip != 0, slip, np.where(standing & (off == 0.0), alone, torn))

    def _free(
        self, sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray
    ) -> tuple[np.ndarray, ...]:
        """Torques that would start both sides together, the crank or the shaft, each forwards and backwards."""
        forth = np.ones(time.size)
        found = []
        for way in (forth, -forth):
            # These torques only decide about sides at rest.
            pull = coupling_pull(
                sides, joined._replace(crank_direction=way, shaft_direction=way), moving, time, moves=False
            )
            found.append((pull.crank.total, pull.shaft.total))
        (a, b), (c, d) = found
        return a + b, c + d, a, b, c, d

    def _ways(
        self,
        sides: CoupledSides,
        joined: Joined,
        moving: np.ndarray,
        time: np.ndarray,
        mode: np.ndarray,
        ways: tuple[np.ndarray, ...],
    ) -> tuple[np.ndarray, np.ndarray]:
        """Direction of each side: of its motion, or of its start from rest."""
        both_forth, both_back, forth, shaft_forth, back, shaft_back = self._free(sides, joined, moving, time)
        moment = coupling_pull(sides, joined._replace(mode=mode), moving, time).moment
        holds = mode == TOGETHER

        def off(low: np.ndarray, high: np.ndarray) -> np.ndarray:
            return np.where(high > 0.0, 1.0, np.where(low < 0.0, -1.0, 0.0))

        crank = np.where(holds, off(both_back, both_forth), off(back + moment, forth + moment))
        shaft = np.where(holds, crank, off(shaft_back - moment, shaft_forth - moment))
        return np.where(ways[0] == 0.0, crank, ways[0]), np.where(ways[1] == 0.0, shaft, ways[1])

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
        end = np.where(faced > 0.0, np.minimum(ends.turned, ends.most_turned), ends.most_turned)
        ahead = end - faced * turned
        # A run without an end is compared with itself from cycle to cycle.
        compared = (np.isinf(ends.turned) | (faced < 0.0)) & np.isinf(ends.time)
        cycles = (np.floor(faced * turned / self.cycle + NEARLY) + 1.0) * self.cycle
        ahead = np.where(compared, np.minimum(ahead, cycles - faced * turned), ahead)
        # Where torques jump, a clutch may break loose and a standing side start.
        looks = (joined.mode == TOGETHER) | (joined.shaft_direction == 0.0)
        direction = self.variants.direction[who]
        here = self.start[who] + direction * turned
        breaks = np.mod(faced * direction * (self.variants.breaks.angles[:, who] - here), self.cycle)
        # Rounding may put the jump that was just passed on either side.
        breaks = np.where((breaks > JUMP) & (breaks < self.cycle - JUMP), breaks, np.inf)
        nearest = np.fmin.reduce(breaks, axis=0, initial=np.inf)
        return turned + faced * np.where(looks, np.minimum(ahead, nearest), ahead)

    def _first_pace(self, sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Length of the first trial step [s]."""
        found = coupling_pull(sides, joined, moving, time)
        crank, shaft = found.crank.epsilon, found.shaft.epsilon
        speed = np.maximum(np.abs(moving[CRANK_SPEED]), np.abs(moving[SHAFT_SPEED]))
        change = np.maximum(np.abs(crank), np.abs(shaft))
        # A hundredth of the time per radian.
        first = 0.01 / np.maximum(speed, np.sqrt(change))
        if not sides.is_elastic:
            return first
        # Within a backlash, a quarter of the time it takes to cross it, at most.
        gap, rise = sides.coupling.backlash, np.abs(shaft - crank)
        crossing = gap / (np.abs(moving[SHAFT_SPEED] - moving[CRANK_SPEED]) + np.sqrt(gap * rise))
        return np.where(joined.touch == 0.0, np.minimum(first, 0.25 * crossing), first)

    @staticmethod
    def _growing(sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Sign of the rate of an elastic shaft's torque, or of its twist if out of contact."""
        found = coupling_pull(sides, joined, moving, time)
        slip = moving[SHAFT_SPEED] - moving[CRANK_SPEED]
        change = found.shaft.epsilon - found.crank.epsilon
        rate = touch_turns(tuple(sides.coupling), joined.touch, slip, change)
        return np.sign(np.where(rate == 0.0, change, rate))

    def _walk(self, who: np.ndarray, method: int, faced: np.ndarray, goal: np.ndarray, longest: np.ndarray) -> Walks:
        """Walk by a method, for at most a time [s] and up to an angle turned."""
        sides, joined, system = self.sides.some(who), some(self.joined, who), self.sides.two.system
        sizes, state, time = system.sizes, self.state[:, who].copy(), self.time[who]
        crank_moves, shaft_moves = joined.crank_direction != 0.0, joined.shaft_direction != 0.0
        holds, slips = joined.mode == TOGETHER, np.abs(joined.mode) == FORWARDS
        stands = ~crank_moves | ~shaft_moves
        loose = sides.coupling.backlash > 0.0 if sides.is_elastic else np.zeros(who.size, bool)
        acts = {
            Ending.CRANK_RESTS: crank_moves,
            Ending.SHAFT_RESTS: shaft_moves & ~holds,
            Ending.LOCKS_UP: slips,
            Ending.ASTRAY: slips,
            Ending.BREAKS_LOOSE: holds & crank_moves,
            Ending.SETS_OFF: stands,
            Ending.TOUCH: loose,
            Ending.TURNS: loose,
        }
        if loose.any():
            growing = self._growing(sides, joined, state[: SHAFT_SPEED + 1], time)
            self.growing[who] = np.where(np.isnan(self.growing[who]), growing, self.growing[who])
        limits, joining = self.speed_limits(who, sizes.crank, faced[0]), sizes.joining
        limits |= sides.joining(joined) | {joining.growing: self.growing[who]}
        if sides.two.is_fluid:
            limits[joining.piece] = sides.coupling.fluid_piece(state[CRANK_SPEED], state[SHAFT_SPEED])
        if stands.any():
            _, _, *ways = self._free(sides, joined, state[: SHAFT_SPEED + 1], time)
            limits |= {joining.resists: ways[0] - ways[2], joining.shaft_resists: ways[1] - ways[3]}
        limits |= {
            node: np.where(acts[ending], 0.0, np.inf) for ending, node in zip(Ending, joining.never, strict=True)
        }
        numbers = system.limited(sides.numbers(joined), limits)
        new = np.isinf(self.pace[who])
        if new.any():
            first = self._first_pace(sides, joined, state[: SHAFT_SPEED + 1], time)
            self.pace[who] = np.where(new, self.longer * first, self.pace[who])
        waits = ~crank_moves & ~shaft_moves
        # A machine that nothing stops fades instead of coming to rest.
        floor = np.where(self._fades(who), FADED * self.highs[0, who], 0.0)
        step = {"longest": np.where(waits, longest / WAITS, np.inf), "pace": np.where(waits, longest, self.pace[who])}
        goals = {"goal": longest, "other_goal": goal, "floor": floor}
        lanes = self.lanes(who, faced[0], farthest=self.farthest_step, **step, **goals)
        state[CRANK_SPEED], state[SHAFT_SPEED] = np.abs(state[[CRANK_SPEED, SHAFT_SPEED]])
        task = system.task(self.cycle, method, longer=self.longer)
        edges = self.edges(who, self.start[who])
        return system.run(task, Start(numbers, lanes, state, edges, recorded=RECORDED))

    def _advance(self, who: np.ndarray, method: int) -> None:
        """Walk by a method until something changes, and handle the change."""
        joined = some(self.joined, who)
        faced, longest = faced_ways(joined), self._longest(who)
        goal = self._goal(who, faced[0])
        gone = self._walk(who, method, faced, goal, longest)
        seen = self._seen(who, joined, gone)
        passed = self._passed_over(who, joined, seen)
        if np.isfinite(passed).any():
            gone = self._walk(who, method, faced, goal, np.minimum(longest, passed))
            seen = self._seen(who, joined, gone)
        why, before = gone.why, self.time[who]
        self._see(who, joined, seen)
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
        phase, moving, moment = some(joined, column), samples[: SHAFT_SPEED + 1], np.zeros((0, *samples.shape[1:]))
        moving[[CRANK_SPEED, SHAFT_SPEED]] *= np.array(faced_ways(phase))[:, None]
        if self.stepping.peaks or self.observers or self.sides.two.is_clutch:
            time = self.time[who[column]] + begin + SHOWN[:, None] * length
            moment = self._moments(who[column], phase, moving, time, column, gone.numbers)[None]
        return Seen(column, begin, length, moving, moment)

    def _passed_over(self, who: np.ndarray, joined: Joined, seen: Seen) -> np.ndarray:
        """Time of a walk at which a clutch slips inside a step, unlike at its ends (held, or opposite slip); or inf.

        Another walk to this time finds the beginning of the slip.
        """
        first, phase = np.full(who.size, np.inf), some(joined, seen.column)
        if not self.sides.two.is_clutch:
            return first
        holds = (phase.mode == TOGETHER) & (phase.crank_direction != 0.0)
        time = self.time[who[seen.column]] + seen.begin + SHOWN[:, None] * seen.length
        grip = _grip(some(self.sides.coupling, who[seen.column]), phase.engaged + time)
        slip = phase.mode * (seen.moving[SHAFT_SPEED] - seen.moving[CRANK_SPEED])
        margin = np.where(holds, grip - np.abs(seen.moment[0]), slip)
        low, high = margin.min(axis=0), margin.max(axis=0)
        may = np.flatnonzero(low - EXCEEDS * (high - low) < 0.0)
        walked = seen.begin[may] + LOOKS * seen.length[may]
        times = np.where(weighted(AT_LOOKS, margin[None, :, may])[0] < 0.0, walked, np.inf)
        np.minimum.at(first, seen.column[may], times.min(axis=0, initial=np.inf))
        return first

    def _see(self, who: np.ndarray, joined: Joined, seen: Seen) -> None:
        """Update minima, maxima and peaks from the steps of a walk."""
        begin, speeds = self.time[who[seen.column]] + seen.begin, seen.moving[[CRANK_SPEED, SHAFT_SPEED]]
        curves = -speeds, speeds, -seen.moment, seen.moment
        top = tops_in_steps(seen.column, np.concatenate(curves), who.size)
        self.lows[:, who] = np.fmin(self.lows[:, who], -top.value[:2])
        self.highs[:, who] = np.fmax(self.highs[:, who], top.value[2:4])
        for value, step, share in zip(*(row[4:] for row in top), strict=True):
            # Ties go to the earlier step.
            higher = np.flatnonzero(value > self.peak[who] * (1.0 + SAME_PEAK))
            own = step[higher]
            self.peak_at[who[higher]] = begin[own] + share[higher] * seen.length[own]
            self.peak[who] = np.fmax(self.peak[who], value)
        if self.observers and begin.size:
            samples = np.array([begin + SHOWN[:, None] * seen.length, *seen.moving, *seen.moment])
            self.see(CoupledMotion(self.sides, who[seen.column], some(joined, seen.column), samples))

    def _moments(
        self,
        who: np.ndarray,
        joined: Joined,
        moving: np.ndarray,
        time: np.ndarray,
        column: np.ndarray,
        numbers: np.ndarray,
    ) -> np.ndarray:
        """Torques of the coupling at instants of steps, (instants, steps).

        Parameters
        ----------
        who : ndarray (steps,) of int
        joined, moving, time
            As for `coupling_pull`.
        column : ndarray (steps,) of int
            Columns of `numbers`, those of the motion.
        """
        holds = (joined.mode == TOGETHER) & (joined.crank_direction != 0.0)
        sides = self.sides._replace(coupling=some(self.sides.coupling, who))
        found = sides.apart_moment(joined, moving, time)
        if holds.any():
            system, own, (turned, speed, other, shaft_speed) = sides.two.system, who[holds], moving[..., holds]
            ways, crank = joined.crank_direction[holds], self.form.of(own)
            # Torques jump at the ends of a step, not within it.
            turned[0] += ways * crank.break_offset(turned[0])
            turned[-1] -= ways * crank.break_offset(turned[-1])
            places = self.start[own] + self.variants.direction[own] * turned
            states, clock = (turned, ways * speed, other, ways * shaft_speed), joined.clock[holds] + time[:, holds]
            found[:, holds] = system.at(numbers, places, states, [system.shown["coupling"]], clock, column[holds])[0]
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
            # A standing crank stays at rest.
            both = np.where(self.joined.crank_direction[locked] == 0.0, 0.0, both)
            self.state[CRANK_SPEED, locked] = self.state[SHAFT_SPEED, locked] = both
        rest = met(Ending.CRANK_RESTS)
        together = rest[self.joined.mode[rest] == TOGETHER]
        self.state[CRANK_SPEED, rest], self.state[SHAFT_SPEED, together] = 0.0, 0.0
        self.state[SHAFT_SPEED, met(Ending.SHAFT_RESTS)] = 0.0
        torn = met(Ending.BREAKS_LOOSE)
        if torn.size:
            sides, joined, moving = self.sides.some(torn), some(self.joined, torn), self.state[: SHAFT_SPEED + 1, torn]
            found = coupling_pull(sides, joined, moving, self.time[torn])
            self.joined.mode[torn] = np.where(found.moment > 0.0, FORWARDS, BACKWARDS)
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

        These are runs that swing no farther forward than at their last stop, that repeat the cycle before, that slow
        down for ever without stopping, or that run away from their end, faster from cycle to cycle.
        """
        self.compare_swings(rest[self.joined.crank_direction[rest] > 0.0])
        speeds, moves = np.abs(self.state[[CRANK_SPEED, SHAFT_SPEED]]), self.joined.crank_direction != 0.0
        faded = who[moves[who] & (speeds[0, who] > 0.0) & (speeds[0, who] < FADED * self.highs[0, who])]
        self.give_up(faded[~self.done[faded] & self._fades(faded)])
        stands = who[~moves[who]]
        passed = np.floor(self.state[SHAFT_TURNED, stands] / self.cycle) != np.floor(self.marks[2, stands] / self.cycle)
        at_mark = at_mark[np.isinf(self.ends.turned[at_mark]) | (self.joined.crank_direction[at_mark] < 0.0)]
        for compared in (at_mark[moves[at_mark]], stands[passed]):
            mine = compared[~self.done[compared] & self.never_changes(compared)]
            now = np.array(
                [*self.state[[CRANK_SPEED, SHAFT_SPEED]][:, mine], self.state[SHAFT_TURNED, mine], moves[mine]]
            )
            before = self.marks[:, mine]
            whole = np.isclose(np.mod(self.state[TURNED, mine] / self.cycle + 0.5, 1.0), 0.5, rtol=0.0, atol=NEARLY)
            alike = (whole | ~moves[mine]) & (now[3] == before[3])
            same = np.abs(now[:2] - before[:2]) <= SETTLED * np.abs(now[:2]).max(axis=0)
            # While a clutch holds, slips or is open, a crank that got faster over a cycle gets still faster: it never
            # stops or turns round. It locks only if the shaft follows it.
            mode, (crank, shaft) = self.joined.mode[mine], now[:2] - before[:2]
            parts = self.ends.lock_up | self.ends.standing | (now[0] < 0.0)
            parts &= (mode * shaft >= -SETTLED * np.abs(now[1])) | (not self.ends.lock_up)
            parts &= np.isin(mode, (TOGETHER, APART)) | ((np.abs(mode) == FORWARDS) & (mode * crank < 0.0))
            parts &= crank * now[0] > 0.0
            self.marks[:, mine] = np.where(whole | ~moves[mine], now, before)
            self.give_up(mine[alike & (same.all(axis=0) | parts)])


def _grip(clutch: CouplingNumbers, engaged: np.ndarray) -> np.ndarray:
    """Torque capacity of locked clutches [N·m], a given time after their engagement [s]."""
    return clutch.capacity_at(engaged) * (1.0 + GRIP)
