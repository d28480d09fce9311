"""The motion of a machine in each of its regimes, from the state that the one before left, and its results."""

import math
from collections.abc import Callable, Sequence
from functools import partial
from typing import NamedTuple

import numpy as np

from engine.laws.rounding import EPS
from engine.mechanism.actions.motors import motor_ratio
from engine.motion.asked_regimes import AskedRegimes
from engine.motion.coupled.coupled_answers import run_coupled
from engine.motion.coupled.coupled_fields import HELD, CoupledFields, HeldFields
from engine.motion.coupled.coupled_steady import one_cycle, settled_at_two_speeds
from engine.motion.coupled.two_sides import coupling_numbers
from engine.motion.fields.field_watch import FieldWatch
from engine.motion.fields.motion_fields import MotionFields
from engine.motion.fields.recorded_motion import Observer
from engine.motion.moments.dynamics import Variants
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import Asked, FieldAnswers
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_progress import CoupledStanding, Ends, RunOutcome, Standing, Stepping
from engine.motion.runs.spread_errors import spread_errors
from engine.motion.settled.return_map import Returned
from engine.motion.settled.sizing import flywheel_for
from engine.motion.settled.steady import Steady, steady_motion
from engine.motion.settled.steady_with_friction import settled_motion
from engine.stepping.records import on_arrays, over_all, put, some
from engine.words.verdicts import Verdict

ROUNDING = 16.0 * EPS
# Results that need the minimum and maximum speed.
EXTREMES_OF_SPEED = ("speed_min", "speed_max", "speed_fluctuation", "motor_moment_peak")


class OneRegime(NamedTuple):
    """Results of one regime.

    Attributes
    ----------
    answers : FieldAnswers
        By name without the regime's.
    standing : Standing
        State after it.
    made : ndarray (variants,) or float
        Approximate number of steps, each with its rounding.
    energy : ndarray (variants,)
        Approximate maximum kinetic energy [J].
    covered : ndarray (2, variants) or None
        Minimum and maximum position of the input in a run.
    by_equal_steps : ndarray (3, variants) or None
        Angle turned [rad], final speed [rad/s] and time [s] of a run by equal steps.
    known : ndarray (variants,) or bool
        Whether all errors are propagated, so that one comparison suffices.
    """

    answers: FieldAnswers
    standing: Standing
    made: np.ndarray | float
    energy: np.ndarray
    covered: np.ndarray | None = None
    by_equal_steps: np.ndarray | None = None
    known: np.ndarray | bool = False


class _Ready(NamedTuple):
    """Variants that run: which of all, their initial states, the ends of their runs, and what is kept of all."""

    which: np.ndarray
    variants: Variants
    standing: Standing
    ends: Ends
    kept: dict

    @property
    def begin(self) -> tuple[Variants, Standing, Ends]:
        """What a run starts from."""
        return self.variants, self.standing, self.ends

    def some(self, chosen: np.ndarray) -> "_Ready":
        """A subset, by index."""
        standing, ends = some(self.standing, chosen), some(self.ends, chosen)
        return _Ready(self.which[chosen], self.variants.some(chosen), standing, ends, self.kept)

    def alike(self, other: "_Ready") -> np.ndarray:
        """Which variants start from the same state as in other runs, (variants,) of bool."""
        if not np.array_equal(self.which, other.which):
            return np.zeros(self.which.size, bool)
        states = zip(self.standing[:3], other.standing[:3], strict=True)
        return np.all([mine == its for mine, its in states], axis=0)


