"""Propagation of errors from a motion's own numbers to its results."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from engine.motion.runs.run_progress import Changed, RunOutcome
from engine.motion.settled.steady import Steady
from engine.stepping.walk_task import change_or_anything

Motion = TypeVar("Motion", RunOutcome, Steady)
# Fields that don't enter the results.
SKIPPED = ("verdict", "record", "steep")


def spread_errors(
    motion: Motion,
    errors: Changed | Steady,
    results_of: Callable[[Motion], dict[str, np.ndarray]],
    asks: Callable[[str], bool],
) -> dict[str, np.ndarray]:
    """Error estimates of results: the sum of the changes due to the error of each of a motion's own numbers.

    Parameters
    ----------
    motion : RunOutcome or Steady
    errors : Changed or Steady
        Error estimates of its numbers; works have one row each.
    results_of : callable
        Computes the results of a motion.
    asks : callable
        Whether a result is requested.
    """
    nothing = type(errors)(*(np.zeros_like(x) for x in errors))
    known = {name: value for name, value in results_of(motion).items() if asks(name)}
    off = {name: np.zeros_like(value) for name, value in known.items()}
    for name in errors._fields:
        rows = getattr(errors, name)
        for i in np.ndindex(rows.shape[:-1]) if name not in SKIPPED else ():
            if not rows[i].any():
                continue
            alone = np.zeros_like(rows)
            alone[i] = rows[i]
            changed = results_of(motion.shifted(nothing._replace(**{name: alone})))
            for result, value in known.items():
                off[result] += change_or_anything(np.abs(changed[result] - value), value)
    return off
