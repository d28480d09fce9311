"""A derivative from differences over steps of several lengths, extrapolated to none, with an error figure.

Let f be known at x and at x ± h for several h. The difference quotient over 2h is f'(x) + a h² + b h⁴ + …, that of
one side is f'(x) + a h + b h² + …: combined over a window of lengths such that the leading powers cancel, quotients
give f'(x) much better (Richardson). Of all windows that one is taken whose figure is least. The figure adds up

- truncation: the difference from the window one step coarser;
- kinks: what the quotients of both sides, extrapolated, differ by, which is 0 for a smooth f;
- rounding of f, and jitter of f from one x to the next, as positions take turns in giving an extreme.

Source: L. F. Richardson, J. A. Gaunt, The deferred approach to the limit, Phil. Trans. R. Soc. A 226 (1927); for the
choice by the least figure, C. J. F. Ridders, Accurate computation of F'(x) and F'(x)F''(x), Adv. Eng. Softw. 4 (1982).
"""

from functools import cache
from typing import NamedTuple

import numpy as np

# Lengths in a window: central quotients then err by the eighth power of the step.
WIDEST = 4
# Error figures that differ by no more than this share are the same.
ALIKE = 1e-13
# Powers of the step in a difference quotient, one for each length but the first.
CENTRAL, ONE_SIDED, OF_JUMP = (2, 4, 6), (1, 2, 3), (1, 3, 5)


class Differences(NamedTuple):
    """A function beside a place.

    Attributes
    ----------
    steps : ndarray (levels,)
        Lengths of the steps as shares of a scale, from long to short.
    width : ndarray (variants, levels, 2)
        What x was moved by, up and down: about ± steps, as rounding lets it.
    here, doubt : ndarray (variants,)
        f at the place, and its error figure.
    value : ndarray (variants, levels, 2)
        f at the places moved to; NaN where there is none.
    error : ndarray (variants, levels, 2)
        Error figure of each.
    """

    steps: np.ndarray
    width: np.ndarray
    here: np.ndarray
    doubt: np.ndarray
    value: np.ndarray
    error: np.ndarray


class Estimate(NamedTuple):
    """A derivative, its error figure, and the part of that which shorter steps may lessen; (variants,) each."""

    value: np.ndarray
    error: np.ndarray
    from_steps: np.ndarray


@cache
def weights(steps: tuple[float, ...], powers: tuple[int, ...]) -> np.ndarray:
    """What to multiply quotients over several steps by, so that their sum is free of the given powers of the step.

    Parameters
    ----------
    steps : tuple of float
        Lengths, all different.
    powers : tuple of int
        Powers that cancel, one less than there are lengths.

    Returns
    -------
    ndarray (lengths,)
        They add up to 1.
    """
    relative = np.array(steps) / max(steps)
    rows = np.stack([relative**power for power in (0, *powers)])
    right = np.zeros(len(steps))
    right[0] = 1.0
    return np.linalg.solve(rows, right)


def derivative_of(samples: Differences, rounding: float) -> Estimate:
    """Derivative at the place, by differences to both sides, or to one where only that side has values throughout.

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
    """The window with the least figure for each variant; NaN where no two windows have values."""
    length = np.abs(samples.width).mean(axis=2)
    size = rounding * np.fmax(np.abs(samples.here), np.abs(_filled(samples.value)).max(axis=(1, 2)))
    jitter, hidden = _jitter(samples, quotients, powers, length, 2 * size)
    doubt = (size[:, None] + jitter) / length
    best = Estimate(*(np.full(samples.here.shape, np.nan) for _ in range(3)))
    for first in range(1, samples.steps.size):
        for last in range(first + 1, min(first + WIDEST, samples.steps.size) + 1):
            window, coarser = slice(first, last), slice(first - 1, last - 1)
            value = _extrapolated(samples.steps, quotients, powers, window)
            steps = np.abs(value - _extrapolated(samples.steps, quotients, powers, coarser))
            if jumps is not None:
                steps += np.abs(_extrapolated(samples.steps, jumps, OF_JUMP, window))
            error = steps + _sum(doubt[:, window], np.abs(_weights(samples.steps, powers, window))) + hidden
            better = np.isfinite(error) & ~(best.error <= error)
            best = Estimate(*(np.where(better, b, a) for a, b in zip(best, (value, error, steps), strict=True)))
    return best


def _weights(steps: np.ndarray, powers: tuple[int, ...], window: slice) -> np.ndarray:
    chosen = tuple(steps[window].tolist())
    return weights(chosen, powers[: len(chosen) - 1])


def _extrapolated(steps: np.ndarray, quotients: np.ndarray, powers: tuple[int, ...], window: slice) -> np.ndarray:
    return _sum(quotients[:, window], _weights(steps, powers, window))


def _sum(columns: np.ndarray, factors: np.ndarray) -> np.ndarray:
    """Sum of columns times factors, to the same bit however many rows there are."""
    total = columns[:, 0] * factors[0]
    for i in range(1, factors.size):
        total = total + columns[:, i] * factors[i]
    return total


def _jitter(
    samples: Differences, quotients: np.ndarray, powers: tuple[int, ...], length: np.ndarray, least: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Noise of the function at each level (variants, levels), and what its error figure does to slopes (variants,).

    Windows that disagree, whatever their width, show noise: it isn't taken for more than the function's own error
    figure. Where places are too near for positions to take turns, a jump or an extreme between two positions hides its
    motion, and with it up to twice the error figure over a step. What changes by less than `least` altogether, with an
    error figure that doesn't change at all, doesn't depend on the number.
    """
    apart = np.full(samples.here.shape, np.inf)
    for width in range(2, WIDEST + 1):
        windows = [slice(i, i + width) for i in range(samples.steps.size - width + 1)]
        values = np.stack([_extrapolated(samples.steps, quotients, powers, window) for window in windows], axis=1)
        gaps = np.abs(np.diff(values, axis=1)) * length[:, 1 : values.shape[1]]
        apart = np.fmin(apart, np.where(np.isfinite(gaps).any(axis=1), _filled(gaps).max(axis=1), np.inf))
    # Small by chance at one place, an error figure is that of the greatest one so near.
    figures = np.concatenate([samples.doubt[:, None], _filled(samples.error).max(axis=2)[:, ::-1]], axis=1)
    figures = np.maximum.accumulate(figures, axis=1)[:, :0:-1]
    over_steps = np.where(np.isfinite(quotients), 2 * figures / length, np.inf).min(axis=1)
    changes = np.abs(_filled(samples.value - samples.here[:, None, None])).max(axis=(1, 2))
    same = (changes <= least) & (figures.max(axis=1) <= (1 + ALIKE) * np.fmin.reduce(samples.error, axis=(1, 2)))
    return np.minimum(apart[:, None], figures), np.where(same, 0.0, over_steps)


def _filled(values: np.ndarray) -> np.ndarray:
    """Values, with 0 for NaN and infinite ones."""
    return np.where(np.isfinite(values), values, 0.0)
