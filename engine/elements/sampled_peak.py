"""The peak of a function, for many variants at once: the root of its slope next to the highest sample."""

from collections.abc import Callable

import numpy as np

from engine.cycle.regula_falsi import regula_falsi


def sampled_peak(
    f: Callable[[np.ndarray], np.ndarray], slope: Callable[[np.ndarray], np.ndarray], places: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Peak of a function next to its highest sample, and its position.

    Parameters
    ----------
    f, slope : callable
        The function, and its slope or a quantity of the same sign, at places (..., variants).
    places : ndarray (samples, variants)
        Ascending, and close enough that the slope has only one root next to the highest sample, or the peak is at an
        end.

    Returns
    -------
    peak, place : ndarray (variants,)
    """
    samples = f(places)
    best = samples.argmax(axis=0)[None]
    near = np.clip(best + np.array([[-1], [0], [1]]), 0, len(places) - 1)
    low, there, high = np.take_along_axis(places, near, axis=0)
    turns = (slope(low) > 0.0) & (slope(high) < 0.0)
    place = np.where(turns, regula_falsi(slope, low, high), there)
    peak, sampled = f(place), np.take_along_axis(samples, best, axis=0)[0]
    # At a kink the root of the slope can miss the peak.
    lower = peak < sampled
    return np.where(lower, sampled, peak), np.where(lower, there, place)
