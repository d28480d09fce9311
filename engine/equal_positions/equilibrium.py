"""Checks of a machine's equilibrium, from rows over the positions."""

import numpy as np

from engine.compiling.jit import scalar
from engine.equal_positions.rows import combined_max, combined_min, greatest, least


@scalar
def greater(a: float, b: float) -> float:
    """The greater of two numbers; NaN if either is."""
    return a if a >= b or a != a else b


@scalar
def peak_of(row: np.ndarray) -> float:
    """Greatest magnitude in a row; NaN if any value is NaN or infinite."""
    return greater(abs(greatest(row)), abs(least(row)))


@scalar
def gap_of(a: np.ndarray, b: np.ndarray) -> float:
    """Greatest difference between two rows, by magnitude; NaN if any value is NaN or infinite."""
    return greater(abs(combined_max(a, b, 1.0)), abs(combined_min(a, b, 1.0)))


@scalar
def share_of(part: float, whole: float) -> float:
    """A magnitude as a share of another; 0 where there is nothing of it."""
    return part / whole if part != 0.0 else part


@scalar
def unbalanced_share(force: np.ndarray, forces: np.ndarray, moment: np.ndarray, moments: np.ndarray) -> float:
    """Greatest force or moment that is left without balance, as a share of the reactions at their greatest.

    Parameters
    ----------
    force, moment : ndarray (positions,)
        Magnitude of the sum of all forces [N], and sum of all moments [N·m] on the machine.
    forces, moments : ndarray (positions,)
        Sums of the magnitudes of reactions.
    """
    of_forces = share_of(peak_of(force), peak_of(forces))
    return greater(of_forces, share_of(peak_of(moment), peak_of(moments)))


@scalar
def greatest_disagreement(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> float:
    """Greatest difference between any two of three rows, as a share of the greatest magnitude in them.

    Parameters
    ----------
    a, b, c : ndarray (positions,)
        The same quantity, found in three ways.
    """
    apart = greater(gap_of(a, b), greater(gap_of(b, c), gap_of(c, a)))
    return share_of(apart, greater(peak_of(a), greater(peak_of(b), peak_of(c))))
