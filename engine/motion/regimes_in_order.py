"""A schedule: the regimes of a scene in order, for many variants, with an error estimate for every number.

Runs over the crank angle and steady running propagate the errors of their steps; fields of steady running are evaluated
again with these errors added, at half the positions. All other motions run twice, the second time with 64 times the
tolerance and twice the maximum step. The error estimate is the larger of the propagated error and the change, plus the
rounding of the energies.
"""

from collections.abc import Callable
from functools import partial
from typing import NamedTuple

import numpy as np

from engine.compiling.threads import on_all_threads, threads
from engine.graph.nodes import Node
from engine.mechanism.actions.motors import motor_ratio
from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.coupled_answers import held_moment, run_coupled
from engine.motion.coupled.coupled_fields import CoupledFields, CycleStates
from engine.motion.coupled.coupled_run import LOOKS
from engine.motion.coupled.coupled_steady import CoupledSteady, one_cycle, settled_at_two_speeds
from engine.motion.coupled.two_sides import TwoSides, coupling_of
from engine.motion.loads import PairLoads
from engine.motion.moments.at_speed import greatest_moment
from engine.motion.moments.dynamics import Dynamics, Reduction, Variants
from engine.motion.moments.equation_of_motion import FRICTION_MOMENT
from engine.motion.moments.grid import NODES
from engine.motion.one_speed import CHANNELS
from engine.motion.quantities import (
    AT_SHAFT,
    AXES,
    EFFICIENCY_NOW,
    FIELDS,
    POWERS,
    WORKS,
    Asked,
    FieldAnswers,
    kept_at_of,
    kept_fields,
    motion_fields,
    only_motor,
)
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_extremes import RunExtremes
from engine.motion.runs.run_instants import RunInstants
from engine.motion.runs.run_progress import FARTHEST_STEP, CoupledStanding, Ends, RunOutcome, Standing, Stepping
from engine.motion.runs.run_progress import TOLERANCE as RUN_TOLERANCE
from engine.motion.runs.spread_errors import spread_errors
from engine.motion.runs.watching import Observer, RunFields
from engine.motion.settled.cycle import Cycle, answers_of, cycle_of
from engine.motion.settled.rubbing_steady import settled_motion
from engine.motion.settled.sizing import flywheel_for
from engine.motion.settled.steady import Steady, steady_motion
from engine.parts.regimes import RunRegime, run_keys
from engine.quantities.quantity import has_cycle
from engine.scene.pairs import has_friction
from engine.scene.scene import Numbers, SceneError
from engine.stepping.records import on_arrays, over_all, put, some
from engine.words.verdicts import Verdict

# Tolerance of a step in steady running, relative to the maximum work in a step: default, fraction of the requested
# accuracy, minimum.
TOLERANCE, SURER, LEAST_TOLERANCE = 1e-9, 0.1, 1e-13
# Tolerances of a step in time and of a step over the angle, whose errors are known, relative to the requested accuracy;
# default tolerance over the angle, relative to that in time.
SURER_IN_RUNS, FINER = (0.1, 0.3), 0.03
# Largest relative change of the final time, angle or speed with equal steps of twice the length; beyond: TOO_COARSE.
TELLS_NOTHING = 0.01
# Bytes of cache shared by the cores, and rows of tables: they limit the variants computed together.
CACHE, ROWS = 16e6, 6
# Variants in steady running computed together: many blocks, but few enough for a cache.
TOGETHER = 4096
WORTH_A_THREAD = 128
# Numbers in a cache line.
ODD = 8
# Longest distance between samples of a run at two speeds [rad].
BETWEEN_LOOKS = FARTHEST_STEP / (LOOKS.size - 1)
ROUNDING = 16 * np.finfo(float).eps
# Steps whose rounding equals all other rounding: half a unit in the last place each.
STEPS_OF_ROUNDING = 32

TURN = 2.0 * np.pi
# Results that need the minimum and maximum speed.
EXTREMES_OF_SPEED = ("speed_min", "speed_max", "motor_moment_peak")


def share_of_change(name: str) -> float:
    """Factor from the change with coarser steps to the error estimate of a result."""
    last = name.rpartition(".")[2]
    # Two positions may share an extreme; the estimate of a position is one step instead.
    if last in ("min_at", "max_at", "min_time", "max_time"):
        return 0.0
    # Means over time and extremes converge without an order if a steep motor recovers from a jump within a step.
    return 2.0 if last in ("mean", "rms", "mean_speed", "speed_min", "speed_max") else 1.0


