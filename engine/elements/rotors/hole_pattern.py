"""Corrections on a circle of holes: split between two neighbouring holes, or composed of pieces of equal mass.

The holes are at the angles first + 2 pi k/n. Arrays of corrections have any axes.

Source: ISO 21940-11, 4.5 (correction by components); the split is the law of sines.
"""

import math
from functools import lru_cache
from itertools import combinations, product
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike
from scipy.spatial import cKDTree

LARGEST_TABLE = 500_000
# From this number of pieces, the square of a correction may overflow, and with it its distance from the nearest sum.
FARTHEST = 1e150


class PatternError(ValueError):
    """A circle of holes that cannot take a correction, or has too many combinations to search."""


class Split(NamedTuple):
    """A correction in two neighbouring holes.

    Attributes
    ----------
    hole, next_hole : ndarray of int (...)
        Numbers of the holes, from 0.
    amount, next_amount : ndarray (...)
        Unbalances there, not negative [kg·m].
    """

    hole: np.ndarray
    next_hole: np.ndarray
    amount: np.ndarray
    next_amount: np.ndarray


def split_on_neighbours(correction: ArrayLike, holes: int) -> Split:
    """Split a correction exactly between the two adjacent holes: C sin(b)/sin(a + b) and C sin(a)/sin(a + b).

    Parameters
    ----------
    correction : array_like of complex (...)
        [kg·m].
    holes : int
        Number n of equally spaced holes, the first at angle 0.

    Raises
    ------
    PatternError
        Fewer than three holes: neighbours half a turn apart have no components in other directions.
    """
    if holes < 3:
        raise PatternError(f"holes = {holes}: splitting a correction takes at least 3 equally spaced holes")
    step = math.tau / holes
    beyond = np.angle(correction) % math.tau
    finite = np.isfinite(beyond)
    hole = np.floor(np.where(finite, beyond, 0.0) / step).astype(int) % holes
    after = np.clip(beyond - step * np.floor(beyond / step), 0.0, step)
    size = np.abs(correction) / math.sin(step)
    return Split(hole, (hole + 1) % holes, size * np.sin(step - after), size * np.sin(after))


def best_holes(
    correction: ArrayLike, holes: int, most: int, used: int, piece: ArrayLike, first: ArrayLike = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Pieces in a few holes that approximate a correction best, with as few pieces as possible.

    Parameters
    ----------
    correction : array_like of complex (...)
        [kg·m].
    holes : int
        Number of equally spaced holes.
    most : int
        Maximum number of pieces in one hole.
    used : int
        Maximum number of holes with pieces.
    piece : array_like (...)
        Unbalance of one piece, its mass times the radius of the holes [kg·m]; negative if material is removed.
    first : array_like (...)
        Angle of the first hole [rad].

    Returns
    -------
    pieces : ndarray of uint8 (..., holes)
        Number of pieces in each hole.
    made : ndarray of complex (...)
        The resulting unbalance [kg·m]; NaN if the correction is infinite, NaN or above 1e150 pieces, or a piece has no
        mass.

    Raises
    ------
    PatternError
        More combinations than can be searched.
    """
    ways, sums, tree = _ways(holes, most, used)
    with np.errstate(divide="ignore", invalid="ignore"):
        turn = np.exp(1j * np.asarray(first, dtype=float))
        wanted = np.asarray(correction) / turn / piece
        possible = np.abs(wanted) < FARTHEST
    wanted = np.where(possible, wanted, 0.0)
    _, chosen = tree.query(np.stack([wanted.real, wanted.imag], axis=-1))
    made = np.where(possible, sums[chosen] * turn * piece, complex(math.nan, math.nan))
    return np.where(possible[..., None], ways[chosen], np.uint8(0)), made


def ways_to_fill(holes: int, most: int, used: int) -> int:
    """Number of combinations of pieces in the holes.

    Parameters
    ----------
    holes, most, used : int
        As for `best_holes`.

    Raises
    ------
    PatternError
        More combinations than can be searched, or none.
    """
    if min(holes, most, used) < 1 or most > 255:
        raise PatternError(
            f"holes = {holes}, most = {most}, used = {used}: a pattern has at least one of each, at most 255 pieces"
        )
    count = sum(math.comb(holes, k) * most**k for k in range(min(used, holes) + 1))
    if count > LARGEST_TABLE:
        raise PatternError(
            f"{holes} holes with up to {most} pieces in {used} of them can be filled in {count} ways; at most "
            f"{LARGEST_TABLE} are searched: use fewer holes at a time or fewer pieces"
        )
    return count


@lru_cache(maxsize=16)
def _ways(holes: int, most: int, used: int) -> tuple[np.ndarray, np.ndarray, cKDTree]:
    """All combinations of pieces, the sums of their unit vectors, and a tree for the nearest one."""
    ways = np.zeros((ways_to_fill(holes, most, used), holes), np.uint8)
    row = 1
    for k in range(1, min(used, holes) + 1):
        fillings = np.array(list(product(range(1, most + 1), repeat=k)), np.uint8)
        for places in combinations(range(holes), k):
            ways[row : row + len(fillings), list(places)] = fillings
            row += len(fillings)
    ways = ways[np.argsort(ways.sum(axis=1), kind="stable")]
    sums = ways @ np.exp(1j * math.tau / holes * np.arange(holes))
    # Opposite pieces cancel: of equal sums keep the first, which has the fewest pieces.
    _, kept = np.unique(np.round(sums, 9), return_index=True)
    ways, sums = ways[kept], sums[kept]
    return ways, sums, cKDTree(np.stack([sums.real, sums.imag], axis=-1))
