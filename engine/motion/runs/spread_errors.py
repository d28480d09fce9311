"""How errors of a motion's own numbers spread to what is made of them."""

from collections.abc import Callable
from typing import Protocol, TypeVar

import numpy as np


class Shiftable(Protocol):
    """A motion whose numbers can be changed."""

    def shifted(self, by: tuple) -> "Shiftable":
        """The same with its numbers changed."""


Motion = TypeVar("Motion", bound=Shiftable)
Told = dict[str, np.ndarray]


def spread_errors(
    motion: Motion, errors: tuple, told: Callable[[Motion], dict[str, np.ndarray]]
) -> dict[str, np.ndarray]:
    """Errors of numbers made of a motion: the sum of what the error of each of its own numbers changes them by.

    Parameters
    ----------
    motion : with `shifted`
    errors : named tuple of ndarray
        Of its own numbers; among them `works`, with a row for each. A `verdict` and `steep` have none, and a `record`
        isn't told.
    told : callable
        Makes numbers of a motion.
    """
    known, nothing = told(motion), type(errors)(*(np.zeros_like(x) for x in errors))
    off = {name: np.zeros_like(value) for name, value in known.items()}
    names = [name for name in errors._fields if name not in ("verdict", "works", "record", "steep")]
    alone = [nothing._replace(**{name: getattr(errors, name)}) for name in names]
    for i, work in enumerate(errors.works):
        works = nothing.works.copy()
        works[i] = work
        alone.append(nothing._replace(works=works))
    for change in alone:
        for name, value in told(motion.shifted(change)).items():
            off[name] += np.abs(value - known[name])
    return off