class RegimeAnswers(NamedTuple):
    """Values, fields and error estimates by name, and the verdict on each variant.

    A field has one error estimate for each variant, the maximum over the instants of a run or the positions of a cycle.
    `covered` is the range of the input positions in each run, (runs, 2, variants), in order.
    """

    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]
    fields: dict[str, np.ndarray]
    verdict: np.ndarray
    covered: np.ndarray

    def judged(self, lost: np.ndarray, share: np.ndarray) -> "RegimeAnswers":
        """The same with NaN for `lost` variants, and error estimates increased by a fraction of the values.

        Parameters
        ----------
        lost : ndarray (variants,) of bool
        share : ndarray (variants,)
        """
        found = on_arrays(np.copy, self)
        for name, row in (found.values | found.fields).items():
            found.errors[name] += share * (np.abs(row) if row.ndim == 1 else _greatest(np.abs(row)))
        for row in (*found.values.values(), *found.errors.values(), *found.fields.values()):
            row[lost] = np.nan
        return found


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
    """

    answers: FieldAnswers
    standing: Standing
    made: np.ndarray | float
    energy: np.ndarray
    covered: np.ndarray | None = None
    by_equal_steps: np.ndarray | None = None


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


class Schedule:
    """The regimes of a scene.

    Parameters
    ----------
    mechanics : Mechanics
    asked : set of str
        Summaries and fields, "REGIME.quantity".
    steps : int
        Even number of steps in a cycle.
    accuracy : float, optional
        Requested relative accuracy of the results.

    Attributes
    ----------
    tolerance : float
        Tolerance of a step in steady running, relative to the maximum work in a step.
    loads : PairLoads or None
        Loads on the pairs, if requested.
    keys : RunKeys
        For the kind of input.
    """

    def __init__(self, mechanics: Mechanics, asked: set[str], steps: int, accuracy: float | None = None) -> None:
        self.scene, self.steps = mechanics.scene, steps
        own = ((name, n) for name, regime in self.scene.regimes.items() for n in only_motor(self.scene, regime))
        pairs = (
            (f"{name}.{n}_shaft_torque_{key}", f"{name}.motor_moment_{key}", n) for name, n in own for key in AT_SHAFT
        )
        # Torques of motors at their own shafts, with the torques reduced to the input from which they follow.
        self.at_shaft = {name: (reduced, n) for name, reduced, n in pairs if name in asked}
        self.only_for_shafts = {reduced for reduced, _ in self.at_shaft.values()} - asked
        asked = self.asked = asked | self.only_for_shafts
        self.keys = run_keys(mechanics.scene.input)
        self.tolerance = TOLERANCE if accuracy is None else max(SURER * accuracy, LEAST_TOLERANCE)
        self._run_tolerance = RUN_TOLERANCE, FINER * RUN_TOLERANCE
        if accuracy is not None:
            self._run_tolerance = tuple(max(share * accuracy, LEAST_TOLERANCE) for share in SURER_IN_RUNS)
        scene = mechanics.scene
        for coupling in scene.couplings.values():
            if scene.shafts[coupling.shaft].efficiency is not None:
                message = "losses of the teeth between a coupling and the crank aren't counted in regimes; leave it out"
                raise SceneError([(f"shafts.{coupling.shaft}.efficiency", message)])
        self.regimes = dict(scene.regimes)
        self.steady = {name for name, regime in self.regimes.items() if not isinstance(regime, RunRegime)}
        self.needed = self._needed()
        known = {q.name for kind in ("steady", "run") for q in motion_fields(mechanics, kind)}
        known |= {q.name for q in kept_fields(mechanics)}
        self.instants = kept_at_of(scene)
        fields = [one for one in map(Asked.of, sorted(asked)) if f"{one.regime}.{one.field}" in known]
        self.fields = {name: [one for one in fields if one.regime == name] for name in self.regimes}
        loads = {one.field for one in fields} - FIELDS.keys() - AXES.keys()
        self.loads = PairLoads(mechanics, loads) if loads else None
        summaries = {name.rpartition(".")[2] for name in asked}
        works = not summaries.isdisjoint((*WORKS, "efficiency", "work_residual"))
        works |= any(one.field in ("motors_power", *POWERS, EFFICIENCY_NOW) for one in fields)
        sets = dict.fromkeys(frozenset(self.regimes[name].off) for name in self.needed)
        self.reduction = Reduction(mechanics)
        friction = PairLoads(mechanics, [FRICTION_MOMENT]) if has_friction(scene) else None
        gathered = {"motors"} if works or summaries & {"motor_work", "motor_power"} else set()
        gathered |= {"fading"} if self.steady & set(self.needed) else set()
        gathered |= {"squares"} if "motor_moment_rms" in summaries else set()
        self.dynamics = {off: Dynamics(self.reduction, off, works, friction, frozenset(gathered)) for off in sets}
        self.sides = {off: TwoSides(self.reduction, off, works, friction) for off in sets} if scene.couplings else {}
        self._refuse_equal_steps()

    @property
    def nodes(self) -> list[Node]:
        """Nodes from which the motion and the requested loads are computed at a position."""
        return [*self.reduction.nodes, *(self.loads.nodes if self.loads else ())]

    def _refuse_equal_steps(self) -> None:
        """Raise SceneError if a run names a method of equal steps but cannot be computed over the crank angle."""
        for name in self.needed:
            regime = self.regimes[name]
            if name in self.steady or regime.method is None:
                continue
            timed = self.dynamics[frozenset(regime.off)].timed
            there = {
                "an input that doesn't turn fully": not has_cycle(self.scene),
                "the two speeds of a coupling": bool(self.sides),
                "friction in pairs": has_friction(self.scene),
                "moments that depend on time": timed,
            }
            hindrances = [words for words, found in there.items() if found]
            if hindrances:
                message = f"equal steps over the crank angle don't follow {hindrances[0]}; leave method, steps_per_turn"
                raise SceneError([(f"regimes.{name}.method", message)])

    def _needed(self) -> list[str]:
        """Requested regimes, and the runs before them that set their initial state."""
        wanted = {name.partition(".")[0] for name in self.asked}
        needed, pending = [], False
        for name, regime in reversed(self.regimes.items()):
            if name in wanted or pending:
                needed.append(name)
                pending = isinstance(regime, RunRegime) and not self._begins_anew(regime)
        return needed[::-1]

    def _begins_anew(self, regime: RunRegime) -> bool:
        """Whether a run specifies its initial position and speed, and so needs no previous regime; its clock is 0."""
        return None not in (getattr(regime, self.keys.from_speed), getattr(regime, self.keys.from_place))

    def answers(self, numbers: Numbers, count: int) -> RegimeAnswers:
        """Requested results of a number of variants."""
        # Fields are tabulated over the steps of a cycle.
        looked_at = any(self.fields[name] for name in self.needed)
        together = int(CACHE / (8 * ROWS * (2 * self.steps + 1))) + 1 if looked_at else TOGETHER
        pieces = max(-(-count // together), min(threads(), count // WORTH_A_THREAD), 1)
        # Row lengths that are multiples of a power of two would map to a few sets of the cache.
        width = -(-count // pieces)
        width += (ODD - width) % (2 * ODD) if pieces > 1 else 0
        cuts = [np.arange(first, min(first + width, count)) for first in range(0, count, width)]
        return _joined(on_all_threads(lambda chosen: self._of_chunk(numbers.of_variants(chosen), chosen.size), cuts))

    def _of_chunk(self, numbers: Numbers, count: int) -> RegimeAnswers:
        variants = self.variants(numbers, count)
        driven = {off: dynamics.driven(variants) for off, dynamics in self.dynamics.items()}
        # Infinite or NaN numbers cause a verdict, not a warning.
        with np.errstate(all="ignore"):
            (fine, regimes), (coarse, others) = self._go(driven), self._go(driven, half=True)
        verdict, other_verdict = (each[-1].standing.verdict for each in (regimes, others))
        # A verdict with coarser steps only is due to the method, not to the machine.
        whole, rough = other_verdict == Verdict.OK, np.zeros(count, bool)
        for mine, other in zip(regimes, others, strict=True):
            if mine.by_equal_steps is not None:
                change = np.abs(mine.by_equal_steps - other.by_equal_steps)
                rough |= ~(change <= TELLS_NOTHING * np.abs(mine.by_equal_steps)).all(axis=0) | ~whole
        verdict = np.where(rough & (verdict == Verdict.OK), Verdict.TOO_COARSE, verdict).astype(np.uint8)
        values = {name: np.where(verdict == Verdict.OK, v, np.nan) for name, v in fine.values.items()}
        errors = {}
        for name, row in (values | fine.rows).items():
            size, other = np.abs(row), (coarse.values | coarse.rows)[name]
            # The positions of the coarser cycle are a subset.
            change = np.abs((row if row.ndim == 1 else row[:, :: row.shape[1] // other.shape[1]]) - other)
            if row.ndim > 1:
                size, change = _greatest(size), _greatest(change)
            change = share_of_change(name) * np.where(whole, change, size)
            rounding = ROUNDING * np.maximum(size, fine.scales.get(name, 0.0))
            error = np.maximum(change, fine.missed.get(name, 0.0)) + rounding
            errors[name] = np.where(verdict == Verdict.OK, error, np.nan)
        covered = [found.covered for found in regimes if found.covered is not None]
        return RegimeAnswers(values, errors, fine.rows, verdict, np.reshape(covered, (-1, 2, count)))

    def variants(self, numbers: Numbers, count: int) -> Variants:
        """A number of variants, with the flywheel of the scene."""
        direction = np.broadcast_to(np.sign(numbers["input.speed"]), (count,)).astype(float)
        flywheel = np.zeros(count)
        if "flywheel.inertia" in numbers:
            flywheel = np.broadcast_to(numbers["flywheel.inertia"], (count,)).astype(float)
        return self.reduction.variants(numbers, direction, flywheel)

    @property
    def turns(self) -> bool:
        """Whether the input rotates fully."""
        return self.reduction.has_cycle

    def at_begin(self, variants: Variants) -> Standing:
        """Initial state before the first regime: at φ = 0 or at the start of the input's range, at rest."""
        zero = np.zeros(variants.count)
        low, high = self.reduction.range_of(variants.numbers, variants.count)
        begin = zero if self.turns else np.where(variants.direction > 0.0, low, high)
        return Standing(begin, zero, zero, np.full(variants.count, Verdict.OK, np.uint8))

    def _go(self, driven: dict[frozenset[str], Variants], half: bool = False) -> tuple[FieldAnswers, list[OneRegime]]:
        """Compute all needed regimes in order; the requested results by their names, and each regime's."""
        standing = self.at_begin(next(iter(driven.values())))
        every, regimes = FieldAnswers.none(), []
        for name in self.needed:
            off = frozenset(self.regimes[name].off)
            dynamics, variants = self.dynamics[off], driven[off]
            hindered = self.hindered(name, dynamics, variants)
            standing = standing._replace(verdict=np.where(standing.verdict, standing.verdict, hindered))
            regime = self._ran if name not in self.steady else self._steady
            regime = self._steady_at_two_speeds if name in self.steady and self.at_two_speeds(name) else regime
            found = regime(name, dynamics, variants, standing, half)
            answers, standing = found.answers, found.standing
            asked = {key: v for key, v in answers.values.items() if f"{name}.{key}" in self.asked}
            # Rounding accumulates from step to step.
            growth = 1.0 + np.abs(found.made) / STEPS_OF_ROUNDING
            scales = {key: growth * np.abs(answers.scales.get(key, v)) for key, v in asked.items()}
            scales["energy_change"] = growth * found.energy
            if name in self.instants:
                scales |= {key: growth * _greatest(np.abs(rows)) for key, rows in answers.rows.items()}
            for table, own in zip(every, answers._replace(values=asked, scales=scales), strict=True):
                table.update({f"{name}.{key}": row for key, row in own.items()})
            regimes.append(found)
        numbers = next(iter(driven.values())).numbers
        for name, (reduced, motor) in self.at_shaft.items():
            ratio = np.abs(motor_ratio(self.scene, self.scene.moments[motor], numbers))
            for rows in every[:3]:
                if reduced in rows:
                    rows[name] = rows[reduced] / ratio
        for name in self.only_for_shafts:
            every.values.pop(name, None)
        return every, regimes

    def hindered(self, name: str, dynamics: Dynamics, variants: Variants) -> np.ndarray:
        """Verdict that rules out a regime before it is computed.

        Causes: a brake that locks, zero inertia, a start outside the range of the input.
        """
        verdict = np.where(dynamics.locked(variants), Verdict.LOCKS, Verdict.OK)
        if not self.turns and getattr(self.regimes[name], self.keys.from_place) is not None:
            begin = self._number(name, self.keys.from_place, variants, 0.0)
            low, high = self.reduction.range_of(variants.numbers, variants.count)
            verdict = np.where((begin < low) | (begin > high), Verdict.OUTSIDE_LIMITS, verdict)
        if self.at_two_speeds(name):
            bare = self.sides[frozenset(self.regimes[name].off)].without_inertia(variants)
            return np.where(bare, Verdict.NO_INERTIA, verdict).astype(np.uint8)
        # A flywheel to be determined provides inertia everywhere.
        if f"{name}.flywheel" not in self.asked:
            verdict = np.where(self.reduction.without_inertia(variants), Verdict.NO_INERTIA, verdict)
        return verdict.astype(np.uint8)

    # Runs

    def _number(self, name: str, key: str, variants: Variants, otherwise: float) -> np.ndarray:
        """A number of a run for every variant; `otherwise` if it is not given."""
        given = getattr(self.regimes[name], key) is not None
        value = variants.numbers[f"regimes.{name}.{key}"] if given else otherwise
        return np.broadcast_to(value, (variants.count,)).astype(float)

    def run(
        self,
        name: str,
        variants: Variants,
        standing: Standing,
        half: bool = False,
        record: Callable[[RunFields], Observer] | None = None,
    ) -> tuple[RunOutcome, FieldAnswers, Standing]:
        """Run a regime from the current state.

        Parameters
        ----------
        name : str
        variants : Variants
            With the inertia of all parts.
        standing : Standing
        half : bool
            Whether to use a looser tolerance and half the samples, for comparison.
        record : callable, optional
            Creates the observer of the run, which replaces the requested fields.
        """
        regime, keys, count, cycle = self.regimes[name], self.keys, variants.count, self.reduction.cycle

        def number(key: str, otherwise: float = np.inf) -> np.ndarray:
            return self._number(name, key, variants, otherwise)

        begin, own = standing, {"omega": keys.from_speed, "angle": keys.from_place}
        begin = begin._replace(**{part: number(key) for part, key in own.items() if getattr(regime, key) is not None})
        if self._begins_anew(regime):
            begin = begin._replace(clock=np.zeros(count))
        if self.sides and (standing.coupled is None or regime.from_speed is not None):
            begin = begin._replace(coupled=CoupledStanding(begin.omega, np.zeros(count)))
        # Near a speed that is never reached, the time to reach it is as uncertain as its last digits.
        speed = number(keys.speed) * (1.0 - ROUNDING if half else 1.0)
        flags = (getattr(regime, key) is True for key in ("rest", "reversal", "end_of_range", "lock_up"))
        ends = Ends(number("cycles") * cycle, number("time"), speed, number("at_most") * cycle, *flags)
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        run = self._run_at_two_speeds if self.sides else self._run_at_one_speed
        own = _Ready(ready, variants.some(ready), some(begin, ready), some(ends, ready), variants.kept)
        found = run(name, own, half, record)
        outcome, answers = over_all(found[0], ready, count), found[1].over_all(ready, count)
        verdict = np.where(standing.verdict == Verdict.OK, outcome.verdict, standing.verdict).astype(np.uint8)
        # An end of the range stops the input.
        omega = np.where(outcome.arrived != 0, 0.0, outcome.state.omega)
        place, clock = begin.angle + variants.direction * outcome.state.turned, begin.clock + outcome.state.time
        return outcome, answers, Standing(place, omega, clock, verdict, outcome.coupled)

    def _run_at_two_speeds(
        self, name: str, run: "_Ready", half: bool, record: Callable[[CoupledFields], Observer] | None
    ) -> tuple[RunOutcome, FieldAnswers]:
        sides, standing = (
            self.sides[frozenset(self.regimes[name].off)].of(run.variants, run.standing.angle),
            run.standing,
        )
        if self.regimes[name].from_shaft_speed is not None:
            shaft = self._number(name, "from_shaft_speed", run.variants, 0.0) / sides.coupling.ratio
            standing = standing._replace(coupled=standing.coupled._replace(speed=shaft))
        along, asked = CoupledFields(sides, standing.clock, self.loads), self.fields[name]
        watch = record or (lambda along: RunExtremes(along, [one.field for one in asked]))
        observers = [watch(along)] if asked or record else []
        outcome = run_coupled(sides, standing, run.ends, self._stepping(name, half), observers)
        if not asked or record is not None:
            return outcome, FieldAnswers.none()
        return outcome, observers[0].answers(asked, np.full(run.which.size, BETWEEN_LOOKS))

    def at_two_speeds(self, name: str) -> bool:
        """Whether both sides of a coupling have separate speeds in a regime: always, except for a locked clutch."""
        return bool(self.sides) and (name not in self.steady or self.sides[frozenset(self.regimes[name].off)].is_fluid)

    def settled_at_two_speeds(
        self,
        name: str,
        variants: Variants,
        standing: Standing,
        half: bool = False,
        record: Callable[[CoupledFields, np.ndarray], Observer] | None = None,
    ) -> tuple[CoupledSteady, RunOutcome, Standing]:
        """Steady running through a fluid coupling, and one cycle of it; parameters as for `run`.

        `record` also receives the indices of the variants in steady running.
        """
        two, count, zero = self.sides[frozenset(self.regimes[name].off)], variants.count, np.zeros(variants.count)
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        sides, stepping = two.of(variants.some(ready), zero[ready]), self._stepping(name, half)
        steady = settled_at_two_speeds(sides, stepping)
        good = np.flatnonzero(steady.verdict == Verdict.OK)
        moving = sides.some(good)
        watching = [] if record is None else [record(CoupledFields(moving, zero[good], self.loads), ready[good])]
        gone = over_all(one_cycle(moving, steady.speeds[:, good], stepping, watching), ready[good], count)
        steady = over_all(steady, ready, count)
        verdict = np.where(standing.verdict != Verdict.OK, standing.verdict, np.maximum(steady.verdict, gone.verdict))
        shaft = CoupledStanding(steady.speeds[1], np.full(count, np.inf))
        steady = steady._replace(verdict=verdict.astype(np.uint8))
        return steady, gone, Standing(zero, steady.speeds[0], zero, steady.verdict, shaft)

    def _steady_at_two_speeds(
        self, name: str, dynamics: Dynamics, variants: Variants, standing: Standing, half: bool
    ) -> OneRegime:
        asked, seen = self.fields[name], []

        def record(along: CoupledFields, good: np.ndarray) -> CycleStates:
            seen.append((along, good, CycleStates(good.size, LOOKS[:: 2 if half else 1].size)))
            return seen[0][2]

        steady, gone, after = self.settled_at_two_speeds(name, variants, standing, half, record if asked else None)
        answers = FieldAnswers.none()
        if asked:
            along, good, states = seen[0]
            answers = answers_of(self._fluid_cycle(along, states, half), asked, dynamics.cycle)
            answers = answers.over_all(good, variants.count)
        found = self._of_run(name, dynamics, variants, gone)
        low, high, period = gone.slowest, gone.fastest, gone.state.time
        found |= {"period": period, "mean_speed": dynamics.cycle / period, "multiplier": steady.multiplier}
        found |= {"return_residual": steady.residual, "speed_fluctuation": 2.0 * (high - low) / (high + low)}
        answers.values.update(found | self._slips(name, variants, found["mean_speed"], gone))
        # δ is a difference of speeds, and rounds as they do.
        answers.scales["speed_fluctuation"] = np.ones(variants.count)
        return OneRegime(answers, after, float(self.steps // 2 if half else self.steps), gone.energy)

    def _fluid_cycle(self, along: CoupledFields, states: CycleStates, half: bool) -> Cycle:
        """The steady cycle through a fluid coupling with its fields."""
        variants, steps = along.variants, self.steps // 2 if half else self.steps
        sided = variants._replace(breaks=variants.breaks.two_sided())
        grid = along.dynamics.grid(sided, np.zeros(variants.count), along.dynamics.cycle, steps)
        angle = grid.places[NODES]
        rows = along(np.arange(variants.count), states.at(variants.direction * angle))
        even = np.broadcast_to(np.arange(len(angle))[:, None], angle.shape) if grid.even is None else grid.even
        return Cycle(angle, grid.steps, even, rows["speed"], variants.direction, rows)

    def _run_at_one_speed(
        self, name: str, run: "_Ready", half: bool, record: Callable[[RunFields], Observer] | None
    ) -> tuple[RunOutcome, FieldAnswers]:
        dynamics = self.dynamics[frozenset(self.regimes[name].off)]
        observers = [] if record is None else [record(self._along(name, dynamics, run))]
        key, stepping = ("run", name), self._stepping(name, half)
        if half and record is None:
            # A known run predicts the effect of coarser steps.
            before, known = run.kept[key]
            outcome = on_arrays(np.copy, known.shifted(known.changed))
            left = np.flatnonzero(~(run.alike(before) & known.known))
            if left.size:
                put(outcome, left, run_to_end(dynamics, *run.some(left).begin, self.steps, stepping))
        else:
            outcome = run_to_end(dynamics, *run.begin, self.steps, stepping, observers)
            run.kept[key] = run, outcome
        if record is not None or not self.fields[name]:
            return outcome, FieldAnswers.none()
        # Fields are evaluated for runs that reach their end.
        good = np.flatnonzero(outcome.verdict == Verdict.OK)
        return outcome, self._along_run(name, dynamics, run.some(good), half).over_all(good, run.which.size)

    def _ran(self, name: str, dynamics: Dynamics, variants: Variants, standing: Standing, half: bool) -> OneRegime:
        outcome, answers, after = self.run(name, variants, standing, half)
        results_of = partial(self._of_run, name, dynamics, variants)
        answers.values.update(results_of(outcome) | self._at_end(outcome, after))
        if outcome.changed is not None and not half:
            answers.missed.update(spread_errors(outcome, outcome.changed, results_of))
        # The work residual is relative to the works, and rounds as they do.
        answers.scales.update(end_reached=np.zeros(variants.count), work_residual=np.ones(variants.count))
        low, high = self.reduction.range_of(variants.numbers, variants.count)
        turned = outcome.state.turned
        made = turned / (high - low) * (self.steps // 2 if half else self.steps)
        covered = np.sort(after.angle + variants.direction * (outcome.covered - turned), axis=0)
        ends = None if self.regimes[name].method is None else np.stack(outcome.state[:3])
        return OneRegime(answers, after, made, outcome.energy, covered, ends)

    def _at_end(self, outcome: RunOutcome, standing: Standing) -> dict[str, np.ndarray]:
        """Final position of an input of limited range, and the energy of its impact on a stop."""
        if self.turns:
            return {}
        taken = np.where(outcome.arrived != 0, outcome.ended, 0.0)
        arrived = outcome.arrived.astype(float)
        found = {"final_position": standing.angle, "end_reached": arrived, "impact_energy": taken}
        return found | {"displacement": outcome.state.turned}

    def _stepping(self, name: str, coarse: bool) -> Stepping:
        steps = self.regimes[name].steps_per_turn if name not in self.steady else None
        extremes = not {f"{name}.{key}" for key in EXTREMES_OF_SPEED}.isdisjoint(self.asked)
        stepping = Stepping(*self._run_tolerance, extremes=extremes, coarse=coarse)
        return stepping if steps is None else stepping._replace(farthest=TURN / steps, classical=True)

    def _along(self, name: str, dynamics: Dynamics, run: "_Ready") -> RunFields:
        """Fields in a run."""
        off = frozenset(self.regimes[name].off)
        return RunFields(dynamics, run.variants, run.standing.angle, run.standing.clock, self.loads, off)

    def _along_run(self, name: str, dynamics: Dynamics, run: "_Ready", half: bool) -> FieldAnswers:
        """Requested fields of a run, with half the samples if `half`, for comparison."""
        steps, along = self.steps // 2 if half else self.steps, self._along(name, dynamics, run)
        asked = [one for one in self.fields[name] if one.statistic]
        kept = [one.field for one in self.fields[name] if not one.statistic]
        extremes = RunExtremes(along, [one.field for one in asked])
        observers: list[Observer] = [extremes] if asked else []
        if kept:
            instants = RunInstants(along, kept, self.instants[name])
            observers.append(instants)
        outcome = run_to_end(dynamics, *run.begin, steps, self._stepping(name, half), observers)
        low, high = self.reduction.range_of(run.variants.numbers, run.which.size)
        found = extremes.answers(asked, (high - low) / steps)
        if kept:
            instants.finish(outcome)
            found = found._replace(rows=instants.rows)
        return found

    def _of_run(self, name: str, dynamics: Dynamics, variants: Variants, outcome: RunOutcome) -> dict[str, np.ndarray]:
        """Results of a run by their names without the regime's."""
        state, low, high = outcome.state, outcome.slowest, outcome.fastest
        found = {"time": state.time, "angle": state.turned, "final_speed": state.omega}
        found |= {"speed_min": low, "speed_max": high, "implicit_steps": outcome.steep}
        if f"{name}.motor_moment_peak" in self.asked and not self.sides:
            found["motor_moment_peak"] = greatest_moment(variants.drive, low, high)
        works, change = (state.works, state.squares, state.time), outcome.ended - outcome.started
        found |= _work_values(dynamics, *works, change, outcome.energy, outcome.values.get("coupling_heat", 0.0))
        places = {}
        if self.sides:
            two = self.sides[frozenset(self.regimes[name].off)]
            places = {"coupling": two.name, "shaft": two.coupling.shaft}
        for key, value in outcome.values.items():
            side, _, rest = key.partition("_")
            found[f"{places[side]}_{rest}" if side in places else key] = value
        return found

    # Steady running

    def _steady(self, name: str, dynamics: Dynamics, variants: Variants, standing: Standing, half: bool) -> OneRegime:
        zero, asked = np.zeros(variants.count), self.fields[name]
        found, missed, verdict = {}, {}, np.full(variants.count, Verdict.OK, np.uint8)
        if f"{name}.flywheel" in self.asked:
            delta = np.broadcast_to(variants.numbers["flywheel.speed_fluctuation"], (variants.count,))
            found["flywheel"], verdict = flywheel_for(dynamics, variants, self.tolerance, delta, half)
            wheel = np.where(verdict == Verdict.OK, found["flywheel"], variants.flywheel)
            variants = variants._replace(flywheel=wheel, kept={})
        # A force may jump where its torque has only a kink, as at a dead centre, where the velocity is zero.
        sided = variants._replace(breaks=variants.breaks.two_sided()) if asked else variants
        looked = bool(asked or self.sides)
        grid = dynamics.grid(sided, zero, dynamics.cycle, self.steps // 2 if half else self.steps) if looked else None
        nodes = None if grid is None else variants.direction * grid.places[NODES]
        off: Steady | None = None
        if dynamics.friction is not None:
            steady = settled_motion(dynamics, variants, self.tolerance, half, nodes)
        else:
            # Without nodes the second call is identical.
            if nodes is not None or "steady" not in variants.kept:
                variants.kept["steady"] = steady_motion(dynamics, variants, self.tolerance, nodes)
            steady, off = variants.kept["steady"]

        def results_of(steady: Steady) -> dict[str, np.ndarray]:
            return self._of_steady(name, dynamics, variants, steady)

        if off is not None and not half:
            missed |= spread_errors(steady, off, results_of)
        if off is not None and half:
            steady = steady.shifted(off)
        found |= results_of(steady)
        if self.sides:
            two = self.sides[frozenset(self.regimes[name].off)]
            peak, most = held_moment(two, dynamics, variants, grid.places[NODES], steady.record[0])
            found[f"{two.name}_moment_peak"] = peak
            verdict = np.where(peak > most, Verdict.SLIPS, verdict)
        answers = FieldAnswers.none()
        if asked:
            acts = cycle_of(dynamics, variants, grid, steady, self.loads, frozenset(self.regimes[name].off))
            answers = answers_of(acts, asked, dynamics.cycle)
        answers.values.update(found)
        answers.missed.update(missed)
        # δ is a difference of speeds, and rounds as they do.
        answers.scales["speed_fluctuation"] = np.ones(variants.count)
        verdict = np.where(standing.verdict != Verdict.OK, standing.verdict, np.maximum(verdict, steady.verdict))
        begin = np.sqrt(2.0 * steady.energy / dynamics.rows(variants, zero[None]).inertia[0])
        held = CoupledStanding(begin, np.full(variants.count, np.inf)) if self.sides else None
        after = Standing(zero, begin, zero, verdict.astype(np.uint8), held)
        return OneRegime(answers, after, float(self.steps // 2 if half else self.steps), found["energy"])

    def _of_steady(self, name: str, dynamics: Dynamics, variants: Variants, steady: Steady) -> dict[str, np.ndarray]:
        """Results of steady running by their names without the regime's."""
        low, high, period = steady.slowest, steady.fastest, steady.period
        found = {"speed_min": low, "speed_max": high, "speed_fluctuation": steady.fluctuation}
        found |= {"period": period, "mean_speed": dynamics.cycle / period, "multiplier": steady.multiplier}
        found |= {"return_residual": steady.residual, "energy": steady.energy, "implicit_steps": steady.steep}
        if f"{name}.motor_moment_peak" in self.asked:
            found["motor_moment_peak"] = greatest_moment(variants.drive, low, high)
        change = steady.ended - steady.energy
        found |= _work_values(dynamics, steady.works, steady.squares, period, change, steady.energy)
        return found | self._slips(name, variants, dynamics.cycle / period)

    def _slips(
        self, name: str, variants: Variants, mean_speed: np.ndarray, gone: RunOutcome | None = None
    ) -> dict[str, np.ndarray]:
        """Mean slips of induction motors; those on a coupled shaft run at its speed."""
        scene, n, slips = self.scene, variants.numbers, {}
        for motor, action in scene.moments.items():
            if action.type == "induction_motor" and motor not in self.regimes[name].off:
                speed = mean_speed * np.abs(motor_ratio(scene, action, n))
                if gone is not None and action.on == coupling_of(scene)[1].shaft:
                    speed = gone.values["shaft_mean_speed"]
                slips[f"{motor}_slip"] = 1.0 - speed / n[f"moments.{motor}.synchronous_speed"]
        return slips


def _work_values(
    dynamics: Dynamics,
    works: np.ndarray,
    squares: np.ndarray,
    time: np.ndarray,
    change: np.ndarray,
    turned_over: np.ndarray,
    heat: np.ndarray | float = 0.0,
) -> dict[str, np.ndarray]:
    """Results for work and power."""
    with np.errstate(all="ignore"):
        found = {
            "motor_work": works[0],
            "motor_power": works[0] / time,
            "motor_moment_rms": np.sqrt(squares / time),
            "energy_change": change,
            "work_residual": (works.sum(axis=0) - heat - change) / (turned_over + np.abs(works).sum(axis=0)),
        }
        if dynamics.works:
            by_channel = dict(zip(CHANNELS, works[1:], strict=True))
            found |= {f"{key}_work": by_channel[key] for key in ("driving", "other")}
            found |= {f"{key}_work": 0.0 - by_channel[key] for key in ("useful", "harmful")}
            found["brake_heat"] = 0.0 - by_channel["braking"]
            found["efficiency"] = found["useful_work"] / (works[0] + by_channel["driving"])
    return found


def _joined(parts: list[RegimeAnswers]) -> RegimeAnswers:
    """Results of several chunks as one; ranges of positions count the variants last."""
    return on_arrays(lambda *rows: np.concatenate(rows, axis=2 if rows[0].ndim == 3 else 0), *parts)


def _greatest(rows: np.ndarray) -> np.ndarray:
    """Maximum of each row, ignoring NaN; 0 for a row of NaN."""
    return np.fmax.reduce(rows, axis=1, initial=0.0)
