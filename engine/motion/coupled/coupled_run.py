"""Runs at two speeds: from a given state to an angle, a time, a speed, rest, or the lock-up of the clutch.

A walk along time lasts as long as the joining of the sides doesn't change. It ends where a clutch stops slipping or
breaks loose, where a side stops or starts, where a time-dependent quantity changes, and at the end of the run.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from engine.elements.elastic_drives.shaft_touch import touch_turns
from engine.motion.coupled.coupled_fields import CoupledPiece
from engine.motion.coupled.two_sides import (
    APART,
    BACKWARDS,
    FLUID,
    FORWARDS,
    TOGETHER,
    CoupledSides,
    Joined,
    coupling_pull,
    faced_ways,
)
from engine.motion.coupled.two_speeds import CRANK_SPEED, GRIP, SHAFT_SPEED, SHAFT_TURNED, TURNED
from engine.motion.moments.breaks import JUMP
from engine.motion.moments.grid import edges_of
from engine.motion.runs.watching import Observer, side_by_side
from engine.stepping.methods import EIGHT, NINE
from engine.stepping.system import SHOWN, Walks
from engine.stepping.walk import LONGER, Why, coarser
from engine.words.verdicts import Verdict

TOLERANCE, FARTHEST_TURN = 1e-10, 0.25 * np.pi
# Fractions of a step at which speeds and torques are sampled, and the interpolation matrix from the recorded ones.
LOOKS = np.arange(17) / 16
AT_LOOKS = np.array([np.polynomial.Polynomial.fit(SHOWN, row, SHOWN.size - 1)(LOOKS) for row in np.eye(SHOWN.size)]).T
# Maximum numbers of steps recorded per walk, and of walks per run.
RECORDED, MOST_WALKS = 64, 100_000
# Relative change of the speeds per cycle that counts as none; fraction of the maximum speed that counts as rest where
# nothing stops a machine; difference of equal swings [rad].
SETTLED, FADED, SAME_SWING = 1e-8, 1e-9, 1e-6
# A peak counts as later only if it is higher by more than this fraction.
SAME_PEAK = 1e-12
# Newton iterations for the peak of a quartic.
NEWTONS = 5
# Angles this close to the end of a cycle, as a fraction of it, count as its end.
NEARLY = 1e-9
# Steps of a standing machine to the next change.
WAITS = 4
# Reasons for the end of a walk, in addition to the common ones, in the order of the system's guards.
ABOVE, BELOW, CRANK_RESTS, SHAFT_RESTS, LOCKS_UP, ASTRAY, BREAKS_LOOSE, SETS_OFF, TOUCH, TURNS = (
    Why.GUARD + i for i in range(10)
)


class Precision(NamedTuple):
    """Precision of runs.

    Attributes
    ----------
    tolerance : float
        Relative tolerance of a step.
    coarser : bool
        Whether this is a comparison run: longer steps, sampled half as often.
    """

    tolerance: float = TOLERANCE
    coarser: bool = False


FINE = Precision()


class CoupledEnds(NamedTuple):
    """Ends of runs, (variants,): angle turned [rad], time [s], speed of the crank [rad/s]; infinite for never.

    The run also ends when the crank remains at rest if `rest`, when it is at rest even for an instant if `reversal`,
    and when the clutch locks if `lock_up`. A run that turns by `most_turned` [rad] is given up.
    """

    turned: np.ndarray
    time: np.ndarray
    speed: np.ndarray
    rest: bool
    lock_up: bool
    most_turned: np.ndarray
    reversal: bool = False

    def some(self, who: np.ndarray) -> "CoupledEnds":
        """A subset of the variants, by index."""
        rows = {key: getattr(self, key)[who] for key in ("turned", "time", "speed", "most_turned")}
        return self._replace(**rows)


class CoupledRuns:
    """Runs of a number of variants, in progress.

    Parameters
    ----------
    sides : CoupledSides
    speeds : tuple of ndarray (variants,)
        Of the crank and of the shaft at the start, reduced to the crank [rad/s].
    clock, engaged : ndarray (variants,)
        Clock time at the start, and time since the coupling was engaged [s].
    ends : CoupledEnds
    precision : Precision
    observers : sequence of Observer
        Each receives a `CoupledPiece` of every walk.

    Attributes
    ----------
    state : ndarray (rows, variants)
        Current angle and speed of the crank and of the shaft, in the direction of motion, angles from the start of the
        run; then the integrals.
    time : ndarray (variants,)
        From the start of the run [s].
    joined : Joined
    verdict : ndarray of uint8
    done : ndarray of bool
    lows, highs : ndarray (2, variants)
        Minimum and maximum speeds of the crank and of the shaft [rad/s].
    covered : ndarray (2, variants)
        Minimum and maximum angle turned by the crank [rad].
    peak, peak_at : ndarray
        Peak magnitude of the coupling torque [N·m], and its time [s].
    stops, closings : ndarray
        How often the crank came to rest, and how often a backlash closed.
    growing : ndarray
        +1 or −1: whether the torque of a shaft with backlash (its twist, if out of contact) rises or falls. Steps end
        at its extremes, so that none passes over a short contact.
    once_steep : ndarray
        1 if any step was implicit, else 0.
    slip_time : ndarray
        Total time of slip of a clutch [s].
    lock_time, lock_speed : ndarray
        Time of the last lock-up and speed of the crank then; NaN without one.
    """

    def __init__(
        self,
        sides: CoupledSides,
        speeds: tuple[np.ndarray, np.ndarray],
        clock: np.ndarray,
        engaged: np.ndarray,
        ends: CoupledEnds,
        precision: Precision = FINE,
        observers: Sequence[Observer] = (),
    ) -> None:
        self.sides, self.ends, self.observers, count = sides, ends, observers, sides.count
        self.cycle = sides.crank.dynamics.cycle
        self.looks = slice(None, None, 2 if precision.coarser else 1)
        self.longer = LONGER if precision.coarser else 1.0
        self.tolerance = coarser(precision.tolerance) if precision.coarser else precision.tolerance
        self.farthest = FARTHEST_TURN * self.longer
        self.state = np.zeros((len(sides.two.system.rates), count))
        self.state[CRANK_SPEED], self.state[SHAFT_SPEED] = speeds
        self.time, zero = np.zeros(count), np.zeros(count)
        self.pace = np.full(count, np.inf)
        self.joined = Joined(np.zeros(count, int), zero.copy(), zero.copy(), clock, engaged, np.ones(count))
        self.verdict, self.done = np.full(count, Verdict.OK, np.uint8), np.zeros(count, bool)
        self.lows, self.highs = np.array(speeds), np.array(speeds)
        self.covered = np.zeros((2, count))
        self.peak, self.peak_at, self.slip_time = np.zeros(count), np.zeros(count), np.zeros(count)
        self.stops, self.closings = np.zeros(count), np.zeros(count)
        self.growing = np.full(count, np.nan)
        self.lock_time, self.lock_speed = np.full(count, np.nan), np.full(count, np.nan)
        self.above = np.where(ends.speed > speeds[0], ends.speed, np.inf)
        self.below = np.where(ends.speed < speeds[0], ends.speed, -np.inf)
        self.done |= ends.speed == speeds[0]
        self.unsettled, self.steep, self.once_steep = np.ones(count, bool), np.zeros(count, bool), np.zeros(count)
        self.marks, self.farthest_swing = np.full((4, count), np.nan), np.full(count, np.nan)

    def go_to_end(self) -> None:
        """Carry the runs to their end, in place."""
        # Infinite and undefined values become verdicts, not warnings.
        with np.errstate(all="ignore"):
            for _ in range(MOST_WALKS):
                self._settle(np.flatnonzero(self.unsettled & ~self.done))
                live = np.flatnonzero(~self.done)
                if not live.size:
                    return
                for steep in (False, True):
                    some = live[self.steep[live] == steep]
                    if some.size:
                        self._advance(some, NINE if steep else EIGHT)
        self._give_up(np.flatnonzero(~self.done))

    def _give_up(self, who: np.ndarray) -> None:
        """End runs that would never end: with the clutch slipping, with the crank standing, or in motion."""
        slips, stands = np.abs(self.joined.mode[who]) == FORWARDS, self.joined.crank_way[who] == 0.0
        verdict = np.where(slips, Verdict.SLIPS, np.where(stands, Verdict.STALLS, Verdict.NO_END))
        self.verdict[who], self.done[who] = verdict, True

    def _never_changes(self, who: np.ndarray) -> np.ndarray:
        """Whether nothing depends on time any more and no time ends the run."""
        free = np.isinf(self.ends.time[who]) & np.isinf(self._longest(who))
        return free & (not self.sides.crank.dynamics.changing)

    def _fades(self, who: np.ndarray) -> np.ndarray:
        """Whether the crank slows down without ever stopping, since all torques vanish with the speed."""
        return self._never_changes(who) & self.sides.crank.dynamics.fades

    # Joining of the sides

    def _settle(self, who: np.ndarray) -> None:
        """Decide the joining of the sides of some variants, and the direction of each side."""
        if not who.size:
            return
        self.unsettled[who] = self.steep[who] = False
        sides, joined, moving = self.sides.some(who), self.joined.some(who), self.state[: SHAFT_SPEED + 1, who].copy()
        # Evaluate behind a jump at this very angle.
        moving[TURNED] += np.sign(moving[CRANK_SPEED]) * sides.crank.beside(moving[TURNED])
        ways = np.sign(moving[CRANK_SPEED]), np.sign(moving[SHAFT_SPEED])
        mode = np.full(who.size, APART if sides.open else FLUID)
        if not (sides.open or sides.is_fluid or sides.is_elastic):
            mode = self._holding(sides, joined, moving, self.time[who], ways)
        ways = self._ways(sides, joined, moving, self.time[who], mode, ways)
        self.joined.mode[who], self.joined.crank_way[who], self.joined.shaft_way[who] = mode, *ways
        holds = mode == TOGETHER
        locks = who[holds & (ways[0] != 0.0) & np.isnan(self.lock_time[who])]
        self.lock_time[locks], self.lock_speed[locks] = self.time[locks], self.state[CRANK_SPEED, locks]
        slips = who[np.abs(mode) == FORWARDS]
        self.lock_time[slips] = self.lock_speed[slips] = np.nan
        self.done[who[holds & (ways[0] != 0.0)]] |= self.ends.lock_up
        stands = who[ways[0] == 0.0]
        begun = self.state[TURNED, stands] != 0.0
        self.done[stands] |= (self.ends.rest | self.ends.reversal) & begun
        # Both stand until a time-dependent torque or the clutch changes, or until the run's time is over.
        both = who[(ways[0] == 0.0) & (ways[1] == 0.0)]
        both = both[~self.done[both]]
        for_ever = both[~np.isfinite(self._longest(both))]
        self.done[for_ever] = True
        self.verdict[for_ever] = Verdict.OK if self.ends.rest or self.ends.reversal else Verdict.STALLS

    def _holding(
        self, sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray, ways: tuple[np.ndarray, ...]
    ) -> np.ndarray:
        """Joining of clutches: locked, or the direction of slip."""
        slip = np.sign(moving[SHAFT_SPEED] - moving[CRANK_SPEED]).astype(int)
        standing = (ways[0] == 0.0) & (ways[1] == 0.0)
        forth, back, _, shaft_forth, _, shaft_back = self._free(sides, joined, moving, time)
        off = np.where(standing, np.where(forth > 0.0, 1.0, np.where(back < 0.0, -1.0, 0.0)), ways[0])
        capacity = _grip(sides, joined.engaged + time)
        trial = joined._replace(mode=np.full(slip.size, TOGETHER), crank_way=off, shaft_way=off)
        needed = coupling_pull(sides, trial, moving, time).moment
        # Where both stand, either side may be held by its own resistance.
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
            pull = coupling_pull(sides, joined._replace(crank_way=way, shaft_way=way), moving, time, moves=False)
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
        time = self.time[who]
        instants = self.sides.crank.variants.instants[:, who] - self.joined.clock[who]
        knots = self.sides.coupling.times[:, who] - self.joined.engaged[who]
        every = np.concatenate((instants, knots if not self.sides.open else knots[:0], self.ends.time[who][None]))
        later = np.where(every > time * (1.0 + 1e-15), every, np.inf)
        return later.min(axis=0) - time

    def _goal(self, who: np.ndarray, faced: np.ndarray) -> np.ndarray:
        """Largest angle turned of a walk: the end of the run, or the next angle at which to check the joining."""
        ends, turned, joined = self.ends.some(who), self.state[TURNED, who], self.joined.some(who)
        end = np.where(faced > 0.0, np.minimum(ends.turned, ends.most_turned), ends.most_turned)
        ahead = end - faced * turned
        # A run without an end is compared with itself from cycle to cycle.
        compared = np.isinf(ends.turned) & np.isinf(ends.time)
        cycles = (np.floor(faced * turned / self.cycle + NEARLY) + 1.0) * self.cycle
        ahead = np.where(compared, np.minimum(ahead, cycles - faced * turned), ahead)
        # Where torques jump, a clutch may break loose and a standing side start.
        looks = (joined.mode == TOGETHER) | (joined.shaft_way == 0.0)
        crank = self.sides.crank
        way = faced * crank.variants.direction[who]
        here = crank.start[who] + crank.variants.direction[who] * turned
        breaks = np.mod(way * (crank.variants.breaks.angles[:, who] - here), self.cycle)
        # Rounding may put the jump just passed on either side.
        breaks = np.where((breaks > JUMP) & (breaks < self.cycle - JUMP), breaks, np.inf)
        nearest = np.fmin.reduce(breaks, axis=0, initial=np.inf)
        return turned + faced * np.where(looks, np.minimum(ahead, nearest), ahead)

    def _first_pace(self, sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Length of the first trial step [s]."""
        found = coupling_pull(sides, joined, moving, time)
        crank, shaft = found.crank.epsilon, found.shaft.epsilon
        speed = np.maximum(np.abs(moving[CRANK_SPEED]), np.abs(moving[SHAFT_SPEED]))
        change = np.maximum(np.abs(crank), np.abs(shaft))
        # A hundredth of the time per radian; less where torques pull the speeds together.
        first = 0.01 / np.fmax(np.maximum(speed, np.sqrt(change)), np.abs(found.steepness))
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
        sides, joined, system = self.sides.some(who), self.joined.some(who), self.sides.two.system
        sizes, own, state, time = system.sizes, sides.crank.variants, self.state[:, who].copy(), self.time[who]
        crank_moves, shaft_moves = joined.crank_way != 0.0, joined.shaft_way != 0.0
        holds, slips = joined.mode == TOGETHER, np.abs(joined.mode) == FORWARDS
        stands = ~crank_moves | ~shaft_moves
        counts = (crank_moves, shaft_moves & ~holds, slips, slips, holds & crank_moves, stands)
        loose = sides.coupling.backlash > 0.0 if sides.is_elastic else np.zeros(who.size, bool)
        counts += (loose, loose)
        if loose.any():
            growing = self._growing(sides, joined, state[: SHAFT_SPEED + 1], time)
            self.growing[who] = np.where(np.isnan(self.growing[who]), growing, self.growing[who])
        limits = {sizes.crank.above: np.where(faced[0] > 0.0, self.above[who], -self.below[who])}
        limits |= {sizes.crank.below: np.where(faced[0] > 0.0, self.below[who], -self.above[who])}
        joining = sizes.joining
        limits |= sides.joining(joined) | {joining.growing: self.growing[who]}
        if stands.any():
            _, _, *ways = self._free(sides, joined, state[: SHAFT_SPEED + 1], time)
            limits |= {joining.resists: ways[0] - ways[2], joining.shaft_resists: ways[1] - ways[3]}
        limits |= {node: np.where(some, 0.0, np.inf) for node, some in zip(joining.never, counts, strict=True)}
        numbers = system.limited(sides.numbers(joined), limits)
        edges = np.concatenate(edges_of(own.direction, own.breaks, self.cycle, sides.crank.start))
        new = np.isinf(self.pace[who])
        if new.any():
            first = self._first_pace(sides, joined, state[: SHAFT_SPEED + 1], time)
            self.pace[who] = np.where(new, self.longer * first, self.pace[who])
        waits = ~crank_moves & ~shaft_moves
        # A machine that nothing stops fades instead of coming to rest.
        floor = np.where(self._fades(who), FADED * self.highs[0, who], 0.0)
        lanes = {"start": sides.crank.start, "direction": own.direction, "facing": faced[0]}
        lanes |= {"clock": joined.clock + time, "goal": longest, "other_goal": goal, "tolerance": self.tolerance}
        lanes |= {"farthest": self.farthest, "longest": np.where(waits, longest / WAITS, np.inf), "floor": floor}
        lanes |= {"turned": state[TURNED], "pace": np.where(waits, longest, self.pace[who])}
        state[CRANK_SPEED], state[SHAFT_SPEED] = np.abs(state[[CRANK_SPEED, SHAFT_SPEED]])
        task, nothing = system.task(self.cycle, method, longer=self.longer), np.zeros((0, who.size))
        return system.run(task, numbers, edges, nothing, lanes, state, recorded=RECORDED)

    def _advance(self, who: np.ndarray, method: int) -> None:
        """Walk by a method until something changes, and handle the change."""
        joined = self.joined.some(who)
        faced, longest = faced_ways(joined), self._longest(who)
        goal = self._goal(who, faced[0])
        gone = self._walk(who, method, faced, goal, longest)
        why, before = gone.why, self.time[who]
        self._see(who, joined, before, gone)
        self.state[:, who] = gone.states
        self.state[[[CRANK_SPEED], [SHAFT_SPEED]], who] *= np.array(faced)
        self.state[TURNED, who] = np.where(why == Why.OTHER_GOAL, goal, self.state[TURNED, who])
        ended = (why == Why.GOAL) & (longest == self.ends.time[who] - before)
        self.time[who] = np.where(ended, self.ends.time[who], before + gone.at)
        moves = (joined.crank_way != 0.0) | (joined.shaft_way != 0.0)
        self.pace[who] = np.where(moves, gone.pace, self.pace[who])
        self.covered[0, who] = np.fmin(self.covered[0, who], self.state[TURNED, who])
        self.covered[1, who] = np.fmax(self.covered[1, who], self.state[TURNED, who])
        self.slip_time[who] += np.where(np.abs(joined.mode) == FORWARDS, gone.at, 0.0)
        lost = who[(why == Why.LOST) | ((why == Why.STEEP) & (method == NINE))]
        self.steep[who] |= why == Why.STEEP
        self.once_steep[who[why == Why.STEEP]] = 1.0
        # Friction without an equilibrium makes the reactions infinite.
        rubs = self.sides.crank.dynamics.rubs
        self.verdict[lost], self.done[lost] = Verdict.JAMS if rubs else Verdict.NOT_FINITE, True
        self.done[who[ended]] = True
        self._after(who, why, goal)

    def _see(self, who: np.ndarray, joined: Joined, before: np.ndarray, gone: Walks) -> None:
        """Update minima, maxima and peaks from the recorded steps."""
        made, shown = gone.steps.astype(int), SHOWN.size
        step, column = np.nonzero(np.arange(made.max())[:, None] < made)
        at, length, _, *rows = gone.recorded[step, :, column].T
        looks, at_looks = LOOKS[self.looks, None], AT_LOOKS[self.looks]
        moving = np.stack([at_looks @ np.array(rows[i * (shown + 1) : i * (shown + 1) + shown]) for i in range(4)])
        seen, faced = joined.some(column), np.array(faced_ways(joined))[:, column]
        moving[[CRANK_SPEED, SHAFT_SPEED]] *= faced[:, None]
        time = before[column] + at + looks * length
        mine = who[column]
        for row, speeds in enumerate((moving[CRANK_SPEED], moving[SHAFT_SPEED])):
            np.fmin.at(self.lows[row], mine, -highest(-speeds)[0])
            np.fmax.at(self.highs[row], mine, highest(speeds)[0])
        moment = self._moments(mine, seen, moving, time)
        self._see_peaks(mine, np.abs(moment), time)
        if self.observers and step.size:
            order = np.lexsort((step, column))
            counts = len(looks) * made[made > 0]
            along = np.concatenate((time[None], moving, moment[None]))[:, :, order]
            whole = [side_by_side(row.T.ravel(), counts) for row in along]
            piece = CoupledPiece(whole[0], np.array(whole[1:-1]), whole[-1], joined.some(np.flatnonzero(made)))
            for observer in self.observers:
                observer.see(who[made > 0], piece)

    def _see_peaks(self, mine: np.ndarray, size: np.ndarray, time: np.ndarray) -> None:
        """Update the peak torques of some variants from magnitudes at instants of steps, (instants, steps)."""
        tops, share = highest(size)
        when, before = time[0] + share * (time[-1] - time[0]), self.peak[mine]
        np.fmax.at(self.peak, mine, tops)
        higher = np.flatnonzero((tops > before * (1.0 + SAME_PEAK)) & (tops == self.peak[mine]))
        # Ties go to the earlier step.
        self.peak_at[mine[higher[::-1]]] = when[higher[::-1]]

    def _moments(self, who: np.ndarray, joined: Joined, moving: np.ndarray, time: np.ndarray) -> np.ndarray:
        """Torques of the coupling at instants of the steps of some variants, (instants, steps)."""
        holds = (joined.mode == TOGETHER) & (joined.crank_way != 0.0)
        if self.sides.is_elastic:
            slip = moving[SHAFT_SPEED] - moving[CRANK_SPEED]
            return self.sides.coupling.some(who).moment(joined.touch, moving[SHAFT_TURNED], slip)
        if self.sides.is_fluid:
            return self.sides.coupling.some(who).fluid_moment(moving[CRANK_SPEED], moving[SHAFT_SPEED])
        if self.sides.open:
            return np.zeros_like(time)
        slips = np.where(np.abs(joined.mode) == FORWARDS, joined.mode, 0)
        found = slips * self.sides.coupling.some(who).capacity_at(joined.engaged + time)
        if holds.any():
            sides, ways = self.sides.some(who[holds]), joined.crank_way[holds]
            there, moving = time[:, holds], moving[..., holds].copy()
            # Torques jump at the ends of a step, not within it.
            moving[TURNED, 0] += ways * sides.crank.beside(moving[TURNED, 0])
            moving[TURNED, -1] -= ways * sides.crank.beside(moving[TURNED, -1])
            found[:, holds] = coupling_pull(sides, joined.some(holds), moving, there).moment
        return found

    # After a walk

    def _after(self, who: np.ndarray, why: np.ndarray, goal: np.ndarray) -> None:
        """Handle the events that ended walks."""

        def met(*whys: int) -> np.ndarray:
            return who[np.isin(why, whys)]

        locked = met(LOCKS_UP)
        if locked.size:
            # The speeds differ by rounding: take their mean, weighted by inertia.
            sides, moving = self.sides.some(locked), self.state[:, locked]
            crank, shaft = sides.crank.inertia(moving[TURNED]), sides.shaft.inertia
            both = (crank * moving[CRANK_SPEED] + shaft * moving[SHAFT_SPEED]) / (crank + shaft)
            # A standing crank stays at rest.
            both = np.where(self.joined.crank_way[locked] == 0.0, 0.0, both)
            self.state[CRANK_SPEED, locked] = self.state[SHAFT_SPEED, locked] = both
        rest = met(CRANK_RESTS)
        together = rest[self.joined.mode[rest] == TOGETHER]
        self.state[CRANK_SPEED, rest], self.state[SHAFT_SPEED, together] = 0.0, 0.0
        self.state[SHAFT_SPEED, met(SHAFT_RESTS)] = 0.0
        torn = met(BREAKS_LOOSE)
        if torn.size:
            moving = self.state[: SHAFT_SPEED + 1, torn]
            found = coupling_pull(self.sides.some(torn), self.joined.some(torn), moving, self.time[torn])
            self.joined.mode[torn] = np.where(found.moment > 0.0, FORWARDS, BACKWARDS)
            self.lock_time[torn] = self.lock_speed[torn] = np.nan
        self.stops[rest] += 1.0
        turns = np.isin(who, met(TURNS))
        self.growing[who] = np.where(turns, -self.growing[who], np.where(why == Why.FULL, self.growing[who], np.nan))
        touching = met(TOUCH)
        if touching.size:
            touch, coupling = self.joined.touch[touching], self.sides.coupling.some(touching)
            sides = np.where(self.state[SHAFT_TURNED, touching] > -0.5 * coupling.backlash, 1.0, -1.0)
            self.closings[touching] += touch == 0.0
            self.joined.touch[touching] = np.where(touch == 0.0, sides, 0.0)
            self.pace[touching] = np.inf
        self.done[met(ABOVE, BELOW)] = True
        self.done[rest] |= self.ends.reversal
        arrived = why == Why.OTHER_GOAL
        self.done[who[arrived & (goal == self.ends.turned[who])]] = True
        far = who[arrived & (np.abs(goal) == self.ends.most_turned[who])]
        self._give_up(far[~self.done[far]])
        self.unsettled[who[~np.isin(why, (Why.FULL, Why.STEEP, BREAKS_LOOSE, TURNS))]] = True
        at_mark = who[arrived]
        self._tell_endless(rest, at_mark, who)

    def _tell_endless(self, rest: np.ndarray, at_mark: np.ndarray, who: np.ndarray) -> None:
        """Give up runs that never end.

        These are runs that swing no farther forward than at their last stop, that repeat the cycle before, or that
        slow down for ever without stopping.
        """
        rest = rest[~self.done[rest] & self._never_changes(rest) & (self.joined.crank_way[rest] > 0.0)]
        turned = self.state[TURNED, rest]
        again = turned <= self.farthest_swing[rest] + SAME_SWING
        if self.ends.rest:
            # A run to rest gets there if each swing is smaller than the last.
            again &= turned >= self.farthest_swing[rest] - SAME_SWING
        self.farthest_swing[rest] = turned
        self._give_up(rest[again])
        speeds, moves = np.abs(self.state[[CRANK_SPEED, SHAFT_SPEED]]), self.joined.crank_way != 0.0
        faded = who[moves[who] & (speeds[0, who] > 0.0) & (speeds[0, who] < FADED * self.highs[0, who])]
        self._give_up(faded[~self.done[faded] & self._fades(faded)])
        stands = who[~moves[who]]
        passed = np.floor(self.state[SHAFT_TURNED, stands] / self.cycle) != np.floor(self.marks[2, stands] / self.cycle)
        for some in (at_mark[moves[at_mark] & np.isinf(self.ends.turned[at_mark])], stands[passed]):
            mine = some[~self.done[some] & self._never_changes(some)]
            now = np.array(
                [*self.state[[CRANK_SPEED, SHAFT_SPEED]][:, mine], self.state[SHAFT_TURNED, mine], moves[mine]]
            )
            before = self.marks[:, mine]
            whole = np.isclose(np.mod(self.state[TURNED, mine] / self.cycle + 0.5, 1.0), 0.5, rtol=0.0, atol=NEARLY)
            compared = (whole | ~moves[mine]) & (now[3] == before[3])
            same = np.abs(now[:2] - before[:2]) <= SETTLED * np.abs(now[:2]).max(axis=0)
            self.marks[:, mine] = np.where(whole | ~moves[mine], now, before)
            self._give_up(mine[compared & same.all(axis=0)])


