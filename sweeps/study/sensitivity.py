"""Sensitivity of results: requested derivatives, and tolerance bands.

To first order, tolerances ± t₁, ± t₂, … change a result f by at most Σ |∂f/∂pᵢ| tᵢ, and by √Σ (∂f/∂pᵢ tᵢ)² if
deviations are independent and all tᵢ equally rare (root of the sum of squares, RSS).
Source: any handbook of tolerance analysis, linear stack-up.
"""

from collections.abc import Callable, Iterable, Mapping
from functools import cached_property

import numpy as np

import engine
from sweeps.store import Column, columns_of_number
from sweeps.study.study_content import AskedDerivative, StudyContent
from sweeps.study.tolerances import Tolerance, read_tolerances

# Variants per batch, to bound memory.
TOGETHER = 2048
WORST_CASE, RSS = "tolerance_worst_case", "tolerance_rss"


class Sensitivity:
    """Derivatives and tolerance bands of a study's variants.

    A derivative includes numbers that the study derives from its variable. A tolerance doesn't: each part is made
    separately.

    Parameters
    ----------
    study : StudyContent

    Raises
    ------
    AskError
        A summary or a number doesn't exist, or has no derivative.
    """

    def __init__(self, study: StudyContent) -> None:
        self.study = study
        self.tolerances = read_tolerances(study.scene, study.tolerances)
        left_out = (*engine.PLACE_STATISTICS, *engine.ACCURACY_SUMMARIES)
        smooth = [n for n in study.summaries if not n.endswith(left_out) and not engine.is_warning(n)]
        self._summaries = smooth if self.tolerances else []
        for asked in study.derivatives:
            self._check(asked)

    def _check(self, asked: AskedDerivative) -> None:
        study, numbers = self.study, engine.scene_numbers(self.study.scene)
        known = dict.fromkeys([*numbers, *study.parameters])
        if asked.by not in known:
            raise engine.AskError(
                f"{asked.by!r} is not a number that the scene gives. {engine.unknown_name_message(asked.by, known)}"
            )
        if asked.of.endswith(engine.PLACE_STATISTICS):
            raise engine.AskError(
                f"{asked.of!r} is the position of an extreme, which may jump between peaks: it has no derivative"
            )
        if asked.by in numbers:
            engine.scale_of(study.scene, {asked.by: np.array([numbers[asked.by].value])}, asked.by)
            engine.made_ready(study.scene, [asked.of], (), [asked.by])
        engine.made_ready(study.scene, [asked.of])

    @cached_property
    def machine(self) -> engine.Machine | engine.ElementsAlone:
        """The machine, in float64, at the study's positions or accuracy."""
        study = self.study
        names = dict.fromkeys([*(asked.of for asked in study.derivatives), *self._summaries])
        moved = (name for name in (*self._derived_by, *(t.path for t in self.tolerances)) if name in study.fixed)
        varied = dict.fromkeys([*study.paths, *moved])
        return engine.made_ready(study.scene, names, (), varied, study.positions, accuracy=study.accuracy)

    @property
    def _derived_by(self) -> tuple[str, ...]:
        return tuple(dict.fromkeys(asked.by for asked in self.study.derivatives))

    @property
    def evaluations(self) -> int:
        """Extra evaluations per variant."""
        return engine.EVALUATIONS_PER_DERIVATIVE * len({*self._derived_by, *(t.path for t in self.tolerances)})

    @cached_property
    def quantities(self) -> tuple[engine.Quantity, ...]:
        """The resulting quantities, each with an error estimate."""
        available = self.machine.available_summaries if self.evaluations else {}
        found = []
        for asked in self.study.derivatives:
            of = available[asked.of]
            units = engine.unit_over(of.units, self.study.unit(asked.by) or "1")
            found.append(engine.Quantity(asked.name, f"derivative with respect to {asked.by}: {of.long_name}", units))
        for name in self._summaries:
            words, units = available[name].long_name, available[name].units
            found.append(engine.Quantity(f"{name}.{WORST_CASE}", f"worst case within tolerances, ±: {words}", units))
            found.append(
                engine.Quantity(f"{name}.{RSS}", f"root of the sum of squares of tolerances, ±: {words}", units)
            )
        return tuple(found)

    @property
    def columns(self) -> list[Column]:
        """Columns filled by `of_variants`."""
        found = [c for q in self.quantities for c in columns_of_number(q.name, q.long_name, q.units)]
        words = "verdict on the variant's neighbours along"
        return found + [Column(f"status_by.{by}", f"{words} {by}", "1", dtype=np.uint8) for by in self._derived_by]

    def of_variants(self, values: Mapping[str, np.ndarray], status: np.ndarray) -> dict[str, np.ndarray]:
        """Columns of a block of variants.

        Parameters
        ----------
        values : mapping of str to ndarray (variants,)
            Their parameters (SI), including derived ones.
        status : ndarray (variants,) of uint8
            Their verdicts; only successful variants count.
        """
        names = [quantity.name for quantity in self.quantities]
        found = {name: np.full(status.size, np.nan) for name in (*names, *(f"{name}_error" for name in names))}
        found |= {f"status_by.{by}": status.copy() for by in self._derived_by}
        chosen = np.flatnonzero(status == engine.Verdict.OK) if self.evaluations else np.zeros(0, int)
        for start in range(0, chosen.size, TOGETHER):
            some = chosen[start : start + TOGETHER]
            part = self._of_some({name: array[some] for name, array in values.items()}, some.size)
            for name, array in part.items():
                found[name][some] = array
        return found

    def _of_some(self, values: Mapping[str, np.ndarray], count: int) -> dict[str, np.ndarray]:
        known = {path: np.full(count, value) for path, value in self.study.fixed.items()} | values
        slopes: dict[tuple[str, bool], engine.Derivatives] = {}
        found = {}

        def along(by: str, followed: bool) -> engine.Derivatives:
            key = (by, followed and self._is_followed(by))
            if key not in slopes:
                slopes[key] = engine.derivatives_along(self.machine, self._move(known, *key))
            return slopes[key]

        for asked in self.study.derivatives:
            by = along(asked.by, True)
            found |= {asked.name: by.values[asked.of], f"{asked.name}_error": by.errors[asked.of]}
            found[f"status_by.{asked.by}"] = by.status
        return found | self._bands(known, along) if self.tolerances else found

    # Moves

    def _is_followed(self, by: str) -> bool:
        """Whether anything is derived from a number, directly or indirectly."""
        moved = {by}
        for path, expression in self.study.derived.items():
            if moved.intersection(expression.names):
                moved.add(path)
        return len(moved) > 1

    def _move(self, known: Mapping[str, np.ndarray], by: str, followed: bool) -> engine.Move:
        study, paths = self.study, self.machine.varied
        needed = {*paths, *(name for expression in study.derived.values() for name in expression.names)}

        def varied(places: np.ndarray, variants: np.ndarray) -> dict[str, np.ndarray]:
            numbers = {name: known[name][variants] for name in needed} | {by: places}
            for path, expression in study.derived.items() if followed else ():
                if path != by:
                    numbers[path] = np.broadcast_to(expression.evaluate(numbers), places.shape).astype(float)
            return {path: numbers[path] for path in paths}

        size = np.abs(known[by])
        scale = engine.scale_of(study.scene, known, by) if by in study.fixed else np.where(size > 0, size, 1.0)
        return engine.Move(known[by], scale, varied)

    # Tolerances

    def _bands(
        self, known: Mapping[str, np.ndarray], along: Callable[[str, bool], engine.Derivatives]
    ) -> dict[str, np.ndarray]:
        slopes = [along(tolerance.path, False) for tolerance in self.tolerances]
        bends = [self._bend(known, tolerance) for tolerance in self.tolerances]
        found = {}
        for name in self._summaries:
            parts = _table(slope.values[name] * t.half_width for slope, t in zip(slopes, self.tolerances, strict=True))
            doubts = _table(slope.errors[name] * t.half_width for slope, t in zip(slopes, self.tolerances, strict=True))
            doubts += _table(bend[name] for bend in bends)
            parts = np.where(np.isfinite(doubts), parts, np.nan)
            for ending, added in ((WORST_CASE, np.sum), (RSS, np.linalg.norm)):
                found[f"{name}.{ending}"] = added(np.abs(parts), axis=0)
                found[f"{name}.{ending}_error"] = added(doubts, axis=0)
        return found

    def _bend(self, known: Mapping[str, np.ndarray], tolerance: Tolerance) -> dict[str, np.ndarray]:
        """Nonlinear remainder at the ends of one tolerance; NaN if no machine can be built there."""
        move, count = self._move(known, tolerance.path, False), known[tolerance.path].size
        offsets = np.array([0.0, 1.0, -1.0])[:, None] * tolerance.half_width
        outcome = self.machine.evaluate(move.varied((move.at + offsets).ravel(), np.tile(np.arange(count), 3)))
        found = {}
        for name, values in outcome.summaries.items():
            here, more, less = np.where(outcome.status == engine.Verdict.OK, values, np.nan).reshape(3, count)
            found[name] = np.abs((more - here) + (less - here)) / 2
        return found


def _table(rows: Iterable[np.ndarray]) -> np.ndarray:
    return np.stack(list(rows))
