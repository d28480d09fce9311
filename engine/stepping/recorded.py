"""Recorded steps of walks: their states at any fraction of a step, and the highest values within them."""

from typing import NamedTuple

import numpy as np

from engine.cycle.panels.chebyshev import PLACES
from engine.cycle.panels.sampled import tops
from engine.stepping.records import elements_of_counts
from engine.stepping.system import RECORDED_AT

# Steps recorded at a time.
RECORDED = 64
# Lagrange polynomials of the recorded samples, and their derivatives.
LAGRANGE = [np.polynomial.Polynomial.fit(RECORDED_AT, row, RECORDED_AT.size - 1) for row in np.eye(RECORDED_AT.size)]
SLOPES = [polynomial.deriv() for polynomial in LAGRANGE]
# A polynomial exceeds its samples by at most this fraction of their range: half the excess over 1 of the Lebesgue
# constant of the fractions RECORDED_AT, 2.203.
EXCEEDS = 0.61


class MadeSteps(NamedTuple):
    """Recorded steps of walks in the order of the variants.

    Attributes
    ----------
    variant : ndarray (steps,) of int
    begin, length : ndarray (steps,)
        In the independent variable.
    samples : ndarray (states, RECORDED_AT, steps)
        States at the fractions RECORDED_AT.
    errors : ndarray (states, steps)
        Error estimates of the states at the start.
    """

    variant: np.ndarray
    begin: np.ndarray
    length: np.ndarray
    samples: np.ndarray
    errors: np.ndarray


def made_steps(recorded: np.ndarray, steps: np.ndarray) -> MadeSteps:
    """The steps that walks recorded.

    Parameters
    ----------
    recorded, steps : ndarray
        As in `Walks`.
    """
    variant, step = elements_of_counts(steps.astype(int))
    # Row by row, since each is contiguous over the variants.
    begin, length, _, *rows = (row[step, variant] for row in recorded.swapaxes(0, 1))
    samples = np.reshape(rows, (len(rows) // (RECORDED_AT.size + 1), RECORDED_AT.size + 1, variant.size))
    return MadeSteps(variant, begin, length, samples[:, :-1], samples[:, -1])


def weights_at(share: np.ndarray, slope: bool = False) -> np.ndarray:
    """Weights of a step's samples in its value, or its slope, at fractions of its length, (RECORDED_AT, …)."""
    if slope:
        return np.array([polynomial(share) for polynomial in SLOPES])
    if share.shape[-1] > 1 and (share == share[..., :1]).all():
        return weights_at(share[..., :1])
    weights = np.array([polynomial(share) for polynomial in LAGRANGE])
    # Exact at the ends.
    for end, row in ((0.0, 0), (1.0, -1)):
        weights[:, share == end] = np.eye(RECORDED_AT.size)[row][:, None]
    return weights


def weighted(weights: np.ndarray, samples: np.ndarray) -> np.ndarray:
    """Sums of weighted samples, in their order for any number of steps.

    Parameters
    ----------
    weights : ndarray (RECORDED_AT, …)
    samples : ndarray (states, RECORDED_AT, steps)

    Returns
    -------
    ndarray (states, …)
        `weights` may have an axis of the steps, or one of length 1 in its place.
    """
    rows = samples.swapaxes(0, 1).reshape(RECORDED_AT.size, len(samples), *(1,) * (weights.ndim - 2), -1)
    return sum(weight * row for weight, row in zip(weights, rows, strict=True))


AT_PLACES = weights_at(0.5 + 0.5 * PLACES)[..., None]


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
    samples : ndarray (curves, RECORDED_AT, steps)
        Values at the fractions RECORDED_AT; a step with a NaN is left out.
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
        found, own = tops(weighted(AT_PLACES, every[None, :, may])[0].T, np.zeros(may.size)), owner[may]
        order = np.lexsort((may, -found.values, own))
        chosen = order[_firsts(own[order])]
        own = own[chosen]
        value[own], share[own], step[own] = found.values[chosen], 0.5 + 0.5 * found.places[chosen], may[chosen] % steps
    return StepTops(*(row.reshape(curves, count) for row in (value, step, share)))


def _firsts(owners: np.ndarray) -> np.ndarray:
    """Index of the first element of each owner."""
    return np.flatnonzero(np.diff(owners, prepend=-1))
