"""Runs: regimes from a given state to an end, at one speed or at the two of a coupling."""

import math
from abc import abstractmethod
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from engine.graph.values import NodeValues
from engine.motion.coupled.coupled_answers import run_coupled
from engine.motion.coupled.coupled_fields import CoupledFields
from engine.motion.fields.field_watch import FieldWatch
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import Observer
from engine.motion.moments.dynamics import Variants
from engine.motion.quantities import FINAL_POSITION, FieldAnswers
from engine.motion.regime_motions import ROUNDING, OneRegime, RegimeMotion
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_progress import CoupledStanding, Ends, RunOutcome, Standing, Stepping
from engine.motion.runs.spread_errors import spread_errors
from engine.stepping.records import over_all, put, some
from engine.stepping.walk_task import LONGEST
from engine.words.verdicts import Verdict

# Creates the observers of a run from its fields.
Record = Callable[[MotionFields], Sequence[Observer]]


class _Ready(NamedTuple):
    """Variants that run: their indices among all, initial states, ends of their runs, and the cached results of all."""

    which: np.ndarray
    variants: Variants
    standing: Standing
    ends: Ends
    kept: dict

    @property
    def begin(self) -> tuple[Variants, Standing, Ends]:
        """The variants, initial states and ends of a run."""
        return self.variants, self.standing, self.ends

    def some(self, chosen: np.ndarray) -> "_Ready":
        """A subset, by index."""
        standing, ends = some(self.standing, chosen), some(self.ends, chosen)
        return _Ready(self.which[chosen], self.variants.some(chosen), standing, ends, self.kept)

    def alike(self, other: "_Ready") -> np.ndarray:
        """Which variants start from the same state as in other runs of the same variants, (variants,) of bool."""
        parts = ("angle", "omega", "clock")
        return np.all([getattr(self.standing, part) == getattr(other.standing, part) for part in parts], axis=0)


