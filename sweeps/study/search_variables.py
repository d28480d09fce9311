"""Search variables: each range and list of a study as a coordinate from 0 to 1."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from sweeps.study.sampling import Axis, Columns, Design, Listed, Sampled, between, entry_at


class Span(NamedTuple):
    """A number between two bounds, linear or logarithmic."""

    name: str
    low: float
    high: float
    logarithmic: bool = False


@dataclass(frozen=True)
class Variables:
    """Coordinates of a search: ranges first, then lists.

    Attributes
    ----------
    spans : tuple of Span
    choices : tuple of Axis
        Lists and tables, from which a candidate takes one entry or row.
    names : tuple of str
        Paths of all variables, in the study's order.
    """

    spans: tuple[Span, ...]
    choices: tuple[Axis, ...]
    names: tuple[str, ...]

    @classmethod
    def of(cls, design: Design) -> "Variables":
        """Coordinates of a study's axes, ignoring the counts of ranges."""
        spans: list[Span] = []
        choices: list[Axis] = []
        for axis in design.axes:
            if isinstance(axis, Listed | Columns):
                choices.append(axis)
            elif isinstance(axis, Sampled):
                sampled = list(map(Span, axis.names, axis.lows, axis.highs, axis.logarithmic))
                spans += [span for span in sampled if span.name not in axis.sizes]
                choices += [Listed(name, sizes) for name, sizes in axis.sizes.items()]
            else:
                spans.append(Span(axis.name, *sorted((axis.start, axis.stop)), axis.logarithmic))
        return cls(tuple(spans), tuple(choices), design.names)

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return len(self.spans) + len(self.choices)

    @property
    def free(self) -> np.ndarray:
        """Which coordinates vary continuously (size,) of bool."""
        return np.array([*(span.low < span.high for span in self.spans), *(False for _ in self.choices)], bool)

    @property
    def ranges(self) -> list[Span]:
        """The ranges, and the smallest and largest entries of lists, if there are others between them."""
        lists = [axis for axis in self.choices if isinstance(axis, Listed) and axis.size > 2]
        return [*self.spans, *(Span(a.name, float(min(a.listed)), float(max(a.listed))) for a in lists)]

    @property
    def varies(self) -> bool:
        """Whether there is anything to choose."""
        return bool(self.free.any()) or any(axis.size > 1 for axis in self.choices)

    def values(self, coordinates: np.ndarray) -> dict[str, np.ndarray]:
        """Parameters (SI) at coordinates (candidates, size), each from 0 to 1."""
        found: dict[str, np.ndarray] = {}
        for x, (name, low, high, logarithmic) in zip(coordinates.T, self.spans, strict=False):
            found[name] = between(x, low, high, logarithmic)
        for x, axis in zip(coordinates.T[len(self.spans) :], self.choices, strict=True):
            found |= axis.values(entry_at(x, np.arange(axis.size)))
        return {name: found[name] for name in self.names}

    def coordinates(self, known: Mapping[str, float]) -> np.ndarray:
        """Coordinates (size,) of known parameters.

        Default: the middle of a range, the nearest entry of a list, the first row of a table.
        """
        places = [_place(span, known.get(span.name, math.nan)) for span in self.spans]
        for axis in self.choices:
            rows = axis.values(np.arange(axis.size))
            if isinstance(axis, Listed):
                entry = np.argmin(np.abs(rows[axis.name] - known.get(axis.name, math.nan)))
            else:
                entry = np.argmax(np.all([rows[n] == known.get(n, math.nan) for n in axis.names], axis=0))
            places.append((entry + 0.5) / axis.size)
        return np.array(places)


def _place(span: Span, value: float) -> float:
    _, low, high, logarithmic = span
    if not low < high or not low <= value <= high:
        return 0.5
    return math.log(value / low) / math.log(high / low) if logarithmic else (value - low) / (high - low)
