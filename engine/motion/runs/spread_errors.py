"""Propagation of errors from a motion's own numbers to its results."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from engine.motion.runs.run_progress import Changed, RunOutcome
from engine.motion.settled.steady import Steady

Motion = TypeVar("Motion", RunOutcome, Steady)
# Fields that don't enter the results.
SKIPPED = ("verdict", "record", "steep")


def spread_errors(
    motion: Motion, errors: Changed | Steady, results_of: Callable[[Motion], dict[str, np.ndarray]]
) -> dict[str, np.ndarray]:
    """Error estimates of results: the sum of the changes due to the error of each of a motion's own numbers.

    Parameters
    ----------
    motion : RunOutcome or Steady
    errors : Changed or Steady
        Error estimates of its numbers; works have one row each.
    results_of : callable
        Computes the results of a motion.
    """
    known, nothing = results_of(motion), type(errors)(*(np.zeros_like(x) for x in errors))
    off = {name: np.zeros_like(value) for name, value in known.items()}
    for name in errors._fields:
        rows = getattr(errors, name)
        for i in np.ndindex(rows.shape[:-1]) if name not in SKIPPED else ():
            alone = np.zeros_like(rows)
            alone[i] = rows[i]
            for result, value in results_of(motion.shifted(nothing._replace(**{name: alone}))).items():
                off[result] += np.abs(value - known[result])
    return off
