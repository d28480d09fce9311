"""Positions of groups that no formula solves: seeds from a table, corrections, and the proof that they lead to a root.

A table holds the solution of a group at equally spaced positions of the input, with its derivative. Between two of them
a cubic comes close to the solution; Newton's corrections do the rest. That they converge, and to which root, is proved
at every position by the theorem of Newton and Kantorovich: with β a bound of the inverse Jacobian, η of the first
correction and L of the change of the Jacobian, h = βηL ≤ ½ proves a root near the seed, the only one within
(1 + √(1 − 2h))/(βL) of it.

Sources: L. V. Kantorovich, G. P. Akilov, Functional Analysis, chapter on Newton's method; J. Stoer, R. Bulirsch,
Introduction to Numerical Analysis, chapters on Hermite interpolation and on the rational form of rotations by Cayley.
"""

import math

import numpy as np

from engine.compiling.decorators import scalar

# The greatest h that proves a root.
PROVES = 0.5


@scalar
def place_in_table(q: float, first: float, per_step: float, intervals: float, turns: float) -> tuple[float, float]:
    """Interval of a table of seeds in which a position lies, and where in it.

    Parameters
    ----------
    q, first : float
        The position and the first one of the table.
    per_step : float
        How many seeds there are for each unit of the input, negative where it runs backwards.
    intervals : float
        How many intervals there are.
    turns : float
        1 where the last seed is the first again; then any q has its place. Otherwise those outside lie in the first or
        last interval.

    Returns
    -------
    interval, share : float
        Number of the interval; from 0 at its beginning to 1 at its end.
    """
    x = (q - first) * per_step
    x = x - turns * intervals * math.floor(x * (1.0 / intervals))
    interval = min(max(math.floor(x), 0.0), intervals - 1.0)
    return interval, x - interval


@scalar
def cubic_between(a: float, slope_a: float, b: float, slope_b: float, x: float) -> float:
    """Hermite's cubic with values a, b and slopes at 0 and 1."""
    rest = 1.0 - x
    return (a * (1.0 + x + x) + slope_a * x) * (rest * rest) + (b * (1.0 + rest + rest) - slope_b * rest) * (x * x)


@scalar
def two_directions(
    memory: np.ndarray, begin: int, apart: int, column: float, width: float, interval: float
) -> tuple[float, float, float, float, float, float]:
    """Cosine, sine and rate of a direction in two seeds that follow each other.

    Parameters
    ----------
    memory, begin, apart
        A table of numbers.
    column, width : float
        Place of the cosine among the numbers of a seed, and how many these are.
    interval : float
        From `place_in_table`.
    """
    one = begin + int(interval * width + column) * apart
    two = one + int(width) * apart
    return (
        memory[one],
        memory[one + apart],
        memory[one + apart + apart],
        memory[two],
        memory[two + apart],
        memory[two + apart + apart],
    )


@scalar
def two_slides(
    memory: np.ndarray, begin: int, apart: int, column: float, width: float, interval: float
) -> tuple[float, float, float, float]:
    """Slide coordinate and rate in two seeds that follow each other; parameters as for `two_directions`."""
    one = begin + int(interval * width + column) * apart
    two = one + int(width) * apart
    return memory[one], memory[one + apart], memory[two], memory[two + apart]


@scalar
def direction_between(
    c1: float, s1: float, w1: float, c2: float, s2: float, w2: float, share: float, step: float
) -> tuple[float, float]:
    """Direction between two seeds, by cubics of its cosine and its sine.

    Parameters
    ----------
    c1, s1, w1, c2, s2, w2 : float
        From `two_directions`.
    share : float
        From `place_in_table`.
    step : float
        Distance of seeds.
    """
    turn1, turn2 = w1 * step, w2 * step
    c = cubic_between(c1, -s1 * turn1, c2, -s2 * turn2, share)
    s = cubic_between(s1, c1 * turn1, s2, c2 * turn2, share)
    per_length = 1.0 / math.sqrt(c * c + s * s)
    return c * per_length, s * per_length


@scalar
def turned(c: float, s: float, angle: float) -> tuple[float, float]:
    """Direction turned by a small angle, by Cayley's form: of unit length exactly, short of the angle by angle³/12."""
    t = 0.5 * angle
    square = t * t
    per_whole = 1.0 / (1.0 + square)
    cosine, sine = (1.0 - square) * per_whole, (t + t) * per_whole
    return c * cosine - s * sine, s * cosine + c * sine


@scalar
def proved(h: float, x: float) -> float:
    """A correction whose root is proved; NaN otherwise."""
    return x if h <= PROVES else math.nan
