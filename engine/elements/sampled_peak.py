"""The peak of a function of many variants at once: the highest of some samples, narrowed down by golden section."""

import math
from collections.abc import Callable

import numpy as np

# So many leave 2e-7 of the bracket, of whose square a flat top is lower.
_NARROWINGS = 32
_GOLDEN = (math.sqrt(5.0) - 1.0) / 2.0


def sampled_peak(f: Callable[[np.ndarray], np.ndarray], places: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Greatest value of a function beside the highest of its samples, and where.

    Parameters
    ----------
    f : callable
        Of an array (..., variants), to one like it.
    places : ndarray (samples, variants)
        Ascending; so close that the peak lies beside the highest sample.

    Returns
    -------
    peak, place : ndarray (variants,)
    """
    best = f(places).argmax(axis=0)[None]
    low, high = (np.take_along_axis(places, np.clip(best + k, 0, len(places) - 1), axis=0)[0] for k in (-1, 1))
    inner, outer = high - _GOLDEN * (high - low), low + _GOLDEN * (high - low)
    at_inner, at_outer = f(inner), f(outer)
    for _ in range(_NARROWINGS):
        falls = at_inner > at_outer
        low, high = np.where(falls, low, inner), np.where(falls, outer, high)
        fresh = np.where(falls, high - _GOLDEN * (high - low), low + _GOLDEN * (high - low))
        at_fresh = f(fresh)
        inner, at_inner, outer, at_outer = (
            np.where(falls, fresh, outer),
            np.where(falls, at_fresh, at_outer),
            np.where(falls, inner, fresh),
            np.where(falls, at_inner, at_fresh),
        )
    found = at_inner > at_outer
    return np.where(found, at_inner, at_outer), np.where(found, inner, outer)
