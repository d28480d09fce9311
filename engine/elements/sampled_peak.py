"""The peak of a function, for many variants at once: the root of its slope next to the highest sample."""

from collections.abc import Callable

import numpy as np

from engine.cycle.regula_falsi import regula_falsi

# Distance of the points of a difference quotient, as a fraction of the distance between samples.
_APART = 1e-5


def sampled_peak(
    f: Callable[[np.ndarray], np.ndarray], places: np.ndarray, slope: Callable[[np.ndarray], np.ndarray] | None = None
) -> tuple[np.ndarray, np.ndarray]:
    """Peak of a function next to its highest sample, and its position.

    Parameters
    ----------
    f : callable
        Function of positions (..., variants).
    places : ndarray (samples, variants)
        Ascending, and close enough that the slope has only one root next to the highest sample, or the peak is at an
        end.
    slope : callable, optional
        The slope of f, or a quantity of the same sign. Differences of f, the default, are good for the peak itself,
        which changes little with its position.

    Returns
    -------
    peak, place : ndarray (variants,)
    """
    samples = f(places)
    best = samples.argmax(axis=0)[None]
    near = np.clip(best + np.array([[-1], [0], [1]]), 0, len(places) - 1)
    low, there, high = np.take_along_axis(places, near, axis=0)
    apart = _APART * (high - low)
    rises = slope or (lambda x: f(x + apart) - f(x - apart))
    turns = (rises(low) > 0.0) & (rises(high) < 0.0)
    place = np.where(turns, regula_falsi(rises, low, high), there)
    peak, sampled = f(place), np.take_along_axis(samples, best, axis=0)[0]
    # At a kink the root of the slope can miss the peak.
    lower = peak < sampled
    return np.where(lower, sampled, peak), np.where(lower, there, place)
