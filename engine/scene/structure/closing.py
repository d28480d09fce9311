"""Closure of the cycle: every part must make whole turns in it; how many crank turns that takes.

A cycle is `input.revolutions` turns of the crank. All parts must return to their initial positions at its end, or
gravity and springs would do net work in every cycle.
"""

import math
from collections.abc import Iterable
from fractions import Fraction

import numpy as np

from engine.laws.rounding import EPS
from engine.parts.skeleton import MOST_REVOLUTIONS

# Relative rounding error of a number of turns computed from ratios.
_ROUNDING = 64.0 * EPS


def is_whole(turns: float | np.ndarray) -> bool | np.ndarray:
    """Whether numbers of turns are whole, within rounding."""
    return np.abs(turns - np.round(turns)) <= _ROUNDING * np.maximum(1.0, np.abs(turns))


def _closing_revolutions(turns: Iterable[float]) -> int | None:
    """Fewest turns of the crank that close a cycle of parts with these turns; None if they exceed the maximum."""
    found = 1
    for ratio in turns:
        whole = Fraction(ratio).limit_denominator(MOST_REVOLUTIONS) if math.isfinite(ratio) else None
        if whole is None or not is_whole(ratio * whole.denominator):
            return None
        found = math.lcm(found, whole.denominator)
    return found if found <= MOST_REVOLUTIONS else None


def how_to_close(turns: Iterable[float], revolutions: int) -> str:
    """Suggestion for a cycle that doesn't close.

    Parameters
    ----------
    turns : iterable of float
        Turns of the parts per turn of the crank.
    revolutions : int
        Present length of the cycle, which other parts may require.
    """
    turns = list(turns)
    needed = _closing_revolutions([*turns, 1.0 / revolutions]) or _closing_revolutions(turns)
    if needed is not None:
        return f"set input.revolutions = {needed}"
    return (
        f"no cycle of up to {MOST_REVOLUTIONS} turns of the crank closes; take ratios of small whole numbers, written "
        'exactly, as in "2/3", or a range of the crank, input.start … input.stop'
    )
