"""A run: motion from a given state to an angle, a time, a speed, or rest.

While the energy changes slowly, the independent variable is the crank angle. It is time near rest, backwards, with
torques that depend on time, with friction in pairs, and for an input of limited range. Each variant switches between
the two independently. Ends are met exactly: the last step is shortened to the given angle, time or speed.
"""

from collections.abc import Sequence

import numpy as np

from engine.motion.fields.recorded_motion import Observer
from engine.motion.moments.dynamics import Dynamics, Variants
from engine.motion.runs.one_speed_run import OneSpeedRuns
from engine.motion.runs.run_in_angle import TIMES_TO_THE_END, stretch_over_angle
from engine.motion.runs.run_in_time import BRISK_TO_LOOK, set_off, stretch_over_time
from engine.motion.runs.run_progress import ADAPTIVE, Ends, RunOutcome, Standing, Stepping
from engine.stepping.methods import EIGHT, NINE

# A run is abandoned if this number of steps gains neither a cycle nor this fraction of its time.
MOST_TIME_STEPS, OF_ITS_TIME = 40_000, 0.01


def run_to_end(
    dynamics: Dynamics,
    variants: Variants,
    standing: Standing,
    ends: Ends,
    steps: int,
    stepping: Stepping = ADAPTIVE,
    observers: Sequence[Observer] = (),
) -> RunOutcome:
    """Integrate runs to their end; parameters as for `OneSpeedRuns`."""
    # Infinite or NaN numbers cause a verdict, not a warning.
    with np.errstate(all="ignore"):
        runs = _Runs(dynamics, variants, standing, ends, steps, stepping, observers)
        started = runs.energy()
        runs.go_to_end()
        ended = runs.energy()
        fastest = np.maximum(np.abs(runs.fastest), np.abs(runs.slowest))
        highest = runs.energy_at(np.arange(variants.count), runs.turned, fastest, runs.time)
        energy = np.maximum(highest, np.maximum(started, ended))
    speeds, energies = (runs.slowest, runs.fastest), (started, ended, energy)
    rest = runs.covered, runs.steep, runs.arrived, runs.changed, runs.known
    return RunOutcome(runs.verdict, runs.state, *speeds, *energies, *rest)


class _Runs(OneSpeedRuns):
    """Runs that change between both forms of the equation of motion."""

    # Steps without a gain end a run.
    most_walks = 1_000_000_000

    def go_to_end(self) -> None:
        """Carry the runs to their end, in place."""
        count = self.variants.count
        set_off(self, np.flatnonzero((self.facing == 0.0) & ~self.done))
        self.see_begin()
        if self.ends.standing and self.dynamics.fades:
            # Torques that vanish with the speed stop no machine in finite time.
            self.give_up(np.flatnonzero(~self.done & np.isinf(self.ends.time)))
        self._brisk = self._is_brisk()
        # Steps since the last gain, and the angle and time then.
        self._steps, self._reached, self._until = np.zeros(count), np.zeros(count), np.zeros(count)
        super().go_to_end()

    def advance(self, live: np.ndarray) -> None:
        """Walk over the angle while variants are brisk; then over time, to the next rest or change."""
        fast = live[self._brisk[live]]
        if fast.size:
            stretch_over_angle(self, fast)
            self._brisk[fast], self.pace[fast] = False, np.inf
        set_off(self, np.flatnonzero((self.facing == 0.0) & ~self.done))
        slow = np.flatnonzero(~self._brisk & ~self.done & (self.facing != 0.0))
        if slow.size:
            self.known[slow], self.changed.omega[slow] = False, 0.0
            steep = self.steep[slow] == 1.0
            for own, method in ((slow[~steep], EIGHT), (slow[steep], NINE)):
                if own.size:
                    self._brisk[own], made = stretch_over_time(self, own, method)
                    self._steps[own] += made
            gained = self.turned > self._reached + self.dynamics.cycle
            gained |= self.time > self._until + OF_ITS_TIME * self.ends.time
            self._reached[gained], self._until[gained] = self.turned[gained], self.time[gained]
            self._steps[gained] = 0.0
            self.give_up(np.flatnonzero(~self.done & (self._steps > MOST_TIME_STEPS)))

    def _is_brisk(self) -> np.ndarray:
        """Which variants move forwards with energy that changes slowly."""
        if self.dynamics.in_time:
            return np.zeros(self.variants.count, bool)
        brisk, share = self.omega > 0.0, TIMES_TO_THE_END if self.to_the_end else BRISK_TO_LOOK
        moving = np.flatnonzero(brisk)
        energy = self.energy()[moving]
        torque = self.form.of(moving).torque(self.turned[moving], energy, (self.time + self.clock)[moving])
        brisk[moving] = np.abs(torque) < share * energy
        return brisk
