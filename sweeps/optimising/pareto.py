"""The Pareto front: the non-dominated variants."""

import numpy as np


def pareto_front(costs: np.ndarray) -> np.ndarray:
    """Which points are non-dominated: no other is as low in everything and lower in something.

    Exact; keeps all equal points and no NaN. Two objectives: by sorting, O(n log n); more: by comparison with the
    points kept so far, fast while the front is small.

    Parameters
    ----------
    costs : ndarray (points, objectives)

    Returns
    -------
    ndarray (points,) of bool
    """
    kept = np.zeros(costs.shape[0], dtype=bool)
    sound = np.flatnonzero(~np.isnan(costs).any(axis=1))
    if sound.size == 0:
        return kept
    # Only distinct points are compared, in lexicographic order.
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
    # In lexicographic order only an earlier point can dominate; the earliest left is on the front.
    front, left = np.zeros(costs.shape[0], dtype=bool), np.arange(costs.shape[0])
    while left.size:
        first, rest = left[0], left[1:]
        front[first] = True
        left = rest[(costs[rest] < costs[first]).any(axis=1)]
    return front
