"""Positions of groups without a closed form: seeds from a table, corrections, and the proof of their convergence.

A table holds the solution of a group at positions of the input, with its derivatives. They are so close together that a
quintic between two of them is close to the solution, and two Newton corrections leave only rounding. The theorem of
Newton and Kantorovich proves at every position that these converge, and to which root: with β a bound of the inverse
Jacobian, η of the first correction and L of the change of the Jacobian, h = βηL ≤ ½ proves a root near the seed, the
only one within (1 + √(1 − 2h))/(βL) of it.

Sources: L. V. Kantorovich, G. P. Akilov, Functional Analysis, chapter on Newton's method; J. Stoer, R. Bulirsch,
Introduction to Numerical Analysis, chapters on Hermite interpolation and on the rational form of rotations by Cayley.
"""

import math

import numpy as np

from engine.compiling.decorators import scalar

# Maximum h that proves a root, and maximum h for which two corrections leave 4h³ of the first one: rounding.
PROVES, CLOSE = 0.5, 2e-4
# Minimum fraction of the transmission angle's sine that is kept over a step along a path.
LEAST_SHARE = 0.2
# Modes are the same if their unknowns differ by no more than this [rad, or m; relative above 1 m].
SAME = 1e-6
# Largest position in a range, just below 1.
_LAST = 1.0 - 2.0**-53
# An angle [rad] or a slide [m] with its first and second rate.
Seed = tuple[float, float, float]


@scalar
def place_in_range(q: float, first: float, per_range: float, turns: float) -> float:
    """Fraction of the input's range that lies before a position, less than 1.

    Parameters
    ----------
    q, first : float
        The position, and the first position of the range.
    per_range : float
        Reciprocal of the range's length, negative if the input runs backwards.
    turns : float
        1 if the last position coincides with the first, so that any q is in range; else 0.
    """
    x = (q - first) * per_range
    x = x - turns * math.floor(x)
    return _LAST if x >= 1.0 else x


@scalar
def place_in_table(
    memory: np.ndarray, begin: int, apart: int, intervals: float, unknowns: float, x: float
) -> tuple[float, float, float]:
    """Find the interval of a table of seeds that contains a position, and the position within it.

    A seed has its position, infinite for an unused seed, then the values of all unknowns, their first rates and their
    second rates.

    Parameters
    ----------
    memory, begin, apart
        A table of numbers.
    intervals, unknowns : float
        Number of intervals that the table has room for, and number of unknowns.
    x : float
        From `place_in_range`.

    Returns
    -------
    interval, share, length : float
        Index of the interval; position within it, from 0 to 1; its length as a fraction of the range.
    """
    count, wide, found = int(intervals), (1 + 3 * int(unknowns)) * apart, begin
    while count > 1:
        half = count // 2
        found = found + half * wide if memory[found + half * wide] <= x else found
        count -= half
    length = memory[found + wide] - memory[found]
    return float((found - begin) // wide), (x - memory[found]) / length, length


@scalar
def quintic_between(
    a: float, slope_a: float, bend_a: float, b: float, slope_b: float, bend_b: float, x: float
) -> float:
    """Hermite's quintic with values a, b, slopes and second derivatives at 0 and 1."""
    rest = 1.0 - x
    one = a * (1.0 + x * (3.0 + 6.0 * x)) + x * (slope_a * (1.0 + 3.0 * x) + 0.5 * bend_a * x)
    two = b * (1.0 + rest * (3.0 + 6.0 * rest)) - rest * (slope_b * (1.0 + 3.0 * rest) - 0.5 * bend_b * rest)
    return one * (rest * rest * rest) + two * (x * x * x)


@scalar
def two_seeds(
    memory: np.ndarray, begin: int, apart: int, unknown: float, unknowns: float, interval: float
) -> tuple[float, float, float, float, float, float]:
    """Value and rates of an unknown in two consecutive seeds.

    Parameters
    ----------
    memory, begin, apart
        A table of numbers.
    unknown, unknowns : float
        Index of the unknown, and number of unknowns.
    interval : float
        From `place_in_table`.
    """
    count = int(unknowns)
    one = begin + (int(interval) * (1 + 3 * count) + 1 + int(unknown)) * apart
    two, rate = one + (1 + 3 * count) * apart, count * apart
    return (
        memory[one],
        memory[one + rate],
        memory[one + 2 * rate],
        memory[two],
        memory[two + rate],
        memory[two + 2 * rate],
    )


@scalar
def between_seeds(one: Seed, two: Seed, share: float, step: float) -> float:
    """Value of an unknown between two seeds.

    Parameters
    ----------
    one, two : Seed
        From `two_seeds`.
    share : float
        From `place_in_table`.
    step : float
        Distance between the seeds.
    """
    (a, v, e), (b, w, f), square = one, two, step * step
    return quintic_between(a, v * step, e * square, b, w * step, f * square, share)


@scalar
def turned(c: float, s: float, angle: float) -> tuple[float, float]:
    """Direction turned by a small angle, in Cayley's form: exactly of unit length, short of the angle by angle³/12."""
    t = 0.5 * angle
    square = t * t
    per_whole = 1.0 / (1.0 + square)
    cosine, sine = (1.0 - square) * per_whole, (t + t) * per_whole
    return c * cosine - s * sine, s * cosine + c * sine


@scalar
def proved(h: float, x: float) -> float:
    """A correction whose root is proved; NaN otherwise."""
    return x if h <= PROVES else math.nan


def same_unknowns(one: np.ndarray, other: np.ndarray, slides: np.ndarray) -> np.ndarray:
    """Whether values of the unknowns are those of one mode, angles except for whole turns (...).

    Parameters
    ----------
    one, other : ndarray (unknowns, ...)
    slides : ndarray (unknowns,) of bool
        Which unknowns are slides; the others are angles.
    """
    slides = slides.reshape(-1, *[1] * (one.ndim - 1))
    apart = one - other
    apart = apart - np.where(slides, 0.0, math.tau * np.rint(apart / math.tau))
    return (np.abs(apart) <= SAME * np.where(slides, np.maximum(1.0, np.abs(one)), 1.0)).all(axis=0)
