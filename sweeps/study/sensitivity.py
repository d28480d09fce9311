"""Sensitivity of results: requested derivatives, and tolerance bands.

To first order, tolerances ± t₁, ± t₂, … change a result f by at most Σ |∂f/∂pᵢ| tᵢ, and by √Σ (∂f/∂pᵢ tᵢ)² if
deviations are independent and all tᵢ equally rare (root of the sum of squares, RSS).
Source: any handbook of tolerance analysis, linear stack-up.
"""

from collections.abc import Callable, Mapping
from functools import cached_property
from typing import NamedTuple

import numpy as np

import engine
from sweeps.store import Column, columns_of_number
from sweeps.study.study_content import AskedDerivative, ReadyMachine, StudyContent
from sweeps.study.study_text import ToleranceText
from sweeps.text.scene_text import unknown_number_text

# Variants per batch, to bound memory.
TOGETHER = 2048
# Factor on joint effects of two tolerances, for those of three.
MARGIN = 1.25
WORST_CASE, RSS = "tolerance_worst_case", "tolerance_rss"


class Tolerance(NamedTuple):
    """Tolerance of a number: uniform within ± `half_width`, or normal with σ = ±/3."""

    path: str
    half_width: float
    distribution: str

    @property
    def deviation(self) -> float:
        """Standard deviation."""
        return self.half_width / (3.0 if self.distribution == "normal" else 3.0**0.5)


def read_tolerances(scene: engine.Scene, texts: Mapping[str, ToleranceText]) -> tuple[Tolerance, ...]:
    """Tolerances in SI units.

    Parameters
    ----------
    scene : Scene
    texts : mapping of str to ToleranceText
        By path of the number.

    Raises
    ------
    AskError, UnitError
        No number of the scene, or no width.
    """
    numbers, found = engine.scene_numbers(scene), []
    for path, text in texts.items():
        if path not in numbers:
            raise engine.AskError(unknown_number_text(scene, path))
        half_width = engine.in_text(text.plus_minus, numbers[path].dimension)
        if not 0 < half_width < np.inf:
            raise engine.AskError(f"{text.plus_minus!r}: a tolerance must be greater than 0, such as '0.1 mm'")
        found.append(Tolerance(path, half_width, text.distribution))
    return tuple(found)


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
                engine.unknown_name_message(asked.by, known, f"{asked.by!r} is not a number that the scene gives")
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
    def machine(self) -> ReadyMachine:
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
        together = max(1, TOGETHER // max(1, len(self.tolerances)))
        for start in range(0, chosen.size, together):
            some = chosen[start : start + together]
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
        return found | self._bands(known, along) if self._summaries else found

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
        widths, count = np.array([[t.half_width] for t in self.tolerances]), len(slopes)
        shares = {name: np.stack([s.values[name] for s in slopes]) * widths for name in self._summaries}
        each, (first, second) = np.eye(count), np.triu_indices(count, 1)
        up = np.vstack([each, each[first] + each[second]])
        # The extreme machine, with all tolerances added up.
        corners = np.concatenate([[sign * np.copysign(1.0, rows) for sign in (1, -1)] for rows in shares.values()])
        around = np.broadcast_to(np.stack([up, -up])[..., None], (2, *up.shape, corners.shape[-1]))
        changes = self._changes(known, np.concatenate([*around, corners]))
        found = {}
        for k, (name, parts) in enumerate(shares.items()):
            near, far = changes[name][: 2 * len(up)].reshape(2, len(up), -1), changes[name][2 * len(up) :][2 * k :][:2]
            alone, paired = near[:, :count], near[:, count:]
            # Nonlinearity in one number adds to the error of its slope; a product of two numbers is linear in each.
            of_slopes = np.stack([s.errors[name] for s in slopes]) * widths
            slips = of_slopes + np.abs(alone - np.stack([parts, -parts])).max(axis=0)
            both = MARGIN * np.abs(paired - alone[:, first] - alone[:, second]).max(axis=0)
            beyond = of_slopes.sum(axis=0) + np.abs(np.abs(far) - np.abs(parts).sum(axis=0)).max(axis=0)
            estimates = np.vstack([slips, both])
            parts = np.where(np.isfinite(estimates).all(axis=0) & np.isfinite(beyond), parts, np.nan)
            for ending, added in ((WORST_CASE, np.sum), (RSS, np.linalg.norm)):
                found[f"{name}.{ending}"] = added(np.abs(parts), axis=0)
                found[f"{name}.{ending}_error"] = np.maximum(added(estimates, axis=0), beyond * (ending == WORST_CASE))
        return found

    def _changes(self, known: Mapping[str, np.ndarray], offsets: np.ndarray) -> dict[str, np.ndarray]:
        """Changes of each summary (offsets, variants), NaN if no machine can be built there.

        The offsets (offsets, tolerances, variants) are multiples of the tolerances.
        """
        offsets = np.concatenate([0.0 * offsets[:1], offsets])
        shape = len(offsets), offsets.shape[-1]
        places = {path: np.broadcast_to(known[path], shape) for path in self.machine.varied}
        for k, tolerance in enumerate(self.tolerances):
            places[tolerance.path] = places[tolerance.path] + tolerance.half_width * offsets[:, k]
        outcome = self.machine.evaluate({path: values.ravel() for path, values in places.items()})
        built = {
            name: np.where(outcome.status == engine.Verdict.OK, row, np.nan) for name, row in outcome.summaries.items()
        }
        return {name: row.reshape(shape)[1:] - row.reshape(shape)[:1] for name, row in built.items()}
