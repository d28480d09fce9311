"""Runs at two speeds: from a given state until an angle, a time, a speed, rest, or until the clutch locks up.

Variants go step by step side by side, each with a length of its own. A step ends where a clutch stops slipping or
breaks loose, where a side comes to rest or sets off, where moments jump, and where the run is to end. These places are
found on the polynomial within the step, and a shorter step leads there.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from engine.cycle.regula_falsi import regula_falsi
from engine.motion.coupled.coupled_step import (
    APART,
    BACKWARDS,
    CRANK,
    CRANK_SPEED,
    FLUID,
    FORWARDS,
    MOVING,
    SHAFT,
    SHAFT_SPEED,
    TOGETHER,
    WORKS,
    CoupledStep,
    coupled_step,
    coupling_pull,
)
from engine.motion.coupled.two_sides import CoupledSides, Joined
from engine.motion.moments.breaks import JUMP
from engine.verdicts import Verdict

TOLERANCE, FARTHEST_TURN = 1e-10, 0.25 * np.pi
# A step's estimated error goes with its length to the eighth power.
SAFETY, SHRINK, GROW = 0.9, 0.2, 4.0
# Least share of a step that Newton's method goes on from.
NEWTON_LEAST = 0.02
# Shares of a step at which it is looked for places to end it, and at which speeds are looked at.
LOOKS = (0.0, 0.25, 0.5, 0.75, 1.0)
SPEED_LOOKS = tuple(i / 8 for i in range(9))
# Share of the moments by which they exceed what holds a standing side, where it sets off.
SURELY = 1e-11
# By this share of its capacity a clutch holds more than it transmits slipping: less than any step misses.
GRIP = 1e-11
# A step that ends so near to a jump of the moments ends at it [rad]: a tenth of half the jump's width.
LANDED = 0.1 * JUMP
# So small a share of a step is none: what would end there was there at its begin.
NO_STEP = 1e-9
MOST_STEPS = 100_000
# After so many attempts, what would end a step at its very begin does.
MOST_ATTEMPTS = 12
# Speeds that change by no more in a cycle stay as they are; a share of the greatest speed that counts as rest where
# nothing stops a machine; swings that differ by no more are the same [rad].
SETTLED, FADED, SAME_SWING = 1e-8, 1e-9, 1e-6
# What ends a step, besides its length.
LOCKS_UP, CRANK_RESTS, SHAFT_RESTS, AT_JUMP, AT_ANGLE, TOO_FAR, ABOVE, BELOW, BREAKS_LOOSE, SETS_OFF, AT_INSTANT = (
    range(11)
)


class CoupledEnds(NamedTuple):
    """Where runs end, (variants,): angle turned [rad], time [s], speed of the crank [rad/s]; infinite for never.

    `rest` says whether the run ends when the crank rests, `reversal` whether where it stands, be it for a moment,
    `lock_up` whether it does when the clutch holds; `most_turned` [rad] is where it is given up.
    """

    turned: np.ndarray
    time: np.ndarray
    speed: np.ndarray
    rest: bool
    lock_up: bool
    most_turned: np.ndarray
    reversal: bool = False

    def some(self, who: np.ndarray) -> "CoupledEnds":
        """Of some of the variants, by index."""
        rows = {key: getattr(self, key)[who] for key in ("turned", "time", "speed", "most_turned")}
        return self._replace(**rows)


class CoupledRuns:
    """Runs of a number of variants on their way.

    Parameters
    ----------
    sides : CoupledSides
    speeds : tuple of ndarray (variants,)
        Of the crank and of the shaft at the begin, reduced to the crank [rad/s].
    clock, engaged : ndarray (variants,)
        Time at the begin, and since the coupling is engaged [s].
    ends : CoupledEnds
    loose : bool
        Whether steps may miss more, for comparison.
    record : bool
        Whether to keep the history (of a single variant).

    Attributes
    ----------
    state : ndarray (rows, variants)
        Now, as of `coupled_step`; angles counted from the begin of the run.
    time : ndarray (variants,)
        Since the begin of the run [s].
    joined : Joined
    verdict : ndarray of uint8
    done : ndarray of bool
    lows, highs : ndarray (2, variants)
        Least and greatest speeds of the crank and of the shaft [rad/s].
    covered : ndarray (2, variants)
        Least and greatest angle turned by the crank [rad].
    peak : ndarray
        Greatest moment of the coupling by magnitude [N·m].
    slip_time : ndarray
        For how long a clutch slipped [s].
    lock_time, lock_speed : ndarray
        When it held last, and how fast the crank turned then; NaN where it never did.
    notes : list of ndarray or None
        Time, angle of the crank, both speeds and moment of the coupling, where they are kept.
    """

    def __init__(
        self,
        sides: CoupledSides,
        speeds: tuple[np.ndarray, np.ndarray],
        clock: np.ndarray,
        engaged: np.ndarray,
        ends: CoupledEnds,
        loose: bool = False,
        record: bool = False,
    ) -> None:
        self.sides, self.ends, count = sides, ends, sides.count
        self.cycle = sides.crank.dynamics.cycle
        # For comparison, steps of nearly twice the length.
        self.tolerance, self.farthest = TOLERANCE * (2.0**6 if loose else 1.0), FARTHEST_TURN * (2.0 if loose else 1.0)
        self.state = np.zeros((WORKS + 1 + len(sides.crank.dynamics.channels), count))
        self.state[CRANK_SPEED], self.state[SHAFT_SPEED] = speeds
        self.time, zero = np.zeros(count), np.zeros(count)
        self.pace, self.aims = np.full(count, np.inf), np.full(count, np.inf)
        self.joined = Joined(np.zeros(count, int), zero.copy(), zero.copy(), clock, engaged)
        self.verdict, self.done = np.full(count, Verdict.OK, np.uint8), np.zeros(count, bool)
        self.lows, self.highs = np.array(speeds), np.array(speeds)
        self.covered = np.zeros((2, count))
        self.peak, self.slip_time = np.zeros(count), np.zeros(count)
        self.lock_time, self.lock_speed = np.full(count, np.nan), np.full(count, np.nan)
        self.above = np.where(ends.speed > speeds[0], ends.speed, np.inf)
        self.below = np.where(ends.speed < speeds[0], ends.speed, -np.inf)
        self.done |= ends.speed == speeds[0]
        self.unsettled, self.attempts = np.ones(count, bool), np.zeros(count, int)
        self.marks, self.farthest_swing = np.full((4, count), np.nan), np.full(count, np.nan)
        self.notes: list[np.ndarray] | None = [] if record else None

    def go_to_end(self) -> None:
        """Carry the runs to their end, in place."""
        pool, sides = np.arange(self.sides.count), self.sides
        # What isn't finite ends as a verdict, not as a warning.
        with np.errstate(all="ignore"):
            for _ in range(MOST_STEPS):
                self._settle(np.flatnonzero(self.unsettled & ~self.done))
                live = np.flatnonzero(~self.done)
                if not live.size:
                    return
                if 2 * live.size <= pool.size:
                    pool, sides = live, self.sides.some(live)
                self._advance(pool, sides)
        self._give_up(np.flatnonzero(~self.done))

    def _give_up(self, who: np.ndarray) -> None:
        """End runs that go on for ever: with the clutch slipping, the crank standing, or as they are."""
        slips, stands = np.abs(self.joined.mode[who]) == FORWARDS, self.joined.crank_way[who] == 0.0
        verdict = np.where(slips, Verdict.SLIPS, np.where(stands, Verdict.STALLS, Verdict.NO_END))
        self.verdict[who], self.done[who] = verdict, True

    def _never_changes(self, who: np.ndarray) -> np.ndarray:
        """Of which variants nothing depends on time any more, and no time ends the run."""
        free = np.isinf(self.ends.time[who]) & np.isinf(self._longest(who))
        return free & (not self.sides.crank.dynamics.changing)

    # How the sides are joined

    def _settle(self, who: np.ndarray) -> None:
        """Decide whether the sides of some variants go together, and which way each goes."""
        if not who.size:
            return
        self.unsettled[who] = False
        sides, joined, moving = self.sides.some(who), self.joined.some(who), self.state[:MOVING, who]
        ways = np.sign(moving[CRANK_SPEED]), np.sign(moving[SHAFT_SPEED])
        mode = np.full(who.size, APART if sides.open else FLUID)
        if not (sides.open or sides.is_fluid):
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
        begun = self.state[CRANK, stands] != 0.0
        self.done[stands] |= (self.ends.rest | self.ends.reversal) & begun
        # Both stand: until a moment over time or the clutch changes, or the time is over.
        both = who[(ways[0] == 0.0) & (ways[1] == 0.0)]
        both = both[~self.done[both]]
        for_ever = both[~np.isfinite(self._longest(both))]
        self.done[for_ever] = True
        self.verdict[for_ever] = Verdict.OK if self.ends.rest or self.ends.reversal else Verdict.STALLS
        self._pass_jumps(who)

    def _holding(
        self, sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray, ways: tuple[np.ndarray, ...]
    ) -> np.ndarray:
        """Whether clutches hold or slip, and which way."""
        slip = np.sign(moving[SHAFT_SPEED] - moving[CRANK_SPEED]).astype(int)
        standing = (ways[0] == 0.0) & (ways[1] == 0.0)
        forth, back, _, shaft_forth, _, shaft_back = self._free(sides, joined, moving, time)
        off = np.where(standing, np.where(forth > 0.0, 1.0, np.where(back < 0.0, -1.0, 0.0)), ways[0])
        capacity = _grip(sides, joined.engaged + time)
        trial = joined._replace(mode=np.full(slip.size, TOGETHER), crank_way=off, shaft_way=off)
        needed = coupling_pull(sides, trial, moving, time).moment
        # Where both stand, either may be held by its own resistances.
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
        """Moments that set off both sides together, forwards and backwards; so of the crank and of the shaft alone."""
        forth = np.ones(time.size)
        found = []
        for way in (forth, -forth):
            turned, w1, _, w2 = moving
            rows, of_crank = sides.crank.at(turned, w1, joined.clock + time, way)
            crank = of_crank.total[0] - 0.5 * w1 * w1 * rows.inertia_phi[0]
            found.append((crank, sides.shaft.moments(w2, way).total[0]))
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
        """Which way each side goes: as it moves, or as it sets off from rest."""
        both_forth, both_back, forth, shaft_forth, back, shaft_back = self._free(sides, joined, moving, time)
        moment = coupling_pull(sides, joined._replace(mode=mode), moving, time).moment
        holds = mode == TOGETHER

        def off(low: np.ndarray, high: np.ndarray) -> np.ndarray:
            return np.where(high > 0.0, 1.0, np.where(low < 0.0, -1.0, 0.0))

        crank = np.where(holds, off(both_back, both_forth), off(back + moment, forth + moment))
        shaft = np.where(holds, crank, off(shaft_back - moment, shaft_forth - moment))
        return np.where(ways[0] == 0.0, crank, ways[0]), np.where(ways[1] == 0.0, shaft, ways[1])

    # Places where moments jump

    def _ahead(self, who: np.ndarray) -> np.ndarray:
        """How far it is to each place where moments jump or bend, the way the crank goes, (places, variants)."""
        crank = self.sides.crank
        way = crank.variants.direction[who]
        here = crank.start[who] + way * self.state[CRANK, who]
        facing = np.where(self.joined.crank_way[who] < 0.0, -1.0, 1.0)
        return np.mod(way * facing * (crank.variants.breaks.angles[:, who] - here), self.cycle)

    def _pass_jumps(self, who: np.ndarray) -> None:
        """Take cranks that are within the width of a jump, or at it, to the other side."""
        who = who[self.joined.crank_way[who] != 0.0]
        ahead = self._ahead(who)
        ahead = np.where(ahead > 0.5 * self.cycle, ahead - self.cycle, ahead)
        within = np.where(np.abs(ahead) <= 1.5 * JUMP, ahead + JUMP, 0.0)
        farthest = np.fmax.reduce(within, axis=0, initial=0.0)
        self.state[CRANK, who] += self.joined.crank_way[who] * farthest

    def _goal(self, who: np.ndarray) -> np.ndarray:
        """Angle turned at the next place where moments jump or bend."""
        ahead = self._ahead(who) - JUMP
        nearest = np.fmin.reduce(np.where(ahead > 0.0, ahead, np.inf), axis=0, initial=np.inf)
        way = np.where(self.joined.crank_way[who] < 0.0, -1.0, 1.0)
        # What may go on for ever is compared with itself from cycle to cycle.
        cycles = (np.floor((way * self.state[CRANK, who] + LANDED) / self.cycle) + 1.0) * self.cycle
        compared = np.isinf(self.ends.turned[who]) & np.isinf(self.ends.time[who])
        nearest = np.where(compared, np.fmin(nearest, cycles - way * self.state[CRANK, who]), nearest)
        return self.state[CRANK, who] + way * nearest

    # Steps

    def _longest(self, who: np.ndarray) -> np.ndarray:
        """Time to the next instant at which a moment over time, or the clutch, changes, or to the end [s]."""
        time = self.time[who]
        instants = self.sides.crank.variants.instants[:, who] - self.joined.clock[who]
        knots = self.sides.coupling.times[:, who] - self.joined.engaged[who]
        every = np.concatenate((instants, knots if not self.sides.open else knots[:0], self.ends.time[who][None]))
        later = np.where(every > time * (1.0 + 1e-15), every, np.inf)
        return later.min(axis=0) - time

    def _length(
        self, who: np.ndarray, sides: CoupledSides, joined: Joined, goal: np.ndarray, longest: np.ndarray
    ) -> np.ndarray:
        """Length of the next step."""
        state, time = self.state[:, who], self.time[who]
        fresh = np.isinf(self.pace[who])
        if fresh.any():
            found = coupling_pull(sides, joined, state[:MOVING], time)
            speed = np.maximum(np.abs(state[CRANK_SPEED]), np.abs(state[SHAFT_SPEED]))
            change = np.maximum(np.abs(found.crank), np.abs(found.shaft))
            # A hundredth of the time that a radian takes; moments that pull speeds together leave less.
            first = 0.01 / np.maximum(np.maximum(speed, np.sqrt(change)), found.rate)
            self.pace[who] = np.where(fresh, first, self.pace[who])
        h = np.fmin(self.pace[who], longest)
        speed, ahead = np.abs(state[CRANK_SPEED]), np.abs(goal - state[CRANK])
        h = np.where(joined.crank_way != 0.0, np.fmin(h, np.fmin(self.farthest, ahead) / speed), h)
        h = np.fmin(h, self.aims[who])
        # Where both stand, what is looked for is when one sets off.
        h = np.where((joined.crank_way == 0.0) & (joined.shaft_way == 0.0), longest, h)
        return np.where(self.done[who], 0.0, h)

    def _advance(self, who: np.ndarray, sides: CoupledSides) -> None:
        """A step of some variants, or an attempt at one that was too long."""
        joined, time, goal = self.joined.some(who), self.time[who], self._goal(who)
        longest = self._longest(who)
        h = self._length(who, sides, joined, goal, longest)
        step = coupled_step(sides, joined, self.state[:, who], time, h, goal, self.tolerance)
        share = np.clip(SAFETY * step.missed ** (-1.0 / 8.0), SHRINK, GROW)
        share = np.where(np.isnan(share), SHRINK, share)
        live = ~self.done[who]
        # What moments do beyond a jump isn't known: by Newton's method to the length that ends at it.
        past = np.where(joined.crank_way == 0.0, -np.inf, joined.crank_way * (step.end[CRANK] - goal))
        beyond = live & (past > LANDED)
        shorter = np.clip(1.0 - past / (np.abs(step.end[CRANK_SPEED]) * h), NEWTON_LEAST, 1.0)
        # Where a step missed, its end says nothing of how far the jump is.
        shorter = np.where(step.missed <= 1.0, shorter, np.fmin(shorter, share))
        self.aims[who] = np.where(beyond, h * shorter, np.inf)
        taken = live & (step.missed <= 1.0) & ~beyond
        limited = beyond | (taken & (h < self.pace[who]))
        self.pace[who] = np.where(
            live, np.where(limited, np.fmax(self.pace[who], h * share), h * share), self.pace[who]
        )
        lost = live & ~taken & ~beyond & (h < 1e-14 * np.maximum(time, 1e-300)) & (h < 1e-14)
        self.verdict[who[lost]], self.done[who[lost]] = Verdict.NOT_FINITE, True
        ended, kind = self._ended(who, sides, joined, step, time, np.flatnonzero(taken))
        kind = np.where(taken & (kind < 0) & (past >= -LANDED), AT_JUMP, kind)
        at_once = taken & (kind >= 0) & (ended < NO_STEP) & (self.attempts[who] < MOST_ATTEMPTS)
        self.pace[who[at_once]] = h[at_once] * SHRINK
        self.attempts[who[at_once]] += 1
        taken &= ~at_once
        sub = np.flatnonzero(taken & (kind >= 0) & (kind != AT_JUMP))
        if sub.size:
            some, length = sides.some(sub), (ended * h)[sub]
            begin = step.begin[:, sub]
            short = coupled_step(some, joined.some(sub), begin, time[sub], length, goal[sub], self.tolerance)
            for whole, part in zip(step, short, strict=True):
                whole[..., sub] = part
        self._take(who, sides, joined, step, time, taken)
        self._after(who, np.where(taken & (kind < 0) & (h >= longest), AT_INSTANT, kind), goal, taken)

    def _ended(
        self,
        who: np.ndarray,
        sides: CoupledSides,
        joined: Joined,
        step: CoupledStep,
        time: np.ndarray,
        taken: np.ndarray,
    ) -> tuple[np.ndarray, np.ndarray]:
        """At which share of a step each variant comes to a place that ends it, and what it is; −1 where to none."""
        share, kind = np.ones(who.size), np.full(who.size, -1)
        turns = joined.crank_way[taken] != 0.0
        lanes = dict.fromkeys(range(SETS_OFF + 1), taken)
        lanes[BREAKS_LOOSE] = taken[turns & (joined.mode[taken] == TOGETHER)]
        lanes[AT_JUMP] = taken[:0]
        lanes[SETS_OFF] = taken[~turns | (joined.shaft_way[taken] == 0.0)]
        looked = [(step.at(np.full(who.size, x)), time + x * step.length) for x in LOOKS[1:]]
        for what, every in lanes.items():
            if not every.size:
                continue
            beyond = self._place(what, who, sides, joined, every)
            above = np.array([beyond(moving[:, every], now[every]) > 0.0 for moving, now in looked])
            met = np.flatnonzero(above.any(axis=0))
            if not met.size:
                continue
            sub, first = every[met], above[:, met].argmax(axis=0)
            begin, end = np.array(LOOKS)[first], np.array(LOOKS)[first + 1]
            place = self._along(self._place(what, who, sides, joined, sub), step.some(sub), time[sub])
            root = np.where(place(begin) >= 0.0, begin, regula_falsi(place, begin, end))
            sooner = (root < share[sub]) | ((kind[sub] < 0) & (root <= share[sub]))
            share[sub], kind[sub] = np.where(sooner, root, share[sub]), np.where(sooner, what, kind[sub])
        return share, kind

    def _place(
        self,
        what: int,
        who: np.ndarray,
        sides: CoupledSides,
        joined: Joined,
        sub: np.ndarray,
    ) -> Callable[[np.ndarray, np.ndarray], np.ndarray]:
        """How far motion is beyond a place that ends a step, by angles and speeds and the time; of variants `sub`."""
        who, joined = who[sub], joined.some(sub)
        ends, way = self.ends.some(who), joined.crank_way
        if what in (BREAKS_LOOSE, SETS_OFF):
            sides = sides.some(sub)

        free = (joined.shaft_way != 0.0) & (joined.mode != TOGETHER)
        places: dict[int, Callable[[np.ndarray, np.ndarray], np.ndarray]] = {
            LOCKS_UP: lambda m, _: np.where(
                np.abs(joined.mode) == FORWARDS, joined.mode * (m[CRANK_SPEED] - m[SHAFT_SPEED]), -1.0
            ),
            CRANK_RESTS: lambda m, _: np.where(way != 0.0, -way * m[CRANK_SPEED], -1.0),
            SHAFT_RESTS: lambda m, _: np.where(free, -joined.shaft_way * m[SHAFT_SPEED], -1.0),
            AT_ANGLE: lambda m, _: m[CRANK] - ends.turned,
            TOO_FAR: lambda m, _: np.abs(m[CRANK]) - ends.most_turned,
            ABOVE: lambda m, _: m[CRANK_SPEED] - self.above[who],
            BELOW: lambda m, _: self.below[who] - m[CRANK_SPEED],
            BREAKS_LOOSE: lambda m, now: (
                np.abs(coupling_pull(sides, joined, m, now).moment) - _grip(sides, joined.engaged + now)
            ),
            SETS_OFF: lambda m, now: self._push_off(sides, joined, m, now),
        }
        return places[what]

    @staticmethod
    def _along(
        place: Callable[[np.ndarray, np.ndarray], np.ndarray], step: CoupledStep, time: np.ndarray
    ) -> Callable[[np.ndarray], np.ndarray]:
        """How far motion is beyond a place, by the share of a step."""
        return lambda share: place(step.at(share), time + share * step.length)

    def _push_off(self, sides: CoupledSides, joined: Joined, moving: np.ndarray, time: np.ndarray) -> np.ndarray:
        """By how much the moments on a standing side exceed what holds it."""
        both_forth, both_back, forth, shaft_forth, back, shaft_back = self._free(sides, joined, moving, time)
        moment, holds = coupling_pull(sides, joined, moving, time).moment, joined.mode == TOGETHER
        crank = np.maximum(forth + moment, -(back + moment))
        shaft = np.maximum(shaft_forth - moment, -(shaft_back - moment))
        apart = np.maximum(
            np.where(joined.crank_way == 0.0, crank, -np.inf), np.where(joined.shaft_way == 0.0, shaft, -np.inf)
        )
        # So that it is sure to set off from where it does.
        surely = SURELY * np.maximum.reduce(np.abs((forth, shaft_forth, moment)))
        if not holds.any():
            return apart - surely
        capacity = _grip(sides, joined.engaged + time)
        alone = np.maximum.reduce((forth - capacity, -back - capacity, shaft_forth - capacity, -shaft_back - capacity))
        return np.where(holds, np.maximum(np.maximum(both_forth, -both_back), alone), apart) - surely

    # After a step

    def _take(
        self,
        who: np.ndarray,
        sides: CoupledSides,
        joined: Joined,
        step: CoupledStep,
        time: np.ndarray,
        taken: np.ndarray,
    ) -> None:
        """Take over the state after a step, and what was greatest and least on the way."""
        mine = who[taken]
        self.attempts[mine] = 0
        self.state[:, mine], self.time[mine] = step.end[:, taken], (time + step.length)[taken]
        everywhere = [step.at(np.full(who.size, x)) for x in SPEED_LOOKS]
        speeds = np.array([moving[[CRANK_SPEED, SHAFT_SPEED]] for moving in everywhere])
        low, high = -greatest_between(-speeds), greatest_between(speeds)
        self.lows[:, mine] = np.fmin(self.lows[:, mine], low[:, taken])
        self.highs[:, mine] = np.fmax(self.highs[:, mine], high[:, taken])
        self.covered[0, mine] = np.fmin(self.covered[0, mine], self.state[CRANK, mine])
        self.covered[1, mine] = np.fmax(self.covered[1, mine], self.state[CRANK, mine])
        looks = [everywhere[SPEED_LOOKS.index(x)] for x in LOOKS]
        instants = [time + x * step.length for x in LOOKS]
        between = [coupling_pull(sides, joined, looks[i], instants[i]).moment for i in range(1, len(LOOKS) - 1)]
        standing = (joined.mode == TOGETHER) & (joined.crank_way == 0.0)
        moments = np.where(standing, 0.0, np.array([step.moments[0], *between, step.moments[1]]))
        self.peak[mine] = np.fmax(self.peak[mine], greatest_between(np.abs(moments))[taken])
        slips = np.abs(joined.mode[taken]) == FORWARDS
        self.slip_time[mine] += np.where(slips, step.length[taken], 0.0)
        if self.notes is not None and taken.all():
            for at, now, moment in zip(looks, instants, moments, strict=True):
                self.notes.append(np.array([now, at[CRANK], at[CRANK_SPEED], at[SHAFT_SPEED], moment]))

    def _after(self, who: np.ndarray, kind: np.ndarray, goal: np.ndarray, taken: np.ndarray) -> None:
        """What follows from a place that ended a step."""

        def met(*kinds: int) -> np.ndarray:
            return who[taken & np.isin(kind, kinds)]

        locked, at_jump = met(LOCKS_UP), taken & (kind == AT_JUMP)
        if locked.size:
            # Of what rounding leaves between the speeds, the heavier side says more.
            sides, moving = self.sides.some(locked), self.state[:MOVING, locked]
            crank = sides.crank.at(moving[CRANK], moving[CRANK_SPEED], self.time[locked], np.ones(locked.size))
            crank, shaft = crank[0].inertia[0], sides.shaft.inertia
            both = (crank * moving[CRANK_SPEED] + shaft * moving[SHAFT_SPEED]) / (crank + shaft)
            # A side that stands, or comes to rest just then, does.
            both = np.where(self.joined.crank_way[locked] == 0.0, 0.0, both)
            self.state[CRANK_SPEED, locked] = self.state[SHAFT_SPEED, locked] = both
        rest = met(CRANK_RESTS)
        together = rest[self.joined.mode[rest] == TOGETHER]
        self.state[CRANK_SPEED, rest], self.state[SHAFT_SPEED, together] = 0.0, 0.0
        self.state[SHAFT_SPEED, met(SHAFT_RESTS)] = 0.0
        self.state[CRANK, who[at_jump]] = goal[at_jump]
        torn = met(BREAKS_LOOSE)
        if torn.size:
            found = coupling_pull(
                self.sides.some(torn), self.joined.some(torn), self.state[:MOVING, torn], self.time[torn]
            )
            self.joined.mode[torn] = np.where(found.moment > 0.0, FORWARDS, BACKWARDS)
            self.lock_time[torn] = self.lock_speed[torn] = np.nan
        exact = met(AT_ANGLE)
        self.state[CRANK, exact] = self.ends.turned[exact]
        self.done[met(AT_ANGLE, ABOVE, BELOW)] = True
        self.done[rest] |= self.ends.reversal
        self._give_up(met(TOO_FAR))
        mine = who[taken]
        self.done[mine[self.time[mine] >= self.ends.time[mine] * (1.0 - 1e-15)]] = True
        self.unsettled[met(LOCKS_UP, CRANK_RESTS, SHAFT_RESTS, AT_JUMP, SETS_OFF, AT_INSTANT)] = True
        self._tell_endless(rest, who[at_jump], mine)

    def _tell_endless(self, rest: np.ndarray, at_mark: np.ndarray, who: np.ndarray) -> None:
        """Give up runs that never come to their end.

        Those that come no farther forward than when they came to rest the last time, that go as they did a cycle
        before, that go ever more slowly and don't come to rest.
        """
        rest = rest[~self.done[rest] & self._never_changes(rest) & (self.joined.crank_way[rest] > 0.0)]
        turned = self.state[CRANK, rest]
        again = turned <= self.farthest_swing[rest] + SAME_SWING
        if self.ends.rest:
            # What is lost in each swing brings it to rest.
            again &= turned >= self.farthest_swing[rest] - SAME_SWING
        self.farthest_swing[rest] = turned
        self._give_up(rest[again])
        speeds, moves = np.abs(self.state[[CRANK_SPEED, SHAFT_SPEED]]), self.joined.crank_way != 0.0
        faded = who[moves[who] & (speeds[0, who] > 0.0) & (speeds[0, who] < FADED * self.highs[0, who])]
        self._give_up(faded[~self.done[faded] & self._never_changes(faded)])
        stands = who[~moves[who]]
        passed = np.floor(self.state[SHAFT, stands] / self.cycle) != np.floor(self.marks[2, stands] / self.cycle)
        for some in (at_mark[moves[at_mark] & np.isinf(self.ends.turned[at_mark])], stands[passed]):
            mine = some[~self.done[some] & self._never_changes(some)]
            now = np.array([*self.state[[CRANK_SPEED, SHAFT_SPEED]][:, mine], self.state[SHAFT, mine], moves[mine]])
            before = self.marks[:, mine]
            whole = np.isclose(np.mod(self.state[CRANK, mine] / self.cycle + 0.5, 1.0), 0.5, rtol=0.0, atol=NO_STEP)
            compared = (whole | ~moves[mine]) & (now[3] == before[3])
            same = np.abs(now[:2] - before[:2]) <= SETTLED * np.abs(now[:2]).max(axis=0)
            self.marks[:, mine] = np.where(whole | ~moves[mine], now, before)
            self._give_up(mine[compared & same.all(axis=0)])


def _grip(sides: CoupledSides, engaged: np.ndarray) -> np.ndarray:
    """Moment that clutches hold [N·m] after they have been engaged for some time [s]."""
    return sides.coupling.capacity_at(engaged) * (1.0 + GRIP)


def greatest_between(values: np.ndarray, even: bool | np.ndarray = True) -> np.ndarray:
    """Greatest of values at some places, the first axis, with the tops of parabolas through three of them.

    Parameters
    ----------
    values : ndarray (places, variants)
    even : bool or ndarray (places - 2, variants) of bool
        Whether a place, the first and the last left out, is as far from the one before as from the one after it.
    """
    low, middle, high = values[:-2], values[1:-1], values[2:]
    bend = low - 2.0 * middle + high
    inside = (middle >= low) & (middle >= high) & (bend < 0.0) & even
    with np.errstate(all="ignore"):
        tops = np.where(inside, middle - (high - low) ** 2 / (8.0 * bend), middle)
    return np.maximum(tops.max(axis=0), np.maximum(values[0], values[-1]))
