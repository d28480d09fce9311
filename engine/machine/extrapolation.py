"""A derivative by extrapolation of difference quotients to zero step length, with an error estimate.

Let f be known at x and at x ± h for several h. The central quotient is f'(x) + a h² + b h⁴ + …, the one-sided quotient
f'(x) + a h + b h² + …. A combination of quotients over a window of step lengths cancels the leading powers and
approximates f'(x) much better (Richardson). The window with the smallest error estimate is used. The estimate adds up

- truncation: the difference from the window one step coarser;
- kinks: the difference between the extrapolated one-sided quotients, which is 0 for a smooth f;
- rounding of f, and jitter of f from one x to the next, where the position that gives an extreme changes.

Source: L. F. Richardson, J. A. Gaunt, The deferred approach to the limit, Phil. Trans. R. Soc. A 226 (1927); for the
selection by the smallest estimate, C. J. F. Ridders, Accurate computation of F'(x) and F'(x)F''(x), Adv. Eng. Softw. 4
(1982).
"""

from functools import cache
from typing import NamedTuple

import numpy as np

# Maximum number of step lengths in a window; the error of central quotients is then of the eighth power of the step.
WIDEST = 4
# Relative tolerance for equal error estimates.
ALIKE = 1e-13
# Powers of the step in the error of a difference quotient: one fewer than the step lengths of a window.
CENTRAL, ONE_SIDED, OF_JUMP = (2, 4, 6), (1, 2, 3), (1, 3, 5)


class Differences(NamedTuple):
    """A function around a point.

    Attributes
    ----------
    steps : ndarray (levels,)
        Step lengths relative to a scale, in descending order.
    width : ndarray (variants, levels, 2)
        Displacement of x, up and down: ± steps, within rounding.
    here, here_error : ndarray (variants,)
        f at the point, and its error estimate.
    value : ndarray (variants, levels, 2)
        f at the displaced points; NaN if undefined.
    error : ndarray (variants, levels, 2)
        Error estimate of each.
    """

    steps: np.ndarray
    width: np.ndarray
    here: np.ndarray
    here_error: np.ndarray
    value: np.ndarray
    error: np.ndarray


class Estimate(NamedTuple):
    """A derivative, its error estimate, and the part of that which shorter steps may reduce; (variants,) each."""

    value: np.ndarray
    error: np.ndarray
    from_steps: np.ndarray


@cache
def weights(steps: tuple[float, ...], powers: tuple[int, ...]) -> np.ndarray:
    """Weights of quotients over several steps whose sum is free of the given powers of the step.

    Parameters
    ----------
    steps : tuple of float
        Lengths, all different.
    powers : tuple of int
        Powers to cancel, one fewer than the lengths.

    Returns
    -------
    ndarray (lengths,)
        Weights with the sum 1.
    """
    relative = np.array(steps) / max(steps)
    rows = np.stack([relative**power for power in (0, *powers)])
    right = np.zeros(len(steps))
    right[0] = 1.0
    return np.linalg.solve(rows, right)


def derivative_of(samples: Differences, rounding: float) -> Estimate:
    """Derivative from central differences, or from one-sided ones if only that side is defined throughout.

    Parameters
    ----------
    samples : Differences
    rounding : float
        Relative rounding error of the function.
    """
    with np.errstate(all="ignore"):
        slopes = (samples.value - samples.here[:, None, None]) / samples.width
        central = (samples.value[..., 0] - samples.value[..., 1]) / (samples.width[..., 0] - samples.width[..., 1])
        found = _best(samples, central, CENTRAL, slopes[..., 0] - slopes[..., 1], rounding)
        for side in (0, 1):
            other = _best(samples, slopes[..., side], ONE_SIDED, None, rounding)
            better = ~np.isfinite(found.error)
            found = Estimate(*(np.where(better, b, a) for a, b in zip(found, other, strict=True)))
    return found


