"""Propagation of errors from a motion's own numbers to its results."""

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np


class Shiftable(Protocol):
    """A motion whose numbers can be changed."""

    def shifted(self, by: tuple) -> "Shiftable":
        """The same with its numbers changed."""


Motion = TypeVar("Motion", bound=Shiftable)


def spread_errors(
    motion: Motion, errors: tuple, results_of: Callable[[Motion], dict[str, np.ndarray]]
) -> dict[str, np.ndarray]:
    """Error estimates of results: the sum of the changes due to the error of each of a motion's own numbers.

    Parameters
    ----------
    motion : with `shifted`
    errors : named tuple of ndarray
        Error estimates of its numbers; `works` has one row for each work. `verdict`, `steep` and `record` are skipped.
    results_of : callable
        Computes the results of a motion.
    """
    known, nothing = results_of(motion), type(errors)(*(np.zeros_like(x) for x in errors))
    off = {name: np.zeros_like(value) for name, value in known.items()}
    names = [name for name in errors._fields if name not in ("verdict", "works", "record", "steep")]
    alone = [nothing._replace(**{name: getattr(errors, name)}) for name in names]
    for i, work in enumerate(errors.works):
        works = nothing.works.copy()
        works[i] = work
        alone.append(nothing._replace(works=works))
    for change in alone:
        for name, value in results_of(motion.shifted(change)).items():
            off[name] += np.abs(value - known[name])
    return off
