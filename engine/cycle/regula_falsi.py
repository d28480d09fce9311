"""Roots of many functions side by side, each within a bracket, by NumPy."""

from collections.abc import Callable

import numpy as np

# A last step of this share of the bracket; the error it leaves is smaller by the share that is left of the other end.
_ITERATIONS, _LAST_STEP = 20, 4e-14


def regula_falsi(f: Callable[[np.ndarray], np.ndarray], a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Roots between a and b, where f changes sign, by regula falsi with Anderson's and Björck's weights.

    Parameters
    ----------
    f : callable
        Of an array like a, to an array like a.
    a, b : ndarray
        NaN stays.
    """
    fa, fb = f(a), f(b)
    moving, small = np.isfinite(fa + fb), _LAST_STEP * np.abs(b - a)
    for _ in range(_ITERATIONS):
        with np.errstate(all="ignore"):
            c = b - fb * (b - a) / (fb - fa)
        # A root that is found stays as it is, however long the others take.
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
