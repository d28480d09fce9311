"""Variants that share the numbers which decide the shape of the motion, found and put together."""

from itertools import pairwise

import numpy as np

# Variants that each shape must serve, in the mean, for its kinematics to be worth sharing.
WORTH_SHARING = 3


def shared_shapes(shapes: np.ndarray, pieces: int) -> tuple[np.ndarray, np.ndarray] | None:
    """Groups of variants of one shape; None where too few of them share any.

    Parameters
    ----------
    shapes : ndarray (slots, variants)
        Numbers that decide the shape.
    pieces : int
        Into how many pieces a group of all variants is split, so that it still uses every core.

    Returns
    -------
    starts : ndarray (groups + 1,)
        Where each group begins in `members`.
    members : ndarray (variants,)
        Indices of the variants, group by group.
    """
    variants = shapes.shape[1]
    if variants < 2 * WORTH_SHARING:
        return None
    shapes = shapes[(shapes != shapes[:, :1]).any(axis=1)]
    keys = _shape_keys(shapes)
    ordered = np.sort(keys)
    if (1 + np.count_nonzero(ordered[1:] != ordered[:-1])) * WORTH_SHARING > variants:
        return None
    _, first, inverse = np.unique(keys, return_index=True, return_inverse=True)
    if not np.array_equal(shapes, shapes[:, first[inverse]]):
        return None
    members = np.argsort(inverse, kind="stable")
    starts = np.concatenate(([0], np.cumsum(np.bincount(inverse))))
    longest = max(-(-members.size // pieces), 64)
    cuts = [np.arange(a, b, longest) for a, b in pairwise(starts)]
    return np.append(np.concatenate(cuts), members.size), members


def _shape_keys(shapes: np.ndarray) -> np.ndarray:
    """A 64-bit mix of the bits of what varies of each shape: equal for equal shapes, and very likely for no others."""
    factors = np.random.default_rng(0).integers(2**62, 2**63, shapes.shape[0], dtype=np.uint64) * 2 + 1
    keys = np.zeros(shapes.shape[1], np.uint64)
    for row, factor in zip(shapes, factors, strict=True):
        keys += row.astype(np.float64).view(np.uint64) * factor
    return keys ^ (keys >> np.uint64(29))
