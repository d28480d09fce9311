"""First position at which a variant fails: equally spaced ones are examined, then the interval before is bisected."""

from collections.abc import Callable, Sequence

import numpy as np

from engine.compiling.printed_functions import PrintedFunction
from engine.cycle.regula_falsi import bisected
from engine.graph.at_points import Points, fill_points
from engine.graph.functions import function_at
from engine.graph.nodes import Node
from engine.machine.measuring.measuring import Measuring

# Equally spaced positions that are examined.
LOOKED_AT = 720


def first_failure(
    measuring: Measuring, curves: Sequence[Node], table: np.ndarray, fails: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """First position at which one of some curves fails.

    Parameters
    ----------
    measuring : Measuring
    curves : sequence of Node
    table : ndarray (numbers, variants)
        Including the numbers found on the cycle.
    fails : callable
        Whether values (curves, positions, variants) fail.

    Returns
    -------
    which : ndarray (variants,) of int
        The curve that fails there; −1 if none fails at the positions examined.
    place : ndarray (variants,)
        The position; NaN if there is none.
    """
    functions, variants = measuring.functions, np.arange(table.shape[1])
    numbers = np.ascontiguousarray(table)
    function = PrintedFunction(function_at(curves, functions.rows))

    def failing_at(q: np.ndarray) -> np.ndarray:
        """Which curves fail at positions (positions, variants)."""
        out = np.empty((len(curves), q.size))
        return fails(fill_points(function, Points(numbers, functions.memory, q.ravel(), out)).reshape(-1, *q.shape))

    first, last = table[list(measuring.ends)]
    q = first + (last - first) * (np.arange(LOOKED_AT + 1) / LOOKED_AT)[:, None]
    failing = failing_at(q)
    anywhere = failing.any(axis=(0, 1))
    at = failing.any(axis=0).argmax(axis=0)
    low, high = q[np.maximum(at - 1, 0), variants], q[at, variants]
    _, first = bisected(lambda q: ~failing_at(q[None]).any(axis=(0, 1)), low, high)
    which = failing_at(first[None])[:, 0].argmax(axis=0)
    return np.where(anywhere, which, -1), np.where(anywhere, first, np.nan)
