"""The regimes of a scene in order, for many variants, with an error estimate for every number.

Runs over the crank angle and steady running propagate the errors of their steps; fields of steady running, and what
follows a run, are evaluated again with these errors added. All other motions run three times, twice for comparison;
with friction in pairs, the comparisons displace the ends of their steps by the error estimates of these.
The error estimate is the larger of the propagated error and the range of the results, plus the rounding of the
energies.
"""

from typing import NamedTuple

import numpy as np

from engine.compiling.threads import on_all_threads, threads
from engine.mechanism.actions.motors import motor_ratio
from engine.mechanism.mechanics import Mechanics
from engine.motion.asked_regimes import AskedRegimes
from engine.motion.moments.dynamics import Variants
from engine.motion.quantities import FINAL_POSITION, FieldAnswers
from engine.motion.regime_motions import ROUNDING, OneRegime, RegimeMotion
from engine.motion.run_motions import RunAtOneSpeed, RunAtTwoSpeeds
from engine.motion.runs.run_progress import Standing
from engine.motion.steady_motions import SteadyAtOneSpeed, SteadyAtTwoSpeeds
from engine.scene.scene import Numbers
from engine.stepping.records import on_arrays
from engine.stepping.walk_task import WALKS, change_or_anything
from engine.words.verdicts import Verdict

# Largest relative change of the final time, angle or speed with equal steps of twice the length; beyond: TOO_COARSE.
MAX_STEP_CHANGE = 0.01
# Bytes of cache shared by the cores, and rows of tables: they limit the variants computed together.
CACHE, ROWS = 16e6, 6
# Variants computed together, if no fields are tabulated: with fewer, calls of NumPy count.
TOGETHER = 16_384
WORTH_A_THREAD = 128
# Numbers in a cache line.
ODD = 8
# Steps whose rounding equals all other rounding: half a unit in the last place each.
STEPS_OF_ROUNDING = 32


def share_of_change(name: str) -> float:
    """Factor from the change with coarser steps to the error estimate of a result."""
    last = name.rpartition(".")[2]
    # Means over time, extremes and their positions, and the heat of a coupling, converge without an order if a steep
    # motor or coupling recovers from a jump within a step.
    positions = ("min_at", "max_at", "min_time", "max_time")
    without_order = ("mean", "rms", "mean_speed", "speed_min", "speed_max", *positions)
    # A coupling has any name.
    of_coupling = last.endswith("_heat") and last != "brake_heat"
    return 2.0 if of_coupling or last in without_order else 1.0


class RegimeAnswers(NamedTuple):
    """Values, fields and error estimates by name, and the verdict on each variant.

    A field has one error estimate for each variant, the maximum over the instants of a run or the positions of a cycle.
    `failing` is the index of the first of the scene's regimes that fails, or −1, and `covered` the range of the input
    positions in each run, (runs, 2, variants), in order.
    """

    values: dict[str, np.ndarray]
    errors: dict[str, np.ndarray]
    fields: dict[str, np.ndarray]
    verdict: np.ndarray
    failing: np.ndarray
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


