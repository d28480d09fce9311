"""Where on its cycle a variant fails first: looked for in equally spaced positions, then between two of them."""

from collections.abc import Callable

import numpy as np

from engine.machine.kept_fields import KeptFields

# Equally spaced positions at which failing variants are examined, and halvings of the step between two of them.
LOOKED_AT, HALVINGS = 720, 40


def first_failure(
    curves: KeptFields, table: np.ndarray, ends: tuple[int, int], fails: Callable[[np.ndarray], np.ndarray]
) -> tuple[np.ndarray, np.ndarray]:
    """First position at which one of some curves fails.

    Parameters
    ----------
    curves : KeptFields
    table : ndarray (numbers, variants)
        As for `KeptFields.fill`.
    ends : tuple of int
        Rows of the table with the ends of the input's range.
    fails : callable
        Whether values (curves, variants, positions) fail.

    Returns
    -------
    which : ndarray (variants,) of int
        The curve that fails there; −1 where none does at any of the positions looked at.
    place : ndarray (variants,)
        The position; NaN where there is none.
    """
    count, variants = curves.count, np.arange(table.shape[1])
    share = np.arange(LOOKED_AT + 1) / LOOKED_AT
    values = np.empty((count, variants.size, share.size))
    curves.fill(table, share, values, variants, ends)
    failing = fails(values)
    anywhere = failing.any(axis=(0, 2))
    at = failing.any(axis=0).argmax(axis=1)
    first, length = table[ends[0]], table[ends[1]] - table[ends[0]]
    low, high = first + length * share[np.maximum(at - 1, 0)], first + length * share[at]
    which = failing[:, variants, at].argmax(axis=0)
    own = np.vstack([table, low, high])
    rows, room = (len(table), len(table) + 1), np.empty((count, variants.size, 1))
    for _ in range(HALVINGS):
        curves.fill(own, np.array([0.5]), room, variants, rows)
        here = fails(room[:, :, 0])
        middle, found = 0.5 * (own[-2] + own[-1]), here.any(axis=0)
        which = np.where(found, here.argmax(axis=0), which)
        own[-1], own[-2] = np.where(found, middle, own[-1]), np.where(found, own[-2], middle)
    return np.where(anywhere, which, -1), np.where(anywhere, own[-1], np.nan)
