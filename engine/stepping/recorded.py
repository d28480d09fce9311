"""Recorded steps of walks, interpolated at any position."""

import math
from typing import NamedTuple

import numpy as np

from engine.compiling.running import over_variants
from engine.cycle.panels.chebyshev import PLACES
from engine.cycle.panels.sampled import tops
from engine.stepping.records import elements_of_counts
from engine.stepping.system import SHOWN, Walks

# Steps recorded at a time.
RECORDED = 64
# Lagrange polynomials of the recorded samples, and their derivatives at these samples.
LAGRANGE = [np.polynomial.Polynomial.fit(SHOWN, row, SHOWN.size - 1) for row in np.eye(SHOWN.size)]
SLOPES = np.array([polynomial.deriv()(SHOWN) for polynomial in LAGRANGE])
# A polynomial exceeds its samples by at most this fraction of their range: half the excess over 1 of the Lebesgue
# constant of the fractions SHOWN, 2.203.
EXCEEDS = 0.61


class MadeSteps(NamedTuple):
    """Recorded steps of walks in the order of the variants.

    Attributes
    ----------
    variant : ndarray (steps,) of int
    begin, length : ndarray (steps,)
        In the independent variable.
    samples : ndarray (states, SHOWN, steps)
        States at the fractions SHOWN.
    """

    variant: np.ndarray
    begin: np.ndarray
    length: np.ndarray
    samples: np.ndarray


def made_steps(recorded: np.ndarray, steps: np.ndarray) -> MadeSteps:
    """The steps that walks recorded.

    Parameters
    ----------
    recorded, steps : ndarray
        As in `Walks`.
    """
    variant, step = elements_of_counts(steps.astype(int))
    begin, length, _, *rows = recorded[step, :, variant].T
    samples = np.reshape(rows, (len(rows) // (SHOWN.size + 1), SHOWN.size + 1, variant.size))
    return MadeSteps(variant, begin, length, samples[:, :-1])


def weights_at(share: np.ndarray) -> np.ndarray:
    """Weights of a step's samples in its value at fractions of its length, (SHOWN, …)."""
    return np.array([polynomial(share) for polynomial in LAGRANGE])


AT_PLACES = weights_at(0.5 + 0.5 * PLACES).T


class StepTops(NamedTuple):
    """Maxima of curves within the steps of each variant, (curves, variants).

    Attributes
    ----------
    value : ndarray
        NaN for a variant without steps.
    step : ndarray of int
        Number of the step among all.
    share : ndarray
        Position as a fraction of the step's length.
    """

    value: np.ndarray
    step: np.ndarray
    share: np.ndarray


def tops_in_steps(variant: np.ndarray, samples: np.ndarray, count: int) -> StepTops:
    """Maxima within recorded steps, also between their samples; of equal ones the earliest.

    Parameters
    ----------
    variant : ndarray (steps,) of int
        As in `MadeSteps`.
    samples : ndarray (curves, SHOWN, steps)
        Values at the fractions SHOWN; a step with a NaN is left out.
    count : int
        Number of variants.
    """
    curves, steps = len(samples), variant.size
    value, share, step = *np.full((2, curves * count), np.nan), np.zeros(curves * count, int)
    if steps:
        owner, every = (count * np.arange(curves)[:, None] + variant).ravel(), np.concatenate(samples, axis=1)
        high, low, begins = every.max(axis=0), every.min(axis=0), _firsts(owner)
        best = np.repeat(np.fmax.reduceat(high, begins), np.diff(begins, append=owner.size))
        may = np.flatnonzero(high + EXCEEDS * (high - low) >= best)
        found, own = tops((AT_PLACES @ every[:, may]).T, np.zeros(may.size)), owner[may]
        order = np.lexsort((may, -found.values, own))
        chosen = order[_firsts(own[order])]
        own = own[chosen]
        value[own], share[own], step[own] = found.values[chosen], 0.5 + 0.5 * found.places[chosen], may[chosen] % steps
    return StepTops(*(row.reshape(curves, count) for row in (value, step, share)))


def _firsts(owners: np.ndarray) -> np.ndarray:
    """Index of the first element of each owner."""
    return np.flatnonzero(np.diff(owners, prepend=-1))


def states_at(gone: Walks, columns: np.ndarray, at: np.ndarray, off: bool = False) -> np.ndarray:
    """First two states and the slope of the first one, (3, …), at positions in walks (…), from their recorded steps.

    Parameters
    ----------
    gone : Walks
    columns : ndarray (…) of int
        Variants.
    at : ndarray (…)
        In the independent variable.
    off : bool
        Whether to shift the states by their error estimates at the start of each step.
    """
    found = np.empty((3, at.size))
    read_steps(at.size, gone.recorded, gone.steps, columns.ravel(), at.ravel(), off, found)
    return found.reshape(3, *at.shape)


@over_variants
def read_steps(
    begin: int,
    end: int,
    recorded: np.ndarray,
    steps: np.ndarray,
    columns: np.ndarray,
    turned: np.ndarray,
    off: bool,
    found: np.ndarray,
) -> None:
    """Read steps as `states_at` does.

    Source: J.-P. Berrut and L. N. Trefethen, Barycentric Lagrange interpolation, SIAM Review 46 (2004).
    """
    shown = SLOPES.shape[0]
    for p in range(begin, end):
        v, low, high = columns[p], 0, max(int(steps[columns[p]]) - 1, 0)
        while low < high:
            middle = (low + high + 1) // 2
            if recorded[middle, 0, v] <= turned[p]:
                low = middle
            else:
                high = middle - 1
        length = recorded[low, 1, v]
        theta = (turned[p] - recorded[low, 0, v]) / length
        total, energy, time, moment, at = 0.0, 0.0, 0.0, 0.0, -1
        for j in range(shown):
            apart = theta - (0.5 - 0.5 * math.cos(math.pi * j / (shown - 1)))
            at = j if apart == 0.0 else at
        for j in range(shown):
            apart = theta - (0.5 - 0.5 * math.cos(math.pi * j / (shown - 1)))
            weight = (0.5 if j in (0, shown - 1) else 1.0) * (1.0 - 2.0 * (j % 2))
            # At a sample only its own value counts.
            weight = weight / apart if at < 0 else 1.0 if j == at else 0.0
            slope = 0.0
            for i in range(shown):
                slope += SLOPES[i, j] * recorded[low, 3 + i, v]
            total += weight
            energy += weight * recorded[low, 3 + j, v]
            time += weight * recorded[low, 4 + shown + j, v]
            moment += weight * slope
        energy_off, time_off = recorded[low, 3 + shown, v], recorded[low, 4 + 2 * shown, v]
        found[0, p] = energy / total + (energy_off if off else 0.0)
        found[1, p] = time / total + (time_off if off else 0.0)
        found[2, p] = moment / total / length