class RegimesInOrder(AskedRegimes):
    """The regimes of a scene in order; parameters as for `AskedRegimes`.

    Attributes
    ----------
    motions : dict of str to RegimeMotion
        The needed regimes in order.
    """

    def __init__(self, mechanics: Mechanics, asked: set[str], steps: int, accuracy: float | None = None) -> None:
        super().__init__(mechanics, asked, steps, accuracy)
        self.motions = {name: self._motion(name) for name in self.needed}

    def _motion(self, name: str) -> RegimeMotion:
        two = self.sides.get(frozenset(self.regimes[name].off))
        if name in self.steady:
            # A clutch holds in steady running; a fluid coupling always slips.
            return (SteadyAtTwoSpeeds if two is not None and two.is_fluid else SteadyAtOneSpeed)(self, name)
        return (RunAtOneSpeed if two is None else RunAtTwoSpeeds)(self, name)

    def at_begin(self, variants: Variants) -> Standing:
        """Initial state before the first regime: at φ = 0 or at the start of the input's range, at rest."""
        zero = np.zeros(variants.count)
        low, high = self.reduction.range_of(variants.numbers, variants.count)
        begin = zero if self.reduction.has_cycle else np.where(variants.direction > 0.0, low, high)
        return Standing(begin, zero, zero, np.full(variants.count, Verdict.OK, np.uint8))

    @property
    def looked_at(self) -> bool:
        """Whether any field is requested, or one of its statistics."""
        return any(self.fields[name] for name in self.needed)

    def answers(self, numbers: Numbers, count: int) -> RegimeAnswers:
        """Requested results of a number of variants."""
        # Fields are tabulated over the steps of a cycle.
        together = int(CACHE / (8 * ROWS * (2 * self.steps + 1))) + 1 if self.looked_at else TOGETHER
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
            fine, regimes = self._go(driven, WALKS[0])
            verdict = regimes[-1].standing.verdict
            known = np.all([np.broadcast_to(one.known, count) for one in regimes], axis=0)
            # Of one regime without fields, all errors may be known by propagation.
            alone = len(regimes) == 1 and not self.looked_at and fine.values.keys() <= fine.missed.keys()
            whole, rough, compared = np.ones(count, bool), np.zeros(count, bool), []
            for longer in WALKS[1:]:
                every = longer == WALKS[1] and not alone
                again = np.flatnonzero(every | (~known & whole & (verdict == Verdict.OK)))
                if not again.size:
                    continue
                # Without results kept from other walks: an estimate depends on its own variant only.
                few = driven if every else {off: each.some(again)._replace(kept={}) for off, each in driven.items()}
                coarse, others = self._go(few, longer)
                # A verdict with coarser steps only is due to the method, not to the machine.
                whole[again] = others[-1].standing.verdict == Verdict.OK
                rows = coarse.values | coarse.rows
                if not every:
                    rows, new = on_arrays(np.copy, compared[-1] if compared else fine.values), rows
                    for name, row in new.items():
                        rows[name][again] = row
                compared.append(rows)
                for mine, other in zip(regimes, others, strict=True):
                    if mine.by_equal_steps is not None and longer == WALKS[1]:
                        own = mine.by_equal_steps[:, again]
                        close = np.abs(own - other.by_equal_steps) <= MAX_STEP_CHANGE * np.abs(own)
                        rough[again] |= ~close.all(axis=0) | ~whole[again]
        verdict = np.where(rough & (verdict == Verdict.OK), Verdict.TOO_COARSE, verdict).astype(np.uint8)
        values = {name: np.where(verdict == Verdict.OK, v, np.nan) for name, v in fine.values.items()}
        errors = {}
        for name, row in (values | fine.rows).items():
            size, others = np.abs(row), [each[name] for each in compared]
            change = np.ptp([row, *others], axis=0)
            if name.endswith("_at") or name.partition(".")[2] == FINAL_POSITION:
                # Positions recur after a cycle, which is infinite if they do not.
                change = np.minimum(change, np.abs(self.reduction.cycle - change))
            if row.ndim > 1:
                size, change = _greatest(size), _greatest(change)
            else:
                change = change_or_anything(change, row)
            change = share_of_change(name) * np.where(whole, change, size)
            rounding = ROUNDING * np.maximum(size, fine.scales.get(name, 0.0))
            error = np.maximum(change, fine.missed.get(name, 0.0)) + rounding
            errors[name] = np.where(verdict == Verdict.OK, error, np.nan)
        covered = [found.covered for found in regimes if found.covered is not None]
        fails = np.array([found.standing.verdict != Verdict.OK for found in regimes])
        which = np.array([[*self.scene.regimes].index(self.leads.get(name, name)) for name in self.needed])
        failing = np.where(fails.any(axis=0), which[fails.argmax(axis=0)], -1)
        return RegimeAnswers(values, errors, fine.rows, verdict, failing, np.reshape(covered, (-1, 2, count)))

    def _go(self, driven: dict[frozenset[str], Variants], longer: float) -> tuple[FieldAnswers, list[OneRegime]]:
        """Compute all needed regimes in order; the requested results by their names, and each regime's."""
        standing = self.at_begin(next(iter(driven.values())))
        every, regimes = FieldAnswers.none(), []
        for name, motion in self.motions.items():
            found = motion.follow(driven[motion.dynamics.off], standing, longer)
            answers, standing = found.answers, found.standing
            asked = {key: v for key, v in answers.values.items() if f"{name}.{key}" in self.asked}
            # Rounding accumulates from step to step; numbers of a brake that nearly locks itself bring more.
            growth = 1.0 + np.abs(found.made) / STEPS_OF_ROUNDING
            growth = growth * motion.dynamics.rounding_of_brakes(driven[motion.dynamics.off].numbers)
            scales = {key: growth * np.abs(answers.scales.get(key, v)) for key, v in asked.items()}
            scales["energy_change"] = growth * found.energy
            # Works, of which parts may cancel, round as the energies do.
            works = [key for key in asked if key.endswith(("_work", "_heat"))]
            scales |= {key: np.maximum(scales[key], found.energy) for key in works}
            if name in self.instants:
                scales |= {key: growth * _greatest(np.abs(rows)) for key, rows in answers.rows.items()}
            for table, own in zip(every, answers._replace(values=asked, scales=scales), strict=True):
                table.update({f"{name}.{key}": row for key, row in own.items()})
            regimes.append(found)
        numbers = next(iter(driven.values())).numbers
        for name, (reduced, motor) in self.at_shaft.items():
            ratio = np.abs(motor_ratio(self.scene, self.scene.moments[motor], numbers))
            for rows in (every.values, every.missed, every.scales):
                if reduced in rows:
                    rows[name] = rows[reduced] / ratio
        for name in self.only_for_shafts:
            every.values.pop(name, None)
        return every, regimes


def _joined(parts: list[RegimeAnswers]) -> RegimeAnswers:
    """Results of several chunks as one; ranges of positions count the variants last."""
    return on_arrays(lambda *rows: np.concatenate(rows, axis=2 if rows[0].ndim == 3 else 0), *parts)


def _greatest(rows: np.ndarray) -> np.ndarray:
    """Maximum of each row, ignoring NaN; 0 for a row of NaN."""
    return np.fmax.reduce(rows, axis=1, initial=0.0)
