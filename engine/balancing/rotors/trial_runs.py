"""Balancing by trial runs on any machine that can be read: what to add in every plane.

Source: K. V. Frolov et al., Theory of Mechanisms and Machines (balancing on machines).
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from engine.balancing.rotors.influence import four_runs, influence_coefficients, influence_correction


class TrialRuns(NamedTuple):
    """What trial runs gave.

    Attributes
    ----------
    corrections : ndarray of complex (planes,)
        Unbalances to be added [kg·m].
    coefficients : ndarray of complex (readings, planes)
        Influence coefficients.
    initial : ndarray of complex (readings,)
        Vibration of the first run.
    """

    corrections: np.ndarray
    coefficients: np.ndarray
    initial: np.ndarray


def balance_by_influence(read: Callable[[np.ndarray], np.ndarray], weights: ArrayLike) -> TrialRuns:
    """All planes at once: a first run, and one with the trial weight in each plane in turn.

    Parameters
    ----------
    read : callable
        Makes a run with unbalances (planes,) added and returns vibrations, complex (readings,).
    weights : array_like of complex (planes,)
        Trial weights as unbalances [kg·m].
    """
    weights = np.asarray(weights, dtype=complex)
    initial = np.asarray(read(np.zeros_like(weights)))
    trials = np.array([read(added) for added in np.diag(weights)])
    coefficients = influence_coefficients(initial, trials, weights)
    return TrialRuns(influence_correction(coefficients, initial), coefficients, initial)


def balance_in_turn(read: Callable[[int, np.ndarray], float], weights: ArrayLike) -> np.ndarray:
    """One plane after the other by amplitudes alone, as in a frame that swings about the plane not in hand.

    Four runs for every plane: as it is, and with the trial weight at 0, 120 and 240 degrees.

    Parameters
    ----------
    read : callable
        Makes a run that feels only the plane of a number, with unbalances (planes,) added, and returns the amplitude.
    weights : array_like (planes,)
        Magnitudes of the trial weights as unbalances [kg·m].

    Returns
    -------
    ndarray of complex (planes,)
        Unbalances to be added [kg·m].
    """
    weights = np.asarray(weights, dtype=float)
    added = np.zeros(weights.size, dtype=complex)
    for plane, weight in enumerate(weights):
        trials = [_with(added, plane, weight * np.exp(2j * np.pi / 3 * k)) for k in range(3)]
        found = four_runs(read(plane, added), [read(plane, trial) for trial in trials], weight)
        added = _with(added, plane, -found.unbalance)
    return added


def _with(added: np.ndarray, plane: int, more: complex) -> np.ndarray:
    """Unbalances with more in one plane."""
    added = added.copy()
    added[plane] += more
    return added