class RunMotion(RegimeMotion):
    """A run, which begins with given numbers or with the state that the regime before left; see `RegimeMotion`."""

    def hindered(self, variants: Variants) -> np.ndarray:
        """As for all regimes, and where a start is outside the range of the input."""
        verdict, keys = super().hindered(variants), self._asked.keys
        if self.reduction.has_cycle or getattr(self.regime, keys.from_place) is None:
            return verdict
        begin = self._number(keys.from_place, variants)
        low, high = self.reduction.range_of(variants.numbers, variants.count)
        outside = (verdict != Verdict.NO_INERTIA) & ((begin < low) | (begin > high))
        return np.where(outside, Verdict.OUTSIDE_LIMITS, verdict).astype(np.uint8)

    def _number(self, key: str, variants: Variants) -> np.ndarray:
        """A number of a run for every variant, infinite if it is not given; a lead's cycles are those up to its end."""
        if getattr(self.regime, key) is None:
            return np.full(variants.count, np.inf)
        if self.name in self._asked.leads:
            place = f"regimes.{self._asked.leads[self.name]}.{self._asked.keys.from_place}"
            share = variants.direction * variants.numbers.of_each(place, variants.count) / self.reduction.cycle
            share = np.mod(share, 1.0)
            return np.where(share > 0.0, share, 1.0)
        return variants.numbers.of_each(f"regimes.{self.name}.{key}", variants.count)

    def run(
        self,
        variants: Variants,
        standing: Standing,
        longer: float = 1.0,
        record: Record | None = None,
    ) -> tuple[RunOutcome, FieldAnswers, Standing]:
        """Run a regime from the current state.

        Parameters
        ----------
        variants : Variants
            With the inertia of all parts.
        standing : Standing
        longer : float
            One of `WALKS`.
        record : callable, optional
            Creates the observers of the run, which replace the requested fields.
        """
        regime, keys, count, cycle = self.regime, self._asked.keys, variants.count, self.reduction.cycle

        def number(key: str) -> np.ndarray:
            return self._number(key, variants)

        given = {"omega": keys.from_speed, "angle": keys.from_place}
        begin = {part: number(key) for part, key in given.items() if getattr(regime, key) is not None}
        begin = standing._replace(**begin)
        if self._asked.begins_anew(regime):
            begin = begin._replace(clock=np.zeros(count))
        begin = self._beginning(begin)
        # Near a speed that is never reached, the time to reach it is as uncertain as its last digits.
        speed = number(keys.speed) * (1.0 - ROUNDING if longer > 1.0 else 1.0)
        flags = (getattr(regime, key) is True for key in ("rest", "reversal", "end_of_range", "lock_up"))
        ends = Ends(number("cycles") * cycle, number("time"), speed, number("at_most") * cycle, *flags)
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        starting = _Ready(ready, variants.some(ready), some(begin, ready), some(ends, ready), variants.kept)
        found = self._run(starting, longer, record)
        outcome, answers = over_all(found[0], ready, count), found[1].over_all(ready, count)
        verdict = np.where(standing.verdict == Verdict.OK, outcome.verdict, standing.verdict).astype(np.uint8)
        # An end of the range stops the input.
        omega = np.where(outcome.arrived != 0, 0.0, outcome.state.omega)
        place, clock = begin.angle + variants.direction * outcome.state.turned, begin.clock + outcome.state.time
        return outcome, answers, Standing(place, omega, clock, verdict, outcome.coupled)

    def _beginning(self, standing: Standing) -> Standing:
        """The state at which the run begins, with that of a coupling's shaft."""
        return standing

    @abstractmethod
    def _run(self, run: "_Ready", longer: float, record: Record | None) -> tuple[RunOutcome, FieldAnswers]:
        """Outcome and requested fields of variants that are ready; arguments as for `run`."""

    def _follow(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        outcome, answers, after = self.run(variants, standing, longer)
        results_of = partial(self._of_run, variants)
        answers.values.update(results_of(outcome) | self._at_end(outcome, after))
        reached, rates = self._slides(variants, after.angle)
        answers.values.update(reached)
        if outcome.changed is not None and longer == 1.0:
            answers.missed.update(spread_errors(outcome, outcome.changed, results_of, self.asks))
        # The work residual is relative to the works, and rounds as they do.
        answers.scales.update(end_reached=np.zeros(variants.count), work_residual=np.ones(variants.count))
        low, high = self.reduction.range_of(variants.numbers, variants.count)
        state, turned = outcome.state, outcome.state.turned
        # A position is as uncertain as all the angle that leads to it.
        answers.scales[FINAL_POSITION] = np.abs(after.angle) + turned
        answers.scales.update({name: np.abs(rate) * answers.scales[FINAL_POSITION] for name, rate in rates.items()})
        made = turned / (high - low) * self._asked.steps
        covered = np.sort(after.angle + variants.direction * (outcome.covered - turned), axis=0)
        ends = None if self.regime.method is None else np.stack((turned, state.omega, state.time))
        known = False if outcome.known is None else outcome.known == 1.0
        return OneRegime(answers, after, made, outcome.energy, covered, ends, known)

    def _at_end(self, outcome: RunOutcome, standing: Standing) -> dict[str, np.ndarray]:
        """Final position; the end of the range at which an input arrives, and the energy of its impact there."""
        place = np.mod(standing.angle, self.reduction.cycle) if self.reduction.has_cycle else standing.angle
        arrived = outcome.arrived.astype(float)
        taken = np.where(outcome.arrived != 0, outcome.ended, 0.0)
        return {FINAL_POSITION: place, "end_reached": arrived, "impact_energy": taken}

    def _slides(self, variants: Variants, place: np.ndarray) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        """Requested positions of sliders, and their derivatives, at positions of the input."""
        graph, slides = self.reduction.mechanics.graph, self.reduction.mechanics.kinematics.slides
        asked = {name: slide for n, slide in slides.items() if self.asks(name := f"{n}.{FINAL_POSITION}")}
        nodes = [*(slide.d for slide in asked.values()), *(slide.v for slide in asked.values())]
        found = NodeValues(graph, variants.numbers, variants.ends.__getitem__)(nodes, place)
        return dict(zip(asked, found, strict=False)), dict(zip(asked, found[len(asked) :], strict=True))


class RunAtOneSpeed(RunMotion):
    """A run of a machine in which everything turns with the crank; see `RegimeMotion`."""

    def _run(self, run: "_Ready", longer: float, record: Record | None) -> tuple[RunOutcome, FieldAnswers]:
        observers = [] if record is None else record(self._along(run))
        key, stepping = ("run", self.name), self._stepping(longer)
        if longer > 1.0 and record is None and key in run.kept:
            # A known run predicts the effect of coarser steps.
            before, known = run.kept[key]
            # In an earlier regime coarser steps may have failed where these didn't, or the reverse.
            _, mine, theirs = np.intersect1d(run.which, before.which, return_indices=True)
            predicted = known.shifted(known.changed) if longer == LONGEST else known
            outcome = over_all(some(predicted, theirs), mine, run.which.size)
            alike = np.zeros(run.which.size, bool)
            alike[mine] = run.some(mine).alike(before.some(theirs)) & known.known[theirs]
            left = np.flatnonzero(~alike)
            if left.size:
                put(outcome, left, run_to_end(self.dynamics, *run.some(left).begin, self._asked.steps, stepping))
        else:
            outcome = run_to_end(self.dynamics, *run.begin, self._asked.steps, stepping, observers)
            run.kept[key] = run, outcome
        if record is not None or not self.fields:
            return outcome, FieldAnswers.none()
        # Fields are evaluated for runs that reach their end.
        good = np.flatnonzero(outcome.verdict == Verdict.OK)
        answers, known = self._along_run(run.some(good), longer)
        whole = outcome.known == 1.0
        whole[good] &= known
        return outcome._replace(known=whole), answers.over_all(good, run.which.size)

    def _stepping(self, longer: float) -> Stepping:
        stepping, steps = super()._stepping(longer), self.regime.steps_per_turn
        return stepping if steps is None else stepping._replace(farthest=math.tau / steps, classical=True)

    def _along(self, run: "_Ready") -> MotionFields:
        """Fields in a run."""
        return MotionFields(self.dynamics, run.variants, run.standing.angle, run.standing.clock, self.loads)

    def _along_run(self, run: "_Ready", longer: float) -> tuple[FieldAnswers, np.ndarray]:
        """Requested fields of a run, and whether its errors are known."""
        kept = self._asked.instants.get(self.name)
        at = () if kept is None else (kept.values, kept.over_time)
        watch = FieldWatch(self._along(run), self.fields, self._asked.field_tolerance, *at)
        outcome = run_to_end(self.dynamics, *run.begin, self._asked.steps, self._stepping(longer), watch.observers)
        if watch.instants is not None:
            state = outcome.state
            watch.instants.finish(outcome.verdict == Verdict.OK, state.turned, state.omega, state.time)
        return watch.answers(), outcome.known

    def _of_run(self, variants: Variants, outcome: RunOutcome) -> dict[str, np.ndarray]:
        found = super()._of_run(variants, outcome)
        if self.asks("motor_moment_peak"):
            speeds = outcome.slowest, outcome.fastest
            found["motor_moment_peak"] = self.dynamics.greatest_moment(variants.numbers, *speeds)
        return found


class RunAtTwoSpeeds(RunMotion):
    """A run in which the shaft behind a coupling has a separate speed; see `RegimeMotion`."""

    def _without_inertia(self, variants: Variants) -> np.ndarray:
        return self.two.without_inertia(variants)

    def _beginning(self, standing: Standing) -> Standing:
        if standing.coupled is not None and self.regime.from_speed is None:
            return standing
        return standing._replace(coupled=CoupledStanding(standing.omega, np.zeros(standing.omega.size)))

    def _run(self, run: "_Ready", longer: float, record: Record | None) -> tuple[RunOutcome, FieldAnswers]:
        sides, standing = self.two.of(run.variants, run.standing.angle), run.standing
        if self.regime.from_shaft_speed is not None:
            shaft = self._number("from_shaft_speed", run.variants) / sides.coupling.ratio
            standing = standing._replace(coupled=standing.coupled._replace(speed=shaft))
        along = CoupledFields(sides, standing.clock, self.loads)
        watch = FieldWatch(along, self.fields if record is None else (), self._asked.field_tolerance)
        observers = watch.observers if record is None else record(along)
        outcome = run_coupled(sides, standing, run.ends, self._stepping(longer), observers)
        return outcome, watch.answers()

    def _of_run(self, variants: Variants, outcome: RunOutcome) -> dict[str, np.ndarray]:
        return super()._of_run(variants, outcome) | self._of_coupling(outcome)
