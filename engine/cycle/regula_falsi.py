"""Bracketed roots of many functions at once, in NumPy."""

from collections.abc import Callable

import numpy as np

# Bisections of an interval to rounding.
_HALVINGS = 64
# Maximum iterations, as for a triple root; the last step as a fraction of the bracket; the error it leaves is smaller.
_ITERATIONS, _LAST_STEP = 60, 4e-14


def regula_falsi(f: Callable[[np.ndarray], np.ndarray], a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Roots between a and b, where f changes sign, by bisection and regula falsi, weighted by Anderson and Björck.

    Parameters
    ----------
    f : callable
        Maps an array of the shape of a to one of the same shape.
    a, b : ndarray
        Ends of the brackets; b is returned where f doesn't change its sign.
    """
    fa, fb = f(a), f(b)
    # Never less than the rounding of the root.
    small = np.maximum(_LAST_STEP * np.abs(b - a), 2.0 * np.spacing(np.maximum(np.abs(a), np.abs(b))))
    moving = np.isfinite(fa + fb) & (fb != 0.0) & (((fa > 0.0) != (fb > 0.0)) | (fa == 0.0)) & (a != b)
    step = before = np.full(np.shape(fb), np.inf)
    for _ in range(_ITERATIONS):
        with np.errstate(all="ignore"):
            c = b - fb * (b - a) / (fb - fa)
        # Towards a multiple root steps hardly shrink.
        c = np.where(np.abs(c - b) >= 0.5 * before, 0.5 * (a + b), c)
        # A tiny step is followed by another: it passes the root, unless f was steep where the tiny step began.
        checks = step <= small
        c = np.where(checks, b + np.copysign(small, a - b), c)
        # A converged root stays fixed, so that it doesn't depend on the iterations of the others.
        c = np.where(moving & np.isfinite(c), c, b)
        fc = f(c)
        crossed = (fc > 0.0) != (fb > 0.0)
        failed = checks & ~crossed
        before, step = np.where(failed, 0.0, step), np.where(failed, np.inf, np.abs(c - b))
        moving &= ~(checks & crossed) & (fc != 0.0)
        with np.errstate(all="ignore"):
            less = 1.0 - fc / fb
        a, fa = np.where(crossed, b, a), np.where(crossed, fb, np.where(less > 0.0, less, 0.5) * fa)
        b, fb = np.where(checks & crossed, b, c), np.where(checks & crossed, fb, fc)
        moving &= np.abs(b - a) > small
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