class RegimeMotion:
    """The motion of a machine in one of its regimes.

    Parameters
    ----------
    asked : AskedRegimes
    name : str
        Of the regime.

    Attributes
    ----------
    dynamics : Dynamics
    two : TwoSides or None
        Both sides of the scene's coupling.
    is_steady : bool
    """

    def __init__(self, asked: AskedRegimes, name: str) -> None:
        self.name, self.regime, self.is_steady = name, asked.regimes[name], name in asked.steady
        off = frozenset(self.regime.off)
        self.dynamics, self.two, self.reduction = asked.dynamics[off], asked.sides.get(off), asked.reduction
        self.fields, self._at, self.loads = asked.fields[name], asked.instants.get(name), asked.loads
        self._asked, self.scene, self.keys = asked, asked.scene, asked.keys

    def asks(self, *keys: str) -> bool:
        """Whether any of some results of the regime is requested."""
        return not self._asked.asked.isdisjoint(f"{self.name}.{key}" for key in keys)

    @property
    def at_two_speeds(self) -> bool:
        """Whether both sides of a coupling have separate speeds: always, except for a locked clutch."""
        return self.two is not None and (not self.is_steady or self.two.is_fluid)

    def follow(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        """A regime from the current state."""
        hindered = self.hindered(variants)
        standing = standing._replace(verdict=np.where(standing.verdict, standing.verdict, hindered))
        if not self.is_steady:
            return self._ran(variants, standing, longer)
        steady = self._steady_at_two_speeds if self.at_two_speeds else self._steady
        return steady(variants, standing, longer)

    def hindered(self, variants: Variants) -> np.ndarray:
        """Verdict that rules out a regime before it is computed.

        Causes: a brake that locks, zero inertia, a start outside the range of the input.
        """
        verdict = np.where(self.dynamics.locked(variants), Verdict.LOCKS, Verdict.OK)
        if not self.reduction.has_cycle and getattr(self.regime, self.keys.from_place) is not None:
            begin = self._number(self.keys.from_place, variants, 0.0)
            low, high = self.reduction.range_of(variants.numbers, variants.count)
            verdict = np.where((begin < low) | (begin > high), Verdict.OUTSIDE_LIMITS, verdict)
        if self.at_two_speeds:
            bare = self.two.without_inertia(variants)
            return np.where(bare, Verdict.NO_INERTIA, verdict).astype(np.uint8)
        # A flywheel to be determined provides inertia everywhere.
        if not self.asks("flywheel"):
            verdict = np.where(self.reduction.without_inertia(variants), Verdict.NO_INERTIA, verdict)
        return verdict.astype(np.uint8)

    def _number(self, key: str, variants: Variants, otherwise: float) -> np.ndarray:
        """A number of a run for every variant; `otherwise` if it is not given."""
        given = getattr(self.regime, key) is not None
        value = variants.numbers[f"regimes.{self.name}.{key}"] if given else otherwise
        return np.broadcast_to(value, (variants.count,)).astype(float)

    def run(
        self,
        variants: Variants,
        standing: Standing,
        longer: float = 1.0,
        record: Callable[[MotionFields], Sequence[Observer]] | None = None,
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
        regime, keys, count, cycle = self.regime, self.keys, variants.count, self.reduction.cycle

        def number(key: str, otherwise: float = np.inf) -> np.ndarray:
            return self._number(key, variants, otherwise)

        begin, own = standing, {"omega": keys.from_speed, "angle": keys.from_place}
        begin = begin._replace(**{part: number(key) for part, key in own.items() if getattr(regime, key) is not None})
        if self._asked.begins_anew(regime):
            begin = begin._replace(clock=np.zeros(count))
        if self.two and (standing.coupled is None or regime.from_speed is not None):
            begin = begin._replace(coupled=CoupledStanding(begin.omega, np.zeros(count)))
        # Near a speed that is never reached, the time to reach it is as uncertain as its last digits.
        speed = number(keys.speed) * (1.0 - ROUNDING if longer > 1.0 else 1.0)
        flags = (getattr(regime, key) is True for key in ("rest", "reversal", "end_of_range", "lock_up"))
        ends = Ends(number("cycles") * cycle, number("time"), speed, number("at_most") * cycle, *flags)
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        run = self._run_at_two_speeds if self.two else self._run_at_one_speed
        own = _Ready(ready, variants.some(ready), some(begin, ready), some(ends, ready), variants.kept)
        found = run(own, longer, record)
        outcome, answers = over_all(found[0], ready, count), found[1].over_all(ready, count)
        verdict = np.where(standing.verdict == Verdict.OK, outcome.verdict, standing.verdict).astype(np.uint8)
        # An end of the range stops the input.
        omega = np.where(outcome.arrived != 0, 0.0, outcome.state.omega)
        place, clock = begin.angle + variants.direction * outcome.state.turned, begin.clock + outcome.state.time
        return outcome, answers, Standing(place, omega, clock, verdict, outcome.coupled)

    def _run_at_two_speeds(
        self, run: "_Ready", longer: float, record: Callable[[CoupledFields], Sequence[Observer]] | None
    ) -> tuple[RunOutcome, FieldAnswers]:
        sides, standing = self.two.of(run.variants, run.standing.angle), run.standing
        if self.regime.from_shaft_speed is not None:
            shaft = self._number("from_shaft_speed", run.variants, 0.0) / sides.coupling.ratio
            standing = standing._replace(coupled=standing.coupled._replace(speed=shaft))
        along = CoupledFields(sides, standing.clock, self.loads)
        watch = FieldWatch(along, self.fields if record is None else (), self._asked.field_tolerance)
        observers = watch.observers if record is None else record(along)
        outcome = run_coupled(sides, standing, run.ends, self._stepping(longer), observers)
        return outcome, watch.answers()

    def settled_at_two_speeds(
        self,
        variants: Variants,
        standing: Standing,
        longer: float = 1.0,
        record: Callable[[CoupledFields, np.ndarray], Sequence[Observer]] = lambda along, good: (),
    ) -> tuple[Returned, RunOutcome, Standing]:
        """Steady running through a fluid coupling, and one cycle of it; parameters as for `run`.

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

    def _steady_at_two_speeds(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        seen: list[tuple[FieldWatch, np.ndarray]] = []

        def record(along: CoupledFields, good: np.ndarray) -> list[Observer]:
            seen.append((self._watch_cycle(along), good))
            return seen[0][0].observers

        steady, gone, after = self.settled_at_two_speeds(variants, standing, longer, record)
        answers = self._over_cycle(*seen[0], variants.count)
        found = self._of_run(variants, gone)
        low, high, period = gone.slowest, gone.fastest, gone.state.time
        found["speed_fluctuation"] = 2.0 * (high - low) / (high + low)
        answers.values.update(found | self._of_cycle(variants, steady, period, gone))
        # δ is a difference of speeds, and rounds as they do.
        answers.scales["speed_fluctuation"] = np.ones(variants.count)
        # Steady running returns exactly.
        answers.missed["return_residual"] = steady.residual
        return OneRegime(answers, after, float(self._asked.steps), gone.energy)

    def _watch_cycle(self, along: MotionFields) -> FieldWatch:
        """Observers of a steady cycle for the requested fields, kept at equal steps."""
        asked = [*self.fields, *([Asked("", HELD, "peak")] if isinstance(along, HeldFields) else ())]
        turned = self.reduction.cycle / self._asked.steps * np.arange(self._asked.steps)
        return FieldWatch(along, asked, self._asked.field_tolerance, turned)

    @staticmethod
    def _over_cycle(watch: FieldWatch, who: np.ndarray, count: int, compared: FieldWatch | None = None) -> FieldAnswers:
        """What was requested of the variants `who`, among all; kept fields over the crank angle."""
        found, back = watch.answers(compared), watch.fields.variants.direction < 0.0
        for rows in found.rows.values():
            # The crank angle decreases if the crank turns clockwise.
            rows[back] = np.roll(rows[back, ::-1], 1, axis=1)
        return found.over_all(who, count)

    def _run_at_one_speed(
        self, run: "_Ready", longer: float, record: Callable[[MotionFields], Sequence[Observer]] | None
    ) -> tuple[RunOutcome, FieldAnswers]:
        observers = [] if record is None else record(self._along(run))
        key, stepping = ("run", self.name), self._stepping(longer)
        if longer > 1.0 and record is None and key in run.kept:
            # A known run predicts the effect of coarser steps.
            before, known = run.kept[key]
            outcome = on_arrays(np.copy, known.shifted(known.changed))
            left = np.flatnonzero(~(run.alike(before) & known.known))
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
        whole = outcome.known.copy()
        whole[good] &= known
        return outcome._replace(known=whole), answers.over_all(good, run.which.size)

    def _ran(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        outcome, answers, after = self.run(variants, standing, longer)
        results_of = partial(self._of_run, variants)
        answers.values.update(results_of(outcome) | self._at_end(outcome, after))
        if outcome.changed is not None and longer == 1.0:
            answers.missed.update(spread_errors(outcome, outcome.changed, results_of, self.asks))
        # The work residual is relative to the works, and rounds as they do.
        answers.scales.update(end_reached=np.zeros(variants.count), work_residual=np.ones(variants.count))
        low, high = self.reduction.range_of(variants.numbers, variants.count)
        turned = outcome.state.turned
        made = turned / (high - low) * self._asked.steps
        covered = np.sort(after.angle + variants.direction * (outcome.covered - turned), axis=0)
        ends = None if self.regime.method is None else np.stack(outcome.state[:3])
        known = False if outcome.known is None else outcome.known == 1.0
        return OneRegime(answers, after, made, outcome.energy, covered, ends, known)

    def _at_end(self, outcome: RunOutcome, standing: Standing) -> dict[str, np.ndarray]:
        """Final position of an input of limited range, and the energy of its impact on a stop."""
        if self.reduction.has_cycle:
            return {}
        taken = np.where(outcome.arrived != 0, outcome.ended, 0.0)
        arrived = outcome.arrived.astype(float)
        found = {"final_position": standing.angle, "end_reached": arrived, "impact_energy": taken}
        return found | {"displacement": outcome.state.turned}

    def _stepping(self, longer: float) -> Stepping:
        steps = self.regime.steps_per_turn if not self.is_steady else None
        peaks = self.two is not None and self.asks(f"{self.two.name}_moment_peak")
        extremes = self.asks(*EXTREMES_OF_SPEED)
        stepping = Stepping(*self._asked.run_tolerance, extremes=extremes, peaks=peaks, longer=longer)
        return stepping if steps is None else stepping._replace(farthest=math.tau / steps, classical=True)

    def _along(self, run: "_Ready") -> MotionFields:
        """Fields in a run."""
        return MotionFields(self.dynamics, run.variants, run.standing.angle, run.standing.clock, self.loads)

    def _along_run(self, run: "_Ready", longer: float) -> tuple[FieldAnswers, np.ndarray]:
        """Requested fields of a run, and whether its errors are known."""
        at = () if self._at is None else (self._at.values, self._at.over_time)
        watch = FieldWatch(self._along(run), self.fields, self._asked.field_tolerance, *at)
        outcome = run_to_end(self.dynamics, *run.begin, self._asked.steps, self._stepping(longer), watch.observers)
        if watch.instants is not None:
            watch.instants.finish(outcome.verdict == Verdict.OK, *outcome.state[:3])
        return watch.answers(), outcome.known

    def _of_run(self, variants: Variants, outcome: RunOutcome) -> dict[str, np.ndarray]:
        """Results of a run by their names without the regime's."""
        state, low, high = outcome.state, outcome.slowest, outcome.fastest
        found = {"time": state.time, "angle": state.turned, "final_speed": state.omega}
        found |= {"speed_min": low, "speed_max": high, "implicit_steps": outcome.steep}
        if self.asks("motor_moment_peak") and not self.two:
            found["motor_moment_peak"] = self.dynamics.greatest_moment(variants.numbers, low, high)
        works, change = (state.works, state.squares, state.time), outcome.ended - outcome.started
        found |= self._work_values(*works, change, outcome.energy, outcome.values.get("coupling_heat", 0.0))
        places = {} if self.two is None else {"coupling": self.two.name, "shaft": self.two.coupling.shaft}
        for key, value in outcome.values.items():
            side, _, rest = key.partition("_")
            found[f"{places[side]}_{rest}" if side in places else key] = value
        return found

    def with_sized_flywheel(self, variants: Variants, longer: float = 1.0) -> tuple[Variants, np.ndarray]:
        """Variants with the flywheel for the required speed fluctuation, where that is requested, and verdicts on it.

        Where there is none, the flywheel stays as it is.
        """
        if not self.asks("flywheel"):
            return variants, np.full(variants.count, Verdict.OK, np.uint8)
        delta = np.broadcast_to(variants.numbers["flywheel.speed_fluctuation"], (variants.count,))
        wheel, verdict = flywheel_for(self.dynamics, variants, self._asked.tolerance, delta, longer)
        wheel = np.where(verdict == Verdict.OK, wheel, variants.flywheel)
        return variants._replace(flywheel=wheel, kept={}), verdict

    def _steady(self, variants: Variants, standing: Standing, longer: float) -> OneRegime:
        zero, kept = np.zeros(variants.count), variants.kept
        variants, verdict = self.with_sized_flywheel(variants, longer)
        found = {"flywheel": variants.flywheel} if self.asks("flywheel") else {}
        steady, off, answers = self._settled(variants, kept, longer)
        missed = {} if off is None else spread_errors(steady, off, partial(self._of_steady, variants), self.asks)
        steady = steady if off is None or longer == 1.0 else steady.shifted(off)
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
        begin = np.sqrt(2.0 * steady.energy / self.dynamics.inertia(variants, zero))
        held = CoupledStanding(begin, np.full(variants.count, np.inf)) if self.two else None
        after = Standing(zero, begin, zero, verdict.astype(np.uint8), held)
        return OneRegime(answers, after, float(self._asked.steps), found["energy"], known=not self.dynamics.rubs)

    def _settled(self, variants: Variants, kept: dict, longer: float) -> tuple[Steady, Steady | None, FieldAnswers]:
        """Steady running, its error estimates where they are known, and the fields of its cycle.

        With known errors, the cycle is also seen shifted by them, for comparison.
        """
        tolerance, count = self._asked.tolerance, variants.count
        if self.dynamics.rubs:
            seen: list[tuple[FieldWatch, np.ndarray]] = []

            def watch(good: np.ndarray) -> list[Observer]:
                seen.append((self._watch_cycle(self._along_cycle(variants.some(good))), good))
                return seen[0][0].observers

            steady = settled_motion(self.dynamics, variants, tolerance, longer, watch)
            return steady, None, self._over_cycle(*seen[0], count)
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

    def _of_cycle(
        self,
        variants: Variants,
        steady: Steady | Returned,
        period: np.ndarray,
        gone: RunOutcome | None = None,
    ) -> dict[str, np.ndarray]:
        """Results of any steady running; the slips of induction motors on a coupled shaft are at its speed."""
        scene, n, mean_speed = self.scene, variants.numbers, self.dynamics.cycle / period
        found = {"period": period, "mean_speed": mean_speed}
        found |= {"multiplier": steady.multiplier, "return_residual": steady.residual}
        for motor, action in scene.moments.items():
            if action.type == "induction_motor" and motor not in self.regime.off:
                speed = mean_speed * np.abs(motor_ratio(scene, action, n))
                if gone is not None and action.on == self.two.coupling.shaft:
                    speed = gone.values["shaft_mean_speed"]
                found[f"{motor}_slip"] = 1.0 - speed / n[f"moments.{motor}.synchronous_speed"]
        return found

    def _work_values(
        self,
        works: np.ndarray,
        squares: np.ndarray,
        time: np.ndarray,
        change: np.ndarray,
        turned_over: np.ndarray,
        heat: np.ndarray | float = 0.0,
    ) -> dict[str, np.ndarray]:
        """Results for work and power."""
        converted = turned_over + np.abs(works).sum(axis=0)
        with np.errstate(all="ignore"):
            found = {
                "motor_work": works[0],
                "motor_power": works[0] / time,
                "motor_moment_rms": np.sqrt(squares / time),
                "energy_change": change,
                # A machine that stands converts nothing.
                "work_residual": (works.sum(axis=0) - heat - change) / np.where(converted == 0.0, 1.0, converted),
            }
            if self.dynamics.works:
                by_channel = dict(zip(CHANNELS, works[1:], strict=True))
                found |= {f"{key}_work": by_channel[key] for key in ("driving", "other")}
                found |= {f"{key}_work": 0.0 - by_channel[key] for key in ("useful", "harmful")}
                found["brake_heat"] = 0.0 - by_channel["braking"]
                useful, supplied = found["useful_work"], works[0] + by_channel["driving"]
                # Undefined where the useful load drives, or nothing is supplied.
                found["efficiency"] = np.where((useful >= 0.0) & (supplied > 0.0), useful / supplied, np.nan)
        return found
