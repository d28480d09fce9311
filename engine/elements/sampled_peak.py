"""The peak of a function of many variants at once: where its slope vanishes beside the highest of some samples."""

from collections.abc import Callable

import numpy as np

from engine.cycle.regula_falsi import regula_falsi


def sampled_peak(
    f: Callable[[np.ndarray], np.ndarray], slope: Callable[[np.ndarray], np.ndarray], places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Greatest value of a function beside the highest of its samples, and where.

    Parameters
    ----------
    f, slope : callable
        The function, and its slope or what has the sign of it, at places (..., variants).
    places : ndarray (samples, variants)
        Ascending; so close that the slope changes its sign once beside the highest sample, or the peak is at an end.

    Returns
    -------
    peak, place : ndarray (variants,)
    """
    samples = f(places)
    best = samples.argmax(axis=0)[None]
    low, there, high = (
        np.take_along_axis(places, np.clip(best + k, 0, len(places) - 1), axis=0)[0] for k in (-1, 0, 1)
    )
    turns = (slope(low) > 0.0) & (slope(high) < 0.0)
    place = np.where(turns, regula_falsi(slope, low, high), there)
    peak, sampled = f(place), np.take_along_axis(samples, best, axis=0)[0]
    # At a bend the slope may change its sign beside the peak.
    lower = peak < sampled
    return np.where(lower, sampled, peak), np.where(lower, there, place)
