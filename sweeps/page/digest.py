"""Digest of a result file of any size for the report: the best variants and a sample of all."""

from collections.abc import Iterator, Mapping
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from engine import Verdict
from sweeps.optimising.optimum import front, is_front
from sweeps.report.sweep_result import SweepResult
from sweeps.text.conditions import Condition, parts_of

MOST_BEST, MOST_SAMPLED = 500, 2000
# Ordered axes, whose variants have neighbours; samples and tables have no order.
ORDERED_AXES = ("Listed", "Steps")


class ConditionEffect(NamedTuple):
    """A part of the condition, and its price.

    Attributes
    ----------
    text : str
    margin : float
        Distance from the limit at the best variant, relative to the limit; NaN without a best variant, of conditions
        joined by `or`, and if the limit is 0.
    without : int or None
        The best variant without this part.
    """

    text: str
    margin: float
    without: int | None


def _margin(part: Condition, values: Mapping[str, np.ndarray], errors: Mapping[str, np.ndarray]) -> float:
    sides = part.sides(values, errors)
    if sides is None or sides[2] == 0.0:
        return np.nan
    _, value, limit = sides
    return abs(value - limit) / abs(limit)


class Neighbour(NamedTuple):
    """The best variant's neighbours along a grid axis; None beyond the ends."""

    names: tuple[str, ...]
    below: int | None
    above: int | None


class Digest:
    """The content of a report; columns are read in parts and few rows are kept.

    Parameters
    ----------
    path : Path

    Attributes
    ----------
    result : SweepResult
        Description and record; its columns are never read whole.
    aim : Best or None
        The objective and condition; for a search its first objective and conditions.

    Raises
    ------
    StoreError
        From the properties: the file can't be read, or isn't a sweep result.
    """

    def __init__(self, path: Path) -> None:
        self.result = SweepResult(path)
        self.aim = self.result.aim

    @property
    def where(self) -> str:
        """The condition of the aim, or ""."""
        return self.aim.condition if self.aim else ""

    @property
    def conditions(self) -> tuple[Condition, ...]:
        """The parts of that condition."""
        return parts_of(self.where)

    # Over all variants

    def _first(self, where: str, most: int) -> np.ndarray:
        """The best variants under a condition, best first."""
        if self.aim is None:
            return np.zeros(0, int)
        found = self.result.select(where, self.aim.goal, self.aim.sign < 0, most)
        return found[np.isfinite(self.result.columns[self.aim.goal][found])]

    @cached_property
    def leaders(self) -> np.ndarray:
        """The best variants that meet the condition, best first."""
        return self._first(self.where, MOST_BEST)

    @property
    def best(self) -> int | None:
        """The best variant."""
        return int(self.leaders[0]) if self.leaders.size else None

    @cached_property
    def prices(self) -> tuple[ConditionEffect, ...]:
        """The price of each part of the condition."""
        return tuple(map(self._price, self.conditions))

    def _price(self, part: Condition) -> ConditionEffect:
        others = " and ".join(f"({other.text})" for other in self.conditions if other.text != part.text)
        without, margin = self._first(others, 1), np.nan
        if self.best is not None:
            margin = _margin(part, *self.result.known(np.array([self.best]), part.names))
        return ConditionEffect(part.text, margin, int(without[0]) if without.size else None)

    @cached_property
    def worst_errors(self) -> dict[str, float]:
        """Maximum relative error estimate of each summary among the feasible variants."""
        found, columns = dict.fromkeys(self.result.summaries, 0.0), self.result.columns
        for part in self.result.parts():
            ok = columns["status"][part] == Verdict.OK
            for name in found:
                values, errors = np.abs(columns[name][part][ok]), columns[f"{name}_error"][part][ok]
                shares = errors[values > 0] / values[values > 0]
                found[name] = max(found[name], float(np.nanmax(shares, initial=0.0)))
        return found

    # Of the variants kept

    @cached_property
    def front(self) -> np.ndarray:
        """The front of a search with several objectives; else nothing."""
        return front(self.result) if is_front(self.result) else np.zeros(0, int)

    @cached_property
    def shown(self) -> np.ndarray:
        """Variants in the figures, ascending: the leaders, the front and a random sample of all that work."""
        # The smallest of random numbers select a sample without replacement.
        random, chances, numbers = np.random.default_rng(0), np.zeros(0), np.zeros(0, int)
        for part in self.result.parts():
            ok = self.result.columns["status"][part] == Verdict.OK
            chances = np.append(chances, random.random(ok.size)[ok])
            numbers = np.append(numbers, part.start + np.flatnonzero(ok))
            least = np.argsort(chances, kind="stable")[:MOST_SAMPLED]
            chances, numbers = chances[least], numbers[least]
        return np.union1d(np.union1d(self.leaders, self.front), numbers)

    @cached_property
    def rows(self) -> dict[str, np.ndarray]:
        """All columns of the variants `shown`."""
        return self.result.taken(self.shown)

    @cached_property
    def meets(self) -> np.ndarray:
        """Which of the variants `shown` work and meet the condition."""
        return self.result.meets(self.where)(self.shown)

    @property
    def neighbours(self) -> Iterator[Neighbour]:
        """The neighbours of the best variant along the axes of a grid."""
        if self.best is None or "search" in self.result.record:
            return
        place = np.unravel_index(self.best, self.result.shape)
        for i, axis in enumerate(self.result.record["vary"]):
            if axis["kind"] in ORDERED_AXES and axis["size"] > 1:
                stride = int(np.prod(self.result.shape[i + 1 :], dtype=int))
                below = self.best - stride if place[i] > 0 else None
                above = self.best + stride if place[i] + 1 < axis["size"] else None
                yield Neighbour(tuple(axis["names"]), below, above)

    @property
    def is_one(self) -> bool:
        """Whether there is only one variant."""
        return self.result.file.variants == 1

    @cached_property
    def drawn(self) -> int | None:
        """The variant to draw: the only one, the best, or without an aim the first that works."""
        if self.is_one:
            return 0
        if self.best is not None or self.aim is not None:
            return self.best
        return int(self.shown[0]) if self.shown.size else None
