"""Batches of candidates: columns, costs and constraint violations."""

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from engine import Verdict
from sweeps.run.blocks import evaluate_variants
from sweeps.study.search_task import Objective, SearchTask
from sweeps.text.conditions import Values, met_by, value_with_error

if TYPE_CHECKING:
    from sweeps.run.cluster.crew import Crew

# Violation of an undefined cost, or of a strict inequality on its limit.
LEAST_VIOLATION = 1e-12


class Batch(NamedTuple):
    """Evaluated candidates.

    Attributes
    ----------
    columns : dict of str to ndarray (candidates,)
        Parameters, verdicts, summaries, error estimates and objectives, SI.
    costs : ndarray (candidates, objectives)
        To be minimised.
    margins : ndarray (parts, candidates)
        Positive where a condition is missed (see `Condition.margins`).
    violation : ndarray (candidates,)
        Total violation of the conditions; exactly 0 if feasible.
    """

    columns: dict[str, np.ndarray]
    costs: np.ndarray
    margins: np.ndarray
    violation: np.ndarray

    @property
    def met(self) -> np.ndarray:
        """Feasible candidates."""
        return self.violation == 0


Evaluate = Callable[[np.ndarray], Batch]

# Costs of infeasible candidates: above all others, growing with the violation.
BEYOND = 1e100


class Trials:
    """Evaluates candidates of a search in batches.

    Parameters
    ----------
    task : SearchTask
    crew : Crew, optional
        Cluster workers that share the candidates.
    """

    def __init__(self, task: SearchTask, crew: "Crew | None" = None) -> None:
        self.task, self.crew = task, crew

    def evaluate(self, coordinates: np.ndarray) -> Batch:
        """Evaluate the candidates at coordinates (candidates, variables), each from 0 to 1.

        Includes candidates that fail `require`, so that gradients exist at its limits.
        """
        varied = self.task.variables.values(coordinates)
        return self.judged(self.columns(varied, coordinates.shape[0], drop=False))

    def columns(self, varied: Mapping[str, np.ndarray], count: int, drop: bool) -> dict[str, np.ndarray]:
        """All columns of `count` candidates, in memory bounded as for a sweep.

        Parameters
        ----------
        varied : mapping of str to ndarray (count,)
        count : int
        drop : bool
            Skip candidates that fail `require`.
        """
        study = self.task.study
        values, missed = study.completed(varied, count)
        dropped = missed.any(axis=0) & drop
        found = evaluate_variants(study, values, dropped) if self.crew is None else self.crew.share_out(values, dropped)
        for objective in self.task.objectives:
            if not objective.is_column:
                known = study.requirements.known(found)
                found[objective.name], found[f"{objective.name}_error"] = _with_error(objective, *known, count)
        return found

    def judged(self, columns: dict[str, np.ndarray]) -> Batch:
        """Costs, margins and violations from the candidates' columns."""
        task, status = self.task, columns["status"]
        costs = np.column_stack([o.sign * columns[o.name] for o in task.objectives])
        conditions, known = (*task.study.require, *task.conditions), task.study.requirements.known(columns)
        apart = [condition.margins(*known, status.size) for condition in conditions]
        parts = np.concatenate(apart) if apart else np.zeros((0, status.size))
        violation = np.maximum(parts, 0).sum(axis=0)
        violation += (status != Verdict.OK) & (status != Verdict.DROPPED)
        met = met_by(conditions, *known, status.size) & (status == Verdict.OK) & np.isfinite(costs).all(axis=1)
        violation = np.where(met, 0.0, np.maximum(violation, LEAST_VIOLATION))
        return Batch(columns, costs, parts, violation)


def _with_error(objective: Objective, values: Values, errors: Values, count: int) -> tuple[np.ndarray, np.ndarray]:
    """An objective and its error estimate."""
    with np.errstate(all="ignore"):
        found = value_with_error(objective.expression.tree, values, errors)
    value, error = (np.broadcast_to(part, (count,)).astype(float) for part in found)
    return value, np.where(np.isfinite(value) & np.isfinite(error), error, np.nan)
