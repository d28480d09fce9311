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
# Largest position in a range, just below 1.
_LAST = 1.0 - 2.0**-53
# Cosine and sine of a direction with its first and second rate.
Turn = tuple[float, float, float, float]


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
    memory: np.ndarray, begin: int, apart: int, intervals: float, width: float, x: float
) -> tuple[float, float, float]:
    """Find the interval of a table of seeds that contains a position, and the position within it.

    The first number of a seed is its position, infinite for an unused seed.

    Parameters
    ----------
    memory, begin, apart
        A table of numbers.
    intervals, width : float
        Number of intervals that the table has room for, and numbers per seed.
    x : float
        From `place_in_range`.

    Returns
    -------
    interval, share, length : float
        Index of the interval; position within it, from 0 to 1; its length as a fraction of the range.
    """
    count, wide, found = int(intervals), int(width) * apart, begin
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
def two_directions(
    memory: np.ndarray, begin: int, apart: int, column: float, width: float, interval: float
) -> tuple[float, float, float, float, float, float, float, float]:
    """Cosine, sine and rates of a direction in two consecutive seeds.

    Parameters
    ----------
    memory, begin, apart
        A table of numbers.
    column, width : float
        Index of the cosine among the numbers of a seed, and number of these.
    interval : float
        From `place_in_table`.
    """
    one = begin + int(interval * width + column) * apart
    two = one + int(width) * apart
    return (
        memory[one],
        memory[one + apart],
        memory[one + 2 * apart],
        memory[one + 3 * apart],
        memory[two],
        memory[two + apart],
        memory[two + 2 * apart],
        memory[two + 3 * apart],
    )


@scalar
def two_slides(
    memory: np.ndarray, begin: int, apart: int, column: float, width: float, interval: float
) -> tuple[float, float, float, float, float, float]:
    """Slide coordinate and rates in two consecutive seeds; parameters as in `two_directions`."""
    one = begin + int(interval * width + column) * apart
    two = one + int(width) * apart
    return (
        memory[one],
        memory[one + apart],
        memory[one + 2 * apart],
        memory[two],
        memory[two + apart],
        memory[two + 2 * apart],
    )


@scalar
def slide_between(d1: float, v1: float, a1: float, d2: float, v2: float, a2: float, share: float, step: float) -> float:
    """Slide coordinate between two seeds; parameters as in `direction_between`, from `two_slides`."""
    square = step * step
    return quintic_between(d1, v1 * step, a1 * square, d2, v2 * step, a2 * square, share)


@scalar
def direction_between(one: Turn, two: Turn, share: float, step: float) -> tuple[float, float]:
    """Direction between two seeds, by quintics of its cosine and its sine.

    Parameters
    ----------
    one, two : Turn
        From `two_directions`.
    share : float
        From `place_in_table`.
    step : float
        Distance between the seeds.
    """
    c1, s1, w1, e1 = one
    c2, s2, w2, e2 = two
    turn1, turn2, square = w1 * step, w2 * step, step * step
    bend1, bend2, round1, round2 = e1 * square, e2 * square, turn1 * turn1, turn2 * turn2
    c = quintic_between(c1, -s1 * turn1, -s1 * bend1 - c1 * round1, c2, -s2 * turn2, -s2 * bend2 - c2 * round2, share)
    s = quintic_between(s1, c1 * turn1, c1 * bend1 - s1 * round1, s2, c2 * turn2, c2 * bend2 - s2 * round2, share)
    per_length = 1.0 / math.sqrt(c * c + s * s)
    return c * per_length, s * per_length


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
