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

from engine.compiling.running import of_all
from engine.compiling.threads import on_all_threads, threads
from engine.graph.nodes import Node
from engine.mechanism.actions.motors import motor_ratio
from engine.mechanism.mechanics import Mechanics
from engine.motion.coupled.coupled_answers import CoupledOutcome, CoupledStanding, held_moment, run_coupled
from engine.motion.coupled.coupled_fields import CoupledFields, CycleStates
from engine.motion.coupled.coupled_run import FARTHEST_TURN, LOOKS, CoupledEnds, Precision
from engine.motion.coupled.coupled_steady import CoupledSteady, one_cycle, settled_at_two_speeds
from engine.motion.coupled.two_sides import TwoSides, coupling_of
from engine.motion.loads import PairLoads
from engine.motion.moments.dynamics import Dynamics, Reduction, Variants
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
    kept_at_of,
    kept_fields,
    motion_fields,
    only_motor,
)
from engine.motion.runs.run import run_to_end
from engine.motion.runs.run_extremes import FieldAnswers, RunExtremes
from engine.motion.runs.run_instants import RunInstants
from engine.motion.runs.run_progress import TOLERANCE as RUN_TOLERANCE
from engine.motion.runs.run_progress import Begin, Changed, Ends, Progress, RunOutcome, Stepping
from engine.motion.runs.spread_errors import spread_errors
from engine.motion.runs.watching import Observer, RunFields
from engine.motion.settled.cycle import Cycle, CycleAnswers, answers_of, cycle_of
from engine.motion.settled.rubbing_steady import settled_motion
from engine.motion.settled.sizing import flywheel_for
from engine.motion.settled.steady import Steady, steady_motion
from engine.parts.regimes import RunRegime, run_keys
from engine.quantities.quantity import has_cycle
from engine.scene.pairs import has_friction
from engine.scene.scene import Numbers, SceneError
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
BETWEEN_LOOKS = FARTHEST_TURN / (LOOKS.size - 1)
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


class Standing(NamedTuple):
    """State of every variant between two regimes: crank angle [rad], speed [rad/s], time [s], verdict.

    `coupled` is the state of a shaft behind a coupling; None if it turns with the crank.
    """

    angle: np.ndarray
    omega: np.ndarray
    clock: np.ndarray
    verdict: np.ndarray
    coupled: CoupledStanding | None = None


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
        tables = self.values, self.errors, self.fields
        values, errors, fields = ({name: row.copy() for name, row in table.items()} for table in tables)
        for name, row in (values | fields).items():
            errors[name] += share * (np.abs(row) if row.ndim == 1 else _greatest(np.abs(row)))
        for row in (*values.values(), *errors.values(), *fields.values()):
            row[lost] = np.nan
        return self._replace(values=values, errors=errors, fields=fields)


class Gone(NamedTuple):
    """Results of a number of variants with one number of steps.

    Attributes
    ----------
    values, fields : dict of str to ndarray
    verdict : ndarray (variants,) of uint8
    scales : dict of str to ndarray (variants,)
        Magnitudes to which the rounding of values is relative, where not the value itself.
    missed : dict of str to ndarray (variants,)
        Propagated error estimates, and how far extremes between nodes may exceed those at nodes.
    by_equal_steps : dict of str to ndarray (3, variants)
        Angle turned [rad], final speed [rad/s] and time [s] of the runs by equal steps.
    covered : list of ndarray (2, variants)
        For each run the minimum and maximum position of the input.
    """

    values: dict[str, np.ndarray]
    fields: dict[str, np.ndarray]
    verdict: np.ndarray
    scales: dict[str, np.ndarray]
    missed: dict[str, np.ndarray]
    by_equal_steps: dict[str, np.ndarray]
    covered: list[np.ndarray]


