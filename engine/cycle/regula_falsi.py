"""Bracketed roots of many functions at once, in NumPy."""

from collections.abc import Callable

import numpy as np

# Bisections of an interval to rounding.
_HALVINGS = 64
# Maximum iterations, and the last step as a fraction of the bracket; the error it leaves is smaller still.
_ITERATIONS, _LAST_STEP = 20, 4e-14


def regula_falsi(f: Callable[[np.ndarray], np.ndarray], a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Roots between a and b, where f changes sign, by regula falsi with the weights of Anderson and Björck.

    Parameters
    ----------
    f : callable
        Maps an array of the shape of a to one of the same shape.
    a, b : ndarray
        Ends of the brackets; NaN yields NaN.
    """
    fa, fb = f(a), f(b)
    moving, small = np.isfinite(fa + fb), _LAST_STEP * np.abs(b - a)
    for _ in range(_ITERATIONS):
        with np.errstate(all="ignore"):
            c = b - fb * (b - a) / (fb - fa)
        # A converged root stays fixed, so that it doesn't depend on the iterations of the others.
        c = np.where(moving & np.isfinite(c), c, b)
        fc = f(c)
        moving &= np.abs(c - b) > small
        crossed = (fc > 0.0) != (fb > 0.0)
        with np.errstate(all="ignore"):
            less = 1.0 - fc / fb
        a, fa = np.where(crossed, b, a), np.where(crossed, fb, np.where(less > 0.0, less, 0.5) * fa)
        b, fb = c, fc
        if not moving.any():
            break
    return b


def bisected(holds: Callable[[np.ndarray], np.ndarray], a: np.ndarray, b: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Adjacent numbers between a and b: a condition holds at the first, as at a, and not at the second.

    Parameters
    ----------
    holds : callable
        Maps an array of the shape of a to one of bool.
    a, b : ndarray
    """
    for _ in range(_HALVINGS):
        middle = 0.5 * (a + b)
        there = holds(middle)
        a, b = np.where(there, middle, a), np.where(there, b, middle)
    return a, b