def _grip(sides: CoupledSides, engaged: np.ndarray) -> np.ndarray:
    """Torque capacity of locked clutches [N·m], a given time after their engagement [s]."""
    return sides.coupling.capacity_at(engaged) * (1.0 + GRIP)


def highest(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Maximum of equally spaced values along the first axis, on the quartic around the largest; and its location.

    Parameters
    ----------
    values : ndarray (places, steps)

    Returns
    -------
    value, share : ndarray (steps,)
        The location is a fraction of the interval from the first node to the last.
    """
    last, column = len(values) - 1, np.arange(values.shape[1])
    k = values.argmax(axis=0)
    centre = np.clip(k, 2, last - 2)
    a, b, c, d, e = (values[centre + way, column] for way in (-2, -1, 0, 1, 2))
    # Taylor coefficients of the quartic about its middle node.
    first, second = (a - 8.0 * b + 8.0 * d - e) / 12.0, (-a + 16.0 * b - 30.0 * c + 16.0 * d - e) / 24.0
    third, fourth = (e - 2.0 * d + 2.0 * b - a) / 12.0, (e - 4.0 * d + 6.0 * c - 4.0 * b + a) / 24.0
    begin = (k - centre).astype(float)
    x = begin.copy()
    for _ in range(NEWTONS):
        slope = first + x * (2.0 * second + x * (3.0 * third + x * 4.0 * fourth))
        x = x - slope / (2.0 * second + x * (6.0 * third + x * 12.0 * fourth))
    top = c + x * (first + x * (second + x * (third + x * fourth)))
    sound = (np.abs(x - begin) <= 1.0) & (x + centre >= 0.0) & (x + centre <= last) & (top >= values[k, column])
    place = np.where(sound, x, begin) + centre
    return np.where(sound, top, values[k, column]), place / last
