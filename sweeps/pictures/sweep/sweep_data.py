"""Plot data of a sweep: columns with units and long names, and their grid."""

import re
from collections.abc import Collection, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from engine import Verdict, did_you_mean, display_unit
from sweeps.pictures.picture_error import PictureError
from sweeps.pictures.style import NO_BREAK, typeset, wrapped
from sweeps.store import FieldAxis

LONGEST_LEGEND = 200


class SweepData(NamedTuple):
    """Plot data of a sweep.

    Attributes
    ----------
    arrays : mapping of str to ndarray
        Parameters and summaries (variants,), fields (variants, positions), SI. The error estimates of the summary
        NAME are the array NAME_error, if there is one.
    units, long_names : mapping of str to str
        CF unit and meaning of each array.
    varied, summaries : sequence of str
        Names of the parameters, and of the summaries by importance.
    shape : sequence of int
        Sizes of the grid axes, the last fastest; a single number without a grid.
    status : ndarray (variants,) of uint8
        `engine.Verdict` codes.
    along : mapping of str to FieldAxis
        Axis of each field: input positions, or times of a run.
    condition : str
        Condition for the best variant, or "".
    candidates : ndarray (variants,) of bool, optional
        Which computed variants meet it (default: all).
    chosen_of : int, optional
        Number of variants before thinning.
    listed : collection of str
        Parameters that take the entries of a list, without values between them.
    symbols : mapping of str to str
        Textbook symbols of arrays that have one.
    """

    arrays: Mapping[str, np.ndarray]
    units: Mapping[str, str]
    long_names: Mapping[str, str]
    varied: Sequence[str]
    summaries: Sequence[str]
    shape: Sequence[int]
    status: np.ndarray
    along: Mapping[str, FieldAxis] = {}
    condition: str = ""
    candidates: np.ndarray | None = None
    chosen_of: int | None = None
    listed: Collection[str] = ()
    symbols: Mapping[str, str] = {}

    @property
    def out(self) -> np.ndarray:
        """Which computed variants miss the condition."""
        return np.zeros_like(self.ok) if self.candidates is None else self.ok & ~self.candidates

    def legend_of(self, words: str) -> str:
        """Words and the condition for a legend: quantities stay on one line, long texts are cut."""
        condition = re.sub(r"'[^']*'", lambda quoted: quoted[0].replace(" ", NO_BREAK), self.condition)
        text = f"{words} {condition}"
        return "\n".join(wrapped(text if len(text) <= LONGEST_LEGEND else f"{text[:LONGEST_LEGEND]} …", 70))

    def in_steps(self, name: str) -> bool:
        """Whether a parameter only takes discrete values: entries of a list, or whole numbers such as teeth."""
        values = np.asarray(self.arrays[name], float)
        whole = self.units.get(name, "1") in ("", "1") and bool((values == np.round(values)).all())
        return name in self.listed or whole

    @property
    def ok(self) -> np.ndarray:
        """Which variants were computed successfully."""
        return np.asarray(self.status) == Verdict.OK

    def shown(self, name: str) -> tuple[np.ndarray, str, float]:
        """Values of an array in a practical unit, its label, and the factor from SI.

        Raises
        ------
        PictureError
            No such array.
        """
        if name not in self.arrays:
            known = did_you_mean(name, (n for n in self.arrays if not n.endswith("_error")))
            raise PictureError(f"{name!r} is not in this result; {known}")
        values = np.asarray(self.arrays[name], dtype=float)
        factor, unit = display_unit(self.units.get(name, "1"), values)
        words = self.long_names.get(name, name) or name
        text = f"{words[0].upper()}{words[1:]}" if words != name else words
        text = "\n".join(wrapped(text, 42))
        symbol = f" {typeset(self.symbols[name])}" if self.symbols.get(name) else ""
        return factor * values, text + symbol + (f", {unit}" if unit not in ("", "1") else ""), factor

    def grid_parameters(self) -> list[str]:
        """The monotonic parameter along each grid axis with more than one value.

        A single parameter always has its axis. Empty without a grid, as for random samples of several.
        """
        if len(self.varied) == 1 and self.status.size > 1:
            return [*self.varied]
        found = []
        for axis, size in enumerate(self.shape):
            if size > 1:
                found += next(([name] for name in self.varied if name not in found and self._runs(name, axis)), [])
        return found if len(found) == sum(size > 1 for size in self.shape) else []

    def _runs(self, name: str, axis: int) -> bool:
        grid = np.moveaxis(np.asarray(self.arrays[name]).reshape(self.shape), axis, 0).reshape(self.shape[axis], -1)
        steps = np.diff(grid[:, 0])
        return bool((grid == grid[:, :1]).all() and ((steps > 0).all() or (steps < 0).all()))


def evenly_chosen(shape: Sequence[int], best: int | None, most: int) -> tuple[tuple[int, ...], np.ndarray]:
    """Thin a grid evenly along each axis, keeping the best variant.

    Parameters
    ----------
    shape : sequence of int
        Sizes of the grid's axes, the last fastest.
    best : int, optional
        Variant to keep.
    most : int
        Approximate maximum.

    Returns
    -------
    shape : tuple of int
        Of the smaller grid.
    variants : ndarray (chosen,)
        Indices of the chosen variants, ascending.
    """
    longest = max(shape)
    while longest > 2 and np.prod([float(min(size, longest)) for size in shape]) > most:
        longest = int(0.95 * longest)
    kept = [np.zeros(size, bool) for size in shape]
    for along, place in zip(kept, [[]] * len(shape) if best is None else np.unravel_index(best, shape), strict=True):
        along[np.linspace(0, along.size - 1, min(along.size, longest)).round().astype(int)] = True
        along[place] = True
    places = [np.flatnonzero(along) for along in kept]
    return tuple(map(len, places)), np.ravel_multi_index(np.ix_(*places), shape).ravel()
