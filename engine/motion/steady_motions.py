"""Steady running: regimes whose motion repeats with every cycle, at one speed or through a fluid coupling."""

from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from engine.mechanism.actions.motors import motor_ratio
from engine.motion.coupled.coupled_fields import HELD, CoupledFields, HeldFields
from engine.motion.coupled.coupled_steady import one_cycle, settled_at_two_speeds
from engine.motion.coupled.two_sides import coupling_numbers
from engine.motion.fields.field_watch import FieldWatch
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import Observer
from engine.motion.moments.dynamics import Variants
from engine.motion.quantities import Asked, FieldAnswers
from engine.motion.regime_motions import EXTREMES_OF_SPEED, OneRegime, RegimeMotion
from engine.motion.runs.run_progress import CoupledStanding, RunOutcome, Standing
from engine.motion.runs.spread_errors import spread_errors
from engine.motion.settled.return_map import Returned
from engine.motion.settled.sizing import flywheel_for
from engine.motion.settled.steady import Steady, steady_motion
from engine.motion.settled.steady_with_friction import settled_motion
from engine.stepping.records import over_all
from engine.stepping.walk_task import LONGEST
from engine.words.verdicts import Verdict


class _SeenCycle:
    """What is seen of a steady cycle; which variants run in it is known only when it is found."""

    def __init__(self, watch_of: Callable[[MotionFields], FieldWatch]) -> None:
        self._watch_of = watch_of

    def observers(self, along: MotionFields, who: np.ndarray) -> Sequence[Observer]:
        """Observers of the variants `who`, given the fields of their motion."""
        self.watch, self.who = self._watch_of(along), who
        return self.watch.observers


class SteadyMotion(RegimeMotion):
    """Steady running; see `RegimeMotion`."""

    def _watch_cycle(self, along: MotionFields) -> FieldWatch:
        """Observers of a steady cycle for the requested fields, kept at equal steps."""
        asked = [*self.fields, *([Asked("", HELD, "peak")] if isinstance(along, HeldFields) else ())]
        turned = self.reduction.cycle / self._asked.steps * np.arange(self._asked.steps)
        return FieldWatch(along, asked, self._asked.field_tolerance, turned)

    @staticmethod
    def _over_cycle(watch: FieldWatch, who: np.ndarray, count: int, compared: FieldWatch | None = None) -> FieldAnswers:
        """Requested results of the variants `who`, expanded to all; kept fields over the crank angle."""
        found, back = watch.answers(compared), watch.fields.variants.direction < 0.0
        for rows in found.rows.values():
            # The crank angle decreases if the crank turns clockwise.
            rows[back] = np.roll(rows[back, ::-1], 1, axis=1)
        return found.over_all(who, count)

    def _of_cycle(
        self,
        variants: Variants,
        steady: Steady | Returned,
        period: np.ndarray,
        shaft_speed: np.ndarray | None = None,
    ) -> dict[str, np.ndarray]:
        """Results of any steady running; `shaft_speed` is the mean speed of a coupled shaft."""
        scene, n, mean_speed = self.scene, variants.numbers, self.dynamics.cycle / period
        found = {"period": period, "mean_speed": mean_speed}
        found |= {"multiplier": steady.multiplier, "return_residual": steady.residual}
        for motor, action in scene.moments.items():
            if action.type == "induction_motor" and motor not in self.regime.off:
                speed = mean_speed * np.abs(motor_ratio(scene, action, n))
                if shaft_speed is not None and action.on == self.two.coupling.shaft:
                    speed = shaft_speed
                found[f"{motor}_slip"] = 1.0 - speed / n[f"moments.{motor}.synchronous_speed"]
        return found