class Known(NamedTuple):
    """A run that is already known: its variants, initial state and outcome."""

    variants: np.ndarray
    begin: Begin
    outcome: RunOutcome

    def tells(self, variants: np.ndarray, begin: Begin) -> np.ndarray:
        """For which variants it predicts the effect of coarser steps, (variants,) of bool."""
        if not np.array_equal(variants, self.variants):
            return np.zeros(variants.size, bool)
        alike = np.all([now == then for now, then in zip(begin, self.begin, strict=True)], axis=0)
        return alike & self.outcome.known


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
        rubs = has_friction(scene)
        gathered = {"motors"} if works or summaries & {"motor_work", "motor_power"} else set()
        gathered |= {"fading"} if self.steady & set(self.needed) else set()
        gathered |= {"squares"} if "motor_moment_rms" in summaries else set()
        self.dynamics = {off: Dynamics(self.reduction, off, works, rubs, frozenset(gathered)) for off in sets}
        self.sides = {off: TwoSides(self.reduction, off, works, rubs) for off in sets} if scene.couplings else {}
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
            fine, coarse = self._go(driven), self._go(driven, half=True)
        rough = np.zeros(count, bool)
        for name, ends in fine.by_equal_steps.items():
            change, size = np.abs(ends - coarse.by_equal_steps[name]), np.abs(ends)
            rough |= ~(change <= TELLS_NOTHING * size).all(axis=0) | (coarse.verdict != Verdict.OK)
        verdict = np.where(rough & (fine.verdict == Verdict.OK), Verdict.TOO_COARSE, fine.verdict).astype(np.uint8)
        fine = fine._replace(verdict=verdict)
        # A verdict with coarser steps only is due to the method, not to the machine.
        values = {name: np.where(fine.verdict == Verdict.OK, v, np.nan) for name, v in fine.values.items()}
        errors = {}
        for name, value in values.items():
            change = np.where(coarse.verdict == Verdict.OK, np.abs(value - coarse.values[name]), np.abs(value))
            carried_error = np.maximum(share_of_change(name) * change, fine.missed.get(name, 0.0))
            errors[name] = carried_error + ROUNDING * np.maximum(np.abs(value), fine.scales.get(name, 0.0))
        for name, rows in fine.fields.items():
            size, other = _greatest(np.abs(rows)), coarse.fields[name]
            # The positions of the coarser cycle are a subset.
            change = _greatest(np.abs(rows[:, :: rows.shape[1] // other.shape[1]] - other))
            carried_error = np.where(coarse.verdict == Verdict.OK, change, size)
            carried_error += ROUNDING * np.maximum(size, fine.scales.get(name, 0.0))
            errors[name] = np.where(fine.verdict == Verdict.OK, carried_error, np.nan)
        return RegimeAnswers(values, errors, fine.fields, fine.verdict, np.reshape(fine.covered, (-1, 2, count)))

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

    def _go(self, driven: dict[frozenset[str], Variants], half: bool = False) -> Gone:
        """Compute all needed regimes in order."""
        count, steps = next(iter(driven.values())).count, self.steps // 2 if half else self.steps
        standing = self.at_begin(next(iter(driven.values())))
        gone = Gone({}, {}, standing.verdict, {}, {}, {}, [])
        for name in self.needed:
            off = frozenset(self.regimes[name].off)
            dynamics, variants = self.dynamics[off], driven[off]
            hindered = self.hindered(name, dynamics, variants)
            standing = standing._replace(verdict=np.where(standing.verdict, standing.verdict, hindered))
            if self.at_two_speeds(name) and name in self.steady:
                going, cycle, standing, found = self._steady_at_two_speeds(name, dynamics, variants, standing, half)
                made, energy = float(steps), going.energy
                found, scale = found | cycle.values, cycle.scales | {"speed_fluctuation": np.ones(count)}
                gone.fields.update({f"{name}.{key}": row for key, row in cycle.fields.items()})
                gone.missed.update({f"{name}.{key}": most for key, most in cycle.missed.items()})
            elif self.at_two_speeds(name):
                going, extremes, standing = self.run_at_two_speeds(name, variants, standing, half)
                made, energy = going.turned / dynamics.cycle * steps, going.energy
                found = self._at_two_speeds(name, dynamics, going) | extremes.values
                scale = extremes.scales | {"work_residual": np.ones(count)}
                gone.missed.update({f"{name}.{key}": most for key, most in extremes.missed.items()})
                gone.covered.append(_positions(variants, standing.angle, going.turned, going.covered))
            elif isinstance(self.regimes[name], RunRegime):
                outcome, extremes, standing = self.run(name, dynamics, variants, standing, half)
                gone.fields.update({f"{name}.{key}": rows for key, rows in extremes.rows.items()})
                gone.covered.append(_positions(variants, standing.angle, outcome.state.turned, outcome.covered))
                low, high = self.reduction.range_of(variants.numbers, variants.count)
                made = outcome.state.turned / (high - low) * steps
                energy = _greatest_energy(dynamics, variants, standing.angle, outcome)
                if self.regimes[name].method is not None:
                    gone.by_equal_steps[name] = np.stack(outcome.state[:3])
                results_of = partial(self._of_run, name, dynamics, variants, energy=energy)
                found, scale = results_of(outcome) | extremes.values, extremes.scales
                off = {} if half else spread_errors(outcome, outcome.changed, results_of)
                gone.missed.update({f"{name}.{key}": row for key, row in off.items()})
                found |= self._at_end(outcome, standing)
                # The work residual is relative to the works, and rounds as they do.
                scale |= {"end_reached": np.zeros(count), "work_residual": np.ones(count)}
                gone.missed.update({f"{name}.{key}": most for key, most in extremes.missed.items()})
            else:
                found, off, cycle, standing = self._steady(name, dynamics, variants, standing, half)
                gone.missed.update({f"{name}.{key}": row for key, row in off.items()})
                made, energy = float(steps), found["energy"]
                # δ is a difference of speeds, and rounds as they do.
                found, scale = found | cycle.values, cycle.scales | {"speed_fluctuation": np.ones(count)}
                gone.fields.update({f"{name}.{key}": row for key, row in cycle.fields.items()})
                gone.missed.update({f"{name}.{key}": most for key, most in cycle.missed.items()})
            asked = {key: v for key, v in found.items() if f"{name}.{key}" in self.asked}
            gone.values.update({f"{name}.{key}": v for key, v in asked.items()})
            # Rounding accumulates from step to step.
            growth = 1.0 + np.abs(made) / STEPS_OF_ROUNDING
            gone.scales.update({f"{name}.{key}": growth * np.abs(scale.get(key, v)) for key, v in asked.items()})
            gone.scales[f"{name}.energy_change"] = growth * energy
            for key, rows in gone.fields.items() if name in self.instants else ():
                if key.startswith(f"{name}."):
                    gone.scales[key] = growth * _greatest(np.abs(rows))
        numbers = next(iter(driven.values())).numbers
        for name, (reduced, motor) in self.at_shaft.items():
            ratio = np.abs(motor_ratio(self.scene, self.scene.moments[motor], numbers))
            for rows in (gone.values, gone.scales, gone.missed):
                if reduced in rows:
                    rows[name] = rows[reduced] / ratio
        for name in self.only_for_shafts:
            gone.values.pop(name, None)
        return gone._replace(verdict=standing.verdict)

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

    def run_at_two_speeds(
        self,
        name: str,
        variants: Variants,
        standing: Standing,
        loose: bool = False,
        record: Callable[[CoupledFields], Observer] | None = None,
    ) -> tuple[CoupledOutcome, FieldAnswers, Standing]:
        """Run a regime of a machine with a coupling from its current state.

        Parameters
        ----------
        name : str
        variants : Variants
            With the inertia of all parts.
        standing : Standing
        loose : bool
            Whether to use a looser tolerance, for comparison.
        record : callable, optional
            Creates the observer of the run, which replaces the requested fields.
        """
        regime, zero = self.regimes[name], np.zeros(variants.count)
        two, cycle = self.sides[frozenset(regime.off)], self.reduction.cycle

        def number(key: str, otherwise: float) -> np.ndarray:
            return self._number(name, key, variants, otherwise)

        if self._begins_anew(regime):
            standing = standing._replace(clock=zero)
        angle = number("from_angle", 0.0) if regime.from_angle is not None else standing.angle
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        sides = two.of(variants.some(ready), angle[ready])
        omega, shaft, engaged = standing.omega, standing.omega, zero
        if standing.coupled is not None:
            shaft, engaged = standing.coupled
        if regime.from_speed is not None:
            omega, engaged = number("from_speed", 0.0), zero
            shaft = omega
        omega, shaft, engaged, clock = (row[ready] for row in (omega, shaft, engaged, standing.clock))
        if regime.from_shaft_speed is not None:
            shaft = number("from_shaft_speed", 0.0)[ready] / sides.coupling.ratio
        turned, most = (number(key, np.inf)[ready] * cycle for key in ("cycles", "at_most"))
        time, speed = (number(key, np.inf)[ready] for key in ("time", "speed"))
        ends = CoupledEnds(
            turned, time, speed, regime.rest is True, regime.lock_up is True, most, regime.reversal is True
        )
        along, asked = CoupledFields(sides, clock, self.loads), self.fields[name]
        watch = record or (lambda along: RunExtremes(along, [one.field for one in asked]))
        observers = [watch(along)] if asked or record else []
        gone = run_coupled(sides, (omega, shaft), clock, engaged, ends, self._precision(loose), observers)
        extremes = FieldAnswers({}, {}, {}, {})
        if asked and record is None:
            extremes = observers[0].answers(asked, np.full(ready.size, BETWEEN_LOOKS))
            extremes = extremes.over_all(ready, variants.count)
        gone = gone.over_all(ready, variants.count)
        verdict = np.where(standing.verdict == Verdict.OK, gone.verdict, standing.verdict).astype(np.uint8)
        since = np.full(variants.count, np.nan)
        since[ready] = engaged
        after = CoupledStanding(gone.shaft_omega, zero if two.open else since + gone.time)
        angle = angle + variants.direction * gone.turned
        return gone, extremes, Standing(angle, gone.omega, standing.clock + gone.time, verdict, after)

    def _precision(self, coarser: bool) -> Precision:
        return Precision(self._run_tolerance[0], coarser)

    def at_two_speeds(self, name: str) -> bool:
        """Whether both sides of a coupling have separate speeds in a regime: always, except for a locked clutch."""
        return bool(self.sides) and (name not in self.steady or self.sides[frozenset(self.regimes[name].off)].is_fluid)

    def settled_at_two_speeds(
        self,
        name: str,
        variants: Variants,
        standing: Standing,
        loose: bool = False,
        record: Callable[[CoupledFields, np.ndarray], Observer] | None = None,
    ) -> tuple[CoupledSteady, CoupledOutcome, Standing]:
        """Steady running through a fluid coupling, and one cycle of it; parameters as for `run_at_two_speeds`.

        `record` also receives the indices of the variants in steady running.
        """
        two, count, zero = self.sides[frozenset(self.regimes[name].off)], variants.count, np.zeros(variants.count)
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        sides = two.of(variants.some(ready), zero[ready])
        precision = self._precision(loose)
        steady = settled_at_two_speeds(sides, precision)
        good = np.flatnonzero(steady.verdict == Verdict.OK)
        # Numbers of the variants in steady running, NaN for the others.
        moving = sides.some(good)
        watching = [] if record is None else [record(CoupledFields(moving, zero[good], self.loads), ready[good])]
        gone = one_cycle(moving, steady.speeds[:, good], precision, watching).over_all(ready[good], count)
        verdict = standing.verdict.astype(np.uint8).copy()
        verdict[ready] = np.where(steady.verdict == Verdict.OK, gone.verdict[ready], steady.verdict)
        speeds, multiplier, residual = (of_all(row, ready, count) for row in steady[1:])
        after = Standing(zero, speeds[0], zero, verdict, CoupledStanding(speeds[1], np.full(count, np.inf)))
        return CoupledSteady(verdict, speeds, multiplier, residual), gone, after

    def _steady_at_two_speeds(
        self, name: str, dynamics: Dynamics, variants: Variants, standing: Standing, half: bool
    ) -> tuple[CoupledOutcome, CycleAnswers, Standing, dict[str, np.ndarray]]:
        asked, seen = self.fields[name], []

        def record(along: CoupledFields, good: np.ndarray) -> CycleStates:
            looks = LOOKS[:: 2 if half else 1].size
            seen.append((along, good, CycleStates(good.size, looks)))
            return seen[0][2]

        steady, gone, after = self.settled_at_two_speeds(name, variants, standing, half, record if asked else None)
        cycle = CycleAnswers({}, {}, {}, {})
        if asked:
            along, good, states = seen[0]
            cycle = answers_of(self._fluid_cycle(along, states, half), asked, dynamics.cycle)
            cycle = cycle.over_all(good, variants.count)
        found = self._at_two_speeds(name, dynamics, gone)
        low, high = found["speed_min"], found["speed_max"]
        found |= {"period": gone.time, "mean_speed": dynamics.cycle / gone.time, "multiplier": steady.multiplier}
        found |= {"return_residual": steady.residual, "speed_fluctuation": 2.0 * (high - low) / (high + low)}
        found |= self._slips(name, variants, found["mean_speed"], gone)
        return gone, cycle, after, found

    def _fluid_cycle(self, along: CoupledFields, states: CycleStates, half: bool) -> Cycle:
        """The steady cycle through a fluid coupling with its fields."""
        variants, steps = along.variants, self.steps // 2 if half else self.steps
        sided = variants._replace(breaks=variants.breaks.two_sided())
        grid = along.dynamics.grid(sided, np.zeros(variants.count), along.dynamics.cycle, steps)
        angle = grid.places[NODES]
        rows = along(np.arange(variants.count), states.at(variants.direction * angle))
        even = np.broadcast_to(np.arange(len(angle))[:, None], angle.shape) if grid.even is None else grid.even
        return Cycle(angle, grid.steps, even, rows["speed"], variants.direction, rows)

    def _at_two_speeds(self, name: str, dynamics: Dynamics, gone: CoupledOutcome) -> dict[str, np.ndarray]:
        two = self.sides[frozenset(self.regimes[name].off)]
        found = {"time": gone.time, "angle": gone.turned, "final_speed": gone.omega}
        found |= _work_values(dynamics, gone.works, gone.squares, gone.time, gone.change, gone.energy)
        heat, works = gone.values["coupling_heat"], gone.works
        with np.errstate(all="ignore"):
            over = gone.energy + np.abs(works).sum(axis=0)
            found["work_residual"] = (works.sum(axis=0) - heat - gone.change) / over
        places = {"coupling": two.name, "shaft": two.coupling.shaft}
        for key, value in gone.values.items():
            side, _, rest = key.partition("_")
            found[f"{places[side]}_{rest}" if side in places else key] = value
        return found

    def run(
        self,
        name: str,
        dynamics: Dynamics,
        variants: Variants,
        standing: Standing,
        half: bool = False,
        record: Callable[[RunFields], Observer] | None = None,
    ) -> tuple[RunOutcome, FieldAnswers, Standing]:
        """Run a regime from the current state; the observer from `record` replaces the requested fields."""
        regime, count = self.regimes[name], variants.count

        def number(key: str, otherwise: float) -> np.ndarray:
            return self._number(name, key, variants, otherwise)

        keys, rounded = self.keys, 1.0 - ROUNDING if half else 1.0
        if self._begins_anew(regime):
            standing = standing._replace(clock=np.zeros(count))
        omega = number(keys.from_speed, 0.0) if getattr(regime, keys.from_speed) is not None else standing.omega
        angle = number(keys.from_place, 0.0) if getattr(regime, keys.from_place) is not None else standing.angle
        ends = Ends(
            number("cycles", np.inf) * dynamics.cycle,
            number("time", np.inf),
            # Near a speed that is never reached, the time to reach it is as uncertain as its last digits.
            number(keys.speed, np.inf) * rounded,
            regime.rest is True,
            number("at_most", np.inf) * dynamics.cycle,
            regime.end_of_range is True,
            regime.reversal is True,
        )
        ready = np.flatnonzero(standing.verdict == Verdict.OK)
        part = variants.some(ready)
        ends = ends.some(ready)
        begin = Begin(angle, omega, standing.clock).some(ready)
        observers = [] if record is None else [record(self._along(name, dynamics, part, begin))]
        key, left, stepping = ("run", name), np.arange(ready.size), self._stepping(name)
        known = variants.kept.get(key) if half and not observers else None
        if known is not None:
            left = np.flatnonzero(~known.tells(ready, begin))
            outcome = known.outcome.shifted(known.outcome.changed)
        if left.size or known is None:
            own = (dynamics, part.some(left), begin.some(left), ends.some(left))
            gone = run_to_end(Progress(*own, self.steps, half, observers, stepping))
            outcome = gone if known is None else outcome.with_others(left, gone)
        if not half:
            variants.kept[key] = Known(ready, begin, outcome)
        extremes = FieldAnswers({}, {}, {}, {})
        if self.fields[name] and record is None:
            # Fields are evaluated for runs that reach their end.
            good = np.flatnonzero(outcome.verdict == Verdict.OK)
            chosen = ends.some(good)
            found = self._extremes(name, dynamics, part.some(good), begin.some(good), chosen, half)
            extremes = found.over_all(ready[good], count)
        outcome = _over_all(outcome, ready, count)
        verdict = np.where(standing.verdict == Verdict.OK, outcome.verdict, standing.verdict)
        turned, time = outcome.state.turned, outcome.state.time
        # An end of the range stops the input.
        omega = np.where(outcome.arrived != 0, 0.0, outcome.state.omega)
        angle = angle + variants.direction * turned
        return outcome, extremes, Standing(angle, omega, standing.clock + time, verdict.astype(np.uint8))

    def _at_end(self, outcome: RunOutcome, standing: Standing) -> dict[str, np.ndarray]:
        """Final position of an input of limited range, and the energy of its impact on a stop."""
        if self.turns:
            return {}
        taken = np.where(outcome.arrived != 0, outcome.ended, 0.0)
        arrived = outcome.arrived.astype(float)
        found = {"final_position": standing.angle, "end_reached": arrived, "impact_energy": taken}
        return found | {"displacement": outcome.state.turned}

    def _stepping(self, name: str) -> Stepping:
        steps = self.regimes[name].steps_per_turn
        extremes = not {f"{name}.{key}" for key in EXTREMES_OF_SPEED}.isdisjoint(self.asked)
        if steps is None:
            return Stepping(*self._run_tolerance, extremes=extremes)
        return Stepping(farthest=TURN / steps, classical=True, extremes=extremes)

    def _along(self, name: str, dynamics: Dynamics, part: Variants, begin: Begin) -> RunFields:
        """Fields in a run."""
        return RunFields(dynamics, part, begin.angle, begin.clock, self.loads, frozenset(self.regimes[name].off))

    def _extremes(
        self, name: str, dynamics: Dynamics, part: Variants, begin: Begin, ends: Ends, half: bool
    ) -> FieldAnswers:
        """Requested fields of a run, with half the samples if `half`, for comparison."""
        steps, along = self.steps // 2 if half else self.steps, self._along(name, dynamics, part, begin)
        asked = [one for one in self.fields[name] if one.statistic]
        kept = [one.field for one in self.fields[name] if not one.statistic]
        observers: list[Observer] = []
        if asked:
            seen = RunExtremes(along, [one.field for one in asked])
            observers.append(seen)
        if kept:
            instants = RunInstants(along, kept, self.instants[name])
            observers.append(instants)
        outcome = run_to_end(Progress(dynamics, part, begin, ends, steps, half, observers, self._stepping(name)))
        low, high = self.reduction.range_of(part.numbers, part.count)
        found = seen.answers(asked, (high - low) / steps) if asked else FieldAnswers({}, {}, {}, {})
        if kept:
            instants.finish(outcome)
            found = found._replace(rows=instants.rows)
        return found

    def _of_run(
        self, name: str, dynamics: Dynamics, variants: Variants, outcome: RunOutcome, energy: np.ndarray
    ) -> dict[str, np.ndarray]:
        state, low, high = outcome.state, outcome.slowest, outcome.fastest
        found = {"time": state.time, "angle": state.turned, "final_speed": state.omega}
        found |= {"speed_min": low, "speed_max": high, "implicit_steps": outcome.steep}
        if f"{name}.motor_moment_peak" in self.asked:
            found["motor_moment_peak"] = dynamics.greatest_moment(variants.numbers, low, high)
        change = outcome.ended - outcome.started
        return found | _work_values(dynamics, state.works, state.squares, state.time, change, energy)

    # Steady running

    def _steady(
        self, name: str, dynamics: Dynamics, variants: Variants, standing: Standing, half: bool
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray], CycleAnswers, Standing]:
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
        if dynamics.rubs:
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
        cycle = CycleAnswers({}, {}, {}, {})
        if asked:
            off = frozenset(self.regimes[name].off)
            cycle = answers_of(cycle_of(dynamics, variants, grid, steady, self.loads, off), asked, dynamics.cycle)
        verdict = np.where(standing.verdict != Verdict.OK, standing.verdict, np.maximum(verdict, steady.verdict))
        begin = np.sqrt(2.0 * steady.energy / dynamics.inertia(variants, zero))
        held = CoupledStanding(begin, np.full(variants.count, np.inf)) if self.sides else None
        return found, missed, cycle, Standing(zero, begin, zero, verdict.astype(np.uint8), held)

    def _of_steady(self, name: str, dynamics: Dynamics, variants: Variants, steady: Steady) -> dict[str, np.ndarray]:
        """Results of steady running by their names without the regime's."""
        low, high, period = steady.slowest, steady.fastest, steady.period
        found = {"speed_min": low, "speed_max": high, "speed_fluctuation": steady.fluctuation}
        found |= {"period": period, "mean_speed": dynamics.cycle / period, "multiplier": steady.multiplier}
        found |= {"return_residual": steady.residual, "energy": steady.energy, "implicit_steps": steady.steep}
        if f"{name}.motor_moment_peak" in self.asked:
            found["motor_moment_peak"] = dynamics.greatest_moment(variants.numbers, low, high)
        change = steady.ended - steady.energy
        found |= _work_values(dynamics, steady.works, steady.squares, period, change, steady.energy)
        return found | self._slips(name, variants, dynamics.cycle / period)

    def _slips(
        self, name: str, variants: Variants, mean_speed: np.ndarray, gone: CoupledOutcome | None = None
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
) -> dict[str, np.ndarray]:
    """Results for work and power."""
    with np.errstate(all="ignore"):
        found = {
            "motor_work": works[0],
            "motor_power": works[0] / time,
            "motor_moment_rms": np.sqrt(squares / time),
            "energy_change": change,
            "work_residual": (works.sum(axis=0) - change) / (turned_over + np.abs(works).sum(axis=0)),
        }
        if dynamics.works:
            by_channel = dict(zip(CHANNELS, works[1:], strict=True))
            found |= {f"{key}_work": by_channel[key] for key in ("driving", "other")}
            found |= {f"{key}_work": 0.0 - by_channel[key] for key in ("useful", "harmful")}
            found["brake_heat"] = 0.0 - by_channel["braking"]
            found["efficiency"] = found["useful_work"] / (works[0] + by_channel["driving"])
    return found


def _joined(parts: list[RegimeAnswers]) -> RegimeAnswers:
    """Results of several chunks as one."""

    def joined(tables: list[dict[str, np.ndarray]]) -> dict[str, np.ndarray]:
        return {name: np.concatenate([table[name] for table in tables]) for name in tables[0]}

    return RegimeAnswers(
        joined([part.values for part in parts]),
        joined([part.errors for part in parts]),
        joined([part.fields for part in parts]),
        np.concatenate([part.verdict for part in parts]),
        np.concatenate([part.covered for part in parts], axis=2),
    )


def _positions(variants: Variants, end: np.ndarray, turned: np.ndarray, covered: np.ndarray) -> np.ndarray:
    """Minimum and maximum position of the input in runs that end at `end`, from the angles turned."""
    return np.sort(end + variants.direction * (covered - turned), axis=0)


def _greatest(rows: np.ndarray) -> np.ndarray:
    """Maximum of each row, ignoring NaN; 0 for a row of NaN."""
    return np.fmax.reduce(rows, axis=1, initial=0.0)


def _greatest_energy(dynamics: Dynamics, variants: Variants, angle: np.ndarray, outcome: RunOutcome) -> np.ndarray:
    """Approximate peak kinetic energy of a run: at its ends, or at its maximum speed."""
    inertia = dynamics.inertia(variants, angle)
    fastest = np.maximum(np.abs(outcome.fastest), np.abs(outcome.slowest))
    return np.maximum(0.5 * inertia * fastest**2, np.maximum(outcome.started, outcome.ended))


def _over_all(outcome: RunOutcome, ready: np.ndarray, count: int) -> RunOutcome:
    """An outcome of some variants expanded to all, NaN for the others."""
    state = type(outcome.state)(*(of_all(x, ready, count) for x in outcome.state))
    verdict = np.full(count, Verdict.OK, np.uint8)
    verdict[ready] = outcome.verdict
    changed = Changed(*(of_all(x, ready, count) for x in outcome.changed))
    names = ("slowest", "fastest", "started", "ended", "arrived", "known", "covered", "steep")
    rest = {name: of_all(getattr(outcome, name), ready, count) for name in names}
    return RunOutcome(verdict, state, changed=changed, **rest)
