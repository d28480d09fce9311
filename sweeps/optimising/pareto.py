"""The Pareto front: the variants that no other surpasses in all objectives."""

from collections.abc import Sequence

import numpy as np


def pareto_front(values: np.ndarray, minimise: Sequence[bool]) -> np.ndarray:
    """Which points no other point surpasses: none is as good in everything and better in something.

    Exact; equal points are all kept, points with NaN never. With two objectives by sorting, O(n log n); with more
    by comparison with the points kept so far, which is quick while the front is small.

    Parameters
    ----------
    values : ndarray (points, objectives)
    minimise : sequence of bool
        Which objectives should be small; the others should be great.

    Returns
    -------
    ndarray (points,) of bool
    """
    costs = np.asarray(values, dtype=float) * np.where(np.asarray(minimise, dtype=bool), 1.0, -1.0)
    kept = np.zeros(costs.shape[0], dtype=bool)
    sound = np.flatnonzero(~np.isnan(costs).any(axis=1))
    if sound.size == 0:
        return kept
    # Equal points stand or fall together, so only distinct ones are compared, in lexicographic order.
    order = sound[np.lexsort(costs[sound].T[::-1])]
    is_new = np.append(True, (costs[order[1:]] != costs[order[:-1]]).any(axis=1))
    distinct = costs[order[is_new]]
    front = _front_of_two(distinct) if distinct.shape[1] == 2 else _front_of_many(distinct)
    kept[order] = front[np.cumsum(is_new) - 1]
    return kept


def _front_of_two(costs: np.ndarray) -> np.ndarray:
    least_before = np.minimum.accumulate(costs[:, 1])
    return np.append(True, costs[1:, 1] < least_before[:-1])


def _front_of_many(costs: np.ndarray) -> np.ndarray:
    # In lexicographic order a point can only be surpassed by an earlier one; the earliest left is on the front.
    front, left = np.zeros(costs.shape[0], dtype=bool), np.arange(costs.shape[0])
    while left.size:
        first, rest = left[0], left[1:]
        front[first] = True
        left = rest[(costs[rest] < costs[first]).any(axis=1)]
    return front