class SteadyAtOneSpeed(SteadyMotion):
    """Steady running in which everything turns with the crank, also through a clutch; see `RegimeMotion`."""

    def _without_inertia(self, variants: Variants) -> np.ndarray:
        # A flywheel to be determined provides inertia everywhere.
        return np.zeros(variants.count, bool) if self.asks("flywheel") else super()._without_inertia(variants)

    def with_sized_flywheel(self, variants: Variants, longer: float = 1.0) -> tuple[Variants, np.ndarray, np.ndarray]:
        """Variants with the flywheel for the required speed fluctuation, where that is requested.

        Where there is none, the flywheel stays as it is.

        Returns
        -------
        variants : Variants
        missed : ndarray (variants,)
            As for `flywheel_for`.
        verdict : ndarray (variants,)
        """
        if not self.asks("flywheel"):
            return variants, np.zeros(variants.count), np.full(variants.count, Verdict.OK, np.uint8)
        delta = variants.numbers.of_each("flywheel.speed_fluctuation", variants.count)
        wheel, missed, verdict = flywheel_for(self.dynamics, variants, self._asked.tolerance, delta, longer)
        wheel = np.where(verdict == Verdict.OK, wheel, variants.flywheel)
        return variants._replace(flywheel=wheel, kept={}), missed, verdict

    def after(self, variants: Variants, steady: Steady, verdict: np.ndarray) -> Standing:
        """State at the end of steady running, with given verdicts."""
        zero = np.zeros(variants.count)
        omega = np.sqrt(2.0 * steady.energy / self.dynamics.inertia(variants, zero))
        held = CoupledStanding(omega, np.full(variants.count, np.inf)) if self.two else None
        return Standing(zero, omega, zero, verdict.astype(np.uint8), held)

    def _follow(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        kept = variants.kept
        variants, too_heavy, verdict = self.with_sized_flywheel(variants, longer)
        # The comparison takes the one that is too light.
        wheel = variants.flywheel - (too_heavy if longer > 1.0 else 0.0)
        found = {"flywheel": wheel} if self.asks("flywheel") else {}
        steady, off, answers = self._settled(variants, kept, longer)
        missed = {} if off is None else spread_errors(steady, off, partial(self._of_steady, variants), self.asks)
        steady = steady.shifted(off) if off is not None and longer == LONGEST else steady
        found |= self._of_steady(variants, steady)
        if self.two:
            key, held = f"{self.two.name}_moment_peak", f"{HELD}.peak"
            found[key], answers.missed[key] = answers.values.pop(held), answers.missed.pop(held)
            coupling = coupling_numbers(self.scene, variants.numbers, variants.count)
            verdict = np.where(found[key] > coupling.capacity[-1] / coupling.ratio, Verdict.SLIPS, verdict)
        answers.values.update(found)
        answers.missed.update(missed if longer == 1.0 else {})
        # δ is a difference of speeds, and rounds as they do.
        answers.scales["speed_fluctuation"] = np.ones(variants.count)
        verdict = np.where(standing.verdict != Verdict.OK, standing.verdict, np.maximum(verdict, steady.verdict))
        after = self.after(variants, steady, verdict)
        return OneRegime(answers, after, float(self._asked.steps), found["energy"], known=not self.dynamics.rubs)

    def _settled(self, variants: Variants, kept: dict, longer: float) -> tuple[Steady, Steady | None, FieldAnswers]:
        """Steady running, its error estimates where they are known, and the fields of its cycle.

        With known errors, the cycle is also seen shifted by them, for comparison.
        """
        tolerance, count = self._asked.tolerance, variants.count
        if self.dynamics.rubs:
            seen = _SeenCycle(self._watch_cycle)
            steady = settled_motion(
                self.dynamics,
                variants,
                tolerance,
                longer,
                lambda good: seen.observers(self._along_cycle(variants.some(good)), good),
            )
            return steady, None, self._over_cycle(seen.watch, seen.who, count)
        key = "steady", self.name
        if key not in kept:
            both = [self._watch_cycle(self._along_cycle(variants)) for _ in range(2)]
            seers = (watch.observers for watch in both)
            own = steady_motion(self.dynamics, variants, tolerance, *seers, extremes=self.asks(*EXTREMES_OF_SPEED))
            compared = zip(both, (None, both[0]), strict=True)
            kept[key] = *own, [self._over_cycle(watch, np.arange(count), count, other) for watch, other in compared]
        steady, off, answers = kept[key]
        return steady, off, answers[longer > 1.0].copied()

    def _along_cycle(self, variants: Variants) -> MotionFields:
        """Fields in a steady cycle at one speed."""
        zero = np.zeros(variants.count)
        given = self.dynamics, variants, zero, zero, self.loads
        return HeldFields(self.two, *given) if self.two else MotionFields(*given)

    def _of_steady(self, variants: Variants, steady: Steady) -> dict[str, np.ndarray]:
        """Results of steady running by their names without the regime's."""
        low, high, period = steady.slowest, steady.fastest, steady.period
        found = {"speed_min": low, "speed_max": high, "speed_fluctuation": steady.fluctuation}
        found |= {"energy": steady.energy, "implicit_steps": steady.steep}
        if self.asks("motor_moment_peak"):
            found["motor_moment_peak"] = self.dynamics.greatest_moment(variants.numbers, low, high)
        change = steady.ended - steady.energy
        found |= self._work_values(steady.works, steady.squares, period, change, steady.energy)
        return found | self._of_cycle(variants, steady, period)


class SteadyAtTwoSpeeds(SteadyMotion):
    """Steady running through a fluid coupling; see `RegimeMotion`."""

    def _without_inertia(self, variants: Variants) -> np.ndarray:
        return self.two.without_inertia(variants)

    def settled(
        self,
        variants: Variants,
        standing: Standing,
        longer: float = 1.0,
        record: Callable[[CoupledFields, np.ndarray], Sequence[Observer]] = lambda along, good: (),
    ) -> tuple[Returned, RunOutcome, Standing]:
        """Steady running through a fluid coupling, and one cycle of it; parameters as for `RunMotion.run`.

        `record` also receives the indices of the variants in steady running, and makes any number of observers.
        """
        two, count, zero = self.two, variants.count, np.zeros(variants.count)
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        sides, stepping = two.of(variants.some(ready), zero[ready]), self._stepping(longer)
        steady = settled_at_two_speeds(sides, stepping)
        good = np.flatnonzero(steady.verdict == Verdict.OK)
        moving = sides.some(good)
        watching = record(CoupledFields(moving, zero[good], self.loads), ready[good])
        gone = over_all(one_cycle(moving, steady.speeds[:, good], stepping, watching), ready[good], count)
        steady = over_all(steady, ready, count)
        verdict = np.where(standing.verdict != Verdict.OK, standing.verdict, np.maximum(steady.verdict, gone.verdict))
        shaft = CoupledStanding(steady.speeds[1], np.full(count, np.inf))
        steady = steady._replace(verdict=verdict.astype(np.uint8))
        return steady, gone, Standing(zero, steady.speeds[0], zero, steady.verdict, shaft)

    def _follow(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        seen = _SeenCycle(self._watch_cycle)
        steady, gone, after = self.settled(variants, standing, longer, seen.observers)
        answers = self._over_cycle(seen.watch, seen.who, variants.count)
        found = self._of_run(variants, gone) | self._of_coupling(gone)
        low, high, period = gone.slowest, gone.fastest, gone.state.time
        found["speed_fluctuation"] = 2.0 * (high - low) / (high + low)
        answers.values.update(found | self._of_cycle(variants, steady, period, gone.values["shaft_mean_speed"]))
        # δ is a difference of speeds, and rounds as they do.
        answers.scales["speed_fluctuation"] = np.ones(variants.count)
        # Steady running returns exactly.
        answers.missed["return_residual"] = steady.residual
        return OneRegime(answers, after, float(self._asked.steps), gone.energy)
