"""What is drawn of a sweep: its columns with their units and meanings, and the grid that they form."""

import re
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from engine import Verdict
from sweeps.pictures.picture_error import PictureError
from sweeps.store import FieldAxis
from sweeps.text.engineer_units import engineer_unit

NO_BREAK = "\N{NO-BREAK SPACE}"
LONGEST_LEGEND = 200
SYMBOLS = {
    "reduced_inertia": "I",
    "reduced_moment": "M",
    "input_moment": "$M_{in}$",
    "work": "W",
    "speed": "ω",
    "speed_fluctuation": "δ",
    "excess_work": "$A_{exc}$",
    "required_drive_moment": "$M_{dr}$",
    "required_power": "P",
    "flywheel_excess_work": "$I_F$",
    "flywheel_merzalov": "$I_F$",
    "flywheel_wittenbauer": "$I_F$",
    "speed_min": "$ω_{min}$",
    "speed_max": "$ω_{max}$",
}


class SweepData(NamedTuple):
    """What is drawn of a sweep.

    Attributes
    ----------
    arrays : mapping of str to ndarray
        Parameters and summaries (variants,), fields (variants, positions), SI. The error figures of the summary
        NAME are the array NAME_error, if there is one.
    units, long_names : mapping of str to str
        Unit as CF spells it, and meaning, of each array.
    varied, summaries : sequence of str
        Names of the parameters, and of the summaries in the order of their importance.
    shape : sequence of int
        Sizes of the grid's axes, the last fastest; a single number where the variants form no grid.
    status : ndarray (variants,) of uint8
        `engine.Verdict` codes.
    along : mapping of str to FieldAxis
        What runs along each field: positions of the input, or instants of a run.
    condition : str
        What the best variant must meet, "" where nothing is asked.
    candidates : ndarray (variants,) of bool, optional
        Which of the computed variants meet it; all of them unless given.
    chosen_of : int, optional
        Of how many variants those drawn were chosen evenly, where they are too many for a picture.
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

    @property
    def out(self) -> np.ndarray:
        """Which of the variants computed without complaint miss the condition."""
        return np.zeros_like(self.ok) if self.candidates is None else self.ok & ~self.candidates

    def legend_of(self, words: str) -> str:
        """Words followed by the condition, as a legend has it: quantities stay on one line, long ones are cut."""
        condition = re.sub(r"'[^']*'", lambda quoted: quoted[0].replace(" ", NO_BREAK), self.condition)
        text = f"{words} {condition}"
        return "\n".join(wrapped(text if len(text) <= LONGEST_LEGEND else f"{text[:LONGEST_LEGEND]} …", 70))

    @property
    def ok(self) -> np.ndarray:
        """Which variants have been computed without complaint."""
        return np.asarray(self.status) == Verdict.OK

    def _is_error(self, name: str) -> bool:
        return name.endswith("_error") and name.removesuffix("_error") in self.arrays

    def shown(self, name: str) -> tuple[np.ndarray, str, float]:
        """Values of an array in an engineer's unit, its label, and the factor from SI.

        Raises
        ------
        PictureError
            There is no such array.
        """
        if name not in self.arrays:
            known = ", ".join(n for n in self.arrays if not self._is_error(n))
            raise PictureError(f"{name!r} is not in this result; there are: {known}")
        values = np.asarray(self.arrays[name], dtype=float)
        factor, unit = engineer_unit(self.units.get(name, "1"), values)
        words = self.long_names.get(name, name) or name
        text = f"{words[0].upper()}{words[1:]}" if words != name else words
        text = "\n".join(wrapped(text, 42))
        symbol = f" {SYMBOLS[name]}" if name in SYMBOLS else ""
        return factor * values, text + symbol + (f", {unit}" if unit not in ("", "1") else ""), factor

    def grid_parameters(self) -> list[str]:
        """The parameter that grows or falls along each axis of the grid with more than one place.

        Empty where the variants form no grid, as random samples don't.
        """
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
    """Fewer variants of a grid, evenly along each of its axes, the best among them.

    Parameters
    ----------
    shape : sequence of int
        Sizes of the grid's axes, the last fastest.
    best : int, optional
        A variant that must be among them.
    most : int
        No more than about so many.

    Returns
    -------
    shape : tuple of int
        Of the smaller grid.
    variants : ndarray (chosen,)
        Numbers of the variants chosen, in their order.
    """
    longest = max(shape)
    while longest > 2 and np.prod([float(min(size, longest)) for size in shape]) > most:
        longest = int(0.95 * longest)
    at = [()] * len(shape) if best is None else np.unravel_index(best, shape)
    places = [np.linspace(0, size - 1, min(size, longest)).round().astype(int) for size in shape]
    places = [np.union1d(along, place).astype(int) for along, place in zip(places, at, strict=True)]
    return tuple(map(len, places)), np.ravel_multi_index(np.ix_(*places), shape).ravel()


def wrapped(text: str, width: int) -> list[str]:
    """Lines of at most `width` letters, broken at blanks and after the dots of a path; longer words stay whole."""
    lines = [""]
    for piece in re.split(r"(?<=\.)(?=[^\W\d])|(?<= )", text):
        if lines[-1] and len((lines[-1] + piece).rstrip()) > width:
            lines.append("")
        lines[-1] += piece
    return [line.rstrip() for line in lines]