def _best(
    samples: Differences, quotients: np.ndarray, powers: tuple[int, ...], jumps: np.ndarray | None, rounding: float
) -> Estimate:
    """Result of the window with the smallest estimate for each variant; NaN if fewer than two windows are defined."""
    length = np.abs(samples.width).mean(axis=2)
    size = rounding * np.fmax(np.abs(samples.here), np.abs(_filled(samples.value)).max(axis=(1, 2)))
    jitter, hidden = _jitter(samples, quotients, powers, length, 2 * size)
    noise = (size[:, None] + jitter) / length
    best = Estimate(*(np.full(samples.here.shape, np.nan) for _ in range(3)))
    for first in range(1, samples.steps.size):
        for last in range(first + 1, min(first + WIDEST, samples.steps.size) + 1):
            window, coarser = slice(first, last), slice(first - 1, last - 1)
            value = _extrapolated(samples.steps, quotients, powers, window)
            steps = np.abs(value - _extrapolated(samples.steps, quotients, powers, coarser))
            if jumps is not None:
                steps += np.abs(_extrapolated(samples.steps, jumps, OF_JUMP, window))
            error = steps + _sum(noise[:, window], np.abs(_weights(samples.steps, powers, window))) + hidden
            better = np.isfinite(error) & ~(best.error <= error)
            best = Estimate(*(np.where(better, b, a) for a, b in zip(best, (value, error, steps), strict=True)))
    return best


def _weights(steps: np.ndarray, powers: tuple[int, ...], window: slice) -> np.ndarray:
    chosen = tuple(steps[window].tolist())
    return weights(chosen, powers[: len(chosen) - 1])


def _extrapolated(steps: np.ndarray, quotients: np.ndarray, powers: tuple[int, ...], window: slice) -> np.ndarray:
    return _sum(quotients[:, window], _weights(steps, powers, window))


def _sum(columns: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Weighted sum of columns, bitwise independent of the number of rows."""
    total = columns[:, 0] * factors[0]
    for i in range(1, factors.size):
        total = total + columns[:, i] * factors[i]
    return total


def _jitter(
    samples: Differences, quotients: np.ndarray, powers: tuple[int, ...], length: np.ndarray, least: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Noise of the function at each level (variants, levels), and the slope error from its errors (variants,).

    The disagreement of windows, whatever their width, indicates noise; it is limited to the function's error estimate.
    At points so close that the position of an extreme does not change, a jump or an extreme between two positions stays
    hidden, and with it up to twice the error estimate over a step. A function that changes by less than `least` in
    total, with a constant error estimate, doesn't depend on the number.
    """
    apart = np.full(samples.here.shape, np.inf)
    for width in range(2, WIDEST + 1):
        windows = [slice(i, i + width) for i in range(samples.steps.size - width + 1)]
        values = np.stack([_extrapolated(samples.steps, quotients, powers, window) for window in windows], axis=1)
        gaps = np.abs(np.diff(values, axis=1)) * length[:, 1 : values.shape[1]]
        apart = np.fmin(apart, np.where(np.isfinite(gaps).any(axis=1), _filled(gaps).max(axis=1), np.inf))
    # An error estimate may be small by chance: use the largest one at least as near.
    figures = np.concatenate([samples.here_error[:, None], _filled(samples.error).max(axis=2)[:, ::-1]], axis=1)
    figures = np.maximum.accumulate(figures, axis=1)[:, :0:-1]
    over_steps = np.where(np.isfinite(quotients), 2 * figures / length, np.inf).min(axis=1)
    changes = np.abs(_filled(samples.value - samples.here[:, None, None])).max(axis=(1, 2))
    same = (changes <= least) & (figures.max(axis=1) <= (1 + ALIKE) * np.fmin.reduce(samples.error, axis=(1, 2)))
    return np.minimum(apart[:, None], figures), np.where(same, 0.0, over_steps)


def _filled(values: np.ndarray) -> np.ndarray:
    """Replace NaN and infinite values by 0."""
    return np.where(np.isfinite(values), values, 0.0)
